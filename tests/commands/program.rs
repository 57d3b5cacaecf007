//! Calls of the program, and how they end.

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::SystemTime;

use voidwalk::run::FolderKind;

use crate::schemas::records_since;

pub fn voidwalk(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_voidwalk"));
    command.current_dir(folder).args(args).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// What it wrote, if it has done what was asked, keeps to its schemas.
pub fn call(folder: &Path, args: &[&str]) -> Output {
    let begun = SystemTime::now();
    let output = voidwalk(folder, args).output().unwrap();
    if output.status.success() {
        records_since(folder, begun);
    }
    output
}

pub fn done(output: &Output) {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Every figure of a folder is on the list of those that go when its work is replaced.
pub fn figures_are_listed(kind: FolderKind, folder: &Path) {
    let figures = std::fs::read_dir(folder.join("figures")).unwrap();
    let names: Vec<String> =
        figures.map(|entry| entry.unwrap().file_name().into_string().unwrap().replace(".svg", "")).collect();
    assert!(!names.is_empty());
    for name in names {
        assert!(kind.figures().contains(&name.as_str()), "{name} is missing in src/app/run/folder.rs");
    }
}

pub fn refused(output: &Output, message: &str) {
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains(message), "{stderr:?} lacks {message:?}");
}
