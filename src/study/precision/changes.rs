//! Settings that are changed one at a time, and what is held against what.

use super::RunError;
use super::first_run::{FirstRun, Scene};
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
    pub fn all(scene: &Scene) -> Vec<Change> {
        let case = scene.study.case;
        let mut all = vec![Change::Nothing];
        all.extend(SHARES.map(Change::Share));
        all.extend(CAPS.into_iter().filter(|&cap| cap < case.n_base).map(Change::Cap));
        if let Some([nx, ny, nz]) = scene.shape {
            all.extend(WIDTHS.into_iter().filter(|&w| [w, w] != [nx, ny]).map(Change::Width));
            all.extend(LENGTHS.into_iter().filter(|&l| l != nz).map(Change::Length));
        }
        let set = case.scene.inject_share;
        all.extend(INJECTED.into_iter().filter(|share| (share / set - 1.0).abs() > 1e-6).map(Change::Inject));
        if matches!(case.scene.network, NetworkSource::Cubic(_)) {
            all.push(Change::Stratified);
        }
        all
    }

    /// What is changed.
    pub fn factor(self) -> &'static str {
        match self {
            Change::Nothing => "reference",
            Change::Share(_) => "base particles",
            Change::Cap(_) => "cap",
            Change::Width(_) => "cross-section",
            Change::Length(_) => "length",
            Change::Inject(_) => "injection",
            Change::Stratified => "constriction sampling",
        }
    }

    /// To what.
    pub fn level(self) -> String {
        match self {
            Change::Nothing => "as the scene has it".into(),
            Change::Share(share) => format!("{share} of Eq. (2)"),
            Change::Cap(cap) => format!("{cap:e} particles"),
            Change::Width(width) => format!("{width} x {width} voids"),
            Change::Length(length) => format!("{length} layers"),
            Change::Inject(share) => format!("{} % an increment", 100.0 * share),
            Change::Stratified => "stratified".into(),
        }
    }

    /// The same as a number.
    pub fn at(self) -> f64 {
        match self {
            Change::Nothing | Change::Stratified => 1.0,
            Change::Share(share) | Change::Inject(share) => share,
            Change::Cap(cap) => cap as f64,
            Change::Width(n) | Change::Length(n) => f64::from(n),
        }
    }

    /// Whether it is walked on the very networks of the reference.
    pub fn keeps_network(self) -> bool {
        matches!(self, Change::Nothing | Change::Share(_) | Change::Cap(_) | Change::Inject(_))
    }

    /// The scene's shape, changed.
    fn shape(self, scene: &Scene) -> Option<[u32; 3]> {
        let [nx, ny, nz] = scene.shape?;
        Some(match self {
            Change::Width(width) => [width, width, nz],
            Change::Length(length) => [nx, ny, length],
            _ => [nx, ny, nz],
        })
    }

    /// Its network of this seed.
    pub fn network(self, scene: &Scene, seed: u64) -> Result<Network, RunError> {
        let changed = Scene { shape: self.shape(scene), ..*scene };
        match (self, changed.shape) {
            (Change::Stratified, Some(shape)) => {
                let case = scene.study.case;
                Ok(Network::cubic_stratified(shape, &case.curve, case.unit_mm, seed)?)
            }
            _ => changed.network(seed),
        }
    }

    /// The scene's run, changed; more voids take more base by Eq. (2).
    pub fn run(self, scene: &Scene) -> FirstRun {
        let run = Scene { shape: self.shape(scene), ..*scene }.run();
        let of = |share: f64| ((run.n_base as f64 * share).round() as u64).max(1);
        let n_base = match self {
            Change::Share(share) => of(share),
            // A cap is one of the whole scene: a narrower lattice has the same share.
            Change::Cap(cap) => of((cap as f64 / scene.study.case.n_base as f64).min(1.0)),
            _ => run.n_base,
        };
        let increments = match self {
            Change::Inject(share) => (1.0 / share).round() as u64,
            _ => run.increments,
        };
        FirstRun { n_base, increments, ..run }
    }

    /// About what it costs, by what the reference costs: a run takes some 3.6 increments a layer beside those
    /// of insertion.
    pub fn cost(self, scene: &Scene) -> f64 {
        let last = |increments: f64, layers: f64| increments + 3.6 * layers;
        let Some([_, _, nz]) = scene.shape else { return 1.0 };
        let changed = Scene { shape: self.shape(scene), ..*scene };
        let layers = changed.shape.map_or(nz, |[_, _, nz]| nz);
        changed.by_voids() / scene.by_voids() * last(self.run(scene).increments as f64, f64::from(layers))
            / last(scene.run().increments as f64, f64::from(nz))
    }
}
