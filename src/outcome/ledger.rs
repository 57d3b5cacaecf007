//! The ledger of a campaign, as types: one line of `ledger.jsonl` for each finished case.

use serde::{Deserialize, Serialize};

use super::record::{Confidence, Outcome, Ratios, RunSummary, Verdict};

/// A finished case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
    /// How far it can be relied on; lines of earlier versions do not say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub confidence: Option<Confidence>,
    /// The rules of practice that were made for these soils and are not kept, by their names for programs;
    /// lines of earlier versions do not say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rules_not_met: Option<Vec<String>>,
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
    /// Statistics of each run.
    pub runs: Vec<RunSummary>,
    /// What else a reader must know.
    pub warnings: Vec<String>,
    /// Where and when, apart from the rest: two campaigns of one plan differ here only.
    pub made: Made,
}

/// The whole of `campaign.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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

/// Where and when a case was walked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Made {
    /// Name of the machine.
    pub host: String,
    /// Worker threads.
    pub threads: u64,
    /// Job and task of a cluster, where there is one.
    pub job: Option<String>,
    /// When the case began (RFC 3339).
    pub started: String,
    /// Wall time, s.
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
        let of = |verdict| outcome.replicates.iter().filter(|r| r.verdict == verdict).count() as u64;
        Self {
            case: case.into(),
            levels: levels.iter().map(|(factor, level)| (factor.clone(), level.clone().into())).collect(),
            folder,
            fingerprint,
            seed: outcome.seed,
            version: env!("CARGO_PKG_VERSION").into(),
            commit: option_env!("VOIDWALK_COMMIT").map(String::from),
            verdict: outcome.verdict,
            confidence: Some(outcome.confidence),
            rules_not_met: Some(
                outcome.rules.iter().filter(|rule| rule.is_broken()).map(|rule| rule.id.clone()).collect(),
            ),
            replicate_verdicts: Verdict::ALL.map(of),
            replicates: outcome.replicates.len() as u64,
            n_base: outcome.n_base,
            n_base_eq2: outcome.n_base_eq2,
            capped: outcome.capped,
            grains_per_void: outcome.grains_per_void,
            ratios: outcome.ratios,
            runs: outcome.summary.clone(),
            warnings: outcome.warnings.clone(),
            made,
        }
    }
}
