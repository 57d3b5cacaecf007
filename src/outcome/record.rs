//! What a run folder holds, as types: `outcome.json`, `manifest.json` and the rows of the CSV files.
//!
//! The writer and the reader of a run folder share these types, so a name is spelt in one place.
//! Nothing here computes.
//!
//! # Conventions
//! - Sizes are diameters, in mm. When [`Inputs::scale_free`] is set they are multiples of D0F, the smallest
//!   filter grain; the names keep their `_mm`.
//! - A fraction is of 1, a percentage is of 100 and says `percent`. Fractions of base material are of what
//!   the run inserts in all (`N_base` particles), not of what has been inserted so far.
//! - Replicates and runs count from 1, increments from 1, layers from 0 (the layer of the start nodes).
//! - What a run *blocked* is a state: the constrictions blocked at that moment, so the second run's number
//!   contains the first's. What a run *retained* is its own: particles of the first run are gone when the
//!   second begins.

use serde::{Deserialize, Serialize};

pub use super::applied::{AppliedRule, Confidence, RuleRole};
pub use super::pan::{PanBounds, PanReading, PanSize};

/// The whole of `outcome.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// The class that the replicates together support.
    pub verdict: Verdict,
    /// How far it can be relied on; folders of earlier versions do not say, and are outside.
    #[serde(default)]
    pub confidence: Confidence,
    /// Why no further: sentences, the weightiest first.
    #[serde(default)]
    pub reasons: Vec<String>,
    /// The user's seed.
    pub seed: u64,
    /// Base particles inserted in each run.
    pub n_base: u64,
    /// Base particles by Eq. (2), before any cap or user's number; `None` where the grains per void are not
    /// given.
    pub n_base_eq2: Option<u64>,
    /// Whether a cap made `n_base` smaller than `n_base_eq2`.
    pub capped: bool,
    /// Filter grains per void, `N_p / N_voids` of Eq. (2), where given.
    pub grains_per_void: Option<f64>,
    /// Name of the engine that walked.
    pub engine: String,
    /// One per replicate, in order.
    pub replicates: Vec<Replicate>,
    /// One per run, in order: statistics over the replicates.
    pub summary: Vec<RunSummary>,
    /// Why there are so many replicates, where a rule added them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stopping: Option<Stopping>,
    /// Both readings of a pan fraction that need not be passive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pan_bounds: Option<PanBounds>,
    /// Eroded mass fraction that divides the classes: 0.075.
    pub threshold: f64,
    /// Where the inputs leave the range in which the model was checked, and what else a reader must know.
    pub warnings: Vec<String>,
    /// Parts of the program that this scene did not need.
    pub left_out: Vec<String>,
    /// What the model does not contain, for any scene.
    pub model_leaves_out: Vec<String>,
    /// What went in, resolved.
    pub inputs: Inputs,
    /// The network, where its constrictions have no direction of their own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub network: Option<NetworkSummary>,
    /// The ratios that filter rules use.
    pub ratios: Ratios,
    /// Empirical filter rules applied to the same two curves.
    pub rules: Vec<AppliedRule>,
    /// Eq. (1) for single particles; `None` where the network is no cubic lattice.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub infiltration: Option<Infiltration>,
    /// What comes of the other constriction curves that the filter may have; `None` where its curve was
    /// given, or measured on the whole filter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve_range: Option<CurveRange>,
    /// How the verdict moves with the number of base particles; empty when it was not asked for.
    pub sensitivity: Vec<Sensitivity>,
    /// How the verdict moves with the thickness of the filter, itself included; empty when it was not asked
    /// for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub thickness: Vec<OfThickness>,
    /// Wall time of everything, s.
    pub seconds: f64,
}

/// The paper's three classes, after Foster and Fell, and a fourth for what these replicates leave open.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Verdict {
    /// Less than the threshold eroded in the first run.
    #[serde(rename = "no erosion")]
    None,
    /// The threshold reached in the first run, not in the second.
    #[serde(rename = "some erosion")]
    Some,
    /// The threshold reached in both runs.
    #[serde(rename = "continuing erosion")]
    Continuing,
    /// An interval straddles the threshold, or a run that would decide is missing.
    #[serde(rename = "undecided")]
    Undecided,
}

