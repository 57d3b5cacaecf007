//! The contact law, and the pass that computes forces from the lists.
//!
//! # Law
//! With overlap `d`, reduced radius `R`, reduced mass `m`, contact stiffness `E* = G / (1 - nu)`:
//!
//! - normal, Hertz: `4/3 E* sqrt(R) d^1.5`; tangent stiffness `kn = 2 E* sqrt(R d)`;
//! - tangential, Mindlin without micro-slip: spring force `T` grows by `kt` times the tangential motion,
//!   `kt = 8 G* sqrt(R d) = kn 2 (1 - nu) / (2 - nu)`. If `kt` falls, `T` falls with it (Thornton,
//!   Cummins & Cleary 2013, doi:10.1016/j.powtec.2012.08.012), so that no load cycle creates energy;
//! - damping: normal `2 sqrt(5/6) b sqrt(m kn)` times the approach, `b = -ln e / sqrt(pi^2 + ln^2 e)`, gives
//!   the restitution `e` at every speed (Tsuji, Tanaka & Ishida 1992, doi:10.1016/0032-5910(92)88030-L);
//!   tangential the same with `kt`;
//! - no tension: the normal force with its damping is never below zero;
//! - Coulomb: spring and damping together are at most friction times the normal force; if they slip, both are
//!   reduced in proportion.
//!
//! Torques act with the lever arms `r ri / (ri + rj)`, which add up to the distance `r` of the centres.
//! Tests use a linear spring (constant `kn`).
//!
//! # Time levels
//! Positions are at full steps, velocities at half steps. The tangential motion over a step is the
//! velocity of the half step in the plane perpendicular to the half step's normal; `T` is then rotated
//! into the plane of the full step. The usual scheme takes the half step's velocity in the full step's
//! plane; some of the normal motion then counts as tangential, and small grains between large ones stick
//! or gain energy beyond a size ratio of about 3 (Vyas, Ottino, Lueptow & Umbanhowar 2025,
//! doi:10.1016/j.cpc.2025.109524).
//!
//! # Order
//! Each chunk first finds the touching pairs among its close pairs, from the positions alone (in a wide
//! gradation four in ten touch), and then processes them in list order, in blocks: gather, compute lane
//! by lane, scatter. The choice of close pairs changes no bit: a pair that does not touch has no effect.
//! Forces on grains of other chunks go to outboxes, one per chunk, which the receiving chunk adds in the
//! order of the senders. So all sums have one order, whatever the number of threads or the width of the
//! vector unit.

use super::neighbours::{Aspect, GrainChunk, Reach, nearest};
use bytemuck::Zeroable;
use multiversion::multiversion;

const BLOCK: usize = 64;

/// Contact parameters in reduced units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Law {
    /// True for Hertz contacts, false for linear springs.
    pub(crate) hertz: bool,
    /// `2 E*` for Hertz, the spring constant for linear springs.
    pub(crate) stiffness: f64,
    /// Ratio of tangential to normal stiffness.
    pub(crate) tangential: f64,
    /// Damping coefficient over `sqrt(m kn)`.
    pub(crate) damping: f64,
    pub(crate) friction: f64,
    /// True to cut the normal force at zero.
    pub(crate) clip: bool,
}

/// Input of one step.
#[derive(Clone, Copy)]
pub(super) struct Now<'a> {
    /// Position in units of the cell; radius.
    pub(crate) position: &'a [[f64; 4]],
    /// Velocity relative to the deforming cell; mass.
    pub(crate) velocity: &'a [[f64; 4]],
    /// Angular velocity; unused.
    pub(crate) spin: &'a [[f64; 4]],
    pub(crate) chunk: &'a [u16],
    pub(crate) law: Law,
    pub(crate) cell: f64,
    pub(crate) aspect: Aspect,
    pub(crate) strain_rate: f64,
    pub(crate) step: f64,
    /// Reach for a new pick of the close pairs, if one is due.
    pub(crate) pick: Option<Reach>,
}

/// Forces for the grains of another chunk.
#[derive(Clone, Debug, Default)]
pub(super) struct Outbox {
    pub(crate) grain: Vec<u32>,
    /// Force; normal stiffness.
    pub(crate) force: Vec<[f64; 4]>,
    /// Torque; zero.
    pub(crate) torque: Vec<[f64; 4]>,
}

