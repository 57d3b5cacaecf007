//! What the results of a run say beside its verdict, and the findings of an outcome as they are shown.

use super::entry::Finding;
use super::finding;
use crate::outcome::packing::{FLOATING_PERCENT, PackedPart};
use crate::outcome::record::{CurveRange, Outcome, Run, ShortOf, Stopping};
use crate::outcome::undecided::UndecidedBy;

/// Id of a finest part of the filter that the mass eroded does not know of.
pub const NOT_COUNTED: &str = "pan_of_filter";

/// Above this part of its volume a void holds more than any packing of particles would.
const ROOM: f64 = 0.6;

impl Outcome {
    /// Findings of its results: a target that was not reached, what the replicates leave open, what was
    /// trapped, and what water and voids came to.
    pub fn found(&self) -> Vec<Finding> {
        let trapped: u64 = self.replicates.iter().flat_map(|r| &r.runs).map(|r| r.trapped).sum();
        [
            self.stopping.as_ref().and_then(short_of),
            self.replicates_leave_open(),
            (trapped > 0).then(|| finding::trapped(trapped)),
            self.permeability(),
            self.overfull(),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// The sentence of a finding; `None` without it.
    pub fn sentence_of(&self, id: &str) -> Option<String> {
        self.findings.iter().find(|finding| finding.id == id).map(|finding| finding.sentence.clone())
    }

    /// What leaves a class open that the replicates do not separate, where nothing else says it.
    fn replicates_leave_open(&self) -> Option<Finding> {
        // A target error that was met says nothing of the class.
        let said = |stopping: &Stopping| stopping.short_of.is_some() || stopping.decide_percent.is_some();
        if self.stopping.as_ref().is_some_and(said) {
            return None;
        }
        match self.undecided_by()? {
            UndecidedBy::Curve => None,
            UndecidedBy::SecondRun => Some(finding::second_run_missing()),
            UndecidedBy::Replicates => Some(finding::replicates_leave_open()),
        }
    }

    /// How far the permeability fell, run by run: means over the replicates; `None` where no water flowed.
    fn permeability(&self) -> Option<Finding> {
        let falls: Vec<String> = (0..self.summary.len())
            .map(|run| Some(format!("{:.1} %", 100.0 * self.mean_of(run, |run| run.k_over_k0)?)))
            .collect::<Option<_>>()?;
        let clean = self.network.as_ref().and_then(|network| network.k0_m_per_s);
        let clean = clean.map_or(String::new(), |k| format!(" ({k:.1e} m/s for water of 10 °C)"));
        let of = if falls.len() > 1 { "first and second run" } else { "run" };
        (!falls.is_empty()).then(|| finding::permeability(of, &falls.join(" and "), &clean))
    }

    /// That a void holds more than it has room for; `None` where none does, or volumes are not known.
    fn overfull(&self) -> Option<Finding> {
        let runs = || self.replicates.iter().flat_map(|replicate| &replicate.runs);
        let share = 100.0 * runs().filter_map(|run| run.overfull_fraction).reduce(f64::max)?;
        let fullest = runs().filter_map(|run| run.fullness_max).reduce(f64::max);
        match fullest.filter(|&fullest| fullest > ROOM) {
            Some(fullest) => Some(finding::overfull(fullest, share)),
            None => (share > 0.0).then(|| finding::no_room(share)),
        }
    }

    /// Mean of a figure of one run over the replicates that have it.
    fn mean_of(&self, run: usize, of: impl Fn(&Run) -> Option<f64>) -> Option<f64> {
        let values: Vec<f64> = self.replicates.iter().filter_map(|r| of(r.runs.get(run)?)).collect();
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    }
}

pub fn curve_range(range: &CurveRange) -> Finding {
    let ends = range.eroded_mass_fraction.first().copied().unwrap_or([f64::NAN; 2]);
    let [low, high] = ends.map(|share| 100.0 * share);
    finding::curve_range(low, high)
}

/// What a reader must know of a filter of which this part was packed.
pub fn packed_part(part: &PackedPart) -> Finding {
    let PackedPart { percent, largest_mm, finer_by, sizes_missing_above, .. } = *part;
    let of_part = match (sizes_missing_above, percent >= FLOATING_PERCENT) {
        (_, false) => finding::loose_part_packed,
        (true, true) => finding::floating_part_packed,
        (false, true) => finding::part_packed,
    };
    of_part(percent, largest_mm, 100.0 * finer_by)
}

/// Why replicates do not reach what was asked for.
fn short_of(stopping: &Stopping) -> Option<Finding> {
    Some(match stopping.short_of? {
        ShortOf::SecondRun => finding::second_run_missing(),
        ShortOf::Decision { run, mean_percent, distance_pp, sd_pp, needed } => {
            let which = if run == 1 { "first" } else { "second" };
            let more = match needed {
                Some(n) => format!("About {n} replicates would decide, if the mean stayed where it is"),
                None => "No number of replicates will decide".into(),
            };
            let level = stopping.decide_percent.unwrap_or(0.0);
            finding::level_missed(level, which, &format!("{mean_percent:.3} %"), distance_pp, sd_pp, &more)
        }
        ShortOf::Target { half_width_pp, replicates, needed } => {
            let target = stopping.target_error_pp.unwrap_or(0.0);
            finding::target_missed(target, half_width_pp, replicates, needed)
        }
    })
}
