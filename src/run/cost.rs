//! What a case or a packing takes, guessed before any of it is done: for what is asked of a cluster, and to tell a user minutes
//! from hours.
//!
//! The figures per particle, void and grain are those of one thread without vector kernels (`results/walk-speed-*.md`,
//! `results/packing-*.md`), rounded up; `results/slurm-*.md` holds guesses against measured times.

use super::replicates::runs_to_walk;
use crate::case::{Case, PackingPlan};

/// Seconds of a thread for one move of a particle.
const MOVE_S: f64 = 3e-9;
/// Seconds to part the counts of a void in an increment; not all voids hold particles all the time.
const VOID_S: f64 = 1e-8;
/// Seconds to build a network, by its voids and constrictions.
const NETWORK_S: f64 = 3e-7;
/// Seconds to write a case's files and page.
const FILES_S: f64 = 0.1;
/// Seconds for one grain in one step of a compression.
const GRAIN_S: f64 = 1e-7;
/// Bytes that packing a grain takes, its constrictions included.
const GRAIN_BYTES: u64 = 20_000;
/// Bytes of the program itself and of a page that is being written.
const PROGRAM_BYTES: u64 = 100_000_000;

impl Case {
    /// Seconds that one thread of a machine of today takes for the whole case: a rough guess. What a rule that adds replicates
    /// may ask for besides is not foreseen.
    pub fn core_seconds(&self) -> f64 {
        let [voids, constrictions, start_nodes, layers] = self.counts.map(|n| n as f64);
        let one_run = |n_base: u64| {
            let moves = self.one_by_one(n_base) as f64 * layers.max(1.0);
            let each = self.scene.walk.engine.takes_each(n_base / self.increments(), start_nodes as u64);
            let increments = self.increments() as f64 + 3.0 * layers;
            moves * MOVE_S + if each { 0.0 } else { voids * increments * VOID_S }
        };
        let (runs, replicates) = (self.scene.walk.runs as f64, self.scene.walk.replicates as f64);
        let own = replicates * one_run(self.n_base);
        let of_factor = |factor: f64| one_run((self.n_base as f64 * factor) as u64);
        let others: f64 = self.sensitivity_factors().into_iter().map(of_factor).sum();
        let networks = runs_to_walk(self) as f64 / runs.max(1.0) * (voids + constrictions) * NETWORK_S;
        runs * (own + self.scene.record.sensitivity_replicates as f64 * others) + networks + FILES_S
    }

    /// Bytes that the program takes where its walks take so many.
    pub fn program_bytes(&self, walks: u64) -> u64 {
        let [voids, constrictions, ..] = self.counts;
        // A network is being built, and a page is being written.
        walks.saturating_add(PROGRAM_BYTES).saturating_add(100 * (voids + constrictions))
    }
}

impl PackingPlan {
    /// Seconds that one thread takes for the packing: a rough guess.
    pub fn core_seconds(&self) -> f64 {
        // Stiffer grains move in shorter steps.
        let stiffness = libm::sqrt((self.compression.stiffness_ratio / 0.1).max(0.1));
        self.compression.grains as f64 * self.usual_steps() as f64 * stiffness * GRAIN_S
    }

    /// Steps that packings of this friction took (`results/filters-2026-11-21.md`).
    fn usual_steps(&self) -> u64 {
        match self.compression.friction {
            friction if friction <= 0.5 => 50_000,
            _ => 95_000,
        }
    }

    /// The most bytes that packing it takes.
    pub fn program_bytes(&self) -> u64 {
        PROGRAM_BYTES + self.compression.grains as u64 * GRAIN_BYTES
    }
}
