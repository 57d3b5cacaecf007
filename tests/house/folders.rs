//! The folders beside the code: an index names what is there, and a path that a text names leads somewhere.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// What tools leave behind, and what is made anew as a whole.
const LEFT_BEHIND: [&str; 6] = ["__pycache__", ".mypy_cache", ".pytest_cache", "target", ".git", "corpus"];

/// Every file below a folder, in order.
fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        let name = path.file_name().unwrap().to_string_lossy();
        if path.is_dir() && !LEFT_BEHIND.contains(&&*name) {
            files(&path, found);
        } else if path.is_file() {
            found.push(path);
        }
    }
}

/// The published crate has neither results nor most scripts.
fn is_the_repository() -> bool {
    Path::new(".ci").exists()
}

/// Names at the beginning of the lines of an index, as `- [NAME](...)` or `` - `NAME`: ... ``.
fn indexed(text: &str) -> BTreeSet<String> {
    let lines = text.lines().filter_map(|line| line.strip_prefix("- `"));
    lines.filter_map(|line| Some(line.split_once('`')?.0.to_owned())).collect()
}

/// What is missing in the index of a folder, and what it names that is not there. A name that ends in `/` stands for all
/// below it.
fn differences(folder: &str) -> Vec<String> {
    let index = Path::new(folder).join("README.md");
    let names = indexed(&fs::read_to_string(&index).unwrap());
    assert!(names.len() > 10, "{}: {} names seen", index.display(), names.len());
    let mut found = Vec::new();
    files(Path::new(folder), &mut found);
    let mut wrong: Vec<String> = names
        .iter()
        .filter(|name| !Path::new(folder).join(name).exists())
        .map(|name| format!("{} names {name}, which is not there", index.display()))
        .collect();
    for path in found.iter().filter(|path| **path != index) {
        let inside = path.strip_prefix(folder).unwrap().to_string_lossy().replace('\\', "/");
        let is_below = |name: &String| name.ends_with('/') && inside.starts_with(name.as_str());
        if !names.contains(&inside) && !names.iter().any(is_below) {
            wrong.push(format!("{} does not name {inside}", index.display()));
        }
    }
    wrong
}

#[test]
fn every_script_and_every_result_stands_in_its_index() {
    if is_the_repository() {
        let wrong = [differences("scripts"), differences("results")].concat();
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }
}

/// Paths into `scripts` and `results` that a text names, without what stands for any name (`DATE`, `*`) and
/// what an earlier commit holds (`scripts/a.py` of 7a45e404).
fn named(text: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for folder in ["scripts/", "results/"] {
        for (at, _) in text.match_indices(folder) {
            let before = text[..at].chars().next_back();
            if before.is_some_and(|c| c.is_alphanumeric() || "_-.$".contains(c))
                || before == Some('/') && !text[..at].ends_with("../")
            {
                continue;
            }
            let is_of_path = |c: char| c.is_ascii_alphanumeric() || "_./-".contains(c);
            let end = text[at..].find(|c| !is_of_path(c)).map_or(text.len(), |length| at + length);
            let is_pattern =
                text[end..].starts_with(['*', '{', '$', '<', '(', '%']) || text[at..end].contains("DATE");
            let path = text[at..end].trim_end_matches('.');
            let is_of_a_commit = text[end..]
                .strip_prefix("` of ")
                .is_some_and(|commit| commit.chars().take_while(char::is_ascii_hexdigit).count() >= 7);
            if !is_pattern && !is_of_a_commit && path.len() > folder.len() {
                found.insert(path.to_owned());
            }
        }
    }
    found
}

#[test]
fn the_reader_of_paths_leaves_out_patterns() {
    let text = "`scripts/a.sh`, see results/b.md, `scripts/g.py` of 7a45e404. results/c-*.md, my-scripts/d, scripts/e-DATE.md, (scripts/f/)";
    let expected = ["results/b.md", "scripts/a.sh", "scripts/f/"];
    assert_eq!(named(text), expected.map(String::from).into());
}

/// `results/paper` is written by a program at a commit, and says where it was then.
#[test]
fn every_script_and_result_that_a_text_names_is_there() {
    if !is_the_repository() {
        return;
    }
    let mut found: Vec<PathBuf> =
        ["README.md", "CONTRIBUTING.md", "Cargo.toml", "pyproject.toml", "deny.toml"]
            .map(PathBuf::from)
            .into();
    for folder in [".ci", ".github", "benches", "results", "scripts", "src", "tests"] {
        files(Path::new(folder), &mut found);
    }
    // What a command makes is named and not there.
    let made = fs::read_to_string(".gitignore").unwrap();
    let is_made = |name: &str| made.lines().any(|line| line.strip_prefix('/') == Some(name));
    let (mut seen, mut wrong) = (0, Vec::new());
    for path in found {
        if path.starts_with("results/paper") || path.ends_with("house/folders.rs") {
            continue;
        }
        let Ok(text) = fs::read_to_string(&path) else { continue };
        for name in named(&text) {
            seen += 1;
            // The book calls a folder's page `index.md`; a program may be given a page's name without its end.
            let places = [name.clone(), name.replace("/index.md", "/README.md"), format!("{name}.md")];
            if !is_made(&name) && !places.iter().any(|place| Path::new(place).exists()) {
                wrong.push(format!("{} names {name}, which is not there", path.display()));
            }
        }
    }
    assert!(seen > 150, "{seen} paths seen");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
