//! Contents of a run folder, as types: `outcome.json`, `manifest.json` and the rows of the CSV files.
//!
//! The writer and the reader of a run folder share these types, so a name is spelt in one place.
//!
//! # Conventions
//! - Sizes are diameters, in mm. When [`Inputs::scale_free`] is set they are multiples of D0F, the smallest
//!   filter grain; the names keep their `_mm`.
//! - A fraction is relative to 1, a percentage to 100 and has `percent` in its name. Fractions of base
//!   material refer to the total that the run inserts (`N_base` particles).
//! - Replicates and runs count from 1, increments from 1, layers from 0 (the layer of the start nodes).
//! - The *blocked* constrictions of a run are a state: those blocked at that moment, so the second run's
//!   number contains the first's. The *retained* particles belong to one run: particles of the first run
//!   are removed when the second begins.

mod answer;
mod inputs;

pub use super::left_out::{LeftOut, ModelLimit};
pub(crate) use super::number_rows::{
    BlockedRow, ConstrictionRow, FlowRow, LayerRow, RetainedRow, SeriesRow, SizeRow, VoidRow,
};
pub(crate) use answer::ShortOf;
pub use answer::{
    Classed, CurveEnd, CurveRange, Model, OfThickness, Sensitivity, Statistic, Stopping, Verdict,
};
pub use inputs::{
    BaseRecord, ConstrictionsRecord, CurveOrigin, FilterRecord, Inputs, NetworkKind, NetworkRecord, Ratios,
    SampledBase,
};
pub(crate) use inputs::{BaseSize, NetworkSummary};

use super::left_out::Modelled;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use voidwalk_core::network::ExitRule;
use voidwalk_practice::{AppliedRule, Decision, Headline, IfDispersive, InputFile, Note, Practice};
use xxhash_rust::xxh3::Xxh3;

/// Contents of `outcome.json`.
///
/// ```
/// use voidwalk_app::{Callbacks, Case, Scene, walk_case};
/// let small = ["network.nx=8", "network.ny=8", "network.nz=12", "replicates=2", "record.sensitivity=[]"];
/// let case = Case::new(Scene::built_in(&small.map(String::from))?)?;
/// let outcome = walk_case(&case, &Callbacks::default())?;
/// for run in &outcome.summary {
///     println!("run {}: {:.1} % eroded", run.run, 100.0 * run.eroded_mass_fraction.mean);
/// }
/// assert_eq!(outcome.summary.len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Outcome {
    /// Answer of filter practice; `None` without two sieve curves in mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub headline: Option<Headline>,
    /// Decision of filter practice on the pair, without the walk; `None` without two sieve curves in mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub practice: Option<Practice>,
    /// Result of the walk, without practice.
    pub model: Model,
    /// Notes in the order of every face.
    pub notes: Vec<Note>,
    /// Limit of practice if the base is dispersive; `None` if dispersion is stated or the base has few
    /// fines.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub if_dispersive: Option<IfDispersive>,
    /// Origin of the constrictions.
    pub constrictions: ConstrictionsRecord,
    /// Seed given by the user.
    pub seed: u64,
    /// Base particles inserted in each run.
    pub n_base: u64,
    /// Base particles by Eq. (2), before any cap or number set by the user; `None` if the grains per void
    /// are not given.
    pub n_base_eq2: Option<u64>,
    /// True if a cap made `n_base` smaller than `n_base_eq2`.
    pub capped: bool,
    /// Filter grains per void, `N_p / N_voids` of Eq. (2), if given.
    pub grains_per_void: Option<f64>,
    /// Name of the engine.
    pub engine: String,
    /// Results of each replicate, in order.
    pub replicates: Vec<Replicate>,
    /// Statistics of each run over the replicates, in order.
    pub summary: Vec<RunSummary>,
    /// Reason for the number of replicates, if a rule added them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stopping: Option<Stopping>,
    /// Eroded mass fraction that divides the classes: 0.075.
    pub threshold: f64,
    /// Parts of the program that this scene did not need.
    pub left_out: Vec<LeftOut>,
    /// Processes that the model omits for any scene.
    pub model_leaves_out: Vec<ModelLimit>,
    /// Resolved inputs.
    pub inputs: Inputs,
    /// Summary of the network, if its constrictions have no direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub network: Option<NetworkSummary>,
    /// Ratios used by filter rules.
    pub ratios: Ratios,
    /// Empirical filter rules applied to the same two curves.
    pub rules: Vec<AppliedRule>,
    /// Eq. (1) for single particles; `None` unless the network is a cubic lattice.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub infiltration: Option<Infiltration>,
    /// Results for the other possible constriction curves of the filter; `None` if its curve was given,
    /// or measured on the whole filter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve_range: Option<CurveRange>,
    /// Law by which particles arched; `None` if they did not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub arching: Option<ArchingRecord>,
    /// Verdict for other numbers of base particles; empty if it was not requested.
    pub sensitivity: Vec<Sensitivity>,
    /// Verdict for several thicknesses of the filter, its own included; empty if it was not requested.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub thickness: Vec<OfThickness>,
    /// True if both studies are still being walked or were stopped: `voidwalk resume` continues them.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub studies_to_come: bool,
    /// Digest of all numbers, equal wherever a scene and seed give the same numbers: XXH3 with 128 bits,
    /// in hexadecimal, of every number, `true`, `false` and `null` with its place. Text, `seconds` and
    /// `studies_to_come` are omitted.
    pub digest: String,
    /// Total wall time, s; a campaign walks other cases on the same threads.
    pub seconds: f64,
}

