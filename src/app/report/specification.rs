//! Page of a specification, and page of the specifications for many samples.

use std::path::Path;

use maud::{Markup, Render, html};

use super::figures::{Across, Axis, BLACK, BLUE, Dash, Figure, Mark, Shape, positive_range};
use super::files::{ReportError, json, refused};
use super::names::{brief_name, file_notes, titled_by_file};
use super::section::{Sections, Written};
use super::shell::{Drawn, clean, program, unbroken};
use super::soils::{curves_appendix, curves_figure, curves_heading, input_files};
use super::table::{SizedSoil, Table, known, of_many};
use crate::outcome::table::{Columns, Emphasis, Shown, TableCell};
use crate::words::products::{columns, product as product_result, products as products_line, to_be_checked};
use crate::words::specification::{
    DESIGN_AGAIN, DESIGN_EACH_AGAIN, band, beside_limits, if_dispersive, limit, limit_columns, no_band,
    raised, step_name, step_notes, step_value, still_to_set, without_margin,
};
use crate::words::{designed, row_note};
use voidwalk_practice::design::specification::StepValue;
use voidwalk_practice::design::{Specification, SpecificationStep};
use voidwalk_practice::quantity::{NumberRole, SizeUnit, length};
use voidwalk_practice::{DesignedSample, DesignedSamples};

/// Writes `specification.html`, its figure and `specification.xlsx` into the folder of a specification, from
/// its `specification.json`.
pub(crate) fn write_specification(folder: &Path) -> Result<Written, ReportError> {
    let design: Specification = json(&folder.join("specification.json"))?;
    let names = html! {
        (titled_by_file("Base", "Base", &design.base)) @if design.dispersive { ", dispersive" }
        ", by the rules of practice alone"
    };
    let footer = html! {
        p { "By the rules of practice, without a walk. It does not replace a filter test or a designer’s \
             judgement." }
        p.small { "voidwalk " (design.version) "." }
    };
    #[cfg(feature = "xlsx")]
    super::workbook::write_specification_workbook(folder, &design)?;
    let more = design.notes.iter().skip(WARNINGS).map(|row| row_note(row, unit(&design)));
    let more =
        html! { @if design.notes.len() > WARNINGS { ul { @for note in more { li { (clean(&note)) } } } } };
    let made = html! { @if !design.inputs.is_empty() {
        table.facts { tbody { (input_files(&design.inputs)) } }
    } };
    let title = "Specification of a filter";
    let page = Sections::new(title, title, &names)
        .cover(&design.cover, &program(&design.version, design.commit.as_deref()), None)
        .words(&html! { section.sheet { (answer(&design)) } })
        .figures(curves_figure(&design, band(&design, unit(&design)).as_deref()));
    page.section("More warnings", &more)
        .section("Limits sieve by sieve", &sieve_limits(&design))
        .section("Standard products", &products(&design))
        .section("Step by step", &steps(&design))
        .section(curves_heading(&design), &curves_appendix(&design))
        .section("How this was made", &made)
        .write(folder, "specification.html", &footer)
}

fn unit(design: &Specification) -> SizeUnit {
    SizeUnit::of(false, design.inches)
}

fn answer(design: &Specification) -> Markup {
    let unit = unit(design);
    html! {
        section.verdict {
            @if let Some(band) = band(design, unit) { p.word.long { (clean(&band)) ", by practice." } }
            p { "Limit: " (clean(&limit(design, unit))) "." }
            (to_specify(design))
            @if let Some(sentence) = without_margin(design, unit) { p { (unbroken(&sentence)) "." } }
            @if let Some(sentence) = if_dispersive(design, DESIGN_AGAIN, unit) {
                p { (clean(&sentence)) "." }
            }
            @if let Some(why) = &design.no_band {
                p.word.long { "No band." }
                p { (clean(&no_band(why, unit))) }
            }
            @for row in design.notes.iter().take(WARNINGS) {
                p.caution { b { "Warning" } ": " (unbroken(&row_note(row, unit))) }
            }
            @if design.notes.len() > WARNINGS { p.small { "More warnings below." } }
            @if let Some(gaps) = still_to_set(design, unit) { p.caution { b { (unbroken(&gaps)) } } }
            p { (clean(&products_line(design))) "." }
        }
    }
}

