//! Settings of a compression, their defaults and errors; masses, contact law and critical step.

use super::contact::Law;
use super::neighbours::Reach;
use crate::gradation::Gradation;
use crate::schema::{Allowed, OutOfRange, only, section, whole};
use std::f64::consts::PI;

/// Normal force of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Contact {
    /// Hertz-Mindlin, with the shear modulus and Poisson's ratio of the settings.
    Hertz,
    /// A linear spring, for comparison: stiffness in units of pressure times smallest diameter.
    Linear(f64),
}

section! {
    /// Compression of the grains; the defaults suit nearly every filter.
    ///
    /// The defaults are those of the paper if it gives them. The others come from the study in
    /// `results/packing.md` (`scripts/studies/study_packing.py`): half the rates, other masses, half the
    /// time step, twice the hold, and more or fewer grains change the void ratio by no more than 0.003,
    /// about as much as other seeds (standard deviation 0.0035 loose and 0.0016 dense for 4,000 grains,
    /// 0.0011 and 0.0005 for 15,000).
    ///
    /// A loose packing depends on its start: a packing fraction of 0.45 at the start makes it 0.014
    /// denser, 0.2 makes it 0.005 looser, three times the drag 0.006 looser. Take void ratios of loose
    /// packings as uncertain by 0.01; none of this changes constriction curves by 1 % or more.
    ///
    /// `stiffness_ratio`: with the default of 0.1, packings with friction keep their void ratio within
    /// 0.003, but packings without friction become 0.003 to 0.008 denser than at the full stiffness,
    /// which gives the paper's values within 0.002 (Cu 1.2 to 3) in two and a half times the time:
    /// `stiffness_ratio: 1.0, hold_steps: 8000`. The default is 0.1 because all six filters of the
    /// paper, up to 60,000 grains of Cu 6, were settled with it.
    pub struct Settings in "packing" {
        /// Seed of sizes and start positions.
        pub seed: u64 = 1, off, whole(0..=u64::MAX);
        /// Friction set once the pressure holds; the packing then settles again.
        pub final_friction: f64 = 0.3, off, friction();
        /// Mean pressure (kPa).
        pub pressure_kpa: f64 = 50.0, off, positive();
        /// Shear modulus of the grains (GPa).
        pub shear_modulus_gpa: f64 = 27.0, off, positive();
        /// Poisson's ratio of the grains.
        pub poisson_ratio: f64 = 0.3, off, only("0 to 0.5", |v| (0.0..=0.5).contains(v));
        /// Factor on the shear modulus; below 1 trades stiffness for time.
        pub stiffness_ratio: f64 = 0.1, off, positive();
        /// Density of the grains (kg/m3): only the reported time depends on it.
        pub density_kg_m3: f64 = 2670.0, off, positive();
        /// Coefficient of restitution, at every speed.
        pub restitution: f64 = 0.5, off, only("more than 0, at most 1", |v| *v > 0.0 && *v <= 1.0);
        /// Drag on every grain over its mass and velocity relative to the deforming cell, in reduced units.
        pub drag: f64 = 0.03, off, zero_or_more();
        /// Drag once the pressure has first come within 2 %: it stops rattlers, which no contact slows down.
        pub settling_drag: f64 = 0.1, off, zero_or_more();
        /// Cundall's local damping: each component of the unbalanced force is reduced by this fraction
        /// of itself if it drives the motion, and increased if it resists.
        pub local_damping: f64 = 0.0, off, only("0 to below 1", |v| (0.0..1.0).contains(v));
        /// Packing fraction of the random placement.
        pub start_fraction: f64 = 0.35, off, only("more than 0, at most 0.5", |v| *v > 0.0 && *v <= 0.5);
        /// Fraction of the expected final packing fraction up to which the cell shrinks at `squeeze_rate`.
        pub compression_target_fraction: f64 = 0.87, off, only("more than 0, at most \
         1", |v| *v > 0.0 && *v <= 1.0);
        /// Linear strain rate of that first compression, in reduced units.
        pub squeeze_rate: f64 = 0.01, off, positive();
        /// Maximum linear strain rate of the servo, in reduced units.
        pub servo_rate: f64 = 2e-3, off, positive();
        /// Linear strain rate of the servo over the relative pressure deficit, in reduced units.
        pub servo_gain: f64 = 1e-2, off, positive();
        /// The mass of a grain is proportional to its diameter to the power of 3 minus this. 0 is the
        /// true mass; with more, small grains limit the time step less. At rest masses do not matter.
        pub mass_exponent: f64 = 1.0, off, only("0 to 2", |v| (0.0..=2.0).contains(v));
        /// Time step as a fraction of the critical step; a low restitution lowers it further.
        pub step_fraction: f64 = 0.7, off, only("more than 0, less than 1", |v| *v > 0.0 && *v < 1.0);
        /// Number of steps for which the state must hold to end a stage. If some grains are given a
        /// larger mass (size ratio of 20 or more), it is counted in steps of the grains' own masses.
        pub hold_steps: u64 = 4000, off, whole(1..=u64::from(u32::MAX));
        /// Maximum number of steps.
        pub max_steps: u64 = 2_000_000, off, whole(1..=u64::from(u32::MAX));
    }
    beside {
        /// Grains drawn from the gradation.
        pub grains: usize = 10_000;
        /// Friction between grains during compression: 0 makes the densest packing, 0.3 a loose one.
        pub friction: f64 = 0.3;
        /// Normal contact force.
        pub contact: Contact = Contact::Hertz;
        /// True to prevent tension from the damping of a separating contact.
        pub clip_tension: bool = true;
        /// Fixed time step in reduced units instead of `step_fraction`; must be below the critical step.
        pub step: Option<f64> = None;
        /// Initial reach of the neighbour lists beyond contact; adapted during the compression.
        pub reach: Reach = Reach { relative: 0.01, absolute: 0.1 };
    }
}

