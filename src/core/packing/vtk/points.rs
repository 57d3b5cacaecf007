//! Turns points with numbers into grains.

use crate::packing::LengthUnit;
use crate::packing::csv::{DIAMETER, Named, RADIUS};
use crate::packing::fields::{ImportError, refused};
use crate::packing::found::{FileCell, FileGrains, NAMES};

/// Points of a file and their numbers.
pub struct Points {
    /// The line that names them, for messages.
    pub line: usize,
    /// x, y and z of each point in turn.
    pub places: Vec<f64>,
    pub arrays: Vec<PointArray>,
}

/// One array of numbers.
pub struct PointArray {
    pub line: usize,
    pub name: String,
    pub values: Vec<f64>,
}

/// Turns the points into grains.
pub fn grains(file: &str, points: Points) -> Result<FileGrains, ImportError> {
    let named = |called: &[&str]| -> Vec<(&PointArray, Named)> {
        let all = points.arrays.iter().map(|array| (array, Named::of(&array.name)));
        all.filter(|(_, named)| called.contains(&named.name.as_str())).collect()
    };
    let (mut sizes, factor) = match named(DIAMETER) {
        diameters if diameters.is_empty() => (named(RADIUS), 2.0),
        diameters => (diameters, 1.0),
    };
    let (Some((size, name)), true) = (sizes.pop(), sizes.is_empty()) else {
        let names: Vec<&str> = points.arrays.iter().map(|array| array.name.as_str()).collect();
        let allowed = "points with one array called diameter or radius";
        return Err(refused(file, points.line, "arrays of the points", &names.join(", "), allowed));
    };
    let count = points.places.len() / 3;
    if size.values.len() != count {
        let allowed = format!("{count} numbers, one for each point");
        return Err(refused(file, size.line, NAMES[3], &format!("{} numbers", size.values.len()), allowed));
    }
    if count == 0 {
        let expected = "at least one point".into();
        return Err(ImportError::Truncated { file: file.into(), line: points.line, expected });
    }
    if let Some((at, value)) = points.places.iter().enumerate().find(|(_, value)| !value.is_finite()) {
        return Err(refused(file, points.line, NAMES[at % 3], &value.to_string(), "a finite number"));
    }
    if let Some(value) = size.values.iter().find(|value| !(value.is_finite() && **value > 0.0)) {
        return Err(refused(file, size.line, NAMES[3], &value.to_string(), "a finite number above 0"));
    }
    let column = |axis: usize| points.places.iter().skip(axis).step_by(3).copied().collect();
    let diameter = size.values.iter().map(|value| factor * value).collect();
    let columns = [column(0), column(1), column(2), diameter];
    let of_unit = |unit: LengthUnit| {
        format!(
            "{file}: the array {} is in {}, and so are the coordinates taken to be",
            size.name,
            unit.words()
        )
    };
    let notes = name.unit.map(of_unit).into_iter().collect();
    Ok(FileGrains { columns, unit: name.unit, cell: FileCell::Unsaid, line: points.line, notes })
}
