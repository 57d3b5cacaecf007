//! Answers as workbooks: numbers as numbers, units in the headings, the same bytes every time.

use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use rust_xlsxwriter::{DocProperties, ExcelDateTime, Format, Workbook, Worksheet, XlsxError};

use super::files::{ReportError, malformed};
use super::folder::RunFolder;
use super::names::soil_name;
use super::shell::clean;
use crate::outcome::record::{Outcome, Replicate, Run, Statistic};
use crate::outcome::table::{CellValue, Columns, TableCell};
use crate::words::products::{columns as product_columns, product as product_result};
use crate::words::specification::{
    StepRow, beside_limits, limit_columns, no_band, step_rows, still_to_set, without_margin,
};
use crate::words::{dispersive_limit, first_lines, row_note, rule, sentence};
use voidwalk_core::store::write_whole;
use voidwalk_core::text::shorten;
use voidwalk_practice::design::size_band::BandSize;
use voidwalk_practice::design::{SieveSeries, Specification};
use voidwalk_practice::quantity::SizeUnit;
use voidwalk_practice::{Decision, Headline, RuleRole};

pub(super) const VERDICT: &str = "verdict.xlsx";

const SPECIFICATION: &str = "specification.xlsx";

/// Writes `verdict.xlsx` into `into`, from the files of a finished run folder: the answer, the inputs, every
/// rule with its formula and source, every run, both gradations, and the program version.
pub(crate) fn write_verdict_workbook(folder: &Path, into: &Path) -> Result<PathBuf, ReportError> {
    let path = into.join(VERDICT);
    write_whole(&path, &verdict_workbook(folder)?)?;
    Ok(path)
}

pub(super) fn verdict_workbook(folder: &Path) -> Result<Vec<u8>, ReportError> {
    let run = &RunFolder::read(folder)?;
    let (outcome, decision) = (&run.outcome, &run.decision);
    let sheets = [
        verdict(outcome, decision),
        inputs(outcome),
        rules(decision),
        runs(outcome),
        gradations(outcome),
        provenance(run),
    ];
    bytes(&folder.join(VERDICT), "voidwalk: verdict", &sheets)
}

/// Writes `specification.xlsx` into a folder: steps, limits, band, products, and the base. Writes nothing if
/// the clock is before 1970.
pub(super) fn write_specification_workbook(folder: &Path, design: &Specification) -> Result<(), ReportError> {
    if is_before_1970() {
        return Ok(());
    }
    let path = folder.join(SPECIFICATION);
    let sheets =
        [summary(design), limits(design), band(design), products(design), steps(design), base(design)];
    Ok(write_whole(&path, &bytes(&path, "voidwalk: specification of a filter", &sheets)?)?)
}

/// Workbook to fill in, with one column per soil, for [`voidwalk_sheets::soils_in_file`], as bytes. A clock
/// before 1970 is an error.
pub(crate) fn soil_template() -> Result<Vec<u8>, ReportError> {
    let sheets = [soil("Base", &BASE), soil("Filter", &FILTER), how()];
    bytes(Path::new("template"), "voidwalk: sieve tables", &sheets)
}

/// Workbook as bytes; `path` names it in errors.
fn bytes(path: &Path, title: &str, sheets: &[Sheet]) -> Result<Vec<u8>, ReportError> {
    workbook(title, sheets).map_err(|error| malformed(path, 0, error.to_string()))
}

/// Maximum number of characters in a cell; Excel allows slightly more.
const CELL: usize = 32_000;

/// Largest integer that a cell holds exactly.
const WHOLE: u64 = 1 << 53;

/// Creation date of every workbook, so that its bytes do not change from day to day.
const DAY: (u16, u8, u8) = (2000, 1, 1);

const WIDTHS: (usize, usize) = (8, 70);

struct Sheet {
    name: &'static str,
    headings: Vec<String>,
    rows: Vec<Vec<CellValue>>,
}

