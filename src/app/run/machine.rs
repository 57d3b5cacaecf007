//! The machine that walks a case: threads, memory, the job of a cluster, and the number of cases at a time.

use std::panic::resume_unwind;

use super::RunError;
use crate::case::Case;
use crate::words::memory::bytes;
use voidwalk_core::store::platform;

/// System, processor and memory of this machine.
pub(super) fn description() -> String {
    let model = platform::processor().unwrap_or_else(|| "unknown processor".into());
    let total = platform::memory().total.map_or("unknown".into(), bytes);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let noun = if cores == 1 { "core" } else { "cores" };
    format!("{}, {model}, {cores} {noun}, {total} of memory", platform::system())
}

/// Memory that a run may take (bytes): that of a cluster's job, if it has less than the machine. Nothing is
/// refused if the system reports no memory.
pub(super) fn available_bytes() -> u64 {
    let of_job = Allocation::here().and_then(|job| job.memory);
    platform::memory().available.unwrap_or(u64::MAX).min(of_job.unwrap_or(u64::MAX))
}

/// Worker threads: the number asked for, else the number of a cluster's job, else one per core on which this
/// process may run.
///
/// # Errors
/// The system provides no threads.
pub fn threads(asked: Option<usize>) -> Result<rayon::ThreadPool, RunError> {
    let cores = std::thread::available_parallelism().ok().map(usize::from);
    // At most as many as this process may run on.
    let allocated = || Some(Allocation::here()?.processors?.min(cores.unwrap_or(usize::MAX)));
    let number = asked.or_else(allocated).or(cores).unwrap_or(1);
    Ok(rayon::ThreadPoolBuilder::new().num_threads(number).build()?)
}

/// Runs work on such threads.
pub(crate) fn on_threads<T: Send>(
    asked: Option<usize>,
    work: impl FnOnce() -> Result<T, RunError> + Send,
) -> Result<T, RunError> {
    threads(asked)?.install(work)
}

/// Does the same work on this many threads, including this one; on fewer if the system provides no more.
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

/// Reads a size in bytes as users write it: `4GB`, `500 MB`, `1.5GiB`.
pub(crate) fn bytes_from_words(text: &str) -> Result<u64, String> {
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

/// Job of a cluster in which the program runs, and its resources, as Slurm describes them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Allocation {
    /// Job, with its task if it belongs to an array, as Slurm writes it: `12_3`.
    pub(crate) job: String,
    processors: Option<usize>,
    /// Memory (bytes).
    memory: Option<u64>,
}

impl Allocation {
    /// The job of this process; `None` outside a job.
    pub(crate) fn here() -> Option<Self> {
        Self::of(|name| std::env::var(name).ok())
    }

    fn of(variable: impl Fn(&str) -> Option<String>) -> Option<Self> {
        let number = |name| variable(name)?.trim().parse::<u64>().ok();
        let job = match (variable("SLURM_ARRAY_JOB_ID"), variable("SLURM_ARRAY_TASK_ID")) {
            (Some(array), Some(task)) => format!("{array}_{task}"),
            _ => variable("SLURM_JOB_ID")?,
        };
        let on_node = number("SLURM_CPUS_ON_NODE");
        let processors = number("SLURM_CPUS_PER_TASK").or(on_node).filter(|n| *n > 0);
        // Megabytes of 2^20 bytes; 0 means all memory of the node.
        let per_processor = || number("SLURM_MEM_PER_CPU")?.checked_mul(on_node.or(processors)?);
        let memory = number("SLURM_MEM_PER_NODE").or_else(per_processor).filter(|megabytes| *megabytes > 0);
        Some(Self {
            job,
            processors: processors.and_then(|n| usize::try_from(n).ok()),
            memory: memory.and_then(|megabytes| megabytes.checked_mul(1 << 20)),
        })
    }
}

/// Factor on the estimated memory that a job script requests.
pub(crate) const MEMORY_MARGIN: f64 = 1.5;
/// A job is small if it takes at most this much memory for each of its threads (bytes).
const LITTLE_BYTES: u64 = 1 << 30;

/// Number of cases walked at a time: the same for the process itself, for `check`, and for the job scripts
/// that request its memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CasesAtOnce {
    pub(crate) cases: u64,
    /// Bytes that the process takes then.
    pub(crate) bytes: u64,
}

impl CasesAtOnce {
    /// Counts these cases in a job whose script requests their memory. Cases beyond those that keep the
    /// threads busy are added only if the job stays small with them: no job requests twice the memory to fill
    /// threads that idle at the end of a case.
    pub(crate) fn of_job(cases: &[&Case], threads: u64) -> Self {
        let of_room = |spare| Self::where_there_is_room(cases, threads, spare, u64::MAX);
        let with_spare = of_room(1);
        if with_spare.bytes <= threads.saturating_mul(LITTLE_BYTES) { with_spare } else { of_room(0) }
    }

    /// Counts these cases in this process.
    pub(crate) fn here(cases: &[&Case], threads: u64) -> Self {
        let in_job = Allocation::here().is_some_and(|job| job.memory.is_some());
        Self::within(cases, threads, available_bytes(), in_job)
    }

    /// Counts these cases if this many bytes are available, either to a job alone or to everything on the
    /// machine.
    fn within(cases: &[&Case], threads: u64, available: u64, in_job: bool) -> Self {
        if !in_job {
            return Self::where_there_is_room(cases, threads, 1, available / 2);
        }
        let room = (available as f64 / MEMORY_MARGIN) as u64;
        let Self { cases: most, .. } = Self::of_job(cases, threads);
        Self::at_most(most, cases, threads, room)
    }

