//! Collects the finished cases of a plan: `ledger.jsonl`, one JSON line a case in the order of the plan, and
//! `cases.csv`.

use std::collections::BTreeSet;
use std::path::Path;

use super::plan::{CasePlan, PlannedCase};
use super::prepared::PreparedCase;
use crate::outcome::ledger::{Campaign, LedgerLine};
use crate::run::error::RunError;
use crate::run::results::json;
use crate::words::ledger::columns;
use voidwalk_core::store::format::{self, visible_json};
use voidwalk_core::store::{read_whole, write_whole};

/// Cases of the ledger in a campaign's folder that this plan does not have: they are about to leave it.
pub(super) fn of_other_plans(plan: &CasePlan, out: &Path) -> Vec<String> {
    let text = read_whole(&out.join("ledger.jsonl")).unwrap_or_default();
    let lines = serde_json::Deserializer::from_slice(&text).into_iter::<LedgerLine>();
    let names = lines.map_while(Result::ok).map(|line| line.case);
    names.filter(|name| plan.case(name).is_none()).collect()
}

/// Collects the finished cases of a plan, in its order, and writes `ledger.jsonl`, `campaign.json` and
/// `cases.csv` into the campaign's folder.
///
/// # Errors
/// A finished case that cannot be read, for a ledger without it would be wrong; errors of the system.
pub(super) fn collect(
    plan: &CasePlan,
    cases: &[PreparedCase],
    out: &Path,
) -> Result<Vec<LedgerLine>, RunError> {
    let lines: Vec<LedgerLine> =
        cases.iter().filter_map(|case| case.read_line(out).transpose()).collect::<Result<_, _>>()?;
    let there: BTreeSet<&str> = lines.iter().map(|line| line.case.as_str()).collect();
    let is_missing = |case: &&PlannedCase| !there.contains(case.name.as_str());
    let about = Campaign {
        title: plan.title.clone(),
        plan: plan.file_name(),
        factors: plan.factors.clone(),
        cases: plan.cases.len() as u64,
        missing: plan.cases.iter().filter(is_missing).map(|case| case.name.clone()).collect(),
    };
    let mut ledger = String::new();
    for line in &lines {
        let line = serde_json::to_string(line)
            .map_err(|e| RunError::Format { file: "ledger.jsonl", source: e.into() })?;
        ledger.extend([visible_json(line), "\n".into()]);
    }
    write_whole(&out.join("ledger.jsonl"), ledger.as_bytes())?;
    write_whole(&out.join("campaign.json"), &json(format::CAMPAIGN, &about)?)?;
    write_whole(&out.join("cases.csv"), &columns(&about.factors).csv(&lines))?;
    Ok(lines)
}
