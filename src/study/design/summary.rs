//! Puts what the networks say together: the record and the table of a design.

use super::judged::Judged;
use super::options::{DesignOptions, Thickness};
use super::practice::{allowed, finest_base};
use super::row::Row;
use super::search::Done;
use super::steadiness;
use crate::outcome::design::band::Band;
use crate::outcome::design::products::fits;
use crate::outcome::design::{
    BETWEEN_STEPS, BaseStated, Beyond, Boundary, Design, DesignAnswer, DesignRow, NetworkBoundaries, WalkRow,
    spread,
};
use crate::outcome::leaves_out;
use crate::outcome::record::Confidence;
use crate::outcome::table::csv_of;
use crate::outcome::verdict::THRESHOLD;
use crate::run::error::RunError;
use crate::verdict::words::{capital, within};
use crate::verdict::{Finding, Judgement, finding};

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
    let mut boundaries = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        let of_row: Vec<&Done> = done.iter().filter(|done| done.row == index).collect();
        boundaries.push(of(row, &of_row)?);
    }
    let held: Vec<Option<f64>> = rows.iter().map(|row| held_over_range(row, rows, &boundaries)).collect();
    // An end of a range is no filter that anybody offers: it is judged with the row that it is an end of.
    let asked = || (0..rows.len()).filter(|&at| rows[at].end_of.is_none());
    for at in asked() {
        let note = no_band(&rows[at], rows, &boundaries);
        let held = held[at].filter(|_| note.is_none());
        (boundaries[at].band, boundaries[at].band_note) = (band(&rows[at], held)?, note);
    }
    let of_row = |at: usize| asked_for(at, rows, &boundaries, held[at]);
    let each: Vec<Asked> = asked().map(of_row).collect::<Result<_, _>>()?;
    let (confidence, reasons, warnings) = all_judged(&each, &boundaries)?;
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
    // None that fits is coarser than the answer.
    let products_confidence = (!products.is_empty()).then_some(confidence);
    let first = &rows[0];
    let record = judged.case.record();
    let design = Design {
        answer: None,
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
        engine: first.case.scene.walk.engine.name().into(),
        bracket: options.bracket,
        step: BETWEEN_STEPS,
        confidence,
        reasons,
        rules,
        rules_at: ratio,
        products,
        products_confidence,
        warnings,
        model_leaves_out: leaves_out(first.case.scene.exit_rule()),
        settings: settings(options),
        seconds,
        boundaries,
    };
    Ok(Design { answer: Some(DesignAnswer::of(&design, finest.as_ref())), ..design })
}

/// A row that was asked for, and the ratio that nearly all networks hold over the range of its curve.
struct Asked<'a> {
    row: &'a Row,
    of: &'a DesignRow,
    /// The same, no more than practice allows.
    held: Option<f64>,
    /// What the walks of the curve of that range that holds least say against its boundary.
    unsteady: Option<String>,
}

fn asked_for<'a>(
    at: usize,
    rows: &'a [Row],
    boundaries: &'a [DesignRow],
    held: Option<f64>,
) -> Result<Asked<'a>, RunError> {
    let row = &rows[at];
    let held_by = |of: &DesignRow| of.held().unwrap_or(0.0);
    let least = range(row, rows, boundaries).min_by(|a, b| held_by(a).total_cmp(&held_by(b)));
    let unsteady = least.and_then(|of| Some(named(row, of, of.unsteady.clone()?)));
    let held = held.map(|held| allowed(row, held, finest_base(row)?.as_ref())).transpose()?;
    Ok(Asked { row, of: &boundaries[at], held, unsteady })
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
/// known. A curve whose networks hold all that was searched counts as holding to its end.
fn held_over_range(row: &Row, rows: &[Row], boundaries: &[DesignRow]) -> Option<f64> {
    let each = range(row, rows, boundaries).map(DesignRow::held);
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
fn no_band(row: &Row, rows: &[Row], boundaries: &[DesignRow]) -> Option<String> {
    let eroding = range(row, rows, boundaries).find(|of| of.band_note.is_some());
    if let Some((of, note)) = eroding.and_then(|of| Some((of, of.band_note.clone()?))) {
        return Some(named(row, of, note));
    }
    let least = range(row, rows, boundaries).filter_map(|of| Some((of, of.held()?)));
    let (of, ratio) = least.min_by(|a, b| a.1.total_cmp(&b.1))?;
    (of.no_erosion.is_none() && !row.inverse).then(|| {
        let note = match of.eroding_networks() {
            0 => format!(
                "nearly all networks hold as far as was searched, here to D15F/D85B {ratio:.2}, so that no \
                 greatest D15F is known; a higher end of --bracket may find it"
            ),
            eroding => format!(
                "nearly all networks hold to D15F/D85B {ratio:.2}; {eroding} of {} erode within the search, \
                 and the median lies beyond it: a higher end of --bracket may find it",
                of.networks.len()
            ),
        };
        named(row, of, note)
    })
}

/// What is said of a curve of a row's range, with its name where it is not the row's own.
fn named(row: &Row, of: &DesignRow, note: String) -> String {
    if of.density == row.wanted.density { note } else { format!("{}: {note}", of.density) }
}

/// What the answers of all rows are worth: as much as the worst of them. The sentences that speak against
/// them, and all others, of every row: what not all of them say with the row's name.
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
    each.sort_by_key(|(_, answer)| std::cmp::Reverse(answer.confidence));
    let worst = each.first().map_or(Confidence::Outside, |(_, answer)| answer.confidence);
    let said = |of: fn(&Judgement) -> Vec<String>| -> Vec<String> {
        let mut all: Vec<String> = Vec::new();
        for (name, answer) in &each {
            for sentence in of(answer) {
                let by_all = each.iter().all(|(_, other)| of(other).contains(&sentence));
                let sentence = if by_all { sentence } else { format!("{name}: {sentence}") };
                if !all.contains(&sentence) {
                    all.push(sentence);
                }
            }
        }
        all
    };
    let mut notes = said(Judgement::notes_to_do);
    let not_monotone: u64 = boundaries.iter().map(|of| of.not_monotone).sum();
    notes.extend((not_monotone > 0).then(|| finding::not_monotone(not_monotone).sentence()));
    Ok((worst, said(Judgement::reasons_to_do), notes))
}

