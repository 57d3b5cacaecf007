//! Collects the finished cases of a plan: `ledger.jsonl`, one JSON line a case in the order of the plan, and `cases.csv`.

use std::path::Path;

use super::run_cases::PreparedCase;
use crate::outcome::ledger::{Campaign, LedgerLine};
use crate::outcome::record::Statistic;
use crate::run::results::{ResultError, json};
use crate::store::{StoreError, write_whole};

/// The finished cases, in the order of the plan.
///
/// # Errors
/// One that is there and cannot be read: a ledger without it would be wrong.
pub fn collect(cases: &[PreparedCase], out: &Path) -> Result<Vec<LedgerLine>, StoreError> {
    cases.iter().filter_map(|case| case.read_line(out).transpose()).collect()
}

/// Writes `ledger.jsonl`, `cases.csv` and `campaign.json` into the campaign's folder.
///
/// # Errors
/// What the system says.
pub fn write(out: &Path, about: &Campaign, lines: &[LedgerLine]) -> Result<(), ResultError> {
    let mut ledger = Vec::new();
    for line in lines {
        serde_json::to_writer(&mut ledger, line)
            .map_err(|e| ResultError::Format { file: "ledger.jsonl", source: e.into() })?;
        ledger.push(b'\n');
    }
    write_whole(&out.join("ledger.jsonl"), &ledger)?;
    write_whole(&out.join("campaign.json"), &json("campaign.json", about)?)?;
    write_whole(&out.join("cases.csv"), &table(&about.factors, lines)?)?;
    Ok(())
}

/// Columns of `cases.csv` after the case and its levels.
const COLUMNS: [&str; 22] = [
    "verdict",
    "replicates",
    "n_base",
    "capped",
    "grains_per_void",
    "d15f_over_d85b",
    "d15f_over_d95b",
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

fn table(factors: &[String], lines: &[LedgerLine]) -> Result<Vec<u8>, ResultError> {
    let failed = |e: csv::Error| ResultError::Format { file: "cases.csv", source: e.into() };
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
        row.extend([line.verdict.words().to_string(), line.replicates.to_string(), line.n_base.to_string()]);
        row.extend([
            line.capped.to_string(),
            line.grains_per_void.map_or(String::new(), |grains| format!("{grains:.5}")),
            format!("{:.5}", line.ratios.d15f_over_d85b),
            format!("{:.5}", line.ratios.d15f_over_d95b),
        ]);
        row.extend(percent(0, |r| Some(r.eroded_mass_fraction)));
        row.extend(percent(1, |r| Some(r.eroded_mass_fraction)));
        row.extend([largest(0), largest(1)]);
        row.extend([0, 1].map(|run| percent(run, |r| Some(r.blocked_fraction))[0].clone()));
        row.extend(line.replicate_verdicts[..3].iter().map(u64::to_string));
        row.extend([line.seed.to_string(), line.folder.clone()]);
        writer.write_record(row.iter().map(|cell| inert(cell))).map_err(failed)?;
    }
    writer.into_inner().map_err(|e| ResultError::Format { file: "cases.csv", source: e.into_error().into() })
}

/// A cell that no spreadsheet takes for a formula.
fn inert(cell: &str) -> String {
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
