//! Sentences of notes, filled with their numbers.

use serde_json::Value;

use voidwalk_practice::design::RowNote;
use voidwalk_practice::note::Note;
use voidwalk_practice::quantity::{NumberRole, SizeUnit, Unit, significant, whole};

/// Sentence of a note; lengths are shown in this unit.
///
/// ```
/// use voidwalk_practice::{Note, quantity::SizeUnit};
/// let note = Note::CoarseBase { d85_mm: 19.0 };
/// let words = voidwalk_app::words::sentence(&note, SizeUnit::Mm);
/// assert_eq!(words, "The D85 of the base is 19\u{202f}mm: are its sizes micrometres under a header in mm?");
/// ```
pub fn sentence(note: &Note, unit: SizeUnit) -> String {
    filled(note, note.entry().sentence, unit)
}

/// Setting that changes the subject of a note; empty without one.
pub fn setting(note: &Note) -> String {
    filled(note, note.entry().setting, SizeUnit::Mm)
}

/// Sentence of a note on a part of boundaries or of a specification, after the name of that part.
pub(crate) fn row_note(row: &RowNote, unit: SizeUnit) -> String {
    let words = sentence(&row.note, unit);
    row.row.as_ref().map_or(words.clone(), |name| format!("{name}: {words}"))
}

/// Template with a note's numbers in place of their names: `{name}`, or `{name:noun}` for a count.
fn filled(note: &Note, template: &str, unit: SizeUnit) -> String {
    let record = serde_json::to_value(note).unwrap_or_default();
    let mut text = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once('{') {
        let (field, after) = after.split_once('}').unwrap_or((after, ""));
        let (name, noun) = field.split_once(':').map_or((field, None), |(name, noun)| (name, Some(noun)));
        text += before;
        text += &shown(name, noun, &record["numbers"][name], unit);
        rest = after;
    }
    text + rest
}

/// Number, rounded by the unit and the side in its name.
fn shown(name: &str, noun: Option<&str>, value: &Value, unit: SizeUnit) -> String {
    match value {
        Value::String(text) => one_line(text),
        Value::Array(names) => {
            listed(&names.iter().filter_map(Value::as_str).map(one_line).collect::<Vec<_>>())
        }
        Value::Number(number) if number.is_u64() => counted(number.as_u64().unwrap_or(0), noun),
        Value::Number(number) => measured(name, number.as_f64().unwrap_or(f64::NAN), unit),
        _ => "an unknown number of".into(),
    }
}

fn measured(name: &str, value: f64, unit: SizeUnit) -> String {
    let number = match name.split('_').next() {
        Some("least") => significant(value).role(NumberRole::Least),
        // A value above a bound is above the bound rounded down.
        Some("most" | "over") => significant(value).role(NumberRole::Greatest),
        _ => significant(value).in_digits(3),
    };
    match name.rsplit('_').next() {
        Some("mm") => number.in_unit(Unit::Size(unit)).to_string(),
        Some("percent") => number.in_unit(Unit::Percent).in_digits(3).to_string(),
        Some("pp") => format!("{} percentage points", number.in_digits(3)),
        _ => number.to_string(),
    }
}

/// Count with its noun, such as `replicate` or `copy|copies`.
fn counted(number: u64, noun: Option<&str>) -> String {
    let Some(noun) = noun else { return whole(number).to_string() };
    let (one, many) = noun.split_once('|').unwrap_or((noun, ""));
    match (number, many) {
        (1, _) => format!("1 {one}"),
        (_, "") => format!("{} {one}s", whole(number)),
        (_, many) => format!("{} {many}", whole(number)),
    }
}

