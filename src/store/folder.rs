//! The run folder: one writer, and no file that is half written.
//!
//! - A folder is ours when it was empty or absent, or holds our lock file [`LOCK_FILE`] or a finished run. Anything else is
//!   not written to; neither is a folder reached through a symbolic link.
//! - The lock belongs to the process: the system releases it however the process dies. The lock file
//!   says who holds it.
//! - A file appears under its name only when it is whole: written beside it, synced, renamed, and the
//!   folder synced.

use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Name of the lock file, which marks a folder as ours.
pub const LOCK_FILE: &str = ".voidwalk.lock";

/// Why a folder cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The folder holds other things.
    #[error("{path}: this folder is not empty and was not made by voidwalk; name an empty or new one")]
    NotOurs {
        /// The folder.
        path: PathBuf,
    },
    /// The path is there, but is no folder of its own.
    #[error("{path}: is {what}; name a folder that is empty or new")]
    NotAFolder {
        /// The path.
        path: PathBuf,
        /// What it is instead.
        what: &'static str,
    },
    /// Somebody else is writing.
    #[error("{path}: another run writes to this folder ({holder})")]
    Held {
        /// The folder.
        path: PathBuf,
        /// What the lock file says.
        holder: String,
    },
    /// The system refuses.
    #[error("{path}: cannot {action}: {source}")]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was tried.
        action: &'static str,
        /// What the system says.
        source: io::Error,
    },
}

impl StoreError {
    /// Whether the user can mend it by naming another folder, before any work is done.
    pub fn is_refusal(&self) -> bool {
        use io::ErrorKind::{NotADirectory, NotFound, PermissionDenied, ReadOnlyFilesystem};
        let by_name = [NotADirectory, NotFound, PermissionDenied, ReadOnlyFilesystem];
        !matches!(self, Self::Io { source, .. } if !by_name.contains(&source.kind()))
    }
}

/// A folder that this process alone writes to, until it is dropped.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    _lock: File,
}

impl Folder {
    /// Makes the folder where it is missing, and locks it.
    ///
    /// # Errors
    /// The folder is a link, holds other things, is held by another process, or cannot be written.
    pub fn open(path: &Path) -> Result<Self, StoreError> {
        Self::open_locked(path, false)
    }

    /// The same for a folder that several processes work in, each in folders of its own inside; it is not taken while one
    /// process holds it alone.
    ///
    /// # Errors
    /// As [`Folder::open`].
    pub fn open_shared(path: &Path) -> Result<Self, StoreError> {
        Self::open_locked(path, true)
    }

    fn open_locked(path: &Path, shared: bool) -> Result<Self, StoreError> {
        // Without a trailing slash, which would follow a link.
        let path: &Path = &path.components().collect::<PathBuf>();
        let io = |action| move |source| StoreError::Io { path: path.to_owned(), action, source };
        match fs::symlink_metadata(path) {
            Ok(meta) if meta.is_symlink() => {
                return Err(StoreError::NotAFolder { path: path.to_owned(), what: "a symbolic link" });
            }
            Ok(meta) if !meta.is_dir() => {
                return Err(StoreError::NotAFolder { path: path.to_owned(), what: "a file" });
            }
            Ok(_) => {
                let is_file = |name| path.join(name).symlink_metadata().is_ok_and(|m| m.is_file());
                // In this order: a process that has just locked an empty folder leaves its mark in it.
                let empty = fs::read_dir(path).map_err(io("read the folder"))?.next().is_none();
                let marked = is_file(LOCK_FILE) || (is_file("manifest.json") && is_file("outcome.json"));
                if !marked && !empty {
                    return Err(StoreError::NotOurs { path: path.to_owned() });
                }
            }
            Err(e) if e.kind() == io::ErrorKind::NotFound => {
                fs::create_dir_all(path).map_err(io("make the folder"))?;
            }
            Err(e) => return Err(io("look at the folder")(e)),
        }
        let lock_path = path.join(LOCK_FILE);
        let mut options = File::options();
        options.read(true).write(true).create(true).truncate(false);
        // A lock file that is a link would have the file it leads to emptied.
        std::os::unix::fs::OpenOptionsExt::custom_flags(
            &mut options,
            rustix::fs::OFlags::NOFOLLOW.bits() as i32,
        );
        let mut lock = options.open(&lock_path).map_err(io("write to the folder"))?;
        match if shared { lock.try_lock_shared() } else { lock.try_lock() } {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let holder = fs::read_to_string(&lock_path).unwrap_or_default();
                let holder = holder.lines().next().unwrap_or("unknown").chars().take(200).collect();
                return Err(StoreError::Held { path: path.to_owned(), holder });
            }
            Err(TryLockError::Error(e)) => return Err(io("lock the folder")(e)),
        }
        if shared {
            return Ok(Self { path: path.to_owned(), _lock: lock });
        }
        let host = rustix::system::uname().nodename().to_string_lossy().into_owned();
        lock.set_len(0)
            .and_then(|()| writeln!(lock, "process {} on {host}", std::process::id()))
            .map_err(io("write to the folder"))?;
        Ok(Self { path: path.to_owned(), _lock: lock })
    }

    /// The folder's path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether the folder holds a file of this name.
    pub fn has(&self, name: &str) -> bool {
        self.path.join(name).symlink_metadata().is_ok()
    }

    /// What a file of the folder holds; `None` where there is none.
    ///
    /// # Errors
    /// What the system says, with the file's path.
    pub fn read(&self, name: &str) -> Result<Option<Vec<u8>>, StoreError> {
        let path = self.path.join(name);
        match fs::read(&path) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(source) => Err(StoreError::Io { path, action: "read", source }),
        }
    }

    /// Removes a file of the folder, if it is there.
    ///
    /// # Errors
    /// What the system says, with the file's path.
    pub fn remove(&self, name: &str) -> Result<(), StoreError> {
        let path = self.path.join(name);
        match fs::remove_file(&path) {
            Err(source) if source.kind() != io::ErrorKind::NotFound => {
                Err(StoreError::Io { path, action: "remove", source })
            }
            _ => Ok(()),
        }
    }

    /// Writes a whole file: either all of it is there afterwards, or what was there before.
    ///
    /// # Errors
    /// What the system says, with the file's path.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), StoreError> {
        let path = self.path.join(name);
        if let Some(folder) = path.parent().filter(|p| *p != self.path) {
            make_folder(folder)?;
        }
        write_whole(&path, bytes)
    }
}

