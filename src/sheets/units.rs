//! Unit of openings that have none: from the numbers, from a column or a row of units, or from a title.

use super::extent::Reading;
use super::grid::GridRow;
use super::heading::{Retained, Role, role, unit, words};
use super::languages::INCH;
use super::size::{Entry, Form, Opening, Unit, goes_one_way, is_us_sieve_of_inches, us_sieve};
use std::collections::HashMap;
use voidwalk_core::gradation::TableError;

/// US sieves in decimal inches, with the usual roundings, that are not the opening of a metric sieve.
/// The first few are also used in mm: one of them alone proves nothing.
const ONLY_INCHES: [f64; 70] = [
    3.5, 1.75, 1.5, 0.75, 0.875, 0.625, 0.53, 0.4375, 0.4380, 0.438, 0.44, 0.375, 0.38, 0.3125, 0.313, 0.312,
    0.265, 0.223, 0.187, 0.1870, 0.1875, 0.19, 0.157, 0.132, 0.1319, 0.111, 0.1102, 0.1110, 0.0937, 0.0938,
    0.094, 0.0929, 0.093, 0.0787, 0.079, 0.0661, 0.0669, 0.0555, 0.0551, 0.0469, 0.047, 0.0465, 0.0394,
    0.0331, 0.0335, 0.0278, 0.0234, 0.0236, 0.0232, 0.0197, 0.0165, 0.0167, 0.0139, 0.0138, 0.0117, 0.0118,
    0.0116, 0.0098, 0.0083, 0.007, 0.0059, 0.0058, 0.0049, 0.0041, 0.0035, 0.0029, 0.0025, 0.0021, 0.0017,
    0.0015,
];
/// US sieves in decimal inches that could also be metric sieves.
const ALSO_MM: [f64; 22] = [
    12.0, 6.0, 5.0, 4.0, 3.0, 2.5, 2.0, 1.25, 1.0, 0.5, 0.25, 0.033, 0.028, 0.023, 0.017, 0.012, 0.006,
    0.003, 0.01, 0.004, 0.002, 0.125,
];

/// Note on bare openings without a known unit.
pub(super) const TAKEN_AS_MM: &str = "openings without a unit taken as mm";

/// Unit of openings that are bare numbers: the unit of the heading; mm if no other opening is in inches;
/// otherwise the unit in which the openings only rise or only fall.
pub(super) fn of_bare(reading: &mut Reading, entries: &[Entry]) -> Result<Unit, TableError> {
    refuse_other_series(reading, entries)?;
    let stated = beside(reading, entries)?;
    if matches!(stated, None | Some(Unit::Mm)) {
        refuse_micrometres(reading, entries)?;
    }
    let is_no_sieve = |entry: &Entry| match entry.opening {
        Opening::Bare(value) => value != 0.0 && Unit::SieveNumber.mm(value).is_none(),
        _ => false,
    };
    refuse_other_unit(reading, entries, stated)?;
    match stated {
        // Headings also say `Sieve no.` above openings in mm.
        Some(Unit::SieveNumber) if entries.iter().any(is_no_sieve) => {}
        Some(unit) => return Ok(unit),
        None => {}
    }
    let bare = |entry: &&Entry| matches!(entry.opening, Opening::Bare(value) if value > 0.0);
    let is_sieve_number =
        |entry: &Entry| matches!(entry.opening, Opening::Bare(value) if is_whole_sieve_number(value));
    let Some(first) = entries.iter().find(bare) else { return Ok(Unit::Mm) };
    let any = |form: Form| entries.iter().any(|entry| entry.form == form);
    if let Some(entry) = first_sieve_number(entries, reading.column.role) {
        if reading.layout.unit == Some(Unit::SieveNumber) {
            // An opening that is not a sieve number is refused separately.
            return Ok(Unit::SieveNumber);
        }
        let text = &entry.text;
        let allowed = format!(
            "No. {text} or {text} mm: no unit is given, and these look like US sieve numbers; write No. \
             {text}, or head the column Sieve No.; sizes in mm need mm in the heading, as Sieve (mm)"
        );
        return Err(reading.refused_size(entry, allowed));
    }
    if any(Form::Inches) || any(Form::UsNumber) {
        match (goes_one_way_in(entries, Unit::Mm), goes_one_way_in(entries, Unit::Inch)) {
            (false, true) => {
                let note = "openings without a unit read as inches, as those around them are";
                reading.notes.push(note.into());
                return Ok(Unit::Inch);
            }
            (true, false) => {
                let is_either = |entry: &&Entry| any(Form::Inches) && is_sieve_number(entry);
                if let Some(entry) = entries.iter().find(is_either) {
                    let text = &entry.text;
                    let allowed = format!("No. {text} or {text} mm, as other rows are in inches");
                    return Err(reading.refused_size(entry, allowed));
                }
            }
            (false, false) if !any(Form::Inches) => {}
            (true, true) if !any(Form::Inches) && !is_series_of_inches(entries) => {}
            _ => {
                let allowed = "an opening with its unit (mm or in), as other rows are in inches";
                return Err(reading.refused_size(first, allowed));
            }
        }
    } else if is_series_of_inches(entries) {
        let text = &first.text;
        let allowed = format!(
            "{text} in or {text} mm: no unit is given, and all openings are those of US sieves in inches; \
             write the unit in the heading, as Sieve (in) or Sieve (mm)"
        );
        return Err(reading.refused_size(first, allowed));
    }
    reading.notes.push(TAKEN_AS_MM.into());
    Ok(Unit::Mm)
}

