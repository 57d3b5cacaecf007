//! A case's answer as facts: practice beside the walks, each with its notes. No walk changes the answer of
//! practice.
//!
//! - [`PlannedWalk`] has the notes on soils and network before their walk, `walks` and `beside` the notes on
//!   walks themselves.
//! - [`WalkedBatch`] is a table of many samples with their walks.
//! - [`RunFiles`] is the content of the files of a run folder, as values.
//! - [`counts_as()`] is the class as which practice counts where a command accepts verdicts.

pub(crate) mod beside;
mod planned_walk;
mod run_files;
mod severity;
mod walked_batch;
pub(crate) mod walks;

pub use planned_walk::PlannedWalk;
pub use run_files::RunFiles;
pub use severity::counts_as;
pub use walked_batch::{SampleWalk, WalkedBatch, WalkedRow};
