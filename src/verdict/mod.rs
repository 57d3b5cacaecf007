//! What an answer is worth: findings about a verdict, the label that they set, and all sentences about it.
//!
//! - [`finding`] is the table of all findings: direction, weight, label, sentence and page of each, and a
//!   function of its name that reports it. A translation is another table of sentences.
//! - [`judge()`] takes class, rules and findings, and gives the answer with its label and ordered findings.
//! - [`practice`] is what the rules of filter practice say of a pair.
//! - [`walks`] is what walks say themselves, [`beside`] what their results say beside the verdict.
//! - [`PairRules`] are two soils as practice sees them, without a walk.
//! - [`words`] are what a class means, and the headline.

mod answer;
pub mod beside;
mod entry;
mod evidence;
pub mod finding;
mod pair;
pub mod practice;
mod quantity;
mod thickness;
pub mod walks;
pub mod words;

pub use answer::{Judgement, judge, rank};
pub use entry::{Entry, Finding};
pub use pair::{BaseSizes, FilterSizes, Mistake, MistakeKind, PairOptions, PairRules};
pub use quantity::FindingValue;
