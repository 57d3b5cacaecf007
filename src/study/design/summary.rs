//! Puts what the networks say together: the record and the table of a design.

use std::cmp::Ordering;

use super::judged::Judged;
use super::options::{DesignOptions, Thickness};
use super::practice::{allowed, finest_base};
use super::row::Row;
use super::search::{Beside, Done, Ended};
use super::steadiness;
use crate::case::Input;
use crate::gradation::{CurvePoint, Gradation};
use crate::outcome::design::band::{Band, SetBy};
use crate::outcome::design::products::fits;
use crate::outcome::design::{
    BETWEEN_STEPS, BaseStated, Beyond, Boundary, Design, DesignAnswer, DesignFinding, DesignRow,
    NetworkBoundaries, Specification, WalkRow, spread,
};
use crate::outcome::leaves_out;
use crate::outcome::record::{FindingRecord, InputFile, commit};
use crate::outcome::table::csv_of;
use crate::outcome::verdict::THRESHOLD;
use crate::run::error::RunError;
use crate::study::days::today;
use crate::verdict::{Finding, SpecificationOptions, design_answer, finding};

/// Ratio at which the rules are read where no boundary is known.
const USUAL_RATIO: f64 = 4.0;

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
    let searched: Vec<Option<FoundRow>> = (0..rows.len())
        .map(|at| {
            let of_row: Vec<&Done> = done.iter().filter(|done| done.row == at).collect();
            (!of_row.is_empty()).then(|| of(&rows[at], &of_row))
        })
        .collect();
    // A row without networks is as the worst of its ends.
    let as_end = |row: &Row| {
        let ends = rows.iter().zip(&searched).filter(|(end, _)| is_in_range(row, end));
        let worst = ends.filter_map(|(_, found)| found.as_ref()).filter(|found| !found.is_spared());
        let worst = worst.min_by(|a, b| holds_less(a, b));
        worst.expect("a row without networks has ends").named(row)
    };
    let found = rows.iter().zip(&searched).map(|(row, found)| found.clone().unwrap_or_else(|| as_end(row)));
    let mut found: Vec<FoundRow> = found.collect();
    let held: Vec<Option<f64>> = rows.iter().map(|row| held_over_range(row, rows, &found)).collect();
    // An end of a range is no filter that anybody offers: it is judged with the row that it is an end of.
    let asked = || (0..rows.len()).filter(|&at| rows[at].end_of.is_none());
    let mut judgements = Vec::new();
    for at in asked() {
        let row = &rows[at];
        let no_band = no_band(row, rows, &found);
        let band = band(row, held[at].filter(|_| no_band.is_none()))?;
        (found[at].of.band, found[at].of.band_note) = (band, no_band.as_ref().map(Finding::with_to_do));
        let notes = found[at].of.no_erosion_note.take().into_iter().chain(spared_ends(row, rows, &found));
        let notes: Vec<String> = notes.collect();
        found[at].of.no_erosion_note = (!notes.is_empty()).then(|| notes.join(" "));
        let name = format!("{}, {}", row.wanted.density, row.wanted.thickness);
        judgements.push((name, judged(row, (&found[at], rows, &found), held[at], no_band)?));
    }
    // The worst end of a row without networks is that row, unless another row has it as an end, too.
    let is_shown = |(of, row): &(&FoundRow, &Row)| {
        let density = &row.wanted.density;
        let has_it =
            |other: &Row| other.wanted.thickness == row.wanted.thickness && other.ends.contains(density);
        let all: Vec<_> = found.iter().zip(rows).filter(|(_, other)| has_it(other)).collect();
        let only = if let [(only, _)] = all[..] { only.of.as_end.as_ref() } else { None };
        !of.is_spared() && (of.of.end_of.is_none() || only != Some(density))
    };
    let shown = found.iter().zip(rows).filter(is_shown);
    let boundaries: Vec<DesignRow> = shown.map(|(found, _)| found.of.clone()).collect();
    let findings = all_found(judgements, &boundaries);
    let known = asked().filter_map(|at| Some((at, held[at]?)));
    // Rules are shown of the coarsest filter that is said to hold: there they fail first.
    let (at, ratio) = known.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, USUAL_RATIO));
    let finest = finest_base(&rows[0])?;
    let ratio = allowed(&rows[at], ratio, finest.as_ref())?;
    let judged = Judged::new(&rows[at], ratio)?;
    let rules = judged.rules();
    let bands = boundaries.iter().filter_map(|of| of.band.as_ref());
    let narrowest = bands.min_by(|a, b| a.greatest.total_cmp(&b.greatest));
    let products = narrowest.filter(|band| band.unit == "mm").map(fits).unwrap_or_default();
    let first = &rows[0];
    let record = judged.case.record();
    let design = Design {
        answer: None,
        specification: None,
        version: env!("CARGO_PKG_VERSION").into(),
        commit: commit(),
        inverse: options.inverse,
        base: base(first, &judged.base_name),
        filter: format!("{}, constrictions {}", record.filter.name, record.filter.curve_name),
        filter_cu: first.case.filter.cu(),
        filter_d15_mm: first.filter_has_size.then(|| first.d15f()),
        filter_gradation: if first.filter_has_size { pairs(&first.case.filter) } else { Vec::new() },
        inputs: inputs(first),
        unit: judged.unit().into(),
        threshold: THRESHOLD,
        replicates: first.case.scene.walk.replicates,
        seed: first.case.scene.walk.seed,
        engine: first.case.scene.walk.engine.name().into(),
        bracket: options.bracket,
        step: BETWEEN_STEPS,
        rules,
        rules_at: ratio,
        products,
        findings,
        model_leaves_out: leaves_out(first.case.modelled()),
        settings: settings(options),
        cover: first.stated.scene.about.cover().dated(today()),
        inches: first.stated.scene.about.shows_inches(),
        seconds,
        boundaries,
    };
    let answer = design_answer(&design, finest.as_ref());
    let specification = specification(first, &design.base.name, &answer, options);
    let answer = answer.specified(specification.as_ref());
    Ok(Design { answer: Some(answer), specification, ..design })
}

