//! Names in a form that can be shown: short, and without characters that are invisible or change how
//! others look. Times in written form.

use std::ops::RangeInclusive;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Last time whose year has four digits (seconds after 1970).
const LAST_MOMENT: u64 = 253_402_300_799;

/// Writes a time as `2026-11-25T23:59:59Z`. A wrong clock, as on a board without a battery, may give any
/// time: one before 1970 is written as the first of 1970, one after 9999 as the last of 9999.
pub fn moment(at: SystemTime) -> String {
    let last = UNIX_EPOCH + Duration::from_secs(LAST_MOMENT);
    humantime::format_rfc3339_seconds(at.clamp(UNIX_EPOCH, last)).to_string()
}

/// Characters that change the direction of writing.
const TURNING: [RangeInclusive<char>; 4] =
    ['\u{061c}'..='\u{061c}', '\u{200e}'..='\u{200f}', '\u{202a}'..='\u{202e}', '\u{2066}'..='\u{2069}'];

/// Characters without width, other line ends, and tags. Some scripts use them to join letters.
const WITHOUT_WIDTH: [RangeInclusive<char>; 10] = [
    '\u{00ad}'..='\u{00ad}',
    '\u{034f}'..='\u{034f}',
    '\u{115f}'..='\u{1160}',
    '\u{180b}'..='\u{180f}',
    '\u{200b}'..='\u{200d}',
    '\u{2028}'..='\u{2029}',
    '\u{2060}'..='\u{2065}',
    '\u{206a}'..='\u{206f}',
    '\u{feff}'..='\u{feff}',
    '\u{e0000}'..='\u{e0fff}',
];

/// Tells if a character changes the direction of writing around it.
fn turns_direction(character: char) -> bool {
    TURNING.iter().any(|range| range.contains(&character))
}

/// Tells if a character is invisible: a control character, one without width, or one that changes the
/// direction of writing.
pub fn is_hidden(character: char) -> bool {
    let without_width = || WITHOUT_WIDTH.iter().any(|range| range.contains(&character));
    character.is_control() || turns_direction(character) || without_width()
}

/// Returns the character, or U+FFFD if it is hidden (other than tab and line feed) or forbidden by XML
/// 1.0.
pub fn visible(character: char) -> char {
    match character {
        ' '..='~' | '\t' | '\n' => character,
        '\u{fffe}' | '\u{ffff}' => '\u{fffd}',
        c if is_hidden(c) => '\u{fffd}',
        c => c,
    }
}

/// Returns a text whose characters are all [`visible`].
pub fn all_visible(text: &str) -> String {
    text.chars().map(visible).collect()
}

/// Puts a text on one line, with U+FFFD for each hidden character.
pub fn plain(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { visible(c) }).collect()
}

/// Makes a word that can be pasted into a shell (POSIX, fish), quoted if necessary.
pub fn shell_word(word: &str) -> String {
    let needs_none = |c: char| c.is_ascii_alphanumeric() || "/._-+=,:@".contains(c);
    if !word.is_empty() && word.chars().all(needs_none) { word.to_owned() } else { quoted(word) }
}

/// Quotes a word so that no shell (POSIX, fish) interprets it.
pub fn quoted(word: &str) -> String {
    // fish treats a backslash within quotes as special.
    let inert = |c: char| if c == '\'' || c == '\\' { format!("'\\{c}'") } else { c.to_string() };
    format!("'{}'", word.chars().map(inert).collect::<String>())
}

/// Tells if a character means the same in a file name, an address and a table.
pub(crate) fn is_plain(character: char) -> bool {
    character.is_ascii_alphanumeric() || "=.,-_".contains(character)
}

/// Tells if a part of a path has plain characters only and is neither hidden nor the parent folder.
pub fn is_plain_part(part: &str) -> bool {
    !part.is_empty() && !part.starts_with('.') && part.chars().all(is_plain)
}

/// Cuts the text to `most` characters, with an ellipsis for the rest.
pub fn shorten(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_owned();
    }
    let mut cut: String = text.chars().take(most.saturating_sub(1)).collect();
    cut.truncate(cut.trim_end().len());
    cut.push('…');
    cut
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_moment_that_a_clock_may_say_is_written() {
        let day = Duration::from_secs(86_400);
        assert_eq!(moment(UNIX_EPOCH + day), "1970-01-02T00:00:00Z");
        assert_eq!(moment(UNIX_EPOCH - day), "1970-01-01T00:00:00Z");
        assert_eq!(moment(UNIX_EPOCH + day * 4_000_000), "9999-12-31T23:59:59Z");
    }

    #[test]
    fn long_names_are_cut() {
        assert_eq!(shorten("abcdef", 6), "abcdef");
        assert_eq!(shorten("abc defghi", 5), "abc…");
    }

    #[test]
    fn a_word_in_quotes_is_one_word() {
        assert_eq!(shell_word("a/b-1.csv"), "a/b-1.csv");
        assert_eq!(shell_word("a'b $(c)"), "'a'\\''b $(c)'");
        assert_eq!((&*shell_word(""), &*shell_word("a\\")), ("''", "'a'\\\\''"));
    }

    #[test]
    fn nothing_that_is_hidden_is_left() {
        let all: String = ('\u{0}'..=char::MAX).collect();
        assert!(!plain(&all).chars().any(is_hidden));
        assert!(all.chars().map(visible).all(|c| !is_hidden(c) || "\t\n".contains(c)));
    }

    /// Checks the twelve characters of Unicode's Bidi_Control.
    #[test]
    fn every_character_that_turns_the_direction_is_known() {
        let turning: Vec<char> = ('\u{0}'..=char::MAX).filter(|c| turns_direction(*c)).collect();
        let unicode =
            "\u{61c}\u{200e}\u{200f}\u{202a}\u{202b}\u{202c}\u{202d}\u{202e}\u{2066}\u{2067}\u{2068}\u{2069}";
        assert_eq!(turning, unicode.chars().collect::<Vec<_>>());
        assert!(turning.into_iter().all(is_hidden));
        for hidden in ['\u{0}', '\u{9b}', '\u{200b}', '\u{2028}', '\u{2060}', '\u{feff}', '\u{e0041}'] {
            assert!(is_hidden(hidden), "{hidden:?}");
        }
        assert!(!"größer, µm, Å, ≤ 5 %, 砂, رمل, नदी".chars().any(is_hidden));
    }

    #[test]
    fn plain_parts_of_a_path_lead_down() {
        assert!("walks/cases/fine-0.5,a=b/report.html".split('/').all(is_plain_part));
        for wrong in ["", ".", "..", ".hidden", "a b", "a\\b", "javascript:x", "a%2f", "é"] {
            assert!(!is_plain_part(wrong), "{wrong}");
        }
    }
}
