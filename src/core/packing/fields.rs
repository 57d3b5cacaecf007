//! The content of a packing file before it is completed: its fields, its unit, and the errors of a file
//! that cannot be used.

use super::Cell;
use crate::gradation::shortened;
use crate::schema::Leaf;
use crate::store::in_mb;
use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// Maximum size of a packing file and of the content of a compressed one, in bytes.
pub const PACKING_FILE_LIMIT_BYTES: u64 = 4 << 30;

const KNOWN: &str = "CSV with columns as x_mm, y_mm, z_mm and diameter_mm (or Points:0, Points:1, Points:2 \
                     and Diameter of ParaView and MFIX; radius will do), text dumps of LAMMPS and LIGGGHTS, \
                     Yade's export.text, MercuryDPM's .data, and points of VTK with a diameter or radius \
                     (.vtk, .vtp, .vtu); each also packed by gzip";

const UNITS_OF_PROGRAMS: &str = " (LIGGGHTS, Yade, MercuryDPM and MFIX mostly use metres; LAMMPS states it \
                                 after `dump_modify ID units yes`)";

/// A packing file that cannot be used.
#[derive(Debug)]
pub struct ImportError {
    pub(super) file: String,
    pub(super) problem: Problem,
}

impl std::fmt::Display for ImportError {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{}{}", self.file, self.problem)
    }
}

impl std::error::Error for ImportError {
    /// Error of the system, if the file cannot be read.
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.problem.source()
    }
}

/// Reasons why a packing file cannot be used, as they follow its name in a message; lines count from 1.
#[derive(Debug, thiserror::Error)]
pub(super) enum Problem {
    #[error(": cannot be read: {0}")]
    Read(#[from] std::io::Error),
    #[error(" is a folder; name a file of grains: {KNOWN}")]
    Folder,
    #[error(" is not in a known packing format: {0}. Known formats: {KNOWN}")]
    Unknown(String),
    #[error(
        " does not say the unit of its lengths, and a guess may be wrong by a factor of 1000; give it: \
         --unit m (or cm, mm, um, nm), in a scene network.unit = \"m\"{UNITS_OF_PROGRAMS}"
    )]
    NoUnit,
    #[error(
        " does not say whether its boundaries are periodic; give them: --cell none for free ones, --cell \
         Lx,Ly,Lz for a periodic cell with a corner at the origin (in the file's unit){0}; in a scene \
         network.cell"
    )]
    NoCell(&'static str),
    #[error(
        ": its box is periodic along some axes only, and a cell is periodic along all or none; say \
         --cell none to take its grains as free ones; in a scene network.cell"
    )]
    Mixed,
    #[error(
        ": the grains do not fit their cell: the centres spread over {spread} along {axis}, and the cell is \
         {length} long there. A cell is given in the file's unit; grains that have crossed it must be \
         brought back into it"
    )]
    Spread { axis: &'static str, spread: f64, length: f64 },
    #[error(
        ": the grains do not fit their cell: the grains have {0:.3} times the volume of the cell, {x} x {y} \
         x {z}, and leave no voids. A cell is given in the file's unit; or are radii read as diameters?",
        x = .1[0], y = .1[1], z = .1[2]
    )]
    Full(f64, [f64; 3]),
    #[error(
        " is larger than {limit}; allowed: a packing file up to that size",
        limit = in_mb(PACKING_FILE_LIMIT_BYTES)
    )]
    TooLarge,
    #[error(", line {line}: byte 0x{byte:02X} is not UTF-8 text; allowed: a text file saved as UTF-8")]
    Encoding { line: usize, byte: u8 },
    #[error(", line {line}, {field}: \"{value}\" is not allowed; allowed: {allowed}")]
    Value { line: usize, field: &'static str, value: String, allowed: String },
    #[error(" ends after line {line}; expected {expected}")]
    Truncated { line: usize, expected: String },
}

/// A line of a file and its number, counted from 1.
pub(super) type Line<'a> = (usize, &'a str);

/// Returns the lines that are not blank, with their numbers.
pub(super) fn numbered(text: &str) -> impl Iterator<Item = Line<'_>> + Clone {
    text.lines().enumerate().map(|(i, line)| (i + 1, line)).filter(|(_, line)| !line.trim().is_empty())
}

