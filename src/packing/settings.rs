//! What a compression needs to know, its defaults, and what can be wrong.

use super::neighbours::Reach;

/// Normal force of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Contact {
    /// Hertz-Mindlin with the shear modulus and Poisson's ratio of the settings.
    Hertz,
    /// A linear spring, for comparison: stiffness in units of pressure times smallest diameter.
    Linear(f64),
}

/// Settings of a compression.
///
/// The defaults are those of the paper where it gives them. The others come from the study in `results/packing-2026-11-21.md`
/// (`scripts/study_packing.py`): half the rates, other masses, half the time step, twice the hold, and more or fewer grains change the void
/// ratio by no more than 0.003, about what seeds do (standard deviation 0.0035 loose and 0.0016 dense for 4,000 grains, 0.0011 and 0.0005 for 15,000).
///
/// A loose packing remembers its start: a packing fraction of 0.45 at the start makes it 0.014 denser, 0.2 makes it 0.005 looser, three times the drag 0.006
/// looser. Take void ratios of loose packings as uncertain by 0.01; constriction curves move by less than 1 % with any of this.
///
/// `stiffness_ratio`: with the default, a tenth, packings with friction keep their void ratio within 0.003, but those without friction
/// come out 0.003 to 0.008 denser than at the full stiffness, which gives the paper's values within 0.002 (Cu 1.2 to 3) in
/// two and a half times the time: `stiffness_ratio: 1.0, hold_steps: 8000`. A tenth of the stiffness is the default because all six filters of
/// the paper, up to 60,000 grains of Cu 6, were settled with it.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Grains drawn from the gradation.
    pub grains: usize,
    /// Seed of sizes and start positions.
    pub seed: u64,
    /// Friction between grains during compression: 0 makes the densest packing, 0.3 a loose one.
    pub friction: f64,
    /// Friction set once the pressure is held; the packing then settles again.
    pub final_friction: f64,
    /// Mean pressure (kPa).
    pub pressure_kpa: f64,
    /// Shear modulus of the grains (GPa).
    pub shear_modulus_gpa: f64,
    /// Poisson's ratio of the grains.
    pub poisson_ratio: f64,
    /// Factor on the shear modulus; below 1 trades stiffness for time.
    pub stiffness_ratio: f64,
    /// Density of the grains (kg/m3): only the reported time depends on it.
    pub density_kg_m3: f64,
    /// Normal contact force.
    pub contact: Contact,
    /// Part of its approach velocity that a collision keeps, at every speed.
    pub restitution: f64,
    /// Drag on every grain by its mass and velocity relative to the deforming cell, in reduced units.
    pub drag: f64,
    /// Drag once the pressure has first come within 2 %: it stops the loose grains, which no contact would.
    pub brake: f64,
    /// Cundall's local damping: each component of the unbalanced force is reduced by this part of itself
    /// where it drives the motion, raised where it resists.
    pub local_damping: f64,
    /// No tension from the damping of a separating contact.
    pub clip_tension: bool,
    /// Packing fraction of the random placement.
    pub start_fraction: f64,
    /// Part of the expected final packing fraction up to which the cell shrinks at `squeeze_rate`.
    pub squeeze_to: f64,
    /// Linear strain rate of the squeeze, in reduced units.
    pub squeeze_rate: f64,
    /// Largest linear strain rate of the servo, in reduced units.
    pub servo_rate: f64,
    /// Linear strain rate of the servo per relative lack of pressure, in reduced units.
    pub servo_gain: f64,
    /// Mass of a grain grows with diameter to the power of three less this: 0 is the true mass, more lets small
    /// grains govern the time step less. At rest masses do not matter.
    pub mass_exponent: f64,
    /// Time step as part of the critical one, where `step` is not given; a low restitution lowers it further.
    pub step_fraction: f64,
    /// Fixed time step in reduced units; refused at or above the critical one.
    pub step: Option<f64>,
    /// How far the first neighbour lists reach beyond contact; adapted as the compression goes.
    pub reach: Reach,
    /// Held steps that end a stage; see [`compress`](super::compress).
    pub hold_steps: u64,
    /// Give up after this many steps.
    pub max_steps: u64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            grains: 10_000,
            seed: 1,
            friction: 0.3,
            final_friction: 0.3,
            pressure_kpa: 50.0,
            shear_modulus_gpa: 27.0,
            poisson_ratio: 0.3,
            stiffness_ratio: 0.1,
            density_kg_m3: 2670.0,
            contact: Contact::Hertz,
            restitution: 0.5,
            drag: 0.03,
            brake: 0.1,
            local_damping: 0.0,
            clip_tension: true,
            start_fraction: 0.35,
            squeeze_to: 0.87,
            squeeze_rate: 0.01,
            servo_rate: 2e-3,
            servo_gain: 1e-2,
            mass_exponent: 1.0,
            step_fraction: 0.7,
            step: None,
            reach: Reach { relative: 0.01, absolute: 0.1 },
            hold_steps: 4000,
            max_steps: 2_000_000,
        }
    }
}

/// With larger overlaps (%, of the diameter) grains are no spheres in contact any more: the void ratio falls with the stiffness, below 0 in
/// the end, although every other criterion of a settled packing is met.
const MOST_OVERLAP_PERCENT: f64 = 3.0;

