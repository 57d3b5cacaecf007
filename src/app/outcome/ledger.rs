//! The ledger of a campaign, as types: one line of `ledger.jsonl` for each finished case.

use super::record::{ModelLimit, Outcome, Ratios, RunSummary, Verdict, commit};
use super::verdict::UndecidedBy;
use super::{BaseSize, Modelled, leaves_out_of_all};
use serde::{Deserialize, Serialize};
use voidwalk_practice::Note;

/// A finished case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct LedgerLine {
    /// Name of the case.
    pub case: String,
    /// Level by factor, in the order of the plan.
    pub levels: serde_json::Map<String, serde_json::Value>,
    /// Folder of its results, inside the campaign's.
    pub folder: String,
    /// Fingerprint of everything that the results follow from: the resolved scene and its files.
    pub fingerprint: String,
    /// The case's seed.
    pub seed: u64,
    /// Version of the program.
    pub version: String,
    /// Commit of the program, where known.
    pub commit: Option<String>,
    /// The class that the replicates together support.
    pub verdict: Verdict,
    /// What leaves the verdict undecided.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undecided_by: Option<UndecidedBy>,
    /// The filter that was modelled, along the flow.
    pub thickness: ModelledThickness,
    /// Whether water gave particles their way.
    pub with_flow: bool,
    /// Whether particles arched.
    pub with_arches: bool,
    /// Whether blocked constrictions left openings.
    pub with_openings: bool,
    /// The rules of practice that were made for these soils and are not kept, by their names for programs.
    pub rules_not_met: Vec<String>,
    /// Replicates by their own class, in the order of [`Verdict::ALL`].
    pub replicate_verdicts: [u64; 4],
    /// Replicates.
    pub replicates: u64,
    /// Base particles of each run.
    pub n_base: u64,
    /// Base particles by Eq. (2), before any cap.
    pub n_base_eq2: Option<u64>,
    /// Whether a cap made `n_base` smaller than `n_base_eq2`.
    pub capped: bool,
    /// Filter grains per void.
    pub grains_per_void: Option<f64>,
    /// D15F over D85B and D95B.
    pub ratios: Ratios,
    /// D85B and which base it is of; `None` without a unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base: Option<BaseSize>,
    /// Statistics of each run.
    pub runs: Vec<RunSummary>,
    /// What else to know.
    pub notes: Vec<Note>,
    /// Where and when, apart from the rest: two campaigns of one plan differ here only.
    pub made: Made,
}

/// The whole of `campaign.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Campaign {
    /// What the plan is about, in a line.
    pub title: String,
    /// Name of the plan's file.
    pub plan: String,
    /// Factors in the order of the plan.
    pub factors: Vec<String>,
    /// Cases of the plan.
    pub cases: u64,
    /// Cases that are not done.
    pub missing: Vec<String>,
}

/// How thick the filter is that was modelled.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct ModelledThickness {
    /// Layers of voids.
    pub layers: u64,
    /// Along the flow (mm); `None` where the network does not say.
    pub mm: Option<f64>,
    /// Whether sizes are multiples of D0F instead of mm.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub scale_free: bool,
}

/// Where and when a case was walked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Made {
    /// Name of the machine.
    pub host: String,
    /// Worker threads.
    pub threads: u64,
    /// Job and task of a cluster, where there is one.
    pub job: Option<String>,
    /// When the case began (RFC 3339).
    pub started: String,
    /// Wall time from the start of the case to its end, s. Cases that are walked beside it on the same
    /// threads take a part of it.
    pub seconds: f64,
}

impl LedgerLine {
    /// The line of an outcome.
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
