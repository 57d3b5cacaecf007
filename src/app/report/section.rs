//! A page as a list of sections: heading, words, figures, tables. The figures are numbered through the page,
//! and written beside it.

use std::path::Path;

use maud::{Markup, PreEscaped, html};

use super::cover::{cover, foot};
use super::error::ReportError;
use super::shell::{Drawn, contents, figure, model, page_with_foot};
use super::written::{Written, write_page_as};
use voidwalk_practice::SheetCover;

/// A page that is built from the top.
pub(super) struct Sections {
    title: String,
    foot: Option<String>,
    header: Markup,
    main: String,
    drawn: Vec<Drawn>,
}

impl Sections {
    /// A page with its title for a browser, its first heading, and its subject below.
    pub(super) fn new(title: impl Into<String>, heading: &str, names: &Markup) -> Self {
        let header = html! { h1 { (heading) } @if !names.0.is_empty() { p.names { (names) } } };
        Self { title: title.into(), foot: None, header, main: String::new(), drawn: Vec::new() }
    }

    /// Adds a line that explains the model, before its results.
    pub(super) fn model(mut self) -> Self {
        self.header = html! { (self.header) (model()) };
        self
    }

    /// Adds the cover of a sheet below its first heading.
    pub(super) fn cover(mut self, sheet: &SheetCover, program: &str, seed: Option<u64>) -> Self {
        self.header = html! { (self.header) (cover(sheet, program, seed)) };
        self.foot = foot(sheet);
        self
    }

    /// Adds words, or a table.
    pub(super) fn words(mut self, words: &Markup) -> Self {
        self.main += &words.0;
        self
    }

    /// Adds words under a heading; without words the heading is left out too.
    pub(super) fn section(self, heading: &str, words: &Markup) -> Self {
        match words.0.is_empty() {
            true => self,
            false => self.words(&html! { h2 { (heading) } (words) }),
        }
    }

    /// Adds the list of the headings that follow.
    pub(super) fn contents(self) -> Self {
        self.words(&contents())
    }

    /// Adds figures.
    pub(super) fn figures(mut self, figures: impl IntoIterator<Item = Drawn>) -> Self {
        for drawn in figures {
            self.main += &figure(self.drawn.len() + 1, &drawn).0;
            self.drawn.push(drawn);
        }
        self
    }

    /// The page as text, with this at its end.
    pub(super) fn text(&self, footer: &Markup) -> String {
        let main = PreEscaped(self.main.clone());
        page_with_foot(self.foot.as_deref(), &self.title, [&self.header, &main, footer])
    }

    /// Writes the figures and then the page, with this at its end, under its name in the folder.
    ///
    /// # Errors
    /// Returns the error of a file that cannot be written.
    pub(super) fn write(&self, folder: &Path, name: &str, footer: &Markup) -> Result<Written, ReportError> {
        write_page_as(name, folder, &self.drawn, &self.text(footer))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::figures::{Axis, Figure};

    #[test]
    fn figures_are_numbered_through_the_page_and_a_section_without_words_has_no_heading() {
        let drawn = |name| {
            let axis = || Axis::linear("x", 0.0, 1.0);
            Drawn::new(name, Figure::new("", "", "", axis(), axis()), "")
        };
        let page = Sections::new("a", "Heading", &html! {})
            .figures([drawn("one")])
            .section("Empty", &html! {})
            .section("Full", &html! { p { "words" } })
            .figures([drawn("two")])
            .text(&html! {});
        let at = |text: &str| page.find(text).unwrap();
        assert!(at("Figure 1. ") < at("<h2>Full</h2><p>words</p>") && at("</p>") < at("Figure 2. "));
        assert!(!page.contains("Empty") && !page.contains("<p class=\"names\""));
    }
}
