//! Puts what the networks say together: the record and the table of a design.

use super::kept::Done;
use super::options::{DesignOptions, Thickness};
use super::row::Row;
use crate::case::{Case, StatedBase};
use crate::outcome::confidence;
use crate::outcome::design::band::Band;
use crate::outcome::design::products::fits;
use crate::outcome::design::{
    BETWEEN_STEPS, BaseStated, Beyond, Boundary, Design, DesignRow, NetworkBoundaries, WalkRow,
};
use crate::outcome::leaves_out;
use crate::outcome::record::{AppliedRule, Confidence, Verdict};
use crate::outcome::rules::{BaseSoil, RuleInputs, apply};
use crate::outcome::verdict::THRESHOLD;
use crate::run::error::RunError;
use crate::scene::{Amount, BaseGradation, D85};

/// Ratio at which the rules are read where no boundary is known.
const USUAL_RATIO: f64 = 4.0;

/// Fewer networks than these give no percentiles.
const FEW_NETWORKS: u64 = 5;

/// A base coarser than this (D85, mm) is worth a word.
const COARSE_BASE_MM: f64 = 10.0;

/// The record.
///
/// # Errors
/// Sizes out of range.
pub(super) fn design(
    rows: &[Row],
    done: &[Done],
    options: &DesignOptions,
    seconds: f64,
) -> Result<Design, RunError> {
    let mut boundaries = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        let of_row: Vec<&Done> = done.iter().filter(|done| done.row == index).collect();
        boundaries.push(of(row, &of_row)?);
    }
    let held: Vec<Option<f64>> = rows.iter().map(|row| held_over_range(row, rows, &boundaries)).collect();
    // An end of a range is no filter that anybody offers: it is judged with the row that it is an end of.
    let asked = || (0..rows.len()).filter(|&at| rows[at].end_of.is_none());
    for at in asked() {
        (boundaries[at].band, boundaries[at].band_note) =
            (band(&rows[at], held[at])?, no_band(&rows[at], rows, &boundaries));
    }
    let each: Vec<Asked> =
        asked().map(|at| Asked { row: &rows[at], of: &boundaries[at], held: held[at] }).collect();
    let (confidence, reasons, warnings) = all_judged(&each, &boundaries)?;
    let known = asked().filter_map(|at| Some((at, held[at]?)));
    // Rules are shown of the coarsest filter that is said to hold: there they fail first.
    let (at, ratio) = known.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, USUAL_RATIO));
    let judged = Judged::new(&rows[at], ratio)?;
    let rules = judged.rules();
    let bands = boundaries.iter().filter_map(|of| of.band.as_ref());
    let narrowest = bands.min_by(|a, b| a.greatest.total_cmp(&b.greatest));
    let first = &rows[0];
    let record = judged.case.record();
    Ok(Design {
        version: env!("CARGO_PKG_VERSION").into(),
        inverse: options.inverse,
        base: base(first, &judged.base_name),
        filter: format!("{}, constrictions {}", record.filter.name, record.filter.curve_name),
        filter_cu: first.case.filter.cu(),
        filter_d15_mm: first.filter_has_size.then(|| first.d15f()),
        unit: judged.unit().into(),
        threshold: THRESHOLD,
        replicates: first.case.scene.walk.replicates,
        seed: first.case.scene.walk.seed,
        bracket: options.bracket,
        step: BETWEEN_STEPS,
        confidence,
        reasons,
        rules,
        rules_at: ratio,
        products: narrowest.filter(|band| band.unit == "mm").map(fits).unwrap_or_default(),
        warnings,
        model_leaves_out: leaves_out(first.case.scene.exit_rule()),
        settings: settings(options),
        seconds,
        boundaries,
    })
}

/// A row that was asked for, and the ratio that nearly all networks hold over the range of its curve.
struct Asked<'a> {
    row: &'a Row,
    of: &'a DesignRow,
    held: Option<f64>,
}

