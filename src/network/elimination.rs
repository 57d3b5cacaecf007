//! A network of conductances taken apart void by void, with few of the links that this makes.
//!
//! To eliminate a void is to join all its neighbours with one another: void by void until none is left, that
//! is Cholesky's factor, and soon everything is joined with everything. Here the neighbours of an eliminated
//! void are joined by a tree instead: in rising order of their conductances `w` each is joined with one of
//! those after it, chosen in proportion to theirs, by what it would conduct to all of them together (Kyng &
//! Sachdeva 2016, doi:10.1109/FOCS.2016.68; Gao, Kyng & Spielman 2023, arXiv:2303.00709). On average over
//! the choices that is the network itself, and no elimination adds a link. Choices follow the golden ratio,
//! so that they are spread evenly and always the same.
//!
//! Dead ends, which one link holds, go first, from their ends on: they are many where a filter has clogged,
//! and taken away exactly. The others follow by number of neighbours, and among equals in turns that are
//! scattered over the network, so that few of them meet; within a turn by row, so that memory is read in
//! order.

use std::ops::Range;

/// A conductance between two rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub one: u32,
    pub other: u32,
    pub conductance: f64,
}

/// An approximate factor of a system of conductances: the preconditioner of its conjugate gradients.
pub(super) struct Factor {
    /// Row of the system by place in the order of elimination.
    row: Vec<u32>,
    /// What places make up of one another, in the order of elimination.
    parts: Vec<Part>,
    /// By place: reciprocal of the sum of its conductances at its elimination.
    pivot: Vec<f64>,
}

/// The part of the pressure of one place that the pressure of a later one makes up. Single precision is
/// enough of what is approximate.
#[derive(Clone, Copy)]
struct Part {
    of: u32,
    by: u32,
    part: f32,
}

/// 2^64 over the golden ratio, and 2^32 over it.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
const GOLDEN_32: u32 = 0x9e37_79b9;

/// Turns, as a power of two.
const TURNS: u32 = 6;

/// Neighbours that are sorted at once, without a branch.
const AT_ONCE: usize = 8;

impl Factor {
    /// Of the system whose row `i` conducts `ground[i]` to known pressures, and whose rows are joined by
    /// `links`.
    pub(super) fn new(ground: &[f64], links: &[Link]) -> Self {
        let rows = ground.len();
        let order = order(rows, links);
        let mut rest = Rest::new(&order, ground, links);
        let mut factor =
            Self { row: order, parts: Vec::with_capacity(2 * links.len()), pivot: Vec::with_capacity(rows) };
        factor.eliminate(&mut rest, 0..rows as u32);
        factor
    }

    /// Takes these places, one after another, from what is left of the system.
    fn eliminate(&mut self, rest: &mut Rest, places: Range<u32>) {
        let (mut meeting, mut at) = (Meeting::default(), vec![0; rest.head.len()]);
        let mut choices = 0u64;
        for place in places {
            let ground = rest.take(place, &mut meeting, &mut at);
            meeting.sort();
            let all = meeting.sums.last().copied().unwrap_or(0.0);
            // Of nothing, and of so little that its inverse is no number, nothing is known.
            let pivot = Some(1.0 / (ground + all)).filter(|inverse| inverse.is_finite()).unwrap_or(0.0);
            for &(to, g) in &meeting.sorted {
                self.parts.push(Part { of: place, by: to, part: (g * pivot) as f32 });
                rest.head[to as usize].ground += g * ground * pivot;
            }
            for i in 1..meeting.sorted.len() {
                let (one, g) = meeting.sorted[i - 1];
                let before = meeting.sums[i - 1];
                let left = all - before;
                choices += 1;
                let part = (choices.wrapping_mul(GOLDEN) >> 11) as f64 / (1u64 << 53) as f64;
                rest.join(one, meeting.chosen(i, before + part * left), g * left * pivot);
            }
            self.pivot.push(pivot);
        }
    }

    /// Solves the factor, once down and once up; `scratch` has the length of both.
    pub(super) fn solve(&self, residual: &[f64], scratch: &mut [f64], out: &mut [f64]) {
        scratch.iter_mut().zip(&self.row).for_each(|(value, &row)| *value = residual[row as usize]);
        // Part by part: loops over those of each place would end where no processor expects it.
        for &Part { of, by, part } in &self.parts {
            scratch[by as usize] += f64::from(part) * scratch[of as usize];
        }
        scratch.iter_mut().zip(&self.pivot).for_each(|(value, pivot)| *value *= pivot);
        for &Part { of, by, part } in self.parts.iter().rev() {
            scratch[of as usize] += f64::from(part) * scratch[by as usize];
        }
        scratch.iter().zip(&self.row).for_each(|(value, &row)| out[row as usize] = *value);
    }
}

