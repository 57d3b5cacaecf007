//! The house: data flows one way between rooms, no two files lean on each other, one name is one thing.
//!
//! The tests read the source as text: rooms and files by `use` lines and paths, without the code of tests. They would miss an
//! arrow that only a macro writes.

#[path = "house/folders.rs"]
mod folders;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The rooms in the order in which data flows; a room uses only those before it.
const ORDER: [&str; 23] = [
    "text",
    "stream",
    "store",
    "schema",
    "gradation",
    "packing",
    "constrictions",
    "network",
    "walk",
    "sheets",
    "practice",
    "outcome",
    "verdict",
    "words",
    "scene",
    "case",
    "run",
    "cases",
    "study",
    "report",
    "serve",
    "cli",
    "docs",
];

/// Rustfmt wraps code at this width (`rustfmt.toml`), but neither comments nor strings.
const WIDTH: usize = 110;

/// A file of the library.
struct Source {
    /// `src/walk/kernel/mod.rs`.
    path: PathBuf,
    /// `walk::kernel`.
    module: String,
    /// Its code, without comments and tests.
    code: String,
}

/// Every file of the library that is not a test.
fn sources() -> Vec<Source> {
    let mut found = Vec::new();
    collect(Path::new("src"), &mut found);
    let tests: BTreeSet<PathBuf> = found.iter().flat_map(test_files).collect();
    for source in &mut found {
        source.code = paths_from_one_root(&code(&fs::read_to_string(&source.path).unwrap()), &source.module);
    }
    found.retain(|source| !tests.contains(&source.path));
    assert!(found.len() > 150, "the tests read the code: {} files seen", found.len());
    found
}

/// Code with the paths of the four crates as those of one: `voidwalk_core::walk` and, within the core,
/// `crate::walk` are the same room.
fn paths_from_one_root(code: &str, module: &str) -> String {
    let own = match room(module) {
        name @ ("sheets" | "practice") => code.replace("crate::", &format!("crate::{name}::")),
        _ => code.to_owned(),
    };
    let own = own.replace("voidwalk_core::", "crate::").replace("voidwalk_sheets::", "crate::sheets::");
    own.replace("voidwalk_practice::", "crate::practice::").replace("voidwalk_app::", "crate::")
}

fn collect(folder: &Path, found: &mut Vec<Source>) {
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            collect(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            let inside = path.strip_prefix("src").unwrap().with_extension("");
            let mut parts: Vec<String> = inside
                .iter()
                .map(|part| part.to_string_lossy().into_owned())
                .filter(|part| part != "mod")
                .collect();
            match parts[0].as_str() {
                "core" | "app" => drop(parts.remove(0)),
                "sheets" | "practice" if parts[1] == "lib" => parts.truncate(1),
                _ => {}
            }
            found.push(Source { module: parts.join("::"), code: String::new(), path });
        }
    }
}

/// Files that this one declares as tests: `#[cfg(test)] mod tests;`.
fn test_files(source: &Source) -> Vec<PathBuf> {
    let text = fs::read_to_string(&source.path).unwrap();
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let folder = match source.path.file_name().unwrap().to_str().unwrap() {
        "mod.rs" | "lib.rs" => source.path.parent().unwrap().to_owned(),
        _ => source.path.with_extension(""),
    };
    let declared = lines.windows(2).filter(|pair| pair[0] == "#[cfg(test)]");
    declared
        .filter_map(|pair| pair[1].strip_prefix("mod ")?.strip_suffix(';'))
        .map(|name| folder.join(format!("{name}.rs")))
        .collect()
}

/// The code of a file: no comments, and nothing that `#[cfg(test)]` stands before.
fn code(text: &str) -> String {
    let mut kept = String::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if line.trim() == "#[cfg(test)]" {
            // The item ends with the line on which as many brackets are closed as were opened.
            let (mut open, mut begun) = (0i64, false);
            for line in lines.by_ref() {
                open += line.matches('{').count() as i64 - line.matches('}').count() as i64;
                begun |= line.contains('{') || line.contains(';');
                if begun && open <= 0 {
                    break;
                }
            }
        } else if !line.trim_start().starts_with("//") {
            kept.push_str(line);
            kept.push('\n');
        }
    }
    kept
}

fn room(module: &str) -> &str {
    module.split("::").next().unwrap()
}

#[test]
fn the_reader_of_code_leaves_out_tests_and_comments() {
    let text = "use a;\n#[cfg(test)]\nmod tests;\nuse b;\n// c\n#[cfg(test)]\nmod more {\n    use d;\n    fn f() {}\n}\nuse e;\n";
    assert_eq!(code(text), "use a;\nuse b;\nuse e;\n");
}

