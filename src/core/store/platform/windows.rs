//! Files, clocks, processors and memory on Windows.

use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::os::windows::ffi::OsStrExt;
use std::os::windows::fs::{FileExt, OpenOptionsExt};
use std::os::windows::io::AsRawHandle;
use std::path::Path;
#[cfg(feature = "process")]
use std::sync::atomic::{AtomicBool, Ordering};
#[cfg(feature = "process")]
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use windows_sys::Win32::Foundation::{CloseHandle, ERROR_IO_PENDING, ERROR_LOCK_VIOLATION, FILETIME};
use windows_sys::Win32::Storage::FileSystem::{
    BY_HANDLE_FILE_INFORMATION, FILE_FLAG_OPEN_REPARSE_POINT, GetDiskFreeSpaceExW,
    GetFileInformationByHandle, LOCKFILE_EXCLUSIVE_LOCK, LOCKFILE_FAIL_IMMEDIATELY, LockFileEx,
};
#[cfg(feature = "process")]
use windows_sys::Win32::System::Console::{CTRL_BREAK_EVENT, CTRL_C_EVENT, SetConsoleCtrlHandler};
use windows_sys::Win32::System::IO::{OVERLAPPED, OVERLAPPED_0, OVERLAPPED_0_0};
use windows_sys::Win32::System::SystemInformation::{GlobalMemoryStatusEx, MEMORYSTATUSEX};
use windows_sys::Win32::System::Threading::{
    GetCurrentProcess, GetCurrentThread, GetExitCodeProcess, GetProcessAffinityMask, GetThreadTimes,
    OpenProcess, PROCESS_QUERY_LIMITED_INFORMATION, SetThreadAffinityMask,
};

use super::Memory;

/// Result of `GetExitCodeProcess` for a process that has not ended (STILL_ACTIVE).
const STILL_ACTIVE: u32 = 259;

/// Byte that is locked in place of the file, far beyond its end: the system lets nobody read what
/// another process has locked, and the file names the holder.
const LOCKED_BYTE: u64 = 1 << 62;

/// Opens one of the program's own files; a link is opened itself, and is not a file.
pub fn open_own(options: &mut OpenOptions, path: &Path) -> io::Result<File> {
    options.custom_flags(FILE_FLAG_OPEN_REPARSE_POINT).open(path)
}

/// Opens a user's file; the system never waits here.
pub fn open_any(options: &mut OpenOptions, path: &Path) -> io::Result<File> {
    options.open(path)
}

/// Tells if a file has more than one name.
pub fn has_other_names(file: &File) -> io::Result<bool> {
    let mut about = BY_HANDLE_FILE_INFORMATION::default();
    // SAFETY: the handle is open as long as `file` is borrowed, and the system writes a record of this
    // type into `about`, to which nothing else refers.
    let done = unsafe { GetFileInformationByHandle(file.as_raw_handle(), &raw mut about) };
    or_error(done)?;
    Ok(about.nNumberOfLinks > 1)
}

/// Fills `bytes` from a file, starting at this offset.
pub fn read_exact_at(file: &File, mut bytes: &mut [u8], mut offset: u64) -> io::Result<()> {
    while !bytes.is_empty() {
        match file.seek_read(bytes, offset)? {
            0 => return Err(io::ErrorKind::UnexpectedEof.into()),
            read => (bytes, offset) = (&mut bytes[read..], offset + read as u64),
        }
    }
    Ok(())
}

/// Locks a file for this process alone or, if `shared`, for all that share it. Others can still read it.
pub fn try_lock(file: &File, shared: bool) -> Result<(), TryLockError> {
    let exclusive = if shared { 0 } else { LOCKFILE_EXCLUSIVE_LOCK };
    let place = OVERLAPPED_0_0 { Offset: LOCKED_BYTE as u32, OffsetHigh: (LOCKED_BYTE >> 32) as u32 };
    let mut place = OVERLAPPED { Anonymous: OVERLAPPED_0 { Anonymous: place }, ..OVERLAPPED::default() };
    // SAFETY: the handle is open as long as `file` is borrowed. It was not opened for overlapped
    // operations, so when the call returns it is complete and nothing refers to `place`.
    let done = unsafe {
        let how = exclusive | LOCKFILE_FAIL_IMMEDIATELY;
        LockFileEx(file.as_raw_handle(), how, 0, 1, 0, &raw mut place)
    };
    or_error(done).map_err(|error| match error.raw_os_error().map(|code| code as u32) {
        Some(ERROR_LOCK_VIOLATION | ERROR_IO_PENDING) => TryLockError::WouldBlock,
        _ => TryLockError::Error(error),
    })
}

/// Does nothing: the system has no such call. It keeps the order of changes to names, so that after a
/// power cut a folder is in some earlier state.
pub fn sync_folder(_folder: &Path) -> io::Result<()> {
    Ok(())
}

/// Makes a file `bytes` long; the file system allocates all of it, unless it compresses the file.
pub fn allocate(file: &File, bytes: u64) -> io::Result<()> {
    file.set_len(bytes)
}

/// Bytes that this user may still write on the disk of a folder; `None` if unknown.
pub fn free_bytes(folder: &Path) -> Option<u64> {
    let name: Vec<u16> = folder.as_os_str().encode_wide().chain([0]).collect();
    let mut free = 0;
    // SAFETY: `name` ends with a zero and lives until the call has returned; the system writes one number
    // into `free`, and nothing to the null places.
    let done = unsafe {
        GetDiskFreeSpaceExW(name.as_ptr(), &raw mut free, std::ptr::null_mut(), std::ptr::null_mut())
    };
    (done != 0).then_some(free)
}

