//! What practice says of a pair, what a reader must know besides, and all sentences about it.
//!
//! - `finding` is the table of all findings: topic, label, sentence and page of each, and a function of its
//!   name that reports it. A translation is another table of sentences.
//! - [`ordered()`] brings what was found into the order of the table.
//! - [`PlannedWalk`] is what is found about soils and network before their walk.
//! - `practice` is what the rules of filter practice say of a pair, `practice_words` its line, `tested` its
//!   class by the boundaries that Foster and Fell saw in tests, and `rule_words` what a single rule found.
//! - `washout` is whether a filter that is not internally stable retains its base without its finer part.
//! - `listed` has the rules in the rows of a table.
//! - `dispersion` is what is said of a base of which nobody has said whether it is dispersive.
//! - `left_out` has the words of what the model does not contain and of what a scene does not need.
//! - `rule_notes` has the words of what those rules say beside their results.
//! - `walks` is what walks say themselves, `beside` what their results say beside the verdict.
//! - [`DesignedSamples`] are many samples with how coarse a filter may be for each.
//! - [`design_answer()`] is how coarse a filter may be, and [`Band`] the band of a specification; `fitting`
//!   is which standard products are said to fit, and `base_cautions` what is said of the base itself.
//! - [`SpecificationOptions`] are what a specification is asked for, whose steps are made and worded here.
//! - [`PairRules`] are two soils as practice sees them, without a walk.
//! - `batch` is what practice says of many samples, a row each; [`BatchTable`] reads them from their files,
//!   and [`WalkedBatch`] is them with what their walks say.
//! - `conclusion` has what every face says first: the lines of practice and of the model; `next` has what to
//!   do.
//! - `words` are what a class means.

mod answer;
mod band;
mod base_cautions;
pub(crate) mod batch;
pub(crate) mod batch_counts;
mod batch_table;
mod batch_words;
pub(crate) mod beside;
mod conclusion;
mod design;
mod designed_samples;
mod designed_words;
pub(crate) mod dispersion;
mod entry;
#[cfg(test)]
mod fewer_sieves;
pub(crate) mod finding;
pub(crate) mod fitting;
pub(crate) mod left_out;
pub(crate) mod listed;
mod mistake;
mod next;
mod pair;
mod planned_walk;
pub(crate) mod practice;
pub(crate) mod practice_words;
mod quantity;
mod rule_notes;
pub(crate) mod rule_words;
mod specification;
pub(crate) mod tested;
mod walked_batch;
pub(crate) mod walks;
mod washout;
pub(crate) mod words;
#[cfg(test)]
mod worse_soils;

#[cfg(doc)]
use crate::outcome::design::band::Band;

pub use answer::{ordered, rank};
pub use batch::BatchRow;
pub use batch_table::{BatchFilter, BatchTable};
pub use conclusion::FOREMOST;
pub use design::{FinestBase, design_answer};
pub use designed_samples::{DesignedSample, DesignedSamples, DesignedWalks, SampleDesign};
pub use entry::{Entry, Finding};
pub use mistake::{Mistake, MistakeKind};
pub use pair::{BaseSizes, FilterSizes, PairOptions, PairRules};
pub use planned_walk::PlannedWalk;
pub use practice::counts_as;
pub use quantity::FindingValue;
pub use specification::{DESIGN_AGAIN, DESIGN_EACH_AGAIN, SpecificationOptions};
pub use walked_batch::{SampleWalk, WalkedBatch, WalkedRow};