#[test]
fn no_arrow_between_rooms_turns_back() {
    let mut arrows = 0;
    for source in sources() {
        let Some(place) = ORDER.iter().position(|name| *name == room(&source.module)) else {
            assert!(
                ["lib", "main", "build"].contains(&source.module.as_str()),
                "{} has no room",
                source.path.display()
            );
            continue;
        };
        for (at, _) in source.code.match_indices("crate::") {
            let name: String = source.code[at + 7..].chars().take_while(|c| is_of_name(*c)).collect();
            let Some(used) = ORDER.iter().position(|room| *room == name) else { continue };
            arrows += 1;
            assert!(used <= place, "{} uses {name}, which comes after it", source.path.display());
        }
    }
    assert!(arrows > 200, "{arrows} arrows seen");
}

fn is_of_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// `walk` knows the network and the base soil; `report` reads results and runs nothing (`sheets` names the sieves).
#[test]
fn walk_and_report_know_what_they_may() {
    for source in sources() {
        let may: &[&str] = match room(&source.module) {
            "walk" => &["stream", "store", "schema", "gradation", "network", "walk"],
            "report" => &["sheets", "practice", "outcome", "verdict", "words", "store", "text", "report"],
            _ => continue,
        };
        for name in ORDER.iter().filter(|name| !may.contains(name)) {
            let arrow = format!("crate::{name}::");
            assert!(!source.code.contains(&arrow), "{} uses {name}", source.path.display());
        }
    }
}

/// What one system alone has stands in `src/core/store/platform`, each system's in its own files; so a file that
/// is written today compiles on the systems that nobody tries it on.
#[test]
fn only_the_platform_names_a_system() {
    let places: [(&str, &[&str]); 9] = [
        ("std::os::unix", &["unix"]),
        ("std::os::linux", &[]),
        ("std::os::windows", &["windows"]),
        ("rustix", &["unix", "linux", "macos"]),
        ("libc::", &["process"]),
        ("windows_sys", &["windows"]),
        ("signal_hook", &["process"]),
        ("\"/proc", &["linux", "process"]),
        ("\"/dev/", &[]),
    ];
    let mut seen = 0;
    for source in sources() {
        let file = source.module.strip_prefix("store::platform::");
        for (name, files) in places {
            let is_used = source.code.contains(name);
            seen += usize::from(is_used);
            let may = file.is_some_and(|file| files.contains(&file));
            assert!(!is_used || may, "{} uses {name}", source.path.display());
        }
        let asks = ["target_os", "cfg(unix", "cfg(windows", "cfg(not(unix", "cfg(not(windows"];
        let is_platform = source.module.starts_with("store::platform");
        for cfg in asks.into_iter().filter(|_| !is_platform) {
            assert!(!source.code.contains(cfg), "{} asks for the system", source.path.display());
        }
    }
    assert!(seen >= 8, "{seen} files name a system");
}

/// Columns are named where a table is described, never where it is written. Graphs, packings and networks have
/// readers of their own, whose form their module states.
#[test]
fn a_table_is_written_from_its_description() {
    let is_name =
        |part: &str| !part.is_empty() && part.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let is_header = |text: &str| {
        let names = || text.trim_end_matches("\\n").split(',');
        names().count() > 2 && names().all(is_name) && names().any(|name| name.ends_with("_mm"))
    };
    let (mut writers, mut headers) = (Vec::new(), Vec::new());
    for source in sources() {
        if source.code.contains("csv::Writer") || source.code.contains("write_record") {
            writers.push(source.path.clone());
        }
        if source.code.split('"').any(is_header) {
            headers.push(source.path);
        }
    }
    assert_eq!(writers, [Path::new("src/app/outcome/table.rs")]);
    headers.sort();
    let own = ["src/core/constrictions/graph.rs", "src/core/network/file.rs", "src/core/packing/mod.rs"];
    assert_eq!(headers, own.map(Path::new));
}

#[test]
fn only_the_command_line_prints() {
    for source in sources().iter().filter(|source| !["cli", "build"].contains(&room(&source.module))) {
        for print in ["println!", "eprint", "print!("] {
            assert!(!source.code.contains(print), "{} prints", source.path.display());
        }
    }
}

/// Stands for the word `as` in a path whose blanks are gone: `at_least` holds these letters, too.
const AS: &str = "=";

/// Names that a file imports: the module that the path names, and the last name.
fn imports(source: &Source, modules: &BTreeSet<&str>) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let mut rest = source.code.as_str();
    while let Some(at) = rest.find("use ") {
        let line = rest[..at].rsplit('\n').next().unwrap_or_default().trim_start();
        let begins_a_line = line.is_empty() || line == "pub " || line.starts_with("pub(");
        rest = &rest[at + 4..];
        let Some(end) = rest.find(';') else { break };
        if begins_a_line {
            let words = rest[..end].split_whitespace().map(|word| if word == "as" { AS } else { word });
            let path: String = words.collect();
            expand(&absolute(&path, &source.module, modules), &mut found);
        }
    }
    found
}

