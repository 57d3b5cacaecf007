//! Quantities in markup.

use std::fmt::Display;

use super::quantity::whole;

/// A value, or words for a missing one.
pub(super) fn known<T, R: Display>(value: Option<T>, words: impl FnOnce(T) -> R) -> String {
    value.map_or_else(|| "not given".to_owned(), |value| words(value).to_string())
}

/// Several counts in a row.
pub(super) fn counts<const N: usize>(numbers: [u64; N]) -> String {
    numbers.map(|number| whole(number).to_string()).join(", ")
}