/// Minimum number that is read as micrometres: no sieve is finer, and larger openings in mm are rare.
const LEAST_MICROMETRES: f64 = 25.0;

/// Refuses openings whose finer part seems to be in micrometres and whose coarser part in mm: they only
/// rise or only fall if the finer ones are divided by a thousand.
fn refuse_micrometres(reading: &Reading, entries: &[Entry]) -> Result<(), TableError> {
    let sizes: Vec<(f64, &Entry)> = entries
        .iter()
        .filter_map(|entry| match entry.opening {
            Opening::Mm(mm) => Some((mm, entry)),
            Opening::Bare(value) if value > 0.0 => Some((value, entry)),
            _ => None,
        })
        .collect();
    let may_be = |(value, entry): &(f64, &Entry)| {
        matches!(entry.opening, Opening::Bare(_)) && value.fract() == 0.0 && *value >= LEAST_MICROMETRES
    };
    let in_mm = |fine: &std::ops::Range<usize>| -> Vec<f64> {
        let mm = |at: usize| if fine.contains(&at) { sizes[at].0 / 1e3 } else { sizes[at].0 };
        (0..sizes.len()).map(mm).collect()
    };
    let steps: Vec<bool> = sizes.windows(2).map(|pair| pair[0].0 > pair[1].0).collect();
    // A single step against the direction of the others marks the change of unit.
    let alone = |falls: bool| {
        let mut places = (0..steps.len()).filter(|&at| steps[at] == falls);
        places.next().filter(|_| places.next().is_none() && steps.len() > 1)
    };
    let places = [alone(true), alone(false)].into_iter().flatten();
    for fine in places.flat_map(|at| [at + 1..sizes.len(), 0..at + 1]) {
        if !sizes[fine.clone()].iter().all(may_be) || !goes_one_way(&in_mm(&fine)) {
            continue;
        }
        let beside = if fine.start > 0 { &sizes[fine.start - 1] } else { &sizes[fine.end] };
        let (value, entry) = if fine.start > 0 { sizes[fine.start] } else { sizes[fine.end - 1] };
        let (text, other) = (&entry.text, &beside.1.text);
        let allowed = format!(
            "{text} um ({} mm) beside {other}, if these are micrometres: write the unit in each cell",
            value / 1e3
        );
        return Err(reading.refused_size(entry, allowed));
    }
    Ok(())
}

/// True if the openings only rise or only fall when those without a unit are read in this one.
fn goes_one_way_in(entries: &[Entry], unit: Unit) -> bool {
    let size = |entry: &Entry| match entry.opening {
        Opening::Mm(mm) => Some(mm),
        Opening::Bare(value) if value > 0.0 => unit.mm(value),
        _ => None,
    };
    goes_one_way(&entries.iter().filter_map(size).collect::<Vec<_>>())
}

