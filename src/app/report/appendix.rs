//! The appendix of a report page: gradations as tables of numbers, and the files that were read.

use maud::{Markup, html};

use super::names::{input_name, is_named, soil_name};
use super::quantity::{SizeUnit, percent, significant};
use super::shell::{clean, fact};
use super::table::Table;
use crate::outcome::record::Outcome;
use crate::outcome::table::Columns;
use crate::words::grading;
use voidwalk_practice::InputFile;
use voidwalk_practice::soil_sizes::us_sieve;

/// Rows shown of each gradation; all are in the record.
const ROWS: usize = 200;

/// A gradation: its kind, its name, and its rows of size and percent finer.
pub(super) struct TabledSoil<'a> {
    /// Kind of the soil, as `Filter`.
    pub kind: &'a str,
    /// Its name, which may say no more.
    pub name: &'a str,
    /// Size, and percent finer by mass.
    pub rows: &'a [[f64; 2]],
}

/// Filter and base as the walk read them: the values that a reader types in to check it.
pub(super) fn of_run(outcome: &Outcome, unit: SizeUnit) -> Markup {
    let inputs = &outcome.inputs;
    let (filter, base) = (&inputs.filter, &inputs.base);
    let sampled = base.as_sampled.as_ref();
    let mut soils = vec![TabledSoil { kind: "Filter", name: &filter.name, rows: &filter.gradation }];
    let name = if is_named("base", &base.name) { base.name.as_str() } else { "" };
    if let Some(sampled) = sampled {
        soils.push(TabledSoil { kind: "Base, as sampled", name, rows: &sampled.gradation });
    }
    let kind = sampled.map_or("Base".into(), |_| format!("Base, {}", grading(&base.size())));
    soils.push(TabledSoil { kind: &kind, name, rows: &base.gradation });
    let note = html! {
        p.small {
            "Percent finer by mass, as walked and as the rules read them"
            @if sampled.is_some() { ", and of the base as it was sampled: permeability is judged by that" }
            "; " (BETWEEN) " Files that they were \
             read from are kept in the folder " code { "inputs" } " of this run."
        }
    };
    let gradations = gradations(&soils, unit, "outcome.json");
    html! { section.appendix { h2 { "Appendix: the two gradations" } (note) (gradations) } }
}

/// Interpolation between the rows of a gradation.
pub(super) const BETWEEN: &str = "between two rows straight lines on semi-logarithmic paper.";

/// Gradations side by side; the record has all of their rows.
pub(super) fn gradations(soils: &[TabledSoil], unit: SizeUnit, record: &str) -> Markup {
    html! { div.gradations { @for soil in soils { (gradation(soil, unit, record)) } } }
}

/// Every file that was read, as rows of a table of facts.
pub(super) fn input_files(files: &[InputFile]) -> Markup {
    html! { @for file in files {
        (fact("Input file", format!("{} (XXH3 {})", input_name(&file.name), file.xxh3)))
    } }
}

fn gradation(soil: &TabledSoil, unit: SizeUnit, record: &str) -> Markup {
    let TabledSoil { kind, name, rows } = soil;
    let finest = rows.iter().map(|row| row[1]).fold(100.0, f64::min);
    // The coarsest first, as a laboratory writes it.
    let shown: Vec<&[f64; 2]> = rows.iter().rev().take(ROWS).collect();
    let mut columns = Columns::default();
    if unit == SizeUnit::MmAndInches {
        columns = columns.name("us_sieve", "US sieve", |row: &[f64; 2]| us_sieve(row[0]).unwrap_or_default());
    }
    let heading = format!("Size ({})", unit.short());
    let percent_finer = |row: &[f64; 2]| significant((row[1] * 100.0).round() / 100.0).in_digits(4);
    let columns = columns.number("size", heading, |row| significant(row[0]).in_digits(4));
    let columns = columns.number("percent_finer", "Percent finer", percent_finer);
    html! {
        div {
            h3 { (kind) @if is_named(kind, name) { ": " bdi { (clean(soil_name(name))) } } }
            (Table::of(shown, columns))
            @if finest > 0.0 {
                p.small {
                    (percent(finest / 100.0)) " are finer than the finest size; how fine is not known."
                }
            }
            @if rows.len() > ROWS { p.small { "The rest is in " (record) "." } }
        }
    }
}
