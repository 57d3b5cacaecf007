//! The protocol of a compression: squeeze, hold the pressure, switch the friction, hold it again.

use super::compression::{Compression, Stage};
use super::draw::{draw, random_start};
use super::grains::Packing;
use super::observed::Measure;
use super::settings::{PackingError, Settings};
use crate::gradation::Gradation;
use std::f64::consts::PI;

/// Steps between two checks of the state.
const CHECK: u64 = 100;

/// Allowed departure of the pressure from its target.
const PRESSURE: f64 = 0.005;

/// Departure of the pressure from its target at which the drag is raised.
const BRAKE: f64 = 0.02;

/// Allowed root mean square unbalanced force by mean contact force: a frictionless packing has more in an
/// avalanche, less after it.
const UNBALANCED: f64 = 0.05;

/// Allowed kinetic by elastic energy.
const KINETIC: f64 = 1e-2;

/// Allowed change of the coordination number during a hold.
const COORDINATION: f64 = 0.05;

/// Allowed change of the void ratio during a hold: a quarter of the 0.002 that two seeds or half the rate
/// change it by. A wide grading with high friction creeps on as the logarithm of time, so some rate has to
/// count as rest.
const VOID_RATIO: f64 = 5e-4;

/// Progress of a running compression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompressionProgress {
    /// Current stage.
    pub stage: Stage,
    /// Steps done.
    pub steps: u64,
    /// Void ratio.
    pub void_ratio: f64,
    /// Pressure by target.
    pub pressure: f64,
    /// Mean coordination number `2 N_c / N_p`.
    pub coordination: f64,
    /// Root mean square unbalanced force by mean contact force.
    pub unbalanced: f64,
    /// Time step, reduced units.
    pub step: f64,
}

/// Result of a compression.
#[derive(Clone, Debug, PartialEq)]
pub struct PackReport {
    /// Settled with the friction of the compression.
    pub before: Measure,
    /// Settled with the final friction.
    pub after: Measure,
    /// Steps.
    pub steps: u64,
    /// Simulated time (s), with the masses of the settings.
    pub simulated_s: f64,
}

/// Draws grains from the gradation, places them at random and compresses them: see the
/// [module](crate::packing) for the protocol. `progress` is called every thousand steps and returns false to
/// stop.
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

impl Compression {
    /// Does `steps` steps of the protocol, or fewer if it settles. The division of the steps into calls does
    /// not change the result.
    ///
    /// # Errors
    /// A fixed time step that is too long for the contacts by now.
    pub fn advance(&mut self, steps: u64) -> Result<(), PackingError> {
        for _ in 0..steps {
            match self.stage {
                Stage::Done => break,
                Stage::Squeeze => {
                    self.strain_rate = -self.settings.squeeze_rate;
                    self.advance_once(None)?;
                }
                Stage::Compress | Stage::Settle => {
                    self.advance_once(Some((self.settings.servo_rate, self.settings.servo_gain)))?;
                }
            }
            if self.steps.is_multiple_of(CHECK) {
                self.check_stage();
            }
        }
        Ok(())
    }

    fn check_stage(&mut self) {
        match self.stage {
            Stage::Done => {}
            Stage::Squeeze => {
                let goal = self.settings.compression_target_fraction * self.expected_fraction();
                if 1.0 / (1.0 + self.void_ratio()) >= goal || self.pressure > 0.5 {
                    self.enter(Stage::Compress);
                }
            }
            Stage::Compress | Stage::Settle => {
                self.hold.braking |= (self.pressure - 1.0).abs() < BRAKE;
                if self.settled() {
                    let measure = self.measure();
                    if self.stage == Stage::Compress {
                        self.hold.before = Some(measure);
                        if self.settings.final_friction == self.settings.friction {
                            self.stage = Stage::Done;
                        } else {
                            self.law.friction = self.settings.final_friction;
                            self.enter(Stage::Settle);
                        }
                    } else {
                        self.stage = Stage::Done;
                    }
                }
            }
        }
    }

    fn enter(&mut self, stage: Stage) {
        self.stage = stage;
        (self.hold.since, self.hold.saved) = (self.steps, 0.0);
    }

