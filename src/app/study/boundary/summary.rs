//! Combines the results of the networks: the record and the table of the boundaries.

use std::cmp::Ordering;

use super::judged::Judged;
use super::options::{BoundaryOptions, Thickness};
use super::row::Row;
use super::search::{Beside, Done, Ended};
use super::steadiness;
use crate::case::Input;
use crate::cases::days::today;
use crate::outcome::boundary::{
    BETWEEN_STEPS, BaseStated, Beyond, Boundaries, Boundary, BoundaryRow, NetworkBoundaries, WalkRow, spread,
};
use crate::outcome::leaves_out;
use crate::outcome::record::commit;
use crate::outcome::table::csv_of;
use crate::outcome::verdict::THRESHOLD;
use crate::run::error::RunError;
use crate::words::grading;
use voidwalk_practice::design::RowNote;
use voidwalk_practice::{InputFile, Note};

/// Ratio at which a row is judged if no boundary is known.
const USUAL_RATIO: f64 = 4.0;

/// The record.
///
/// # Errors
/// Sizes out of range.
pub(super) fn boundaries(
    (rows, bracket): (&[Row], [f64; 2]),
    done: &[Done],
    options: &BoundaryOptions,
    seconds: f64,
) -> Result<Boundaries, RunError> {
    let searched: Vec<Option<FoundRow>> = (0..rows.len())
        .map(|at| {
            let of_row: Vec<&Done> = done.iter().filter(|done| done.row == at).collect();
            (!of_row.is_empty()).then(|| found_row(&rows[at], &of_row))
        })
        .collect();
    // A row without networks is as the worst of its ends.
    let as_end = |row: &Row| {
        let ends = rows.iter().zip(&searched).filter(|(end, _)| is_in_range(row, end));
        let worst = ends.filter_map(|(_, result)| result.as_ref()).filter(|result| !result.is_spared());
        let worst = worst.min_by(|a, b| holds_less(a, b));
        worst.expect("a row without networks has ends").named(row)
    };
    let results =
        rows.iter().zip(&searched).map(|(row, result)| result.clone().unwrap_or_else(|| as_end(row)));
    let mut results: Vec<FoundRow> = results.collect();
    let held: Vec<Option<f64>> = rows.iter().map(|row| held_over_range(row, rows, &results)).collect();
    // An end of a range is not a filter on offer: it is judged with the row that it is an end of.
    let asked = || (0..rows.len()).filter(|&at| rows[at].end_of.is_none());
    let mut judgements = Vec::new();
    for at in asked() {
        let row = &rows[at];
        let unbounded = unbounded(row, rows, &results);
        let spared = spared_ends(row, rows, &results);
        results[at].record.no_erosion_notes.extend(spared);
        let name = format!("{}, {}", row.density, row.thickness);
        judgements.push((name, judged(row, (&results[at], rows, &results), held[at], unbounded)?));
    }
    // The worst end of a row without networks replaces that row, unless another row shares it as an end.
    let is_shown = |(result, row): &(&FoundRow, &Row)| {
        let density = &row.density;
        let has_it = |other: &Row| other.thickness == row.thickness && other.ends.contains(density);
        let all: Vec<_> = results.iter().zip(rows).filter(|(_, other)| has_it(other)).collect();
        let only = if let [(only, _)] = all[..] { only.record.as_end.as_ref() } else { None };
        !result.is_spared() && (result.record.end_of.is_none() || only != Some(density))
    };
    let shown = results.iter().zip(rows).filter(is_shown);
    let boundaries: Vec<BoundaryRow> = shown.map(|(result, _)| result.record.clone()).collect();
    let (first, stated) = (&rows[0], &rows[0].stated.scene.about);
    let judged = Judged::new(first, USUAL_RATIO)?;
    let notes = all_notes(judgements, &boundaries);
    let record = judged.case.record();
    Ok(Boundaries {
        version: env!("CARGO_PKG_VERSION").into(),
        commit: commit(),
        base: base(first, &judged.base_name),
        filter: record.filter.name,
        curve_name: record.filter.curve_name,
        filter_cu: first.case.filter.gradation.cu(),
        filter_d15_mm: first.filter_has_size.then(|| first.d15f()),
        inputs: inputs(first),
        threshold: THRESHOLD,
        replicates: first.case.scene.walk.replicates,
        seed: first.case.scene.walk.seed,
        engine: first.case.scene.walk.engine.name().into(),
        bracket,
        step: BETWEEN_STEPS,
        notes,
        model_leaves_out: leaves_out(first.case.modelled()),
        settings: settings(options),
        cover: stated.cover().dated(today()),
        inches: stated.shows_inches(),
        seconds,
        boundaries,
    })
}