const ROUND: usize = 4;

/// True if all openings without a unit are US sieves in decimal inches and not metric sieves. The
/// ordinary series in mm, such as 4, 2, 1, 0.5, 0.25, 0.125, does not count.
fn is_series_of_inches(entries: &[Entry]) -> bool {
    let (mut only, mut round) = (false, 0);
    for entry in entries {
        let (Opening::Bare(value) | Opening::Below(value)) = entry.opening else { continue };
        if value == 0.0 || entry.form != Form::Plain {
            continue;
        }
        let place = |list: &[f64]| list.iter().position(|inches| (inches - value).abs() < 1e-9);
        match (place(&ONLY_INCHES), place(&ALSO_MM)) {
            (Some(place), _) if place < ROUND => round += 1,
            (Some(_), _) => only = true,
            (None, Some(_)) => {}
            (None, None) => return false,
        }
    }
    only || round > 1
}

const LEAST_NUMBERS: usize = 3;

/// Numbers of US sieves that are not the opening (mm) of any metric sieve.
const NO_METRIC_SIEVE: [f64; 12] =
    [7.0, 18.0, 30.0, 35.0, 60.0, 70.0, 120.0, 140.0, 170.0, 230.0, 270.0, 325.0];

fn is_whole_sieve_number(value: f64) -> bool {
    value.fract() == 0.0 && Unit::SieveNumber.mm(value).is_some()
}

/// First opening of a table whose bare openings are numbers of US sieves: whole numbers up to at least
/// No. 100, larger for finer sieves. Sizes in mm may be the same numbers, such as 4, 8, 20, 100.
fn first_sieve_number(entries: &[Entry], role: Role) -> Option<&Entry> {
    let is_inches =
        |value: f64| ONLY_INCHES.iter().chain(&ALSO_MM).any(|inches| (inches - value).abs() < 1e-9);
    let (mut numbers, mut all) = (Vec::new(), true);
    for entry in entries {
        match entry.opening {
            Opening::Bare(value) if is_whole_sieve_number(value) => numbers.push((value, entry)),
            Opening::Bare(value) if value == 0.0 || is_inches(value) => all &= value == 0.0,
            Opening::Bare(_) => return None,
            _ => {}
        }
    }
    let first = numbers.first()?.1;
    numbers.sort_by(|a, b| a.0.total_cmp(&b.0));
    numbers.dedup_by(|a, b| a.0 == b.0);
    let largest = numbers.last()?.0;
    if numbers.len() < LEAST_NUMBERS || largest < 100.0 {
        return None;
    }
    let values: Vec<f64> = numbers.iter().map(|(_, entry)| entry.value).collect();
    let rises = values.is_sorted() && values[0] < values[values.len() - 1];
    let falls = values.is_sorted_by(|a, b| a >= b) && values[0] > values[values.len() - 1];
    let is_it = match role {
        Role::Retained(Retained { cumulative: Some(true), .. }) => rises,
        Role::Retained(Retained { cumulative: None, .. }) if rises => true,
        // Values on each sieve have no direction; the pan is next to the finest sieve.
        Role::Retained(_) => match beside_pan(entries) {
            Some(value) => value == largest,
            None => all && numbers.iter().any(|(n, _)| *n >= 200.0 || NO_METRIC_SIEVE.contains(n)),
        },
        _ => falls,
    };
    is_it.then_some(first)
}

fn beside_pan(entries: &[Entry]) -> Option<f64> {
    let is_pan = |entry: &Entry| match entry.opening {
        Opening::Pan | Opening::Below(_) => true,
        Opening::Bare(value) => value == 0.0,
        _ => false,
    };
    let pan = entries.iter().position(is_pan)?;
    let beside = [pan.checked_sub(1), Some(pan + 1)].into_iter().flatten();
    beside.filter_map(|at| entries.get(at)).find_map(|entry| match entry.opening {
        Opening::Bare(value) if value > 0.0 => Some(value),
        _ => None,
    })
}

