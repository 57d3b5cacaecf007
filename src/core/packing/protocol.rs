//! The protocol of a compression: squeeze, hold the pressure, switch the friction, hold again. A
//! compression can be stored as bytes at any step and continued with the same bits.

use super::neighbours::{Aspect, list};
use super::settings::{PackingError, Settings};
use super::state::{Compression, Measure, Moment, Stage};
use super::{Packing, draw, random_start};
use crate::gradation::Gradation;
use std::f64::consts::PI;
use xxhash_rust::xxh3::xxh3_64;

const MAGIC: [u8; 8] = *b"vwpacked";
const VERSION: u64 = 1;

const CHECK: u64 = 100;

/// Allowed relative deviation of the pressure from its target.
const PRESSURE: f64 = 0.005;

/// Relative deviation of the pressure from its target at which the drag is raised.
const BRAKE: f64 = 0.02;

/// Maximum root mean square unbalanced force over the mean contact force: a frictionless packing has
/// more during an avalanche, less after it.
const UNBALANCED: f64 = 0.05;

/// Maximum ratio of kinetic to elastic energy.
const KINETIC: f64 = 1e-2;

/// Maximum change of the coordination number during a hold.
const COORDINATION: f64 = 0.05;

/// Maximum change of the void ratio during a hold: a quarter of the 0.002 by which it differs between
/// two seeds or with half the rate.
const VOID_RATIO: f64 = 5e-4;

/// Progress of a running compression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompressionProgress {
    /// Current stage.
    pub stage: Stage,
    /// Number of steps done.
    pub steps: u64,
    /// Void ratio.
    pub void_ratio: f64,
    /// Pressure over its target.
    pub pressure: f64,
    /// Mean coordination number `2 N_c / N_p`.
    pub coordination: f64,
    /// Root mean square unbalanced force over the mean contact force.
    pub unbalanced: f64,
}

/// Result of a compression.
#[derive(Clone, Debug, PartialEq)]
pub struct PackReport {
    /// Values when settled with the friction of the compression.
    pub before: Measure,
    /// Values when settled with the final friction.
    pub after: Measure,
    /// Number of steps.
    pub steps: u64,
    /// Simulated time (s), with the masses of the settings.
    pub simulated_s: f64,
}

/// Draws grains from the gradation, places them at random and compresses them by the protocol of the
/// [module](crate::packing). `progress` is called every thousand steps and returns false to stop.
///
/// ```
/// use voidwalk_core::{gradation::Gradation, packing::{Settings, compress}};
/// let filter = Gradation::linear_from_d0(1.0, 1.2).unwrap();
/// let settings = Settings { grains: 200, stiffness_ratio: 0.01, ..Settings::default() };
/// let (packing, report) = compress(&filter, &settings, |_| true).unwrap();
/// assert_eq!(packing.x.len(), 200);
/// assert!((report.after.pressure_kpa - 50.0).abs() < 0.25);
/// ```
///
/// # Errors
/// Errors of [`random_start`], [`Compression::new`] and [`Compression::run`].
pub fn compress(
    gradation: &Gradation,
    settings: &Settings,
    progress: impl FnMut(&CompressionProgress) -> bool,
) -> Result<(Packing, PackReport), PackingError> {
    settings.check()?;
    let start = random_start(&draw(gradation, settings.grains, settings.seed), settings)?;
    let mut compression = Compression::new(&start, settings)?.of_gradation(gradation);
    let report = compression.run(progress)?;
    Ok((compression.packing(), report))
}

fn require(holds: bool, problem: &'static str) -> Result<(), PackingError> {
    if holds { Ok(()) } else { Err(PackingError::State(problem)) }
}

impl Compression {
    /// Does `steps` steps of the protocol, or fewer if it settles. The result does not depend on how the
    /// steps are divided into calls.
    ///
    /// # Errors
    /// A fixed time step that has become too long for the contacts.
    pub fn advance(&mut self, steps: u64) -> Result<(), PackingError> {
        for _ in 0..steps {
            match self.now.stage {
                Stage::Done => break,
                Stage::Squeeze => {
                    self.now.strain_rate = -self.settings.squeeze_rate;
                    self.advance_once(None)?;
                }
                Stage::Compress | Stage::Settle => {
                    self.advance_once(Some((self.settings.servo_rate, self.settings.servo_gain)))?;
                }
            }
            if self.now.steps.is_multiple_of(CHECK) {
                self.check_stage();
            }
        }
        Ok(())
    }

