//! The files of soils that a study read.

use std::path::{Path, PathBuf};

use crate::gradation::{bytes_of, file_and_soil};
use crate::outcome::record::InputFile;
use crate::run::error::RunError;

/// The files that these paths name, each once, whatever soil of it is meant.
pub(crate) fn files_of<'a>(paths: impl IntoIterator<Item = &'a Path>) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = Vec::new();
    for path in paths {
        let (file, _) = file_and_soil(path);
        if !files.contains(&file) {
            files.push(file);
        }
    }
    files
}

/// The same with their checksums.
///
/// # Errors
/// A file that cannot be read.
pub(crate) fn input_files<'a>(paths: impl IntoIterator<Item = &'a Path>) -> Result<Vec<InputFile>, RunError> {
    let of = |file: PathBuf| {
        let bytes = bytes_of(&file).map_err(RunError::refused)?;
        Ok(InputFile::of(file.display().to_string(), &bytes))
    };
    files_of(paths).into_iter().map(of).collect()
}
