//! Lines of a campaign's ledger, columns that its table shares with batches, and D85 of a base.

use crate::outcome::BaseSize;
use crate::outcome::ledger::{LedgerLine, ModelledThickness};
use crate::outcome::record::Statistic;
use crate::outcome::table::{Columns, Emphasis, TableCell};
use voidwalk_core::text::shorten;
use voidwalk_practice::quantity::{SizeUnit, length, percent, significant, whole};
use voidwalk_sheets::us_sieve;

/// Thickness of a modelled filter, as `60 layers, 93.1 mm`.
pub(crate) fn thickness(filter: &ModelledThickness) -> String {
    let unit = if filter.scale_free { "D0F" } else { "mm" };
    let size = filter.mm.map_or("no size in particular".into(), |mm| format!("{mm:.1} {unit}"));
    format!("{} {}, {size}", whole(filter.layers), if filter.layers == 1 { "layer" } else { "layers" })
}

/// Columns of `cases.csv` and of the page's table.
pub(crate) fn columns(factors: &[String]) -> Columns<'_, LedgerLine> {
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
        .column("rules_not_met", |line| Some(line.rules_not_met.len()))
        .page_number("Rules not met", |line| {
            let count = line.rules_not_met.len();
            Some(count).shown().emphasised((count > 0).then_some(Emphasis::Doubt))
        })
        .number("notes", "Notes", |line| line.notes.len())
        .column("layers", |line| line.thickness.layers)
        .digits("thickness_mm", 3, |line| line.thickness.mm.filter(|_| !line.thickness.scale_free))
        .page_number("Thickness", |line| {
            let ModelledThickness { layers, mm, scale_free } = line.thickness;
            let unit = if scale_free { SizeUnit::D0f } else { SizeUnit::Mm };
            mm.map(|mm| length(mm, unit)).shown().below(Some(format!("{} layers", whole(layers))))
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
        .digits("d15f_over_d85b", 5, |line| Some(line.ratios.d15f_over_d85b))
        .page_number("D15F/ D85B", |line| {
            let base = line.base.map(|base| base_size(&base, SizeUnit::Mm));
            significant(line.ratios.d15f_over_d85b).shown().below(base)
        })
        .place(1)
        .digits("d15f_over_d95b", 5, |line| Some(line.ratios.d15f_over_d95b))
        .page_number("D15F/ D95B", |line| line.ratios.d15f_over_d95b)
        .place(1)
        .column("d85b_of", |line| line.base.map(|base| grading(&base)))
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

/// Eroded mass in a run, and its range if the constriction curve has one.
type Eroded = (Option<Statistic>, Option<[f64; 2]>);

impl<'a, T: 'a> Columns<'a, T> {
    /// Adds the eroded mass in the first and the second run, with its interval and, on a page, its range
    /// if the constriction curve has one.
    pub(super) fn eroded(self, eroded_of: fn(&T, usize) -> Eroded) -> Self {
        let cell = move |row: &T, run| {
            let (statistic, range) = eroded_of(row, run);
            let curve = |[low, high]: [f64; 2]| format!("curve: {} to {}", percent(low), percent(high));
            statistic.shown().below(range.map(curve))
        };
        self.statistic(["first_eroded_mass_percent", "first_low", "first_high"], move |row| {
            eroded_of(row, 0).0
        })
        .page_number("Eroded, first run", move |row| cell(row, 0))
        .statistic(["second_eroded_mass_percent", "second_low", "second_high"], move |row| {
            eroded_of(row, 1).0
        })
        .page_number("second run", move |row| cell(row, 1))
    }
}

/// Grading of a base: as sampled, or the sieve on which it is regraded.
pub(crate) fn grading(base: &BaseSize) -> String {
    let regraded = |at| format!("regraded on {} mm", significant(at));
    base.regraded_at_mm.map_or_else(|| "as sampled".into(), regraded)
}

/// Full text, as `D85B 1.80 mm, regraded on 4.75 mm (as sampled 12.8 mm)`; if inches are shown, with
/// inches after each D85 and the name of a US sieve.
pub(crate) fn base_size(base: &BaseSize, unit: SizeUnit) -> String {
    let size = |mm: f64| length(mm, unit).to_string();
    let before = base.as_sampled_mm.filter(|_| base.regraded_at_mm.is_some());
    let before = before.map_or(String::new(), |d85| format!(" (as sampled {})", size(d85)));
    let comma = if base.regraded_at_mm.is_some() { "," } else { "" };
    let sieve = base.regraded_at_mm.filter(|_| unit == SizeUnit::MmAndInches);
    let grading = match sieve.and_then(|at| Some((us_sieve(at)?, at))) {
        Some((name, at)) => format!("regraded on {name}, {} mm", significant(at)),
        None => grading(base),
    };
    format!("D85B {}{comma} {grading}{before}", size(base.d85_mm))
}