impl Verdict {
    /// Every class, in the order of `replicate_verdicts`.
    pub const ALL: [Verdict; 4] = [Verdict::None, Verdict::Some, Verdict::Continuing, Verdict::Undecided];

    /// Its name in `outcome.json` and in every table.
    pub fn words(self) -> &'static str {
        match self {
            Verdict::None => "no erosion",
            Verdict::Some => "some erosion",
            Verdict::Continuing => "continuing erosion",
            Verdict::Undecided => "undecided",
        }
    }
}

/// What a rule that adds replicates until they are enough arrived at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stopping {
    /// Target half width of the 95 % interval of the eroded mass, in every run (percentage points of the
    /// base).
    pub target_error_pp: Option<f64>,
    /// Confidence level at which the verdict was to be decided (%), corrected for repeated looks.
    pub decide_percent: Option<f64>,
    /// Replicates at which it stops in any case.
    pub most: u64,
    /// How often it looked at the replicates.
    pub looks: u64,
    /// Whether what was asked for is reached.
    pub met: bool,
    /// The verdict at that confidence level, where one was asked for.
    pub verdict: Option<Verdict>,
    /// Widest half of the 95 % intervals of the eroded mass (percentage points); `None` with one replicate.
    pub half_width_pp: Option<f64>,
    /// Why it is not reached.
    pub sentence: Option<String>,
}

/// One new network, walked once or twice.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Replicate {
    /// The seed that gives this replicate alone.
    pub seed: u64,
    /// The class of this replicate alone.
    pub verdict: Verdict,
    /// One or two.
    pub runs: Vec<Run>,
}

/// The end of one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// 1 or 2.
    pub run: u64,
    /// Mass eroded over mass inserted.
    pub eroded_mass_fraction: f64,
    /// Particles eroded over particles inserted.
    pub eroded_number_fraction: f64,
    /// Largest particle that left the filter; `None` when none did.
    pub largest_eroded_mm: Option<f64>,
    /// `largest_eroded_mm` over D15F.
    pub largest_eroded_over_d15f: Option<f64>,
    /// Constrictions blocked when the run ends.
    pub blocked: u64,
    /// Their share of all constrictions.
    pub blocked_fraction: f64,
    /// Their share of the constrictions of layers 0, 1 and 2.
    pub blocked_first_three_layers_fraction: f64,
    /// Share of all constrictions that lie on an open path from start to end.
    pub backbone_fraction: f64,
    /// Particles inserted.
    pub inserted: u64,
    /// Particles that left through the last layer.
    pub eroded: u64,
    /// Particles stopped by a constriction.
    pub retained_in_constrictions: u64,
    /// Particles in voids without an open exit.
    pub retained_in_voids: u64,
    /// Particles trapped in closed loops.
    pub trapped: u64,
    /// Particles retained in any way, over voids.
    pub retained_per_void: f64,
    /// Deepest layer in which a particle of this run is retained; `None` where none is.
    #[serde(default)]
    pub deepest_retained_layer: Option<u64>,
    /// The layer down to which 95 % of the particles of this run that a layer retains lie.
    #[serde(default)]
    pub retained_95_layer: Option<u64>,
    /// Increments until nothing moved.
    pub increments: u64,
    /// Moves completed, the one that leaves included.
    pub particle_moves: u64,
    /// Permeability when the run ends over that of the clean filter, where water flows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub k_over_k0: Option<f64>,
    /// Permeability of the clean filter (mm2), where the network knows its lengths.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub k0_mm2: Option<f64>,
    /// Volume that this run retained over void volume, of the fullest void; where voids have a volume.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fullness_max: Option<f64>,
    /// Share of the voids that are filled by more than 0.6 of their volume, likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub overfull_fraction: Option<f64>,
    /// Retained and blocked by connectivity of the void, rising; empty where all voids have one connectivity.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub by_connectivity: Vec<ByConnectivity>,
    /// Wall time, s.
    pub seconds: f64,
}

/// What the voids of one connectivity (entrances and exits) did in a run; Table 3 of the paper.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ByConnectivity {
    /// Entrances and exits; that a void is a start node counts as an entrance.
    pub connectivity: u64,
    /// Voids that have it.
    pub voids: u64,
    /// Their share of all voids.
    pub voids_fraction: f64,
    /// Their exits.
    pub constrictions: u64,
    /// Those of them that are blocked when the run ends.
    pub blocked: u64,
    /// Particles of the run stopped by them.
    pub retained_in_constrictions: u64,
    /// Particles of the run retained in these voids.
    pub retained_in_voids: u64,
    /// Particles retained either way, over these voids.
    pub retained_per_void: f64,
    /// Their share of all particles retained either way.
    pub retained_fraction: f64,
}

