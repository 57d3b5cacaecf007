//! Motion of the grains: forces from the other chunks, kick, drift and the sums over the grains.

use super::contact::Work;
use super::neighbours::chunk_bounds;
use multiversion::multiversion;

/// Farthest move of a grain in a step, in units of the smallest diameter: only an overlapping start comes
/// near it.
pub(super) const LONGEST_MOVE: f64 = 0.02;

/// Cuts a column at the bounds of the chunks.
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

/// Parameters of a step for the grains of a chunk.
pub(super) struct StepRule {
    pub step: f64,
    pub per_cell: f64,
    pub keep: f64,
    pub kick: f64,
    pub local: f64,
    pub fastest: f64,
    pub rotate: bool,
    /// Least mass of a grain by the sum of its contacts' stiffness; 0 if grains keep their own.
    pub least_mass: f64,
}

/// Sums over the grains of a chunk.
#[derive(Clone, Copy, Default)]
pub(super) struct Sums {
    pub moved: f64,
    pub stiffest: f64,
    /// `stiffest` with the grains' own masses.
    pub stiffest_of_own: f64,
    pub twice_kinetic: f64,
    pub unbalanced: f64,
}

/// The grains of a chunk on their way through a step.
pub(super) struct ChunkInStep<'a> {
    pub chunk: usize,
    pub first: usize,
    pub position: &'a mut [[f64; 4]],
    pub velocity: &'a mut [[f64; 4]],
    pub spin: &'a mut [[f64; 4]],
    pub force: &'a mut [[f64; 4]],
    pub torque: &'a mut [[f64; 4]],
    pub picked: &'a [[f64; 4]],
    pub sums: Sums,
}

/// Takes the forces that other chunks sent, and moves the grains of `part` by a step.
#[multiversion(targets("x86_64+avx+avx2+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx+avx2"))]
pub(super) fn advance(part: &mut ChunkInStep<'_>, work: &[Work], rule: &StepRule) {
    for sender in work {
        let outbox = &sender.outbox[part.chunk];
        collect(part.force, part.first, &outbox.grain, &outbox.force);
        if rule.rotate {
            collect(part.torque, part.first, &outbox.grain, &outbox.torque);
        }
    }
    part.sums = match rule.least_mass > 0.0 {
        true => kick_by::<true>(part, rule),
        false => kick_by::<false>(part, rule),
    };
}

#[inline(always)]
fn collect(to: &mut [[f64; 4]], first: usize, grain: &[u32], sent: &[[f64; 4]]) {
    for (&i, s) in grain.iter().zip(sent) {
        let to = &mut to[i as usize - first];
        *to = std::array::from_fn(|a| to[a] + s[a]);
    }
}

/// Load after local damping: less if it drives the motion, more if it resists.
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

/// Does kick and drift. The fourth entries go along, so that a row is one vector: they are set, or zero is
/// added.
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
