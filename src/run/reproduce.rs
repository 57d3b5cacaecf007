//! Walks a finished run again from the scene and inputs that its folder keeps, and compares every number.
//!
//! Compared are `outcome.json`, every CSV file, and the seed and the checksums of the inputs in
//! `manifest.json`: numbers, yes and no, and the words that are results. Times, host, paths, sentences, pages
//! and figures are not: two runs take different times, and sentences are worded anew from the same numbers.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::path::Path;

use serde::Serialize;
use serde_json::Value;

use super::callbacks::Callbacks;
use super::error::{Exit, RunError};
use super::folder::{FolderKind, shown};
use super::walk::{RunOptions, walk_scene};
use crate::scene::Scene;
use crate::store::format::from_json;
use crate::store::{StoreError, read_whole};

/// Differences that are named; the others are counted.
const NAMED: usize = 10;

/// Strings with these names are results, all others words about them.
const RESULTS: [&str; 10] = [
    "verdict",
    "confidence",
    "engine",
    "kind",
    "direction",
    "weight",
    "xxh3",
    "foster_fell",
    "origin",
    "law",
];

/// The names of the files whose numbers are compared besides CSV files.
const OUTCOME: &str = "outcome.json";
const MANIFEST: &str = "manifest.json";

/// What became of a run that was walked again.
#[derive(Clone, Debug, Default, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Reproduced {
    /// Whether all that was compared is the same.
    pub same: bool,
    /// The files.
    pub files: Vec<String>,
    /// Values that were compared.
    pub values: u64,
    /// How many of them differ, with those that are in one folder alone.
    pub different: u64,
    /// The first of those.
    pub differences: Vec<Difference>,
    /// The version that made the folder, with its commit where known.
    pub made_by: String,
    /// The version that walked again.
    pub again_by: String,
}

/// A value that is not the same.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Difference {
    /// The file.
    pub file: String,
    /// Where in it: the path of a value, the line and column of a cell; empty for the whole file.
    pub place: String,
    /// What the folder says.
    pub kept: String,
    /// What was walked now.
    pub again: String,
}

/// Walks the run of a folder again, in a temporary folder beside it that is removed, and compares.
/// [`RunOptions::out`] and [`RunOptions::overwrite`] say nothing.
///
/// # Errors
/// A folder that holds no finished run, or that nothing can be written beside; then as [`walk_scene`].
pub fn reproduce(folder: &Path, options: &RunOptions, callbacks: &Callbacks) -> Result<Reproduced, RunError> {
    check_kind(folder)?;
    let io = |source| StoreError::Io { path: folder.to_owned(), action: "read", source };
    let whole = folder.canonicalize().map_err(io)?;
    let beside = whole.parent().unwrap_or(&whole);
    let place = tempfile::Builder::new().prefix(".voidwalk-reproduce-").tempdir_in(beside);
    let place = place.map_err(|error| {
        RunError::Refused(format!("{}: no folder can be made beside the run: {error}", shown(beside)))
    })?;
    let mut options = RunOptions { out: Some(place.path().join("run")), overwrite: false, ..options.clone() };
    // What was packed is kept as a curve; nothing is packed again.
    options.prepare.packings = place.path().join("packings");
    let scene = Scene::read(&folder.join("scene.toml"), &[])?;
    // No page is compared.
    let callbacks = Callbacks { on_results: &|_, _| Ok(()), ..*callbacks };
    let run = walk_scene(scene, &options, &callbacks).map_err(|error| match error.exit() {
        Exit::Stopped => RunError::Stopped("nothing of it is kept; the same command begins again".into()),
        _ => error,
    })?;
    compare(folder, &run.folder)
}

/// Refuses what is no finished run.
fn check_kind(folder: &Path) -> Result<(), RunError> {
    let refuse = |problem: String| Err(RunError::Refused(format!("{}: {problem}", shown(folder))));
    match FolderKind::of(folder) {
        Some(FolderKind::Run) if !FolderKind::Run.is_finished(folder)? => {
            refuse("this run is not finished; continue it with voidwalk resume".into())
        }
        Some(FolderKind::Run) => Ok(()),
        Some(FolderKind::Campaign | FolderKind::Comparison | FolderKind::Batch) => refuse(
            "holds several cases; name the folder of one of them: each case is a run of its own".into(),
        ),
        Some(other) => refuse(format!(
            "holds a {}, which is not reproduced; name the folder of a run: of voidwalk judge or run",
            other.name()
        )),
        None => {
            refuse(format!("holds no {OUTCOME}; name the folder of a finished run: of voidwalk judge or run"))
        }
    }
}

