//! Decoding of bytes to text, by the encoding of the file.

use voidwalk_core::gradation::TableError;

/// The text in `bytes`, and the assumed encoding if it is not plain UTF-8.
///
/// UTF-8 and UTF-16 are understood, with or without a byte order mark. Anything else is Windows-1252, in
/// which spreadsheets of western countries save, unless it is no text at all.
pub(super) fn decoded(file: &str, bytes: &[u8]) -> Result<(String, Option<String>), TableError> {
    refuse_other_formats(file, bytes)?;
    if let Some((is_big, skip)) = utf16(bytes) {
        let name = if is_big { "UTF-16BE" } else { "UTF-16LE" };
        let number = if is_big { u16::from_be_bytes } else { u16::from_le_bytes };
        let (units, odd) = bytes[skip..].as_chunks();
        let text: Result<String, _> = char::decode_utf16(units.iter().map(|&unit| number(unit))).collect();
        let Some(text) = text.ok().filter(|text| odd.is_empty() && !text.contains('\0')) else {
            return Err(other(file, format!("{name} that ends or breaks in the middle of a character")));
        };
        return Ok((unified(text), Some(format!("read as {name} text"))));
    }
    let (text, note) = match std::str::from_utf8(bytes) {
        Ok(text) => (text.strip_prefix('\u{feff}').unwrap_or(text).to_owned(), None),
        Err(_) => (windows_1252(bytes), Some("read as Windows-1252 text".to_owned())),
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

/// Windows-1252: Latin-1 except for these characters from 0x80 to 0x9f.
fn windows_1252(bytes: &[u8]) -> String {
    const OTHERS: &str = "€\u{81}‚ƒ„…†‡ˆ‰Š‹Œ\u{8d}Ž\u{8f}\u{90}‘’“”•–—˜™š›œ\u{9d}žŸ";
    let others: Vec<char> = OTHERS.chars().collect();
    let character = |&byte: &u8| others.get(usize::from(byte).wrapping_sub(0x80)).copied();
    bytes.iter().map(|byte| character(byte).unwrap_or(char::from(*byte))).collect()
}

/// Recognises UTF-16 by its mark or by the zeros in every other byte. Returns true if the larger byte comes
/// first, and the length of the mark.
fn utf16(bytes: &[u8]) -> Option<(bool, usize)> {
    match bytes {
        [0xff, 0xfe, ..] => return Some((false, 2)),
        [0xfe, 0xff, ..] => return Some((true, 2)),
        _ => {}
    }
    let start = &bytes[..bytes.len().min(200) & !1];
    let zeros = |from: usize| start.iter().skip(from).step_by(2).filter(|&&b| b == 0).count();
    let (even, odd, most) = (zeros(0), zeros(1), start.len() * 2 / 5);
    match start.len() >= 8 {
        true if odd > most && even == 0 => Some((false, 0)),
        true if even > most && odd == 0 => Some((true, 0)),
        _ => None,
    }
}

/// Refuses formats of other programs, by their first bytes.
fn refuse_other_formats(file: &str, bytes: &[u8]) -> Result<(), TableError> {
    const KNOWN: [(&[u8], &str); 4] = [
        (&[0xd0, 0xcf, 0x11, 0xe0], "an Excel workbook of the old kind (.xls), or one with a password"),
        (b"%PDF", "a PDF document"),
        (b"{\\rtf", "a text document (.rtf)"),
        (&[0x1f, 0x8b], "compressed (gzip)"),
    ];
    if let Some((_, what)) = KNOWN.iter().find(|(start, _)| bytes.starts_with(start)) {
        return Err(other(file, (*what).to_owned()));
    }
    let small = file.to_lowercase();
    match [".xlsx", ".ods"].iter().find(|ending| small.ends_with(**ending)) {
        Some(ending) => Err(other(file, format!("not a workbook, though its name ends in {ending}"))),
        None => Ok(()),
    }
}

fn other(file: &str, is: String) -> TableError {
    TableError::Format { file: file.into(), is }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_named_as_a_workbook_is_one_or_refused() {
        let error = |file: &str, bytes: &[u8]| decoded(file, bytes).unwrap_err().to_string();
        for ending in ["xlsx", "XLSX", "ods"] {
            let message = error(&format!("site.{ending}"), b"# voidwalk\n\n4.75,100\n");
            let is = format!("site.{ending} is not a workbook, though its name ends in .");
            assert!(message.starts_with(&is), "{message}");
        }
        assert!(error("site.xlsx", &[0xd0, 0xcf, 0x11, 0xe0]).contains("one with a password"));
        assert!(decoded("site.csv", b"4.75,100\n").is_ok());
    }

    #[test]
    fn windows_1252_has_a_character_for_every_byte() {
        let all: Vec<u8> = (0x7e..=0xff).collect();
        let text = windows_1252(&all);
        assert!(
            text.starts_with("~\u{7f}€\u{81}‚ƒ") && text.contains("œ\u{9d}žŸ\u{a0}¡") && text.ends_with("þÿ")
        );
        assert_eq!(text.chars().count(), all.len());
    }
}
