//! NumPy arrays: `.npy`, and several named arrays in a zip, `.npz`.
//!
//! Integers and floats of 8 to 64 bits, little-endian, and booleans, in one or two dimensions, in C or
//! Fortran order; as `numpy.savez` and `numpy.savez_compressed` write them.

use std::io::{self, Cursor, Read, Write};

use zip::write::SimpleFileOptions;
use zip::{DateTime, ZipArchive, ZipWriter};

/// First bytes of every `.npy`.
const MAGIC: &[u8] = b"\x93NUMPY";

/// Limits on the unpacked size of an array: this many bytes, or this many times the file size.
const UNPACKED: (u64, u64) = (8 << 20, 200);

/// Longest header (bytes).
const HEADER: usize = 1 << 16;

/// An array of one or two dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Number of rows.
    pub rows: usize,
    /// Numbers per row; `None` for one dimension.
    pub columns: Option<usize>,
    /// Numbers, row by row.
    pub numbers: Numbers,
}

/// The numbers of an [`Array`].
#[derive(Clone, Debug, PartialEq)]
pub enum Numbers {
    /// Floats.
    Float(Vec<f64>),
    /// Integers.
    Whole(Vec<i64>),
    /// Booleans.
    Truth(Vec<bool>),
}

impl Array {
    /// Makes a one-dimensional array of floats.
    pub fn of_floats(numbers: Vec<f64>) -> Self {
        Self { rows: numbers.len(), columns: None, numbers: Numbers::Float(numbers) }
    }

    /// Makes a one-dimensional array of integers.
    pub fn of_whole(numbers: Vec<i64>) -> Self {
        Self { rows: numbers.len(), columns: None, numbers: Numbers::Whole(numbers) }
    }
}

/// An open `.npz`.
pub struct Npz<'a> {
    archive: ZipArchive<Cursor<&'a [u8]>>,
    names: Vec<String>,
    most: u64,
}

impl<'a> Npz<'a> {
    /// Opens an `.npz`.
    ///
    /// # Errors
    /// A message if the file is not a zip.
    pub fn open(bytes: &'a [u8]) -> Result<Self, String> {
        let archive = ZipArchive::new(Cursor::new(bytes))
            .map_err(|_| "is not an .npz file: it cannot be read as a zip".to_owned())?;
        let names =
            archive.file_names().flatten().map(|name| name.trim_end_matches(".npy").to_owned()).collect();
        let most = UNPACKED.0.saturating_add(UNPACKED.1.saturating_mul(bytes.len() as u64));
        Ok(Self { archive, names, most })
    }

    /// Names of the arrays.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Reads the first of these arrays that exists; returns its name too.
    ///
    /// # Errors
    /// A message with the name of an array that cannot be read, or has an unsupported type.
    pub fn first<'n>(&mut self, names: &[&'n str]) -> Result<Option<(&'n str, Array)>, String> {
        let Some(&name) = names.iter().find(|name| self.names.iter().any(|known| known == *name)) else {
            return Ok(None);
        };
        let wrong = |problem: String| format!("{name}: {problem}");
        let part = self.archive.by_name(&format!("{name}.npy"));
        let part = part.map_err(|_| wrong("cannot be read from the zip".into()))?;
        let mut bytes = Vec::new();
        let read = part.take(self.most + 1).read_to_end(&mut bytes);
        read.map_err(|_| wrong("cannot be unpacked".into()))?;
        if bytes.len() as u64 > self.most {
            return Err(wrong(format!("is more than {} MB unpacked", self.most >> 20)));
        }
        Ok(Some((name, parse(&bytes).map_err(wrong)?)))
    }
}

