//! Fluxes by elimination without subtraction, for any contrast of conductances.
//!
//! A void is eliminated by joining each two of its neighbours by `g_j g_k / sum of g`. All numbers are
//! positive and are only multiplied, divided and added, so each is accurate to a few roundings (Grassmann,
//! Taksar & Heyman 1985, doi:10.1287/opre.33.5.1107). Across a constriction of very high conductance
//! pressures differ by less than a float can hold, so differences (falls) are computed instead, from the last
//! void to the first: the fall from a void to a neighbour is the mean of the falls from all its neighbours to
//! that neighbour, weighted by conductance.

use super::system::PAIRS;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Turn of a node that is never eliminated.
const LAST: u32 = u32::MAX;

#[derive(Clone, Copy, Debug)]
struct Neighbour {
    node: u32,
    /// Conductance to the neighbour, as a fraction of all conductance from the void.
    part: f64,
    /// Pressure of the void minus pressure of the neighbour.
    fall: f64,
}

/// Pressure differences between neighbours, with pressure 1 at the first of two known nodes and 0 at the
/// second. The known nodes come last.
#[derive(Debug)]
pub(super) struct Eliminated {
    /// Neighbours of each node at its elimination, in rising order.
    rows: Vec<Vec<Neighbour>>,
    turn: Vec<u32>,
    /// Pressure by node, the known ones last.
    pub(crate) pressure: Vec<f64>,
    /// Conductance between the two known nodes.
    pub(crate) conductance: f64,
}

impl Eliminated {
    /// Eliminates this many nodes, joined by `links` with one another and with two known nodes; `None` if
    /// that takes too much work or a conductance is not finite. Every node must be connected to both known
    /// nodes.
    pub(super) fn new(nodes: usize, links: impl Iterator<Item = (u32, u32, f64)>) -> Option<Self> {
        let [high, low] = [nodes as u32, nodes as u32 + 1];
        let is_known = |node: u32| node >= high;
        let mut met: Vec<Vec<(u32, f64)>> = vec![Vec::new(); nodes];
        let mut conductance = 0.0;
        for (one, other, g) in links.filter(|(one, other, _)| one != other) {
            if is_known(one) && is_known(other) {
                conductance += g;
            }
            for (node, met_by) in [(one, other), (other, one)] {
                // Known nodes have no row here.
                if let Some(row) = met.get_mut(node as usize) {
                    row.push((met_by, g));
                }
            }
        }
        for row in &mut met {
            row.sort_by_key(|&(node, _)| node);
            row.dedup_by(|next, kept| {
                let is_same = next.0 == kept.0;
                if is_same {
                    kept.1 += next.1;
                }
                is_same
            });
        }
        let mut rows: Vec<Vec<Neighbour>> = vec![Vec::new(); nodes];
        let mut turn = vec![LAST; nodes + 2];
        let mut queue: BinaryHeap<Reverse<(usize, u32)>> =
            met.iter().zip(0..).map(|(row, node)| Reverse((row.len(), node))).collect();
        let (mut order, mut pairs) = (Vec::with_capacity(nodes), 0);
        while let Some(Reverse((count, node))) = queue.pop() {
            let at = node as usize;
            if turn[at] != LAST || met[at].len() != count {
                continue;
            }
            pairs += count * count;
            if pairs > PAIRS {
                return None;
            }
            turn[at] = order.len() as u32;
            order.push(node);
            let row = std::mem::take(&mut met[at]);
            let sum: f64 = row.iter().map(|&(_, g)| g).sum();
            if !sum.is_normal() {
                return None;
            }
            let part = |&(node, g): &(u32, f64)| Neighbour { node, part: g / sum, fall: 0.0 };
            rows[at] = row.iter().map(part).collect();
            for &(other, g) in row.iter().filter(|&&(other, _)| !is_known(other)) {
                met[other as usize] = joined(&met[other as usize], &rows[at], (node, other), g);
                queue.push(Reverse((met[other as usize].len(), other)));
            }
            if let [.., Neighbour { node: a, part, .. }, Neighbour { node: b, .. }] = rows[at][..]
                && [a, b] == [high, low]
            {
                conductance += part * row[row.len() - 1].1;
            }
        }
        let mut pressure = vec![0.0; nodes + 2];
        pressure[nodes] = 1.0;
        let mut eliminated = Self { rows, turn, pressure, conductance };
        for node in order.into_iter().rev() {
            eliminated.put_back(node as usize);
        }
        Some(eliminated)
    }

