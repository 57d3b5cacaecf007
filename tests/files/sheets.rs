//! Sheets with several tables, made from a seed and written as CSV, .xlsx and .ods: each soil is read with its own
//! openings, or the sheet is refused; none is misread.

use std::collections::BTreeMap;
use std::io::{Cursor, Write};

use voidwalk::sheets::Soil;
use zip::write::SimpleFileOptions;

/// Sheets of each layout and format.
const SHEETS: usize = 20;
const SEED: u64 = 20261124;

/// Numbers from a seed (SplitMix64).
pub(super) struct Draw(pub(super) u64);

impl Draw {
    pub(super) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e3779b97f4a7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58476d1ce4e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d049bb133111eb);
        z ^ (z >> 31)
    }

    pub(super) fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    pub(super) fn one_of<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())]
    }
}

/// Sieves: opening (mm), name.
const SIEVES: [(f64, &str); 16] = [
    (75.0, "3 in"),
    (50.0, "2 in"),
    (37.5, "1 1/2 in"),
    (25.0, "1 in"),
    (19.0, "3/4 in"),
    (12.5, "1/2 in"),
    (9.5, "3/8 in"),
    (4.75, "No. 4"),
    (2.36, "No. 8"),
    (2.0, "No. 10"),
    (1.18, "No. 16"),
    (0.6, "No. 30"),
    (0.425, "No. 40"),
    (0.3, "No. 50"),
    (0.15, "No. 100"),
    (0.075, "No. 200"),
];

#[derive(Clone)]
pub(super) enum Cell {
    Text(String),
    Number(f64),
}

fn text(words: &str) -> Option<Cell> {
    Some(Cell::Text(words.into()))
}

pub(super) type Grid = Vec<Vec<Option<Cell>>>;

/// A table: its soil, and how it is written.
#[derive(Clone)]
struct Table {
    name: String,
    /// Opening (mm) and percent, falling.
    points: Vec<(f64, f64)>,
    /// The headings, and the cells of the openings.
    headings: Vec<String>,
    openings: Vec<Vec<Option<Cell>>>,
}

/// A curve of some sieves, from 100 down to `last` at the least.
fn curve(draw: &mut Draw, last: f64) -> Vec<(f64, f64)> {
    let start = draw.below(9);
    let count = 4 + draw.below(SIEVES.len() - start - 4);
    let mut sieves: Vec<f64> = SIEVES[start..].iter().map(|sieve| sieve.0).collect();
    while sieves.len() > count {
        sieves.remove(draw.below(sieves.len()));
    }
    percents(draw, &sieves, 100.0, last)
}

fn percents(draw: &mut Draw, sizes: &[f64], top: f64, last: f64) -> Vec<(f64, f64)> {
    let mut falling: Vec<f64> =
        (1..sizes.len()).map(|_| last + (top - last) * (draw.below(900) as f64 + 1.0) / 1000.0).collect();
    falling.sort_by(|a, b| b.total_cmp(a));
    let rounded = falling.into_iter().map(|percent| (10.0 * percent).round() / 10.0);
    sizes.iter().copied().zip(std::iter::once(top).chain(rounded)).collect()
}

fn table(draw: &mut Draw, name: &str) -> Table {
    let points = curve(draw, 1.0);
    let value = draw.one_of(&["% passing", "Percent finer", "Passing (%)", "% finer by mass"]);
    let sieve_name = |mm: f64| SIEVES.iter().find(|sieve| sieve.0 == mm).map(|sieve| sieve.1).unwrap();
    let (headings, openings): (Vec<&str>, Vec<Vec<Option<Cell>>>) = match draw.below(5) {
        0 => (vec!["Opening (mm)"], points.iter().map(|p| vec![Some(Cell::Number(p.0))]).collect()),
        1 => (vec!["Sieve, mm"], points.iter().map(|p| vec![Some(Cell::Number(p.0))]).collect()),
        2 => (vec!["Sieve"], points.iter().map(|p| vec![text(sieve_name(p.0))]).collect()),
        3 => {
            let um = |p: &(f64, f64)| vec![Some(Cell::Number((p.0 * 1e3).round()))];
            (vec!["Size (um)"], points.iter().map(um).collect())
        }
        _ => {
            let both = |p: &(f64, f64)| vec![text(sieve_name(p.0)), Some(Cell::Number(p.0))];
            (vec!["Sieve", "Opening (mm)"], points.iter().map(both).collect())
        }
    };
    let headings = headings.into_iter().chain([value]).map(str::to_owned).collect();
    Table { name: name.into(), points, headings, openings }
}

