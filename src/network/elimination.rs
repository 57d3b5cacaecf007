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
//! Dead ends go first, from their ends on: they are many where a filter has clogged, and taken away exactly.
//! The others follow by number of neighbours, and among equals scattered, so that few of them meet.

/// An approximate factor of a system of conductances: the preconditioner of its conjugate gradients.
pub(super) struct Factor {
    /// Row of the system by place in the order of elimination.
    row: Vec<u32>,
    begin: Vec<u32>,
    /// By place: places of the neighbours at its elimination, and parts of its pressure that they make up.
    /// Single precision is enough of what is approximate.
    neighbour: Vec<(u32, f32)>,
    /// Reciprocal of the sum of its conductances then.
    pivot: Vec<f64>,
}

/// A conductance to a later place, in the list of those of one place.
#[derive(Clone, Copy)]
struct Link {
    to: u32,
    /// The next of its list.
    next: u32,
    conductance: f64,
}

/// No link, or no place yet.
const NONE: u32 = u32::MAX;

/// 2^64 over the golden ratio, and 2^32 over it.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
const GOLDEN_32: u32 = 0x9e37_79b9;

/// What is left of the system while rows are eliminated, all by place.
struct Rest {
    /// Each stands with the one of its two rows that is eliminated first.
    links: Vec<Link>,
    first: Vec<u32>,
    /// Conductance to pressures that are known.
    ground: Vec<f64>,
}

impl Factor {
    /// Of the system whose row `i` conducts `ground[i]` to known pressures and `conductance[k]` to row
    /// `row[k]`, for `k` in `begin[i] .. begin[i + 1]`.
    pub(super) fn new(ground: &[f64], begin: &[u32], row: &[u32], conductance: &[f64]) -> Self {
        let rows = ground.len();
        let order = order(begin, row);
        let mut rest = Rest::new(&order, ground, begin, row, conductance);
        let mut factor = Self {
            row: order,
            begin: Vec::with_capacity(rows + 1),
            neighbour: Vec::with_capacity(row.len()),
            pivot: Vec::with_capacity(rows),
        };
        factor.begin.push(0);
        let (mut meeting, mut at) = (Vec::new(), vec![NONE; rows]);
        let mut choices = 0u64;
        for place in 0..rows {
            rest.neighbours(place, &mut meeting, &mut at);
            let ground = rest.ground[place];
            let all: f64 = meeting.iter().map(|(g, _)| g).sum();
            // Of nothing, and of so little that its inverse is no number, nothing is known.
            let pivot = Some(1.0 / (ground + all)).filter(|inverse| inverse.is_finite()).unwrap_or(0.0);
            for &(g, to) in &meeting {
                factor.neighbour.push((to, (g * pivot) as f32));
                rest.ground[to as usize] += g * ground * pivot;
            }
            let mut left = all;
            for i in 1..meeting.len() {
                let (g, one) = meeting[i - 1];
                left -= g;
                choices += 1;
                let part = (choices.wrapping_mul(GOLDEN) >> 11) as f64 / (1u64 << 53) as f64;
                rest.join(one, chosen(&meeting[i..], part * left), g * left * pivot);
            }
            factor.begin.push(factor.neighbour.len() as u32);
            factor.pivot.push(pivot);
        }
        factor
    }

    /// Solves the factor, once down and once up; `scratch` has the length of both.
    pub(super) fn solve(&self, residual: &[f64], scratch: &mut [f64], out: &mut [f64]) {
        scratch.iter_mut().zip(&self.row).for_each(|(value, &row)| *value = residual[row as usize]);
        let neighbours = |place: usize| {
            let of = self.begin[place] as usize..self.begin[place + 1] as usize;
            &self.neighbour[of]
        };
        for place in 0..self.row.len() {
            let value = scratch[place];
            for &(to, part) in neighbours(place) {
                scratch[to as usize] += f64::from(part) * value;
            }
            scratch[place] = self.pivot[place] * value;
        }
        for place in (0..self.row.len()).rev() {
            let known: f64 =
                neighbours(place).iter().map(|&(to, part)| f64::from(part) * scratch[to as usize]).sum();
            scratch[place] += known;
            out[self.row[place] as usize] = scratch[place];
        }
    }
}

/// Rows in the order of elimination.
fn order(begin: &[u32], row: &[u32]) -> Vec<u32> {
    let rows = begin.len() as u32 - 1;
    let of = |i: u32| &row[begin[i as usize] as usize..begin[i as usize + 1] as usize];
    let mut count: Vec<u32> = (0..rows).map(|i| of(i).len() as u32).collect();
    let mut is_done = vec![false; rows as usize];
    let mut order = Vec::with_capacity(rows as usize);
    let mut ends: Vec<u32> = (0..rows).filter(|&i| count[i as usize] <= 1).collect();
    while let Some(end) = ends.pop() {
        if std::mem::replace(&mut is_done[end as usize], true) {
            continue;
        }
        order.push(end);
        for &next in of(end).iter().filter(|&&next| !is_done[next as usize]) {
            count[next as usize] -= 1;
            if count[next as usize] == 1 {
                ends.push(next);
            }
        }
    }
    let dead_ends = order.len();
    order.extend((0..rows).filter(|&i| !is_done[i as usize]));
    order[dead_ends..].sort_unstable_by_key(|&i| (count[i as usize], i.wrapping_mul(GOLDEN_32)));
    order
}

/// The first row at which the conductances so far exceed `share`, or the last.
fn chosen(meeting: &[(f64, u32)], mut share: f64) -> u32 {
    for &(g, to) in meeting {
        if share < g {
            return to;
        }
        share -= g;
    }
    meeting[meeting.len() - 1].1
}

