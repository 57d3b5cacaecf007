//! The page of a specification: what to watch, both sides of the band on the form of gradations, limits
//! sieve by sieve, standard products, the steps with their numbers, and the base. The page of a design has
//! the same.

use std::path::Path;

use maud::{Markup, Render, html};

use super::appendix::input_files;
use super::cover::program;
use super::error::ReportError;
use super::files::json;
use super::given_soils::GivenSoils;
use super::names::titled_by_file;
use super::numbers::{SizeUnit, known, significant, trimmed};
use super::section::Sections;
use super::shell::{clean, unbroken};
use super::table::Table;
use super::written::Written;
use crate::outcome::design::products::to_be_checked;
use crate::outcome::design::specification::ProductMargin;
use crate::outcome::design::{DesignFinding, Specification, SpecificationStep};
use crate::verdict::DESIGN_AGAIN;
use crate::verdict::fitting::FITS;

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
    super::workbook::write_specification_workbook(folder, &of, None)?;
    let (stated, soils) = (Stated::of(&of), GivenSoils::of_specification(&of));
    let made = html! { table.facts { tbody { (input_files(&of.inputs)) } } };
    let title = "Specification of a filter";
    Sections::new(title, title, &names)
        .cover(&of.cover, &program(&of.version, of.commit.as_deref()), None)
        .inches(of.inches)
        .words(&html! { section.sheet { (answer(&of)) } })
        .figures(soils.figure(of.band.as_ref(), of.band_in_words().as_deref()))
        .section("More warnings", &more_warnings(&of))
        .section("Limits sieve by sieve", &stated.limits)
        .section("Standard products", &products(&of, true))
        .section("Step by step", &stated.words)
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

/// The parts of a specification that its own page and that of a design show.
#[derive(Default)]
pub(super) struct Stated {
    /// Every step.
    pub words: Markup,
    /// What a delivery may have finer than each sieve.
    pub limits: Markup,
    /// Margins of standard products.
    pub products: Markup,
}

impl Stated {
    pub(super) fn of(specification: &Specification) -> Self {
        Self {
            words: steps(specification),
            limits: limits(specification),
            products: products(specification, false),
        }
    }
}

fn answer(of: &Specification) -> Markup {
    html! {
        section.verdict {
            @if let Some(band) = of.band_in_words() { p.word.long { (clean(&band)) ", by practice." } }
            (to_specify(of))
            @if let Some(said) = of.without_margin_in_words() { p { (unbroken(&said)) "." } }
            @if let Some(said) = of.if_dispersive_in_words(DESIGN_AGAIN) {
                p { (clean(&said)) "." }
            }
            @if let Some(why) = &of.no_band { p.word.long { "No band." } p { (clean(why)) } }
            (cautions(&of.findings))
            @if of.findings.len() > WARNINGS { p.small { "More warnings stand below." } }
            (still_to_set(of))
            p { (clean(&of.products_in_words())) "." }
        }
    }
}

/// Warnings that stand in the answer; those of further curves stand below it.
const WARNINGS: usize = 4;

fn more_warnings(of: &Specification) -> Markup {
    let more = of.findings.iter().skip(WARNINGS);
    html! {
        @if of.findings.len() > WARNINGS { ul { @for found in more { li { (clean(&found.words())) } } } }
    }
}

/// The first warnings of the base itself.
pub(super) fn cautions(of: &[DesignFinding]) -> Markup {
    html! {
        @for found in of.iter().take(WARNINGS) {
            p.caution { b { "Warning" } ": " (unbroken(&found.words())) }
        }
    }
}

/// What the specification lacks; nothing without a band.
pub(super) fn still_to_set(of: &Specification) -> Markup {
    html! { @if let Some(said) = of.still_to_set() { p.caution { b { (unbroken(&said)) } } } }
}

/// Why the band begins where it does, and the sizes of its two sides; nothing without a band.
pub(super) fn to_specify(of: &Specification) -> Markup {
    let Some(band) = &of.band else { return html! {} };
    let unit = SizeUnit::of(false, of.inches);
    let sides = [("Fine side", true), ("Coarse side", false)];
    let table = Table::of(&sides).class("band").name(unit.name(), |side| side.0);
    let table = band.sizes.iter().fold(table, |table, size| {
        table.number(format!("D{}F", size.percent), move |side: &(_, bool)| match side.1 {
            true => unit.least(size.min_mm),
            false => unit.greatest(size.max_mm),
        })
    });
    html! {
        @if let Some(raised) = of.raised_in_words() { p { (clean(&raised)) "." } }
        (table)
    }
}

