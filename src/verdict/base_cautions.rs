//! The caution of a broadly graded base, as it was sampled.

use super::entry::Finding;
use super::finding;
use crate::gradation::{BROAD_CU, Gradation};
use crate::outcome::numbers::{rounded_down, significant};

/// That a base, as sampled, is so broad that practice looks at its finer part alone. Where D10 is finer than
/// the finest sieve, its Cu is more than with D10 of that size.
pub(super) fn broad_base(sampled: &Gradation) -> Option<Finding> {
    let cu = match sampled.cu() {
        Some(cu) => (cu >= BROAD_CU).then(|| significant(cu))?,
        None => {
            let least = sampled.d(60.0)? / sampled.smallest_mm();
            (least >= BROAD_CU).then(|| format!("more than {}", rounded_down(least)))?
        }
    };
    Some(finding::broad_base(&cu))
}
