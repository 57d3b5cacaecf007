//! The soils that a command is given, read from their files; notes on these files, and their checksums.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use super::file_names::{names, refuse_twice, shared};
use crate::run::error::RunError;
use crate::run::folder::shown;
use voidwalk_core::gradation::{GradationError, bytes_of};
use voidwalk_practice::InputFile;
use voidwalk_sheets::{SoilSample, envelope_in, file_and_soil, notes_in_file, samples_in};

/// Reads the soils of a file.
type ReadSoils = fn(&Path) -> Result<Vec<SoilSample>, GradationError>;

/// Soils of files, each under a name of its own.
pub(crate) struct InputSoils {
    /// The soils, file by file.
    pub soils: Vec<SoilSample>,
    /// The tables by their names; a folder is replaced by its tables.
    files: Vec<PathBuf>,
    /// Short names of the inputs.
    pub name: String,
}

impl InputSoils {
    /// Reads every sample of files and folders, as [`samples_in`].
    ///
    /// # Errors
    /// A file that cannot be read as a table; a soil that is named twice.
    pub fn samples(paths: &[PathBuf]) -> Result<Self, RunError> {
        Self::read(paths, samples_in)
    }

    /// Reads every curve of files, as [`envelope_in`].
    ///
    /// # Errors
    /// See [`Self::samples`]; also if a path is a folder.
    pub fn envelope(paths: &[PathBuf]) -> Result<Self, RunError> {
        Self::read(paths, envelope_in)
    }

    fn read(paths: &[PathBuf], soils_in: ReadSoils) -> Result<Self, RunError> {
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

    /// Assumptions on their files and on these others, a sentence each, every file once.
    ///
    /// # Errors
    /// A file that cannot be read as a table.
    pub fn notes(&self, others: &[PathBuf]) -> Result<Vec<String>, RunError> {
        let mut read = HashSet::new();
        let mut all = Vec::new();
        for file in self.files.iter().chain(others).filter(|file| read.insert(*file)) {
            let notes = notes_in_file(file).map_err(RunError::refused)?;
            all.extend(notes.into_iter().map(|note| format!("{}: {note}", shown(file))));
        }
        Ok(all)
    }
}

/// The files of these soils, each once.
fn files_of(soils: &[SoilSample]) -> Vec<PathBuf> {
    let mut read = HashSet::new();
    let files = soils.iter().map(|soil| file_and_soil(&soil.path).0);
    files.filter(|file| read.insert(file.clone())).collect()
}

/// The files of these soils, each once, with their checksums.
///
/// # Errors
/// A file that cannot be read.
pub(crate) fn input_files(soils: &[SoilSample]) -> Result<Vec<InputFile>, RunError> {
    let input = |file: PathBuf| {
        let bytes = bytes_of(&file).map_err(RunError::refused)?;
        Ok(InputFile::of(file.display().to_string(), &bytes))
    };
    files_of(soils).into_iter().map(input).collect()
}
