//! Processors and memory on macOS.
//!
//! Facts about the machine come from the output of its commands: no system call is needed that only a
//! Mac could test, and tests on every system read such output.

#[cfg(target_os = "macos")]
use super::Memory;

/// Empty: the system binds no thread to a processor.
#[cfg(target_os = "macos")]
pub fn processors() -> Vec<usize> {
    Vec::new()
}

/// Does nothing: the system binds no thread to a processor.
#[cfg(target_os = "macos")]
pub fn stay_on(_processor: usize) {}

/// Returns the memory of the machine, by `sysctl` and `vm_stat`.
#[cfg(target_os = "macos")]
pub fn memory() -> Memory {
    Memory {
        total: output_of("/usr/sbin/sysctl", &["-n", "hw.memsize"]).and_then(|text| text.trim().parse().ok()),
        available: output_of("/usr/bin/vm_stat", &[]).and_then(|text| not_in_use(&text)),
    }
}

/// Name of the processor, by `sysctl`.
#[cfg(target_os = "macos")]
pub fn processor() -> Option<String> {
    let name = output_of("/usr/sbin/sysctl", &["-n", "machdep.cpu.brand_string"])?;
    Some(name.trim().to_owned()).filter(|name| !name.is_empty())
}

/// Output of a command.
#[cfg(target_os = "macos")]
fn output_of(command: &str, words: &[&str]) -> Option<String> {
    let output = std::process::Command::new(command).args(words).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Bytes of the pages that `vm_stat` lists as free or speculative. Inactive pages are not all
/// reclaimable, and purgeable ones are counted among the active and inactive.
pub(super) fn not_in_use(vm_stat: &str) -> Option<u64> {
    let mut lines = vm_stat.lines();
    let page = lines.next()?.split_once("page size of ")?.1.split(' ').next()?.parse::<u64>().ok()?;
    let pages = lines.filter_map(|line| {
        let (name, count) = line.split_once(':')?;
        let counts = ["Pages free", "Pages speculative"].contains(&name);
        counts.then(|| count.trim().trim_end_matches('.').parse::<u64>().ok())?
    });
    pages.sum::<u64>().checked_mul(page).filter(|bytes| *bytes > 0)
}
