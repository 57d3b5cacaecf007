//! How grains move: forces from the other chunks, kick, drift and the sums over the grains.

use super::contact::Work;
use super::neighbours::chunk_bounds;

/// Farthest a grain may move in a step, in units of the smallest diameter: only an overlapping start comes
/// near it.
pub(super) const LONGEST_MOVE: f64 = 0.02;

/// A column cut at the bounds of the chunks.
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

/// How the grains of a chunk take a step.
pub(super) struct StepRule {
    pub step: f64,
    pub per_cell: f64,
    pub keep: f64,
    pub kick: f64,
    pub local: f64,
    pub fastest: f64,
    pub rotate: bool,
}

/// What the grains of a chunk add up to.
#[derive(Clone, Copy, Default)]
pub(super) struct Sums {
    pub moved: f64,
    pub stiffest: f64,
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

impl ChunkInStep<'_> {
    pub fn advance(&mut self, work: &[Work], rule: &StepRule) {
        for sender in work {
            let outbox = &sender.outbox[self.chunk];
            for (&i, f) in outbox.grain.iter().zip(&outbox.force) {
                let to = &mut self.force[i as usize - self.first];
                *to = [to[0] + f[0], to[1] + f[1], to[2] + f[2], to[3] + f[3]];
            }
            if rule.rotate {
                for (&i, t) in outbox.grain.iter().zip(&outbox.torque) {
                    let to = &mut self.torque[i as usize - self.first];
                    *to = [to[0] + t[0], to[1] + t[1], to[2] + t[2], to[3] + t[3]];
                }
            }
        }
        let mut sums = Sums::default();
        let columns = self.position.iter_mut().zip(self.velocity.iter_mut()).zip(self.spin.iter_mut());
        let loads = self.force.iter().zip(self.torque.iter()).zip(self.picked);
        for (((p, v), w), ((f, t), picked)) in columns.zip(loads) {
            let per_mass = 1.0 / v[3];
            let kick = rule.step * per_mass * rule.kick;
            let mut u = [0.0; 3];
            for a in 0..3 {
                let f = if rule.local > 0.0 {
                    f[a] - rule.local
                        * f[a].abs()
                        * if v[a] > 0.0 {
                            1.0
                        } else if v[a] < 0.0 {
                            -1.0
                        } else {
                            0.0
                        }
                } else {
                    f[a]
                };
                u[a] = v[a] * rule.keep + kick * f;
            }
            let mut square = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
            if square > rule.fastest * rule.fastest {
                let cut = rule.fastest / square.sqrt();
                u = u.map(|u| u * cut);
                square = rule.fastest * rule.fastest;
            }
            let mut far = 0.0;
            for a in 0..3 {
                v[a] = u[a];
                p[a] += u[a] * rule.per_cell;
                far += (p[a] - picked[a]) * (p[a] - picked[a]);
            }
            if rule.rotate {
                let twist = kick * 2.5 / (p[3] * p[3]);
                for a in 0..3 {
                    let m = if rule.local > 0.0 {
                        t[a] - rule.local
                            * t[a].abs()
                            * if w[a] > 0.0 {
                                1.0
                            } else if w[a] < 0.0 {
                                -1.0
                            } else {
                                0.0
                            }
                    } else {
                        t[a]
                    };
                    w[a] = w[a] * rule.keep + twist * m;
                }
            }
            sums.moved = if far > sums.moved { far } else { sums.moved };
            let stiff = f[3] * per_mass;
            sums.stiffest = if stiff > sums.stiffest { stiff } else { sums.stiffest };
            sums.twice_kinetic += square * v[3];
            sums.unbalanced += f[0] * f[0] + f[1] * f[1] + f[2] * f[2];
        }
        self.sums = sums;
    }
}
