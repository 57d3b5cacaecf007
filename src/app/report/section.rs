//! Page as a list of sections; its figures are numbered consecutively, and also written as files.

use std::path::{Path, PathBuf};

use maud::{Markup, PreEscaped, html};

use super::files::ReportError;
use super::shell::{Drawn, contents, cover, figure, foot, model, page_with_foot};
use voidwalk_core::store::{Together, make_folder};
use voidwalk_practice::SheetCover;

pub(super) struct Sections {
    title: String,
    foot: Option<String>,
    header: Markup,
    main: String,
    drawn: Vec<Drawn>,
}

impl Sections {
    /// Page with its browser title, its first heading, and its subject below.
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

    pub(super) fn words(mut self, words: &Markup) -> Self {
        self.main += &words.0;
        self
    }

    /// Adds text under a heading; without text it adds nothing.
    pub(super) fn section(self, heading: &str, words: &Markup) -> Self {
        match words.0.is_empty() {
            true => self,
            false => self.words(&html! { h2 { (heading) } (words) }),
        }
    }

    pub(super) fn contents(self) -> Self {
        self.words(&contents())
    }

    pub(super) fn figures(mut self, figures: impl IntoIterator<Item = Drawn>) -> Self {
        for drawn in figures {
            self.main += &figure(self.drawn.len() + 1, &drawn).0;
            self.drawn.push(drawn);
        }
        self
    }

    pub(super) fn text(&self, footer: &Markup) -> String {
        let main = PreEscaped(self.main.clone());
        page_with_foot(self.foot.as_deref(), &self.title, [&self.header, &main, footer])
    }

    /// Writes the figures and then the page, with this footer, under its name in the folder.
    pub(super) fn write(&self, folder: &Path, name: &str, footer: &Markup) -> Result<Written, ReportError> {
        write_page(folder, name, &self.drawn, &self.text(footer))
    }
}

/// Files of a report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// `report.html`.
    pub page: PathBuf,
    /// Files `figures/*.svg`, in the order of the page.
    pub figures: Vec<PathBuf>,
}

/// Writes the figures as `figures/*.svg`, then the page under its name. Each file appears complete or not at
/// all, and replaces an older one of the same name.
pub(super) fn write_page(
    folder: &Path,
    name: &str,
    figures: &[Drawn],
    page: &str,
) -> Result<Written, ReportError> {
    make_folder(&folder.join("figures"))?;
    let mut files = Together::in_folder(folder);
    let mut written = Vec::new();
    for drawn in figures {
        let name = format!("figures/{}.svg", drawn.name);
        files.add(&name, drawn.figure.file().as_bytes())?;
        written.push(folder.join(name));
    }
    files.add(name, page.as_bytes())?;
    files.finish()?;
    Ok(Written { page: folder.join(name), figures: written })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::figures::{Axis, Figure};

    #[test]
    fn figures_are_numbered_through_the_page_and_a_section_without_words_has_no_heading() {
        let drawn = |name| {
            let axis = || Axis::linear("x", 0.0, 1.0);
            Drawn::new(name, Figure::new("", "", axis(), axis()), "")
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
