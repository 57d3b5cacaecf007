//! Text dumps of LAMMPS and LIGGGHTS.
//!
//! Reads the last frame with atoms of a dump with the columns `x y z` (or `xu`, `xs`, `xsu` and so on),
//! `radius` or `diameter`, and `id` if present, which then decides the order. Boundaries `pp pp pp` are a
//! periodic cell, moved to the origin; boundaries without any `p` are free, and so are others if the user
//! says so. `ITEM: UNITS` (LAMMPS writes it after `dump_modify ID units yes`, LIGGGHTS does not) gives the
//! unit of length: `si`, `cgs`, `micro` and `nano` have one, `lj` has none, and the others are of atoms.

use super::fields::{ImportError, Kind, Line, number, refused};
use super::found::{FileCell, FileGrains};
use super::grains::Cell;
use super::unit::LengthUnit;
use crate::gradation::shortened;

/// Form of a coordinate in a dump.
#[derive(Clone, Copy)]
struct Coordinate {
    place: usize,
    /// True for a fraction of the box.
    scaled: bool,
}

/// Systems of units of LAMMPS with a unit of length.
const UNITS: [(&str, LengthUnit); 4] =
    [("si", LengthUnit::M), ("cgs", LengthUnit::Cm), ("micro", LengthUnit::Um), ("nano", LengthUnit::Nm)];

/// System of units in which a length has no unit.
const REDUCED: &str = "lj";

/// Reads the units of a dump, given once or before every frame: the name, and its unit of length.
fn unit(
    file: &str,
    text: &str,
    given: Option<LengthUnit>,
) -> Result<Option<(&'static str, LengthUnit)>, ImportError> {
    let mut named: Option<(&str, LengthUnit)> = None;
    for (at, item) in text.match_indices("ITEM: UNITS") {
        let line = 2 + text[..at].matches('\n').count();
        let name = text[at + item.len()..].lines().nth(1).map_or("", str::trim);
        let unit = match (UNITS.into_iter().find(|unit| unit.0 == name), given) {
            (Some(unit), _) => unit,
            (None, Some(given)) if name == REDUCED => (REDUCED, given),
            (None, _) => {
                let allowed = "si, cgs, micro or nano; with lj, --unit (network.unit in a scene) says what a \
                               length of 1 is; the others are of atoms";
                return Err(refused(file, line, "units", name, allowed));
            }
        };
        if named.is_some_and(|before| before.0 != unit.0) {
            return Err(refused(file, line, "units", name, "the same units in every frame"));
        }
        named = Some(unit);
    }
    Ok(named)
}

/// Reads the last frame; `given` is the unit that the user names.
pub(super) fn dump(file: &str, text: &str, given: Option<LengthUnit>) -> Result<FileGrains, ImportError> {
    let unit = unit(file, text, given)?;
    let frames = text.matches(FRAME).count();
    // Only the last frame with atoms is parsed, so that a long run costs no more than its end.
    let (mut start, mut end) = (text.rfind(FRAME).unwrap_or(0), text.len());
    while is_empty(&text[start..end])
        && let Some(before) = text[..start].rfind(FRAME)
    {
        (start, end) = (before, start);
    }
    let with_atoms = if end == text.len() { "" } else { " with atoms" };
    let text = &text[..end];
    let mut notes = Vec::new();
    if frames > 1 {
        let step = text[start..].lines().nth(1).map_or("", str::trim);
        let step = shortened(step);
        notes.push(format!("holds {frames} frames: the last one{with_atoms}, timestep {step}, is taken"));
    }
    let before = text[..start].matches('\n').count();
    let mut lines = text[start..].lines().enumerate().map(|(i, line)| (before + i + 1, line));
    let (mut atoms, mut bounds, mut last) = (None, None, before);
    let ended = |line: usize, expected: &str| ImportError::Truncated {
        file: file.into(),
        line,
        expected: expected.into(),
    };
    while let Some((line, item)) = lines.next() {
        last = line;
        let Some(item) = item.trim().strip_prefix("ITEM:").map(str::trim) else {
            if item.trim().is_empty() {
                continue;
            }
            return Err(refused(file, line, "section", item, "a line that starts with ITEM:"));
        };
        if item == "NUMBER OF ATOMS" {
            let (line, value) = lines.next().ok_or_else(|| ended(last, "the number of atoms"))?;
            let count = value.trim().parse::<u64>().ok().filter(|&n| n > 0);
            atoms = Some(
                count
                    .ok_or_else(|| refused(file, line, "number of atoms", value, "a whole number from 1"))?,
            );
        } else if let Some(kinds) = item.strip_prefix("BOX BOUNDS") {
            let mut box_lines = [(0, ""); 3];
            for slot in &mut box_lines {
                *slot = lines.next().ok_or_else(|| ended(last, "three lines of box bounds"))?;
                last = slot.0;
            }
            bounds = Some(box_bounds(file, (line, kinds), box_lines)?);
        } else if let Some(columns) = item.strip_prefix("ATOMS") {
            let atoms =
                atoms.ok_or_else(|| refused(file, line, "section", item, "ITEM: NUMBER OF ATOMS first"))?;
            let bounds =
                bounds.ok_or_else(|| refused(file, line, "section", item, "ITEM: BOX BOUNDS first"))?;
            let (cell, columns) = rows(file, (line, columns), atoms, bounds, lines)?;
            let unit = unit.map(|(_, unit)| unit);
            return Ok(FileGrains { columns, unit, cell, line, notes });
        } else {
            // TIMESTEP, TIME, UNITS: one line, known by now or not needed.
            lines.next();
        }
    }
    Err(ended(last, "ITEM: ATOMS"))
}

