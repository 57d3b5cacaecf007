//! Case with one thing changed: its constriction curve, base, sizes, number of base particles or
//! thickness; and the changes that are not walked.
//!
//! A walk uses only sizes as multiples of the finest filter grain. A filter s times as large is therefore
//! walked with a base 1/s times as large, as in a search for boundaries: its network remains identical to
//! the bit, and so does every random number that does not depend on the base.

use super::files::Files;
use super::{Case, CaseBase, CaseError, CaseNetwork, CaseSupply, Input};
use crate::outcome::left_out::{LayerKind, LeftOut};
use crate::scene::{Amount, NetworkSource, Scene};
use voidwalk_core::constrictions::Curve;
use voidwalk_core::gradation::Gradation;
use voidwalk_core::network::Network;

/// Multiples of the thickness that are walked by default.
const HALF_AND_TWICE: [f64; 2] = [0.5, 2.0];

/// Base as a scene states it, with its sizes unchanged.
#[derive(Clone, Debug)]
pub(crate) struct StatedBase {
    pub(crate) scene: Scene,
    pub(crate) base: CaseBase,
    pub(crate) inputs: Vec<Input>,
}

impl Case {
    /// Replaces only the constriction curve: base and amount of base are unchanged.
    pub(crate) fn with_curve(&self, curve: Curve) -> Self {
        let mut case = self.clone();
        case.filter.finest_mm = self.filter.finest_mm.min(curve.smallest());
        case.filter.curve = curve;
        case.filter.curve_ends.clear();
        case
    }

    /// Reads the base of another scene with this case's filter. Errors: a file is refused.
    pub(crate) fn base_of(&self, scene: &Scene) -> Result<StatedBase, CaseError> {
        let mut files = Files::default();
        let base = CaseBase::read(scene, &self.filter, &mut files)?;
        if scene.is_guarded && scene.filter.sieve.is_some() {
            base.mistake(scene, &self.filter.gradation, false)?;
        }
        Ok(StatedBase { scene: scene.clone(), base, inputs: files.inputs })
    }

    /// Replaces the base by one with this gradation, in this filter's unit. Filter and network are unchanged,
    /// but a lattice gets the number of layers in `layers`. Errors: the base cannot be walked: Eq. (2) gives
    /// too few or too many particles, sizes are out of range, or there are more constrictions than 32 bits
    /// can number.
    pub(crate) fn with_base(&self, base: Gradation, layers: Option<u64>) -> Result<Self, CaseError> {
        let mut case = self.clone();
        if let (Some(layers), NetworkSource::Cubic([nx, ny, _])) = (layers, self.scene.network.source()) {
            let shape = [nx, ny, u32::try_from(layers).unwrap_or(u32::MAX)];
            case.network = CaseNetwork::of_lattice(shape)?;
            case.scene.network.set_layers(layers);
        }
        case.supply = CaseSupply::new(&case.scene, &case.filter, case.network.voids, &base, false)?;
        case.base = CaseBase { gradation: base, regraded_from: None };
        // No other number or thickness is studied.
        case.scene.record.sensitivity.clear();
        case.scene.record.thickness = Some(Vec::new());
        Ok(case)
    }

