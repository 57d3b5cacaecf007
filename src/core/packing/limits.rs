//! Masses, the contact law and the critical time step in reduced units.

use super::contact::Law;
use super::settings::{Contact, Settings};
use crate::gradation::Gradation;
use std::f64::consts::PI;

/// Mass of a grain in reduced units.
pub(super) fn mass(radius: f64, exponent: f64) -> f64 {
    let d = 2.0 * radius;
    let cube = PI / 6.0 * d * d * d;
    if exponent == 0.0 {
        cube
    } else if exponent == 1.0 {
        cube / d
    } else {
        cube / libm::pow(d, exponent)
    }
}

/// The contact law in reduced units, with this friction.
pub(super) fn law(settings: &Settings, friction: f64) -> Law {
    let nu = settings.poisson_ratio;
    let shear = settings.shear_modulus_gpa * settings.stiffness_ratio * 1e6 / settings.pressure_kpa;
    let log = libm::log(settings.restitution);
    let ratio = -log / (PI * PI + log * log).sqrt();
    let (hertz, stiffness, factor) = match settings.contact {
        Contact::Hertz => (true, 2.0 * shear / (1.0 - nu), 2.0 * (5.0f64 / 6.0).sqrt()),
        Contact::Linear(stiffness) => (false, stiffness, 2.0),
    };
    Law {
        hertz,
        stiffness,
        tangential: 2.0 * (1.0 - nu) / (2.0 - nu),
        damping: factor * ratio,
        friction,
        clip: settings.clip_tension,
    }
}

/// Upper bound of `(angular frequency)^2` by the largest sum of normal contact stiffness by mass: a contact
/// of stiffness `kn` between two free grains has the modes `2 kn / m` and, with friction, `7 kt / m` (sliding
/// and rolling together); the sum over the contacts of a grain bounds the whole network (each contact's
/// energy is at most that of its two grains moved alone, twice).
pub(super) fn stability(law: &Law) -> f64 {
    if law.friction > 0.0 { (7.0 * law.tangential).max(2.0) } else { 2.0 }
}

/// Part of the critical step that damping leaves. The damping force takes the velocity of the last half step,
/// so an oscillator of damping ratio `z` is stable up to `sqrt(1 + z^2) - z` of its undamped limit. A grain
/// between several contacts has a higher ratio than a pair, and the critical step is below the true limit;
/// 0.9 of the damping coefficient covers both. Checked by packings: at restitution 0.2 this is 0.50, and 0.5
/// settles where 0.6 and 0.7 of the critical step never do.
pub(super) fn damped_part(law: &Law) -> f64 {
    let z = 0.9 * law.damping;
    (1.0 + z * z).sqrt() - z
}

/// The critical time step before there are contacts, and what sets it: the Rayleigh wave across the smallest
/// grain by mass; the period of a Hertz contact under the target pressure; a grain with six such contacts.
pub(super) fn critical_step(
    position: &[[f64; 4]],
    velocity: &[[f64; 4]],
    settings: &Settings,
) -> (f64, &'static str) {
    let law = law(settings, settings.friction.max(settings.final_friction));
    let shear = settings.shear_modulus_gpa * settings.stiffness_ratio * 1e6 / settings.pressure_kpa;
    let mut least = (f64::INFINITY, "");
    for (p, v) in position.iter().zip(velocity) {
        let (radius, mass) = (p[3], v[3]);
        let kn = if law.hertz {
            // Force p D^2 on a contact of two such grains.
            let force = 4.0 * radius * radius;
            let root = (0.5 * radius).sqrt();
            let overlap =
                libm::cbrt((1.5 * force / (law.stiffness * root)) * (1.5 * force / (law.stiffness * root)));
            let density = mass / (4.0 / 3.0 * PI * radius * radius * radius);
            let rayleigh =
                PI * radius * (density / shear).sqrt() / (0.1631 * settings.poisson_ratio + 0.8766);
            if rayleigh < least.0 {
                least = (rayleigh, "the Rayleigh wave across a grain");
            }
            law.stiffness * root * overlap.sqrt()
        } else {
            law.stiffness
        };
        let contact = PI / (2.0 * kn / mass).sqrt();
        if contact < least.0 {
            least = (contact, "the duration of a contact");
        }
        let crowded = 2.0 / (stability(&law) * 6.0 * kn / mass).sqrt();
        if crowded < least.0 {
            least = (crowded, "a grain with six contacts");
        }
    }
    least
}

/// Ratio of the largest to the smallest grain from which the most crowded grains are moved as heavier ones.
pub(super) const WIDE: f64 = 20.0;

/// Critical step of a heavier grain, by the critical step before there are contacts.
const HEAVIER_STEP: f64 = 1.5;

/// Tells if sizes differ so much that a few small grains pressed between large ones would set the step of a
/// compression, so that such grains are moved as heavier ones.
pub fn is_wide(gradation: &Gradation) -> bool {
    gradation.largest_mm() / gradation.smallest_mm() >= WIDE
}

/// Least mass of a grain in a step by the sum of its contacts' stiffness, so that its critical step is
/// [`HEAVIER_STEP`] times `loose_step`, the critical step before there are contacts.
pub(super) fn heavier_mass_by_stiffness(law: &Law, loose_step: f64) -> f64 {
    let step = HEAVIER_STEP * loose_step;
    0.25 * stability(law) * step * step
}
