//! Practice as facts: the results of its rules for two soils, the requirements of a specification, and notes.
//! No walk changes the answer of practice. Sentences are made in `words`, except refusals of tables and the
//! formulas of a specification.
//!
//! - [`Decision`] is the whole decision of practice on a pair, made once from its rules: `tested` has the
//!   class by the boundaries that Foster and Fell saw in tests, `rule_result` the result of a single rule,
//!   and `listed` the rules in the rows of a table.
//! - `washout` describes the rest of a filter that is not internally stable, `dispersion` the requirements of
//!   a dispersive base.
//! - [`PlannedWalk`] has the notes on soils and network before their walk, `walks` the notes on walks
//!   themselves; [`ordered()`] brings notes into the order of their table.
//! - [`PairRules`] are two soils as practice sees them, `batch` many samples, one row each; [`BatchTable`]
//!   has their rows, and [`WalkedBatch`] adds their walks.
//! - [`RunFiles`] is the content of the files of a run folder, as values.
//! - [`SpecificationOptions`] are the requests to a specification, whose steps are made here.

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
