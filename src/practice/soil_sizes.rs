//! The sizes of a soil that engineers look for, as a table shows them.

use super::quantity::{SizeUnit, length, significant};
use voidwalk_core::gradation::{FINES_MM, Gradation};
pub use voidwalk_sheets::us_sieve;

/// A row of the table of sizes: its name, and the function that gives its value for a soil.
type SizeRow = (&'static str, fn(&Gradation, SizeUnit) -> Option<String>);

/// The size that `PERCENT` percent are finer than.
fn finer<const PERCENT: u8>(soil: &Gradation, unit: SizeUnit) -> Option<String> {
    soil.d(f64::from(PERCENT)).map(|size| length(size, unit).in_both_units())
}

fn percent_fines(soil: &Gradation, _: SizeUnit) -> Option<String> {
    soil.percent_finer_if_known(FINES_MM).map(|percent| significant(percent).in_digits(3).to_string())
}

/// The sizes that engineers look for.
const SIZES: [SizeRow; 11] = [
    ("D5", finer::<5>),
    ("D10", finer::<10>),
    ("D15", finer::<15>),
    ("D30", finer::<30>),
    ("D50", finer::<50>),
    ("D60", finer::<60>),
    ("D85", finer::<85>),
    ("D90", finer::<90>),
    ("D95", finer::<95>),
    ("Cu", |soil, _| soil.cu().map(|cu| significant(cu).in_digits(3).to_string())),
    ("Cc", |soil, _| soil.cc().map(|cc| significant(cc).in_digits(3).to_string())),
];

/// Rows for sizes that have a unit.
const OF_UNIT: [SizeRow; 2] = [("Fines (%)", percent_fines), ("Group", |soil, _| soil.group())];

/// Sizes of a soil, by name: `None` if the sieves do not give one. Without a unit, fines and group are left
/// out.
pub fn sizes_of(rows: &[[f64; 2]], unit: SizeUnit) -> Vec<(&'static str, Option<String>)> {
    let soil = Gradation::of_rows(rows).ok();
    let of_unit = if unit == SizeUnit::D0f { &[] } else { &OF_UNIT[..] };
    SIZES
        .iter()
        .chain(of_unit)
        .map(|(name, value)| (*name, soil.as_ref().and_then(|soil| value(soil, unit))))
        .collect()
}
