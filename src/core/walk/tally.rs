//! Sums over a run: particle numbers, masses added in a fixed order, and both by size class.

use crate::network::FlowError;

/// Sums over a run up to and including an increment. Masses are sums of diameter cubed, in units of the
/// reference length cubed.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Tally {
    /// Number of base particles inserted.
    pub inserted: u64,
    /// Number of base particles still moving.
    pub moving: u64,
    /// Number of base particles that left the filter.
    pub eroded: u64,
    /// Number of base particles stopped by a constriction.
    pub retained_in_constrictions: u64,
    /// Number of base particles in arches, included in the former.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub retained_in_arches: u64,
    /// Number of arches.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub arches: u64,
    /// Mass in arches.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub arched_mass: f64,
    /// Number of base particles in voids without open exits.
    pub retained_in_voids: u64,
    /// Number of base particles trapped in closed loops.
    pub trapped: u64,
    /// Number of blocked constrictions, including those of earlier runs.
    pub blocked: u64,
    /// Number of completed moves, including those that leave; saturates at 2^64 - 1.
    pub particle_moves: u64,
    /// Mass inserted.
    pub inserted_mass: f64,
    /// Mass eroded.
    pub eroded_mass: f64,
    /// Number of passive base particles inserted.
    pub passive_inserted: u64,
    /// Number of passive base particles eroded.
    pub passive_eroded: u64,
    /// Diameter of the largest eroded particle; 0 if no particle has eroded.
    pub largest_eroded: f32,
}

fn is_zero<T: Default + PartialEq>(number: &T) -> bool {
    *number == T::default()
}

impl Tally {
    /// Adds the events of a chunk in an increment.
    pub(super) fn add(&mut self, chunk: &Self) {
        self.inserted += chunk.inserted;
        self.inserted_mass += chunk.inserted_mass;
        self.passive_inserted += chunk.passive_inserted;
        self.particle_moves = self.particle_moves.saturating_add(chunk.particle_moves);
        self.eroded += chunk.eroded;
        self.eroded_mass += chunk.eroded_mass;
        self.passive_eroded += chunk.passive_eroded;
        self.largest_eroded = self.largest_eroded.max(chunk.largest_eroded);
        self.retained_in_constrictions += chunk.retained_in_constrictions;
        self.retained_in_voids += chunk.retained_in_voids;
        let gone = chunk.eroded + chunk.retained_in_constrictions + chunk.retained_in_voids;
        self.moving = self.moving + chunk.inserted - gone;
    }

    pub(super) fn check(&self, increment: u64) -> Result<(), WalkError> {
        let all =
            [self.moving, self.eroded, self.retained_in_constrictions, self.retained_in_voids, self.trapped];
        // Corrupt counts may sum to more than 64 bits.
        let accounted = all.into_iter().fold(0u64, u64::saturating_add);
        match all.into_iter().map(u128::from).sum::<u128>() == u128::from(self.inserted) {
            true => Ok(()),
            false => Err(WalkError::NotConserved { increment, inserted: self.inserted, accounted }),
        }
    }
}

/// Bounds of size classes, ascending; class `k` holds diameters above bound `k - 1` up to bound `k`.
#[derive(Clone, Debug, PartialEq)]
pub struct SizeClasses {
    upper: Vec<f32>,
    /// Class of the smallest diameter of each bucket, and the bound above which the next class begins. A
    /// bucket holds diameters with equal top bits.
    guide: Vec<(u32, f32)>,
    /// Bucket of the first entry of `guide`.
    first_bucket: u32,
    /// True if a bucket contains more than one bound, for example with 64 classes over a size ratio below 7.
    several_bounds: bool,
}

/// Bits of an f32 below its bucket: 32 buckets in a factor of two.
const BELOW_BUCKET: u32 = 18;

impl SizeClasses {
    /// Creates `count` classes of equal width in the logarithm of the diameter, from `smallest` to
    /// `largest`; one class if the two are equal.
    pub fn logarithmic(smallest: f32, largest: f32, count: usize) -> Self {
        let ratio = libm::log(f64::from(largest) / f64::from(smallest));
        let bound = |k: usize| f64::from(smallest) * libm::exp(ratio * k as f64 / count as f64);
        let mut upper: Vec<f32> = (1..count).map(|k| bound(k) as f32).collect();
        upper.push(largest);
        upper.dedup();
        let bucket = |diameter: f32| diameter.to_bits() >> BELOW_BUCKET;
        let class = |diameter: f32| upper.partition_point(|&bound| bound < diameter);
        let first_bucket = bucket(upper[0]);
        let after_first = first_bucket + 1..=bucket(largest);
        let starts = after_first.map(|bucket| class(f32::from_bits(bucket << BELOW_BUCKET)));
        // Sizes above the last bound belong to the last class.
        let bound = |class: usize| if class + 1 < upper.len() { upper[class] } else { f32::INFINITY };
        let entry = |class: usize| (class as u32, bound(class));
        let guide: Vec<(u32, f32)> = std::iter::once(0).chain(starts).map(entry).collect();
        let several_bounds = upper.windows(2).any(|bounds| bucket(bounds[0]) == bucket(bounds[1]));
        Self { upper, guide, first_bucket, several_bounds }
    }

