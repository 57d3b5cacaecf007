//! What can be reached through open constrictions: the backbone, and the blocked set of one size.

use super::{END, NO_LAYER, Network, WIDE};

/// Where paths through passable constrictions lead, found breadth-first.
pub struct Reachability {
    /// Voids that a start node leads to.
    pub from_start: Vec<bool>,
    /// Voids from which the end can be reached.
    pub to_end: Vec<bool>,
}

impl Network {
    /// Follows the constrictions that `passable` admits, downstream from the start nodes and
    /// upstream from the end.
    pub fn reach(&self, passable: impl Fn(usize) -> bool) -> Reachability {
        let from_start = self.distances(&passable).into_iter().map(|d| d != NO_LAYER).collect();
        Reachability { from_start, to_end: self.leading_to_end(&passable) }
    }

    /// Whether an open way leads from a start node out of the network: nothing can leave any other, whatever
    /// it would hold.
    pub fn leads_out(&self) -> bool {
        let open = |c: usize| self.diameter[c] > 0.0;
        let reached = self.distances(open);
        let is_last = |&void: &u32| {
            reached[void as usize] != NO_LAYER && self.exits(void).any(|c| self.target[c] == END && open(c))
        };
        (0..self.voids() as u32).any(|void| is_last(&void))
    }

    /// Share of all constrictions that lie on a path from start to end through constrictions that
    /// `open` admits.
    pub fn backbone_fraction(&self, open: impl Fn(usize) -> bool) -> f64 {
        let reach = self.reach(&open);
        let mut on_path = 0u64;
        for void in (0..self.voids() as u32).filter(|&v| reach.from_start[v as usize]) {
            let leads_out = |&c: &usize| {
                let target = self.target[c];
                self.diameter[c] != WIDE && open(c) && (target == END || reach.to_end[target as usize])
            };
            on_path += self.exits(void).filter(leads_out).count() as u64;
        }
        on_path as f64 / self.passages().max(1) as f64
    }

    /// The constrictions that an unlimited supply of particles of diameter `d` blocks, whatever the
    /// seed: those finer than `d` whose upstream void can be reached from a start node through
    /// constrictions of at least `d`. Ascending.
    pub fn blocked_by_one_size(&self, d: f32) -> Vec<u32> {
        let distance = self.distances(|c| self.diameter[c] >= d && self.diameter[c] > 0.0);
        let mut blocked = Vec::new();
        for void in (0..self.voids() as u32).filter(|&v| distance[v as usize] != NO_LAYER) {
            let finer = |&c: &usize| self.diameter[c] < d && self.diameter[c] > 0.0;
            blocked.extend(self.exits(void).filter(finer).map(|c| c as u32));
        }
        blocked
    }

    /// Fewest moves from a start node to each void through `passable` constrictions, or [`NO_LAYER`].
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
                for exit in self.exits(void).filter(|&c| passable(c)) {
                    let target = self.target[exit];
                    if target != END && distance[target as usize] == NO_LAYER {
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
        let (begin, entrances) = self.entrances();
        let mut leads = vec![false; self.voids()];
        let mut stack = Vec::new();
        for void in 0..self.voids() as u32 {
            if self.exits(void).any(|c| self.target[c] == END && passable(c)) {
                leads[void as usize] = true;
                stack.push(void);
            }
        }
        let upstream = self.upstream();
        while let Some(void) = stack.pop() {
            for &entrance in &entrances[begin[void as usize] as usize..begin[void as usize + 1] as usize] {
                let above = upstream[entrance as usize];
                if passable(entrance as usize) && !leads[above as usize] {
                    leads[above as usize] = true;
                    stack.push(above);
                }
            }
        }
        leads
    }

    /// Constrictions by downstream void: those that lead into void `v` are
    /// `entrances[begin[v] .. begin[v + 1]]`, ascending.
    pub fn entrances(&self) -> (Vec<u32>, Vec<u32>) {
        let inner = || self.target.iter().enumerate().filter(|&(_, &t)| t != END);
        let mut begin = vec![0u32; self.voids() + 1];
        for (_, &target) in inner() {
            begin[target as usize + 1] += 1;
        }
        for void in 0..self.voids() {
            begin[void + 1] += begin[void];
        }
        let mut next = begin.clone();
        let mut entrances = vec![0u32; begin[self.voids()] as usize];
        for (constriction, &target) in inner() {
            entrances[next[target as usize] as usize] = constriction as u32;
            next[target as usize] += 1;
        }
        (begin, entrances)
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
        // With every +z exit of one layer closed nothing leads through.
        assert_eq!(network.backbone_fraction(|c| !(c % 3 == 2 && network.layer_of()[c / 3] == 1)), 0.0);
    }

    #[test]
    fn coarse_particles_block_every_exit_of_the_first_layer() {
        let network = Network::cubic_from_diameters([4, 5, 3], vec![1.0; 180], 1.0).unwrap();
        assert_eq!(network.blocked_by_one_size(2.0), (0..60).collect::<Vec<u32>>());
        assert_eq!(network.blocked_by_one_size(1.0), Vec::<u32>::new());
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
