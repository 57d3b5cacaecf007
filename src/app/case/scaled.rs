//! A case with another constriction curve, or in other sizes: its filter against a base that is scaled, as
//! a search of boundaries tries many of.
//!
//! A walk knows sizes as multiples of the finest filter grain alone. So a filter that is s times as large is
//! walked as a base 1/s times as large: its network stays the same to the bit, and with it every random
//! number that does not depend on the base.

use super::files::Files;
use super::supply::Against;
use super::{Case, CaseBase, CaseError, CaseNetwork};
use crate::scene::{NetworkSource, Scene};
use voidwalk_core::constrictions::Curve;
use voidwalk_core::gradation::Gradation;
use voidwalk_core::network::Network;

/// A base as a scene states it, with its sizes as they are.
#[derive(Clone, Debug)]
pub struct StatedBase {
    /// The scene that states it.
    pub scene: Scene,
    /// The base.
    pub base: CaseBase,
    /// Files that were read.
    pub inputs: Vec<super::Input>,
}

impl Case {
    /// Replaces the constriction curve alone: base and amount of base stay.
    pub fn with_curve(&self, curve: Curve) -> Self {
        let mut case = self.clone();
        case.filter.finest_mm = self.filter.finest_mm.min(curve.smallest());
        case.filter.curve = curve;
        case.filter.curve_ends.clear();
        case
    }

    /// The base that another scene states, read beside this case's filter.
    ///
    /// # Errors
    /// A file that is refused.
    pub fn base_of(&self, scene: &Scene) -> Result<StatedBase, CaseError> {
        let mut files = Files::default();
        let base = CaseBase::read(scene, &self.filter, &mut files)?;
        if scene.is_guarded && scene.filter.sieve.is_some() {
            base.mistake(scene, &self.filter.gradation, false)?;
        }
        Ok(StatedBase { scene: scene.clone(), base, inputs: files.inputs })
    }

    /// Replaces the base by one of this gradation, in this filter's own unit; filter and network stay, but a
    /// lattice gets the number of layers in `layers`.
    ///
    /// # Errors
    /// A base that cannot be walked: Eq. (2) gives too few or too many particles, or sizes are out of range;
    /// more constrictions than 32 bits can number.
    pub fn with_base(&self, base: Gradation, layers: Option<u64>) -> Result<Self, CaseError> {
        let mut case = self.clone();
        if let (Some(layers), NetworkSource::Cubic([nx, ny, _])) = (layers, self.scene.network.source()) {
            let shape = [nx, ny, u32::try_from(layers).unwrap_or(u32::MAX)];
            case.network = CaseNetwork::of_lattice(shape)?;
            case.scene.network.set_layers(layers);
        }
        let against =
            Against { scene: &case.scene, filter: &case.filter, voids: case.network.voids, is_packed: false };
        case.supply = against.supply(&base)?;
        case.base = CaseBase { gradation: base, regraded_from: None };
        // No other number or thickness is studied.
        case.scene.record.sensitivity.clear();
        case.scene.record.thickness = Some(Vec::new());
        Ok(case)
    }

    /// Enlarges the filter of this case by `factor`, against a stated base at its own size: not to be walked,
    /// but to be judged by rules in millimetres.
    ///
    /// # Errors
    /// Sizes out of range.
    pub fn enlarged(&self, factor: f64, base: &StatedBase) -> Result<Self, CaseError> {
        let mut case = self.clone();
        (case.filter, case.base) = (case.filter.enlarged(factor)?, base.base.clone());
        if case.scene.filter.sieve.is_none() {
            // Its sizes are no longer multiples of D0F.
            case.scene.filter.d0_mm = Some(case.filter.unit_mm);
        }
        case.scene.base = base.scene.base.clone();
        case.inputs.extend(base.inputs.iter().cloned());
        Ok(case)
    }

    /// True if a network of another base on the same filter has as many layers as this case's, so that both
    /// share it.
    pub fn has_layers_of(&self, network: &Network) -> bool {
        network.layers() as u64 == self.network.layers
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn built_in(set: &[&str]) -> Scene {
        Scene::built_in(&set.iter().map(ToString::to_string).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn a_base_that_is_scaled_is_the_base_that_a_scene_states_in_that_size() {
        let case = Case::new(built_in(&["base.cu=3"])).unwrap();
        for ratio in [4.0, 6.5] {
            let stated = built_in(&["base.cu=3", &format!("base.d15f_over_d85b={ratio}")]);
            let wanted = Case::new(stated.clone()).unwrap();
            let base = case.base_of(&stated).unwrap().base.gradation;
            let made = case.with_base(base, None).unwrap();
            assert_eq!(made.base.gradation, wanted.base.gradation);
            let made_of = |case: &Case| (case.supply.n_base, case.network.voids, case.network.layers);
            assert_eq!(made_of(&made), made_of(&wanted));
        }
    }

    #[test]
    fn more_layers_take_more_base() {
        let case = Case::new(built_in(&[])).unwrap();
        let thick = case.with_base(case.base.gradation.clone(), Some(120)).unwrap();
        assert_eq!(thick.network.layers, 120);
        assert!(thick.supply.n_base.abs_diff(2 * case.supply.n_base) <= 1);
        let kept = case.network(7).unwrap();
        assert!(case.has_layers_of(&kept) && !thick.has_layers_of(&kept));
        assert_eq!(thick.network(7).unwrap().layers(), 120);
    }

    /// A pan fraction that is walked blocks nothing at either end of a guess, so that a walk there
    /// follows numbers and asks for no column of billions of particles.
    #[test]
    fn a_passive_pan_fraction_is_passive_at_the_ends_of_a_guess_too() {
        let folder = tempfile::tempdir().unwrap();
        let (base, filter) = (folder.path().join("base.csv"), folder.path().join("filter.csv"));
        std::fs::write(&base, "opening_mm,percent_finer\n19,100\n9.5,76\n4.75,27.2\n2.36,16.4\n").unwrap();
        let sieves = "19,100\n9.5,77.5\n4.75,61.3\n1.18,52\n0.3,15.7\n0.075,8\n0.02,6.5\n";
        std::fs::write(&filter, format!("opening_mm,percent_finer\n{sieves}")).unwrap();
        let path = |name: &str, file: &std::path::Path| format!("{name}.sieve={}", file.display());
        let set = [path("base", &base), path("filter", &filter)].into_iter();
        let set = set.chain(["filter.estimate=0.5", "base.n_base=50", "network.nx=4"].map(String::from));
        let set: Vec<String> = set.collect();
        for arches in [&[][..], &["walk.arching=marin-2018", "walk.concentration=0.1"]] {
            let set: Vec<String> =
                set.iter().cloned().chain(arches.iter().map(ToString::to_string)).collect();
            let case = Case::new(Scene::built_in(&set).unwrap()).unwrap();
            assert!(case.supply.pan_is_walked);
            let (ends, widest) = (&case.filter.curve_ends, case.scene.law().map_or(1.0, |law| law.widest));
            assert!(ends.iter().any(|end| end.curve.smallest() < case.filter.curve.smallest()));
            for end in ends {
                let finest = (end.curve.smallest() / widest / case.filter.unit_mm) as f32;
                assert!(case.supply.sampler.smallest() < finest, "{arches:?} {}", end.name);
            }
            let bytes = case.bytes(case.supply.n_base, 1);
            assert!(bytes < 10_000_000, "{arches:?} {bytes}");
        }
    }
}
