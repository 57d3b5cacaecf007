//! Grains from VTK files, as written by LIGGGHTS, Yade, MercuryDPM, MFIX and ParaView.
//!
//! Points with an array called `diameter` or `radius` (`radii` in Yade), possibly with a unit at the
//! end, as in `diameter_mm`. [`legacy`] reads the formats before XML (`.vtk`, ASCII and binary), [`xml`]
//! reads `.vtp` and `.vtu`. Neither format tells if boundaries are periodic.

pub(super) mod xml;

use crate::packing::fields::{FileCell, FileGrains, NAMES, Problem, ReadingNote, ended, line_ends, refused};
use crate::packing::tables::{DIAMETER, Named, RADIUS};

/// Points of a file and their numbers.
pub(crate) struct Points {
    /// Line that names them, for messages.
    pub(crate) line: usize,
    /// x, y and z of each point, one point after another.
    pub(crate) places: Vec<f64>,
    pub(crate) arrays: Vec<PointArray>,
}

pub(crate) struct PointArray {
    pub(crate) line: usize,
    pub(crate) name: String,
    pub(crate) values: Vec<f64>,
}

pub(crate) fn grains(points: Points) -> Result<FileGrains, Problem> {
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
        return Err(refused(points.line, "arrays of the points", &names.join(", "), allowed));
    };
    let count = points.places.len() / 3;
    if size.values.len() != count {
        let allowed = format!("{count} numbers, one for each point");
        return Err(refused(size.line, NAMES[3], &format!("{} numbers", size.values.len()), allowed));
    }
    if count == 0 {
        return Err(ended(points.line, "at least one point"));
    }
    if let Some((at, value)) = points.places.iter().enumerate().find(|(_, value)| !value.is_finite()) {
        return Err(refused(points.line, NAMES[at % 3], &value.to_string(), "a finite number"));
    }
    if let Some(value) = size.values.iter().find(|value| !(value.is_finite() && **value > 0.0)) {
        return Err(refused(size.line, NAMES[3], &value.to_string(), "a finite number above 0"));
    }
    let places = points.places.chunks_exact(3).zip(&size.values);
    let grains = places.map(|(p, value)| [p[0], p[1], p[2], factor * value]).collect();
    let note = name.unit.map(|unit| ReadingNote::Array { name: size.name.clone(), unit });
    Ok(FileGrains { grains, unit: name.unit, cell: FileCell::Unsaid, line: points.line, note })
}

/// Type of the numbers of an array: its form, and its size in bytes.
#[derive(Clone, Copy)]
pub(crate) struct Number(NumberForm, usize);

#[derive(Clone, Copy)]
enum NumberForm {
    Signed,
    Unsigned,
    Float,
}

/// Names of the number types in XML and in the formats before XML.
const NUMBERS: [(&str, &[&str], Number); 10] = [
    ("Int8", &["char"], Number(NumberForm::Signed, 1)),
    ("UInt8", &["unsigned_char"], Number(NumberForm::Unsigned, 1)),
    ("Int16", &["short"], Number(NumberForm::Signed, 2)),
    ("UInt16", &["unsigned_short"], Number(NumberForm::Unsigned, 2)),
    ("Int32", &["int", "vtkIdType"], Number(NumberForm::Signed, 4)),
    ("UInt32", &["unsigned_int"], Number::U32),
    ("Int64", &["long", "vtktypeint64"], Number(NumberForm::Signed, 8)),
    ("UInt64", &["unsigned_long", "vtktypeuint64"], Number::U64),
    ("Float32", &["float"], Number(NumberForm::Float, 4)),
    ("Float64", &["double"], Number(NumberForm::Float, 8)),
];

impl Number {
    pub(crate) const U32: Self = Self(NumberForm::Unsigned, 4);
    pub(crate) const U64: Self = Self(NumberForm::Unsigned, 8);

    pub(crate) fn bytes(self) -> usize {
        self.1
    }

    /// Reads all numbers in a run of bytes; an incomplete rest is ignored.
    pub(crate) fn all(self, bytes: &[u8], is_big_endian: bool) -> Vec<f64> {
        bytes.chunks_exact(self.bytes()).map(|bytes| self.one(bytes, is_big_endian)).collect()
    }

