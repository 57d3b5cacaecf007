//! The caution of a broadly graded base, as it was sampled.

use crate::Note;
use voidwalk_core::gradation::{BROAD_CU, Gradation};

/// That a base, as sampled, is so broad that practice looks at its finer part alone. Where D10 is finer than
/// the finest sieve, its Cu is more than with D10 of that size.
pub fn broad_base(sampled: &Gradation) -> Option<Note> {
    match sampled.cu() {
        Some(cu) => (cu >= BROAD_CU).then_some(Note::BroadBase { cu }),
        None => {
            let over_cu = sampled.d(60.0)? / sampled.smallest_mm();
            (over_cu >= BROAD_CU).then_some(Note::BroadBaseAtLeast { over_cu })
        }
    }
}
