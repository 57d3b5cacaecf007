//! Computes the observables of a packing under compression from positions and memory, apart from the fast
//! pass.

use super::compression::Compression;
use super::neighbours::{Memory, nearest};
use super::observed::{Energy, Measure};

impl Compression {
    /// Calls `visit` with the grains, distance, overlap and tangential memory of every contact.
    pub(super) fn for_each_contact(&self, mut visit: impl FnMut(usize, usize, f64, f64, &Memory)) {
        for chunk in &self.chunks {
            for (&[i, j], memory) in chunk.close.iter().zip(&chunk.memory) {
                let (i, j) = (i as usize, j as usize);
                let (p, q) = (self.position[i], self.position[j]);
                let along = self.aspect.nearest(q[2] - p[2]);
                let d = [nearest(q[0] - p[0]), nearest(q[1] - p[1]), along].map(|d| d * self.cell);
                let r = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
                let overlap = p[3] + q[3] - r;
                if overlap > 0.0 {
                    visit(i, j, r, overlap, memory);
                }
            }
        }
    }

    /// Energies, with the grains' own masses and the velocities of the last half step.
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

    /// Observables of this instant.
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
        loop {
            count.fill(0);
            for &(i, j) in &contacts {
                if held[i as usize] && held[j as usize] {
                    count[i as usize] += 1;
                    count[j as usize] += 1;
                }
            }
            let mut changed = false;
            for (held, &count) in held.iter_mut().zip(&count) {
                if *held && count < needed {
                    *held = false;
                    changed = true;
                }
            }
            if !changed {
                break;
            }
        }
        let holding = held.iter().filter(|&&h| h).count();
        let total: u64 = count.iter().zip(&held).filter(|(_, h)| **h).map(|(c, _)| u64::from(*c)).sum();
        let energy = self.energy();
        Measure {
            void_ratio: self.void_ratio(),
            pressure_kpa: self.pressure * self.settings.pressure_kpa,
            coordination: 2.0 * contacts.len() as f64 / n as f64,
            coordination_held: if holding > 0 { total as f64 / holding as f64 } else { 0.0 },
            rattlers: 1.0 - holding as f64 / n as f64,
            kinetic_ratio: if energy.elastic > 0.0 { energy.kinetic / energy.elastic } else { f64::INFINITY },
            unbalanced: self.unbalanced_ratio(),
            largest_overlap,
        }
    }

    /// Root mean square unbalanced force of a grain by the mean normal contact force, in the last step.
    pub(super) fn unbalanced_ratio(&self) -> f64 {
        if self.mean_normal > 0.0 {
            (self.unbalanced / self.rank.len() as f64).sqrt() / self.mean_normal
        } else {
            f64::INFINITY
        }
    }
}
