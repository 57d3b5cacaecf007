//! Combines the results of the networks: the record and the table of the boundaries.

use std::cmp::Ordering;

use super::plan::{BoundaryOptions, Thickness};
use super::row::{Judged, Row};
use super::search::{Beside, Done, Found};
use crate::case::Input;
use crate::cases::kept::today;
use crate::outcome::boundary::{
    BETWEEN_STEPS, BaseStated, Beyond, Boundaries, Boundary, BoundaryRow, NetworkBoundaries, WalkRow, spread,
};
use crate::outcome::leaves_out;
use crate::outcome::record::commit;
use crate::outcome::table::csv_of;
use crate::outcome::verdict::THRESHOLD;
use crate::run::RunError;
use crate::words::grading;
use voidwalk_practice::design::RowNote;
use voidwalk_practice::{InputFile, Note};

/// Ratio at which a row is judged without a known boundary.
const USUAL_RATIO: f64 = 4.0;

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
    // A row without networks takes the result of the worst of its ends.
    let as_end = |row: &Row| {
        let ends = rows.iter().zip(&searched).filter(|(end, _)| is_in_range(row, end));
        let worst =
            ends.filter_map(|(_, result)| result.as_ref()).filter(|result| result.spared_at.is_none());
        let worst = worst.min_by(|a, b| holds_less(a, b)).expect("a row without networks has ends").clone();
        let (density, as_end) = (row.density.clone(), Some(worst.record.density.clone()));
        FoundRow { record: BoundaryRow { density, as_end, end_of: None, ..worst.record }, ..worst }
    };
    let results =
        rows.iter().zip(&searched).map(|(row, result)| result.clone().unwrap_or_else(|| as_end(row)));
    let mut results: Vec<FoundRow> = results.collect();
    // An end of a range is not a filter on offer: it is judged with its row.
    let mut judgements = Vec::new();
    for (at, row) in rows.iter().enumerate().filter(|(_, row)| row.end_of.is_none()) {
        let in_range = rows.iter().zip(&results).filter(|(other, _)| is_in_range(row, other));
        let (searched, spared): (Vec<&FoundRow>, Vec<&FoundRow>) =
            in_range.map(|(_, result)| result).partition(|result| result.spared_at.is_none());
        let name = format!("{}, {}", row.density, row.thickness);
        judgements.push((name, judged(row, &results[at].record, &searched)?));
        let density = |end: &FoundRow| end.record.density.clone();
        let spared = spared.into_iter().filter_map(|end| Some((density(end), end.spared_at?)));
        let spared: Vec<Note> = spared.map(|(density, ratio)| Note::SparedEnd { density, ratio }).collect();
        results[at].record.no_erosion_notes.extend(spared);
    }
    // The worst end of a row without networks replaces that row, unless another row shares it as an end.
    let is_shown = |(result, row): &(&FoundRow, &Row)| {
        let density = &row.density;
        let has_it = |other: &Row| other.thickness == row.thickness && other.ends.contains(density);
        let all: Vec<_> = results.iter().zip(rows).filter(|(_, other)| has_it(other)).collect();
        let only = if let [(only, _)] = all[..] { only.record.as_end.as_ref() } else { None };
        result.spared_at.is_none() && (result.record.end_of.is_none() || only != Some(density))
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

/// Row made from its networks, with the doubts about it.
#[derive(Clone)]
struct FoundRow {
    record: BoundaryRow,
    eroding: u64,
    /// For an end that cannot decide the answer: the ratio that its first network holds, its only result.
    spared_at: Option<f64>,
}

impl FoundRow {
    fn unheld(&self) -> Option<Note> {
        let networks = self.record.networks.len() as u64;
        self.record.held().is_none().then_some(match self.eroding {
            0 => Note::NothingWalked {},
            networks_eroding => Note::ErodesEverywhere { networks_eroding, networks },
        })
    }
}

/// Order of two curves of a range by the ratio that they hold; a curve without one comes first.
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

/// Reason why the model has no boundary: with some curve of the range networks erode at every ratio of the
/// search, or they hold every one, and the end of the search is not a boundary.
fn unbounded(range: &[&FoundRow]) -> Option<Note> {
    if let Some(unheld) = range.iter().find_map(|result| result.unheld()) {
        return Some(unheld);
    }
    let least = range.iter().filter_map(|result| Some((result, result.record.held()?)));
    let (least, ratio) = least.min_by(|a, b| a.1.total_cmp(&b.1))?;
    least.record.no_erosion.is_none().then(|| match least.record.eroding_networks() as u64 {
        0 => Note::HoldsEverywhere { ratio },
        networks_eroding => {
            Note::MedianBeyond { ratio, networks_eroding, networks: least.record.networks.len() as u64 }
        }
    })
}

/// Notes on all rows; a note that some rows lack has the name of its row.
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
/// `range` holds the results of the row itself and of the ends of its range, as far as they were searched. A
/// curve whose networks hold all ratios of the search counts as holding up to its end.
fn judged(row: &Row, record: &BoundaryRow, range: &[&FoundRow]) -> Result<Vec<Note>, RunError> {
    let unbounded = unbounded(range);
    // Unknown if it is unknown for one of them.
    let held = range.iter().map(|result| result.record.held());
    let Some(held) = held.reduce(|a, b| Some(a?.min(b?))).flatten() else {
        let why = unbounded.into_iter().chain(record.no_erosion_notes.iter().cloned());
        return Ok(Judged::new(row, USUAL_RATIO)?.notes(row, why.collect()));
    };
    let judged = Judged::new(row, held)?;
    let least = range.iter().min_by(|a, b| holds_less(a, b));
    let unsteady = least.and_then(|end| end.record.unsteady.clone());
    let of_boundary = match &record.no_erosion {
        Some(boundary) => Vec::from_iter(row.thicker(boundary.high.unwrap_or(boundary.median).max(held))),
        None => record.no_erosion_notes.clone(),
    };
    let why = [unsteady, unbounded].into_iter().flatten();
    Ok(judged.notes(row, why.chain(of_boundary).collect()))
}

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

/// Every file that was read for a row, the base's file first.
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
    // Sizes in mm are unknown for a base without a size.
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

fn found_row(row: &Row, done: &[&Done]) -> FoundRow {
    type End = fn(&Found) -> (Option<f64>, &Option<Beside>);
    let [first, second]: [End; 2] = [
        |found| (found.no_erosion, &found.no_erosion_beyond),
        |found| (found.continuing, &found.continuing_beyond),
    ];
    let networks = |end: End| -> Vec<Result<f64, Beyond>> {
        let one = |done: &&Done| match end(&done.found) {
            (Some(ratio), _) => Ok(ratio),
            (None, beside) => Err(beside.as_ref().map_or(Beyond::Above, |(beyond, _)| *beyond)),
        };
        done.iter().map(one).collect()
    };
    // Reason why some networks have no boundary, taken from the first of them.
    let ended = |end: End| {
        let all: Vec<_> = done.iter().filter_map(|done| Some(&end(&done.found).1.as_ref()?.1)).collect();
        all.first().map(|why| why.note(all.len() as u64))
    };
    let (of_first, of_second) = (networks(first), networks(second));
    let [no_erosion, continuing] = [&of_first, &of_second].map(|networks| Boundary::of(networks, row.d85_mm));
    let holds_to = if no_erosion.is_none() { holds_to(done) } else { None };
    let ratio = no_erosion.as_ref().map_or(holds_to.unwrap_or(USUAL_RATIO), |boundary| boundary.median);
    let layers = row.layers(ratio).unwrap_or(row.case.network.layers);
    let of_layers = || {
        // For a thickness in layers: the case's own thickness, with the filter scaled to the boundary.
        no_erosion.as_ref()?;
        Some(row.case.thickness()? * row.factor(ratio)?)
    };
    // For a filter no thicker than one layer: the thickness of the layer.
    let thicker = |boundary: &Option<Boundary>| {
        let greatest = boundary.as_ref().map(|boundary| boundary.high.unwrap_or(boundary.median));
        row.thicker(greatest.or(holds_to)?)
    };
    let ended_first = ended(first);
    let of_pan = ended_first.as_ref().and_then(|_| of_pan(row));
    let no_erosion_notes = [ended_first, of_pan, thicker(&no_erosion)].into_iter().flatten().collect();
    let continuing_notes = [ended(second), thicker(&continuing)].into_iter().flatten().collect();
    let unsteady = no_erosion.as_ref().and_then(|_| unsteady(done));
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
        no_erosion_notes,
        holds_to,
        continuing,
        continuing_notes,
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
        as_end: None,
        end_of: row.end_of.clone(),
    };
    let eroding = of_first.iter().filter(|end| **end == Err(Beyond::Below)).count() as u64;
    FoundRow { record, eroding, spared_at: done.iter().find_map(|done| done.found.spared_at) }
}

