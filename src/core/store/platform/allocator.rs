//! Memory that is given back and soon asked for again stays with the program.

/// Blocks up to this size come from what the program has already (bytes): glibc takes no more than this.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const KEPT_BLOCK: i32 = 32 << 20;

/// So much that is free at the end of a part stays with the program (bytes).
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const KEPT: i32 = 256 << 20;

/// Keeps what walks give back for the next ones. Each run needs some 10 MB of columns; with glibc's own
/// settings they go back to the system at its end, which clears every page again for the next: a tenth of the
/// time of a first look. At most so much is kept as each thread once had in blocks of up to [`KEPT_BLOCK`];
/// larger ones go back at once. Only for a process that is the program's own: it holds for all of it.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
pub fn keep_memory() {
    for (what, bytes) in [(libc::M_MMAP_THRESHOLD, KEPT_BLOCK), (libc::M_TRIM_THRESHOLD, KEPT)] {
        // SAFETY: it takes two numbers, and changes nothing that was handed out. Of a value that it does not
        // take it says so, and keeps its own.
        unsafe { libc::mallopt(what, bytes) };
    }
}

/// Does nothing: elsewhere nothing is known of what the allocator keeps.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub fn keep_memory() {}