/// Compares the files of two run folders.
fn compare(kept: &Path, again: &Path) -> Result<Reproduced, RunError> {
    let mut found = Reproduced::default();
    let mut names: Vec<String> = vec![OUTCOME.into(), MANIFEST.into()];
    names.extend(csv_files(kept)?.union(&csv_files(again)?).cloned());
    for name in names {
        let [left, right] = [kept.join(&name), again.join(&name)];
        match (left.is_file(), right.is_file()) {
            (true, true) => {}
            (there, _) => {
                let said = |there| if there { "the file" } else { "no such file" };
                found.differ(&name, "", said(there), said(!there));
                continue;
            }
        }
        match name.ends_with(".csv") {
            true => found.compare_csv(&name, &read(&left)?, &read(&right)?),
            false => {
                let [left, right] = [record(&left)?, record(&right)?];
                if name == MANIFEST {
                    (found.made_by, found.again_by) = (made_by(&left), made_by(&right));
                    for part in ["seed", "inputs"] {
                        found.compare_json(&name, part, part, Some(&left[part]), Some(&right[part]));
                    }
                } else {
                    found.compare_json(&name, "", "", Some(&left), Some(&right));
                }
            }
        }
        found.files.push(name);
    }
    found.same = found.different == 0;
    Ok(found)
}

/// The names of the CSV files of a folder.
fn csv_files(folder: &Path) -> Result<BTreeSet<String>, RunError> {
    let io = |source| StoreError::Io { path: folder.to_owned(), action: "read", source };
    let entries = std::fs::read_dir(folder).map_err(io)?;
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|path| is_csv(path));
    Ok(paths.filter_map(|path| Some(path.file_name()?.to_str()?.to_owned())).collect())
}

fn is_csv(path: &Path) -> bool {
    path.extension() == Some(OsStr::new("csv")) && path.is_file()
}

fn read(path: &Path) -> Result<Vec<u8>, RunError> {
    let io = |source| StoreError::Io { path: path.to_owned(), action: "read", source };
    Ok(read_whole(path).map_err(io)?)
}

fn record(path: &Path) -> Result<Value, RunError> {
    from_json(&read(path)?).map_err(|error| RunError::Refused(format!("{}: {error}", shown(path))))
}

/// The program that a manifest names.
fn made_by(manifest: &Value) -> String {
    let version = manifest["version"].as_str().unwrap_or("of no known version");
    manifest["commit"].as_str().map_or(version.into(), |commit| format!("{version} ({commit})"))
}

/// Whether a value or column of this name is a time, or worked out from one, or who wrote the file.
fn is_left_out(name: &str) -> bool {
    ["seconds", "merit"].iter().any(|time| name.contains(time)) || ["format", "voidwalk"].contains(&name)
}

impl Reproduced {
    fn differ(&mut self, file: &str, place: &str, kept: &str, again: &str) {
        self.different += 1;
        if self.differences.len() < NAMED {
            let [file, place, kept, again] = [file, place, kept, again].map(String::from);
            self.differences.push(Difference { file, place, kept, again });
        }
    }

    /// Compares two values that stand at this place under this name; a list gives its name to its items.
    fn compare_json(
        &mut self,
        file: &str,
        place: &str,
        name: &str,
        kept: Option<&Value>,
        again: Option<&Value>,
    ) {
        match (kept, again) {
            (Some(Value::Object(left)), Some(Value::Object(right))) => {
                let only_again = right.keys().filter(|key| !left.contains_key(*key));
                for key in left.keys().chain(only_again).filter(|key| !is_left_out(key)) {
                    let place = if place.is_empty() { key.clone() } else { format!("{place}.{key}") };
                    self.compare_json(file, &place, key, left.get(key), right.get(key));
                }
            }
            (Some(Value::Array(left)), Some(Value::Array(right))) => {
                for at in 0..left.len().max(right.len()) {
                    self.compare_json(file, &format!("{place}[{at}]"), name, left.get(at), right.get(at));
                }
            }
            (Some(Value::String(_)), Some(Value::String(_))) if !RESULTS.contains(&name) => {}
            _ => {
                self.values += 1;
                if kept != again {
                    let said =
                        |value: Option<&Value>| value.map_or_else(|| "nothing".into(), Value::to_string);
                    self.differ(file, place, &said(kept), &said(again));
                }
            }
        }
    }

