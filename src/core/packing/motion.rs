//! A step of a compression: complete lists, forces, kick and drift, and the time step.
//!
//! # Step
//! Positions are in units of the cell's width and relative to its deformation, at full steps; velocities
//! (without the motion of the cell) and spins are at half steps. A step: forces from the positions and
//! the last half step's velocities, kick, drift, and the cell deforms at the servo's strain rate.
//!
//! # Masses
//! A grain of diameter `D` has the mass `pi/6 D^(3 - mass_exponent)`: masses do not matter at rest, and with
//! the true ones (0) the smallest grains set the time step.
//!
//! If the largest grain is at least 20 times as wide as the smallest, a few small grains between large ones
//! have such stiff contacts that they would set the step for all. Each grain is then moved with a mass of
//! at least `s K t^2 / 4`, and the moment of inertia of that mass: `K` is the sum of its contact stiffness
//! at that moment, `s` the factor of the critical step `2 / sqrt(s K / m)`, and `t` 1.5 times the critical
//! step before there are contacts. The damping of contacts and the energies use the grain's own mass, so
//! its restitution differs. With a fixed step no grain gets a larger mass. A stage still takes as much time
//! as with the own masses: a hold is counted in the steps that the own masses would have taken.

use super::contact::{Now, Work, pass};
use super::neighbours::{GrainChunk, Reach, Remembered, chunk_bounds, list, morton};
use super::settings::{PackingError, damped_part, heavier_mass_by_stiffness, stability};
use super::state::Compression;
use multiversion::multiversion;
use rayon::prelude::*;

/// Farthest allowed move of a grain in a step, in units of the smallest diameter: only an overlapping
/// start comes near it.
pub(super) const LONGEST_MOVE: f64 = 0.02;

const STEP_CHECK: u64 = 16;

/// Fraction of the critical step at which the step is checked without waiting.
const CLOSE_STEP: f64 = 0.85;

/// Fraction of the way to its target strain rate that the servo takes in a step. Through the contacts'
/// damping the pressure responds at once to the strain rate. An immediate servo swings between its
/// limits from step to step once its gain exceeds the inverse of the viscosity (0.03 for Cu 6 at 5e4
/// times the pressure); this one only does so above seven times that gain.
const SERVO_SHARE: f64 = 0.25;

/// Number of steps for which a pick of close pairs should last.
const PICKS: (u64, u64) = (10, 25);

/// Number of steps for which lists should last.
const LISTS: (u64, u64) = (100, 300);

/// Lengthens a reach that lasted too short a time, and shortens one that lasted too long.
fn follow(reach: &mut Reach, strained: bool, lasted: u64, meant: (u64, u64), least: Reach) {
    if lasted < meant.0 {
        if strained {
            reach.relative = (reach.relative * 1.5).min(0.05);
        } else {
            reach.absolute = (reach.absolute * 1.3).min(1.0);
        }
    } else if lasted > meant.1 {
        reach.relative *= 0.8;
        reach.absolute *= 0.8;
    }
    reach.relative = reach.relative.max(least.relative);
    reach.absolute = reach.absolute.max(least.absolute);
}

impl Compression {
    /// Takes one step; without `servo` (its maximum rate, and its gain) the strain rate is unchanged.
    pub(super) fn advance_once(&mut self, servo: Option<(f64, f64)>) -> Result<(), PackingError> {
        let pick = self.renew();
        self.now.steps += 1;
        let now = Now {
            position: &self.position,
            velocity: &self.velocity,
            spin: &self.spin,
            chunk: &self.chunk_of,
            law: self.law,
            cell: self.now.cell,
            aspect: self.aspect,
            strain_rate: self.now.strain_rate,
            step: self.now.step,
            pick,
        };
        let parallel = rayon::current_num_threads() > 1 && self.chunks.len() > 1;
        let (force, torque) = (split(&mut self.force), split(&mut self.torque));
        let tasks = self.chunks.iter_mut().zip(&mut self.work).zip(force.into_iter().zip(torque));
        let one = |((chunk, work), (force, torque)): ((&mut GrainChunk, &mut Work), (&mut [_], &mut [_]))| {
            pass(chunk, work, &now, force, torque);
        };
        if parallel {
            tasks.collect::<Vec<_>>().into_par_iter().for_each(one);
        } else {
            tasks.for_each(one);
        }
        let (mut virial, mut normal) = (0.0, 0.0);
        self.now.contacts = 0;
        for work in &self.work {
            virial += work.virial;
            normal += work.normal;
            self.now.contacts += work.contacts;
        }
        self.now.pressure =
            virial / (3.0 * self.now.cell * self.now.cell * self.now.cell * self.aspect.height());
        self.now.mean_normal = if self.now.contacts > 0 { normal / self.now.contacts as f64 } else { 0.0 };
        if let Some((rate, gain)) = servo {
            let goal = (gain * (self.now.pressure - 1.0)).clamp(-rate, rate);
            self.now.strain_rate += SERVO_SHARE * (goal - self.now.strain_rate);
        }
        self.kick_and_drift(parallel);
        self.now.cell *= 1.0 + self.now.strain_rate * self.now.step;
        self.now.time += self.now.step;
        if self.now.steps.is_multiple_of(STEP_CHECK) || self.now.step > CLOSE_STEP * self.critical_step() {
            self.check_step()?;
        }
        Ok(())
    }

