//! Openings that a blocked constriction leaves beside the particle that blocks it.
//!
//! # Geometry
//! A constriction of size `D` is taken as the gap between three equal touching grains of diameter `G = D /
//! (2 / sqrt(3) - 1) = 6.46 D`. A particle of diameter `d` that does not pass rests on all three grains.
//! Between the particle and each pair of grains is an opening: the circle inscribed between their circles in
//! the plane of their centres ([`residual_opening`]). The third grain does not obstruct it: spheres that
//! touch three mutually touching spheres form a ring (Soddy's hexlet), in which the third grain is always
//! more than one position away. For `d = D` the opening is 0.406 `D`. It grows with `d` up to `D`, because
//! everything that passes the opening must pass `D` as well.
//!
//! # Rules
//! - The three openings beside a particle are equal and are treated as one exit of that size with three
//!   times its area, at most the area of the constriction.
//! - A particle coarser than the opening is stopped and sits between the same two grains, so the formula
//!   applies to it too, and narrows all three. The remaining opening is that beside the finest particle
//!   stopped there so far: a minimum, so the order of chunks and threads does not matter.
//! - The particles of an arch count as stopped particles.
//! - Water passes a blocked constriction through the three openings: it keeps `3 (x / D)^4` of its
//!   conductance, at most 1.
//! - No particle is passive: repeated narrowing can stop any particle.

use crate::schema::Leaf;
use bitvec::slice::BitSlice;
use bitvec::vec::BitVec;
use serde::{Deserialize, Serialize};

use crate::network::Network;

/// Size of the constriction of three equal touching grains, divided by the grain size: `2 / sqrt(3) - 1`.
const OF_GRAIN: f64 = 0.154_700_538_379_251_53;

const OPENINGS: f64 = 3.0;

/// Exponent of the diameter in the conductance of an opening relative to the whole constriction
/// (Hagen-Poiseuille).
pub(super) const CONDUCTS: f64 = 4.0;

/// Diameter of the opening between a particle and each pair of the three equal, touching grains of a
/// constriction, in the unit of the arguments; at most the size of the constriction.
///
/// `1 / x = 1 / d + 2 / G + 2 sqrt(1 / G^2 + 2 / (d G))` with `G = D / (2 / sqrt(3) - 1)`: Descartes'
/// circle theorem for the circle inscribed between three touching circles.
pub fn residual_opening(constriction: f64, particle: f64) -> f64 {
    let (grain, curvature) = (OF_GRAIN / constriction, 1.0 / particle);
    let inside = curvature + 2.0 * grain + 2.0 * (grain * (grain + 2.0 * curvature)).sqrt();
    (1.0 / inside).min(constriction)
}

/// Fraction that a constriction keeps of a quantity proportional to diameter to the power `exponent` (2
/// for area), if three openings `ratio` times as wide remain beside a particle.
pub(super) fn part_kept(ratio: f64, exponent: f64) -> f64 {
    if ratio > 0.0 { (OPENINGS * libm::pow(ratio, exponent)).min(1.0) } else { 0.0 }
}

/// Effect of a blocked constriction on later particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum BlockedAs {
    /// Closed, as in the paper.
    Closed,
    /// Open beside the blocking particle.
    Open,
}

impl Leaf for BlockedAs {}

impl BlockedAs {
    /// Both choices, in the order shown to users.
    pub const ALL: [Self; 2] = [Self::Closed, Self::Open];

    /// Name of the choice in a scene.
    pub fn name(self) -> &'static str {
        match self {
            Self::Closed => "closed",
            Self::Open => "open",
        }
    }
}

/// Constrictions of a network after a run, passed on to the next run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clogged {
    /// Bit `c`: constriction `c` is blocked.
    pub blocked: BitVec,
    /// Current width of the constriction of each exit, if blocked ones leave openings; empty if they are
    /// closed.
    pub widths: Vec<f32>,
}

impl From<BitVec> for Clogged {
    /// Creates the state of blocked constrictions without openings.
    fn from(blocked: BitVec) -> Self {
        Self { blocked, widths: Vec::new() }
    }
}

impl Clogged {
    /// Creates the state of a clean network.
    pub fn none(network: &Network) -> Self {
        BitVec::repeat(false, network.constrictions()).into()
    }
}

/// Opening created or narrowed by a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Narrowing {
    /// Increment in which a particle was stopped; the opening takes effect in the next one.
    pub increment: u64,
    /// Constriction, by the first of its exits.
    pub constriction: u32,
    /// Width before, in units of the network's reference length.
    pub before: f32,
    /// Width after, in the same units.
    pub after: f32,
}

/// Openings of a run, if blocked constrictions leave any.
#[derive(Clone, Debug, PartialEq)]
pub struct Openings {
    /// Width of the constriction of each exit, in units of the network's reference length.
    pub widths: Vec<f32>,
    /// Narrowings of this run, by increment, then by constriction.
    pub history: Vec<Narrowing>,
}