/// Maximum number of warnings in the answer; the others are below it.
const WARNINGS: usize = 4;

/// Reason for the start of the band, and the sizes of its two sides; empty without a band.
fn to_specify(design: &Specification) -> Markup {
    let Some(band) = &design.band else { return html! {} };
    let unit = unit(design);
    let sides = [("Fine side", true), ("Coarse side", false)];
    let columns = Columns::default().name("side", unit.name(), |side: &(&'static str, bool)| side.0);
    let columns = band.sizes.iter().fold(columns, |columns, size| {
        let [name, heading] = [format!("d{}f_mm", size.percent), format!("D{}F", size.percent)];
        columns.number(name, heading, move |side| match side.1 {
            true => length(size.min_mm, unit).role(NumberRole::Least).in_cell(),
            false => length(size.max_mm, unit).role(NumberRole::Greatest).in_cell(),
        })
    });
    html! {
        @if let Some(raised) = raised(design, unit) { p { (clean(&raised)) "." } }
        (Table::new(&sides, columns).class("band"))
    }
}

fn steps(design: &Specification) -> Markup {
    let unit = unit(design);
    let number = |value: &StepValue| known(step_value(value, unit), |words| words);
    let columns = Columns::default()
        .name("step", "What is done, formula, source", |step: &SpecificationStep| {
            let source = (!step.source.is_empty()).then(|| format!("Source: {}", step.source));
            let texts = [step.formula.clone(), step_notes(step, unit)].into_iter();
            let below = texts.filter(|text| !text.is_empty()).chain(source);
            below.fold(format!("{}. {}", step.step, step_name(step.does)).shown(), Shown::below)
        })
        .text("values", "Numbers", |step| {
            let values = step.values.iter().map(|value| format!("{} = {}", value.name, number(value)));
            values.collect::<Vec<_>>().join("; ")
        });
    html! {
        p.small {
            "The order of the steps is ours, as procedures commonly have it, and not that of the NRCS \
             handbook (National Engineering Handbook, Part 633, Chapter 26). Each step names the text that \
             its numbers come from, or says that they are this program’s own."
        }
        (Table::new(&design.steps, columns).class("study steps").showing("values", |step| html! {
            @for value in &step.values { (clean(&value.name)) " = " b { (number(value)) } br; }
        }))
    }
}

fn sieve_limits(design: &Specification) -> Markup {
    let unit = unit(design);
    if design.band.is_none() {
        return html! { @if let Some(why) = &design.no_band { p { (clean(&no_band(why, unit))) } } };
    }
    html! {
        (Table::new(&design.limits, limit_columns()))
        @if let Some(beside) = beside_limits(design, unit) { p { (clean(&beside)) } }
        @if if_dispersive(design, DESIGN_AGAIN, unit).is_some() {
            p { b { "Valid only for a base that tests show not to be dispersive." } }
        }
        p.small {
            "Percent finer by mass, rounded into the band; above D60F of a side no text was read for it. \
             At most 5 % may be finer than \
             0.075 mm, and these fines must not be plastic. Segregation is not checked: the maximum D90F is \
             still to be set (see its step)."
        }
    }
}

fn products(design: &Specification) -> Markup {
    let columns = columns(unit(design)).text("result", "", |product| {
        product_result(design, product).shown().emphasised(product.fits().map(Emphasis::Kept))
    });
    let to_check = to_be_checked(&design.products);
    html! {
        @if !design.products.is_empty() {
            (Table::new(&design.products, columns).class("study"))
            p.small {
                "A margin of 1 and more is kept. Each product is tested with its own two sides; its \
                 supplier’s gradation decides."
                @if let Some(sentence) = to_check { " " (clean(&sentence)) }
            }
        }
    }
}

const RECORD: &str = "designs.json";

/// Maximum number of rows in the page's table; all are in `designs.csv`.
const LISTED: usize = 2000;

/// Writes `designs.html` and `figures/designs.svg` into the folder of the designs of many samples. A missing
/// or malformed file is an error, and nothing is written then.
pub(crate) fn write_designs(folder: &Path) -> Result<Written, ReportError> {
    let path = folder.join(RECORD);
    let all: DesignedSamples = json(&path)?;
    if all.rows.is_empty() {
        return Err(refused(&path, "rows", "empty".into(), "one or more"));
    }
    let names = html! {
        (titled_by_file("Samples", "Samples", &all.samples))
        @if all.dispersive { ", dispersive" }
        ", by the rules of practice alone"
    };
    let lines = designed::lines(&all, DESIGN_EACH_AGAIN, SizeUnit::of(false, all.inches));
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
        .section("Notes on the files", &file_notes(&all.notes))
        .section("Appendix: the soils", &appendix(&all))
        .section("How this was made", &made)
        .write(folder, "designs.html", &html! {})
}

fn appendix(all: &DesignedSamples) -> Markup {
    let mut soils: Vec<SizedSoil> = Vec::new();
    for row in all.rows.iter().take(LISTED).filter(|row| !row.gradation.is_empty()) {
        soils.push((brief_name(&row.sample), &row.gradation));
        if !row.regraded.is_empty() {
            soils.push((format!("{}, regraded", brief_name(&row.sample)), &row.regraded));
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

fn table(all: &DesignedSamples) -> Markup {
    let columns = designed::columns(SizeUnit::of(false, all.inches));
    let table = Table::new(all.rows.iter().take(LISTED), columns)
        .class("cases")
        .showing("sample", |row| html! { bdi { (brief_name(&row.sample)) } });
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

/// Limit of practice of every sample against its D85B; `None` without a number.
fn limits(all: &DesignedSamples) -> Option<Drawn> {
    let limit = |row: &DesignedSample| Some((row.d85b_mm?, row.d15f_max_mm?, row.governs == Some(1)));
    let practice: Vec<_> = all.rows.iter().filter_map(limit).collect();
    practice.first()?;
    let (low, high) = positive_range(practice.iter().map(|(d85, ..)| *d85));
    let x = Axis::log("D85B after regrading (mm)", low / 1.2, high * 1.2);
    let (low, high) = positive_range(practice.iter().map(|(_, mm, _)| *mm));
    let y = Axis::log("D15F (mm)", low / 1.2, high * 1.2);
    let what = "Maximum D15F by practice against D85B of each sample";
    let mut figure = Figure::new("How coarse the filter may be", what, x, y).names_above();
    let governs = all.governing().first().and_then(|row| row.d15f_max_mm);
    if let Some(mm) = governs {
        figure.add(Mark::rule(Across::Y, mm, BLACK).dash(Dash::Dashed).label("governing sample"));
    }
    let point = |(d85, mm, governs): &(f64, f64, bool)| {
        Mark::point(*d85, *mm, BLUE, if *governs { Shape::Square } else { Shape::Circle })
    };
    figure.add_points("limit of practice", practice.iter().map(point));
    let caption = "The strictest limit of practice of each sample. Square: the sample that governs. The \
                   dashed line is the D15F beyond which that sample is not served.";
    Some(Drawn::new("designs", figure, caption))
}

#[cfg(test)]
mod tests {
    use super::*;
    use voidwalk_core::gradation::Gradation;
    use voidwalk_practice::SpecificationOptions;
    use voidwalk_practice::design::specification::margins;

    #[test]
    fn products_are_said_to_fit_as_far_as_is_known() {
        let base = Gradation::from_lines(&[(0.002, 0.0), (0.075, 60.0), (2.0, 100.0)]).unwrap();
        let core = Specification::of("core", &[("core".into(), base)], SpecificationOptions::default());
        let line = products_line(&core);
        assert_eq!(line, "Standard products that fit: ASTM C33 fine aggregate");
        assert!(sieve_limits(&core).into_string().contains("D15F of each delivery must lie within 0.140 to"));
        // The maximum is unknown, and the minimum alone refuses the finest product.
        let unknown =
            Specification { d15f_max_mm: None, products: margins((Some(0.2), 0.2), None), ..core.clone() };
        assert!(products_line(&unknown).starts_with("No other product is known to fit"));
        let unknown = Specification { products: margins((Some(0.1), 0.1), None), ..unknown };
        assert!(products_line(&unknown).starts_with("No other product is known to fit"));
        let page = products(&core).into_string();
        assert!(
            page.contains("Limits to be checked against the standard: ASTM C33 fine aggregate, "),
            "{page}"
        );
    }
}
