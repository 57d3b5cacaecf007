//! Whole files, one at a time or many synced together, and the folders around them, inside one of ours.
//!
//! A file appears under its name only when complete: it is written beside its place, synced and renamed,
//! and the folder is synced.

use super::disk;
use super::disk::{Call, PartFile, ask};
use std::fs::Metadata;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// Writes a whole file: afterwards the file holds all of it, or its former content.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), StoreError> {
    write_whole_with(path, |file| file.write_all(bytes))
}

/// Writes like [`write_whole`], for content that is produced piece by piece.
pub(crate) fn write_whole_with(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), StoreError> {
    let mut file = Unnamed::beside(path.to_owned(), fill)?;
    file.part.sync().map_err(StoreError::io(path, "sync"))?;
    file.name(true)
}

/// Files of one folder and its subfolders. Each is synced while the next is being made. When all are
/// complete, they appear in the order in which they were added; each folder is then synced once.
///
/// If one file cannot be written, none appears.
pub struct Together {
    folder: PathBuf,
    files: Vec<Unnamed>,
}

impl Together {
    /// Starts an empty set of files for this folder.
    pub fn in_folder(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), files: Vec::new() }
    }

    /// Adds a file by its name in the folder; a missing subfolder is created.
    pub fn add(&mut self, name: &str, bytes: &[u8]) -> Result<(), StoreError> {
        let path = self.folder.join(name);
        if folder_of(&path) != self.folder {
            make_folder(folder_of(&path))?;
        }
        let mut file = Unnamed::beside(path, |file| file.write_all(bytes))?;
        file.part.send_all().map_err(StoreError::io(&file.path, "sync"))?;
        self.files.push(file);
        Ok(())
    }

    /// Waits for the disk, then names the files; the files of one folder are on the disk before the
    /// first of the next appears.
    pub fn finish(mut self) -> Result<(), StoreError> {
        for file in &mut self.files {
            file.part.sent().map_err(StoreError::io(&file.path, "sync"))?;
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

/// A written file without a final name.
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
        let mut part =
            PartFile::beside(folder_of(&path)).map_err(StoreError::io(&path, "write beside the file"))?;
        fill(&mut part).map_err(StoreError::io(&path, "write"))?;
        Ok(Self { part, path })
    }

    /// Gives a synced file its name, and syncs the folder if the file `is_last` in it.
    fn name(self, is_last: bool) -> Result<(), StoreError> {
        let Self { part, path } = self;
        part.rename(&path).map_err(StoreError::io(&path, "rename"))?;
        if !is_last {
            return Ok(());
        }
        disk::sync_folder(folder_of(&path)).map_err(StoreError::io(&path, "sync the folder"))
    }
}

fn folder_of(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// Syncs the names in a folder.
pub(super) fn sync(folder: &Path) -> Result<(), StoreError> {
    disk::sync_folder(folder).map_err(StoreError::io(folder, "sync the folder"))
}

/// Tells if a folder is empty.
pub(super) fn is_empty(folder: &Path) -> io::Result<bool> {
    ask(Call::List(folder), || Ok(fs::read_dir(folder)?.next().is_none()))
}

/// Creates a folder and its missing parents, each synced into its own parent.
pub(super) fn make_folders(path: &Path) -> io::Result<()> {
    let missing: Vec<&Path> =
        path.ancestors().take_while(|folder| !folder.as_os_str().is_empty() && !folder.exists()).collect();
    for folder in missing.into_iter().rev() {
        match ask(Call::MakeFolder(folder), || fs::create_dir(folder)) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && folder.is_dir() => {}
            other => other?,
        }
        disk::sync_folder(folder.parent().unwrap_or(Path::new("")))?;
    }
    Ok(())
}

/// Creates a folder inside one of ours, if it is missing; one reached through a link is refused.
///
/// # Errors
/// A link or a file in its place, or an error of the system.
pub fn make_folder(path: &Path) -> Result<(), StoreError> {
    match path.symlink_metadata() {
        Ok(meta) => expect_folder(path, &meta),
        Err(_) => make_folders(path).map_err(StoreError::io(path, "make the folder")),
    }
}

/// Refuses a link or a file in place of a folder.
pub(super) fn expect_folder(path: &Path, meta: &Metadata) -> Result<(), StoreError> {
    let what = if meta.is_symlink() { "a symbolic link" } else { "a file" };
    if meta.is_dir() { Ok(()) } else { Err(StoreError::NotAFolder { path: path.to_owned(), what }) }
}

/// Removes a folder with all its content, if it exists.
///
/// # Errors
/// A link in its place, or an error of the system.
pub fn remove_folder(path: &Path) -> Result<(), StoreError> {
    if path.symlink_metadata().is_ok_and(|meta| meta.is_symlink()) {
        return Err(StoreError::NotAFolder { path: path.to_owned(), what: "a symbolic link" });
    }
    match ask(Call::RemoveFolder(path), || fs::remove_dir_all(path)) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => {
            Err(StoreError::io(path, "remove")(source))
        }
        _ => Ok(()),
    }
}

/// Lists the files of a folder; empty if there is no such folder.
pub fn files_in(folder: &Path) -> Result<Vec<PathBuf>, StoreError> {
    let list = || fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>();
    match ask(Call::List(folder), list) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => {
            Err(StoreError::io(folder, "read the folder")(source))
        }
        listed => {
            let mut files = listed.unwrap_or_default();
            files.sort();
            Ok(files)
        }
    }
}

/// Reasons why a folder cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The folder holds other things.
    #[error("{path}: this folder is not empty and was not made by voidwalk; name an empty or new one")]
    NotOurs {
        /// The folder.
        path: PathBuf,
    },
    /// The path exists, but is not a real folder.
    #[error("{path}: is {what}; name a folder that is empty or new")]
    NotAFolder {
        /// The path.
        path: PathBuf,
        /// Its actual kind.
        what: &'static str,
    },
    /// The lock file's name belongs to a file that is not a lock file.
    #[error(
        "{path}: is not a voidwalk lock file: it is another name of some file, or not a file; remove it, \
         or name another folder"
    )]
    NotALock {
        /// The path.
        path: PathBuf,
    },
    /// Another process is writing.
    #[error("{path}: another run writes to this folder ({holder})")]
    Held {
        /// The folder.
        path: PathBuf,
        /// Content of the lock file.
        holder: String,
    },
    /// The system reported an error.
    #[error("{path}: cannot {action}: {source}")]
    Io {
        /// Path of the file or folder.
        path: PathBuf,
        /// Action that failed.
        action: &'static str,
        /// Error of the system.
        source: io::Error,
    },
}

impl StoreError {
    /// Makes the error of a failed action.
    pub(super) fn io(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Io { path, action, source }
    }

    /// Tells if the user can fix this by naming another folder before any work is done.
    pub fn is_refusal(&self) -> bool {
        use io::ErrorKind::{InvalidFilename, InvalidInput, NotADirectory, NotFound};
        use io::ErrorKind::{PermissionDenied, ReadOnlyFilesystem};
        // Windows reports a device name, such as NUL, as invalid input.
        let by_name =
            [InvalidFilename, InvalidInput, NotADirectory, NotFound, PermissionDenied, ReadOnlyFilesystem];
        !matches!(self, Self::Io { source, .. } if !by_name.contains(&source.kind()))
    }
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
