//! The state of a compression, as columns, and the quantities measured from it.
//!
//! # Reduced units
//! Length: the smallest diameter. Stress: the target pressure. Density: the grains' density. So the unit of
//! time is `smallest diameter * sqrt(density / pressure)` and a strain rate of 1e-3 is an inertial number of
//! 1e-3 for the smallest grains.

use super::contact::{Law, Work};
use super::neighbours::{Aspect, GrainChunk, Memory, Reach, chunk_bounds, nearest};
use super::settings::{PackingError, Settings, WIDE, critical_step, is_wide, mass};
use super::{Cell, Packing};
use crate::gradation::Gradation;
use std::f64::consts::PI;

/// Stages of a compression.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// The cell shrinks at a constant rate.
    #[default]
    Squeeze,
    /// The servo holds the pressure, with the friction of the compression.
    Compress,
    /// The servo holds the pressure, with the final friction.
    Settle,
    /// Settled.
    Done,
}

/// Measured values at one instant.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct Measure {
    /// Volume of the voids over the volume of the grains.
    pub void_ratio: f64,
    /// Mean contact pressure (kPa).
    pub pressure_kpa: f64,
    /// Mean coordination number `2 N_c / N_p`, over all grains.
    pub coordination: f64,
    /// Mean coordination number among the held grains: those with at least two contacts (four without
    /// friction) with held grains.
    pub coordination_held: f64,
    /// Rattler fraction: number of grains that are not held over the number of all grains.
    pub rattlers: f64,
    /// Ratio of kinetic to elastic energy.
    pub kinetic_ratio: f64,
    /// Root mean square unbalanced force of a grain over the mean normal contact force.
    pub unbalanced: f64,
    /// Largest overlap over the smaller diameter of its two grains.
    pub largest_overlap: f64,
}

/// Energies in reduced units (pressure times smallest diameter cubed).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Energy {
    pub(crate) kinetic: f64,
    pub(crate) elastic: f64,
}

fn is_zero(saved: &f64) -> bool {
    *saved == 0.0
}

/// State that the protocol keeps between its checks.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct HoldState {
    /// Step from which all criteria have held.
    pub(crate) since: u64,
    /// Number of additional steps that the grains' own masses would have taken for this time, if some
    /// grains are given a larger mass.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub(crate) saved: f64,
    /// Mean coordination number and void ratio at that step.
    pub(crate) coordination: f64,
    pub(crate) void_ratio: f64,
    /// True once the pressure has been near its target; the drag is then raised.
    pub(crate) braking: bool,
    /// Values before the friction was switched.
    pub(crate) before: Option<Measure>,
}

/// State of a compression, except its columns, as it is stored.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Moment {
    pub(crate) settings: u64,
    pub(crate) grains: usize,
    /// Number of close pairs; like `friction` and `makes_heavier`, set when the state is stored.
    pub(crate) close_pairs: usize,
    pub(crate) stage: Stage,
    pub(crate) steps: u64,
    pub(crate) time: f64,
    pub(crate) step: f64,
    /// Smallest diameter (mm): the unit of length.
    pub(crate) unit_mm: f64,
    pub(crate) cell: f64,
    /// Fixed ratio of height to width of the cell; omitted for a cube.
    #[serde(default = "cube", skip_serializing_if = "is_cube")]
    pub(crate) aspect: f64,
    pub(crate) strain_rate: f64,
    pub(crate) friction: f64,
    /// True if crowded grains are given a larger mass.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) makes_heavier: bool,
    /// Step in which the lists were made; the width of the cell at that step, and the reach.
    pub(crate) listed_at: u64,
    pub(crate) listed_cell: f64,
    pub(crate) reach: Reach,
    /// Step in which the close pairs were picked; the width of the cell at that step, and the reach.
    pub(crate) picked_at: u64,
    pub(crate) picked_cell: f64,
    pub(crate) close: Reach,
    /// Farthest move of any grain since the close pairs were picked, in units of the cell; infinite
    /// before the first pick, stored as `null`.
    #[serde(deserialize_with = "or_infinite")]
    pub(crate) moved: f64,
    pub(crate) contacts: u64,
    /// Mean contact pressure over its target, in the last step, as for all fields below.
    pub(crate) pressure: f64,
    /// Largest sum of contact stiffness over the mass used for the grain.
    pub(crate) stiffest: f64,
    /// Sum of the mass used for a grain times its squared velocity.
    pub(crate) twice_kinetic: f64,
    /// Sum of the squared unbalanced forces.
    pub(crate) unbalanced: f64,
    pub(crate) mean_normal: f64,
    pub(crate) hold: HoldState,
}

