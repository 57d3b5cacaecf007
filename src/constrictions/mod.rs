//! Constrictions: the narrowest openings between the voids of a filter, and their sizes by number.

mod curve;
mod shipped;

pub use curve::{Curve, CurveError, CurveUnit};
pub use shipped::{ShippedFilter, find, shipped};
