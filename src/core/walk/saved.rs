//! Conversion of a state to sections of a checkpoint and back. Data that can be rebuilt are not saved.

use super::{
    Blocking, CHUNK, Expected, ExpectedSums, Narrowing, Openings, Passive, SizeCounts, State, Supply, Tally,
};
use crate::network::Network;
use crate::store::checkpoint::{Checkpoint, CheckpointError, Section};
use bitvec::field::BitField;
use bitvec::vec::BitVec;
use bytemuck::Pod;
use serde::{Deserialize, Serialize};

/// State as sections of a checkpoint.
///
/// | section | element | content |
/// |---|---|---|
/// | `state` | JSON | the record below |
/// | `live` | u32 | moving particles by chunk |
/// | `void` | u32 | void of each moving particle, chunk after chunk |
/// | `diameter` | f32 | diameter of each moving particle, chunk after chunk |
/// | `counts` | u64 | moving passive particles by void; only with engine `counts` |
/// | `expected_moving` | f64 | expected moving passive particles by void; only with engine `expected` |
/// | `expected_retained` | f64 | expected retained passive particles by void; likewise |
/// | `counted_retained` | u64 | number of these that the state counts, by void; likewise |
/// | `blocked` | u64 | bit `c % 64` of word `c / 64`: constriction `c` is blocked |
/// | `history_increment` | u64 | increment of each blocking of this run |
/// | `history_constriction` | u32 | constriction of each blocking of this run |
/// | `widths` | f32 | width by exit; this and the next three rows only with openings |
/// | `narrowed_increment` | u64 | increment of each narrowing of this run |
/// | `narrowed_constriction` | u32 | constriction of each narrowing of this run, by the first of its exits |
/// | `narrowed_before`, `narrowed_after` | f32 | width before and after each narrowing |
/// | `retained_in_constrictions` | u64 | particles retained in exits, by void |
/// | `retained_in_voids` | u64 | particles retained for lack of an open exit, by void |
/// | `eroded_number`, `retained_number` | u64 | particles by size class |
/// | `eroded_mass`, `retained_mass` | f64 | mass by size class |
/// | `retained_cubes` | f64 | retained diameters cubed by void; only if volumes are known |
///
/// The record holds the fields of [`State`] with these names: `seed`, `run`, `increment`, `finished`,
/// `passive_limit` (`null` if no constriction was open at the start of the run) and `tally` (all fields of
/// [`Tally`]). It also holds `passive`, the method for passive particles (`one_by_one`, `counts` or
/// `expected`); `constrictions`, their number; and, with engine `expected` only, `expected`: the sums
/// `eroded`, `moves` and `inserted`, and in `counted` the integers `moves`, `eroded` and `at_rest`
/// included in the tally.
pub struct SavedState<'a> {
    state: &'a State,
    record: Vec<u8>,
    blocked: Vec<u64>,
    history_increment: Vec<u64>,
    history_constriction: Vec<u32>,
    narrowed_increment: Vec<u64>,
    narrowed_constriction: Vec<u32>,
    narrowed_before: Vec<f32>,
    narrowed_after: Vec<f32>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Record {
    seed: u64,
    run: u64,
    increment: u64,
    finished: bool,
    passive: PassiveKind,
    passive_limit: Option<f32>,
    expected: Option<ExpectedSums>,
    tally: Tally,
    constrictions: usize,
}

/// Method by which a run follows its passive particles.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum PassiveKind {
    OneByOne,
    Counts,
    Expected,
}

impl PassiveKind {
    fn new(passive: &Passive) -> Self {
        match passive {
            Passive::OneByOne => Self::OneByOne,
            Passive::Counts(_) => Self::Counts,
            Passive::Expected(_) => Self::Expected,
        }
    }
}

/// JSON has no infinity.
fn finite(limit: f32) -> Option<f32> {
    limit.is_finite().then_some(limit)
}

impl<'a> SavedState<'a> {
    /// Prepares the sections of this state.
    pub fn new(state: &'a State) -> Self {
        let record = Record {
            seed: state.seed,
            run: state.run,
            increment: state.increment,
            finished: state.finished,
            passive: PassiveKind::new(&state.passive),
            passive_limit: finite(state.passive_limit),
            expected: state.passive.expected().map(|expected| expected.sums),
            tally: state.tally,
            constrictions: state.blocked.len(),
        };
        let narrowed = state.openings.as_ref().map_or(&[][..], |openings| &openings.history);
        Self {
            state,
            record: serde_json::to_vec(&record).expect("numbers and words"),
            blocked: to_words(&state.blocked),
            history_increment: state.history.iter().map(|b| b.increment).collect(),
            history_constriction: state.history.iter().map(|b| b.constriction).collect(),
            narrowed_increment: narrowed.iter().map(|n| n.increment).collect(),
            narrowed_constriction: narrowed.iter().map(|n| n.constriction).collect(),
            narrowed_before: narrowed.iter().map(|n| n.before).collect(),
            narrowed_after: narrowed.iter().map(|n| n.after).collect(),
        }
    }

