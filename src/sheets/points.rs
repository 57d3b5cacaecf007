//! Converts a column of a table to openings in mm and percents finer.

use super::content::{bound, is_blank, is_date, is_value, is_words, percentage, range, refuse_short};
use super::extent::{Extent, Reading, check_commas, refuse_lost};
use super::grid::{Grid, listed};
use super::heading::Role;
use super::layout::{End, Layout, SoilColumn, fields};
use super::retained::{percents_finer, refuse_contradiction, says_fraction, says_percent, scale_fractions};
use super::size::{Entry, Form, Opening, Unit, opening, unmarked};
use super::soil::Soil;
use super::{roles, units};
use std::collections::HashMap;
use voidwalk_core::gradation::{
    FIELDS, Row, TableError, allowed_percent, allowed_size, percent_is_allowed, size_is_allowed,
};

/// Minimum percent at the coarsest size that counts as 100 % rounded by a laboratory.
const ALL_PERCENT: f64 = 99.9;
/// Maximum bound for which a percent below it is read as the bound: no more of the mass is uncertain.
const LEAST_BOUND: f64 = 1.0;

/// Soils of a table, column by column.
pub(super) fn soils(grid: &Grid, layout: &Layout) -> Result<Vec<Result<Soil, TableError>>, TableError> {
    let extent = Extent::of(grid, layout)?;
    let last = last_column(&extent);
    for row in extent.rows() {
        refuse_short(grid, row, row.cell(extent.column_of_size(row)), last)?;
    }
    let soils: Vec<_> = layout.soils.iter().map(|column| soil(&extent, column)).collect();
    refuse_contradiction(&extent, &soils)?;
    refuse_lost(&extent, &soils)?;
    Ok(soils)
}

/// Finds the last column that has a value in most of the rows.
fn last_column(extent: &Extent) -> usize {
    let rows: Vec<_> = extent.rows().collect();
    let mut values = vec![0; rows.iter().map(|row| row.cells.len()).max().unwrap_or(0)];
    for row in &rows {
        row.filled().filter(|&c| is_value(row.cell(c))).for_each(|c| values[c] += 1);
    }
    let first = extent.layout.soils.iter().map(|soil| soil.column).min().unwrap_or(0);
    values.iter().rposition(|&n| 2 * n > rows.len()).unwrap_or(0).max(extent.layout.size).max(first)
}

fn soil(extent: &Extent, column: &SoilColumn) -> Result<Soil, TableError> {
    let (grid, layout) = (extent.grid, extent.layout);
    let notes = [&grid.notes[..], &layout.notes, &extent.notes].concat();
    let mut reading = Reading { extent, grid, layout, column, notes };
    let (mut entries, missing) = entries(&mut reading)?;
    let unit = units::of_bare(&mut reading, &entries)?;
    for entry in &mut entries {
        let unit = if entry.form == Form::Plain { unit } else { Unit::Mm };
        let mm = |value: f64| in_mm(&reading, entry, value, unit);
        entry.opening = match entry.opening {
            Opening::Bare(value) | Opening::Mm(value) | Opening::Below(value) => match mm(value)? {
                // Nothing passes the pan.
                0.0 => Opening::Pan,
                mm if matches!(entry.opening, Opening::Below(_)) => Opening::Below(mm),
                mm => Opening::Mm(mm),
            },
            Opening::Class(one, other) => {
                let bound = |value: f64| if value == f64::INFINITY { Ok(value) } else { mm(value) };
                let (one, other) = (bound(one)?, bound(other)?);
                Opening::Class(one.max(other), one.min(other))
            }
            other => other,
        };
    }
    units::say_names(&entries, unit, &mut reading.notes);
    let mut rows = match roles::settle(&mut reading, &mut entries)? {
        Role::Retained(retained) => {
            scale_fractions(&mut reading, retained, &mut entries)?;
            percents_finer(&mut reading, retained, &entries, &missing)?
        }
        _ => finer(&mut reading, &entries)?,
    };
    let mut notes = reading.notes;
    let Some(top) = rows.iter_mut().max_by(|a, b| a.size.total_cmp(&b.size)) else {
        return Err(TableError::NoRows { file: grid.place(), header: layout.headed });
    };
    if top.percent < 100.0 && top.percent >= ALL_PERCENT {
        notes.push(format!("{} % at the coarsest size read as 100 %", top.percent));
        top.percent = 100.0;
    }
    let largest = top.size;
    if largest > 500.0 && unit == Unit::Mm && layout.unit != Some(Unit::Inch) {
        notes.push(format!("its largest opening is {largest} mm: is the column in micrometres?"));
    }
    if let Some(end) = column.end {
        let side = if end == End::Least { "least" } else { "most" };
        notes.push(format!("ranges such as 95-100 are two curves; this is the curve of the {side} allowed"));
    }
    let elsewhere: HashMap<usize, usize> =
        entries.iter().filter(|e| e.column != layout.size).map(|e| (e.line, e.column)).collect();
    let place = |row: &Row| {
        let of_size = elsewhere.get(&row.line).copied().unwrap_or(layout.size);
        [grid.place_of(row.line, of_size), grid.place_of(row.line, column.column)]
    };
    let places = rows.iter().map(place).collect();
    let (name, file) = (column.heading.clone(), grid.place());
    let (in_sheet, across) = (grid.sheet.is_some(), grid.across.is_some());
    Ok(Soil { name, file, rows, places, in_sheet, across, notes })
}