    pub(crate) fn one(self, bytes: &[u8], is_big_endian: bool) -> f64 {
        let mut little = [0; 8];
        for (k, slot) in little.iter_mut().take(bytes.len()).enumerate() {
            *slot = if is_big_endian { bytes[bytes.len() - 1 - k] } else { bytes[k] };
        }
        let (whole, unused) = (u64::from_le_bytes(little), 64 - 8 * self.bytes());
        match self {
            Self(NumberForm::Unsigned, _) => whole as f64,
            Self(NumberForm::Signed, _) => ((whole << unused) as i64 >> unused) as f64,
            Self(NumberForm::Float, 4) => f64::from(f32::from_bits(whole as u32)),
            Self(NumberForm::Float, _) => f64::from_bits(whole),
        }
    }
}

pub(crate) fn legacy(content: &[u8]) -> Result<FileGrains, Problem> {
    let mut cursor = Cursor { content, at: 0, line: 0, is_binary: false };
    let heading = [cursor.raw_line(), cursor.raw_line()];
    if heading.iter().any(Option::is_none) {
        return Err(cursor.ended("a title, ASCII or BINARY, and DATASET"));
    }
    cursor.is_binary = match cursor.words()?.first().map(String::as_str) {
        Some("ASCII") => false,
        Some("BINARY") => true,
        other => return Err(cursor.refused("form", other.unwrap_or(""), "ASCII or BINARY")),
    };
    let (mut points, mut arrays, mut of_points) = (None, Vec::new(), false);
    while let Some(words) = cursor.next_words() {
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        match words[..] {
            ["DATASET", "POLYDATA" | "UNSTRUCTURED_GRID"] => {}
            ["DATASET", other, ..] => {
                return Err(cursor.refused("dataset", other, "POLYDATA or UNSTRUCTURED_GRID"));
            }
            ["POINTS", count, kind] => {
                let line = cursor.line;
                points = Some((line, cursor.numbers(count, 3, kind)?));
            }
            ["VERTICES" | "LINES" | "POLYGONS" | "TRIANGLE_STRIPS" | "CELLS", count, size] => {
                cursor.cells(count, size)?;
            }
            ["CELL_TYPES", count] => drop(cursor.numbers(count, 1, "int")?),
            ["POINT_DATA", _] => of_points = true,
            ["CELL_DATA", _] => of_points = false,
            ["SCALARS", name, kind, ref components @ ..] => {
                let components = components.first().copied().unwrap_or("1");
                let array = cursor.array(name, points.as_ref(), components, kind)?;
                if of_points {
                    arrays.push(array);
                }
            }
            ["VECTORS" | "NORMALS", name, kind] => drop(cursor.array(name, points.as_ref(), "3", kind)?),
            ["TENSORS", name, kind] => drop(cursor.array(name, points.as_ref(), "9", kind)?),
            ["FIELD", _, count] => {
                let count = cursor.count(count)?;
                for _ in 0..count {
                    let words = cursor.words()?;
                    let [name, components, tuples, kind] = &words[..] else {
                        let allowed = "an array's name, components, number and type";
                        return Err(cursor.refused("field", &words.join(" "), allowed));
                    };
                    let (line, components) = (cursor.line, cursor.count(components)?);
                    let values = cursor.numbers(tuples, components, kind)?;
                    if of_points && components == 1 {
                        arrays.push(PointArray { line, name: name.clone(), values });
                    }
                    cursor.metadata();
                }
            }
            ["METADATA"] => cursor.pass_blank_line(),
            _ => {
                let allowed = "a section of points with numbers, as POINTS, VERTICES, SCALARS or FIELD";
                return Err(cursor.refused("section", &words.join(" "), allowed));
            }
        }
    }
    let (line, places) = points.ok_or_else(|| cursor.ended("POINTS"))?;
    grains(Points { line, places, arrays })
}

struct Cursor<'a> {
    content: &'a [u8],
    at: usize,
    /// Line number, by counting line ends even in a binary file.
    line: usize,
    is_binary: bool,
}

impl<'a> Cursor<'a> {
    fn refused(&self, field: &'static str, value: &str, allowed: &str) -> Problem {
        refused(self.line, field, value, allowed)
    }

    fn ended(&self, expected: &str) -> Problem {
        ended(self.line, expected)
    }

