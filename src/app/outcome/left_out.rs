//! Parts of the program that a scene does not need, and features that the model omits.

use serde::{Deserialize, Serialize};
use voidwalk_core::walk::Shortcut;

/// Part of the program that a scene does not need, or a study that is not walked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema), schemars(with = "schema::LeftOut"))]
#[serde(tag = "id", content = "numbers", rename_all = "snake_case")]
pub enum LeftOut {
    /// Lattice, if the voids of a packing are the network.
    Lattice,
    /// All steps before the network, if the network is given.
    BeforeNetwork,
    /// Given curve, if a packing is measured.
    GivenCurve,
    /// Packing, if the curve comes from the library.
    PackingByLibrary,
    /// Packing, if the curve is guessed.
    PackingByGuess,
    /// Packing, if the curve is given.
    PackingByCurve,
    /// Packing, if the packing in this folder has the filter's shape; its sizes are multiplied by the factor.
    PackingOfShape(String, f64),
    /// The second run.
    SecondRun,
    /// Multiples of the number of base particles above the cap, and the cap.
    AmountsAboveCap(Vec<f64>, f64),
    /// Multiples of the number of base particles that repeat a number already walked.
    AmountsTheSame(Vec<f64>),
    /// Other thickness of a network from a file.
    ThicknessOfFile,
    /// Multiple of the thickness, and the reason why it cannot be walked.
    ThicknessRefused(f64, String),
    /// Multiple of the thickness that gives the same number of layers or copies of a packing.
    ThicknessTheSame(f64, u64, LayerKind),
    /// Part that the first run of the first replicate did not need.
    Walk(Shortcut),
}

/// Unit of a network's thickness along the flow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LayerKind {
    /// Layers of a lattice.
    Layer,
    /// Copies of a packing.
    Copy,
}

#[cfg(feature = "cli")]
mod schema {
    /// Part of the program that a scene does not need.
    #[derive(schemars::JsonSchema)]
    #[allow(dead_code)]
    pub(super) struct LeftOut {
        /// Name of the part.
        id: String,
        /// Numbers of the part; absent if it has none.
        #[serde(default, skip_serializing_if = "serde_json::Value::is_null")]
        numbers: serde_json::Value,
    }
}

/// Process that the model omits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ModelLimit {
    /// Flow, gradient and time.
    Hydraulics,
    /// Flow, gradient and time in those of several cases without water.
    HydraulicsElsewhere,
    /// Gradient and time, if water directs particles.
    Gradient,
    /// Gradient and time in those of several cases with water.
    GradientThere,
    /// Bridging of several particles.
    Bridging,
    /// Partly clogged constrictions.
    PartialClogging,
    /// Limited supply of base particles.
    Supply,
    /// The class of excessive erosion.
    Excessive,
    /// Cohesion and further behaviour of soils.
    Cohesion,
}

impl ModelLimit {
    /// All limits.
    pub const ALL: [Self; 9] = [
        Self::Hydraulics,
        Self::HydraulicsElsewhere,
        Self::Gradient,
        Self::GradientThere,
        Self::Bridging,
        Self::PartialClogging,
        Self::Supply,
        Self::Excessive,
        Self::Cohesion,
    ];

    /// Limits with and without water.
    const ALWAYS: &[Self] = Self::ALL.split_at(4).1;
}

/// Features of a walk that other walks omit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Modelled {
    /// Water directs particles.
    pub(crate) flow: bool,
    /// Particles arch.
    pub(crate) arches: bool,
    /// Blocked constrictions leave openings.
    pub(crate) openings: bool,
}

/// Features that the model of such a walk omits; shown beside every verdict.
pub(crate) fn leaves_out(modelled: Modelled) -> Vec<ModelLimit> {
    leaves_out_of_all([modelled])
}

/// Features that the models of all these cases omit.
pub(crate) fn leaves_out_of_all(cases: impl IntoIterator<Item = Modelled>) -> Vec<ModelLimit> {
    let cases: Vec<Modelled> = cases.into_iter().collect();
    let (with, without): (Vec<Modelled>, Vec<Modelled>) = cases.iter().partition(|case| case.flow);
    let hydraulics: &[ModelLimit] = match (with.is_empty(), without.is_empty()) {
        (true, _) => &[ModelLimit::Hydraulics],
        (false, true) => &[ModelLimit::Gradient],
        (false, false) => &[ModelLimit::GradientThere, ModelLimit::HydraulicsElsewhere],
    };
    let is_in_some = |limit: &&ModelLimit| match limit {
        ModelLimit::Bridging => cases.iter().any(|case| case.arches),
        ModelLimit::PartialClogging => cases.iter().any(|case| case.openings),
        _ => false,
    };
    let others = ModelLimit::ALWAYS.iter().filter(|limit| !is_in_some(limit));
    hydraulics.iter().chain(others).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_one_of_several_cases_contains_is_not_left_out_of_all() {
        let sieving = Modelled::default();
        let [arches, openings] =
            [Modelled { arches: true, ..sieving }, Modelled { openings: true, flow: true, ..sieving }];
        let has = |cases: &[Modelled]| {
            let left_out = leaves_out_of_all(cases.iter().copied());
            [ModelLimit::Bridging, ModelLimit::PartialClogging].map(|limit| left_out.contains(&limit))
        };
        assert_eq!([has(&[]), has(&[sieving, sieving])], [[true, true]; 2]);
        assert_eq!([has(&[arches]), has(&[sieving, arches])], [[false, true]; 2]);
        assert_eq!([has(&[openings, sieving]), has(&[openings, arches])], [[true, false], [false, false]]);
        let both = leaves_out_of_all([openings, sieving]);
        assert_eq!(both[..2], [ModelLimit::GradientThere, ModelLimit::HydraulicsElsewhere]);
        assert_eq!(leaves_out(arches)[0], ModelLimit::Hydraulics);
        assert_eq!(leaves_out(sieving).len(), ModelLimit::ALWAYS.len() + 1);
    }
}
