//! What is walked of a case besides itself, where its inputs leave open what it is: the other reading of a
//! pan fraction, and the ends of the range of its constriction curve.

use super::curve_range::curve_range;
use super::error::RunError;
use super::replicates::{ReplicateContext, ReplicateResult, other_reading};
use crate::case::Case;
use crate::outcome::record::CurveRange;

/// What was walked besides the case itself.
#[derive(Default)]
pub struct OtherWalks {
    /// Replicates of the other reading of the base's pan fraction; none where there is one reading.
    pub reading: Vec<ReplicateResult>,
    /// What came of the ends of the curve's range; `None` where the curve is no range.
    pub range: Option<CurveRange>,
}

impl OtherWalks {
    /// Walks them, on the random numbers of the case itself.
    ///
    /// # Errors
    /// As [`super::replicates::replicates`].
    pub fn walk(
        case: &Case,
        walked: &[ReplicateResult],
        context: &ReplicateContext,
    ) -> Result<Self, RunError> {
        Ok(Self { reading: other_reading(case, context)?, range: curve_range(case, walked, context)? })
    }
}
