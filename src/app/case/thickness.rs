//! A case with a filter of another thickness.

use super::{Case, CaseError};
use crate::outcome::left_out::{LayerKind, LeftOut};
use crate::scene::NetworkSource;

/// Multiples of the thickness that are walked by default.
const HALF_AND_TWICE: [f64; 2] = [0.5, 2.0];

impl Case {
    /// Multiples of the thickness that the study walks: those asked for, else half and twice if the study of
    /// the number of base particles is walked. Leaves out all for a network from a file, whose thickness is
    /// fixed, those that round to the layers or copies of the case itself, and repeated thicknesses.
    pub fn thickness_factors(&self) -> Vec<f64> {
        let mut known = vec![self.thickness_parts()];
        let mut is_other = |factor: &f64| {
            let parts = times(known[0], *factor);
            let is_new = !known.contains(&parts);
            known.push(parts);
            is_new
        };
        self.thickness_wanted().into_iter().filter(|factor| is_other(factor)).collect()
    }

    /// Multiples that are asked for but not walked, each with the reason.
    pub(super) fn thickness_not_walked(&self) -> Vec<LeftOut> {
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

    /// Number of parts of its network along the flow: copies of a packing, or layers.
    fn thickness_parts(&self) -> u64 {
        self.network.copies().map_or(self.network.layers, u64::from)
    }

    /// Multiplies the thickness of the filter, to the nearest layer (of a lattice) or copy (of a packing);
    /// Eq. (2) multiplies the base likewise, up to its cap, and a number that was given stays.
    ///
    /// # Errors
    /// More constrictions than 32 bits can number, less than one base particle by Eq. (2).
    pub fn of_thickness(&self, factor: f64) -> Result<Self, CaseError> {
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
        let other = Self::with_graph(scene, packed, graph, inputs.clone())?;
        Ok(Self { inputs, memory: self.memory, placement: self.placement.clone(), ..other })
    }
}

fn times(parts: u64, factor: f64) -> u64 {
    ((parts as f64 * factor).round() as u64).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    fn case(changes: &[&str]) -> Case {
        let changes: Vec<String> = changes.iter().map(|c| c.to_string()).collect();
        Case::new(Scene::built_in(&changes).unwrap()).unwrap()
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
