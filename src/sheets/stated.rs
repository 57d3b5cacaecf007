//! Units and series of sieves that a sheet states elsewhere than in the heading of its openings or in their
//! cells: in a column or a row of units, in a title, or by the openings themselves.

use std::collections::HashMap;

use super::grid::{Grid, GridRow};
use super::heading::{Role, role, unit, words};
use super::languages::say_inches;
use super::layout::Layout;
use super::size::{Entry, Form, Opening, Unit, is_us_sieve};
use voidwalk_core::gradation::FIELDS;
use voidwalk_core::gradation::TableError;

/// Allowed text of the error for openings without a unit beside them.
const ALLOWED: &str = "openings whose heading names their unit, as Size (mm) or Size (um)";

/// Unit of bare openings as stated beside them, in the heading or in a column of units.
pub(super) fn beside(grid: &Grid, layout: &Layout, entries: &[Entry]) -> Result<Option<Unit>, TableError> {
    let bare: HashMap<usize, &Entry> =
        entries.iter().filter(|e| matches!(e.opening, Opening::Bare(_))).map(|e| (e.line, e)).collect();
    let mut stated = layout.unit.filter(|unit| *unit != Unit::SieveNumber);
    let (mut rows, mut count) = (0, 0);
    for row in &grid.rows[layout.first..] {
        let Some(entry) = bare.get(&row.line) else { continue };
        rows += 1;
        // The unit lies near the openings, outside the columns of soils.
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
            Err(grid.refused(entry.line, entry.column, FIELDS[0], &entry.text, ALLOWED))
        }
        _ => Ok(stated.or(layout.unit)),
    }
}

/// Refuses bare openings if a title or a row of units states their unit, or if they are sieves in another
/// unit than the one taken.
pub(super) fn refuse_other_unit(
    grid: &Grid,
    layout: &Layout,
    entries: &[Entry],
    unit: Option<Unit>,
) -> Result<(), TableError> {
    const MICROMETRES: [f64; 18] = [
        45.0, 53.0, 63.0, 75.0, 90.0, 106.0, 125.0, 150.0, 180.0, 212.0, 250.0, 300.0, 355.0, 425.0, 500.0,
        600.0, 710.0, 850.0,
    ];
    /// Fewer may be chosen in any unit.
    const LEAST: usize = 4;
    let bare = |entry: &Entry| match entry.opening {
        Opening::Bare(value) if value > 0.0 => Some(value),
        _ => None,
    };
    let sizes: Vec<f64> = entries.iter().filter_map(bare).collect();
    let Some(first) = entries.iter().find(|entry| bare(entry).is_some()) else { return Ok(()) };
    if unit.is_none() {
        for row in titles(grid, layout) {
            if let Some(cell) = row.cells.iter().find(|cell| states_unit(cell)) {
                let allowed = format!("{ALLOWED}; this names one that is not mm");
                return Err(grid.refused_heading(row.line, cell, &allowed));
            }
        }
    }
    let all_bare = entries.iter().all(|e| !matches!(e.opening, Opening::Mm(_) | Opening::Class(..)));
    let finest = sizes.iter().copied().fold(f64::INFINITY, f64::min);
    let in_micrometres = sizes.iter().filter(|size| MICROMETRES.contains(size)).count();
    let text = &first.text;
    let refused = |why: &str| {
        let allowed = format!("{text} um or {text} mm: {why}; write the unit in the heading");
        Err(grid.refused(first.line, first.column, FIELDS[0], text, allowed))
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
                && sizes.iter().all(|&size| is_us_sieve(size))
                && sizes.iter().any(|size| size.fract() != 0.0) =>
        {
            refused("the heading says micrometres, and these are sieves in mm")
        }
        _ => Ok(()),
    }
}

/// Refuses sieves by number if the sheet names a series other than the United States one.
pub(super) fn refuse_other_series(grid: &Grid, layout: &Layout, entries: &[Entry]) -> Result<(), TableError> {
    let (mut numbered, mut bare, mut whole, mut largest) = (None, None, true, 0.0f64);
    for entry in entries {
        if let Opening::Bare(value) = entry.opening {
            bare = bare.or(Some(entry));
            whole &= value.fract() == 0.0;
            largest = largest.max(value);
        }
        numbered = numbered.or(Some(entry).filter(|e| e.form == Form::UsNumber));
    }
    let may_be_numbers = matches!(layout.unit, None | Some(Unit::SieveNumber)) && whole && largest >= 100.0;
    let Some(entry) = numbered.or(bare.filter(|_| may_be_numbers)) else { return Ok(()) };
    let named = titles(grid, layout).flat_map(|row| &row.cells).find_map(|cell| other_series(cell));
    let Some(series) = named else { return Ok(()) };
    let allowed =
        format!("openings in mm: the sheet names {series}, whose numbers are not those of US sieves");
    Err(grid.refused(entry.line, entry.column, FIELDS[0], &entry.text, allowed))
}

