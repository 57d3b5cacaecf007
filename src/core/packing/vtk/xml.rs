//! VTK files in XML, `.vtp` and `.vtu`: numbers as text, in Base64, or appended after the XML in Base64
//! or raw; compressed by zlib or not.

use super::{NUMBERS, Number, PointArray, Points, grains};
use crate::packing::fields::{
    FileGrains, PACKING_FILE_LIMIT_BYTES, Problem, ended, in_utf8, line_ends, refused,
};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::io::Read;

const TYPES: [&str; 2] = ["PolyData", "UnstructuredGrid"];

/// Maximum unpacked size of a block of compressed numbers.
const LARGEST_BLOCK: usize = 1 << 28;

pub(crate) fn xml(content: &[u8]) -> Result<FileGrains, Problem> {
    let (head, appended) = split(content)?;
    let mut reader = Reader::from_str(head);
    reader.config_mut().expand_empty_elements = true;
    // A file with appended data is cut before the end of its XML.
    reader.config_mut().check_end_names = false;
    let mut form = Form { line: 1, is_big_endian: false, header: Number::U32, is_zlib: false, appended };
    let mut points = Points { line: 1, places: Vec::new(), arrays: Vec::new() };
    // Number of points in the pieces so far; true once the file is complete.
    let (mut point_count, mut is_whole) = (0usize, form.appended.is_some());
    let (mut room, mut open): (Option<Room>, Option<Declared>) = (None, None);
    // Depth within an array: VTK's notes on an array are separate elements.
    let mut within: i64 = 0;
    let mut at = 0;
    loop {
        let before = std::mem::replace(&mut at, reader.buffer_position() as usize);
        form.line += line_ends(&head.as_bytes()[before..at]);
        let event = match reader.read_event() {
            Ok(event) => event,
            // The XML is cut off where the appended numbers begin.
            Err(_) if form.appended.is_some() && reader.buffer_position() as usize >= head.len() => break,
            Err(error) => {
                return Err(form.refused("XML", &error.to_string(), "a whole file of VTK"));
            }
        };
        match event {
            Event::Start(e) => match e.name().as_ref() {
                "VTKFile" => form.read(&e)?,
                "Piece" => {
                    let count = attribute(&e, "NumberOfPoints").unwrap_or_default();
                    let more = count.parse().ok().and_then(|more| point_count.checked_add(more));
                    point_count =
                        more.ok_or_else(|| form.refused("NumberOfPoints", &count, "a whole number"))?;
                }
                "Points" => (room, points.line) = (Some(Room::Places), form.line),
                "PointData" => room = Some(Room::Numbers),
                "DataArray" if room.is_some() => (open, within) = (Some(Declared::read(&e, &form)?), 0),
                _ if open.is_some() => within += 1,
                _ => {}
            },
            Event::Text(text) => {
                if let Some(open) = open.as_mut().filter(|_| within == 0) {
                    open.text.push_str(&text);
                }
            }
            Event::End(e) => match e.name().as_ref() {
                "DataArray" => {
                    if let (Some(room), Some(open)) = (room, open.take()) {
                        keep(&mut points, room, open, &form)?;
                    }
                }
                "VTKFile" => is_whole = true,
                "Points" | "PointData" => room = None,
                _ if open.is_some() => within -= 1,
                _ => {}
            },
            Event::Eof => break,
            _ => {}
        }
    }
    if !is_whole {
        return Err(ended(form.line, "</VTKFile>"));
    }
    if point_count.checked_mul(3) != Some(points.places.len()) {
        let actual = format!("{} numbers", points.places.len());
        let allowed = format!("x, y and z of {point_count} points, as NumberOfPoints says");
        return Err(refused(points.line, "points", &actual, allowed));
    }
    grains(points)
}

/// Target of an array.
#[derive(Clone, Copy, PartialEq)]
enum Room {
    Places,
    Numbers,
}

