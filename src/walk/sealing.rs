//! Whether a run can erode nothing more.
//!
//! What is closed stays closed. Once no open constrictions lead from a start node to an end, all that is
//! inserted later stays; and once nothing moves in a void from which some lead to an end, what erodes is
//! known, whatever else is blocked. The rest of such a run is left out where nothing else is asked of it.
//! Where water flows, constrictions turn, and nothing is said.

use super::State;
use super::counts::Passive;
use super::leading::leading_to;
use crate::network::{END, Network};

/// Increments from one look to the next.
const BETWEEN_LOOKS: u64 = 16;

/// What the last look found.
#[derive(Default)]
pub(super) struct Sealing {
    /// Open constrictions from a start node to an end.
    way: Vec<u32>,
    /// No such way is left.
    is_sealed: bool,
    /// Changes for which `leads_out` holds.
    known: Option<usize>,
    /// By void: whether open constrictions lead from it to an end.
    leads_out: Vec<bool>,
}

impl Sealing {
    /// Whether nothing more erodes, for certain: what the state counts as eroded is what it will count at the
    /// end of the run. Looked at now and then.
    pub fn is_certain(&mut self, network: &Network, state: &State) -> bool {
        state.increment.is_multiple_of(BETWEEN_LOOKS) && self.is_sealed(network, state) && {
            let changes = Some(state.changes());
            if self.known != changes {
                let to_end = |exit: usize| network.targets()[exit] == END;
                let open = |exit: usize| !state.is_closed(network, exit);
                let ends = |void: &u32| network.exits(*void).any(|exit| open(exit) && to_end(exit));
                (self.known, self.leads_out) = (changes, leading_to(network, open, ends));
            }
            self.nothing_leaves(state)
        }
    }

    fn is_sealed(&mut self, network: &Network, state: &State) -> bool {
        let is_open = |&exit: &u32| !state.is_closed(network, exit as usize);
        if !self.is_sealed && (self.way.is_empty() || !self.way.iter().all(is_open)) {
            match way_out(network, state) {
                Some(way) => self.way = way,
                None => self.is_sealed = true,
            }
        }
        self.is_sealed
    }

    fn nothing_leaves(&self, state: &State) -> bool {
        let particles = &state.particles;
        let stays = |void: &u32| !self.leads_out[*void as usize];
        let one_by_one = (0..particles.live.len()).all(|chunk| particles.chunk(chunk).0.iter().all(stays));
        one_by_one
            && match &state.passive {
                Passive::OneByOne => true,
                Passive::Counts(moving) => {
                    moving.iter().zip(&self.leads_out).all(|(&n, &out)| n == 0 || !out)
                }
                Passive::Expected(expected) => expected.has_eroded(&self.leads_out),
            }
    }
}

