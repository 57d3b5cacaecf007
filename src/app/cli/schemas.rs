//! The JSON Schemas of the files that are written, made from the types that write them.

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};
use serde::Serialize;
use serde_json::{Value, json};

use crate::cases::PlanCheck;
use crate::outcome::Recorded;
use crate::outcome::boundary::{Boundaries, WalkRow};
use crate::outcome::ledger::{Campaign, LedgerLine};
use crate::outcome::network_walk::NetworkWalkRecord;
use crate::outcome::packing::PackingRecord;
use crate::outcome::percolation::PercolationStudy;
use crate::outcome::record::{Manifest, Outcome};
use crate::run::Check;
use crate::scene::SceneReference;
use crate::verdict::WalkedBatch;
use voidwalk_core::constrictions::Summary;
use voidwalk_core::store::format::{self, Format};
use voidwalk_practice::design::Specification;
use voidwalk_practice::{DesignedSamples, PairRules};
use voidwalk_sheets::SoilSummary;

/// Makes the schema of a type.
type Made = fn() -> Schema;

/// Contents of each form after its beginning.
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
/// Types that Python gives but no file holds: they are made from their schemas.
const OF_PYTHON: &[(&str, Made)] =
    &[("network-walk", schema_of::<NetworkWalkRecord>), ("columns", schema_of::<Tables>)];

/// The JSON Schema of a file, by the name of its form, as `outcome`: indented, with a newline at its end.
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

/// A file of which only the beginning is anybody's business.
#[derive(Serialize, JsonSchema)]
struct Nothing {}

/// The schema of a type as it is written.
fn schema_of<T: JsonSchema>() -> Schema {
    let schema = SchemaSettings::draft2020_12().for_serialize().into_generator().into_root_schema_for::<T>();
    let mut schema = schema.to_value();
    without_examples(&mut schema);
    schema.try_into().expect("still a schema")
}

/// Removes the examples in Rust, which do not describe a file, from all descriptions.
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

/// The schema of a file, its beginning included.
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
    use xxhash_rust::xxh3::xxh3_64;

    use super::*;

    /// Variable that makes the test write the lines again.
    const UPDATE: &str = "VOIDWALK_UPDATE_SCHEMAS";
    /// A line a record: its form, and a hash of its schema.
    const KEPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/cli/schemas.txt");

    #[test]
    fn no_record_changes_unnoticed() {
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
