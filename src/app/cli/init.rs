//! Commands `voidwalk init` and `examples`: the built-in scene, the plan of a campaign and example files to
//! start from; and the JSON Schemas of the files that are written, made from the types that write them.

use super::print::{as_it_is, shown, to_copy, to_stdout};
use crate::cases::{CasePlan, PlanCheck};
use crate::outcome::Recorded;
use crate::outcome::boundary::{Boundaries, WalkRow};
use crate::outcome::ledger::{Campaign, LedgerLine};
use crate::outcome::packing::PackingRecord;
use crate::outcome::percolation::PercolationStudy;
use crate::outcome::record::{Manifest, NetworkWalkRecord, Outcome};
use crate::run::{Check, EXAMPLE_FILES, RunError, write_examples, write_new};
use crate::scene::{Scene, SceneReference};
use crate::verdict::WalkedBatch;
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};
use serde::Serialize;
use serde_json::{Value, json};
use std::path::Path;
use voidwalk_core::constrictions::Summary;
use voidwalk_core::store::format;
use voidwalk_core::store::format::Format;
use voidwalk_practice::design::Specification;
use voidwalk_practice::{DesignedSamples, PairRules};
use voidwalk_sheets::SoilSummary;

pub(crate) fn init(
    path: Option<&Path>,
    plan: bool,
    as_json: bool,
    schema: Option<String>,
) -> Result<(), RunError> {
    if let Some(schema) = schema {
        to_stdout(&schema);
        return Ok(());
    }
    if as_json {
        as_it_is(&format::SETTINGS.json(&Scene::reference())?);
        return Ok(());
    }
    let Some(path) = path else {
        to_stdout(&if plan { CasePlan::INIT_TEXT.to_owned() } else { Scene::init_text() });
        return Ok(());
    };
    if plan {
        write_new(path, CasePlan::INIT_TEXT.as_bytes())?;
    } else {
        write_new(path, Scene::init_text().as_bytes())?;
    }
    to_stdout(&format!("{}\n", shown(path)));
    Ok(())
}

/// Commands to try with the files, from within their folder: each a command line and its effect.
const TO_TRY: [[&str; 2]; 9] = [
    ["voidwalk soil us-sieves.csv", "what is read from a sheet"],
    ["voidwalk rules base.csv filter.csv", "every rule of practice"],
    ["voidwalk rules borrow-area.ags filter-fine.csv filter.csv --each", "many samples, two filters"],
    ["voidwalk judge base.csv filter.csv --quick", "rules and walk, and a page"],
    ["voidwalk judge base.csv filter-fine.csv filter.csv --quick", "two filters, in one table"],
    ["voidwalk design base.csv", "the specification of a filter for it"],
    ["voidwalk run scene.toml --out scene", "the scene"],
    ["voidwalk campaign plan.toml", "the plan"],
    ["jupyter notebook notebook.ipynb", "with the Python packages voidwalk and matplotlib"],
];

pub(crate) fn examples(folder: &Path) -> Result<(), RunError> {
    write_examples(folder)?;
    let files = EXAMPLE_FILES.iter().map(|file| format!("{:<18}{}\n", file.name, file.what));
    let lines = TO_TRY.map(|[line, what]| format!("  {line:<68}  {what}\n"));
    let folder = to_copy(folder);
    to_stdout(&format!("{}\nTo try:\n\n  cd {folder}\n{}", files.collect::<String>(), lines.concat()));
    Ok(())
}

type Made = fn() -> Schema;

const CONTENTS: &[(Format, Made)] = &[
    (format::OUTCOME, schema_of::<Outcome>),
    (format::MANIFEST, schema_of::<Manifest>),
    (format::BOUNDARY, schema_of::<Boundaries>),
    (format::DESIGNS, schema_of::<DesignedSamples>),
    (format::SPECIFICATION, schema_of::<Specification>),
    (format::BATCH, schema_of::<WalkedBatch>),
    (format::CAMPAIGN, schema_of::<Campaign>),
    (format::CASE, schema_of::<LedgerLine>),
    (format::PACKING, schema_of::<PackingRecord>),
    (format::CONSTRICTIONS, schema_of::<Summary>),
    (format::PERCOLATION, schema_of::<PercolationStudy>),
    (format::SERVE, schema_of::<Nothing>),
    (format::CHECK, schema_of::<Check>),
    (format::PLAN_CHECK, schema_of::<PlanCheck>),
    (format::RULES, schema_of::<PairRules>),
    (format::SOILS, schema_of::<Soils>),
    (format::SETTINGS, schema_of::<SceneReference>),
];
/// Types that Python returns but no file holds, because Python makes them from their schemas.
const OF_PYTHON: &[(&str, Made)] =
    &[("network-walk", schema_of::<NetworkWalkRecord>), ("columns", schema_of::<Tables>)];

