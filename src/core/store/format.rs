//! JSON files of the program. Each begins with the name and number of its format and the program's version.
//!
//! ```json
//! { "format": "voidwalk-outcome/1", "voidwalk": "0.1.0", ... }
//! ```
//! The number rises if an older program would misread the file: a field was removed, or has another
//! meaning. A new field changes nothing. A file without this beginning, or with another number, is refused.

use std::fmt;

use serde::ser::Error;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::text::is_hidden;

/// The format of a JSON file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Format {
    /// Name, without the program's.
    name: &'static str,
    /// Number of the format.
    number: u32,
    /// Name of the file, or the command that prints it.
    pub file: &'static str,
}

macro_rules! formats {
    ($($(#[$what:meta])* $constant:ident = $name:literal / $number:literal, $file:literal;)*) => {
        $($(#[$what])* pub const $constant: Format = Format { name: $name, number: $number, file: $file };)*

        /// All formats.
        pub const FORMATS: &[Format] = &[$($constant),*];
    };
}

formats! {
    /// Outcome of a scene.
    OUTCOME = "outcome" / 1, "outcome.json";
    /// Origin of a run folder.
    MANIFEST = "manifest" / 1, "manifest.json";
    /// Boundaries of the model.
    BOUNDARY = "boundary" / 1, "boundary.json";
    /// Specifications for many samples.
    DESIGNS = "designs" / 1, "designs.json";
    /// The specification of a filter.
    SPECIFICATION = "specification" / 1, "specification.json";
    /// Many samples tested against filters.
    BATCH = "batch" / 1, "batch.json";
    /// A campaign, with its `ledger.jsonl` and `cases.csv`.
    CAMPAIGN = "campaign" / 1, "campaign.json";
    /// One case of a campaign.
    CASE = "case" / 1, "case.json";
    /// A packed filter.
    PACKING = "packing" / 1, "packing.json";
    /// Measured constrictions.
    CONSTRICTIONS = "constrictions" / 1, "constrictions.json";
    /// The percolation threshold.
    PERCOLATION = "percolation" / 1, "percolation.json";
    /// The folder of the local web page.
    SERVE = "serve" / 1, "serve.json";
    /// Plan of a run.
    CHECK = "check" / 1, "voidwalk check --json";
    /// Cost of the cases of a plan.
    PLAN_CHECK = "plan-check" / 1, "voidwalk check PLAN --json";
    /// The rules of practice for two soils.
    RULES = "rules" / 1, "voidwalk rules --json";
    /// The soils of a file.
    SOILS = "soils" / 1, "voidwalk soil --json";
    /// Every setting of a scene.
    SETTINGS = "settings" / 1, "voidwalk init --json";
}

/// Beginning of every file.
#[derive(Serialize)]
struct Headed<'a, T> {
    format: String,
    voidwalk: &'static str,
    #[serde(flatten)]
    content: &'a T,
}

/// Beginning of a file being read.
#[derive(Deserialize)]
struct Beginning {
    #[serde(default)]
    format: Value,
    #[serde(default)]
    voidwalk: Value,
}

impl Format {
    /// Name, without the program's and without the number.
    pub fn name(self) -> &'static str {
        self.name
    }

    /// Writes a record in this format, as indented JSON with a final newline.
    ///
    /// # Errors
    /// A record that is not a map, or that JSON cannot hold.
    pub fn json(self, content: &impl Serialize) -> Result<String, serde_json::Error> {
        let headed = Headed { format: self.to_string(), voidwalk: env!("CARGO_PKG_VERSION"), content };
        Ok(visible_json(serde_json::to_string_pretty(&headed)?) + "\n")
    }
}

/// Escapes the hidden characters of JSON text, so that no terminal acts on them; the content is unchanged.
pub fn visible_json(text: String) -> String {
    let acts = |c: char| c != '\n' && is_hidden(c);
    if !text.contains(acts) {
        return text;
    }
    let escape = |c: char| c.encode_utf16(&mut [0; 2]).iter().map(|unit| format!("\\u{unit:04x}")).collect();
    text.chars().map(|c| if acts(c) { escape(c) } else { c.to_string() }).collect()
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "voidwalk-{}/{}", self.name, self.number)
    }
}

