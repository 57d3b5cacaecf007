//! The parts of a workbook: files in a zip, read within bounds.

use std::io::{Cursor, Read};

use quick_xml::events::{BytesStart, Event};
use zip::ZipArchive;

use voidwalk_core::gradation::TableError;

/// Limit on the unpacked size of all parts of a workbook (bytes).
const UNPACKED_LIMIT: u64 = 64 << 20;
/// Limit on the size of a part that is read into memory (bytes).
const PART_LIMIT: u64 = 24 << 20;
/// Limit on the number of parts.
const PARTS_LIMIT: usize = 2000;

/// A workbook as a zip.
pub(super) struct Zipped<'a> {
    file: String,
    archive: ZipArchive<Cursor<&'a [u8]>>,
    names: Vec<String>,
}

impl<'a> Zipped<'a> {
    /// Opens a zip; refuses one that unpacks to more than a workbook of soils holds.
    pub(super) fn open(file: &str, bytes: &'a [u8]) -> Result<Zipped<'a>, TableError> {
        let broken = |_| unreadable(file, "its zip cannot be read");
        let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(broken)?;
        if archive.len() > PARTS_LIMIT {
            return Err(too_large(file, &format!("{} parts", archive.len())));
        }
        let (mut names, mut unpacked) = (Vec::new(), 0u64);
        for index in 0..archive.len() {
            let part = archive.by_index_raw(index).map_err(broken)?;
            if part.encrypted() {
                return Err(unreadable(file, "it has a password"));
            }
            unpacked = unpacked.saturating_add(part.size());
            if unpacked > UNPACKED_LIMIT {
                return Err(too_large(file, &format!("more than {} MB unpacked", UNPACKED_LIMIT >> 20)));
            }
            names.push(part.name().map_err(broken)?.into_owned());
        }
        let zipped = Zipped { file: file.into(), archive, names };
        if zipped.names.iter().any(|name| name.to_lowercase().ends_with("vbaproject.bin")) {
            return Err(unreadable(file, "it holds macros: save it as .xlsx, without them"));
        }
        Ok(zipped)
    }

    /// True if the workbook has this part.
    pub(super) fn has(&self, name: &str) -> bool {
        self.names.iter().any(|part| part == name)
    }

    /// Text of a part. The limit holds for the unpacked bytes, whatever size the zip declares.
    pub(super) fn text(&mut self, name: &str) -> Result<String, TableError> {
        let file = self.file.clone();
        let part = self.archive.by_name(name);
        let part = part.map_err(|_| unreadable(&file, &format!("its part {name} cannot be read")))?;
        let mut bytes = Vec::new();
        let read = part.take(PART_LIMIT + 1).read_to_end(&mut bytes);
        read.map_err(|_| unreadable(&file, &format!("its part {name} cannot be unpacked")))?;
        if bytes.len() as u64 > PART_LIMIT {
            return Err(too_large(&file, &format!("{name} is more than {} MB", PART_LIMIT >> 20)));
        }
        String::from_utf8(bytes).map_err(|_| unreadable(&file, &format!("its part {name} is not UTF-8")))
    }
}

/// Error for a workbook that cannot be read.
pub(super) fn unreadable(file: &str, why: &str) -> TableError {
    TableError::Workbook { file: file.into(), why: why.into() }
}

/// Error for a workbook that is larger than any workbook of soils.
pub(super) fn too_large(file: &str, how: &str) -> TableError {
    unreadable(file, &format!("it is too large ({how}); keep the sheet with the soils alone"))
}

/// An attribute of an element.
pub(super) fn attribute(element: &BytesStart, name: &str) -> Option<String> {
    let attribute = element
        .attributes()
        .with_checks(false)
        .flatten()
        .find(|a| a.key.as_ref() == name || !name.contains(':') && a.key.local_name().as_ref() == name)?;
    let value = quick_xml::escape::unescape(&attribute.value).ok()?;
    Some(value.into_owned())
}

/// Characters that an event within an element represents.
pub(super) fn characters(event: &Event) -> Option<String> {
    match event {
        Event::Text(text) => Some((**text).to_owned()),
        Event::CData(text) => Some((**text).to_owned()),
        Event::GeneralRef(reference) => {
            let written = format!("&{};", &**reference);
            // Keeps an unknown entity as written: without it `8&b;1` would be 81.
            let known = quick_xml::escape::unescape(&written).map(std::borrow::Cow::into_owned);
            Some(known.unwrap_or(written))
        }
        _ => None,
    }
}
