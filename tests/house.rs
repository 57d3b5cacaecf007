//! The house: data flows one way, and no file holds two things.

use std::fs;
use std::path::{Path, PathBuf};

/// The modules in the order in which data flows; a module uses only those before it.
const ORDER: [&str; 15] = [
    "stream",
    "store",
    "gradation",
    "packing",
    "constrictions",
    "network",
    "walk",
    "outcome",
    "scene",
    "case",
    "run",
    "campaign",
    "study",
    "report",
    "cli",
];

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => sources(&path, found),
            false if path.extension().is_some_and(|e| e == "rs") => found.push(path),
            false => {}
        }
    }
}

fn module_of(path: &Path) -> String {
    let first = path.strip_prefix("src").unwrap().components().next().unwrap();
    first.as_os_str().to_string_lossy().trim_end_matches(".rs").to_string()
}

#[test]
fn no_arrow_turns_back() {
    let mut files = Vec::new();
    sources(Path::new("src"), &mut files);
    let mut arrows = 0;
    for file in files {
        let module = module_of(&file);
        let Some(place) = ORDER.iter().position(|m| *m == module) else {
            assert!(["lib", "main"].contains(&module.as_str()), "{module} has no place in the order");
            continue;
        };
        let text = fs::read_to_string(&file).unwrap();
        let text = text.split("#[cfg(test)]").next().unwrap();
        for (at, _) in text.match_indices("crate::") {
            let rest = &text[at + 7..];
            let name: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            let Some(used) = ORDER.iter().position(|m| *m == name) else { continue };
            arrows += 1;
            assert!(used <= place, "{}: {module} uses {name}, which comes after it", file.display());
        }
    }
    assert!(arrows > 20, "the test reads the code: {arrows} arrows seen");
}

/// `walk` knows the network and the base soil; `report` reads results and runs nothing.
#[test]
fn walk_and_report_know_what_they_may() {
    let mut files = Vec::new();
    sources(Path::new("src/walk"), &mut files);
    sources(Path::new("src/report"), &mut files);
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        let text = text.split("#[cfg(test)]").next().unwrap();
        let forbidden: &[&str] = match module_of(&file).as_str() {
            "walk" => &["packing", "constrictions"],
            _ => &[
                "gradation",
                "packing",
                "constrictions",
                "network",
                "walk",
                "scene",
                "case",
                "run",
                "campaign",
                "study",
            ],
        };
        for name in forbidden {
            let arrow = format!("crate::{name}");
            assert!(!text.contains(&arrow), "{} uses {name}", file.display());
        }
    }
}

#[test]
fn only_the_command_line_prints() {
    let mut files = Vec::new();
    sources(Path::new("src"), &mut files);
    for file in files.iter().filter(|f| module_of(f) != "cli") {
        let text = fs::read_to_string(file).unwrap();
        for print in ["println!", "eprint", "print!("] {
            let found = text.lines().any(|l| l.contains(print) && !l.trim_start().starts_with("//"));
            assert!(!found, "{} prints", file.display());
        }
    }
}