    fn check_stage(&mut self) {
        match self.now.stage {
            Stage::Done => {}
            Stage::Squeeze => {
                let goal = self.settings.compression_target_fraction * self.expected_fraction();
                if 1.0 / (1.0 + self.void_ratio()) >= goal || self.now.pressure > 0.5 {
                    self.enter(Stage::Compress);
                }
            }
            Stage::Compress | Stage::Settle => {
                self.now.hold.braking |= (self.now.pressure - 1.0).abs() < BRAKE;
                if !self.settled() {
                    return;
                }
                let (stage, last) = (self.now.stage, self.settings.final_friction);
                self.now.stage = Stage::Done;
                if stage == Stage::Compress {
                    self.now.hold.before = Some(self.measure());
                    if last != self.settings.friction {
                        self.law.friction = last;
                        self.enter(Stage::Settle);
                    }
                }
            }
        }
    }

    fn enter(&mut self, stage: Stage) {
        self.now.stage = stage;
        (self.now.hold.since, self.now.hold.saved) = (self.now.steps, 0.0);
    }

    /// Tells if pressure, unbalanced force, coordination number and void ratio have held for long
    /// enough, and the grains are at rest.
    fn settled(&mut self) -> bool {
        let coordination = self.coordination();
        let void_ratio = self.void_ratio();
        let holds = (self.now.pressure - 1.0).abs() < PRESSURE
            && self.unbalanced_ratio() < UNBALANCED
            && (coordination - self.now.hold.coordination).abs() < COORDINATION
            && (void_ratio - self.now.hold.void_ratio).abs() < VOID_RATIO;
        if !holds {
            (self.now.hold.since, self.now.hold.saved) = (self.now.steps, 0.0);
            self.now.hold.coordination = coordination;
            self.now.hold.void_ratio = void_ratio;
        }
        let held = (self.now.steps - self.now.hold.since) as f64 + self.now.hold.saved;
        held >= self.settings.hold_steps as f64 && {
            let energy = self.energy();
            energy.kinetic < KINETIC * energy.elastic
        }
    }

    /// Mean coordination number `2 N_c / N_p` in the last step.
    pub fn coordination(&self) -> f64 {
        2.0 * self.now.contacts as f64 / self.rank.len() as f64
    }

    /// Rough estimate of the final packing fraction; it only decides when the servo replaces the squeeze.
    fn expected_fraction(&self) -> f64 {
        let mut by_rank = vec![0.0; self.rank.len()];
        for (p, &r) in self.position.iter().zip(&self.rank) {
            by_rank[r as usize] = 2.0 * p[3];
        }
        let total = 6.0 / PI * self.grain_volume();
        let size = |percent: f64| {
            let mut coarser = 0.0;
            let reached = by_rank.iter().find(|&&d| {
                coarser += d * d * d;
                coarser >= (1.0 - percent / 100.0) * total
            });
            *reached.unwrap_or(&by_rank[by_rank.len() - 1])
        };
        let uniformity = size(60.0) / size(10.0);
        (0.635 + 0.08 * libm::log(uniformity) - 0.15 * self.settings.friction.min(0.4)).min(0.85)
    }

    fn progress(&self) -> CompressionProgress {
        CompressionProgress {
            stage: self.now.stage,
            steps: self.now.steps,
            void_ratio: self.void_ratio(),
            pressure: self.now.pressure,
            coordination: self.coordination(),
            unbalanced: self.unbalanced_ratio(),
        }
    }

    /// Continues until settled, reporting every thousand steps; stops if `progress` returns false.
    ///
    /// # Errors
    /// Errors of [`Compression::advance`]; stopped by `progress`; not settled after `max_steps`.
    pub fn run(
        &mut self,
        progress: impl FnMut(&CompressionProgress) -> bool,
    ) -> Result<PackReport, PackingError> {
        self.run_until(1000, || false, progress)
    }

    /// Runs like [`Compression::run`], to the same bits, but reports every `every` steps, and calls
    /// `is_stopped` once per million grain steps.
    pub fn run_until(
        &mut self,
        every: u64,
        is_stopped: impl Fn() -> bool,
        mut progress: impl FnMut(&CompressionProgress) -> bool,
    ) -> Result<PackReport, PackingError> {
        let at_once = (1_000_000 / self.position.len().max(1) as u64).max(1);
        while self.now.stage != Stage::Done {
            // After a stop between two reports, the run continues to the next.
            let report = (self.now.steps / every.max(1) + 1) * every.max(1);
            while self.now.stage != Stage::Done && self.now.steps < report {
                self.advance(at_once.min(report - self.now.steps))?;
                if self.now.stage != Stage::Done && is_stopped() {
                    return Err(PackingError::Stopped(self.now.steps));
                }
            }
            if !progress(&self.progress()) {
                return Err(PackingError::Stopped(self.now.steps));
            }
            if self.now.stage != Stage::Done && self.now.steps >= self.settings.max_steps {
                let (steps, pressure) = (self.now.steps, self.now.pressure);
                let kinetic_ratio = self.measure().kinetic_ratio;
                return Err(PackingError::Unsettled { steps, pressure, kinetic_ratio });
            }
        }
        let after = self.measure();
        let unit_s = 1e-3
            * self.now.unit_mm
            * (self.settings.density_kg_m3 / (1e3 * self.settings.pressure_kpa)).sqrt();
        Ok(PackReport {
            before: self.now.hold.before.unwrap_or(after),
            after,
            steps: self.now.steps,
            simulated_s: self.now.time * unit_s,
        })
    }

