//! Boundaries of the model: the D15F/D85B from which a filter of some shape lets some of the base erode, and
//! the D15F/D85B from which erosion continues.
//!
//! # Method
//! Each shape and density takes one packing. Packings are free of scale: a filter s times as large holds a
//! base as the filter itself would hold one 1/s times as large, so nothing is packed again. Each network of a
//! boundary is a replicate of a run, with its own streams of random numbers; these are the same at every
//! ratio, and so is the network, to the bit. `search` describes the search; `crate::outcome::boundary`
//! gives the median and band over networks. A thickness in mm is another number of layers at every ratio, but
//! the first layers are always the same.
//!
//! For a thickness in layers or multiples of D50F, a base twice as large takes a filter exactly twice as
//! large.

mod plan;
#[cfg(test)]
mod range_tests;
mod row;
mod search;
mod summary;
#[cfg(test)]
mod tests;
mod trials;

use std::sync::{Mutex, MutexGuard};
use std::time::Instant;

use rayon::prelude::*;
use serde_json::{Value, json};

use super::specified::check_d85;
use crate::case::CaseError;
use crate::cases::kept::{self, Kept};
use crate::cases::plan::PlannedCase;
use crate::outcome::boundary::{Beyond, Boundaries};
use crate::run::callbacks::{Callbacks, Event};
use crate::run::folder::{FolderKind, claim};
use crate::run::machine::on_threads;
use crate::run::pack::provide;
use crate::run::prepare::Draft;
use crate::run::replicates::have_networks;
use crate::run::{Exit, RunError};
use crate::scene::{BaseGradation, D85};
use plan::{plan, with_any_base};
use row::Row;
use search::{Done, Found, Hint, METHOD};
use voidwalk_core::schema::setting_name;

pub use plan::BoundaryOptions;
pub(crate) use plan::{Thickness, ThicknessList};

/// Finds the boundaries and writes `boundary.csv` and, last, `boundary.json`.
///
/// # Errors
/// Wrong settings, or a folder that cannot be claimed, are refused before any work; then errors of a packing
/// or a walk. After a stop or a kill the same command continues with the remaining networks.
pub fn run(options: &BoundaryOptions, callbacks: &Callbacks) -> Result<Boundaries, RunError> {
    on_threads(options.prepare.threads, || run_within(options, BRACKET, callbacks))
}

fn run_within(
    options: &BoundaryOptions,
    bracket: [f64; 2],
    callbacks: &Callbacks,
) -> Result<Boundaries, RunError> {
    let begun = Instant::now();
    // Any mistake is found before any work.
    let drafts = plan(options)?.cases.into_iter().map(|planned| drafted(planned, options, bracket));
    let drafts: Vec<(Draft, Row)> = drafts.collect::<Result<_, _>>()?;
    let kind = FolderKind::Boundary;
    let folder = claim(&options.out, kind, options.overwrite)?;
    let packed = |(draft, row): (Draft, Row)| -> Result<Row, RunError> {
        let provided = |plan| provide(plan, &options.prepare.packings, callbacks);
        let packed = draft.packing.as_ref().map(provided).transpose()?;
        Ok(Row { case: draft.finished(packed)?, ..row })
    };
    let rows = with_curve_ends(drafts.into_iter().map(packed).collect::<Result<_, _>>()?);
    let work = work(&rows, bracket);
    kept::study((&folder, kind, options.overwrite), work, callbacks, |kept, done| {
        let done = searched(&rows, bracket, done.unwrap_or_default(), kept, callbacks)?;
        folder.write("boundary.csv", &summary::csv(&rows, &done))?;
        summary::boundaries((&rows, bracket), &done, options, begun.elapsed().as_secs_f64())
    })
}

/// D15F/D85B between which [`run`] searches.
const BRACKET: [f64; 2] = [0.5, 100.0];

