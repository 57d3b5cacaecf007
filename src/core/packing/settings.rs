//! Settings of a compression, their defaults, and its errors.

use super::neighbours::Reach;
use crate::schema::{Allowed, OutOfRange, only, section, whole};

/// Normal force of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Contact {
    /// Hertz-Mindlin with the shear modulus and Poisson's ratio of the settings.
    Hertz,
    /// A linear spring, for comparison: stiffness in units of pressure times smallest diameter.
    Linear(f64),
}

section! {
    /// How the grains are compressed; the defaults suit nearly every filter.
    ///
    /// The defaults are those of the paper where it gives them. The others come from the study in
    /// `results/packing.md` (`scripts/studies/study_packing.py`): half the rates, other masses,
    /// half the time step, twice the hold, and more or fewer grains change the void ratio by no more than
    /// 0.003, about what seeds do (standard deviation 0.0035 loose and 0.0016 dense for 4,000 grains, 0.0011
    /// and 0.0005 for 15,000).
    ///
    /// A loose packing remembers its start: a packing fraction of 0.45 at the start makes it 0.014 denser,
    /// 0.2 makes it 0.005 looser, three times the drag 0.006 looser. Take void ratios of loose packings as
    /// uncertain by 0.01; constriction curves move by less than 1 % with any of this.
    ///
    /// `stiffness_ratio`: with the default, a tenth, packings with friction keep their void ratio within
    /// 0.003, but those without friction come out 0.003 to 0.008 denser than at the full stiffness, which
    /// gives the paper's values within 0.002 (Cu 1.2 to 3) in two and a half times the time:
    /// `stiffness_ratio: 1.0, hold_steps: 8000`. A tenth of the stiffness is the default because all six
    /// filters of the paper, up to 60,000 grains of Cu 6, were settled with it.
    pub struct Settings in "packing" {
        /// Seed of sizes and start positions.
        pub seed: u64 = 1, off, whole(0..=u64::MAX);
        /// Friction set once the pressure is held; the packing then settles again.
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
        /// Drag on every grain by its mass and velocity relative to the deforming cell, in reduced units.
        pub drag: f64 = 0.03, off, zero_or_more();
        /// Drag once the pressure has first come within 2 %: it stops rattlers, which no contact would.
        pub settling_drag: f64 = 0.1, off, zero_or_more();
        /// Cundall's local damping: each component of the unbalanced force is reduced by this part of itself
        /// where it drives the motion, raised where it resists.
        pub local_damping: f64 = 0.0, off, only("0 to below 1", |v| (0.0..1.0).contains(v));
        /// Packing fraction of the random placement.
        pub start_fraction: f64 = 0.35, off, only("more than 0, at most 0.5", |v| *v > 0.0 && *v <= 0.5);
        /// Part of the expected final packing fraction up to which the cell shrinks at `squeeze_rate`.
        pub compression_target_fraction: f64 = 0.87, off, only("more than 0, at most \
         1", |v| *v > 0.0 && *v <= 1.0);
        /// Linear strain rate of that first compression, in reduced units.
        pub squeeze_rate: f64 = 0.01, off, positive();
        /// Largest linear strain rate of the servo, in reduced units.
        pub servo_rate: f64 = 2e-3, off, positive();
        /// Linear strain rate of the servo per relative lack of pressure, in reduced units.
        pub servo_gain: f64 = 1e-2, off, positive();
        /// Mass of a grain grows with diameter to the power of three less this: 0 is the true mass, more lets
        /// small grains govern the time step less. At rest masses do not matter.
        pub mass_exponent: f64 = 1.0, off, only("0 to 2", |v| (0.0..=2.0).contains(v));
        /// Time step as part of the critical one; a low restitution lowers it further.
        pub step_fraction: f64 = 0.7, off, only("more than 0, less than 1", |v| *v > 0.0 && *v < 1.0);
        /// Held steps that end a stage, as many as the grains' own masses would take where some are moved as
        /// heavier ones (gradations of a size ratio of 20 or more).
        pub hold_steps: u64 = 4000, off, whole(1..=u64::from(u32::MAX));
        /// Give up after this many steps.
        pub max_steps: u64 = 2_000_000, off, whole(1..=u64::from(u32::MAX));
    }
    beside {
        /// Grains drawn from the gradation.
        pub grains: usize = 10_000;
        /// Friction between grains during compression: 0 makes the densest packing, 0.3 a loose one.
        pub friction: f64 = 0.3;
        /// Normal contact force.
        pub contact: Contact = Contact::Hertz;
        /// No tension from the damping of a separating contact.
        pub clip_tension: bool = true;
        /// Fixed time step in reduced units instead of `step_fraction`; refused at or above the critical one.
        pub step: Option<f64> = None;
        /// How far the first neighbour lists reach beyond contact; adapted as the compression goes.
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

/// Largest overlap (%, of the diameter) at which grains still count as spheres in contact: beyond it the void
/// ratio falls with the stiffness, below 0 in the end, although every other criterion of a settled packing is
/// met.
const MOST_OVERLAP_PERCENT: f64 = 3.0;

/// Reasons why no packing could be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PackingError {
    /// A setting is out of range.
    #[error("{field} = {value} is not allowed: {allowed}")]
    Setting {
        /// Name of the setting.
        field: &'static str,
        /// Its value.
        value: String,
        /// Allowed values.
        allowed: String,
    },
    /// Grains so soft that their overlaps mean nothing.
    #[error(
        "stiffness_ratio = {value} is not allowed: under the pressure of {pressure_kpa} kPa grains would \
         overlap by about {overlap_percent:.2} % of their size; allowed: at least {least:.1e}, where they \
         overlap by {MOST_OVERLAP_PERCENT} %"
    )]
    Soft {
        /// The ratio asked for.
        value: f64,
        /// Pressure to be held.
        pressure_kpa: f64,
        /// Overlap of two grains under that pressure, of their diameter.
        overlap_percent: f64,
        /// Least allowed ratio.
        least: f64,
    },
    /// An invalid grain.
    #[error("grain {grain}: {column} = {value} is not allowed: {allowed}")]
    Grain {
        /// Index of the grain, counted from 0.
        grain: usize,
        /// Name of the wrong column.
        column: &'static str,
        /// The value.
        value: f64,
        /// Allowed values.
        allowed: &'static str,
    },
    /// Columns of different length, or no grain at all.
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
    /// A grain would touch itself or another grain twice.
    #[error(
        "the cell is {cell_mm} mm wide, narrower than two of the largest grain ({largest_mm} mm): use more \
         grains or a narrower gradation"
    )]
    NarrowCell {
        /// Edge of the cell (mm).
        cell_mm: f64,
        /// Diameter of the largest grain (mm).
        largest_mm: f64,
    },
    /// Two grains with one centre: there is no direction to push them apart.
    #[error("grains {first} and {second} have the same centre")]
    Coincident {
        /// First grain, counted from 0.
        first: usize,
        /// Second grain, counted from 0.
        second: usize,
    },
    /// A time step that cannot be stable.
    #[error(
        "time step {step:e} (reduced units) is not below the critical time step {critical:e}, which is set \
         by {cause}"
    )]
    Step {
        /// The step asked for.
        step: f64,
        /// The critical step.
        critical: f64,
        /// Cause of the limit.
        cause: &'static str,
    },
    /// No room for a grain.
    #[error("no room for grain {grain} of {grains} at packing fraction {fraction}: start looser")]
    Placement {
        /// Rank of the grain, from the largest.
        grain: usize,
        /// Number of grains.
        grains: usize,
        /// Packing fraction that was tried.
        fraction: f64,
    },
    /// The stage did not settle.
    #[error(
        "not settled after {steps} steps: pressure {pressure} of the target, kinetic by elastic energy \
         {kinetic_ratio:e}"
    )]
    Unsettled {
        /// Steps done.
        steps: u64,
        /// Pressure by target.
        pressure: f64,
        /// Kinetic by elastic energy.
        kinetic_ratio: f64,
    },
    /// The progress callback asked to stop.
    #[error("stopped after {0} steps")]
    Stopped(u64),
    /// Stored columns do not fit together.
    #[error("stored state: {0}")]
    State(&'static str),
}

impl Settings {
    /// Checks every setting.
    ///
    /// # Errors
    /// The first setting that is out of range, with what is allowed.
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
                return Err(PackingError::Setting {
                    field,
                    value: value.to_string(),
                    allowed: allowed.words,
                });
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
        let shear = self.shear_modulus_gpa * self.stiffness_ratio * 1e6 / self.pressure_kpa;
        let loaded = 3.0 * std::f64::consts::SQRT_2 * (1.0 - self.poisson_ratio) / shear;
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
