//! Passive particles of a state: numbers or expectations by void, and sizes.
//!
//! The fate of a passive particle does not depend on its size, so the sizes of those eroded or retained
//! are independent draws from the passive part of the base: the numbers by class are multinomial and drawn
//! exactly, and the largest particle is drawn from the coarsest class that is not empty. Masses are counts
//! times a mean mass: of the passive part for the sums of a run, of the class for size curves.

use super::binomial::{CERTAIN, Draws, one};
use crate::gradation::SizeSampler;
use crate::network::Network;
use crate::stream::Key;
use crate::walk::tally::{SizeClasses, SizeCounts};

/// Moving passive particles of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Passive {
    /// Walked one by one, like other particles.
    OneByOne,
    /// Number of moving particles, by void.
    Counts(Vec<u64>),
    /// Expected number of moving particles, by void.
    Expected(Box<Expected>),
}

impl Passive {
    pub(in crate::walk) fn counts(&self) -> &[u64] {
        match self {
            Passive::Counts(moving) => moving,
            _ => &[],
        }
    }

    /// Expectation, if this engine uses it.
    pub fn expected(&self) -> Option<&Expected> {
        match self {
            Passive::Expected(expected) => Some(expected),
            _ => None,
        }
    }
}

/// Number of particles below which a void counts as empty.
pub(super) const NOTHING: f64 = 1e-30;

/// Expected numbers of passive particles.
#[derive(Clone, Debug, PartialEq)]
pub struct Expected {
    /// Expected number moving, by void.
    pub moving: Vec<f64>,
    /// Expected number retained for lack of an open exit, by void.
    pub retained: Vec<f64>,
    /// Integer number retained that the state already counts, by void.
    pub counted_retained: Vec<u64>,
    /// Sums over the voids.
    pub sums: ExpectedSums,
}

/// Sums over the voids of the expected passive particles, over the run so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExpectedSums {
    /// Number eroded.
    pub(crate) eroded: f64,
    /// Number of completed moves.
    pub moves: f64,
    /// Number inserted.
    pub inserted: u64,
    /// Integers that the state already counts.
    pub counted: Counted,
}

/// Integer numbers of passive particles over the run so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Counted {
    /// Number of completed moves.
    pub(crate) moves: u64,
    /// Number eroded.
    pub eroded: u64,
    /// Number eroded or retained.
    pub(crate) at_rest: u64,
}

impl Expected {
    pub(in crate::walk) fn new(voids: usize) -> Self {
        Self {
            moving: vec![0.0; voids],
            retained: vec![0.0; voids],
            counted_retained: vec![0; voids],
            sums: ExpectedSums::default(),
        }
    }

    /// Puts `count` particles on the start nodes, the same number on each.
    pub(in crate::walk::counts) fn insert(&mut self, network: &Network, count: u64) {
        self.sums.inserted += count;
        let part = count as f64 / network.start().len() as f64;
        network.start().iter().for_each(|&void| self.moving[void as usize] += part);
    }

    /// Tells if more than one particle is expected to move in voids that lead out. Starts with the last
    /// voids, where the last particles are, so that few voids are visited.
    pub(in crate::walk::counts) fn surely_moves(&self, leads_out: &[bool]) -> bool {
        let free = self.moving.iter().zip(leads_out).rev().filter(|(_, leads_out)| **leads_out);
        let mut sum = 0.0;
        free.map(|(n, _)| n).any(|n| {
            sum += n;
            sum > 1.0
        })
    }

