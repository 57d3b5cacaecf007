//! Forecast of the cases of a plan, and their mistakes, before any work.

use std::collections::BTreeMap;

use rayon::prelude::*;
use serde::Serialize;

use super::plan::{CasePlan, PlannedCase};
use super::prepared::{FailedCase, named, wanted};
use super::run::CaseOptions;
use crate::case::{Case, PackingPlan};
use crate::run::RunError;
use crate::run::callbacks::Callbacks;
use crate::run::machine::{CasesAtOnce, threads};
use crate::run::prepare::Draft;
use crate::run::replicates::{have_networks, runs_to_walk};

/// Forecast of the cases of a plan; sizes and times are estimates.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct PlanCheck {
    /// File of the plan.
    pub(crate) plan: String,
    /// Its title.
    pub(crate) title: String,
    /// Its factors.
    pub(crate) factors: Vec<String>,
    /// Each case, in the order of the plan.
    pub(crate) cases: Vec<CaseCheck>,
    /// Packings of filters that the cases need, each once.
    pub(crate) packings: u64,
    /// Number of these still to be made; until then sizes and times of their cases are guesses.
    pub(crate) packings_to_make: u64,
    /// Seconds of one core of this machine for these packings.
    pub(crate) packing_core_seconds: f64,
    /// Seconds of one core of this machine for all walks.
    pub(crate) core_seconds: f64,
    /// Memory of the largest case (bytes).
    pub(crate) bytes: u64,
    /// Cases that this machine walks at the same time.
    pub(crate) cases_at_once: u64,
    /// Memory that the program then takes (bytes).
    pub(crate) bytes_at_once: u64,
    /// Memory that a case may take (bytes).
    pub(crate) bytes_allowed: u64,
}

/// Forecast of one case.
#[derive(Clone, Debug, Default, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct CaseCheck {
    /// Its name.
    pub(crate) case: String,
    /// Base particles of a run.
    pub(crate) n_base: u64,
    /// Runs to walk.
    pub(crate) runs_to_walk: u64,
    /// Memory of a walk (bytes).
    pub(crate) bytes: u64,
    /// Seconds of one core of this machine for its walks.
    pub(crate) core_seconds: f64,
    /// Problem of the case; empty for a sound case, whose other fields are 0 otherwise.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub(crate) problem: String,
}

impl PlanCheck {
    /// Reason to refuse the plan, even if it can be forecast: its unsound cases.
    pub(crate) fn refusal(&self) -> Option<RunError> {
        let wrong = self.cases.iter().filter(|case| !case.problem.is_empty());
        let failed = |case: &CaseCheck| FailedCase { case: case.case.clone(), problem: case.problem.clone() };
        let wrong: Vec<FailedCase> = wrong.map(failed).collect();
        (!wrong.is_empty()).then(|| RunError::Refused(named(&wrong)))
    }
}

/// Forecasts the cases of a plan, here and with these options, and reports the mistakes in each. Packs,
/// claims and writes nothing. Errors: the plan has no such part, or there is no such folder of packings.
pub(crate) fn check_plan(plan: &CasePlan, options: &CaseOptions) -> Result<PlanCheck, RunError> {
    let wanted = wanted(plan, &options.part)?;
    let (limits, _) = options.rooms(&options.out, &wanted);
    let pool = threads(options.threads)?;
    let workers = pool.current_num_threads() as u64;
    let look = |planned: &PlannedCase| -> Result<(Case, Option<PackingPlan>), RunError> {
        let draft = Draft::new(planned.scene.clone())?;
        let packing = draft.packing.clone();
        let made = packing.as_ref().map(|packing| options.packed(packing)).transpose()?.flatten();
        let mut case = draft.finished(made)?;
        case.place(&limits, workers, &options.out)?;
        have_networks(&case, &Callbacks::default())?;
        Ok((case, packing))
    };
    let check = |planned: &PlannedCase| {
        let none = CaseCheck { case: planned.name.clone(), ..CaseCheck::default() };
        match look(planned) {
            Err(problem) => (CaseCheck { problem: problem.to_string(), ..none }, None),
            Ok((case, packing)) => {
                let check = CaseCheck {
                    n_base: case.supply.n_base,
                    runs_to_walk: runs_to_walk(&case),
                    bytes: case.bytes(case.supply.n_base, workers) + case.kept_bytes(),
                    core_seconds: case.core_seconds_here(),
                    ..none
                };
                (check, Some((case, packing)))
            }
        }
    };
    let looked: Vec<_> = pool.install(|| wanted.into_par_iter().map(check).collect());
    let mut packings: BTreeMap<String, PackingPlan> = BTreeMap::new();
    for packing in looked.iter().filter_map(|(_, sound)| sound.as_ref()?.1.as_ref()) {
        packings.entry(packing.fingerprint()).or_insert_with(|| packing.clone());
    }
    let is_missing = |packing: &&PackingPlan| matches!(options.packed(packing), Ok(None));
    let missing: Vec<&PackingPlan> = packings.values().filter(is_missing).collect();
    let sound: Vec<&Case> = looked.iter().filter_map(|(_, sound)| Some(&sound.as_ref()?.0)).collect();
    let at_once = CasesAtOnce::here(&sound, workers);
    let cases: Vec<CaseCheck> = looked.into_iter().map(|(case, _)| case).collect();
    Ok(PlanCheck {
        plan: plan.file.clone(),
        title: plan.title.clone(),
        factors: plan.factors.clone(),
        packings: packings.len() as u64,
        packings_to_make: missing.len() as u64,
        packing_core_seconds: missing.iter().map(|packing| packing.core_seconds_here()).sum(),
        core_seconds: cases.iter().map(|case| case.core_seconds).sum(),
        bytes: cases.iter().map(|case| case.bytes).max().unwrap_or(0),
        cases_at_once: at_once.cases,
        bytes_at_once: at_once.bytes,
        bytes_allowed: limits.memory,
        cases,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn a_plan_says_what_each_case_takes_and_what_is_wrong() {
        let text = "[set]\nreplicates = 3\nrecord.sensitivity = []\n\
            [[factor]]\nname = \"layers\"\nsetting = \"network.nz\"\nvalues = [20, 40]\n\
            [[case]]\nname = \"gone\"\nset = { \"base.sieve\" = \"nowhere.csv\" }\n";
        let plan = CasePlan::parse(text.as_bytes(), Path::new("plan.toml")).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let options = CaseOptions { out: folder.path().join("c"), ..CaseOptions::default() };
        let check = check_plan(&plan, &options).unwrap();
        let [thin, thick, gone] = &check.cases[..] else { panic!("{check:?}") };
        assert!(thick.n_base > thin.n_base && thick.bytes > thin.bytes && thin.core_seconds > 0.0);
        assert_eq!((thin.runs_to_walk, check.packings), (6, 0));
        assert!(gone.problem.contains("nowhere.csv") && gone.n_base == 0, "{gone:?}");
        assert_eq!(check.bytes, thick.bytes);
        // Two cases at most, and the program itself.
        assert!((1..=2).contains(&check.cases_at_once), "{check:?}");
        assert!(check.bytes_at_once > check.cases_at_once * thin.bytes + 100_000_000, "{check:?}");
        let refusal = check.refusal().unwrap();
        assert!(refusal.to_string().starts_with("case gone: "), "{refusal}");
        assert_eq!(refusal.exit().code(), 2);
        assert!(!options.out.exists());
    }
}
