//! Short names of the tables that a study is given, no two the same.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use crate::run::error::RunError;
use crate::run::folder::shown;
use voidwalk_sheets::file_and_soil;

/// Refuses a table that is named twice.
///
/// # Errors
/// The table that is named twice.
pub(crate) fn refuse_twice(files: &[PathBuf]) -> Result<(), RunError> {
    let mut seen = HashSet::new();
    match files.iter().find(|file| !seen.insert(real(file))) {
        Some(twice) => Err(RunError::Refused(format!("{} is named twice", shown(twice)))),
        None => Ok(()),
    }
}

/// A table's file as the disk knows it, with the soil's name if it is given; missing files are told apart by
/// their names alone.
fn real(file: &Path) -> PathBuf {
    let (path, soil) = file_and_soil(file);
    let path = path.canonicalize().unwrap_or(path);
    match soil {
        Some(soil) => format!("{}#{soil}", path.display()).into(),
        None => path,
    }
}

/// Short names, all different: the file's name without its ending, with the soil's if it is one of several;
/// the whole path if two would agree, with its number in front if even the paths agree.
pub(super) fn names(files: &[PathBuf]) -> Vec<String> {
    let mut names: Vec<String> = files.iter().map(|file| short_name(file)).collect();
    // A longer name can be another's short one.
    for _ in files {
        let again = shared(&names);
        again.into_iter().for_each(|at| names[at] = shown(&files[at]));
    }
    as_folders(names)
}

/// Names of folders, no two the same: a hidden one has its number in front.
pub(super) fn as_folders(mut names: Vec<String>) -> Vec<String> {
    let hidden = |name: &String| name.is_empty() || name.starts_with('.');
    for (at, name) in names.iter_mut().enumerate().filter(|(_, name)| hidden(name)) {
        *name = format!("{} {name}", at + 1);
    }
    numbered(names)
}

/// Names, no two the same: those that are not alone have their number in front.
pub(crate) fn numbered(mut names: Vec<String>) -> Vec<String> {
    // Those with a number in front differ from each other: this ends.
    loop {
        let again = shared(&names);
        if again.is_empty() {
            return names;
        }
        again.into_iter().for_each(|at| names[at] = format!("{} {}", at + 1, names[at]));
    }
}

/// Positions of names that occur more than once; some disks do not tell upper from lower case.
pub(super) fn shared(names: &[String]) -> Vec<usize> {
    let lower: Vec<String> = names.iter().map(|name| name.to_lowercase()).collect();
    (0..names.len()).filter(|&at| lower.iter().filter(|name| **name == lower[at]).count() > 1).collect()
}

fn short_name(file: &Path) -> String {
    let (path, soil) = file_and_soil(file);
    let stem = path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
    match soil {
        None => stem,
        Some(soil) => format!("{stem}: {soil}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(files: &[&str]) -> Vec<String> {
        names(&files.iter().map(PathBuf::from).collect::<Vec<_>>())
    }

    #[test]
    fn names_are_short_where_they_are_alone() {
        assert_eq!(named(&["a/f.csv", "g.csv", "s.xlsx#Filter A"]), ["f", "g", "s: Filter A"]);
        assert_eq!(named(&["a/f.csv", "b/f.csv"]), ["a/f.csv", "b/f.csv"]);
        assert_eq!(named(&["f.csv", "f.tsv", "f.csv.csv"]), ["f.csv", "f.tsv", "f.csv.csv"]);
        assert_eq!(named(&["a/F.csv", "b/f.csv"]), ["a/F.csv", "b/f.csv"]);
        assert_eq!(named(&["a/2 .f.csv", ".f"]), ["1 2 .f", "2 2 .f"]);
        // No name may be a folder that exists already.
        assert_eq!(named(&["...csv", ".f"]), ["1 ..", "2 .f"]);
    }

    /// A name with a number in front can be another's own.
    #[test]
    fn numbered_names_are_all_different() {
        let folders = |names: &[&str]| as_folders(names.iter().map(ToString::to_string).collect());
        assert_eq!(folders(&["A", "a", "B"]), ["1 A", "2 a", "B"]);
        assert_eq!(folders(&["A", "A", "1 A"]), ["1 1 A", "2 A", "3 1 A"]);
        assert_eq!(folders(&[".A", "B", ""]), ["1 .A", "B", "3 "]);
    }

    #[test]
    fn two_soils_of_a_file_are_two_and_one_is_not() {
        let two = ["f.csv#A", "f.csv#B"].map(PathBuf::from);
        assert!(refuse_twice(&two).is_ok());
        assert!(refuse_twice(&["f.csv", "f.csv"].map(PathBuf::from)).is_err());
    }
}
