//! Grains from files of VTK, as LIGGGHTS, Yade, MercuryDPM, MFIX and ParaView write them.
//!
//! Points with an array called `diameter` or `radius` (`radii` of Yade), perhaps with a unit at the end as
//! `diameter_mm`. Files before XML (`.vtk`, ASCII and binary) are read by [`legacy`], `.vtp` and `.vtu` by
//! [`xml`]. Neither says whether boundaries are periodic.

mod legacy;
#[cfg(test)]
mod tests;
mod xml;

pub(super) use legacy::legacy;
pub(super) use xml::xml;

use super::csv::{DIAMETER, Named, RADIUS};
use super::fields::{ImportError, refused};
use super::found::{FileCell, FileGrains, NAMES};

/// Points of a file and the numbers that they carry.
struct Points {
    /// The line that names them, for messages.
    line: usize,
    /// x, y and z of each in turn.
    places: Vec<f64>,
    arrays: Vec<Array>,
}

/// One array of numbers.
struct Array {
    line: usize,
    name: String,
    values: Vec<f64>,
}

/// The points as grains.
fn grains(file: &str, points: Points) -> Result<FileGrains, ImportError> {
    let named = |called: &[&str]| -> Vec<(&Array, Named)> {
        let all = points.arrays.iter().map(|array| (array, Named::of(&array.name)));
        all.filter(|(_, named)| called.contains(&named.name.as_str())).collect()
    };
    let (mut sizes, factor) = match named(DIAMETER) {
        found if found.is_empty() => (named(RADIUS), 2.0),
        found => (found, 1.0),
    };
    let (Some((size, name)), true) = (sizes.pop(), sizes.is_empty()) else {
        let names: Vec<&str> = points.arrays.iter().map(|array| array.name.as_str()).collect();
        let allowed = "points with one array called diameter or radius";
        return Err(refused(file, points.line, "arrays of the points", &names.join(", "), allowed));
    };
    let count = points.places.len() / 3;
    if !points.places.len().is_multiple_of(3) {
        let found = format!("{} numbers", points.places.len());
        return Err(refused(file, points.line, "points", &found, "three numbers for each point"));
    }
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
    Ok(FileGrains { columns, unit: name.unit, cell: FileCell::Unsaid, line: points.line, notes: Vec::new() })
}

/// What one number of an array is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Number {
    /// Bytes that it takes.
    fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// All numbers in a run of bytes; what is left of it is none.
    fn all(self, bytes: &[u8], is_big_endian: bool) -> Vec<f64> {
        bytes.chunks_exact(self.bytes()).map(|bytes| self.one(bytes, is_big_endian)).collect()
    }

    fn one(self, bytes: &[u8], is_big_endian: bool) -> f64 {
        let mut little = [0; 8];
        for (k, slot) in little.iter_mut().take(bytes.len()).enumerate() {
            *slot = if is_big_endian { bytes[bytes.len() - 1 - k] } else { bytes[k] };
        }
        let whole = u64::from_le_bytes(little);
        match self {
            Self::I8 => f64::from(whole as i8),
            Self::U8 | Self::U16 | Self::U32 | Self::U64 => whole as f64,
            Self::I16 => f64::from(whole as i16),
            Self::I32 => f64::from(whole as i32),
            Self::I64 => whole as i64 as f64,
            Self::F32 => f64::from(f32::from_bits(whole as u32)),
            Self::F64 => f64::from_bits(whole),
        }
    }
}