/// Statistics of one run over the replicates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunSummary {
    /// 1 or 2.
    pub run: u64,
    /// Of [`Run::eroded_mass_fraction`].
    pub eroded_mass_fraction: Statistic,
    /// Of [`Run::eroded_number_fraction`].
    pub eroded_number_fraction: Statistic,
    /// Of [`Run::largest_eroded_over_d15f`], over the replicates in which something eroded; `None` if in
    /// none.
    pub largest_eroded_over_d15f: Option<Statistic>,
    /// Of [`Run::blocked_fraction`].
    pub blocked_fraction: Statistic,
    /// Of [`Run::blocked_first_three_layers_fraction`].
    pub blocked_first_three_layers_fraction: Statistic,
    /// Of [`Run::backbone_fraction`].
    pub backbone_fraction: Statistic,
}

/// A mean, and with two or more replicates its standard deviation and interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Statistic {
    /// Mean over the replicates.
    pub mean: f64,
    /// Sample standard deviation.
    pub sd: Option<f64>,
    /// Lower end of the 95 % interval of the mean.
    pub low: Option<f64>,
    /// Upper end of the 95 % interval of the mean.
    pub high: Option<f64>,
}

/// What went in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Inputs {
    /// The filter and its constrictions.
    pub filter: FilterRecord,
    /// The base soil.
    pub base: BaseRecord,
    /// The void network.
    pub network: NetworkRecord,
    /// Mass of base over mass of filter, `F_base` of Eq. (2).
    pub mass_ratio: Option<f64>,
    /// Share of `n_base` inserted in each increment.
    pub inject_share: f64,
    /// Whether sizes are multiples of D0F instead of mm.
    pub scale_free: bool,
}

/// The filter: its gradation by mass and its constrictions by number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FilterRecord {
    /// As the user calls it.
    pub name: String,
    /// Whom to credit for the constriction curve; empty for the user's own.
    pub attribution: String,
    /// D60 / D10 by mass; `None` where D10 lies in the pan fraction (finer than the finest sieve).
    pub cu: Option<f64>,
    /// Smallest grain.
    pub d0_mm: f64,
    /// 15 % finer by mass.
    pub d15_mm: f64,
    /// 50 % finer by mass.
    pub d50_mm: f64,
    /// 50 % finer by number: the distance from void to void.
    pub d50_by_number_mm: f64,
    /// 85 % finer by mass.
    pub d85_mm: f64,
    /// Volume of voids over volume of grains, where known.
    pub void_ratio: Option<f64>,
    /// Rows of (size, percent finer by mass), sizes ascending.
    pub gradation: Vec<[f64; 2]>,
    /// Rows of (diameter, percent smaller by number), diameters ascending.
    pub constrictions: Vec<[f64; 2]>,
    /// Dc60 / Dc10 by number.
    pub cu_csd: f64,
    /// Name of the constriction curve.
    pub curve_name: String,
}

/// The base soil.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BaseRecord {
    /// As the user calls it.
    pub name: String,
    /// D60 / D10 by mass; `None` where D10 lies in the pan fraction (finer than the finest sieve).
    pub cu: Option<f64>,
    /// Smallest particle.
    pub d0_mm: f64,
    /// 15 % finer by mass.
    pub d15_mm: Option<f64>,
    /// 50 % finer by mass.
    pub d50_mm: Option<f64>,
    /// 85 % finer by mass.
    pub d85_mm: f64,
    /// 95 % finer by mass.
    pub d95_mm: f64,
    /// Largest particle.
    pub d100_mm: f64,
    /// Pan fraction (finer than the finest sieve) by mass; counted as passive.
    pub tail_mass_fraction: f64,
    /// The size that it was regraded on before it was walked; `None` where it is walked as it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub regraded_at_mm: Option<f64>,
    /// Rows of (size, percent finer by mass), sizes ascending.
    pub gradation: Vec<[f64; 2]>,
}

