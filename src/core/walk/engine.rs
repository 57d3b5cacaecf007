//! All choices of how a run is walked: engine, omitted work, instruction set, threads.

use super::supply::passive_limit;
use super::{Arching, Sampling, Supply};
use crate::gradation::SizeSampler;
use crate::network::Network;
use crate::schema::Leaf;
use crate::store::platform::{processors, stay_on};
use bitvec::slice::BitSlice;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::sync::{Arc, OnceLock};

/// Methods of moving passive base particles; the first three give the same distribution of runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Engine {
    /// `Counts` if there are enough passive particles for it to be faster, otherwise `Particles`.
    Auto,
    /// All base particles one by one.
    Particles,
    /// Passive particles as counts per void.
    Counts,
    /// Expectation of the passive particles, given the constrictions blocked by the others.
    Expected,
}

impl Leaf for Engine {}

impl Engine {
    /// All engines, in the order shown to users.
    pub const ALL: [Engine; 4] = [Engine::Auto, Engine::Particles, Engine::Counts, Engine::Expected];

    /// Tells if the engine walks passive particles one by one, too, if each increment inserts this many of
    /// them on this many start nodes. Depends only on numbers, so that a seed gives the same bits on every
    /// machine.
    pub fn takes_each(self, passive_share: u64, start_nodes: u64) -> bool {
        match self {
            Engine::Particles => true,
            Engine::Auto => 2 * u128::from(passive_share) < WORTH_TWICE * u128::from(start_nodes),
            Engine::Counts | Engine::Expected => false,
        }
    }

    /// Number of passive particles among `share` base particles, if this many of all 2^64 words draw one.
    pub fn passive_share(share: u64, passive_words: u128) -> u64 {
        ((u128::from(share) * passive_words) >> 64) as u64
    }

    /// Name of the engine in a scene.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Particles => "particles",
            Self::Counts => "counts",
            Self::Expected => "expected",
        }
    }
}

/// Twice the number of passive particles per start node and increment from which counts are faster. The
/// break-even number is between 5 (AVX2, base Cu 3) and 9 (AVX-512, base Cu 1.5), see `results/speed.md`.
const WORTH_TWICE: u128 = 13;

/// Plan of one run: an engine, and the passive part of the base.
#[derive(Clone, Debug)]
pub struct RunPlan {
    engine: Engine,
    passive_words: u128,
    sampling: Sampling,
    left_out: Vec<Shortcut>,
    arching: Option<Arc<Arching>>,
    leaves_openings: bool,
}

impl RunPlan {
    /// Plans a run of this base with `blocked` constrictions, if each increment inserts `share` base
    /// particles.
    pub fn new(
        wanted: Engine,
        network: &Network,
        sampler: &SizeSampler,
        blocked: &BitSlice,
        share: u64,
    ) -> Self {
        Self::with_clogging(wanted, network, sampler, blocked, share, (None, false))
    }

    /// Plans a run with this law of arching, if given: only particles too fine to arch are passive. If
    /// blocked constrictions leave openings, no particle is passive.
    pub fn with_clogging(
        wanted: Engine,
        network: &Network,
        sampler: &SizeSampler,
        blocked: &BitSlice,
        share: u64,
        (arching, leaves_openings): (Option<Arc<Arching>>, bool),
    ) -> Self {
        let passive_limit = |finest| passive_limit(arching.as_deref(), leaves_openings, finest);
        let finest = network.finest_open(|c| blocked[c]);
        let passive_words = sampler.word_limit(passive_limit(finest));
        // Decided on the clean network, so that all runs of a replicate use one engine.
        let on_open = sampler.word_limit(passive_limit(network.finest()));
        let passive = Engine::passive_share(share, on_open);
        let engine = match wanted {
            wanted if wanted.takes_each(passive, network.entries() as u64) => Engine::Particles,
            _ if passive_words == 0 => Engine::Particles,
            Engine::Auto => Engine::Counts,
            chosen => chosen,
        };
        let finest = Finest { size_mm: f64::from(finest) * network.unit_mm(), arches: arching.is_some() };
        let mut left_out = match leaves_openings {
            true => vec![Shortcut::Openings],
            false => left_out(engine, finest, passive_words),
        };
        let keeps_sizes = engine == Engine::Particles || passive_words < 1 << 64;
        if sampler.smallest() == sampler.largest() && keeps_sizes {
            left_out.push(Shortcut::OneSize);
        }
        if wanted == Engine::Auto && engine == Engine::Particles && on_open > 0 {
            left_out.push(Shortcut::FewPassive(passive, network.entries() as u64));
        }
        Self { engine, passive_words, sampling: Sampling::Independent, left_out, arching, leaves_openings }
    }

