//! Cases side by side: their tables, and what the difference between two comes to.

use crate::outcome::comparison::{ComparedCase, ComparedPair, Comparison};
use crate::outcome::quantity::SizeUnit;
use crate::outcome::record::Statistic;
use crate::outcome::table::Columns;

/// A difference in percentage points. No minus before nothing.
fn points(share: f64) -> String {
    let text = format!("{:.2}", 100.0 * share);
    if text == "-0.00" { "0.00".to_owned() } else { text }
}

fn interval(low: f64, high: f64) -> String {
    format!("95 % interval {} to {}", points(low), points(high))
}

/// The difference of a pair in a run, without the last end.
pub fn difference(pair: &ComparedPair) -> String {
    let (one, other) = (&pair.first, &pair.second);
    let run = if pair.run == 1 { "first" } else { "second" };
    let Statistic { mean, low, high, .. } = pair.difference;
    let Some((low, high)) = low.zip(high) else {
        let by = points(mean);
        return format!(
            "{run} run: {one} less {other} is {by} percentage points in the one replicate of both"
        );
    };
    let (more, by, range) = match pair.differ {
        Some(true) if mean > 0.0 => ("more", points(mean), interval(low, high)),
        Some(true) => ("less", points(-mean), interval(-high, -low)),
        _ => {
            let (by, range) = (points(mean), interval(low, high));
            return format!(
                "{run} run: no difference between {one} and {other} is shown; {one} less {other} is {by} \
                 percentage points ({range})"
            );
        }
    };
    format!("{run} run: {one} erodes {by} percentage points {more} than {other} ({range})")
}

/// What no interval of a difference holds, where a case has it.
pub fn not_in_intervals(comparison: &Comparison) -> Option<&'static str> {
    comparison.has_range_of_curve().then_some("how far the constriction curve of a case may be off")
}

/// The columns of `compare.csv` and of the page's table, whose sizes are shown in this unit.
pub fn case_columns(unit: SizeUnit) -> Columns<'static, ComparedCase> {
    Columns::default()
        .column("case", |case: &ComparedCase| case.name.clone())
        .headed("Case")
        .column("verdict", |case| case.verdict)
        .headed("Class")
        .broken_rules("rules_not_kept", "Rules not kept", |case| Some(case.rules_not_kept.len()))
        .column("replicates", |case| case.replicates)
        .headed("Replicates")
        .place(3)
        .column("n_base", |case| case.n_base)
        .headed("Base particles")
        .place(3)
        .ratios(6, unit, |case| (case.ratios, case.base))
        .eroded(|case, run| (case.runs.get(run).copied(), case.curve_range.get(run).copied()))
        .digits("grains_per_void", 5, |case| case.grains_per_void)
        .headed("Grains per void")
        .place(2)
        .thickness(5, unit, |case| (case.thickness_mm, case.scale_free, None))
        .place(2)
        .column("folder", |case| case.folder.clone())
}

/// The columns of `compare_pairs.csv`.
pub fn pair_columns() -> Columns<'static, ComparedPair> {
    Columns::default()
        .column("first", |pair: &ComparedPair| pair.first.clone())
        .column("second", |pair| pair.second.clone())
        .column("run", |pair| pair.run)
        .column("replicates", |pair| pair.replicates)
        .statistic(["difference_percentage_points", "low", "high"], |pair| Some(pair.difference))
        .percent("joint_low", |pair| pair.joint.map(|joint| joint[0]))
        .percent("joint_high", |pair| pair.joint.map(|joint| joint[1]))
        .column("differ", |pair| pair.differ)
}
