//! Whether records keep to their JSON Schemas: as much of the standard as the schemas of this program use.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use serde_json::Value;
use voidwalk::cli::schema;

/// Keys that say nothing of what is allowed.
const REMARKS: [&str; 8] =
    ["description", "title", "default", "format", "minimum", "maximum", "$defs", "$schema"];

/// Form and version, with which a record begins.
pub fn beginning(text: &str) -> (String, String) {
    let value: Value = serde_json::from_str(text).unwrap();
    let names: Vec<&String> = value.as_object().unwrap().keys().take(2).collect();
    assert_eq!(names, ["format", "voidwalk"], "{text:.200}");
    let [format, version] = ["format", "voidwalk"].map(|name| value[name].as_str().unwrap().to_owned());
    (format, version)
}

/// The schema that the beginning of a record names.
pub fn schema_of(text: &str) -> Value {
    let (form, _) = beginning(text);
    let name = form.trim_start_matches("voidwalk-").split('/').next().unwrap();
    serde_json::from_str(&schema(name).unwrap()).unwrap()
}

/// A record says all that its schema requires, and nothing that this does not know.
pub fn keep_to_schema(text: &str, place: &str) {
    let record: Value = serde_json::from_str(text).unwrap();
    assert_eq!(problems(&schema_of(text), &record), [""; 0], "{place} {}", record["format"]);
}

/// The JSON files in a folder and those below, but for the names of inputs, which are the program's own. No link is followed,
/// and what cannot be read is left out.
pub fn json_files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let (path, kind) = (entry.path(), entry.file_type());
        if kind.as_ref().is_ok_and(fs::FileType::is_dir) {
            found.extend(json_files(&path));
        } else if kind.is_ok_and(|kind| kind.is_file())
            && path.extension().is_some_and(|ending| ending == "json")
            && !path.ends_with("names.json")
        {
            found.push(path);
        }
    }
    found
}

/// Every record in a folder that was written since then keeps to its schema.
pub fn records_since(folder: &Path, begun: SystemTime) {
    for file in json_files(folder) {
        if fs::metadata(&file).and_then(|of| of.modified()).is_ok_and(|written| written >= begun) {
            keep_to_schema(&fs::read_to_string(&file).unwrap(), &file.display().to_string());
        }
    }
}

/// Where `value` does not keep to `schema`, or has a field that this does not know.
pub fn problems(root: &Value, value: &Value) -> Vec<String> {
    let mut found = Vec::new();
    check(root, root, value, "", &mut found);
    found
}

fn keeps(root: &Value, schema: &Value, value: &Value) -> bool {
    let mut found = Vec::new();
    check(root, schema, value, "", &mut found);
    found.is_empty()
}

fn is_of(kind: &str, value: &Value) -> bool {
    match kind {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_u64() || value.is_i64(),
        "number" => value.is_number(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        kind => panic!("no kind of value: {kind}"),
    }
}

fn check(root: &Value, schema: &Value, value: &Value, at: &str, found: &mut Vec<String>) {
    let Some(rules) = schema.as_object() else {
        if schema != &Value::Bool(true) {
            found.push(format!("{at} is not in the schema"));
        }
        return;
    };
    for (rule, says) in rules {
        let kept = match rule.as_str() {
            "$ref" => {
                let target = says.as_str().and_then(|path| root.pointer(path.strip_prefix('#')?));
                check(root, target.expect("a type that is there"), value, at, found);
                true
            }
            "const" => value == says,
            "enum" => says.as_array().unwrap().contains(value),
            "anyOf" => says.as_array().unwrap().iter().any(|one| keeps(root, one, value)),
            "oneOf" => says.as_array().unwrap().iter().filter(|one| keeps(root, one, value)).count() == 1,
            "type" => match says {
                Value::String(kind) => is_of(kind, value),
                kinds => kinds.as_array().unwrap().iter().any(|kind| is_of(kind.as_str().unwrap(), value)),
            },
            "required" => {
                let missing =
                    |name: &&Value| value.is_object() && value.get(name.as_str().unwrap()).is_none();
                let missing: Vec<&Value> = says.as_array().unwrap().iter().filter(missing).collect();
                found.extend(missing.iter().map(|name| format!("{at}: {name} is missing")));
                true
            }
            "properties" => {
                for (name, of) in value.as_object().into_iter().flatten() {
                    match says.get(name) {
                        Some(schema) => check(root, schema, of, &format!("{at}/{name}"), found),
                        None => found.push(format!("{at}: {name} is not in the schema")),
                    }
                }
                true
            }
            "additionalProperties" => {
                let free = value.as_object().into_iter().flatten();
                let free =
                    free.filter(|(name, _)| rules.get("properties").is_none_or(|p| p.get(name).is_none()));
                free.for_each(|(name, of)| check(root, says, of, &format!("{at}/{name}"), found));
                true
            }
            "items" => {
                let entries = value.as_array().into_iter().flatten().enumerate();
                entries.for_each(|(i, of)| check(root, says, of, &format!("{at}/{i}"), found));
                true
            }
            "prefixItems" => {
                let entries =
                    value.as_array().into_iter().flatten().zip(says.as_array().unwrap()).enumerate();
                entries.for_each(|(i, (of, schema))| check(root, schema, of, &format!("{at}/{i}"), found));
                true
            }
            "minItems" => value.as_array().is_none_or(|all| all.len() as u64 >= says.as_u64().unwrap()),
            "maxItems" => value.as_array().is_none_or(|all| all.len() as u64 <= says.as_u64().unwrap()),
            remark => {
                assert!(REMARKS.contains(&remark), "{at}: {remark} is not checked");
                true
            }
        };
        if !kept {
            found.push(format!("{at}: {value} is not what {rule} {says} allows"));
        }
    }
}
