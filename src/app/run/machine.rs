//! The machine of a case: number of threads, and memory that it may use.

use std::panic::resume_unwind;

use super::allocation::Allocation;
use super::error::RunError;
use voidwalk_core::store::platform;

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
        let memory = platform::memory();
        let model = platform::processor().unwrap_or_else(|| "unknown processor".into());
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let total = memory.total.map_or("unknown".into(), crate::case::in_words);
        Self {
            host: platform::host_name(),
            description: format!(
                "{}, {model}, {cores} {}, {total} of memory",
                platform::system(),
                if cores == 1 { "core" } else { "cores" }
            ),
            // Without word from the system, nothing is refused. A cluster's job has its share of the
            // machine.
            available: memory
                .available
                .unwrap_or(u64::MAX)
                .min(Allocation::here().and_then(|job| job.memory).unwrap_or(u64::MAX)),
        }
    }
}

/// Worker threads: the number that is asked for, else the number that a cluster's job has, else one per core
/// on which this process may run.
///
/// # Errors
/// The system gives no threads.
pub fn threads(asked: Option<usize>) -> Result<rayon::ThreadPool, RunError> {
    Ok(rayon::ThreadPoolBuilder::new().num_threads(number_of_threads(asked)).build()?)
}

/// Number of worker threads.
pub fn number_of_threads(asked: Option<usize>) -> usize {
    let allocated = || Allocation::here().and_then(|job| job.threads());
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    asked.or_else(allocated).unwrap_or_else(cores)
}

/// Does some work on such threads.
pub(crate) fn on_threads<T: Send>(
    asked: Option<usize>,
    work: impl FnOnce() -> Result<T, RunError> + Send,
) -> Result<T, RunError> {
    threads(asked)?.install(work)
}

/// Does the same work on this many threads, this one included; on fewer if the system gives no more.
///
/// # Errors
/// The first error of the work.
pub(crate) fn on_each(count: usize, work: impl Fn() -> Result<(), RunError> + Sync) -> Result<(), RunError> {
    std::thread::scope(|scope| {
        let start = |_| std::thread::Builder::new().spawn_scoped(scope, &work).ok();
        let threads: Vec<_> = (1..count).map_while(start).collect();
        let here = work();
        let joined =
            threads.into_iter().map(|thread| thread.join().unwrap_or_else(|panic| resume_unwind(panic)));
        joined.fold(here, Result::and)
    })
}

/// A size in bytes as a user writes it: `4GB`, `500 MB`, `1.5GiB`.
///
/// # Errors
/// The form that is expected.
pub fn bytes_from_words(text: &str) -> Result<u64, String> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = match text[digits.len()..].to_lowercase().as_str() {
        "" | "b" => 1.0,
        "kb" => 1e3,
        "mb" => 1e6,
        "gb" => 1e9,
        "tb" => 1e12,
        "kib" => 1024.0,
        "mib" => 1_048_576.0,
        "gib" => 1_073_741_824.0,
        "tib" => 1_099_511_627_776.0,
        _ => return Err("write a size as 4GB, 500MB or 2GiB".into()),
    };
    match digits.trim().parse::<f64>() {
        Ok(number) if number > 0.0 && number * unit < 1e18 => Ok((number * unit) as u64),
        _ => Err("write a size above 0 as 4GB, 500MB or 2GiB".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::bytes_from_words;

    #[test]
    fn sizes_are_read_with_their_units() {
        for (text, size) in
            [("4GB", 4_000_000_000), ("500 mb", 500_000_000), ("1.5GiB", 1_610_612_736), ("77", 77)]
        {
            assert_eq!(bytes_from_words(text), Ok(size));
        }
        for text in ["", "GB", "-1GB", "0", "4 apples", "nan", "inf", "1e30TB"] {
            assert!(bytes_from_words(text).is_err(), "{text}");
        }
    }
}
