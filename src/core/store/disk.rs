//! Calls to the disk. Every call that creates, changes, reads or removes one of the program's own files
//! goes through `ask` and one [`Disk`].
//!
//! The disk is global to the process and not passed from function to function: a writer without a folder
//! (a report, a ledger, a mapped column) cannot forget it, and only tests set it. Without a replacement
//! the real disk is used, at the cost of one pointer load per call.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;

use super::platform;

/// One call.
#[derive(Clone, Copy, Debug)]
pub enum Call<'a> {
    /// Lists a folder.
    List(&'a Path),
    /// Creates a single folder.
    MakeFolder(&'a Path),
    /// Removes a folder with all its content.
    RemoveFolder(&'a Path),
    /// Opens the lock file, creating it if it is missing, and locks it.
    Lock(&'a Path),
    /// Writes the name of the holder into the lock file.
    Sign(&'a Path, &'a [u8]),
    /// Creates a new, empty file.
    Create(&'a Path),
    /// Appends bytes to a file.
    Write(&'a Path, &'a [u8]),
    /// Syncs the written part of a file.
    Sync(&'a Path),
    /// Renames a file, replacing any file of that name.
    Rename(&'a Path, &'a Path),
    /// Syncs the names in a folder.
    SyncFolder(&'a Path),
    /// Creates a nameless file of this many bytes in a folder, allocates all of its blocks, and maps it.
    Map(&'a Path, u64),
    /// Opens a file or reads from it.
    Read(&'a Path),
    /// Removes a file.
    Remove(&'a Path),
}

/// A disk that may fail or record calls.
pub trait Disk: Send + Sync {
    /// Answers a call; `act` does the work of the real disk.
    ///
    /// # Errors
    /// The error of `act`, or any error that this disk chooses.
    fn call(&self, call: Call<'_>, act: &mut dyn FnMut() -> io::Result<()>) -> io::Result<()>;
}

static DISK: OnceLock<Box<dyn Disk>> = OnceLock::new();

/// Replaces the real disk for the rest of the process; only the first call counts.
pub fn replace_disk(disk: Box<dyn Disk>) {
    let _ = DISK.set(disk);
}

/// Calls the disk; repeats a call that a signal interrupted.
pub(super) fn ask<T>(call: Call<'_>, mut act: impl FnMut() -> io::Result<T>) -> io::Result<T> {
    loop {
        let answer = match DISK.get() {
            None => act(),
            Some(disk) => {
                let mut value = None;
                let done = disk.call(call, &mut || act().map(|answer| value = Some(answer)));
                done.and_then(|()| value.ok_or_else(|| io::Error::other("the disk did nothing")))
            }
        };
        match answer {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            other => return other,
        }
    }
}

/// Prefix of the names of incomplete files. A file left by a killed process is removed when its folder
/// is next locked.
pub(super) const PART: &str = ".voidwalk-part-";

/// Number of bytes after which a growing file is synced in the background.
const SEND_EVERY: u64 = 64 << 20;

/// A new file beside its final place, removed unless it is renamed into place.
pub(super) struct PartFile {
    path: PathBuf,
    file: Arc<File>,
    /// Bytes written since the last sync began, and the thread that is syncing.
    waiting: u64,
    sending: Option<JoinHandle<io::Result<()>>>,
    whole: bool,
}

impl PartFile {
    pub(crate) fn beside(folder: &Path) -> io::Result<Self> {
        static NUMBER: AtomicU64 = AtomicU64::new(0);
        loop {
            let number = NUMBER.fetch_add(1, Ordering::Relaxed);
            let path = folder.join(format!("{PART}{}-{number}", std::process::id()));
            let create = || File::options().write(true).create_new(true).open(&path);
            match ask(Call::Create(&path), create) {
                Ok(file) => {
                    let file = Arc::new(file);
                    return Ok(Self { path, file, waiting: 0, sending: None, whole: false });
                }
                // Left by a killed process of this number, or created on another machine.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
    }

    /// Syncs the file. After an error the file is abandoned: a second sync may report success although
    /// nothing was written.
    pub(crate) fn sync(&mut self) -> io::Result<()> {
        self.sent()?;
        ask(Call::Sync(&self.path), || self.file.sync_all())
    }

    pub(crate) fn rename(mut self, to: &Path) -> io::Result<()> {
        ask(Call::Rename(&self.path, to), || std::fs::rename(&self.path, to))?;
        self.whole = true;
        Ok(())
    }

    /// Starts syncing the new bytes, if there are many and no sync is under way.
    fn send(&mut self) -> io::Result<()> {
        if self.waiting < SEND_EVERY || self.sending.as_ref().is_some_and(|thread| !thread.is_finished()) {
            return Ok(());
        }
        self.send_by(File::sync_data)
    }

    /// Starts syncing all written bytes and the length; [`Self::sent`] waits for the end.
    pub(crate) fn send_all(&mut self) -> io::Result<()> {
        self.send_by(File::sync_all)
    }

    fn send_by(&mut self, sync: fn(&File) -> io::Result<()>) -> io::Result<()> {
        self.sent()?;
        let (path, file) = (self.path.clone(), Arc::clone(&self.file));
        let send = move || ask(Call::Sync(&path), || sync(&file));
        match std::thread::Builder::new().spawn(send.clone()) {
            Ok(thread) => self.sending = Some(thread),
            // No thread is available: this one waits for the disk.
            Err(_) => send()?,
        }
        self.waiting = 0;
        Ok(())
    }

    /// Waits for the sync under way; the system reports an error only once.
    pub(crate) fn sent(&mut self) -> io::Result<()> {
        match self.sending.take().map(JoinHandle::join) {
            None => Ok(()),
            Some(Ok(result)) => result,
            Some(Err(_)) => Err(io::Error::other("the thread that syncs has panicked")),
        }
    }
}

impl Write for PartFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // All bytes at once, so that a recording disk knows the content of the file.
        ask(Call::Write(&self.path, bytes), || (&*self.file).write_all(bytes))?;
        self.waiting += bytes.len() as u64;
        self.send()?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Drop for PartFile {
    fn drop(&mut self) {
        let _ = self.sent();
        if !self.whole {
            // If this fails too, the next process that locks the folder removes the file.
            let _ = ask(Call::Remove(&self.path), || std::fs::remove_file(&self.path));
        }
    }
}

/// Syncs the names in a folder.
pub(super) fn sync_folder(folder: &Path) -> io::Result<()> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    ask(Call::SyncFolder(folder), || platform::sync_folder(folder))
}

/// Reads a whole file that the program wrote itself; a link is refused.
pub fn read_whole(path: &Path) -> io::Result<Vec<u8>> {
    ask(Call::Read(path), || {
        let mut bytes = Vec::new();
        open_own(path)?.read_to_end(&mut bytes)?;
        Ok(bytes)
    })
}

/// Opens one of the program's own files for reading: a regular file, not a link.
pub(super) fn open_own(path: &Path) -> io::Result<File> {
    let file = regular(platform::open_own(File::options().read(true), path)?)?;
    file.ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "is not a regular file"))
}

/// Returns the file; `None` if it is a folder, a pipe, a socket or a device.
fn regular(file: File) -> io::Result<Option<File>> {
    Ok(file.metadata()?.is_file().then_some(file))
}

/// Reads a user's file; `None` if it is not a regular file or is longer than `largest` bytes. Does not
/// wait for a pipe.
pub fn read_regular(path: &Path, largest: u64) -> io::Result<Option<Vec<u8>>> {
    let Some(file) = open_regular(path)? else { return Ok(None) };
    let mut bytes = Vec::new();
    file.take(largest.saturating_add(1)).read_to_end(&mut bytes)?;
    Ok((bytes.len() as u64 <= largest).then_some(bytes))
}

/// Writes a limit on a file's size.
pub(crate) fn in_mb(bytes: u64) -> String {
    match bytes >> 30 {
        0 => format!("{} MB", bytes >> 20),
        gb => format!("{gb} GB"),
    }
}

/// Opens a file for reading; `None` if it is not a regular file. Does not wait for a pipe.
pub fn open_regular(path: &Path) -> io::Result<Option<File>> {
    regular(platform::open_any(File::options().read(true), path)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A reader of a pipe waits for ever if nobody writes to it.
    #[test]
    #[cfg(unix)]
    fn what_is_no_regular_file_is_not_read_and_not_waited_for() {
        let root = tempfile::tempdir().unwrap();
        let (pipe, text) = (root.path().join("pipe"), root.path().join("text"));
        let made = std::process::Command::new("mkfifo").arg(&pipe).status().unwrap();
        assert!(made.success());
        std::fs::write(&text, "abc").unwrap();
        for (path, largest, expected) in [
            (text.as_path(), 3, Some(b"abc".to_vec())),
            (&text, 2, None),
            (&pipe, 3, None),
            (root.path(), 3, None),
            (Path::new("/dev/zero"), u64::MAX, None),
        ] {
            assert_eq!(read_regular(path, largest).unwrap(), expected, "{}", path.display());
        }
        assert_eq!([in_mb(16 << 20), in_mb(4 << 30)], ["16 MB", "4 GB"]);
        assert_eq!(read_whole(&text).unwrap(), b"abc");
        assert_eq!(read_whole(&pipe).unwrap_err().to_string(), "is not a regular file");
    }
}
