//! Practice as facts: what its rules say of two soils, what a specification asks for, and notes. No walk
//! decides what practice says. Sentences are made in `words`, except refusals of tables and the formulas
//! of a specification.
//!
//! - [`Decision`] is everything that practice decides of a pair, made once of its rules: `tested` has the
//!   class by the boundaries that Foster and Fell saw in tests, `rule_result` what a single rule found, and
//!   `listed` the rules in the rows of a table.
//! - `washout` is what is left of a filter that is not internally stable, `dispersion` what a dispersive
//!   base asks for.
//! - [`PlannedWalk`] has the notes on soils and network before their walk, `walks` those of walks themselves;
//!   [`ordered()`] brings notes into the order of their table.
//! - [`PairRules`] are two soils as practice sees them, `batch` many samples, a row each; [`BatchTable`]
//!   has their rows, and [`WalkedBatch`] these with their walks.
//! - [`RunFiles`] is the content of the files of a run folder, as values.
//! - [`SpecificationOptions`] are what a specification is asked for, whose steps are made here.

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
