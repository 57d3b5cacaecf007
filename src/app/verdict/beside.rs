//! Notes on the results of a run.

use crate::outcome::packing::{FLOATING_PERCENT, PackedPart};
use crate::outcome::record::{Outcome, Run, ShortOf, Stopping, Verdict};
use crate::outcome::undecided::UndecidedBy;
use crate::outcome::verdict::THRESHOLD;
use voidwalk_practice::Note;

/// Above this part of its volume a void holds more than any packing of particles would.
const ROOM: f64 = 0.6;

impl Outcome {
    /// Notes on its results: a target that was not reached, classes that the replicates leave open, trapped
    /// particles, and the effects of water and full voids.
    pub fn notes_of_results(&self) -> Vec<Note> {
        let trapped: u64 = self.replicates.iter().flat_map(|r| &r.runs).map(|r| r.trapped).sum();
        [
            self.stopping.as_ref().and_then(short_of),
            self.replicates_leave_open(),
            (trapped > 0).then_some(Note::Trapped { particles: trapped }),
            self.second_run_may_erode(),
            self.thinner_than_grain(),
            self.not_studied(),
            self.permeability(),
            self.overfull(),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// Notes the cause of a class that the replicates do not separate, unless another note does.
    fn replicates_leave_open(&self) -> Option<Note> {
        // A target error that was met says nothing about the class.
        let is_told = |stopping: &Stopping| stopping.short_of.is_some() || stopping.decide_percent.is_some();
        if self.stopping.as_ref().is_some_and(is_told) {
            return None;
        }
        match self.undecided_by()? {
            UndecidedBy::Curve => None,
            UndecidedBy::SecondRun => Some(Note::SecondRunMissing {}),
            UndecidedBy::Replicates => Some(Note::ReplicatesLeaveOpen {}),
        }
    }

    /// Notes that the second run may erode though the first does not.
    fn second_run_may_erode(&self) -> Option<Note> {
        let mean = self.summary.get(1)?.eroded_mass_fraction.mean;
        let [_, most_percent] = *self.model.eroded_percent.get(1)?;
        let may = mean < THRESHOLD && most_percent >= 100.0 * THRESHOLD;
        (self.model.class == Verdict::None && may).then_some(Note::SecondRunMayErode { most_percent })
    }

    /// Notes that the modelled part of the filter is thinner than its largest grain.
    fn thinner_than_grain(&self) -> Option<Note> {
        let modelled_mm = self.inputs.network.thickness_mm?;
        let [grain_mm, _] = *self.inputs.filter.gradation.last()?;
        (grain_mm > modelled_mm).then_some(Note::ThinnerThanGrain { modelled_mm, grain_mm })
    }

    /// Notes that no other amount of base or thickness was walked.
    fn not_studied(&self) -> Option<Note> {
        let is_studied = self.studies_to_come || !(self.sensitivity.is_empty() && self.thickness.is_empty());
        (self.practice.is_some() && !is_studied).then_some(Note::NotStudied {})
    }

    /// Notes the part of the permeability that is left at the end: a mean over the replicates; `None` without
    /// water.
    fn permeability(&self) -> Option<Note> {
        let last = self.summary.len().checked_sub(1)?;
        let left_percent = 100.0 * self.mean_of(last, |run| run.k_over_k0)?;
        Some(Note::Permeability { run: last as u64 + 1, left_percent })
    }

    /// Notes that a void holds more than it has room for; `None` if no void does, or volumes are unknown.
    fn overfull(&self) -> Option<Note> {
        let runs = || self.replicates.iter().flat_map(|replicate| &replicate.runs);
        let share = 100.0 * runs().filter_map(|run| run.overfull_fraction).reduce(f64::max)?;
        let fullest = runs().filter_map(|run| run.fullness_max).reduce(f64::max);
        match fullest.filter(|&fullest| fullest > ROOM) {
            Some(fullest) => Some(Note::Overfull { fullest, voids_percent: share }),
            None => (share > 0.0).then_some(Note::NoRoom { voids_percent: share }),
        }
    }

    /// Mean of a quantity of one run over the replicates that have it.
    fn mean_of(&self, run: usize, quantity: impl Fn(&Run) -> Option<f64>) -> Option<f64> {
        let values: Vec<f64> = self.replicates.iter().filter_map(|r| quantity(r.runs.get(run)?)).collect();
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    }
}

/// The note on a filter from which this part was packed.
pub fn packed_part(part: &PackedPart) -> Note {
    let PackedPart { percent: part_percent, largest_mm, finer_by, sizes_missing_above, .. } = *part;
    let finer_percent = 100.0 * finer_by;
    match (sizes_missing_above, part_percent >= FLOATING_PERCENT) {
        (_, false) => Note::LoosePartPacked { part_percent, largest_mm, finer_percent },
        (true, true) => Note::FloatingPartPacked { part_percent, largest_mm, finer_percent },
        (false, true) => Note::PartPacked { part_percent, largest_mm, finer_percent },
    }
}

/// Notes the reason why replicates miss the requested target.
fn short_of(stopping: &Stopping) -> Option<Note> {
    Some(match stopping.short_of? {
        ShortOf::SecondRun => Note::SecondRunMissing {},
        ShortOf::Decision { run, distance_pp, .. } => {
            let level_percent = stopping.decide_percent.unwrap_or(0.0);
            Note::LevelMissed { level_percent, run, distance_pp }
        }
        ShortOf::Target { half_width_pp, replicates, needed } => {
            let target_pp = stopping.target_error_pp.unwrap_or(0.0);
            Note::TargetMissed { target_pp, half_width_pp, replicates, needed }
        }
    })
}