impl Sheet {
    fn new<'r, T: 'r>(
        name: &'static str,
        columns: &Columns<T>,
        rows: impl IntoIterator<Item = &'r T>,
    ) -> Self {
        let rows = rows.into_iter().map(|row| columns.values(row).map(held).collect()).collect();
        Self { name, headings: columns.headings(), rows }
    }

    fn items(name: &'static str) -> Self {
        Self { name, headings: ["Item", "Value", "Unit"].map(String::from).to_vec(), rows: Vec::new() }
    }

    fn item(&mut self, name: &str, value: impl TableCell, unit: &str) {
        self.rows.push([name.value(), value.value(), unit.value()].map(held).to_vec());
    }

    fn write(&self, sheet: &mut Worksheet) -> Result<(), XlsxError> {
        sheet.set_name(self.name)?;
        let (bold, wrapped) = (Format::new().set_bold(), Format::new().set_text_wrap());
        for (column, heading) in (0u16..).zip(&self.headings) {
            sheet.write_with_format(0, column, heading, &bold)?;
            let words = |row: &Vec<CellValue>| match row.get(usize::from(column)) {
                Some(CellValue::Words(words)) => words.chars().count(),
                _ => 0,
            };
            let widest = self.rows.iter().map(words).max().unwrap_or(0).max(heading.chars().count());
            sheet.set_column_width(column, (widest + 2).clamp(WIDTHS.0, WIDTHS.1) as f64)?;
        }
        for (line, row) in (1u32..).zip(&self.rows) {
            for (column, value) in (0u16..).zip(row) {
                match value {
                    CellValue::Empty => continue,
                    CellValue::Words(words) => {
                        sheet.write_string_with_format(line, column, words, &wrapped)?
                    }
                    CellValue::Number(number) => sheet.write_number(line, column, *number)?,
                    CellValue::Count(count) => sheet.write_number(line, column, *count as f64)?,
                    CellValue::Truth(truth) => sheet.write_boolean(line, column, *truth)?,
                };
            }
        }
        sheet.set_freeze_panes(1, 0)?;
        sheet.set_landscape();
        sheet.set_print_fit_to_pages(1, 0);
        Ok(())
    }
}

/// Value for a cell: words without hidden characters; numbers that no cell can hold become words.
fn held(value: CellValue) -> CellValue {
    match value {
        CellValue::Words(words) if words.is_empty() => CellValue::Empty,
        CellValue::Words(words) => CellValue::Words(shorten(&clean(&words), CELL)),
        CellValue::Number(number) if !number.is_finite() => CellValue::Words(number.to_string()),
        CellValue::Count(count) if count > WHOLE => CellValue::Words(count.to_string()),
        value => value,
    }
}

/// True if the clock shows a year in which the workbook writer panics.
fn is_before_1970() -> bool {
    SystemTime::now() < UNIX_EPOCH
}

const NO_THREADS: &str =
    "the system gives no more threads, and a workbook needs one per sheet: allow more (ulimit -u)";

/// True if the system can start this number of threads at once: the workbook writer takes one per sheet, or
/// panics.
fn has_threads(count: usize) -> bool {
    let threads: Vec<_> = (0..count).map(|_| std::thread::Builder::new().spawn(std::thread::park)).collect();
    let all = threads.iter().all(Result::is_ok);
    for thread in threads.into_iter().flatten() {
        thread.thread().unpark();
        let _ = thread.join();
    }
    all
}

/// Workbook of these sheets, as bytes. Errors: a sheet that does not fit into a workbook, such as one of more
/// than a million rows; a clock before 1970; no threads.
fn workbook(title: &str, sheets: &[Sheet]) -> Result<Vec<u8>, XlsxError> {
    if is_before_1970() {
        return Err(XlsxError::ParameterError("no workbook before 1970: set this machine's clock".into()));
    }
    let mut book = Workbook::new();
    let (year, month, day) = DAY;
    let made = ExcelDateTime::from_ymd(year, month, day)?;
    book.set_properties(
        &DocProperties::new().set_title(title).set_author("voidwalk").set_creation_datetime(&made),
    );
    for sheet in sheets {
        sheet.write(book.add_worksheet())?;
    }
    if !has_threads(sheets.len()) {
        return Err(XlsxError::ParameterError(NO_THREADS.into()));
    }
    book.save_to_buffer()
}

