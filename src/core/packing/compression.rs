//! The state of a compression, as columns, and one step of it.
//!
//! # Reduced units
//! Length: the smallest diameter. Stress: the target pressure. Density: the grains' density. So the unit of
//! time is `smallest diameter * sqrt(density / pressure)` and a strain rate of 1e-3 is an inertial number of
//! 1e-3 for the smallest grains.
//!
//! # Step
//! Positions are in units of the cell's width and relative to its deformation, at full steps; velocities
//! (without the motion of the cell) and spins at half steps. A step: forces from positions and the last half
//! step's velocities, kick, drift, and the cell grows by the servo's strain rate.
//!
//! # Masses
//! A grain of diameter `D` weighs `pi/6 D^(3 - mass_exponent)`. With the true masses (0) the smallest grains
//! set the time step and the largest take `Dmax/Dmin` times as many steps to move as the smallest. Masses do
//! not matter in a packing at rest.
//!
//! If the largest grain is 20 times as wide as the smallest or more, a few small grains between large ones
//! have contacts so stiff that they would set the step of all. Each grain is then moved with a mass of at
//! least `s K t^2 / 4`, and the moment of inertia of that mass: `K` is the sum of its contacts' stiffness at
//! that moment, `s` the factor of the critical step `2 / sqrt(s K / m)`, and `t` 1.5 times the critical step
//! before there are contacts. The damping of contacts and the energies keep the grain's own mass, so that its
//! restitution differs. A fixed step makes no grain heavier. A stage then ends after as much time as with the
//! own masses: a hold is counted in the steps that the own masses would have taken.

use super::contact::{Grains, Law, Now, Work, pass};
use super::grains::{Cell, Packing};
use super::limits::{
    WIDE, critical_step, damped_part, heavier_mass_by_stiffness, is_wide, law, mass, stability,
};
use super::motion::{ChunkInStep, LONGEST_MOVE, StepRule, Sums, advance, split};
use super::neighbours::{Aspect, GrainChunk, Reach, chunk_bounds};
use super::observed::HoldState;
use super::settings::{PackingError, Settings};
use crate::gradation::Gradation;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Largest ratio of a cell's height to its width.
pub(super) const TALLEST: f64 = 100.0;

/// Steps between two checks of the time step.
const STEP_CHECK: u64 = 16;

/// Part of the critical step at which the step is checked without waiting.
const CLOSE_STEP: f64 = 0.85;

/// Part of the way to its target strain rate that the servo goes in a step. The contacts' damping makes the
/// pressure answer at once to the strain rate; an immediate servo swings between its limits from step to step
/// once its gain exceeds the viscosity's inverse (0.03 for Cu 6 at 5e4 times the pressure), this one only
/// above seven times that gain.
const SERVO_SHARE: f64 = 0.25;

/// Stages of a compression.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// The cell shrinks at a constant rate.
    Squeeze,
    /// The servo holds the pressure, with the friction of the compression.
    Compress,
    /// The servo holds the pressure, with the final friction.
    Settle,
    /// Settled.
    Done,
}

