//! The walks that the verdict of a case follows from: its replicates, and the ends of the range of its
//! constriction curve.

use super::curve_range::{begin_ends, curve_range};
use super::error::RunError;
use super::replicates::{ReplicateContext, ReplicateResult, replicates, stopping};
use super::summary::summarise;
use crate::case::Case;
use crate::outcome::record::{CurveRange, RunSummary, Stopping, Verdict};

/// Everything that was walked for the verdict of a case, with the class of it.
pub struct CaseWalks {
    /// The replicates of the case itself.
    pub replicates: Vec<ReplicateResult>,
    /// Their statistics by run.
    pub summary: Vec<RunSummary>,
    /// Result of a rule that adds replicates.
    pub stopping: Option<Stopping>,
    /// The ends of the range of the curve; `None` if the curve has no range.
    pub range: Option<CurveRange>,
    /// The class that all of them support.
    pub verdict: Verdict,
    /// The confidence level (%) at which the rule decided, if it is less than the usual one.
    pub low_level_percent: Option<f64>,
}

impl CaseWalks {
    /// Walks the replicates of a case and, on their random numbers, everything else that its verdict follows
    /// from.
    ///
    /// # Errors
    /// See [`super::replicates::replicates`].
    pub fn walk(case: &Case, context: &ReplicateContext) -> Result<Self, RunError> {
        // Ends do not wait for the last replicate.
        let (walked, begun) = rayon::join(|| replicates(case, context), || begin_ends(case, context));
        let (replicates, begun) = (walked?, begun?);
        let (verdict, summary) = summarise(&replicates);
        let stopping = stopping(case, &replicates);
        let low_level_percent = stopping.as_ref().and_then(|stopping| stopping.less_than_usual(verdict));
        // A verdict that was to be certain is one at the level asked for.
        let verdict = stopping.as_ref().and_then(|stopping| stopping.verdict).unwrap_or(verdict);
        let range = curve_range(case, &replicates, (verdict, &summary), begun, context)?;
        let verdict = range.as_ref().map_or(verdict, CurveRange::whole);
        Ok(Self { replicates, summary, stopping, range, verdict, low_level_percent })
    }
}