/// Makes a folder inside one of ours, if it is not there; one reached through a link is refused.
///
/// # Errors
/// It is a link or a file, or what the system says.
pub fn make_folder(path: &Path) -> Result<(), StoreError> {
    let made = fs::create_dir_all(path);
    match path.symlink_metadata() {
        Ok(meta) if meta.is_symlink() => {
            Err(StoreError::NotAFolder { path: path.to_owned(), what: "a symbolic link" })
        }
        _ => {
            made.map_err(|source| StoreError::Io { path: path.to_owned(), action: "make the folder", source })
        }
    }
}

/// Writes a whole file beside its final name, syncs it, renames it and syncs the folder.
///
/// # Errors
/// What the system says, with the file's path.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), StoreError> {
    write_whole_with(path, |file| file.write_all(bytes))
}

/// The same for what does not lie in one piece.
///
/// # Errors
/// What the system says, with the file's path.
pub fn write_whole_with(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), StoreError> {
    let io = |action| move |source| StoreError::Io { path: path.to_owned(), action, source };
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut file = tempfile::Builder::new()
        .prefix(".voidwalk-part-")
        .tempfile_in(folder)
        .map_err(io("write beside the file"))?;
    fill(&mut file).map_err(io("write"))?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let permissions = fs::Permissions::from_mode(0o644);
        file.as_file().set_permissions(permissions).map_err(io("set permissions"))?;
    }
    file.as_file().sync_all().map_err(io("sync"))?;
    file.persist(path).map_err(|e| io("rename")(e.error))?;
    File::open(folder).and_then(|f| f.sync_all()).map_err(io("sync the folder"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_or_empty_folder_is_taken_and_can_be_taken_again() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a/b");
        for text in ["one", "two"] {
            let folder = Folder::open(&path).unwrap();
            folder.write("x.txt", text.as_bytes()).unwrap();
            assert_eq!(fs::read_to_string(path.join("x.txt")).unwrap(), text);
            assert!(folder.has("x.txt") && !folder.has("y.txt"));
        }
        assert_eq!(fs::read_dir(&path).unwrap().count(), 2);
    }

    #[test]
    fn a_second_writer_is_told_who_holds_the_folder() {
        let root = tempfile::tempdir().unwrap();
        let _first = Folder::open(root.path()).unwrap();
        let error = Folder::open(root.path()).unwrap_err();
        assert!(error.is_refusal());
        assert!(error.to_string().contains(&format!("process {} on", std::process::id())));
    }

    #[test]
    fn what_is_not_ours_is_left_alone() {
        let root = tempfile::tempdir().unwrap();
        fs::write(root.path().join("thesis.txt"), "years of work").unwrap();
        assert!(matches!(Folder::open(root.path()), Err(StoreError::NotOurs { .. })));
        assert!(matches!(
            Folder::open(&root.path().join("thesis.txt")),
            Err(StoreError::NotAFolder { what: "a file", .. })
        ));
        let link = root.path().join("link");
        std::os::unix::fs::symlink("/tmp", &link).unwrap();
        assert!(matches!(Folder::open(&link), Err(StoreError::NotAFolder { what: "a symbolic link", .. })));
        let with_slash = root.path().join("link/");
        assert!(matches!(Folder::open(&with_slash), Err(StoreError::NotAFolder { .. })));
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 2);
    }
}
