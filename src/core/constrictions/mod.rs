//! Constrictions: the narrowest openings between the voids of a filter, and their sizes by number.
//!
//! ```text
//! Packing -> Triangulation -> voids, discs -> Constrictions -> Curve
//! ```
//! [`from_library()`] finds a curve from packings made earlier, and [`inscribed()`] estimates one from the
//! gradation alone.

mod curve;
mod discs;
mod frame;
mod graph;
mod inscribed;
mod library;
mod measure;
mod possible;
mod shipped;
mod summary;
mod tangent;
mod throat;
mod triangulation;
mod twice;
mod voids;

pub use curve::{Curve, CurveError, CurveUnit};
pub use graph::VoidGraph;
pub use inscribed::inscribed;
pub use library::{FromLibrary, from_library};
pub use measure::{Constrictions, ConstrictionsError, DEFAULT_MERGE_OVERLAP, Facets};
pub use shipped::{ShippedFilter, find, shipped};
pub use summary::{SUMMARY_PERCENT, Summary};
pub use triangulation::{SanityError, Triangulation, TriangulationError};

#[cfg(test)]
mod lattice_tests;
