//! Soils given to a command, read from their files, under short names that are all different; notes on these
//! files, and their checksums.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use crate::run::RunError;
use crate::run::folder::shown;
use voidwalk_core::gradation::{GradationError, bytes_of};
use voidwalk_practice::InputFile;
use voidwalk_sheets::{SoilSample, file_and_soil, notes_in_file};

pub(crate) struct InputSoils {
    pub(crate) soils: Vec<SoilSample>,
    /// Tables, in the order in which they were named; a folder is replaced by its tables.
    files: Vec<PathBuf>,
    pub(crate) name: String,
}

impl InputSoils {
    /// Reads soils by [`samples_in`](voidwalk_sheets::samples_in), every sample in files and folders, or by
    /// [`envelope_in`](voidwalk_sheets::envelope_in), every curve in files. Errors: a file that cannot be
    /// read as a table; a soil that is named twice; for an envelope a folder.
    pub(crate) fn read(
        paths: &[PathBuf],
        soils_in: fn(&Path) -> Result<Vec<SoilSample>, GradationError>,
    ) -> Result<Self, RunError> {
        let (mut soils, mut files) = (Vec::new(), Vec::new());
        for path in paths {
            let of_path = soils_in(path).map_err(RunError::refused)?;
            files.extend(if path.is_dir() { files_of(&of_path) } else { vec![path.clone()] });
            soils.extend(of_path);
        }
        if let [path] = paths {
            return Ok(Self { soils, files, name: path.display().to_string() });
        }
        let paths_of_soils: Vec<PathBuf> = soils.iter().map(|soil| soil.path.clone()).collect();
        refuse_twice(&paths_of_soils)?;
        let alike = shared(&soils.iter().map(|soil| soil.name.clone()).collect::<Vec<_>>());
        let told_apart = names(&alike.iter().map(|&at| paths_of_soils[at].clone()).collect::<Vec<_>>());
        alike.into_iter().zip(told_apart).for_each(|(at, name)| soils[at].name = name);
        Ok(Self { soils, files, name: names(paths).join(", ") })
    }

    /// Assumptions made on these files and the others, one sentence each; every file occurs once. Errors: a
    /// file that cannot be read as a table.
    pub(crate) fn notes(&self, others: &[PathBuf]) -> Result<Vec<String>, RunError> {
        let mut read = HashSet::new();
        let mut all = Vec::new();
        for file in self.files.iter().chain(others).filter(|file| read.insert(*file)) {
            let notes = notes_in_file(file).map_err(RunError::refused)?;
            all.extend(notes.into_iter().map(|note| format!("{}: {note}", shown(file))));
        }
        Ok(all)
    }
}

fn files_of(soils: &[SoilSample]) -> Vec<PathBuf> {
    let mut read = HashSet::new();
    let files = soils.iter().map(|soil| file_and_soil(&soil.path).0);
    files.filter(|file| read.insert(file.clone())).collect()
}

/// Files of these soils, each once, with their checksums.
pub(crate) fn input_files(soils: &[SoilSample]) -> Result<Vec<InputFile>, RunError> {
    let input = |file: PathBuf| {
        let bytes = bytes_of(&file).map_err(RunError::refused)?;
        Ok(InputFile::of(file.display().to_string(), &bytes))
    };
    files_of(soils).into_iter().map(input).collect()
}

pub(crate) fn refuse_twice(files: &[PathBuf]) -> Result<(), RunError> {
    let mut seen = HashSet::new();
    match files.iter().find(|file| !seen.insert(real(file))) {
        Some(twice) => Err(RunError::Refused(format!("{} is named twice", shown(twice)))),
        None => Ok(()),
    }
}

/// Canonical path of a table's file, with the soil's name if it is given; missing files are compared by their
/// names only.
fn real(file: &Path) -> PathBuf {
    let (path, soil) = file_and_soil(file);
    let path = path.canonicalize().unwrap_or(path);
    match soil {
        Some(soil) => format!("{}#{soil}", path.display()).into(),
        None => path,
    }
}

/// Short names, all different: the file's name without its ending, with the soil's name if the file has
/// several; the whole path if two would agree, preceded by its number if even the paths agree.
pub(super) fn names(files: &[PathBuf]) -> Vec<String> {
    let mut names: Vec<String> = files.iter().map(|file| short_name(file)).collect();
    // A longer name may equal the short name of another.
    for _ in files {
        let again = shared(&names);
        again.into_iter().for_each(|at| names[at] = shown(&files[at]));
    }
    as_folders(names)
}

/// Folder names, all different; a hidden one is preceded by its number.
pub(super) fn as_folders(mut names: Vec<String>) -> Vec<String> {
    let hidden = |name: &String| name.is_empty() || name.starts_with('.');
    for (at, name) in names.iter_mut().enumerate().filter(|(_, name)| hidden(name)) {
        *name = format!("{} {name}", at + 1);
    }
    numbered(names)
}

/// Names, all different: those that occur more than once are preceded by their numbers.
pub(crate) fn numbered(mut names: Vec<String>) -> Vec<String> {
    // Names with a number in front differ from each other, so the loop ends.
    loop {
        let again = shared(&names);
        if again.is_empty() {
            return names;
        }
        again.into_iter().for_each(|at| names[at] = format!("{} {}", at + 1, names[at]));
    }
}

/// Positions of names that occur more than once; some disks do not distinguish upper from lower case.
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

    #[test]
    fn names_are_short_where_they_are_alone() {
        let named = |files: &[&str]| names(&files.iter().map(PathBuf::from).collect::<Vec<_>>());
        assert_eq!(named(&["a/f.csv", "g.csv", "s.xlsx#Filter A"]), ["f", "g", "s: Filter A"]);
        assert_eq!(named(&["a/f.csv", "b/f.csv"]), ["a/f.csv", "b/f.csv"]);
        assert_eq!(named(&["f.csv", "f.tsv", "f.csv.csv"]), ["f.csv", "f.tsv", "f.csv.csv"]);
        assert_eq!(named(&["a/F.csv", "b/f.csv"]), ["a/F.csv", "b/f.csv"]);
        assert_eq!(named(&["a/2 .f.csv", ".f"]), ["1 2 .f", "2 2 .f"]);
        // A name must not be a folder that already exists.
        assert_eq!(named(&["...csv", ".f"]), ["1 ..", "2 .f"]);
    }

    /// A name with a number in front may equal the original name of another.
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