    /// Tells if pressure, unbalanced force, coordination number and void ratio have held for long enough, and
    /// the grains rest.
    fn settled(&mut self) -> bool {
        let coordination = self.coordination();
        let void_ratio = self.void_ratio();
        let holds = (self.pressure - 1.0).abs() < PRESSURE
            && self.unbalanced_ratio() < UNBALANCED
            && (coordination - self.hold.coordination).abs() < COORDINATION
            && (void_ratio - self.hold.void_ratio).abs() < VOID_RATIO;
        if !holds {
            (self.hold.since, self.hold.saved) = (self.steps, 0.0);
            self.hold.coordination = coordination;
            self.hold.void_ratio = void_ratio;
        }
        let held = (self.steps - self.hold.since) as f64 + self.hold.saved;
        held >= self.settings.hold_steps as f64 && {
            let energy = self.energy();
            energy.kinetic < KINETIC * energy.elastic
        }
    }

    /// Mean coordination number `2 N_c / N_p` in the last step.
    pub fn coordination(&self) -> f64 {
        2.0 * self.contacts as f64 / self.rank.len() as f64
    }

    /// Rough packing fraction to be expected: it only decides when the servo replaces the squeeze.
    fn expected_fraction(&self) -> f64 {
        let mut by_rank = vec![0.0; self.rank.len()];
        for (p, &r) in self.position.iter().zip(&self.rank) {
            by_rank[r as usize] = 2.0 * p[3];
        }
        let total = 6.0 / PI * self.grain_volume();
        let size = |percent: f64| {
            let mut coarser = 0.0;
            for &d in &by_rank {
                coarser += d * d * d;
                if coarser >= (1.0 - percent / 100.0) * total {
                    return d;
                }
            }
            by_rank[by_rank.len() - 1]
        };
        let uniformity = size(60.0) / size(10.0);
        (0.635 + 0.08 * libm::log(uniformity) - 0.15 * self.settings.friction.min(0.4)).min(0.85)
    }

    /// Progress of the compression.
    pub fn progress(&self) -> CompressionProgress {
        CompressionProgress {
            stage: self.stage,
            steps: self.steps,
            void_ratio: self.void_ratio(),
            pressure: self.pressure,
            coordination: self.coordination(),
            unbalanced: self.unbalanced_ratio(),
            step: self.step,
        }
    }

    /// Goes on until settled, reporting every thousand steps; stops if `progress` returns false.
    ///
    /// # Errors
    /// Errors of [`Compression::advance`]; stopped by `progress`; not settled after the most steps allowed.
    pub fn run(
        &mut self,
        progress: impl FnMut(&CompressionProgress) -> bool,
    ) -> Result<PackReport, PackingError> {
        self.run_until(|| false, progress)
    }

    /// Runs like [`Compression::run`], to the same bits, asking whether to stop every million steps of a
    /// grain.
    ///
    /// # Errors
    /// Errors of [`Compression::run`].
    pub fn run_until(
        &mut self,
        is_stopped: impl Fn() -> bool,
        progress: impl FnMut(&CompressionProgress) -> bool,
    ) -> Result<PackReport, PackingError> {
        self.run_asking(1000, is_stopped, progress)
    }

    /// Runs like [`Compression::run`], to the same bits, reporting every `every` steps, which sets how soon
    /// it can be stopped.
    ///
    /// # Errors
    /// Errors of [`Compression::run`].
    pub fn run_reporting(
        &mut self,
        every: u64,
        progress: impl FnMut(&CompressionProgress) -> bool,
    ) -> Result<PackReport, PackingError> {
        self.run_asking(every.max(1), || false, progress)
    }

    fn run_asking(
        &mut self,
        every: u64,
        is_stopped: impl Fn() -> bool,
        mut progress: impl FnMut(&CompressionProgress) -> bool,
    ) -> Result<PackReport, PackingError> {
        let at_once = (1_000_000 / self.position.len().max(1) as u64).max(1);
        while self.stage != Stage::Done {
            // After a stop between two reports the run goes on to the next.
            let report = (self.steps / every + 1) * every;
            while self.stage != Stage::Done && self.steps < report {
                self.advance(at_once.min(report - self.steps))?;
                if self.stage != Stage::Done && is_stopped() {
                    return Err(PackingError::Stopped(self.steps));
                }
            }
            if !progress(&self.progress()) {
                return Err(PackingError::Stopped(self.steps));
            }
            if self.stage != Stage::Done && self.steps >= self.settings.max_steps {
                return Err(PackingError::Unsettled {
                    steps: self.steps,
                    pressure: self.pressure,
                    kinetic_ratio: self.measure().kinetic_ratio,
                });
            }
        }
        let after = self.measure();
        let unit_s =
            1e-3 * self.unit_mm * (self.settings.density_kg_m3 / (1e3 * self.settings.pressure_kpa)).sqrt();
        Ok(PackReport {
            before: self.hold.before.unwrap_or(after),
            after,
            steps: self.steps,
            simulated_s: self.time * unit_s,
        })
    }
}