/// Rows of the table as written, and the lines of openings with an empty value cell.
fn entries(reading: &mut Reading) -> Result<(Vec<Entry>, Vec<usize>), TableError> {
    let &mut Reading { extent, grid, layout, column, .. } = reading;
    let retained = matches!(column.role, Role::Retained(_));
    let (mut entries, mut without, mut missing) = (Vec::new(), Vec::new(), Vec::new());
    let mut marked: Option<String> = None;
    let (mut with_sign, mut plain) = (false, None);
    for row in extent.rows() {
        let line = row.line;
        let value = row.cell(column.column);
        let at = extent.column_of_size(row);
        let size = row.cell(at);
        let read = opening(size);
        if is_blank(value) {
            match read {
                Some((Opening::Mm(_) | Opening::Bare(_) | Opening::Below(_), _)) => {
                    without.push(line);
                    missing.push(line);
                    continue;
                }
                None if is_words(size) => {
                    without.push(line);
                    continue;
                }
                Some((Opening::Pan | Opening::Total, _)) => continue,
                None if size.is_empty() && layout.soils.len() > 1 => continue,
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
        let Some((opening, form)) = read else {
            let date = "an opening; this is a date, into which spreadsheets turn fractions such as 3/8: \
                        write 3/8 in";
            let allowed = if is_date(size) { date.into() } else { allowed_size() };
            return Err(grid.refused(line, at, FIELDS[0], size, allowed));
        };
        if matches!(opening, Opening::Bare(value) if !value.is_finite()) {
            return Err(grid.refused(line, at, FIELDS[0], size, allowed_size()));
        }
        let of_range = |(least, most): (f64, f64)| if column.end == Some(End::Least) { least } else { most };
        let bound = bound(value).filter(|_| !retained);
        if let Some(most) = bound {
            if most > LEAST_BOUND {
                let allowed = format!("a number: below {most} it may be anything from 0 to {most}");
                return Err(grid.refused(line, column.column, FIELDS[1], value, allowed));
            }
            let row = grid.row_label(line);
            reading.notes.push(format!("{value} in {row} read as {most} %, its upper bound"));
        }
        let value_read = percentage(value)
            .or(bound)
            .or_else(|| range(value).filter(|_| column.end.is_some()).map(of_range));
        let mark = [size, value].into_iter().find(|cell| unmarked(cell) != *cell);
        marked = marked.or_else(|| mark.map(str::to_owned));
        let number =
            value_read.filter(|&v| if retained { v >= 0.0 && v.is_finite() } else { percent_is_allowed(v) });
        let Some(number) = number else {
            let allowed = if retained { "a number from 0".to_owned() } else { allowed_percent() };
            return Err(grid.refused(line, column.column, FIELDS[1], value, allowed));
        };
        match value.contains('%') {
            true => with_sign = true,
            false if number > 0.0 && number < 1.0 => plain = plain.or(Some((line, value))),
            false => {}
        }
        let text = size.to_owned();
        entries.push(Entry { line, column: at, opening, text, form, value: number + 0.0 });
    }
    if let Some((line, value)) = plain.filter(|_| with_sign) {
        let allowed = "a number with %, as other cells of the column have: this may be a fraction of 1";
        return Err(grid.refused(line, column.column, FIELDS[1], value, allowed));
    }
    if !without.is_empty() {
        let have = if without.len() == 1 { "has" } else { "have" };
        let rows = listed(grid.row_word(), &without, |&line| grid.row_name(line));
        reading.notes.push(format!("{rows} {have} no percent: left out"));
    }
    reading.notes.extend(marked.map(|cell| format!("marks of footnotes, as in {cell}, left out")));
    check_commas(reading)?;
    Ok((entries, missing))
}

/// Converts a size of an entry to mm; 0 remains 0 in units of length.
fn in_mm(reading: &Reading, entry: &Entry, value: f64, unit: Unit) -> Result<f64, TableError> {
    if value == 0.0 && unit != Unit::Phi {
        return Ok(0.0);
    }
    let allowed = match unit {
        Unit::SieveNumber => "the number of a US sieve (4, 10, 40, 200 ...), as the heading says".to_owned(),
        Unit::Phi => "a size in phi, from -40 to 40".to_owned(),
        _ => allowed_size(),
    };
    let mm = unit.mm(value).filter(|&mm| size_is_allowed(mm) && (unit == Unit::Phi || value > 0.0));
    mm.ok_or_else(|| reading.refused_size(entry, allowed))
}

/// Rows of a column in percent finer, or in fractions.
fn finer(reading: &mut Reading, entries: &[Entry]) -> Result<Vec<Row>, TableError> {
    let factor = fractions(reading, entries)?;
    let sieves = entries.iter().filter_map(|entry| match entry.opening {
        Opening::Mm(size) => Some((size, entry.value)),
        _ => None,
    });
    let finest = sieves.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, value)| value);
    let mut rows = Vec::new();
    for entry in entries {
        let size = match entry.opening {
            Opening::Mm(size) | Opening::Below(size) => size,
            Opening::Total => {
                let row = reading.grid.row_label(entry.line);
                reading.notes.push(format!("the total in {row} was left out"));
                continue;
            }
            Opening::Pan if entry.value == 0.0 => {
                reading.notes.push("the pan was left out".into());
                continue;
            }
            Opening::Pan if Some(entry.value) == finest => {
                let note = "the percent of the pan, equal to that of the finest sieve, was left out";
                reading.notes.push(note.into());
                continue;
            }
            Opening::Pan | Opening::Bare(_) | Opening::Class(..) => {
                let allowed = "0, or nothing: the pan lets nothing pass (or a heading that says retained)";
                return Err(reading.refused_value(entry.line, entry.value, allowed));
            }
        };
        rows.push(Row { line: entry.line, size, percent: entry.value * factor });
    }
    let falls = rows.is_sorted_by(|a: &Row, b| a.size >= b.size);
    let rises = rows.is_sorted_by(|a, b| a.size <= b.size);
    if !falls && !rises && entries.iter().all(|entry| entry.form > Form::Plain) {
        let note = "rows not in order of size, each with its unit or the name of its sieve, sorted";
        reading.notes.push(note.into());
        rows.sort_by(|a, b| b.size.total_cmp(&a.size));
    }
    Ok(rows)
}

