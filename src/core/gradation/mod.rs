//! Gradations: the distribution of a soil's mass over particle sizes, and the number of its particles.
//!
//! - [`Gradation`] is a sieve curve, percent finer by mass, linear in percent against ln(size) between
//!   its points. "Linear" in the paper is one such straight line: `D_x = D_0 Cu^(x / 50)`, so
//!   `D_60 / D_10 = Cu` and `D_100 / D_0 = Cu^2`.
//! - [`SizeSampler`] draws diameters from it by number; [`base_particles`] is Eq. (2) of the paper.
//! - `stability` tells if a soil retains its own fines, `regrade` regrades a base by filter practice.
//!
//! # By mass and by number
//! Between two points of a curve the mass is spread evenly over ln(D), so the number of particles
//! per mm of diameter is proportional to `D^-4`, and the number finer than `D` is linear in `D^-3`.
//!
//! # The pan fraction
//! A finest row above 0 % leaves a pan fraction, finer than the finest sieve. With `d0_mm` it is one more
//! straight segment that ends at that size. Without it the pan fraction is treated as passive and counted
//! by mass only: number statistics cover the sized part, and [`Gradation::pan_fraction`] gives the rest.
//!
//! # Units
//! Sizes are diameters in mm. Only ratios of sizes enter a formula that rounds, so a factor of two on
//! every length does not change any ratio by a bit.

mod error;
mod group;
mod regrade;
mod sampler;
mod sieve;
mod stability;
mod supply;
mod table;

pub use error::{GradationError, NumberError, Position, TableError, letters, shortened};
pub use regrade::{BROAD_CU, FEW_FINES, GAP_PERCENT, Gap, RegradeCause, RegradeReason, Regraded};
pub(crate) use sampler::SizeGuide;
pub use sampler::{SizeRange, SizeSampler};
pub use sieve::{CurvePoint, End, FIELDS, FINES_MM, GRAVEL_MM, Gradation, Step, from_rows};
pub use sieve::{TIE, USUAL_STEP, WIDE_STEP};
pub use stability::{KEZDI_RANGE, ShapeIndex, SoilSplit, WIDE_LOOSE_PERCENT};
pub use supply::{BaseSupply, base_particles};
pub use table::{
    Comma, FILE_LIMIT_BYTES, Row, allowed_percent, allowed_size, bytes_of, comma, number, percent_is_allowed,
    size_is_allowed,
};
pub(crate) use table::{Direction, Table, check_size, rising};