    /// Sets the sampling of start nodes and sizes.
    pub fn sampled(self, sampling: Sampling) -> Self {
        Self { sampling, ..self }
    }

    /// Engine that walks; never `Auto`.
    pub fn engine(&self) -> Engine {
        self.engine
    }

    /// Omitted work.
    pub fn left_out(&self) -> &[Shortcut] {
        &self.left_out
    }

    /// Supply of `n` base particles in `increments` equal parts, for run `run` of `seed`.
    pub fn supply(&self, sampler: SizeSampler, n: u64, increments: u64, seed: u64, run: u64) -> Supply {
        let all = Supply::new(sampler, n, increments)
            .arching_by(self.arching.clone())
            .leaving_openings(self.leaves_openings);
        let all = match self.sampling {
            Sampling::Independent => all,
            Sampling::Stratified => all.stratified(seed, run),
        };
        match self.engine {
            Engine::Particles => all,
            engine => all.with_passive_part(self.passive_words, engine == Engine::Expected, seed, run),
        }
    }
}

/// Finest open constriction at the start of a run.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Finest {
    /// Size (mm).
    pub size_mm: f64,
    /// True if particles may arch in it, so that only particles too fine to arch are passive.
    pub arches: bool,
}

/// Work that a run can omit.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shortcut {
    /// Nothing moves, as no constriction is open.
    NothingOpen,
    /// No base particle is counted: all are coarser than this.
    NonePassive(Finest),
    /// No base particle is counted: openings beside particles may stop any of them.
    Openings,
    /// All base particles are counted by this engine: none is coarser than this.
    AllPassive(Finest, Engine),
    /// This percentage of the base particles is walked one by one; this engine counts the others.
    MostPassive(f64, Finest, Engine),
    /// No column of diameters is stored: the base has one size.
    OneSize,
    /// Too few passive base particles per increment (first number) on the start nodes (second number) for
    /// counts.
    FewPassive(u64, u64),
}

fn left_out(engine: Engine, finest: Finest, passive_words: u128) -> Vec<Shortcut> {
    let coarse_percent = 100.0 * (((1u128 << 64) - passive_words) as f64 / 18_446_744_073_709_551_616.0);
    let is_open = finest.size_mm != f64::INFINITY;
    let none_passive = match is_open {
        false => Some(Shortcut::NothingOpen),
        true => (passive_words == 0).then_some(Shortcut::NonePassive(finest)),
    };
    let by_counts = match engine {
        Engine::Particles => None,
        _ if passive_words < 1 << 64 => Some(Shortcut::MostPassive(coarse_percent, finest, engine)),
        _ => is_open.then_some(Shortcut::AllPassive(finest, engine)),
    };
    none_passive.into_iter().chain(by_counts).collect()
}

/// Creates a pool of `count` threads for walks (0: one for each processor available to the program).
///
/// With `pinned`, thread `i` stays on the `i`-th of these processors, if there are as many as threads:
/// some systems keep the threads of a busy program on one processor. Failure to pin (impossible on macOS)
/// is not an error, as results do not depend on it. Use it only if no other program pins its threads on
/// this machine: they would share the same processors.
///
/// # Errors
/// Errors of the system when it cannot start a thread.
pub fn threads(count: usize, pinned: bool) -> Result<ThreadPool, ThreadPoolBuildError> {
    let processors = processors();
    let builder = ThreadPoolBuilder::new().num_threads(count).thread_name(|i| format!("walk {i}"));
    let needed = if count == 0 { processors.len() } else { count };
    if !pinned || needed < 2 || processors.len() < needed {
        return builder.build();
    }
    builder
        .start_handler(move |i| {
            if let Some(&processor) = processors.get(i) {
                stay_on(processor);
            }
        })
        .build()
}

