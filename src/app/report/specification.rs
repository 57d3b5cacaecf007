//! The page of a specification: warnings, both sides of the band on the form of gradations, limits sieve by
//! sieve, standard products, the steps with their numbers, and the base.

use std::path::Path;

use maud::{Markup, html};

use super::appendix::input_files;
use super::cover::program;
use super::error::ReportError;
use super::files::json;
use super::given_soils::GivenSoils;
use super::names::titled_by_file;
use super::section::Sections;
use super::shell::{clean, unbroken};
use super::shown::known;
use super::table::Table;
use super::written::Written;
use crate::outcome::table::{Columns, Emphasis, Shown, TableCell};
use crate::words::products::{columns, product as product_result, products as products_line, to_be_checked};
use crate::words::row_note;
use crate::words::specification::{
    DESIGN_AGAIN, band, beside_limits, if_dispersive, limit, limit_columns, no_band, raised, step_name,
    step_notes, step_value, still_to_set as still_to_set_line, without_margin,
};
use voidwalk_practice::design::specification::StepValue;
use voidwalk_practice::design::{Specification, SpecificationStep};
use voidwalk_practice::quantity::{NumberRole, SizeUnit, length};

/// Writes `specification.html`, its figure and `specification.xlsx` into the folder of a specification, from
/// `specification.json` there.
///
/// # Errors
/// The file is missing or malformed, or something cannot be written.
pub fn write_specification(folder: &Path) -> Result<Written, ReportError> {
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
    let soils = GivenSoils::of_specification(&design);
    let made = html! { table.facts { tbody { (input_files(&design.inputs)) } } };
    let title = "Specification of a filter";
    let page = Sections::new(title, title, &names)
        .cover(&design.cover, &program(&design.version, design.commit.as_deref()), None)
        .words(&html! { section.sheet { (answer(&design)) } })
        .figures(
            soils.figure(design.band.as_ref(), band(&design, SizeUnit::of(false, design.inches)).as_deref()),
        );
    page.section("More warnings", &more_warnings(&design))
        .section("Limits sieve by sieve", &limits(&design))
        .section("Standard products", &products(&design))
        .section("Step by step", &steps(&design))
        .section(soils.heading(), &soils.appendix())
        .section(
            "How this was made",
            &if design.inputs.is_empty() {
                html! {}
            } else {
                made
            },
        )
        .write(folder, "specification.html", &footer)
}

/// The answer of practice.
fn answer(design: &Specification) -> Markup {
    let unit = SizeUnit::of(false, design.inches);
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
            (cautions(design))
            @if design.notes.len() > WARNINGS { p.small { "More warnings stand below." } }
            (still_to_set(design))
            p { (clean(&products_line(design))) "." }
        }
    }
}

/// Number of warnings in the answer; those of further curves are below it.
const WARNINGS: usize = 4;

fn more_warnings(design: &Specification) -> Markup {
    let (more, unit) = (design.notes.iter().skip(WARNINGS), SizeUnit::of(false, design.inches));
    html! {
        @if design.notes.len() > WARNINGS { ul { @for row in more { li { (clean(&row_note(row, unit))) } } } }
    }
}

/// The first warnings of the base itself.
fn cautions(design: &Specification) -> Markup {
    let unit = SizeUnit::of(false, design.inches);
    html! {
        @for row in design.notes.iter().take(WARNINGS) {
            p.caution { b { "Warning" } ": " (unbroken(&row_note(row, unit))) }
        }
    }
}

/// Gaps of the specification; empty without a band.
fn still_to_set(design: &Specification) -> Markup {
    let gaps = still_to_set_line(design, SizeUnit::of(false, design.inches));
    html! { @if let Some(gaps) = gaps { p.caution { b { (unbroken(&gaps)) } } } }
}

/// The reason for the beginning of the band, and the sizes of its two sides; empty without a band.
fn to_specify(design: &Specification) -> Markup {
    let Some(band) = &design.band else { return html! {} };
    let unit = SizeUnit::of(false, design.inches);
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
        (Table::of(&sides, columns).class("band"))
    }
}

fn steps(design: &Specification) -> Markup {
    let unit = SizeUnit::of(false, design.inches);
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
        (Table::of(&design.steps, columns).class("study steps").showing("values", |step| html! {
            @for value in &step.values { (clean(&value.name)) " = " b { (number(value)) } br; }
        }))
    }
}

fn limits(design: &Specification) -> Markup {
    if design.band.is_none() {
        let unit = SizeUnit::of(false, design.inches);
        return html! { @if let Some(why) = &design.no_band { p { (clean(&no_band(why, unit))) } } };
    }
    html! {
        (Table::of(&design.limits, limit_columns()))
        @if let Some(beside) = beside_limits(design, SizeUnit::of(false, design.inches)) {
            p { (clean(&beside)) }
        }
        @if if_dispersive(design, DESIGN_AGAIN, SizeUnit::of(false, design.inches)).is_some() {
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

/// Margins of standard products, with their result.
fn products(design: &Specification) -> Markup {
    let columns = columns(SizeUnit::of(false, design.inches)).text("result", "", |product| {
        product_result(design, product).shown().emphasised(product.fits().map(Emphasis::Kept))
    });
    let to_check = to_be_checked(&design.products);
    html! {
        @if !design.products.is_empty() {
            (Table::of(&design.products, columns).class("study"))
            p.small {
                "A margin of 1 and more is kept. Each product is tested with its own two sides; its \
                 supplier’s gradation decides."
                @if let Some(sentence) = to_check { " " (clean(&sentence)) }
            }
        }
    }
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
        assert!(limits(&core).into_string().contains("D15F of each delivery must lie within 0.140 to"));
        // The greatest is unknown, and the least alone refuses the finest product.
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
