//! Processors, memory and blocks of files on Linux.

use std::fs::{File, read_to_string};
use std::io;

use rustix::fs::FallocateFlags;
use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};

use super::{Memory, cgroup, write_zeros};

/// Makes a file `bytes` long with every block allocated: by the file system, or else by writing.
pub fn allocate(file: &File, bytes: u64) -> io::Result<()> {
    match rustix::fs::fallocate(file, FallocateFlags::empty(), 0, bytes) {
        Err(rustix::io::Errno::OPNOTSUPP) => write_zeros(file, bytes),
        other => Ok(other?),
    }
}

/// Processors that this thread may use, by their numbers.
pub fn processors() -> Vec<usize> {
    match sched_getaffinity(None) {
        Ok(set) => (0..CpuSet::MAX_CPU).filter(|&processor| set.is_set(processor)).collect(),
        Err(_) => Vec::new(),
    }
}

/// Keeps this thread on a processor. If refused, the system places the thread.
pub fn stay_on(processor: usize) {
    let mut one = CpuSet::new();
    one.set(processor);
    let _ = sched_setaffinity(None, &one);
}

/// Memory of the machine, and the part that the groups of this process leave it.
pub fn memory() -> Memory {
    let text = read_to_string("/proc/meminfo").unwrap_or_default();
    let bytes = |key: &str| -> Option<u64> {
        let line = text.lines().find(|line| line.starts_with(key))?;
        Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? * 1024)
    };
    // A container has its share of the machine.
    let available = bytes("MemAvailable:").into_iter().chain(cgroup::memory_left()).min();
    Memory { total: bytes("MemTotal:"), available }
}

/// Name of the processor.
pub fn processor() -> Option<String> {
    let text = read_to_string("/proc/cpuinfo").ok()?;
    let (_, name) = text.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "))?;
    Some(name.to_owned())
}

/// Table of the mounts, in the form of `/proc/self/mountinfo`.
pub fn mounts() -> Option<String> {
    read_to_string("/proc/self/mountinfo").ok()
}
