//! Results of a walk: series, size curves, blocked by layer, and the verdict with its uncertainty.
//!
//! - [`record`] holds the names and shapes of everything in a run folder, [`packing`] those of a packing
//!   folder.
//! - [`Recorder`] records the requested data of a running walk.
//! - [`RunMetrics`] are the numbers of one run at its end.
//! - [`by_connectivity`] splits the retained particles of a run by the connectivity of the voids (Table 3).
//! - `by_void` holds the events in each void and constriction, for pictures.
//! - [`verdict`] classifies one replicate or many by mass eroded; [`stopping`] decides how many are enough,
//!   `early_stop` how many of a study.
//! - [`leaves_out`] lists the features that the model omits.
//! - [`so_far`] looks at the replicates of a run that is under way.
//! - [`digest`] reduces all numbers of a record to one, by which two runs are compared.
//! - `paper` holds the numbers that the paper states.
//! - [`infiltration()`] sets Eq. (1) beside the walk.
//! - [`network_walk`] holds the results of walks on given networks, without a scene.
//! - [`percolation`] fits percolation thresholds of several lattice sizes.
//! - [`undecided`] names the cause that leaves a verdict open.
//! - [`boundary`] holds the boundaries of the model.
//! - [`table`] describes the tables of files and pages, [`number_rows`] the tables of numbers alone.

mod base_size;
pub mod boundary;
pub mod by_connectivity;
pub(crate) mod by_void;
mod curve_range;
pub mod digest;
pub(crate) mod early_stop;
mod infiltration;
mod least_squares;
pub mod ledger;
pub mod left_out;
mod metrics;
mod model_limit;
pub mod network_walk;
pub mod number_rows;
pub mod packing;
pub(crate) mod paper;
pub mod percolation;
pub mod record;
mod recorder;
pub mod so_far;
pub mod statistic;
pub mod stopping;
pub(crate) mod student;
pub mod table;
pub mod undecided;
pub mod verdict;

pub use base_size::BaseSize;
pub use infiltration::infiltration;
pub(crate) use least_squares::Straight;
pub use metrics::{Eroded, Recorded, RunId, RunMetrics};
pub use model_limit::{Modelled, leaves_out, leaves_out_of_all};
pub use recorder::{Recorder, Wanted};
pub use voidwalk_core::gradation::CurvePoint;

use voidwalk_core::network::ExitRule;
use voidwalk_practice::{Decision, Note};

impl record::Outcome {
    /// True if water directed the particles.
    pub fn is_with_flow(&self) -> bool {
        let with_flow =
            |exit: &str| ExitRule::ALL.iter().any(|rule| rule.name() == exit && rule.needs_flow());
        self.network.as_ref().is_some_and(|network| with_flow(&network.exit))
    }

    /// The decision of practice on its pair: without an answer if the record has none.
    pub fn decision(&self) -> Decision {
        let mut decision = Decision::new(&self.rules, self.if_dispersive, Some(self.inputs.filter.d15_mm));
        decision.headline = self.headline.and(decision.headline);
        decision
    }

    /// Features that its walk contained.
    pub fn modelled(&self) -> Modelled {
        Modelled {
            flow: self.is_with_flow(),
            arches: self.arching.is_some(),
            openings: self.notes.contains(&Note::Openings {}),
        }
    }
}
