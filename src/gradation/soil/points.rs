//! From a column of a grid to openings in mm and percents finer.

use super::grid::Grid;
use super::heading::Role;
use super::layout::{Layout, SoilColumn, fields, is_blank, is_text, percentage, repeats_headings};
use super::retained::{Weighed, percents_finer};
use super::size::{Entry, Opening, Said, Unit, opening};
use super::table::Soil;
use crate::gradation::error::TableError;
use crate::gradation::sieve::FIELDS;
use crate::gradation::table::{Row, allowed_percent, allowed_size, percent_is_allowed, size_is_allowed};

/// The soil in one column of a grid.
pub(super) fn soil(grid: &Grid, layout: &Layout, column: &SoilColumn) -> Result<Soil, TableError> {
    let mut notes = grid.notes.clone();
    let mut entries = entries(grid, layout, column, &mut notes)?;
    let unit = unit_of_bare(grid, layout, &entries, &mut notes)?;
    for entry in &mut entries {
        entry.opening = match entry.opening {
            Opening::Bare(value) => in_mm(grid, layout, entry, value, unit)?,
            Opening::Mm(mm) => in_mm(grid, layout, entry, mm, Unit::Mm)?,
            Opening::Below(value) => {
                let unit = if entry.said == Said::Plain { unit } else { Unit::Mm };
                match in_mm(grid, layout, entry, value, unit)? {
                    Opening::Mm(mm) => Opening::Below(mm),
                    other => other,
                }
            }
            other => other,
        };
    }
    say_names(&entries, unit, &mut notes);
    let rows = match column.role {
        Role::Retained(retained) => {
            let weighed = Weighed { grid, column: column.column, retained };
            percents_finer(&weighed, &entries, &mut notes)?
        }
        _ => finer(grid, column, &entries, &mut notes)?,
    };
    if rows.is_empty() {
        return Err(TableError::NoRows { file: grid.place(), header: layout.headed });
    }
    let largest = rows.iter().map(|row| row.size).fold(0.0, f64::max);
    if largest > 500.0 && unit == Unit::Mm && layout.unit != Some(Unit::Inch) {
        notes.push(format!("its largest opening is {largest} mm: is the column in micrometres?"));
    }
    let columns = grid.sheet.as_ref().map(|_| [layout.size as u32, column.column as u32]);
    Ok(Soil { name: column.heading.clone(), file: grid.place(), rows, notes, columns })
}

/// The rows of the table as they are written.
fn entries(
    grid: &Grid,
    layout: &Layout,
    column: &SoilColumn,
    notes: &mut Vec<String>,
) -> Result<Vec<Entry>, TableError> {
    let rows = &grid.rows[layout.first..];
    let is_number = |cell: &str| percentage(cell).is_some();
    let last = rows.iter().rposition(|row| row.filled().any(|c| is_number(row.cell(c)))).unwrap_or(0);
    let single = layout.soils.len() == 1;
    let retained = matches!(column.role, Role::Retained(_));
    let mut entries = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        let line = row.line;
        let value = row.cell(column.column);
        let of_size = row.cell(layout.size);
        let other = layout.other_size.map_or("", |c| row.cell(c));
        let size = if is_blank(of_size) && !other.is_empty() { other } else { of_size };
        if repeats_headings(row, layout) {
            continue;
        }
        let is_remark = is_text(row) && (row.filled().count() == 1 || index > last);
        if is_remark {
            notes.push(format!("{} {line} taken as a remark and left out", row_word(grid)));
            continue;
        }
        let read = opening(size);
        if is_blank(value) {
            match read {
                Some((Opening::Mm(_) | Opening::Bare(_) | Opening::Below(_), _)) => {
                    if single {
                        notes.push(format!("{} {line} has no percent: left out", row_word(grid)));
                    }
                    continue;
                }
                Some((Opening::Pan | Opening::Total, _)) => continue,
                None if size.is_empty() && !single => continue,
                _ => {}
            }
        }
        if grid.sheet.is_none()
            && row.cells.len() == 1
            && !layout.headed
            && layout.size + column.column > 0
            && read.is_none()
        {
            return Err(fields(grid, row));
        }
        let Some((opening, said)) = read else {
            return Err(grid.refused(line, layout.size, FIELDS[0], size, allowed_opening(size)));
        };
        if matches!(opening, Opening::Bare(value) if !value.is_finite()) {
            return Err(grid.refused(line, layout.size, FIELDS[0], size, allowed_size()));
        }
        let allowed = if retained { "a number from 0".to_owned() } else { allowed_percent() };
        let number = percentage(value)
            .filter(|&v| if retained { v >= 0.0 && v.is_finite() } else { percent_is_allowed(v) });
        let Some(number) = number else {
            return Err(grid.refused(line, column.column, FIELDS[1], value, allowed));
        };
        entries.push(Entry { line, opening, text: size.to_owned(), said, value: number + 0.0 });
    }
    check_decimal_signs(grid, layout, column)?;
    Ok(entries)
}

