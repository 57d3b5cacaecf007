//! Services that differ from system to system: locks, places in files, the state of the disk when a call
//! returns, processors, clocks, memory and signals.
//!
//! No other file of the program names a system or a crate of one (`tests/house.rs` checks it). Each file here
//! offers the same calls; the page of long runs (`voidwalk::docs`) lists what a system cannot promise.
//!
//! | file | systems |
//! |---|---|
//! | `unix.rs` | files and clocks of Linux and macOS |
//! | `linux.rs`, `cgroup.rs` | processors, memory and blocks of files on Linux |
//! | `macos.rs` | the same on macOS |
//! | `windows.rs` | Windows |
//! | `other.rs` | any other, as a page in a browser: no locks, no affinity, nothing known of the machine |
//! | `allocator.rs` | memory that is given back stays with the program on Linux with glibc |
//! | `signals.rs` | how the user or the system asks the program to end |

#[cfg(feature = "process")]
pub mod allocator;
#[cfg(any(target_os = "linux", test))]
mod cgroup;
#[cfg(target_os = "linux")]
mod linux;
#[cfg(any(target_os = "macos", test))]
mod macos;
#[cfg(not(any(target_os = "linux", target_os = "macos", windows)))]
mod other;
#[cfg(feature = "process")]
pub mod signals;
#[cfg(test)]
mod tests;
#[cfg(any(target_os = "linux", target_os = "macos"))]
mod unix;
#[cfg(windows)]
mod windows;

#[cfg(target_os = "linux")]
use linux as machine;
#[cfg(target_os = "macos")]
use macos as machine;
#[cfg(not(any(target_os = "linux", target_os = "macos", windows)))]
use other as files;
#[cfg(not(any(target_os = "linux", target_os = "macos", windows)))]
use other as machine;
#[cfg(any(target_os = "linux", target_os = "macos"))]
use unix as files;
#[cfg(windows)]
use windows as files;
#[cfg(windows)]
use windows as machine;

pub(super) use files::{
    has_other_names, is_running, open_any, open_own, read_exact_at, sync_folder, try_lock,
};
pub(super) use machine::allocate;

pub use files::{THREAD_SECONDS_STEP, free_bytes, host_name, thread_seconds};
pub use machine::{memory, mounts, processor, processors, stay_on};

/// Memory of the machine; `None` if the system does not report it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Memory {
    /// Installed memory (bytes).
    pub total: Option<u64>,
    /// Memory that this process may still take (bytes).
    pub available: Option<u64>,
}

/// The system and the kind of processor: `Linux x86_64`.
pub fn system() -> String {
    let system = match std::env::consts::OS {
        "linux" => "Linux",
        "macos" => "macOS",
        "windows" => "Windows",
        other => other,
    };
    format!("{system} {}", std::env::consts::ARCH)
}

/// Makes a file `bytes` long by writing zeros, which are on the disk afterwards.
#[cfg(any(unix, test))]
fn write_zeros(mut file: &std::fs::File, bytes: u64) -> std::io::Result<()> {
    let zeros = vec![0; 1 << 20];
    let mut left = bytes;
    while left > 0 {
        let part = left.min(zeros.len() as u64);
        std::io::Write::write_all(&mut file, &zeros[..part as usize])?;
        left -= part;
    }
    file.sync_all()
}
