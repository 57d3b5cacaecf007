//! Reasons why no flow through a network is known.

use super::system::NotConverged;

/// Reason why no flow is known.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FlowError {
    /// Conductances so far apart that pressures cannot be resolved.
    #[error(
        "the flow through the network cannot be solved: after {rounds} rounds the residual is \
         still {residual:.1e} \
         of the inflow; constrictions whose conductances lie many orders apart do that"
    )]
    NotConverged {
        /// Rounds.
        rounds: usize,
        /// Residual over inflow.
        residual: f64,
    },
    /// Conductances so far apart that the flow is lost in their rounding.
    #[error(
        "the flow through the network cannot be told: as close as rounding lets pressures come, voids take \
         in {off:.1e} of what passes the network more or less than they let out. Conductances lie too many \
         orders apart: leave out constrictions that conduct many orders more than the ways through, blind \
         ones too, since a way in that nothing can block conducts as constrictions do on average"
    )]
    Unresolved {
        /// Sum of the imbalances of all voids, over the flow through the filter.
        off: f64,
    },
}

impl From<NotConverged> for FlowError {
    fn from(NotConverged { rounds, residual }: NotConverged) -> Self {
        Self::NotConverged { rounds, residual }
    }
}
