//! Boundaries of the model: what `boundary.json` and `boundary.csv` hold, and how networks are put together.
//!
//! A boundary is the D15F/D85B from which a network erodes 7.5 % of the base: in the first run (no erosion
//! turns into some), or in the second as well (some turns into continuing). One packing a shape and density;
//! the filter is scaled, which repacks nothing.

mod record;
mod spread;

pub use record::{
    BETWEEN_STEPS, BaseStated, Boundaries, Boundary, BoundaryRow, NetworkBoundaries, Range, WalkRow,
};
pub use spread::{Beyond, are_few, spread};
