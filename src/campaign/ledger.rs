//! Collects the finished cases of a plan: `ledger.jsonl`, one JSON line a case in the order of the plan, and
//! `cases.csv`.

use std::collections::BTreeSet;
use std::path::Path;

use super::cases::PreparedCase;
use super::plan::{CampaignPlan, PlannedCase};
use crate::outcome::ledger::{Campaign, LedgerLine};
use crate::outcome::record::Statistic;
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
    write_whole(&out.join("cases.csv"), &table(&about.factors, &lines)?)?;
    Ok(lines)
}

/// Columns of `cases.csv` after the case and its levels.
const COLUMNS: [&str; 29] = [
    "verdict",
    "confidence",
    "reason",
    "rules_not_met",
    "warnings",
    "layers",
    "thickness_mm",
    "replicates",
    "n_base",
    "capped",
    "grains_per_void",
    "d15f_over_d85b",
    "d15f_over_d95b",
    "d85b_of",
    "first_eroded_mass_percent",
    "first_low",
    "first_high",
    "second_eroded_mass_percent",
    "second_low",
    "second_high",
    "first_largest_eroded_over_d15f",
    "second_largest_eroded_over_d15f",
    "first_blocked_percent",
    "second_blocked_percent",
    "replicates_no_erosion",
    "replicates_some_erosion",
    "replicates_continuing_erosion",
    "seed",
    "folder",
];

fn table(factors: &[String], lines: &[LedgerLine]) -> Result<Vec<u8>, RunError> {
    let failed = |e: csv::Error| RunError::Format { file: "cases.csv", source: e.into() };
    let mut writer = csv::Writer::from_writer(Vec::new());
    let header = std::iter::once("case").chain(factors.iter().map(String::as_str)).chain(COLUMNS);
    writer.write_record(header.map(inert)).map_err(failed)?;
    for line in lines {
        let percent = |run: usize, of: fn(&crate::outcome::record::RunSummary) -> Option<Statistic>| {
            let statistic = line.runs.get(run).and_then(of);
            let number = |value: Option<f64>| value.map_or(String::new(), |v| format!("{:.4}", 100.0 * v));
            [
                number(statistic.map(|s| s.mean)),
                number(statistic.and_then(|s| s.low)),
                number(statistic.and_then(|s| s.high)),
            ]
        };
        let largest = |run: usize| {
            let found = line.runs.get(run).and_then(|r| r.largest_eroded_over_d15f);
            found.map_or(String::new(), |s| format!("{:.5}", s.mean))
        };
        let level = |factor: &String| match line.levels.get(factor) {
            Some(serde_json::Value::String(level)) => level.clone(),
            _ => String::new(),
        };
        let mut row = vec![line.case.clone()];
        row.extend(factors.iter().map(level));
        // What a line of an earlier version does not say stays empty.
        let known = |value: Option<String>| value.unwrap_or_default();
        let thickness = line.thickness;
        row.extend([
            line.verdict.words().to_string(),
            known(line.confidence.map(|confidence| confidence.words().to_string())),
            known(line.reason.clone()),
            known(line.rules_not_met.as_ref().map(|rules| rules.len().to_string())),
            line.warnings.len().to_string(),
            known(thickness.map(|thickness| thickness.layers.to_string())),
            known(thickness.filter(|t| !t.scale_free).and_then(|t| t.mm).map(|mm| format!("{mm:.3}"))),
        ]);
        row.extend([line.replicates.to_string(), line.n_base.to_string()]);
        row.extend([
            line.capped.to_string(),
            line.grains_per_void.map_or(String::new(), |grains| format!("{grains:.5}")),
            format!("{:.5}", line.ratios.d15f_over_d85b),
            format!("{:.5}", line.ratios.d15f_over_d95b),
            line.base.map_or(String::new(), |base| base.grading()),
        ]);
        row.extend(percent(0, |r| Some(r.eroded_mass_fraction)));
        row.extend(percent(1, |r| Some(r.eroded_mass_fraction)));
        row.extend([largest(0), largest(1)]);
        row.extend([0, 1].map(|run| percent(run, |r| Some(r.blocked_fraction))[0].clone()));
        row.extend(line.replicate_verdicts[..3].iter().map(u64::to_string));
        row.extend([line.seed.to_string(), line.folder.clone()]);
        writer.write_record(row.iter().map(|cell| inert(cell))).map_err(failed)?;
    }
    writer.into_inner().map_err(|e| RunError::Format { file: "cases.csv", source: e.into_error().into() })
}

/// A cell that no spreadsheet takes for a formula.
pub(crate) fn inert(cell: &str) -> String {
    let formula = cell.starts_with(['=', '+', '-', '@', '\t', '\r']) && cell.parse::<f64>().is_err();
    if formula { format!("'{cell}") } else { cell.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::inert;

    #[test]
    fn a_cell_is_no_formula() {
        assert_eq!(["=1+1", "-3", "@x", "loose"].map(inert), ["'=1+1", "-3", "'@x", "loose"]);
    }
}