fn cube() -> f64 {
    1.0
}

fn is_cube(aspect: &f64) -> bool {
    *aspect == 1.0
}

fn or_infinite<'d, D: serde::Deserializer<'d>>(stored: D) -> Result<f64, D::Error> {
    Ok(<Option<f64> as serde::Deserialize>::deserialize(stored)?.unwrap_or(f64::INFINITY))
}

impl Moment {
    /// State before the first step; the length of the step is not yet known.
    fn start(settings: &Settings, grains: usize, unit_mm: f64, (cell, aspect): (f64, Aspect)) -> Self {
        Self {
            settings: settings.fingerprint(),
            grains,
            unit_mm,
            cell,
            aspect: aspect.height(),
            friction: settings.friction,
            listed_cell: cell,
            reach: settings.reach,
            picked_cell: cell,
            close: Reach { relative: 0.1 * settings.reach.relative, absolute: 0.1 * settings.reach.absolute },
            moved: f64::INFINITY,
            ..Self::default()
        }
    }
}

/// Grains under compression: columns by grain in memory order, which changes, and `rank` (0 = the
/// largest), which does not.
#[derive(Clone, Debug)]
pub struct Compression {
    pub(super) settings: Settings,
    pub(super) now: Moment,
    /// Rank of each grain by size, from the largest.
    pub(super) rank: Vec<u32>,
    /// Index in the user's columns, by rank.
    pub(super) origin: Vec<u32>,
    /// Position along x, y, z in units of the cell; radius.
    pub(super) position: Vec<[f64; 4]>,
    /// Velocity along x, y, z relative to the deforming cell, at the last half step; mass.
    pub(super) velocity: Vec<[f64; 4]>,
    /// Angular velocity about x, y, z at the last half step; zero.
    pub(super) spin: Vec<[f64; 4]>,
    /// Position when the lists were made.
    pub(super) listed: Vec<[f64; 4]>,
    /// Position when the close pairs were picked.
    pub(super) picked: Vec<[f64; 4]>,
    pub(super) aspect: Aspect,
    pub(super) law: Law,
    /// The lists, with the tangential memory.
    pub(super) chunks: Vec<GrainChunk>,
    /// Critical step before there are contacts.
    pub(super) loose_step: f64,
    /// True if sizes differ so much that the most crowded grains are given a larger mass.
    pub(super) is_wide: bool,
    pub(super) chunk_of: Vec<u16>,
    pub(super) work: Vec<Work>,
    pub(super) force: Vec<[f64; 4]>,
    pub(super) torque: Vec<[f64; 4]>,
}

