//! The lines of a campaign's ledger.

use crate::outcome::ledger::{LedgerLine, ModelledThickness};
use crate::outcome::table::{Columns, TableCell};
use voidwalk_core::text::shorten;
use voidwalk_practice::quantity::{SizeUnit, whole};

/// The thickness of a modelled filter, as `60 layers, 93.1 mm`.
pub fn thickness(filter: &ModelledThickness) -> String {
    let unit = if filter.scale_free { "D0F" } else { "mm" };
    let size = filter.mm.map_or("no size in particular".into(), |mm| format!("{mm:.1} {unit}"));
    format!("{} {}, {size}", whole(filter.layers), if filter.layers == 1 { "layer" } else { "layers" })
}

/// The columns of `cases.csv` and of the page's table.
pub fn columns(factors: &[String]) -> Columns<'_, LedgerLine> {
    // The levels identify the case, if there are any.
    let case = |line: &LedgerLine| if line.levels.is_empty() { shorten(&line.case, 60) } else { "".into() };
    let columns = Columns::default().column("case", |line: &LedgerLine| line.case.clone());
    let mut columns = columns.page_text("Case", case);
    for factor in factors {
        let level = move |line: &LedgerLine| line.levels.get(factor)?.as_str().map(String::from);
        let shown = move |line: &LedgerLine| shorten(&level(line).unwrap_or_default(), 40);
        columns = columns.column(factor, level).page_text(factor.as_str(), shown);
    }
    let run = |line: &LedgerLine, run: usize| line.runs.get(run).cloned();
    let largest =
        move |line: &LedgerLine, number: usize| Some(run(line, number)?.largest_eroded_over_d15f?.mean);
    let blocked = move |line: &LedgerLine, number: usize| Some(run(line, number)?.blocked_fraction.mean);
    columns
        .name("verdict", "Class", |line| line.verdict)
        .place(-1)
        .broken_rules("rules_not_met", "Rules not met", |line| Some(line.rules_not_met.len()))
        .number("notes", "Notes", |line| line.notes.len())
        .column("layers", |line| line.thickness.layers)
        .thickness(3, SizeUnit::Mm, |line| {
            let ModelledThickness { layers, mm, scale_free } = line.thickness;
            (mm, scale_free, Some(layers))
        })
        .place(2)
        .column("replicates", |line| line.replicates)
        .column("n_base", |line| line.n_base)
        .page_number("Base particles", |line| {
            whole(line.n_base).shown().below(line.capped.then(|| "capped".into()))
        })
        .place(3)
        .column("capped", |line| line.capped)
        .digits("grains_per_void", 5, |line| line.grains_per_void)
        .page_number("Grains per void", |line| line.grains_per_void)
        .place(2)
        .ratios(5, SizeUnit::Mm, |line| (line.ratios, line.base))
        .eroded(|line, run| (line.runs.get(run).map(|run| run.eroded_mass_fraction), None))
        .digits("first_largest_eroded_over_d15f", 5, move |line| largest(line, 0))
        .page_number("Largest eroded/ D15F", move |line| largest(line, 0))
        .digits("second_largest_eroded_over_d15f", 5, move |line| largest(line, 1))
        .percent("first_blocked_percent", move |line| blocked(line, 0))
        .percent("second_blocked_percent", move |line| blocked(line, 1))
        .column("replicates_no_erosion", |line| line.replicate_verdicts[0])
        .column("replicates_some_erosion", |line| line.replicate_verdicts[1])
        .column("replicates_continuing_erosion", |line| line.replicate_verdicts[2])
        .column("seed", |line| line.seed)
        .column("folder", |line| line.folder.clone())
}
