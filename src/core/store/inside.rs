//! Folders inside one of ours: made, looked into, removed.

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

/// Whether nothing is in a folder.
pub(super) fn is_empty(folder: &Path) -> io::Result<bool> {
    ask(Call::List(folder), || Ok(fs::read_dir(folder)?.next().is_none()))
}

/// Makes a folder and those above it that are missing, each synced into the one that it is in.
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

/// Makes a folder inside one of ours, if it is not there; one reached through a link is refused.
///
/// # Errors
/// It is a link or a file, or what the system says.
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

/// Removes a folder with all that is in it, if it is there.
///
/// # Errors
/// It is a link, which somebody has laid there; or what the system says.
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

/// The files of a folder; none where there is no such folder.
///
/// # Errors
/// What the system says.
pub fn files_in(folder: &Path) -> Result<Vec<PathBuf>, StoreError> {
    let list = || fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>();
    match ask(Call::List(folder), list) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => {
            Err(StoreError::Io { path: folder.to_owned(), action: "read the folder", source })
        }
        found => {
            let mut files = found.unwrap_or_default();
            files.sort();
            Ok(files)
        }
    }
}
