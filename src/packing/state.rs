//! A compression as bytes, and back: a resumed compression gives the same bits as an unbroken one.
//!
//! Little-endian 64-bit words: magic, version, hash of the settings, the scalars, then the columns (each its length and its
//! entries), and last the XXH3 hash of all before it, which finds accidents, not attackers. The lists
//! are not stored: they follow from the positions at which they were made, which are. The tangential memory is stored for the close pairs in list
//! order.

use super::compression::{Compression, Stage};
use super::measure::Measure;
use super::neighbours::{Reach, list};
use super::protocol::Watch;
use super::settings::{PackingError, Settings};
use xxhash_rust::xxh3::xxh3_64;

const MAGIC: u64 = u64::from_le_bytes(*b"vwpacked");
const VERSION: u64 = 1;

/// Writes words one after another.
#[derive(Default)]
struct Writer(Vec<u8>);

impl Writer {
    fn word(&mut self, word: u64) {
        self.0.extend_from_slice(&word.to_le_bytes());
    }

    fn real(&mut self, real: f64) {
        self.word(real.to_bits());
    }

    fn rows(&mut self, rows: &[[f64; 4]]) {
        self.word(rows.len() as u64);
        rows.iter().flatten().for_each(|&v| self.real(v));
    }

    fn whole(&mut self, column: &[u32]) {
        self.word(column.len() as u64);
        column.iter().for_each(|&v| self.word(u64::from(v)));
    }
}

/// Reads them back.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn word(&mut self) -> Result<u64, PackingError> {
        let (word, rest) = self.0.split_first_chunk::<8>().ok_or(PackingError::State("it ends early"))?;
        self.0 = rest;
        Ok(u64::from_le_bytes(*word))
    }

    fn real(&mut self) -> Result<f64, PackingError> {
        self.word().map(f64::from_bits)
    }

    fn length(&mut self, words: usize) -> Result<usize, PackingError> {
        let length = usize::try_from(self.word()?).unwrap_or(usize::MAX);
        if length > self.0.len() / (8 * words) {
            return Err(PackingError::State("a column is longer than the file"));
        }
        Ok(length)
    }

    fn rows(&mut self) -> Result<Vec<[f64; 4]>, PackingError> {
        (0..self.length(4)?).map(|_| Ok([self.real()?, self.real()?, self.real()?, self.real()?])).collect()
    }

    fn whole(&mut self) -> Result<Vec<u32>, PackingError> {
        (0..self.length(1)?)
            .map(|_| u32::try_from(self.word()?).map_err(|_| PackingError::State("a rank is too large")))
            .collect()
    }
}

fn measure_words(m: &Measure) -> [f64; 8] {
    [
        m.void_ratio,
        m.pressure_kpa,
        m.coordination,
        m.coordination_held,
        m.rattlers,
        m.kinetic_ratio,
        m.unbalanced,
        m.largest_overlap,
    ]
}