/// The row itself, and those of the ends of its range.
fn range<'a>(
    row: &'a Row,
    rows: &'a [Row],
    boundaries: &'a [DesignRow],
) -> impl Iterator<Item = &'a DesignRow> {
    let is_of_it = move |other: &Row| {
        let density = &other.wanted.density;
        other.wanted.thickness == row.wanted.thickness
            && (*density == row.wanted.density || row.ends.contains(density))
    };
    rows.iter().zip(boundaries).filter(move |(other, _)| is_of_it(other)).map(|(_, of)| of)
}

/// The ratio that nearly all networks hold, of every curve of the range; `None` where that of one is not
/// known.
fn held_over_range(row: &Row, rows: &[Row], boundaries: &[DesignRow]) -> Option<f64> {
    let each = range(row, rows, boundaries).map(|of| of.no_erosion.as_ref().and_then(Boundary::cautious));
    each.reduce(|a, b| Some(a?.min(b?))).flatten()
}

/// The band of a specification up to the ratio that holds.
fn band(row: &Row, held: Option<f64>) -> Result<Option<Band>, RunError> {
    let Some(ratio) = held.filter(|_| !row.inverse) else { return Ok(None) };
    let judged = Judged::new(row, ratio)?;
    let d85b = row.d85_mm.unwrap_or(1.0);
    Ok(Band::new(&judged.rules(), d85b, ratio * d85b, judged.unit()))
}

/// Why there is no band, where networks erode at every ratio that was searched, with some curve of the range.
fn no_band(row: &Row, rows: &[Row], boundaries: &[DesignRow]) -> Option<String> {
    let mut range = range(row, rows, boundaries);
    range.find_map(|of| {
        let note = of.band_note.as_ref()?;
        Some(if of.density == row.wanted.density { note.clone() } else { format!("{}: {note}", of.density) })
    })
}

/// How far the answers of all rows can be relied on: as far as the worst of them. Why no further, and what
/// else is to be said, of every row: what not all of them say with the row's name.
fn all_judged(
    asked: &[Asked],
    boundaries: &[DesignRow],
) -> Result<(Confidence, Vec<String>, Vec<String>), RunError> {
    let mut each = Vec::new();
    for asked in asked {
        let name = format!("{}, {}", asked.of.density, asked.of.thickness);
        each.push((name, judged(asked)?));
    }
    // The weightiest first.
    each.sort_by_key(|(_, (confidence, ..))| std::cmp::Reverse(*confidence));
    let worst = each.first().map_or(Confidence::Outside, |(_, (confidence, ..))| *confidence);
    let said = |of: fn(&Said) -> &Vec<String>| -> Vec<String> {
        let mut all: Vec<String> = Vec::new();
        for (name, judged) in &each {
            for sentence in of(judged) {
                let by_all = each.iter().all(|(_, other)| of(other).contains(sentence));
                let sentence = if by_all { sentence.clone() } else { format!("{name}: {sentence}") };
                if !all.contains(&sentence) {
                    all.push(sentence);
                }
            }
        }
        all
    };
    let mut warnings = said(|(.., warnings)| warnings);
    let not_monotone: u64 = boundaries.iter().map(|of| of.not_monotone).sum();
    if not_monotone > 0 {
        warnings.push(format!(
            "on {not_monotone} of the networks some larger ratio was seen to hold: there the smallest ratio \
             that was seen to erode counts"
        ));
    }
    Ok((worst, said(|(_, reasons, _)| reasons), warnings))
}

/// How far a row can be relied on, why no further, and what else is to be said.
type Said = (Confidence, Vec<String>, Vec<String>);

