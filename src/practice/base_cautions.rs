//! Caution for a base that is broadly graded as sampled.

use crate::Note;
use voidwalk_core::gradation::{BROAD_CU, Gradation};

/// Cautions that a base is so broad as sampled that practice looks at its finer part alone. If D10 is finer
/// than the finest sieve, its Cu is greater than with D10 at that sieve.
pub fn broad_base(sampled: &Gradation) -> Option<Note> {
    match sampled.cu() {
        Some(cu) => (cu >= BROAD_CU).then_some(Note::BroadBase { cu }),
        None => {
            let over_cu = sampled.d(60.0)? / sampled.smallest_mm();
            (over_cu >= BROAD_CU).then_some(Note::BroadBaseAtLeast { over_cu })
        }
    }
}
