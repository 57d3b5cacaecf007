//! Notes on a case before its walk: departures from the range in which the model was checked, and other
//! facts for the user.

use super::base::PAPER_MASS_RATIO;
use super::filter::needs_grains_per_void;
use super::packed_filter::GUESSED_GRAINS_PER_VOID;
use super::{Case, Input, PackingPlan, replicate_seed};
use crate::scene::{LibraryDensity, NetworkSource, Regrade};
use crate::verdict::PlannedWalk;
use crate::verdict::walks::packed_part;
use voidwalk_core::gradation::GRAVEL_MM;
use voidwalk_core::network::ExitRule;
use voidwalk_practice::Note;

/// Number of moves of a particle that nothing stops above which a note is given.
const MANY_MOVES: f64 = 1e5;
/// Fraction of grains without load above which a note is given ...
const MANY_LOOSE: f64 = 0.5;
/// ... and above which coarse grains form a skeleton: with two widely different sizes 98 % were without
/// load if the finer one was 30 % of the mass, and 19 % if it was 40 % (`results/packing.md`).
const SKELETON: f64 = 0.9;
/// Maximum number of constrictions that are examined for this, with repetitions.
const LOOKED_AT: u64 = 50_000_000;

impl Case {
    /// Notes before the walk, except those that the walk itself adds.
    pub fn notes(&self) -> Vec<Note> {
        let mut all = self.planned_walk().notes();
        all.extend(self.mistake.clone());
        all.extend((self.scene.base.dispersive == Some(true)).then_some(Note::DispersiveBase {}));
        all.extend(self.scene.filter.joint_mm.map(|width_mm| Note::OpenJoint { width_mm }));
        all.extend(self.too_thick());
        all.extend(self.too_little_base());
        all.extend(self.other_filter());
        all.extend(self.guesses());
        // The omitted grains can only make constrictions coarser than those that were walked.
        all.extend(self.filter.packed.as_ref().and_then(|packed| packed.part.as_ref()).map(packed_part));
        let loose = self.filter.packed.as_ref().and_then(|packed| packed.rattlers);
        match loose.filter(|loose| *loose >= MANY_LOOSE).map(|loose| 100.0 * loose) {
            Some(loose_percent) if loose_percent > 100.0 * SKELETON => {
                all.push(Note::Skeleton { loose_percent });
            }
            loose => all.extend(loose.map(|loose_percent| Note::LooseGrains { loose_percent })),
        }
        all.extend(self.regrading());
        let of_file = |input: &Input| -> Vec<Note> {
            let read_as =
                |reading: &String| Note::ReadAs { file: input.name.clone(), reading: reading.clone() };
            input.notes.iter().map(read_as).collect()
        };
        all.extend(self.inputs.iter().flat_map(of_file));
        if self.filter.gradation.pan_fraction() > 0.0 {
            all.push(Note::PanOfFilter { finest_percent: 100.0 * self.filter.gradation.pan_fraction() });
        }
        all.extend(self.narrow_cell());
        all.extend(self.network.copies().map(|copies| Note::OnePacking { copies: copies.into() }));
        if let Some(moves) = self.moves_to_an_end().filter(|moves| *moves > MANY_MOVES) {
            all.push(Note::LongWayOut { moves: moves.min(1e300) });
        }
        all
    }

