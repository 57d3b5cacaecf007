//! Services that differ between systems: locks, reads at an offset, guarantees of the disk, processors,
//! clocks, memory and signals.
//!
//! No other file of the program names a system or a system's crate (`tests/house.rs` checks this). Each file
//! here offers the same calls; the page on long runs (`voidwalk::docs`) lists what a system cannot guarantee.
//!
//! | file | systems |
//! |---|---|
//! | `unix.rs` | files and clocks of Linux and macOS |
//! | `linux.rs` | processors and memory on Linux |
//! | `macos.rs` | processors and memory on macOS |
//! | `windows.rs` | Windows |
//! | `other.rs` | any other, such as a page in a browser: no locks, no affinity, machine unknown |
//! | `process.rs` | requests to end the program; freed memory that it keeps on Linux with glibc |

#[cfg(target_os = "linux")]
mod linux;
#[cfg(any(target_os = "macos", test))]
mod macos;
#[cfg(not(any(target_os = "linux", target_os = "macos", windows)))]
mod other;
#[cfg(feature = "process")]
pub mod process;
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

pub(super) use files::{allocate, has_other_names, is_running, open_any, open_own};
pub(super) use files::{read_exact_at, sync_folder, try_lock};

pub use files::{THREAD_SECONDS_STEP, free_bytes, host_name, thread_seconds};
#[cfg(target_os = "linux")]
pub use machine::mounts;
pub use machine::{memory, processor, processors};

pub(crate) use machine::stay_on;

/// `None`: only Linux has a table of mounts.
#[cfg(not(target_os = "linux"))]
pub fn mounts() -> Option<String> {
    None
}

/// Memory of the machine; `None` if the system does not report it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Memory {
    /// Installed memory (bytes).
    pub total: Option<u64>,
    /// Memory that this process may still take (bytes).
    pub available: Option<u64>,
}

/// Names the system and the kind of processor: `Linux x86_64`.
pub fn system() -> String {
    let system = match std::env::consts::OS {
        "linux" => "Linux",
        "macos" => "macOS",
        "windows" => "Windows",
        other => other,
    };
    format!("{system} {}", std::env::consts::ARCH)
}

/// Makes a file `bytes` long by writing zeros, and syncs it.
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

#[cfg(test)]
mod tests {
    use std::fs::{self, File, TryLockError};
    use std::io::ErrorKind;
    use std::path::PathBuf;
    use std::time::{Duration, Instant};

    use super::*;

    fn file_of(text: &str) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        fs::write(&path, text).unwrap();
        (folder, path)
    }

    /// Two handles of one process exclude each other, as two processes do.
    #[test]
    fn a_locked_file_keeps_others_out_and_is_read_by_all() {
        let (_folder, path) = file_of("who holds it");
        let open = || open_own(File::options().read(true).write(true), &path).unwrap();
        let would_block = |locked| matches!(locked, Err(TryLockError::WouldBlock));
        let first = open();
        try_lock(&first, false).unwrap();
        assert!(would_block(try_lock(&open(), false)) && would_block(try_lock(&open(), true)));
        assert_eq!(fs::read_to_string(&path).unwrap(), "who holds it");
        drop(first);
        let shared = [open(), open()];
        shared.iter().for_each(|file| try_lock(file, true).unwrap());
        assert!(would_block(try_lock(&open(), false)));
        drop(shared);
        try_lock(&open(), false).unwrap();
    }

    #[test]
    fn a_file_is_read_from_any_place_and_no_further_than_its_end() {
        let (_folder, path) = file_of("0123456789");
        let file = open_any(File::options().read(true), &path).unwrap();
        let mut bytes = [0; 4];
        for (offset, text) in [(6, b"6789"), (0, b"0123"), (3, b"3456")] {
            read_exact_at(&file, &mut bytes, offset).unwrap();
            assert_eq!(&bytes, text);
        }
        for offset in [7, 10, 1 << 40] {
            assert_eq!(
                read_exact_at(&file, &mut bytes, offset).unwrap_err().kind(),
                ErrorKind::UnexpectedEof
            );
        }
    }

    #[test]
    fn a_second_name_of_a_file_is_seen() {
        let (folder, path) = file_of("");
        let has = || has_other_names(&File::open(&path).unwrap()).unwrap();
        assert!(!has());
        fs::hard_link(&path, folder.path().join("other")).unwrap();
        assert!(has());
    }

    #[test]
    #[cfg_attr(miri, ignore = "Miri knows no such calls")]
    fn a_file_is_made_as_long_as_was_asked_for() {
        let (folder, path) = file_of("");
        let file = File::options().write(true).open(&path).unwrap();
        allocate(&file, 3_000_001).unwrap();
        let other = File::create(folder.path().join("other")).unwrap();
        write_zeros(&other, 3_000_001).unwrap();
        for file in [file, other] {
            assert_eq!(file.metadata().unwrap().len(), 3_000_001);
        }
        assert!(free_bytes(folder.path()).unwrap() > 0 && free_bytes(&folder.path().join("none")).is_none());
        sync_folder(folder.path()).unwrap();
    }

    #[test]
    #[cfg_attr(miri, ignore = "Miri knows no such calls")]
    fn a_process_runs_until_it_has_ended() {
        assert!(is_running(&std::process::id().to_string()));
        for none in ["", "x", "-1", "4999999", "99999999999"] {
            assert!(!is_running(none), "{none}");
        }
    }

    /// Processor time passes only with work.
    #[test]
    #[cfg_attr(miri, ignore = "Miri knows no such calls")]
    fn processor_time_passes_while_there_is_work() {
        let thread = thread_seconds();
        let begun = Instant::now();
        while thread_seconds() - thread < 0.05 && begun.elapsed() < Duration::from_secs(60) {
            std::hint::black_box((0..10_000u64).fold(1u64, |a, b| a.wrapping_mul(b | 1)));
        }
        let worked = thread_seconds() - thread;
        assert!((0.05..60.0).contains(&worked), "{worked}");
    }

    #[test]
    #[cfg_attr(miri, ignore = "Miri knows no such calls")]
    fn the_machine_says_what_it_is() {
        assert!(!host_name().is_empty() && system().contains(' '));
        let Memory { total, available } = memory();
        let (total, available) = (total.unwrap(), available.unwrap());
        assert!(total > 1 << 26 && available <= total, "{available} of {total}");
        let all = processors();
        assert!(cfg!(target_os = "macos") || !all.is_empty());
        assert!(all.is_sorted());
    }

    /// Uses output in the form of a Mac's.
    #[test]
    fn free_memory_of_a_mac_is_read() {
        let text = "Mach Virtual Memory Statistics: (page size of 16384 bytes)\n\
            Pages free:                               10.\n\
            Pages inactive:                          200.\n\
            Pages speculative:                      3000.\n\
            Pages purgeable:                       40000.\n";
        assert_eq!(macos::not_in_use(text), Some(3010 * 16_384));
        for other in ["", "Pages free: 1.", "(page size of x bytes)\n", "(page size of 4096 bytes)\n"] {
            assert_eq!(macos::not_in_use(other), None, "{other}");
        }
    }
}
