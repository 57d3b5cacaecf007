//! VTK files before XML: a heading of four lines, and then words with numbers in text or, with the high byte
//! first, in binary.

use super::number::Number;
use super::points::{PointArray, Points, grains};
use crate::packing::fields::{ImportError, refused};
use crate::packing::found::FileGrains;

/// Reads the grains of a file that begins with `# vtk DataFile`.
pub fn legacy(file: &str, content: &[u8]) -> Result<FileGrains, ImportError> {
    let mut cursor = Cursor { file, content, at: 0, line: 0, is_binary: false };
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
    grains(file, Points { line, places, arrays })
}

/// A position in the file.
struct Cursor<'a> {
    file: &'a str,
    content: &'a [u8],
    at: usize,
    /// Number of lines begun, counted by line ends in a binary file too.
    line: usize,
    is_binary: bool,
}

impl<'a> Cursor<'a> {
    fn refused(&self, field: &'static str, value: &str, allowed: &str) -> ImportError {
        refused(self.file, self.line, field, value, allowed)
    }

    fn ended(&self, expected: &str) -> ImportError {
        ImportError::Truncated { file: self.file.into(), line: self.line, expected: expected.into() }
    }

    /// The next line without its end.
    fn raw_line(&mut self) -> Option<String> {
        let rest = self.content.get(self.at..).filter(|rest| !rest.is_empty())?;
        let length = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        self.at += (length + 1).min(rest.len());
        self.line += 1;
        Some(String::from_utf8_lossy(&rest[..length]).trim().to_owned())
    }

    /// The words of the next line that is not blank.
    fn next_words(&mut self) -> Option<Vec<String>> {
        loop {
            let line = self.raw_line()?;
            if !line.is_empty() {
                return Some(line.split_whitespace().map(str::to_owned).collect());
            }
        }
    }

    fn words(&mut self) -> Result<Vec<String>, ImportError> {
        self.next_words().ok_or_else(|| self.ended("further lines"))
    }

    /// Passes over the next line if it is one of these, or else does not move.
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

    fn count(&self, text: &str) -> Result<usize, ImportError> {
        text.parse().map_err(|_| self.refused("number", text, "a whole number"))
    }

    fn array(
        &mut self,
        name: &str,
        points: Option<&(usize, Vec<f64>)>,
        components: &str,
        kind: &str,
    ) -> Result<PointArray, ImportError> {
        let line = self.line;
        let Some((_, places)) = points else { return Err(self.refused("section", name, "POINTS first")) };
        let tuples = (places.len() / 3).to_string();
        self.skip_if(|word| word == "LOOKUP_TABLE");
        let values = self.numbers(&tuples, self.count(components)?, kind)?;
        self.metadata();
        Ok(PointArray { line, name: name.to_owned(), values })
    }

    /// Passes over the lists of the points of each cell: since VTK 9 as offsets and points.
    fn cells(&mut self, count: &str, size: &str) -> Result<(), ImportError> {
        let before = (self.at, self.line);
        let words = self.words()?;
        if words.first().is_some_and(|word| word == "OFFSETS") {
            let kind = words.get(1).cloned().unwrap_or_default();
            self.numbers(count, 1, &kind)?;
            let words = self.words()?;
            let kind = words.get(1).cloned().unwrap_or_default();
            return self.numbers(size, 1, &kind).map(drop);
        }
        (self.at, self.line) = before;
        self.numbers(size, 1, "int").map(drop)
    }

    /// Reads `tuples` tuples of numbers.
    fn numbers(&mut self, tuples: &str, components: usize, kind: &str) -> Result<Vec<f64>, ImportError> {
        let count = self.count(tuples)?.checked_mul(components);
        let left = self.content.len() - self.at;
        // A number takes a byte at least, so a file can never ask for more memory than its own size.
        let Some(count) = count.filter(|&count| count <= left) else {
            return Err(self.ended(&format!("{tuples} times {components} numbers")));
        };
        let number = number(kind).ok_or_else(|| {
            self.refused("type", kind, "a number's type, as float, double, int or vtktypeint64")
        })?;
        if self.is_binary {
            let end = count.checked_mul(number.bytes()).filter(|&bytes| bytes <= left);
            let Some(bytes) = end else { return Err(self.ended(&format!("{count} numbers of type {kind}"))) };
            let run = &self.content[self.at..self.at + bytes];
            self.at += bytes;
            self.line += run.iter().filter(|&&byte| byte == b'\n').count();
            return Ok(number.all(run, true));
        }
        (0..count).map(|_| self.number()).collect()
    }

    /// The next number in text.
    fn number(&mut self) -> Result<f64, ImportError> {
        let rest = &self.content[self.at..];
        let begin = rest.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(rest.len());
        let word = &rest[begin..];
        let length = word.iter().position(u8::is_ascii_whitespace).unwrap_or(word.len());
        self.line += rest[..begin].iter().filter(|&&byte| byte == b'\n').count();
        self.at += begin + length;
        let text = String::from_utf8_lossy(&word[..length]);
        if text.is_empty() {
            return Err(self.ended("further numbers"));
        }
        text.parse().map_err(|_| refused(self.file, self.line + 1, "number", &text, "a number"))
    }
}

fn number(kind: &str) -> Option<Number> {
    Some(match kind {
        "char" => Number::I8,
        "unsigned_char" => Number::U8,
        "short" => Number::I16,
        "unsigned_short" => Number::U16,
        "int" | "vtkIdType" => Number::I32,
        "unsigned_int" => Number::U32,
        "long" | "vtktypeint64" => Number::I64,
        "unsigned_long" | "vtktypeuint64" => Number::U64,
        "float" => Number::F32,
        "double" => Number::F64,
        _ => return None,
    })
}
