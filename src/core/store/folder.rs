//! The run folder: one writer, no half-written file.
//!
//! - A folder is ours if it was empty or absent, or holds our lock file [`LOCK_FILE`] or a finished run.
//!   No other folder is written to, nor one reached through a symbolic link.
//! - The lock belongs to the process: the system releases it however the process ends. The lock file
//!   names its holder.
//! - A file appears under its name only when complete: it is written beside its place, synced and
//!   renamed, and the folder is synced. A new folder is synced into its parent.
//! - Incomplete files of a killed process are removed when one process alone next locks their folder.
//! - Names of folders and files are valid on every system, and no system confuses two of them.

use super::disk::{Call, PART, ask};
use super::whole::{
    StoreError, expect_folder, is_empty, make_folder, make_folders, remove_folder, sync, write_whole,
};
use super::{disk, platform};
use crate::text::is_plain;
use std::fs::{File, TryLockError};
use std::io::{Seek, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use std::{fs, io};

/// Name of the lock file, which marks a folder as ours.
const LOCK_FILE: &str = ".voidwalk.lock";

/// Time for which a shared folder is retried: another process may hold it alone while it clears up.
const ASK_FOR: Duration = Duration::from_millis(500);

/// Maximum time in which a process signs the lock file after locking a folder.
const SIGNS_WITHIN: Duration = Duration::from_millis(200);

/// A folder to which only this process writes until it is dropped.
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
    /// Creates the folder if it is missing, and locks it.
    ///
    /// # Errors
    /// The folder is a link, holds other things, is held by another process, or cannot be written.
    pub fn open(path: &Path) -> Result<Self, StoreError> {
        Self::open_locked(path, false)
    }

    /// Opens a folder like [`Folder::open`], for several processes that each work in a subfolder of
    /// their own. Fails while one process holds the folder alone.
    pub fn open_shared(path: &Path) -> Result<Self, StoreError> {
        Self::open_locked(path, true)
    }

    fn open_locked(path: &Path, shared: bool) -> Result<Self, StoreError> {
        #[cfg(feature = "process")]
        platform::process::save_first();
        // No trailing slash, which would follow a link.
        let path: &Path = &path.components().collect::<PathBuf>();
        let mut marked = false;
        match fs::symlink_metadata(path) {
            Ok(meta) => {
                expect_folder(path, &meta)?;
                let is_file = |name| path.join(name).symlink_metadata().is_ok_and(|m| m.is_file());
                // In this order: a process that has just locked an empty folder leaves its lock file in it.
                let empty = is_empty(path).map_err(StoreError::io(path, "read the folder"))?;
                marked = is_file(LOCK_FILE) || (is_file("manifest.json") && is_file("outcome.json"));
                if !marked && !empty {
                    return Err(StoreError::NotOurs { path: path.to_owned() });
                }
            }
            Err(e) if e.kind() == io::ErrorKind::NotFound => {
                make_folders(path).map_err(StoreError::io(path, "make the folder"))?
            }
            Err(e) => return Err(StoreError::io(path, "look at the folder")(e)),
        }
        let lock_path = path.join(LOCK_FILE);
        let lock = if shared { share(&lock_path)? } else { lock(&lock_path, false)? };
        if !marked {
            // Else a power failure could leave a folder with other files but without this lock file.
            disk::sync_folder(path).map_err(StoreError::io(path, "sync the folder"))?;
        }
        if !shared {
            let holder = format!("process {} on {}\n", std::process::id(), platform::host_name());
            ask(Call::Sign(&lock_path, holder.as_bytes()), || {
                let mut file = &lock.0;
                file.set_len(0)?;
                file.rewind()?;
                file.write_all(holder.as_bytes())
            })
            .map_err(StoreError::io(path, "write to the folder"))?;
            clear_parts(path).map_err(StoreError::io(path, "clear up the folder"))?;
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
    pub fn read(&self, name: &str) -> Result<Option<Vec<u8>>, StoreError> {
        let path = self.path.join(name);
        match disk::read_whole(&path) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(source) => Err(StoreError::io(&path, "read")(source)),
        }
    }

    /// Removes a file of the folder, if it exists.
    pub fn remove(&self, name: &str) -> Result<(), StoreError> {
        let path = self.path.join(name);
        match ask(Call::Remove(&path), || fs::remove_file(&path)) {
            Err(e) if e.kind() != io::ErrorKind::NotFound => Err(StoreError::io(&path, "remove")(e)),
            _ => Ok(()),
        }
    }

    /// Removes any of these files from the folder, for good: a power cut restores none.
    pub fn remove_all(&self, names: &[&str]) -> Result<(), StoreError> {
        if self.remove_there(names)? { sync(&self.path) } else { Ok(()) }
    }

    /// Removes files like [`Folder::remove_all`] from a subfolder, and then the subfolder if it is
    /// empty.
    ///
    /// # Errors
    /// A link in place of the subfolder, or an error of the system.
    pub fn remove_all_in(&self, inside: &str, names: &[impl AsRef<str>]) -> Result<(), StoreError> {
        let path = self.path.join(inside);
        if path.symlink_metadata().is_err() {
            return Ok(());
        }
        make_folder(&path)?;
        let names: Vec<String> = names.iter().map(|name| format!("{inside}/{}", name.as_ref())).collect();
        let removed = self.remove_there(&names)?;
        if is_empty(&path).map_err(StoreError::io(&path, "read the folder"))? {
            remove_folder(&path)?;
            return sync(&self.path);
        }
        if removed { sync(&path) } else { Ok(()) }
    }

    /// Removes those of the files that exist; tells if there were any.
    fn remove_there(&self, names: &[impl AsRef<str>]) -> Result<bool, StoreError> {
        let there: Vec<&str> = names.iter().map(AsRef::as_ref).filter(|name| self.has(name)).collect();
        there.iter().try_for_each(|name| self.remove(name))?;
        Ok(!there.is_empty())
    }

    /// Writes a whole file: afterwards the file holds all of it, or its former content.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), StoreError> {
        let path = self.path.join(name);
        if let Some(folder) = path.parent().filter(|p| *p != self.path) {
            make_folder(folder)?;
        }
        write_whole(&path, bytes)
    }
}

