//! Reach of paths through open constrictions: the backbone, and the blocked set of one size.

use super::in_order_of_voids;
use super::{END, NO_LAYER, Network, WIDE};

impl Network {
    /// Tells if an open path leads from a start node out of the network; otherwise no particle can leave.
    pub fn leads_out(&self) -> bool {
        self.leads_out_by(|c| self.diameter[c] > 0.0)
    }

    /// Tells if a path through constrictions that `open` admits leads from a start node out of the network.
    pub(super) fn leads_out_by(&self, open: impl Fn(usize) -> bool) -> bool {
        let reached = self.distances(&open);
        let is_last = |c: usize| self.target[c] == END && open(c);
        let mut voids = (0..self.voids() as u32).filter(|&void| reached[void as usize] != NO_LAYER);
        voids.any(|void| self.exits(void).any(is_last))
    }

    /// Fraction of all constrictions that lie on a path from start to end through constrictions that
    /// `open` admits.
    pub(crate) fn backbone_fraction(&self, open: impl Fn(usize) -> bool) -> f64 {
        let to_end = self.leading_to_end(&open);
        let (mut reached, mut stack, mut on_path) = (vec![false; self.voids()], self.start.clone(), 0u64);
        self.start.iter().for_each(|&void| reached[void as usize] = true);
        while let Some(void) = stack.pop() {
            for c in self.exits(void).filter(|&c| open(c)) {
                let target = self.target[c];
                let leads_out = target == END || to_end[target as usize];
                on_path += u64::from(leads_out && self.diameter[c] != WIDE);
                if target != END && !std::mem::replace(&mut reached[target as usize], true) {
                    stack.push(target);
                }
            }
        }
        on_path as f64 / self.passages().max(1) as f64
    }

    /// Constrictions blocked by an unlimited supply of particles of diameter `d`, for any seed, in
    /// ascending order: constrictions finer than `d` whose upstream void can be reached from a start node
    /// through constrictions of at least `d`.
    pub fn blocked_by_one_size(&self, d: f32) -> Vec<u32> {
        let distance = self.distances(|c| self.diameter[c] >= d && self.diameter[c] > 0.0);
        let mut blocked = Vec::new();
        for void in (0..self.voids() as u32).filter(|&v| distance[v as usize] != NO_LAYER) {
            let finer = |&c: &usize| self.diameter[c] < d && self.diameter[c] > 0.0;
            blocked.extend(self.exits(void).filter(finer).map(|c| c as u32));
        }
        blocked
    }

    /// Minimum number of moves from a start node to each void through `passable` constrictions, or
    /// [`NO_LAYER`].
    pub(super) fn distances(&self, passable: impl Fn(usize) -> bool) -> Vec<u32> {
        let mut distance = vec![NO_LAYER; self.voids()];
        let mut front: Vec<u32> = self.start.clone();
        for &void in &front {
            distance[void as usize] = 0;
        }
        let mut moves = 0;
        while !front.is_empty() {
            moves += 1;
            let mut next = Vec::new();
            for void in front {
                for exit in self.exits(void) {
                    let target = self.target[exit];
                    // Most voids have been reached already, and this check is cheaper than `passable`.
                    if target != END && distance[target as usize] == NO_LAYER && passable(exit) {
                        distance[target as usize] = moves;
                        next.push(target);
                    }
                }
            }
            front = next;
        }
        distance
    }

    fn leading_to_end(&self, passable: impl Fn(usize) -> bool) -> Vec<bool> {
        let is_last = |&void: &u32| self.exits(void).any(|c| self.target[c] == END && passable(c));
        // On a lattice these voids are in the last layer.
        let first = self.shape.map_or(0, |[nx, ny, nz]| nx * ny * (nz - 1));
        self.leading_to((first..self.voids() as u32).filter(is_last).collect(), passable)
    }

    /// True for each void of `those`, and each from which `passable` constrictions lead to one of them.
    pub(crate) fn leading_to(&self, those: Vec<u32>, passable: impl Fn(usize) -> bool) -> Vec<bool> {
        let mut leads = vec![false; self.voids()];
        those.iter().for_each(|&void| leads[void as usize] = true);
        if let Some(shape) = self.shape {
            spread_upstream(shape, &open_exits(self.voids(), passable), &mut leads);
            return leads;
        }
        let (mut stack, ((begin, entrances), upstream)) = (those, (self.entrances(), self.upstream()));
        while let Some(void) = stack.pop() {
            for &entrance in &entrances[begin[void as usize] as usize..begin[void as usize + 1] as usize] {
                let from = upstream[entrance as usize];
                if !leads[from as usize] && passable(entrance as usize) {
                    leads[from as usize] = true;
                    stack.push(from);
                }
            }
        }
        leads
    }

    /// Constrictions by downstream void (`begin`, `entrances`): `entrances[begin[v] .. begin[v + 1]]` lead
    /// into void `v`, in ascending order.
    pub(crate) fn entrances(&self) -> (Vec<u32>, Vec<u32>) {
        let inner = || self.target.iter().copied().zip(0u32..).filter(|&(target, _)| target != END);
        let (begin, slots) = in_order_of_voids(self.voids(), inner().map(|(target, _)| target));
        let mut entrances = vec![0u32; slots.len()];
        for (slot, (_, constriction)) in slots.into_iter().zip(inner()) {
            entrances[slot as usize] = constriction;
        }
        (begin, entrances)
    }
}

/// Bits for the exits of a lattice void.
const ALONG_X: u8 = 1;
const ALONG_Y: u8 = 2;
const ALONG_Z: u8 = 4;

