//! Observables of a packing under compression, and the state that the protocol keeps between its checks.

/// Observables of one instant.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct Measure {
    /// Volume of the voids by that of the grains.
    pub void_ratio: f64,
    /// Mean contact pressure (kPa).
    pub pressure_kpa: f64,
    /// Mean coordination number `2 N_c / N_p`, over all grains.
    pub coordination: f64,
    /// Mean coordination number among the grains that are held: with at least two contacts (four without
    /// friction) with held grains.
    pub coordination_held: f64,
    /// Rattler fraction: grains that are not held, by all grains.
    pub rattlers: f64,
    /// Kinetic by elastic energy.
    pub kinetic_ratio: f64,
    /// Root mean square unbalanced force of a grain by the mean normal contact force.
    pub unbalanced: f64,
    /// Largest overlap by the smaller diameter of its two grains.
    pub largest_overlap: f64,
}

/// Energies in reduced units (pressure times smallest diameter cubed).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Energy {
    pub kinetic: f64,
    pub elastic: f64,
}

fn is_zero(saved: &f64) -> bool {
    *saved == 0.0
}

/// State that the protocol keeps between its checks.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HoldState {
    /// Step since which all criteria have held.
    pub since: u64,
    /// Number of further steps that the grains' own masses would have taken for this time, if some are moved
    /// as heavier ones.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub saved: f64,
    /// Mean coordination number then.
    pub coordination: f64,
    /// Void ratio then.
    pub void_ratio: f64,
    /// True once the pressure has been near its target; the drag is raised from then on.
    pub braking: bool,
    /// Observables before the friction was switched.
    pub before: Option<Measure>,
}