fn judged(&Asked { row, of, held }: &Asked) -> Result<Said, RunError> {
    let Some(ratio) = held else {
        // No filter is said to hold, and no rule speaks against one.
        let (_, reasons, warnings) = Judged::new(row, USUAL_RATIO)?.confidence(row, &[]);
        let why = [&of.band_note, &of.no_erosion_note].into_iter().flatten().cloned();
        return Ok((Confidence::Outside, why.chain(reasons).collect(), warnings));
    };
    let judged = Judged::new(row, ratio)?;
    let (mut confidence, mut reasons, warnings) = judged.confidence(row, &judged.rules());
    if let Some(band) = of.band.as_ref().filter(|band| band.is_empty) {
        confidence = confidence.max(Confidence::Outside);
        reasons.insert(0, band.said.clone());
    }
    Ok((confidence, reasons, warnings))
}

/// `design.csv`.
///
/// # Errors
/// None that a writer to memory has.
pub(super) fn csv(rows: &[Row], done: &[Done]) -> Result<Vec<u8>, RunError> {
    let format = |e: csv::Error| RunError::Format { file: "design.csv", source: e.into() };
    let mut writer = csv::Writer::from_writer(Vec::new());
    for done in done {
        let wanted = &rows[done.row].wanted;
        for &(ratio, first, second) in &done.found.walks {
            let row = WalkRow {
                density: wanted.density.clone(),
                thickness: wanted.thickness.to_string(),
                network: done.network,
                d15f_over_d85b: ratio,
                eroded_first: first,
                eroded_second: second,
            };
            writer.serialize(row).map_err(format)?;
        }
    }
    writer.into_inner().map_err(|e| RunError::Format { file: "design.csv", source: e.to_string().into() })
}

fn settings(options: &DesignOptions) -> Vec<String> {
    let base = options.base.iter().map(|path| path.display().to_string());
    let filter = options.filter.iter().map(|shape| format!("--filter {shape}"));
    let densities = options.densities.iter().map(|density| format!("--density {density}"));
    let thicknesses = options.thicknesses.iter().map(|thickness| format!("--thickness {thickness}"));
    let settings = options.settings.iter().map(|setting| format!("--set {setting}"));
    base.chain(filter).chain(densities).chain(thicknesses).chain(settings).collect()
}

fn base(row: &Row, name: &str) -> BaseStated {
    let walked = &row.stated.gradation;
    let given = row.stated.regraded_from.as_ref().map_or(walked, |(given, _)| given);
    let sized = row.d85_mm.filter(|_| !row.inverse);
    BaseStated {
        name: name.into(),
        cu: walked.cu(),
        d15_mm: sized.and(given.d(15.0)),
        d85_mm: sized,
        d95_over_d85: row.base.d(95.0),
    }
}

