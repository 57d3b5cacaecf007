//! Ledger of a campaign, as types: one line of `ledger.jsonl` for each finished case.

use super::record::{ModelLimit, Outcome, Ratios, RunSummary, Verdict, commit};
use super::verdict::UndecidedBy;
use super::{BaseSize, Modelled, leaves_out_of_all};
use serde::{Deserialize, Serialize};
use voidwalk_practice::Note;

/// Finished case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct LedgerLine {
    /// Name of the case.
    pub case: String,
    /// Level of each factor, in the order of the plan.
    pub levels: serde_json::Map<String, serde_json::Value>,
    /// Folder of its results, inside the campaign's folder.
    pub folder: String,
    /// Fingerprint of all inputs of the results: the resolved scene and its files.
    pub fingerprint: String,
    /// Seed of the case.
    pub seed: u64,
    /// Version of the program.
    pub version: String,
    /// Commit of the program, if known.
    pub commit: Option<String>,
    /// Class supported by all replicates together.
    pub verdict: Verdict,
    /// Cause that leaves the verdict undecided.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undecided_by: Option<UndecidedBy>,
    /// Thickness of the modelled filter along the flow.
    pub thickness: ModelledThickness,
    /// True if water directed particles.
    pub with_flow: bool,
    /// True if particles arched.
    pub with_arches: bool,
    /// True if blocked constrictions left openings.
    pub with_openings: bool,
    /// Identifiers of rules of practice that apply to these soils and are not kept.
    pub rules_not_met: Vec<String>,
    /// Number of replicates in each class, in the order of `Verdict::ALL`.
    pub replicate_verdicts: [u64; 4],
    /// Number of replicates.
    pub replicates: u64,
    /// Number of base particles in each run.
    pub n_base: u64,
    /// Number of base particles by Eq. (2), before any cap.
    pub n_base_eq2: Option<u64>,
    /// True if a cap made `n_base` smaller than `n_base_eq2`.
    pub capped: bool,
    /// Filter grains per void.
    pub grains_per_void: Option<f64>,
    /// D15F over D85B and D95B.
    pub ratios: Ratios,
    /// D85B and the base that it belongs to; `None` without a unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base: Option<BaseSize>,
    /// Statistics of each run.
    pub runs: Vec<RunSummary>,
    /// Notes on the case.
    pub notes: Vec<Note>,
    /// Machine and time of the walk: two campaigns of one plan differ only here.
    pub made: Made,
}

/// Contents of `campaign.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Campaign {
    /// Subject of the plan, in one line.
    pub title: String,
    /// Name of the plan's file.
    pub plan: String,
    /// Factors in the order of the plan.
    pub factors: Vec<String>,
    /// Number of cases in the plan.
    pub cases: u64,
    /// Cases that are not finished.
    pub missing: Vec<String>,
}

/// Thickness of a modelled filter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct ModelledThickness {
    /// Layers of voids.
    pub(crate) layers: u64,
    /// Thickness along the flow (mm); `None` if the network does not give it.
    pub(crate) mm: Option<f64>,
    /// True if sizes are multiples of D0F instead of mm.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) scale_free: bool,
}

/// Machine and time of a case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Made {
    /// Name of the machine.
    pub host: String,
    /// Worker threads.
    pub threads: u64,
    /// Job and task of a cluster, if there is one.
    pub job: Option<String>,
    /// Start of the case (RFC 3339).
    pub started: String,
    /// Wall time of the case from start to end, s. Other cases on the same threads at the same time
    /// lengthen it.
    pub seconds: f64,
}

impl LedgerLine {
    /// Builds the line of an outcome.
    pub fn new(
        case: &str,
        levels: &[(String, String)],
        folder: String,
        fingerprint: String,
        outcome: &Outcome,
        made: Made,
    ) -> Self {
        let count = |verdict| outcome.replicates.iter().filter(|r| r.verdict == verdict).count() as u64;
        let (modelled, inputs) = (outcome.modelled(), &outcome.inputs);
        let broken = outcome.rules.iter().filter(|rule| rule.is_broken());
        Self {
            case: case.into(),
            levels: levels.iter().map(|(factor, level)| (factor.clone(), level.clone().into())).collect(),
            folder,
            fingerprint,
            seed: outcome.seed,
            version: env!("CARGO_PKG_VERSION").into(),
            commit: commit(),
            verdict: outcome.model.class,
            undecided_by: outcome.undecided_by(),
            thickness: ModelledThickness {
                layers: inputs.network.layers,
                mm: inputs.network.thickness_mm,
                scale_free: inputs.scale_free,
            },
            with_flow: modelled.flow,
            with_arches: modelled.arches,
            with_openings: modelled.openings,
            rules_not_met: broken.map(|rule| rule.id.clone()).collect(),
            replicate_verdicts: Verdict::ALL.map(count),
            replicates: outcome.replicates.len() as u64,
            n_base: outcome.n_base,
            n_base_eq2: outcome.n_base_eq2,
            capped: outcome.capped,
            grains_per_void: outcome.grains_per_void,
            ratios: outcome.ratios,
            base: inputs.base_size(),
            runs: outcome.summary.clone(),
            notes: outcome.notes.clone(),
            made,
        }
    }
}

/// Features that the model omits in every case of a ledger.
pub fn leaves_out(lines: &[LedgerLine]) -> Vec<ModelLimit> {
    leaves_out_of_all(lines.iter().map(|line| Modelled {
        flow: line.with_flow,
        arches: line.with_arches,
        openings: line.with_openings,
    }))
}
