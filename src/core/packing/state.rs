//! Stores a compression as bytes and restores it: a resumed compression gives the same bits as an unbroken
//! one.

use super::compression::{Compression, Stage, TALLEST};
use super::neighbours::{Aspect, Reach, list};
use super::observed::HoldState;
use super::settings::{PackingError, Settings};
use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::xxh3_64;

const MAGIC: [u8; 8] = *b"vwpacked";
const VERSION: u64 = 1;

/// State of a compression besides its columns; the fields of [`Compression`] with these names have the
/// details.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Record {
    /// XXH3 hash of the settings.
    settings: u64,
    grains: usize,
    /// Rows of `memory`.
    close_pairs: usize,
    stage: Stage,
    steps: u64,
    time: f64,
    step: f64,
    unit_mm: f64,
    cell: f64,
    /// Height by width of the cell; omitted for a cube.
    #[serde(default = "cube", skip_serializing_if = "is_cube")]
    aspect: f64,
    strain_rate: f64,
    friction: f64,
    /// True if crowded grains are moved as heavier ones.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    makes_heavier: bool,
    listed_at: u64,
    listed_cell: f64,
    reach: Reach,
    picked_at: u64,
    picked_cell: f64,
    close: Reach,
    /// `null` for infinity, before the first pick.
    moved: Option<f64>,
    contacts: u64,
    pressure: f64,
    stiffest: f64,
    twice_kinetic: f64,
    unbalanced: f64,
    mean_normal: f64,
    hold: HoldState,
}

fn cube() -> f64 {
    1.0
}

fn is_cube(aspect: &f64) -> bool {
    *aspect == 1.0
}

impl Compression {
    /// Writes everything that the next step depends on:
    ///
    /// | bytes | what |
    /// |---|---|
    /// | 8 | `vwpacked` |
    /// | 8 | version of this format, 1 (all numbers are little-endian) |
    /// | 8 | bytes of the record |
    /// | | the record: JSON with named fields; every floating-point number comes back bit for bit |
    /// | 4 n | `rank` (u32) of each of the `n` grains by size, in memory order |
    /// | 4 n | `origin` (u32): place in the user's columns, by rank |
    /// | 32 n each | `position`, `velocity`, `spin`, `listed`, `picked`: rows of four f64, in memory order |
    /// | 32 each | tangential memory of the close pairs, in list order |
    /// | 8 | XXH3-64 of everything before, which finds accidents, not attackers |
    ///
    /// The lists are left out: they follow from the stored positions at which they were made.
    pub fn to_bytes(&self) -> Vec<u8> {
        let memory: Vec<[f64; 4]> = self.chunks.iter().flat_map(|c| c.memory.iter().copied()).collect();
        let record = serde_json::to_vec(&self.record(memory.len())).expect("numbers and words");
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend((record.len() as u64).to_le_bytes());
        bytes.extend(record);
        bytes.extend_from_slice(bytemuck::cast_slice(&self.rank));
        bytes.extend_from_slice(bytemuck::cast_slice(&self.origin));
        for rows in [&self.position, &self.velocity, &self.spin, &self.listed, &self.picked, &memory] {
            bytes.extend_from_slice(bytemuck::cast_slice(rows));
        }
        bytes.extend(xxh3_64(&bytes).to_le_bytes());
        bytes
    }

    fn record(&self, close_pairs: usize) -> Record {
        Record {
            settings: fingerprint(&self.settings),
            grains: self.rank.len(),
            close_pairs,
            stage: self.stage,
            steps: self.steps,
            time: self.time,
            step: self.step,
            unit_mm: self.unit_mm,
            cell: self.cell,
            aspect: self.aspect.height(),
            strain_rate: self.strain_rate,
            friction: self.law.friction,
            makes_heavier: self.makes_heavier(),
            listed_at: self.listed_at,
            listed_cell: self.listed_cell,
            reach: self.reach,
            picked_at: self.picked_at,
            picked_cell: self.picked_cell,
            close: self.close,
            moved: self.moved.is_finite().then_some(self.moved),
            contacts: self.contacts,
            pressure: self.pressure,
            stiffest: self.stiffest,
            twice_kinetic: self.twice_kinetic,
            unbalanced: self.unbalanced,
            mean_normal: self.mean_normal,
            hold: self.hold,
        }
    }