    fn kick_and_drift(&mut self, parallel: bool) {
        let step = self.now.step;
        let drag =
            step * if self.now.hold.braking { self.settings.settling_drag } else { self.settings.drag };
        let rule = StepRule {
            step,
            per_cell: step / (self.now.cell * (1.0 + 0.5 * self.now.strain_rate * step)),
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
        let (work, picked) = (&self.work, &self.picked);
        let bounds = chunk_bounds(self.position.len());
        let columns =
            [&mut self.position, &mut self.velocity, &mut self.spin, &mut self.force, &mut self.torque];
        let mut columns = columns.map(|column| split(column).into_iter());
        let part = |(chunk, (first, last)): (usize, (usize, usize))| {
            let [position, velocity, spin, force, torque] =
                columns.each_mut().map(|column| column.next().expect("a part for each chunk"));
            ChunkInStep {
                chunk,
                first,
                position,
                velocity,
                spin,
                force,
                torque,
                picked: &picked[first..last],
            }
        };
        let mut parts: Vec<ChunkInStep<'_>> = bounds.into_iter().enumerate().map(part).collect();
        let sums: Vec<Sums> = if parallel {
            parts.par_iter_mut().map(|part| advance(part, work, &rule)).collect()
        } else {
            parts.iter_mut().map(|part| advance(part, work, &rule)).collect()
        };
        let mut total = Sums::default();
        for sums in sums {
            total.moved = total.moved.max(sums.moved);
            total.stiffest = total.stiffest.max(sums.stiffest);
            total.stiffest_of_own = total.stiffest_of_own.max(sums.stiffest_of_own);
            total.twice_kinetic += sums.twice_kinetic;
            total.unbalanced += sums.unbalanced;
        }
        self.now.moved = total.moved.sqrt();
        self.now.stiffest = total.stiffest;
        self.now.twice_kinetic = total.twice_kinetic;
        self.now.unbalanced = total.unbalanced;
        if rule.least_mass > 0.0 {
            self.now.hold.saved += (step / self.followed(total.stiffest_of_own) - 1.0).max(0.0);
        }
    }

    /// Keeps the step below the critical one: adapts it, or refuses a fixed step that is no longer below.
    fn check_step(&mut self) -> Result<(), PackingError> {
        let critical = self.critical_step();
        match self.settings.step {
            Some(step) if step >= critical => {
                let cause = "the stiffness of a grain's contacts";
                Err(PackingError::Step { step, critical, cause })
            }
            Some(_) => Ok(()),
            None => {
                let goal = self.followed(self.now.stiffest);
                self.now.step = if goal < self.now.step { goal } else { goal.min(1.02 * self.now.step) };
                Ok(())
            }
        }
    }

    pub(super) fn critical_step(&self) -> f64 {
        self.critical(self.now.stiffest)
    }

    /// Critical step if `stiffest` is the largest sum of contact stiffness over mass.
    fn critical(&self, stiffest: f64) -> f64 {
        if stiffest > 0.0 { 2.0 / (stability(&self.law) * stiffest).sqrt() } else { f64::INFINITY }
    }

    fn followed(&self, stiffest: f64) -> f64 {
        let part = self.settings.step_fraction.min(damped_part(&self.law));
        part * self.critical(stiffest).min(2.0 * self.loose_step)
    }

    /// Ensures that every pair that can touch is among the close pairs; returns the reach of a new pick
    /// if one is due.
    ///
    /// Both reaches are adapted to how long they last: a longer one costs more pairs per step, a shorter
    /// one is renewed more often.
    fn renew(&mut self) -> Option<Reach> {
        if self.now.close.holds(Reach::CONTACT, self.now.cell, self.now.picked_cell, self.now.moved) {
            return None;
        }
        let strained = self.now.picked_cell > self.now.cell * (1.0 + self.now.close.relative);
        let least = Reach { relative: 2e-5, absolute: 2e-4 };
        follow(&mut self.now.close, strained, self.now.steps - self.now.picked_at, PICKS, least);
        let listed_moved = self.position.iter().zip(&self.listed).fold(0.0, |far: f64, (p, l)| {
            let d = [p[0] - l[0], p[1] - l[1], p[2] - l[2]];
            far.max(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
        });
        if !self.now.reach.holds(self.now.close, self.now.cell, self.now.listed_cell, listed_moved.sqrt()) {
            let strained = self.now.listed_cell * (1.0 + self.now.close.relative)
                > self.now.cell * (1.0 + self.now.reach.relative);
            let least =
                Reach { relative: 3.0 * self.now.close.relative, absolute: 3.0 * self.now.close.absolute };
            follow(&mut self.now.reach, strained, self.now.steps - self.now.listed_at, LISTS, least);
            self.relist();
        }
        self.picked.clone_from(&self.position);
        self.now.picked_cell = self.now.cell;
        self.now.picked_at = self.now.steps;
        self.now.moved = 0.0;
        Some(self.now.close)
    }

    /// Makes new lists, with the grains in the order of a space-filling curve.
    pub(super) fn relist(&mut self) {
        let remembered = Remembered::collect(&self.chunks, &self.rank);
        for p in &mut self.position {
            let [x, y, z, radius] = *p;
            let [x, y, z] = self.aspect.wrapped([x, y, z]);
            *p = [x, y, z, radius];
        }
        let mut order: Vec<u64> = (0..self.rank.len() as u64)
            .map(|i| {
                let [x, y, z, _] = self.position[i as usize];
                (u64::from(morton([x, y, z / self.aspect.height()])) << 32) | u64::from(self.rank[i as usize])
            })
            .collect();
        order.sort_unstable();
        let mut place = vec![0u32; self.rank.len()];
        for (i, &r) in self.rank.iter().enumerate() {
            place[r as usize] = i as u32;
        }
        let from: Vec<usize> =
            order.iter().map(|&key| place[(key & 0xffff_ffff) as usize] as usize).collect();
        self.rank = from.iter().map(|&i| self.rank[i]).collect();
        for column in [&mut self.position, &mut self.velocity, &mut self.spin] {
            *column = from.iter().map(|&i| column[i]).collect();
        }
        self.listed.clone_from(&self.position);
        self.now.listed_cell = self.now.cell;
        self.now.listed_at = self.now.steps;
        self.chunks = list(&self.position, &self.rank, self.now.cell, self.aspect, self.now.reach);
        remembered.restore(&mut self.chunks, &self.rank);
    }
}

pub(super) fn split<T>(mut column: &mut [T]) -> Vec<&mut [T]> {
    let bounds = chunk_bounds(column.len());
    let mut parts = Vec::with_capacity(bounds.len());
    for (first, last) in bounds {
        let (part, rest) = column.split_at_mut(last - first);
        parts.push(part);
        column = rest;
    }
    parts
}

struct StepRule {
    step: f64,
    per_cell: f64,
    keep: f64,
    kick: f64,
    local: f64,
    fastest: f64,
    rotate: bool,
    /// Minimum mass of a grain over the sum of its contact stiffness; 0 if grains keep their own mass.
    least_mass: f64,
}

#[derive(Clone, Copy, Default)]
struct Sums {
    moved: f64,
    stiffest: f64,
    /// `stiffest` computed with the grains' own masses.
    stiffest_of_own: f64,
    twice_kinetic: f64,
    unbalanced: f64,
}

struct ChunkInStep<'a> {
    chunk: usize,
    first: usize,
    position: &'a mut [[f64; 4]],
    velocity: &'a mut [[f64; 4]],
    spin: &'a mut [[f64; 4]],
    force: &'a mut [[f64; 4]],
    torque: &'a mut [[f64; 4]],
    picked: &'a [[f64; 4]],
}

/// Adds the forces sent by other chunks, and moves the grains of `part` by a step.
#[multiversion(targets("x86_64+avx+avx2+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx+avx2"))]
fn advance(part: &mut ChunkInStep<'_>, work: &[Work], rule: &StepRule) -> Sums {
    for sender in work {
        let outbox = &sender.outbox[part.chunk];
        collect(part.force, part.first, &outbox.grain, &outbox.force);
        if rule.rotate {
            collect(part.torque, part.first, &outbox.grain, &outbox.torque);
        }
    }
    match rule.least_mass > 0.0 {
        true => kick_by::<true>(part, rule),
        false => kick_by::<false>(part, rule),
    }
}

#[inline(always)]
fn collect(to: &mut [[f64; 4]], first: usize, grain: &[u32], sent: &[[f64; 4]]) {
    for (&i, s) in grain.iter().zip(sent) {
        let to = &mut to[i as usize - first];
        *to = std::array::from_fn(|a| to[a] + s[a]);
    }
}

/// Load after local damping: smaller if it drives the motion, larger if it resists.
#[inline(always)]
fn damped(load: f64, velocity: f64, local: f64) -> f64 {
    let along = f64::from(u8::from(velocity > 0.0)) - f64::from(u8::from(velocity < 0.0));
    load - local * load.abs() * along
}

#[inline(always)]
fn kick_by<const HEAVIER: bool>(part: &mut ChunkInStep<'_>, rule: &StepRule) -> Sums {
    match (rule.rotate, rule.local > 0.0) {
        (true, true) => kick::<HEAVIER, true, true>(part, rule),
        (true, false) => kick::<HEAVIER, true, false>(part, rule),
        (false, true) => kick::<HEAVIER, false, true>(part, rule),
        (false, false) => kick::<HEAVIER, false, false>(part, rule),
    }
}

/// Does kick and drift. The fourth entries are included, so that a row is one vector: they are set, or
/// zero is added.
#[inline(always)]
fn kick<const HEAVIER: bool, const ROTATE: bool, const LOCAL: bool>(
    part: &mut ChunkInStep<'_>,
    rule: &StepRule,
) -> Sums {
    let mut sums = Sums::default();
    let columns = part.position.iter_mut().zip(part.velocity.iter_mut()).zip(part.spin.iter_mut());
    let loads = part.force.iter().zip(part.torque.iter()).zip(part.picked);
    for (((p, v), w), ((f, t), picked)) in columns.zip(loads) {
        let least = if HEAVIER { rule.least_mass * f[3] } else { 0.0 };
        let mass = if least > v[3] { least } else { v[3] };
        let per_mass = 1.0 / mass;
        let kick = rule.step * per_mass * rule.kick;
        let load = |f: f64, v: f64| if LOCAL { damped(f, v, rule.local) } else { f };
        let mut u: [f64; 4] = std::array::from_fn(|a| v[a] * rule.keep + kick * load(f[a], v[a]));
        u[3] = 0.0;
        let mut square = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
        if square > rule.fastest * rule.fastest {
            let cut = rule.fastest / square.sqrt();
            u = u.map(|u| u * cut);
            square = rule.fastest * rule.fastest;
        }
        *v = [u[0], u[1], u[2], v[3]];
        *p = std::array::from_fn(|a| p[a] + u[a] * rule.per_cell);
        let d: [f64; 4] = std::array::from_fn(|a| (p[a] - picked[a]) * (p[a] - picked[a]));
        let far = d[0] + d[1] + d[2];
        if ROTATE {
            let twist = kick * 2.5 / (p[3] * p[3]);
            *w = std::array::from_fn(|a| w[a] * rule.keep + twist * load(t[a], w[a]));
        }
        sums.moved = if far > sums.moved { far } else { sums.moved };
        let stiff = f[3] * per_mass;
        sums.stiffest = if stiff > sums.stiffest { stiff } else { sums.stiffest };
        if HEAVIER {
            let stiff = f[3] / v[3];
            sums.stiffest_of_own = if stiff > sums.stiffest_of_own { stiff } else { sums.stiffest_of_own };
        }
        sums.twice_kinetic += square * mass;
        sums.unbalanced += f[0] * f[0] + f[1] * f[1] + f[2] * f[2];
    }
    sums
}
