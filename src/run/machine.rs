//! What machine a case runs on, and how much memory it may use.

use super::allocation::Allocation;

/// The machine, in words.
pub struct Machine {
    /// Name of the machine.
    pub host: String,
    /// System, processor and memory.
    pub description: String,
    /// Memory that a run may take (bytes).
    pub available: u64,
}

impl Machine {
    /// Asks the system.
    pub fn here() -> Self {
        let name = rustix::system::uname();
        let read = |file: &str| std::fs::read_to_string(file).unwrap_or_default();
        let meminfo = read("/proc/meminfo");
        let kib = |key: &str| -> Option<u64> {
            let line = meminfo.lines().find(|line| line.starts_with(key))?;
            line.split_whitespace().nth(1)?.parse().ok()
        };
        let cpuinfo = read("/proc/cpuinfo");
        let model = cpuinfo.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
        let model = model.map_or("unknown processor", |(_, model)| model);
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let total = kib("MemTotal:").map_or("unknown".into(), |k| crate::case::in_words(k * 1024));
        Self {
            host: name.nodename().to_string_lossy().into_owned(),
            description: format!(
                "{} {}, {model}, {cores} cores, {total} of memory",
                name.sysname().to_string_lossy(),
                name.machine().to_string_lossy()
            ),
            // Without word from the system, nothing is refused. A cluster's job has its share of the machine.
            available: kib("MemAvailable:")
                .map_or(u64::MAX, |k| k * 1024)
                .min(Allocation::here().and_then(|job| job.memory).unwrap_or(u64::MAX)),
        }
    }
}