    /// Restores a compression from its bytes, with the settings that it was made with.
    ///
    /// # Errors
    /// Bytes that are corrupt, of another version, or of other settings.
    pub fn from_bytes(settings: &Settings, bytes: &[u8]) -> Result<Self, PackingError> {
        settings.check()?;
        const EARLY: PackingError = PackingError::State("it ends early");
        let (body, sum) = bytes.split_last_chunk::<8>().ok_or(EARLY)?;
        if xxh3_64(body) != u64::from_le_bytes(*sum) {
            return Err(PackingError::State("its checksum is wrong"));
        }
        let (magic, body) = body.split_first_chunk::<8>().ok_or(EARLY)?;
        if *magic != MAGIC {
            return Err(PackingError::State("it is not a compression"));
        }
        let (version, body) = body.split_first_chunk::<8>().ok_or(EARLY)?;
        if u64::from_le_bytes(*version) != VERSION {
            return Err(PackingError::State("it has another version"));
        }
        let (length, body) = body.split_first_chunk::<8>().ok_or(EARLY)?;
        let length = usize::try_from(u64::from_le_bytes(*length)).unwrap_or(usize::MAX);
        let (record, columns) = body.split_at_checked(length).ok_or(EARLY)?;
        let record: Record =
            serde_json::from_slice(record).map_err(|_| PackingError::State("its record cannot be read"))?;
        if record.settings != fingerprint(settings) {
            return Err(PackingError::State("it was made with other settings"));
        }
        let n = record.grains;
        if n == 0 || columns.len() as u128 != 168 * n as u128 + 32 * record.close_pairs as u128 {
            return Err(PackingError::State("its columns have another length"));
        }
        let (rank, rest) = columns.split_at(4 * n);
        let (origin, rest) = rest.split_at(4 * n);
        let mut rows = rest.chunks(32 * n).map(bytemuck::pod_collect_to_vec::<u8, [f64; 4]>);
        let mut row = || rows.next().unwrap_or_default();
        let (position, velocity) = (row(), row());
        let origin = bytemuck::pod_collect_to_vec(origin);
        if !(1.0..=1.001 * TALLEST).contains(&record.aspect) {
            return Err(PackingError::State("its cell is none"));
        }
        let cell = (record.cell, Aspect::new(record.aspect));
        let mut this = Self::blank(settings, position, velocity, record.unit_mm, origin, cell);
        this.is_wide = record.makes_heavier;
        this.rank = bytemuck::pod_collect_to_vec(rank);
        (this.spin, this.listed, this.picked) = (row(), row(), row());
        let memory: Vec<[f64; 4]> = bytemuck::pod_collect_to_vec(&rest[160 * n..]);
        this.take(&record);
        this.chunks = list(&this.listed, &this.rank, this.listed_cell, this.aspect, this.reach);
        let mut taken = 0;
        for chunk in &mut this.chunks {
            if this.moved < f64::INFINITY {
                chunk.pick(&this.picked, this.picked_cell, this.aspect, this.close);
            }
            let part = memory.get(taken..taken + chunk.close.len());
            chunk.memory.copy_from_slice(part.ok_or(PackingError::State("memory is missing"))?);
            taken += chunk.close.len();
        }
        if taken != memory.len() {
            return Err(PackingError::State("memory is left over"));
        }
        Ok(this)
    }

    fn take(&mut self, record: &Record) {
        (self.stage, self.steps, self.time, self.step) =
            (record.stage, record.steps, record.time, record.step);
        (self.strain_rate, self.law.friction) = (record.strain_rate, record.friction);
        (self.listed_at, self.listed_cell, self.reach) = (record.listed_at, record.listed_cell, record.reach);
        (self.picked_at, self.picked_cell, self.close) = (record.picked_at, record.picked_cell, record.close);
        self.moved = record.moved.unwrap_or(f64::INFINITY);
        (self.contacts, self.pressure, self.stiffest) = (record.contacts, record.pressure, record.stiffest);
        (self.twice_kinetic, self.unbalanced) = (record.twice_kinetic, record.unbalanced);
        (self.mean_normal, self.hold) = (record.mean_normal, record.hold);
    }
}

/// Hash of the settings, for recognising them.
fn fingerprint(settings: &Settings) -> u64 {
    xxh3_64(format!("{settings:?}").as_bytes())
}
