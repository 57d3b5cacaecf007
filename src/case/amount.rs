//! Where the amount of base and the network leave the range in which the model was checked.

use super::Case;
use super::supply::PAPER_MASS_RATIO;
use crate::scene::NetworkSource;
use crate::verdict::{Finding, finding};

/// A lattice narrower than this many voids has few ways beside each other: on one pair of soils one void
/// across eroded 3.3 %, forty 13.3 %.
const FEWEST_ACROSS: u32 = 10;

impl Case {
    /// That less base is offered than the paper's Eq. (2) and mass ratio ask for.
    pub fn too_little_base(&self) -> Option<Finding> {
        let ratio = self.scene.base.mass_ratio.unwrap_or(PAPER_MASS_RATIO);
        match self.n_base_eq2 {
            Some(eq2) if self.capped => Some(finding::capped_base(self.n_base, eq2)),
            Some(eq2) if self.n_base < eq2 => Some(finding::few_particles(self.n_base, eq2)),
            Some(_) if self.scene.base.n_base.is_none() && ratio < PAPER_MASS_RATIO => {
                Some(finding::low_mass_ratio(100.0 * ratio))
            }
            None => self.scene.base.n_base.map(finding::amount_unknown),
            _ => None,
        }
    }

    /// What speaks against the network, whatever comes of its walk.
    pub(super) fn of_network(&self) -> Vec<Finding> {
        let source = self.scene.network.source();
        let is_given = matches!(source, NetworkSource::File(_));
        let given = is_given.then(|| finding::given_network(self.counts[0]));
        let flows = self.scene.exit_rule().needs_flow();
        let late = all_on_its_way(flows, self.increments(), self.counts[3]);
        given.into_iter().chain(narrow_lattice(source.shape())).chain(late).collect()
    }
}

/// A lattice of this shape that is narrow.
pub fn narrow_lattice(shape: Option<[u32; 3]>) -> Option<Finding> {
    let [nx, ny, _] = shape?;
    (nx.min(ny) < FEWEST_ACROSS).then(|| finding::narrow_lattice(nx.into(), ny.into()))
}

/// Where water flows, a base that has all been inserted before any of it can be through.
///
/// A particle makes one move an increment, and needs as many as there are layers. What is on its way when the
/// water stops counts as retained; here that is all of it.
pub fn all_on_its_way(flows: bool, increments: u64, layers: u64) -> Option<Finding> {
    (flows && increments <= layers).then(|| finding::all_on_its_way(increments, layers))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::record::Verdict;
    use crate::scene::Scene;

    fn doubts(set: &[&str]) -> Vec<String> {
        let small =
            ["network.nx=10", "network.ny=10", "network.nz=12", "base.cu=3", "base.d15f_over_d85b=3.9"];
        let all: Vec<String> = small.iter().chain(set).map(ToString::to_string).collect();
        let found = Case::new(Scene::built_in(&all).unwrap()).unwrap().findings();
        found.iter().filter(|of| of.is_against(Verdict::None)).map(Finding::sentence).collect()
    }

    #[track_caller]
    fn says(set: &[&str], word: &str) {
        let found = doubts(set);
        assert!(found.iter().any(|said| said.starts_with(word)), "{set:?}: {found:?}");
    }

    #[test]
    fn less_base_than_eq_2_gives_is_a_doubt() {
        assert_eq!(doubts(&[]), Vec::<String>::new());
        says(&["base.cap=500"], "The base is capped at 500 of the");
        says(&["base.n_base=500"], "The base has 500 of the");
        says(&["base.mass_ratio=0.01"], "The mass of the base is 1 % of the filter's");
        for enough in ["base.n_base=1e9", "base.cap=1e12", "base.mass_ratio=0.1"] {
            assert_eq!(doubts(&[enough]), Vec::<String>::new(), "{enough}");
        }
    }

    #[test]
    fn a_narrow_lattice_is_a_doubt() {
        says(&["network.nx=9"], "The lattice is only 9 x 10 voids across");
        says(
            &["network.ny=1", "network.connectivity={4=50,8=50}"],
            "The lattice is only 10 x 1 voids across",
        );
    }

    #[test]
    fn a_base_that_is_all_on_its_way_is_a_doubt_where_water_flows() {
        says(&["walk.exit=flux", "inject_share=0.1"], "The whole base is inserted before");
        for converged in [["walk.exit=flux", "inject_share=0.05"], ["walk.exit=area", "inject_share=0.1"]] {
            assert_eq!(doubts(&converged), Vec::<String>::new(), "{converged:?}");
        }
    }

    #[test]
    fn a_capped_base_has_the_mass_ratio_of_its_particles() {
        let of = |set: &str| {
            let all = ["network.nx=10", "network.ny=10", "network.nz=12", set].map(String::from);
            Case::new(Scene::built_in(&all).unwrap()).unwrap().mass_ratio.unwrap()
        };
        let (capped, given) = (of("base.cap=1000"), of("base.n_base=1000"));
        assert!((capped / given - 1.0).abs() < 0.01 && capped < 0.04, "{capped} {given}");
    }
}