/// Adds an array to the arrays of earlier pieces.
fn keep(points: &mut Points, room: Room, array: Declared, form: &Form<'_>) -> Result<(), Problem> {
    match (room, array.components) {
        (Room::Places, 3) => points.places.extend(array.values(form)?),
        (Room::Places, other) => {
            return Err(refused(array.line, "NumberOfComponents", &other.to_string(), "three: x, y and z"));
        }
        (Room::Numbers, 1) => {
            let values = array.values(form)?;
            match points.arrays.iter_mut().find(|earlier| earlier.name == array.name) {
                Some(earlier) => earlier.values.extend(values),
                None => points.arrays.push(PointArray { line: array.line, name: array.name, values }),
            }
        }
        (Room::Numbers, _) => {}
    }
    Ok(())
}

/// Separates the XML from the data appended after it.
fn split(content: &[u8]) -> Result<(&str, Option<Coded<'_>>), Problem> {
    const OPENS: &[u8] = b"<AppendedData";
    let appended_at = content.windows(OPENS.len()).position(|window| window == OPENS);
    let end = appended_at.unwrap_or(content.len());
    let head = in_utf8(&content[..end])?;
    let Some(begin) = appended_at else { return Ok((head, None)) };
    let line = 1 + line_ends(head.as_bytes());
    let tag = &content[begin..];
    let marks = |mark: u8, from: usize| tag[from..].iter().position(|&byte| byte == mark).map(|at| from + at);
    let Some((close, data)) = marks(b'>', 0).and_then(|close| Some((close, marks(b'_', close)?))) else {
        return Err(ended(line, "an underscore and the appended numbers"));
    };
    let is_raw = match String::from_utf8_lossy(&tag[..close]) {
        tag if tag.contains("\"raw\"") => true,
        tag if tag.contains("\"base64\"") => false,
        tag => return Err(refused(line, "encoding", &tag, "raw or base64")),
    };
    Ok((head, Some(Coded { is_raw, content: &tag[data + 1..] })))
}

struct Form<'a> {
    line: usize,
    is_big_endian: bool,
    /// Integer type that gives the length of the data that follows.
    header: Number,
    is_zlib: bool,
    appended: Option<Coded<'a>>,
}

impl Form<'_> {
    fn refused(&self, field: &'static str, value: &str, allowed: &str) -> Problem {
        refused(self.line, field, value, allowed)
    }

    fn read(&mut self, e: &BytesStart<'_>) -> Result<(), Problem> {
        let kind = attribute(e, "type").unwrap_or_default();
        if !TYPES.contains(&kind.as_str()) {
            let allowed = "PolyData or UnstructuredGrid, one file of points; of a parallel file give a piece";
            return Err(self.refused("type", &kind, allowed));
        }
        self.is_big_endian = match attribute(e, "byte_order").as_deref() {
            None | Some("LittleEndian") => false,
            Some("BigEndian") => true,
            Some(other) => return Err(self.refused("byte_order", other, "LittleEndian or BigEndian")),
        };
        self.header = match attribute(e, "header_type").as_deref() {
            None | Some("UInt32") => Number::U32,
            Some("UInt64") => Number::U64,
            Some(other) => return Err(self.refused("header_type", other, "UInt32 or UInt64")),
        };
        self.is_zlib = match attribute(e, "compressor").as_deref() {
            None | Some("") => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => {
                return Err(self.refused("compressor", other, "none or vtkZLibDataCompressor"));
            }
        };
        Ok(())
    }
}

fn attribute(element: &BytesStart<'_>, name: &str) -> Option<String> {
    let entry = element.attributes().with_checks(false).flatten().find(|a| a.key.as_ref() == name)?;
    Some(quick_xml::escape::unescape(&entry.value).ok()?.into_owned())
}

struct Declared {
    line: usize,
    name: String,
    number: Number,
    components: usize,
    place: Place,
    text: String,
}

enum Place {
    Text,
    Base64,
    /// Offset in bytes or characters after the underscore.
    Appended(usize),
}

