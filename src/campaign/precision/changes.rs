//! Settings that are changed one at a time, and what is held against what.

use super::PrecisionError;
use super::Study;
use super::first_run::FirstRun;
use crate::campaign::scene::NetworkSource;
use crate::network::Network;

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
    pub fn all(study: &Study) -> Vec<Change> {
        let case = study.case;
        let mut all = vec![Change::Nothing];
        all.extend(SHARES.map(Change::Share));
        all.extend(CAPS.into_iter().filter(|&cap| cap < case.n_base).map(Change::Cap));
        if let Some([nx, ny, nz]) = study.shape() {
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
    fn shape(self, study: &Study) -> Option<[u32; 3]> {
        let [nx, ny, nz] = study.shape()?;
        Some(match self {
            Change::Width(width) => [width, width, nz],
            Change::Length(length) => [nx, ny, length],
            _ => [nx, ny, nz],
        })
    }

    /// Its network of this seed.
    pub fn network(self, study: &Study, seed: u64) -> Result<Network, PrecisionError> {
        let shape = self.shape(study);
        match (self, shape) {
            (Change::Stratified, Some(shape)) => {
                let case = study.case;
                Ok(Network::cubic_stratified(shape, &case.curve, case.unit_mm, seed)?)
            }
            _ => study.network(shape, seed),
        }
    }

    /// The scene's run, changed; more voids take more base by Eq. (2).
    pub fn run(self, study: &Study) -> FirstRun {
        let reference = FirstRun::of(study);
        let of = |share: f64| ((reference.n_base as f64 * share).round() as u64).max(1);
        let n_base = match self {
            Change::Share(share) => of(share),
            Change::Cap(cap) => reference.n_base.min(cap),
            _ => of(self.voids(study)),
        };
        let increments = match self {
            Change::Inject(share) => (1.0 / share).round() as u64,
            _ => reference.increments,
        };
        FirstRun { n_base, increments, ..reference }
    }

    /// Voids, by those of the scene.
    fn voids(self, study: &Study) -> f64 {
        let count = |shape: Option<[u32; 3]>| shape.map_or(1.0, |n| n.map(f64::from).iter().product());
        count(self.shape(study)) / count(study.shape())
    }

    /// About what it costs, by what the reference costs: a run takes some 3.6 increments a layer beside those of insertion.
    pub fn cost(self, study: &Study) -> f64 {
        let last = |increments: f64, layers: f64| increments + 3.6 * layers;
        let Some([_, _, nz]) = study.shape() else { return 1.0 };
        let layers = self.shape(study).map_or(nz, |[_, _, nz]| nz);
        let increments = self.run(study).increments as f64;
        self.voids(study) * last(increments, f64::from(layers))
            / last(study.case.increments() as f64, f64::from(nz))
    }
}