impl Outcome {
    /// Decision of practice on the pair: without an answer if the record has none.
    pub fn decision(&self) -> Decision {
        let mut decision = Decision::new(&self.rules, self.if_dispersive, Some(self.inputs.filter.d15_mm));
        decision.headline = self.headline.and(decision.headline);
        decision
    }

    /// Features of its walk.
    pub(crate) fn modelled(&self) -> Modelled {
        let with_flow =
            |exit: &str| ExitRule::ALL.iter().any(|rule| rule.name() == exit && rule.needs_flow());
        Modelled {
            flow: self.network.as_ref().is_some_and(|network| with_flow(&network.exit)),
            arches: self.arching.is_some(),
            openings: self.notes.contains(&Note::Openings {}),
        }
    }
}

/// Law by which particles arch in a constriction that they fit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct ArchingRecord {
    /// Name of the law in a scene.
    pub(crate) law: String,
    /// Publication of the law.
    pub(crate) source: String,
    /// Parts of the source that were read, and assumptions.
    pub(crate) basis: String,
    /// Range in which arches form: size of the constriction over size of the particle.
    pub(crate) range_of_ratio: [f64; 2],
    /// Solids fraction of the suspension that enters the filter, volume of particles over volume of
    /// suspension; `None` if the law does not depend on it.
    pub(crate) concentration: Option<f64>,
}

/// New network, walked once or twice.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Replicate {
    /// Seed that gives this replicate alone.
    pub seed: u64,
    /// Class of this replicate alone.
    pub verdict: Verdict,
    /// One or two runs.
    pub runs: Vec<Run>,
}

/// State at the end of one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Run {
    /// 1 or 2.
    pub run: u64,
    /// Mass eroded over mass inserted.
    pub eroded_mass_fraction: f64,
    /// Particles eroded over particles inserted.
    pub eroded_number_fraction: f64,
    /// Largest particle that left the filter; `None` if none did.
    pub largest_eroded_mm: Option<f64>,
    /// `largest_eroded_mm` over D15F.
    pub largest_eroded_over_d15f: Option<f64>,
    /// Number of blocked constrictions at the end of the run.
    pub blocked: u64,
    /// Blocked fraction of all constrictions.
    pub blocked_fraction: f64,
    /// Blocked fraction of the constrictions of layers 0, 1 and 2.
    pub blocked_first_three_layers_fraction: f64,
    /// Fraction of all constrictions that lie on an open path from start to end.
    pub backbone_fraction: f64,
    /// Number of particles inserted.
    pub inserted: u64,
    /// Number of particles that left through the last layer.
    pub eroded: u64,
    /// Number of particles stopped by a constriction.
    pub retained_in_constrictions: u64,
    /// Number of particles stopped in arches; `None` without arches. It is not a physical number: it
    /// depends on how many particles an increment brings to one constriction (arches.md).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub retained_in_arches: Option<u64>,
    /// Number of arches; `None` without arches.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub arches: Option<u64>,
    /// Mass in arches over the mass inserted; `None` without arches.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub arched_mass_fraction: Option<f64>,
    /// Number of particles in voids without an open exit.
    pub retained_in_voids: u64,
    /// Number of particles trapped in closed loops.
    pub trapped: u64,
    /// Number of particles retained in any way, per void.
    pub retained_per_void: f64,
    /// Deepest layer in which a particle of this run is retained; `None` if none is.
    pub deepest_retained_layer: Option<u64>,
    /// Layer down to which 95 % of the particles retained in layers in this run lie.
    pub retained_95_layer: Option<u64>,
    /// Number of increments until nothing moved.
    pub increments: u64,
    /// Number of moves completed, including those that leave the filter.
    pub particle_moves: u64,
    /// Permeability at the end of the run over that of the clean filter, with water.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub k_over_k0: Option<f64>,
    /// Number of times the flow was solved, with water.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flow_solutions: Option<u64>,
    /// Maximum fraction of the inflow through constrictions that had closed since the flow was solved,
    /// summed over the filter: their mean number on the way of a particle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flow_closed_most: Option<f64>,
    /// Permeability of the clean filter (mm2), if the network has lengths.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub k0_mm2: Option<f64>,
    /// Volume retained in this run over void volume, for the fullest void with a volume, if volumes are
    /// known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fullness_max: Option<f64>,
    /// Fraction of voids filled above 0.6 of their volume, if volumes are known; a void without volume
    /// counts as soon as a particle rests in it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub overfull_fraction: Option<f64>,
    /// Retained and blocked by connectivity of the void, ascending; empty if all voids have the same.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub by_connectivity: Vec<ByConnectivity>,
    /// Wall time from start to end, s; other walks may use the same threads.
    pub seconds: f64,
}

