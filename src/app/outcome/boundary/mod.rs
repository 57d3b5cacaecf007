//! Boundaries of the model: the contents of `boundary.json` and `boundary.csv`, and the merging of networks.
//!
//! A boundary is the D15F/D85B from which a network erodes 7.5 % of the base: in the first run (no erosion
//! turns into some), or in the second as well (some turns into continuing). Each shape and density has one
//! packing; the filter is scaled, which needs no new packing.

mod record;
mod spread;

pub use record::{
    BETWEEN_STEPS, BaseStated, Boundaries, Boundary, BoundaryRow, NetworkBoundaries, Range, WalkRow,
};
pub use spread::{Beyond, are_few, spread};