/// Bits of the open exits of each lattice void.
fn open_exits(voids: usize, open: impl Fn(usize) -> bool) -> Vec<u8> {
    let of_void = |v| (0..3).fold(0, |bits, e| bits | u8::from(open(3 * v + e)) << e);
    (0..voids).map(of_void).collect()
}

/// Marks the lattice voids from which open exits lead to marked voids. Works layer by layer, as no exit
/// leads back into a layer, so that memory access stays local.
fn spread_upstream(shape: [u32; 3], open: &[u8], leads: &mut [bool]) {
    let [nx, ny, nz] = shape.map(|n| n as usize);
    let plane = nx * ny;
    let mut stack = Vec::new();
    for layer in (0..plane * nz).step_by(plane).rev() {
        for v in layer..layer + plane {
            let leads_down = || open[v] & ALONG_Z > 0 && leads.get(v + plane).is_some_and(|&below| below);
            if leads[v] || leads_down() {
                leads[v] = true;
                stack.push(v);
            }
        }
        while let Some(v) = stack.pop() {
            // Upstream neighbours along x and y.
            let by_x = if v % nx == 0 { v + nx - 1 } else { v - 1 };
            let by_y = if v - layer < nx { v + plane - nx } else { v - nx };
            for (before, along) in [(by_x, ALONG_X), (by_y, ALONG_Y)] {
                if open[before] & along > 0 && !leads[before] {
                    leads[before] = true;
                    stack.push(before);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clean_lattice_is_all_backbone() {
        let network = Network::cubic_from_diameters([3, 3, 4], vec![1.0; 108], 1.0).unwrap();
        assert_eq!(network.backbone_fraction(|_| true), 1.0);
        assert_eq!(network.backbone_fraction(|_| false), 0.0);
        // With every +z exit of one layer closed, no path leads through.
        assert_eq!(network.backbone_fraction(|c| !(c % 3 == 2 && network.layer_of()[c / 3] == 1)), 0.0);
    }

    #[test]
    fn coarse_particles_block_every_exit_of_the_first_layer() {
        let network = Network::cubic_from_diameters([4, 5, 3], vec![1.0; 180], 1.0).unwrap();
        assert_eq!(network.blocked_by_one_size(2.0), (0..60).collect::<Vec<u32>>());
        assert_eq!(network.blocked_by_one_size(1.0), Vec::<u32>::new());
    }

    /// Number of open constrictions whose void is reached from the start and whose target leads to the end,
    /// after as many rounds over all of them as there are voids.
    fn on_paths(network: &Network, open: impl Fn(usize) -> bool) -> usize {
        let (upstream, targets) = (network.upstream(), network.targets());
        let [mut reached, mut leads_out] = [(); 2].map(|()| vec![false; network.voids()]);
        network.start().iter().for_each(|&void| reached[void as usize] = true);
        let ends = |c: usize| (upstream[c] as usize, (targets[c] != END).then_some(targets[c] as usize));
        for _ in 0..network.voids() {
            for (from, to) in (0..targets.len()).filter(|&c| open(c)).map(ends) {
                leads_out[from] |= to.is_none_or(|to| leads_out[to]);
                to.into_iter().for_each(|to| reached[to] |= reached[from]);
            }
        }
        let is_on_path =
            |(from, to): &(usize, Option<usize>)| reached[*from] && to.is_none_or(|to| leads_out[to]);
        (0..targets.len()).filter(|&c| open(c)).map(ends).filter(is_on_path).count()
    }

    /// Upstream voids are computed on a lattice and looked up in other networks.
    #[test]
    fn as_many_voids_lead_on_in_a_lattice_as_in_the_network_that_it_is() {
        for shape in [[4, 3, 5], [1, 4, 3], [5, 1, 3], [1, 1, 4], [2, 2, 1]] {
            let count = Network::lattice_constrictions(shape).unwrap();
            let lattice = Network::cubic_from_diameters(shape, vec![1.0; count], 1.0).unwrap();
            let network = Network { shape: None, ..lattice.clone() };
            let mut some = 0;
            for closed in 2..9 {
                let open = |c: usize| !(c * 7919 % 101).is_multiple_of(closed);
                let those = || vec![(closed * 5 % lattice.voids()) as u32, lattice.voids() as u32 - 1];
                let [led, expected] = [&lattice, &network].map(|network| network.leading_to(those(), open));
                assert_eq!(led, expected, "{shape:?}");
                let [to_end, expected_end] = [&lattice, &network].map(|network| network.leading_to_end(open));
                assert_eq!(to_end, expected_end, "{shape:?}");
                let expected = on_paths(&network, open) as f64 / count as f64;
                assert_eq!(
                    [&lattice, &network].map(|n| n.backbone_fraction(open)),
                    [expected; 2],
                    "{shape:?}"
                );
                some += [&led, &to_end].into_iter().flatten().filter(|&&leads| leads).count();
            }
            assert!(some > 7, "{shape:?}: nothing led anywhere");
        }
    }

    #[test]
    fn entrances_are_the_exits_turned_round() {
        let network = Network::cubic_from_diameters([3, 2, 2], vec![1.0; 36], 1.0).unwrap();
        let (begin, entrances) = network.entrances();
        let upstream = network.upstream();
        for void in 0..network.voids() {
            for &c in &entrances[begin[void] as usize..begin[void + 1] as usize] {
                assert_eq!(network.targets()[c as usize] as usize, void);
                assert!(network.exits(upstream[c as usize]).contains(&(c as usize)));
            }
        }
        assert_eq!(entrances.len(), 36 - 6);
    }
}