/// Results for the voids of one connectivity (entrances and exits) in a run; Table 3 of the paper.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct ByConnectivity {
    /// Number of entrances and exits; being a start node counts as an entrance.
    pub connectivity: u64,
    /// Number of voids with this connectivity.
    pub voids: u64,
    /// Fraction of all voids.
    pub voids_fraction: f64,
    /// Number of their exits.
    pub constrictions: u64,
    /// Number of these exits blocked at the end of the run.
    pub blocked: u64,
    /// Number of particles of the run stopped by them.
    pub retained_in_constrictions: u64,
    /// Number of particles of the run retained in these voids.
    pub retained_in_voids: u64,
    /// Number of particles retained either way, per void.
    pub retained_per_void: f64,
    /// Fraction of all particles retained either way.
    pub retained_fraction: f64,
}

/// Statistics of one run over the replicates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct RunSummary {
    /// 1 or 2.
    pub run: u64,
    /// Statistic of [`Run::eroded_mass_fraction`].
    pub eroded_mass_fraction: Statistic,
    /// Statistic of [`Run::eroded_number_fraction`].
    pub eroded_number_fraction: Statistic,
    /// Statistic of [`Run::largest_eroded_over_d15f`] over the replicates in which something eroded;
    /// `None` if there are none.
    pub largest_eroded_over_d15f: Option<Statistic>,
    /// Statistic of [`Run::blocked_fraction`].
    pub blocked_fraction: Statistic,
    /// Statistic of [`Run::blocked_first_three_layers_fraction`].
    pub blocked_first_three_layers_fraction: Statistic,
    /// Statistic of [`Run::backbone_fraction`].
    pub backbone_fraction: Statistic,
}

/// Eq. (1) of the paper: depth that single particles reach in the clean filter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Infiltration {
    /// Number of layers of the network.
    pub layers: u64,
    /// Sizes of the base, ascending.
    pub sizes: Vec<InfiltrationSize>,
    /// Coarsest size that passes all layers with a probability of 5 %.
    pub coarsest_through_mm: f64,
    /// Mass fraction of the base that would leave if nothing were ever blocked.
    pub eroded_without_blocking: f64,
}

/// One size of the base in the clean filter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct InfiltrationSize {
    /// Name of the size, such as `D85B`.
    pub name: String,
    /// Diameter of the size.
    pub diameter_mm: f64,
    /// P(F): probability of moving one layer downstream.
    pub downstream: f64,
    /// Number of layers that the size does not pass, with a confidence of 95 %; `None` if nothing stops it.
    pub layers_95: Option<f64>,
    /// Number of layers that the size does not pass, with a confidence of 99 %.
    pub layers_99: Option<f64>,
    /// Probability of passing all layers.
    pub through: f64,
}

/// Commit that this program was built from, if known.
pub(crate) fn commit() -> Option<String> {
    option_env!("VOIDWALK_COMMIT").map(String::from)
}

/// Contents of `manifest.json`: how the folder was made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Manifest {
    /// Version of voidwalk.
    pub version: String,
    /// Commit that the program was built from, if known.
    pub commit: Option<String>,
    /// Seed given by the user.
    pub seed: u64,
    /// Files that were read.
    pub inputs: Vec<InputFile>,
    /// Number of worker threads.
    pub threads: u64,
    /// Name of the machine.
    pub host: String,
    /// Kind of machine: system, processor, memory.
    pub machine: String,
    /// Start of the work, RFC 3339.
    pub started: String,
    /// End of the work, RFC 3339.
    pub finished: String,
    /// Command line of the run.
    pub command: String,
}

