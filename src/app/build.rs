//! Notes the commit that the program is built from, for the manifest of a run.

use std::process::Command;

fn main() {
    let git = |args: &[&str]| {
        let output = Command::new("git").args(args).output().ok().filter(|o| o.status.success())?;
        String::from_utf8(output.stdout).ok().map(|text| text.trim().to_string())
    };
    // A packed crate says what it was packed from; a repository around it is somebody else's.
    if let Ok(packed) = std::fs::read_to_string(".cargo_vcs_info.json") {
        let commit = packed.split("\"sha1\": \"").nth(1).and_then(|rest| rest.get(..12));
        commit.iter().for_each(|commit| println!("cargo::rustc-env=VOIDWALK_COMMIT={commit}"));
    } else {
        if let Some(commit) = git(&["rev-parse", "--short=12", "HEAD"]) {
            println!("cargo::rustc-env=VOIDWALK_COMMIT={commit}");
        }
        if let Some(folder) = git(&["rev-parse", "--absolute-git-dir"]) {
            println!("cargo::rerun-if-changed={folder}/logs/HEAD");
        }
    }
    println!("cargo::rerun-if-changed=build.rs");
}