    /// Compares two tables, cell by cell.
    fn compare_csv(&mut self, file: &str, kept: &[u8], again: &[u8]) {
        let rows = |text: &[u8]| -> Vec<csv::ByteRecord> {
            let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text);
            reader.byte_records().map_while(Result::ok).collect()
        };
        let (left, right) = (rows(kept), rows(again));
        let text = |cell: Option<&[u8]>| {
            cell.map_or_else(|| "nothing".into(), |cell| String::from_utf8_lossy(cell).into_owned())
        };
        let header = left.first().cloned().unwrap_or_default();
        for at in 0..left.len().max(right.len()) {
            let (Some(one), Some(other)) = (left.get(at), right.get(at)) else {
                let said = |row: Option<&csv::ByteRecord>| if row.is_some() { "the line" } else { "nothing" };
                self.differ(file, &format!("line {}", at + 1), said(left.get(at)), said(right.get(at)));
                continue;
            };
            for column in 0..one.len().max(other.len()) {
                let name = text(header.get(column));
                if at > 0 && is_left_out(&name) {
                    continue;
                }
                self.values += 1;
                if one.get(column) != other.get(column) {
                    let place = format!("line {}, {name}", at + 1);
                    self.differ(file, &place, &text(one.get(column)), &text(other.get(column)));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn numbers_and_results_are_compared_and_times_and_sentences_are_not() {
        let kept = json!({
            "format": "voidwalk-outcome/1", "verdict": "no erosion", "reasons": ["as it was worded"],
            "seconds": 1.5, "summary": [{"mean": 0.25, "sd": null}], "old": 7,
        });
        let again = json!({
            "format": "voidwalk-outcome/2", "verdict": "some erosion", "reasons": ["as it is worded"],
            "seconds": 2.5, "summary": [{"mean": 0.250_000_000_000_000_06, "sd": null}, {"mean": 1}],
        });
        let mut found = Reproduced::default();
        found.compare_json(OUTCOME, "", "", Some(&kept), Some(&again));
        let places: Vec<&str> = found.differences.iter().map(|of| of.place.as_str()).collect();
        assert_eq!(places, ["verdict", "summary[0].mean", "summary[1]", "old"]);
        assert_eq!((found.values, found.different), (5, 4));
        let mean = &found.differences[1];
        assert_eq!([mean.kept.as_str(), &mean.again], ["0.25", "0.25000000000000006"]);
        assert_eq!(found.differences[3].again, "nothing");
        let mut same = Reproduced::default();
        same.compare_json(OUTCOME, "", "", Some(&kept), Some(&kept));
        assert_eq!((same.values, same.different), (4, 0));
    }

    #[test]
    fn cells_are_named_by_line_and_column() {
        let mut found = Reproduced::default();
        let [kept, again] = ["a,seconds\n1,2\n3,4\n", "a,seconds\n1,9\n5,4\n7,7\n"];
        found.compare_csv("series.csv", kept.as_bytes(), again.as_bytes());
        let said: Vec<[&str; 3]> =
            found.differences.iter().map(|of| [of.place.as_str(), &of.kept, &of.again]).collect();
        assert_eq!(said, [["line 3, a", "3", "5"], ["line 4", "nothing", "the line"]]);
        assert_eq!(found.values, 4);
    }

    #[test]
    fn many_differences_are_counted_and_the_first_named() {
        let mut found = Reproduced::default();
        let row = |digit: &str| [digit; 30].join(",");
        found.compare_csv("a.csv", row("1").as_bytes(), row("2").as_bytes());
        assert_eq!((found.different, found.differences.len()), (30, NAMED));
    }
}
