//! A workbook to fill in: a base and a filter as sieve tables, with instructions.

use super::sheet::Sheet;
use crate::outcome::table::Columns;
use voidwalk_practice::design::SieveSeries;

/// Sheets of the workbook: the soils first.
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
    Sheet::of(name, &columns(), &rows(example))
}

fn columns<'a>() -> Columns<'a, (f64, f64)> {
    let columns = Columns::default().column("Opening (mm)", |row: &(f64, f64)| row.0);
    columns.column("Sample 1 (% finer)", |row| row.1)
}

fn rows(example: &Example) -> Vec<(f64, f64)> {
    SieveSeries::Us.openings().iter().copied().zip(*example).collect()
}

/// Instructions, in words that no reader takes for a sieve table.
fn how() -> Sheet {
    let columns = Columns::default().column("How to fill in", |line: &&str| line.to_string());
    let lines = [
        "Replace the examples on the sheets Base and Filter by your own openings and percents finer.",
        "Add or remove rows as you need. A further sample is a further column, headed as Sample 2 (% finer).",
        "The coarsest row must have 100 % finer. Leave no row empty between two others.",
        "Add hydrometer sizes below the finest sieve if you have them: retention depends on fines and D85.",
        "Where a command reads one soil, name its sheet: site.xlsx#Base. Else both sheets would be one soil.",
        "Delete a sheet that you do not need. voidwalk soil FILE.xlsx shows what is read.",
    ];
    Sheet::of("How to fill in", &columns, &lines)
}

#[cfg(test)]
mod tests {
    use super::super::sheet::workbook;
    use super::*;
    use voidwalk_sheets::soils_in_file;

    /// The last sheet asks for one column per further sample.
    #[test]
    fn a_template_with_a_further_sample_is_read_as_it_says() {
        let columns = columns().column("Sample 2 (% finer)", |row| row.1);
        let filled = Sheet::of("Base", &columns, &rows(&BASE));
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("site.xlsx");
        std::fs::write(&path, workbook("a", &[filled, soil("Filter", &FILTER), how()]).unwrap()).unwrap();
        let soils = soils_in_file(&path, None).unwrap();
        let names: Vec<&str> = soils.iter().map(|soil| soil.name.as_str()).collect();
        assert_eq!(names, ["Base/Sample 1 (% finer)", "Base/Sample 2 (% finer)", "Filter"]);
        assert_eq!(soils[0].points, soils[1].points);
        // Sieves that everything passes are one row: the finest of them.
        assert_eq!((soils[0].points.len(), soils[0].points[0].row()), (8, [0.075, 38.0]));
    }
}