/// Reads a record from the text of its file.
///
/// # Errors
/// Text without a format name, in a format that this version does not read, or that is not such a record.
pub fn from_json<T: serde::de::DeserializeOwned>(text: &[u8]) -> Result<T, serde_json::Error> {
    let read = serde_json::from_slice(text);
    // Read second: if the file is not JSON, the parser's own error names the line.
    let Ok(beginning) = serde_json::from_slice::<Beginning>(text) else { return read };
    let this = concat!("this is voidwalk ", env!("CARGO_PKG_VERSION"));
    let Some(form) = beginning.format.as_str() else {
        let problem = format!("this file does not begin with the name and number of its format; {this}");
        return Err(serde_json::Error::custom(problem));
    };
    if FORMATS.iter().any(|format| format.to_string() == form) {
        return read;
    }
    let by = beginning.voidwalk.as_str().unwrap_or("of no known version");
    let name = form.strip_prefix("voidwalk-").and_then(|form| form.rsplit_once('/')).map(|(name, _)| name);
    let known = FORMATS.iter().find(|format| name == Some(format.name));
    let reads = known.map_or(String::new(), |known| format!(", which reads {known}"));
    let problem = format!("this file is in the format {form} of voidwalk {by}; {this}{reads}");
    Err(serde_json::Error::custom(problem))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Record {
        seconds: f64,
        seed: u64,
    }

    #[test]
    fn every_record_begins_with_its_form_and_the_version() {
        let record = Record { seconds: 0.1 + 0.2, seed: u64::MAX };
        let text = OUTCOME.json(&record).unwrap();
        let version = env!("CARGO_PKG_VERSION");
        let begins = format!("{{\n  \"format\": \"voidwalk-outcome/1\",\n  \"voidwalk\": \"{version}\",\n");
        assert!(text.starts_with(&begins) && text.ends_with("}\n"), "{text}");
        assert_eq!(from_json::<Record>(text.as_bytes()).unwrap(), record);
    }

    #[test]
    fn hidden_characters_of_a_record_are_escapes_and_read_back() {
        let name = "a\u{9b}\u{202e}\u{200b}\u{e0041}\n\"ü";
        let text = OUTCOME.json(&serde_json::json!({ "name": name })).unwrap();
        assert!(!text.contains(|c| c != '\n' && is_hidden(c)), "{text}");
        assert_eq!(from_json::<Value>(text.as_bytes()).unwrap()["name"], name);
    }

    #[test]
    fn a_record_of_another_form_or_of_none_is_refused() {
        let read = |begins: &str| {
            let text = format!(r#"{{{begins}"voidwalk":"9.1.0","seconds":1,"seed":2}}"#);
            from_json::<Record>(text.as_bytes()).map_err(|error| error.to_string())
        };
        assert!(read(r#""format":"voidwalk-outcome/1","#).is_ok());
        for form in ["voidwalk-outcome/2", "voidwalk-outcome/0"] {
            let error = read(&format!(r#""format":"{form}","#)).unwrap_err();
            assert!(error.contains(&format!("{form} of voidwalk 9.1.0")), "{error}");
            assert!(error.contains("reads voidwalk-outcome/1"), "{error}");
        }
        for none in ["", r#""format":1,"#, r#""format":"voidwalk-new/7","#, r#""format":"","#] {
            assert!(read(none).is_err(), "{none}");
        }
    }

    #[test]
    fn the_guide_lists_every_form() {
        let guide = include_str!("../../docs/stability.md");
        for format in FORMATS {
            let row = guide.lines().find(|line| line.starts_with(&format!("| `{format}` |")));
            assert!(row.is_some_and(|row| row.contains(&format!("`{}`", format.file))), "{format}");
        }
    }

    #[test]
    fn no_two_files_share_a_form() {
        let names: BTreeSet<&str> = FORMATS.iter().map(|format| format.name).collect();
        let files: BTreeSet<&str> = FORMATS.iter().map(|format| format.file).collect();
        assert_eq!([names.len(), files.len()], [FORMATS.len(); 2]);
    }
}