/// Reads an array from the bytes of an `.npy`.
fn parse(bytes: &[u8]) -> Result<Array, String> {
    let no_array = || "is not a NumPy array".to_owned();
    let rest = bytes.strip_prefix(MAGIC).ok_or_else(no_array)?;
    let (&[major, _], rest) = rest.split_first_chunk::<2>().ok_or_else(no_array)?;
    let (length, rest) = match major {
        1 => rest.split_first_chunk::<2>().map(|(n, rest)| (usize::from(u16::from_le_bytes(*n)), rest)),
        2 | 3 => rest.split_first_chunk::<4>().map(|(n, rest)| (u32::from_le_bytes(*n) as usize, rest)),
        _ => None,
    }
    .ok_or_else(no_array)?;
    if length > HEADER || length > rest.len() {
        return Err(no_array());
    }
    let (header, data) = rest.split_at(length);
    let header = std::str::from_utf8(header).map_err(|_| no_array())?;
    let after = |key: &str| Some(header.split_once(&format!("'{key}':"))?.1.trim_start());
    let kind =
        after("descr").and_then(|text| text.strip_prefix('\'')?.split('\'').next()).unwrap_or("of fields");
    let by_column = after("fortran_order").is_some_and(|text| text.starts_with("True"));
    let shape =
        after("shape").and_then(|text| text.strip_prefix('(')?.split(')').next()).ok_or_else(no_array)?;
    let shape: Option<Vec<usize>> =
        shape.split(',').map(str::trim).filter(|n| !n.is_empty()).map(|n| n.parse().ok()).collect();
    let (rows, columns) = match shape.ok_or_else(no_array)?[..] {
        [rows] => (rows, None),
        [rows, columns] => (rows, Some(columns)),
        ref other => return Err(format!("has {} dimensions; one or two are read", other.len())),
    };
    // Rows without columns take no bytes, so a header could state any number of them.
    if rows > 0 && columns == Some(0) {
        return Err(format!("has the shape ({rows}, 0); rows of 1 or more numbers are allowed"));
    }
    let count = rows.checked_mul(columns.unwrap_or(1)).ok_or_else(no_array)?;
    let stored = Stored { data, count, by_column: columns.filter(|_| by_column) };
    let numbers = match kind {
        "<f8" => Numbers::Float(stored.read(f64::from_le_bytes)?),
        "<f4" => Numbers::Float(stored.read(|bytes| f64::from(f32::from_le_bytes(bytes)))?),
        "<i8" => Numbers::Whole(stored.read(i64::from_le_bytes)?),
        "<u8" => Numbers::Whole(stored.read(|bytes| u64::from_le_bytes(bytes).min(i64::MAX as u64) as i64)?),
        "<i4" => Numbers::Whole(stored.read(|bytes| i32::from_le_bytes(bytes).into())?),
        "<u4" => Numbers::Whole(stored.read(|bytes| u32::from_le_bytes(bytes).into())?),
        "<i2" => Numbers::Whole(stored.read(|bytes| i16::from_le_bytes(bytes).into())?),
        "<u2" => Numbers::Whole(stored.read(|bytes| u16::from_le_bytes(bytes).into())?),
        "|i1" => Numbers::Whole(stored.read(|bytes| i8::from_le_bytes(bytes).into())?),
        "|u1" => Numbers::Whole(stored.read(|bytes| u8::from_le_bytes(bytes).into())?),
        "|b1" => Numbers::Truth(stored.read(|[byte]: [u8; 1]| byte != 0)?),
        other => {
            return Err(format!(
                "has numbers of type {other}; f4, f8, i1 to i8, u1 to u8 (little-endian) and b1 are read"
            ));
        }
    };
    Ok(Array { rows, columns, numbers })
}

/// Numbers as stored: `count` of them, column by column if the number of columns is given, else row by row.
struct Stored<'a> {
    data: &'a [u8],
    count: usize,
    by_column: Option<usize>,
}

impl Stored<'_> {
    fn read<const N: usize, T>(&self, one: impl Fn([u8; N]) -> T) -> Result<Vec<T>, String> {
        let (chunks, count) = (self.data.as_chunks::<N>().0, self.count);
        let Some(chunks) = chunks.get(..count) else {
            return Err(format!("ends after {} of its {count} numbers", chunks.len()));
        };
        let Some(columns) = self.by_column.filter(|_| count > 0) else {
            return Ok(chunks.iter().map(|bytes| one(*bytes)).collect());
        };
        let rows = count / columns;
        let place = |at: usize| (at % columns) * rows + at / columns;
        Ok((0..count).map(|at| one(chunks[place(at)])).collect())
    }
}

/// Writes an `.npz` of these arrays, compressed; the same arrays give the same bytes.
///
/// # Errors
/// Error of the zip writer.
pub fn npz(arrays: &[(String, Array)]) -> io::Result<Vec<u8>> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, array) in arrays {
        let bytes = npy(array);
        let options = SimpleFileOptions::default()
            .last_modified_time(DateTime::default())
            .large_file(bytes.len() as u64 > u64::from(u32::MAX));
        zip.start_file(format!("{name}.npy"), options).map_err(io::Error::other)?;
        zip.write_all(&bytes)?;
    }
    Ok(zip.finish().map_err(io::Error::other)?.into_inner())
}