/// First words of a frame.
const FRAME: &str = "ITEM: TIMESTEP";

/// Tells if a frame declares no atoms.
fn is_empty(frame: &str) -> bool {
    let number = frame.split_once("ITEM: NUMBER OF ATOMS").and_then(|(_, rest)| rest.lines().nth(1));
    number.is_some_and(|number| number.trim() == "0")
}

/// Periodicity of the box (unknown if it is periodic along some axes only), and its bounds.
type Bounds = (Option<bool>, [[f64; 2]; 3]);

fn box_bounds(file: &str, (line, kinds): Line<'_>, lines: [Line<'_>; 3]) -> Result<Bounds, ImportError> {
    let words: Vec<&str> = kinds.split_whitespace().collect();
    if words.contains(&"xy") || words.contains(&"abc") {
        return Err(refused(file, line, "box bounds", kinds, "a box with right angles"));
    }
    let [_, _, _] = words[..] else {
        let allowed = "three boundaries, as pp pp pp (a periodic cell) or ff ff ff (free)";
        return Err(refused(file, line, "box bounds", kinds.trim(), allowed));
    };
    let periodic = match words.iter().filter(|&&kind| kind == "pp").count() {
        3 => Some(true),
        0 if words.iter().all(|kind| !kind.contains('p')) => Some(false),
        _ => None,
    };
    let mut bounds = [[0.0; 2]; 3];
    for (slot, (line, text)) in bounds.iter_mut().zip(lines) {
        let values: Vec<&str> = text.split_whitespace().collect();
        let [low, high] = values[..] else {
            return Err(refused(file, line, "box bounds", text, "two numbers, low and high"));
        };
        let read = |text| number(file, line, "box bounds", text, Kind::Finite);
        *slot = [read(low)?, read(high)?];
        if slot[0] >= slot[1] {
            return Err(refused(file, line, "box bounds", text, "a low bound below the high one"));
        }
    }
    Ok((periodic, bounds))
}

fn rows<'a>(
    file: &str,
    (header_line, header): Line<'_>,
    atoms: u64,
    (periodic, bounds): Bounds,
    lines: impl Iterator<Item = Line<'a>>,
) -> Result<(FileCell, [Vec<f64>; 4]), ImportError> {
    let names: Vec<&str> = header.split_whitespace().collect();
    let place = |name: &str| names.iter().position(|&n| n == name);
    let missing = |what: &str| refused(file, header_line, "columns", header.trim(), what);
    let coordinate = |axis: &str| {
        [("", false), ("u", false), ("s", true), ("su", true)].into_iter().find_map(|(suffix, scaled)| {
            place(&format!("{axis}{suffix}")).map(|place| Coordinate { place, scaled })
        })
    };
    let mut coordinates = [Coordinate { place: 0, scaled: false }; 3];
    for (slot, axis) in coordinates.iter_mut().zip(["x", "y", "z"]) {
        *slot = coordinate(axis).ok_or_else(|| missing("columns x, y and z (or xu, xs, xsu and so on)"))?;
    }
    let (size, factor) = match (place("diameter"), place("radius")) {
        (Some(diameter), _) => (diameter, 1.0),
        (None, Some(radius)) => (radius, 2.0),
        (None, None) => return Err(missing("a column called diameter or radius")),
    };
    let (id, mut grains) = (place("id"), Vec::new());
    let mut last = header_line;
    for (line, row) in lines {
        if row.trim().is_empty() {
            continue;
        }
        last = line;
        if grains.len() as u64 == atoms {
            let allowed = format!("{atoms} rows, the number of atoms, and then the end of the file");
            return Err(refused(file, line, "atoms", row, allowed));
        }
        let fields: Vec<&str> = row.split_whitespace().collect();
        if fields.len() != names.len() {
            return Err(refused(file, line, "atoms", row, format!("{} fields", names.len())));
        }
        let mut grain = [0.0; 4];
        for (axis, (slot, at)) in grain.iter_mut().zip(coordinates).enumerate() {
            let [low, high] = bounds[axis];
            let value = number(file, line, ["x", "y", "z"][axis], fields[at.place], Kind::Finite)?;
            let value = if at.scaled { low + value * (high - low) } else { value };
            *slot = if periodic == Some(true) { value - low } else { value };
        }
        grain[3] = factor * number(file, line, "diameter", fields[size], Kind::Positive)?;
        let order = match id {
            Some(place) => fields[place]
                .parse::<u64>()
                .map_err(|_| refused(file, line, "id", fields[place], "a whole number"))?,
            None => grains.len() as u64,
        };
        grains.push((order, line, grain));
    }
    if (grains.len() as u64) < atoms {
        let expected = format!("{atoms} rows of atoms, {} found", grains.len());
        return Err(ImportError::Truncated { file: file.into(), line: last, expected });
    }
    grains.sort_by_key(|&(order, line, _)| (order, line));
    if let Some(pair) = grains.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let allowed = format!("every id once (it stands on line {} too)", pair[0].1);
        return Err(refused(file, pair[1].1, "id", &pair[1].0.to_string(), allowed));
    }
    let column = |axis: usize| grains.iter().map(|(_, _, grain)| grain[axis]).collect();
    let cell = match periodic {
        Some(true) => FileCell::Known(Cell::Periodic(bounds.map(|[low, high]| high - low))),
        Some(false) => FileCell::Known(Cell::Free),
        None => FileCell::Mixed,
    };
    Ok((cell, [0, 1, 2, 3].map(column)))
}
