//! A workbook to fill in: a base and a filter as sieve tables, and how to fill them in.

use super::sheet::{Entry, Sheet};
use crate::outcome::design::SieveSeries;

/// Its sheets: the soils first.
pub(super) fn sheets() -> Vec<Sheet> {
    vec![soil("Base", &BASE), soil("Filter", &FILTER), how()]
}

/// Percent finer of an example at the sieves of the United States, the coarsest first.
type Example = [f64; 14];

const BASE: Example =
    [100.0, 100.0, 100.0, 100.0, 100.0, 100.0, 100.0, 99.0, 96.0, 91.0, 82.0, 68.0, 52.0, 38.0];

const FILTER: Example =
    [100.0, 100.0, 100.0, 100.0, 100.0, 100.0, 100.0, 97.0, 85.0, 68.0, 45.0, 18.0, 5.0, 1.5];

fn soil(name: &'static str, example: &Example) -> Sheet {
    let mut sheet = Sheet::new(name, &["Opening (mm)", "Percent finer by mass (%)"]);
    for ((_, opening), percent) in SieveSeries::Us.sieves().iter().zip(example) {
        sheet.row([(*opening).into(), (*percent).into()]);
    }
    sheet
}

/// What to do, in words that no reader takes for a sieve table.
fn how() -> Sheet {
    let mut sheet = Sheet::new("How to fill in", &["How to fill in"]);
    for line in [
        "Replace the examples on the sheets Base and Filter by your own openings and percents finer.",
        "Add or remove rows as you need. Add a column for each further sample and name it above its percents.",
        "The coarsest row must have 100 % finer. Leave no row empty between two others.",
        "Add hydrometer sizes below the finest sieve if you have them: retention depends on fines and D85.",
        "Delete a sheet that you do not need. voidwalk soil FILE.xlsx shows what is read.",
    ] {
        sheet.row([Entry::from(line)]);
    }
    sheet
}
