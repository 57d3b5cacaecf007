//! What is walked of a case besides itself, where its inputs leave open what it is: the other readings of a
//! pan fraction, the ends of the range of its constriction curve, and how much coarser the filter could be.

use super::curve_range::{begin_ends, curve_range};
use super::error::RunError;
use super::evidence;
use super::margin::MOST_BYTES;
use super::replicates::{ReplicateContext, ReplicateResult, other_readings, replicates_and};
use crate::case::Case;
use crate::outcome::record::{CurveRange, Margin};

/// What was walked besides the case itself.
#[derive(Default)]
pub struct OtherWalks {
    /// Replicates of each other reading of the base's pan fraction.
    pub readings: Vec<Vec<ReplicateResult>>,
    /// What came of the ends of the curve's range; `None` where the curve is no range.
    pub range: Option<CurveRange>,
    /// How much coarser the filter could be; `None` where that is not asked for.
    pub margin: Option<Margin>,
}

impl OtherWalks {
    /// Walks the replicates of the case itself and, on their random numbers, everything else that its verdict
    /// follows from.
    ///
    /// # Errors
    /// As [`super::replicates::replicates_and`].
    pub fn with_case(
        case: &Case,
        context: &ReplicateContext,
    ) -> Result<(Vec<ReplicateResult>, Self), RunError> {
        // Ends and the margin do not wait for the last replicate.
        let margin = |own: &ReplicateResult| evidence::walked(case, own, context);
        let (walked, begun) =
            rayon::join(|| replicates_and(case, context, MOST_BYTES, margin), || begin_ends(case, context));
        let ((walked, margin), begun) = (walked?, begun?);
        let other = Self {
            readings: other_readings(case, context)?,
            range: curve_range(case, &walked, begun, context)?,
            margin,
        };
        Ok((walked, other))
    }
}