    /// Upper bound of each class.
    pub fn upper(&self) -> &[f32] {
        &self.upper
    }

    /// Class of a diameter; sizes above the last bound belong to the last class.
    #[inline]
    pub(crate) fn of(&self, diameter: f32) -> usize {
        let bucket = (diameter.to_bits() >> BELOW_BUCKET).saturating_sub(self.first_bucket) as usize;
        let (class, bound) = self.guide[bucket.min(self.guide.len() - 1)];
        let mut class = class as usize + usize::from(bound < diameter);
        if self.several_bounds {
            let last = self.upper.len() - 1;
            while class < last && self.upper[class] < diameter {
                class += 1;
            }
        }
        class
    }
}

/// Number and mass by size class.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SizeCounts {
    /// Number of particles by class.
    pub number: Vec<u64>,
    /// Sum of diameter cubed by class.
    pub mass: Vec<f64>,
}

impl SizeCounts {
    pub(crate) fn new(classes: &SizeClasses) -> Self {
        Self { number: vec![0; classes.upper.len()], mass: vec![0.0; classes.upper.len()] }
    }

    #[inline]
    pub(super) fn add(&mut self, classes: &SizeClasses, diameter: f32) {
        let class = classes.of(diameter);
        self.number[class] += 1;
        self.mass[class] += cube(diameter);
    }

    pub(super) fn clear(&mut self) {
        self.number.fill(0);
        self.mass.fill(0.0);
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        self.number.iter_mut().zip(&other.number).for_each(|(sum, n)| *sum += n);
        self.mass.iter_mut().zip(&other.mass).for_each(|(sum, mass)| *sum += mass);
    }
}

/// Diameter cubed, the mass in units of the reference length cubed.
#[inline]
pub(super) fn cube(diameter: f32) -> f64 {
    let d = f64::from(diameter);
    d * d * d
}

/// Reason why a walk ended early.
#[derive(Debug, thiserror::Error)]
pub enum WalkError {
    /// Not all inserted particles are accounted for.
    #[error("increment {increment}: {inserted} base particles inserted, but {accounted} accounted for")]
    NotConserved {
        /// Number of the increment.
        increment: u64,
        /// Number of particles inserted so far.
        inserted: u64,
        /// Number of moving, retained, trapped and eroded particles.
        accounted: u64,
    },
    /// The flow through the network is unknown.
    #[error("increment {increment}: {source}")]
    Flow {
        /// Number of the increment.
        increment: u64,
        /// Reason.
        source: FlowError,
    },
    /// The caller requested a stop.
    #[error("stopped on request in increment {increment}")]
    Stopped {
        /// Last completed increment.
        increment: u64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lost_particle_is_noticed() {
        let tally = Tally { inserted: 5, moving: 1, eroded: 1, trapped: 2, ..Tally::default() };
        let error = tally.check(3).unwrap_err().to_string();
        assert_eq!(error, "increment 3: 5 base particles inserted, but 4 accounted for");
        assert!(Tally { retained_in_voids: 1, ..tally }.check(3).is_ok());
        // 2^64 + 5 particles are not 5.
        assert!(Tally { retained_in_voids: u64::MAX, trapped: 4, ..tally }.check(3).is_err());
    }

    #[test]
    fn classes_cover_their_range() {
        let classes = SizeClasses::logarithmic(1.0, 8.0, 3);
        assert_eq!(classes.upper().len(), 3);
        assert_eq!([classes.of(1.0), classes.of(1.9), classes.of(2.1), classes.of(8.0)], [0, 0, 1, 2]);
        assert_eq!(classes.of(9.0), 2);
        assert_eq!(SizeClasses::logarithmic(2.0, 2.0, 64).upper(), [2.0]);
    }

    /// Compares with the definition: at and next to every bound, at the start of every bucket, and far
    /// outside.
    #[test]
    fn the_guide_finds_the_class_by_definition() {
        for (smallest, largest, count) in [
            (1.0, 8.0, 3),
            (0.016, 0.33, 64),
            (1e-20, 1e20, 64),
            (0.2, 0.45, 64),
            (1.0, 1.01, 500),
            (2.0, 2.0, 1),
            (1e-3, 1.0, 1),
        ] {
            let classes = SizeClasses::logarithmic(smallest, largest, count);
            let starts = (0..1u32 << 13).map(|bucket| f32::from_bits(bucket << BELOW_BUCKET));
            let probes = starts.chain(classes.upper().iter().copied()).filter(|d| d.is_finite() && *d > 0.0);
            for d in probes.flat_map(|d| [d.next_down(), d, d.next_up()]) {
                let by_definition = classes.upper().iter().filter(|&&bound| bound < d).count();
                assert_eq!(classes.of(d), by_definition.min(classes.upper().len() - 1), "{d}");
            }
        }
    }
}