#[derive(Clone, Debug)]
pub(super) struct Work {
    block: Box<Block>,
    /// Indices of the close pairs that touch.
    hits: Vec<u32>,
    pub(crate) outbox: Vec<Outbox>,
    /// Sum of normal force times distance of the centres.
    pub(crate) virial: f64,
    pub(crate) normal: f64,
    pub(crate) contacts: u64,
}

impl Work {
    pub(crate) fn new(chunks: usize) -> Self {
        Self {
            block: Box::new(Block::zeroed()),
            hits: Vec::new(),
            outbox: vec![Outbox::default(); chunks],
            virial: 0.0,
            normal: 0.0,
            contacts: 0,
        }
    }
}

type Lanes = [f64; BLOCK];

/// A block of close pairs as columns, so that the law is computed for many of them side by side.
#[derive(Clone, Debug, Zeroable)]
struct Block {
    /// Separation from the larger to the smaller grain along x, y, z, in units of the cell.
    gap: [Lanes; 3],
    /// Velocity of the smaller grain minus that of the larger, along x, y, z.
    motion: [Lanes; 3],
    /// Radius times angular velocity, summed over both, about x, y, z.
    spin: [Lanes; 3],
    /// Radius of the larger, of the smaller.
    radius: [Lanes; 2],
    /// Mass of the larger, of the smaller.
    mass: [Lanes; 2],
    /// Tangential spring force on the larger grain along x, y, z, and its stiffness.
    spring: [Lanes; 4],
    /// Force on the larger grain along x, y, z.
    force: [Lanes; 3],
    /// Torque per radius about x, y, z.
    torque: [Lanes; 3],
    /// Normal stiffness; zero if the grains do not touch.
    stiffness: Lanes,
    normal: Lanes,
    /// Normal force times distance.
    virial: Lanes,
}

/// Adds the forces and torques from the pairs that `chunk` lists: those on its own grains to `force` and
/// `torque`, those on others to the outboxes. The fourth entry of a force sums normal stiffness; the
/// fourth entry of a torque is zero.
#[multiversion(targets("x86_64+avx+avx2+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx+avx2"))]
pub(super) fn pass(
    chunk: &mut GrainChunk,
    work: &mut Work,
    now: &Now<'_>,
    force: &mut [[f64; 4]],
    torque: &mut [[f64; 4]],
) {
    match (now.law.friction > 0.0, now.law.hertz) {
        (true, true) => sweep::<true, true>(chunk, work, now, force, torque),
        (true, false) => sweep::<true, false>(chunk, work, now, force, torque),
        (false, true) => sweep::<false, true>(chunk, work, now, force, torque),
        (false, false) => sweep::<false, false>(chunk, work, now, force, torque),
    }
}

#[inline(always)]
fn sweep<const FRICTION: bool, const HERTZ: bool>(
    chunk: &mut GrainChunk,
    work: &mut Work,
    now: &Now<'_>,
    force: &mut [[f64; 4]],
    torque: &mut [[f64; 4]],
) {
    for outbox in &mut work.outbox {
        outbox.grain.clear();
        outbox.force.clear();
        outbox.torque.clear();
    }
    (work.virial, work.normal, work.contacts) = (0.0, 0.0, 0);
    force.fill([0.0; 4]);
    if FRICTION {
        torque.fill([0.0; 4]);
    }
    if let Some(reach) = now.pick {
        chunk.pick(now.position, now.cell, now.aspect, reach);
    }
    let mut hits = std::mem::take(&mut work.hits);
    touching(chunk, now, &mut hits);
    for hits in hits.chunks(BLOCK) {
        block::<FRICTION, HERTZ>(chunk, work, hits, now, force, torque);
    }
    work.hits = hits;
}

