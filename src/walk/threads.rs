//! The threads that chunks are spread over.

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};

/// A pool of `count` threads to run walks in (0: one for each processor that the program may use).
///
/// With `pinned`, thread `i` stays on the `i`-th of those processors, where there are as many as threads:
/// some systems keep the threads of a busy program together on one. Whether it could is not an error: results
/// do not depend on it. Use it where the machine is for this program alone: two programs that pin their
/// threads share the same processors.
///
/// # Errors
/// What the system says when it cannot start a thread.
///
/// ```
/// let pool = voidwalk::walk::threads(2, true)?;
/// assert_eq!(pool.install(rayon::current_num_threads), 2);
/// # Ok::<(), rayon::ThreadPoolBuildError>(())
/// ```
pub fn threads(count: usize, pinned: bool) -> Result<ThreadPool, ThreadPoolBuildError> {
    let processors = allowed();
    let builder = ThreadPoolBuilder::new().num_threads(count).thread_name(|i| format!("walk {i}"));
    let needed = if count == 0 { processors.len() } else { count };
    if !pinned || needed < 2 || processors.len() < needed {
        return builder.build();
    }
    builder
        .start_handler(move |i| {
            let mut one = CpuSet::new();
            if let Some(&processor) = processors.get(i) {
                one.set(processor);
                // Refused: the thread goes where the system puts it.
                let _ = sched_setaffinity(None, &one);
            }
        })
        .build()
}

/// Processors that this program may use.
fn allowed() -> Vec<usize> {
    match sched_getaffinity(None) {
        Ok(set) => (0..CpuSet::MAX_CPU).filter(|&processor| set.is_set(processor)).collect(),
        Err(_) => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pinned_threads_keep_to_processors_of_their_own() {
        let all = allowed();
        let pool = threads(0, true).unwrap();
        let seen = pool.broadcast(|_| allowed());
        if all.len() > 1 && seen.len() == all.len() {
            assert_eq!(seen.concat(), all);
        }
        assert_eq!(threads(1, true).unwrap().broadcast(|_| allowed()), [all.as_slice()]);
        assert!(threads(3, false).unwrap().broadcast(|_| allowed()).iter().all(|a| *a == all));
    }
}