/// A row from its networks, with the doubts about it.
#[derive(Clone)]
struct FoundRow {
    record: BoundaryRow,
    /// Number of networks that put its boundary in doubt, and number that erode.
    unsteady: Option<[u64; 2]>,
    /// Networks that erode at every ratio of the search.
    eroding: u64,
    /// Notes on its boundary of no erosion.
    of_boundary: Vec<Note>,
    /// For an end that cannot set the answer: the ratio that its first network holds; nothing more is known.
    spared_at: Option<f64>,
}

impl FoundRow {
    /// True if it is an end that cannot set the answer.
    fn is_spared(&self) -> bool {
        self.spared_at.is_some()
    }

    /// Why no ratio is known that holds.
    fn unheld(&self) -> Option<Note> {
        let networks = self.record.networks.len() as u64;
        self.record.held().is_none().then_some(match self.eroding {
            0 => Note::NothingWalked {},
            networks_eroding => Note::ErodesEverywhere { networks_eroding, networks },
        })
    }

    /// Result under the name of a row, for which this is the end that holds least.
    fn named(&self, row: &Row) -> Self {
        let as_end = Some(self.record.density.clone());
        let record =
            BoundaryRow { density: row.density.clone(), as_end, end_of: None, ..self.record.clone() };
        Self { record, ..self.clone() }
    }
}

/// Order of two curves of a range by the ratio that they hold; one without such a ratio is the least.
fn holds_less(a: &FoundRow, b: &FoundRow) -> Ordering {
    let [a, b] = [a, b].map(|result| result.record.held().unwrap_or(0.0));
    a.total_cmp(&b)
}

/// True if another row is this one, if it was searched, or an end of its range.
fn is_in_range(row: &Row, other: &Row) -> bool {
    let density = &other.density;
    other.networks() > 0
        && other.thickness == row.thickness
        && (*density == row.density || row.ends.contains(density))
}

/// Results of the row itself, if it was searched, and of the ends of its range.
fn range<'a>(row: &'a Row, rows: &'a [Row], results: &'a [FoundRow]) -> impl Iterator<Item = &'a FoundRow> {
    let in_range = rows.iter().zip(results).filter(move |(other, _)| is_in_range(row, other));
    in_range.map(|(_, result)| result).filter(|result| !result.is_spared())
}

/// Notes on ends of a row's range that were not searched.
fn spared_ends(row: &Row, rows: &[Row], results: &[FoundRow]) -> Vec<Note> {
    let in_range = rows.iter().zip(results).filter(|(other, _)| is_in_range(row, other));
    let spared = |(_, end): (&Row, &FoundRow)| {
        Some(Note::SparedEnd { density: end.record.density.clone(), ratio: end.spared_at? })
    };
    in_range.filter_map(spared).collect()
}

/// The ratio that nearly all networks hold with every curve of the range; `None` if it is unknown for one of
/// them. A curve whose networks hold all ratios of the search counts as holding to its end.
fn held_over_range(row: &Row, rows: &[Row], results: &[FoundRow]) -> Option<f64> {
    let held = range(row, rows, results).map(|result| result.record.held());
    held.reduce(|a, b| Some(a?.min(b?))).flatten()
}

