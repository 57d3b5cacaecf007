//! Approximate elimination of a network of conductances, void by void, which keeps few of the new links.
//!
//! Exact elimination of a void joins all its neighbours with one another, which soon fills the matrix. Here
//! they are joined by a tree instead: in rising order of conductance `w`, each is joined to one of the later
//! neighbours, chosen in proportion to their conductances, by the conductance that it would have to all of
//! them together (Kyng & Sachdeva 2016, doi:10.1109/FOCS.2016.68; Gao, Kyng & Spielman 2023,
//! arXiv:2303.00709). Averaged over the choices this equals exact elimination. Choices follow the golden
//! ratio, so that they are evenly spread and reproducible.
//!
//! Dead ends (voids with one link) are eliminated first, from their ends inwards, which is exact. The other
//! voids follow by number of neighbours, those with equal numbers in turns scattered over the network, so
//! that few of them are neighbours, and within a turn by row, so that memory is read in order.

use std::ops::Range;

/// Approximate factor of a system of conductances, used as preconditioner of conjugate gradients.
pub(super) struct Factor {
    /// Row of the system, by place in the order of elimination.
    row: Vec<u32>,
    /// Coefficients between places, in the order of elimination.
    parts: Vec<Parts>,
    /// Reciprocal of the sum of conductances at elimination, by place.
    pivot: Vec<f64>,
    choices: u64,
}

/// Coefficients per group; the coefficients of a place are padded with 0, so that loop lengths are
/// predictable.
const TOGETHER: usize = 4;

/// Coefficients that give the pressure of one place from the pressures of later places. Single precision
/// is enough for an approximation.
struct Parts {
    place: u32,
    by: [u32; TOGETHER],
    part: [f32; TOGETHER],
}

/// 2^64 and 2^32 divided by the golden ratio.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
const GOLDEN_32: u32 = 0x9e37_79b9;

const TURNS: u32 = 6;

/// Maximum number of sums counted without branches; it covers all stars with a number of arms known in
/// advance.
const COUNTED: usize = 16;

impl Factor {
    /// Builds the factor of the system in which row `i` has conductance `ground[i]` to known pressures and
    /// `links` join the rows.
    pub(super) fn new(ground: &[f64], links: &[Link]) -> Self {
        let order = order(ground.len(), links);
        let mut rest = Rest::new(&order, ground, links);
        let mut factor = Self::of_none(order, ground.len() + links.len());
        factor.eliminate(&mut rest, 0..ground.len() as u32);
        factor
    }

    /// Creates a factor with nothing eliminated and room for this many groups of coefficients.
    fn of_none(row: Vec<u32>, parts: usize) -> Self {
        let (parts, pivot) = (Vec::with_capacity(parts), Vec::with_capacity(row.len()));
        Self { row, parts, pivot, choices: 0 }
    }

