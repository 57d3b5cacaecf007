//! How densely particles lie in each void, for laws of clogging that depend on it.
//!
//! # What is decided
//! The concentration of a law is stated, or it is that of the void in which a particle is: the volume of the
//! *other* particles there by the volume of the void. The particles of an increment are counted once it has
//! inserted its share and before any moves, as all of them then attempt one move. A particle that is alone
//! has a concentration of 0. No void is denser than grains at rest.
//!
//! Passive particles are not counted: they are too fine for an arch in any open constriction. Which they are
//! is the same with every engine, so that engines count alike.
//!
//! A law asks for the ratio `R` of a constriction to a particle. Where sizes are mixed, that particle is the
//! one that would pass ([`ArchSize::Own`]), or has the mean volume of all in its void
//! ([`ArchSize::VoidMean`]). Either way the particle itself must be coarse enough for the law.
//!
//! # Trapped particles
//! Particles that circle in closed loops, each alone in its void, would never arch. So only what stops a
//! single particle counts when trapped ones are looked for. Trapped particles may still jam while others
//! move; nothing opens by that, so that they stay trapped.

use libm::cbrt;
use serde::{Deserialize, Serialize};

use super::sizes::cube;

/// Concentration of grains that lie densely: nothing is denser.
pub const DENSEST: f64 = 0.64;

/// Where the concentration of a law comes from, as a scene says it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Concentration {
    /// This volume of particles by volume of voids, everywhere and always.
    Stated(f64),
    /// What the walk itself brings into each void.
    Walked(WalkedConcentration),
}

/// The word for a concentration that follows from the walk.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum WalkedConcentration {
    /// That of each void in each increment.
    #[serde(rename = "by-void")]
    ByVoid,
}

/// Which size counts in a void of mixed sizes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ArchSize {
    /// That of the particle that would pass.
    #[default]
    Own,
    /// The diameter of the mean volume of the particles in its void.
    VoidMean,
}

impl ArchSize {
    /// All of them, in the order in which a user is told of them.
    pub const ALL: [Self; 2] = [Self::Own, Self::VoidMean];

    /// The word that a scene says.
    pub fn name(self) -> &'static str {
        match self {
            Self::Own => "own",
            Self::VoidMean => "void-mean",
        }
    }
}

/// How the concentration of each void follows from the particles in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ByVoid {
    /// Volume of a void, as the cube of the diameter of a sphere of that volume, in units of the network's
    /// reference length cubed.
    pub void_cube: f64,
    /// Which size counts.
    pub size: ArchSize,
}

impl ByVoid {
    /// The ratio and the concentration for which a law is asked: of a particle of this size in front of a
    /// constriction of this width, both in units of the network's reference length, in a void with so many
    /// particles, itself included, whose diameters cubed add up to `cubes`.
    ///
    /// ```
    /// use voidwalk::walk::{ArchSize, ByVoid};
    ///
    /// let own = ByVoid { void_cube: 100.0, size: ArchSize::Own };
    /// // Four others of size 1 in a void as large as 100 of them.
    /// assert_eq!(own.asked(2.0, 1.0, 5, 5.0), (2.0, 0.04));
    /// // One of size 2 beside it: the mean volume is (1 + 8) / 2, the diameter of it 1.651.
    /// let mean = ByVoid { size: ArchSize::VoidMean, ..own };
    /// let (ratio, concentration) = mean.asked(2.0, 1.0, 2, 9.0);
    /// assert!((ratio - 2.0 / 4.5f64.cbrt()).abs() < 1e-12 && concentration == 0.08);
    /// ```
    pub fn asked(&self, width: f32, diameter: f32, number: u32, cubes: f64) -> (f64, f64) {
        let others = (cubes - cube(diameter)).max(0.0);
        let size = match self.size {
            ArchSize::Own => f64::from(diameter),
            ArchSize::VoidMean => cbrt(cubes / f64::from(number.max(1))),
        };
        // Of a particle that is alone nothing is left but the rounding of its own cube.
        let concentration = if number > 1 { (others / self.void_cube).min(DENSEST) } else { 0.0 };
        (f64::from(width) / size, concentration)
    }
}

/// The particles in each void that may arch: how many, and the sum of their diameters cubed.
pub(super) struct Crowd {
    of_void: Vec<(u32, f64)>,
}

impl Crowd {
    /// Those coarser than `passive_limit`, added in order: void and diameter of the particles of each chunk.
    pub fn of<'a>(
        chunks: impl Iterator<Item = (&'a [u32], &'a [f32])>,
        passive_limit: f32,
        voids: usize,
    ) -> Self {
        let mut of_void = vec![(0, 0.0); voids];
        for (void, diameter) in chunks {
            for (&void, &d) in void.iter().zip(diameter).filter(|&(_, &d)| d > passive_limit) {
                let (number, cubes) = &mut of_void[void as usize];
                *number += 1;
                *cubes += cube(d);
            }
        }
        Self { of_void }
    }

    /// How many are in a void, and the sum of their diameters cubed.
    #[inline]
    pub fn of_void(&self, void: u32) -> (u32, f64) {
        self.of_void[void as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_states_a_number_or_asks_for_the_walk() {
        let read = |text| serde_json::from_str::<Concentration>(text);
        assert_eq!(read("0.05").unwrap(), Concentration::Stated(0.05));
        assert_eq!(read("\"by-void\"").unwrap(), Concentration::Walked(WalkedConcentration::ByVoid));
        assert!(read("\"by-voids\"").is_err());
        for size in ArchSize::ALL {
            assert_eq!(serde_json::to_value(size).unwrap(), size.name());
        }
    }

    #[test]
    fn one_alone_has_no_others_and_many_lie_densely() {
        let own = ByVoid { void_cube: 0.1, size: ArchSize::Own };
        assert_eq!(own.asked(0.3, 0.1, 1, cube(0.1)), (f64::from(0.3f32) / f64::from(0.1f32), 0.0));
        assert_eq!(own.asked(2.0, 1.0, 1000, 1000.0).1, DENSEST);
    }
}