fn unit(outcome: &Outcome) -> &'static str {
    if outcome.inputs.scale_free { "D0F" } else { "mm" }
}

fn verdict(outcome: &Outcome, decision: &Decision) -> Sheet {
    let mut sheet = Sheet::items("Verdict");
    for (line, words) in first_lines(outcome, decision, SizeUnit::Mm) {
        sheet.item(line.name(), words, "");
    }
    let practice = outcome.practice.as_ref();
    sheet.item("Practice", decision.headline.map(Headline::words), "");
    sheet.item("Class of the model", outcome.model.class.words(), "");
    sheet.item("Limit of design of D15F", practice.and_then(|practice| practice.limit_mm), unit(outcome));
    let d15f = practice.and_then(|practice| practice.d15f_mm);
    sheet.item("D15F, at least", d15f.map(|ends| ends[0]), unit(outcome));
    sheet.item("D15F, at most", d15f.map(|ends| ends[1]), unit(outcome));
    sheet.item("D15F/D85B", outcome.ratios.d15f_over_d85b, "-");
    sheet.item("D15F/D95B", outcome.ratios.d15f_over_d95b, "-");
    sheet.item("Mass eroded from which a run erodes", outcome.threshold, "fraction of the base");
    for run in &outcome.summary {
        let Statistic { mean, sd, low, high } = run.eroded_mass_fraction;
        for (what, value) in [
            ("mean", Some(mean)),
            ("standard deviation", sd),
            ("lower end of the 95 % interval", low),
            ("upper end of the 95 % interval", high),
        ] {
            let name = format!("Mass eroded, run {}, {what}", run.run);
            sheet.item(&name, value, "fraction of the base");
        }
    }
    for (index, note) in outcome.notes.iter().enumerate() {
        sheet.item(&format!("Note {}", index + 1), sentence(note, SizeUnit::Mm), "");
    }
    sheet
}

fn inputs(outcome: &Outcome) -> Sheet {
    let mut sheet = Sheet::items("Inputs");
    let (inputs, unit) = (&outcome.inputs, unit(outcome));
    let (filter, base, network) = (&inputs.filter, &inputs.base, &inputs.network);
    sheet.item("Filter", soil_name(&filter.name), "");
    for (name, size) in [
        ("D0F", filter.d0_mm),
        ("D15F", filter.d15_mm),
        ("D50F", filter.d50_mm),
        ("D50F by number", filter.d50_by_number_mm),
        ("D85F", filter.d85_mm),
    ] {
        sheet.item(name, size, unit);
    }
    sheet.item("Cu of the filter", filter.cu, "-");
    sheet.item("Void ratio of the filter", filter.void_ratio, "-");
    sheet.item("Constriction curve", &filter.curve_name, "");
    sheet.item("Cu of the constrictions", filter.cu_csd, "-");
    sheet.item("Base", soil_name(&base.name), "");
    for (name, size) in [
        ("D0B", Some(base.d0_mm)),
        ("D15B", base.d15_mm),
        ("D50B", base.d50_mm),
        ("D85B", Some(base.d85_mm)),
        ("D95B", Some(base.d95_mm)),
        ("D100B", Some(base.d100_mm)),
        ("Base regraded on", base.regraded_at_mm),
    ] {
        sheet.item(name, size, unit);
    }
    sheet.item("Cu of the base", base.cu, "-");
    sheet.item("Pan fraction of the base", base.tail_mass_fraction, "fraction of the mass");
    sheet.item("Network", &network.name, "");
    sheet.item("Voids", network.voids, "");
    sheet.item("Constrictions", network.constrictions, "");
    sheet.item("Layers of voids", network.layers, "");
    sheet.item("Thickness modelled", network.thickness_mm, unit);
    sheet.item("Filter grains per void", outcome.grains_per_void, "-");
    sheet.item("Mass of base / mass of filter", inputs.mass_ratio, "-");
    sheet.item("Base particles in each run", outcome.n_base, "");
    sheet.item("Share inserted in each increment", inputs.inject_share, "fraction of the base");
    sheet
}

