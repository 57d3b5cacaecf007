//! The pan fraction of a base, what is finer than its finest sieve, of the sizes between which it lies.
//!
//! Where the finest sieve is no coarser than the finest constriction, a pan fraction is passive, and is
//! counted by mass only. Where it is coarser, some of it may block constrictions. The base is then walked
//! twice, with the same mass: once with a pan fraction that is passive, and once with all of it of the finest
//! sieve's size.

use crate::gradation::{Gradation, GradationError};
use crate::outcome::record::PanSize;

/// Passive particles are walked this much finer than the finest constriction, and of sizes that span as
/// much: what is passive is never stopped by a constriction, so that its size matters to nothing else.
const FINER: f64 = 0.99;

/// Particles of the finest sieve's size are walked from this much finer on: a sieve curve cannot be upright.
const NEARLY: f64 = 0.999;

/// Whether a pan fraction need not be passive.
pub(super) fn may_block(base: &Gradation, finest_mm: f64) -> bool {
    base.pan_fraction() > 0.0 && base.smallest_mm() > finest_mm
}

/// The base with its pan fraction of a size.
pub(super) fn taken_as(base: &Gradation, size: PanSize, finest_mm: f64) -> Result<Gradation, GradationError> {
    let mut points = base.points();
    let (sieve, percent) = points[0];
    match size {
        PanSize::Passive => {
            let passive = FINER * finest_mm;
            points.splice(0..0, [(FINER * passive, 0.0), (passive, percent)]);
        }
        PanSize::FinestSieve => points.insert(0, (NEARLY * sieve, 0.0)),
    }
    Gradation::from_points(&points, None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::SizeSampler;

    #[test]
    fn both_readings_keep_the_mass_and_lie_where_they_must() {
        let base = Gradation::from_points(&[(0.075, 35.0), (0.5, 80.0), (2.0, 100.0)], None).unwrap();
        assert!(!may_block(&base, 0.075) && may_block(&base, 0.0749));
        let fine = taken_as(&base, PanSize::Passive, 0.04).unwrap();
        let coarse = taken_as(&base, PanSize::FinestSieve, 0.04).unwrap();
        for reading in [&fine, &coarse] {
            assert_eq!(reading.pan_fraction(), 0.0);
            for percent in [36.0, 80.0, 99.0] {
                assert_eq!(reading.d(percent), base.d(percent));
            }
            assert!((reading.percent_finer_by_mass(0.075) - 35.0).abs() < 1e-12);
        }
        assert!((fine.percent_finer_by_mass(0.0399) - 35.0).abs() < 1e-12);
        assert!(SizeSampler::new(&fine, 1.0).unwrap().smallest() > 0.039);
        assert_eq!(coarse.percent_finer_by_mass(0.074), 0.0);
    }
}
