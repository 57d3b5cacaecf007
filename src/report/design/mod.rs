//! The page of a design: the specification by practice and, apart from it, the boundaries of the model; from
//! `design.json` and `design.csv` alone.

mod figure;
mod tables;
#[cfg(test)]
mod tests;
mod words;

use std::path::Path;

use maud::{Markup, html};

use super::cover::program;
use super::error::ReportError;
use super::files::{json, rows};
use super::given_soils::GivenSoils;
use super::names::titled_by_file;
use super::section::Sections;
use super::shell::{citation, clean, unbroken};
use super::specification::{answer, with_details};
use super::written::Written;
use crate::outcome::design::{Design, WalkRow};
use crate::outcome::quantity::{length, significant};
use crate::words::base_size;
use crate::words::design::design_model;
use crate::words::left_out::left_out_in_brief;
use crate::words::specification::band as band_words;
use crate::words::{FOREMOST, row_note};
use words::size_unit;

/// Writes `design.html` and its figures into the folder of a design, from `design.json` and `design.csv`
/// there.
///
/// # Errors
/// A file is missing or malformed, or cannot be written.
pub fn write_design(folder: &Path) -> Result<Written, ReportError> {
    let design: Design = json(&folder.join("design.json"))?;
    let walks: Vec<(u64, WalkRow)> = rows(&folder.join("design.csv"))?;
    let walks: Vec<WalkRow> = walks.into_iter().map(|(_, row)| row).collect();
    let title = "How coarse may the filter be?";
    let names = html! {
        (titled_by_file("Base", "Base", &design.base.name)) ", " (filter_words(&design))
    };
    let unit = size_unit(&design);
    let notes: Vec<String> = design.notes.iter().map(|row| row_note(row, unit)).collect();
    let (foremost, rest) = notes.split_at(notes.len().min(FOREMOST));
    let sheet = html! { section.sheet {
        @if let Some(specification) = &design.specification { (answer(specification)) }
        (model(&design, foremost, rest.len()))
        p.small { (clean(&left_out_in_brief(&design.model_leaves_out))) " The boundaries of the walk are the \
            model’s. They do not replace a filter test or a designer’s judgement." }
    } };
    let footer = html! {
        (citation())
        p { "The classes: Foster and Fell, as that paper uses them." }
        p.small { "voidwalk " (design.version) "." }
    };
    #[cfg(feature = "xlsx")]
    if let Some(specification) = &design.specification {
        super::workbook::write_specification_workbook(folder, specification)?;
    }
    let soils = GivenSoils::of_design(&design);
    let band = design.specification.as_ref().and_then(|of| Some((of.band.as_ref()?, band_words(of, unit)?)));
    let drawn = soils.figure(band.as_ref().map(|(band, _)| *band), band.as_ref().map(|(_, said)| &**said));
    let page = Sections::new(title, title, &names)
        .model()
        .cover(&design.cover, &program(&design.version, design.commit.as_deref()), Some(design.seed))
        .words(&sheet)
        .figures(drawn)
        .contents();
    let page = match &design.specification {
        Some(specification) => with_details(page, specification),
        None => page,
    };
    page.section("Other notes", &others(rest))
        .section("Boundaries of the model", &tables::boundaries(&design))
        .figures(figure::erosion(&design, &walks))
        .section("Network by network", &tables::networks(&design))
        .section(soils.heading(), &soils.appendix())
        .section("How this was made", &tables::made(&design, &walks))
        .write(folder, "design.html", &footer)
}

/// The soil of the filter with its sizes as they were given, and its curve.
fn filter_words(design: &Design) -> Markup {
    let (soil, curve) = design.filter.split_once(CURVE).unwrap_or((&design.filter, ""));
    html! {
        (titled_by_file("filter", "filter of the shape", soil))
        @if let Some(said) = as_given(design) { " (" (said) ")" }
        @if !curve.is_empty() { (CURVE) (clean(curve)) }
    }
}

/// D15F and Cu of the filter as it was given; nothing where neither is known.
fn as_given(design: &Design) -> Option<String> {
    let d15 = design.filter_d15_mm.map(|mm| format!("D15F {}", length(mm, size_unit(design))));
    let cu = design.filter_cu.map(|cu| format!("Cu {}", significant(cu)));
    let given = design.filter_d15_mm.map(|_| "as given".to_owned());
    let said: Vec<String> = d15.into_iter().chain(cu).chain(given).collect();
    (!said.is_empty()).then(|| said.join(", "))
}

/// What stands between the names of a filter and of its curve.
const CURVE: &str = ", constrictions ";

/// The notes that do not stand on the first sheet: folded on a screen, and open in print.
fn others(rest: &[String]) -> Markup {
    html! { @if !rest.is_empty() {
        details { summary { (rest.len()) " more" } ul { @for said in rest { li { (clean(said)) } } } }
    } }
}

/// The line of the model, and the notes that matter most.
fn model(design: &Design, foremost: &[String], more: usize) -> Markup {
    let said = unbroken(&design_model(design, size_unit(design)));
    html! {
        section.verdict {
            p.practice { b { "Model (research)" } ": " (said) "." }
            @if let Some(base) = design.base.size() { p { (base_size(&base, size_unit(design))) "." } }
            @if !foremost.is_empty() { ul { @for said in foremost { li { (unbroken(said)) } } } }
            @if more > 0 { p.small { "and " (more) " more below, under “Other notes”" } }
        }
    }
}
