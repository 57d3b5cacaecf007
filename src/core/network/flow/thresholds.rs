//! Every number that decides when a flow counts as solved, and the error from which each protects.

/// Residual of conjugate gradients, as part of the inflow. Protects from pressures that are not the
/// network's: fluxes then differ in the tenth digit.
pub(super) const CONVERGED: f64 = 1e-10;

/// Residual where fluxes are small beside the inflow: the least that rounding allows.
pub(super) const CLOSEST: f64 = f64::EPSILON / 4.0;

/// Possible loss of the sums of each row in rounding, as part of the flow through its known pressures.
pub(super) const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Residual that is taken, as part of the inflow, if rounding lets it come no closer.
pub(super) const BEST_OF_ROUNDING: f64 = 1e-6;

/// Mean flux of an inlet over the flux that the residual may account for, below which pressures are looked
/// for more closely, and finally by elimination. Protects from fluxes of a clogging filter that are mostly
/// residual.
pub(super) const CLEAR: f64 = 1e4;

/// Least such ratio where neither is possible: below it the flow is refused. Protects from a filter that
/// seems to hold because no flux tells where particles go.
pub(super) const RESOLVED: f64 = 30.0;

/// Possible error of fluxes, over the largest conductance found for the network; beyond it the flow is
/// refused.
pub(super) const KNOWN: f64 = 5e-7;

/// Possible error of fluxes, over the present flow, for a reader of every flux.
pub(super) const CLOSELY: f64 = 1e-8;

/// Fluxes below this fraction of the mean inlet flux count as zero, except the largest flux out of a void.
/// Protects from ways that only the residual opens.
pub(super) const NO_FLUX: f64 = 1e-8;

/// Possible error of a flux found by elimination, over the flow through the filter.
pub(super) const ELIMINATED: f64 = 1e-12;

/// Rounds of conjugate gradients, for each layer and a hundred besides, after which the flow is refused or
/// found by elimination. Protects from a search without end.
pub(super) const ROUNDS: usize = 100;

/// Most rounds with a factor of another system: this number, or this multiple of the rounds that its own
/// system took, whichever is more. Protects from a factor that no longer fits.
pub(super) const ROUNDS_OF_ANOTHER: [usize; 2] = [60, 3];

/// A factor is kept until more than one in this many exits have closed: so it serves while little closes from
/// one solution to the next, and costs fewer rounds then than making another would.
pub(super) const KEPT_UNTIL: usize = 100;

/// Pairs of neighbours that an elimination looks at before it is given up: some seconds.
pub(super) const PAIRS: usize = 50_000_000;