/// The specification of a filter that practice and the answer allow; `None` without an answer in mm.
fn specification(
    row: &Row,
    name: &str,
    answer: &DesignAnswer,
    options: &DesignOptions,
) -> Option<Specification> {
    let greatest = answer.d15f_max_mm?;
    let given = row.stated.regraded_from.as_ref().map_or(&row.stated.gradation, |(given, _)| given);
    let specified = SpecificationOptions {
        dispersive: row.stated.scene.base.dispersive,
        finer: false,
        sieves: options.sieves,
        walked_mm: (answer.set_by == SetBy::Walk).then_some(greatest),
    };
    let of = Specification::of(name, &[(name.to_owned(), given.clone())], specified);
    Some(Specification { inches: row.stated.scene.about.shows_inches(), ..of })
}

/// A row as its networks have it, and what they say against it.
#[derive(Clone)]
struct FoundRow {
    of: DesignRow,
    /// How many of how many networks that erode put its boundary in doubt.
    unsteady: Option<[u64; 2]>,
    /// Networks that erode at every ratio of the search.
    eroding: u64,
    /// What is to be said of its boundary of no erosion.
    of_boundary: Vec<Finding>,
    /// Of an end that cannot set the answer: the ratio that its first network holds, and no more is known.
    spared_at: Option<f64>,
}

impl FoundRow {
    /// Whether it is an end that cannot set the answer.
    fn is_spared(&self) -> bool {
        self.spared_at.is_some()
    }

    /// Why no ratio is known that holds; `at` names the curve.
    fn unheld(&self, at: &str) -> Option<Finding> {
        let networks = self.of.networks.len() as u64;
        self.of.held().is_none().then(|| match self.eroding {
            0 => finding::nothing_walked(at),
            eroding => finding::erodes_everywhere(eroding, networks, at),
        })
    }

    /// The same of a row of which this is the end that holds least.
    fn named(&self, row: &Row) -> Self {
        let as_end = Some(self.of.density.clone());
        let of = DesignRow { density: row.wanted.density.clone(), as_end, end_of: None, ..self.of.clone() };
        Self { of, ..self.clone() }
    }
}

/// Which of two curves of a range holds less; one without a ratio that holds is the least.
fn holds_less(a: &FoundRow, b: &FoundRow) -> Ordering {
    let [a, b] = [a, b].map(|found| found.of.held().unwrap_or(0.0));
    a.total_cmp(&b)
}

/// Whether another row is this one, where it was searched, or an end of its range.
fn is_in_range(row: &Row, other: &Row) -> bool {
    let density = &other.wanted.density;
    other.networks() > 0
        && other.wanted.thickness == row.wanted.thickness
        && (*density == row.wanted.density || row.ends.contains(density))
}

