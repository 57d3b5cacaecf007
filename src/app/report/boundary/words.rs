//! Numbers and notes of the boundaries as their page writes them.

use crate::outcome::boundary::Boundaries;
use crate::report::quantity::SizeUnit;

/// Unit in which sizes in mm are shown.
pub(super) fn size_unit(all: &Boundaries) -> SizeUnit {
    SizeUnit::of(false, all.inches)
}

pub(super) fn ratio(value: f64) -> String {
    format!("{value:.2}")
}

pub(super) fn between(low: Option<f64>, high: Option<f64>, words: impl Fn(f64) -> String) -> String {
    let end = |value: Option<f64>| value.map_or_else(|| "unknown".to_owned(), &words);
    format!("{} to {}", end(low), end(high))
}

/// The band in brackets, if there are enough networks for one.
pub(super) fn in_band(low: Option<f64>, high: Option<f64>, words: impl Fn(f64) -> String) -> String {
    let is_known = low.is_some() || high.is_some();
    if is_known { format!(" ({})", between(low, high, words)) } else { String::new() }
}
