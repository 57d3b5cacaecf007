//! The page of the model's boundaries: one table and one figure, from `boundary.json` and `boundary.csv`
//! alone.

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
use super::names::{file_name, titled_by_file};
use super::section::Sections;
use super::shell::{citation, clean, unbroken};
use super::written::Written;
use crate::outcome::boundary::{Boundaries, WalkRow};
use crate::words::base_size;
use crate::words::boundary::held;
use crate::words::left_out::left_out_in_brief;
use crate::words::{FOREMOST, row_note};
use voidwalk_practice::quantity::{length, significant};
use words::size_unit;

/// Writes `boundary.html` and its figure into a folder, from `boundary.json` and `boundary.csv` there.
///
/// # Errors
/// A file is missing or malformed, or cannot be written.
pub fn write_boundary(folder: &Path) -> Result<Written, ReportError> {
    let all: Boundaries = json(&folder.join("boundary.json"))?;
    let walks: Vec<(u64, WalkRow)> = rows(&folder.join("boundary.csv"))?;
    let walks: Vec<WalkRow> = walks.into_iter().map(|(_, row)| row).collect();
    let title = "Boundaries of the model";
    let names = html! {
        (titled_by_file("Base", "Base", &all.base.name)) ", " (filter_words(&all))
    };
    let unit = size_unit(&all);
    let notes: Vec<String> = all.notes.iter().map(|row| row_note(row, unit)).collect();
    let (foremost, rest) = notes.split_at(notes.len().min(FOREMOST));
    let sheet = html! { section.sheet {
        (model(&all, foremost, rest.len()))
        p.small { (clean(&left_out_in_brief(&all.model_leaves_out))) " The boundaries of the walk are the \
            model’s. They do not replace a filter test or a designer’s judgement." }
    } };
    let footer = html! {
        (citation())
        p { "The classes: Foster and Fell, as that paper uses them." }
        p.small { "voidwalk " (all.version) "." }
    };
    Sections::new(title, title, &names)
        .model()
        .cover(&all.cover, &program(&all.version, all.commit.as_deref()), Some(all.seed))
        .words(&sheet)
        .figures(figure::erosion(&all, &walks))
        .contents()
        .section("Density and thickness", &tables::boundaries(&all))
        .section("Other notes", &others(rest))
        .section("How this was made", &tables::made(&all, &walks))
        .write(folder, "boundary.html", &footer)
}

/// The soil of the filter with its given sizes, and its curve.
fn filter_words(all: &Boundaries) -> Markup {
    html! {
        (titled_by_file("filter", "filter of the shape", &all.filter))
        @if let Some(facts) = as_given(all) { " (" (facts) ")" }
        ", constrictions " (clean(&file_name(&all.curve_name)))
    }
}

/// D15F and Cu of the given filter; `None` if neither is known.
fn as_given(all: &Boundaries) -> Option<String> {
    let d15 = all.filter_d15_mm.map(|mm| format!("D15F {}", length(mm, size_unit(all))));
    let cu = all.filter_cu.map(|cu| format!("Cu {}", significant(cu)));
    let given = all.filter_d15_mm.map(|_| "as given".to_owned());
    let facts: Vec<String> = d15.into_iter().chain(cu).chain(given).collect();
    (!facts.is_empty()).then(|| facts.join(", "))
}

/// The notes that are not on the first sheet: folded on a screen, and open in print.
fn others(rest: &[String]) -> Markup {
    html! { @if !rest.is_empty() {
        details { summary { (rest.len()) " more" } ul { @for note in rest { li { (clean(note)) } } } }
    } }
}

/// The line of the model, and the notes that matter most.
fn model(all: &Boundaries, foremost: &[String], more: usize) -> Markup {
    let sentence = unbroken(&held(all, size_unit(all)));
    html! {
        section.verdict {
            p.practice { b { "Model (research)" } ": " (sentence) "." }
            @if let Some(base) = all.base.size() { p { (base_size(&base, size_unit(all))) "." } }
            @if !foremost.is_empty() { ul { @for note in foremost { li { (unbroken(note)) } } } }
            @if more > 0 { p.small { "and " (more) " more below, under “Other notes”" } }
        }
    }
}