    /// Writes all data on which the next step depends:
    ///
    /// | bytes | content |
    /// |---|---|
    /// | 8 | `vwpacked` |
    /// | 8 | version of this format, 1 (all numbers are little-endian) |
    /// | 8 | bytes of the record |
    /// | | the record: JSON with named fields; every floating-point number is restored bit for bit |
    /// | 4 n | `rank` (u32) of each of the `n` grains by size, in memory order |
    /// | 4 n | `origin` (u32): index in the user's columns, by rank |
    /// | 32 n each | `position`, `velocity`, `spin`, `listed`, `picked`: rows of four f64, in memory order |
    /// | 32 each | tangential memory of the close pairs, in list order |
    /// | 8 | XXH3-64 of everything before it, which detects accidents, not attackers |
    ///
    /// The lists are left out: they are rebuilt from the stored positions at which they were made.
    pub fn to_bytes(&self) -> Vec<u8> {
        let memory: Vec<[f64; 4]> = self.chunks.iter().flat_map(|c| c.memory.iter().copied()).collect();
        let now = Moment {
            close_pairs: memory.len(),
            friction: self.law.friction,
            makes_heavier: self.makes_heavier(),
            ..self.now.clone()
        };
        let record = serde_json::to_vec(&now).expect("numbers and words");
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

    /// Restores a compression from its bytes and the settings with which it was made.
    ///
    /// # Errors
    /// Bytes that are corrupt, of another version, or of other settings.
    pub fn from_bytes(settings: &Settings, bytes: &[u8]) -> Result<Self, PackingError> {
        settings.check()?;
        const EARLY: PackingError = PackingError::State("it ends early");
        let (body, sum) = bytes.split_last_chunk::<8>().ok_or(EARLY)?;
        require(xxh3_64(body) == u64::from_le_bytes(*sum), "its checksum is wrong")?;
        let (magic, body) = body.split_first_chunk::<8>().ok_or(EARLY)?;
        require(*magic == MAGIC, "it is not a compression")?;
        let (version, body) = body.split_first_chunk::<8>().ok_or(EARLY)?;
        require(u64::from_le_bytes(*version) == VERSION, "it has another version")?;
        let (length, body) = body.split_first_chunk::<8>().ok_or(EARLY)?;
        let length = usize::try_from(u64::from_le_bytes(*length)).unwrap_or(usize::MAX);
        let (record, columns) = body.split_at_checked(length).ok_or(EARLY)?;
        let now: Moment =
            serde_json::from_slice(record).map_err(|_| PackingError::State("its record cannot be read"))?;
        require(now.settings == settings.fingerprint(), "it was made with other settings")?;
        let n = now.grains;
        let length = 168 * n as u128 + 32 * now.close_pairs as u128;
        require(n > 0 && columns.len() as u128 == length, "its columns have another length")?;
        require((1.0..=1.001 * Aspect::TALLEST).contains(&now.aspect), "its cell is invalid")?;
        let (rank, rest) = columns.split_at(4 * n);
        let (origin, rest) = rest.split_at(4 * n);
        let mut rows = rest.chunks(32 * n).map(bytemuck::pod_collect_to_vec::<u8, [f64; 4]>);
        let mut row = || rows.next().unwrap_or_default();
        let (position, velocity) = (row(), row());
        let origin = bytemuck::pod_collect_to_vec(origin);
        let makes_heavier = now.makes_heavier;
        let mut this = Self::blank(settings, now, position, velocity, origin);
        this.is_wide = makes_heavier;
        this.rank = bytemuck::pod_collect_to_vec(rank);
        (this.spin, this.listed, this.picked) = (row(), row(), row());
        let memory: Vec<[f64; 4]> = bytemuck::pod_collect_to_vec(&rest[160 * n..]);
        this.chunks = list(&this.listed, &this.rank, this.now.listed_cell, this.aspect, this.now.reach);
        let mut taken = 0;
        for chunk in &mut this.chunks {
            if this.now.moved < f64::INFINITY {
                chunk.pick(&this.picked, this.now.picked_cell, this.aspect, this.now.close);
            }
            let part = memory.get(taken..taken + chunk.close.len());
            chunk.memory.copy_from_slice(part.ok_or(PackingError::State("memory is missing"))?);
            taken += chunk.close.len();
        }
        require(taken == memory.len(), "memory is left over")?;
        Ok(this)
    }
}