/// What rows are called.
fn row_word(grid: &Grid) -> &'static str {
    if grid.sheet.is_some() { "row" } else { "line" }
}

/// What an opening may be; spreadsheets turn `3/8` into a date.
fn allowed_opening(found: &str) -> String {
    const MONTHS: [&str; 12] =
        ["jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec"];
    let small = found.to_lowercase();
    match found.contains(|c: char| c.is_ascii_digit()) && MONTHS.iter().any(|month| small.contains(month))
        || small.contains("(a date)")
    {
        true => {
            "an opening; this is a date, into which spreadsheets turn fractions such as 3/8: write 3/8 in"
                .into()
        }
        false => allowed_size(),
    }
}

/// A file that uses both `.` and `,` inside numbers has thousands separators, or a mistake.
fn check_decimal_signs(grid: &Grid, layout: &Layout, column: &SoilColumn) -> Result<(), TableError> {
    if grid.sheet.is_some() {
        return Ok(());
    }
    let with = |sign: char| {
        grid.rows[layout.first..].iter().find_map(|row| {
            let cells = [row.cell(layout.size), row.cell(column.column)];
            let is_with = |cell: &&str| cell.contains(sign) && percentage(cell).is_some();
            cells.into_iter().find(is_with).map(|cell| (row.line, cell))
        })
    };
    match (with('.'), with(',')) {
        (Some((dot_line, _)), Some((line, value))) => {
            let allowed = format!(
                "one decimal sign in the whole file (line {dot_line} has a decimal point), no thousands \
                 separators"
            );
            Err(grid.refused(line, layout.size, "number", value, allowed))
        }
        _ => Ok(()),
    }
}

/// The unit of openings that are bare numbers: the heading's; mm where nothing else has inches; else the one
/// in which the openings go one way.
fn unit_of_bare(
    grid: &Grid,
    layout: &Layout,
    entries: &[Entry],
    notes: &mut Vec<String>,
) -> Result<Unit, TableError> {
    let is_no_sieve = |entry: &Entry| match entry.opening {
        Opening::Bare(value) => value != 0.0 && Unit::SieveNumber.mm(value).is_none(),
        _ => false,
    };
    match layout.unit {
        // Headings say `Sieve no.` of openings in mm too.
        Some(Unit::SieveNumber) if entries.iter().any(is_no_sieve) => {}
        Some(unit) => return Ok(unit),
        None => {}
    }
    let inches = entries.iter().any(|entry| entry.said == Said::Inches);
    let bare = |entry: &&Entry| matches!(entry.opening, Opening::Bare(value) if value > 0.0);
    let Some(first) = entries.iter().find(bare).filter(|_| inches) else { return Ok(Unit::Mm) };
    let goes_one_way = |unit: Unit| {
        let sizes: Vec<f64> = entries
            .iter()
            .filter_map(|entry| match entry.opening {
                Opening::Mm(mm) => Some(mm),
                Opening::Bare(value) if value > 0.0 => unit.mm(value),
                _ => None,
            })
            .collect();
        sizes.windows(2).all(|w| w[0] > w[1]) || sizes.windows(2).all(|w| w[0] < w[1])
    };
    match (goes_one_way(Unit::Mm), goes_one_way(Unit::Inch)) {
        (true, false) => Ok(Unit::Mm),
        (false, true) => {
            notes.push("openings without a unit read as inches, as those around them are".into());
            Ok(Unit::Inch)
        }
        _ => {
            let allowed = "an opening with its unit (mm or in), as other rows are in inches";
            Err(grid.refused(first.line, layout.size, FIELDS[0], &first.text, allowed))
        }
    }
}