fn positive() -> Allowed<f64> {
    only("a positive number", |v: &f64| *v > 0.0 && v.is_finite())
}

fn zero_or_more() -> Allowed<f64> {
    only("0 or more", |v| (0.0..f64::INFINITY).contains(v))
}

fn friction() -> Allowed<f64> {
    only("0 to 10", |v| (0.0..=10.0).contains(v))
}

/// Maximum overlap (% of the diameter) at which grains still count as spheres in contact. Beyond it the
/// void ratio falls with the stiffness, in the end below 0, although every other criterion of a settled
/// packing is met.
const MOST_OVERLAP_PERCENT: f64 = 3.0;

/// Reasons why no packing could be made.
#[allow(missing_docs)]
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PackingError {
    /// A setting is out of range.
    #[error("{field} = {value} is not allowed: {allowed}")]
    Setting { field: &'static str, value: String, allowed: String },
    /// Grains so soft that their overlaps mean nothing, and the minimum allowed ratio of stiffness.
    #[error(
        "stiffness_ratio = {value} is not allowed: under the pressure of {pressure_kpa} kPa grains would \
         overlap by about {overlap_percent:.2} % of their size; allowed: at least {least:.1e}, where they \
         overlap by {MOST_OVERLAP_PERCENT} %"
    )]
    Soft { value: f64, pressure_kpa: f64, overlap_percent: f64, least: f64 },
    /// An invalid grain, counted from 0: a column, its value, and the allowed values.
    #[error("grain {0}: {1} = {2} is not allowed: {3}")]
    Grain(usize, &'static str, f64, &'static str),
    /// Columns of different length, or without grains.
    #[error(
        "grain columns x, y, z, diameter have {0:?} entries: they must have the same number, at least one"
    )]
    Columns([usize; 4]),
    /// The cell is not periodic, not square, or flatter than wide.
    #[error("compression needs a periodic cell, square across z and 1 to 100 times as tall as wide, not {0}")]
    Cell(String),
    /// A cell too flat or too tall.
    #[error("a cell {0} times as tall as wide: allowed: a number from 1 to 100")]
    Aspect(f64),
    /// A cell in which the largest grain would touch itself, or another grain twice.
    #[error(
        "the cell is {cell_mm} mm wide, narrower than two of the largest grain ({largest_mm} mm): use more \
         grains or a narrower gradation"
    )]
    NarrowCell { cell_mm: f64, largest_mm: f64 },
    /// Two grains with the same centre: there is no direction in which to push them apart.
    #[error("grains {0} and {1} have the same centre")]
    Coincident(usize, usize),
    /// A time step that cannot be stable, the critical step, and its cause.
    #[error(
        "time step {step:e} (reduced units) is not below the critical time step {critical:e}, which is set \
         by {cause}"
    )]
    Step { step: f64, critical: f64, cause: &'static str },
    /// No room for a grain, by rank from the largest.
    #[error("no room for grain {grain} of {grains} at packing fraction {fraction}: start looser")]
    Placement { grain: usize, grains: usize, fraction: f64 },
    /// A stage that did not settle: pressure over its target, ratio of kinetic to elastic energy.
    #[error(
        "not settled after {steps} steps: pressure {pressure} of the target, kinetic by elastic energy \
         {kinetic_ratio:e}"
    )]
    Unsettled { steps: u64, pressure: f64, kinetic_ratio: f64 },
    /// The progress callback asked to stop.
    #[error("stopped after {0} steps")]
    Stopped(u64),
    /// The stored columns are inconsistent.
    #[error("stored state: {0}")]
    State(&'static str),
}

