//! Features that the model omits.

use serde::{Deserialize, Serialize};

/// Something that the model does not contain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ModelLimit {
    /// Flow, gradient and time.
    Hydraulics,
    /// The same, in those of several cases in which no water gives particles their way.
    HydraulicsElsewhere,
    /// Gradient and time, where water gives particles their way.
    Gradient,
    /// The same, in those of several cases in which it does.
    GradientThere,
    /// Bridging of several particles.
    Bridging,
    /// Constrictions that are partly clogged.
    PartialClogging,
    /// A limit to the base that enters.
    Supply,
    /// The class of excessive erosion.
    Excessive,
    /// What soils do besides.
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

    /// Limits that hold with water and without.
    const ALWAYS: &[Self] = Self::ALL.split_at(4).1;
}

/// Features of a walk that other walks omit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Modelled {
    /// Water directs particles.
    pub flow: bool,
    /// Particles arch.
    pub arches: bool,
    /// Blocked constrictions leave openings.
    pub openings: bool,
}

impl Modelled {
    /// Tells if the walk contains the feature that this limit names as omitted.
    fn contains(self, limit: &ModelLimit) -> bool {
        match limit {
            ModelLimit::Bridging => self.arches,
            ModelLimit::PartialClogging => self.openings,
            _ => false,
        }
    }
}

/// Features that the model of such a walk omits; shown next to every verdict.
pub fn leaves_out(modelled: Modelled) -> Vec<ModelLimit> {
    leaves_out_of_all([modelled])
}

/// Features that the models of all these cases omit.
pub fn leaves_out_of_all(cases: impl IntoIterator<Item = Modelled>) -> Vec<ModelLimit> {
    let cases: Vec<Modelled> = cases.into_iter().collect();
    let (with, without): (Vec<Modelled>, Vec<Modelled>) = cases.iter().partition(|case| case.flow);
    let hydraulics: &[ModelLimit] = match (with.is_empty(), without.is_empty()) {
        (true, _) => &[ModelLimit::Hydraulics],
        (false, true) => &[ModelLimit::Gradient],
        (false, false) => &[ModelLimit::GradientThere, ModelLimit::HydraulicsElsewhere],
    };
    let is_in_some = |limit: &&ModelLimit| cases.iter().any(|case| case.contains(limit));
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
