//! Numbers of one run at its end, and its rows in the CSV files.

use super::record::{
    BlockedRow, ByConnectivity, FlowRow, LayerRow, Replicate, RetainedRow, Run, SeriesRow, SizeRow,
};
use super::recorder::{self, Recorder};
use super::verdict::{below_by_count, below_by_mass};
use std::collections::BTreeMap;
use voidwalk_core::network::Network;
use voidwalk_core::walk::{FlowRecord, Retention, SizeClasses, SizeCounts, State, Tally};

/// Run of a replicate, and the reference sizes of its numbers.
#[derive(Clone, Copy, Debug)]
pub struct RunId {
    /// Replicate, counted from 1.
    pub replicate: u64,
    /// Run, counted from 1.
    pub run: u64,
    /// D15F (mm).
    pub d15f_mm: f64,
    /// Mass fraction of the base that is finer than the finest sieve.
    pub pan_fraction: f64,
}

/// Numbers of one run at its end.
#[derive(Clone, Debug)]
pub struct RunMetrics {
    /// Entry of the run in `outcome.json`.
    pub run: Run,
    /// True if less than 7.5 % of the mass eroded.
    pub(crate) below_threshold: bool,
    /// Rows of `layers.csv`.
    pub(crate) layers: Vec<LayerRow>,
}

/// Rows of one run in the CSV files.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Recorded {
    /// Rows of `series.csv`.
    pub series: Vec<SeriesRow>,
    /// Rows of `layers.csv`.
    pub layers: Vec<LayerRow>,
    /// Rows of `retained.csv`.
    pub retained: Vec<SizeRow>,
    /// Rows of `eroded.csv`.
    pub eroded: Vec<SizeRow>,
    /// Rows of `flow.csv`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub flow: Vec<FlowRow>,
    /// Rows of `retained_by_void.csv`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub voids: Vec<RetainedRow>,
    /// Rows of `blocked.csv`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub blocked: Vec<BlockedRow>,
}

/// Mass eroded over the total mass that the run inserts.
///
/// The pan fraction is passive: the same fraction of it erodes as of the passive particles, and all of it
/// if the base has none.
fn eroded_mass_fraction(tally: &Tally, end: &Tally, pan_fraction: f64) -> f64 {
    let sized = match end.inserted_mass > 0.0 {
        // Masses added in different orders may differ in their last bits.
        true => (tally.eroded_mass / end.inserted_mass).min(1.0),
        false => 0.0,
    };
    if pan_fraction == 0.0 {
        return sized;
    }
    let of_pan = match end.passive_inserted {
        0 => tally.inserted as f64 / end.inserted.max(1) as f64,
        n => tally.passive_eroded as f64 / n as f64,
    };
    (1.0 - pan_fraction) * sized + pan_fraction * of_pan
}

/// Mass eroded in a finished run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Eroded {
    /// Mass eroded over the mass inserted.
    pub(crate) mass_fraction: f64,
    /// True if less than 7.5 % of the mass eroded.
    pub(crate) below_threshold: bool,
}

impl Eroded {
    /// Reads a run that has ended, with a base of this pan fraction by mass.
    pub(crate) fn of(state: &State, pan_fraction: f64) -> Self {
        let tally = &state.tally;
        let mass_fraction = eroded_mass_fraction(tally, tally, pan_fraction);
        let one_size = state.classes.upper().len() == 1 && pan_fraction == 0.0;
        let below_threshold = match one_size {
            true => below_by_count(tally.eroded, tally.inserted),
            false if pan_fraction == 0.0 => below_by_mass(tally.eroded_mass, tally.inserted_mass),
            false => below_by_mass(mass_fraction, 1.0),
        };
        Self { mass_fraction, below_threshold }
    }
}