impl Openings {
    /// Creates the openings before the first increment of a run. Blocked constrictions without an opening
    /// are closed.
    pub(super) fn new(network: &Network, clogged: &Clogged) -> Self {
        let width_of = |c: usize| match clogged.widths.get(c) {
            Some(&width) => width,
            None if clogged.blocked[c] => 0.0,
            None => network.diameters()[c],
        };
        Self { widths: (0..network.constrictions()).map(width_of).collect(), history: Vec::new() }
    }

    /// Narrows the constriction of this exit, which stopped a particle of this size.
    pub(super) fn stop(&mut self, network: &Network, exit: usize, diameter: f32) {
        let left = residual_opening(f64::from(network.diameters()[exit]), f64::from(diameter)) as f32;
        if left < self.widths[exit] {
            let first = network.either_way(exit);
            let (constriction, before) = (first as u32, self.widths[exit]);
            self.history.push(Narrowing { increment: 0, constriction, before, after: left });
            self.set(network, exit, left);
        }
    }

    /// Merges the narrowings from entry `from` on into one per constriction, for one increment; returns
    /// these constrictions.
    pub(super) fn end_increment(&mut self, increment: u64, from: usize) -> Vec<u32> {
        let new = &mut self.history[from..];
        // Sorted by constriction, then from wide to narrow, which is their order in time.
        new.sort_by(|a, b| {
            (a.constriction, b.before).partial_cmp(&(b.constriction, a.before)).expect("numbers")
        });
        let mut kept = from;
        for at in from..self.history.len() {
            let next = Narrowing { increment, ..self.history[at] };
            match kept > from && self.history[kept - 1].constriction == next.constriction {
                true => self.history[kept - 1].after = next.after,
                false => {
                    self.history[kept] = next;
                    kept += 1;
                }
            }
        }
        self.history.truncate(kept);
        self.history[from..].iter().map(|narrowing| narrowing.constriction).collect()
    }

    /// Tells if a walk of this many increments can have left these openings, with no particles finer than
    /// `smallest`. Blocked constrictions must be no narrower than beside such a particle and equal in both
    /// directions, and the others unchanged. Each must have been narrowed step by step, at most once per
    /// increment.
    pub(super) fn can_be(
        &self,
        network: &Network,
        blocked: &BitSlice,
        increments: u64,
        smallest: f32,
    ) -> bool {
        let is_width = |c: usize, width: f32| {
            let whole = network.diameters()[c];
            let least = residual_opening(f64::from(whole), f64::from(smallest)) as f32;
            (least..=whole).contains(&width)
        };
        let of_exit = |(c, &width): (usize, &f32)| {
            let is_whole = width == network.diameters()[c];
            is_width(c, width)
                && (blocked[c] || is_whole)
                && network.twin(c).is_none_or(|twin| self.widths[twin] == width)
        };
        // Goes back from the current widths.
        let mut then = self.widths.clone();
        let mut of_history = |n: &Narrowing| {
            let c = n.constriction as usize;
            (1..=increments).contains(&n.increment)
                && c < blocked.len()
                && blocked[c]
                && network.twin(c).is_none_or(|twin| c < twin)
                && is_width(c, n.before)
                && n.after < n.before
                && std::mem::replace(&mut then[c], n.before) == n.after
        };
        let order = |n: &Narrowing| (n.increment, n.constriction);
        self.widths.iter().enumerate().all(of_exit)
            && self.history.iter().rev().all(&mut of_history)
            && self.history.windows(2).all(|pair| order(&pair[0]) < order(&pair[1]))
    }

    /// Sets the width of the constriction of an exit, in both directions.
    pub(super) fn set(&mut self, network: &Network, exit: usize, width: f32) {
        self.widths[exit] = width;
        if let Some(twin) = network.twin(exit) {
            self.widths[twin] = width;
        }
    }
}

/// Exits open to base particles.
#[derive(Clone, Copy)]
pub(super) enum Ways<'a> {
    Unblocked(&'a BitSlice),
    /// All exits with these widths, and their widths in the last solution of the flow if weights are fluxes.
    Openings(&'a [f32], Option<&'a [f32]>),
}

impl Ways<'_> {
    #[inline]
    pub(crate) fn weight(&self, network: &Network, c: usize) -> f64 {
        match *self {
            Self::Unblocked(blocked) => network.exit_weight(c) * f64::from(u8::from(!blocked[c])),
            Self::Openings(widths, then) => weight(network, c, widths[c], then.map(|then| then[c])),
        }
    }
}