/// Why a packing could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PackingError {
    /// A setting is out of range.
    #[error("{field} = {value} is not allowed: {allowed}")]
    Setting {
        /// Name of the setting.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// Grains so soft that their overlaps mean nothing.
    #[error(
        "stiffness_ratio = {value} is not allowed: under the pressure of {pressure_kpa} kPa grains would overlap by about {overlap_percent:.2} % of \
         their size; allowed: at least {least:.1e}, where they overlap by {MOST_OVERLAP_PERCENT} %"
    )]
    Soft {
        /// The ratio asked for.
        value: f64,
        /// Pressure that is to be held.
        pressure_kpa: f64,
        /// Overlap of two grains under it, of their diameter.
        overlap_percent: f64,
        /// The least ratio that is allowed.
        least: f64,
    },
    /// A grain is no grain.
    #[error("grain {grain}: {column} = {value} is not allowed: {allowed}")]
    Grain {
        /// Which, counted from 0.
        grain: usize,
        /// What is wrong with it.
        column: &'static str,
        /// The value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// Columns of different length, or no grain at all.
    #[error(
        "grain columns x, y, z, diameter have {0:?} entries: they must have the same number, at least one"
    )]
    Columns([usize; 4]),
    /// The cell is not periodic and cubic.
    #[error("compression needs a periodic cubic cell, not {0}")]
    Cell(String),
    /// A grain would touch itself or another grain twice.
    #[error(
        "the cell is {cell_mm} mm wide, narrower than two of the largest grain ({largest_mm} mm): use more grains or a narrower gradation"
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
        /// The one, counted from 0.
        first: usize,
        /// The other.
        second: usize,
    },
    /// The time step cannot be stable.
    #[error(
        "time step {step:e} (reduced units) is not below the critical time step {critical:e}, which is set by {cause}"
    )]
    Step {
        /// The step asked for.
        step: f64,
        /// The critical step.
        critical: f64,
        /// Which limit.
        cause: &'static str,
    },
    /// No room for a grain.
    #[error("no room for grain {grain} of {grains} at packing fraction {fraction}: start looser")]
    Placement {
        /// Which, from the largest.
        grain: usize,
        /// Of how many.
        grains: usize,
        /// The packing fraction tried.
        fraction: f64,
    },
    /// The stage did not settle.
    #[error(
        "not settled after {steps} steps: pressure {pressure} of the target, kinetic by elastic energy {kinetic_ratio:e}"
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
        let positive = "a positive number";
        let part = "more than 0, less than 1";
        let linear = match self.contact {
            Contact::Hertz => 1.0,
            Contact::Linear(stiffness) => stiffness,
        };
        let above = |v: f64| v > 0.0 && v < f64::INFINITY;
        let rules: [(&'static str, f64, bool, &'static str); 24] = [
            ("grains", self.grains as f64, self.grains > 0, "at least 1"),
            ("friction", self.friction, (0.0..=10.0).contains(&self.friction), "0 to 10"),
            ("final_friction", self.final_friction, (0.0..=10.0).contains(&self.final_friction), "0 to 10"),
            ("pressure_kpa", self.pressure_kpa, above(self.pressure_kpa), positive),
            ("shear_modulus_gpa", self.shear_modulus_gpa, above(self.shear_modulus_gpa), positive),
            ("poisson_ratio", self.poisson_ratio, (0.0..=0.5).contains(&self.poisson_ratio), "0 to 0.5"),
            ("stiffness_ratio", self.stiffness_ratio, above(self.stiffness_ratio), positive),
            ("density_kg_m3", self.density_kg_m3, above(self.density_kg_m3), positive),
            ("contact stiffness", linear, above(linear), positive),
            (
                "restitution",
                self.restitution,
                self.restitution > 0.0 && self.restitution <= 1.0,
                "more than 0, at most 1",
            ),
            ("drag", self.drag, (0.0..f64::INFINITY).contains(&self.drag), "0 or more"),
            ("brake", self.brake, (0.0..f64::INFINITY).contains(&self.brake), "0 or more"),
            ("local_damping", self.local_damping, (0.0..1.0).contains(&self.local_damping), "0 to below 1"),
            (
                "start_fraction",
                self.start_fraction,
                self.start_fraction > 0.0 && self.start_fraction <= 0.5,
                "more than 0, at most 0.5",
            ),
            (
                "squeeze_to",
                self.squeeze_to,
                self.squeeze_to > 0.0 && self.squeeze_to <= 1.0,
                "more than 0, at most 1",
            ),
            ("squeeze_rate", self.squeeze_rate, above(self.squeeze_rate), positive),
            ("servo_rate", self.servo_rate, above(self.servo_rate), positive),
            ("servo_gain", self.servo_gain, above(self.servo_gain), positive),
            ("mass_exponent", self.mass_exponent, (0.0..=2.0).contains(&self.mass_exponent), "0 to 2"),
            ("step_fraction", self.step_fraction, self.step_fraction > 0.0 && self.step_fraction < 1.0, part),
            ("step", self.step.unwrap_or(1.0), self.step.is_none_or(above), positive),
            ("reach.relative", self.reach.relative, above(self.reach.relative), positive),
            ("reach.absolute", self.reach.absolute, above(self.reach.absolute), positive),
            ("hold_steps", self.hold_steps as f64, self.hold_steps > 0, "at least 1"),
        ];
        match rules.into_iter().find(|rule| !rule.2) {
            Some((field, value, _, allowed)) => Err(PackingError::Setting { field, value, allowed }),
            None => self.check_softness(),
        }
    }

    /// Two equal grains of diameter D that carry the force p D^2 overlap by `0.5 (4.24 (1 - nu) p / G)^(2/3)` of D (Hertz).
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
        // To two digits, upwards, so that what is named is allowed.
        let unit = libm::pow(10.0, libm::floor(libm::log10(least)) - 1.0);
        Err(PackingError::Soft {
            value: self.stiffness_ratio,
            pressure_kpa: self.pressure_kpa,
            overlap_percent,
            least: libm::ceil(least / unit) * unit,
        })
    }
}
