//! Elimination of a network of conductances, void by void, with few of the links that this makes.
//!
//! Eliminating a void joins all its neighbours with one another: done void by void until no void is left,
//! this is Cholesky's factor, and soon everything is joined with everything. Here the neighbours of an
//! eliminated void are joined by a tree instead: in rising order of their conductances `w` each is joined
//! with one of those after it, chosen in proportion to their conductances, by the conductance that it would
//! have to all of them together (Kyng & Sachdeva 2016, doi:10.1109/FOCS.2016.68; Gao, Kyng & Spielman 2023,
//! arXiv:2303.00709). Averaged over the choices this is the network itself, and no elimination adds a link.
//! Choices follow the golden ratio, so that they are spread evenly and always the same.
//!
//! Dead ends, which one link holds, go first, from their ends on: a clogged filter has many of them, and
//! their elimination is exact. The others follow by number of neighbours, and among equals in turns that are
//! scattered over the network, so that few of them meet; within a turn by row, so that memory is read in
//! order.

use std::ops::Range;

use super::rest::{Link, Meeting, Rest};

/// An approximate factor of a system of conductances: the preconditioner of its conjugate gradients.
pub(super) struct Factor {
    /// Row of the system by place in the order of elimination.
    row: Vec<u32>,
    /// Parts that places make up of one another, in the order of elimination.
    parts: Vec<Parts>,
    /// By place: reciprocal of the sum of its conductances at its elimination.
    pivot: Vec<f64>,
    /// Choices of neighbours that it took.
    choices: u64,
}

/// Parts stored as one group: the parts of a place are padded with parts of 0, so that no loop over them ends
/// where a processor does not expect it.
const TOGETHER: usize = 4;

/// Parts of the pressure of one place that the pressures of later ones make up. Single precision is enough
/// for an approximation.
struct Parts {
    place: u32,
    by: [u32; TOGETHER],
    part: [f32; TOGETHER],
}

/// 2^64 over the golden ratio, and 2^32 over it.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
const GOLDEN_32: u32 = 0x9e37_79b9;

/// Turns, as a power of two.
const TURNS: u32 = 6;

/// Most sums that are counted without a branch: those of stars whose number of arms is known.
const COUNTED: usize = 16;

impl Factor {
    /// Makes the factor of the system whose row `i` conducts `ground[i]` to known pressures, and whose rows
    /// are joined by `links`.
    pub(super) fn new(ground: &[f64], links: &[Link]) -> Self {
        let order = order(ground.len(), links);
        let mut rest = Rest::new(&order, ground, links);
        let mut factor = Self::of_none(order, ground.len() + links.len());
        factor.eliminate(&mut rest, 0..ground.len() as u32);
        factor
    }

    /// Factor with nothing eliminated yet, and room for this many groups of parts.
    fn of_none(row: Vec<u32>, parts: usize) -> Self {
        let (parts, pivot) = (Vec::with_capacity(parts), Vec::with_capacity(row.len()));
        Self { row, parts, pivot, choices: 0 }
    }

    /// Eliminates these places, one after another, from the rest of the system.
    fn eliminate(&mut self, rest: &mut Rest, places: Range<u32>) {
        let mut meeting = Meeting::new(self.row.len());
        for place in places {
            let ground = rest.take(place, &mut meeting);
            let neighbours = &mut meeting.neighbours[..];
            // Most have few: loops over a known number end where a processor expects it.
            macro_rules! of_number {
                ($($few:literal)*) => {
                    match neighbours.len() {
                        $($few => self.take_few::<$few>(rest, place, ground, neighbours),)*
                        _ => self.take_many(rest, place, ground, neighbours),
                    }
                };
            }
            of_number!(1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16);
        }
    }

    /// Eliminates a place with this many neighbours.
    #[inline(always)]
    fn take_few<const N: usize>(
        &mut self,
        rest: &mut Rest,
        place: u32,
        ground: f64,
        neighbours: &[(u32, f64)],
    ) {
        let neighbours: &[(u32, f64); N] = neighbours.try_into().expect("so many were found");
        self.give_way(rest, place, ground, &sorted(neighbours), &mut [0.0; N]);
    }

    /// Eliminates a place with any number of neighbours.
    #[inline(never)]
    fn take_many(&mut self, rest: &mut Rest, place: u32, ground: f64, neighbours: &mut [(u32, f64)]) {
        neighbours.sort_by_key(|&(_, conductance)| rising(conductance));
        self.give_way(rest, place, ground, neighbours, &mut vec![0.0; neighbours.len()]);
    }