/// Density and thickness found sound, with a guess for a filter that is still to be packed.
fn drafted(
    planned: PlannedCase,
    options: &BoundaryOptions,
    bracket: [f64; 2],
) -> Result<(Draft, Row), RunError> {
    let PlannedCase { scene, mut levels, .. } = planned;
    let (density, thickness) = (levels.remove(0).1, Thickness::of(&scene.network));
    let mut draft = Draft::new(with_any_base(&scene))?;
    let case = &mut draft.case;
    let stated = case.base_of(&scene)?;
    let refuse = |problem: &str| Err(RunError::from(CaseError::from(scene.clash(problem.to_owned()))));
    let Some(d85) = stated.base.gradation.d(85.0) else {
        return refuse(
            "the base's D85 lies in the pan fraction (finer than the finest sieve): add finer sieves, or \
             base.d0_mm",
        );
    };
    // D0 counts as one millimetre if it is stated, else as the unit.
    let states_d0 = options.settings.iter().any(|setting| setting_name(setting) == "filter.d0_mm");
    let filter_has_size = states_d0 || !case.is_scale_free();
    let has_size = match scene.base.gradation() {
        BaseGradation::Sieve(..) | BaseGradation::Single(_) => true,
        BaseGradation::Linear { d85, .. } => matches!(d85, D85::Mm(_)),
    };
    if has_size && let Err(stones) = check_d85(d85) {
        return refuse(&stones.to_string());
    }
    if matches!(thickness, Thickness::Mm(_)) && !has_size {
        return refuse(
            "a thickness in mm needs a base in mm: give BASE, base.d85_mm, or a thickness in layers or \
             multiples of D50F",
        );
    }
    let base = stated.base.gradation.scaled(1.0 / d85).map_err(CaseError::from)?;
    let limits = options.prepare.limits(&options.out);
    case.place(&limits, rayon::current_num_threads() as u64, &options.out)?;
    have_networks(case, &Callbacks::default())?;
    let row = Row {
        density,
        thickness,
        case: case.clone(),
        stated,
        base,
        d85_mm: has_size.then_some(d85),
        filter_has_size,
        limits,
        end_of: None,
        ends: Vec::new(),
    };
    row.check_room(bracket)?;
    // The curve of a filter that is still to be packed is not known yet.
    if row.case.filter.packed.is_none() {
        row.at_curve_ends().iter().try_for_each(|end| end.check_room(bracket))?;
    }
    Ok((draft, row))
}

/// Every row, each followed by the ends of the range of its constriction curve, as a run walks them: the
/// densest and the loosest for a guess, the coarser curve for a filter with only its finer part packed. An
/// end that was asked for as a row of its own is not repeated.
fn with_curve_ends(rows: Vec<Row>) -> Vec<Row> {
    let same = |a: &Row, b: &Row| a.density == b.density && a.thickness == b.thickness;
    let mut all: Vec<Row> = Vec::new();
    for row in &rows {
        let ends = row.at_curve_ends();
        let names = ends.iter().map(|end| end.density.clone()).collect();
        let asked_for = |end: &Row| rows.iter().chain(&all).any(|other| same(end, other));
        let ends: Vec<Row> = ends.into_iter().filter(|end| !asked_for(end)).collect();
        all.push(Row { ends: names, ..row.clone() });
        all.extend(ends);
    }
    all
}

fn work(rows: &[Row], bracket: [f64; 2]) -> String {
    let rows = rows.iter().map(|row| {
        let base = row.stated.base.gradation.points();
        let base: Vec<[f64; 2]> = base.iter().map(|point| [point.size, point.percent]).collect();
        let thickness = row.thickness.to_string();
        json!([row.case.fingerprint(), thickness, base, row.d85_mm, row.filter_has_size])
    });
    let rows: Vec<Value> = rows.collect();
    kept::hash_of(&json!([METHOD, bracket, rows]).to_string())
}

