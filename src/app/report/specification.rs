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
    let of: Specification = json(&folder.join("specification.json"))?;
    let names = html! {
        (titled_by_file("Base", "Base", &of.base)) @if of.dispersive { ", dispersive" }
        ", by the rules of practice alone"
    };
    let footer = html! {
        p { "By the rules of practice, without a walk. It does not replace a filter test or a designer’s \
             judgement." }
        p.small { "voidwalk " (of.version) "." }
    };
    #[cfg(feature = "xlsx")]
    super::workbook::write_specification_workbook(folder, &of)?;
    let soils = GivenSoils::of_specification(&of);
    let made = html! { table.facts { tbody { (input_files(&of.inputs)) } } };
    let title = "Specification of a filter";
    let page = Sections::new(title, title, &names)
        .cover(&of.cover, &program(&of.version, of.commit.as_deref()), None)
        .words(&html! { section.sheet { (answer(&of)) } })
        .figures(soils.figure(of.band.as_ref(), band(&of, SizeUnit::of(false, of.inches)).as_deref()));
    page.section("More warnings", &more_warnings(&of))
        .section("Limits sieve by sieve", &limits(&of))
        .section("Standard products", &products(&of))
        .section("Step by step", &steps(&of))
        .section(soils.heading(), &soils.appendix())
        .section(
            "How this was made",
            &if of.inputs.is_empty() {
                html! {}
            } else {
                made
            },
        )
        .write(folder, "specification.html", &footer)
}

/// The answer of practice.
fn answer(of: &Specification) -> Markup {
    let unit = SizeUnit::of(false, of.inches);
    html! {
        section.verdict {
            @if let Some(band) = band(of, unit) { p.word.long { (clean(&band)) ", by practice." } }
            p { "Limit: " (clean(&limit(of, unit))) "." }
            (to_specify(of))
            @if let Some(said) = without_margin(of, unit) { p { (unbroken(&said)) "." } }
            @if let Some(said) = if_dispersive(of, DESIGN_AGAIN, unit) {
                p { (clean(&said)) "." }
            }
            @if let Some(why) = &of.no_band { p.word.long { "No band." } p { (clean(&no_band(why, unit))) } }
            (cautions(of))
            @if of.notes.len() > WARNINGS { p.small { "More warnings stand below." } }
            (still_to_set(of))
            p { (clean(&products_line(of))) "." }
        }
    }
}

/// Number of warnings in the answer; those of further curves are below it.
const WARNINGS: usize = 4;

fn more_warnings(of: &Specification) -> Markup {
    let (more, unit) = (of.notes.iter().skip(WARNINGS), SizeUnit::of(false, of.inches));
    html! {
        @if of.notes.len() > WARNINGS { ul { @for row in more { li { (clean(&row_note(row, unit))) } } } }
    }
}

/// The first warnings of the base itself.
fn cautions(of: &Specification) -> Markup {
    let unit = SizeUnit::of(false, of.inches);
    html! {
        @for row in of.notes.iter().take(WARNINGS) {
            p.caution { b { "Warning" } ": " (unbroken(&row_note(row, unit))) }
        }
    }
}

/// Gaps of the specification; empty without a band.
fn still_to_set(of: &Specification) -> Markup {
    let said = still_to_set_line(of, SizeUnit::of(false, of.inches));
    html! { @if let Some(said) = said { p.caution { b { (unbroken(&said)) } } } }
}

/// The reason for the beginning of the band, and the sizes of its two sides; empty without a band.
fn to_specify(of: &Specification) -> Markup {
    let Some(band) = &of.band else { return html! {} };
    let unit = SizeUnit::of(false, of.inches);
    let sides = [("Fine side", true), ("Coarse side", false)];
    let columns = Columns::default().name("side", unit.name(), |side: &(&'static str, bool)| side.0);
    let columns = band.sizes.iter().fold(columns, |columns, of| {
        let [name, heading] = [format!("d{}f_mm", of.percent), format!("D{}F", of.percent)];
        columns.number(name, heading, move |side| match side.1 {
            true => length(of.min_mm, unit).role(NumberRole::Least).in_cell(),
            false => length(of.max_mm, unit).role(NumberRole::Greatest).in_cell(),
        })
    });
    html! {
        @if let Some(raised) = raised(of, unit) { p { (clean(&raised)) "." } }
        (Table::of(&sides, columns).class("band"))
    }
}

fn steps(of: &Specification) -> Markup {
    let unit = SizeUnit::of(false, of.inches);
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
        (Table::of(&of.steps, columns).class("study steps").showing("values", |step| html! {
            @for value in &step.values { (clean(&value.name)) " = " b { (number(value)) } br; }
        }))
    }
}

fn limits(of: &Specification) -> Markup {
    if of.band.is_none() {
        let unit = SizeUnit::of(false, of.inches);
        return html! { @if let Some(why) = &of.no_band { p { (clean(&no_band(why, unit))) } } };
    }
    html! {
        (Table::of(&of.limits, limit_columns()))
        @if let Some(beside) = beside_limits(of, SizeUnit::of(false, of.inches)) { p { (clean(&beside)) } }
        @if if_dispersive(of, DESIGN_AGAIN, SizeUnit::of(false, of.inches)).is_some() {
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
fn products(of: &Specification) -> Markup {
    let columns = columns(SizeUnit::of(false, of.inches)).text("result", "", |product| {
        product_result(of, product).shown().emphasised(product.fits().map(Emphasis::Kept))
    });
    let to_check = to_be_checked(&of.products);
    html! {
        @if !of.products.is_empty() {
            (Table::of(&of.products, columns).class("study"))
            p.small {
                "A margin of 1 and more is kept. Each product is tested with its own two sides; its \
                 supplier’s gradation decides."
                @if let Some(said) = to_check { " " (clean(&said)) }
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
        let said = products_line(&core);
        assert_eq!(said, "Standard products that fit: ASTM C33 fine aggregate");
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