fn rules(decision: &Decision) -> Sheet {
    let rules = decision.rules.iter().filter(|rule| rule.role != RuleRole::Walk);
    Sheet::new("Rules", &rule::columns(SizeUnit::Mm), rules)
}

fn runs(outcome: &Outcome) -> Sheet {
    let columns = Columns::default()
        .column("Replicate", |row: &(u64, &Replicate, &Run)| row.0)
        .column("Seed", |(_, replicate, _)| replicate.seed)
        .column("Class of the replicate", |(_, replicate, _)| replicate.verdict)
        .column("Run", |(.., run)| run.run)
        .column("Mass eroded (fraction of the mass inserted)", |(.., run)| run.eroded_mass_fraction)
        .column("Particles eroded (fraction of those inserted)", |(.., run)| run.eroded_number_fraction)
        .column("Largest particle eroded (mm, or D0F without a unit)", |(.., run)| run.largest_eroded_mm)
        .column("Largest particle eroded / D15F (-)", |(.., run)| run.largest_eroded_over_d15f)
        .column("Particles inserted", |(.., run)| run.inserted)
        .column("Particles eroded", |(.., run)| run.eroded)
        .column("Particles retained in constrictions", |(.., run)| run.retained_in_constrictions)
        .column("Particles retained in voids", |(.., run)| run.retained_in_voids)
        .column("Constrictions blocked", |(.., run)| run.blocked)
        .column("Constrictions blocked (fraction of all)", |(.., run)| run.blocked_fraction)
        .column("Increments", |(.., run)| run.increments)
        .column("Particle moves", |(.., run)| run.particle_moves);
    let numbered = (1..).zip(&outcome.replicates);
    let rows = numbered
        .flat_map(|(number, replicate)| replicate.runs.iter().map(move |run| (number, replicate, run)));
    Sheet::new("Runs", &columns, &rows.collect::<Vec<_>>())
}

fn gradations(outcome: &Outcome) -> Sheet {
    let columns = Columns::default()
        .column("Curve", |row: &(&str, [f64; 2], &str)| row.0.to_owned())
        .column("Size (mm, or D0F without a unit)", |row| row.1[0])
        .column("Finer (%)", |row| row.1[1])
        .column("Percent finer by", |row| row.2.to_owned());
    let (filter, base) = (&outcome.inputs.filter, &outcome.inputs.base);
    let sampled = base.as_sampled.as_ref().map_or(&[][..], |before| &before.gradation);
    let curves = [
        ("filter", &filter.gradation[..], "mass"),
        ("constrictions of the filter", &filter.constrictions, "number"),
        ("base as walked", &base.gradation, "mass"),
        ("base as sampled", sampled, "mass"),
    ];
    let rows = curves.into_iter().flat_map(|(curve, rows, by)| rows.iter().map(move |row| (curve, *row, by)));
    Sheet::new("Gradations", &columns, &rows.collect::<Vec<_>>())
}

fn provenance(run: &RunFolder) -> Sheet {
    let (mut sheet, manifest) = (Sheet::items("Provenance"), &run.manifest);
    for (name, value) in [
        ("voidwalk", Some(&manifest.version)),
        ("Commit", manifest.commit.as_ref()),
        ("Command", Some(&manifest.command)),
        ("Engine", Some(&run.outcome.engine)),
        ("Machine", Some(&manifest.machine)),
        ("Host", Some(&manifest.host)),
        ("Started", Some(&manifest.started)),
        ("Finished", Some(&manifest.finished)),
    ] {
        sheet.item(name, value, "");
    }
    sheet.item("Seed", run.outcome.seed, "");
    sheet.item("Replicates", run.outcome.replicates.len() as u64, "");
    for input in &manifest.inputs {
        sheet.item(&format!("XXH3 of {}", input.name), &input.xxh3, "");
    }
    sheet
}

