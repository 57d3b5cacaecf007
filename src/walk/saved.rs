//! A state as sections of a checkpoint, and back.
//!
//! Nothing that can be rebuilt is kept: no generator, no thresholds, no network. Of the particles' columns the moving ones are
//! kept, chunk after chunk.

use bitvec::vec::BitVec;
use bytemuck::Pod;

use super::{Blocking, CHUNK, Expected, Passive, SizeCounts, State, Tally};
use crate::network::Network;
use crate::store::checkpoint::{Harmed, Saved, Section};

/// What is kept beside the columns; lives as long as the sections that borrow it.
pub struct Kept {
    words: Vec<u64>,
    reals: Vec<f64>,
    history_increment: Vec<u64>,
    history_constriction: Vec<u32>,
    expected: Vec<u64>,
}

impl Kept {
    /// What of a state is not a column.
    pub fn new(state: &State) -> Self {
        let t = &state.tally;
        let words = vec![
            state.seed,
            state.run,
            state.increment,
            u64::from(state.finished),
            state.passive.kind(),
            u64::from(state.passive_limit.to_bits()),
            t.inserted,
            t.moving,
            t.eroded,
            t.retained_in_constrictions,
            t.retained_in_voids,
            t.trapped,
            t.blocked,
            t.particle_moves,
            t.passive_inserted,
            t.passive_eroded,
            u64::from(t.largest_eroded.to_bits()),
            state.blocked.len() as u64,
        ];
        Self {
            words,
            reals: vec![t.inserted_mass, t.eroded_mass],
            history_increment: state.history.iter().map(|b| b.increment).collect(),
            history_constriction: state.history.iter().map(|b| b.constriction).collect(),
            expected: state.passive.expected_words(),
        }
    }

    /// The sections of a state.
    pub fn sections<'a>(&'a self, state: &'a State) -> Vec<Section<'a>> {
        let particles = &state.particles;
        let chunks = 0..particles.live.len();
        vec![
            Section::new("words", &self.words),
            Section::new("reals", &self.reals),
            Section::new("live", &particles.live),
            Section::parts("void", chunks.clone().map(|c| particles.chunk(c).0)),
            Section::parts("diameter", chunks.map(|c| particles.chunk(c).1)),
            Section::new("counts", state.passive.counts()),
            Section::new("expected", &self.expected),
            Section::new("blocked", state.blocked.as_raw_slice()),
            Section::new("history_increment", &self.history_increment),
            Section::new("history_constriction", &self.history_constriction),
            Section::new("in_constrictions", &state.retained_in_constrictions),
            Section::new("in_voids", &state.retained_in_voids),
            Section::new("eroded_number", &state.eroded_sizes.number),
            Section::new("eroded_mass", &state.eroded_sizes.mass),
            Section::new("retained_number", &state.retained_sizes.number),
            Section::new("retained_mass", &state.retained_sizes.mass),
        ]
    }
}

