//! The page of the designs of many samples, from `designs.json` alone.

use std::path::Path;

use maud::{Markup, Render, html};

use super::appendix::input_files;
use super::cover::program;
use super::error::ReportError;
use super::figures::{Across, Axis, BLACK, BLUE, Dash, Figure, Point, Rule, Shape, positive_range, shorten};
use super::files::json;
use super::names::{note_words, titled_by_file};
use super::quantity::SizeUnit;
use super::section::Sections;
use super::shell::{Drawn, clean};
use super::sizes::{SizedSoil, of_many};
use super::table::Table;
use super::written::Written;
use crate::words::designed::{columns, lines};
use crate::words::specification::DESIGN_EACH_AGAIN;
use voidwalk_practice::{DesignedSample, DesignedSamples};

const RECORD: &str = "designs.json";

/// Rows of the page's table; all are in `designs.csv`.
const LISTED: usize = 2000;

/// Writes `designs.html` and `figures/designs.svg` into the folder of the designs of many samples.
///
/// # Errors
/// A file that is missing or malformed; nothing is written then.
pub fn write_designs(folder: &Path) -> Result<Written, ReportError> {
    let path = folder.join(RECORD);
    let all: DesignedSamples = json(&path)?;
    if all.rows.is_empty() {
        let (field, value, allowed) = ("rows".into(), "empty".into(), "one or more".into());
        return Err(ReportError::Value { path, field, value, allowed });
    }
    let names = html! {
        (titled_by_file("Samples", "Samples", &all.samples))
        @if all.dispersive { ", dispersive" }
        ", by the rules of practice alone"
    };
    let lines = lines(&all, DESIGN_EACH_AGAIN, SizeUnit::of(false, all.inches));
    let first = html! { section.verdict {
        p.word.long { (clean(&lines[0])) "." }
        ul { @for line in &lines[1..] { li { (clean(line)) "." } } }
    } };
    let made = html! { table.facts { tbody { (input_files(&all.inputs)) } } p {
        "voidwalk " (clean(&all.version)) ". "
        code { "designs.json" } " holds this page’s numbers, " code { "designs.csv" }
        " its table with further columns."
    } };
    Sections::new("Filters for many samples", "How coarse may the filter be?", &names)
        .cover(&all.cover, &program(&all.version, all.commit.as_deref()), None)
        .words(&first)
        .contents()
        .words(&html! { h2 { "Figures" } })
        .figures(limits(&all))
        .section("Samples", &table(&all))
        .section("Notes on the files", &notes(&all))
        .section("Appendix: the soils", &appendix(&all))
        .section("How this was made", &made)
        .write(folder, "designs.html", &html! {})
}

fn name(name: &str) -> String {
    clean(&shorten(name, 60))
}

/// The sizes of every sample, as sampled and as regraded.
fn appendix(all: &DesignedSamples) -> Markup {
    let mut soils: Vec<SizedSoil> = Vec::new();
    for row in all.rows.iter().take(LISTED).filter(|row| !row.gradation.is_empty()) {
        soils.push(SizedSoil::new(name(&row.sample), &row.gradation));
        if !row.regraded.is_empty() {
            soils.push(SizedSoil::new(format!("{}, regraded", name(&row.sample)), &row.regraded));
        }
    }
    if soils.is_empty() {
        return html! {};
    }
    html! {
        p.small {
            "By mass, as sampled and as regraded for the rules of practice. " code { "designs.json" }
            " has every gradation."
        }
        (of_many(&soils))
    }
}

fn notes(all: &DesignedSamples) -> Markup {
    html! {
        @if !all.notes.is_empty() { ul { @for note in &all.notes { li { (clean(&note_words(note))) } } } }
    }
}

fn table(all: &DesignedSamples) -> Markup {
    let columns = columns(SizeUnit::of(false, all.inches));
    let table = Table::of(all.rows.iter().take(LISTED), columns)
        .class("cases")
        .showing("sample", |row| html! { bdi { (name(&row.sample)) } });
    html! {
        (table.render())
        @if all.rows.len() > LISTED { p.small { "The rest is in designs.csv." } }
        p.small {
            "Limit of practice: the strictest D15F by which the rules retain the sample. Drains from: the \
             minimum D15F that drains it. Band: D15F of both sides of its specification. Governs: 1 for the \
             sample with the least limit."
        }
    }
}

/// The limit of practice of every sample against its D85B; `None` without a number.
fn limits(all: &DesignedSamples) -> Option<Drawn> {
    let limit = |row: &DesignedSample| Some((row.d85b_mm?, row.d15f_max_mm?, row.governs == Some(1)));
    let practice: Vec<_> = all.rows.iter().filter_map(limit).collect();
    practice.first()?;
    let (low, high) = positive_range(practice.iter().map(|(d85, ..)| *d85));
    let x = Axis::log("D85B after regrading (mm)", low / 1.2, high * 1.2);
    let (low, high) = positive_range(practice.iter().map(|(_, mm, _)| *mm));
    let y = Axis::log("D15F (mm)", low / 1.2, high * 1.2);
    let what = "Maximum D15F by practice against D85B of each sample";
    let mut figure = Figure::new("How coarse the filter may be", what, "", x, y).names_above();
    let governs = all.governing().first().and_then(|row| row.d15f_max_mm);
    if let Some(mm) = governs {
        figure.add(Rule::new(Across::Y, mm, BLACK).dash(Dash::Dashed).label("governing sample"));
    }
    let point = |(d85, mm, governs): &(f64, f64, bool)| {
        Point::new(*d85, *mm, BLUE, if *governs { Shape::Square } else { Shape::Circle })
    };
    figure.add_points("limit of practice", practice.iter().map(point));
    let caption = "The strictest limit of practice of each sample. Square: the sample that governs. The \
                   dashed line is the D15F beyond which that sample is not served.";
    Some(Drawn::new("designs", figure, caption))
}