/// The void network.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NetworkRecord {
    /// Where it comes from.
    pub kind: NetworkKind,
    /// As the user calls it.
    pub name: String,
    /// Voids along x; `None` for a network from a file.
    pub nx: Option<u64>,
    /// Voids along y.
    pub ny: Option<u64>,
    /// Voids along z, the direction of flow.
    pub nz: Option<u64>,
    /// Number of voids.
    pub voids: u64,
    /// Number of constrictions.
    pub constrictions: u64,
    /// Number of voids in which base particles start.
    pub start_nodes: u64,
    /// Number of layers.
    pub layers: u64,
    /// Rows of (connectivity, percent of the voids), rising; empty where all voids have the same.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub connectivity: Vec<[f64; 2]>,
    /// Modelled filter thickness: layers times D50F by number, or copies of a packing; `None` where a layer
    /// has no thickness.
    pub thickness_mm: Option<f64>,
    /// Equal copies of a packing, one behind the other; `None` but for a graph.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub copies: Option<u64>,
}

/// The network that was walked, where its constrictions have no direction of their own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NetworkSummary {
    /// `lattice`, `graph` or `file`.
    pub kind: String,
    /// How particles chose among the exits of a void: `flux`, `area-along-flow` or `height`.
    pub exit: String,
    /// Voids.
    pub voids: u64,
    /// Constrictions, each counted once.
    pub constrictions: u64,
    /// Ways in from the reservoir.
    pub inlets: u64,
    /// Equal copies of a packing, one behind the other; `None` for a lattice.
    pub copies: Option<u64>,
    /// Layers of voids.
    pub layers: u64,
    /// Modelled filter thickness (mm).
    pub thickness_mm: Option<f64>,
    /// Permeability of the clean filter (m2); `None` where no water flows, or where lengths have no unit.
    pub k0_m2: Option<f64>,
    /// Hydraulic conductivity of the clean filter for water of 10 C (m/s), likewise.
    pub k0_m_per_s: Option<f64>,
}

/// One row of `flow.csv`: the permeability when the flow was solved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FlowRow {
    /// Counts from 1.
    pub replicate: u64,
    /// 1 or 2.
    pub run: u64,
    /// Increments that were done.
    pub increment: u64,
    /// Permeability over that of the clean filter.
    pub k_over_k0: f64,
}

/// How a network was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NetworkKind {
    /// Directed cubic lattice.
    Cubic,
    /// The lattice changed until its voids have a given distribution of connectivity.
    Connected,
    /// Read from a file.
    File,
    /// The voids of a packing and the constrictions between them.
    Graph,
}

/// The ratios of characteristic sizes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ratios {
    /// D15F / D85B.
    pub d15f_over_d85b: f64,
    /// D15F / D95B.
    pub d15f_over_d95b: f64,
}

/// Eq. (1) of the paper: how far single particles come in the clean filter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Infiltration {
    /// Layers of the network.
    pub layers: u64,
    /// Sizes of the base, ascending.
    pub sizes: Vec<InfiltrationSize>,
    /// The coarsest size that passes all layers with a probability of 5 %.
    pub coarsest_through_mm: f64,
    /// Share of the base's mass that would leave if nothing were ever blocked.
    pub eroded_without_blocking: f64,
}

/// One size of the base in the clean filter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct InfiltrationSize {
    /// As `D85B`.
    pub name: String,
    /// Its size.
    pub diameter_mm: f64,
    /// P(F): probability that it moves one layer downstream.
    pub downstream: f64,
    /// Layers that it does not pass, with a confidence of 95 %; `None` where nothing stops it.
    pub layers_95: Option<f64>,
    /// Layers that it does not pass, with a confidence of 99 %.
    pub layers_99: Option<f64>,
    /// Probability that it passes all layers.
    pub through: f64,
}

/// The outcome with another number of base particles.
///
/// `N_base` holds grains per void and mass ratio only as a product (Eq. 2), so one factor answers for both.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sensitivity {
    /// Multiple of the outcome's own `n_base`.
    pub factor: f64,
    /// Base particles inserted in each run.
    pub n_base: u64,
    /// Grains per void to which this factor corresponds at the scene's mass ratio.
    pub grains_per_void: Option<f64>,
    /// Mass ratio to which this factor corresponds at the scene's grains per void.
    pub mass_ratio: Option<f64>,
    /// How many replicates were walked.
    pub replicates: u64,
    /// Their class.
    pub verdict: Verdict,
    /// Eroded mass fraction, one per run.
    pub runs: Vec<Statistic>,
}

