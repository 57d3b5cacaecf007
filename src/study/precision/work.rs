//! Work side by side, each piece on one thread, and the processor time it takes.

use super::study::{PrecisionStudy, stopped};
use crate::run::error::RunError;
use crate::run::machine::on_each;
pub(super) use crate::store::platform::{process_seconds as all_threads, thread_seconds as this_thread};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What some work gives, and the processor time of this thread that it takes (s).
pub(super) fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let begun = this_thread();
    let made = work();
    (made, this_thread() - begun)
}

/// The sum of what `work` gives, piece after piece, and the processor time of this thread that all of it
/// takes (s).
pub(super) fn summed(
    mut pieces: impl Iterator<Item = u64>,
    work: impl Fn(u64) -> Result<u64, RunError>,
) -> Result<(u64, f64), RunError> {
    let (sum, seconds) = timed(|| pieces.try_fold(0, |sum, piece| Ok::<_, RunError>(sum + work(piece)?)));
    Ok((sum?, seconds))
}

impl PrecisionStudy<'_> {
    /// `work(0 .. count)`, pieces side by side, each on one thread alone; in order.
    pub(super) fn side_by_side<T: Send>(
        &self,
        count: usize,
        work: impl Fn(usize) -> Result<T, RunError> + Sync,
    ) -> Result<Vec<T>, RunError> {
        let next = AtomicUsize::new(0);
        let done: Mutex<Vec<(usize, Result<T, RunError>)>> = Mutex::new(Vec::new());
        let worker = || -> Result<(), RunError> {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
            loop {
                let piece = next.fetch_add(1, Ordering::Relaxed);
                if piece >= count {
                    return Ok(());
                }
                if self.callbacks.is_stopped() {
                    return Err(stopped());
                }
                let made = pool.install(|| work(piece));
                done.lock().unwrap_or_else(|e| e.into_inner()).push((piece, made));
            }
        };
        on_each(self.threads.clamp(1, count.max(1)), worker)?;
        let mut done = done.into_inner().unwrap_or_else(|e| e.into_inner());
        done.sort_by_key(|(piece, _)| *piece);
        done.into_iter().map(|(_, made)| made).collect()
    }
}

/// How many of something a budget pays for, between the least and the most that make sense.
pub(super) fn affordable(budget_s: f64, each_s: f64, least: u64, most: u64) -> u64 {
    ((budget_s / each_s.max(1e-9)) as u64).clamp(least, most)
}
