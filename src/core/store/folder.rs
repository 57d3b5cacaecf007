//! The run folder: one writer, and no file that is half written.
//!
//! - A folder is ours if it was empty or absent, or holds our lock file [`LOCK_FILE`] or a finished run. Any
//!   other folder is not written to; neither is a folder reached through a symbolic link.
//! - The lock belongs to the process: the system releases it however the process dies. The lock file names
//!   its holder.
//! - A file appears under its name only when it is whole: written beside it, synced, renamed, and the folder
//!   synced. A new folder is synced into its parent.
//! - Incomplete files of a killed process are removed when their folder is next taken by one process alone.

use std::fs::{self, File, TryLockError};
use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::disk::{self, Call, PART, ask};
use super::error::StoreError;
use super::inside::{is_empty, make_folder, make_folders, remove_folder, sync};
use super::platform;
use super::whole::write_whole;

/// Name of the lock file, which marks a folder as ours.
pub const LOCK_FILE: &str = ".voidwalk.lock";

/// Time during which a shared folder is asked for: another process may hold it alone while it clears up.
const ASK_FOR: Duration = Duration::from_millis(500);

/// Time within which a process signs the lock file after locking a folder.
const SIGNS_WITHIN: Duration = Duration::from_millis(200);

/// A folder that this process alone writes to, until it is dropped.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    _lock: Lock,
}

impl AsRef<Path> for Folder {
    fn as_ref(&self) -> &Path {
        self.path()
    }
}

impl Folder {
    /// Makes the folder if it is missing, and locks it.
    ///
    /// # Errors
    /// The folder is a link, holds other things, is held by another process, or cannot be written.
    pub fn open(path: &Path) -> Result<Self, StoreError> {
        Self::open_locked(path, false)
    }

    /// Opens a folder like [`Folder::open`], for several processes that each work in folders of their own
    /// inside; it is not taken while one process holds it alone.
    ///
    /// # Errors
    /// Errors of [`Folder::open`].
    pub fn open_shared(path: &Path) -> Result<Self, StoreError> {
        Self::open_locked(path, true)
    }

    fn open_locked(path: &Path, shared: bool) -> Result<Self, StoreError> {
        #[cfg(feature = "process")]
        platform::signals::save_first();
        // Without a trailing slash, which would follow a link.
        let path: &Path = &path.components().collect::<PathBuf>();
        let io = |action| move |source| StoreError::Io { path: path.to_owned(), action, source };
        let mut marked = false;
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
                let empty = is_empty(path).map_err(io("read the folder"))?;
                marked = is_file(LOCK_FILE) || (is_file("manifest.json") && is_file("outcome.json"));
                if !marked && !empty {
                    return Err(StoreError::NotOurs { path: path.to_owned() });
                }
            }
            Err(e) if e.kind() == io::ErrorKind::NotFound => {
                make_folders(path).map_err(io("make the folder"))?
            }
            Err(e) => return Err(io("look at the folder")(e)),
        }
        let lock_path = path.join(LOCK_FILE);
        let lock = match shared {
            false => lock(&lock_path, false)?,
            true => share(&lock_path)?,
        };
        if !marked {
            // Without this, a power failure could leave a folder with other files but without this mark.
            disk::sync_folder(path).map_err(io("sync the folder"))?;
        }
        if !shared {
            let holder = format!("process {} on {}\n", std::process::id(), platform::host_name());
            ask(Call::Sign(&lock_path, holder.as_bytes()), || {
                let mut file = &lock.0;
                file.set_len(0)?;
                file.rewind()?;
                file.write_all(holder.as_bytes())
            })
            .map_err(io("write to the folder"))?;
            clear_parts(path).map_err(io("clear up the folder"))?;
        }
        Ok(Self { path: path.to_owned(), _lock: lock })
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Tells if the folder holds a file of this name.
    pub fn has(&self, name: &str) -> bool {
        self.path.join(name).symlink_metadata().is_ok()
    }

    /// Reads a file of the folder; `None` if it is missing.
    ///
    /// # Errors
    /// Error of the system, with the file's path.
    pub fn read(&self, name: &str) -> Result<Option<Vec<u8>>, StoreError> {
        let path = self.path.join(name);
        match disk::read(&path) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(source) => Err(StoreError::Io { path, action: "read", source }),
        }
    }

    /// Removes a file of the folder, if it is there.
    ///
    /// # Errors
    /// Error of the system, with the file's path.
    pub fn remove(&self, name: &str) -> Result<(), StoreError> {
        let path = self.path.join(name);
        match ask(Call::Remove(&path), || fs::remove_file(&path)) {
            Err(source) if source.kind() != io::ErrorKind::NotFound => {
                Err(StoreError::Io { path, action: "remove", source })
            }
            _ => Ok(()),
        }
    }

    /// Removes files of the folder, if present, for good: a power cut restores no file.
    ///
    /// # Errors
    /// Error of the system, with the file's path.
    pub fn remove_all(&self, names: &[&str]) -> Result<(), StoreError> {
        let there: Vec<&&str> = names.iter().filter(|name| self.has(name)).collect();
        there.iter().try_for_each(|name| self.remove(name))?;
        match there.is_empty() {
            true => Ok(()),
            false => sync(&self.path),
        }
    }

    /// Removes files like [`Folder::remove_all`] in a folder inside, and that folder too if nothing else is
    /// in it.
    ///
    /// # Errors
    /// A link in place of that folder, or an error of the system.
    pub fn remove_all_in(&self, inside: &str, names: &[impl AsRef<str>]) -> Result<(), StoreError> {
        let path = self.path.join(inside);
        if path.symlink_metadata().is_err() {
            return Ok(());
        }
        make_folder(&path)?;
        let names: Vec<String> = names.iter().map(|name| format!("{inside}/{}", name.as_ref())).collect();
        let there: Vec<&String> = names.iter().filter(|name| self.has(name)).collect();
        there.iter().try_for_each(|name| self.remove(name))?;
        let read = |source| StoreError::Io { path: path.clone(), action: "read the folder", source };
        if is_empty(&path).map_err(read)? {
            remove_folder(&path)?;
            return sync(&self.path);
        }
        match there.is_empty() {
            true => Ok(()),
            false => sync(&path),
        }
    }

    /// Writes a whole file: afterwards either all of it is there, or the former content.
    ///
    /// # Errors
    /// Error of the system, with the file's path.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), StoreError> {
        let path = self.path.join(name);
        if let Some(folder) = path.parent().filter(|p| *p != self.path) {
            make_folder(folder)?;
        }
        write_whole(&path, bytes)
    }
}

