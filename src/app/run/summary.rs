//! Summary of the replicates of a case.

use super::replicates::ReplicateResult;
use crate::outcome::record::{Classed, RunSummary, Statistic, Verdict};
use crate::outcome::verdict::{below_by_interval, classify};

/// The verdict that the replicates support together, and their statistics by run.
pub fn summarise(walked: &[ReplicateResult]) -> (Verdict, Vec<RunSummary>) {
    let runs = walked.first().map_or(0, |w| w.replicate.runs.len());
    let summaries: Vec<RunSummary> = (0..runs).map(|run| run_summary(walked, run)).collect();
    let below = |run: usize| {
        let summary = summaries.get(run)?;
        let below_by_replicate: Vec<bool> = walked.iter().map(|w| w.below[run]).collect();
        below_by_interval(&summary.eroded_mass_fraction, &below_by_replicate)
    };
    (classify(below(0), below(1)), summaries)
}

/// Class and statistics of the replicates, as a point of a study holds them.
pub fn classed(walked: &[ReplicateResult]) -> Classed {
    let (verdict, summaries) = summarise(walked);
    let runs = summaries.iter().map(|run| run.eroded_mass_fraction).collect();
    Classed { replicates: walked.len() as u64, stopped_when_clear: false, verdict, runs }
}

fn run_summary(walked: &[ReplicateResult], run: usize) -> RunSummary {
    let statistic = |figure: fn(&crate::outcome::record::Run) -> f64| {
        let values: Vec<f64> = walked.iter().map(|w| figure(&w.replicate.runs[run])).collect();
        Statistic::of_fraction(&values)
    };
    let largest: Vec<f64> =
        walked.iter().filter_map(|w| w.replicate.runs[run].largest_eroded_over_d15f).collect();
    RunSummary {
        run: run as u64 + 1,
        eroded_mass_fraction: statistic(|r| r.eroded_mass_fraction),
        eroded_number_fraction: statistic(|r| r.eroded_number_fraction),
        largest_eroded_over_d15f: (!largest.is_empty()).then(|| Statistic::of(&largest)),
        blocked_fraction: statistic(|r| r.blocked_fraction),
        blocked_first_three_layers_fraction: statistic(|r| r.blocked_first_three_layers_fraction),
        backbone_fraction: statistic(|r| r.backbone_fraction),
    }
}