/// Adds a note about converted names of openings.
pub(super) fn say_names(entries: &[Entry], unit: Unit, notes: &mut Vec<String>) {
    let any = |form: Form| entries.iter().any(|entry| entry.form == form);
    let number = any(Form::UsNumber) || unit == Unit::SieveNumber;
    let of_inches = entries
        .iter()
        .filter(|entry| entry.form == Form::Inches || entry.form == Form::Plain && unit == Unit::Inch);
    let (mut standard, mut exact) = (false, false);
    for entry in of_inches {
        if let Opening::Mm(mm) | Opening::Below(mm) = entry.opening {
            let is_us = is_us_sieve_of_inches(mm);
            (standard, exact) = (standard || is_us, exact || !is_us);
        }
    }
    if number || standard {
        let example = if number { "No. 200 = 0.075 mm" } else { "3/8 in = 9.5 mm" };
        notes.push(format!("US sieves read as the openings of ASTM E11 ({example})"));
    }
    if exact {
        let openings = if standard { "other openings in inches" } else { "openings in inches" };
        notes.push(format!("{openings} converted exactly: 1 in = 25.4 mm"));
    }
    match unit {
        Unit::Micrometre => notes.push("openings in micrometres".into()),
        Unit::Cm => notes.push("openings in cm".into()),
        Unit::Phi => notes.push("openings in phi: size = 2^-phi mm".into()),
        _ => {}
    }
}

/// Allowed values in the error for openings without a unit beside them.
pub(super) const WITH_UNIT: &str = "openings whose heading names their unit, as Size (mm) or Size (um)";

/// Unit of bare openings as stated beside them: in the heading or in a column of units.
fn beside(reading: &Reading, entries: &[Entry]) -> Result<Option<Unit>, TableError> {
    let &Reading { grid, layout, .. } = reading;
    let bare: HashMap<usize, &Entry> =
        entries.iter().filter(|e| matches!(e.opening, Opening::Bare(_))).map(|e| (e.line, e)).collect();
    let mut stated = layout.unit.filter(|unit| *unit != Unit::SieveNumber);
    let (mut rows, mut count) = (0, 0);
    for row in &grid.rows[layout.first..] {
        let Some(entry) = bare.get(&row.line) else { continue };
        rows += 1;
        // The unit is near the openings, outside the columns of soils.
        let near = entry.column.saturating_sub(2)..=entry.column + 2;
        let Some((cell, unit)) = near.filter(|&c| c != entry.column).find_map(|c| unit_alone(row.cell(c)))
        else {
            continue;
        };
        count += 1;
        if *stated.get_or_insert(unit) != unit {
            let allowed = "one unit for all openings, or each with its unit in its own cell, as 425 um";
            return Err(grid.refused(row.line, entry.column, "unit", cell, allowed));
        }
    }
    match bare.values().next() {
        Some(entry) if count > 0 && count < rows && layout.unit.is_none() => {
            Err(reading.refused_size(entry, WITH_UNIT))
        }
        _ => Ok(stated.or(layout.unit)),
    }
}

/// Refuses bare openings if a title or a row of units states their unit, or if they are sieves in
/// another unit than the assumed one.
fn refuse_other_unit(reading: &Reading, entries: &[Entry], unit: Option<Unit>) -> Result<(), TableError> {
    const MICROMETRES: [f64; 18] = [
        45.0, 53.0, 63.0, 75.0, 90.0, 106.0, 125.0, 150.0, 180.0, 212.0, 250.0, 300.0, 355.0, 425.0, 500.0,
        600.0, 710.0, 850.0,
    ];
    /// Minimum number of openings; fewer may fit any unit.
    const LEAST: usize = 4;
    let bare = |entry: &Entry| match entry.opening {
        Opening::Bare(value) if value > 0.0 => Some(value),
        _ => None,
    };
    let sizes: Vec<f64> = entries.iter().filter_map(bare).collect();
    let Some(first) = entries.iter().find(|entry| bare(entry).is_some()) else { return Ok(()) };
    if unit.is_none() {
        for row in titles(reading) {
            if let Some(cell) = row.cells.iter().find(|cell| states_unit(cell)) {
                let allowed = format!("{WITH_UNIT}; this names one that is not mm");
                return Err(reading.grid.refused_heading(row.line, cell, &allowed));
            }
        }
    }
    let all_bare = entries.iter().all(|e| !matches!(e.opening, Opening::Mm(_) | Opening::Class(..)));
    let finest = sizes.iter().copied().fold(f64::INFINITY, f64::min);
    let in_micrometres = sizes.iter().filter(|size| MICROMETRES.contains(size)).count();
    let text = &first.text;
    let refused = |why: &str| {
        let allowed = format!("{text} um or {text} mm: {why}; write the unit in the heading");
        Err(reading.refused_size(first, allowed))
    };
    match unit {
        None if all_bare
            && sizes.iter().all(|size| size.fract() == 0.0)
            && (20.0..=100.0).contains(&finest)
            && in_micrometres >= LEAST =>
        {
            refused("no unit is given, and these look like micrometres")
        }
        Some(Unit::Micrometre)
            if sizes.len() >= LEAST
                && sizes.iter().all(|&size| us_sieve(size).is_some())
                && sizes.iter().any(|size| size.fract() != 0.0) =>
        {
            refused("the heading says micrometres, and these are sieves in mm")
        }
        _ => Ok(()),
    }
}

