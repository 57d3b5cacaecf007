//! The fields of a packing file, and the errors of a file that cannot be used.

use crate::gradation::{Position, shortened};
use crate::store::in_mb;

/// Largest packing file that is read, in bytes, and largest size that a packed file may unpack to.
pub const PACKING_FILE_LIMIT_BYTES: u64 = 4 << 30;

/// Formats that are read, in words.
const KNOWN: &str = "CSV with columns as x_mm, y_mm, z_mm and diameter_mm (or Points:0, Points:1, Points:2 \
                     and Diameter of ParaView and MFIX; radius will do), text dumps of LAMMPS and LIGGGHTS, \
                     Yade's export.text, MercuryDPM's .data, and points of VTK with a diameter or radius \
                     (.vtk, .vtp, .vtu); each also packed by gzip";

/// Usual units of other programs.
const UNITS_OF_PROGRAMS: &str = " (LIGGGHTS, Yade, MercuryDPM and MFIX mostly have metres; LAMMPS says it \
                                 after `dump_modify ID units yes`)";

/// A packing file that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// The file cannot be opened or read.
    #[error("{file}: cannot be read: {source}")]
    Read {
        /// File as the user named it.
        file: String,
        /// Error of the system.
        source: std::io::Error,
    },
    /// A folder in place of a file.
    #[error("{file} is a folder; name a file of grains: {known}", known = KNOWN)]
    Folder {
        /// Folder as the user named it.
        file: String,
    },
    /// A file of no known format.
    #[error("{file} is no packing that is known: {looks_like}. Known are: {known}", known = KNOWN)]
    Unknown {
        /// File as the user named it.
        file: String,
        /// Description of its actual content.
        looks_like: String,
    },
    /// Neither the file nor the user gives the unit of its lengths.
    #[error(
        "{file} does not say the unit of its lengths, and a guess may be wrong by a factor of 1000; say it: \
         --unit m (or cm, mm, um, nm), in a scene network.unit = \"m\"{programs}",
        programs = UNITS_OF_PROGRAMS
    )]
    NoUnit {
        /// File as the user named it.
        file: String,
    },
    /// Neither the file nor the user tells if the boundaries are periodic.
    #[error(
        "{file} does not say whether its boundaries are periodic; say it: --cell none for free ones, --cell \
         Lx,Ly,Lz for a periodic cell with a corner at the origin (in the file's unit){bounds}; in a scene \
         network.cell"
    )]
    NoCell {
        /// File as the user named it.
        file: String,
        /// Further option, if the file gives bounds.
        bounds: &'static str,
    },
    /// Boundaries that are periodic along some axes only.
    #[error(
        "{file}: its box is periodic along some axes only, and a cell is periodic along all or none; say \
         --cell none to take its grains as free ones; in a scene network.cell"
    )]
    Mixed {
        /// File as the user named it.
        file: String,
    },
    /// Grains that do not fit the periodic cell given for them.
    #[error("{file}: the grains do not fit their cell: {problem}")]
    Misfit {
        /// File as the user named it.
        file: String,
        /// Evidence of the misfit.
        problem: String,
    },
    /// A file larger than any packing.
    #[error("{file} is larger than {}; allowed: a packing file up to that size", in_mb(*.limit))]
    TooLarge {
        /// File as the user named it.
        file: String,
        /// Largest file that is read.
        limit: u64,
    },
    /// Bytes that are no UTF-8 text.
    #[error("{file}, line {line}: byte 0x{byte:02X} is not UTF-8 text; allowed: a text file saved as UTF-8")]
    Encoding {
        /// File as the user named it.
        file: String,
        /// Line, counted from 1.
        line: usize,
        /// The first byte that does not belong.
        byte: u8,
    },
    /// A value that is not allowed in its place.
    #[error("{at}: \"{value}\" is not allowed; allowed: {allowed}")]
    Value {
        /// Place of the value.
        at: Position,
        /// The value, shortened.
        value: String,
        /// Allowed values.
        allowed: String,
    },
    /// The file ends before the packing does.
    #[error("{file} ends after line {line}; expected {expected}")]
    Truncated {
        /// File as the user named it.
        file: String,
        /// Its last line.
        line: usize,
        /// Expected rest of the file.
        expected: String,
    },
}

/// A line of a file and its number, counted from 1.
pub(super) type Line<'a> = (usize, &'a str);

pub(super) fn refused(
    file: &str,
    line: usize,
    field: &'static str,
    value: &str,
    allowed: impl Into<String>,
) -> ImportError {
    let at = Position { file: file.into(), line, field, column: None };
    ImportError::Value { at, value: shortened(value), allowed: allowed.into() }
}

/// Allowed range of a number.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Finite,
    Positive,
}

pub(super) fn number(
    file: &str,
    line: usize,
    field: &'static str,
    text: &str,
    kind: Kind,
) -> Result<f64, ImportError> {
    let value = text.trim().trim_matches('"').parse::<f64>().ok().filter(|v| v.is_finite());
    match (value, kind) {
        (Some(value), Kind::Finite) => Ok(value),
        (Some(value), Kind::Positive) if value > 0.0 => Ok(value),
        (_, Kind::Finite) => Err(refused(file, line, field, text.trim(), "a finite number")),
        (_, Kind::Positive) => Err(refused(file, line, field, text.trim(), "a finite number above 0")),
    }
}
