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
//! one that would pass ([`ArchSize::Own`]), has the mean volume of all in its void
//! ([`ArchSize::VoidMean`]), or is the D85 of them ([`ArchSize::VoidD85`]). In each case the particle itself
//! must be coarse enough for the law.
//!
//! The D85 of a void is the finest size for which the particles no coarser hold 85 % of the volume or more.
//! It is added up from the finest on, so that it does not depend on the order of the particles.
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
    /// The size than which particles with 85 % of the volume in its void are no coarser.
    #[serde(rename = "void-d85")]
    VoidD85,
}

impl ArchSize {
    /// All of them, in the order in which a user is told of them.
    pub const ALL: [Self; 3] = [Self::Own, Self::VoidMean, Self::VoidD85];

    /// The word that a scene says.
    pub fn name(self) -> &'static str {
        match self {
            Self::Own => "own",
            Self::VoidMean => "void-mean",
            Self::VoidD85 => "void-d85",
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
    /// constriction of this width, both in units of the network's reference length, in a void with these
    /// particles, itself included.
    ///
    /// ```
    /// use voidwalk::walk::{ArchSize, ByVoid, VoidCrowd};
    ///
    /// let own = ByVoid { void_cube: 100.0, size: ArchSize::Own };
    /// // Four others of size 1 in a void as large as 100 of them.
    /// let five = VoidCrowd { number: 5, cubes: 5.0, d85: 1.0 };
    /// assert_eq!(own.asked(2.0, 1.0, five), (2.0, 0.04));
    /// // One of size 2 beside it: the mean volume is (1 + 8) / 2, the diameter of it 1.651; 8 of 9 parts of
    /// // the volume are in the coarser one.
    /// let two = VoidCrowd { number: 2, cubes: 9.0, d85: 2.0 };
    /// let mean = ByVoid { size: ArchSize::VoidMean, ..own };
    /// let (ratio, concentration) = mean.asked(2.0, 1.0, two);
    /// assert!((ratio - 2.0 / 4.5f64.cbrt()).abs() < 1e-12 && concentration == 0.08);
    /// assert_eq!(ByVoid { size: ArchSize::VoidD85, ..own }.asked(2.0, 1.0, two), (1.0, 0.08));
    /// ```
    pub fn asked(&self, width: f32, diameter: f32, crowd: VoidCrowd) -> (f64, f64) {
        let others = (crowd.cubes - cube(diameter)).max(0.0);
        let size = match self.size {
            ArchSize::Own => f64::from(diameter),
            ArchSize::VoidMean => cbrt(crowd.cubes / f64::from(crowd.number.max(1))),
            ArchSize::VoidD85 => f64::from(crowd.d85),
        };
        // Of a particle that is alone nothing is left but the rounding of its own cube.
        let concentration = if crowd.number > 1 { (others / self.void_cube).min(DENSEST) } else { 0.0 };
        (f64::from(width) / size, concentration)
    }
}

/// The particles in a void that may arch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VoidCrowd {
    /// How many.
    pub number: u32,
    /// D85 of them, in units of the network's reference length; 0 where it does not count.
    pub d85: f32,
    /// The sum of their diameters cubed.
    pub cubes: f64,
}

/// The particles in each void that may arch.
pub(super) struct Crowd {
    of_void: Vec<VoidCrowd>,
}

impl Crowd {
    /// Those coarser than `passive_limit`, added in order: void and diameter of the particles of each chunk.
    pub fn of<'a>(
        chunks: impl Iterator<Item = (&'a [u32], &'a [f32])> + Clone,
        passive_limit: f32,
        voids: usize,
        size: ArchSize,
    ) -> Self {
        let counted = chunks
            .flat_map(|(void, diameter)| void.iter().copied().zip(diameter.iter().copied()))
            .filter(|&(_, d)| d > passive_limit);
        let mut of_void = vec![VoidCrowd::default(); voids];
        counted.clone().for_each(|(void, d)| {
            let crowd = &mut of_void[void as usize];
            crowd.number += 1;
            crowd.cubes += cube(d);
        });
        if size == ArchSize::VoidD85 {
            find_d85(counted, &mut of_void);
        }
        Self { of_void }
    }

    /// Those of a void.
    #[inline]
    pub fn of_void(&self, void: u32) -> VoidCrowd {
        self.of_void[void as usize]
    }
}

/// The D85 of each void whose particles were counted.
fn find_d85(counted: impl Iterator<Item = (u32, f32)>, of_void: &mut [VoidCrowd]) {
    // The sizes void by void: where those of each begin, then where the next of it comes.
    let mut next: Vec<usize> = of_void
        .iter()
        .scan(0, |at, crowd| Some(std::mem::replace(at, *at + crowd.number as usize)))
        .collect();
    let mut sizes = vec![0.0; of_void.iter().map(|crowd| crowd.number as usize).sum()];
    counted.for_each(|(void, d)| {
        let at = &mut next[void as usize];
        sizes[*at] = d;
        *at += 1;
    });
    for (crowd, end) in of_void.iter_mut().zip(next) {
        let sizes = &mut sizes[end - crowd.number as usize..end];
        sizes.sort_unstable_by(f32::total_cmp);
        crowd.d85 = d85(sizes);
    }
}

/// Of sizes from the finest on; 0 of none.
fn d85(sizes: &[f32]) -> f32 {
    let wanted = 0.85 * sizes.iter().map(|&d| cube(d)).sum::<f64>();
    let mut finer = 0.0;
    let reaches = |&&d: &&f32| {
        finer += cube(d);
        finer >= wanted
    };
    sizes.iter().find(reaches).copied().unwrap_or(0.0)
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
        assert_eq!(
            own.asked(0.3, 0.1, VoidCrowd { number: 1, cubes: cube(0.1), d85: 0.1 }),
            (f64::from(0.3f32) / f64::from(0.1f32), 0.0)
        );
        assert_eq!(own.asked(2.0, 1.0, VoidCrowd { number: 1000, cubes: 1000.0, d85: 1.0 }).1, DENSEST);
    }

    /// By hand: sizes 1, 1, 2 and 3 have the volumes 1, 1, 8 and 27 of 37; without the coarsest 27 %.
    #[test]
    fn the_d85_of_a_void_is_where_85_percent_of_its_volume_lie() {
        let of = |sizes: &[f32], voids: &[u32]| {
            let half = sizes.len() / 2;
            let (front, back) = ((&voids[..half], &sizes[..half]), (&voids[half..], &sizes[half..]));
            Crowd::of([front, back].into_iter(), 0.5, 3, ArchSize::VoidD85)
        };
        // In any order and any chunk; the passive one of 0.4 does not count, nor does that of another void.
        let crowd = of(&[3.0, 1.0, 0.4, 2.0, 1.0, 1.5], &[1, 1, 1, 1, 1, 2]);
        assert_eq!(crowd.of_void(1), VoidCrowd { number: 4, cubes: 37.0, d85: 3.0 });
        assert_eq!((crowd.of_void(0), crowd.of_void(2).d85), (VoidCrowd::default(), 1.5));
        // Twenty of size 1 and one of 1.5: 20 of 23.375 parts, 85.6 %.
        let mut sizes = vec![1.0; 21];
        sizes[4] = 1.5;
        assert_eq!(of(&sizes, &[0; 21]).of_void(0).d85, 1.0);
        // Nineteen of them: 19 of 22.375 parts, 84.9 %.
        sizes.pop();
        assert_eq!(of(&sizes, &[0; 20]).of_void(0).d85, 1.5);
    }
}