/// Text on one line, for any name.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Joins items as `a`, `a and b`, `a, b and c`.
fn listed(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [all @ .., last] => format!("{} and {last}", all.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::fs;
    use std::path::Path;

    /// Clients read each sentence alone; a short one is understood at once.
    #[test]
    fn every_sentence_has_at_most_25_words() {
        for note in Note::all_with(12.5, 3, "some") {
            for words in [sentence(&note, SizeUnit::Mm), setting(&note)] {
                assert!(words.split_whitespace().count() <= 25, "{words}");
            }
        }
    }

    /// No number spoils a sentence, and a file returns the values that it holds.
    #[test]
    fn every_note_reads_well_with_any_numbers_and_is_read_back() {
        let long = "a name ".repeat(200);
        for number in [0.0, 1e-300, -1.0, 12.345, 1e300, f64::NAN, f64::INFINITY] {
            for (count, name) in [(0, ""), (1, "x"), (u64::MAX, &*long), (2, "two\nlines {and} braces")] {
                for note in Note::all_with(number, count, name) {
                    for words in [sentence(&note, SizeUnit::MmAndInches), setting(&note)] {
                        assert!(!words.contains("NaN") && !words.contains("inf "), "{words}");
                        assert!(name.contains('{') || !words.contains(['{', '}']), "{words}");
                    }
                    let text = serde_json::to_string(&note).unwrap();
                    if number.is_finite() {
                        assert_eq!(serde_json::from_str::<Note>(&text).unwrap(), note);
                    }
                }
            }
        }
    }

    /// Folder of all crates.
    const SOURCES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

    #[test]
    fn every_row_is_whole_and_every_number_is_used() {
        let mut ids = BTreeSet::new();
        for (place, note) in Note::all_with(12.5, 3, "some").into_iter().enumerate() {
            let (entry, id, record) = (note.entry(), note.id(), serde_json::to_value(&note).unwrap());
            assert_eq!(note.place(), place);
            assert!(ids.insert(id.clone()), "{id} is there twice");
            let page = Path::new(SOURCES).join("docs").join(entry.page);
            assert!(!entry.label.is_empty() && page.exists(), "{id}");
            let begin = entry.sentence.chars().next().unwrap();
            assert!((begin.is_uppercase() || begin == '{') && entry.sentence.ends_with(['.', '?']), "{id}");
            for name in record["numbers"].as_object().into_iter().flat_map(|numbers| numbers.keys()) {
                let is_used = |text: &str| {
                    [format!("{{{name}}}"), format!("{{{name}:")].iter().any(|field| text.contains(field))
                };
                assert!(is_used(entry.sentence) || is_used(entry.setting), "{id} does not say {name}");
            }
            // Sentences for a client contain no words of the program.
            for word in ["base.", "filter.", "network.", "walk.", "inject_share", "--", "rattler"] {
                let is_key =
                    |(at, _)| entry.sentence[at + word.len()..].starts_with(|c: char| c.is_ascii_lowercase());
                assert!(!entry.sentence.match_indices(word).any(is_key), "{id}: {}", entry.sentence);
            }
        }
    }

    #[test]
    fn numbers_have_the_unit_and_the_side_of_their_names() {
        for (name, value, text) in [
            ("fines_percent", 35.24, "35.2\u{202f}%"),
            ("fines_percent", 100.0, "100\u{202f}%"),
            ("sieve_mm", 0.075, "0.075\u{202f}mm"),
            ("most_d15f_mm", 0.2859, "0.285\u{202f}mm"),
            ("least_d15f_mm", 0.2851, "0.286\u{202f}mm"),
            ("least_cu", 8.7655, "8.77"),
        ] {
            assert_eq!(measured(name, value, SizeUnit::Mm), text);
        }
        assert_eq!(counted(1, Some("copy|copies")), "1 copy");
        assert_eq!(counted(12_000, Some("replicate")), "12\u{202f}000 replicates");
    }

    /// A dead row would be a sentence that is never read.
    #[test]
    fn every_note_is_reported_somewhere() {
        let mut code = String::new();
        let mut folders = vec![Path::new(SOURCES).to_owned()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else if path.extension().is_some_and(|e| e == "rs") {
                    code += &fs::read_to_string(path).unwrap();
                }
            }
        }
        for note in Note::all_with(1.0, 1, "") {
            let debug = format!("{note:?}");
            let name = debug.split(' ').next().unwrap();
            assert!(code.contains(&format!("Note::{name}")), "{name} is reported nowhere");
        }
    }
}