    fn where_there_is_room(cases: &[&Case], threads: u64, spare: u64, room: u64) -> Self {
        let fewest = cases.iter().map(|case| case.scene.walk.replicates).min().unwrap_or(1);
        Self::at_most(wanted(threads, fewest, spare, cases.len()), cases, threads, room)
    }

    /// Limits the number of cases to `most`, by the room for their walks, and by the limit of each case.
    fn at_most(most: u64, cases: &[&Case], threads: u64, room: u64) -> Self {
        let allowed = cases.iter().map(|case| case.memory).min().unwrap_or(u64::MAX);
        let largest = cases.iter().map(|case| case.peak_bytes(threads)).max().unwrap_or(0);
        let count = most.min(allowed.min(room) / largest.max(1)).max(1);
        // Particles that do not fit into memory go into files.
        let walks = largest.saturating_mul(count).min(allowed);
        let bytes = cases.iter().map(|case| case.program_bytes(walks)).max().unwrap_or(walks);
        Self { cases: count, bytes }
    }
}

/// Number of these cases to walk at a time, regardless of memory, if each has at least this many replicates:
/// enough to give each thread a replicate, and `spare` more for threads that wait for the last replicate or
/// the page of another case.
fn wanted(threads: u64, replicates: u64, spare: u64, cases: usize) -> u64 {
    let spare = if threads > 1 { spare } else { 0 };
    (threads.div_ceil(replicates.max(1)) + spare).clamp(1, cases.max(1) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::case_of;

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

    fn allocation(variables: &[(&str, &str)]) -> Option<Allocation> {
        let find = |name: &str| variables.iter().find(|(key, _)| *key == name);
        Allocation::of(|name| find(name).map(|(_, value)| (*value).to_string()))
    }

    #[test]
    fn what_slurm_says_is_understood() {
        assert_eq!(allocation(&[("HOME", "/root")]), None);
        let task = allocation(&[
            ("SLURM_JOB_ID", "14"),
            ("SLURM_ARRAY_JOB_ID", "12"),
            ("SLURM_ARRAY_TASK_ID", "3"),
            ("SLURM_CPUS_PER_TASK", "4"),
            ("SLURM_CPUS_ON_NODE", "8"),
            ("SLURM_MEM_PER_NODE", "600"),
        ]);
        let wanted = Allocation { job: "12_3".into(), processors: Some(4), memory: Some(600 << 20) };
        assert_eq!(task, Some(wanted));
        let by_processor =
            allocation(&[("SLURM_JOB_ID", "14"), ("SLURM_CPUS_ON_NODE", "8"), ("SLURM_MEM_PER_CPU", "100")])
                .unwrap();
        assert_eq!(by_processor.memory, Some(800 << 20));
        assert_eq!((by_processor.processors, by_processor.job.as_str()), (Some(8), "14"));
        let all = allocation(&[("SLURM_JOB_ID", "14"), ("SLURM_MEM_PER_NODE", "0")]).unwrap();
        assert_eq!((all.memory, all.processors), (None, None));
    }

    fn case(n_base: u64, replicates: u64) -> Case {
        let settings = [&*format!("base.n_base={n_base}"), &*format!("replicates={replicates}")];
        Case { memory: u64::MAX, ..case_of(&settings) }
    }

    #[test]
    fn one_thread_walks_one_case_and_several_have_one_to_spare() {
        let number = |threads, replicates, cases| wanted(threads, replicates, 1, cases);
        assert_eq!([number(1, 5, 9), number(2, 5, 9), number(2, 1, 9), number(64, 10, 99)], [1, 2, 3, 8]);
        assert_eq!([number(2, 5, 1), number(64, 1, 7), number(2, 0, 0)], [1, 7, 1]);
        assert_eq!([wanted(4, 10, 0, 9), wanted(64, 10, 0, 99)], [1, 7]);
    }

    /// A job requests the memory of the cases that it will walk at a time, however large they are.
    #[test]
    fn a_job_walks_as_many_cases_as_its_script_asked_for() {
        let mut numbers = Vec::new();
        for (n_base, replicates, threads) in
            [(300_000_000, 10, 4), (300_000_000, 10, 64), (50_000_000, 3, 8), (20_000, 10, 4), (20_000, 1, 2)]
        {
            let case = case(n_base, replicates);
            let cases = vec![&case; 20];
            let job = CasesAtOnce::of_job(&cases, threads);
            let asked = (MEMORY_MARGIN * job.bytes as f64) as u64;
            // A script rounds up to the next 100 MiB.
            for available in [asked, asked + (100 << 20)] {
                let inside = Case { memory: available / 5 * 4, ..case.clone() };
                let inside = vec![&inside; 20];
                let walked = CasesAtOnce::within(&inside, threads, available, true);
                assert_eq!(walked.cases, job.cases, "{n_base} {replicates} {threads}");
                assert!(walked.bytes <= available, "{walked:?} of {available}");
            }
            numbers.push(job.cases);
        }
        assert_eq!(numbers, [1, 8, 4, 2, 3]);
    }

    #[test]
    fn half_of_a_machine_that_others_use_too_has_room_for_the_walks() {
        let case = case(300_000_000, 10);
        let (cases, largest) = ([&case, &case], case.peak_bytes(4));
        let number = |available| CasesAtOnce::within(&cases, 4, available, false).cases;
        assert_eq!([number(0), number(4 * largest - 2), number(4 * largest)], [1, 1, 2]);
        let little = Case { memory: 2 * largest - 1, ..case.clone() };
        assert_eq!(CasesAtOnce::within(&[&little, &little], 4, u64::MAX, false).cases, 1);
    }
}
