//! The page of a design: how coarse the filter may be, from `design.json` and `design.csv` alone.

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
use super::numbers::{significant, threshold, whole};
use super::section::Sections;
use super::shell::{citation, clean, unbroken};
use super::specification::{Stated, cautions, still_to_set, to_specify};
use super::written::Written;
use crate::outcome::design::{Design, DesignFinding, DesignRow, WalkRow, share_of_networks};
use crate::verdict::FOREMOST;
use crate::verdict::beside::NOT_COUNTED;
use crate::verdict::left_out::left_out_in_brief;
use crate::verdict::words::capital;
use words::{between, of_walk, ratio, sentence, shown_in, walk_decides};

/// Writes `design.html` and its figure into the folder of a design, from `design.json` and `design.csv`
/// there.
///
/// # Errors
/// A file is missing or malformed, or cannot be written.
pub fn write_design(folder: &Path) -> Result<Written, ReportError> {
    let design: Design = json(&folder.join("design.json"))?;
    let walks: Vec<(u64, WalkRow)> = rows(&folder.join("design.csv"))?;
    let walks: Vec<WalkRow> = walks.into_iter().map(|(_, row)| row).collect();
    let title = match design.inverse {
        false => "How coarse may the filter be?",
        true => "How fine may the base be?",
    };
    let names = html! {
        (titled_by_file("Base", "Base", &design.base.name)) ", " (filter_words(&design))
    };
    let findings = told(&design);
    // Of a walk that sets nothing what speaks against it most is enough for the first sheet.
    let foremost = if walk_decides(&design) { FOREMOST } else { 1 };
    let (foremost, rest) = findings.split_at(findings.len().min(foremost));
    let sheet = html! { section.sheet {
        (answer(&design, foremost, rest.len()))
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
        super::workbook::write_specification_workbook(folder, specification, Some(&design))?;
    }
    let stated = design.specification.as_ref().map(Stated::of).unwrap_or_default();
    let soils = GivenSoils::of_design(&design);
    let band = design.specification.as_ref().and_then(|of| Some((of.band.as_ref()?, of.band_in_words()?)));
    let drawn = soils.figure(band.as_ref().map(|(band, _)| *band), band.as_ref().map(|(_, said)| &**said));
    Sections::new(title, title, &names)
        .model()
        .cover(&design.cover, &program(&design.version, design.commit.as_deref()), Some(design.seed))
        .inches(design.inches)
        .words(&sheet)
        .figures(figure::erosion(&design, &walks))
        .contents()
        .section("Other findings", &others(rest))
        .section("Boundaries of the model", &tables::boundaries(&design))
        .section("D15F between drainage and retention", &tables::bands(&design))
        .section("Standard products", &tables::products(&design))
        .section("The specification, step by step", &stated.words)
        .figures(drawn)
        .section("Limits sieve by sieve", &html! { (in_doubt(&design)) (stated.limits) })
        .section("Margins of standard products", &stated.products)
        .section("Rules of practice", &tables::practice(&design))
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
    let d15 = design.filter_d15_mm.map(|mm| format!("D15F {}", shown_in(design, "mm").size(mm)));
    let cu = design.filter_cu.map(|cu| format!("Cu {}", significant(cu)));
    let given = design.filter_d15_mm.map(|_| "as given".to_owned());
    let said: Vec<String> = d15.into_iter().chain(cu).chain(given).collect();
    (!said.is_empty()).then(|| said.join(", "))
}

/// What stands between the names of a filter and of its curve.
const CURVE: &str = ", constrictions ";

/// What was found, without the names of settings.
fn told(design: &Design) -> Vec<String> {
    // Why a row has no band stands in the answer itself.
    let notes = design.boundaries.iter().filter_map(|row| row.band_note.as_ref());
    let notes: Vec<String> = notes.map(|note| sentence(note)).collect();
    let is_said = |of: &&DesignFinding| {
        let is_noted = notes.iter().any(|note| note.contains(&clean(&of.finding.sentence)));
        let is_above = of.finding.id == NOT_COUNTED && walk_decides(design);
        is_noted || is_above || design.is_cautioned(of)
    };
    let words = |of: &DesignFinding| {
        let said = &of.finding.sentence;
        of.row.as_ref().map_or_else(|| said.clone(), |row| format!("{}: {said}", capital(row)))
    };
    design.findings.iter().filter(|of| !is_said(of)).map(words).collect()
}

/// What is said of a part of the filter that the mass eroded does not know of, once.
fn not_counted(design: &Design) -> Option<&str> {
    let of = design.findings.iter().find(|of| of.finding.id == NOT_COUNTED)?;
    Some(&of.finding.sentence)
}

/// The findings that do not stand on the first sheet: folded on a screen, and open in print.
fn others(rest: &[String]) -> Markup {
    html! { @if !rest.is_empty() {
        details { summary { (rest.len()) " more" } ul { @for said in rest { li { (clean(said)) } } } }
    } }
}

fn answer(design: &Design, foremost: &[String], more: usize) -> Markup {
    let (found, said) = (design.least_held(), design.answer());
    let others = design.boundaries.iter().filter(|row| row.no_erosion.is_none() || row.band_note.is_some());
    let others = others.count();
    let is_empty = |row: &DesignRow| row.band.as_ref().is_some_and(|band| band.is_empty);
    // Never in green where the walk sets the answer, a rule of practice is broken, or a row has no answer.
    let class = match &found {
        None => "undecided",
        Some(_)
            if others == 0
                && design.fits_by_practice()
                && said.d15f_over_d85b.is_some()
                && !design.boundaries.iter().any(is_empty) =>
        {
            "none"
        }
        Some(_) => "doubted",
    };
    html! {
        section class=(format!("verdict {class}")) {
            p.word.long { (clean(&said.limit)) }
            @if let Some(washout) = &said.washout { p { b { (unbroken(washout)) "." } } }
            @if let Some(margin) = &said.margin { p { (unbroken(margin)) "." } }
            @if let Some(dispersive) = &said.if_dispersive { p { b { (clean(dispersive)) "." } } }
            @if let Some((row, held)) = &found {
                @if let Some(base) = design.base.size() { p.lead { (base.words()) "." } }
                p {
                    "In the model no erosion (less than " (threshold(design.threshold)) " of the base in the \
                     first run) up to D15F/D85B "
                    @let [no_erosion, _] = row.shown();
                    @match &no_erosion {
                        Some(boundary) => {
                            (of_walk(design, &ratio(boundary.median)))
                            @if design.replicates == 1 { " on one network: " } @else {
                                " in the median of " (whole(design.replicates)) " networks ("
                                (between(boundary.low, boundary.high, ratio)) ", "
                                (share_of_networks(design.replicates)) "): "
                            }
                        },
                        None => {
                            (of_walk(design, &ratio(*held))) " on nearly all of " (whole(design.replicates))
                            " networks; "
                            @if row.eroding_networks() > 0 {
                                (row.eroding_networks()) " of them erode within the search, and the \
                                median lies beyond it: "
                            } @else {
                                "where erosion begins lies beyond the search: "
                            }
                        },
                    }
                    (clean(&row.name())) ", " (clean(&row.thickness)) "."
                    @if let Some(walk) = &said.walk { " " (unbroken(walk)) "." }
                }
                @if walk_decides(design) && let Some(said) = not_counted(design) {
                    p.counted { (unbroken(said)) }
                }
                @if design.specification.is_none() && let Some(band) = design.band_of(row) {
                    p { b { "Band: " (clean(&band.said)) } "." }
                }
                @if let Some(band) = design.band_of(row) {
                    // Where practice sets the coarse side, the band says so.
                    @let of_walk = |limit: &f64| !band.is_empty && *limit != band.greatest;
                    @if let Some(practice) = band.practice.filter(of_walk) {
                        p {
                            "Practice allows up to "
                            (shown_in(design, &band.unit).limit(practice, &band.unit, false)) " ("
                            (clean(&band.practice_rule)) ")."
                        }
                    }
                }
            }
            @if found.is_none() && let Some(walk) = &said.walk { p { (unbroken(walk)) "." } }
            @if let Some(of) = &design.specification {
                @match of.band_in_words() {
                    Some(band) => p { b { "Band to specify: " (clean(&band)) } "." },
                    None => p {
                        b { "No band to specify." } " " (clean(of.no_band.as_deref().unwrap_or_default()))
                    },
                }
                (to_specify(of))
                (cautions(design.cautions()))
                (still_to_set(of))
            }
            @for row in &design.boundaries {
                @if let Some(note) = &row.band_note {
                    p {
                        b { "No band for " (clean(&row.name())) ", " (clean(&row.thickness)) ". " }
                        (sentence(note))
                    }
                }
            }
            @if design.boundaries.len() > 1 && design.least_held().is_some() {
                p.small {
                    "Of several densities and thicknesses, the one that holds least"
                    @if others > 0 {
                        "; of those that have an answer: " (others) " of " (design.boundaries.len())
                        " have none"
                    }
                    "."
                }
            }
            @if !foremost.is_empty() { ul { @for said in foremost { li { (unbroken(said)) } } } }
            @if more > 0 { p.small { "and " (more) " more below, under “Other findings”" } }
        }
    }
}

/// What the walk is worth beside limits that follow from practice.
fn in_doubt(design: &Design) -> Markup {
    html! {
        @if design.specification.is_some() && design.fits_by_practice() {
            p { "The limit of practice sets them. " (design.walk_beside_practice()) }
        }
    }
}