    /// Multiplies the filter of this case by `factor`, with a stated base at its own size; not for walks, but
    /// for rules in millimetres. Errors: sizes are out of range.
    pub(crate) fn enlarged(&self, factor: f64, base: &StatedBase) -> Result<Self, CaseError> {
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

    /// True if a network of another base with the same filter has as many layers as this case's, so that
    /// both can share it.
    pub(crate) fn has_layers_of(&self, network: &Network) -> bool {
        network.layers() as u64 == self.network.layers
    }

    /// Multiples of N_base that the sensitivity study walks: those requested, except those above a cap
    /// set by the user, those that give the case's own number, and repeated numbers.
    pub(crate) fn sensitivity_factors(&self) -> Vec<f64> {
        let (cap, n_base) = (self.cap(), self.supply.n_base);
        let mut factors = with_new_numbers(self.scene.record.sensitivity.clone(), n_base);
        factors.retain(|factor| factor * n_base as f64 <= cap);
        factors
    }

    /// Number of base particles times this factor, at least one.
    pub(crate) fn times_base(&self, factor: f64) -> u64 {
        times(self.supply.n_base, factor)
    }

    /// Number of base particles for this multiple of the grains per void, up to a cap set by the user;
    /// unchanged if the user states the number.
    pub(crate) fn base_by_grains(&self, times_grains: f64) -> u64 {
        let is_by_mass = matches!(self.scene.base.amount(), Amount::MassRatio(..));
        let of_eq2 = self.supply.n_base_eq2.filter(|_| is_by_mass);
        of_eq2
            .map_or(self.supply.n_base, |n| (n as f64 * times_grains).round().min(self.cap()).max(1.0) as u64)
    }

    fn cap(&self) -> f64 {
        match self.scene.base.amount() {
            Amount::MassRatio(_, Some(cap)) => cap as f64,
            _ => f64::INFINITY,
        }
    }

    /// Multiples of the thickness that the study walks: those requested, or else half and twice if the
    /// number of base particles is studied. Excludes all for a network from a file, whose thickness is
    /// fixed, those that round to the case's own layers or copies, and repeated thicknesses.
    pub(crate) fn thickness_factors(&self) -> Vec<f64> {
        with_new_numbers(self.thickness_wanted(), self.thickness_parts())
    }

    /// Multiples that are requested but not walked, each with the reason.
    fn thickness_not_walked(&self) -> Vec<LeftOut> {
        if matches!(self.scene.network.source(), NetworkSource::File(_)) {
            let asked = self.scene.record.thickness.as_ref().is_some_and(|factors| !factors.is_empty());
            return if asked { vec![LeftOut::ThicknessOfFile] } else { Vec::new() };
        }
        let parts = self.thickness_parts();
        let kind = if self.network.copies().is_some() { LayerKind::Copy } else { LayerKind::Layer };
        let same = |factor: &f64| times(parts, *factor) == parts;
        let the_same = |factor| LeftOut::ThicknessTheSame(factor, parts, kind);
        self.thickness_wanted().into_iter().filter(same).map(the_same).collect()
    }

    fn thickness_wanted(&self) -> Vec<f64> {
        let record = &self.scene.record;
        match (self.scene.network.source(), &record.thickness) {
            (NetworkSource::File(_), _) => Vec::new(),
            (_, Some(factors)) => factors.clone(),
            (_, None) if record.sensitivity.is_empty() => Vec::new(),
            (_, None) => HALF_AND_TWICE.to_vec(),
        }
    }

    /// Number of units of its network along the flow: copies of a packing, or layers.
    fn thickness_parts(&self) -> u64 {
        self.network.copies().map_or(self.network.layers, u64::from)
    }

    /// Multiplies the thickness of the filter, to the nearest layer (of a lattice) or copy (of a packing);
    /// Eq. (2) multiplies the base likewise, up to its cap, and a given number is unchanged. Errors: there
    /// are more constrictions than 32 bits can number, or less than one base particle by Eq. (2).
    pub(crate) fn of_thickness(&self, factor: f64) -> Result<Self, CaseError> {
        let parts = times(self.thickness_parts(), factor);
        let mut scene = self.scene.clone();
        scene.record.sensitivity.clear();
        scene.record.thickness = Some(Vec::new());
        match self.network.copies() {
            Some(_) => scene.network.set_copies(parts),
            None => scene.network.set_layers(parts),
        }
        let graph = self.network.packing().map(|packing| packing.graph.clone());
        let (packed, inputs) = (self.filter.packed.clone(), self.inputs.clone());
        let other = Self::with_filter(scene, packed, graph, inputs.clone())?;
        Ok(Self { inputs, memory: self.memory, placement: self.placement.clone(), ..other })
    }

    /// Parts of the program that this scene does not need.
    pub(crate) fn left_out(&self) -> Vec<LeftOut> {
        let filter = &self.filter;
        let mut left_out = vec![match &self.network.fixed {
            Some(fixed) if fixed.packing.is_some() => LeftOut::Lattice,
            Some(_) => LeftOut::BeforeNetwork,
            None if filter.packed.is_some() => LeftOut::GivenCurve,
            None if filter.library.is_some() => LeftOut::PackingByLibrary,
            None if filter.guessed_density.is_some() => LeftOut::PackingByGuess,
            None => LeftOut::PackingByCurve,
        }];
        if let Some(other) = filter.packed.as_ref().and_then(|packed| packed.same_shape.as_ref()) {
            left_out.push(LeftOut::PackingOfShape(other.folder.clone(), other.factor));
        }
        if self.scene.walk.runs == 1 {
            left_out.push(LeftOut::SecondRun);
        }
        let (walked, cap) = (self.sensitivity_factors(), self.cap());
        let not_walked =
            self.scene.record.sensitivity.iter().copied().filter(|factor| !walked.contains(factor));
        let (above, same): (Vec<f64>, Vec<f64>) =
            not_walked.partition(|factor| *factor * self.supply.n_base as f64 > cap);
        if !above.is_empty() {
            left_out.push(LeftOut::AmountsAboveCap(above, cap));
        }
        if !same.is_empty() {
            left_out.push(LeftOut::AmountsTheSame(same));
        }
        for factor in self.thickness_factors() {
            if let Err(error) = self.of_thickness(factor) {
                left_out.push(LeftOut::ThicknessRefused(factor, error.to_string()));
            }
        }
        left_out.extend(self.thickness_not_walked());
        left_out
    }
}

/// Number times this factor, at least one.
fn times(number: u64, factor: f64) -> u64 {
    ((number as f64 * factor).round() as u64).max(1)
}

/// Factors that give a number other than `number` and other than the previous ones.
fn with_new_numbers(factors: Vec<f64>, number: u64) -> Vec<f64> {
    let mut known = vec![number];
    let is_new = |factor: &f64| {
        let other = times(number, *factor);
        let is_new = !known.contains(&other);
        known.push(other);
        is_new
    };
    factors.into_iter().filter(is_new).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::words::left_out::left_out;

    fn case(set: &[&str]) -> Case {
        Case::built_in(set).unwrap()
    }

    #[test]
    fn a_base_that_is_scaled_is_the_base_that_a_scene_states_in_that_size() {
        let given = case(&["base.cu=3"]);
        for ratio in [4.0, 6.5] {
            let wanted = case(&["base.cu=3", &format!("base.d15f_over_d85b={ratio}")]);
            let base = given.base_of(&wanted.scene).unwrap().base.gradation;
            let made = given.with_base(base, None).unwrap();
            assert_eq!(made.base.gradation, wanted.base.gradation);
            let made_of = |case: &Case| (case.supply.n_base, case.network.voids, case.network.layers);
            assert_eq!(made_of(&made), made_of(&wanted));
        }
    }

    #[test]
    fn more_layers_take_more_base() {
        let case = case(&[]);
        let thick = case.with_base(case.base.gradation.clone(), Some(120)).unwrap();
        assert_eq!(thick.network.layers, 120);
        assert!(thick.supply.n_base.abs_diff(2 * case.supply.n_base) <= 1);
        let kept = case.network(7).unwrap();
        assert!(case.has_layers_of(&kept) && !thick.has_layers_of(&kept));
        assert_eq!(thick.network(7).unwrap().layers(), 120);
    }

    /// A pan fraction that is walked blocks nothing at either end of a guess, so a walk there follows
    /// numbers and needs no column of billions of particles.
    #[test]
    fn a_passive_pan_fraction_is_passive_at_the_ends_of_a_guess_too() {
        let folder = tempfile::tempdir().unwrap();
        let (base, filter) = (folder.path().join("base.csv"), folder.path().join("filter.csv"));
        std::fs::write(&base, "opening_mm,percent_finer\n19,100\n9.5,76\n4.75,27.2\n2.36,16.4\n").unwrap();
        let sieves = "19,100\n9.5,77.5\n4.75,61.3\n1.18,52\n0.3,15.7\n0.075,8\n0.02,6.5\n";
        std::fs::write(&filter, format!("opening_mm,percent_finer\n{sieves}")).unwrap();
        let path = |name: &str, file: &std::path::Path| format!("{name}.sieve={}", file.display());
        let (base, filter) = (path("base", &base), path("filter", &filter));
        let set = [&*base, &*filter, "filter.estimate=0.5", "base.n_base=50", "network.nx=4"];
        for arches in [&[][..], &["walk.arching=marin-2018", "walk.concentration=0.1"]] {
            let case = case(&[&set, arches].concat());
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

    /// The coarse end of the library has 6 % fewer grains per void near one of its shapes.
    #[test]
    fn the_base_of_an_end_follows_its_grains_unless_they_are_stated_and_keeps_the_cap() {
        let numbers = |set: &[&str]| {
            let case = case(&[&["filter.library=loose", "filter.cu=1.5", "filter.d0_mm=1"], set].concat());
            (case.base_by_grains(case.filter.curve_ends[0].times_grains), case.supply.n_base)
        };
        let (of_end, n_base) = numbers(&[]);
        assert_eq!(of_end, (n_base as f64 / 1.06).round() as u64);
        // Caps between the base of the end and the base of the case, and below both.
        for (cap, expected) in [(n_base - 1, of_end), (of_end / 2, of_end / 2)] {
            assert_eq!(numbers(&[&format!("base.cap={cap}")]), (expected, cap));
        }
        let (of_end, n_base) = numbers(&["filter.grains_per_void=0.5"]);
        assert_eq!(of_end, n_base);
        assert_eq!(numbers(&["base.n_base=1000"]), (1000, 1000));
    }

    #[test]
    fn what_is_not_walked_is_said_with_its_reason() {
        let studies = |set: &[&str]| {
            let case = case(set);
            let left_out = case.left_out().iter().map(|part| left_out(part, "mm")).collect::<Vec<_>>();
            (case.sensitivity_factors(), left_out)
        };
        let (factors, left_out) = studies(&["base.cap=1000"]);
        assert_eq!(factors, [0.25, 0.5]);
        let expected =
            "sensitivity to the number of base particles, x2, x4: more than base.cap, 1000, allows";
        assert!(left_out.iter().any(|line| line == expected), "{left_out:?}");
        let (factors, left_out) = studies(&["record.sensitivity=[1, 2, 2.0, 0.5]", "base.n_base=1000"]);
        assert_eq!(factors, [2.0, 0.5]);
        assert!(left_out.iter().any(|line| line.contains("particles, x1: the same number")), "{left_out:?}");
        let (factors, left_out) = studies(&["base.n_base=1000"]);
        assert_eq!(factors.len(), 4);
        assert!(
            !left_out.iter().any(|line| line.starts_with("sensitivity to the number of base particles")),
            "{left_out:?}"
        );
    }

    #[test]
    fn twice_the_thickness_is_the_case_of_twice_the_layers() {
        let thick = case(&["network.nz=20"]).of_thickness(2.0).unwrap();
        let asked = case(&["network.nz=40"]);
        let numbers = |case: &Case| (case.network.voids, case.supply.n_base, case.supply.n_base_eq2);
        assert_eq!((thick.network.layers, numbers(&thick)), (40, numbers(&asked)));
        assert_eq!(thick.network(5).unwrap().fingerprint(), asked.network(5).unwrap().fingerprint());
        assert!(case(&["network.nz=20", "record.thickness=[1.01]"]).thickness_factors().is_empty());
        let unsaid = case(&["network.nz=20", "record.thickness=[1.01, 2]"]);
        let same = LeftOut::ThicknessTheSame(1.01, 20, LayerKind::Layer);
        assert_eq!(unsaid.left_out().iter().filter(|part| **part == same).count(), 1);
        assert_eq!(unsaid.thickness_factors(), [2.0]);
        let given = case(&["base.n_base=1000"]).of_thickness(0.5).unwrap();
        assert_eq!((given.supply.n_base, given.network.layers), (1000, 30));
        let capped = case(&["base.cap=5000"]).of_thickness(2.0).unwrap();
        assert_eq!((capped.supply.n_base, capped.supply.capped), (5000, true));
    }

    #[test]
    fn another_thickness_reads_no_file_again() {
        let folder = tempfile::tempdir().unwrap();
        let sheet = folder.path().join("base.csv");
        std::fs::write(&sheet, "size_mm,percent\n0.1,0\n0.3,100\n").unwrap();
        let case = case(&[&format!("base.sieve={}", sheet.display()), "filter.d0_mm=1.9"]);
        std::fs::remove_file(&sheet).unwrap();
        let thick = case.of_thickness(2.0).unwrap();
        assert_eq!(thick.input_files(), case.input_files());
        assert_eq!(thick.base.gradation, case.base.gradation);
    }

    #[test]
    fn what_is_asked_for_is_walked_and_by_default_half_and_twice() {
        assert_eq!(case(&[]).thickness_factors(), HALF_AND_TWICE);
        assert!(case(&["record.sensitivity=[]"]).thickness_factors().is_empty());
        assert_eq!(case(&["record.sensitivity=[]", "record.thickness=[3]"]).thickness_factors(), [3.0]);
        assert!(case(&["record.thickness=[]"]).thickness_factors().is_empty());
    }
}