/// Collects the touching close pairs in `hits`, in list order; the others lose their memory.
#[inline(always)]
fn touching(chunk: &mut GrainChunk, now: &Now<'_>, hits: &mut Vec<u32>) {
    let position = now.position;
    hits.clear();
    let (mut gap, mut sum) = ([[0.0; BLOCK]; 3], [0.0; BLOCK]);
    let mut touching = [0u32; BLOCK];
    for (b, (close, memory)) in chunk.close.chunks(BLOCK).zip(chunk.memory.chunks_mut(BLOCK)).enumerate() {
        for (k, &[i, j]) in close.iter().enumerate().take(BLOCK) {
            let (p, q) = (position[i as usize], position[j as usize]);
            for a in 0..3 {
                gap[a][k] = q[a] - p[a];
            }
            sum[k] = p[3] + q[3];
        }
        let mut touch = [false; BLOCK];
        for k in 0..BLOCK {
            let r = distance([gap[0][k], gap[1][k], gap[2][k]], now).1;
            touch[k] = sum[k] > r;
        }
        let mut count = 0;
        for (k, memory) in memory.iter_mut().enumerate().take(BLOCK) {
            touching[count & (BLOCK - 1)] = (b * BLOCK + k) as u32;
            count += usize::from(touch[k]);
            if !touch[k] && memory[3] != 0.0 {
                *memory = [0.0; 4];
            }
        }
        hits.extend_from_slice(&touching[..count]);
    }
}

/// Separation to the nearest image, from a difference in units of the cell's width, and the distance.
#[inline(always)]
fn distance([x, y, z]: [f64; 3], now: &Now<'_>) -> ([f64; 3], f64) {
    let [x, y, z] = [nearest(x) * now.cell, nearest(y) * now.cell, now.aspect.nearest(z) * now.cell];
    ([x, y, z], (x * x + y * y + z * z).sqrt())
}

#[inline(always)]
fn block<const FRICTION: bool, const HERTZ: bool>(
    chunk: &mut GrainChunk,
    work: &mut Work,
    hits: &[u32],
    now: &Now<'_>,
    force: &mut [[f64; 4]],
    torque: &mut [[f64; 4]],
) {
    let Now { position, velocity, spin, chunk: chunk_of, .. } = *now;
    let b = &mut *work.block;
    for (k, &hit) in hits.iter().enumerate().take(BLOCK) {
        let [i, j] = chunk.close[hit as usize].map(|grain| grain as usize);
        let (p, q) = (position[i], position[j]);
        let (u, v) = (velocity[i], velocity[j]);
        for a in 0..3 {
            b.gap[a][k] = q[a] - p[a];
            b.motion[a][k] = v[a] - u[a];
        }
        (b.radius[0][k], b.radius[1][k]) = (p[3], q[3]);
        (b.mass[0][k], b.mass[1][k]) = (u[3], v[3]);
        if FRICTION {
            let spring = chunk.memory[hit as usize];
            let (w, o) = (spin[i], spin[j]);
            let (ri, rj) = (p[3], q[3]);
            for a in 0..3 {
                b.spin[a][k] = ri * w[a] + rj * o[a];
                b.spring[a][k] = spring[a];
            }
            b.spring[3][k] = spring[3];
        }
    }
    // Lanes without a pair are zero or hold an earlier one; their result is never read.
    let lanes = hits.len().min(BLOCK);
    compute::<FRICTION, HERTZ>(b, lanes.next_multiple_of(8), now);
    let (first, count) = (chunk.first, chunk.last - chunk.first);
    for (k, &hit) in hits.iter().enumerate().take(BLOCK) {
        let [i, j] = chunk.close[hit as usize];
        let kn = b.stiffness[k];
        let f = [b.force[0][k], b.force[1][k], b.force[2][k]];
        let t = [b.torque[0][k], b.torque[1][k], b.torque[2][k]];
        work.virial += b.virial[k];
        work.normal += b.normal[k];
        work.contacts += 1;
        let (i, j) = (i as usize - first, (j as usize).wrapping_sub(first));
        let to = &mut force[i];
        *to = [to[0] + f[0], to[1] + f[1], to[2] + f[2], to[3] + kn];
        let (ri, rj) = (b.radius[0][k], b.radius[1][k]);
        if FRICTION {
            chunk.memory[hit as usize] = [b.spring[0][k], b.spring[1][k], b.spring[2][k], b.spring[3][k]];
            let to = &mut torque[i];
            *to = [to[0] + ri * t[0], to[1] + ri * t[1], to[2] + ri * t[2], 0.0];
        }
        if j < count {
            let to = &mut force[j];
            *to = [to[0] - f[0], to[1] - f[1], to[2] - f[2], to[3] + kn];
            if FRICTION {
                let to = &mut torque[j];
                *to = [to[0] + rj * t[0], to[1] + rj * t[1], to[2] + rj * t[2], 0.0];
            }
        } else {
            let j = j.wrapping_add(first);
            let outbox = &mut work.outbox[usize::from(chunk_of[j])];
            outbox.grain.push(j as u32);
            outbox.force.push([-f[0], -f[1], -f[2], kn]);
            if FRICTION {
                outbox.torque.push([rj * t[0], rj * t[1], rj * t[2], 0.0]);
            }
        }
    }
}

