//! How coarse a filter may be: what `design.json` and `design.csv` hold, and how networks are put together.
//!
//! A boundary is the D15F/D85B from which a network erodes 7.5 % of the base: in the first run (no erosion
//! turns into some), or in the second as well (some turns into continuing). One packing a shape and density;
//! the filter is scaled, which repacks nothing.

pub mod band;
mod finding;
pub(crate) mod products;
mod record;
mod sieves;
mod size_band;
pub mod specification;
mod spread;

pub use finding::DesignFinding;
pub use record::{
    BETWEEN_STEPS, BaseStated, Boundary, Design, DesignAnswer, DesignRow, NetworkBoundaries, Range, WalkRow,
};
pub use sieves::SieveSeries;
pub use specification::{Specification, SpecificationStep};
pub use spread::{Beyond, drawn_of_networks, over_networks, share_of_networks, spread};
