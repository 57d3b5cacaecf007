//! The specification of a filter by practice: its record, the rules of retention behind it, and standard
//! products beside it.

pub mod products;
pub mod retention;
mod row_note;
mod sieves;
pub mod size_band;
pub mod specification;

pub use row_note::RowNote;
pub use sieves::SieveSeries;
pub use specification::{Specification, SpecificationStep};