    /// Joins the neighbours of a place, which are sorted, by a tree instead of it; `sums` has their number.
    #[inline(always)]
    fn give_way(&mut self, rest: &mut Rest, place: u32, ground: f64, met: &[(u32, f64)], sums: &mut [f64]) {
        let mut all = 0.0;
        for (sum, &(_, conductance)) in sums.iter_mut().zip(met) {
            all += conductance;
            *sum = all;
        }
        // A sum of 0, or one so small that its inverse is no number, gets 0: nothing is known there.
        let pivot = Some(1.0 / (ground + all)).filter(|inverse| inverse.is_finite()).unwrap_or(0.0);
        self.pivot.push(pivot);
        for some in met.chunks(TOGETHER) {
            let mut parts = Parts { place, by: [some[0].0; TOGETHER], part: [0.0; TOGETHER] };
            for (i, &(to, conductance)) in some.iter().enumerate() {
                (parts.by[i], parts.part[i]) = (to, (conductance * pivot) as f32);
            }
            self.parts.push(parts);
        }
        if ground > 0.0 {
            met.iter().for_each(|&(to, conductance)| rest.hold(to, conductance * ground * pivot));
        }
        for i in 1..met.len() {
            let (one, conductance) = met[i - 1];
            let left = all - sums[i - 1];
            self.choices += 1;
            let share = (self.choices.wrapping_mul(GOLDEN) >> 11) as f64 / (1u64 << 53) as f64;
            let chosen = passed(sums, sums[i - 1] + share * left).clamp(i, met.len() - 1);
            rest.join(one, met[chosen].0, conductance * left * pivot);
        }
    }

    /// Solves the factor, once down and once up; `scratch` has a number for each row.
    pub(super) fn solve(&self, residual: &[f64], scratch: &mut [f64], out: &mut [f64]) {
        scratch.iter_mut().zip(&self.row).for_each(|(value, &row)| *value = residual[row as usize]);
        for Parts { place, by, part } in &self.parts {
            let value = scratch[*place as usize];
            by.iter().zip(part).for_each(|(&by, &part)| scratch[by as usize] += f64::from(part) * value);
        }
        scratch.iter_mut().zip(&self.pivot).for_each(|(value, pivot)| *value *= pivot);
        for Parts { place, by, part } in self.parts.iter().rev() {
            let [a, b, c, d] = std::array::from_fn(|i| f64::from(part[i]) * scratch[by[i] as usize]);
            scratch[*place as usize] += (a + b) + (c + d);
        }
        scratch.iter().zip(&self.row).for_each(|(value, &row)| out[row as usize] = *value);
    }
}

/// Key that rises with conductance, except between conductances that differ by a millionth.
fn rising(conductance: f64) -> u64 {
    // Bits of floats that are not negative rise as the floats do.
    conductance.to_bits() >> 32
}

/// Neighbours in rising order of conductance; those that differ by a millionth in the order in which they
/// were found.
#[inline(always)]
fn sorted<const N: usize>(neighbours: &[(u32, f64); N]) -> [(u32, f64); N] {
    // Compared as floats, for which all processors have fast instructions: no two keys are equal.
    let key: [f64; N] = std::array::from_fn(|i| f64::from_bits(rising(neighbours[i].1) << 32 | i as u64));
    let mut sorted = [(0, 0.0); N];
    for i in 0..N {
        sorted[key.iter().map(|&key_of| usize::from(key_of < key[i])).sum::<usize>()] = neighbours[i];
    }
    sorted
}

/// Number of these rising sums that do not exceed a share.
#[inline(always)]
fn passed(sums: &[f64], share: f64) -> usize {
    match sums.len() {
        ..=COUNTED => sums.iter().map(|&sum| usize::from(sum <= share)).sum(),
        _ => sums.partition_point(|&sum| sum <= share),
    }
}

