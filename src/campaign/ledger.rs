//! Collects the finished cases of a plan: `ledger.jsonl`, one JSON line a case in the order of the plan, and
//! `cases.csv`.

use std::collections::BTreeSet;
use std::path::Path;

use super::cases::PreparedCase;
use super::plan::{CampaignPlan, PlannedCase};
use crate::outcome::ledger::{Campaign, LedgerLine};
use crate::outcome::record::Confidence;
use crate::outcome::table::Columns;
use crate::run::error::RunError;
use crate::run::results::json;
use crate::store::{read_whole, write_whole};

/// Cases of the ledger in a campaign's folder that this plan does not have: they are about to leave it.
pub(super) fn of_other_plans(plan: &CampaignPlan, out: &Path) -> Vec<String> {
    let text = read_whole(&out.join("ledger.jsonl")).unwrap_or_default();
    let lines = serde_json::Deserializer::from_slice(&text).into_iter::<LedgerLine>();
    let names = lines.map_while(Result::ok).map(|line| line.case);
    names.filter(|name| plan.case(name).is_none()).collect()
}

/// Collects the finished cases of a plan, in its order, and writes `ledger.jsonl`, `campaign.json` and
/// `cases.csv` into the campaign's folder.
///
/// # Errors
/// A finished case that cannot be read, for a ledger without it would be wrong; what the system says.
pub(super) fn collect(
    plan: &CampaignPlan,
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
    let mut ledger = Vec::new();
    for line in &lines {
        serde_json::to_writer(&mut ledger, line)
            .map_err(|e| RunError::Format { file: "ledger.jsonl", source: e.into() })?;
        ledger.push(b'\n');
    }
    write_whole(&out.join("ledger.jsonl"), &ledger)?;
    write_whole(&out.join("campaign.json"), &json("campaign.json", &about)?)?;
    write_whole(&out.join("cases.csv"), &columns(&about.factors).csv(&lines))?;
    Ok(lines)
}

/// `cases.csv`. What a line of an earlier version does not say stays empty.
fn columns(factors: &[String]) -> Columns<'_, LedgerLine> {
    let mut columns = Columns::default().column("case", |line: &LedgerLine| line.case.clone());
    for factor in factors {
        columns = columns.column(factor, move |line| line.levels.get(factor)?.as_str().map(String::from));
    }
    let run = |line: &LedgerLine, run: usize| line.runs.get(run).cloned();
    let eroded = move |line: &LedgerLine, of: usize| run(line, of).map(|run| run.eroded_mass_fraction);
    let largest = move |line: &LedgerLine, of: usize| Some(run(line, of)?.largest_eroded_over_d15f?.mean);
    let blocked = move |line: &LedgerLine, of: usize| Some(run(line, of)?.blocked_fraction.mean);
    columns
        .column("verdict", |line| line.verdict.words())
        .column("confidence", |line| line.confidence.map(Confidence::words))
        .column("reason", |line| line.reason.clone())
        .column("rules_not_met", |line| line.rules_not_met.as_ref().map(Vec::len))
        .column("warnings", |line| line.warnings.len())
        .column("layers", |line| line.thickness.map(|thickness| thickness.layers))
        .digits("thickness_mm", 3, |line| line.thickness.filter(|of| !of.scale_free)?.mm)
        .column("replicates", |line| line.replicates)
        .column("n_base", |line| line.n_base)
        .column("capped", |line| line.capped)
        .digits("grains_per_void", 5, |line| line.grains_per_void)
        .digits("d15f_over_d85b", 5, |line| Some(line.ratios.d15f_over_d85b))
        .digits("d15f_over_d95b", 5, |line| Some(line.ratios.d15f_over_d95b))
        .column("d85b_of", |line| line.base.map(|base| base.grading()))
        .statistic(["first_eroded_mass_percent", "first_low", "first_high"], move |line| eroded(line, 0))
        .statistic(["second_eroded_mass_percent", "second_low", "second_high"], move |line| eroded(line, 1))
        .digits("first_largest_eroded_over_d15f", 5, move |line| largest(line, 0))
        .digits("second_largest_eroded_over_d15f", 5, move |line| largest(line, 1))
        .percent("first_blocked_percent", move |line| blocked(line, 0))
        .percent("second_blocked_percent", move |line| blocked(line, 1))
        .column("replicates_no_erosion", |line| line.replicate_verdicts[0])
        .column("replicates_some_erosion", |line| line.replicate_verdicts[1])
        .column("replicates_continuing_erosion", |line| line.replicate_verdicts[2])
        .column("seed", |line| line.seed)
        .column("folder", |line| line.folder.clone())
}
