//! Whether a record keeps to its JSON Schema: as much of the standard as the schemas of this program use.

use serde_json::Value;

/// Keys that say nothing of what is allowed.
const REMARKS: [&str; 8] =
    ["description", "title", "default", "format", "minimum", "maximum", "$defs", "$schema"];

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
        assert_eq!(schema, &Value::Bool(true), "{at}");
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