    /// Updates the integers that the state counts; returns the old and the new ones. `holding`: voids that
    /// retain particles, in ascending order, with their sum. With `trapped` (the expected number of
    /// trapped particles), the other moving particles are fewer than 0.5 and are counted at rest.
    pub(in crate::walk::counts) fn count(
        &mut self,
        (holding, stranded): (&[u32], f64),
        trapped: Option<f64>,
        retained_in_voids: &mut [u64],
    ) -> [Counted; 2] {
        // No sum is negative, and `floor` is a function call on machines without an instruction for it.
        let whole = |x: f64| ((x + 0.5) as u64).min(self.sums.inserted);
        let mut at_rest = whole(self.sums.eroded + stranded);
        let mut eroded = whole(self.sums.eroded);
        if let Some(trapped) = trapped {
            at_rest = self.sums.inserted - whole(trapped);
            eroded = if stranded == 0.0 { at_rest } else { eroded.min(at_rest) };
        }
        let (mut sum, mut last) = (self.sums.eroded, eroded);
        if stranded > 0.0 {
            for void in holding.iter().map(|&void| void as usize) {
                sum += self.retained[void];
                let upto = whole(sum).clamp(last, at_rest);
                let (before, now) = (self.counted_retained[void], upto - last);
                if now != before {
                    retained_in_voids[void] = retained_in_voids[void] - before + now;
                    self.counted_retained[void] = now;
                }
                last = upto;
            }
            // The remainder of rounding goes to the last void that retains particles.
            if let Some(&void) = holding.last() {
                retained_in_voids[void as usize] += at_rest - last;
                self.counted_retained[void as usize] += at_rest - last;
            }
        }
        let moves = (self.sums.moves + 0.5) as u64;
        let counted = Counted { moves, eroded, at_rest };
        [std::mem::replace(&mut self.sums.counted, counted), counted]
    }
}

/// Adds `n` retained particles to a void, and the void to `holding` if they are its first.
pub(super) fn retain(void: usize, n: f64, retained: &mut [f64], holding: &mut Vec<u32>) {
    if retained[void] == 0.0 {
        holding.push(void as u32);
    }
    retained[void] += n;
}

/// Passive part of a base, by size class.
pub(super) struct PassiveSizes<'a> {
    sampler: &'a SizeSampler,
    /// Number of words up to the upper bound of each class; the last is the number of passive words.
    words: Vec<u128>,
    /// Probability that a passive particle not finer than the class is in it.
    probability: Vec<u64>,
    mean_cube: Vec<f64>,
    mean_cube_of_all: f64,
}

impl<'a> PassiveSizes<'a> {
    pub(crate) fn new(sampler: &'a SizeSampler, passive_words: u128, classes: &SizeClasses) -> Self {
        let bounds = classes.upper();
        let mut words: Vec<u128> =
            bounds.iter().map(|&bound| sampler.word_limit(bound).min(passive_words)).collect();
        // Sizes above the last bound belong to the last class.
        words[bounds.len() - 1] = passive_words;
        let (mut probability, mut mean_cube, mut before) = (Vec::new(), Vec::new(), 0);
        for &upto in &words {
            let (width, rest) = (upto - before, passive_words - before);
            probability.push(fraction(width, rest));
            mean_cube.push(sampler.part(before..upto).mean_cube().unwrap_or(0.0));
            before = upto;
        }
        let mean_cube_of_all = sampler.part(0..passive_words).mean_cube().unwrap_or(0.0);
        Self { sampler, words, probability, mean_cube, mean_cube_of_all }
    }

    pub(crate) fn mass(&self, count: u64) -> f64 {
        count as f64 * self.mean_cube_of_all
    }

    /// Adds `count` particles with drawn sizes; returns the largest of them, if there are any.
    pub(crate) fn draw(&self, count: u64, draws: &mut Draws, into: &mut SizeCounts) -> Option<f32> {
        let (mut left, mut coarsest) = (count, None);
        for class in 0..self.words.len() {
            if left == 0 {
                break;
            }
            let n = one(draws, left, self.probability[class]);
            left -= n;
            if n > 0 {
                into.number[class] += n;
                into.mass[class] += n as f64 * self.mean_cube[class];
                coarsest = Some((class, n));
            }
        }
        let (class, n) = coarsest?;
        let from = if class == 0 { 0 } else { self.words[class - 1] };
        self.sampler.part(from..self.words[class]).largest_of(n, draws.word())
    }