    fn raw_line(&mut self) -> Option<String> {
        let rest = self.content.get(self.at..).filter(|rest| !rest.is_empty())?;
        let length = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        self.at += (length + 1).min(rest.len());
        self.line += 1;
        Some(String::from_utf8_lossy(&rest[..length]).trim().to_owned())
    }

    /// Returns the words of the next line that is not blank.
    fn next_words(&mut self) -> Option<Vec<String>> {
        loop {
            let line = self.raw_line()?;
            if !line.is_empty() {
                return Some(line.split_whitespace().map(str::to_owned).collect());
            }
        }
    }

    fn words(&mut self) -> Result<Vec<String>, Problem> {
        self.next_words().ok_or_else(|| self.ended("further lines"))
    }

    /// Skips the next line if it passes the test; else does not move.
    fn skip_if(&mut self, is: impl Fn(&str) -> bool) -> bool {
        let before = (self.at, self.line);
        let is_skipped = self.next_words().is_some_and(|words| is(&words[0]));
        if !is_skipped {
            (self.at, self.line) = before;
        }
        is_skipped
    }

    fn metadata(&mut self) {
        if self.skip_if(|word| word == "METADATA") {
            self.pass_blank_line();
        }
    }

    fn pass_blank_line(&mut self) {
        while self.raw_line().is_some_and(|line| !line.is_empty()) {}
    }

    fn count(&self, text: &str) -> Result<usize, Problem> {
        text.parse().map_err(|_| self.refused("number", text, "a whole number"))
    }

    fn array(
        &mut self,
        name: &str,
        points: Option<&(usize, Vec<f64>)>,
        components: &str,
        kind: &str,
    ) -> Result<PointArray, Problem> {
        let line = self.line;
        let Some((_, places)) = points else { return Err(self.refused("section", name, "POINTS first")) };
        let tuples = (places.len() / 3).to_string();
        self.skip_if(|word| word == "LOOKUP_TABLE");
        let values = self.numbers(&tuples, self.count(components)?, kind)?;
        self.metadata();
        Ok(PointArray { line, name: name.to_owned(), values })
    }

    /// Skips the lists of the points of each cell: since VTK 9 as offsets and points.
    fn cells(&mut self, count: &str, size: &str) -> Result<(), Problem> {
        let before = (self.at, self.line);
        for (place, count) in [count, size].into_iter().enumerate() {
            let words = self.words()?;
            if place == 0 && words[0] != "OFFSETS" {
                (self.at, self.line) = before;
                return self.numbers(size, 1, "int").map(drop);
            }
            self.numbers(count, 1, words.get(1).map_or("", String::as_str))?;
        }
        Ok(())
    }

    fn numbers(&mut self, tuples: &str, components: usize, kind: &str) -> Result<Vec<f64>, Problem> {
        let count = self.count(tuples)?.checked_mul(components);
        let left = self.content.len() - self.at;
        // A number takes at least one byte, so a file can never ask for more memory than its own size.
        let Some(count) = count.filter(|&count| count <= left) else {
            return Err(self.ended(&format!("{tuples} times {components} numbers")));
        };
        let Some(&(.., number)) = NUMBERS.iter().find(|(_, names, _)| names.contains(&kind)) else {
            let allowed = "a number's type, as float, double, int or vtktypeint64";
            return Err(self.refused("type", kind, allowed));
        };
        if self.is_binary {
            let end = count.checked_mul(number.bytes()).filter(|&bytes| bytes <= left);
            let Some(bytes) = end else { return Err(self.ended(&format!("{count} numbers of type {kind}"))) };
            let run = &self.content[self.at..self.at + bytes];
            self.at += bytes;
            self.line += line_ends(run);
            return Ok(number.all(run, true));
        }
        (0..count).map(|_| self.number()).collect()
    }

    fn number(&mut self) -> Result<f64, Problem> {
        let rest = &self.content[self.at..];
        let begin = rest.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(rest.len());
        let word = &rest[begin..];
        let length = word.iter().position(u8::is_ascii_whitespace).unwrap_or(word.len());
        self.line += line_ends(&rest[..begin]);
        self.at += begin + length;
        let text = String::from_utf8_lossy(&word[..length]);
        if text.is_empty() {
            return Err(self.ended("further numbers"));
        }
        text.parse().map_err(|_| refused(self.line + 1, "number", &text, "a number"))
    }
}
