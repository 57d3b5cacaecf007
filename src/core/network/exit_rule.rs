//! Rules by which a particle chooses among the open exits of its void.

use crate::schema::Leaf;
use serde::{Deserialize, Serialize};

/// Rule by which a particle chooses among the open exits of its void.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ExitRule {
    /// In proportion to area, on a network whose constrictions have a direction of their own (the paper's).
    #[default]
    Area,
    /// In proportion to the flow of water, which leads down the pressure.
    Flux,
    /// In proportion to area, among the exits that water leaves by.
    AreaAlongFlow,
    /// In proportion to area, among the exits that lead to a void further along the axis of flow: for
    /// comparison, since voids without one hold back particles that water would carry on.
    Height,
}

impl Leaf for ExitRule {}

impl ExitRule {
    /// Every rule, in the order in which a user is told of them.
    pub const ALL: [Self; 4] = [Self::Area, Self::Flux, Self::AreaAlongFlow, Self::Height];

    /// Name of the rule in a scene.
    pub fn name(self) -> &'static str {
        match self {
            Self::Area => "area",
            Self::Flux => "flux",
            Self::AreaAlongFlow => "area-along-flow",
            Self::Height => "height",
        }
    }

    /// Tells if the rule needs to know where water flows.
    pub fn needs_flow(self) -> bool {
        matches!(self, Self::Flux | Self::AreaAlongFlow)
    }

    /// Weight of an exit of this area (the square of its diameter), with `flux` out through it, or in if
    /// negative; fluxes up to `least` count as zero.
    pub(super) fn weight(self, area: f64, flux: f64, least: f64) -> f64 {
        // The direction of water cannot be foreseen: chosen without a branch.
        match self {
            Self::Area | Self::Height => area,
            Self::Flux if flux > least => flux,
            Self::Flux => 0.0,
            Self::AreaAlongFlow => area * f64::from(u8::from(flux > least)),
        }
    }
}
