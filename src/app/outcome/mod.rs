//! Results of a walk: series, size curves, blocked by layer, and the verdict with its uncertainty.
//!
//! - [`record`] defines names and types of everything in a run folder, `packing` of a packing folder,
//!   [`number_rows`] of tables of numbers alone; `table` describes the tables of files and pages.
//! - `recorder` records a running walk, `metrics` gives the numbers of a run at its end, `statistic`
//!   those of several.
//! - [`verdict`] classifies replicates by eroded mass; `stopping` decides how many are needed,
//!   `early_stop` how many for a study.
//! - `left_out` lists what a scene does not need and what the model omits.
//! - `paper` gives results of the paper beside the walk.
//! - `percolation` and `boundary` hold results of studies, [`ledger`] those of a campaign.

pub(crate) mod boundary;
pub(crate) mod early_stop;
pub mod ledger;
pub(crate) mod left_out;
pub(crate) mod metrics;
pub mod number_rows;
pub(crate) mod packing;
pub(crate) mod paper;
pub(crate) mod percolation;
pub mod record;
pub(crate) mod recorder;
pub(crate) mod statistic;
pub(crate) mod stopping;
pub(crate) mod table;
pub mod verdict;

pub(crate) use left_out::{Modelled, leaves_out, leaves_out_of_all};
pub(crate) use metrics::Eroded;
pub use metrics::{Recorded, RunId, RunMetrics};
pub(crate) use paper::infiltration;
pub(crate) use record::BaseSize;
pub(crate) use recorder::Recorder;
pub use recorder::Wanted;
pub(crate) use statistic::Straight;
pub(crate) use voidwalk_core::gradation::CurvePoint;