/// Grains under compression: columns by grain in memory order, which changes, and `rank` (0 = the largest),
/// which is fixed.
#[derive(Clone, Debug)]
pub struct Compression {
    /// The settings.
    pub(super) settings: Settings,
    /// The smallest diameter (mm): the unit of length.
    pub(super) unit_mm: f64,
    /// Rank of each grain by size, from the largest.
    pub(super) rank: Vec<u32>,
    /// Place in the user's columns, by rank.
    pub(super) origin: Vec<u32>,
    /// Position along x, y, z in units of the cell; radius.
    pub(super) position: Vec<[f64; 4]>,
    /// Velocity along x, y, z relative to the deforming cell, at the last half step; mass.
    pub(super) velocity: Vec<[f64; 4]>,
    /// Angular velocity about x, y, z at the last half step; zero.
    pub(super) spin: Vec<[f64; 4]>,
    /// Position when the lists were made.
    pub(super) listed: Vec<[f64; 4]>,
    /// Edge of the cell when the lists were made.
    pub(super) listed_cell: f64,
    /// Reach of the lists.
    pub(super) reach: Reach,
    /// Step in which the lists were made.
    pub(super) listed_at: u64,
    /// Position when the close pairs were picked.
    pub(super) picked: Vec<[f64; 4]>,
    /// Edge of the cell when the close pairs were picked.
    pub(super) picked_cell: f64,
    /// Reach of the close pairs.
    pub(super) close: Reach,
    /// Step in which the close pairs were picked.
    pub(super) picked_at: u64,
    /// Width of the cell.
    pub(super) cell: f64,
    /// Height of the cell by its width, which is fixed.
    pub(super) aspect: Aspect,
    /// Relative growth of the cell per unit of time.
    pub(super) strain_rate: f64,
    /// Time step.
    pub(super) step: f64,
    /// Time.
    pub(super) time: f64,
    /// Steps done.
    pub(super) steps: u64,
    /// Current stage.
    pub(super) stage: Stage,
    /// Mean contact pressure in the last step, by target.
    pub(super) pressure: f64,
    /// Largest sum of contact stiffness by the mass that the grain was moved with, in the last step.
    pub(super) stiffest: f64,
    /// Sum of the mass that grains were moved with times squared velocity, in the last step.
    pub(super) twice_kinetic: f64,
    /// Sum of the squared unbalanced forces, in the last step.
    pub(super) unbalanced: f64,
    /// Mean normal force of the contacts in the last step.
    pub(super) mean_normal: f64,
    /// Contacts in the last step.
    pub(super) contacts: u64,
    /// State that the protocol keeps between its checks.
    pub(super) hold: HoldState,
    /// The contact law.
    pub(super) law: Law,
    /// The lists, with the tangential memory.
    pub(super) chunks: Vec<GrainChunk>,
    /// Farthest move of any grain since the close pairs were picked, in units of the cell; infinite before
    /// the first pick.
    pub(super) moved: f64,
    /// The critical step before there are contacts.
    loose_step: f64,
    /// True if sizes differ so much that the most crowded grains are moved as heavier ones.
    pub(super) is_wide: bool,
    /// Chunk of each grain.
    chunk_of: Vec<u16>,
    work: Vec<Work>,
    force: Vec<[f64; 4]>,
    torque: Vec<[f64; 4]>,
}

impl Compression {
    /// Makes a compression of grains at any position, at rest.
    ///
    /// # Errors
    /// Settings out of range; invalid grains; a cell narrower than two of the largest grain; coincident
    /// centres; a fixed step that is not below the critical one.
    pub fn new(packing: &Packing, settings: &Settings) -> Result<Self, PackingError> {
        settings.check()?;
        let columns = [packing.x.len(), packing.y.len(), packing.z.len(), packing.diameter.len()];
        let n = columns[0];
        if columns.iter().any(|&c| c != n) || n == 0 {
            return Err(PackingError::Columns(columns));
        }
        let (cell_mm, aspect) = match packing.cell {
            Cell::Periodic([x, y, z])
                if x == y && x > 0.0 && x < f64::INFINITY && z >= x && z <= 1.001 * TALLEST * x =>
            {
                (x, Aspect::new(z / x))
            }
            other => return Err(PackingError::Cell(format!("{other:?}"))),
        };
        for (column, values) in [("x", &packing.x), ("y", &packing.y), ("z", &packing.z)] {
            if let Some(grain) = values.iter().position(|v| !v.is_finite()) {
                let value = values[grain];
                return Err(PackingError::Grain { grain, column, value, allowed: "a finite number" });
            }
        }
        let good = |d: &f64| *d > 0.0 && *d < f64::INFINITY;
        if let Some(grain) = packing.diameter.iter().position(|d| !good(d)) {
            let value = packing.diameter[grain];
            return Err(PackingError::Grain {
                grain,
                column: "diameter",
                value,
                allowed: "a positive number",
            });
        }
        let mut origin: Vec<u32> = (0..n as u32).collect();
        origin.sort_by(|&a, &b| {
            packing.diameter[b as usize].total_cmp(&packing.diameter[a as usize]).then(a.cmp(&b))
        });
        let unit_mm = packing.diameter[origin[n - 1] as usize];
        let largest_mm = packing.diameter[origin[0] as usize];
        if cell_mm < 2.0 * largest_mm {
            return Err(PackingError::NarrowCell { cell_mm, largest_mm });
        }
        let position: Vec<[f64; 4]> = origin
            .iter()
            .map(|&i| {
                let i = i as usize;
                let radius = 0.5 * (packing.diameter[i] / unit_mm);
                let [x, y, z] =
                    aspect.wrapped([packing.x[i], packing.y[i], packing.z[i]].map(|mm| mm / cell_mm));
                [x, y, z, radius]
            })
            .collect();
        let mut by_place: Vec<usize> = (0..n).collect();
        by_place.sort_by(|&a, &b| position[a][..3].partial_cmp(&position[b][..3]).expect("finite"));
        if let Some(w) = by_place.windows(2).find(|w| position[w[0]][..3] == position[w[1]][..3]) {
            let (a, b) = (origin[w[0]] as usize, origin[w[1]] as usize);
            return Err(PackingError::Coincident { first: a.min(b), second: a.max(b) });
        }
        let velocity: Vec<[f64; 4]> =
            position.iter().map(|p| [0.0, 0.0, 0.0, mass(p[3], settings.mass_exponent)]).collect();
        let cell = cell_mm / unit_mm;
        let mut this = Self::blank(settings, position, velocity, unit_mm, origin, (cell, aspect));
        if let Some(step) = settings.step
            && step >= this.loose_step
        {
            let (critical, cause) = critical_step(&this.position, &this.velocity, settings);
            return Err(PackingError::Step { step, critical, cause });
        }
        this.relist();
        this.picked.clone_from(&this.position);
        Ok(this)
    }

