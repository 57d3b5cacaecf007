//! What the model does not contain, as values. Their words are in `verdict`.

use crate::network::ExitRule;

/// Something that the model does not contain.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(test, derive(schemars::JsonSchema), schemars(with = "String"))]
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
    /// The words of a file of an earlier version.
    Said(String),
}

impl ModelLimit {
    /// All but what files say.
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

    /// What holds whether or not water gives particles their way.
    const ALWAYS: &[Self] = Self::ALL.split_at(4).1;
}

/// What the model does not contain where particles choose by this rule; shown next to every verdict.
pub fn leaves_out(rule: ExitRule) -> Vec<ModelLimit> {
    leaves_out_of_all([rule.needs_flow()])
}

/// What the model does not contain in any of several cases, each with water that gives particles their way or
/// without.
pub fn leaves_out_of_all(with_flow: impl IntoIterator<Item = bool>) -> Vec<ModelLimit> {
    let (with, without): (Vec<bool>, Vec<bool>) = with_flow.into_iter().partition(|with| *with);
    let hydraulics: &[ModelLimit] = match (with.is_empty(), without.is_empty()) {
        (true, _) => &[ModelLimit::Hydraulics],
        (false, true) => &[ModelLimit::Gradient],
        (false, false) => &[ModelLimit::GradientThere, ModelLimit::HydraulicsElsewhere],
    };
    [hydraulics, ModelLimit::ALWAYS].concat()
}
