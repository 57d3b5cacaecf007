//! Reads packings from files of this program and of others.
//!
//! Text ([`tables`](super::tables)) or VTK ([`vtk`](super::vtk)), possibly compressed by gzip. The first line
//! determines the format, not the file's name. The unit of length and the boundaries are never guessed: if
//! a file does not give them, [`ReadOptions`] must, or the file is refused.

use super::fields::{
    FileCell, FileGrains, ImportError, LengthUnit, PACKING_FILE_LIMIT_BYTES, Problem, ReadingNote, in_utf8,
    refused,
};
use super::tables::{csv, dump, is_mercury, mercury, yade};
use super::vtk::{legacy, xml};
use super::{Cell, Packing};
use crate::schema::Leaf;
use crate::store::read_regular;
use serde::{Deserialize, Serialize};
use std::io::Read;
use std::path::Path;
use std::str::FromStr;

/// Facts about a packing file that the file itself does not give.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Unit of its lengths.
    pub unit: Option<LengthUnit>,
    /// Its cell.
    pub cell: Option<CellOption>,
}

/// Cell of a packing whose file does not give it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum CellOption {
    /// Free boundaries.
    None,
    /// Periodic between the bounds given by the file.
    Bounds,
    /// Periodic from the origin to these lengths along x, y, z, in the file's unit.
    Lengths([f64; 3]),
}

impl Leaf for CellOption {}

impl FromStr for CellOption {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim() {
            "none" => return Ok(Self::None),
            "bounds" => return Ok(Self::Bounds),
            _ => {}
        }
        let lengths: Option<Vec<f64>> = text.split(',').map(|length| length.trim().parse().ok()).collect();
        match lengths.as_deref() {
            Some(&[x, y, z]) if [x, y, z].iter().all(|l| l.is_finite() && *l > 0.0) => {
                Ok(Self::Lengths([x, y, z]))
            }
            _ => Err("write none for free boundaries, Lx,Ly,Lz for a periodic cell with a corner at the \
                      origin (in the file's unit), or bounds for one between the bounds in the file"
                .into()),
        }
    }
}

impl TryFrom<String> for CellOption {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<CellOption> for String {
    fn from(cell: CellOption) -> Self {
        match cell {
            CellOption::None => "none".into(),
            CellOption::Bounds => "bounds".into(),
            CellOption::Lengths([x, y, z]) => format!("{x}, {y}, {z}"),
        }
    }
}

impl Packing {
    /// Reads a packing from a file that gives its unit and its cell.
    ///
    /// # Errors
    /// Errors of [`Packing::read_as`].
    pub fn read(path: impl AsRef<Path>) -> Result<Packing, ImportError> {
        Ok(Self::read_as(path, &ReadOptions::default())?.0)
    }

    /// Reads a packing, with notes on how it was read.
    ///
    /// # Errors
    /// A file that cannot be read, is a folder, is too large or is not text; a file of an unknown
    /// format, or without unit or cell if `options` do not give them; any departure from its format,
    /// with the line, the field, the value and the allowed values.
    pub fn read_as(
        path: impl AsRef<Path>,
        options: &ReadOptions,
    ) -> Result<(Packing, Vec<ReadingNote>), ImportError> {
        let file = path.as_ref().display().to_string();
        match bytes_of(path.as_ref()) {
            Ok(bytes) => Self::parse_as(&file, &bytes, options),
            Err(problem) => Err(ImportError { file, problem }),
        }
    }

    /// Parses the content of a file like [`Packing::read`]; `name` is used in messages.
    ///
    /// ```
    /// use voidwalk_core::packing::{Cell, Packing};
    /// let text = "# cell_mm = 2, 2, 2\nx_mm,y_mm,z_mm,diameter_mm\n0.5,0.5,0.5,1\n";
    /// let packing = Packing::parse("example", text.as_bytes())?;
    /// assert_eq!((packing.cell, packing.diameter), (Cell::Periodic([2.0; 3]), vec![1.0]));
    /// # Ok::<(), voidwalk_core::packing::ImportError>(())
    /// ```
    pub fn parse(name: &str, content: &[u8]) -> Result<Packing, ImportError> {
        Ok(Self::parse_as(name, content, &ReadOptions::default())?.0)
    }

