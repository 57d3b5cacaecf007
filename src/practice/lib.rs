//! Filter practice: its rules for a base and a filter, and the specification of a filter for a base.
//!
//! No result here depends on a walk.
//!
//! ```
//! use voidwalk_core::Gradation;
//! use voidwalk_practice::{PairRules, PracticeClass};
//!
//! let base = Gradation::from_lines(&[(0.2, 0.0), (0.6, 100.0)])?;
//! let filter = Gradation::from_lines(&[(0.9, 0.0), (1.0, 15.0), (2.0, 100.0)])?;
//! let pair = PairRules::of(&base, &filter);
//! for rule in pair.rules.iter().filter(|rule| rule.applies) {
//!     println!("{}: {:?}, limit {:?} ({})", rule.id, rule.value, rule.limit, rule.source);
//! }
//! assert_eq!(pair.practice.unwrap().class, PracticeClass::Meets);
//! # Ok::<(), voidwalk_core::gradation::GradationError>(())
//! ```
//!
//! - [`rules`]: each rule with its limit, the soils that it was made for, and its source.
//! - [`Decision`]: decision of practice on a pair; [`PairRules`]: two soils; [`batch`]: many samples.
//! - [`design`]: the specification of a filter, step by step, with standard products.
//! - [`retention`]: limits of D15F, also for the remainder of an unstable filter; [`dispersion`].
//! - [`note`]: notes, as names and numbers; [`quantity`]: numbers as text; [`page`]: author and soils as
//!   shown on every page.

mod applied;
pub mod batch;
pub mod decision;
pub mod design;
pub mod dispersion;
pub mod note;
pub mod page;
mod pair;
pub mod quantity;
#[cfg(test)]
mod random_soils;
pub mod retention;
pub mod rule_result;
pub mod rules;
#[cfg(test)]
mod test_soils;

pub use applied::{AppliedRule, RuleNote, RuleQuantity, RuleRole, RuleUnit, ValueBound, WithoutFiner};
pub use batch::{BatchFilter, BatchRow, BatchTable, DesignedSample, DesignedSamples};
pub use decision::{Decision, Headline, Practice, PracticeClass, TestedClass};
pub use design::{SpecificationOptions, least_of_band, no_band_between};
pub use dispersion::{DispersiveLack, IfDispersive};
pub use note::{Note, ordered};
pub use page::{AboutPage, InputFile, SheetCover};
pub use pair::{BaseSizes, FilterSizes, Mistake, MistakeKind, PairOptions, PairRules, Refusal};