fn steps(of: &Specification) -> Markup {
    let unit = SizeUnit::of(false, of.inches);
    html! {
        p.small {
            "The order of the steps is ours, as procedures commonly have it, and not that of the NRCS \
             handbook (National Engineering Handbook, Part 633, Chapter 26). Each step names the text that \
             its numbers come from, or says that they are this program’s own."
        }
        (Table::of(&of.steps).class("study steps")
            .name("What is done, formula, source", |step: &SpecificationStep| html! {
                (step.step) ". " (clean(&step.does))
                @for text in [&step.formula, &step.note] {
                    @if !text.is_empty() { br; span.small { (clean(text)) } }
                }
                @if !step.source.is_empty() { br; span.small { "Source: " (clean(&step.source)) } }
            })
            .text("Numbers", |step| html! {
                @for value in &step.values {
                    (clean(&value.name)) " = " b { (known(value.words_in(unit), |words| words)) } br;
                }
            })
            .render())
    }
}

fn limits(of: &Specification) -> Markup {
    if of.band.is_none() {
        return html! { @if let Some(why) = &of.no_band { p { (clean(why)) } } };
    }
    html! {
        (Table::of(&of.limits)
            .name("Sieve", |limit| clean(&limit.sieve))
            .number("Opening (mm)", |limit| significant(limit.opening_mm))
            .number("Least finer (%)", |limit| trimmed(limit.min_percent_finer))
            .number("Greatest finer (%)", |limit| limit.max_percent_finer.map_or(String::new(), trimmed))
            .render())
        @if let Some(beside) = of.beside_limits() { p { (clean(&beside)) } }
        @if of.if_dispersive_in_words(DESIGN_AGAIN).is_some() {
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

/// Margins of standard products; who judges them elsewhere says there whether they fit.
fn products(of: &Specification, says_fit: bool) -> Markup {
    let margin = |value: Option<f64>| known(value, significant);
    let unit = SizeUnit::of(false, of.inches);
    let mut table = Table::of(&of.products)
        .class("study")
        .name("Product", |of: &ProductMargin| clean(&of.product))
        .number("D15, fine to coarse side (mm)", |of| {
            let size = |mm: f64| significant(mm) + &unit.beside(mm);
            format!("{} to {}", size(of.d15_fine_mm), size(of.d15_coarse_mm))
        })
        .number("Drains: finest D15 / minimum D15F", |of| margin(of.drains_by))
        .number("Retains: maximum D15F / coarsest D15", |of| margin(of.holds_by))
        .text("What else its sides do not keep", |of| clean(&of.not_kept));
    if says_fit {
        table = table.text("", |product| match (&*of.product_in_words(product), product.fits()) {
            (FITS, _) => html! { span.keeps { "✓ " (FITS) } },
            (said, Some(false)) => html! { span.breaks { "✗ " (said) } },
            (said, _) => html! { (said) },
        });
    }
    let to_check = to_be_checked(of.products.iter().map(|of| (of.product.as_str(), of.source.as_str())));
    html! {
        @if !of.products.is_empty() {
            (table.render())
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
    use crate::gradation::Gradation;
    use crate::outcome::design::specification::margins;
    use crate::verdict::SpecificationOptions;

    #[test]
    fn products_are_said_to_fit_as_far_as_is_known() {
        let base = Gradation::from_lines(&[(0.002, 0.0), (0.075, 60.0), (2.0, 100.0)]).unwrap();
        let core = Specification::of("core", &[("core".into(), base)], SpecificationOptions::default());
        let said = core.products_in_words();
        assert_eq!(said, "Standard products that fit: ASTM C33 fine aggregate");
        assert!(limits(&core).into_string().contains("D15F of each delivery must lie between 0.140 and"));
        // The greatest is not known, and the least alone refuses the finest product.
        let unknown =
            Specification { d15f_max_mm: None, products: margins((Some(0.2), 0.2), None), ..core.clone() };
        assert!(unknown.products_in_words().starts_with("No other product is known to fit"));
        let unknown = Specification { products: margins((Some(0.1), 0.1), None), ..unknown };
        assert!(unknown.products_in_words().starts_with("No other product is known to fit"));
        let page = products(&core, true).into_string();
        assert!(
            page.contains("Limits to be checked against the standard: ASTM C33 fine aggregate, "),
            "{page}"
        );
    }
}