/// The same case with a filter of this thickness.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OfThickness {
    /// Multiple of the outcome's own thickness.
    pub factor: f64,
    /// Layers of voids along the flow.
    pub layers: u64,
    /// Modelled thickness (mm, or D0F as all its sizes); `None` where a layer has none.
    pub thickness_mm: Option<f64>,
    /// Base particles inserted in each run.
    pub n_base: u64,
    /// How many replicates were walked.
    pub replicates: u64,
    /// Their class.
    pub verdict: Verdict,
    /// Eroded mass fraction, one per run.
    pub runs: Vec<Statistic>,
}

/// The walks at the ends of the range of a constriction curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CurveRange {
    /// The class by the curve itself.
    pub verdict: Verdict,
    /// The other curves of the range: its ends.
    pub ends: Vec<CurveEnd>,
    /// Least and most eroded over the whole range, one pair per run: the ends of the 95 % intervals, or the
    /// means of a single replicate (fraction of the mass).
    pub eroded_mass_fraction: Vec<[f64; 2]>,
}

/// The replicates walked with another constriction curve, all else and all random numbers the same.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CurveEnd {
    /// Which curve it is, in words.
    pub curve: String,
    /// Its median constriction by that of the curve itself.
    pub dc50_factor: f64,
    /// How many replicates were walked.
    pub replicates: u64,
    /// Their class.
    pub verdict: Verdict,
    /// Eroded mass fraction, one per run.
    pub runs: Vec<Statistic>,
}

/// The whole of `manifest.json`: what made the folder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Version of voidwalk.
    pub version: String,
    /// Commit it was built from, where known.
    pub commit: Option<String>,
    /// The user's seed.
    pub seed: u64,
    /// Every file that was read.
    pub inputs: Vec<InputFile>,
    /// Worker threads.
    pub threads: u64,
    /// Name of the machine.
    pub host: String,
    /// Kind of machine: system, processor, memory.
    pub machine: String,
    /// When the work began, RFC 3339.
    pub started: String,
    /// When it ended, RFC 3339.
    pub finished: String,
    /// The command line.
    pub command: String,
}

/// A file that was read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct InputFile {
    /// Its name as given.
    pub name: String,
    /// XXH3 of its bytes, hexadecimal. Finds accidents, not attackers.
    pub xxh3: String,
}

/// One row of `series.csv`: the counts after an increment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SeriesRow {
    /// Counts from 1.
    pub replicate: u64,
    /// 1 or 2.
    pub run: u64,
    /// Counts from 1.
    pub increment: u64,
    /// Particles inserted so far in this run.
    pub inserted: u64,
    /// Particles still moving.
    pub moving: u64,
    /// Particles eroded so far in this run.
    pub eroded: u64,
    /// Particles stopped by a constriction so far in this run.
    pub retained_in_constrictions: u64,
    /// Particles retained in voids so far in this run.
    pub retained_in_voids: u64,
    /// Particles trapped in closed loops.
    pub trapped: u64,
    /// Constrictions blocked.
    pub blocked: u64,
    /// Mass eroded so far over the mass that the whole run inserts.
    pub eroded_mass_fraction: f64,
}

/// One row of `layers.csv`: a layer when a run has ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LayerRow {
    /// Counts from 1.
    pub replicate: u64,
    /// 1 or 2.
    pub run: u64,
    /// Counts from 0 at the start nodes.
    pub layer: u64,
    /// Constrictions that leave the voids of this layer.
    pub constrictions: u64,
    /// Those of them that are blocked.
    pub blocked: u64,
    /// Particles of this run stopped by them.
    pub retained_in_constrictions: u64,
    /// Particles of this run retained in the voids of this layer.
    pub retained_in_voids: u64,
}

/// One row of `retained.csv` or `eroded.csv`: a point of the size curve of what is retained, or eroded, so
/// far.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SizeRow {
    /// Counts from 1.
    pub replicate: u64,
    /// 1 or 2.
    pub run: u64,
    /// The increment after which the curve was taken.
    pub increment: u64,
    /// Size.
    pub diameter_mm: f64,
    /// Percent of the mass in particles no larger.
    pub percent_finer_by_mass: f64,
    /// Percent of the number in particles no larger.
    pub percent_finer_by_number: f64,
}