/// Factor that converts values to percents: 100 for fractions of 1.
fn fractions(reading: &mut Reading, entries: &[Entry]) -> Result<f64, TableError> {
    let of_sieves = || entries.iter().filter(|entry| !matches!(entry.opening, Opening::Total));
    let Some(top) = of_sieves().max_by(|a, b| a.value.total_cmp(&b.value)) else { return Ok(1.0) };
    let is_broken = |entry: &&Entry| entry.value > 0.0 && entry.value < 1.0;
    let broken = of_sieves().filter(is_broken).count();
    let rest_is_below_1 = || of_sieves().all(|entry| entry.value <= 1.0 || entry.value == 100.0);
    if top.value == 100.0
        && broken > 1
        && rest_is_below_1()
        && let Some(entry) = of_sieves().find(is_broken)
    {
        let allowed = "percents from 0 to 100; these look like fractions from 0 to 1 below a 100: write them \
                       in percent, or 1 for 100";
        return Err(reading.refused_value(entry.line, entry.value, allowed));
    }
    if top.value > 1.0 || broken == 0 {
        return Ok(1.0);
    }
    let heading = &reading.column.heading;
    let (says_percent, says_fraction) = (says_percent(heading), says_fraction(heading));
    if top.value == 1.0 && (says_fraction || !says_percent || reading.grid.sheet.is_some()) {
        reading.notes.push("values from 0 to 1 read as fractions: 1 is 100 %".into());
        return Ok(100.0);
    }
    let rest = match says_percent && top.value == 1.0 {
        true => " under a heading of percents: write percents, or `fraction` in the heading",
        false => ", of which the coarsest must be 1",
    };
    let allowed = format!("100 at the coarsest size; these look like fractions from 0 to 1{rest}");
    Err(reading.refused_value(top.line, top.value, allowed))
}
