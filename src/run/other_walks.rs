//! What is walked of a case besides itself, where its inputs leave open what it is: the ends of the range of
//! its constriction curve.

use super::curve_range::{begin_ends, curve_range};
use super::error::RunError;
use super::replicates::{ReplicateContext, ReplicateResult, replicates};
use crate::case::Case;
use crate::outcome::record::{CurveRange, Verdict};

/// What was walked besides the case itself.
#[derive(Default)]
pub struct OtherWalks {
    /// What came of the ends of the curve's range; `None` where the curve is no range.
    pub range: Option<CurveRange>,
}

impl OtherWalks {
    /// Walks the replicates of the case itself and, on their random numbers, everything else that its verdict
    /// follows from.
    ///
    /// # Errors
    /// As [`super::replicates::replicates`].
    pub fn with_case(
        case: &Case,
        context: &ReplicateContext,
    ) -> Result<(Vec<ReplicateResult>, Self), RunError> {
        // Ends do not wait for the last replicate.
        let (walked, begun) = rayon::join(|| replicates(case, context), || begin_ends(case, context));
        let (walked, begun) = (walked?, begun?);
        let other = Self { range: curve_range(case, &walked, begun, context)? };
        Ok((walked, other))
    }

    /// The class of a case whose own replicates have this one.
    pub fn verdict(&self, own: Verdict) -> Verdict {
        self.range.as_ref().map_or(own, CurveRange::whole)
    }
}