/// Searches every missing network of every row, side by side, and saves each as soon as it is done.
fn searched(
    rows: &[Row],
    bracket: [f64; 2],
    done: Vec<Done>,
    kept: &Kept,
    callbacks: &Callbacks,
) -> Result<Vec<Done>, RunError> {
    let total: u64 = rows.iter().map(Row::networks).sum();
    let tell = |text: String| (callbacks.on_event)(Event::Studying(&text));
    if !done.is_empty() {
        tell(format!("{} of {total} networks are done already", done.len()));
    }
    tell(format!("searching up to {} networks", total - done.len() as u64));
    let less: Vec<Vec<usize>> = (0..rows.len()).map(|row| holding_less(rows, row)).collect();
    let (ends, others): (Vec<usize>, Vec<usize>) = (0..rows.len()).partition(|&row| !less[row].is_empty());
    let searched = others.iter().filter(|&&row| rows[row].networks() > 0).count().max(1);
    let begun_at_once = rayon::current_num_threads().div_ceil(searched);
    let (done, writing) = (Mutex::new(done), Mutex::new(()));
    let searching = Searching { rows, bracket, done, writing, kept, callbacks, begun_at_once };
    let ended = others.into_par_iter().try_for_each(|row| searching.row(row)).and_then(|()| {
        // Ends that seem to hold more are searched if they may still decide the answer.
        let row_or_less = |row: usize| match searching.holds_clearly_more(row, &less[row])? {
            true => Ok(()),
            false => searching.row(row),
        };
        ends.into_par_iter().try_for_each(row_or_less)
    });
    let mut done = searching.done.into_inner().expect("no search panics while it keeps");
    if let Err(error) = ended {
        return Err(match error.exit() {
            Exit::Stopped => kept.stopped(done.len(), total as usize),
            _ => error,
        });
    }
    done.sort_by_key(|done| (done.row, done.network));
    Ok(done)
}

struct Searching<'a> {
    rows: &'a [Row],
    bracket: [f64; 2],
    done: Mutex<Vec<Done>>,
    writing: Mutex<()>,
    kept: &'a Kept<'a>,
    callbacks: &'a Callbacks<'a>,
    /// Networks of a row that begin before its first has ended, and stay in memory until they end.
    begun_at_once: usize,
}

impl Searching<'_> {
    /// Searches every missing network of a row. The first gives hints for the others; some of them begin
    /// while its second run is searched.
    fn row(&self, row: usize) -> Result<(), RunError> {
        let settings = &self.rows[row];
        let result = |network: u64| {
            let done = self.done();
            done.iter().find(|done| (done.row, done.network) == (row, network)).map(|done| done.found.clone())
        };
        let left: Vec<u64> = (1..=settings.networks()).filter(|network| result(*network).is_none()).collect();
        let with = |hint: Hint| (self.bracket, hint);
        let (others, mut soon) = match left.split_first() {
            Some((1, others)) => {
                let first = settings.begun(1, with(Hint::default()), self.callbacks)?;
                let hint = first.hint();
                let (soon, others) = others.split_at(others.len().min(self.begun_at_once));
                let begin =
                    |&network: &u64| Ok((network, settings.begun(network, with(hint), self.callbacks)?));
                let (first, soon) = rayon::join(
                    || self.keep(row, 1, first.ended(None)?),
                    || soon.par_iter().map(begin).collect::<Result<Vec<_>, RunError>>(),
                );
                first?;
                (others, soon?)
            }
            _ => (&left[..], Vec::new()),
        };
        let hint = result(1).map(|first| Hint::of(&first)).unwrap_or_default();
        let (begun, whole) = rayon::join(
            || {
                soon.par_drain(..).try_for_each(|(network, begun)| {
                    self.keep(row, network, begun.ended(hint.boundaries[1])?)
                })
            },
            || {
                others.par_iter().try_for_each(|&network| {
                    let begun = settings.begun(network, with(hint), self.callbacks)?;
                    self.keep(row, network, begun.ended(hint.boundaries[1])?)
                })
            },
        );
        begun.and(whole)
    }

    /// True if the first network of an end holds clearly more than these rows, so that it cannot decide the
    /// answer.
    fn holds_clearly_more(&self, row: usize, less: &[usize]) -> Result<bool, RunError> {
        let less: Vec<(usize, u64)> = less.iter().map(|&less| (less, self.rows[less].networks())).collect();
        let first =
            |done: &Vec<Done>| done.iter().find(|done| done.row == row).map(|done| done.found.spared_at);
        let (known, ratio) = {
            let done = self.done();
            (first(&done), clear_of(&done, &less))
        };
        if let Some(spared_at) = known {
            return Ok(spared_at.is_some());
        }
        let Some(ratio) = ratio else { return Ok(false) };
        match self.rows[row].holding(ratio, self.bracket, self.callbacks)? {
            Some(found) => self.keep(row, 1, found).map(|()| true),
            None => Ok(false),
        }
    }

    fn keep(&self, row: usize, network: u64, found: Found) -> Result<(), RunError> {
        let settings = &self.rows[row];
        let words = |ratio: Option<f64>| ratio.map_or("beyond the search".into(), |r| format!("{r:.3}"));
        let holds = match found.spared_at {
            Some(ratio) => format!("D15F/D85B {ratio:.3} holds"),
            None => format!(
                "no erosion to D15F/D85B {}, continuing from {}",
                words(found.no_erosion),
                words(found.continuing)
            ),
        };
        let text = format!(
            "{}, {}, network {network} of {}: {holds} ({} ratios walked)",
            settings.density,
            settings.thickness,
            settings.networks(),
            found.walks.len()
        );
        (self.callbacks.on_event)(Event::Studying(&text));
        self.done().push(Done { row, network, found });
        self.write()
    }

    /// Writes finished work, unless another thread is writing: that thread continues until nothing is left,
    /// so that no search waits for a disk.
    fn write(&self) -> Result<(), RunError> {
        loop {
            let Ok(writing) = self.writing.try_lock() else { return Ok(()) };
            let all = self.done().clone();
            self.kept.keep(all.len(), &all)?;
            drop(writing);
            if self.done().len() == all.len() {
                return Ok(());
            }
        }
    }

    fn done(&self) -> MutexGuard<'_, Vec<Done>> {
        self.done.lock().expect("no search panics while it keeps")
    }
}