#[inline(always)]
fn compute<const FRICTION: bool, const HERTZ: bool>(b: &mut Block, lanes: usize, now: &Now<'_>) {
    let law = &now.law;
    let floor = if law.clip { 0.0 } else { f64::NEG_INFINITY };
    let tangential_damping = law.damping * law.tangential.sqrt();
    for k in 0..lanes.min(BLOCK) {
        let ([x, y, z], r) = distance([b.gap[0][k], b.gap[1][k], b.gap[2][k]], now);
        let [ux, uy, uz] = [b.motion[0][k], b.motion[1][k], b.motion[2][k]];
        let (ri, rj) = (b.radius[0][k], b.radius[1][k]);
        let (mi, mj) = (b.mass[0][k], b.mass[1][k]);
        let sum = ri + rj;
        let inverse = 1.0 / r;
        let (nx, ny, nz) = (x * inverse, y * inverse, z * inverse);
        let touching = sum > r;
        let overlap = if touching { sum - r } else { 0.0 };
        let per_sum = 1.0 / sum;
        let mass = mi * mj / (mi + mj);
        let (kn, elastic) = if HERTZ {
            let kn = law.stiffness * (ri * rj * per_sum * overlap).sqrt();
            (kn, kn * overlap * (2.0 / 3.0))
        } else {
            (law.stiffness, law.stiffness * overlap)
        };
        let root = (mass * kn).sqrt();
        let opening = ux * nx + uy * ny + uz * nz + now.strain_rate * r;
        let push = elastic - law.damping * root * opening;
        let push = if push > floor { push } else { floor };
        b.stiffness[k] = if touching { kn } else { 0.0 };
        b.normal[k] = push;
        b.virial[k] = push * r;
        if FRICTION {
            let half = 0.5 * now.step;
            let (hx, hy, hz) = (x - half * ux, y - half * uy, z - half * uz);
            let along = (ux * hx + uy * hy + uz * hz) / (hx * hx + hy * hy + hz * hz);
            let (sx, sy, sz) = (b.spin[0][k] * per_sum, b.spin[1][k] * per_sum, b.spin[2][k] * per_sum);
            let tx = ux - along * hx - (sy * hz - sz * hy);
            let ty = uy - along * hy - (sz * hx - sx * hz);
            let tz = uz - along * hz - (sx * hy - sy * hx);
            let kt = law.tangential * kn;
            let (bx, by, bz, before) = (b.spring[0][k], b.spring[1][k], b.spring[2][k], b.spring[3][k]);
            let keep = if kt < before { kt / before } else { 1.0 };
            let advance = kt * now.step;
            let px = bx * keep + advance * tx;
            let py = by * keep + advance * ty;
            let pz = bz * keep + advance * tz;
            let out = px * nx + py * ny + pz * nz;
            let (px, py, pz) = (px - out * nx, py - out * ny, pz - out * nz);
            let damping = tangential_damping * root;
            let (qx, qy, qz) = (px + damping * tx, py + damping * ty, pz + damping * tz);
            let square = qx * qx + qy * qy + qz * qz;
            let limit = law.friction * if push > 0.0 { push } else { 0.0 };
            let cut = if square > limit * limit { limit / square.sqrt() } else { 1.0 };
            (b.spring[0][k], b.spring[1][k], b.spring[2][k]) = (px * cut, py * cut, pz * cut);
            b.spring[3][k] = kt;
            let (qx, qy, qz) = (qx * cut, qy * cut, qz * cut);
            b.force[0][k] = qx - push * nx;
            b.force[1][k] = qy - push * ny;
            b.force[2][k] = qz - push * nz;
            b.torque[0][k] = (y * qz - z * qy) * per_sum;
            b.torque[1][k] = (z * qx - x * qz) * per_sum;
            b.torque[2][k] = (x * qy - y * qx) * per_sum;
        } else {
            b.force[0][k] = -push * nx;
            b.force[1][k] = -push * ny;
            b.force[2][k] = -push * nz;
        }
    }
}
