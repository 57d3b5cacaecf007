//! Files and clocks of Linux and macOS.

use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::os::unix::fs::{FileExt, MetadataExt, OpenOptionsExt};
use std::path::Path;

use super::write_zeros;
use rustix::fs::{FallocateFlags, OFlags};
use rustix::time::{ClockId, clock_gettime};

/// Opens one of the program's own files: a link is an error, and a pipe or the like is not waited for.
pub fn open_own(options: &mut OpenOptions, path: &Path) -> io::Result<File> {
    options.custom_flags((OFlags::NOFOLLOW | OFlags::NONBLOCK).bits() as i32).open(path)
}

/// Opens a user's file: a link is followed, and a pipe or the like is not waited for.
pub fn open_any(options: &mut OpenOptions, path: &Path) -> io::Result<File> {
    options.custom_flags(OFlags::NONBLOCK.bits() as i32).open(path)
}

/// Tells if a file has more than one name.
pub fn has_other_names(file: &File) -> io::Result<bool> {
    Ok(file.metadata()?.nlink() > 1)
}

/// Fills `bytes` from a file, starting at this offset.
pub fn read_exact_at(file: &File, bytes: &mut [u8], offset: u64) -> io::Result<()> {
    file.read_exact_at(bytes, offset)
}

/// Locks a file for this process alone or, if `shared`, for all that share it. Others can still read it.
pub fn try_lock(file: &File, shared: bool) -> Result<(), TryLockError> {
    if shared { file.try_lock_shared() } else { file.try_lock() }
}

/// Syncs the names in a folder.
pub fn sync_folder(folder: &Path) -> io::Result<()> {
    File::open(folder)?.sync_all()
}

/// Makes a file `bytes` long with every block allocated: by the file system, or else by writing.
pub fn allocate(file: &File, bytes: u64) -> io::Result<()> {
    match rustix::fs::fallocate(file, FallocateFlags::empty(), 0, bytes) {
        Err(rustix::io::Errno::OPNOTSUPP) => write_zeros(file, bytes),
        other => Ok(other?),
    }
}

/// Bytes that this user may still write on the disk of a folder; `None` if unknown.
pub fn free_bytes(folder: &Path) -> Option<u64> {
    let disk = rustix::fs::statvfs(folder).ok()?;
    Some(disk.f_bavail.saturating_mul(disk.f_frsize))
}

/// Tells if a process with this number is running.
pub fn is_running(process: &str) -> bool {
    let number = process.parse::<u32>().ok().and_then(|number| i32::try_from(number).ok());
    let number = number.and_then(rustix::process::Pid::from_raw);
    // A process of another user cannot be queried, but exists.
    number.is_some_and(|number| {
        !matches!(rustix::process::test_kill_process(number), Err(rustix::io::Errno::SRCH))
    })
}

/// Name of this machine.
pub fn host_name() -> String {
    rustix::system::uname().nodename().to_string_lossy().into_owned()
}

/// Step of the processor time of a thread (s).
pub const THREAD_SECONDS_STEP: f64 = 1e-6;

/// Processor time of this thread (s).
pub fn thread_seconds() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}
