//! Contents of a run folder, as types: `outcome.json`, `manifest.json` and the rows of the CSV files.
//!
//! The writer and the reader of a run folder share these types, so a name is spelt in one place.
//!
//! # Conventions
//! - Sizes are diameters, in mm. When [`Inputs::scale_free`] is set they are multiples of D0F, the smallest
//!   filter grain; the names keep their `_mm`.
//! - A fraction is of 1, a percentage is of 100 and says `percent`. Fractions of base material refer to the
//!   total that the run inserts (`N_base` particles), not to the part inserted so far.
//! - Replicates and runs count from 1, increments from 1, layers from 0 (the layer of the start nodes).
//! - The *blocked* constrictions of a run are a state: those blocked at that moment, so the second run's
//!   number contains the first's. The *retained* particles belong to one run: particles of the first run are
//!   gone when the second begins.

mod answer;
mod inputs;

pub use super::left_out::{LeftOut, ModelLimit};
pub use super::number_rows::{
    BlockedRow, ConstrictionRow, FlowRow, LayerRow, RetainedRow, SeriesRow, SizeRow, VoidRow,
};
pub use answer::{
    Classed, CurveEnd, CurveRange, Model, OfThickness, Sensitivity, ShortOf, Statistic, Stopping, Verdict,
};
pub use inputs::{
    BaseRecord, BaseSize, ConstrictionsRecord, CurveOrigin, FilterRecord, Inputs, NetworkKind, NetworkRecord,
    NetworkSummary, Ratios, SampledBase,
};

use super::left_out::Modelled;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use voidwalk_core::network::ExitRule;
use voidwalk_practice::{AppliedRule, Decision, Headline, IfDispersive, InputFile, Note, Practice};
use xxhash_rust::xxh3::Xxh3;

/// The whole of `outcome.json`.
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
    /// The answer of filter practice; `None` without two sieve curves in mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub headline: Option<Headline>,
    /// What filter practice says of the pair, without the walk; `None` likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub practice: Option<Practice>,
    /// What the walk says, without practice.
    pub model: Model,
    /// What else to know, in the order of every face.
    pub notes: Vec<Note>,
    /// What practice allows if the base is dispersive; `None` where somebody has said whether it is, and
    /// where it has few fines.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub if_dispersive: Option<IfDispersive>,
    /// Where the constrictions come from.
    pub constrictions: ConstrictionsRecord,
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
    /// Eroded mass fraction that divides the classes: 0.075.
    pub threshold: f64,
    /// Parts of the program that this scene did not need.
    pub left_out: Vec<LeftOut>,
    /// What the model does not contain, for any scene.
    pub model_leaves_out: Vec<ModelLimit>,
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
    /// The law by which particles arched; `None` where they did not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub arching: Option<ArchingRecord>,
    /// How the verdict moves with the number of base particles; empty when it was not asked for.
    pub sensitivity: Vec<Sensitivity>,
    /// How the verdict moves with the thickness of the filter, itself included; empty when it was not asked
    /// for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub thickness: Vec<OfThickness>,
    /// Whether both studies are still being walked, or their walk was ended: `voidwalk resume` goes on.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub studies_to_come: bool,
    /// Digest of its numbers, equal wherever a scene and seed give the same numbers: XXH3 with 128 bits,
    /// in hexadecimal, of every number, `true`, `false` and `null` with its place. Left out are text,
    /// `seconds` and `studies_to_come`.
    pub digest: String,
    /// Wall time of everything, s; in a campaign beside other cases on the same threads.
    pub seconds: f64,
}

impl Outcome {
    /// The decision of practice on its pair: without an answer if the record has none.
    pub fn decision(&self) -> Decision {
        let mut decision = Decision::new(&self.rules, self.if_dispersive, Some(self.inputs.filter.d15_mm));
        decision.headline = self.headline.and(decision.headline);
        decision
    }

    /// Features that its walk contained.
    pub fn modelled(&self) -> Modelled {
        let with_flow =
            |exit: &str| ExitRule::ALL.iter().any(|rule| rule.name() == exit && rule.needs_flow());
        Modelled {
            flow: self.network.as_ref().is_some_and(|network| with_flow(&network.exit)),
            arches: self.arching.is_some(),
            openings: self.notes.contains(&Note::Openings {}),
        }
    }
}

/// A law by which particles arch in a constriction that they fit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct ArchingRecord {
    /// Its name in a scene.
    pub law: String,
    /// Where it was published.
    pub source: String,
    /// What of the source was read, and what was assumed.
    pub basis: String,
    /// Sizes of a constriction by that of a particle between which arches form.
    pub range_of_ratio: [f64; 2],
    /// Solids fraction of the suspension that enters the filter, volume of particles by volume of suspension;
    /// `None` where the law does not depend on it.
    pub concentration: Option<f64>,
}

