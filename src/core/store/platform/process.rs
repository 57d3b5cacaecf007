//! The process: requests of the user or the system to end it, and the freed memory that it keeps.

use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock};

/// True if a request ends the program at once: while it reads and prepares there is nothing to save, and
/// no loop needs to check for requests.
static AT_ONCE: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

/// Makes requests end the program at once, until the first folder is locked.
pub fn end_at_once() {
    AT_ONCE.store(true, Ordering::SeqCst);
}

/// Makes requests only set the flag of [`stop_on_request`]: otherwise work would be lost.
pub(crate) fn save_first() {
    AT_ONCE.store(false, Ordering::SeqCst);
}

/// Returns a flag that the first request to end sets. A later interrupt (Ctrl-C), or any request after
/// [`end_at_once`], ends the program at once, as it ends a program without a handler.
///
/// On Linux and macOS the requests are SIGINT, SIGTERM, SIGHUP when the terminal is closed (but on Linux
/// not under `nohup`), and SIGXCPU when the processor time is used up. SIGTERM may come several times: a
/// cluster's scheduler sends it to a job's script, which forwards it, and to all processes of the job.
/// On Windows they are Ctrl-C, Ctrl-Break, closing the window, and the end of the session; for the last
/// two the system gives the program a few seconds.
///
/// # Errors
/// An error of a system that accepts no handler.
pub fn stop_on_request() -> io::Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    listen(&stop)?;
    Ok(stop)
}

#[cfg(unix)]
fn listen(stop: &Arc<AtomicBool>) -> io::Result<()> {
    use signal_hook::consts::SIGINT;
    use signal_hook::flag::{register, register_conditional_default, register_conditional_shutdown};

    register_conditional_shutdown(SIGINT, 1, Arc::clone(stop))?;
    for signal in requests() {
        register_conditional_default(signal, Arc::clone(&AT_ONCE))?;
        register(signal, Arc::clone(stop))?;
    }
    Ok(())
}

#[cfg(windows)]
fn listen(stop: &Arc<AtomicBool>) -> io::Result<()> {
    super::windows::listen(stop, &AT_ONCE)
}

/// Does nothing: such a system sends no requests and only kills.
#[cfg(not(any(unix, windows)))]
fn listen(_stop: &Arc<AtomicBool>) -> io::Result<()> {
    Ok(())
}

#[cfg(unix)]
fn requests() -> impl Iterator<Item = i32> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXCPU};
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = move |signal| signal == SIGHUP && is_ignored(&status, signal);
    [SIGINT, SIGTERM, SIGHUP, SIGXCPU].into_iter().filter(move |signal| !ignored(*signal))
}

/// Tells if the process was started with a signal ignored, from `/proc/self/status`.
#[cfg(unix)]
fn is_ignored(status: &str, signal: i32) -> bool {
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

/// Makes a write beyond the allowed file size fail with an error. If this fails, such a write ends the
/// program as before.
#[cfg(unix)]
pub fn outlive_large_files() {
    let noticed = Arc::new(AtomicBool::new(false));
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, noticed);
}

/// Does nothing: only Unix ends a program for such a write.
#[cfg(not(unix))]
pub fn outlive_large_files() {}

#[cfg(all(test, unix))]
mod tests {
    use super::is_ignored;

    #[test]
    fn what_the_parent_ignores_is_known() {
        let nohup = "Name:\tvoidwalk\nSigBlk:\t0000000000000000\nSigIgn:\t0000000000001001\n";
        assert!(is_ignored(nohup, 1) && is_ignored(nohup, 13) && !is_ignored(nohup, 15));
        for other in ["", "SigIgn:\tx\n", "SigIgn:\t0000000000000000\n"] {
            assert!(!is_ignored(other, 1), "{other}");
        }
    }
}

/// Largest block served from memory that the program already has (bytes): glibc's upper limit.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const KEPT_BLOCK: i32 = 32 << 20;

/// Free memory at the end of an arena that the program keeps (bytes).
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const KEPT: i32 = 256 << 20;

/// Keeps memory freed by walks for later ones. Each run needs some 10 MB of columns; with glibc's
/// defaults they go back to the system at its end, and every page is cleared again for the next run: a
/// tenth of the time of a first look. The kept memory is at most what each thread once held in blocks of
/// up to `KEPT_BLOCK`; larger ones go back at once. Only for a process that is the program's own: the
/// setting applies to the whole process.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
pub fn keep_memory() {
    for (what, bytes) in [(libc::M_MMAP_THRESHOLD, KEPT_BLOCK), (libc::M_TRIM_THRESHOLD, KEPT)] {
        // SAFETY: the call takes two numbers and changes no allocated memory. It reports a value that it
        // does not accept, and then changes nothing.
        unsafe { libc::mallopt(what, bytes) };
    }
}

/// Does nothing: other allocators offer no such setting.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub fn keep_memory() {}
