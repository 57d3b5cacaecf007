//! How coarse a filter may be: what `design.json` and `design.csv` hold, and how networks are put together.
//!
//! A boundary is the D15F/D85B from which a network erodes 7.5 % of the base: in the first run (no erosion
//! turns into some), or in the second as well (some turns into continuing). One packing a shape and density;
//! the filter is scaled, which repacks nothing.

pub(crate) mod products;
mod record;
pub mod retention;
mod row_note;
mod sieves;
pub mod size_band;
pub mod specification;
mod spread;

pub use record::{BETWEEN_STEPS, BaseStated, Boundary, Design, DesignRow, NetworkBoundaries, Range, WalkRow};
pub use row_note::RowNote;
pub use sieves::SieveSeries;
pub use specification::{Specification, SpecificationStep};
pub use spread::{Beyond, are_few, spread};