/// One new network, walked once or twice.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
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
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
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
    /// Those of them that are in arches; `None` where there are no arches. No physical number: it depends on
    /// what an increment brings to one constriction (arches.md).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub retained_in_arches: Option<u64>,
    /// Arches, likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub arches: Option<u64>,
    /// Mass in arches over the mass inserted, likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub arched_mass_fraction: Option<f64>,
    /// Particles in voids without an open exit.
    pub retained_in_voids: u64,
    /// Particles trapped in closed loops.
    pub trapped: u64,
    /// Particles retained in any way, over voids.
    pub retained_per_void: f64,
    /// Deepest layer in which a particle of this run is retained; `None` where none is.
    pub deepest_retained_layer: Option<u64>,
    /// The layer down to which 95 % of the particles of this run that a layer retains lie.
    pub retained_95_layer: Option<u64>,
    /// Increments until nothing moved.
    pub increments: u64,
    /// Moves completed, the one that leaves included.
    pub particle_moves: u64,
    /// Permeability when the run ends over that of the clean filter, where water flows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub k_over_k0: Option<f64>,
    /// Times that the flow was solved, where water flows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flow_solutions: Option<u64>,
    /// The most of the inflow that went through constrictions which had closed since the flow was solved,
    /// summed over the filter: so many on the mean way of a particle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flow_closed_most: Option<f64>,
    /// Permeability of the clean filter (mm2), where the network knows its lengths.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub k0_mm2: Option<f64>,
    /// Volume that this run retained over void volume, of the fullest void that has a volume; where volumes
    /// are known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fullness_max: Option<f64>,
    /// Share of the voids that are filled by more than 0.6 of their volume, likewise; a void without volume
    /// is as soon as a particle rests in it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub overfull_fraction: Option<f64>,
    /// Retained and blocked by connectivity of the void, rising; empty where all voids have one connectivity.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub by_connectivity: Vec<ByConnectivity>,
    /// Wall time from start to end, s, beside what else is walked on the same threads.
    pub seconds: f64,
}

/// What the voids of one connectivity (entrances and exits) did in a run; Table 3 of the paper.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
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
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
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

/// Eq. (1) of the paper: how far single particles come in the clean filter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
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
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
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

/// The commit from which this program was built, if known.
pub fn commit() -> Option<String> {
    option_env!("VOIDWALK_COMMIT").map(String::from)
}

/// The whole of `manifest.json`: what made the folder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
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

/// The results of [`crate::run::walk_networks`]; the names are those of `outcome.json` where both have them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct NetworkWalkRecord {
    /// The class that the replicates together support.
    pub verdict: Verdict,
    /// What else to know, in the order of every face.
    pub notes: Vec<Note>,
    /// The user's seed.
    pub seed: u64,
    /// Base particles inserted in each run.
    pub n_base: u64,
    /// Those that Eq. (2) gives, where the filter and its grains per void are known.
    pub n_base_eq2: Option<u64>,
    /// Filter grains per void, where they are known.
    pub grains_per_void: Option<f64>,
    /// Mass of the base over that of the filter, of Eq. (2).
    pub mass_ratio: f64,
    /// Equal parts in which they were inserted.
    pub increments: u64,
    /// Name of the engine that walked.
    pub engine: String,
    /// One per replicate, in order.
    pub replicates: Vec<Replicate>,
    /// One per run, in order: statistics over the replicates.
    pub summary: Vec<RunSummary>,
    /// Eroded mass fraction that divides the classes: 0.075.
    pub threshold: f64,
    /// Parts of the program that this walk did not need.
    pub left_out: Vec<LeftOut>,
    /// What the model does not contain.
    pub model_leaves_out: Vec<ModelLimit>,
    /// The base.
    pub base: BaseRecord,
    /// 15 % of the filter finer by mass (mm), where the filter is known.
    pub d15f_mm: Option<f64>,
    /// What was walked through.
    pub network: GivenNetwork,
    /// Version of the program.
    pub version: String,
}

/// Networks that were given; where there are several, the numbers are those of the first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct GivenNetwork {
    /// Networks that the replicates took in turn.
    pub networks: u64,
    /// How particles chose among the exits of a void.
    pub exit: String,
    /// Voids.
    pub voids: u64,
    /// Constrictions, each counted once.
    pub constrictions: u64,
    /// Layers of voids.
    pub layers: u64,
    /// Rows of (diameter, percent smaller by number) of its open constrictions, diameters ascending (mm).
    pub diameters: Vec<[f64; 2]>,
}

/// Fields that are not results.
const LEFT_OUT: [&str; 2] = ["seconds", "studies_to_come"];

/// Digest of every number, `true`, `false` and `null` of a record: XXH3 of one line `PLACE=VALUE` each, 128
/// bits in hexadecimal. Fields are sorted by name, so their order in the file does not matter. Text is left
/// out (names, sentences, classes that follow from the numbers, version), and so are wall times (`seconds`)
/// and the progress of a run (`studies_to_come`).
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
/// A record that JSON cannot hold.
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
