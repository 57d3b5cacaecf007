//! The threads that chunks are spread over.

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

use crate::store::platform::{processors, stay_on};

/// A pool of `count` threads to run walks in (0: one for each processor that the program may use).
///
/// With `pinned`, thread `i` stays on the `i`-th of those processors, if there are as many as threads: some
/// systems keep the threads of a busy program together on one. A failure to pin (macOS cannot) is not an
/// error: results do not depend on it. Use it where the machine is for this program alone: two programs that
/// pin their threads share the same processors.
///
/// # Errors
/// Those of the system when it cannot start a thread.
///
/// ```
/// let pool = voidwalk_core::walk::threads(2, true)?;
/// assert_eq!(pool.install(rayon::current_num_threads), 2);
/// # Ok::<(), rayon::ThreadPoolBuildError>(())
/// ```
pub fn threads(count: usize, pinned: bool) -> Result<ThreadPool, ThreadPoolBuildError> {
    let processors = processors();
    let builder = ThreadPoolBuilder::new().num_threads(count).thread_name(|i| format!("walk {i}"));
    let needed = if count == 0 { processors.len() } else { count };
    if !pinned || needed < 2 || processors.len() < needed {
        return builder.build();
    }
    builder
        .start_handler(move |i| {
            if let Some(&processor) = processors.get(i) {
                stay_on(processor);
            }
        })
        .build()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pinned_threads_keep_to_processors_of_their_own() {
        let all = processors();
        let pool = threads(0, true).unwrap();
        let seen = pool.broadcast(|_| processors());
        // Windows tells the processors of a program, not of its threads, and macOS pins none.
        if cfg!(target_os = "linux") && all.len() > 1 && seen.len() == all.len() {
            assert_eq!(seen.concat(), all);
        }
        assert_eq!(threads(1, true).unwrap().broadcast(|_| processors()), [all.as_slice()]);
        assert!(threads(3, false).unwrap().broadcast(|_| processors()).iter().all(|a| *a == all));
    }
}
