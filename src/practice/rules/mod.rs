//! The rules of filter practice, applied to the same two curves and shown beside the verdict.
//!
//! One rule is one entry of [`RULES`]: its purpose, its soils, its limit and its source. A rule that lacks an
//! input names it; a rule that was not made for these soils has no result.

mod all;
mod apply;
mod base;
mod drainage;
mod exit;
mod judging;
mod open;
mod retention;
mod rule;
mod stability;
mod walk;

pub use all::{
    CONSTRICTED_EXIT, DESIGN, FILTER_FINES, FILTER_GREATEST_SIZE, KENNEY_LAU, KEZDI, LI_FANNIN,
    PAPER_CONTINUING, PAPER_NO_EROSION, PERMEABILITY, PERMEABILITY_LEAST, RULES, TERZAGHI, TESTS_CONTINUING,
    TESTS_NO_EROSION,
};
pub use apply::authority_in_brief;
pub use apply::{NamedCurve, apply, apply_and_decide, apply_to_envelopes, authority};
pub use base::BaseSoil;
pub use drainage::{GREATEST_SIZE_MM, LEAST_D15F_MM, MOST_CU, MOST_FINES_PERCENT, WIDEST_BAND};
pub(crate) use open::{OpenBase, sieved_limit};
pub use retention::{DESIGN_FLOOR_MM, range_of_tests, tested_range};
pub use rule::{FilterRule, Fines, Judged, Pairing, RuleInputs, SizeBound};

#[cfg(test)]
mod bounds;
#[cfg(test)]
mod tests;