    fn eliminate(&mut self, rest: &mut Rest, places: Range<u32>) {
        let mut meeting = Meeting::new(self.row.len());
        for place in places {
            let ground = rest.take(place, &mut meeting);
            let neighbours = &mut meeting.neighbours[..];
            // Most places have few neighbours; loops of known length are predictable.
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

    #[inline(never)]
    fn take_many(&mut self, rest: &mut Rest, place: u32, ground: f64, neighbours: &mut [(u32, f64)]) {
        neighbours.sort_by_key(|&(_, conductance)| rising(conductance));
        self.give_way(rest, place, ground, neighbours, &mut vec![0.0; neighbours.len()]);
    }

    /// Replaces a place by a tree that joins its sorted neighbours; `sums` has one entry per neighbour.
    #[inline(always)]
    fn give_way(&mut self, rest: &mut Rest, place: u32, ground: f64, met: &[(u32, f64)], sums: &mut [f64]) {
        let mut all = 0.0;
        for (sum, &(_, conductance)) in sums.iter_mut().zip(met) {
            all += conductance;
            *sum = all;
        }
        // If the sum is 0, or so small that its inverse is not finite, the pivot is 0.
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

    /// Solves with the factor, forwards and backwards; `scratch` has one entry per row.
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

/// Key that rises with conductance; conductances within a millionth of each other may share a key.
fn rising(conductance: f64) -> u64 {
    // The bits of non-negative floats are ordered like the floats.
    conductance.to_bits() >> 32
}

/// Sorts neighbours by rising conductance; conductances with equal keys keep their order.
#[inline(always)]
fn sorted<const N: usize>(neighbours: &[(u32, f64); N]) -> [(u32, f64); N] {
    // Compared as floats, which is fast on all processors; no two keys are equal.
    let key: [f64; N] = std::array::from_fn(|i| f64::from_bits(rising(neighbours[i].1) << 32 | i as u64));
    let mut sorted = [(0, 0.0); N];
    for i in 0..N {
        sorted[key.iter().map(|&key_of| usize::from(key_of < key[i])).sum::<usize>()] = neighbours[i];
    }
    sorted
}

/// Number of these rising sums that do not exceed `share`.
#[inline(always)]
fn passed(sums: &[f64], share: f64) -> usize {
    match sums.len() {
        ..=COUNTED => sums.iter().map(|&sum| usize::from(sum <= share)).sum(),
        _ => sums.partition_point(|&sum| sum <= share),
    }
}

fn order(rows: usize, links: &[Link]) -> Vec<u32> {
    // By row: number of links left, and the exclusive or of their other rows, which is the last neighbour
    // once one link is left.
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

#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub(crate) one: u32,
    pub(crate) other: u32,
    pub conductance: f64,
}

/// Neighbours of one place, each once; reused for one place after another.
struct Meeting {
    /// Neighbours with their conductances, in order of discovery.
    pub(crate) neighbours: Vec<(u32, f64)>,
    /// Last place of which each place was a neighbour, and its position in `neighbours` then.
    met: Vec<(u32, u32)>,
}

impl Meeting {
    pub(super) fn new(places: usize) -> Self {
        Self { neighbours: Vec::new(), met: vec![(NONE, 0); places] }
    }

    fn add(&mut self, place: u32, to: u32, conductance: f64) {
        let (met, at) = &mut self.met[to as usize];
        if *met == place {
            self.neighbours[*at as usize].1 += conductance;
        } else {
            (*met, *at) = (place, self.neighbours.len() as u32);
            self.neighbours.push((to, conductance));
        }
    }
}

/// Marks a missing handful or place.
const NONE: u32 = u32::MAX;

const HANDFUL: usize = 6;

/// Latest links of one place, and the index of earlier ones. It fills a cache line. Single precision is
/// enough for an approximation; conductances that would round to 0 become the smallest positive float.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Head {
    conductance: [f32; HANDFUL],
    to: [u32; HANDFUL],
    /// Conductance to known pressures.
    ground: f64,
    count: u32,
    before: u32,
}

#[derive(Clone, Copy)]
struct Handful {
    conductance: [f32; HANDFUL],
    to: [u32; HANDFUL],
    before: u32,
}

/// Remaining system during elimination, by place: a link is stored with whichever of its two places is
/// eliminated first.
struct Rest {
    head: Vec<Head>,
    handfuls: Vec<Handful>,
    free: u32,
}

impl Rest {
    /// Builds the system with its rows in this order of elimination.
    pub(super) fn new(order: &[u32], ground: &[f64], links: &[Link]) -> Self {
        let mut place_of: Vec<u32> = vec![0; order.len()];
        order.iter().zip(0u32..).for_each(|(&row, place)| place_of[row as usize] = place);
        let head = |&row: &u32| Head {
            conductance: [0.0; HANDFUL],
            to: [0; HANDFUL],
            ground: ground[row as usize],
            count: 0,
            before: NONE,
        };
        let mut rest = Self { head: order.iter().map(head).collect(), handfuls: Vec::new(), free: NONE };
        for &Link { one, other, conductance } in links {
            rest.join(place_of[one as usize], place_of[other as usize], conductance);
        }
        rest
    }

    #[inline]
    pub(super) fn join(&mut self, one: u32, other: u32, conductance: f64) {
        let (from, to) = (one.min(other), one.max(other));
        let head = &mut self.head[from as usize];
        if head.count as usize == HANDFUL {
            let full = Handful { conductance: head.conductance, to: head.to, before: head.before };
            head.count = 0;
            head.before = if self.free == NONE {
                self.handfuls.push(full);
                u32::try_from(self.handfuls.len() - 1).expect("fewer links than a factor has bits for")
            } else {
                let at = self.free;
                self.free = std::mem::replace(&mut self.handfuls[at as usize], full).before;
                at
            };
        }
        let at = head.count as usize;
        (head.to[at], head.conductance[at]) = (to, (conductance as f32).max(f32::MIN_POSITIVE));
        head.count += 1;
    }

    /// Removes a place: writes its neighbours to `meeting` and returns its conductance to known pressures.
    pub(super) fn take(&mut self, place: u32, meeting: &mut Meeting) -> f64 {
        meeting.neighbours.clear();
        let Head { conductance, to, ground, count, before } = self.head[place as usize];
        (0..count as usize).for_each(|i| meeting.add(place, to[i], f64::from(conductance[i])));
        let mut next = before;
        while next != NONE {
            let handful = &mut self.handfuls[next as usize];
            (0..HANDFUL).for_each(|i| meeting.add(place, handful.to[i], f64::from(handful.conductance[i])));
            let after = std::mem::replace(&mut handful.before, self.free);
            self.free = std::mem::replace(&mut next, after);
        }
        ground
    }

    pub(super) fn hold(&mut self, place: u32, conductance: f64) {
        self.head[place as usize].ground += conductance;
    }
}

#[cfg(test)]
mod tests {
    use super::super::system::System;
    use super::*;

    /// A tree is solved without approximation: a star of chains with one end at a known pressure.
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

    /// A lattice of 16 x 16 x 16 rows between known pressures above and below, with conductances over six
    /// orders of magnitude and three links in ten blocked. Without a factor it takes thousands of rounds.
    #[test]
    fn few_rounds_do_on_a_lattice_that_clogs() {
        const N: usize = 16;
        let mut state = 1u64;
        let mut draw = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let fill = |system: &mut System| {
            for i in 0..N * N * N {
                let [x, y, z] = [i % N, i / N % N, i / (N * N)];
                if z == 0 || z == N - 1 {
                    system.hold(i as u32, 1.0, if z == 0 { 1.0 } else { 0.0 });
                }
                for (at, step) in [(x, 1), (y, N), (z, N * N)] {
                    if at + 1 < N {
                        let g = libm::pow(10.0, 6.0 * draw() - 3.0);
                        if draw() > 0.3 {
                            system.join(i as u32, (i + step) as u32, g);
                        }
                    }
                }
            }
        };
        let (mut pressure, mut kept) = (vec![0.0; N * N * N], None);
        System::new(N * N * N, |_| true, fill).solve(&mut pressure, N, 1e-8, &mut kept).unwrap();
        // It takes 23; without the order 32, with too large links 42.
        let rounds = kept.unwrap().rounds;
        assert!(rounds <= 28, "{rounds} rounds");
    }

    /// Averaged over choices, links among the four neighbours of an eliminated row conduct as much as the
    /// star did; removed links leave their room to new ones.
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
        // Centres first, so that the trees are left.
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

    /// All small numbers of sums and some larger ones, with shares on both sides of every sum.
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

    /// Any number of neighbours.
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
            // A tree of the star's conductances, and the conductance to ground that passes to the neighbours.
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
                let off = up[link.other as usize] - link.conductance;
                assert!(off.abs() < 1e-5 * link.conductance, "{up:?}");
            }
        }
    }

