//! Requested data of a running walk, and events in each void and constriction, for pictures.

use super::record::{BlockedRow, ConstrictionRow, RetainedRow};
use voidwalk_core::network::Network;
use voidwalk_core::walk::{SizeCounts, State, Tally};

/// Data to record of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// Interval of the records of sums, in increments; the last is always recorded, and 0 records only it. A
    /// series over 20,000 records is thinned: every second record is dropped, repeatedly if needed.
    pub series_every: u64,
    /// Increments after which size curves are recorded, in addition to the last.
    pub size_curves: Vec<u64>,
    /// Number of size classes of these curves.
    pub size_classes: usize,
    /// Increments after which each void's contents are recorded, in addition to the last; `None` omits them.
    pub voids: Option<Vec<u64>>,
}

/// Maximum rows of a series before it is thinned.
const LONGEST_SERIES: usize = 20_000;

/// Sums and size curves of one run, as recorded.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct Recorder {
    /// Increment and sums.
    pub(crate) series: Vec<(u64, Tally)>,
    /// Increment, retained and eroded sizes.
    pub(crate) sizes: Vec<(u64, SizeCounts, SizeCounts)>,
    /// Contents of each void.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) voids: Vec<RetainedRow>,
    /// Number of times the series was thinned by half.
    thinned: u32,
}

impl Recorder {
    /// Records the requested data of a state after a whole increment.
    pub(crate) fn observe(&mut self, wanted: &Wanted, state: &State) {
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
            self.voids.extend(retained(state));
        }
    }
}

/// Number of a void that represents the outside.
const OUTSIDE: i64 = -1;

/// Positions of voids, for pictures: no result depends on them. Water flows along z, from 0.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Places {
    /// Position (mm) of each void of the filter.
    pub(crate) point_mm: Vec<[f64; 3]>,
    /// Lengths (mm) over which the network repeats along x and y.
    pub(crate) period_mm: [f64; 2],
    /// Thickness of a layer (mm).
    pub(crate) layer_mm: f64,
}

impl Places {
    /// Vector (mm) from one void to the nearest image of another; half a layer if either lies outside.
    fn vector(&self, from: i64, to: i64) -> [f64; 3] {
        let point = |void: i64| usize::try_from(void).ok().and_then(|void| self.point_mm.get(void));
        let (Some(from), Some(to)) = (point(from), point(to)) else { return [0.0, 0.0, 0.5 * self.layer_mm] };
        let mut vector = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
        for (length, period) in vector.iter_mut().zip(self.period_mm) {
            *length -= period * (*length / period).round();
        }
        vector
    }
}

/// Constrictions of a network whose voids have these positions, each once.
pub(crate) fn constrictions(network: &Network, places: &Places) -> Vec<ConstrictionRow> {
    let filter = network.filter_voids() as u32;
    let mut rows = Vec::with_capacity(network.passages());
    for void in 0..network.voids() as u32 {
        for exit in network.exits(void).filter(|&exit| network.counts(exit)) {
            let target = network.targets()[exit];
            // The reservoir is not a void of the filter; a constriction to it counts as leading in from it.
            let (from, to) = match (void < filter, network.reservoir() == Some(target)) {
                (true, true) => (OUTSIDE, i64::from(void)),
                (true, false) if target < filter => (i64::from(void), i64::from(target)),
                (true, false) => (i64::from(void), OUTSIDE),
                (false, _) => (OUTSIDE, i64::from(target)),
            };
            let [dx_mm, dy_mm, dz_mm] = places.vector(from, to);
            rows.push(ConstrictionRow {
                constriction: network.either_way(exit) as u64,
                from,
                to,
                dx_mm,
                dy_mm,
                dz_mm,
                diameter_mm: f64::from(network.diameters()[exit]) * network.unit_mm(),
                conductance: network.conductance(exit),
            });
        }
    }
    rows
}

/// Constrictions blocked in a run, in the order of blocking.
pub(crate) fn blocked(network: &Network, state: &State) -> Vec<BlockedRow> {
    let row = |blocking: &voidwalk_core::walk::Blocking| BlockedRow {
        run: state.run,
        increment: blocking.increment,
        constriction: network.either_way(blocking.constriction as usize) as u64,
    };
    state.history.iter().map(row).collect()
}

/// Voids with retained particles of a run, and void 0, so that the increment is recorded even if no void
/// has any.
fn retained(state: &State) -> Vec<RetainedRow> {
    let counts = state.retained_in_constrictions.iter().zip(&state.retained_in_voids);
    (0i64..)
        .zip(counts)
        .filter(|(void, (in_constrictions, in_void))| *void == 0 || **in_constrictions + **in_void > 0)
        .map(|(void, (&retained_in_constrictions, &retained_in_voids))| RetainedRow {
            run: state.run,
            increment: state.increment,
            void,
            retained_in_constrictions,
            retained_in_voids,
        })
        .collect()
}

/// Rows with the reservoir upstream of the filter as the outside instead of the void after the last.
pub(crate) fn of_filter(network: &Network, rows: &[RetainedRow]) -> Vec<RetainedRow> {
    let filter = network.filter_voids() as i64;
    let void = |row: &RetainedRow| if row.void < filter { row.void } else { OUTSIDE };
    rows.iter().map(|row| RetainedRow { void: void(row), ..row.clone() }).collect()
}