/// Reason why the model has no boundary: networks erode at every ratio of the search, with some curve of the
/// range, or they hold every one, and the end of the search is not a boundary.
fn unbounded(row: &Row, rows: &[Row], results: &[FoundRow]) -> Option<Note> {
    if let Some(unheld) = range(row, rows, results).find_map(FoundRow::unheld) {
        return Some(unheld);
    }
    let least = range(row, rows, results).filter_map(|result| Some((result, result.record.held()?)));
    let (least, ratio) = least.min_by(|a, b| a.1.total_cmp(&b.1))?;
    least.record.no_erosion.is_none().then(|| match least.record.eroding_networks() as u64 {
        0 => Note::HoldsEverywhere { ratio },
        networks_eroding => {
            Note::MedianBeyond { ratio, networks_eroding, networks: least.record.networks.len() as u64 }
        }
    })
}

/// The notes on all rows: those that not all of them have with the row's name.
fn all_notes(rows: Vec<(String, Vec<Note>)>, boundaries: &[BoundaryRow]) -> Vec<RowNote> {
    let mut all: Vec<RowNote> = Vec::new();
    for (name, notes) in &rows {
        for note in notes {
            let by_all = rows.iter().all(|(_, other)| other.contains(note));
            let one = RowNote { row: (!by_all).then(|| name.clone()), note: note.clone() };
            if !all.contains(&one) {
                all.push(one);
            }
        }
    }
    let networks: u64 = boundaries.iter().map(|row| row.not_monotone).sum();
    if networks > 0 {
        all.push(RowNote { row: None, note: Note::NotMonotone { networks } });
    }
    all
}

/// Notes on "no erosion" for a row, at the ratio that nearly all networks hold over the range of its curve.
fn judged(
    row: &Row,
    (result, rows, results): (&FoundRow, &[Row], &[FoundRow]),
    held: Option<f64>,
    unbounded: Option<Note>,
) -> Result<Vec<Note>, RunError> {
    let record = &result.record;
    let Some(held) = held else {
        let why = unbounded.into_iter().chain(result.of_boundary.iter().cloned());
        return Ok(Judged::new(row, USUAL_RATIO)?.notes(row, why.collect()));
    };
    let judged = Judged::new(row, held)?;
    let least = range(row, rows, results).min_by(|a, b| holds_less(a, b));
    let unsteady = least.and_then(|end| end.unsteady);
    let unsteady =
        unsteady.map(|[networks_held, networks_eroding]| Note::Unsteady { networks_held, networks_eroding });
    let of_boundary = match &record.no_erosion {
        Some(boundary) => Vec::from_iter(row.thicker(boundary.high.unwrap_or(boundary.median).max(held))),
        None => result.of_boundary.clone(),
    };
    let why = [unsteady, unbounded].into_iter().flatten();
    Ok(judged.notes(row, why.chain(of_boundary).collect()))
}