/// Rows in the order of elimination.
fn order(rows: usize, links: &[Link]) -> Vec<u32> {
    // Of each row how many links are left, and their other rows by exclusive or: where one is left, its row.
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

/// The places that are left and meet one that is eliminated.
#[derive(Default)]
struct Meeting {
    /// Each once, with its conductance, as they were found.
    found: Vec<(u32, f64)>,
    /// In rising order of conductance, but for those that differ by a millionth.
    sorted: Vec<(u32, f64)>,
    /// Sums of the conductances until then.
    sums: Vec<f64>,
    keys: Vec<u64>,
}

impl Meeting {
    /// Adds a conductance to a place; `at` is scratch.
    fn add(&mut self, to: u32, conductance: f64, at: &mut [u32]) {
        let at = &mut at[to as usize];
        match self.found.get_mut(*at as usize) {
            Some((other, sum)) if *other == to => *sum += conductance,
            _ => {
                *at = self.found.len() as u32;
                self.found.push((to, conductance));
            }
        }
    }

    /// Puts them in order.
    fn sort(&mut self) {
        // Bits of floats that are not negative rise as they do.
        let key = |(i, (_, g)): (usize, &(u32, f64))| g.to_bits() >> 32 << 32 | i as u64;
        self.keys.clear();
        self.keys.extend(self.found.iter().enumerate().map(key));
        if self.keys.len() <= AT_ONCE {
            let mut few = [u64::MAX; AT_ONCE];
            few[..self.keys.len()].copy_from_slice(&self.keys);
            sort_at_once(&mut few);
            let count = self.keys.len();
            self.keys.copy_from_slice(&few[..count]);
        } else {
            self.keys.sort_unstable();
        }
        self.sorted.clear();
        self.sums.clear();
        let mut sum = 0.0;
        for &key in &self.keys {
            let (to, g) = self.found[key as u32 as usize];
            sum += g;
            self.sorted.push((to, g));
            self.sums.push(sum);
        }
    }

    /// The place from the `first` on at which the sum so far exceeds `share`, or the last.
    fn chosen(&self, first: usize, share: f64) -> u32 {
        let passed = match self.sums.len() {
            // Counted without a branch where they are few.
            few if few <= 2 * AT_ONCE => self.sums.iter().map(|&sum| usize::from(sum <= share)).sum(),
            _ => self.sums.partition_point(|&sum| sum <= share),
        };
        self.sorted[passed.clamp(first, self.sorted.len() - 1)].0
    }
}

/// Sorts by nineteen exchanges (Knuth 1998, section 5.3.4).
fn sort_at_once(keys: &mut [u64; AT_ONCE]) {
    const EXCHANGES: [(usize, usize); 19] = [
        (0, 2),
        (1, 3),
        (4, 6),
        (5, 7),
        (0, 4),
        (1, 5),
        (2, 6),
        (3, 7),
        (0, 1),
        (2, 3),
        (4, 5),
        (6, 7),
        (2, 4),
        (3, 5),
        (1, 4),
        (3, 6),
        (1, 2),
        (3, 4),
        (5, 6),
    ];
    for (a, b) in EXCHANGES {
        (keys[a], keys[b]) = (keys[a].min(keys[b]), keys[a].max(keys[b]));
    }
}

/// No handful.
const NONE: u32 = u32::MAX;

/// Links that stand together.
const HANDFUL: usize = 4;

/// Links of one place: the last that it was given, and where those before them are. A cache line.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Head {
    conductance: [f64; HANDFUL],
    to: [u32; HANDFUL],
    /// Conductance to pressures that are known.
    ground: f64,
    count: u32,
    before: u32,
}

/// Links of one place that stand before others.
#[derive(Clone, Copy)]
struct Handful {
    conductance: [f64; HANDFUL],
    to: [u32; HANDFUL],
    before: u32,
}

/// What is left of the system while rows are eliminated, by place: a link stands with the one of its two
/// places that is eliminated first.
struct Rest {
    head: Vec<Head>,
    handfuls: Vec<Handful>,
    /// The first handful of those that are free again.
    free: u32,
}

