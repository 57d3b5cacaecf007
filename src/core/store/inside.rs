//! Folders inside one of ours: makes, reads and removes them.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::disk::{self, Call, ask};
use super::error::StoreError;

/// Sends the names in a folder to the disk.
pub(super) fn sync(folder: &Path) -> Result<(), StoreError> {
    disk::sync_folder(folder).map_err(|source| StoreError::Io {
        path: folder.to_owned(),
        action: "sync the folder",
        source,
    })
}

/// Tells if a folder is empty.
pub(super) fn is_empty(folder: &Path) -> io::Result<bool> {
    ask(Call::List(folder), || Ok(fs::read_dir(folder)?.next().is_none()))
}

/// Makes a folder and its missing parents, each synced into its own parent.
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

/// Makes a folder inside one of ours, if it is missing; one reached through a link is refused.
///
/// # Errors
/// A link or a file in its place, or an error of the system.
pub fn make_folder(path: &Path) -> Result<(), StoreError> {
    let not = |what| Err(StoreError::NotAFolder { path: path.to_owned(), what });
    match path.symlink_metadata() {
        Ok(meta) if meta.is_symlink() => not("a symbolic link"),
        Ok(meta) if !meta.is_dir() => not("a file"),
        Ok(_) => Ok(()),
        Err(_) => make_folders(path).map_err(|source| StoreError::Io {
            path: path.to_owned(),
            action: "make the folder",
            source,
        }),
    }
}

/// Removes a folder with all its content, if it exists.
///
/// # Errors
/// A link that somebody has put in its place, or an error of the system.
pub fn remove_folder(path: &Path) -> Result<(), StoreError> {
    if path.symlink_metadata().is_ok_and(|meta| meta.is_symlink()) {
        return Err(StoreError::NotAFolder { path: path.to_owned(), what: "a symbolic link" });
    }
    match ask(Call::RemoveFolder(path), || fs::remove_dir_all(path)) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => {
            Err(StoreError::Io { path: path.to_owned(), action: "remove", source })
        }
        _ => Ok(()),
    }
}

/// Lists the files of a folder; empty if there is no such folder.
///
/// # Errors
/// Error of the system.
pub fn files_in(folder: &Path) -> Result<Vec<PathBuf>, StoreError> {
    let list = || fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>();
    match ask(Call::List(folder), list) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => {
            Err(StoreError::Io { path: folder.to_owned(), action: "read the folder", source })
        }
        listed => {
            let mut files = listed.unwrap_or_default();
            files.sort();
            Ok(files)
        }
    }
}