impl PackingError {
    /// Refuses the first diameter that is not a size.
    pub(super) fn unless_sizes(diameter: &[f64]) -> Result<(), Self> {
        match diameter.iter().position(|d| !(*d > 0.0 && *d < f64::INFINITY)) {
            None => Ok(()),
            Some(grain) => Err(Self::Grain(grain, "diameter", diameter[grain], "a positive number")),
        }
    }
}

impl Settings {
    /// Shear modulus of the grains over the pressure, reduced by the stiffness ratio.
    fn shear(&self) -> f64 {
        self.shear_modulus_gpa * self.stiffness_ratio * 1e6 / self.pressure_kpa
    }

    pub(super) fn fingerprint(&self) -> u64 {
        xxhash_rust::xxh3::xxh3_64(format!("{self:?}").as_bytes())
    }

    /// Checks every setting.
    ///
    /// # Errors
    /// The first setting that is out of range, with its allowed values.
    pub fn check(&self) -> Result<(), PackingError> {
        if let Some(OutOfRange { name, value, allowed }) = self.out_of_range() {
            return Err(PackingError::Setting { field: name, value, allowed });
        }
        let stiffness = match self.contact {
            Contact::Hertz => 1.0,
            Contact::Linear(stiffness) => stiffness,
        };
        for (field, value, allowed) in [
            ("grains", self.grains as f64, only("at least 1", |n| *n > 0.0)),
            ("friction", self.friction, friction()),
            ("contact stiffness", stiffness, positive()),
            ("step", self.step.unwrap_or(1.0), positive()),
            ("reach.relative", self.reach.relative, positive()),
            ("reach.absolute", self.reach.absolute, positive()),
        ] {
            if !allowed.admits(&value) {
                let (value, allowed) = (value.to_string(), allowed.words);
                return Err(PackingError::Setting { field, value, allowed });
            }
        }
        self.check_softness()
    }

    /// Checks the overlap: two equal grains of diameter D that carry the force p D^2 overlap by
    /// `0.5 (4.24 (1 - nu) p / G)^(2/3)` of D (Hertz).
    fn check_softness(&self) -> Result<(), PackingError> {
        if self.contact != Contact::Hertz {
            return Ok(());
        }
        let loaded = 3.0 * std::f64::consts::SQRT_2 * (1.0 - self.poisson_ratio) / self.shear();
        let overlap_percent = 50.0 * libm::cbrt(loaded * loaded);
        if overlap_percent <= MOST_OVERLAP_PERCENT {
            return Ok(());
        }
        let softer = overlap_percent / MOST_OVERLAP_PERCENT;
        let least = self.stiffness_ratio * softer * softer.sqrt();
        // Rounded up to two digits, so that the value in the message is allowed.
        let unit = libm::pow(10.0, libm::floor(libm::log10(least)) - 1.0);
        Err(PackingError::Soft {
            value: self.stiffness_ratio,
            pressure_kpa: self.pressure_kpa,
            overlap_percent,
            least: libm::ceil(least / unit) * unit,
        })
    }
}

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