impl Rest {
    fn new(order: &[u32], ground: &[f64], begin: &[u32], row: &[u32], conductance: &[f64]) -> Self {
        let mut place_of = vec![NONE; order.len()];
        order.iter().zip(0..).for_each(|(&row, place)| place_of[row as usize] = place);
        let mut rest = Self {
            links: Vec::with_capacity(row.len()),
            first: vec![NONE; order.len()],
            ground: order.iter().map(|&row| ground[row as usize]).collect(),
        };
        for (place, &i) in (0u32..).zip(order) {
            for k in begin[i as usize] as usize..begin[i as usize + 1] as usize {
                let to = place_of[row[k] as usize];
                if to > place {
                    rest.join(place, to, conductance[k]);
                }
            }
        }
        rest
    }

    /// Adds a conductance between two places, beside those that there are.
    fn join(&mut self, one: u32, other: u32, conductance: f64) {
        let (from, to) = (one.min(other), one.max(other));
        let link = u32::try_from(self.links.len()).expect("fewer links than a factor has bits for");
        let next = std::mem::replace(&mut self.first[from as usize], link);
        self.links.push(Link { to, next, conductance });
    }

    /// The places that are left and meet this one, each once, in rising order of conductance; `at` is
    /// scratch.
    fn neighbours(&self, place: usize, meeting: &mut Vec<(f64, u32)>, at: &mut [u32]) {
        meeting.clear();
        let mut next = self.first[place];
        while next != NONE {
            let Link { to, next: after, conductance } = self.links[next as usize];
            next = after;
            match meeting.get_mut(at[to as usize] as usize) {
                Some((sum, other)) if *other == to => *sum += conductance,
                _ => {
                    at[to as usize] = meeting.len() as u32;
                    meeting.push((conductance, to));
                }
            }
        }
        meeting.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
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
        let mut meeting = vec![Vec::new(); 7];
        for (a, b, g) in links {
            meeting[a as usize].push((b as u32, g));
            meeting[b as usize].push((a as u32, g));
        }
        let mut begin = vec![0];
        let (mut row, mut conductance) = (Vec::new(), Vec::new());
        for of in &meeting {
            row.extend(of.iter().map(|(to, _)| to));
            conductance.extend(of.iter().map(|(_, g)| g));
            begin.push(row.len() as u32);
        }
        let factor = Factor::new(&ground, &begin, &row, &conductance);
        let right: Vec<f64> = (1..8).map(f64::from).collect();
        let mut x = vec![0.0; 7];
        factor.solve(&right, &mut [0.0; 7], &mut x);
        for i in 0..7 {
            let out: f64 = meeting[i].iter().map(|&(j, g)| g * (x[i] - x[j as usize])).sum();
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
        let mut meeting = vec![Vec::new(); N * N * N];
        let mut ground = vec![0.0; N * N * N];
        for i in 0..N * N * N {
            let [x, y, z] = [i % N, i / N % N, i / (N * N)];
            if z == 0 || z == N - 1 {
                ground[i] = 1.0;
            }
            let ahead = [
                (x + 1 < N).then_some(i + 1),
                (y + 1 < N).then_some(i + N),
                (z + 1 < N).then_some(i + N * N),
            ];
            for j in ahead.into_iter().flatten() {
                let g = libm::pow(10.0, 6.0 * draw() - 3.0);
                if draw() > 0.3 {
                    meeting[i].push((j as u32, g));
                    meeting[j].push((i as u32, g));
                }
            }
        }
        let (mut begin, mut row, mut conductance) = (vec![0], Vec::new(), Vec::new());
        for of in &meeting {
            row.extend(of.iter().map(|(to, _)| to));
            conductance.extend(of.iter().map(|(_, g)| g));
            begin.push(row.len() as u32);
        }
        let factor = Factor::new(&ground, &begin, &row, &conductance);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut residual: Vec<f64> = (0..ground.len()).map(|i| if i < N * N { 1.0 } else { 0.0 }).collect();
        let (first, mut scratch) = (dot(&residual, &residual).sqrt(), vec![0.0; ground.len()]);
        let (mut solved, mut direction) = (vec![0.0; ground.len()], vec![0.0; ground.len()]);
        let (mut before, mut rounds) = (0.0, 0);
        while dot(&residual, &residual).sqrt() > 1e-8 * first {
            factor.solve(&residual, &mut scratch, &mut solved);
            let now = dot(&residual, &solved);
            let kept = if rounds == 0 { 0.0 } else { now / before };
            direction.iter_mut().zip(&solved).for_each(|(d, s)| *d = s + kept * *d);
            let times = |i: usize| {
                let flow = |&(j, g): &(u32, f64)| g * (direction[i] - direction[j as usize]);
                ground[i] * direction[i] + meeting[i].iter().map(flow).sum::<f64>()
            };
            let product: Vec<f64> = (0..ground.len()).map(times).collect();
            let step = now / dot(&direction, &product);
            residual.iter_mut().zip(&product).for_each(|(r, p)| *r -= step * p);
            (before, rounds) = (now, rounds + 1);
            assert!(rounds <= 60, "{rounds} rounds");
        }
    }

    #[test]
    fn a_larger_share_chooses_a_later_row() {
        let meeting = [(1.0, 7), (2.0, 8), (3.0, 9)];
        let of = |share| chosen(&meeting, share);
        assert_eq!([of(0.0), of(0.9), of(1.0), of(2.9), of(3.0), of(5.9), of(6.1)], [7, 7, 8, 8, 9, 9, 9]);
    }
}