/// A path from the crate's root; empty for another crate's.
fn absolute(path: &str, module: &str, modules: &BTreeSet<&str>) -> String {
    let mut here: Vec<&str> = module.split("::").collect();
    let child = format!("{module}::{}", path.split("::").next().unwrap_or(path));
    if modules.contains(child.as_str()) {
        return format!("{module}::{path}");
    }
    if let Some(inside) = path.strip_prefix("crate::") {
        return inside.to_owned();
    }
    if let Some(inside) = path.strip_prefix("self::") {
        return format!("{module}::{inside}");
    }
    let mut rest = path;
    while let Some(inside) = rest.strip_prefix("super::") {
        here.pop();
        rest = inside;
    }
    if rest.len() == path.len() { String::new() } else { [here.join("::").as_str(), rest].join("::") }
}

/// Splits `a::{b, c::{d}}` into its names.
fn expand(path: &str, found: &mut Vec<(String, String)>) {
    if path.is_empty() {
        return;
    }
    if let Some((before, inside)) = path.split_once('{') {
        let inside = inside.strip_suffix('}').unwrap_or(inside);
        let (mut depth, mut from) = (0, 0);
        for (at, c) in inside.char_indices().chain([(inside.len(), ',')]) {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 0 => {
                    expand(&format!("{before}{}", &inside[from..at]), found);
                    from = at + 1;
                }
                _ => {}
            }
        }
        return;
    }
    if let Some((module, name)) = path.rsplit_once("::") {
        let name = name.split(AS).next().unwrap_or(name);
        match name {
            "self" => expand(module, found),
            "" | "*" => {}
            name => found.push((module.trim_start_matches("::").to_owned(), name.to_owned())),
        }
    }
}

/// Names that a file defines at its top level.
fn defined(code: &str) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for line in code.lines().filter(|line| !line.starts_with(char::is_whitespace)) {
        let line = line.strip_prefix("pub").map_or(line, |rest| match rest.strip_prefix('(') {
            Some(inside) => inside.split_once(')').map_or(rest, |(_, rest)| rest),
            None => rest,
        });
        let mut words = line.split_whitespace().filter(|word| {
            !["const", "unsafe", "async"].contains(word)
                || line.trim_start().starts_with("const ") && !line.contains("const fn") && *word == "const"
        });
        let kind = words.next().unwrap_or_default();
        if ["fn", "struct", "enum", "trait", "type", "const", "static", "macro_rules!", "union"]
            .contains(&kind)
        {
            let name: String =
                words.next().unwrap_or_default().chars().take_while(|c| is_of_name(*c)).collect();
            names.insert(name);
        }
    }
    names
}

fn is_reexport(line: &str) -> bool {
    line.starts_with("pub use") || line.starts_with("pub(crate) use")
}

/// Files that use names of each file: re-exports are followed to the definition of a name.
fn arrows(sources: &[Source]) -> BTreeMap<usize, BTreeSet<usize>> {
    let by_module: BTreeMap<&str, usize> =
        sources.iter().enumerate().map(|(index, source)| (source.module.as_str(), index)).collect();
    let defined: Vec<BTreeSet<String>> = sources.iter().map(|source| defined(&source.code)).collect();
    let modules: BTreeSet<&str> = by_module.keys().copied().collect();
    let imports: Vec<Vec<(String, String)>> =
        sources.iter().map(|source| imports(source, &modules)).collect();
    let home = |module: &str, name: &str| -> Option<usize> {
        let (mut module, mut name) = (module.to_owned(), name.to_owned());
        for _ in 0..6 {
            if let Some(&file) = by_module.get(format!("{module}::{name}").as_str()) {
                return Some(file);
            }
            let &file = by_module.get(module.as_str())?;
            if defined[file].contains(&name) {
                return Some(file);
            }
            let (next_module, next) = imports[file].iter().find(|(_, other)| *other == name)?.clone();
            (module, name) = (next_module, next);
        }
        None
    };
    let mut arrows: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    for (index, source) in sources.iter().enumerate() {
        let body: String =
            source.code.lines().filter(|line| !is_reexport(line)).flat_map(|line| [line, "\n"]).collect();
        for (module, name) in &imports[index] {
            let is_used =
                body.matches(name.as_str()).count() > usize::from(body.contains(&format!("use {name}")));
            if let Some(file) = home(module, name).filter(|&file| file != index && is_used) {
                // A re-export that the file itself does not use is no arrow of its own.
                let reexported =
                    source.code.lines().any(|line| is_reexport(line) && line.contains(name.as_str()));
                if !reexported || body.contains(name.as_str()) {
                    arrows.entry(index).or_default().insert(file);
                }
            }
        }
        // Paths written out: `child::name`.
        for (other, target) in sources.iter().enumerate() {
            let Some((parent, child)) = target.module.rsplit_once("::") else { continue };
            if parent == source.module && other != index {
                let path = format!("{child}::");
                let is_path = |at: usize| !body[..at].ends_with(|c: char| is_of_name(c) || c == ':');
                if body.match_indices(&path).any(|(at, _)| is_path(at)) {
                    arrows.entry(index).or_default().insert(other);
                }
            }
        }
    }
    arrows
}

