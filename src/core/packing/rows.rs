//! Packings as rows of numbers with spaces between: Yade's `export.text` and MercuryDPM's `.data`.
//!
//! Yade writes a first line `#format x_y_z_r` (further columns may follow, as `matId`), perhaps a comment,
//! and a row per sphere. MercuryDPM writes frames: a line with the number of particles, the time and the
//! bounds `xmin ymin zmin xmax ymax zmax`, then as many rows of 14 numbers or more: position, velocity,
//! radius, rotation, angular velocity and one more. The last frame with grains is taken. Neither gives its
//! unit of length or tells if its boundaries are periodic.

use super::fields::{ImportError, Kind, number, refused};
use super::found::{FileCell, FileGrains, grain, in_columns};
use crate::gradation::shortened;

/// Numbers of a MercuryDPM header: in three dimensions, and in two.
const HEADERS: [usize; 2] = [8, 6];
/// Numbers in a MercuryDPM row, and the place of the radius.
const ROW: (usize, usize) = (14, 6);

fn ended(file: &str, line: usize, expected: impl Into<String>) -> ImportError {
    ImportError::Truncated { file: file.into(), line, expected: expected.into() }
}

/// Reads a file of Yade.
pub(super) fn yade(file: &str, text: &str) -> Result<FileGrains, ImportError> {
    let mut lines =
        text.lines().enumerate().map(|(i, line)| (i + 1, line.trim())).filter(|(_, l)| !l.is_empty());
    let Some((line, first)) = lines.next() else { return Err(ended(file, 0, "a line #format x_y_z_r")) };
    let names: Vec<&str> = first.trim_start_matches("#format").trim().split('_').collect();
    let place = |name: &str| names.iter().position(|named| *named == name);
    let (Some(x), Some(y), Some(z), Some(r)) = (place("x"), place("y"), place("z"), place("r")) else {
        return Err(refused(
            file,
            line,
            "format",
            first,
            "x, y, z and r among the columns, as #format x_y_z_r",
        ));
    };
    let (mut grains, mut last) = (Vec::new(), line);
    for (line, row) in lines.filter(|(_, line)| !line.starts_with('#')) {
        last = line;
        let fields: Vec<&str> = row.split_whitespace().collect();
        // The last of the columns may be a vector or a list of several words.
        if fields.len() < names.len() {
            return Err(refused(file, line, "row", row, format!("{} fields, as in line 1", names.len())));
        }
        grains.push(grain(file, line, &fields, [x, y, z, r], 2.0)?);
    }
    if grains.is_empty() {
        return Err(ended(file, last, "at least one sphere"));
    }
    let columns = in_columns(&grains);
    Ok(FileGrains { columns, unit: None, cell: FileCell::Unsaid, line, notes: Vec::new() })
}

/// Tells if a text begins like a frame of MercuryDPM: with numbers alone.
pub(super) fn is_mercury(text: &str) -> bool {
    let line = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#'));
    line.is_some_and(|line| {
        let words: Vec<&str> = line.split_whitespace().collect();
        HEADERS.contains(&words.len())
            && words[0].parse::<u64>().is_ok()
            && words.iter().all(|word| word.parse::<f64>().is_ok())
    })
}

/// Reads a file of MercuryDPM.
pub(super) fn mercury(file: &str, text: &str) -> Result<FileGrains, ImportError> {
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(i, line)| (i + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let (mut frames, mut frame, mut last, mut is_last) = (0, None, 0, true);
    while let Some((line, header)) = lines.next() {
        let words: Vec<&str> = header.split_whitespace().collect();
        if words.len() == HEADERS[1] {
            return Err(refused(
                file,
                line,
                "frame",
                header,
                "three dimensions: N time xmin ymin zmin xmax ymax zmax",
            ));
        }
        let count = words[0].parse::<usize>().ok().filter(|_| words.len() == HEADERS[0]);
        let allowed = "N time xmin ymin zmin xmax ymax zmax";
        let count = count.ok_or_else(|| refused(file, line, "frame", header, allowed))?;
        let mut bounds = [[0.0; 2]; 3];
        for (axis, slot) in bounds.iter_mut().enumerate() {
            let read = |word| number(file, line, "bounds", word, Kind::Finite);
            *slot = [read(words[2 + axis])?, read(words[5 + axis])?];
            if slot[0] >= slot[1] {
                return Err(refused(file, line, "bounds", header, "a low bound below the high one"));
            }
        }
        let rows: Vec<(usize, &str)> = lines.by_ref().take(count).collect();
        if rows.len() < count {
            let expected = format!("{count} rows of particles, {} found", rows.len());
            return Err(ended(file, line + rows.len(), expected));
        }
        frames += 1;
        // The first frame is empty in a simulation that fills a box, the last in one that empties it.
        (last, is_last) = (line, count > 0);
        if count > 0 {
            frame = Some((line, words[1], bounds, rows));
        }
    }
    let Some((line, time, bounds, rows)) = frame else {
        return Err(ended(file, last, "a frame with at least one particle"));
    };
    let mut grains = Vec::with_capacity(rows.len());
    for (line, row) in rows {
        let fields: Vec<&str> = row.split_whitespace().collect();
        if fields.len() < ROW.0 {
            let allowed = format!(
                "at least {} numbers: position, velocity, radius, rotation, angular velocity, one more",
                ROW.0
            );
            return Err(refused(file, line, "particle", row, allowed));
        }
        grains.push(grain(file, line, &fields, [0, 1, 2, ROW.1], 2.0)?);
    }
    let notes = match frames {
        1 => Vec::new(),
        n => {
            let with_grains = if is_last { "" } else { " with grains" };
            let time = shortened(time);
            vec![format!("holds {n} frames: the last one{with_grains}, time {time}, is taken")]
        }
    };
    Ok(FileGrains { columns: in_columns(&grains), unit: None, cell: FileCell::Bounds(bounds), line, notes })
}
