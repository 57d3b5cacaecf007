//! Content of a packing file, before anything is added to it.

use super::fields::{ImportError, Kind, number};
use super::grains::Cell;
use super::unit::LengthUnit;

/// Names of the four columns in messages.
pub(super) const NAMES: [&str; 4] = ["x", "y", "z", "diameter"];

/// Grains as a file gives them.
pub(super) struct FileGrains {
    /// x, y, z and diameter, in the file's unit.
    pub columns: [Vec<f64>; 4],
    /// Unit of its lengths, if it gives one.
    pub unit: Option<LengthUnit>,
    /// Its cell.
    pub cell: FileCell,
    /// The line that names the columns, for messages.
    pub line: usize,
    /// Notes to the user on how the file was understood.
    pub notes: Vec<String>,
}

/// Boundaries according to a file.
pub(super) enum FileCell {
    /// A complete cell.
    Known(Cell),
    /// Bounds of the grains, without telling if they are periodic.
    Bounds([[f64; 2]; 3]),
    /// Periodic along some axes only, which no packing here can be.
    Mixed,
    /// Not given.
    Unsaid,
}

/// Reads one grain's row: the four numbers at `places` among its fields, the last times `factor`.
pub(super) fn grain(
    file: &str,
    line: usize,
    fields: &[&str],
    places: [usize; 4],
    factor: f64,
) -> Result<[f64; 4], ImportError> {
    let mut grain = [0.0; 4];
    for (axis, (slot, place)) in grain.iter_mut().zip(places).enumerate() {
        let kind = if axis == 3 { Kind::Positive } else { Kind::Finite };
        *slot = number(file, line, NAMES[axis], fields[place], kind)?;
    }
    grain[3] *= factor;
    Ok(grain)
}

/// Turns rows of grains into columns.
pub(super) fn in_columns(grains: &[[f64; 4]]) -> [Vec<f64>; 4] {
    std::array::from_fn(|axis| grains.iter().map(|grain| grain[axis]).collect())
}