impl Compression {
    /// Everything that the next step depends on.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Writer::default();
        for word in [MAGIC, VERSION, fingerprint(&self.settings)] {
            out.word(word);
        }
        for word in [
            self.stage as u64,
            self.steps,
            self.listed_at,
            self.picked_at,
            self.contacts,
            self.watch.since,
            u64::from(self.watch.braking),
            u64::from(self.watch.before.is_some()),
        ] {
            out.word(word);
        }
        for real in [
            self.unit_mm,
            self.cell,
            self.listed_cell,
            self.picked_cell,
            self.reach.relative,
            self.reach.absolute,
            self.close.relative,
            self.close.absolute,
            self.moved,
            self.strain_rate,
            self.step,
            self.time,
            self.pressure,
            self.stiffest,
            self.twice_kinetic,
            self.unbalanced,
            self.mean_normal,
            self.law.friction,
            self.watch.coordination,
            self.watch.void_ratio,
        ] {
            out.real(real);
        }
        let before = self.watch.before.as_ref().map_or([0.0; 8], measure_words);
        before.iter().for_each(|&v| out.real(v));
        out.whole(&self.rank);
        out.whole(&self.origin);
        for rows in [&self.position, &self.velocity, &self.spin, &self.listed, &self.picked] {
            out.rows(rows);
        }
        let memory: Vec<[f64; 4]> = self.chunks.iter().flat_map(|c| c.memory.iter().copied()).collect();
        out.rows(&memory);
        out.word(xxh3_64(&out.0));
        out.0
    }

    /// A compression from its bytes, with the settings that it was made with.
    ///
    /// # Errors
    /// Bytes that are damaged, of another version, or of other settings.
    pub fn from_bytes(settings: &Settings, bytes: &[u8]) -> Result<Self, PackingError> {
        settings.check()?;
        let (body, sum) = bytes.split_last_chunk::<8>().ok_or(PackingError::State("it ends early"))?;
        if xxh3_64(body) != u64::from_le_bytes(*sum) {
            return Err(PackingError::State("its checksum is wrong"));
        }
        let mut from = Reader(body);
        if from.word()? != MAGIC {
            return Err(PackingError::State("it is not a compression"));
        }
        if from.word()? != VERSION {
            return Err(PackingError::State("it has another version"));
        }
        if from.word()? != fingerprint(settings) {
            return Err(PackingError::State("it was made with other settings"));
        }
        let stage = match from.word()? {
            0 => Stage::Squeeze,
            1 => Stage::Compress,
            2 => Stage::Settle,
            3 => Stage::Done,
            _ => return Err(PackingError::State("it has an unknown stage")),
        };
        let mut words = [0; 7];
        for word in &mut words {
            *word = from.word()?;
        }
        let [steps, listed_at, picked_at, contacts, since, braking, has_before] = words;
        let mut reals = [0.0; 20];
        for real in &mut reals {
            *real = from.real()?;
        }
        let mut m = [0.0; 8];
        for real in &mut m {
            *real = from.real()?;
        }
        let before = Measure {
            void_ratio: m[0],
            pressure_kpa: m[1],
            coordination: m[2],
            coordination_held: m[3],
            rattlers: m[4],
            kinetic_ratio: m[5],
            unbalanced: m[6],
            largest_overlap: m[7],
        };
        let (rank, origin) = (from.whole()?, from.whole()?);
        let (position, velocity, spin) = (from.rows()?, from.rows()?, from.rows()?);
        let (listed, picked, memory) = (from.rows()?, from.rows()?, from.rows()?);
        let n = rank.len();
        let lengths = [origin.len(), position.len(), velocity.len(), spin.len(), listed.len(), picked.len()];
        if n == 0 || lengths.iter().any(|&l| l != n) {
            return Err(PackingError::State("its columns differ in length"));
        }
        let mut this = Self::blank(settings, position, velocity, reals[0], origin, reals[1]);
        (this.rank, this.spin, this.listed, this.picked) = (rank, spin, listed, picked);
        (this.stage, this.steps, this.listed_at, this.picked_at) = (stage, steps, listed_at, picked_at);
        (this.contacts, this.listed_cell, this.picked_cell) = (contacts, reals[2], reals[3]);
        this.reach = Reach { relative: reals[4], absolute: reals[5] };
        this.close = Reach { relative: reals[6], absolute: reals[7] };
        (this.moved, this.strain_rate, this.step, this.time) = (reals[8], reals[9], reals[10], reals[11]);
        (this.pressure, this.stiffest, this.twice_kinetic) = (reals[12], reals[13], reals[14]);
        (this.unbalanced, this.mean_normal, this.law.friction) = (reals[15], reals[16], reals[17]);
        this.watch = Watch {
            since,
            coordination: reals[18],
            void_ratio: reals[19],
            braking: braking != 0,
            before: (has_before != 0).then_some(before),
        };
        this.chunks = list(&this.listed, &this.rank, this.listed_cell, this.reach);
        let mut taken = 0;
        for chunk in &mut this.chunks {
            if this.moved < f64::INFINITY {
                chunk.pick(&this.picked, this.picked_cell, this.close);
            }
            let own = memory.get(taken..taken + chunk.close.len());
            chunk.memory.copy_from_slice(own.ok_or(PackingError::State("memory is missing"))?);
            taken += chunk.close.len();
        }
        if taken != memory.len() {
            return Err(PackingError::State("memory is left over"));
        }
        Ok(this)
    }
}

/// Hash of the settings, for recognising them.
fn fingerprint(settings: &Settings) -> u64 {
    xxh3_64(format!("{settings:?}").as_bytes())
}
