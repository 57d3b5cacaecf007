//! The digest of the numbers of a record, by which two runs are compared.

use serde::Serialize;
use serde_json::Value;
use xxhash_rust::xxh3::Xxh3;

/// Fields that are not results.
const LEFT_OUT: [&str; 2] = ["seconds", "studies_to_come"];

/// Digest of every number, `true`, `false` and `null` of a record: XXH3 of one line `PLACE=VALUE` each, 128
/// bits in hexadecimal. Fields are sorted by name, so their order in the file does not matter. Text is left
/// out (names, sentences, classes that follow from the numbers, version), and so are wall times (`seconds`)
/// and the progress of a run (`studies_to_come`).
///
/// ```
/// use serde_json::json;
/// use voidwalk_app::outcome::digest::digest;
/// let of_run = digest(&json!({ "eroded": 0.25, "engine": "counts", "seconds": 3.5 }))?;
/// assert_eq!(of_run, digest(&json!({ "seconds": 7.1, "engine": "particles", "eroded": 0.25 }))?);
/// assert_ne!(of_run, digest(&json!({ "eroded": 0.5, "engine": "counts", "seconds": 3.5 }))?);
/// # Ok::<(), serde_json::Error>(())
/// ```
///
/// # Errors
/// A record that JSON cannot hold.
pub fn digest(record: &impl Serialize) -> Result<String, serde_json::Error> {
    let mut hash = Xxh3::new();
    add(&mut hash, "", &serde_json::to_value(record)?);
    Ok(format!("{:032x}", hash.digest128()))
}

fn add(hash: &mut Xxh3, place: &str, value: &Value) {
    match value {
        Value::Object(fields) => {
            let mut results: Vec<_> =
                fields.iter().filter(|(name, _)| !LEFT_OUT.contains(&name.as_str())).collect();
            results.sort_by_key(|(name, _)| *name);
            results.iter().for_each(|(name, value)| add(hash, &format!("{place}.{name}"), value));
        }
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(at, item)| add(hash, &format!("{place}[{at}]"), item));
        }
        Value::String(_) => {}
        Value::Null | Value::Bool(_) | Value::Number(_) => {
            hash.update(format!("{place}={value}\n").as_bytes());
        }
    }
}