impl Rest {
    fn new(order: &[u32], ground: &[f64], links: &[Link]) -> Self {
        let mut place_of = vec![0; order.len()];
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

    /// Adds a conductance between two places, beside those that there are.
    #[inline]
    fn join(&mut self, one: u32, other: u32, conductance: f64) {
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
        (head.to[at], head.conductance[at]) = (to, conductance);
        head.count += 1;
    }

    /// Takes away a place: the places that it meets, each once, and its conductance to known pressures. `at`
    /// is scratch.
    fn take(&mut self, place: u32, meeting: &mut Meeting, at: &mut [u32]) -> f64 {
        meeting.found.clear();
        let Head { conductance, to, ground, count, before } = self.head[place as usize];
        (0..count as usize).for_each(|i| meeting.add(to[i], conductance[i], at));
        let mut next = before;
        while next != NONE {
            let handful = &mut self.handfuls[next as usize];
            (0..HANDFUL).for_each(|i| meeting.add(handful.to[i], handful.conductance[i], at));
            let after = std::mem::replace(&mut handful.before, self.free);
            self.free = std::mem::replace(&mut next, after);
        }
        ground
    }
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

    /// All of noughts and ones, and so all (Knuth 1998, section 5.3.4, theorem Z).
    #[test]
    fn eight_are_sorted_at_once() {
        for bits in 0..1u64 << AT_ONCE {
            let mut keys = std::array::from_fn(|i| bits >> i & 1);
            sort_at_once(&mut keys);
            assert!(keys.is_sorted(), "{bits:b}");
        }
    }

    /// What joins the four neighbours of an eliminated row conducts on average, over choices, what the star
    /// did; what is taken leaves its room to what comes.
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
        let mut factor = Factor { row: order, parts: Vec::new(), pivot: Vec::new() };
        let mut rest = Rest::new(&factor.row, &vec![0.0; 5 * STARS], &links);
        factor.eliminate(&mut rest, 0..STARS as u32);
        let mut sum = [[0.0; 4]; 4];
        let arm = |place: u32| (factor.row[place as usize] % 5 - 1) as usize;
        for from in STARS as u32..5 * STARS as u32 {
            let head = rest.head[from as usize];
            for (&to, &conductance) in head.to.iter().zip(&head.conductance).take(head.count as usize) {
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

    /// Thousands of links come and go in the room of the first.
    #[test]
    fn room_of_links_is_used_again() {
        let links: Vec<Link> =
            (1..200).map(|other| Link { one: 0, other, conductance: f64::from(other) }).collect();
        let order: Vec<u32> = (0..200).collect();
        let mut rest = Rest::new(&order, &[0.0; 200], &links);
        let (mut meeting, mut at) = (Meeting::default(), vec![0; 200]);
        let room = rest.handfuls.len();
        for _ in 0..20 {
            rest.take(0, &mut meeting, &mut at);
            assert_eq!(meeting.found.iter().map(|&(to, _)| to).sum::<u32>(), 199 * 100);
            (rest.head[0].count, rest.head[0].before) = (0, NONE);
            links.iter().for_each(|link| rest.join(link.one, link.other, link.conductance));
            assert_eq!(rest.handfuls.len(), room);
        }
    }

    /// As many as are sorted at once, and more; doubles count once.
    #[test]
    fn neighbours_are_sorted_and_chosen_by_their_share() {
        for many in [1, 3, 8, 9, 16, 17, 40] {
            let (mut meeting, mut at) = (Meeting::default(), vec![0; many]);
            // 7 has no common factor with these numbers.
            let order: Vec<u32> = (0..many as u32).map(|i| i * 7 % many as u32).collect();
            order.iter().for_each(|&to| meeting.add(to, 0.25 * f64::from(to + 1), &mut at));
            order.iter().for_each(|&to| meeting.add(to, 0.75 * f64::from(to + 1), &mut at));
            meeting.sort();
            assert!(meeting.sorted.iter().map(|&(to, _)| to).eq(0..many as u32), "{:?}", meeting.sorted);
            let all = many * (many + 1) / 2;
            assert_eq!(meeting.sums.last(), Some(&(all as f64)));
            for share in 0..=all {
                let by_sums = (0..many).position(|i| (i + 1) * (i + 2) / 2 > share).unwrap_or(many - 1);
                assert_eq!(meeting.chosen(0, share as f64) as usize, by_sums, "{share} of {all}");
                assert_eq!(meeting.chosen(many - 1, share as f64) as usize, many - 1);
            }
        }
    }
}
