//! Record of walks on given networks.

use rayon::slice::ParallelSliceMut;

use super::network_walk::{NetworkOutcome, NetworkWalk};
use crate::case::base_record;
use crate::outcome::left_out::LeftOut;
use crate::outcome::network_walk::{GivenNetwork, NetworkWalkRecord};
use crate::outcome::{Modelled, leaves_out, verdict};
use voidwalk_core::gradation::Gradation;
use voidwalk_core::network::Network;

/// Steps of the curve of a network's diameters (percent).
const STEP: usize = 2;

impl NetworkOutcome {
    /// The record of these walks by a plan; `network` is the first of this many networks.
    pub fn record(&self, plan: &NetworkWalk, network: &Network, networks: usize) -> NetworkWalkRecord {
        let first = self.replicates.first().map(|walked| &walked.result);
        NetworkWalkRecord {
            verdict: self.verdict,
            notes: self.notes(plan, network, networks),
            seed: plan.seed,
            n_base: plan.n_base,
            n_base_eq2: plan.eq2(network, plan.mass_ratio).ok().flatten(),
            grains_per_void: plan.filter.as_ref().and_then(|filter| filter.grains_per_void),
            mass_ratio: plan.mass_ratio,
            increments: plan.increments,
            engine: first.map_or(plan.engine, |first| first.engine).name().into(),
            replicates: self.replicates.iter().map(|walked| walked.result.replicate.clone()).collect(),
            summary: self.summary.clone(),
            threshold: verdict::THRESHOLD,
            left_out: first
                .map_or(Vec::new(), |first| first.left_out.iter().copied().map(LeftOut::Walk).collect()),
            model_leaves_out: leaves_out(Modelled {
                flow: network.exit_rule().needs_flow(),
                ..Modelled::default()
            }),
            base: base_record(in_words(&plan.base), &plan.base),
            d15f_mm: plan.d15f_mm(),
            network: given(network, networks),
            version: env!("CARGO_PKG_VERSION").into(),
        }
    }
}

/// Description of a base without a name.
fn in_words(base: &Gradation) -> String {
    match base.cu().filter(|_| base.smallest_mm() < base.largest_mm()) {
        Some(cu) => format!("Cu {}", (cu * 1e3).round() / 1e3),
        None => "one size".into(),
    }
}

fn given(network: &Network, networks: usize) -> GivenNetwork {
    let passages = (0..network.constrictions()).filter(|&c| network.counts(c));
    let mut diameters: Vec<f32> = passages.map(|c| network.diameters()[c]).collect();
    let constrictions = diameters.len() as u64;
    diameters.retain(|&diameter| diameter > 0.0);
    diameters.par_sort_unstable_by(f32::total_cmp);
    // The least, the greatest, and between them the size at this percentile.
    let size = |percent: usize| {
        let at = (percent * diameters.len()).div_ceil(100).max(1) - 1;
        Some([f64::from(*diameters.get(at)?) * network.unit_mm(), percent as f64])
    };
    GivenNetwork {
        networks: networks as u64,
        exit: network.exit_rule().name().into(),
        voids: network.filter_voids() as u64,
        constrictions,
        layers: network.layers() as u64,
        diameters: (0..=100).step_by(STEP).filter_map(size).collect(),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::outcome::record::ModelLimit;
    use crate::run::{Callbacks, walk_networks};
    use voidwalk_core::network::{ExitRule, NetworkColumns};

    /// Two constrictions that are passed both ways and one that is closed from the start, each counted once.
    #[test]
    fn a_record_says_what_was_walked_through() {
        let columns = NetworkColumns {
            voids: 3,
            conns: &[[0, 1], [1, 2], [0, 2]],
            diameter_mm: &[0.5, 0.25, 0.0],
            conductance: None,
            inlets: &[0],
            outlets: &[2],
            rule: ExitRule::Flux,
            rho: 0.0,
            unit_mm: 0.5,
        };
        let network = Arc::new(Network::from_columns(&columns).unwrap().0);
        let plan = NetworkWalk { replicates: 2, ..NetworkWalk::new(Gradation::single(0.1).unwrap(), 1000) };
        let outcome = walk_networks(&[Arc::clone(&network)], &plan, &Callbacks::default()).unwrap();
        let record = outcome.record(&plan, &network, 1);
        let given = &record.network;
        assert_eq!((given.voids, given.constrictions, given.exit.as_str()), (3, 3, "flux"));
        assert_eq!((given.diameters[0], given.diameters[50]), ([0.25, 0.0], [0.5, 100.0]));
        assert!(given.diameters.iter().all(|&[mm, percent]| (mm == 0.25) == (percent <= 50.0)));
        assert_eq!((record.base.name.as_str(), record.base.d85_mm), ("one size", 0.1));
        assert_eq!((record.n_base, record.replicates.len(), record.summary.len()), (1000, 2, 2));
        assert!(record.model_leaves_out.contains(&ModelLimit::Gradient));
        assert_eq!((record.n_base_eq2, record.grains_per_void), (None, None));
        assert!(record.notes.iter().any(|note| note.id() == "amount_unknown"), "{:?}", record.notes);
    }
}