/// A locked file, unlocked when dropped: a process that is being started holds a copy of every open
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
    let failed = |source| StoreError::io(folder, "write to the folder")(source);
    let mut options = File::options();
    options.read(true).write(true).create(true).truncate(false);
    // A link in place of the lock file would cause its target to be emptied.
    let file = ask(Call::Lock(path), || platform::open_own(&mut options, path)).map_err(failed)?;
    let meta = file.metadata().map_err(failed)?;
    // So would a second name of somebody else's file.
    if !meta.is_file() || platform::has_other_names(&file).map_err(failed)? {
        return Err(StoreError::NotALock { path: path.to_owned() });
    }
    match platform::try_lock(&file, shared) {
        Ok(()) => Ok(Lock(file)),
        Err(TryLockError::WouldBlock) => Err(StoreError::Held { path: folder.into(), holder: holder(path) }),
        Err(TryLockError::Error(source)) => Err(StoreError::io(folder, "lock the folder")(source)),
    }
}

/// Reads the holder from the lock file; a process that has just locked it is about to write its name.
fn holder(path: &Path) -> String {
    let begun = Instant::now();
    loop {
        let text = disk::read_whole(path).unwrap_or_default();
        let text = String::from_utf8_lossy(&text);
        match text.lines().next() {
            Some(line) => return line.chars().take(200).collect(),
            None if begun.elapsed() > SIGNS_WITHIN => return "which has not given its name".into(),
            None => std::thread::sleep(Duration::from_millis(5)),
        }
    }
}

