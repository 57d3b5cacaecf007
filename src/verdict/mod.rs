//! What an answer is worth: findings about a verdict, the label that they set, and all sentences about it.
//!
//! - `finding` is the table of all findings: direction, weight, label, sentence and page of each, and a
//!   function of its name that reports it. A translation is another table of sentences.
//! - [`judge()`] takes class, rules and findings, and gives the answer with its label and ordered findings.
//! - [`PlannedWalk`] is what is found about soils and network before their walk.
//! - `practice` is what the rules of filter practice say of a pair, `practice_words` its line, `tested` its
//!   class by the boundaries that Foster and Fell saw in tests, and `rule_words` what a single rule found.
//! - `washout` is whether a filter that is not internally stable retains its base without its finer part.
//! - `by_authority` is what a sheet says that lists the rules of one authority.
//! - `evidence` is what soils of the base's kind say of a walk, `evidence_groups` those soils,
//!   `probability` has its probabilities in words.
//! - `dispersion` is what is said of a base of which nobody has said whether it is dispersive.
//! - `left_out` has the words of what the model does not contain and of what a scene does not need.
//! - `rule_notes` has the words of what those rules say beside their results.
//! - `amount` and `thickness` are how a verdict moves with them, `study_points` the classes of such walks.
//! - `walks` is what walks say themselves, `beside` what their results say beside the verdict.
//! - [`DesignedSamples`] are many samples with how coarse a filter may be for each.
//! - [`design_answer()`] is how coarse a filter may be, and [`Band`] the band of a specification; `fitting`
//!   is which standard products are said to fit, and `base_cautions` what is said of the base itself.
//! - [`SpecificationOptions`] are what a specification is asked for, whose steps are made and worded here.
//! - [`PairRules`] are two soils as practice sees them, without a walk.
//! - `batch` is what practice says of many samples, a row each; [`BatchTable`] reads them from their files,
//!   and [`WalkedBatch`] is them with what their walks say.
//! - `conclusion` has what every face says first: headline, line of practice, line of the walk; `next` has
//!   what to do, `reasons` why a pair lies outside what the model was checked against.
//! - `words` are what a class means.

mod amount;
mod answer;
mod band;
mod base_cautions;
pub(crate) mod batch;
pub(crate) mod batch_counts;
mod batch_table;
mod batch_words;
pub(crate) mod beside;
pub(crate) mod by_authority;
mod conclusion;
mod design;
mod designed_samples;
mod designed_words;
pub(crate) mod dispersion;
mod entry;
pub(crate) mod evidence;
mod evidence_groups;
#[cfg(test)]
mod fewer_sieves;
pub(crate) mod finding;
pub(crate) mod fitting;
pub(crate) mod left_out;
mod mistake;
mod next;
mod pair;
mod planned_walk;
pub(crate) mod practice;
pub(crate) mod practice_words;
mod probability;
mod quantity;
mod reasons;
mod rule_notes;
pub(crate) mod rule_words;
mod specification;
mod study_points;
pub(crate) mod tested;
pub(crate) mod thickness;
mod walked_batch;
pub(crate) mod walks;
mod washout;
pub(crate) mod words;
#[cfg(test)]
mod worse_soils;

#[cfg(doc)]
use crate::outcome::design::band::Band;

pub use answer::{Judgement, judge, rank};
pub use batch::BatchRow;
pub use batch_table::{BatchFilter, BatchTable};
pub use conclusion::FOREMOST;
pub use design::{FinestBase, design_answer};
pub use designed_samples::{DesignedSample, DesignedSamples, DesignedWalks, SampleDesign};
pub use entry::{Entry, Finding};
pub use mistake::{Mistake, MistakeKind};
pub use pair::{BaseSizes, FilterSizes, PairOptions, PairRules, StatedByAuthority};
pub use planned_walk::PlannedWalk;
pub use practice::counts_as;
pub use quantity::FindingValue;
pub use specification::{DESIGN_AGAIN, DESIGN_EACH_AGAIN, SpecificationOptions};
pub use walked_batch::{SampleWalk, WalkedBatch, WalkedRow};