impl RunMetrics {
    /// Numbers of a finished run, which took `seconds` of wall time, with the network as it is at its end.
    pub fn new(network: &Network, state: &State, flow: Option<&FlowRecord>, id: RunId, seconds: f64) -> Self {
        let tally = &state.tally;
        let Eroded { mass_fraction: eroded_mass_fraction, below_threshold } =
            Eroded::of(state, id.pan_fraction);
        let largest_mm = (tally.eroded > 0).then(|| f64::from(tally.largest_eroded) * network.unit_mm());
        let retained = tally.retained_in_constrictions + tally.retained_in_voids + tally.trapped;
        let layers = layers(network, state, id);
        let [deepest, most] = retained_layers(&layers);
        let (blocked, constrictions) =
            layers.iter().take(3).fold((0, 0), |(b, c), row| (b + row.blocked, c + row.constrictions));
        let (fullness_max, overfull_fraction) = state.fullness(network);
        let run = Run {
            run: id.run,
            eroded_mass_fraction,
            eroded_number_fraction: tally.eroded as f64 / tally.inserted.max(1) as f64,
            largest_eroded_mm: largest_mm,
            largest_eroded_over_d15f: largest_mm.map(|d| d / id.d15f_mm),
            blocked: tally.blocked,
            blocked_fraction: tally.blocked as f64 / network.passages().max(1) as f64,
            blocked_first_three_layers_fraction: blocked as f64 / constrictions.max(1) as f64,
            backbone_fraction: state.backbone_fraction(network),
            inserted: tally.inserted,
            eroded: tally.eroded,
            retained_in_constrictions: tally.retained_in_constrictions,
            retained_in_arches: (tally.arches > 0).then_some(tally.retained_in_arches),
            arches: (tally.arches > 0).then_some(tally.arches),
            arched_mass_fraction: (tally.arches > 0).then(|| tally.arched_mass / tally.inserted_mass),
            retained_in_voids: tally.retained_in_voids,
            trapped: tally.trapped,
            retained_per_void: retained as f64 / network.filter_voids() as f64,
            deepest_retained_layer: deepest,
            retained_95_layer: most,
            increments: state.increment,
            particle_moves: tally.particle_moves - free_entries(network, state),
            k_over_k0: flow.and_then(|flow| flow.solutions.last()).map(|solution| solution.k_over_k0),
            flow_solutions: flow.map(|flow| flow.solutions.len() as u64),
            flow_closed_most: flow
                .map(|flow| flow.solutions.iter().map(|solution| solution.closed).fold(0.0, f64::max)),
            k0_mm2: flow.and_then(|flow| flow.k0_mm2),
            fullness_max,
            overfull_fraction,
            by_connectivity: of_run(network, state),
            seconds,
        };
        Self { run, below_threshold, layers }
    }
}

impl Recorded {
    pub(crate) fn new(
        network: &Network,
        state: &State,
        flow: Option<&FlowRecord>,
        recorder: &Recorder,
        layers: Vec<LayerRow>,
        id: RunId,
    ) -> Self {
        let series = recorder.series.iter().map(|(increment, tally)| SeriesRow {
            replicate: id.replicate,
            run: id.run,
            increment: *increment,
            inserted: tally.inserted,
            moving: tally.moving,
            eroded: tally.eroded,
            retained_in_constrictions: tally.retained_in_constrictions,
            retained_in_voids: tally.retained_in_voids,
            trapped: tally.trapped,
            blocked: tally.blocked,
            eroded_mass_fraction: eroded_mass_fraction(tally, &state.tally, id.pan_fraction),
        });
        let flow = flow.iter().flat_map(|flow| &flow.solutions).map(|solution| FlowRow {
            replicate: id.replicate,
            run: id.run,
            increment: solution.increment,
            k_over_k0: solution.k_over_k0,
            closed_flow_fraction: solution.closed,
        });
        let mut recorded = Self {
            series: series.collect(),
            layers,
            flow: flow.collect(),
            // Without recorded voids the blocked constrictions were not requested.
            blocked: if recorder.voids.is_empty() { Vec::new() } else { recorder::blocked(network, state) },
            voids: recorder::of_filter(network, &recorder.voids),
            ..Self::default()
        };
        for (increment, retained, eroded) in &recorder.sizes {
            let row = |counts| size_curve(counts, &state.classes, network.unit_mm(), id, *increment);
            recorded.retained.extend(row(retained));
            recorded.eroded.extend(row(eroded));
        }
        recorded
    }

    /// Appends the rows of a later run or replicate.
    pub fn append(&mut self, mut later: Self) {
        self.series.append(&mut later.series);
        self.layers.append(&mut later.layers);
        self.retained.append(&mut later.retained);
        self.eroded.append(&mut later.eroded);
        self.flow.append(&mut later.flow);
        self.voids.append(&mut later.voids);
        self.blocked.append(&mut later.blocked);
    }
}

/// Moves out of the reservoir through inlets without a constriction: entering is no move.
fn free_entries(network: &Network, state: &State) -> u64 {
    match network.reservoir().filter(|_| network.entry_is_free()) {
        Some(r) => state.tally.inserted - state.retained_in_voids[r as usize],
        None => 0,
    }
}

/// Deepest layer with a retained particle, and layer down to which 95 % of the particles retained in
/// layers lie.
fn retained_layers(layers: &[LayerRow]) -> [Option<u64>; 2] {
    let retained = |row: &LayerRow| row.retained_in_constrictions + row.retained_in_voids;
    let all: u128 = layers.iter().map(|row| u128::from(retained(row))).sum();
    let mut down_to = 0u128;
    let most = layers.iter().position(|row| {
        down_to += u128::from(retained(row));
        all > 0 && down_to * 100 >= all * 95
    });
    [layers.iter().rposition(|row| retained(row) > 0), most].map(|layer| layer.map(|l| l as u64))
}

