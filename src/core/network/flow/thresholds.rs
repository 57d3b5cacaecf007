//! Every number that decides when a flow counts as solved, and what each protects from.

/// The residual of conjugate gradients, as part of what flows in. Protects from pressures that are not those
/// of the network: fluxes then differ in the tenth digit.
pub(super) const CONVERGED: f64 = 1e-10;

/// The residual where fluxes are small beside what flows in: what rounding lets it come to.
pub(super) const CLOSEST: f64 = f64::EPSILON / 4.0;

/// What sums of each row may lose in rounding, as part of the flow through its known pressures.
pub(super) const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The residual that is taken, as part of what flows in, where rounding lets it come no closer.
pub(super) const BEST_OF_ROUNDING: f64 = 1e-6;

/// The mean flux of an inlet over what the residual may stand for, below which pressures are looked for more
/// closely, and by elimination at last. Protects from fluxes of a filter that clogs which are mostly
/// residual.
pub(super) const CLEAR: f64 = 1e4;

/// The same where neither is possible: below it the flow is refused. Protects from a filter that seems to
/// hold because no flux tells where particles go.
pub(super) const RESOLVED: f64 = 30.0;

/// Flow that fluxes may be wrong by, over the most that the network was found to conduct; beyond it the flow
/// is refused.
pub(super) const KNOWN: f64 = 5e-7;

/// The same over what passes now, for a reader of every flux.
pub(super) const CLOSELY: f64 = 1e-8;

/// A flux below this part of what an inlet passes on average counts as none, unless it is the largest out of
/// its void. Protects from ways that only the residual opens.
pub(super) const NO_FLUX: f64 = 1e-8;

/// Flow that a flux found by elimination may be wrong by, over what passes.
pub(super) const ELIMINATED: f64 = 1e-12;

/// Rounds of conjugate gradients, for each layer and a hundred besides, after which the flow is refused or
/// found by elimination. Protects from a search without end.
pub(super) const ROUNDS: usize = 100;

/// The most rounds with a factor of another system: so many, or so many times those that its own system took,
/// whichever is more. Protects from a factor that no longer fits.
pub(super) const ROUNDS_OF_ANOTHER: [usize; 2] = [60, 3];

/// A factor is kept until more than one in so many exits have closed: so it serves where little closes from
/// one solution to the next, and costs fewer rounds then than making another would.
pub(super) const KEPT_UNTIL: usize = 100;

/// Pairs of neighbours that an elimination looks at before it is given up: some seconds.
pub(super) const PAIRS: usize = 50_000_000;
