//! D85 of a base, and the base that it belongs to: every face uses the same words.

use crate::outcome::BaseSize;
use voidwalk_practice::quantity::{SizeUnit, length, significant};
use voidwalk_sheets::us_sieve;

/// Grading of a base: as sampled, or the sieve on which it is regraded.
pub fn grading(base: &BaseSize) -> String {
    base.regraded_at_mm
        .map_or_else(|| "as sampled".into(), |at| format!("regraded on {} mm", significant(at)))
}

/// The whole text, as `D85B 1.80 mm, regraded on 4.75 mm (as sampled 12.8 mm)`; if inches are shown, with
/// inches behind each D85 and the name of a US sieve.
pub fn base_size(base: &BaseSize, unit: SizeUnit) -> String {
    let size = |mm: f64| length(mm, unit).to_string();
    let before = base.as_sampled_mm.filter(|_| base.regraded_at_mm.is_some());
    let before = before.map_or(String::new(), |d85| format!(" (as sampled {})", size(d85)));
    let comma = if base.regraded_at_mm.is_some() { "," } else { "" };
    let sieve = base.regraded_at_mm.filter(|_| unit == SizeUnit::MmAndInches);
    let grading = match sieve.and_then(|at| Some((us_sieve(at)?, at))) {
        Some((name, at)) => format!("regraded on {name}, {} mm", significant(at)),
        None => grading(base),
    };
    format!("D85B {}{comma} {grading}{before}", size(base.d85_mm))
}