/// JSON Schema of a file, by the name of its format, such as `outcome`: indented, with a newline at its end.
pub fn schema(name: &str) -> Option<String> {
    let content = CONTENTS.iter().find(|(form, _)| form.name() == name);
    let of_file = content.map(|(form, content)| headed(*form, content()));
    let of_python = || OF_PYTHON.iter().find(|(form, _)| *form == name);
    let schema = of_file.or_else(|| of_python().map(|(_, content)| content().to_value()))?;
    Some(serde_json::to_string_pretty(&schema).expect("JSON of a map") + "\n")
}

/// The soils of a file.
#[derive(Serialize, JsonSchema)]
pub(super) struct Soils {
    /// Each soil, in the order of the file.
    pub(super) soils: Vec<SoilSummary>,
}

/// The tables whose columns Python gives.
#[derive(Serialize, JsonSchema)]
struct Tables {
    run: Recorded,
    boundary: Vec<WalkRow>,
}

/// File whose contents after the beginning are internal.
#[derive(Serialize, JsonSchema)]
struct Nothing {}

fn schema_of<T: JsonSchema>() -> Schema {
    let schema = SchemaSettings::draft2020_12().for_serialize().into_generator().into_root_schema_for::<T>();
    let mut schema = schema.to_value();
    without_examples(&mut schema);
    schema.try_into().expect("still a schema")
}

/// Removes Rust examples, which do not describe a file, from all descriptions.
fn without_examples(schema: &mut Value) {
    match schema {
        Value::Object(fields) => {
            if let Some(Value::String(text)) = fields.get_mut("description") {
                text.truncate(text.find("\n\n```").unwrap_or(text.len()));
            }
            fields.values_mut().for_each(without_examples);
        }
        Value::Array(items) => items.iter_mut().for_each(without_examples),
        _ => {}
    }
}

fn headed(form: Format, content: Schema) -> Value {
    let mut schema = content.to_value();
    let about = schema.as_object_mut().expect("a schema is a map");
    let mut properties = json!({
        "format": {"description": "The form of this file.", "const": form.to_string()},
        "voidwalk": {"description": "Version of the program that wrote it.", "type": "string"},
    });
    let of_content = about.entry("properties").or_insert_with(|| json!({}));
    let fields = properties.as_object_mut().expect("a map");
    fields.extend(of_content.as_object().expect("properties are a map").clone());
    *of_content = properties;
    let required = about.entry("required").or_insert_with(|| json!([]));
    let names = required.as_array().expect("a list").iter().cloned();
    *required = [json!("format"), json!("voidwalk")].into_iter().chain(names).collect();
    about.insert("title".into(), json!(form.file));
    schema
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::help::command;
    use xxhash_rust::xxh3::xxh3_64;

    #[test]
    fn what_is_to_try_is_understood_and_names_files_that_are_written() {
        for [line, _] in TO_TRY {
            let mut words = line.split_whitespace();
            if words.clone().next() == Some("voidwalk") {
                let read = command().try_get_matches_from(words.clone());
                assert!(read.is_ok(), "{line}: {}", read.unwrap_err());
            }
            let is_file = |word: &&str| word.contains('.') && !word.starts_with('-');
            for word in words.by_ref().filter(is_file) {
                assert!(EXAMPLE_FILES.iter().any(|file| file.name == word), "{line}: {word}");
            }
        }
    }

    /// Variable that makes the test write the lines anew.
    const UPDATE: &str = "VOIDWALK_UPDATE_SCHEMAS";
    /// File with a line per record: its format, and a hash of its schema.
    const KEPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/cli/schemas.txt");

    #[test]
    fn no_schemas_change_unnoticed() {
        let forms: Vec<Format> = CONTENTS.iter().map(|(form, _)| *form).collect();
        assert_eq!(forms, format::FORMATS);
        let files = forms.iter().map(|form| (form.to_string(), schema(form.name())));
        let all = files.chain(OF_PYTHON.iter().map(|(name, _)| (name.to_string(), schema(name))));
        let lines: Vec<String> = all
            .map(|(form, schema)| format!("{form} {:016x}", xxh3_64(schema.unwrap().as_bytes())))
            .collect();
        if std::env::var_os(UPDATE).is_some() {
            return std::fs::write(KEPT, lines.join("\n") + "\n").unwrap();
        }
        let kept = std::fs::read_to_string(KEPT).unwrap();
        let kept: Vec<&str> = kept.lines().collect();
        let changed: Vec<&String> = lines.iter().filter(|line| !kept.contains(&line.as_str())).collect();
        assert!(
            changed.is_empty() && lines.len() == kept.len(),
            "the schemas of these are not those that {KEPT} notes: {changed:?}. A field that goes or means \
             something else raises the number of its form (src/core/store/format.rs); a new one \
             raises nothing. Then: {UPDATE}=1 cargo test --workspace --lib schemas"
        );
    }
}