/// Refuses numbers of sieves if the sheet names a series that is not the United States one.
fn refuse_other_series(reading: &Reading, entries: &[Entry]) -> Result<(), TableError> {
    let (mut numbered, mut bare, mut whole, mut largest) = (None, None, true, 0.0f64);
    for entry in entries {
        if let Opening::Bare(value) = entry.opening {
            bare = bare.or(Some(entry));
            whole &= value.fract() == 0.0;
            largest = largest.max(value);
        }
        numbered = numbered.or(Some(entry).filter(|e| e.form == Form::UsNumber));
    }
    let may_be_numbers =
        matches!(reading.layout.unit, None | Some(Unit::SieveNumber)) && whole && largest >= 100.0;
    let Some(entry) = numbered.or(bare.filter(|_| may_be_numbers)) else { return Ok(()) };
    let named = titles(reading).flat_map(|row| &row.cells).find_map(|cell| other_series(cell));
    let Some(series) = named else { return Ok(()) };
    let allowed =
        format!("openings in mm: the sheet names {series}, whose numbers are not those of US sieves");
    Err(reading.refused_size(entry, allowed))
}

fn titles<'a>(reading: &Reading<'a>) -> impl Iterator<Item = &'a GridRow> {
    let rows = &reading.grid.rows;
    rows[..reading.layout.first.min(rows.len())].iter()
}

/// Series of sieves named by a text, if it is not the United States one.
fn other_series(text: &str) -> Option<String> {
    const NAMES: [&str; 5] = ["TYLER", "JIS", "AFNOR", "GOST", "ГОСТ"];
    let parts: Vec<&str> =
        text.split(|c: char| !c.is_alphanumeric()).filter(|part| !part.is_empty()).collect();
    let is_sieve = |part: &&str| {
        part.bytes().all(|b| b.is_ascii_digit())
            || ["sieve", "sieves", "mesh", "no", "number", "size", "test"]
                .contains(&part.to_lowercase().as_str())
    };
    parts.iter().enumerate().find_map(|(at, part)| {
        let next = parts.get(at + 1);
        let is_it = NAMES.contains(&part.to_uppercase().as_str())
            || ["BS", "BSS"].contains(part)
            || *part == "B" && next == Some(&"S") && text.contains("B.S")
            // `IS` is also an ordinary word.
            || *part == "IS" && (parts.len() == 1 || next.is_some_and(is_sieve));
        is_it.then(|| (*part).to_owned())
    })
}

/// True for a cell that contains only a unit of length; returns it.
fn unit_alone(cell: &str) -> Option<(&str, Unit)> {
    const LONGEST: usize = 16;
    let bare = cell.trim_matches(['(', ')', '[', ']', '.', ' ']);
    let is_one =
        (1..=LONGEST).contains(&bare.len()) && !bare.contains(|c: char| c.is_ascii_digit() || c == ' ');
    let unit = if is_one { unit(bare).ok().flatten() } else { None };
    unit.filter(|unit| *unit != Unit::SieveNumber && role(bare) != Role::Finer).map(|unit| (cell, unit))
}