/// Cautions that the page also gives.
const CAUTIONS: [(&str, &str); 3] = [
    ("Fines", "At most 5 % may be finer than 0.075 mm, and these fines must not be plastic."),
    ("Segregation", "Segregation is not checked: the maximum D90F is still to be set (see its step)."),
    ("Use", "It does not replace a filter test or a designer’s judgement."),
];

fn summary(design: &Specification) -> Sheet {
    let d15 = design.band.as_ref().map(|band| band.d15_mm());
    let mut sheet = Sheet::items("Specification");
    sheet.item("Base", &design.base, "");
    sheet.item("Dispersive", design.dispersive, "");
    sheet.item("Minimum D15F, which drains the base", design.d15f_min_mm, "mm");
    sheet.item("Maximum D15F, which retains the base", design.d15f_max_mm, "mm");
    let mm = SizeUnit::Mm;
    let dispersive = design.if_dispersive.map(|limit| format!("D15F {}", dispersive_limit(limit, mm)));
    sheet.item("Maximum D15F if the base is dispersive (not stated)", dispersive, "");
    sheet.item("Maximum D15F set by", design.set_by(), "");
    sheet.item("Margin", without_margin(design, mm), "");
    sheet.item("D15F of the band, fine side", d15.map(|d15| d15[0]), "mm");
    sheet.item("D15F of the band, coarse side", d15.map(|d15| d15[1]), "mm");
    sheet.item("No band, because", design.no_band.as_ref().map(|why| no_band(why, mm)), "");
    design.notes.iter().for_each(|row| sheet.item("Warning", row_note(row, SizeUnit::Mm), ""));
    sheet.item("Still to be set", still_to_set(design, mm), "");
    sheet.item("Basis", "By the rules of practice alone, without a walk.", "");
    CAUTIONS.iter().for_each(|(item, caution)| sheet.item(item, *caution, ""));
    sheet.item("voidwalk", &design.version, "");
    sheet
}

fn limits(design: &Specification) -> Sheet {
    let (note, first) = (beside_limits(design, SizeUnit::Mm), design.limits.first());
    let columns = limit_columns().column("Note", |limit| note.clone().filter(|_| Some(limit) == first));
    Sheet::new("Limits", &columns, &design.limits)
}

fn band(design: &Specification) -> Sheet {
    let columns = Columns::default()
        .column("Finer by mass (%)", |size: &BandSize| size.percent)
        .column("Least size (mm)", |size| size.min_mm)
        .column("Greatest size (mm)", |size| size.max_mm);
    Sheet::new("Band", &columns, design.band.iter().flat_map(|band| &band.sizes))
}

fn products(design: &Specification) -> Sheet {
    let columns = product_columns(SizeUnit::Mm)
        .column("Fits", |product| product.fits())
        .column("Result", |product| product_result(design, product));
    Sheet::new("Products", &columns, &design.products)
}

fn steps(design: &Specification) -> Sheet {
    let columns = Columns::default()
        .column("Step", |row: &StepRow| row.step)
        .column("What is done", |row| row.does.clone())
        .column("Quantity", |row| row.quantity.clone())
        .column("Value", |row| row.value)
        .column("Unit", |row| row.unit.clone())
        .column("Formula", |row| row.formula.clone())
        .column("Note", |row| row.note.clone())
        .column("Source", |row| row.source.clone());
    Sheet::new("Steps", &columns, &design.steps.iter().flat_map(step_rows).collect::<Vec<_>>())
}

fn base(design: &Specification) -> Sheet {
    let columns = Columns::default()
        .column("Curve", |row: &(String, &str, [f64; 2])| row.0.clone())
        .column("Grading", |row| row.1.to_owned())
        .column("Size (mm)", |row| row.2[0])
        .column("Finer by mass (%)", |row| row.2[1]);
    let gradings = design.curves.iter().flat_map(|curve| {
        [(&curve.curve, "as sampled", &curve.gradation), (&curve.curve, "regraded", &curve.regraded)]
    });
    let rows = gradings
        .flat_map(|(curve, grading, rows)| rows.iter().map(move |row| (curve.clone(), grading, *row)));
    Sheet::new("Base", &columns, &rows.collect::<Vec<_>>())
}