impl State {
    /// Takes a state from a checkpoint into this one, which is that of the same run before its first increment.
    ///
    /// # Errors
    /// A checkpoint that is harmed, or whose counts are not those of this run.
    pub fn restore(&mut self, network: &Network, saved: &mut Saved) -> Result<(), Harmed> {
        let file = format!("checkpoint of replicate {}", saved.label.replicate);
        let wrong = |what: &str| Harmed::new(file.clone(), format!("{what} cannot be of this run"));
        let words: Vec<u64> = fixed(saved, "words", 18)?;
        let reals: Vec<f64> = fixed(saved, "reals", 2)?;
        if words[0] != self.seed || words[1] != self.run || words[4] != self.passive.kind() {
            return Err(wrong("seed, run or engine"));
        }
        if words[17] != self.blocked.len() as u64 || words[5] != u64::from(self.passive_limit.to_bits()) {
            return Err(wrong("its network"));
        }
        let live: Vec<u32> = fixed(saved, "live", self.particles.live.len())?;
        if live.iter().any(|&n| n as usize > CHUNK) {
            return Err(wrong("particles of a chunk"));
        }
        let total: usize = live.iter().map(|&n| n as usize).sum();
        for name in ["void", "diameter"] {
            if saved.count::<u32>(name)? != total {
                return Err(wrong("number of particles"));
            }
        }
        let (mut voids, mut place) = (true, Place::new(&live));
        let column = &mut self.particles.void;
        saved.read_pieces::<u32>("void", |piece| {
            voids &= piece.iter().all(|&v| (v as usize) < network.voids());
            place.put(piece, column);
        })?;
        // One size is known without them.
        if !self.particles.has_one_size() {
            let mut place = Place::new(&live);
            let column = &mut self.particles.diameter;
            saved.read_pieces::<f32>("diameter", |piece| place.put(piece, column))?;
        }
        if !voids {
            return Err(wrong("void of a particle"));
        }
        self.particles.live = live;
        self.passive = match &self.passive {
            Passive::OneByOne => Passive::OneByOne,
            Passive::Counts(now) => Passive::Counts(fixed(saved, "counts", now.len())?),
            Passive::Expected(now) => {
                let words = saved.read::<u64>("expected")?;
                let then = Expected::from_words(now.moving.len(), &words);
                Passive::Expected(Box::new(then.ok_or_else(|| wrong("expectation"))?))
            }
        };
        let blocked: Vec<u64> = fixed(saved, "blocked", self.blocked.as_raw_slice().len())?;
        let mut bits = BitVec::from_vec(blocked);
        bits.truncate(self.blocked.len());
        self.blocked = bits;
        let increments: Vec<u64> = saved.read("history_increment")?;
        let constrictions: Vec<u32> = fixed(saved, "history_constriction", increments.len())?;
        if constrictions.iter().any(|&c| c as usize >= self.blocked.len() || !self.blocked[c as usize]) {
            return Err(wrong("history"));
        }
        let pair = |(&increment, &constriction)| Blocking { increment, constriction };
        self.history = increments.iter().zip(&constrictions).map(pair).collect();
        self.retained_in_constrictions =
            fixed(saved, "in_constrictions", self.retained_in_constrictions.len())?;
        self.retained_in_voids = fixed(saved, "in_voids", self.retained_in_voids.len())?;
        for (sizes, number, mass) in [
            (&mut self.eroded_sizes, "eroded_number", "eroded_mass"),
            (&mut self.retained_sizes, "retained_number", "retained_mass"),
        ] {
            let classes = sizes.number.len();
            *sizes =
                SizeCounts { number: fixed(saved, number, classes)?, mass: fixed(saved, mass, classes)? };
        }
        self.increment = words[2];
        self.finished = words[3] != 0;
        let size = |word: u64| f32::from_bits(word as u32);
        self.tally = Tally {
            inserted: words[6],
            moving: words[7],
            eroded: words[8],
            retained_in_constrictions: words[9],
            retained_in_voids: words[10],
            trapped: words[11],
            blocked: words[12],
            particle_moves: words[13],
            inserted_mass: reals[0],
            eroded_mass: reals[1],
            passive_inserted: words[14],
            passive_eroded: words[15],
            largest_eroded: size(words[16]),
        };
        if self.tally.check(self.increment).is_err() || self.tally.blocked != self.blocked.count_ones() as u64
        {
            return Err(wrong("sums"));
        }
        Ok(())
    }
}

/// A section with so many elements.
fn fixed<T: Pod>(saved: &mut Saved, name: &str, count: usize) -> Result<Vec<T>, Harmed> {
    let found = saved.count::<T>(name)?;
    if found != count {
        let file = format!("checkpoint of replicate {}", saved.label.replicate);
        return Err(Harmed::new(file, format!("section {name} has {found} elements, not {count}")));
    }
    saved.read(name)
}

/// Where the next moving particle of a column goes.
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
