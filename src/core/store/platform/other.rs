//! A system known only through the standard library, such as a page in a browser. Missing calls return
//! errors, so that nothing is written without a lock.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use super::Memory;

pub fn open_own(options: &mut OpenOptions, path: &Path) -> io::Result<File> {
    options.open(path)
}

pub fn open_any(options: &mut OpenOptions, path: &Path) -> io::Result<File> {
    options.open(path)
}

/// Unknown: an error, so that no file counts as having a single name.
pub fn has_other_names(_file: &File) -> io::Result<bool> {
    Err(io::ErrorKind::Unsupported.into())
}

pub fn read_exact_at(mut file: &File, bytes: &mut [u8], offset: u64) -> io::Result<()> {
    file.seek(SeekFrom::Start(offset))?;
    file.read_exact(bytes)
}

/// Locks a file, if the standard library can.
pub fn try_lock(file: &File, shared: bool) -> Result<(), TryLockError> {
    if shared { file.try_lock_shared() } else { file.try_lock() }
}

pub fn sync_folder(folder: &Path) -> io::Result<()> {
    File::open(folder)?.sync_all()
}

/// Makes a file `bytes` long; its blocks may not be allocated.
pub fn allocate(file: &File, bytes: u64) -> io::Result<()> {
    file.set_len(bytes)
}

/// Unknown.
pub fn free_bytes(_folder: &Path) -> Option<u64> {
    None
}

/// Unknown: true, so that nobody's files are removed.
pub fn is_running(_process: &str) -> bool {
    true
}

/// Unknown.
pub fn host_name() -> String {
    "unknown".to_owned()
}

/// Step of the processor time of a thread (s): it does not advance.
pub const THREAD_SECONDS_STEP: f64 = f64::INFINITY;

/// Unknown: no time passes.
pub fn thread_seconds() -> f64 {
    0.0
}

/// Unknown.
pub fn processors() -> Vec<usize> {
    Vec::new()
}

/// Does nothing.
pub fn stay_on(_processor: usize) {}

/// Unknown.
pub fn memory() -> Memory {
    Memory::default()
}

/// Unknown.
pub fn processor() -> Option<String> {
    None
}
