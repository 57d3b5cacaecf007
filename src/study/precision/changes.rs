//! Settings that are changed one at a time and compared with the scene as it is.

use super::first_run::{FirstRun, ScaledScene};
use super::study::PrecisionError;
use crate::network::Network;
use crate::scene::NetworkSource;

/// One setting changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Change {
    /// Nothing: the reference.
    Nothing,
    /// This share of the base that Eq. (2) gives.
    Share(f64),
    /// A cap on the number of base particles.
    Cap(u64),
    /// Voids along x and y.
    Width(u32),
    /// Voids along z.
    Length(u32),
    /// Share of the base inserted in each increment.
    Inject(f64),
    /// Constriction sizes stratified over the lattice.
    Stratified,
}

const SHARES: [f64; 6] = [0.05, 0.1, 0.2, 0.35, 0.5, 0.75];
const CAPS: [u64; 5] = [100_000, 1_000_000, 10_000_000, 50_000_000, 200_000_000];
const WIDTHS: [u32; 4] = [10, 20, 40, 80];
const LENGTHS: [u32; 5] = [15, 30, 60, 120, 240];
const INJECTED: [f64; 5] = [0.002, 0.01, 0.05, 0.1, 1.0];

impl Change {
    /// All that make sense for the scene, the reference first.
    pub fn all(scene: &ScaledScene) -> Vec<Change> {
        let case = scene.study.case;
        let mut all = vec![Change::Nothing];
        all.extend(SHARES.map(Change::Share));
        all.extend(CAPS.into_iter().filter(|&cap| cap < case.n_base).map(Change::Cap));
        if let Some([nx, ny, nz]) = scene.shape {
            all.extend(WIDTHS.into_iter().filter(|&w| [w, w] != [nx, ny]).map(Change::Width));
            all.extend(LENGTHS.into_iter().filter(|&l| l != nz).map(Change::Length));
        }
        let set = case.scene.walk.inject_share;
        all.extend(INJECTED.into_iter().filter(|share| (share / set - 1.0).abs() > 1e-6).map(Change::Inject));
        if matches!(case.scene.network.source(), NetworkSource::Cubic(_)) {
            all.push(Change::Stratified);
        }
        all
    }

    /// What is changed, to what, and that as a number.
    pub fn about(self) -> (&'static str, String, f64) {
        match self {
            Change::Nothing => ("reference", "as the scene has it".into(), 1.0),
            Change::Share(share) => ("base particles", format!("{share} of Eq. (2)"), share),
            Change::Cap(cap) => ("cap", format!("{cap:e} particles"), cap as f64),
            Change::Width(n) => ("cross-section", format!("{n} x {n} voids"), f64::from(n)),
            Change::Length(n) => ("length", format!("{n} layers"), f64::from(n)),
            Change::Inject(share) => ("injection", format!("{} % an increment", 100.0 * share), share),
            Change::Stratified => ("constriction sampling", "stratified".into(), 1.0),
        }
    }

    /// Whether it is walked on the very networks of the reference.
    pub fn keeps_network(self) -> bool {
        matches!(self, Change::Nothing | Change::Share(_) | Change::Cap(_) | Change::Inject(_))
    }

    /// The scene with its lattice changed.
    fn of<'a>(self, scene: &ScaledScene<'a>) -> ScaledScene<'a> {
        let shape = scene.shape.map(|[nx, ny, nz]| match self {
            Change::Width(width) => [width, width, nz],
            Change::Length(length) => [nx, ny, length],
            _ => [nx, ny, nz],
        });
        ScaledScene { shape, ..*scene }
    }

    /// Its network of this seed.
    pub fn network(self, scene: &ScaledScene, seed: u64) -> Result<Network, PrecisionError> {
        let changed = self.of(scene);
        match (self, changed.shape) {
            (Change::Stratified, Some(shape)) => scene.study.stratified(shape, seed),
            _ => changed.network(seed),
        }
    }

    /// The scene's run, changed; more voids take more base by Eq. (2).
    pub fn run(self, scene: &ScaledScene) -> FirstRun {
        let run = self.of(scene).run();
        let of = |share: f64| ((run.n_base as f64 * share).round() as u64).max(1);
        match self {
            Change::Share(share) => FirstRun { n_base: of(share), ..run },
            // A cap is one of the whole scene: a narrower lattice has the same share.
            Change::Cap(cap) => {
                FirstRun { n_base: of((cap as f64 / scene.study.case.n_base as f64).min(1.0)), ..run }
            }
            Change::Inject(share) => FirstRun { increments: (1.0 / share).round() as u64, ..run },
            _ => run,
        }
    }

    /// About what it costs, by what the reference costs: a run takes some 3.6 increments a layer beside those
    /// of insertion.
    pub fn cost(self, scene: &ScaledScene) -> f64 {
        let last = |increments: u64, layers: u32| increments as f64 + 3.6 * f64::from(layers);
        let changed = self.of(scene);
        let (Some([_, _, nz]), Some([_, _, layers])) = (scene.shape, changed.shape) else { return 1.0 };
        changed.by_voids() / scene.by_voids() * last(self.run(scene).increments, layers)
            / last(scene.run().increments, nz)
    }
}