    /// Thousands of links reuse the memory of the first.
    #[test]
    fn room_of_links_is_used_again() {
        let links: Vec<Link> =
            (1..200).map(|other| Link { one: 0, other, conductance: f64::from(other) }).collect();
        let order: Vec<u32> = (0..200).collect();
        let mut rest = Rest::new(&order, &[0.0; 200], &links);
        let room = rest.handfuls.len();
        for _ in 0..20 {
            let mut meeting = Meeting::new(200);
            rest.take(0, &mut meeting);
            assert_eq!(meeting.neighbours.iter().map(|&(to, _)| to).sum::<u32>(), 199 * 100);
            (rest.head[0].count, rest.head[0].before) = (0, NONE);
            links.iter().for_each(|link| rest.join(link.one, link.other, link.conductance));
            assert_eq!(rest.handfuls.len(), room);
        }
    }

    /// A place joined by several links is one neighbour, with the sum of their conductances.
    #[test]
    fn links_between_two_places_are_one() {
        let joined = [(0, 1, 1.0), (2, 0, 2.0), (0, 1, 4.0), (1, 2, 8.0), (1, 0, 16.0), (2, 0, 32.0)];
        let links = joined.map(|(one, other, conductance)| Link { one, other, conductance });
        let mut rest = Rest::new(&[0, 1, 2], &[0.5, 0.0, 0.0], &links);
        let mut meeting = Meeting::new(3);
        rest.hold(0, 0.25);
        assert_eq!(rest.take(0, &mut meeting), 0.75);
        // The earliest links come after the latest.
        meeting.neighbours.sort_by_key(|neighbour| neighbour.0);
        assert_eq!(meeting.neighbours, [(1, 21.0), (2, 34.0)]);
        rest.take(1, &mut meeting);
        assert_eq!(meeting.neighbours, [(2, 8.0)]);
    }
}
