//! What every page is made of: one HTML file that fetches nothing, its head, its figures.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use sha2::{Digest, Sha256};

use super::figures::{Figure, Size, visible};

const STYLE: &str = include_str!("page.css");

/// A figure, the name of its file and what stands below it.
pub(super) struct Drawn {
    pub name: &'static str,
    pub caption: String,
    pub figure: Figure,
}

/// A page as text.
pub(super) fn whole_page(title: &str, header: &Markup, main: &Markup, footer: &Markup) -> String {
    // the style is named by its hash: a style that a hostile name might bring along would not be obeyed
    let hash = BASE64_STANDARD.encode(Sha256::digest(STYLE.as_bytes()));
    let policy =
        format!("default-src 'none'; style-src 'sha256-{hash}'; base-uri 'none'; form-action 'none'");
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(policy);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="referrer" content="no-referrer";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header { (header) }
                main { (main) }
                footer { (footer) }
            }
        }
    }
    .into_string()
}

/// A text from outside without characters that are no text; maud escapes the markup in it.
pub(super) fn clean(text: &str) -> String {
    text.chars().map(visible).collect()
}

pub(super) fn drawing(drawn: &Drawn) -> Markup {
    let wide = drawn.figure.inline(&format!("{}-wide", drawn.name), Size::Wide);
    let narrow = drawn.figure.inline(&format!("{}-narrow", drawn.name), Size::Narrow);
    html! { div.wide { (PreEscaped(wide)) } div.narrow { (PreEscaped(narrow)) } }
}

pub(super) fn figure(number: usize, drawn: &Drawn) -> Markup {
    html! {
        figure {
            (drawing(drawn))
            figcaption { b { "Figure " (number) ". " } (clean(&drawn.caption)) }
        }
    }
}

pub(super) fn fact(name: &str, value: impl AsRef<str>) -> Markup {
    html! { tr { th { (name) } td { (clean(value.as_ref())) } } }
}
