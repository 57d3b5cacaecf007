//! What the walk itself is checked by: tests of the largest passing particle, and the paper's own network.

use super::rule::{Judged, RuleInputs};
use crate::outcome::record::RuleNote;

/// Kenney et al.: the largest particle that passes.
pub fn largest_passing(inputs: &RuleInputs) -> Judged {
    let value = inputs.largest_eroded_over_d15f;
    let judged = Judged { applies: value.is_some(), ..Judged::of(value, Some(0.2)) };
    match value {
        Some(_) => judged.noted(RuleNote::ChecksWalk),
        None => judged.lacking(RuleNote::NeedsErosion),
    }
}

/// The paper's network: no erosion rather than some.
pub fn paper_no_erosion(inputs: &RuleInputs) -> Judged {
    ratio(inputs, 85.0, 5.0)
}

/// The paper's network: some erosion rather than continuing.
pub fn paper_continuing(inputs: &RuleInputs) -> Judged {
    ratio(inputs, 95.0, 4.7)
}

/// D15F over a size of the base that is walked.
fn ratio(inputs: &RuleInputs, percent: f64, limit: f64) -> Judged {
    let value = inputs.d15f().zip(inputs.walked_base.d(percent)).map(|(d15f, of)| d15f / of);
    Judged::of(value, Some(limit)).noted(RuleNote::ResultOfModel)
}