fn in_mm(grid: &Grid, layout: &Layout, entry: &Entry, value: f64, unit: Unit) -> Result<Opening, TableError> {
    if value == 0.0 && unit != Unit::Phi {
        // Nothing passes the pan.
        return Ok(Opening::Pan);
    }
    let allowed = match unit {
        Unit::SieveNumber => "the number of a US sieve (4, 10, 40, 200 ...), as the heading says".to_owned(),
        Unit::Phi => "a size in phi, from -40 to 40".to_owned(),
        _ => allowed_size(),
    };
    let mm = unit.mm(value).filter(|&mm| size_is_allowed(mm) && (unit == Unit::Phi || value > 0.0));
    mm.map(Opening::Mm).ok_or_else(|| grid.refused(entry.line, layout.size, FIELDS[0], &entry.text, allowed))
}

/// Says which names of openings were translated.
fn say_names(entries: &[Entry], unit: Unit, notes: &mut Vec<String>) {
    let any = |said: Said| entries.iter().any(|entry| entry.said == said);
    let number = any(Said::UsNumber) || unit == Unit::SieveNumber;
    let inches = any(Said::Inches) || unit == Unit::Inch;
    if number || inches {
        let example = if number { "No. 200 = 0.075 mm" } else { "3/8 in = 9.5 mm" };
        notes.push(format!("US sieves read as the openings of ASTM E11 ({example})"));
    }
    match unit {
        Unit::Micrometre => notes.push("openings in micrometres".into()),
        Unit::Cm => notes.push("openings in cm".into()),
        Unit::Phi => notes.push("openings in phi: size = 2^-phi mm".into()),
        _ => {}
    }
}

/// Rows of a column that is in percent finer, or in fractions.
fn finer(
    grid: &Grid,
    column: &SoilColumn,
    entries: &[Entry],
    notes: &mut Vec<String>,
) -> Result<Vec<Row>, TableError> {
    let factor = fractions(grid, column, entries, notes)?;
    let mut rows = Vec::new();
    for entry in entries {
        let size = match entry.opening {
            Opening::Mm(size) | Opening::Below(size) => size,
            Opening::Total => continue,
            Opening::Pan if entry.value == 0.0 => {
                notes.push("the pan was left out".into());
                continue;
            }
            Opening::Pan | Opening::Bare(_) => {
                let allowed = "0, or nothing: the pan lets nothing pass (or a heading that says retained)";
                let value = entry.value.to_string();
                return Err(grid.refused(entry.line, column.column, FIELDS[1], &value, allowed));
            }
        };
        rows.push(Row { line: entry.line, size, percent: entry.value * factor });
    }
    Ok(rows)
}

/// 100 where the values are fractions of 1.
fn fractions(
    grid: &Grid,
    column: &SoilColumn,
    entries: &[Entry],
    notes: &mut Vec<String>,
) -> Result<f64, TableError> {
    let of_sieves = || entries.iter().filter(|entry| !matches!(entry.opening, Opening::Total));
    let Some(top) = of_sieves().max_by(|a, b| a.value.total_cmp(&b.value)) else { return Ok(1.0) };
    let broken = of_sieves().filter(|entry| entry.value > 0.0 && entry.value < 1.0).count();
    if top.value > 1.0 || broken == 0 {
        return Ok(1.0);
    }
    let heading = column.heading.to_lowercase();
    let says_percent = heading.contains('%') || heading.contains("percent") || heading.contains("pct");
    let says_fraction = heading.contains("fraction") || heading.contains("ratio");
    if top.value == 1.0 && (says_fraction || !says_percent || grid.sheet.is_some()) {
        notes.push("values from 0 to 1 read as fractions: 1 is 100 %".into());
        return Ok(100.0);
    }
    let allowed = match says_percent && top.value == 1.0 {
        true => {
            "100 at the coarsest size; these look like fractions from 0 to 1 under a heading of percents: \
                 write percents, or `fraction` in the heading"
        }
        false => {
            "100 at the coarsest size; these look like fractions from 0 to 1, of which the coarsest must be 1"
        }
    };
    Err(grid.refused(top.line, column.column, FIELDS[1], &top.value.to_string(), allowed))
}