/// Opens a lock file and shares it; a process that holds it alone clears up first.
fn share(path: &Path) -> Result<Lock, StoreError> {
    if let Ok(alone) = lock(path, false) {
        let folder = path.parent().unwrap_or(path);
        clear_parts(folder).map_err(StoreError::io(folder, "clear up the folder"))?;
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

/// Removes incomplete files of killed processes from a folder and its subfolders that have no lock.
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

/// Tells if a name belongs to an incomplete file whose process has ended. Without working locks, a live
/// process may still be writing it.
fn is_left(name: &str) -> bool {
    let Some(process) = name.strip_prefix(PART).and_then(|rest| rest.split('-').next()) else { return false };
    process == std::process::id().to_string() || !platform::is_running(process)
}

/// Tells if Windows reads a name as a device, whatever its ending.
pub fn is_device(name: &str) -> bool {
    let stem = name.split('.').next().unwrap_or_default().trim_end().to_lowercase();
    let numbered =
        |device| stem.strip_prefix(device).is_some_and(|n| "0123456789¹²³".split("").any(|d| d == n));
    let is_numbered = stem.len() > 3 && (numbered("com") || numbered("lpt"));
    is_numbered || ["con", "prn", "aux", "nul", "conin$", "conout$"].contains(&stem.as_str())
}

/// Turns a name into a folder name. A hash is appended if the name is not plain, is a device name or
/// ends with a dot.
pub fn folder_name(name: &str) -> String {
    let safe = |c: char| if is_plain(c) { c } else { '_' };
    let plain: String = name.chars().take(120).map(safe).collect();
    if plain == name && !is_device(name) && !name.ends_with('.') {
        return plain;
    }
    let plain = if is_device(&plain) { plain.replace('.', "_") } else { plain };
    format!("{plain}-{:016x}", xxhash_rust::xxh3::xxh3_64(name.as_bytes()))
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
    fn what_a_killed_process_left_is_cleared_up_by_the_sole_owner_only() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("run");
        drop(Folder::open(&path).unwrap());
        let part = |folder: &Path| {
            fs::create_dir_all(folder).unwrap();
            fs::write(folder.join(".voidwalk-part-4999999-1"), "half").unwrap();
            folder.join(".voidwalk-part-4999999-1")
        };
        let (left, inside) = (part(&path), part(&path.join("checkpoint")));
        let of_another = part(&path.join("cases/one"));
        fs::write(path.join("cases/one").join(LOCK_FILE), "process 7 on x").unwrap();
        fs::write(path.join("notes.txt"), "mine").unwrap();
        let held = Folder::open_shared(&path).unwrap();
        assert!(!left.exists() && !inside.exists() && of_another.exists());
        // A running process may own it.
        part(&path);
        let _other = Folder::open_shared(&path).unwrap();
        assert!(left.exists());
        drop((held, _other));
        drop(Folder::open(&path).unwrap());
        assert!(!left.exists() && of_another.exists() && path.join("notes.txt").exists());
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
        let linked = root.path().join("linked");
        fs::create_dir(&linked).unwrap();
        fs::hard_link(root.path().join("thesis.txt"), linked.join(LOCK_FILE)).unwrap();
        for opened in [Folder::open(&linked), Folder::open_shared(&linked)] {
            assert!(matches!(opened, Err(StoreError::NotALock { .. })));
        }
        fs::remove_dir_all(&linked).unwrap();
        assert_eq!(fs::read_to_string(root.path().join("thesis.txt")).unwrap(), "years of work");
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 1);
    }

    #[test]
    #[cfg(unix)]
    fn a_link_is_not_followed() {
        let root = tempfile::tempdir().unwrap();
        let (link, elsewhere) = (root.path().join("link"), root.path().join("elsewhere"));
        fs::create_dir(&elsewhere).unwrap();
        std::os::unix::fs::symlink(&elsewhere, &link).unwrap();
        assert!(matches!(Folder::open(&link), Err(StoreError::NotAFolder { what: "a symbolic link", .. })));
        let with_slash = root.path().join("link/");
        assert!(matches!(Folder::open(&with_slash), Err(StoreError::NotAFolder { .. })));
        assert_eq!(fs::read_dir(&elsewhere).unwrap().count(), 0);
    }

    /// A process that is being started holds a copy of every open file until it becomes another program.
    #[test]
    fn a_folder_that_is_let_go_is_free_though_its_lock_file_is_open_elsewhere() {
        let root = tempfile::tempdir().unwrap();
        let folder = Folder::open(root.path()).unwrap();
        let _copy = folder._lock.0.try_clone().unwrap();
        drop(folder);
        assert!(Folder::open(root.path()).is_ok());
    }

    #[test]
    fn names_of_devices_are_known() {
        for device in ["con", "CON", "aux.txt", "nul.a.b", "Com1", "lpt9.csv", "com¹", "con .x", "conin$"] {
            assert!(is_device(device), "{device}");
        }
        for other in ["", "com", "com10", "comx", "lpt", "console", "a.con", "con-1", "auxiliary"] {
            assert!(!is_device(other), "{other}");
        }
    }

    #[test]
    fn every_system_takes_the_name_of_a_folder() {
        for plain in ["fine", "cu_b=1.5,filter=a", "0.5"] {
            assert_eq!(folder_name(plain), plain);
        }
        for name in ["con", "con.x", "LPT1", "a.", "a ", "nul", "wide base", "é"] {
            let folder = folder_name(name);
            assert!(folder.len() > 17 && !is_device(&folder) && folder.chars().all(is_plain), "{folder}");
            assert!(!folder.ends_with(['.', ' ']));
        }
        assert_eq!(folder_name("wide base").split_once('-').map(|(plain, _)| plain), Some("wide_base"));
    }
}
