//! The appendix of a report page: both gradations as tables of numbers.

use maud::{Markup, html};

use super::names::{is_named, soil_name};
use super::numbers::{SizeUnit, in_digits, percent, trimmed};
use super::shell::clean;
use super::table::Table;
use crate::outcome::record::Outcome;
use crate::outcome::soil_sizes::us_sieve;

/// Rows shown of each gradation; all are in `outcome.json`.
const ROWS: usize = 200;

/// Filter and base as the walk read them: what a reader types in to check it.
pub(super) fn gradations(outcome: &Outcome, unit: SizeUnit) -> Markup {
    let inputs = &outcome.inputs;
    let (filter, base) = (&inputs.filter, &inputs.base);
    html! {
        section.appendix {
            h2 { "Appendix: the two gradations" }
            p.small {
                "Percent finer by mass, as walked and as the rules read them; between two rows straight \
                 lines on semi-logarithmic paper. Files that they were read from are kept in the folder "
                code { "inputs" } " of this run."
            }
            div.gradations {
                (gradation("Filter", &filter.name, &filter.gradation, unit))
                (gradation("Base", &base.name, &base.gradation, unit))
            }
        }
    }
}

fn gradation(kind: &str, name: &str, rows: &[[f64; 2]], unit: SizeUnit) -> Markup {
    let finest = rows.iter().map(|row| row[1]).fold(100.0, f64::min);
    // The coarsest first, as a laboratory writes it.
    let shown: Vec<&[f64; 2]> = rows.iter().rev().take(ROWS).collect();
    let mut table = Table::of(&shown);
    let with_sieves = unit == SizeUnit::MmAndInches;
    if with_sieves {
        table = table.name("US sieve", |row| us_sieve(row[0]).unwrap_or_default());
    }
    let heading = SizeUnit::of(unit == SizeUnit::D0f, false).name();
    let table = table
        .number(format!("Size ({heading})"), |row| in_digits(row[0], 4))
        .number("Percent finer", |row| trimmed((row[1] * 100.0).round() / 100.0));
    html! {
        div {
            h3 { (kind) @if is_named(kind, name) { ": " bdi { (clean(&soil_name(name))) } } }
            (table)
            @if finest > 0.0 {
                p.small {
                    (percent(finest / 100.0)) " are finer than the finest size; how fine is not known."
                }
            }
            @if rows.len() > ROWS { p.small { "The rest is in outcome.json." } }
        }
    }
}
