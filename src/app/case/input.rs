//! A file that went into a case.

use std::sync::Arc;

use voidwalk_practice::InputFile;

/// A file that was read, and the name under which a run folder keeps it.
#[derive(Clone, Debug)]
pub struct Input {
    /// The setting that names it.
    pub setting: &'static str,
    /// Its path as the user gave it first: a run that continues from the files in its folder reads it there.
    pub name: String,
    /// Name inside the run folder.
    pub kept_as: String,
    /// Its bytes, which copies of a case share.
    pub bytes: Arc<Vec<u8>>,
    /// Soil to use, if the file holds several.
    pub soil: Option<String>,
    /// Assumptions made to understand it.
    pub notes: Vec<String>,
}

impl Input {
    /// Its name and its checksum.
    pub fn file(&self) -> InputFile {
        InputFile::of(&self.name, &self.bytes)
    }
}