/// Open constrictions from a start node to an end, the last of them first; `None` where there is no such way.
/// Depth first, downstream exits before sideways ones.
fn way_out(network: &Network, state: &State) -> Option<Vec<u32>> {
    const START: u32 = u32::MAX;
    const UNSEEN: u32 = u32::MAX - 1;
    let upstream = network.upstream();
    // By void: the constriction by which it was reached.
    let mut reached_by = vec![UNSEEN; network.voids()];
    let mut stack = Vec::new();
    for &start in network.start() {
        if reached_by[start as usize] == UNSEEN {
            reached_by[start as usize] = START;
            stack.push(start);
        }
        while let Some(void) = stack.pop() {
            for exit in network.exits(void).filter(|&exit| !state.is_closed(network, exit)) {
                let target = network.targets()[exit];
                if target == END {
                    let before = |&exit: &u32| {
                        let by = reached_by[upstream[exit as usize] as usize];
                        (by != START).then_some(by)
                    };
                    return Some(std::iter::successors(Some(exit as u32), before).collect());
                }
                if reached_by[target as usize] == UNSEEN {
                    reached_by[target as usize] = exit as u32;
                    stack.push(target);
                }
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use bitvec::vec::BitVec;

    use super::*;
    use crate::constrictions::{Curve, CurveUnit};
    use crate::gradation::{Gradation, SizeSampler};
    use crate::walk::{Engine, RunPlan, SizeClasses, Walk, WalkControl};

    /// Run after run on one network, walked to the end and left when it is sealed; returns after how many
    /// increments of the run.
    fn walked(engine: Engine, d0: f64, cu: f64, seed: u64) -> Vec<(bool, u64)> {
        let curve = Curve::from_points(&[(0.0, 0.1), (100.0, 0.3)], CurveUnit::Mm).unwrap();
        let network = Network::cubic([6, 6, 8], &curve, 1.0, seed).unwrap();
        let sampler = SizeSampler::new(&Gradation::linear_from_d0(d0, cu).unwrap(), 1.0).unwrap();
        let classes = || SizeClasses::logarithmic(d0 as f32, 3.0 * d0 as f32, 4);
        let mut open: BitVec = BitVec::repeat(false, network.constrictions());
        let mut found = Vec::new();
        for run in 1..=2 {
            let plan = RunPlan::new(engine, &network, &sampler, &open, 2_000);
            let supply = plan.supply(sampler.clone(), 200_000, 100, seed, run);
            let state = || State::new(&network, &supply, classes(), open.clone(), seed, run);
            let (mut whole, mut left) = (state(), state());
            let mut last = 0;
            Walk::new(&network, &supply, &whole).run(&mut whole, &mut |_| WalkControl::Continue).unwrap();
            let is_left = Walk::new(&network, &supply, &left).run_until_sealed(&mut left, &mut |state| {
                last = state.increment;
                WalkControl::Continue
            });
            let what = |state: &State| {
                let tally = &state.tally;
                let masses = [tally.inserted_mass, tally.eroded_mass].map(f64::to_bits);
                (tally.inserted, tally.eroded, tally.passive_eroded, tally.largest_eroded.to_bits(), masses)
            };
            assert_eq!(what(&whole), what(&left), "{engine:?} {d0} {cu} {seed}, run {run}, left at {last}");
            found.push((is_left.unwrap(), last));
            open = whole.blocked;
        }
        found
    }

    #[test]
    fn what_is_left_out_changes_nothing_that_eroded() {
        for engine in [Engine::Particles, Engine::Counts, Engine::Expected] {
            for seed in 1..=5 {
                // Coarse enough to seal: the second run is left at the first look.
                let sealed = walked(engine, 0.09, 6.0, seed);
                assert!(sealed.iter().all(|(is_left, _)| *is_left), "{engine:?} {seed}: {sealed:?}");
                assert!(
                    sealed[0].1 < 100 && sealed[1].1 <= 4 * BETWEEN_LOOKS,
                    "{engine:?} {seed}: {sealed:?}"
                );
                // So fine that nothing seals.
                let open = walked(engine, 0.04, 1.5, seed);
                assert!(open.iter().all(|(is_left, _)| !is_left), "{engine:?} {seed}: {open:?}");
            }
        }
    }

    #[test]
    fn a_way_out_leads_from_a_start_node_to_an_end() {
        let curve = Curve::from_points(&[(0.0, 0.1), (100.0, 0.3)], CurveUnit::Mm).unwrap();
        let network = Network::cubic([3, 3, 5], &curve, 1.0, 3).unwrap();
        let sampler = SizeSampler::new(&Gradation::linear_from_d0(0.08, 1.5).unwrap(), 1.0).unwrap();
        let supply = crate::walk::Supply::new(sampler, 10, 1);
        let open: BitVec = BitVec::repeat(false, network.constrictions());
        let classes = SizeClasses::logarithmic(0.08, 0.2, 4);
        let mut state = State::new(&network, &supply, classes, open, 3, 1);
        // Until none is left, the last constriction of every way is closed.
        let mut ways = 0;
        while let Some(way) = way_out(&network, &state) {
            let [last, first] = [way[0], way[way.len() - 1]].map(|exit| exit as usize);
            assert_eq!(network.targets()[last], END);
            assert!(network.start().contains(&network.upstream()[first]));
            let leads =
                |pair: &[u32]| network.targets()[pair[1] as usize] == network.upstream()[pair[0] as usize];
            assert!(way.windows(2).all(leads));
            state.blocked.set(last, true);
            ways += 1;
        }
        // Every constriction to the end was the last of one.
        assert_eq!(ways, 9);
    }
}