    /// Raises the expected number of particles from `before` to `after`, rounded by class so that the sum
    /// stays exact.
    pub(crate) fn expect(&self, before: u64, after: u64, into: &mut SizeCounts) {
        if before == after {
            return;
        }
        let all = *self.words.last().expect("at least one class");
        let (mut last_before, mut last_after) = (0, 0);
        for (class, &words) in self.words.iter().enumerate() {
            let share = words as f64 / all as f64;
            let [now_before, now_after] = [before, after].map(|count| scaled(count, words, all, share));
            let (old, new) = (now_before - last_before, now_after - last_after);
            into.number[class] = into.number[class] + new - old;
            into.mass[class] += (new as f64 - old as f64) * self.mean_cube[class];
            (last_before, last_after) = (now_before, now_after);
        }
    }

    pub(crate) fn median_largest(&self, count: u64) -> Option<f32> {
        let all = *self.words.last().expect("at least one class");
        self.sampler.part(0..all).largest_of(count, 1 << 63)
    }
}

/// Number of coarse particles among `share` base particles, if `passive_words` of the sampler's words draw
/// passive ones.
pub(in crate::walk) fn coarse_share(share: u64, passive_words: u128, key: Key) -> u64 {
    let all = 1u128 << 64;
    one(&mut Draws::new(key), share, fraction(all - passive_words, all))
}

/// Ratio `width / rest` as a 64-bit fraction.
pub(super) fn fraction(width: u128, rest: u128) -> u64 {
    match width {
        0 => 0,
        width if width == rest => CERTAIN,
        width => {
            // Two steps, since `width << 64` may not fit.
            let (high, left) = ((width << 63) / rest, (width << 63) % rest);
            ((high << 1) as u64 | u64::from(left * 2 >= rest)).min(CERTAIN - 1)
        }
    }
}

/// Number of particles below which a product with a fraction is correct to one particle.
const NEARLY_EXACT: u64 = 1 << 52;

