//! Keeps freed memory with the program, which soon asks for it again.

/// Largest block that is served from memory the program already has (bytes): glibc's upper limit.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const KEPT_BLOCK: i32 = 32 << 20;

/// Free memory at the end of an arena that remains with the program (bytes).
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const KEPT: i32 = 256 << 20;

/// Keeps the memory freed by walks for the next ones. Each run needs some 10 MB of columns; with glibc's own
/// settings they go back to the system at its end, which clears every page again for the next: a tenth of the
/// time of a first look. The kept memory is at most what each thread once had in blocks of up to
/// `KEPT_BLOCK`; larger ones go back at once. Only for a process that is the program's own: the setting
/// holds for all of it.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
pub fn keep_memory() {
    for (what, bytes) in [(libc::M_MMAP_THRESHOLD, KEPT_BLOCK), (libc::M_TRIM_THRESHOLD, KEPT)] {
        // SAFETY: the call takes two numbers, and changes no memory that was handed out. It reports a value
        // that it does not accept, and keeps its own.
        unsafe { libc::mallopt(what, bytes) };
    }
}

/// Does nothing: other allocators offer no such setting.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub fn keep_memory() {}
