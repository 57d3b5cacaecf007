//! Constrictions: the narrowest openings between the voids of a filter, and their sizes by number.
//!
//! ```text
//! Packing -> Triangulation -> voids, discs -> Constrictions -> Curve
//! ```
//! [`inscribed()`] guesses a curve from the gradation alone.

mod curve;
mod discs;
mod graph;
mod inscribed;
mod measure;
mod shipped;
mod summary;
mod tangent;
mod throat;
mod triangulation;
mod voids;

pub use curve::{Curve, CurveError, CurveUnit};
pub use graph::VoidGraph;
pub use inscribed::inscribed;
pub use measure::{Constrictions, ConstrictionsError, DEFAULT_MERGE_OVERLAP, Facets};
pub use shipped::{ShippedFilter, find, shipped};
pub use summary::{SUMMARY_PERCENT, Summary};
pub use triangulation::{SanityError, Triangulation, TriangulationError};

#[cfg(test)]
mod lattice_tests;