/// Number of line ends, in text or in binary numbers.
pub(super) fn line_ends(bytes: &[u8]) -> usize {
    bytes.iter().filter(|&&byte| byte == b'\n').count()
}

pub(super) fn in_utf8(content: &[u8]) -> Result<&str, Problem> {
    std::str::from_utf8(content).map_err(|error| {
        let good = error.valid_up_to();
        Problem::Encoding { line: 1 + line_ends(&content[..good]), byte: content[good] }
    })
}

pub(super) fn ended(line: usize, expected: impl Into<String>) -> Problem {
    Problem::Truncated { line, expected: expected.into() }
}

pub(super) fn refused(line: usize, field: &'static str, value: &str, allowed: impl Into<String>) -> Problem {
    Problem::Value { line, field, value: shortened(value), allowed: allowed.into() }
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Finite,
    Positive,
}

pub(super) fn number(line: usize, field: &'static str, text: &str, kind: Kind) -> Result<f64, Problem> {
    let text = text.trim();
    let (least, allowed) = match kind {
        Kind::Finite => (f64::NEG_INFINITY, "a finite number"),
        Kind::Positive => (0.0, "a finite number above 0"),
    };
    let value = text.trim_matches('"').parse().ok().filter(|v: &f64| v.is_finite() && *v > least);
    value.ok_or_else(|| refused(line, field, text, allowed))
}

/// Reads a low and a high bound; `shown` is their text for the error if their order is wrong.
pub(super) fn bounds(
    line: usize,
    field: &'static str,
    ends: [&str; 2],
    shown: &str,
) -> Result<[f64; 2], Problem> {
    let [low, high] = ends.map(|text| number(line, field, text, Kind::Finite));
    let bounds = [low?, high?];
    match bounds[0] < bounds[1] {
        true => Ok(bounds),
        false => Err(refused(line, field, shown, "a low bound below the high one")),
    }
}

/// Names of the four columns in messages.
pub(super) const NAMES: [&str; 4] = ["x", "y", "z", "diameter"];

pub(super) struct FileGrains {
    /// x, y, z and diameter of each grain, in the file's unit.
    pub(super) grains: Vec<[f64; 4]>,
    pub(super) unit: Option<LengthUnit>,
    pub(super) cell: FileCell,
    /// Line that names the columns, for messages.
    pub(super) line: usize,
    pub(super) note: Option<ReadingNote>,
}

/// Choices that were made in reading a packing file.
#[allow(missing_docs)]
#[derive(Clone, Debug, PartialEq)]
pub enum ReadingNote {
    /// The last of several frames was taken: `lacking` names what later, empty frames lack (atoms or grains),
    /// and `time` is the name and the text of its time.
    Frame { frames: usize, lacking: Option<&'static str>, time: (&'static str, String) },
    /// The coordinates have no unit, and were taken in the unit that the name of this array ends with.
    Array { name: String, unit: LengthUnit },
    /// Lengths were converted to mm from this unit.
    Unit(LengthUnit),
}

/// Boundaries according to a file.
pub(super) enum FileCell {
    Known(Cell),
    /// Bounds of the grains, not known to be periodic.
    Bounds([[f64; 2]; 3]),
    /// Periodic along some axes only, which no packing here supports.
    Mixed,
    Unsaid,
}

/// Reads one grain's row: the four numbers at `places` among its fields, the last multiplied by `factor`.
pub(super) fn grain(
    line: usize,
    fields: &[&str],
    places: [usize; 4],
    factor: f64,
) -> Result<[f64; 4], Problem> {
    let mut grain = [0.0; 4];
    for (axis, (slot, place)) in grain.iter_mut().zip(places).enumerate() {
        let kind = if axis == 3 { Kind::Positive } else { Kind::Finite };
        *slot = number(line, NAMES[axis], fields[place], kind)?;
    }
    grain[3] *= factor;
    Ok(grain)
}

/// A unit of length, from a metre to a nanometre.
#[allow(missing_docs)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LengthUnit {
    M,
    Cm,
    Mm,
    Um,
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
    pub fn words(self) -> &'static str {
        self.described().1
    }

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