/// Results of [`crate::run::walk_networks`], with the field names of `outcome.json` if both have them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct NetworkWalkRecord {
    /// Class supported by all replicates together.
    pub(crate) verdict: Verdict,
    /// Notes in the order of every face.
    pub(crate) notes: Vec<Note>,
    /// Seed given by the user.
    pub(crate) seed: u64,
    /// Base particles inserted in each run.
    pub(crate) n_base: u64,
    /// Base particles by Eq. (2), if the filter and its grains per void are known.
    pub(crate) n_base_eq2: Option<u64>,
    /// Filter grains per void, if known.
    pub(crate) grains_per_void: Option<f64>,
    /// Mass of base over mass of filter, of Eq. (2).
    pub(crate) mass_ratio: f64,
    /// Number of equal increments in which they were inserted.
    pub(crate) increments: u64,
    /// Name of the engine.
    pub(crate) engine: String,
    /// Results of each replicate, in order.
    pub(crate) replicates: Vec<Replicate>,
    /// Statistics of each run over the replicates, in order.
    pub(crate) summary: Vec<RunSummary>,
    /// Eroded mass fraction that divides the classes: 0.075.
    pub(crate) threshold: f64,
    /// Parts of the program that this walk did not need.
    pub(crate) left_out: Vec<LeftOut>,
    /// Processes that the model omits.
    pub(crate) model_leaves_out: Vec<ModelLimit>,
    /// The base.
    pub(crate) base: BaseRecord,
    /// D15 of the filter by mass (mm), if the filter is known.
    pub(crate) d15f_mm: Option<f64>,
    /// Network that was walked.
    pub(crate) network: GivenNetwork,
    /// Version of the program.
    pub(crate) version: String,
}

/// Networks that were given; the numbers are those of the first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct GivenNetwork {
    /// Number of networks, which the replicates take in turn.
    pub(crate) networks: u64,
    /// Exit rule of the particles.
    pub(crate) exit: String,
    /// Number of voids.
    pub(crate) voids: u64,
    /// Number of constrictions, each counted once.
    pub(crate) constrictions: u64,
    /// Number of layers of voids.
    pub(crate) layers: u64,
    /// Rows of (diameter, percent smaller by number) of its open constrictions, diameters ascending (mm).
    pub(crate) diameters: Vec<[f64; 2]>,
}

/// Fields that are not results.
const LEFT_OUT: [&str; 2] = ["seconds", "studies_to_come"];

/// Digest of every number, `true`, `false` and `null` of a record: XXH3 of one line `PLACE=VALUE` each,
/// 128 bits in hexadecimal. Fields are sorted by name, so their order in the file does not matter. Text
/// (names, sentences, classes that follow from the numbers, version), wall times (`seconds`) and the
/// progress of a run (`studies_to_come`) are omitted.
///
/// ```
/// use serde_json::json;
/// use voidwalk_app::outcome::record::digest;
/// let of_run = digest(&json!({ "eroded": 0.25, "engine": "counts", "seconds": 3.5 }))?;
/// assert_eq!(of_run, digest(&json!({ "seconds": 7.1, "engine": "particles", "eroded": 0.25 }))?);
/// assert_ne!(of_run, digest(&json!({ "eroded": 0.5, "engine": "counts", "seconds": 3.5 }))?);
/// # Ok::<(), serde_json::Error>(())
/// ```
///
/// # Errors
/// The record cannot be expressed in JSON.
pub fn digest(record: &impl Serialize) -> Result<String, serde_json::Error> {
    let mut hash = Xxh3::new();
    add(&mut hash, "", &serde_json::to_value(record)?);
    Ok(format!("{:032x}", hash.digest128()))
}

fn add(hash: &mut Xxh3, place: &str, value: &Value) {
    match value {
        Value::Object(fields) => {
            let mut results: Vec<_> =
                fields.iter().filter(|(name, _)| !LEFT_OUT.contains(&name.as_str())).collect();
            results.sort_by_key(|(name, _)| *name);
            results.iter().for_each(|(name, value)| add(hash, &format!("{place}.{name}"), value));
        }
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(at, item)| add(hash, &format!("{place}[{at}]"), item));
        }
        Value::String(_) => {}
        Value::Null | Value::Bool(_) | Value::Number(_) => {
            hash.update(format!("{place}={value}\n").as_bytes());
        }
    }
}
