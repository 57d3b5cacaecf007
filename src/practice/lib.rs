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
//! - [`Decision`]: the decision of practice on a pair; [`PairRules`]: two soils; [`batch`]: many samples.
//! - [`design`]: the specification of a filter, step by step, with standard products.
//! - [`washout`]: the remainder of a filter that is not internally stable; [`dispersion`]: dispersive bases.
//! - [`note`]: notes, as names and numbers; [`quantity`]: the way from a number to text.

mod answer;
mod applied;
pub mod base_cautions;
pub mod batch;
mod batch_table;
mod cover;
pub mod decision;
pub mod design;
mod designed_samples;
pub mod dispersion;
#[cfg(test)]
mod fewer_sieves;
mod input_file;
mod listed;
mod mistake;
pub mod note;
mod note_order;
mod pair;
pub mod quantity;
mod rule_note;
pub mod rule_result;
pub mod rules;
pub mod soil_sizes;
mod specification;
#[cfg(test)]
mod test_soils;
mod tested;
pub mod washout;
#[cfg(test)]
mod worse_soils;

pub use answer::{DispersiveLack, Headline, IfDispersive, Practice, PracticeClass, TestedClass};
pub use applied::{AppliedRule, RuleQuantity, RuleRole, RuleUnit, ValueBound, WithoutFiner};
pub use batch::BatchRow;
pub use batch_table::{BatchFilter, BatchTable};
pub use cover::{AboutPage, SheetCover};
pub use decision::Decision;
pub use designed_samples::{DesignedSample, DesignedSamples};
pub use input_file::InputFile;
pub use mistake::{Mistake, MistakeKind};
pub use note::Note;
pub use note_order::ordered;
pub use pair::{BaseSizes, FilterSizes, PairOptions, PairRules};
pub use rule_note::{RuleNote, d15f_between};
pub use specification::{SpecificationOptions, least_of_band, no_band_between};