/// Puts a cell into a grid.
fn put(grid: &mut Grid, row: usize, column: usize, cell: Option<Cell>) {
    if grid.len() <= row {
        grid.resize(row + 1, Vec::new());
    }
    if grid[row].len() <= column {
        grid[row].resize(column + 1, None);
    }
    grid[row][column] = cell;
}

/// Writes a table; its first free row and column.
fn write(grid: &mut Grid, table: &Table, row: usize, column: usize) -> (usize, usize) {
    for (c, heading) in table.headings.iter().enumerate() {
        put(grid, row, column + c, text(heading));
    }
    for (r, (openings, point)) in table.openings.iter().zip(&table.points).enumerate() {
        for (c, opening) in openings.iter().enumerate() {
            put(grid, row + 1 + r, column + c, opening.clone());
        }
        put(grid, row + 1 + r, column + openings.len(), Some(Cell::Number(point.1)));
    }
    (row + 1 + table.points.len(), column + table.headings.len())
}

/// A soil's name, where it has one, and its points.
type Named = (Option<String>, Vec<(f64, f64)>);

/// What must be read of a sheet.
enum Wanted {
    Soils(Vec<Named>),
    Refusal,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Layout {
    TitlesAndGap,
    TitlesNoGap,
    NoTitles,
    RowsBelow,
    HydrometerRight,
    HydrometerOfFines,
    Stacked,
    Across,
    SampleRow,
    OwnRowOfHeadings,
}

const LAYOUTS: [Layout; 10] = [
    Layout::TitlesAndGap,
    Layout::TitlesNoGap,
    Layout::NoTitles,
    Layout::RowsBelow,
    Layout::HydrometerRight,
    Layout::HydrometerOfFines,
    Layout::Stacked,
    Layout::Across,
    Layout::SampleRow,
    Layout::OwnRowOfHeadings,
];

fn sheet(draw: &mut Draw, layout: Layout) -> (Grid, Wanted) {
    let mut grid = Grid::new();
    let count = 2 + draw.below(2);
    let tables: Vec<Table> =
        (0..count).map(|k| table(draw, ["No. 57 stone", "C33 sand", "Till"][k])).collect();
    let named = |tables: &[Table]| {
        tables.iter().map(|table| (Some(table.name.clone()), table.points.clone())).collect::<Vec<_>>()
    };
    let nameless = |tables: &[Table]| tables.iter().map(|t| (None, t.points.clone())).collect::<Vec<_>>();
    let project = draw.below(2);
    if project > 0 {
        put(&mut grid, 0, 0, text("Project: Dam, north"));
    }
    match layout {
        Layout::TitlesAndGap | Layout::TitlesNoGap | Layout::NoTitles | Layout::RowsBelow => {
            let gap = usize::from(layout != Layout::TitlesNoGap);
            let titled = usize::from(layout != Layout::NoTitles);
            let mut column = 0;
            for table in &tables {
                if titled > 0 {
                    put(&mut grid, project, column, text(&table.name));
                }
                let (mut below, next) = write(&mut grid, table, project + titled, column);
                if layout == Layout::RowsBelow {
                    for (words, value) in [("Dry mass (g)", 512.3), ("D10", 0.21), ("Cu", 4.5), ("LL", 31.0)]
                    {
                        put(&mut grid, below, column, text(words));
                        put(&mut grid, below, next - 1, Some(Cell::Number(value)));
                        below += 1;
                    }
                }
                column = next + gap;
            }
            let wanted = if titled > 0 { named(&tables) } else { nameless(&tables) };
            (grid, Wanted::Soils(wanted))
        }
        Layout::HydrometerRight | Layout::HydrometerOfFines => {
            let mut sieves = tables[0].clone();
            let k = sieves.points.len();
            sieves.points = percents(draw, &[4.75, 2.0, 0.425, 0.15, 0.075], 100.0, 30.0);
            sieves.headings = vec!["Opening (mm)".into(), "% passing".into()];
            sieves.openings = sieves.points.iter().map(|p| vec![Some(Cell::Number(p.0))]).collect();
            let last = sieves.points[4].1;
            let of_fines = layout == Layout::HydrometerOfFines;
            let top = if of_fines { 100.0 } else { last - 1.0 };
            let fine = percents(draw, &[0.05, 0.03, 0.01, 0.005, 0.002], top, 2.0);
            let (_, next) = write(&mut grid, &sieves, project + 1, 0);
            let um = draw.below(2) > 0;
            let unit = |p: &(f64, f64)| Some(Cell::Number(if um { (p.0 * 1e3).round() } else { p.0 }));
            let head = if um { "Diameter (um)" } else { "Diameter (mm)" };
            let hydrometer = Table {
                name: String::new(),
                headings: vec![head.into(), "% finer".into()],
                openings: fine.iter().map(|p| vec![unit(p)]).collect(),
                points: fine.clone(),
            };
            let column = next + draw.below(2);
            if k.is_multiple_of(2) {
                put(&mut grid, project, column, text("Hydrometer"));
            }
            write(&mut grid, &hydrometer, project + 1, column);
            if of_fines {
                return (grid, Wanted::Refusal);
            }
            let all = sieves.points.iter().chain(&fine).copied().collect();
            (grid, Wanted::Soils(vec![(None, all)]))
        }
        Layout::Stacked => {
            let (mut row, wanted) = (project, named(&tables));
            for (k, table) in tables.iter().enumerate() {
                put(&mut grid, row, 0, text(&table.name));
                (row, _) = write(&mut grid, table, row + 1, 0);
                if k == 0 && draw.below(2) > 0 {
                    put(&mut grid, row, 0, text("Gs"));
                    put(&mut grid, row, 1, Some(Cell::Number(2.65)));
                    row += 1;
                }
                // Blank lines between the tables, as people leave them.
                put(&mut grid, row, 0, None);
                row += 1;
            }
            (grid, Wanted::Soils(wanted))
        }
        Layout::Across => {
            let sieves: Vec<f64> = tables[0].points.iter().map(|p| p.0).collect();
            let soils: Vec<Named> = tables
                .iter()
                .map(|table| (Some(table.name.clone()), percents(draw, &sieves, 100.0, 1.0)))
                .collect();
            let us = draw.below(2) > 0;
            put(&mut grid, project, 0, text(if us { "Sample" } else { "Sieve (mm)" }));
            for (c, mm) in sieves.iter().enumerate() {
                let name = SIEVES.iter().find(|sieve| sieve.0 == *mm).map(|sieve| sieve.1).unwrap();
                put(&mut grid, project, c + 1, if us { text(name) } else { Some(Cell::Number(*mm)) });
            }
            for (r, (name, points)) in soils.iter().enumerate() {
                put(&mut grid, project + 1 + r, 0, text(name.as_deref().unwrap()));
                for (c, point) in points.iter().enumerate() {
                    put(&mut grid, project + 1 + r, c + 1, Some(Cell::Number(point.1)));
                }
            }
            (grid, Wanted::Soils(soils))
        }
        Layout::SampleRow => {
            let sieves: Vec<f64> = tables[0].points.iter().map(|p| p.0).collect();
            put(&mut grid, project, 0, text("Sample:"));
            put(&mut grid, project + 1, 0, text("Depth (m)"));
            put(&mut grid, project + 2, 0, text("Opening (mm)"));
            for (r, mm) in sieves.iter().enumerate() {
                put(&mut grid, project + 3 + r, 0, Some(Cell::Number(*mm)));
            }
            let mut wanted = Vec::new();
            for (c, table) in tables.iter().enumerate() {
                let points = percents(draw, &sieves, 100.0, 1.0);
                put(&mut grid, project, c + 1, text(&table.name));
                put(&mut grid, project + 1, c + 1, Some(Cell::Number(1.5 + c as f64)));
                put(&mut grid, project + 2, c + 1, text("% passing"));
                for (r, point) in points.iter().enumerate() {
                    put(&mut grid, project + 3 + r, c + 1, Some(Cell::Number(point.1)));
                }
                wanted.push((Some(table.name.clone()), points));
            }
            (grid, Wanted::Soils(wanted))
        }
        Layout::OwnRowOfHeadings => {
            let gap = draw.below(2);
            let mut column = 0;
            for (k, table) in tables.iter().enumerate() {
                let (_, next) = write(&mut grid, table, project + 1 + k, column);
                column = next + gap;
            }
            (grid, Wanted::Soils(nameless(&tables)))
        }
    }
}

fn csv(grid: &Grid, separator: char) -> Vec<u8> {
    let written = |cell: &Option<Cell>| match cell {
        None => String::new(),
        Some(Cell::Number(value)) => value.to_string(),
        Some(Cell::Text(words)) if words.contains([',', ';', '"']) => {
            format!("\"{}\"", words.replace('"', "\"\""))
        }
        Some(Cell::Text(words)) => words.clone(),
    };
    let width = grid.iter().map(Vec::len).max().unwrap_or(0);
    let line = |row: &Vec<Option<Cell>>| {
        let cells: Vec<String> = (0..width).map(|c| row.get(c).map(written).unwrap_or_default()).collect();
        cells.join(&separator.to_string()) + "\n"
    };
    grid.iter().map(line).collect::<String>().into_bytes()
}

pub(super) fn zipped(parts: &[(&str, String)]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in parts {
        zip.start_file(*name, SimpleFileOptions::default()).unwrap();
        zip.write_all(content.as_bytes()).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

fn escaped(words: &str) -> String {
    words.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

fn letter(column: usize) -> char {
    char::from(b'A' + column as u8)
}

pub(super) fn xlsx(grid: &Grid) -> Vec<u8> {
    let mut rows = String::new();
    for (r, row) in grid.iter().enumerate() {
        rows += &format!("<row r=\"{}\">", r + 1);
        for (c, cell) in row.iter().enumerate() {
            let place = format!("{}{}", letter(c), r + 1);
            match cell {
                None => {}
                Some(Cell::Number(value)) => rows += &format!("<c r=\"{place}\"><v>{value}</v></c>"),
                Some(Cell::Text(words)) => {
                    let words = escaped(words);
                    rows += &format!("<c r=\"{place}\" t=\"inlineStr\"><is><t>{words}</t></is></c>");
                }
            }
        }
        rows += "</row>";
    }
    zipped(&[
        ("xl/workbook.xml", "<workbook><sheets><sheet name=\"A\" id=\"r1\"/></sheets></workbook>".into()),
        (
            "xl/_rels/workbook.xml.rels",
            "<Relationships><Relationship Id=\"r1\" Target=\"worksheets/sheet1.xml\"/></Relationships>"
                .into(),
        ),
        ("xl/worksheets/sheet1.xml", format!("<worksheet><sheetData>{rows}</sheetData></worksheet>")),
    ])
}

fn ods(grid: &Grid) -> Vec<u8> {
    let mut rows = String::new();
    for row in grid {
        rows += "<table:table-row>";
        for cell in row {
            rows += &match cell {
                None => "<table:table-cell/>".to_owned(),
                Some(Cell::Number(value)) => format!(
                    "<table:table-cell office:value-type=\"float\" office:value=\"{value}\"><text:p>{value}</text:p>\
                     </table:table-cell>"
                ),
                Some(Cell::Text(words)) => format!(
                    "<table:table-cell office:value-type=\"string\"><text:p>{}</text:p></table:table-cell>",
                    escaped(words)
                ),
            };
        }
        rows += "</table:table-row>";
    }
    let content = format!(
        "<office:document-content><table:table table:name=\"A\">{rows}</table:table></office:document-content>"
    );
    zipped(&[("content.xml", content)])
}

/// What was read of a file, against what is in it.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Found {
    Read,
    Refused,
}

fn found(bytes: &[u8], wanted: &Wanted) -> Result<Found, String> {
    let soils = match Soil::all("sheet", bytes) {
        Ok(soils) => soils,
        Err(error) => return Ok(refused(&error.to_string())),
    };
    let curves: Result<Vec<_>, _> = soils.iter().map(|soil| soil.gradation(None)).collect();
    let curves = match curves {
        Ok(curves) => curves,
        Err(error) => return Ok(refused(&error.to_string())),
    };
    let Wanted::Soils(wanted) = wanted else { return Err(format!("taken: {soils:?}")) };
    if soils.len() != wanted.len() {
        return Err(format!("{} soils for {}: {soils:?}", soils.len(), wanted.len()));
    }
    for ((soil, curve), (name, points)) in soils.iter().zip(&curves).zip(wanted) {
        let mut points: Vec<(f64, f64)> = points.iter().rev().copied().collect();
        let top = points.iter().position(|point| point.1 == 100.0).unwrap();
        points.truncate(top + 1);
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-6 * b;
        let got = curve.points();
        let same = got.len() == points.len()
            && got.iter().zip(&points).all(|(g, w)| near(g.size, w.0) && near(g.percent, w.1));
        if !same {
            return Err(format!("{}: {got:?} for {points:?}", soil.name()));
        }
        let is_named = |name: &String| soil.name() == name || soil.name() == format!("A/{name}");
        if name.as_ref().is_some_and(|name| !is_named(name)) {
            return Err(format!("{:?} for {name:?}", soil.name()));
        }
    }
    Ok(Found::Read)
}

/// A refusal names the place.
fn refused(message: &str) -> Found {
    assert!(message.contains("line ") || message.contains("cell "), "{message}");
    Found::Refused
}

#[test]
fn of_several_tables_in_a_sheet_each_is_read_with_its_own_openings_or_the_sheet_is_refused() {
    let mut draw = Draw(SEED);
    let mut tally: BTreeMap<(Layout, &str), [usize; 2]> = BTreeMap::new();
    let mut misread = String::new();
    for layout in LAYOUTS {
        for _ in 0..SHEETS {
            let (grid, wanted) = sheet(&mut draw, layout);
            let separator = draw.one_of(&[',', ';', '\t']);
            for (format, bytes) in
                [("csv", csv(&grid, separator)), ("xlsx", xlsx(&grid)), ("ods", ods(&grid))]
            {
                let counts = tally.entry((layout, format)).or_default();
                match found(&bytes, &wanted) {
                    Ok(Found::Read) => counts[0] += 1,
                    Ok(Found::Refused) => counts[1] += 1,
                    Err(what) => {
                        let sheet = String::from_utf8(csv(&grid, ',')).unwrap();
                        misread += &format!("{layout:?} as {format}: {what}\n{sheet}\n");
                    }
                }
            }
        }
    }
    println!("layout                format  read  refused");
    for ((layout, format), [read, refused]) in &tally {
        println!("{:20}  {format:6}  {read:4}  {refused:7}", format!("{layout:?}"));
    }
    assert!(misread.is_empty(), "{misread}");
    for ((layout, format), counts) in &tally {
        let wanted = match layout {
            Layout::HydrometerOfFines => [0, SHEETS],
            // Headings that begin in different rows are read where a column is left empty between the tables.
            Layout::OwnRowOfHeadings => {
                assert!(counts[0] > 0, "{counts:?}");
                continue;
            }
            _ => [SHEETS, 0],
        };
        assert_eq!(*counts, wanted, "{layout:?} as {format}");
    }
}