/// True if a title or a remark names a unit of openings that is not mm; `below 63 µm` names a size.
pub(super) fn states_unit(text: &str) -> bool {
    let all = words(text);
    let behind_number = |word: &str| {
        let at = text.to_lowercase().find(word).unwrap_or(0);
        text.to_lowercase()[..at].trim_end().ends_with(|c: char| c.is_ascii_digit())
    };
    let is_stated = |word: &String| match unit(word) {
        Ok(Some(Unit::Micrometre)) => true,
        Ok(Some(Unit::Phi)) => all.len() > 1,
        Ok(Some(Unit::Inch)) => INCH.any(&all),
        _ => false,
    };
    let units: Vec<&String> = all.iter().filter(|word| is_stated(word) && !behind_number(word)).collect();
    let needs_size = !units.iter().any(|word| unit(word) == Ok(Some(Unit::Micrometre)));
    let says_size =
        role(text) == Role::Size || all.iter().any(|word| role(word) == Role::Size && !units.contains(&word));
    !units.is_empty() && (!needs_size || says_size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Soil, parse_gradation};
    use voidwalk_core::gradation::Gradation;

    fn read(heading: &str, rows: &[&str], backwards: bool) -> Result<Gradation, String> {
        let mut rows = rows.to_vec();
        if backwards {
            rows.reverse();
        }
        let text = format!("{heading}\n{}\n", rows.join("\n"));
        parse_gradation("a.csv", text.as_bytes(), None).map_err(|error| error.to_string())
    }

    #[test]
    fn bare_numbers_of_us_sieves_are_refused_in_either_order() {
        for (heading, rows) in [
            ("Sieve,% Passing", &["4,100", "16,68", "50,17", "200,1.5"][..]),
            ("US Sieve,% Passing", &["0.375,100", "4,97", "16,68", "50,17", "200,1.5"]),
            ("Sieve,% Passing", &["#4,100", "16,68", "50,17", "200,1.5"]),
            ("US Sieve,% Retained", &["16,0", "30,20", "50,60", "100,20", "200,0"]),
            ("Sieve,% Retained", &["4,10", "8,25", "16,40", "50,25", "100,0", "Pan,0"]),
            ("Sieve,Mass retained (g)", &["3/8,0", "4,15", "40,300", "200,17.5", "Pan,7.5"]),
            ("Sieve,Cumulative % retained", &["4,0", "10,20", "40,60", "100,98"]),
        ] {
            for backwards in [false, true] {
                let message = read(heading, rows, backwards).unwrap_err();
                assert!(message.contains("look like US sieve numbers"), "{heading}: {message}");
                assert!(message.contains("line ") && message.contains("sizes in mm need mm"), "{message}");
                let in_mm = heading.replace("Sieve", "Sieve (mm)");
                let message = read(&in_mm, rows, backwards).err().unwrap_or_default();
                assert!(!message.contains("US sieve numbers"), "{in_mm}");
            }
        }
        let bare = read("4,100", &["10,68", "40,17", "200,1.5"], false).unwrap_err();
        assert!(bare.contains("a.csv, line 1, ") && bare.contains("US sieve numbers"), "{bare}");
        let beside = read("Sieve,% Passing", &["1 1/2,100", "3/4,60", "10,7"], false).unwrap_err();
        assert!(beside.contains("No. 10 or 10 mm"), "{beside}");
        let numbered = read("Sieve No.,% Passing", &["4,100", "16,68", "50,17", "200,1.5"], false);
        assert_eq!(numbered.unwrap().largest_mm(), 4.75);
    }

    #[test]
    fn whole_sizes_in_mm_are_read_without_a_unit() {
        for (heading, rows, largest) in [
            ("Sieve,% Passing", &["4,10", "8,30", "16,60", "31.5,100"][..], 31.5),
            ("Sieve,% Passing", &["4,10", "8,30", "20,60", "100,100"], 100.0),
            ("Sieve,% Passing", &["5,10", "20,30", "50,60", "200,100"], 200.0),
            ("Sieve,% Retained", &["100,0", "50,30", "20,40", "10,20", "5,10"], 100.0),
            ("Sieve,Mass retained (g)", &["200,0", "50,30", "30,40", "10,20", "Pan,10"], 200.0),
            ("Sieve,Cumulative % retained", &["200,0", "50,30", "30,70", "10,100"], 200.0),
            ("Sieve,% Retained", &["80,0", "40,30", "20,40", "10,20", "5,10"], 80.0),
        ] {
            for backwards in [false, true] {
                let curve = read(heading, rows, backwards);
                assert_eq!(curve.map(|curve| curve.largest_mm()), Ok(largest), "{heading} {rows:?}");
            }
        }
    }

    #[test]
    fn only_us_sieves_are_said_to_be_read_as_such() {
        let notes = |text: &str| Soil::all("a.csv", text.as_bytes()).unwrap()[0].notes().join("; ");
        let exact = notes("in,percent finer\n9.5,100\n4.75,90\n1.18,50\n0.3,2\n");
        assert!(exact.contains("openings in inches converted exactly: 1 in = 25.4 mm"), "{exact}");
        assert!(!exact.contains("US sieves"), "{exact}");
        let standard = notes("in,percent finer\n1,100\n0.75,90\n0.375,50\n");
        assert!(standard.contains("ASTM E11 (3/8 in = 9.5 mm)") && !standard.contains("25.4"), "{standard}");
        let both = notes("Sieve,% finer\n6 in,100\n3/4 in,50\n3/8 in,2\n");
        assert!(both.contains("ASTM E11") && both.contains("other openings in inches converted exactly"));
    }

    #[test]
    fn titles_state_units_and_series_of_sieves() {
        for title in "Sieve sizes in microns|Sieve openings in inches|Units: um and %".split('|') {
            assert!(states_unit(title), "{title}");
        }
        for title in ["Fines below 63 µm", "phi", "Dam, north", "Sieve (mm)", "Gradation in soils"] {
            assert!(!states_unit(title), "{title}");
        }
        assert!(["IS 2720", "JIS Z 8801", "ГОСТ"].into_iter().all(|title| other_series(title).is_some()));
        for title in ["US mesh", "this is sieve 4", "Sieve No.", "ASTM", "IS THE SOIL", "BSc"] {
            assert!(other_series(title).is_none(), "{title}");
        }
    }

    #[test]
    fn units_are_understood_in_many_languages_and_others_are_refused() {
        let all = "Size (µ)|Size (μ)|Sieve size, mikrometer|Korngröße (Mikrometer)|Tamiz (micras)|\
            Tamiz (micrones)|Peneira (mícrons)|Abertura (micrómetros)|Taille (micromètres)|\
            Sito (mikrony)|Elek (mikron)|Size (mcm)|Size [mic]|Diameter, mu|孔径(微米)|SizeUm|sizeUM|\
            Sieve, Micro meter|Size (1/1000 mm)|Sieve opening (10^-3 mm)|Size (10⁻³ mm)|\
            Maschenweite in Mikrometern|Size (㎛)";
        for name in all.split('|') {
            assert_eq!(unit(name), Ok(Some(Unit::Micrometre)), "{name}");
        }
        let all = "Tamiz (pulg)|Tamiz (pulgadas)|Peneira (pol)|Tamis (pouces)|Setaccio (pollici)|\
            Siebweite (Zoll)|Zeef (duim)|Sieve (ins)";
        for name in all.split('|') {
            assert_eq!(unit(name), Ok(Some(Unit::Inch)), "{name}");
        }
        for name in ["Microsieve (mm)", "SizeMm", "Ø (mm)"] {
            assert_eq!(unit(name), Ok(Some(Unit::Mm)), "{name}");
        }
        for name in ["Size (furlongs)", "Sieve [xyz]", "Ø", "Size (ø)"] {
            assert_eq!(unit(name), Err(()), "{name}");
        }
        for name in "Sieve (ASTM)|Sieve size (US)|Particle size (D)|Sieve (opening)|Size (D6913)".split('|') {
            assert_eq!(unit(name), Ok(None), "{name}");
        }
        assert_eq!(unit("Grain size, phi units"), Ok(Some(Unit::Phi)));
    }
}
