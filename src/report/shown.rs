//! Quantities in markup.

use std::fmt::Display;

use maud::{Render, display};

use super::quantity::{Quantity, Span, whole};

impl Render for Quantity {
    fn render_to(&self, buffer: &mut String) {
        display(self).render_to(buffer);
    }
}

impl Render for Span {
    fn render_to(&self, buffer: &mut String) {
        display(self).render_to(buffer);
    }
}

/// A value, or that it is not given.
pub(super) fn known<T, R: Display>(value: Option<T>, words: impl FnOnce(T) -> R) -> String {
    value.map_or_else(|| "not given".to_owned(), |value| words(value).to_string())
}

/// Several counts in a row.
pub(super) fn counts<const N: usize>(numbers: [u64; N]) -> String {
    numbers.map(|number| whole(number).to_string()).join(", ")
}
