//! One first run on a given network: its eroded mass, and what it costs.

use bitvec::vec::BitVec;

use super::study::PrecisionStudy;
use super::work::timed;
use crate::gradation::{Gradation, SizeSampler};
use crate::network::Network;
use crate::outcome::eroded_mass_fraction;
use crate::run::cost::CountedWork;
use crate::run::error::RunError;
use crate::walk::{Engine, RunPlan, Sampling, SizeClasses, State, Walk, WalkControl};

/// A first run, up to its network and seed.
#[derive(Clone)]
pub(super) struct FirstRun {
    pub engine: Engine,
    pub sampler: SizeSampler,
    /// Pan fraction of the base by mass: what is finer than the finest sieve.
    pub pan_fraction: f64,
    pub n_base: u64,
    pub increments: u64,
    /// How start nodes and sizes are drawn.
    pub sampling: Sampling,
}

/// How it ended.
#[derive(Clone, Debug)]
pub(super) struct Ended {
    pub eroded_mass_fraction: f64,
    pub eroded: u64,
    pub increments: u64,
    pub particle_moves: u64,
    /// Base particles that were walked one by one.
    pub one_by_one: u64,
    /// Whether that is all of them.
    pub all_one_by_one: bool,
    pub blocked: BitVec,
    /// Processor time, without that of the network (s).
    pub core_seconds: f64,
}

impl FirstRun {
    /// The scene's.
    pub fn of(study: &PrecisionStudy) -> Self {
        let case = study.case;
        Self {
            engine: case.scene.walk.engine,
            sampler: case.sampler.clone(),
            pan_fraction: case.pan_by_mass_only(),
            n_base: case.n_base,
            increments: case.increments(),
            sampling: case.scene.walk.sampling,
        }
    }

    /// Particles of one size, in the unit of the network.
    pub fn of_one_size(
        diameter: f64,
        n_base: u64,
        increments: u64,
        engine: Engine,
    ) -> Result<Self, RunError> {
        let sampler = SizeSampler::new(&Gradation::single(diameter)?, 1.0)?;
        Ok(Self { engine, sampler, pan_fraction: 0.0, n_base, increments, sampling: Sampling::Independent })
    }

    /// On a clean network.
    pub fn walk(&self, network: &Network, seed: u64) -> Result<Ended, RunError> {
        self.walk_from(network, clean(network), seed, 1)
    }

    /// On a clean network; `observe` sees the state after every increment.
    pub fn walk_observed(
        &self,
        network: &Network,
        seed: u64,
        observe: &mut (dyn FnMut(&State) + Send),
    ) -> Result<Ended, RunError> {
        self.walk_timed(network, clean(network), seed, 1, observe)
    }

    /// On the constrictions that `blocked` leaves open, with the streams of run `run`.
    pub fn walk_from(
        &self,
        network: &Network,
        blocked: BitVec,
        seed: u64,
        run: u64,
    ) -> Result<Ended, RunError> {
        self.walk_timed(network, blocked, seed, run, &mut |_| ())
    }

    fn walk_timed(
        &self,
        network: &Network,
        blocked: BitVec,
        seed: u64,
        run: u64,
        observe: &mut (dyn FnMut(&State) + Send),
    ) -> Result<Ended, RunError> {
        let walk = || -> Result<(State, u64), RunError> {
            let share = self.n_base / self.increments;
            let plan =
                RunPlan::new(self.engine, network, &self.sampler, &blocked, share).sampled(self.sampling);
            let supply = plan.supply(self.sampler.clone(), self.n_base, self.increments, seed, run);
            let classes = SizeClasses::logarithmic(self.sampler.smallest(), self.sampler.largest(), 64);
            let mut state = State::new(network, &supply, classes, blocked, seed, run);
            Walk::new(network, &supply, &state).run(&mut state, &mut |state| {
                observe(state);
                WalkControl::Continue
            })?;
            Ok((state, supply.total()))
        };
        let (walked, core_seconds) = timed(walk);
        let (state, one_by_one) = walked?;
        let tally = &state.tally;
        Ok(Ended {
            eroded_mass_fraction: eroded_mass_fraction(tally, tally, self.pan_fraction),
            eroded: tally.eroded,
            increments: state.increment,
            particle_moves: tally.particle_moves,
            one_by_one,
            all_one_by_one: one_by_one == tally.inserted,
            blocked: state.blocked,
            core_seconds,
        })
    }
}

/// No constriction blocked.
pub(super) fn clean(network: &Network) -> BitVec {
    BitVec::repeat(false, network.constrictions())
}

/// The scene on another lattice than its own, mostly a narrower one, with as much base a void.
#[derive(Clone, Copy)]
pub(super) struct ScaledScene<'a> {
    pub study: &'a PrecisionStudy<'a>,
    /// Voids along x, y, z, where its network is a lattice.
    pub shape: Option<[u32; 3]>,
}

/// Cross-sections tried, widest first.
const WIDTHS: [u32; 6] = [u32::MAX, 40, 28, 20, 14, 10];

impl<'a> ScaledScene<'a> {
    /// On the widest lattice on which so many first runs are paid for.
    pub fn affordable(study: &'a PrecisionStudy<'a>, runs: u64, budget_s: f64) -> Result<Self, RunError> {
        let Some([nx, ny, nz]) = study.shape() else { return Ok(Self { study, shape: None }) };
        let of = |width: u32| Self { study, shape: Some([nx.min(width), ny.min(width), nz]) };
        let narrow = of(WIDTHS[WIDTHS.len() - 1]);
        let a_run = narrow.cost_s()? / narrow.by_voids();
        let fits = |scene: &Self| a_run * scene.by_voids() * runs as f64 <= budget_s;
        Ok(WIDTHS.into_iter().map(of).find(fits).unwrap_or(narrow))
    }

    /// Voids, by those of the scene.
    pub fn by_voids(&self) -> f64 {
        let count = |shape: Option<[u32; 3]>| shape.map_or(1.0, |n| n.map(f64::from).iter().product::<f64>());
        count(self.shape) / count(self.study.shape())
    }

    /// The scene's first run.
    pub fn run(&self) -> FirstRun {
        let whole = FirstRun::of(self.study);
        FirstRun { n_base: ((whole.n_base as f64 * self.by_voids()).round() as u64).max(1), ..whole }
    }

    /// The network of this seed.
    pub fn network(&self, seed: u64) -> Result<Network, RunError> {
        self.study.network(self.shape, seed)
    }

    /// Counted processor time of a first run (s).
    pub fn cost_s(&self) -> Result<f64, RunError> {
        let network = self.network(self.study.seed(1))?;
        Ok(nominal(&self.run().walk(&network, self.study.seed(1))?, &network))
    }

    /// The lattice in words.
    pub fn words(&self) -> String {
        match self.shape {
            Some([nx, ny, nz]) => format!("{nx} x {ny} x {nz} voids"),
            None => "its network".into(),
        }
    }
}

/// Processor time of a run counted from what it did, network included.
pub(super) fn nominal(ended: &Ended, network: &Network) -> f64 {
    let counted = CountedWork {
        increments: ended.increments,
        particle_moves: ended.particle_moves,
        one_by_one: ended.one_by_one,
        all_one_by_one: ended.all_one_by_one,
        voids: network.voids(),
        constrictions: network.constrictions(),
    };
    counted.core_seconds()
}
