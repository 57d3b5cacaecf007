//! Numbers and notes of a design as its page writes them.

use maud::{Markup, html};

use crate::outcome::design::Design;
use crate::outcome::design::band::SetBy;
use crate::report::numbers::SizeUnit;
use crate::report::shell::clean;
use crate::verdict::words::capital;

/// A note as a sentence.
pub(super) fn sentence(note: &str) -> String {
    clean(&format!("{}.", capital(note.trim_end_matches('.'))))
}

/// What sizes in a unit are shown in.
pub(super) fn shown_in(design: &Design, unit: &str) -> SizeUnit {
    SizeUnit::of(unit != "mm", design.inches)
}

pub(super) fn ratio(value: f64) -> String {
    format!("{value:.2}")
}

pub(super) fn between(low: Option<f64>, high: Option<f64>, words: fn(f64) -> String) -> String {
    let end = |value: Option<f64>| value.map_or_else(|| "unknown".to_owned(), words);
    format!("{} to {}", end(low), end(high))
}

/// The same in brackets, where there are networks enough for a band.
pub(super) fn in_band(low: Option<f64>, high: Option<f64>, words: fn(f64) -> String) -> String {
    let is_known = low.is_some() || high.is_some();
    if is_known { format!(" ({})", between(low, high, words)) } else { String::new() }
}

/// A number of the walk, in bold where the walk decides.
pub(super) fn of_walk(design: &Design, number: &str) -> Markup {
    match walk_decides(design) {
        true => html! { b { (number) } },
        false => html! { (number) },
    }
}

/// Whether the walk sets an answer that is known.
pub(super) fn walk_decides(design: &Design) -> bool {
    let answer = design.answer();
    answer.set_by == SetBy::Walk && answer.d15f_over_d85b.is_some()
}
