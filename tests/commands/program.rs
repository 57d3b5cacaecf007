//! Calls of the program, and how they end.

use std::path::Path;
use std::process::{Command, Output, Stdio};

pub fn voidwalk(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_voidwalk"));
    command.current_dir(folder).args(args).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

pub fn call(folder: &Path, args: &[&str]) -> Output {
    voidwalk(folder, args).output().unwrap()
}

pub fn done(output: &Output) {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

pub fn refused(output: &Output, message: &str) {
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains(message), "{stderr:?} lacks {message:?}");
}