/// Writes the bytes of an `.npy`, version 1.
fn npy(array: &Array) -> Vec<u8> {
    let kind = match array.numbers {
        Numbers::Float(_) => "<f8",
        Numbers::Whole(_) => "<i8",
        Numbers::Truth(_) => "|b1",
    };
    let shape = match array.columns {
        Some(columns) => format!("({}, {columns})", array.rows),
        None => format!("({},)", array.rows),
    };
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    // The numbers begin at a multiple of 64 bytes.
    let whole = (MAGIC.len() + 4 + header.len() + 1).next_multiple_of(64);
    header.extend(std::iter::repeat_n(' ', whole - MAGIC.len() - 4 - header.len() - 1));
    header.push('\n');
    let mut bytes = MAGIC.to_vec();
    bytes.extend([1, 0]);
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    match &array.numbers {
        Numbers::Float(all) => all.iter().for_each(|number| bytes.extend(number.to_le_bytes())),
        Numbers::Whole(all) => all.iter().for_each(|number| bytes.extend(number.to_le_bytes())),
        Numbers::Truth(all) => bytes.extend(all.iter().map(|&truth| u8::from(truth))),
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        let arrays = [
            ("a.b".to_owned(), Array::of_floats(vec![1.5, -0.0, f64::INFINITY])),
            (
                "n".to_owned(),
                Array { rows: 2, columns: Some(2), numbers: Numbers::Whole(vec![0, 1, -2, i64::MAX]) },
            ),
            (
                "is".to_owned(),
                Array { rows: 3, columns: None, numbers: Numbers::Truth(vec![true, false, true]) },
            ),
            ("none".to_owned(), Array::of_whole(vec![])),
        ];
        let bytes = npz(&arrays).unwrap();
        assert_eq!(bytes, npz(&arrays).unwrap());
        let mut read = Npz::open(&bytes).unwrap();
        for (name, array) in &arrays {
            assert_eq!(read.first(&["nothing", name]), Ok(Some((name.as_str(), array.clone()))));
        }
        assert_eq!(read.first(&["nothing"]), Ok(None));
        assert_eq!(npy(&arrays[0].1).len() % 64, 24);
    }

    fn raw(header: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend([1, 0]);
        bytes.extend((header.len() as u16).to_le_bytes());
        [&bytes, header.as_bytes(), data].concat()
    }

    #[test]
    fn arrays_of_other_kinds_are_read_or_refused_in_words() {
        let parsed = |kind: &str, order: &str, shape: &str, data: &[u8]| {
            parse(&raw(&format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': {shape}, }}"), data))
        };
        let columns =
            parsed("<i4", "True", "(2, 2)", &[0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0]).unwrap();
        assert_eq!(columns.numbers, Numbers::Whole(vec![0, 2, 1, 3]));
        assert_eq!(
            parsed("<f4", "False", "(1,)", &1.5f32.to_le_bytes()).unwrap().numbers,
            Numbers::Float(vec![1.5])
        );
        assert_eq!(parsed("|u1", "False", "(2,)", &[1, 255]).unwrap().numbers, Numbers::Whole(vec![1, 255]));
        for (kind, shape, message) in [
            (">f8", "(1,)", "type >f8"),
            ("<U3", "(1,)", "type <U3"),
            ("<f8", "(1, 1, 1)", "3 dimensions"),
            ("<f8", "()", "0 dimensions"),
            ("<f8", "(2,)", "ends after 1 of its 2 numbers"),
            ("<f8", "(99999999999, 99999999999999)", "not a NumPy array"),
            ("<f8", "(x,)", "not a NumPy array"),
        ] {
            let error = parsed(kind, "False", shape, &[0; 8]).unwrap_err();
            assert!(error.contains(message), "{kind} {shape}: {error}");
        }
        // Rows without columns take no bytes, so there can be any number of them.
        for order in ["False", "True"] {
            for (kind, shape) in
                [("<f8", "(4000000000, 0)"), ("|b1", "(3, 0)"), ("<i8", "(1152921504606846976, 0)")]
            {
                let error = parsed(kind, order, shape, &[]).unwrap_err();
                assert!(error.contains("has the shape (") && error.contains("rows of 1 or more"), "{error}");
            }
            for shape in ["(0, 2)", "(0, 1152921504606846976)", "(0,)"] {
                let empty = parsed("<i8", order, shape, &[]).unwrap();
                assert_eq!((empty.rows, empty.numbers), (0, Numbers::Whole(vec![])));
            }
        }
        for bytes in [&b""[..], b"\x93NUMPY", b"\x93NUMPY\x01\x00\xff\xff", b"\x93NUMPY\x09\x00\x01\x00{"] {
            assert!(parse(bytes).is_err());
        }
        assert!(Npz::open(b"from,to").is_err());
    }

    #[test]
    fn an_array_that_unpacks_to_more_than_it_may_is_refused() {
        let bytes = npz(&[("zeros".into(), Array::of_floats(vec![0.0; 12 << 20]))]).unwrap();
        let error = Npz::open(&bytes).unwrap().first(&["zeros"]).unwrap_err();
        assert!(error.starts_with("zeros: is more than ") && error.contains("MB unpacked"), "{error}");
    }
}
