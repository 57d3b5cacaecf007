//! A run of seconds, and what it leaves.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// A run of seconds: a small network, few replicates.
pub const SMALL: [&str; 5] =
    ["network.nx=8", "network.ny=8", "network.nz=10", "replicates=3", "record.sensitivity=[2.0]"];

pub fn voidwalk(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_voidwalk")).args(args).output().unwrap()
}

pub fn run_small(out: &Path, more: &[&str]) -> Output {
    let out = out.to_str().unwrap();
    let mut args = vec!["run", "--out", out];
    for set in SMALL {
        args.extend(["--set", set]);
    }
    args.extend(more);
    voidwalk(&args)
}

pub fn outcome(folder: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.join("outcome.json")).unwrap()).unwrap()
}

/// The outcome without what a clock says.
pub fn without_seconds(mut value: Value) -> Value {
    fn strip(value: &mut Value) {
        match value {
            Value::Object(map) => {
                map.remove("seconds");
                map.values_mut().for_each(strip);
            }
            Value::Array(items) => items.iter_mut().for_each(strip),
            _ => {}
        }
    }
    strip(&mut value);
    value
}

pub fn refused(output: &Output, messages: &[&str]) {
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    for message in messages {
        assert!(stderr.contains(message), "{stderr:?} lacks {message:?}");
    }
}
