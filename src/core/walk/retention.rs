//! Retained particles and blocked constrictions, summed by layer, by connectivity and by void.

use super::State;
use crate::network::{NO_LAYER, Network};
use std::collections::BTreeMap;

/// Voids of one connectivity or layer, and what they hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Retention {
    /// Number of voids.
    pub voids: u64,
    /// Number of their constrictions.
    pub constrictions: u64,
    /// Number of these that are blocked.
    pub blocked: u64,
    /// Particles retained in constrictions.
    pub retained_in_constrictions: u64,
    /// Particles retained in voids, without trapped ones, which never settle.
    pub retained_in_voids: u64,
}

impl Retention {
    /// Adds the counts of another group.
    pub fn add(&mut self, other: &Self) {
        self.voids += other.voids;
        self.constrictions += other.constrictions;
        self.blocked += other.blocked;
        self.retained_in_constrictions += other.retained_in_constrictions;
        self.retained_in_voids += other.retained_in_voids;
    }

    /// Particles retained in voids and constrictions.
    pub fn retained(&self) -> u64 {
        self.retained_in_constrictions + self.retained_in_voids
    }
}

impl State {
    /// Sums by layer of voids, from the first downstream; a constriction of two directions counts once.
    pub fn by_layer(&self, network: &Network) -> Vec<Retention> {
        let mut layers = vec![Retention::default(); network.layers()];
        for (void, &layer) in network.layer_of().iter().enumerate().filter(|&(_, &layer)| layer != NO_LAYER) {
            let constrictions = network.exits(void as u32).filter(|&c| network.counts(c));
            layers[layer as usize].add(&self.of_void(void, constrictions));
        }
        layers
    }

    /// Sums by the number of exits of a void, ascending.
    pub fn by_connectivity(&self, network: &Network) -> BTreeMap<u64, Retention> {
        let mut sums = BTreeMap::<u64, Retention>::new();
        for (void, &exits) in network.connectivity().iter().enumerate() {
            let retention = self.of_void(void, network.exits(void as u32));
            sums.entry(exits.into()).or_default().add(&retention);
        }
        sums
    }

    fn of_void(&self, void: usize, exits: impl Iterator<Item = usize> + Clone) -> Retention {
        Retention {
            voids: 1,
            constrictions: exits.clone().count() as u64,
            blocked: exits.filter(|&c| self.blocked[c]).count() as u64,
            retained_in_constrictions: self.retained_in_constrictions[void],
            retained_in_voids: self.retained_in_voids[void],
        }
    }

    /// Fraction of the constrictions on a path from start to end that base particles can still use.
    pub fn backbone_fraction(&self, network: &Network) -> f64 {
        network.backbone_fraction(|c| !self.is_closed(network, c))
    }

    /// Volume of the resting particles over the volume of their void, for the fullest void with a volume,
    /// and the fraction of overfull voids; `None` where only an expected number in each void is known.
    pub fn fullness(&self, network: &Network) -> (Option<f64>, Option<f64>) {
        match self.passive.expected() {
            Some(_) => (None, None),
            None => fullness(network.volumes(), &self.retained_cubes),
        }
    }
}

/// Fraction of its volume above which a void is overfull: no packing of its particles is denser.
const OVERFULL: f64 = 0.6;

/// Fullness from volumes and sums of the cubed diameters of resting particles. A void without a volume has
/// no room: any particle makes it overfull by an unknown amount.
fn fullness(volumes: &[f64], cubes: &[f64]) -> (Option<f64>, Option<f64>) {
    let full = |(&volume, &cubes): (&f64, &f64)| match cubes > 0.0 {
        true if volume > 0.0 => std::f64::consts::FRAC_PI_6 * cubes / volume,
        true => f64::INFINITY,
        false => 0.0,
    };
    let fullness: Vec<f64> = volumes.iter().zip(cubes).map(full).collect();
    let overfull = fullness.iter().filter(|&&full| full > OVERFULL).count();
    let most = fullness.iter().copied().filter(|full| full.is_finite()).reduce(f64::max);
    (most, (!fullness.is_empty()).then(|| overfull as f64 / fullness.len() as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_void_without_volume_is_overfull_with_anything_and_leaves_the_fullest_finite() {
        let sphere = std::f64::consts::FRAC_PI_6;
        assert_eq!(fullness(&[1.0, 0.0, 0.0, 2.0], &[0.5, 3.0, 0.0, 2.0]), (Some(sphere), Some(0.25)));
        assert_eq!(fullness(&[1.0, 1.0], &[2.0, 0.0]), (Some(2.0 * sphere), Some(0.5)));
        // A volume close to zero is treated as zero.
        assert_eq!(fullness(&[5e-324, 1.0], &[1e300, 0.0]), (Some(0.0), Some(0.5)));
        assert_eq!(fullness(&[0.0], &[1.0]), (None, Some(1.0)));
        assert_eq!(fullness(&[], &[]), (None, None));
    }
}