    /// Soils and network as walked.
    fn planned_walk(&self) -> PlannedWalk<'_> {
        let (source, replicates) = (self.scene.network.source(), self.scene.walk.replicates);
        PlannedWalk {
            base: &self.base.gradation,
            regraded_from: self.base.regraded_from.as_ref().map(|(given, _)| given),
            finest_constriction_mm: self.filter.finest_mm,
            filter: Some(&self.filter.gradation),
            filter_is_measured: self.filter_is_measured(),
            scale_free: self.is_scale_free(),
            given_voids: matches!(source, NetworkSource::File(_)).then_some(self.network.voids),
            lattice: source.shape(),
            layers: self.network.layers,
            flows: self.scene.exit_rule().needs_flow(),
            increments: self.increments(),
            // A rule that adds replicates reports if they suffice, unless it may not add any.
            replicates: match self.scene.stop.is_set() {
                true => self.scene.stop.replicates_at(replicates, 1),
                false => replicates,
            },
        }
    }

    /// Notes a shipped constriction curve of another filter.
    fn other_filter(&self) -> Option<Note> {
        let shipped = self.shipped_curve()?;
        let cu = self.filter.gradation.cu().filter(|cu| (cu / shipped.cu - 1.0).abs() > 0.05)?;
        Some(Note::OtherCurve { cu, curve: shipped.name.clone(), curve_cu: shipped.cu })
    }

    /// Notes values that are guessed because the filter was not packed.
    fn guesses(&self) -> Vec<Note> {
        if let Some(library) = &self.filter.library {
            let density = self.scene.filter.library.unwrap_or(LibraryDensity::Unknown);
            let [error_percent, grains_percent] =
                [library.found.curve_error, library.found.grains_error].map(|error| 100.0 * error);
            let note = match density {
                LibraryDensity::Unknown => Note::LibraryOfAnyDensity { error_percent, grains_percent },
                _ => Note::LibraryOfDensity { density: density.name().into(), error_percent, grains_percent },
            };
            return std::iter::once(note).chain(library.part.as_ref().map(packed_part)).collect();
        }
        if self.filter.guessed_density.is_none() {
            return Vec::new();
        }
        let like_none = self.scene.filter.library.map(|_| Note::LikeNoneOfTheLibrary {});
        let grains = needs_grains_per_void(&self.scene, self.filter.guessed_density);
        let grains = grains.then_some(Note::GuessedGrains { grains: GUESSED_GRAINS_PER_VOID });
        like_none.into_iter().chain([Note::GuessedConstrictions {}]).chain(grains).collect()
    }

    /// Notes a base smaller than by the paper's Eq. (2) and mass ratio.
    pub(crate) fn too_little_base(&self) -> Option<Note> {
        let ratio = self.scene.base.mass_ratio.unwrap_or(PAPER_MASS_RATIO);
        let particles = self.supply.n_base;
        match self.supply.n_base_eq2 {
            Some(needed) if self.supply.capped => Some(Note::CappedBase { particles, needed }),
            Some(needed) if particles < needed => Some(Note::FewParticles { particles, needed }),
            Some(_) if self.scene.base.n_base.is_none() && ratio < PAPER_MASS_RATIO => {
                Some(Note::LowMassRatio { ratio_percent: 100.0 * ratio })
            }
            None => self.scene.base.n_base.map(|particles| Note::AmountUnknown { particles }),
            _ => None,
        }
    }

    /// Notes a real filter layer thinner than the modelled one by more than half a layer of voids, to
    /// which a thickness is rounded.
    fn too_thick(&self) -> Option<Note> {
        let real_mm = self.scene.filter.thickness_mm?;
        if self.is_scale_free() {
            return Some(Note::ThicknessWithoutUnit { real_mm, unit: "D0F".into() });
        }
        let Some(modelled_mm) = self.thickness() else { return Some(Note::ThicknessOfFile { real_mm }) };
        let half = 0.5 * self.filter.gradation.d_by_number(50.0).unwrap_or(0.0);
        (modelled_mm > real_mm + half * (1.0 + 1e-9)).then(|| match self.network.copies() {
            Some(copies) => Note::CopiesThicker { copies: copies.into(), modelled_mm, real_mm },
            None => Note::LayersThicker { layers: self.network.layers, modelled_mm, real_mm },
        })
    }

    /// Notes a base that is walked regraded, or that should have been.
    fn regrading(&self) -> Option<Note> {
        match (&self.base.regraded_from, self.scene.base.regrade) {
            (Some((given, at)), _) => {
                Some(Note::Regraded { part_percent: given.percent_finer_by_mass(*at), sieve_mm: *at })
            }
            // A base without gravel is not expected to be regraded.
            (None, Some(Regrade::Practice)) if self.base.gradation.largest_mm() > GRAVEL_MM => {
                Some(Note::RegradingNotNeeded {})
            }
            _ => None,
        }
    }

    /// Notes a tall cell that is narrow because of its number of grains.
    fn narrow_cell(&self) -> Option<Note> {
        let plan = PackingPlan::new(&self.scene.packing_spec().ok()??).ok()?;
        let (width, usual) = plan.narrow_and_tall()?;
        let grains = plan.compression.grains as u64;
        Some(Note::NarrowCell { grains, aspect: plan.aspect, width, usual })
    }

    /// Approximate number of moves of a particle that nothing stops, if loops may hold it for long: on a
    /// given network, or if one constriction is very much wider than another.
    fn moves_to_an_end(&self) -> Option<f64> {
        let widest = self.filter.curve.largest() / self.filter.curve.smallest();
        match self.network.fixed.as_ref().map(|fixed| &fixed.network) {
            // Along falling pressure there are no loops.
            Some(network) if network.reservoir().is_some() => None,
            Some(network) => Some(network.moves_to_an_end(LOOKED_AT)),
            None if widest * widest > MANY_MOVES && self.scene.exit_rule() == ExitRule::Area => {
                let network = self.network(replicate_seed(self.scene.walk.seed, 1)).ok()?;
                Some(network.moves_to_an_end(LOOKED_AT))
            }
            None => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_thickness(set: &[&str]) -> Option<Note> {
        Case::built_in(set).unwrap().notes().into_iter().find(|note| note.entry().label == "thickness")
    }

    #[test]
    fn a_real_thickness_is_compared_in_mm_and_to_half_a_layer() {
        let without_unit = Note::ThicknessWithoutUnit { real_mm: 50.0, unit: "D0F".into() };
        assert_eq!(of_thickness(&["filter.thickness_mm=50"]), Some(without_unit));
        let sized = |real: &str| of_thickness(&["filter.d0_mm=2.1", "network.thickness_mm=100", real]);
        let case = Case::built_in(&["filter.d0_mm=2.1", "network.thickness_mm=100"]).unwrap();
        let (layer, modelled) = (case.filter.gradation.d_by_number(50.0).unwrap(), case.thickness().unwrap());
        assert!(modelled != 100.0 && sized("filter.thickness_mm=100").is_none());
        assert!(sized(&format!("filter.thickness_mm={}", modelled - 0.49 * layer)).is_none());
        let thinner = sized(&format!("filter.thickness_mm={}", modelled - 0.51 * layer));
        assert!(matches!(thinner, Some(Note::LayersThicker { .. })), "{thinner:?}");
    }

    #[test]
    fn a_network_is_no_thinner_than_half_a_layer() {
        for thin in ["network.thickness_mm=0.5", "network.thickness_d50f=0.3"] {
            let error = Case::built_in(&["filter.d0_mm=2.1", thin]).err().unwrap().to_string();
            assert!(error.contains("allowed: half a layer or more"), "{error}");
        }
        let thinnest = Case::built_in(&["filter.d0_mm=2.1", "network.thickness_mm=1.5"]).unwrap();
        assert_eq!(thinnest.network.layers, 1);
    }

    fn doubts(set: &[&str]) -> Vec<Note> {
        let small =
            ["network.nx=10", "network.ny=10", "network.nz=12", "base.cu=3", "base.d15f_over_d85b=3.9"];
        Case::built_in(&[&small, set].concat()).unwrap().notes()
    }

    #[track_caller]
    fn has(set: &[&str], id: &str) {
        let notes = doubts(set);
        assert!(notes.iter().any(|note| note.id() == id), "{set:?}: {notes:?}");
    }

    #[test]
    fn less_base_than_eq_2_gives_is_a_doubt() {
        assert_eq!(doubts(&[]), []);
        has(&["base.cap=500"], "capped_base");
        has(&["base.n_base=500"], "few_particles");
        has(&["base.mass_ratio=0.01"], "low_mass_ratio");
        for enough in ["base.n_base=1e9", "base.cap=1e12", "base.mass_ratio=0.1"] {
            assert_eq!(doubts(&[enough]), [], "{enough}");
        }
    }

    #[test]
    fn a_narrow_lattice_is_a_doubt() {
        has(&["network.nx=9"], "narrow_lattice");
        has(&["network.ny=1", "network.connectivity={4=50,8=50}"], "narrow_lattice");
    }

    #[test]
    fn a_base_that_is_all_on_its_way_is_a_doubt_where_water_flows() {
        has(&["walk.exit=flux", "inject_share=0.1"], "all_on_its_way");
        for converged in [["walk.exit=flux", "inject_share=0.05"], ["walk.exit=area", "inject_share=0.1"]] {
            assert_eq!(doubts(&converged), [], "{converged:?}");
        }
    }

    #[test]
    fn a_capped_base_has_the_mass_ratio_of_its_particles() {
        let mass_ratio = |set: &str| {
            let all = ["network.nx=10", "network.ny=10", "network.nz=12", set];
            Case::built_in(&all).unwrap().supply.mass_ratio.unwrap()
        };
        let (capped, given) = (mass_ratio("base.cap=1000"), mass_ratio("base.n_base=1000"));
        assert!((capped / given - 1.0).abs() < 0.01 && capped < 0.04, "{capped} {given}");
    }
}