    /// Parses the content of a file like [`Packing::read_as`]; `name` is used in messages.
    ///
    /// ```
    /// use voidwalk_core::packing::{CellOption, LengthUnit, Packing, ReadOptions};
    /// let yade = "#format x_y_z_r\n0.002\t0.001\t0\t0.0005\n";
    /// let options = ReadOptions { unit: Some(LengthUnit::M), cell: Some(CellOption::None) };
    /// let (packing, _) = Packing::parse_as("spheres.txt", yade.as_bytes(), &options)?;
    /// assert_eq!((packing.x, packing.diameter), (vec![2.0], vec![1.0]));
    /// assert!(Packing::parse("spheres.txt", yade.as_bytes()).is_err());
    /// # Ok::<(), voidwalk_core::packing::ImportError>(())
    /// ```
    pub fn parse_as(
        name: &str,
        content: &[u8],
        options: &ReadOptions,
    ) -> Result<(Packing, Vec<ReadingNote>), ImportError> {
        let read = grains_of(content, options.unit).and_then(|grains| complete(grains, options));
        read.map_err(|problem| ImportError { file: name.into(), problem })
    }
}

fn bytes_of(path: &Path) -> Result<Vec<u8>, Problem> {
    if std::fs::metadata(path)?.is_dir() {
        return Err(Problem::Folder);
    }
    match read_regular(path, PACKING_FILE_LIMIT_BYTES)? {
        Some(bytes) => Ok(bytes),
        None if std::fs::metadata(path).is_ok_and(|meta| !meta.is_file()) => {
            Err(std::io::Error::other("is not a regular file").into())
        }
        None => Err(Problem::TooLarge),
    }
}

/// Reads the grains in the format given by the first bytes; `unit` is the user's.
fn grains_of(content: &[u8], unit: Option<LengthUnit>) -> Result<FileGrains, Problem> {
    if content.starts_with(GZIP) {
        return grains_of(&unpacked(content)?, unit);
    }
    if let Some((_, kind)) = NOT_TEXT.iter().find(|(begin, _)| content.starts_with(begin)) {
        return Err(Problem::Unknown((*kind).into()));
    }
    // These two may contain binary numbers.
    if content.starts_with(b"# vtk DataFile") {
        return legacy(content);
    }
    if is_vtk_in_xml(content) {
        return xml::xml(content);
    }
    let text = in_utf8(content)?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    match text.trim_start() {
        start if start.starts_with("ITEM:") => dump(text, unit),
        start if start.starts_with("#format") => yade(text),
        _ if is_mercury(text) => mercury(text),
        _ => csv(text),
    }
}

const GZIP: &[u8] = b"\x1f\x8b";

/// Unpacks the content of a gzip file once: nothing inside it is unpacked again.
fn unpacked(content: &[u8]) -> Result<Vec<u8>, Problem> {
    let (mut bytes, limit) = (Vec::new(), PACKING_FILE_LIMIT_BYTES);
    let read = flate2::read::MultiGzDecoder::new(content).take(limit + 1).read_to_end(&mut bytes);
    read.map_err(|error| std::io::Error::other(format!("its gzip is broken: {error}")))?;
    if bytes.len() as u64 > limit {
        return Err(Problem::TooLarge);
    }
    if bytes.starts_with(GZIP) {
        return Err(Problem::Unknown("packed twice (gzip): unpack it first".into()));
    }
    Ok(bytes)
}

/// Tells if the content begins as XML of VTK, possibly after a byte order mark and a declaration.
fn is_vtk_in_xml(content: &[u8]) -> bool {
    let start = String::from_utf8_lossy(&content[..content.len().min(1000)]);
    let start = start.trim_start_matches('\u{feff}').trim_start();
    start.starts_with("<VTKFile") || start.starts_with("<?xml") && start.contains("<VTKFile")
}

/// First bytes of some binary files, and descriptions of those files.
const NOT_TEXT: [(&[u8], &str); 2] = [
    (b"PK\x03\x04", "a zip or a workbook (save a workbook's sheet as CSV)"),
    (b"\x28\xb5\x2f\xfd", "a compressed file (zstd): unpack it first"),
];

/// Makes the packing (mm) from the file and from `options`; if both give a value, the file's is used.
fn complete(grains: FileGrains, options: &ReadOptions) -> Result<(Packing, Vec<ReadingNote>), Problem> {
    let FileGrains { mut grains, unit, cell, line, note } = grains;
    let unit = match (unit, options.unit) {
        (Some(from_file), Some(given)) if from_file != given => {
            let allowed = format!("{}: the file states the unit of its lengths", from_file.name());
            return Err(refused(line, "unit", given.name(), allowed));
        }
        (from_file, given) => from_file.or(given).ok_or(Problem::NoUnit)?,
    };
    let cell = match (cell, options.cell) {
        (FileCell::Known(cell), None) => cell,
        (FileCell::Known(_), Some(_)) => {
            let allowed = "nothing: the file states its boundaries";
            return Err(refused(line, "cell", "as it was given", allowed));
        }
        (_, Some(CellOption::None)) => Cell::Free,
        (FileCell::Mixed, _) => return Err(Problem::Mixed),
        (_, Some(CellOption::Lengths(lengths))) => Cell::Periodic(lengths),
        (FileCell::Bounds(bounds), Some(CellOption::Bounds)) => {
            for grain in &mut grains {
                grain.iter_mut().zip(bounds).for_each(|(at, [low, _])| *at -= low);
            }
            Cell::Periodic(bounds.map(|[low, high]| high - low))
        }
        (FileCell::Unsaid, Some(CellOption::Bounds)) => {
            let allowed = "none, or Lx,Ly,Lz: the file gives no bounds";
            return Err(refused(line, "cell", "bounds", allowed));
        }
        (FileCell::Bounds(_), None) => {
            return Err(Problem::NoCell(", or bounds for one between those in the file"));
        }
        (FileCell::Unsaid, None) => return Err(Problem::NoCell("")),
    };
    let mut packing = Packing::from_grains(cell, grains);
    check_fit(&packing, matches!(options.cell, Some(CellOption::Lengths(_))))?;
    let mut notes = Vec::from_iter(note);
    if unit != LengthUnit::Mm {
        convert(&mut packing, unit, line)?;
        notes.push(ReadingNote::Unit(unit));
    }
    Ok((packing, notes))
}

/// Refuses grains that do not fit their cell: a wrong cell would give constrictions that are too fine,
/// so a filter that seems to retain more. Programs may leave grains outside a cell that they wrote, but
/// a cell given by hand has no other confirmation.
fn check_fit(packing: &Packing, by_hand: bool) -> Result<(), Problem> {
    let Cell::Periodic(lengths) = packing.cell else { return Ok(()) };
    let columns = [("x", &packing.x), ("y", &packing.y), ("z", &packing.z)];
    for ((axis, column), length) in columns.into_iter().zip(lengths) {
        let low = column.iter().copied().fold(f64::INFINITY, f64::min);
        let high = column.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if by_hand && high - low > length * (1.0 + ROUNDING) {
            return Err(Problem::Spread { axis, spread: high - low, length });
        }
    }
    let solid: f64 = packing.diameter.iter().map(|d| std::f64::consts::FRAC_PI_6 * d * d * d).sum();
    let whole: f64 = lengths.iter().product();
    if solid >= whole { Err(Problem::Full(solid / whole, lengths)) } else { Ok(()) }
}

/// Fraction of a cell's length by which rounding in a file may change it.
const ROUNDING: f64 = 1e-6;

fn convert(packing: &mut Packing, unit: LengthUnit, line: usize) -> Result<(), Problem> {
    let Packing { cell, x, y, z, diameter } = packing;
    let lengths = match cell {
        Cell::Periodic(lengths) => lengths.as_mut_slice(),
        Cell::Free => &mut [],
    };
    for length in [x, y, z, diameter].into_iter().flatten().chain(lengths) {
        let given = *length;
        *length *= unit.mm();
        if !length.is_finite() || (*length == 0.0) != (given == 0.0) {
            let allowed = format!("lengths in {} that are finite numbers in mm", unit.words());
            return Err(refused(line, "units", &given.to_string(), allowed));
        }
    }
    Ok(())
}