/// `boundary.csv`.
pub(super) fn csv(rows: &[Row], done: &[Done]) -> Vec<u8> {
    let of_network = |done: &Done| {
        let (walked, network) = (&rows[done.row], done.network);
        let d85b_of = base(walked, "").size().map_or(String::new(), |size| grading(&size));
        let row = |&(d15f_over_d85b, eroded_first, eroded_second): &(f64, f64, Option<f64>)| WalkRow {
            density: walked.density.clone(),
            thickness: walked.thickness.to_string(),
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

fn settings(options: &BoundaryOptions) -> Vec<String> {
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

fn base(row: &Row, name: &str) -> BaseStated {
    let (walked, given) = (&row.stated.base.gradation, row.stated.base.as_given());
    // Nothing in mm is known about a base without a size.
    let cut = row.stated.base.regraded_from.as_ref().filter(|_| row.d85_mm.is_some());
    BaseStated {
        name: name.into(),
        cu: walked.cu(),
        d15_mm: row.d85_mm.and(given.d(15.0)),
        d85_mm: row.d85_mm,
        d95_over_d85: row.base.d(95.0),
        regraded_at_mm: cut.map(|(_, at)| *at),
        tail_mass_fraction: walked.pan_fraction(),
        d85_as_sampled_mm: cut.and_then(|(given, _)| given.d(85.0)),
    }
}

/// One row of the record.
fn found_row(row: &Row, done: &[&Done]) -> FoundRow {
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
    // Reason why some networks have no boundary, taken from the first of them.
    let ended = |beside: fn(&Done) -> Option<&Beside>| {
        let all: Vec<&Ended> = done.iter().filter_map(|done| Some(&beside(done)?.1)).collect();
        all.first().map(|why| why.note(all.len() as u64))
    };
    let [no_erosion, continuing] = [&first, &second].map(|networks| Boundary::of(networks, row.d85_mm));
    let holds_to = if no_erosion.is_none() { holds_to(done) } else { None };
    let ratio = no_erosion.as_ref().map_or(holds_to.unwrap_or(USUAL_RATIO), |boundary| boundary.median);
    let layers = row.layers(ratio).unwrap_or(row.case.network.layers);
    let of_layers = || {
        // For a thickness in layers: the case's own thickness, with the filter as large as it is at the
        // boundary.
        no_erosion.as_ref()?;
        Some(row.case.thickness()? * row.factor(ratio)?)
    };
    // For a filter that is as thin as one layer, or thinner: the layer itself.
    let thicker = |boundary: &Option<Boundary>| {
        let greatest = boundary.as_ref().map(|boundary| boundary.high.unwrap_or(boundary.median));
        row.thicker(greatest.or(holds_to)?)
    };
    let of_first = ended(|done| done.found.no_erosion_beyond.as_ref());
    let of_pan = of_first.as_ref().and_then(|_| of_pan(row));
    let of_boundary: Vec<Note> = [of_first, of_pan, thicker(&no_erosion)].into_iter().flatten().collect();
    let of_second = [ended(|done| done.found.continuing_beyond.as_ref()), thicker(&continuing)];
    let unsteady = no_erosion.as_ref().and_then(|_| steadiness::doubt(done));
    let record = BoundaryRow {
        density: row.density.clone(),
        thickness: row.thickness.to_string(),
        layers,
        thickness_mm: match row.thickness {
            Thickness::Mm(mm) => Some(row.thicker_than_asked(ratio).unwrap_or(mm)),
            _ => of_layers(),
        },
        grains_per_void: row.case.filter.grains_per_void,
        no_erosion,
        no_erosion_notes: of_boundary.clone(),
        holds_to,
        continuing,
        continuing_notes: of_second.into_iter().flatten().collect(),
        unsteady: unsteady
            .map(|[networks_held, networks_eroding]| Note::Unsteady { networks_held, networks_eroding }),
        not_monotone: done.iter().filter(|done| done.found.is_not_monotone).count() as u64,
        networks: done
            .iter()
            .map(|done| NetworkBoundaries {
                network: done.network,
                no_erosion: done.found.no_erosion,
                continuing: done.found.continuing,
            })
            .collect(),
        as_end: None,
        end_of: row.end_of.clone(),
    };
    let eroding = first.iter().filter(|end| **end == Err(Beyond::Below)).count() as u64;
    let spared_at = done.iter().find_map(|done| done.found.spared_at);
    FoundRow { record, unsteady, eroding, of_boundary, spared_at }
}

/// The ratio that nearly all networks hold if their median lies above all ratios of the search: a network
/// that erodes nowhere counts as holding to the greatest ratio that was walked on it.
fn holds_to(done: &[&Done]) -> Option<f64> {
    let one = |done: &&Done| match (done.found.no_erosion, &done.found.no_erosion_beyond) {
        (Some(ratio), _) => Ok(ratio),
        (None, Some((Beyond::Below, _))) => Err(Beyond::Below),
        (None, _) => done.found.walks.last().map(|walk| walk.0).ok_or(Beyond::Below),
    };
    let [low, ..] = spread(&done.iter().map(one).collect::<Vec<_>>());
    low.ok()
}

/// Note on a base whose pan fraction alone is enough to erode.
fn of_pan(row: &Row) -> Option<Note> {
    let pan = row.stated.base.gradation.pan_fraction();
    (pan >= THRESHOLD).then_some(Note::PanErodes { finest_percent: 100.0 * pan })
}