/// Ratio that nearly all networks hold if their median lies above all ratios of the search: a network that
/// erodes nowhere counts as holding up to the greatest ratio walked on it.
fn holds_to(done: &[&Done]) -> Option<f64> {
    let one = |done: &&Done| match (done.found.no_erosion, &done.found.no_erosion_beyond) {
        (Some(ratio), _) => Ok(ratio),
        (None, Some((Beyond::Below, _))) => Err(Beyond::Below),
        (None, _) => done.found.walks.last().map(|walk| walk.0).ok_or(Beyond::Below),
    };
    let [low, ..] = spread(&done.iter().map(one).collect::<Vec<_>>());
    low.ok()
}

fn of_pan(row: &Row) -> Option<Note> {
    let pan = row.stated.base.gradation.pan_fraction();
    (pan >= THRESHOLD).then_some(Note::PanErodes { finest_percent: 100.0 * pan })
}

/// Note on a doubtful no-erosion boundary: on half or more of the networks that erode, some ratio above an
/// eroding one holds.
fn unsteady(done: &[&Done]) -> Option<Note> {
    let eroding: Vec<&&Done> = done.iter().filter(|network| network.found.no_erosion.is_some()).collect();
    let is_unsteady = |network: &&&&Done| {
        // Walks are in the order of their ratios.
        let mut first_runs = network.found.walks.iter().map(|walk| walk.1);
        first_runs.any(|eroded| eroded >= THRESHOLD) && first_runs.any(|eroded| eroded < THRESHOLD)
    };
    let unsteady = eroding.iter().filter(is_unsteady).count();
    let (networks_held, networks_eroding) = (unsteady as u64, eroding.len() as u64);
    let is_doubtful = unsteady > 0 && 2 * unsteady >= eroding.len();
    is_doubtful.then_some(Note::Unsteady { networks_held, networks_eroding })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::boundary::search::Ended;

    /// Network whose first run erodes these percentages at ratios 1, 2 and so on, and whose second run goes
    /// up and down.
    fn network(first: &[f64]) -> Done {
        let second = [0.0, 0.08, 0.01, 0.02].map(Some);
        let walks = (1u32..).zip(first).zip(second);
        let walks: Vec<_> = walks.map(|((s, first), second)| (f64::from(s), first / 100.0, second)).collect();
        let no_erosion = walks.iter().find(|walk| walk.1 >= THRESHOLD).map(|walk| walk.0);
        let no_erosion_beyond = no_erosion.is_none().then_some((Beyond::Above, Ended::Holds(1, 4.0)));
        let found = Found { no_erosion, no_erosion_beyond, is_not_monotone: true, walks, ..Found::default() };
        Done { row: 0, network: 1, found }
    }

    #[test]
    fn half_of_the_networks_that_erode_in_the_first_run_are_enough() {
        let note = |networks: &[&[f64]]| {
            let done: Vec<Done> = networks.iter().map(|first| network(first)).collect();
            unsteady(&done.iter().collect::<Vec<_>>())
        };
        let doubt =
            |networks_held, networks_eroding| Some(Note::Unsteady { networks_held, networks_eroding });
        let steady: &[f64] = &[1.0, 5.0, 8.0, 20.0];
        let unsteady: &[f64] = &[1.0, 7.5, 7.4, 20.0];
        let holding: &[f64] = &[1.0, 2.0, 3.0, 4.0];
        assert_eq!(note(&[steady, steady, unsteady]), None);
        assert_eq!(note(&[steady, unsteady]), doubt(1, 2));
        assert_eq!(note(&[steady, unsteady, holding]), doubt(1, 2));
        assert_eq!(note(&[unsteady]), doubt(1, 1));
        assert_eq!(note(&[steady]), None);
    }
}