/// One row of the record, but for its band.
fn of(row: &Row, done: &[&Done]) -> Result<DesignRow, RunError> {
    let networks = |value: fn(&Done) -> Option<f64>, beyond: fn(&Done) -> Option<Beyond>| {
        let one = |done: &&Done| value(done).ok_or(beyond(done).unwrap_or(Beyond::Above));
        done.iter().map(one).collect::<Vec<_>>()
    };
    let first = networks(
        |done| done.found.no_erosion,
        |done| done.found.no_erosion_beyond.as_ref().map(|(beyond, _)| *beyond),
    );
    let second = networks(
        |done| done.found.continuing,
        |done| done.found.continuing_beyond.as_ref().map(|(beyond, _)| *beyond),
    );
    let words = |of: fn(&Done) -> Option<&String>| {
        let said: Vec<&String> = done.iter().filter_map(|done| of(done)).collect();
        let why = said.first()?;
        Some(match said.len() == done.len() {
            true => (*why).clone(),
            false => format!("on {} of {} networks: {why}", said.len(), done.len()),
        })
    };
    let boundary = |networks: &[Result<f64, Beyond>]| {
        let boundary = Boundary::of(networks, row.d85_mm.filter(|_| !row.inverse))?;
        Some(if row.inverse { boundary.inverted(row.has_size().then(|| row.d15f())) } else { boundary })
    };
    let (no_erosion, continuing) = (boundary(&first), boundary(&second));
    let ratio = no_erosion.as_ref().map_or(USUAL_RATIO, |boundary| boundary.median);
    let layers = row.layers(ratio).unwrap_or(row.case.counts[3]);
    let has_size = row.has_size();
    let of_layers = || {
        // Of a thickness in layers the case's own thickness, as large as the filter is at the boundary.
        no_erosion.as_ref().filter(|_| has_size)?;
        Some(row.case.thickness()? * row.factor(ratio)?)
    };
    let held = no_erosion.as_ref().map(Boundary::cautious);
    let eroding = first.iter().filter(|of| **of == Err(Beyond::Below)).count();
    let band_note = (held == Some(None)).then(|| {
        format!(
            "{eroding} of {} networks erode 7.5 % or more at every ratio that was searched, so that no ratio \
             is known that all but 5 % of networks hold",
            first.len()
        )
    });
    Ok(DesignRow {
        density: row.wanted.density.clone(),
        thickness: row.wanted.thickness.to_string(),
        layers,
        thickness_mm: match row.wanted.thickness {
            Thickness::Mm(mm) => Some(mm),
            _ => of_layers(),
        },
        grains_per_void: row.case.grains_per_void,
        no_erosion,
        no_erosion_note: words(|done| done.found.no_erosion_beyond.as_ref().map(|(_, why)| why))
            .map(|why| why + &of_pan(row).unwrap_or_default()),
        continuing,
        continuing_note: words(|done| done.found.continuing_beyond.as_ref().map(|(_, why)| why)),
        not_monotone: done.iter().filter(|done| done.found.is_not_monotone).count() as u64,
        networks: done
            .iter()
            .map(|done| NetworkBoundaries {
                network: done.network,
                no_erosion: done.found.no_erosion,
                continuing: done.found.continuing,
            })
            .collect(),
        band: None,
        band_note,
        end_of: row.end_of.clone(),
    })
}

/// What is to be said where the base's pan fraction alone is enough to erode.
fn of_pan(row: &Row) -> Option<String> {
    let pan = row.stated.gradation.pan_fraction();
    (pan >= THRESHOLD).then(|| {
        format!(
            "; {:.1} % of the base is finer than its finest sieve and erodes by itself where it is taken as \
             finer than every constriction: add finer sieves, or base.d0_mm",
            100.0 * pan
        )
    })
}

/// That a band over so few networks says little.
fn few_networks(row: &Row) -> Option<String> {
    let networks = row.case.scene.walk.replicates;
    let counted = if networks == 1 { "1 network".to_owned() } else { format!("{networks} networks") };
    (networks < FEW_NETWORKS).then(|| {
        format!(
            "only {counted}: a band of 5 to 95 % needs {FEW_NETWORKS} at least, better 20 \
             (--set replicates=20)"
        )
    })
}

/// That the number of base particles is not that of Eq. (2) at every ratio.
fn of_amount(row: &Row) -> Option<String> {
    let what = match row.case.scene.base.amount() {
        Amount::Number(n) => format!("base.n_base holds the number of base particles at {n}"),
        Amount::MassRatio(_, Some(cap)) => {
            format!("base.cap holds the number of base particles at {cap} or less")
        }
        Amount::MassRatio(_, None) => return None,
    };
    Some(format!(
        "{what}, which is not the base that Eq. (2) asks for at every ratio: where there is less, more \
         filters seem to hold"
    ))
}

/// A row at one ratio, as what knows millimetres judges it.
struct Judged {
    /// The case with the sizes that filter and base have there; without a unit, that of D85B = 1.
    case: Case,
    has_size: bool,
    /// D85B (mm).
    d85_mm: Option<f64>,
    /// The base that was stated.
    base_name: String,
}