    /// Sections of the checkpoint.
    pub fn sections(&self) -> Vec<Section<'_>> {
        let state = self.state;
        let particles = &state.particles;
        let chunks = 0..particles.live.len();
        let expected = state.passive.expected();
        let mut sections = vec![
            Section::new("state", &self.record),
            Section::new("live", &particles.live),
            Section::parts("void", chunks.clone().map(|c| particles.chunk(c).0)),
            Section::parts("diameter", chunks.map(|c| particles.chunk(c).1)),
            Section::new("counts", state.passive.counts()),
            Section::new("expected_moving", expected.map_or(&[], |e| &e.moving)),
            Section::new("expected_retained", expected.map_or(&[], |e| &e.retained)),
            Section::new("counted_retained", expected.map_or(&[], |e| &e.counted_retained)),
            Section::new("blocked", &self.blocked),
            Section::new("history_increment", &self.history_increment),
            Section::new("history_constriction", &self.history_constriction),
            Section::new("retained_in_constrictions", &state.retained_in_constrictions),
            Section::new("retained_in_voids", &state.retained_in_voids),
            Section::new("eroded_number", &state.eroded_sizes.number),
            Section::new("eroded_mass", &state.eroded_sizes.mass),
            Section::new("retained_number", &state.retained_sizes.number),
            Section::new("retained_mass", &state.retained_sizes.mass),
        ];
        if let Some(openings) = &state.openings {
            sections.extend([
                Section::new("widths", &openings.widths),
                Section::new("narrowed_increment", &self.narrowed_increment),
                Section::new("narrowed_constriction", &self.narrowed_constriction),
                Section::new("narrowed_before", &self.narrowed_before),
                Section::new("narrowed_after", &self.narrowed_after),
            ]);
        }
        if !state.retained_cubes.is_empty() {
            sections.push(Section::new("retained_cubes", &state.retained_cubes));
        }
        sections
    }
}