/// Tells if a process with this number is running.
pub fn is_running(process: &str) -> bool {
    let Ok(number) = process.parse() else { return false };
    // SAFETY: the call takes and returns plain numbers.
    let handle = unsafe { OpenProcess(PROCESS_QUERY_LIMITED_INFORMATION, 0, number) };
    if handle.is_null() {
        // A process of another user cannot be queried, but exists.
        return io::Error::last_os_error().kind() == io::ErrorKind::PermissionDenied;
    }
    let mut code = 0;
    // SAFETY: the handle is the open one from above, last used in the second call, and the system writes
    // one number into `code`.
    unsafe {
        let asked = GetExitCodeProcess(handle, &raw mut code);
        CloseHandle(handle);
        asked != 0 && code == STILL_ACTIVE
    }
}

/// Name of this machine.
pub fn host_name() -> String {
    std::env::var("COMPUTERNAME").unwrap_or_else(|_| "unknown".to_owned())
}

/// Step of the processor time of a thread (s): the step of the system's own clock.
pub const THREAD_SECONDS_STEP: f64 = 0.016;

/// Processor time of this thread (s), in kernel and user mode.
pub fn thread_seconds() -> f64 {
    let mut times = [FILETIME::default(); 4];
    let [creation, exit, kernel, user] = times.each_mut();
    // SAFETY: the handle denotes this thread, and the system writes into the four places that it gets.
    if unsafe { GetThreadTimes(GetCurrentThread(), creation, exit, kernel, user) } == 0 {
        return 0.0;
    }
    // Counted in steps of 100 ns.
    let steps = |time: FILETIME| (u64::from(time.dwHighDateTime) << 32) | u64::from(time.dwLowDateTime);
    1e-7 * (steps(times[2]) + steps(times[3])) as f64
}

/// Lists the processors that this program may use, by number in its group (of at most 64).
pub fn processors() -> Vec<usize> {
    let (mut usable, mut all) = (0, 0);
    // SAFETY: the handle denotes this process, and the system writes a number into both places.
    let done = unsafe { GetProcessAffinityMask(GetCurrentProcess(), &raw mut usable, &raw mut all) };
    if done == 0 {
        Vec::new()
    } else {
        (0..usize::BITS as usize).filter(|at| usable >> at & 1 == 1).collect()
    }
}

/// Binds this thread to a processor. If refused, the system places the thread.
pub fn stay_on(processor: usize) {
    if let Some(one) = 1usize.checked_shl(processor as u32) {
        // SAFETY: the handle denotes this thread; the rest are plain numbers.
        unsafe { SetThreadAffinityMask(GetCurrentThread(), one) };
    }
}

/// Returns the memory of the machine, and its unused part.
pub fn memory() -> Memory {
    let mut about =
        MEMORYSTATUSEX { dwLength: size_of::<MEMORYSTATUSEX>() as u32, ..MEMORYSTATUSEX::default() };
    // SAFETY: `about` holds its own length, and the system writes no further.
    let done = unsafe { GlobalMemoryStatusEx(&raw mut about) };
    if done == 0 {
        return Memory::default();
    }
    Memory { total: Some(about.ullTotalPhys), available: Some(about.ullAvailPhys) }
}

/// Family and model of the processor.
pub fn processor() -> Option<String> {
    std::env::var("PROCESSOR_IDENTIFIER").ok()
}

/// Flags set by a request to end.
#[cfg(feature = "process")]
static STOPS: Mutex<Vec<Arc<AtomicBool>>> = Mutex::new(Vec::new());

/// True if a request ends the program at once.
#[cfg(feature = "process")]
static AT_ONCE: OnceLock<Arc<AtomicBool>> = OnceLock::new();

/// Makes requests to end set the flag. `signal` of the C library is not enough: it does not report a
/// closed window, and differs between C libraries.
#[cfg(feature = "process")]
pub fn listen(stop: &Arc<AtomicBool>, at_once: &Arc<AtomicBool>) -> io::Result<()> {
    let _ = AT_ONCE.set(Arc::clone(at_once));
    STOPS.lock().unwrap_or_else(PoisonError::into_inner).push(Arc::clone(stop));
    // SAFETY: the handler is a function of the program, of the type that the system calls.
    or_error(unsafe { SetConsoleCtrlHandler(Some(on_request), 1) })
}

/// Handles a request; the system calls this on a separate thread. For requests other than interrupts the
/// program ends when this returns: so it waits, as long as the system allows, until the state is saved
/// and the program ends by itself.
#[cfg(feature = "process")]
unsafe extern "system" fn on_request(kind: u32) -> i32 {
    if AT_ONCE.get().is_some_and(|at_once| at_once.load(Ordering::SeqCst)) {
        // The system's handler is next, and ends the program.
        return 0;
    }
    let is_interrupt = matches!(kind, CTRL_C_EVENT | CTRL_BREAK_EVENT);
    if request(&STOPS.lock().unwrap_or_else(PoisonError::into_inner)) && is_interrupt {
        std::process::exit(1);
    }
    while !is_interrupt {
        std::thread::park();
    }
    1
}

/// Sets the flags; tells if one was already set.
#[cfg(feature = "process")]
fn request(stops: &[Arc<AtomicBool>]) -> bool {
    stops.iter().fold(false, |was, stop| stop.swap(true, Ordering::SeqCst) || was)
}

fn or_error(done: i32) -> io::Result<()> {
    if done == 0 { Err(io::Error::last_os_error()) } else { Ok(()) }
}
