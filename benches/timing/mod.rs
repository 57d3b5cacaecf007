//! Times a piece of work ten times over: the least, the median, and how much of it that is in a second.

use std::time::Duration;

const SAMPLES: usize = 10;
/// A sample does the work as often as it takes to last so long.
const LEAST_OF_A_SAMPLE: Duration = Duration::from_millis(100);

/// Times the work and prints a line, unless the command line names others by a part of their name. `spent` does the work
/// so often and says how long that took; `elements` are what is done of it each time.
pub fn time(name: &str, elements: u64, mut spent: impl FnMut(u32) -> Duration) {
    let asked: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    if !asked.is_empty() && !asked.iter().any(|part| name.contains(part.as_str())) {
        return;
    }
    let once = spent(1).max(Duration::from_nanos(1));
    let times = (LEAST_OF_A_SAMPLE.as_secs_f64() / once.as_secs_f64()).ceil().max(1.0) as u32;
    let mut seconds: Vec<f64> = (0..SAMPLES).map(|_| spent(times).as_secs_f64() / f64::from(times)).collect();
    seconds.sort_by(f64::total_cmp);
    let median = (seconds[SAMPLES / 2 - 1] + seconds[SAMPLES / 2]) / 2.0;
    let rate = elements as f64 / median;
    println!("{name}: {:.4e} s at least, {median:.4e} s by the median, {rate:.4e} in a second", seconds[0]);
}
