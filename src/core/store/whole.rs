//! Whole files: one, or many that wait for the disk together.
//!
//! A file appears under its name only when it is whole: it is written beside its place, synced and renamed,
//! and the folder is synced.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::disk::{self, PartFile};
use super::error::StoreError;
use super::inside::make_folder;

/// Reads a whole file that the program wrote itself.
///
/// # Errors
/// Error of the system.
pub fn read_whole(path: &Path) -> io::Result<Vec<u8>> {
    disk::read(path)
}

/// Writes a whole file: afterwards either all of it is there, or the former content.
///
/// # Errors
/// Error of the system, with the file's path.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), StoreError> {
    write_whole_with(path, |file| file.write_all(bytes))
}

/// Writes like [`write_whole`], for content that is not in one piece.
///
/// # Errors
/// Error of the system, with the file's path.
pub fn write_whole_with(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), StoreError> {
    let mut file = Unnamed::beside(path.to_owned(), fill)?;
    file.part.sync().map_err(failed(path, "sync"))?;
    file.name(true)
}

/// Files of one folder and its subfolders. The disk takes each while the next is being made. They appear in
/// the order in which they were added, when all are there; each folder is then synced once.
///
/// If one of them cannot be written, none of the files appears.
pub struct Together {
    folder: PathBuf,
    files: Vec<Unnamed>,
}

impl Together {
    /// Starts without files, for this folder.
    pub fn in_folder(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), files: Vec::new() }
    }

    /// Adds a file by its name in the folder; a missing subfolder is made.
    ///
    /// # Errors
    /// Error of the system, with the file's path.
    pub fn add(&mut self, name: &str, bytes: &[u8]) -> Result<(), StoreError> {
        let path = self.folder.join(name);
        if folder_of(&path) != self.folder {
            make_folder(folder_of(&path))?;
        }
        let mut file = Unnamed::beside(path, |file| file.write_all(bytes))?;
        file.part.send_all().map_err(failed(&file.path, "sync"))?;
        self.files.push(file);
        Ok(())
    }

    /// Waits for the disk, then gives the files their names; the files of a folder are on the disk before the
    /// first of another folder appears.
    ///
    /// # Errors
    /// Error of the system, with the path of a file.
    pub fn finish(mut self) -> Result<(), StoreError> {
        for file in &mut self.files {
            file.part.sent().map_err(failed(&file.path, "sync"))?;
        }
        let mut files = self.files.into_iter().peekable();
        while let Some(file) = files.next() {
            let folder = folder_of(&file.path);
            let is_last = files.peek().is_none_or(|next| folder_of(&next.path) != folder);
            file.name(is_last)?;
        }
        Ok(())
    }
}

/// A written file that has no final name yet.
struct Unnamed {
    part: PartFile,
    path: PathBuf,
}

impl Unnamed {
    /// Writes the output of `fill` beside the place of the file.
    fn beside(
        path: PathBuf,
        fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<Self, StoreError> {
        let mut part = PartFile::beside(folder_of(&path)).map_err(failed(&path, "write beside the file"))?;
        fill(&mut part).map_err(failed(&path, "write"))?;
        Ok(Self { part, path })
    }

    /// Gives a file that is on the disk its name, and syncs its folder if it `is_last` of it.
    fn name(self, is_last: bool) -> Result<(), StoreError> {
        let Self { part, path } = self;
        part.rename(&path).map_err(failed(&path, "rename"))?;
        match is_last {
            true => disk::sync_folder(folder_of(&path)).map_err(failed(&path, "sync the folder")),
            false => Ok(()),
        }
    }
}

fn folder_of(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

fn failed(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> StoreError {
    let path = path.to_owned();
    move |source| StoreError::Io { path, action, source }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn files_appear_all_at_the_end_or_not_at_all() {
        let root = tempfile::tempdir().unwrap();
        let add = |files: &mut Together| {
            files.add("inside/one", b"1").unwrap();
            files.add("two", b"22").unwrap();
        };
        let mut files = Together::in_folder(root.path());
        add(&mut files);
        let shown = |name: &str| root.path().join(name).exists();
        assert!(!shown("inside/one") && !shown("two"));
        drop(files);
        assert_eq!(names(root.path()), ["inside"]);
        assert_eq!(names(&root.path().join("inside")), [""; 0]);

        let mut files = Together::in_folder(root.path());
        add(&mut files);
        files.finish().unwrap();
        assert_eq!(std::fs::read(root.path().join("inside/one")).unwrap(), b"1");
        assert_eq!(std::fs::read(root.path().join("two")).unwrap(), b"22");
        assert_eq!(names(root.path()), ["inside", "two"]);
    }

    #[test]
    fn a_name_that_cannot_be_given_leaves_those_after_it_out() {
        let root = tempfile::tempdir().unwrap();
        std::fs::create_dir_all(root.path().join("two/taken")).unwrap();
        let mut files = Together::in_folder(root.path());
        for name in ["one", "two", "three"] {
            files.add(name, b"text").unwrap();
        }
        let error = files.finish().unwrap_err();
        assert!(error.to_string().contains("two: cannot rename"), "{error}");
        assert_eq!(names(root.path()), ["one", "two"]);
    }
}