/// What was found of the row itself, where it was searched, and of the ends of its range.
fn range<'a>(row: &'a Row, rows: &'a [Row], found: &'a [FoundRow]) -> impl Iterator<Item = &'a FoundRow> {
    let in_range = rows.iter().zip(found).filter(move |(other, _)| is_in_range(row, other));
    in_range.map(|(_, found)| found).filter(|found| !found.is_spared())
}

/// That an end of a row's range was not searched.
fn spared_ends(row: &Row, rows: &[Row], found: &[FoundRow]) -> Vec<String> {
    let in_range = rows.iter().zip(found).filter(|(other, _)| is_in_range(row, other));
    let said = |(_, end): (&Row, &FoundRow)| {
        let ratio = end.spared_at?;
        Some(format!(
            "The end {} holds clearly more: D15F/D85B {ratio:.2} on the first of {} networks. It is taken \
             that it does not set the answer, and its boundary was not searched.",
            end.of.density, row.case.scene.walk.replicates
        ))
    };
    in_range.filter_map(said).collect()
}

/// The ratio that nearly all networks hold, of every curve of the range; `None` where that of one is not
/// known. A curve whose networks hold all that was searched counts as holding to its end.
fn held_over_range(row: &Row, rows: &[Row], found: &[FoundRow]) -> Option<f64> {
    let each = range(row, rows, found).map(|found| found.of.held());
    each.reduce(|a, b| Some(a?.min(b?))).flatten()
}

/// The band of a specification up to the ratio that holds.
fn band(row: &Row, held: Option<f64>) -> Result<Option<Band>, RunError> {
    let Some(ratio) = held.filter(|_| !row.inverse) else { return Ok(None) };
    let judged = Judged::new(row, ratio)?;
    let d15f = ratio * row.d85_mm.unwrap_or(1.0);
    Ok(Band::new(&judged.rules(), d15f, d15f, judged.unit()))
}

/// Why there is no band, where networks erode at every ratio that was searched, with some curve of the range,
/// or where they hold every one, and the end of the search is no limit.
fn no_band(row: &Row, rows: &[Row], found: &[FoundRow]) -> Option<Finding> {
    if let Some(unheld) = range(row, rows, found).find_map(|of| of.unheld(&curve(row, of))) {
        return Some(unheld);
    }
    let least = range(row, rows, found).filter_map(|found| Some((found, found.of.held()?)));
    let (least, ratio) = least.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let at = curve(row, least);
    (least.of.no_erosion.is_none() && !row.inverse).then(|| match least.of.eroding_networks() as u64 {
        0 => finding::holds_everywhere(ratio, &at),
        eroding => finding::median_beyond(ratio, eroding, least.of.networks.len() as u64, &at),
    })
}

/// The name of a curve of a row's range, where it is not the row's own.
fn curve(row: &Row, found: &FoundRow) -> String {
    let density = &found.of.density;
    if *density == row.wanted.density { String::new() } else { format!(" ({density})") }
}

/// What was found about all rows: what not all of them have with the row's name.
fn all_found(each: Vec<(String, Vec<FindingRecord>)>, boundaries: &[DesignRow]) -> Vec<DesignFinding> {
    let same = |a: &FindingRecord, b: &FindingRecord| a.with_to_do() == b.with_to_do();
    let mut findings: Vec<DesignFinding> = Vec::new();
    for (name, found) in &each {
        for finding in found {
            let by_all = each.iter().all(|(_, other)| other.iter().any(|other| same(other, finding)));
            let row = (!by_all).then(|| name.clone());
            if !findings.iter().any(|of| of.row == row && same(&of.finding, finding)) {
                findings.push(DesignFinding { row, finding: finding.clone() });
            }
        }
    }
    let not_monotone: u64 = boundaries.iter().map(|of| of.not_monotone).sum();
    if not_monotone > 0 {
        let finding = finding::not_monotone(not_monotone).record();
        findings.push(DesignFinding { row: None, finding });
    }
    findings
}