impl Law {
    /// Makes the contact law in reduced units, with this friction.
    pub(super) fn new(settings: &Settings, friction: f64) -> Self {
        let nu = settings.poisson_ratio;
        let log = libm::log(settings.restitution);
        let ratio = -log / (PI * PI + log * log).sqrt();
        let (hertz, stiffness, factor) = match settings.contact {
            Contact::Hertz => (true, 2.0 * settings.shear() / (1.0 - nu), 2.0 * (5.0f64 / 6.0).sqrt()),
            Contact::Linear(stiffness) => (false, stiffness, 2.0),
        };
        Self {
            hertz,
            stiffness,
            tangential: 2.0 * (1.0 - nu) / (2.0 - nu),
            damping: factor * ratio,
            friction,
            clip: settings.clip_tension,
        }
    }
}

/// Upper bound of `(angular frequency)^2` over the largest sum of normal contact stiffness over mass. A
/// contact of stiffness `kn` between two free grains has the modes `2 kn / m` and, with friction,
/// `7 kt / m` (sliding and rolling together). The sum over the contacts of a grain bounds the whole
/// network (the energy of each contact is at most twice that of its two grains moved separately).
pub(super) fn stability(law: &Law) -> f64 {
    if law.friction > 0.0 { (7.0 * law.tangential).max(2.0) } else { 2.0 }
}

/// Fraction of the critical step that damping leaves. The damping force uses the velocity of the last half
/// step, so an oscillator of damping ratio `z` is stable up to `sqrt(1 + z^2) - z` of its undamped limit. A
/// grain between several contacts has a higher ratio than a pair, and the critical step is below the true
/// limit; 0.9 of the damping coefficient covers both. Checked with packings: at restitution 0.2 this is
/// 0.50, and packings settle with 0.5 of the critical step but never with 0.6 or 0.7.
pub(super) fn damped_part(law: &Law) -> f64 {
    let z = 0.9 * law.damping;
    (1.0 + z * z).sqrt() - z
}

/// Critical time step before there are contacts, and its cause: the Rayleigh wave across the smallest grain
/// by mass; the period of a Hertz contact under the target pressure; a grain with six such contacts.
pub(super) fn critical_step(
    position: &[[f64; 4]],
    velocity: &[[f64; 4]],
    settings: &Settings,
) -> (f64, &'static str) {
    let law = Law::new(settings, settings.friction.max(settings.final_friction));
    let shear = settings.shear();
    let mut least = (f64::INFINITY, "");
    for (p, v) in position.iter().zip(velocity) {
        let (radius, mass) = (p[3], v[3]);
        let (kn, rayleigh) = if law.hertz {
            // Force p D^2 on a contact of two such grains.
            let force = 4.0 * radius * radius;
            let root = (0.5 * radius).sqrt();
            let loaded = 1.5 * force / (law.stiffness * root);
            let overlap = libm::cbrt(loaded * loaded);
            let density = mass / (4.0 / 3.0 * PI * radius * radius * radius);
            let factor = 0.1631 * settings.poisson_ratio + 0.8766;
            (law.stiffness * root * overlap.sqrt(), PI * radius * (density / shear).sqrt() / factor)
        } else {
            (law.stiffness, f64::INFINITY)
        };
        for limit in [
            (rayleigh, "the Rayleigh wave across a grain"),
            (PI / (2.0 * kn / mass).sqrt(), "the duration of a contact"),
            (2.0 / (stability(&law) * 6.0 * kn / mass).sqrt(), "a grain with six contacts"),
        ] {
            least = if limit.0 < least.0 { limit } else { least };
        }
    }
    least
}

/// Ratio of the largest to the smallest grain from which crowded grains are given a larger mass.
pub(super) const WIDE: f64 = 20.0;

/// Critical step of a grain with a larger mass, over the critical step before there are contacts.
const HEAVIER_STEP: f64 = 1.5;

/// Tells if sizes differ so much that a few small grains pressed between large ones would set the step
/// of a compression, so that they are given a larger mass.
pub fn is_wide(gradation: &Gradation) -> bool {
    gradation.largest_mm() / gradation.smallest_mm() >= WIDE
}

/// Minimum mass of a grain in a step over the sum of its contact stiffness: its critical step is then
/// [`HEAVIER_STEP`] times `loose_step`, the critical step before there are contacts.
pub(super) fn heavier_mass_by_stiffness(law: &Law, loose_step: f64) -> f64 {
    let step = HEAVIER_STEP * loose_step;
    0.25 * stability(law) * step * step
}
