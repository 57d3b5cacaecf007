//! The JSON Schemas of what is written, made from the types that write it.

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};
use serde_json::{Value, json};

use super::soil::Soils;
use crate::cases::PlanCheck;
use crate::constrictions::Summary;
use crate::outcome::boundary::Boundaries;
use crate::outcome::design::Specification;
use crate::outcome::ledger::{Campaign, LedgerLine};
use crate::outcome::network_walk::NetworkWalkRecord;
use crate::outcome::packing::PackingRecord;
use crate::outcome::percolation::PercolationStudy;
use crate::outcome::record::{Manifest, Outcome};
use crate::run::Check;
use crate::scene::SceneReference;
use crate::store::format::{self, Format};
use crate::verdict::{DesignedSamples, PairRules, WalkedBatch};

/// Writes the schemas anew where this variable is set.
const UPDATE: &str = "VOIDWALK_UPDATE_SCHEMAS";

/// What a form holds beside its beginning.
fn contents() -> Vec<(Format, Schema)> {
    vec![
        (format::OUTCOME, of::<Outcome>()),
        (format::MANIFEST, of::<Manifest>()),
        (format::BOUNDARY, of::<Boundaries>()),
        (format::DESIGNS, of::<DesignedSamples>()),
        (format::SPECIFICATION, of::<Specification>()),
        (format::BATCH, of::<WalkedBatch>()),
        (format::CAMPAIGN, of::<Campaign>()),
        (format::CASE, of::<LedgerLine>()),
        (format::PACKING, of::<PackingRecord>()),
        (format::CONSTRICTIONS, of::<Summary>()),
        (format::PERCOLATION, of::<PercolationStudy>()),
        (format::SERVE, of::<Nothing>()),
        (format::CHECK, of::<Check>()),
        (format::PLAN_CHECK, of::<PlanCheck>()),
        (format::RULES, of::<PairRules>()),
        (format::SOILS, of::<Soils>()),
        (format::SETTINGS, of::<SceneReference>()),
    ]
}

/// A file of which only the beginning is anybody's business.
#[derive(serde::Serialize, JsonSchema)]
struct Nothing {}

/// The schema of a type as it is written.
fn of<T: JsonSchema>() -> Schema {
    let schema = SchemaSettings::draft2020_12().for_serialize().into_generator().into_root_schema_for::<T>();
    let mut schema = schema.to_value();
    without_examples(&mut schema);
    schema.try_into().expect("still a schema")
}

/// Takes the examples in Rust, which say nothing of a file, out of all descriptions.
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
fn of_file(form: Format, content: Schema) -> Value {
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

/// Compares a schema with its file in the crate, or writes that.
fn held(name: &str, kept: &str, schema: &Value) {
    let text = serde_json::to_string_pretty(schema).unwrap() + "\n";
    let file = format!("{}/src/store/schemas/{name}.json", env!("CARGO_MANIFEST_DIR"));
    if std::env::var_os(UPDATE).is_some() {
        std::fs::write(&file, &text).unwrap();
    } else {
        assert!(
            kept == text,
            "{file} does not say what is written. A field that goes or means something else raises the \
             number of the form (src/store/format.rs). Then: {UPDATE}=1 cargo test --lib schemas, and again \
             without"
        );
    }
}

#[test]
fn the_schemas_are_those_of_what_is_written() {
    let all = contents();
    let forms: Vec<Format> = all.iter().map(|(form, _)| *form).collect();
    assert_eq!(forms, format::FORMATS);
    for (form, content) in all {
        held(form.name(), form.schema, &of_file(form, content));
    }
    // What Python's `walk` gives, whose types are made from it.
    let walk = of::<NetworkWalkRecord>().to_value();
    held("network-walk", include_str!("../store/schemas/network-walk.json"), &walk);
}