/// Rows in the order of elimination.
fn order(rows: usize, links: &[Link]) -> Vec<u32> {
    // By row: the number of links left, and their other rows by exclusive or: once one is left, its row.
    let mut left = vec![(0u32, 0u32); rows];
    for &Link { one, other, .. } in links {
        for (row, met) in [(one, other), (other, one)] {
            let (count, rows) = &mut left[row as usize];
            *count += 1;
            *rows ^= met;
        }
    }
    let mut is_done = vec![false; rows];
    let mut order = Vec::with_capacity(rows);
    let mut ends: Vec<u32> = (0..rows as u32).filter(|&i| left[i as usize].0 <= 1).collect();
    while let Some(end) = ends.pop() {
        if std::mem::replace(&mut is_done[end as usize], true) {
            continue;
        }
        order.push(end);
        let (count, next) = left[end as usize];
        if count == 1 {
            let (count, rows) = &mut left[next as usize];
            *count -= 1;
            *rows ^= end;
            if *count == 1 {
                ends.push(next);
            }
        }
    }
    let turn = |i: u32| i.wrapping_mul(GOLDEN_32) >> (32 - TURNS);
    let key =
        |i: u32| u64::from(left[i as usize].0) << (32 + TURNS) | u64::from(turn(i)) << 32 | u64::from(i);
    let mut others: Vec<u64> = (0..rows as u32).filter(|&i| !is_done[i as usize]).map(key).collect();
    others.sort_unstable();
    order.extend(others.iter().map(|&key| key as u32));
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tree has nothing to approximate: a star of chains, one end of which leads to a known pressure.
    #[test]
    fn a_tree_is_solved_exactly() {
        let links = [(0, 1, 2.0), (0, 2, 0.5), (0, 3, 1.0), (1, 4, 3.0), (2, 5, 0.25), (3, 6, 8.0)];
        let ground = [0.0, 0.0, 0.0, 0.0, 1.5, 0.0, 0.0];
        let links = links.map(|(one, other, conductance)| Link { one, other, conductance });
        let factor = Factor::new(&ground, &links);
        let right: Vec<f64> = (1..8).map(f64::from).collect();
        let mut x = vec![0.0; 7];
        factor.solve(&right, &mut [0.0; 7], &mut x);
        for i in 0..7 {
            let other = |link: &&Link| match [link.one as usize, link.other as usize] {
                [one, other] if one == i => Some((link.conductance, other)),
                [one, other] if other == i => Some((link.conductance, one)),
                _ => None,
            };
            let out: f64 = links.iter().filter_map(|l| other(&l)).map(|(g, j)| g * (x[i] - x[j])).sum();
            assert!((ground[i] * x[i] + out - right[i]).abs() < 1e-5, "{x:?}");
        }
    }

    /// Conjugate gradients on a lattice of 16 x 16 x 16 rows between known pressures above and below: links
    /// over six orders of magnitude, three in ten blocked. Without a factor they take thousands of rounds.
    #[test]
    fn few_rounds_do_on_a_lattice_that_clogs() {
        const N: usize = 16;
        let mut state = 1u64;
        let mut draw = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut links = Vec::new();
        let mut ground = vec![0.0; N * N * N];
        for (i, ground) in ground.iter_mut().enumerate() {
            let [x, y, z] = [i % N, i / N % N, i / (N * N)];
            if z == 0 || z == N - 1 {
                *ground = 1.0;
            }
            let ahead = [
                (x + 1 < N).then_some(i + 1),
                (y + 1 < N).then_some(i + N),
                (z + 1 < N).then_some(i + N * N),
            ];
            for j in ahead.into_iter().flatten() {
                let g = libm::pow(10.0, 6.0 * draw() - 3.0);
                if draw() > 0.3 {
                    links.push(Link { one: i as u32, other: j as u32, conductance: g });
                }
            }
        }
        let factor = Factor::new(&ground, &links);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut residual: Vec<f64> = (0..ground.len()).map(|i| if i < N * N { 1.0 } else { 0.0 }).collect();
        let (first, mut scratch) = (dot(&residual, &residual).sqrt(), vec![0.0; ground.len()]);
        let (mut solved, mut direction) = (vec![0.0; ground.len()], vec![0.0; ground.len()]);
        let (mut before, mut rounds) = (0.0, 0);
        let size = |residual: &[f64]| dot(residual, residual).sqrt();
        while size(&residual) > 1e-8 * first {
            assert!(size(&residual).is_finite());
            factor.solve(&residual, &mut scratch, &mut solved);
            let now = dot(&residual, &solved);
            let kept = if rounds == 0 { 0.0 } else { now / before };
            direction.iter_mut().zip(&solved).for_each(|(d, s)| *d = s + kept * *d);
            let mut product: Vec<f64> = ground.iter().zip(&direction).map(|(g, d)| g * d).collect();
            for &Link { one, other, conductance } in &links {
                let (one, other) = (one as usize, other as usize);
                let flow = conductance * (direction[one] - direction[other]);
                (product[one], product[other]) = (product[one] + flow, product[other] - flow);
            }
            let step = now / dot(&direction, &product);
            residual.iter_mut().zip(&product).for_each(|(r, p)| *r -= step * p);
            (before, rounds) = (now, rounds + 1);
            // 23; without the order 32, with links that are too large 42.
            assert!(rounds <= 28, "{rounds} rounds");
        }
    }

    /// Links among the four neighbours of an eliminated row conduct on average, over choices, as the star
    /// did; links that are taken leave their room to those that come.
    #[test]
    fn a_star_gives_way_to_trees_that_conduct_as_much() {
        const STARS: usize = 4000;
        let arms = [1.0, 2.0, 3.0, 4.0];
        let link = |star: usize, arm: usize| Link {
            one: (5 * star) as u32,
            other: (5 * star + 1 + arm) as u32,
            conductance: arms[arm],
        };
        let links: Vec<Link> = (0..STARS).flat_map(|star| (0..4).map(move |arm| link(star, arm))).collect();
        // Middles first, so that the others are left with the trees.
        let order: Vec<u32> =
            (0..STARS).map(|s| 5 * s).chain((0..5 * STARS).filter(|i| i % 5 > 0)).map(|i| i as u32).collect();
        let mut factor = Factor::of_none(order, 0);
        let mut rest = Rest::new(&factor.row, &vec![0.0; 5 * STARS], &links);
        factor.eliminate(&mut rest, 0..STARS as u32);
        let mut sum = [[0.0; 4]; 4];
        let arm = |place: u32| (factor.row[place as usize] % 5 - 1) as usize;
        let mut meeting = Meeting::new(5 * STARS);
        for from in STARS as u32..5 * STARS as u32 {
            rest.take(from, &mut meeting);
            for &(to, conductance) in &meeting.neighbours {
                sum[arm(from)][arm(to)] += conductance / STARS as f64;
            }
        }
        for (i, row) in sum.iter().enumerate() {
            for (j, &mean) in row.iter().enumerate().skip(i + 1) {
                let star = arms[i] * arms[j] / 10.0;
                assert!((mean / star - 1.0).abs() < 0.02, "{i} {j}: {mean} for {star}");
            }
        }
    }

    /// Every small number of sums, and larger ones, by shares on both sides of every sum.
    #[test]
    fn the_first_sum_beyond_a_share_is_found() {
        for many in [1, 3, COUNTED, COUNTED + 1, 40] {
            let sums: Vec<f64> = (1..=many).map(|i| (i * (i + 1) / 2) as f64).collect();
            for share in 0..=many * (many + 1) / 2 {
                let by_hand = sums.iter().take_while(|&&sum| sum <= share as f64).count();
                assert_eq!(passed(&sums, share as f64), by_hand, "{share} of {many}");
            }
        }
    }

    /// All orders of five conductances; the second and third differ by less than a millionth and stay as they
    /// were found.
    #[test]
    fn neighbours_are_sorted() {
        const CONDUCTANCES: [f64; 5] = [1e-300, 0.25, 0.25 * (1.0 + 1e-9), 0.75, 1.0];
        let mut neighbours: [(u32, f64); 5] = std::array::from_fn(|i| (i as u32, CONDUCTANCES[i]));
        // Every order by exchanges (Heap 1963).
        let (mut turns, mut at, mut orders) = ([0; 5], 0, 0);
        loop {
            let by_hand = {
                let mut all = neighbours.to_vec();
                all.sort_by_key(|&(_, conductance)| rising(conductance));
                all
            };
            assert_eq!(sorted(&neighbours), by_hand[..], "{neighbours:?}");
            assert_eq!([0, 3, 4].map(|i| sorted(&neighbours)[i].0), [0, 3, 4]);
            orders += 1;
            while at < 5 && turns[at] == at {
                (turns[at], at) = (0, at + 1);
            }
            if at == 5 {
                break;
            }
            neighbours.swap(if at % 2 == 0 { 0 } else { turns[at] }, at);
            (turns[at], at) = (turns[at] + 1, 0);
        }
        assert_eq!(orders, 120);
    }

    /// Any number of neighbours: numbers that the loops know beforehand, and more.
    #[test]
    fn a_row_gives_way_whatever_it_meets() {
        for many in 0..40 {
            let links: Vec<Link> = (1..=many)
                .map(|other| Link { one: 0, other, conductance: f64::from(1 + other * 7 % many) })
                .collect();
            let order: Vec<u32> = (0..=many).collect();
            let mut factor = Factor::of_none(order, 0);
            let mut rest = Rest::new(&factor.row, &vec![1.0; many as usize + 1], &links);
            factor.eliminate(&mut rest, 0..1);
            let all: f64 = links.iter().map(|link| link.conductance).sum();
            assert!((factor.pivot[0] * (1.0 + all) - 1.0).abs() < 1e-14);
            // A tree of the star's conductances, and the part that leads on through the star's ground.
            let (mut meeting, mut links_of_tree, mut ground) = (Meeting::new(many as usize + 1), 0, 0.0);
            for place in 1..=many {
                ground += rest.take(place, &mut meeting) - 1.0;
                links_of_tree += meeting.neighbours.len() as u32;
            }
            assert_eq!(links_of_tree, many.saturating_sub(1), "{many}");
            assert!((ground - all / (1.0 + all)).abs() < 1e-12, "{many}: {ground}");
            let mut up: Vec<f64> = vec![0.0; many as usize + 1];
            factor.pivot.resize(many as usize + 1, 1.0);
            up[0] = 1.0 + all;
            let right = up.clone();
            factor.solve(&right, &mut vec![0.0; many as usize + 1], &mut up);
            for link in &links {
                assert!(
                    (up[link.other as usize] - link.conductance).abs() < 1e-5 * link.conductance,
                    "{up:?}"
                );
            }
        }
    }
}
