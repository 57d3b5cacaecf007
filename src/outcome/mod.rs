//! What came of a walk: series, size curves, blocked by layer, and the verdict with its uncertainty.
//!
//! - [`record`] holds the names and shapes of everything in a run folder, [`packing`] of a packing's.
//! - [`Recorder`] records of a running walk what was asked for.
//! - [`RunMetrics`] are the numbers of one run at its end.
//! - [`by_connectivity`] splits what a run retained by the connectivity of the voids (Table 3).
//! - [`by_void`] is what happened in each void and constriction, for pictures.
//! - [`verdict`] classifies, by mass eroded, one replicate or many; [`stopping`] says how many are enough,
//!   [`early_stop`] how many of a study.
//! - [`so_far`] is a look at the replicates of a run that is under way.
//! - [`paper`] holds what the paper states.
//! - [`rules`] applies the rules of filter practice to the same two curves.
//! - [`infiltration()`] is Eq. (1) beside the walk.
//! - [`network_walk`] is what comes of walks on given networks, without a scene.
//! - [`percolation`] fits percolation thresholds of several lattice sizes.
//! - [`undecided`] is what leaves a verdict open.
//! - [`precision`] is error against run time; [`comparison`] is several cases side by side.
//! - [`design`] is how coarse a filter may be, and the band of a specification.
//! - [`table`] describes the tables of files and pages, [`number_rows`] those of numbers alone, and
//!   [`numbers`] is how a page writes a number.

mod applied;
mod base_size;
pub mod by_connectivity;
pub mod by_void;
mod case_columns;
pub mod comparison;
mod curve_range;
pub mod design;
pub(crate) mod digits;
pub mod early_stop;
mod infiltration;
mod least_squares;
pub mod ledger;
mod metrics;
pub mod network_walk;
pub mod number_rows;
pub mod numbers;
pub mod packing;
mod pan;
pub mod paper;
pub mod percolation;
pub mod precision;
pub mod record;
mod recorder;
mod rule_note;
pub mod rules;
pub mod so_far;
mod statistic;
pub mod stopping;
pub(crate) mod student;
pub mod table;
pub mod undecided;
pub mod verdict;

pub use base_size::BaseSize;
pub(crate) use base_size::three;
pub use infiltration::infiltration;
pub(crate) use least_squares::log_log_slope;
pub(crate) use metrics::eroded_mass_fraction;
pub use metrics::{Eroded, Recorded, RunId, RunMetrics};
pub use recorder::{Recorder, Wanted};

use crate::network::ExitRule;

/// What the model does not contain, for any scene; shown next to every verdict.
pub const MODEL_LEAVES_OUT: [&str; 6] = [
    "hydraulics: no flow, no gradient, no time; an increment is not an interval of time",
    "bridging: a particle is stopped only by a constriction finer than itself",
    "partial clogging: a constriction is open at its full size or blocked",
    "a limit to what enters: all base particles of the scene are offered to the filter",
    "the excessive-erosion class of Foster and Fell: the verdict knows no, some and continuing erosion",
    "cohesion, suffusion of the filter itself, segregation and layering of the filter",
];

/// What stands in the place of the first where water gives particles their way.
const LEAVES_OUT_OF_FLOW: &str = "hydraulics but for the direction and the shares of slow flow: no gradient, \
    no time; an increment is not an interval of time";

/// What the model does not contain where particles choose by this rule.
pub fn leaves_out(rule: ExitRule) -> Vec<String> {
    let mut all = MODEL_LEAVES_OUT.map(String::from).to_vec();
    if rule.needs_flow() {
        all[0] = LEAVES_OUT_OF_FLOW.into();
    }
    all
}

/// What the model does not contain, the first words of each thing.
pub fn left_out_in_brief(items: &[String]) -> String {
    let first: Vec<&str> = items.iter().filter_map(|item| item.split(':').next()).collect();
    format!("The model leaves out: {}.", first.join("; "))
}

/// What the model does not contain in any of several cases, each with water that gives particles their way or
/// without.
pub fn leaves_out_of_all(with_flow: impl IntoIterator<Item = bool>) -> Vec<String> {
    let (with, without): (Vec<bool>, Vec<bool>) = with_flow.into_iter().partition(|with| *with);
    let mut all = leaves_out(if with.is_empty() { ExitRule::Area } else { ExitRule::Flux });
    if !with.is_empty() && !without.is_empty() {
        all[0] = LEAVES_OUT_OF_FLOW.replacen(':', ", where water gives particles their way:", 1);
        all.insert(0, MODEL_LEAVES_OUT[0].replacen(':', ", in the other cases:", 1));
        all.swap(0, 1);
    }
    all
}

impl record::Outcome {
    /// Whether water gave particles their way.
    pub fn is_with_flow(&self) -> bool {
        let with_flow =
            |exit: &str| ExitRule::ALL.iter().any(|rule| rule.name() == exit && rule.needs_flow());
        self.network.as_ref().is_some_and(|network| with_flow(&network.exit))
    }
}
