//! Number of cases that a process walks at the same time, and their memory: one answer for the process
//! itself, for `check`, and for the job scripts that ask for its memory.

use super::allocation::Allocation;
use super::machine::Machine;
use crate::case::Case;

/// Factor on the estimated memory in the request of a job script.
pub const MEMORY_MARGIN: f64 = 1.5;

/// A job takes little that takes no more than this for each of its threads (bytes).
const LITTLE_BYTES: u64 = 1 << 30;

/// Cases that are walked at the same time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CasesAtOnce {
    /// Number of cases.
    pub cases: u64,
    /// Bytes that the process takes then.
    pub bytes: u64,
}

impl CasesAtOnce {
    /// Counts these cases in a job whose script asks for their memory. A case beside those that keep the
    /// threads busy is added if the job takes little memory with it: no job asks for twice the memory to fill
    /// threads that idle at the end of a case.
    pub fn of_job(cases: &[&Case], threads: u64) -> Self {
        let with_spare = Self::where_there_is_room(cases, threads, 1, u64::MAX);
        match with_spare.bytes <= threads.saturating_mul(LITTLE_BYTES) {
            true => with_spare,
            false => Self::where_there_is_room(cases, threads, 0, u64::MAX),
        }
    }

    /// Counts these cases in this process.
    pub fn here(cases: &[&Case], threads: u64) -> Self {
        let in_job = Allocation::here().is_some_and(|job| job.memory.is_some());
        Self::within(cases, threads, Machine::here().available, in_job)
    }

    /// Counts these cases if this many bytes are available: to a job alone, or to all that runs on the
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

    /// Limits the number of cases by `most`, by the room for their walks, and by the limit of each case.
    fn at_most(most: u64, cases: &[&Case], threads: u64, room: u64) -> Self {
        let allowed = cases.iter().map(|case| case.memory).min().unwrap_or(u64::MAX);
        let largest = largest(cases, threads);
        let count = most.min(allowed.min(room) / largest.max(1)).max(1);
        // Particles that do not fit into memory go into files.
        let walks = largest.saturating_mul(count).min(allowed);
        let bytes = cases.iter().map(|case| case.program_bytes(walks)).max().unwrap_or(walks);
        Self { cases: count, bytes }
    }
}

/// Number of these cases to walk at the same time, memory aside, if each has at least this many replicates:
/// enough to give each thread a replicate, and `spare` more for the threads that wait for the last replicate
/// or the page of another.
fn wanted(threads: u64, replicates: u64, spare: u64, cases: usize) -> u64 {
    let spare = if threads > 1 { spare } else { 0 };
    (threads.div_ceil(replicates.max(1)) + spare).clamp(1, cases.max(1) as u64)
}

/// The most bytes that the walks of one of the cases take.
fn largest(cases: &[&Case], threads: u64) -> u64 {
    cases.iter().map(|case| case.peak_bytes(threads)).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    fn case(n_base: u64, replicates: u64) -> Case {
        let (particles, replicates) = (format!("base.n_base={n_base}"), format!("replicates={replicates}"));
        let mut case = Case::new(Scene::built_in(&[particles, replicates]).unwrap()).unwrap();
        case.memory = u64::MAX;
        case
    }

    #[test]
    fn one_thread_walks_one_case_and_several_have_one_to_spare() {
        let number = |threads, replicates, cases| wanted(threads, replicates, 1, cases);
        assert_eq!([number(1, 5, 9), number(2, 5, 9), number(2, 1, 9), number(64, 10, 99)], [1, 2, 3, 8]);
        assert_eq!([number(2, 5, 1), number(64, 1, 7), number(2, 0, 0)], [1, 7, 1]);
        assert_eq!([wanted(4, 10, 0, 9), wanted(64, 10, 0, 99)], [1, 7]);
    }

    /// A job asks for the memory of the cases that it then walks, however large they are.
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
                let mut inside = case.clone();
                inside.memory = available / 5 * 4;
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
        let mut little = case.clone();
        little.memory = 2 * largest - 1;
        assert_eq!(CasesAtOnce::within(&[&little, &little], 4, u64::MAX, false).cases, 1);
    }
}