/// Instruction sets with a version of the step; all give the same bits.
///
/// A further one needs a variant in `ALL`, `name` and `is_available`, a file in `walk/kernel`, and its arm
/// in `step_lattice` (`walk/kernel/mod.rs`). `walk/insert.rs`, `counts/flow.rs` and `counts/expected.rs`
/// also choose by it, and take the portable version if they have none for it. Tests run all of `ALL` that
/// the machine has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Isa {
    /// Instructions that every machine has.
    Portable,
    /// AVX2: eight particles at once.
    Avx2,
    /// AVX-512 (F, BW, DQ, VL): sixteen particles at once.
    Avx512,
}

impl Isa {
    /// All instruction sets, the slowest first.
    pub const ALL: [Isa; 3] = [Isa::Portable, Isa::Avx2, Isa::Avx512];

    /// Name used in `VOIDWALK_ISA` and in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// Tells if this machine supports it.
    pub fn is_available(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("popcnt"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512bw")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
                    && is_x86_feature_detected!("popcnt")
            }
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => false,
        }
    }

    /// Instruction set of walks: the fastest that this machine supports, or the one named by the
    /// environment variable `VOIDWALK_ISA` when the first walk starts, if supported.
    pub fn chosen() -> Self {
        static CHOSEN: OnceLock<Isa> = OnceLock::new();
        *CHOSEN.get_or_init(|| {
            let named = std::env::var("VOIDWALK_ISA").ok();
            let named = Self::ALL.into_iter().find(|isa| Some(isa.name()) == named.as_deref());
            let fastest = Self::ALL.into_iter().rev().find(|isa| isa.is_available());
            named.filter(|isa| isa.is_available()).or(fastest).unwrap_or(Self::Portable)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use bitvec::vec::BitVec;

    #[test]
    fn auto_weighs_the_passive_particles_and_no_others() {
        // 16 start nodes; one constriction has the base's median size by number, the others are wider than
        // all particles.
        let base = Gradation::linear_from_d0(0.2, 1.5).unwrap();
        let sampler = SizeSampler::new(&base, 1.0).unwrap();
        let mut diameters = vec![1.0; 288];
        diameters[7] = sampler.part(0..1 << 64).d_by_number(0.5).unwrap() as f32;
        let network = Network::cubic_from_diameters([4, 4, 6], diameters, 1.0).unwrap();
        let open: BitVec = BitVec::repeat(false, network.constrictions());
        let engine = |share| RunPlan::new(Engine::Auto, &network, &sampler, &open, share).engine();
        // Half of the particles are passive.
        let least = 16 * WORTH_TWICE as u64;
        assert_eq!((engine(least - 16), engine(least + 16)), (Engine::Particles, Engine::Counts));
        assert_eq!(Engine::passive_share(u64::MAX, 1 << 64), u64::MAX);
        assert_eq!(Engine::passive_share(1000, 1 << 62), 250);
    }

    #[test]
    fn pinned_threads_keep_to_processors_of_their_own() {
        let all = processors();
        let pool = threads(0, true).unwrap();
        let seen = pool.broadcast(|_| processors());
        // Windows reports the processors of a program, not of its threads, and macOS cannot pin threads.
        if cfg!(target_os = "linux") && all.len() > 1 && seen.len() == all.len() {
            assert_eq!(seen.concat(), all);
        }
        assert_eq!(threads(1, true).unwrap().broadcast(|_| processors()), [all.as_slice()]);
        assert!(threads(3, false).unwrap().broadcast(|_| processors()).iter().all(|a| *a == all));
    }
}
