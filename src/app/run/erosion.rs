//! Erosion in one run of a case on one network, and nothing else: for studies that walk many cases.

use std::borrow::Cow;
use std::sync::Arc;

use super::callbacks::Callbacks;
use super::error::RunError;
use super::replicates::plan;
use crate::case::Case;
use crate::outcome::Eroded;
use voidwalk_core::network::Network;
use voidwalk_core::walk::{Clogged, PlainExits, SizeClasses, State, Walk, WalkControl};

/// Number of size classes of a run whose record is not wanted: one class or two serve as well.
const SIZE_CLASSES: usize = 2;

/// Walks run `run` (1 or 2) of a case on the network of the replicate with this seed, from constrictions that
/// are `clogged` at its start: the same bits as [`super::walk_case`] gives. `open` are the network's exits,
/// if they are known. Returns the eroded mass and the constrictions at the end.
///
/// # Errors
/// A walk that goes wrong, or that was stopped; particles that do not fit.
pub fn eroded(
    case: &Case,
    (network, open): (&Arc<Network>, Option<&PlainExits>),
    (seed, run): (u64, u64),
    clogged: Clogged,
    callbacks: &Callbacks,
) -> Result<(Eroded, Clogged), RunError> {
    let plan = plan(case, network, &clogged.blocked, case.supply.n_base);
    let supply = plan.supply(case.supply.sampler.clone(), case.supply.n_base, case.increments(), seed, run);
    let (smallest, largest) = (case.supply.sampler.smallest(), case.supply.sampler.largest());
    let classes = SizeClasses::logarithmic(smallest, largest, SIZE_CLASSES);
    let state = State::placed(&case.placement, network, &supply, classes, clogged, seed, run);
    let mut state = state.map_err(|source| RunError::Room { particles: supply.total(), source })?;
    let mut walk = Walk::with_exits(network, &supply, &state, open.map(Cow::Borrowed));
    walk.run(&mut state, &mut |_| match callbacks.is_stopped() {
        true => WalkControl::Stop,
        false => WalkControl::Continue,
    })?;
    walk.end(&state)?;
    Ok((Eroded::of(&state, case.pan_by_mass_only()), state.into_clogged()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::replicate_seed;
    use crate::run::walk_case;
    use crate::scene::Scene;

    #[test]
    fn what_erodes_is_to_the_bit_what_a_run_of_the_scene_says() {
        for base in ["base.cu=3", "base.single_mm=0.19"] {
            let small = ["network.nx=8", "network.ny=8", "network.nz=10", "replicates=1", base];
            let more = ["base.n_base=30000", "record.sensitivity=[]"];
            let settings: Vec<String> = small.iter().chain(&more).map(ToString::to_string).collect();
            let case = Case::new(Scene::built_in(&settings).unwrap()).unwrap();
            let outcome = walk_case(&case, &Callbacks::default()).unwrap();
            let seed = replicate_seed(case.scene.walk.seed, 1);
            let network = Arc::new(case.network(seed).unwrap());
            let mut clogged = Clogged::none(&network);
            for run in &outcome.replicates[0].runs {
                let open = PlainExits::unblocked(&network);
                let known = (&network, (base != "base.cu=3").then_some(&open));
                let result = eroded(&case, known, (seed, run.run), clogged, &Callbacks::default()).unwrap();
                assert_eq!(result.0.mass_fraction.to_bits(), run.eroded_mass_fraction.to_bits(), "{base}");
                assert!(run.eroded_mass_fraction > 0.0);
                clogged = result.1;
            }
        }
    }

    /// If particles arch, or leave openings, their moves depend on more than the network.
    #[test]
    fn known_exits_are_left_alone_where_others_are_needed() {
        for (other, engines) in [
            ("walk.arching=zuriguel-2005", ["engine=counts", "engine=expected"]),
            ("walk.blocked=open", ["engine=auto", "engine=particles"]),
        ] {
            for engine in engines {
                let small = ["network.nx=8", "network.ny=8", "network.nz=10", "base.n_base=30000"];
                let settings: Vec<String> =
                    small.iter().chain(&[other, engine]).map(ToString::to_string).collect();
                let case = Case::new(Scene::built_in(&settings).unwrap()).unwrap();
                assert!(!case.begins_with_plain_exits());
                let network = Arc::new(case.network(5).unwrap());
                let known = PlainExits::unblocked(&network);
                let [a, b] = [None, Some(&known)].map(|open| {
                    let clogged = Clogged::none(&network);
                    eroded(&case, (&network, open), (5, 1), clogged, &Callbacks::default()).unwrap()
                });
                assert_eq!(a.0.mass_fraction.to_bits(), b.0.mass_fraction.to_bits(), "{other} {engine}");
                assert_eq!(a.1.blocked, b.1.blocked, "{other} {engine}");
            }
        }
    }
}
