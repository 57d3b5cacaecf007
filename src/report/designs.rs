//! The page of the designs of many samples, from `designs.json` alone.

use std::path::Path;

use maud::{Markup, Render, html};

use super::appendix::input_files;
use super::cover::program;
use super::error::ReportError;
use super::figures::{Across, Axis, BLACK, BLUE, Dash, Figure, Point, Rule, Shape, positive_range, shorten};
use super::files::json;
use super::names::{file_name, note_words, option_words, titled_by_file};
use super::quantity::{SizeUnit, whole};
use super::section::Sections;
use super::shell::{Drawn, citation, clean, fact, leaves_out};
use super::sizes::{SizedSoil, of_many};
use super::table::Table;
use super::written::Written;
use crate::verdict::{DesignedSample, DesignedSamples, DesignedWalks};
use crate::words::designed::{columns, lines};
use crate::words::specification::DESIGN_EACH_AGAIN;

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
        @if all.filter.is_empty() { ", by the rules of practice alone" }
        @else { ", " (titled_by_file("filter", "filter of the shape", &all.filter)) }
    };
    let said = lines(&all, DESIGN_EACH_AGAIN, SizeUnit::of(false, all.inches));
    let has_walks = !all.model_leaves_out.is_empty();
    let first = html! { div.first[has_walks] {
        section.verdict {
            p.word.long { (clean(&said[0])) "." }
            ul { @for said in &said[1..] { li { (clean(said)) "." } } }
        }
        @if has_walks {
            (leaves_out(&all.model_leaves_out, &html! {
                p { "The boundaries of the walk are the model’s. They do not replace a filter test or a \
                    designer’s judgement." }
            }))
        }
    } };
    let walks = all.walks.as_ref().map(walked).unwrap_or_default();
    let made = html! { table.facts { tbody { (walks) (input_files(&all.inputs)) } } p {
        "voidwalk " (clean(&all.version)) ". "
        @if !all.filter.is_empty() { "The design of each sample has a page of its own. " }
        code { "designs.json" } " holds this page’s numbers, " code { "designs.csv" }
        " its table with further columns."
    } };
    let footer = if all.filter.is_empty() {
        html! {}
    } else {
        citation()
    };
    let page = Sections::new("Filters for many samples", "How coarse may the filter be?", &names);
    let page = if has_walks { page.model() } else { page };
    page.cover(
        &all.cover,
        &program(&all.version, all.commit.as_deref()),
        all.walks.as_ref().map(|of| of.seed),
    )
    .words(&first)
    .contents()
    .words(&html! { h2 { "Figures" } })
    .figures(limits(&all))
    .section("Samples", &table(folder, &all))
    .section("Notes on the files", &notes(&all))
    .section("Appendix: the soils", &appendix(&all))
    .section("How this was made", &made)
    .write(folder, "designs.html", &footer)
}

fn name(name: &str) -> String {
    clean(&shorten(name, 60))
}

/// What was walked for every sample alike.
fn walked(of: &DesignedWalks) -> Markup {
    let asked = of.settings.iter().map(|setting| option_words(&format!("--set {setting}")));
    let asked: Vec<String> = asked.collect();
    html! {
        (fact("Filter", file_name(&of.filter)))
        (fact("Density", of.densities.join(", ")))
        (fact("Thickness", of.thicknesses.join(", ")))
        (fact("Networks, seed", format!("{}, {}", whole(of.networks), of.seed)))
        @if !asked.is_empty() { (fact("Settings", asked.join(" "))) }
    }
}

/// What every sample is, and the filter as it was given: their sizes, as sampled and as regraded.
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
    let filter = all.walks.iter().filter(|of| !of.filter_gradation.is_empty());
    soils.extend(filter.map(|of| SizedSoil::new("Filter, as given", &of.filter_gradation)));
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

fn table(folder: &Path, all: &DesignedSamples) -> Markup {
    let sample = |row: &DesignedSample| {
        let page = row.design.as_ref().map(|of| format!("{}/design.html", of.folder));
        let page = page.filter(|page| folder.join(page).is_file());
        html! { bdi {
            @if let Some(page) = page { a href=(page) { (name(&row.sample)) } } @else { (name(&row.sample)) }
        } }
    };
    let table = Table::of(all.rows.iter().take(LISTED))
        .class("cases")
        .columns(columns(SizeUnit::of(false, all.inches)), |row| row)
        .named_by("sample", sample);
    html! {
        (table.render())
        @if all.rows.len() > LISTED { p.small { "The rest is in designs.csv." } }
        p.small {
            "Limit of practice: the strictest D15F by which the rules retain the sample. Drains from: the \
             minimum D15F that drains it. Band: D15F of both sides of its specification. Governs: 1 for the \
             sample with the least limit."
            @if !all.filter.is_empty() { " Model: the D15F/D85B and the D15F that nearly all networks hold." }
        }
    }
}

/// The limit of practice of every sample against its D85B, and the D15F that the model holds; none without a
/// number.
fn limits(all: &DesignedSamples) -> Option<Drawn> {
    let of = |row: &DesignedSample, mm: Option<f64>| Some((row.d85b_mm?, mm?, row.governs == Some(1)));
    let practice: Vec<_> = all.rows.iter().filter_map(|row| of(row, row.d15f_max_mm)).collect();
    let walk = |row: &DesignedSample| row.design.as_ref().and_then(|of| of.model_d15f_mm);
    let walked: Vec<_> = all.rows.iter().filter_map(|row| of(row, walk(row))).collect();
    let both = || practice.iter().chain(&walked);
    both().next()?;
    let (low, high) = positive_range(both().map(|(d85, ..)| *d85));
    let x = Axis::log("D85B after regrading (mm)", low / 1.2, high * 1.2);
    let (low, high) = positive_range(both().map(|(_, mm, _)| *mm));
    let y = Axis::log("D15F (mm)", low / 1.2, high * 1.2);
    let what = "Maximum D15F by practice, and D15F of the model, against D85B of each sample";
    let mut figure = Figure::new("How coarse the filter may be", what, "", x, y).names_above();
    let governs = all.governing().first().and_then(|row| row.d15f_max_mm);
    if let Some(mm) = governs {
        figure.add(Rule::new(Across::Y, mm, BLACK).dash(Dash::Dashed).label("governing sample"));
    }
    let point = |(d85, mm, governs): &(f64, f64, bool)| {
        Point::new(*d85, *mm, BLUE, if *governs { Shape::Square } else { Shape::Circle })
    };
    figure.add_points("limit of practice", practice.iter().map(point));
    if !walked.is_empty() {
        figure.add_points("model (research)", walked.iter().map(|of| point(of).hollow()));
    }
    let hollow =
        if walked.is_empty() { "" } else { " Hollow: the D15F that nearly all networks of the model hold." };
    let caption = format!(
        "The strictest limit of practice of each sample.{hollow} Square: the sample that governs. The dashed \
         line is the D15F beyond which that sample is not served."
    );
    Some(Drawn::new("designs", figure, caption))
}