/// What "no erosion" of a row is worth, at the ratio that nearly all networks hold over the range of its
/// curve, or at the one that practice allows where that is less.
fn judged(
    row: &Row,
    (own, rows, found): (&FoundRow, &[Row], &[FoundRow]),
    held: Option<f64>,
    no_band: Option<Finding>,
) -> Result<Vec<FindingRecord>, RunError> {
    let of = &own.of;
    let Some(held) = held else {
        // No filter is said to hold, and no rule speaks against one.
        let why = no_band.into_iter().chain(own.of_boundary.iter().cloned());
        return Ok(Judged::new(row, USUAL_RATIO)?.findings(row, &[], why.collect()));
    };
    let ratio = allowed(row, held, finest_base(row)?.as_ref())?;
    let judged = Judged::new(row, ratio)?;
    let least = range(row, rows, found).min_by(|a, b| holds_less(a, b));
    let unsteady = least.and_then(|of| Some((of.unsteady?, curve(row, of))));
    let unsteady = unsteady.map(|([held, eroding], at)| finding::unsteady(held, eroding, &at));
    let of_boundary = match &of.no_erosion {
        Some(boundary) => Vec::from_iter(row.thicker(boundary.high.unwrap_or(boundary.median).max(ratio))),
        None => own.of_boundary.clone(),
    };
    let why = [unsteady, of.band.as_ref().and_then(Band::empty), no_band].into_iter().flatten();
    Ok(judged.findings(row, &judged.rules(), why.chain(of_boundary).collect()))
}

/// `design.csv`.
pub(super) fn csv(rows: &[Row], done: &[Done]) -> Vec<u8> {
    let of_network = |done: &Done| {
        let (wanted, network) = (&rows[done.row].wanted, done.network);
        let d85b_of = base(&rows[done.row], "").size().map_or(String::new(), |size| size.grading());
        let row = |&(d15f_over_d85b, eroded_first, eroded_second): &(f64, f64, Option<f64>)| WalkRow {
            density: wanted.density.clone(),
            thickness: wanted.thickness.to_string(),
            network,
            d15f_over_d85b,
            eroded_first,
            eroded_second,
            d85b_of: d85b_of.clone(),
        };
        done.found.walks.iter().map(row).collect::<Vec<_>>()
    };
    csv_of(&done.iter().flat_map(of_network).collect::<Vec<_>>())
}

fn settings(options: &DesignOptions) -> Vec<String> {
    let base = options.base.iter().map(|path| path.display().to_string());
    let filter = options.filter.iter().map(|shape| format!("--filter {shape}"));
    let densities = options.densities.iter().map(|density| format!("--density {density}"));
    let thicknesses = options.thicknesses.iter().map(|thickness| format!("--thickness {thickness}"));
    let settings = options.settings.iter().map(|setting| format!("--set {setting}"));
    let ticks =
        [("--pack", options.pack), ("--as-sampled", options.as_sampled), ("--as-given", options.as_given)];
    let ticks = ticks.into_iter().filter(|(_, is_given)| *is_given).map(|(name, _)| name.to_owned());
    base.chain(filter).chain(densities).chain(thicknesses).chain(ticks).chain(settings).collect()
}

/// Every file that was read for a row, the base's first.
fn inputs(row: &Row) -> Vec<InputFile> {
    let mut files: Vec<InputFile> = Vec::new();
    for file in row.stated.inputs.iter().chain(&row.case.inputs).map(Input::file) {
        if !files.contains(&file) {
            files.push(file);
        }
    }
    files
}

fn pairs(soil: &Gradation) -> Vec<[f64; 2]> {
    soil.points().into_iter().map(CurvePoint::row).collect()
}

fn base(row: &Row, name: &str) -> BaseStated {
    let walked = &row.stated.gradation;
    let given = row.stated.regraded_from.as_ref().map_or(walked, |(given, _)| given);
    let sized = row.d85_mm.filter(|_| !row.inverse);
    let is_regraded = row.d85_mm.is_some() && row.stated.regraded_from.is_some();
    BaseStated {
        gradation: if row.d85_mm.is_some() { pairs(given) } else { Vec::new() },
        regraded: if is_regraded { pairs(walked) } else { Vec::new() },
        name: name.into(),
        cu: walked.cu(),
        d15_mm: sized.and(given.d(15.0)),
        d85_mm: sized,
        d95_over_d85: row.base.d(95.0),
        regraded_at_mm: row.stated.regraded_from.as_ref().filter(|_| sized.is_some()).map(|(_, at)| *at),
        tail_mass_fraction: walked.pan_fraction(),
        d85_as_sampled_mm: row
            .stated
            .regraded_from
            .as_ref()
            .filter(|_| sized.is_some())
            .and_then(|(given, _)| given.d(85.0)),
    }
}