impl Judged {
    fn new(row: &Row, ratio: f64) -> Result<Self, RunError> {
        let has_size = row.has_size();
        let d85 = match (has_size, row.inverse) {
            (true, false) => row.d85_mm.unwrap_or(1.0),
            (true, true) => row.d15f() / ratio,
            (false, _) => 1.0,
        };
        let scaled = |stated: &StatedBase| -> Result<StatedBase, RunError> {
            let sizes = |gradation: &crate::gradation::Gradation| {
                let factor = d85 / row.stated.gradation.d(85.0).unwrap_or(d85);
                gradation.scaled(factor).map_err(crate::case::CaseError::from)
            };
            let regraded_from = match &stated.regraded_from {
                Some((given, at)) => Some((sizes(given)?, *at)),
                None => None,
            };
            Ok(StatedBase { gradation: sizes(&stated.gradation)?, regraded_from, ..stated.clone() })
        };
        let stated = if has_size && !row.inverse { row.stated.clone() } else { scaled(&row.stated)? };
        let mut case = row.case.enlarged(ratio * d85 / row.d15f(), &stated)?;
        if let Ok(walked) = row.at(ratio) {
            (case.pan_size, case.counts) = (walked.pan_size, walked.counts);
            (case.n_base, case.n_base_eq2, case.capped) = (walked.n_base, walked.n_base_eq2, walked.capped);
        }
        let base_name = case.record().base.name;
        if !has_size {
            // As multiples of a size that is not known, neither soil has fines.
            (case.scene.filter.d0_mm, case.scene.base) = (Some(1.0), row.case.scene.base.clone());
        } else if let BaseGradation::Linear { d85: D85::AtDc(..) | D85::Ratio(_), .. } =
            case.scene.base.gradation()
        {
            // The filter's size says the base's.
            let of = &mut case.scene.base;
            (of.d85_mm, of.d85_at_dc, of.dc_curve, of.d15f_over_d85b) = (Some(d85), None, None, None);
        }
        Ok(Self { case, has_size, d85_mm: has_size.then_some(d85), base_name })
    }

    fn unit(&self) -> &'static str {
        if self.has_size { "mm" } else { "D85B" }
    }

    fn rules(&self) -> Vec<AppliedRule> {
        let (case, scale_free) = (&self.case, !self.has_size);
        let inputs = RuleInputs {
            filter: &case.filter,
            filter_is_measured: case.filter_is_measured(),
            base: case.base_as_given(),
            walked_base: &case.base,
            base_soil: BaseSoil::of(case.base_as_given(), scale_free),
            scale_free,
            filter_curves: Vec::new(),
            dispersive: case.scene.base.dispersive == Some(true),
            joint_mm: case.scene.filter.joint_mm,
            largest_eroded_over_d15f: None,
        };
        let mut rules = apply(&inputs);
        for rule in rules.iter_mut().filter(|rule| rule.unit == "D0F") {
            rule.unit = "D85B".into();
        }
        rules
    }

    /// How far "no erosion" can be relied on, why no further, and what else is to be said.
    fn confidence(&self, row: &Row, rules: &[AppliedRule]) -> Said {
        // Said of every ratio below.
        let of_one = self.case.too_little_base().filter(|_| of_amount(row).is_some());
        let doubts = self.case.doubts().into_iter();
        let doubts: Vec<String> = doubts.filter(|said| Some(said) != of_one.as_ref()).collect();
        let coarse = self.d85_mm.filter(|d85| *d85 > COARSE_BASE_MM).map(|d85| {
            format!("the base's D85 is {d85:.1} mm: are its sizes micrometres under a header in mm?")
        });
        let of_search = [few_networks(row), of_amount(row)].into_iter().flatten();
        let doubts: Vec<String> = coarse.into_iter().chain(doubts).chain(of_search).collect();
        let others = self.case.warnings().into_iter().filter(|said| !doubts.contains(said));
        let warnings = others.collect();
        let (confidence, reasons) = confidence::judge(Verdict::None, rules, doubts);
        (confidence, reasons, warnings)
    }
}
