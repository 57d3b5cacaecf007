//! Bytes to text: which encoding a file is in.

use crate::gradation::error::TableError;

/// The text in `bytes`, and what was assumed of its encoding where that is not plain UTF-8.
///
/// Understood: UTF-8 and UTF-16 with or without a byte order mark; anything else is Windows-1252, in which
/// spreadsheets of western countries save, unless it is no text at all.
pub(super) fn decoded(file: &str, bytes: &[u8]) -> Result<(String, Option<String>), TableError> {
    refuse_other_formats(file, bytes)?;
    if let Some((encoding, skip)) = utf16(bytes) {
        let (text, faulty) = encoding.decode_without_bom_handling(&bytes[skip..]);
        if faulty || text.contains('\0') {
            let value = format!("{} that ends or breaks in the middle of a character", encoding.name());
            return Err(other(file, value));
        }
        return Ok((unified(text.into_owned()), Some(format!("read as {} text", encoding.name()))));
    }
    let (text, note) = match std::str::from_utf8(bytes) {
        Ok(text) => (text.strip_prefix('\u{feff}').unwrap_or(text).to_owned(), None),
        Err(_) => {
            let text = encoding_rs::WINDOWS_1252.decode_without_bom_handling(bytes).0.into_owned();
            (text, Some("read as Windows-1252 text".to_owned()))
        }
    };
    if let Some(at) = bytes.iter().position(|&b| b == 0) {
        let line = 1 + bytes[..at].iter().filter(|&&b| b == b'\n').count();
        return Err(TableError::Encoding { file: file.into(), line, byte: 0 });
    }
    Ok((unified(text), note))
}

/// A file without a single line feed has the carriage returns of an old Mac.
fn unified(text: String) -> String {
    if text.contains('\n') || !text.contains('\r') { text } else { text.replace('\r', "\n") }
}

/// UTF-16, by its mark or by the zeros in every other byte, and the length of the mark.
fn utf16(bytes: &[u8]) -> Option<(&'static encoding_rs::Encoding, usize)> {
    use encoding_rs::{UTF_16BE, UTF_16LE};
    match bytes {
        [0xff, 0xfe, ..] => return Some((UTF_16LE, 2)),
        [0xfe, 0xff, ..] => return Some((UTF_16BE, 2)),
        _ => {}
    }
    let start = &bytes[..bytes.len().min(200) & !1];
    let zeros = |from: usize| start.iter().skip(from).step_by(2).filter(|&&b| b == 0).count();
    let (even, odd, most) = (zeros(0), zeros(1), start.len() * 2 / 5);
    match start.len() >= 8 {
        true if odd > most && even == 0 => Some((UTF_16LE, 0)),
        true if even > most && odd == 0 => Some((UTF_16BE, 0)),
        _ => None,
    }
}

/// Formats of other programs are told by their first bytes.
fn refuse_other_formats(file: &str, bytes: &[u8]) -> Result<(), TableError> {
    const KNOWN: [(&[u8], &str); 4] = [
        (&[0xd0, 0xcf, 0x11, 0xe0], "an Excel workbook of the old kind (.xls), or one with a password"),
        (b"%PDF", "a PDF document"),
        (b"{\\rtf", "a text document (.rtf)"),
        (&[0x1f, 0x8b], "compressed (gzip)"),
    ];
    match KNOWN.iter().find(|(start, _)| bytes.starts_with(start)) {
        Some((_, what)) => Err(other(file, (*what).to_owned())),
        None => Ok(()),
    }
}

fn other(file: &str, is: String) -> TableError {
    TableError::Format { file: file.into(), is }
}