/// Percent finer of an example at the US sieves, coarsest first.
type Example = [f64; 14];

const BASE: Example =
    [100.0, 100.0, 100.0, 100.0, 100.0, 100.0, 100.0, 99.0, 96.0, 91.0, 82.0, 68.0, 52.0, 38.0];

const FILTER: Example =
    [100.0, 100.0, 100.0, 100.0, 100.0, 100.0, 100.0, 97.0, 85.0, 68.0, 45.0, 18.0, 5.0, 1.5];

fn soil(name: &'static str, example: &Example) -> Sheet {
    Sheet::new(name, &template_columns(), &rows(example))
}

fn template_columns<'a>() -> Columns<'a, (f64, f64)> {
    let columns = Columns::default().column("Opening (mm)", |row: &(f64, f64)| row.0);
    columns.column("Sample 1 (% finer)", |row| row.1)
}

fn rows(example: &Example) -> Vec<(f64, f64)> {
    SieveSeries::Us.openings().iter().copied().zip(*example).collect()
}

/// Instructions, worded so that no reader takes them for a sieve table.
fn how() -> Sheet {
    let columns = Columns::default().column("How to fill in", |line: &&str| line.to_string());
    let lines = [
        "Replace the examples on the sheets Base and Filter by your own openings and percents finer.",
        "Add or remove rows as you need. A further sample is a further column, headed as Sample 2 (% finer).",
        "The coarsest row must have 100 % finer. Leave no row empty between two others.",
        "Add hydrometer sizes below the finest sieve if you have them: retention depends on fines and D85.",
        "If a command reads one soil, name its sheet: site.xlsx#Base. Otherwise both sheets are one soil.",
        "Delete a sheet that you do not need. voidwalk soil FILE.xlsx shows what is read.",
    ];
    Sheet::new("How to fill in", &columns, &lines)
}

#[cfg(test)]
mod tests {
    use super::{workbook, *};
    use voidwalk_sheets::soils_in_file;

    #[test]
    fn cells_hold_what_they_can() {
        assert_eq!(held(f64::NAN.value()), CellValue::Words("NaN".into()));
        assert_eq!(held(u64::MAX.value()), CellValue::Words(u64::MAX.to_string()));
        assert_eq!(held(Some(0.1).value()), CellValue::Number(0.1));
        assert_eq!([None::<f64>.value(), "".value()].map(held), [CellValue::Empty, CellValue::Empty]);
        assert_eq!(held("a\u{202e}b".value()), CellValue::Words("a\u{fffd}b".into()));
    }

    #[test]
    fn the_same_sheets_are_the_same_bytes() {
        let made = || {
            let columns = Columns::default().column("Size (mm)", |row: &(f64, &str)| row.0);
            let columns = columns.column("Note", |row| row.1.to_owned());
            workbook("a", &[Sheet::new("One", &columns, &[(0.1, "=1+1")])]).unwrap()
        };
        let first = made();
        std::thread::sleep(std::time::Duration::from_millis(2100));
        assert_eq!(first, made());
    }

    /// A further sample takes one column, as the last sheet says.
    #[test]
    fn a_template_with_a_further_sample_is_read_as_it_says() {
        assert!(soil_template().unwrap().starts_with(b"PK"), "a zip");
        let columns = template_columns().column("Sample 2 (% finer)", |row| row.1);
        let filled = Sheet::new("Base", &columns, &rows(&BASE));
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("site.xlsx");
        std::fs::write(&path, workbook("a", &[filled, soil("Filter", &FILTER), how()]).unwrap()).unwrap();
        let soils = soils_in_file(&path, None).unwrap();
        let names: Vec<&str> = soils.iter().map(|soil| soil.name.as_str()).collect();
        assert_eq!(names, ["Base/Sample 1 (% finer)", "Base/Sample 2 (% finer)", "Filter"]);
        assert_eq!(soils[0].points, soils[1].points);
        // Of the sieves that everything passes, only the finest becomes a row.
        assert_eq!((soils[0].points.len(), soils[0].points[0].row()), (8, [0.075, 38.0]));
    }
}