    /// Computes the pressure and the falls of a node from those of its neighbours.
    fn put_back(&mut self, node: usize) {
        let row = std::mem::take(&mut self.rows[node]);
        let fall = |to: &Neighbour| {
            row.iter()
                .filter(|from| from.node != to.node)
                .map(|from| from.part * self.fall(from.node, to.node))
                .sum()
        };
        let falls: Vec<f64> = row.iter().map(fall).collect();
        self.pressure[node] = row.iter().map(|other| other.part * self.pressure[other.node as usize]).sum();
        self.rows[node] = row.iter().zip(falls).map(|(other, fall)| Neighbour { fall, ..*other }).collect();
    }

    pub(super) fn fall(&self, one: u32, other: u32) -> f64 {
        let [first, second] = [one, other].map(|node| self.turn[node as usize]);
        match (first == LAST, second == LAST) {
            (true, true) => self.pressure[one as usize] - self.pressure[other as usize],
            _ if first < second => self.of_row(one, other),
            _ => -self.of_row(other, one),
        }
    }

    fn of_row(&self, node: u32, other: u32) -> f64 {
        let row = &self.rows[node as usize];
        row.binary_search_by_key(&other, |met| met.node).map_or(0.0, |at| row[at].fall)
    }
}

/// Neighbours of a node after its neighbour `gone`, with conductance `g`, is eliminated: the remaining
/// ones and the new ones.
fn joined(row: &[(u32, f64)], of_gone: &[Neighbour], (gone, node): (u32, u32), g: f64) -> Vec<(u32, f64)> {
    let mut old = row.iter().copied().filter(|&(other, _)| other != gone).peekable();
    let new = of_gone.iter().filter(|met| met.node != node).map(|met| (met.node, g * met.part));
    let mut all = Vec::with_capacity(row.len() + of_gone.len());
    for (other, g) in new {
        while let Some(before) = old.next_if(|&(old, _)| old < other) {
            all.push(before);
        }
        let there = old.next_if(|&(old, _)| old == other).map_or(0.0, |(_, g)| g);
        all.push((other, there + g));
    }
    all.extend(old);
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bridge of five conductances (Wheatstone), balanced and not.
    #[test]
    fn a_bridge_has_the_falls_of_its_formula() {
        for [a, b, c, d, across] in [[1.0, 2.0, 3.0, 4.0, 5.0], [1.0, 2.0, 2.0, 4.0, 7.0]] {
            let links = [(2, 0, a), (2, 1, b), (0, 3, c), (1, 3, d), (0, 1, across)];
            let eliminated = Eliminated::new(2, links.into_iter()).unwrap();
            // Kirchhoff's two equations by Cramer's rule.
            let [[p, q], [r, s]] = [[a + c + across, -across], [-across, b + d + across]];
            let det = p * s - q * r;
            let exact = [(a * s - q * b) / det, (p * b - r * a) / det];
            for (void, exact) in exact.iter().enumerate() {
                assert!((eliminated.pressure[void] - exact).abs() < 1e-15, "{void}");
            }
            assert!((eliminated.fall(0, 1) - (exact[0] - exact[1])).abs() < 1e-15);
            assert!((eliminated.conductance - a * (1.0 - exact[0]) - b * (1.0 - exact[1])).abs() < 1e-14);
        }
    }

    /// Two voids joined by so high a conductance that their pressures agree in every digit: the flow
    /// between them is still known.
    #[test]
    fn a_flux_is_known_where_pressures_do_not_differ() {
        let links = [(2, 0, 1.0), (0, 1, 1e20), (1, 3, 1.0), (0, 3, 0.5)];
        let eliminated = Eliminated::new(2, links.into_iter()).unwrap();
        assert_eq!(eliminated.pressure[0], eliminated.pressure[1]);
        let flux = 1e20 * eliminated.fall(0, 1);
        assert!((flux - 0.4).abs() < 1e-15, "{flux}");
    }
}