/// One row of the record, but for its band.
fn of(row: &Row, done: &[&Done]) -> FoundRow {
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
    // Why some networks have none, in the words of the first of them.
    let ended = |of: fn(&Done) -> Option<&Beside>| {
        let all: Vec<&Ended> = done.iter().filter_map(|done| Some(&of(done)?.1)).collect();
        let on = match all.len() == done.len() {
            true => String::new(),
            false => format!(" ({} of {} networks)", all.len(), done.len()),
        };
        all.first().map(|why| why.finding(&on))
    };
    let boundary = |networks: &[Result<f64, Beyond>]| {
        let boundary = Boundary::of(networks, row.d85_mm.filter(|_| !row.inverse))?;
        Some(if row.inverse { boundary.inverted(row.has_size().then(|| row.d15f())) } else { boundary })
    };
    let (no_erosion, continuing) = (boundary(&first), boundary(&second));
    let holds_to = if no_erosion.is_none() { holds_to(done) } else { None };
    let ratio = no_erosion.as_ref().map_or(holds_to.unwrap_or(USUAL_RATIO), |boundary| boundary.median);
    let layers = row.layers(ratio).unwrap_or(row.case.counts[3]);
    let has_size = row.has_size();
    let of_layers = || {
        // Of a thickness in layers the case's own thickness, as large as the filter is at the boundary.
        no_erosion.as_ref().filter(|_| has_size)?;
        Some(row.case.thickness()? * row.factor(ratio)?)
    };
    // Of a filter that is as thin as one layer, or thinner, the layer itself.
    let thicker = |boundary: &Option<Boundary>| {
        let greatest = boundary.as_ref().map(|of| of.high.unwrap_or(of.median));
        row.thicker(greatest.or(holds_to)?)
    };
    let of_first = ended(|done| done.found.no_erosion_beyond.as_ref());
    let of_pan = of_first.as_ref().and_then(|_| of_pan(row));
    let of_boundary: Vec<Finding> = [of_first, of_pan, thicker(&no_erosion)].into_iter().flatten().collect();
    let of_second = [ended(|done| done.found.continuing_beyond.as_ref()), thicker(&continuing)];
    let note = |findings: &[Finding]| {
        let said: Vec<String> = findings.iter().map(Finding::with_to_do).collect();
        (!said.is_empty()).then(|| said.join(" "))
    };
    let unsteady = no_erosion.as_ref().and_then(|_| steadiness::doubt(done));
    let of = DesignRow {
        density: row.wanted.density.clone(),
        thickness: row.wanted.thickness.to_string(),
        layers,
        thickness_mm: match row.wanted.thickness {
            Thickness::Mm(mm) => Some(row.thicker_than_asked(ratio).unwrap_or(mm)),
            _ => of_layers(),
        },
        grains_per_void: row.case.grains_per_void,
        no_erosion,
        no_erosion_note: note(&of_boundary),
        holds_to,
        continuing,
        continuing_note: note(&of_second.into_iter().flatten().collect::<Vec<_>>()),
        unsteady: unsteady.map(|[held, eroding]| finding::unsteady(held, eroding, "").sentence()),
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
        band_note: None,
        as_end: None,
        end_of: row.end_of.clone(),
    };
    let eroding = first.iter().filter(|of| **of == Err(Beyond::Below)).count() as u64;
    let spared_at = done.iter().find_map(|done| done.found.spared_at);
    let found = FoundRow { of, unsteady, eroding, of_boundary, spared_at };
    let band_note = found.unheld("").map(|unheld| unheld.sentence());
    FoundRow { of: DesignRow { band_note, ..found.of }, ..found }
}

/// The ratio that nearly all networks hold where their median lies above all that was searched: one that
/// erodes nowhere counts as holding to the greatest ratio that was walked on it.
fn holds_to(done: &[&Done]) -> Option<f64> {
    let one = |done: &&Done| match (done.found.no_erosion, &done.found.no_erosion_beyond) {
        (Some(ratio), _) => Ok(ratio),
        (None, Some((Beyond::Below, _))) => Err(Beyond::Below),
        (None, _) => done.found.walks.last().map(|walk| walk.0).ok_or(Beyond::Below),
    };
    let [low, ..] = spread(&done.iter().map(one).collect::<Vec<_>>());
    low.ok()
}

/// What is to be said where the base's pan fraction alone is enough to erode.
fn of_pan(row: &Row) -> Option<Finding> {
    let pan = row.stated.gradation.pan_fraction();
    (pan >= THRESHOLD).then(|| finding::pan_erodes(100.0 * pan))
}