    /// Grains in order of rank, at rest, without lists.
    pub(super) fn blank(
        settings: &Settings,
        position: Vec<[f64; 4]>,
        velocity: Vec<[f64; 4]>,
        unit_mm: f64,
        origin: Vec<u32>,
        (cell, aspect): (f64, Aspect),
    ) -> Self {
        let n = position.len();
        let (critical, _) = critical_step(&position, &velocity, settings);
        let [smallest, largest] = position
            .iter()
            .fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], p| [low.min(p[3]), high.max(p[3])]);
        let mut chunk_of = vec![0; n];
        let bounds = chunk_bounds(n);
        for (c, &(first, last)) in bounds.iter().enumerate() {
            chunk_of[first..last].fill(c as u16);
        }
        let (relative, absolute) = (0.1 * settings.reach.relative, 0.1 * settings.reach.absolute);
        Self {
            settings: settings.clone(),
            unit_mm,
            rank: (0..n as u32).collect(),
            origin,
            listed: Vec::new(),
            position,
            velocity,
            spin: vec![[0.0; 4]; n],
            listed_cell: cell,
            reach: settings.reach,
            listed_at: 0,
            picked: Vec::new(),
            picked_cell: cell,
            close: Reach { relative, absolute },
            picked_at: 0,
            cell,
            aspect,
            strain_rate: 0.0,
            step: settings.step.unwrap_or(settings.step_fraction * critical),
            time: 0.0,
            steps: 0,
            stage: Stage::Squeeze,
            pressure: 0.0,
            stiffest: 0.0,
            twice_kinetic: 0.0,
            unbalanced: 0.0,
            mean_normal: 0.0,
            contacts: 0,
            hold: HoldState::default(),
            law: law(settings, settings.friction),
            chunks: Vec::new(),
            moved: f64::INFINITY,
            loose_step: critical,
            is_wide: largest / smallest >= WIDE,
            chunk_of,
            work: vec![Work::new(bounds.len()); bounds.len()],
            force: vec![[0.0; 4]; n],
            torque: vec![[0.0; 4]; n],
        }
    }

    /// Steps done.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Current stage.
    pub fn stage(&self) -> Stage {
        self.stage
    }

    /// Angular velocity about x, y, z of each grain, in reduced units, in memory order.
    pub fn spins(&self) -> Vec<[f64; 3]> {
        self.spin.iter().map(|w| [w[0], w[1], w[2]]).collect()
    }

    /// Mean contact pressure of the last step, by target.
    pub fn pressure(&self) -> f64 {
        self.pressure
    }

    /// Volume of the cell by volume of the grains, less one.
    pub fn void_ratio(&self) -> f64 {
        self.cell_volume() / self.grain_volume() - 1.0
    }

    fn cell_volume(&self) -> f64 {
        self.cell * self.cell * self.cell * self.aspect.height()
    }

    pub(super) fn grain_volume(&self) -> f64 {
        let mut cubes = vec![0.0; self.rank.len()];
        for (p, &r) in self.position.iter().zip(&self.rank) {
            cubes[r as usize] = p[3] * p[3] * p[3];
        }
        cubes.iter().sum::<f64>() * (4.0 / 3.0 * PI)
    }

    /// The largest stable time step for the contacts of the last step.
    pub fn critical_step(&self) -> f64 {
        self.critical(self.stiffest)
    }

    /// Critical step of grains whose stiffest contacts, by mass, sum up to `stiffest`.
    fn critical(&self, stiffest: f64) -> f64 {
        if stiffest > 0.0 { 2.0 / (stability(&self.law) * stiffest).sqrt() } else { f64::INFINITY }
    }

    /// Step that follows their critical one.
    fn followed(&self, stiffest: f64) -> f64 {
        let part = self.settings.step_fraction.min(damped_part(&self.law));
        part * self.critical(stiffest).min(2.0 * self.loose_step)
    }

    /// Takes one step, without servo: the strain rate is left as it is.
    pub(super) fn advance_once(&mut self, servo: Option<(f64, f64)>) -> Result<(), PackingError> {
        let pick = self.renew();
        self.steps += 1;
        let now = Now {
            cell: self.cell,
            aspect: self.aspect,
            strain_rate: self.strain_rate,
            step: self.step,
            pick,
        };
        let parallel = rayon::current_num_threads() > 1 && self.chunks.len() > 1;
        {
            let grains = Grains {
                position: &self.position,
                velocity: &self.velocity,
                spin: &self.spin,
                chunk: &self.chunk_of,
            };
            let law = &self.law;
            let (force, torque) = (split(&mut self.force), split(&mut self.torque));
            let tasks = self.chunks.iter_mut().zip(&mut self.work).zip(force.into_iter().zip(torque));
            if parallel {
                let tasks: Vec<_> = tasks.collect();
                tasks.into_par_iter().for_each(|((chunk, work), (force, torque))| {
                    pass(chunk, work, grains, law, &now, force, torque);
                });
            } else {
                for ((chunk, work), (force, torque)) in tasks {
                    pass(chunk, work, grains, law, &now, force, torque);
                }
            }
        }
        let (mut virial, mut normal) = (0.0, 0.0);
        self.contacts = 0;
        for work in &self.work {
            virial += work.virial;
            normal += work.normal;
            self.contacts += work.contacts;
        }
        self.pressure = virial / (3.0 * self.cell * self.cell * self.cell * self.aspect.height());
        self.mean_normal = if self.contacts > 0 { normal / self.contacts as f64 } else { 0.0 };
        if let Some((rate, gain)) = servo {
            let goal = (gain * (self.pressure - 1.0)).clamp(-rate, rate);
            self.strain_rate += SERVO_SHARE * (goal - self.strain_rate);
        }
        self.kick_and_drift(parallel);
        self.cell *= 1.0 + self.strain_rate * self.step;
        self.time += self.step;
        if self.steps.is_multiple_of(STEP_CHECK) || self.step > CLOSE_STEP * self.critical_step() {
            self.check_step()?;
        }
        Ok(())
    }

    fn kick_and_drift(&mut self, parallel: bool) {
        let n = self.position.len();
        let step = self.step;
        let drag = step * if self.hold.braking { self.settings.settling_drag } else { self.settings.drag };
        let rule = StepRule {
            step,
            per_cell: step / (self.cell * (1.0 + 0.5 * self.strain_rate * step)),
            keep: (1.0 - 0.5 * drag) / (1.0 + 0.5 * drag),
            kick: 1.0 / (1.0 + 0.5 * drag),
            local: self.settings.local_damping,
            fastest: LONGEST_MOVE / step,
            rotate: self.law.friction > 0.0,
            least_mass: match self.makes_heavier() {
                true => heavier_mass_by_stiffness(&self.law, self.loose_step),
                false => 0.0,
            },
        };
        let work = &self.work;
        let picked = &self.picked;
        let bounds = chunk_bounds(n);
        let mut parts: Vec<ChunkInStep<'_>> = split(&mut self.position)
            .into_iter()
            .zip(split(&mut self.velocity))
            .zip(split(&mut self.spin))
            .zip(split(&mut self.force).into_iter().zip(split(&mut self.torque)))
            .zip(bounds)
            .enumerate()
            .map(|(c, ((((position, velocity), spin), (force, torque)), (first, last)))| ChunkInStep {
                chunk: c,
                first,
                position,
                velocity,
                spin,
                force,
                torque,
                picked: &picked[first..last],
                sums: Sums::default(),
            })
            .collect();
        if parallel {
            parts.par_iter_mut().for_each(|part| advance(part, work, &rule));
        } else {
            for part in &mut parts {
                advance(part, work, &rule);
            }
        }
        let mut total = Sums::default();
        for part in &parts {
            total.moved = total.moved.max(part.sums.moved);
            total.stiffest = total.stiffest.max(part.sums.stiffest);
            total.stiffest_of_own = total.stiffest_of_own.max(part.sums.stiffest_of_own);
            total.twice_kinetic += part.sums.twice_kinetic;
            total.unbalanced += part.sums.unbalanced;
        }
        self.moved = total.moved.sqrt();
        self.stiffest = total.stiffest;
        self.twice_kinetic = total.twice_kinetic;
        self.unbalanced = total.unbalanced;
        if rule.least_mass > 0.0 {
            self.hold.saved += (step / self.followed(total.stiffest_of_own) - 1.0).max(0.0);
        }
    }

    /// Tells if crowded grains are moved as heavier ones.
    pub(super) fn makes_heavier(&self) -> bool {
        self.is_wide && self.settings.step.is_none()
    }

    /// Moves crowded grains as heavier ones if the gradation that the grains were drawn from is wide: a small
    /// sample may miss the extremes, and one gradation has one protocol.
    pub fn of_gradation(mut self, gradation: &Gradation) -> Self {
        self.is_wide = is_wide(gradation);
        self
    }

    /// Keeps the step below the critical one: follows it, or refuses a fixed step that is no longer below it.
    fn check_step(&mut self) -> Result<(), PackingError> {
        let critical = self.critical_step();
        match self.settings.step {
            Some(step) if step >= critical => {
                Err(PackingError::Step { step, critical, cause: "the stiffness of a grain's contacts" })
            }
            Some(_) => Ok(()),
            None => {
                let goal = self.followed(self.stiffest);
                self.step = if goal < self.step { goal } else { goal.min(1.02 * self.step) };
                Ok(())
            }
        }
    }

    /// Grains in their present state, in the order that they were given in.
    pub fn packing(&self) -> Packing {
        let n = self.rank.len();
        let edge = self.cell * self.unit_mm;
        let mut packing = Packing {
            cell: Cell::Periodic([edge, edge, edge * self.aspect.height()]),
            x: vec![0.0; n],
            y: vec![0.0; n],
            z: vec![0.0; n],
            diameter: vec![0.0; n],
        };
        for (p, &r) in self.position.iter().zip(&self.rank) {
            let i = self.origin[r as usize] as usize;
            let height = self.aspect.height();
            let wrapped = |s: f64, length: f64| (s - length * libm::floor(s / length)) * edge;
            packing.x[i] = wrapped(p[0], 1.0);
            packing.y[i] = wrapped(p[1], 1.0);
            packing.z[i] = wrapped(p[2], height);
            packing.diameter[i] = 2.0 * p[3] * self.unit_mm;
        }
        packing
    }
}