fn layers(network: &Network, state: &State, id: RunId) -> Vec<LayerRow> {
    let row = |(layer, sums): (u64, Retention)| LayerRow {
        replicate: id.replicate,
        run: id.run,
        layer,
        constrictions: sums.constrictions,
        blocked: sums.blocked,
        retained_in_constrictions: sums.retained_in_constrictions,
        retained_in_voids: sums.retained_in_voids,
    };
    (0..).zip(state.by_layer(network)).map(row).collect()
}

/// Size curve of `counts`: one row for each class bound; empty if nothing is counted.
fn size_curve(
    counts: &SizeCounts,
    classes: &SizeClasses,
    unit_mm: f64,
    id: RunId,
    increment: u64,
) -> Vec<SizeRow> {
    let number: u64 = counts.number.iter().sum();
    let mass: f64 = counts.mass.iter().sum();
    if number == 0 {
        return Vec::new();
    }
    let (mut finer_number, mut finer_mass) = (0u64, 0.0);
    let mut rows = Vec::with_capacity(counts.number.len());
    for (class, &upper) in classes.upper().iter().enumerate() {
        finer_number += counts.number[class];
        finer_mass += counts.mass[class];
        rows.push(SizeRow {
            replicate: id.replicate,
            run: id.run,
            increment,
            diameter_mm: f64::from(upper) * unit_mm,
            percent_finer_by_mass: 100.0 * finer_mass / mass,
            percent_finer_by_number: 100.0 * finer_number as f64 / number as f64,
        });
    }
    rows
}

/// Rows of a run. Trapped particles never settle in a void and are not counted.
fn of_run(network: &Network, state: &State) -> Vec<ByConnectivity> {
    // Entrances and exits are the same for these networks, and all voids of the cubic lattice are alike.
    match network.reservoir().is_some() || network.shape().is_some() {
        true => Vec::new(),
        false => by_connectivity(&state.by_connectivity(network)),
    }
}

/// Particles retained and constrictions blocked in run `run` (counted from 1) of all replicates, by
/// connectivity of the void (paper, Table 3).
pub(crate) fn of_replicates(replicates: &[Replicate], run: u64) -> Vec<ByConnectivity> {
    let mut sums = BTreeMap::<u64, Retention>::new();
    let runs = replicates.iter().flat_map(|r| &r.runs).filter(|r| r.run == run);
    for row in runs.flat_map(|r| &r.by_connectivity) {
        sums.entry(row.connectivity).or_default().add(&Retention {
            voids: row.voids,
            constrictions: row.constrictions,
            blocked: row.blocked,
            retained_in_constrictions: row.retained_in_constrictions,
            retained_in_voids: row.retained_in_voids,
        });
    }
    by_connectivity(&sums)
}

/// Rows by ascending connectivity; empty if all voids have the same.
fn by_connectivity(sums: &BTreeMap<u64, Retention>) -> Vec<ByConnectivity> {
    if sums.len() < 2 {
        return Vec::new();
    }
    let all_voids: u64 = sums.values().map(|sums| sums.voids).sum();
    let all_retained: u64 = sums.values().map(Retention::retained).sum();
    let row = |(&connectivity, sums): (&u64, &Retention)| ByConnectivity {
        connectivity,
        voids: sums.voids,
        voids_fraction: sums.voids as f64 / all_voids as f64,
        constrictions: sums.constrictions,
        blocked: sums.blocked,
        retained_in_constrictions: sums.retained_in_constrictions,
        retained_in_voids: sums.retained_in_voids,
        retained_per_void: sums.retained() as f64 / sums.voids as f64,
        retained_fraction: sums.retained() as f64 / all_retained.max(1) as f64,
    };
    sums.iter().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_by_hand() {
        let retention =
            |[voids, constrictions, blocked, retained_in_constrictions, retained_in_voids]: [u64; 5]| {
                Retention { voids, constrictions, blocked, retained_in_constrictions, retained_in_voids }
            };
        let mut sixes = retention([2, 6, 0, 4, 0]);
        sixes.add(&retention([1, 3, 0, 0, 6]));
        let rows = by_connectivity(&BTreeMap::from([(6, sixes), (5, retention([1, 2, 1, 30, 0]))]));
        assert_eq!((rows[0].voids_fraction, rows[1].voids_fraction), (0.25, 0.75));
        assert_eq!((rows[0].retained_per_void, rows[0].retained_fraction), (30.0, 0.75));
        assert!((rows[1].retained_per_void - 10.0 / 3.0).abs() < 1e-12);
        assert!(by_connectivity(&BTreeMap::from([(6, sixes)])).is_empty());
    }
}
