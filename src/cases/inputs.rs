//! The soils that a command is given: read from their files, with what was assumed of these and with their
//! checksums.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use crate::gradation::{SoilSample, bytes_of, file_and_soil, notes_in_file, samples_in};
use crate::outcome::record::InputFile;
use crate::run::error::RunError;
use crate::run::folder::shown;

/// Every sample of a file or of the tables in a folder.
pub(crate) struct InputSamples {
    /// The samples, file by file.
    pub samples: Vec<SoilSample>,
    /// The tables, as they were named.
    files: Vec<PathBuf>,
}

impl InputSamples {
    /// Reads them, as [`samples_in`].
    ///
    /// # Errors
    /// A file that cannot be read as a table.
    pub fn read(path: &Path) -> Result<Self, RunError> {
        let samples = samples_in(path).map_err(RunError::refused)?;
        let of_samples = || files_of(samples.iter().map(|sample| sample.path.as_path()));
        let files = if path.is_dir() { of_samples() } else { vec![path.to_owned()] };
        Ok(Self { samples, files })
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

/// The files that these paths name, each once, whatever soil of it is meant.
fn files_of<'a>(paths: impl IntoIterator<Item = &'a Path>) -> Vec<PathBuf> {
    let mut read = HashSet::new();
    let files = paths.into_iter().map(|path| file_and_soil(path).0);
    files.filter(|file| read.insert(file.clone())).collect()
}

/// These files with their checksums.
///
/// # Errors
/// A file that cannot be read.
pub(crate) fn input_files<'a>(paths: impl IntoIterator<Item = &'a Path>) -> Result<Vec<InputFile>, RunError> {
    let input = |file: PathBuf| {
        let bytes = bytes_of(&file).map_err(RunError::refused)?;
        Ok(InputFile::of(file.display().to_string(), &bytes))
    };
    files_of(paths).into_iter().map(input).collect()
}