impl State {
    /// Loads a state from a checkpoint into this one, which belongs to the same run before its first
    /// increment. Everything that a walk relies on is checked, so that a forged checkpoint with correct
    /// checksums causes no panic and no endless walk.
    ///
    /// # Errors
    /// A corrupt checkpoint, or one of another run.
    pub fn restore(
        &mut self,
        network: &Network,
        supply: &Supply,
        saved: &Checkpoint,
    ) -> Result<(), CheckpointError> {
        let wrong = |what: &str| saved.corrupt(format!("{what} cannot belong to this run"));
        let record: Record = saved.read_record("state")?;
        let name = |seed: u64, run: u64, kind: &PassiveKind| {
            format!("seed {seed}, run {run}, passive particles {kind:?}")
        };
        let found = name(record.seed, record.run, &record.passive);
        let expected = name(self.seed, self.run, &PassiveKind::new(&self.passive));
        if found != expected {
            return Err(saved.of_another_walk(&found, &expected));
        }
        if record.constrictions != self.blocked.len() || record.passive_limit != finite(self.passive_limit) {
            return Err(saved.of_another_network());
        }
        let live: Vec<u32> = saved.read_exact("live", self.particles.live.len())?;
        // At most as many as were inserted into each.
        let inserted = supply.inserted(record.increment);
        let most = |chunk: usize| inserted.saturating_sub((chunk * CHUNK) as u64).min(CHUNK as u64);
        if live.iter().enumerate().any(|(chunk, &n)| u64::from(n) > most(chunk)) {
            return Err(wrong("particles of a chunk"));
        }
        let total: usize = live.iter().map(|&n| n as usize).sum();
        for name in ["void", "diameter"] {
            if saved.count::<u32>(name)? != total {
                return Err(wrong("number of particles"));
            }
        }
        let (mut voids, mut sizes, mut place) = (true, true, Place::new(&live));
        let column = &mut self.particles.void;
        saved.read_pieces::<u32>("void", |piece| {
            voids &= piece.iter().all(|&v| (v as usize) < network.voids());
            place.put(piece, column);
        })?;
        // A single size is known without diameters.
        if !self.particles.has_one_size() {
            let mut place = Place::new(&live);
            let column = &mut self.particles.diameter;
            saved.read_pieces::<f32>("diameter", |piece| {
                sizes &= piece.iter().all(|d| d.is_finite() && *d > 0.0);
                place.put(piece, column);
            })?;
        }
        if !voids || !sizes {
            return Err(wrong(if voids { "diameter of a particle" } else { "void of a particle" }));
        }
        self.particles.live = live;
        self.passive = match &self.passive {
            Passive::OneByOne => Passive::OneByOne,
            Passive::Counts(now) => Passive::Counts(saved.read_exact("counts", now.len())?),
            Passive::Expected(_) => Passive::Expected(Box::new(Expected {
                moving: saved.read_exact("expected_moving", network.voids())?,
                retained: saved.read_exact("expected_retained", network.voids())?,
                counted_retained: saved.read_exact("counted_retained", network.voids())?,
                sums: record.expected.ok_or_else(|| wrong("expectation"))?,
            })),
        };
        let constrictions = self.blocked.len();
        self.blocked = from_words(&saved.read_exact("blocked", constrictions.div_ceil(64))?, constrictions);
        let increments: Vec<u64> = saved.read("history_increment")?;
        let constrictions: Vec<u32> = saved.read_exact("history_constriction", increments.len())?;
        if constrictions.iter().any(|&c| c as usize >= self.blocked.len() || !self.blocked[c as usize]) {
            return Err(wrong("history"));
        }
        let pair = |(&increment, &constriction)| Blocking { increment, constriction };
        self.history = increments.iter().zip(&constrictions).map(pair).collect();
        if self.openings.is_some() {
            let openings = openings(saved, self.blocked.len())?;
            let smallest = supply.sampler().smallest();
            if !openings.can_be(network, &self.blocked, record.increment, smallest) {
                return Err(wrong("openings"));
            }
            self.openings = Some(openings);
        }
        self.retained_in_constrictions = saved.read_exact("retained_in_constrictions", network.voids())?;
        self.retained_in_voids = saved.read_exact("retained_in_voids", network.voids())?;
        if !self.retained_cubes.is_empty() {
            self.retained_cubes = saved.read_exact("retained_cubes", network.voids())?;
        }
        for (sizes, number, mass) in [
            (&mut self.eroded_sizes, "eroded_number", "eroded_mass"),
            (&mut self.retained_sizes, "retained_number", "retained_mass"),
        ] {
            let classes = sizes.number.len();
            *sizes = SizeCounts {
                number: saved.read_exact(number, classes)?,
                mass: saved.read_exact(mass, classes)?,
            };
        }
        (self.increment, self.finished, self.tally) = (record.increment, record.finished, record.tally);
        if self.tally.check(self.increment).is_err()
            || self.tally.blocked != network.blocked_count(&self.blocked)
        {
            return Err(wrong("sums"));
        }
        self.check(supply, wrong)
    }

    /// Refuses an impossible number in a restored state whose columns have the right lengths and whose
    /// tally is consistent; `wrong` makes the error.
    ///
    /// Checksums protect a checkpoint from accidents, not from forgery with new checksums. A forged state may
    /// give wrong results, but it must not index beyond a column, overflow a sum, or walk for ever.
    fn check<E>(&self, supply: &Supply, wrong: impl Fn(&str) -> E) -> Result<(), E> {
        let tally = &self.tally;
        let passive = supply.passive_inserted(self.increment);
        let inserting = self.increment < supply.increments();
        if self.increment > MOST_INCREMENTS || self.finished != (!inserting && tally.moving == 0) {
            return Err(wrong("increment"));
        }
        if u128::from(tally.inserted) != u128::from(supply.inserted(self.increment)) + u128::from(passive) {
            return Err(wrong("number of particles"));
        }
        // Trapped particles stay in the columns.
        let live: u128 = self.particles.live.iter().map(|&n| u128::from(n)).sum();
        let still = match &self.passive {
            Passive::OneByOne => 0,
            Passive::Counts(moving) => sum(moving),
            Passive::Expected(expected) => {
                if !self.expectation_can_be(expected, passive) {
                    return Err(wrong("expectation"));
                }
                u128::from(expected.sums.inserted - expected.sums.counted.at_rest)
            }
        };
        if live + still != u128::from(tally.moving) + u128::from(tally.trapped) {
            return Err(wrong("number of moving particles"));
        }
        let columns = [&self.retained_in_constrictions, &self.retained_in_voids];
        let sizes = [&self.eroded_sizes, &self.retained_sizes];
        let numbers = columns.into_iter().chain(sizes.map(|sizes| &sizes.number));
        if numbers.into_iter().any(|column| sum(column) > u128::from(tally.inserted)) {
            return Err(wrong("number of retained or eroded particles"));
        }
        let masses = sizes.into_iter().flat_map(|sizes| &sizes.mass).copied();
        let largest = f64::from(tally.largest_eroded);
        let mut masses = masses.chain([tally.inserted_mass, tally.eroded_mass, largest]);
        if masses.any(|mass| !mass.is_finite()) {
            return Err(wrong("mass"));
        }
        let is_past = |b: &Blocking| (1..=self.increment).contains(&b.increment);
        if self.history.iter().all(is_past) { Ok(()) } else { Err(wrong("history")) }
    }

