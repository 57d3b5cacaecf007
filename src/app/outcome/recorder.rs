//! Records the requested data of a running walk.

use super::by_void;
use super::record::RetainedRow;
use voidwalk_core::walk::{SizeCounts, State, Tally};

/// Data to record of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// Record the sums every this many increments, and after the last; 0 records the last only. A series of
    /// more than 20,000 records is thinned: every second record is dropped, repeatedly if needed.
    pub series_every: u64,
    /// Increments after which size curves are recorded, besides the last.
    pub size_curves: Vec<u64>,
    /// Number of size classes of those curves.
    pub size_classes: usize,
    /// Increments after which the contents of each void are recorded, besides the last; `None` omits them.
    pub voids: Option<Vec<u64>>,
}

/// Rows that a series may have before it is thinned.
pub const LONGEST_SERIES: usize = 20_000;

/// Sums and size curves of one run, as recorded.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Recorder {
    /// Increment and sums.
    pub series: Vec<(u64, Tally)>,
    /// Increment, retained and eroded sizes.
    pub sizes: Vec<(u64, SizeCounts, SizeCounts)>,
    /// Contents of each void.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub voids: Vec<RetainedRow>,
    /// Number of times that the series was thinned by half.
    thinned: u32,
}

impl Recorder {
    /// Records the requested data of a state after a whole increment.
    pub fn observe(&mut self, wanted: &Wanted, state: &State) {
        let t = state.increment;
        if self.series.len() >= LONGEST_SERIES {
            self.thinned += 1;
            let every = wanted.series_every << self.thinned;
            self.series.retain(|(t, _)| t.is_multiple_of(every));
        }
        let every = wanted.series_every << self.thinned;
        if state.finished || (every > 0 && t.is_multiple_of(every)) {
            self.series.push((t, state.tally));
        }
        if state.finished || wanted.size_curves.contains(&t) {
            self.sizes.push((t, state.retained_sizes.clone(), state.eroded_sizes.clone()));
        }
        if let Some(increments) = &wanted.voids
            && (state.finished || increments.contains(&t))
        {
            self.voids.extend(by_void::retained(state));
        }
    }
}
