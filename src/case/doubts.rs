//! Where the amount of base and the network leave the range in which the model was checked.

use super::Case;
use super::supply::PAPER_MASS_RATIO;
use crate::outcome::doubt::{Doubt, Way};
use crate::scene::NetworkSource;

/// A lattice narrower than this many voids has few ways beside each other: on one pair of soils one void
/// across eroded 3.3 %, forty 13.3 %.
const FEWEST_ACROSS: u32 = 10;

/// Of this part of the base on its way at the most can be said that it hardly moves a class.
const LITTLE_ON_ITS_WAY: f64 = 0.1;

impl Case {
    /// That less base is offered than the paper's Eq. (2) and mass ratio ask for.
    pub fn too_little_base(&self) -> Option<String> {
        let ratio = self.scene.base.mass_ratio.unwrap_or(PAPER_MASS_RATIO);
        let few = |what: String| {
            what + ". Fewer particles are a bias, not noise; its sign depends on the case, and a filter that \
                    was offered too few to fill it seems to hold"
        };
        match self.n_base_eq2 {
            Some(eq2) if self.capped => {
                Some(few(format!("capped at {} base particles; Eq. (2) requires {eq2}", self.n_base)))
            }
            Some(eq2) if self.n_base < eq2 => Some(few(format!(
                "base.n_base gives {} base particles; Eq. (2) requires {eq2} for a mass ratio of {} %",
                self.n_base,
                100.0 * PAPER_MASS_RATIO
            ))),
            Some(_) if self.scene.base.n_base.is_none() && ratio < PAPER_MASS_RATIO => Some(few(format!(
                "base.mass_ratio is {ratio}; the model was checked with {PAPER_MASS_RATIO}, base over filter"
            ))),
            None => {
                let n = self.scene.base.n_base?;
                Some(format!(
                    "base.n_base gives {n} base particles; without filter.grains_per_void Eq. (2) cannot say \
                     whether they are enough"
                ))
            }
            _ => None,
        }
    }

    /// What speaks against the network, whatever comes of its walk.
    pub(super) fn network_doubts(&self) -> Vec<Doubt> {
        let own = Doubt::all(Way::Open, self.own_network());
        own.chain(Doubt::all(
            Way::Unsafe,
            [self.narrow_lattice(), self.all_on_its_way()].into_iter().flatten(),
        ))
        .collect()
    }

    /// A network that the user gives.
    fn own_network(&self) -> Option<String> {
        matches!(self.scene.network.source(), NetworkSource::File(_)).then(|| {
            format!(
                "the network is that of the file, {} voids; nothing of it was checked against tests",
                self.counts[0]
            )
        })
    }

    fn narrow_lattice(&self) -> Option<String> {
        let [nx, ny, _] = self.scene.network.source().shape()?;
        (nx.min(ny) < FEWEST_ACROSS).then(|| {
            format!(
                "the lattice is only {nx} x {ny} voids across; a narrow one seals by chance, so that filters \
                 seem to hold: {FEWEST_ACROSS} x {FEWEST_ACROSS} at the least, better 40 x 40 (network.nx, \
                 network.ny)"
            )
        })
    }

    /// Where water flows, a base that has all been inserted before any of it can be through.
    ///
    /// A particle makes one move an increment, and needs as many as there are layers. What is on its way when
    /// the water stops counts as retained; here that is all of it.
    fn all_on_its_way(&self) -> Option<String> {
        let (increments, layers) = (self.increments(), self.counts[3]);
        (self.scene.exit_rule().needs_flow() && increments <= layers).then(|| {
            format!(
                "the whole base is inserted before any of it can be through the filter; inject_share {} \
                 makes {increments} increments, and a particle needs {layers} to pass as many layers. Where \
                 water flows, all that is on its way when the filter clogs counts as retained: take \
                 inject_share = {:.1e} or less",
                self.scene.walk.inject_share,
                LITTLE_ON_ITS_WAY / layers.max(1) as f64
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    fn doubts(set: &[&str]) -> Vec<String> {
        let small =
            ["network.nx=10", "network.ny=10", "network.nz=12", "base.cu=3", "base.d15f_over_d85b=3.9"];
        let all: Vec<String> = small.iter().chain(set).map(ToString::to_string).collect();
        let doubts = Case::new(Scene::built_in(&all).unwrap()).unwrap().doubts();
        doubts.into_iter().map(|doubt| doubt.said).collect()
    }

    #[track_caller]
    fn says(set: &[&str], word: &str) {
        let found = doubts(set);
        assert!(found.iter().any(|said| said.starts_with(word)), "{set:?}: {found:?}");
    }

    #[test]
    fn less_base_than_eq_2_gives_is_a_doubt() {
        assert_eq!(doubts(&[]), Vec::<String>::new());
        says(&["base.cap=500"], "capped at 500 base particles; Eq. (2) requires");
        says(&["base.n_base=500"], "base.n_base gives 500 base particles; Eq. (2) requires");
        says(&["base.mass_ratio=0.01"], "base.mass_ratio is 0.01; ");
        for enough in ["base.n_base=1e9", "base.cap=1e12", "base.mass_ratio=0.1"] {
            assert_eq!(doubts(&[enough]), Vec::<String>::new(), "{enough}");
        }
    }

    #[test]
    fn a_narrow_lattice_is_a_doubt() {
        says(&["network.nx=9"], "the lattice is only 9 x 10 voids across");
        says(
            &["network.ny=1", "network.connectivity={4=50,8=50}"],
            "the lattice is only 10 x 1 voids across",
        );
    }

    #[test]
    fn a_base_that_is_all_on_its_way_is_a_doubt_where_water_flows() {
        says(&["walk.exit=flux", "inject_share=0.1"], "the whole base is inserted before");
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