/// Weight of an exit with this width. Not inlined, so that the check for blocked exits can be inlined.
#[inline(never)]
fn weight(network: &Network, c: usize, width: f32, then: Option<f32>) -> f64 {
    let whole = f64::from(network.diameters()[c]);
    let part = |width: f32, exponent| part_kept(f64::from(width) / whole, exponent);
    match (network.exit_weight(c), then) {
        // Closed from the start.
        (0.0, _) => 0.0,
        (weight, None) => weight * part(width, 2.0),
        (weight, Some(then)) => weight * (part(width, CONDUCTS) / part(then, CONDUCTS)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three grains of size 1 on a plane, a particle on them, and the circle of the formula: it touches
    /// the particle and two grains in the plane of their centres, and does not reach the third.
    #[test]
    fn the_opening_touches_the_particle_and_two_grains() {
        let size = |p: [f64; 3]| p.iter().map(|x| x * x).sum::<f64>().sqrt();
        let between = |a: [f64; 3], b: [f64; 3]| size([0, 1, 2].map(|i| a[i] - b[i]));
        let high = 3f64.sqrt() / 2.0;
        let [one, two, third] = [[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, high, 0.0]];
        for times in [1.0, 1.01, 1.5, 2.0, 4.0, 6.4] {
            let d = times * OF_GRAIN;
            // The particle rests above the middle of the grains and touches each of them.
            let (middle, reach) = (high / 3.0, (1.0 + d) / 2.0);
            let above = (reach * reach - 4.0 * middle * middle).max(0.0).sqrt();
            let particle = [0.0, middle, above];
            assert!((between(particle, third) - reach).abs() < 1e-9);
            let x = residual_opening(OF_GRAIN, d);
            // On the line from the midpoint of the two grains to the particle.
            let along = ((1.0 + x) / 2.0).powi(2) - 0.25;
            let to = size([0.0, middle, above]);
            let centre = [0.0, middle, above].map(|part| part / to * along.sqrt());
            for (sphere, touches) in [(one, 1.0), (two, 1.0), (particle, d)] {
                assert!((between(centre, sphere) - (touches + x) / 2.0).abs() < 1e-9, "{times}");
            }
            assert!(between(centre, third) > (1.0 + x) / 2.0 - 1e-9, "{times}");
        }
    }

    #[test]
    fn an_opening_grows_with_its_particle_up_to_the_constriction() {
        // By hand: 1 / (1 + 2 (2 / sqrt(3) - 1) + 2 / sqrt(3)).
        assert!((residual_opening(1.0, 1.0) - 0.405_826_9).abs() < 1e-6);
        let sizes = [0.1, 0.3, 0.5, 1.0, 1.5, 2.0, 4.0, 6.0];
        let widths = sizes.map(|d| residual_opening(1.0, d));
        assert!(widths.windows(2).all(|pair| pair[0] < pair[1]) && widths[7] < 1.0, "{widths:?}");
        // Stopped particles do not pass afterwards.
        assert!(sizes.iter().zip(widths).all(|(&d, width)| width < d));
        assert_eq!(residual_opening(1.0, 10.0), 1.0);
        // A factor of two on every length leaves the bits the same.
        assert_eq!(residual_opening(0.25, 0.375), 0.25 * residual_opening(1.0, 1.5));
    }

    #[test]
    fn three_openings_keep_at_most_all() {
        assert_eq!([part_kept(1.0, 2.0), part_kept(0.9, 2.0), part_kept(0.0, 2.0)], [1.0, 1.0, 0.0]);
        assert!((part_kept(0.5, 2.0) - 0.75).abs() < 1e-15 && (part_kept(0.5, 4.0) - 0.1875).abs() < 1e-15);
    }

    /// In one increment a constriction is narrowed once, from its old to its new width.
    #[test]
    fn what_happens_in_an_increment_is_one_narrowing() {
        let network = Network::cubic_from_diameters([1, 1, 2], vec![1.0; 6], 1.0).unwrap();
        let mut openings = Openings::new(&network, &Clogged::none(&network));
        for (exit, diameter) in [(4, 3.0), (1, 2.0), (4, 2.0), (4, 2.5), (1, 9.0), (4, 1.5)] {
            openings.stop(&network, exit, diameter);
        }
        assert_eq!(openings.end_increment(7, 0), [1, 4]);
        let left = |d: f64| residual_opening(1.0, d) as f32;
        let narrowing = |constriction, after| Narrowing { increment: 7, constriction, before: 1.0, after };
        assert_eq!(openings.history, [narrowing(1, left(2.0)), narrowing(4, left(1.5))]);
        openings.stop(&network, 1, 1.25);
        assert_eq!(openings.end_increment(9, 2), [1]);
        assert_eq!((openings.history[2].before, openings.history[2].after), (left(2.0), left(1.25)));
        let blocked: BitVec = [false, true, false, false, true, false].into_iter().collect();
        let can_be = |openings: &Openings| openings.can_be(&network, &blocked, 9, 1.25);
        assert!(can_be(&openings));
        assert!(!openings.can_be(&network, &blocked, 8, 1.25));
        assert!(!openings.can_be(&network, &BitVec::repeat(false, 6), 9, 1.25));
        // No particle was that fine.
        assert!(!openings.can_be(&network, &blocked, 9, 1.3));
        let forgeries: [fn(&mut Openings); 5] = [
            |o| o.widths[0] = 1.5,
            |o| o.widths[1] = o.history[0].after,
            |o| o.history[2].before = 1.0,
            |o| o.history[2].increment = 7,
            |o| o.history.swap(0, 1),
        ];
        for (at, forge) in forgeries.into_iter().enumerate() {
            let mut forged = openings.clone();
            forge(&mut forged);
            assert!(!can_be(&forged), "{at}");
        }
    }
}