fn judged(asked: &Asked) -> Result<Judgement, RunError> {
    let &Asked { row, of, held, .. } = asked;
    if let Some(ratio) = held {
        return judged_at(asked, ratio);
    }
    // No filter is said to hold, and no rule speaks against one.
    let why = [&of.band_note, &of.no_erosion_note].into_iter().flatten();
    let mut found: Vec<Finding> = why.map(|said| of_search(said)).collect();
    if found.is_empty() {
        found.push(of_search("no ratio is known that holds"));
    }
    Ok(Judged::new(row, USUAL_RATIO)?.answer(row, &[], found))
}

/// What it is worth that a filter with this ratio holds.
fn judged_at(Asked { row, of, unsteady, .. }: &Asked, ratio: f64) -> Result<Judgement, RunError> {
    let judged = Judged::new(row, ratio)?;
    let greatest = of.no_erosion.as_ref().map_or(ratio, |of| of.high.unwrap_or(of.median).max(ratio));
    let empty = of.band.as_ref().filter(|band| band.is_empty).map(|band| band.said.clone());
    let unknown = of.no_erosion_note.clone().filter(|_| of.no_erosion.is_none());
    let why = [unsteady.clone(), empty, of.band_note.clone(), unknown].into_iter().flatten();
    let found = why.map(|said| of_search(&said)).chain(row.thicker(greatest));
    Ok(judged.answer(row, &judged.rules(), found.collect()))
}

/// What a search found in its own words.
fn of_search(said: &str) -> Finding {
    finding::of_search(&capital(said.trim_end_matches('.')))
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
    let holds_to = if no_erosion.is_none() { holds_to(done) } else { None };
    let ratio = no_erosion.as_ref().map_or(holds_to.unwrap_or(USUAL_RATIO), |boundary| boundary.median);
    let layers = row.layers(ratio).unwrap_or(row.case.counts[3]);
    let has_size = row.has_size();
    let of_layers = || {
        // Of a thickness in layers the case's own thickness, as large as the filter is at the boundary.
        no_erosion.as_ref().filter(|_| has_size)?;
        Some(row.case.thickness()? * row.factor(ratio)?)
    };
    let held = no_erosion.as_ref().map_or(holds_to, Boundary::cautious);
    let eroding = first.iter().filter(|of| **of == Err(Beyond::Below)).count();
    let band_note = held.is_none().then(|| match eroding {
        0 => "no ratio of the search could be walked, so that none is known that holds".to_owned(),
        _ => format!(
            "{eroding} of {} networks erode 7.5 % or more at every ratio that was searched, so that no ratio \
             is known that all but 5 % of networks hold",
            first.len()
        ),
    });
    // Of a filter that is as thin as one layer, or thinner, the layer itself.
    let thicker = |boundary: &Option<Boundary>| {
        let greatest = boundary.as_ref().map(|of| of.high.unwrap_or(of.median));
        Some(within(&row.thicker(greatest.or(holds_to)?)?.sentence()))
    };
    let (first_thicker, second_thicker) = (thicker(&no_erosion), thicker(&continuing));
    let of_first = words(|done| done.found.no_erosion_beyond.as_ref().map(|(_, why)| why));
    let of_second = words(|done| done.found.continuing_beyond.as_ref().map(|(_, why)| why));
    let joined = |notes: [Option<String>; 2]| {
        let notes: Vec<String> = notes.into_iter().flatten().collect();
        (!notes.is_empty()).then(|| notes.join("; "))
    };
    let unsteady = no_erosion.as_ref().and_then(|_| steadiness::doubt(done));
    Ok(DesignRow {
        density: row.wanted.density.clone(),
        thickness: row.wanted.thickness.to_string(),
        layers,
        thickness_mm: match row.wanted.thickness {
            Thickness::Mm(mm) => Some(row.thicker_than_asked(ratio).unwrap_or(mm)),
            _ => of_layers(),
        },
        grains_per_void: row.case.grains_per_void,
        no_erosion,
        no_erosion_note: joined([of_first.map(|why| why + &of_pan(row).unwrap_or_default()), first_thicker]),
        holds_to,
        continuing,
        continuing_note: joined([of_second, second_thicker]),
        unsteady,
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
