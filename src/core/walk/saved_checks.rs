//! Checks of a loaded state that a walk relies on: they find numbers that no walk can have.
//!
//! Checksums keep chance away from a checkpoint, not somebody who makes them right again. Such a state may
//! give a wrong answer; it must not index beyond a column, wrap a sum, or move for ever.

use super::{CHUNK, Expected, Passive, State, Supply, Tally};

/// Relative error allowed in the sum of an expectation: sums over very many increments round.
const ROUNDING: f64 = 1e-6;

/// Increments that no walk reaches.
const MOST_INCREMENTS: u64 = 1 << 62;

/// Numbers of a checkpoint about a walk, beside the supply of that walk.
pub(super) struct Forgery<'a> {
    pub supply: &'a Supply,
    pub increment: u64,
    pub tally: &'a Tally,
}

impl Forgery<'_> {
    /// Tells if chunks may hold this many moving particles: no more than were inserted into each.
    pub fn live_can_be(&self, live: &[u32]) -> bool {
        let inserted = self.supply.inserted(self.increment);
        let into = |chunk: usize| inserted.saturating_sub((chunk * CHUNK) as u64).min(CHUNK as u64);
        live.iter().enumerate().all(|(chunk, &n)| u64::from(n) <= into(chunk))
    }

    /// Finds an impossible number in a state whose columns have the right lengths and whose tally adds up.
    pub fn fault(&self, state: &State) -> Option<&'static str> {
        let (tally, supply) = (self.tally, self.supply);
        let passive = supply.passive_inserted(self.increment);
        let inserting = self.increment < supply.increments();
        if self.increment > MOST_INCREMENTS || state.finished != (!inserting && tally.moving == 0) {
            return Some("increment");
        }
        if u128::from(tally.inserted) != u128::from(supply.inserted(self.increment)) + u128::from(passive) {
            return Some("number of particles");
        }
        // Those that are trapped stay where they are.
        let live: u128 = state.particles.live.iter().map(|&n| u128::from(n)).sum();
        let still = match &state.passive {
            Passive::OneByOne => 0,
            Passive::Counts(moving) => sum(moving),
            Passive::Expected(expected) => {
                if !self.expectation_can_be(expected, passive, state) {
                    return Some("expectation");
                }
                u128::from(expected.sums.inserted - expected.sums.counted.at_rest)
            }
        };
        if live + still != u128::from(tally.moving) + u128::from(tally.trapped) {
            return Some("number of moving particles");
        }
        let columns = [&state.retained_in_constrictions, &state.retained_in_voids];
        let sizes = [&state.eroded_sizes, &state.retained_sizes];
        let numbers = columns.into_iter().chain(sizes.map(|sizes| &sizes.number));
        if numbers.into_iter().any(|column| sum(column) > u128::from(tally.inserted)) {
            return Some("number of retained or eroded particles");
        }
        let masses = sizes.into_iter().flat_map(|sizes| &sizes.mass).copied();
        let largest = f64::from(tally.largest_eroded);
        let mut masses = masses.chain([tally.inserted_mass, tally.eroded_mass, largest]);
        if masses.any(|mass| !mass.is_finite()) {
            return Some("mass");
        }
        let is_past = |increment: u64| (1..=self.increment).contains(&increment);
        (!state.history.iter().all(|b| is_past(b.increment))).then_some("history")
    }

    /// Tells if an expectation is valid: numbers, no one below 0, that sum to the number inserted; and the
    /// whole numbers that were counted of it are in the tally.
    fn expectation_can_be(&self, expected: &Expected, inserted: u64, state: &State) -> bool {
        let (sums, counted) = (&expected.sums, &expected.sums.counted);
        let columns = || expected.moving.iter().chain(&expected.retained);
        let is_number = |n: &f64| n.is_finite() && *n >= 0.0;
        let whole = columns().sum::<f64>() + sums.eroded;
        let retained = sum(&expected.counted_retained);
        let in_voids = state.retained_in_voids.iter();
        columns().chain([&sums.eroded, &sums.moves]).all(is_number)
            && sums.inserted == inserted
            && (whole - inserted as f64).abs() <= 1.0 + ROUNDING * inserted as f64
            && counted.eroded <= counted.at_rest
            && counted.at_rest <= inserted
            && counted.eroded <= self.tally.eroded
            && counted.at_rest - counted.eroded <= self.tally.retained_in_voids
            && retained == u128::from(counted.at_rest - counted.eroded)
            && counted.moves == (sums.moves + 0.5).floor() as u64
            && in_voids.zip(&expected.counted_retained).all(|(all, counted)| counted <= all)
    }
}

fn sum(column: &[u64]) -> u128 {
    column.iter().map(|&n| u128::from(n)).sum()
}