impl Declared {
    fn read(e: &BytesStart<'_>, form: &Form<'_>) -> Result<Self, Problem> {
        let kind = attribute(e, "type").unwrap_or_default();
        let Some(&(.., number)) = NUMBERS.iter().find(|(name, ..)| *name == kind) else {
            return Err(form.refused("type", &kind, "a number's type, as Float32, Float64 or Int32"));
        };
        let place = match attribute(e, "format").as_deref() {
            Some("ascii") => Place::Text,
            Some("binary") => Place::Base64,
            Some("appended") => {
                let offset = attribute(e, "offset").unwrap_or_default();
                let offset = offset.parse().map_err(|_| form.refused("offset", &offset, "a whole number"))?;
                Place::Appended(offset)
            }
            other => return Err(form.refused("format", other.unwrap_or(""), "ascii, binary or appended")),
        };
        let components = match attribute(e, "NumberOfComponents") {
            None => 1,
            Some(text) => {
                text.parse().map_err(|_| form.refused("NumberOfComponents", &text, "a whole number"))?
            }
        };
        let name = attribute(e, "Name").unwrap_or_default();
        Ok(Self { line: form.line, name, number, components, place, text: String::new() })
    }

    fn values(&self, form: &Form<'_>) -> Result<Vec<f64>, Problem> {
        let broken = |expected: &str| ended(self.line, format!("{expected} of the array {}", self.name));
        let words = self.text.split_ascii_whitespace();
        let bytes = match (&self.place, &form.appended) {
            (Place::Text, _) => {
                let one =
                    |word: &str| word.parse().map_err(|_| refused(self.line, "number", word, "a number"));
                return words.map(one).collect();
            }
            (Place::Base64, _) => {
                Coded { is_raw: false, content: words.collect::<String>().as_bytes() }.block(form)
            }
            (&Place::Appended(offset), Some(Coded { is_raw, content })) => {
                let content = content.get(offset..);
                content.and_then(|content| Coded { is_raw: *is_raw, content }.block(form))
            }
            (Place::Appended(_), None) => return Err(broken("AppendedData with the numbers")),
        };
        let bytes = bytes.ok_or_else(|| broken("all bytes"))?;
        Ok(self.number.all(&bytes, form.is_big_endian))
    }
}

/// Encoded bytes in the file, raw or in Base64; there may be more than an array needs.
struct Coded<'a> {
    is_raw: bool,
    content: &'a [u8],
}

impl Coded<'_> {
    /// Decodes `bytes` bytes and returns the start of the next run: Base64 runs are padded to whole
    /// groups. If the run is longer, its first bytes are returned.
    fn run(&self, from: usize, bytes: usize) -> Option<(Vec<u8>, usize)> {
        let length = if self.is_raw { bytes } else { bytes.checked_add(2)? / 3 * 4 };
        let end = from.checked_add(length)?;
        let run = self.content.get(from..end)?;
        if self.is_raw {
            return Some((run.to_vec(), end));
        }
        let mut decoded = STANDARD.decode(run).ok()?;
        decoded.truncate(bytes);
        (decoded.len() == bytes).then_some((decoded, end))
    }

    /// Reads the bytes of an array after its header, unpacked.
    fn block(&self, form: &Form<'_>) -> Option<Vec<u8>> {
        let word = form.header.bytes();
        let whole = |bytes: &[u8]| form.header.one(bytes, form.is_big_endian) as usize;
        let first = whole(&self.run(0, word)?.0);
        if !form.is_zlib {
            let (mut all, _) = self.run(0, word.checked_add(first)?)?;
            all.drain(..word);
            return Some(all);
        }
        // Number of blocks, unpacked size of each and of the last if it is shorter, packed size of each.
        let (header, begin) = self.run(0, first.checked_add(3)?.checked_mul(word)?)?;
        let sizes: Vec<usize> = header.chunks_exact(word).map(whole).collect();
        let (full, last) = (sizes[1], sizes[2]);
        let packed: usize = sizes[3..].iter().try_fold(0usize, |sum, size| sum.checked_add(*size))?;
        let (packed, _) = self.run(begin, packed)?;
        let (mut at, mut bytes) = (0usize, Vec::new());
        for (k, size) in sizes[3..].iter().enumerate() {
            let unpacked = if k + 1 == first && last > 0 { last } else { full };
            let end = at.checked_add(*size)?;
            let begun = bytes.len();
            let block = flate2::read::ZlibDecoder::new(packed.get(at..end)?);
            block.take(unpacked.min(LARGEST_BLOCK) as u64 + 1).read_to_end(&mut bytes).ok()?;
            if bytes.len() - begun != unpacked || bytes.len() as u64 > PACKING_FILE_LIMIT_BYTES {
                return None;
            }
            at = end;
        }
        Some(bytes)
    }
}
