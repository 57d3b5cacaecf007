//! The content of a packing file before it is completed: its fields, its unit, and the errors of a file
//! that cannot be used.

use super::Cell;
use crate::gradation::{Position, shortened};
use crate::schema::Leaf;
use crate::store::in_mb;
use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// Maximum size of a packing file and of the content of a compressed one, in bytes.
pub const PACKING_FILE_LIMIT_BYTES: u64 = 4 << 30;

/// Accepted formats, in words.
const KNOWN: &str = "CSV with columns as x_mm, y_mm, z_mm and diameter_mm (or Points:0, Points:1, Points:2 \
                     and Diameter of ParaView and MFIX; radius will do), text dumps of LAMMPS and LIGGGHTS, \
                     Yade's export.text, MercuryDPM's .data, and points of VTK with a diameter or radius \
                     (.vtk, .vtp, .vtu); each also packed by gzip";

/// Usual units of other programs.
const UNITS_OF_PROGRAMS: &str = " (LIGGGHTS, Yade, MercuryDPM and MFIX mostly use metres; LAMMPS states it \
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
    #[error("{0} is a folder; name a file of grains: {known}", known = KNOWN)]
    Folder(String),
    /// A file of no known format.
    #[error("{0} is not in a known packing format: {1}. Known formats: {known}", known = KNOWN)]
    Unknown(String, String),
    /// Neither the file nor the user gives the unit of its lengths.
    #[error(
        "{0} does not say the unit of its lengths, and a guess may be wrong by a factor of 1000; give it: \
         --unit m (or cm, mm, um, nm), in a scene network.unit = \"m\"{programs}",
        programs = UNITS_OF_PROGRAMS
    )]
    NoUnit(String),
    /// Neither the file nor the user tells if the boundaries are periodic.
    #[error(
        "{0} does not say whether its boundaries are periodic; give them: --cell none for free ones, --cell \
         Lx,Ly,Lz for a periodic cell with a corner at the origin (in the file's unit){1}; in a scene \
         network.cell"
    )]
    NoCell(String, &'static str),
    /// Boundaries that are periodic along some axes only.
    #[error(
        "{0}: its box is periodic along some axes only, and a cell is periodic along all or none; say \
         --cell none to take its grains as free ones; in a scene network.cell"
    )]
    Mixed(String),
    /// Grains that do not fit the periodic cell given for them.
    #[error("{0}: the grains do not fit their cell: {1}")]
    Misfit(String, String),
    /// A file larger than any packing.
    #[error(
        "{0} is larger than {limit}; allowed: a packing file up to that size",
        limit = in_mb(PACKING_FILE_LIMIT_BYTES)
    )]
    TooLarge(String),
    /// Bytes that are not UTF-8 text.
    #[error("{file}, line {line}: byte 0x{byte:02X} is not UTF-8 text; allowed: a text file saved as UTF-8")]
    Encoding {
        /// File as the user named it.
        file: String,
        /// Line, counted from 1.
        line: usize,
        /// First invalid byte.
        byte: u8,
    },
    /// A value that is not allowed at its place.
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

/// Returns the lines that are not blank, with their numbers.
pub(super) fn numbered(text: &str) -> impl Iterator<Item = Line<'_>> + Clone {
    text.lines().enumerate().map(|(i, line)| (i + 1, line)).filter(|(_, line)| !line.trim().is_empty())
}

/// Decodes bytes as text.
pub(super) fn in_utf8<'a>(file: &str, content: &'a [u8]) -> Result<&'a str, ImportError> {
    std::str::from_utf8(content).map_err(|error| {
        let good = error.valid_up_to();
        let line = 1 + content[..good].iter().filter(|&&b| b == b'\n').count();
        ImportError::Encoding { file: file.into(), line, byte: content[good] }
    })
}

pub(super) fn ended(file: &str, line: usize, expected: impl Into<String>) -> ImportError {
    ImportError::Truncated { file: file.into(), line, expected: expected.into() }
}

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

/// Reads a low and a high bound; `shown` is their text for the error if their order is wrong.
pub(super) fn bounds(
    file: &str,
    line: usize,
    field: &'static str,
    [low, high]: [&str; 2],
    shown: &str,
) -> Result<[f64; 2], ImportError> {
    let read = |text| number(file, line, field, text, Kind::Finite);
    let bounds = [read(low)?, read(high)?];
    match bounds[0] < bounds[1] {
        true => Ok(bounds),
        false => Err(refused(file, line, field, shown, "a low bound below the high one")),
    }
}

/// Names of the four columns in messages.
pub(super) const NAMES: [&str; 4] = ["x", "y", "z", "diameter"];

/// Grains as given by a file.
pub(super) struct FileGrains {
    /// x, y, z and diameter of each grain, in the file's unit.
    pub(crate) grains: Vec<[f64; 4]>,
    pub(crate) unit: Option<LengthUnit>,
    pub(crate) cell: FileCell,
    /// Line that names the columns, for messages.
    pub(crate) line: usize,
    /// Notes to the user on how the file was read.
    pub(crate) notes: Vec<String>,
}

/// Boundaries according to a file.
pub(super) enum FileCell {
    /// A complete cell.
    Known(Cell),
    /// Bounds of the grains, not known to be periodic.
    Bounds([[f64; 2]; 3]),
    /// Periodic along some axes only, which no packing here supports.
    Mixed,
    /// Not given.
    Unsaid,
}

/// Reads one grain's row: the four numbers at `places` among its fields, the last multiplied by `factor`.
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

/// A unit of length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LengthUnit {
    /// Metres.
    M,
    /// Centimetres.
    Cm,
    /// Millimetres.
    Mm,
    /// Micrometres.
    Um,
    /// Nanometres.
    Nm,
}

impl Leaf for LengthUnit {}

impl LengthUnit {
    /// All units, from the largest.
    pub const ALL: [Self; 5] = [Self::M, Self::Cm, Self::Mm, Self::Um, Self::Nm];

    fn described(self) -> (&'static str, &'static str, f64) {
        match self {
            Self::M => ("m", "metres", 1e3),
            Self::Cm => ("cm", "centimetres", 10.0),
            Self::Mm => ("mm", "millimetres", 1.0),
            Self::Um => ("um", "micrometres", 1e-3),
            Self::Nm => ("nm", "nanometres", 1e-6),
        }
    }

    /// Name in a scene or on a command line.
    pub fn name(self) -> &'static str {
        self.described().0
    }

    /// Full name, in the plural.
    pub(crate) fn words(self) -> &'static str {
        self.described().1
    }

    /// Length of the unit (mm).
    pub(crate) fn mm(self) -> f64 {
        self.described().2
    }
}

impl FromStr for LengthUnit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim().replace(['µ', 'μ'], "u");
        let unit = Self::ALL.into_iter().find(|unit| unit.name() == text);
        unit.ok_or_else(|| "write the unit of the file's lengths: m, cm, mm, um or nm".into())
    }
}