/// A path and a name of each way to import, as the files of the library write them.
#[test]
fn the_reader_of_imports_sees_every_way_to_write_them() {
    let code = "use super::studies::replicates_at_least;\npub use child::{Case, Base as Other};\n\
                pub(super) use crate::a::d::{self, b::C};\nuse rayon::prelude::*;\n    fn not_here() {}\n";
    let source = Source { path: "src/run/x.rs".into(), module: "run::x".into(), code: code.into() };
    let found = imports(&source, &["run", "run::x", "run::x::child", "run::studies", "a"].into());
    let names: Vec<String> = found.iter().map(|(module, name)| format!("{module}::{name}")).collect();
    let expected = [
        "run::studies::replicates_at_least",
        "run::x::child::Case",
        "run::x::child::Base",
        "a::d",
        "a::d::b::C",
    ];
    assert_eq!(names.iter().map(|n| n.trim_start_matches("::")).collect::<Vec<_>>(), expected);
    assert!(!defined(code).contains("not_here"));
}

#[test]
fn no_two_files_lean_on_each_other() {
    let sources = sources();
    let arrows = arrows(&sources);
    let count: usize = arrows.values().map(BTreeSet::len).sum();
    assert!(count > 300, "{count} arrows between files seen");
    let reach = |from: usize| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
        while let Some(file) = open.pop() {
            for &next in arrows.get(&file).into_iter().flatten() {
                if seen.insert(next) {
                    open.push(next);
                }
            }
        }
        seen
    };
    let reached: Vec<BTreeSet<usize>> = (0..sources.len()).map(reach).collect();
    let mut circles = BTreeSet::new();
    for (one, others) in reached.iter().enumerate().filter(|(one, others)| others.contains(one)) {
        let circle: Vec<&str> = others
            .iter()
            .filter(|&&other| reached[other].contains(&one))
            .map(|&other| sources[other].path.to_str().unwrap())
            .collect();
        circles.insert(circle.join(" <-> "));
    }
    assert!(circles.is_empty(), "{}", circles.into_iter().collect::<Vec<_>>().join("\n"));
}

#[test]
fn a_public_type_name_is_defined_once() {
    let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for source in sources() {
        for line in source.code.lines() {
            let mut words = line.split_whitespace();
            let is_type = words.next() == Some("pub")
                && words.next().is_some_and(|kind| ["struct", "enum", "trait", "type"].contains(&kind));
            if is_type && !line.starts_with("        ") {
                let name = words.next().unwrap_or_default().chars().take_while(|c| is_of_name(*c)).collect();
                places.entry(name).or_default().push(source.path.display().to_string());
            }
        }
    }
    assert!(places.len() > 100, "{} types seen", places.len());
    let twice: Vec<String> = places
        .into_iter()
        .filter(|(name, places)| !name.is_empty() && places.len() > 1)
        .map(|(name, places)| format!("{name}: {}", places.join(", ")))
        .collect();
    assert!(twice.is_empty(), "{}", twice.join("\n"));
}

#[test]
fn no_line_is_wider_than_the_form_asks_for() {
    let mut wide = Vec::new();
    let mut found = Vec::new();
    collect(Path::new("src"), &mut found);
    for source in found {
        let text = fs::read_to_string(&source.path).unwrap();
        let lines = text.lines().enumerate().filter(|(_, line)| line.chars().count() > WIDTH);
        wide.extend(lines.map(|(at, _)| format!("{}:{}", source.path.display(), at + 1)));
    }
    assert!(wide.is_empty(), "{} lines\n{}", wide.len(), wide.join("\n"));
}

#[test]
fn the_readme_shows_the_example_of_the_front_page() {
    let between = |text: &str, fence: &str| {
        let (_, rest) = text.split_once(fence).unwrap();
        rest.split_once("```").unwrap().0.to_owned()
    };
    let library = fs::read_to_string("src/lib.rs").unwrap();
    let documented: String = library
        .lines()
        .filter_map(|line| line.strip_prefix("//!"))
        .map(|line| format!("{}\n", line.strip_prefix(' ').unwrap_or(line)))
        .filter(|line| !line.starts_with("# "))
        .collect();
    let readme = fs::read_to_string("README.md").unwrap();
    assert_eq!(between(&readme, "```rust\n"), between(&documented, "```\n"));
}