impl Compression {
    /// Makes a compression of grains at rest in any positions.
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
                if x == y && x > 0.0 && x < f64::INFINITY && z >= x && z <= 1.001 * Aspect::TALLEST * x =>
            {
                (x, Aspect::new(z / x))
            }
            other => return Err(PackingError::Cell(format!("{other:?}"))),
        };
        for (column, values) in [("x", &packing.x), ("y", &packing.y), ("z", &packing.z)] {
            if let Some(grain) = values.iter().position(|v| !v.is_finite()) {
                let value = values[grain];
                return Err(PackingError::Grain(grain, column, value, "a finite number"));
            }
        }
        PackingError::unless_sizes(&packing.diameter)?;
        let mut origin: Vec<u32> = (0..n as u32).collect();
        origin.sort_by(|&a, &b| {
            packing.diameter[b as usize].total_cmp(&packing.diameter[a as usize]).then(a.cmp(&b))
        });
        let unit_mm = packing.diameter[origin[n - 1] as usize];
        let largest_mm = packing.diameter[origin[0] as usize];
        if cell_mm < 2.0 * largest_mm {
            return Err(PackingError::NarrowCell { cell_mm, largest_mm });
        }
        let placed = |&i: &u32| {
            let i = i as usize;
            let [x, y, z] = aspect.wrapped([packing.x[i], packing.y[i], packing.z[i]].map(|mm| mm / cell_mm));
            [x, y, z, 0.5 * (packing.diameter[i] / unit_mm)]
        };
        let position: Vec<[f64; 4]> = origin.iter().map(placed).collect();
        let mut by_place: Vec<usize> = (0..n).collect();
        by_place.sort_by(|&a, &b| position[a][..3].partial_cmp(&position[b][..3]).expect("finite"));
        if let Some(w) = by_place.windows(2).find(|w| position[w[0]][..3] == position[w[1]][..3]) {
            let (a, b) = (origin[w[0]] as usize, origin[w[1]] as usize);
            return Err(PackingError::Coincident(a.min(b), a.max(b)));
        }
        let velocity: Vec<[f64; 4]> =
            position.iter().map(|p| [0.0, 0.0, 0.0, mass(p[3], settings.mass_exponent)]).collect();
        let now = Moment::start(settings, n, unit_mm, (cell_mm / unit_mm, aspect));
        let mut this = Self::blank(settings, now, position, velocity, origin);
        if let Some(step) = settings.step
            && step >= this.loose_step
        {
            let (critical, cause) = critical_step(&this.position, &this.velocity, settings);
            return Err(PackingError::Step { step, critical, cause });
        }
        this.now.step = settings.step.unwrap_or(settings.step_fraction * this.loose_step);
        this.relist();
        this.picked.clone_from(&this.position);
        Ok(this)
    }

    /// Makes grains in order of rank, at rest, without lists.
    pub(super) fn blank(
        settings: &Settings,
        now: Moment,
        position: Vec<[f64; 4]>,
        velocity: Vec<[f64; 4]>,
        origin: Vec<u32>,
    ) -> Self {
        let n = position.len();
        let [smallest, largest] = position
            .iter()
            .fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], p| [low.min(p[3]), high.max(p[3])]);
        let mut chunk_of = vec![0; n];
        let bounds = chunk_bounds(n);
        for (c, &(first, last)) in bounds.iter().enumerate() {
            chunk_of[first..last].fill(c as u16);
        }
        Self {
            settings: settings.clone(),
            loose_step: critical_step(&position, &velocity, settings).0,
            rank: (0..n as u32).collect(),
            origin,
            position,
            velocity,
            spin: vec![[0.0; 4]; n],
            listed: Vec::new(),
            picked: Vec::new(),
            aspect: Aspect::new(now.aspect),
            law: Law::new(settings, now.friction),
            chunks: Vec::new(),
            is_wide: largest / smallest >= WIDE,
            chunk_of,
            work: vec![Work::new(bounds.len()); bounds.len()],
            force: vec![[0.0; 4]; n],
            torque: vec![[0.0; 4]; n],
            now,
        }
    }

    /// Number of steps done.
    pub fn steps(&self) -> u64 {
        self.now.steps
    }

    /// Current stage.
    pub fn stage(&self) -> Stage {
        self.now.stage
    }

    /// Angular velocity about x, y, z of each grain, in reduced units, in memory order.
    pub fn spins(&self) -> Vec<[f64; 3]> {
        self.spin.iter().map(|w| [w[0], w[1], w[2]]).collect()
    }

    /// Void ratio: volume of the cell over the volume of the grains, minus 1.
    pub(crate) fn void_ratio(&self) -> f64 {
        self.cell_volume() / self.grain_volume() - 1.0
    }

    fn cell_volume(&self) -> f64 {
        self.now.cell * self.now.cell * self.now.cell * self.aspect.height()
    }

    pub(super) fn grain_volume(&self) -> f64 {
        let mut cubes = vec![0.0; self.rank.len()];
        for (p, &r) in self.position.iter().zip(&self.rank) {
            cubes[r as usize] = p[3] * p[3] * p[3];
        }
        cubes.iter().sum::<f64>() * (4.0 / 3.0 * PI)
    }

    pub(super) fn makes_heavier(&self) -> bool {
        self.is_wide && self.settings.step.is_none()
    }

    /// Gives crowded grains a larger mass if the gradation from which they were drawn is wide: a small
    /// sample may miss the extremes, and a gradation has one protocol.
    pub fn of_gradation(mut self, gradation: &Gradation) -> Self {
        self.is_wide = is_wide(gradation);
        self
    }

    /// Grains in their present state, in their original order.
    pub fn packing(&self) -> Packing {
        let (edge, height) = (self.now.cell * self.now.unit_mm, self.aspect.height());
        let mut grains = vec![[0.0; 4]; self.rank.len()];
        for ([x, y, z, radius], &r) in self.position.iter().zip(&self.rank) {
            let wrapped = |s: f64, length: f64| (s - length * libm::floor(s / length)) * edge;
            grains[self.origin[r as usize] as usize] =
                [wrapped(*x, 1.0), wrapped(*y, 1.0), wrapped(*z, height), 2.0 * radius * self.now.unit_mm];
        }
        Packing::from_grains(Cell::Periodic([edge, edge, edge * height]), grains)
    }

    /// Calls `visit` with the grains, distance, overlap and tangential memory of every contact.
    fn for_each_contact(&self, mut visit: impl FnMut(usize, usize, f64, f64, &Memory)) {
        for chunk in &self.chunks {
            for (&[i, j], memory) in chunk.close.iter().zip(&chunk.memory) {
                let (i, j) = (i as usize, j as usize);
                let (p, q) = (self.position[i], self.position[j]);
                let along = self.aspect.nearest(q[2] - p[2]);
                let d = [nearest(q[0] - p[0]), nearest(q[1] - p[1]), along].map(|d| d * self.now.cell);
                let r = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
                let overlap = p[3] + q[3] - r;
                if overlap > 0.0 {
                    visit(i, j, r, overlap, memory);
                }
            }
        }
    }

    /// Computes energies, with the grains' own masses and the velocities of the last half step.
    pub(super) fn energy(&self) -> Energy {
        let mut kinetic = 0.0;
        for ((p, v), w) in self.position.iter().zip(&self.velocity).zip(&self.spin) {
            let inertia = 0.4 * v[3] * p[3] * p[3];
            kinetic += 0.5 * v[3] * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
                + 0.5 * inertia * (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
        }
        let mut elastic = 0.0;
        self.for_each_contact(|i, j, _, overlap, memory| {
            let (ri, rj) = (self.position[i][3], self.position[j][3]);
            elastic += if self.law.hertz {
                let kn = self.law.stiffness * (ri * rj / (ri + rj) * overlap).sqrt();
                4.0 / 15.0 * kn * overlap * overlap
            } else {
                0.5 * self.law.stiffness * overlap * overlap
            };
            if self.law.friction > 0.0 && memory[3] > 0.0 {
                let [x, y, z, kt] = *memory;
                elastic += 0.5 * (x * x + y * y + z * z) / kt;
            }
        });
        Energy { kinetic, elastic }
    }

    /// Measures the packing at this instant.
    pub fn measure(&self) -> Measure {
        let n = self.rank.len();
        let mut contacts: Vec<(u32, u32)> = Vec::new();
        let mut largest_overlap: f64 = 0.0;
        self.for_each_contact(|i, j, _, overlap, _| {
            contacts.push((i as u32, j as u32));
            largest_overlap = largest_overlap.max(0.5 * overlap / self.position[j][3]);
        });
        let needed = if self.law.friction > 0.0 { 2 } else { 4 };
        let mut held = vec![true; n];
        let mut count = vec![0u32; n];
        let mut is_settled = false;
        while !is_settled {
            is_settled = true;
            count.fill(0);
            for &(i, j) in &contacts {
                if held[i as usize] && held[j as usize] {
                    count[i as usize] += 1;
                    count[j as usize] += 1;
                }
            }
            let loose = |(held, count): &(&mut bool, &u32)| **held && **count < needed;
            for (held, _) in held.iter_mut().zip(&count).filter(loose) {
                (*held, is_settled) = (false, false);
            }
        }
        let holding = held.iter().filter(|&&h| h).count();
        let total: u64 = count.iter().zip(&held).filter(|(_, h)| **h).map(|(c, _)| u64::from(*c)).sum();
        let energy = self.energy();
        Measure {
            void_ratio: self.void_ratio(),
            pressure_kpa: self.now.pressure * self.settings.pressure_kpa,
            coordination: 2.0 * contacts.len() as f64 / n as f64,
            coordination_held: if holding > 0 { total as f64 / holding as f64 } else { 0.0 },
            rattlers: 1.0 - holding as f64 / n as f64,
            kinetic_ratio: if energy.elastic > 0.0 { energy.kinetic / energy.elastic } else { f64::INFINITY },
            unbalanced: self.unbalanced_ratio(),
            largest_overlap,
        }
    }

    /// Root mean square unbalanced force of a grain over the mean normal contact force, in the last step.
    pub(super) fn unbalanced_ratio(&self) -> f64 {
        if self.now.mean_normal > 0.0 {
            (self.now.unbalanced / self.rank.len() as f64).sqrt() / self.now.mean_normal
        } else {
            f64::INFINITY
        }
    }
}
