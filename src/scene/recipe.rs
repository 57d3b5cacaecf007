//! How a filter is to be packed, as the user states it.

use std::path::PathBuf;

use super::FilterGradation;
use super::{SceneError, Settings};
use crate::constrictions::DEFAULT_MERGE_OVERLAP;
use crate::packing::{PackingError, Settings as Compression};

/// The friction between grains during compression that a word for the density stands for.
pub const DENSITIES: [(&str, f64); 3] = [("dense", 0.0), ("intermediate", 0.1), ("loose", 0.3)];

/// A filter to be packed.
#[derive(Clone, Debug, PartialEq)]
pub struct PackingSpec {
    /// Its gradation; `cu` is given where it is linear.
    pub gradation: FilterGradation,
    /// Grains, where the user says how many.
    pub grains: Option<usize>,
    /// How the grains are compressed; its number of grains counts only where the user gave one.
    pub compression: Compression,
    /// Overlap of two inscribed spheres from which their tetrahedra are one void.
    pub merge_overlap: f64,
    /// What errors call the file.
    pub file: String,
}

impl PackingSpec {
    /// The recipe that the settings state; `None` where they name neither density nor friction.
    ///
    /// # Errors
    /// A value that is not allowed, settings that clash, or a gradation that is missing.
    pub fn new(s: &Settings, gradation: &FilterGradation) -> Result<Option<Self>, SceneError> {
        let stated = s.has("filter.density") || s.has("filter.friction");
        if !stated {
            return match s.first_in("packing.") {
                Some(name) => Err(s.clash(format!(
                    "{name} goes with filter.density or filter.friction: nothing is packed without one of them"
                ))),
                None => Ok(None),
            };
        }
        for (one, other) in [
            ("filter.density", "filter.friction"),
            ("filter.density", "filter.curve"),
            ("filter.friction", "filter.curve"),
            ("filter.density", "network.file"),
            ("filter.friction", "network.file"),
        ] {
            if s.has(one) && s.has(other) {
                return Err(s.clash(format!(
                    "{one} and {other} both say what the filter's constrictions are: keep one"
                )));
            }
        }
        if matches!(gradation, FilterGradation::Linear { cu: None, .. }) {
            return Err(s.clash(
                "filter.cu or filter.sieve is missing: a filter that is to be packed needs its gradation",
            ));
        }
        let mut compression = Compression::default();
        let words = "\"dense\" (friction 0), \"intermediate\" (0.1) or \"loose\" (0.3)";
        if let Some(friction) = s.word("filter.density", DENSITIES, words)? {
            compression.friction = friction;
        }
        if let Some(friction) = s.number("filter.friction", |_| true, "a number from 0 to 10")? {
            compression.friction = friction;
        }
        for (name, field) in numbers(&mut compression) {
            if let Some(value) = s.number(name, |_| true, "a finite number")? {
                *field = value;
            }
        }
        let whole = |name| s.whole(name, 1..=u64::from(u32::MAX));
        let grains = s.whole("packing.grains", 10..=10_000_000)?.map(|n| n as usize);
        compression.grains = grains.unwrap_or(compression.grains);
        compression.seed = s.whole("packing.seed", 0..=u64::MAX)?.unwrap_or(compression.seed);
        compression.hold_steps = whole("packing.hold_steps")?.unwrap_or(compression.hold_steps);
        compression.max_steps = whole("packing.max_steps")?.unwrap_or(compression.max_steps);
        match compression.check() {
            Err(PackingError::Setting { field, allowed, .. }) => {
                let name =
                    if field == "friction" { "filter.friction".into() } else { format!("packing.{field}") };
                return Err(s.refuse(&name, allowed));
            }
            Err(soft) => return Err(s.clash(format!("packing.{soft}"))),
            Ok(()) => {}
        }
        let merge_overlap = s
            .number("packing.merge_overlap", |f| f >= 0.0, "a number from 0")?
            .unwrap_or(DEFAULT_MERGE_OVERLAP);
        let (gradation, file) = (gradation.clone(), s.file().to_owned());
        Ok(Some(Self { gradation, grains, compression, merge_overlap, file }))
    }

    /// The sieve table of the gradation, if there is one.
    pub fn sieve(&self) -> Option<&PathBuf> {
        match &self.gradation {
            FilterGradation::Sieve(path, _) => Some(path),
            FilterGradation::Linear { .. } => None,
        }
    }
}

/// The numbers of a compression that a user can set, by name.
fn numbers(c: &mut Compression) -> [(&'static str, &mut f64); 17] {
    [
        ("packing.final_friction", &mut c.final_friction),
        ("packing.pressure_kpa", &mut c.pressure_kpa),
        ("packing.shear_modulus_gpa", &mut c.shear_modulus_gpa),
        ("packing.poisson_ratio", &mut c.poisson_ratio),
        ("packing.stiffness_ratio", &mut c.stiffness_ratio),
        ("packing.density_kg_m3", &mut c.density_kg_m3),
        ("packing.restitution", &mut c.restitution),
        ("packing.drag", &mut c.drag),
        ("packing.brake", &mut c.brake),
        ("packing.local_damping", &mut c.local_damping),
        ("packing.start_fraction", &mut c.start_fraction),
        ("packing.squeeze_to", &mut c.squeeze_to),
        ("packing.squeeze_rate", &mut c.squeeze_rate),
        ("packing.servo_rate", &mut c.servo_rate),
        ("packing.servo_gain", &mut c.servo_gain),
        ("packing.mass_exponent", &mut c.mass_exponent),
        ("packing.step_fraction", &mut c.step_fraction),
    ]
}