    /// Tells if an expectation is valid: non-negative numbers that sum to the number inserted, with their
    /// integer counts included in the tally.
    fn expectation_can_be(&self, expected: &Expected, inserted: u64) -> bool {
        let (sums, counted) = (&expected.sums, &expected.sums.counted);
        let columns = || expected.moving.iter().chain(&expected.retained);
        let is_number = |n: &f64| n.is_finite() && *n >= 0.0;
        let whole = columns().sum::<f64>() + sums.eroded;
        let retained = sum(&expected.counted_retained);
        let in_voids = self.retained_in_voids.iter();
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

/// Reads the openings of a network with this many exits.
fn openings(saved: &Checkpoint, exits: usize) -> Result<Openings, CheckpointError> {
    let increments: Vec<u64> = saved.read("narrowed_increment")?;
    let constrictions: Vec<u32> = saved.read_exact("narrowed_constriction", increments.len())?;
    let before: Vec<f32> = saved.read_exact("narrowed_before", increments.len())?;
    let after: Vec<f32> = saved.read_exact("narrowed_after", increments.len())?;
    let rows = increments.into_iter().zip(constrictions).zip(before.into_iter().zip(after));
    let narrowing =
        |((increment, constriction), (before, after))| Narrowing { increment, constriction, before, after };
    Ok(Openings { history: rows.map(narrowing).collect(), widths: saved.read_exact("widths", exits)? })
}

/// Place of the next moving particle of a column, up to the numbers in `live`.
struct Place<'a> {
    live: &'a [u32],
    chunk: usize,
    within: usize,
}

impl<'a> Place<'a> {
    fn new(live: &'a [u32]) -> Self {
        Self { live, chunk: 0, within: 0 }
    }

    fn put<T: Pod>(&mut self, mut piece: &[T], column: &mut [T]) {
        while !piece.is_empty() {
            let room = self.live[self.chunk] as usize - self.within;
            let now = room.min(piece.len());
            let start = self.chunk * CHUNK + self.within;
            column[start..start + now].copy_from_slice(&piece[..now]);
            piece = &piece[now..];
            self.within += now;
            if self.within == self.live[self.chunk] as usize {
                (self.chunk, self.within) = (self.chunk + 1, 0);
            }
        }
    }
}

/// Packs bits into words, the first bit lowest in the first word; unused bits are 0.
fn to_words(bits: &BitVec) -> Vec<u64> {
    bits.chunks(64).map(|part| part.load_le()).collect()
}

/// Unpacks `len` bits from such words; missing bits are 0.
pub fn from_words(words: &[u64], len: usize) -> BitVec {
    let mut bits = BitVec::repeat(false, len);
    bits.chunks_mut(64).zip(words).for_each(|(part, &word)| part.store_le(word));
    bits
}

/// Relative error allowed in the sum of an expectation, for rounding over very many increments.
const ROUNDING: f64 = 1e-6;

const MOST_INCREMENTS: u64 = 1 << 62;

fn sum(column: &[u64]) -> u128 {
    column.iter().map(|&n| u128::from(n)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_come_back_from_words_and_stand_in_them_in_order() {
        for len in [0, 1, 31, 32, 33, 63, 64, 65, 127, 128, 1000] {
            for is_set in [|_| false, |_| true, |i| i % 3 == 1, |i| i * i % 7 < 3] as [fn(usize) -> bool; 4] {
                let bits = (0..len).map(is_set).collect::<BitVec>();
                let words = to_words(&bits);
                assert_eq!(words.len(), len.div_ceil(64));
                for at in 0..64 * words.len() {
                    let is = words[at / 64] >> (at % 64) & 1 == 1;
                    assert_eq!(is, bits.get(at).is_some_and(|bit| *bit), "bit {at} of {len}");
                }
                assert_eq!(from_words(&words, len), bits);
                assert_eq!(from_words(&words, len + 70).count_ones(), bits.count_ones());
                assert_eq!(from_words(&words, len / 2), bits[..len / 2]);
            }
        }
        assert_eq!(to_words(&from_words(&[u64::MAX, 0x0123_4567_89ab_cdef], 120))[1], 0x23_4567_89ab_cdef);
    }
}
