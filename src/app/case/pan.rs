//! The pan fraction of a base, the part finer than its finest sieve, if it may not be passive.
//!
//! If the finest sieve is no coarser than the finest constriction, a pan fraction is passive, and is counted
//! by mass only. If it is coarser, an unknown part of the fraction may block constrictions: all of it is then
//! walked as passive particles of the same mass, just finer than every constriction, or than every size that
//! arches in one. Particles that block nothing leave most, so of all sizes that the part may have these erode
//! most.

use crate::scene::Scene;
use voidwalk_core::gradation::{Gradation, GradationError};

/// Passive particles are walked this much finer than the finest size that is stopped, and with sizes that
/// span as much: a passive particle is never stopped by a constriction, so that its size matters to nothing
/// else.
const FINER: f64 = 0.99;

/// True if a pan fraction may hold particles that are not passive.
pub(super) fn may_block(base: &Gradation, finest_mm: f64) -> bool {
    base.pan_fraction() > 0.0 && base.smallest_mm() > finest_mm
}

/// The base with all of its pan fraction just finer than the finest size that a constriction stops.
pub(super) fn as_passive(
    base: &Gradation,
    finest_mm: f64,
    scene: &Scene,
) -> Result<Gradation, GradationError> {
    let mut points: Vec<_> = base.points().iter().map(|point| (point.size, point.percent)).collect();
    let passive = FINER * finest_mm / scene.law().map_or(1.0, |law| law.widest);
    points.splice(0..0, [(FINER * passive, 0.0), (passive, points[0].1)]);
    Gradation::from_points(&points, None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use voidwalk_core::gradation::SizeSampler;

    #[test]
    fn a_passive_pan_fraction_keeps_its_mass_and_is_finer_than_every_constriction() {
        let base = Gradation::from_lines(&[(0.075, 35.0), (0.5, 80.0), (2.0, 100.0)]).unwrap();
        assert!(!may_block(&base, 0.075) && may_block(&base, 0.0749));
        let passive = as_passive(&base, 0.04, &Scene::built_in(&[]).unwrap()).unwrap();
        assert_eq!(passive.pan_fraction(), 0.0);
        for percent in [36.0, 80.0, 99.0] {
            assert_eq!(passive.d(percent), base.d(percent));
        }
        for size in [0.075, 0.0399] {
            assert!((passive.percent_finer_by_mass(size) - 35.0).abs() < 1e-12, "{size}");
        }
        assert!(SizeSampler::new(&passive, 1.0).unwrap().smallest() > 0.039);
    }
}