/// The headings of a table and the rows above them.
fn titles<'a>(grid: &'a Grid, layout: &Layout) -> impl Iterator<Item = &'a GridRow> {
    grid.rows[..layout.first.min(grid.rows.len())].iter()
}

/// Series of sieves that a text names, other than the United States one.
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
            // `IS` is also a word.
            || *part == "IS" && (parts.len() == 1 || next.is_some_and(is_sieve));
        is_it.then(|| (*part).to_owned())
    })
}

/// A cell that holds nothing but a unit of length.
fn unit_alone(cell: &str) -> Option<(&str, Unit)> {
    const LONGEST: usize = 16;
    let bare = cell.trim_matches(['(', ')', '[', ']', '.', ' ']);
    let is_one =
        (1..=LONGEST).contains(&bare.len()) && !bare.contains(|c: char| c.is_ascii_digit() || c == ' ');
    let unit = if is_one { unit(bare).ok().flatten() } else { None };
    unit.filter(|unit| *unit != Unit::SieveNumber && role(bare) != Role::Finer).map(|unit| (cell, unit))
}

/// True if a title or a remark names a unit of openings other than mm; `below 63 µm` names a size.
pub(super) fn states_unit(text: &str) -> bool {
    let all = words(text);
    let behind_number = |word: &str| {
        let at = text.to_lowercase().find(word).unwrap_or(0);
        text.to_lowercase()[..at].trim_end().ends_with(|c: char| c.is_ascii_digit())
    };
    let is_stated = |word: &String| match unit(word) {
        Ok(Some(Unit::Micrometre)) => true,
        Ok(Some(Unit::Phi)) => all.len() > 1,
        Ok(Some(Unit::Inch)) => say_inches(&all),
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

    #[test]
    fn titles_state_units_and_series_of_sieves() {
        for title in [
            "Sizes in µm",
            "Sieve sizes in microns",
            "Grain size in phi units",
            "unit: um",
            "# size_um,percent_finer",
            "Sieve openings in inches",
            "µm",
            "Units: um and %",
        ] {
            assert!(states_unit(title), "{title}");
        }
        for title in ["Fines below 63 µm", "phi", "Dam, north", "Sieve (mm)", "Gradation in soils"] {
            assert!(!states_unit(title), "{title}");
        }
        for title in [
            "Tyler mesh",
            "BS No.",
            "B.S. sieve no.",
            "IS Sieve",
            "IS 2720",
            "JIS Z 8801",
            "BSS mesh",
            "GOST",
        ] {
            assert!(other_series(title).is_some(), "{title}");
        }
        for title in ["US mesh", "this is sieve 4", "Sieve No.", "ASTM", "IS THE SOIL", "BSc"] {
            assert!(other_series(title).is_none(), "{title}");
        }
    }
    #[test]
    fn units_are_understood_in_many_languages_and_others_are_refused() {
        for name in [
            "Size (µ)",
            "Size (μ)",
            "Sieve size, mikrometer",
            "Korngröße (Mikrometer)",
            "Tamiz (micras)",
            "Tamiz (micrones)",
            "Peneira (mícrons)",
            "Abertura (micrómetros)",
            "Taille (micromètres)",
            "Sito (mikrony)",
            "Elek (mikron)",
            "Size (mcm)",
            "Size [mic]",
            "Diameter, mu",
            "孔径(微米)",
            "SizeUm",
            "sizeUM",
            "Sieve, Micro meter",
            "Size (1/1000 mm)",
            "Sieve opening (10^-3 mm)",
            "Size (10⁻³ mm)",
            "Maschenweite in Mikrometern",
            "Size (㎛)",
        ] {
            assert_eq!(unit(name), Ok(Some(Unit::Micrometre)), "{name}");
        }
        for name in [
            "Tamiz (pulg)",
            "Tamiz (pulgadas)",
            "Peneira (pol)",
            "Tamis (pouces)",
            "Setaccio (pollici)",
            "Siebweite (Zoll)",
            "Zeef (duim)",
            "Sieve (ins)",
        ] {
            assert_eq!(unit(name), Ok(Some(Unit::Inch)), "{name}");
        }
        for name in ["Microsieve (mm)", "SizeMm", "Ø (mm)"] {
            assert_eq!(unit(name), Ok(Some(Unit::Mm)), "{name}");
        }
        for name in ["Size (furlongs)", "Sieve [xyz]", "Ø", "Size (ø)"] {
            assert_eq!(unit(name), Err(()), "{name}");
        }
        for name in
            ["Sieve (ASTM)", "Sieve size (US)", "Particle size (D)", "Sieve (opening)", "Size (D6913)"]
        {
            assert_eq!(unit(name), Ok(None), "{name}");
        }
        assert_eq!(unit("Grain size, phi units"), Ok(Some(Unit::Phi)));
    }
}
