//! Checks of the walk itself: tests of the largest passing particle, and the paper's own network.

use super::rule::{Judged, RuleInputs};
use crate::RuleNote;

/// Largest passing particle over D15F by Kenney et al.
const KENNEY: f64 = 0.2;

/// Fraction of Kenney's ratio below which the walk does not resemble those tests.
const FAR_FINER: f64 = 0.1;

/// Largest particle that passes, by Kenney et al.
pub fn largest_passing(inputs: &RuleInputs) -> Judged {
    let value = inputs.largest_eroded_over_d15f;
    let judged = Judged { applies: value.is_some(), ..Judged::of(value, Some(KENNEY)) };
    // If all of the base is that fine, its size says nothing about the openings.
    let is_far = |share: f64| share < FAR_FINER * KENNEY;
    let coarsest = inputs.d15f().map(|d15f| inputs.walked_base.largest_mm() / d15f);
    let is_held_back = coarsest.is_some_and(|share| !is_far(share));
    match value {
        Some(share) if is_far(share) && is_held_back => {
            judged.noted(RuleNote::ChecksWalk).noted(RuleNote::FarFinerThanTests(KENNEY / share))
        }
        Some(_) => judged.noted(RuleNote::ChecksWalk),
        None => judged.lacking(RuleNote::NeedsErosion),
    }
}

/// The paper's boundary between no erosion and some erosion.
pub fn paper_no_erosion(inputs: &RuleInputs) -> Judged {
    ratio(inputs, 85.0, 5.0)
}

/// The paper's boundary between some erosion and continuing erosion.
pub fn paper_continuing(inputs: &RuleInputs) -> Judged {
    ratio(inputs, 95.0, 4.7)
}

/// D15F over a size of the walked base.
fn ratio(inputs: &RuleInputs, percent: f64, limit: f64) -> Judged {
    let value = inputs.d15f().zip(inputs.walked_base.d(percent)).map(|(d15f, of)| d15f / of);
    Judged::of(value, Some(limit)).noted(RuleNote::ResultOfModel)
}