/// Minimum ratio that the first network of an end must hold, as a multiple of the greatest ratio among the
/// networks of the end that holds least; the square of the spread of those networks counts if it is larger.
/// Even a network of the end that lies twice as far below its first as that spread then holds more than the
/// least of them.
const CLEAR: f64 = 1.1;

/// For each row with row `at` as an end, the end of the same range that holds least by the closed form for a
/// lone particle. Empty if that is row `at` itself, if row `at` was asked for, or if it is an end of a row
/// that is itself searched.
fn holding_less(rows: &[Row], at: usize) -> Vec<usize> {
    let row = &rows[at];
    if row.end_of.is_none() {
        return Vec::new();
    }
    let is_end_of =
        |parent: &Row, end: &Row| parent.thickness == end.thickness && parent.ends.contains(&end.density);
    let parents = || rows.iter().filter(|parent| is_end_of(parent, row));
    if parents().any(|parent| parent.networks() > 0) {
        return Vec::new();
    }
    let least = parents().map(|parent| {
        let ends = (0..rows.len()).filter(|&end| is_end_of(parent, &rows[end]));
        ends.min_by(|&a, &b| rows[a].start().total_cmp(&rows[b].start())).expect("the row is one")
    });
    let least: Vec<usize> = least.collect();
    if least.contains(&at) { Vec::new() } else { least }
}

/// Ratio that the first network of an end must hold so that it cannot decide the answer beside rows that hold
/// less, once all networks of those rows are done; `None` if the end is searched in any case.
fn clear_of(done: &[Done], holding_less: &[(usize, u64)]) -> Option<f64> {
    let ratio = |&(row, networks): &(usize, u64)| {
        let of_row = done.iter().filter(|done| done.row == row);
        let held: Option<Vec<f64>> = of_row.map(|done| holds_to(&done.found)).collect();
        let held = held.filter(|held| held.len() as u64 == networks)?;
        let greatest = held.iter().copied().reduce(f64::max)?;
        let apart = greatest / held.into_iter().reduce(f64::min)?;
        Some(greatest * CLEAR.max(apart * apart))
    };
    let ratios: Option<Vec<f64>> = holding_less.iter().map(ratio).collect();
    ratios?.into_iter().reduce(f64::max).filter(|ratio| ratio.is_finite() && *ratio > 0.0)
}

/// Ratio up to which a network holds; 0 if it erodes at every ratio of the search, `None` if unknown.
fn holds_to(found: &Found) -> Option<f64> {
    match (found.no_erosion, &found.no_erosion_beyond) {
        (Some(ratio), _) => Some(ratio),
        (None, Some((Beyond::Below, _))) => Some(0.0),
        (None, _) => None,
    }
}