/// Rounded value of `count * words / all`; `share` is `words / all`.
fn scaled(count: u64, words: u128, all: u128, share: f64) -> u64 {
    if words == all {
        return count;
    }
    // Here words < 2^64.
    let product = u128::from(count) * words;
    if count >= NEARLY_EXACT {
        let (whole, rest) = (product / all, product % all);
        return (whole + u128::from(rest >= all - rest)) as u64;
    }
    // Divisions of 128 bits take ten times as long; they would dominate an increment of a small network.
    let mut rounded = (count as f64 * share + 0.5) as u64;
    while (2 * u128::from(rounded) + 1) * all <= 2 * product {
        rounded += 1;
    }
    while 2 * u128::from(rounded) * all > 2 * product + all {
        rounded -= 1;
    }
    rounded
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::stream::Purpose;

    fn draws(increment: u64) -> Draws {
        Draws::new(Key { seed: 5, purpose: Purpose::PassiveSize, run: 1, increment, chunk: 0 })
    }

    #[test]
    fn fractions_are_exact_at_their_ends() {
        let all = 1u128 << 64;
        assert_eq!([fraction(0, all), fraction(all, all), fraction(all / 2, all)], [0, CERTAIN, 1 << 63]);
        assert_eq!(fraction(1, all), 1);
        assert_eq!(fraction(all - 1, all), CERTAIN - 1);
        assert_eq!(fraction(1, 3), u64::MAX / 3);
        assert_eq!(fraction(3 << 40, 3 << 60), 1 << 44);
    }

    /// Compares numbers by class with particles drawn one by one: chi-square over 20 classes. With 2e5 of
    /// each, a relative error of about 1 % in a class is detected.
    #[test]
    fn classes_fill_as_if_every_particle_was_drawn() {
        let sampler = SizeSampler::new(&Gradation::linear_from_d0(0.1, 2.0).unwrap(), 1.0).unwrap();
        let classes = SizeClasses::logarithmic(sampler.smallest(), sampler.largest(), 24);
        let passive = sampler.word_limit(0.23);
        let sizes = PassiveSizes::new(&sampler, passive, &classes);
        let (mut drawn, mut one_by_one) = (SizeCounts::new(&classes), SizeCounts::new(&classes));
        let n = 200_000;
        let mut words = draws(1);
        let mut largest = 0f32;
        for part in [1, 99, n - 100] {
            largest = largest.max(sizes.draw(part, &mut words, &mut drawn).unwrap());
        }
        for _ in 0..n {
            let word = (u128::from(words.word()) * passive) >> 64;
            one_by_one.add(&classes, sampler.diameter(word as u64));
        }
        assert_eq!(drawn.number.iter().sum::<u64>(), n);
        assert!(largest <= 0.23 && largest > 0.2);
        let (mut square, mut freedom) = (0.0, -1.0);
        for (&a, &b) in drawn.number.iter().zip(&one_by_one.number).filter(|(a, b)| **a + **b > 20) {
            square += (a as f64 - b as f64).powi(2) / (a + b) as f64;
            freedom += 1.0;
        }
        assert!(freedom > 10.0 && square < freedom + 4.0 * f64::sqrt(2.0 * freedom), "{square} {freedom}");
        let mass = |counts: &SizeCounts| counts.mass.iter().sum::<f64>();
        assert!((mass(&drawn) / mass(&one_by_one) - 1.0).abs() < 0.01);
        assert!((sizes.mass(n) / mass(&one_by_one) - 1.0).abs() < 0.01);
    }

    #[test]
    fn expected_numbers_add_up_however_they_grow() {
        let sampler = SizeSampler::new(&Gradation::linear_from_d0(0.1, 3.0).unwrap(), 1.0).unwrap();
        let classes = SizeClasses::logarithmic(sampler.smallest(), sampler.largest(), 32);
        let sizes = PassiveSizes::new(&sampler, sampler.word_limit(0.3), &classes);
        let (mut grown, mut at_once) = (SizeCounts::new(&classes), SizeCounts::new(&classes));
        let steps = [0, 1, 2, 3, 17, 1000, 1001, 1_000_000_007, u64::MAX];
        for pair in steps.windows(2) {
            sizes.expect(pair[0], pair[1], &mut grown);
            let sum = grown.number.iter().map(|&n| u128::from(n)).sum::<u128>();
            assert_eq!(sum, u128::from(pair[1]));
        }
        sizes.expect(0, u64::MAX, &mut at_once);
        assert_eq!(grown.number, at_once.number);
    }

    /// Compares with division, at and next to halves, and on both sides of `NEARLY_EXACT`.
    #[test]
    fn rounded_products_are_those_of_the_division() {
        let by_division = |count: u64, words: u128, all: u128| {
            let product = u128::from(count) * words;
            let (whole, rest) = (product / all, product % all);
            (whole + u128::from(2 * rest >= all)) as u64
        };
        let mut words = draws(4);
        let mut compared = 0;
        for all in [1u128 << 64, (1 << 64) - 1, 3 << 40, 1000, 2, 1] {
            let of_all = |word: u64| (u128::from(word) * all) >> 64;
            let some: Vec<u128> = [0, 1, 2, all / 2, all - 1].into_iter().filter(|&w| w < all).collect();
            let drawn: Vec<u128> = (0..200).map(|_| of_all(words.word())).filter(|&w| w < all).collect();
            for &part in some.iter().chain(&drawn) {
                let drawn = (0..20).map(|at| words.word() >> (3 * at));
                let edges = [0, 1, 2, 3, 999, 1 << 32, NEARLY_EXACT - 1, NEARLY_EXACT, u64::MAX];
                for count in edges.into_iter().chain(drawn) {
                    let rounded = scaled(count, part, all, part as f64 / all as f64);
                    assert_eq!(rounded, by_division(count, part, all), "{count} {part} {all}");
                    compared += 1;
                }
            }
        }
        assert!(compared > 20_000);
    }

    #[test]
    fn one_size_has_one_class() {
        let sampler = SizeSampler::new(&Gradation::single(0.5).unwrap(), 1.0).unwrap();
        let classes = SizeClasses::logarithmic(0.5, 0.5, 8);
        let sizes = PassiveSizes::new(&sampler, 1 << 64, &classes);
        let mut counts = SizeCounts::new(&classes);
        assert_eq!(sizes.draw(7, &mut draws(2), &mut counts), Some(0.5));
        assert_eq!((counts.number[0], counts.mass[0]), (7, 0.875));
        assert_eq!(sizes.draw(0, &mut draws(3), &mut counts), None);
    }
}