/// A locked file, unlocked when it is dropped: a process that is just being started has a copy of every open
/// file, and would keep the lock until it becomes another program.
#[derive(Debug)]
struct Lock(File);

impl Drop for Lock {
    fn drop(&mut self) {
        // If this fails, the system unlocks when the last copy is closed.
        let _ = self.0.unlock();
    }
}

/// Opens a lock file and locks it, for this process alone or `shared`.
fn lock(path: &Path, shared: bool) -> Result<Lock, StoreError> {
    let folder = path.parent().unwrap_or(path);
    let failed = |source| StoreError::Io { path: folder.to_owned(), action: "write to the folder", source };
    let mut options = File::options();
    options.read(true).write(true).create(true).truncate(false);
    // A link in place of the lock file would cause its target to be emptied.
    let file = ask(Call::Lock(path), || platform::open_own(&mut options, path)).map_err(failed)?;
    let meta = file.metadata().map_err(failed)?;
    // So would a second name of a file that somebody else needs.
    if !meta.is_file() || platform::has_other_names(&file).map_err(failed)? {
        return Err(StoreError::NotALock { path: path.to_owned() });
    }
    match platform::try_lock(&file, shared) {
        Ok(()) => Ok(Lock(file)),
        Err(TryLockError::WouldBlock) => {
            Err(StoreError::Held { path: folder.to_owned(), holder: holder(path) })
        }
        Err(TryLockError::Error(source)) => {
            Err(StoreError::Io { path: folder.to_owned(), action: "lock the folder", source })
        }
    }
}

/// Reads the holder from the lock file; a process that has just locked it is about to write that.
fn holder(path: &Path) -> String {
    let begun = Instant::now();
    loop {
        let text = disk::read(path).unwrap_or_default();
        let text = String::from_utf8_lossy(&text);
        match text.lines().next() {
            Some(line) => return line.chars().take(200).collect(),
            None if begun.elapsed() > SIGNS_WITHIN => return "which has not said who it is".into(),
            None => std::thread::sleep(Duration::from_millis(5)),
        }
    }
}

/// Opens a lock file and shares it; a process that is alone with it first clears up.
fn share(path: &Path) -> Result<Lock, StoreError> {
    if let Ok(alone) = lock(path, false) {
        let folder = path.parent().unwrap_or(path);
        let failed =
            |source| StoreError::Io { path: folder.to_owned(), action: "clear up the folder", source };
        clear_parts(folder).map_err(failed)?;
        drop(alone);
    }
    let begun = Instant::now();
    loop {
        match lock(path, true) {
            Err(StoreError::Held { .. }) if begun.elapsed() < ASK_FOR => {
                std::thread::sleep(Duration::from_millis(5));
            }
            other => return other,
        }
    }
}

/// Removes incomplete files of killed processes in a folder and in its subfolders without a lock of their
/// own.
fn clear_parts(folder: &Path) -> io::Result<()> {
    let entries = ask(Call::List(folder), || fs::read_dir(folder)?.collect::<io::Result<Vec<_>>>())?;
    for entry in entries {
        let (path, kind) = (entry.path(), entry.file_type()?);
        if kind.is_file() && is_left(&entry.file_name().to_string_lossy()) {
            match ask(Call::Remove(&path), || fs::remove_file(&path)) {
                Err(error) if error.kind() == io::ErrorKind::NotFound => {}
                other => other?,
            }
        } else if kind.is_dir() && path.join(LOCK_FILE).symlink_metadata().is_err() {
            clear_parts(&path)?;
        }
    }
    Ok(())
}

/// Tells if a name belongs to an incomplete file whose process is gone. Without working locks, a live process
/// may still be writing it.
fn is_left(name: &str) -> bool {
    let Some(process) = name.strip_prefix(PART).and_then(|rest| rest.split('-').next()) else { return false };
    process == std::process::id().to_string() || !platform::is_running(process)
}

#[cfg(test)]
mod tests;
