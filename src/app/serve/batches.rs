//! Tables of the page: the rules of practice on two sheets; and every sample of a sheet against filters, by
//! the rules alone or with walks, in a table that grows as the walks are done.

use super::sheets::Sheets;
use crate::cases::{BatchWalks, numbered, pairs_of};
use crate::outcome::table::{ColumnKind, Columns, PageColumn};
use crate::verdict::{WalkedBatch, WalkedRow};
use crate::words::batch::{answer, of_filter, walked_columns, walks};
use crate::words::left_out::left_out_in_brief;
use crate::words::rule::{LIMITS_ROUNDED, PARTS, regrade_reason};
use crate::words::{batch, practice_line, rule, sentence};
use serde::Deserialize;
use serde_json::{Value, json};
use std::path::PathBuf;
use voidwalk_practice::quantity::SizeUnit;
use voidwalk_practice::rule_result::{RuleResult, result_of};
use voidwalk_practice::{BatchFilter, BatchRow, BatchTable, PairOptions, PairRules};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct AskedBatch {
    /// Number of the sheet whose soils are all samples; for walks of `filters`, the one base.
    pub(crate) base: String,
    pub(crate) filters: Vec<String>,
    /// Pairs to walk, and the depth: `governing`, `look`, `alone`, or `filters` for one base.
    pub(crate) walks: String,
    #[serde(flatten)]
    pub(crate) tables: AskedTables,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct AskedTables {
    /// Density in one word, or empty.
    pub(crate) density: String,
    pub(crate) pack: bool,
    pub(crate) quick: bool,
    /// True if the base is walked as sampled, not as practice regrades it.
    pub(crate) as_sampled: bool,
    /// True if base and filter are taken as given even if they look exchanged.
    pub(crate) as_given: bool,
    pub(crate) changes: Vec<String>,
}

const FILTERS: usize = 6;

fn filter_paths(sheets: &Sheets, named: &[impl AsRef<str>]) -> Result<Vec<PathBuf>, String> {
    match (1..=FILTERS).contains(&named.len()) {
        true => named.iter().map(|name| sheets.path(name.as_ref())).collect(),
        false => Err(format!("name one to {FILTERS} filters")),
    }
}

/// Names of these filters on the page: their own names, numbered if two agree.
pub(crate) fn filter_names(sheets: &Sheets, paths: &[PathBuf]) -> Vec<String> {
    numbered(paths.iter().map(|path| sheets.as_named(&path.display().to_string())).collect())
}

impl AskedBatch {
    pub(crate) fn walks(&self) -> Result<BatchWalks, String> {
        match self.walks.as_str() {
            "governing" => Ok(BatchWalks::GoverningInFull),
            "look" => Ok(BatchWalks::FirstLook),
            "alone" => Ok(BatchWalks::GoverningAlone),
            "filters" => Ok(BatchWalks::OneBase),
            other => Err(format!("walks: {other}: governing, look, alone or filters")),
        }
    }

    pub(crate) fn sheets(&self, sheets: &Sheets) -> Result<(PathBuf, Vec<PathBuf>), String> {
        let filters = filter_paths(sheets, &self.filters)?;
        let base = if self.has_one_base() { &self.base } else { whole_sheet(&self.base) };
        Ok((sheets.path(base)?, filters))
    }

    fn has_one_base(&self) -> bool {
        self.walks == "filters"
    }

    pub(crate) fn title(&self, samples: &str, filters: &[String]) -> String {
        let every = if self.has_one_base() { "" } else { "Every sample of " };
        format!("{every}{samples} on {}", filters.join(", "))
    }
}

fn whole_sheet(soil: &str) -> &str {
    soil.split_once('#').map_or(soil, |(sheet, _)| sheet)
}

/// JSON of a table for the page: headings, a text below each, cells, and the class of each row's result.
fn table<'r, T: 'r>(
    columns: Columns<T>,
    rows: impl IntoIterator<Item = &'r T>,
    class: impl Fn(&T) -> Option<&'static str>,
) -> Value {
    let columns: Vec<_> = columns.of_page().collect();
    let kind = |column: &PageColumn<T>| match column.kind {
        _ if column.name == "result" => "result",
        ColumnKind::Name => "name",
        ColumnKind::Text => "text",
        ColumnKind::Number => "number",
    };
    let cells = |row: &T| columns.iter().map(|column| (column.cell)(row).line()).collect();
    let (rows, classes): (Vec<Vec<String>>, Vec<_>) =
        rows.into_iter().map(|row| (cells(row), class(row))).unzip();
    json!({
        "headings": columns.iter().map(|column| &column.heading.text).collect::<Vec<_>>(),
        "kinds": columns.iter().map(kind).collect::<Vec<_>>(),
        "rows": rows,
        "classes": classes,
    })
}

/// Class of a sample's result; a result that is met but doubted is not green.
fn class_of(row: &BatchRow, is_doubted: bool) -> Option<&'static str> {
    match row.met {
        Some(true) if !is_doubted && !row.breaks_if_dispersive => Some("keeps"),
        Some(false) => Some("breaks"),
        _ => None,
    }
}

pub(crate) fn so_far(rows: &[WalkedRow], inches: bool) -> Value {
    let columns = walked_columns(SizeUnit::of(false, inches));
    table(columns, rows, |row| class_of(&row.rules, row.is_doubted()))
}

/// JSON of a finished batch for the page: its table, and the answers for a client on each filter.
pub(crate) fn of_batch(batch: &WalkedBatch) -> Value {
    let rules: Vec<BatchRow> = batch.rows.iter().map(|row| row.rules.clone()).collect();
    let unit = SizeUnit::of(false, batch.inches);
    let lines = |filter: &BatchFilter| -> Vec<String> {
        let answers = batch.governing(&filter.name).into_iter();
        let answers = answers.map(|row| format!("{}: {}", row.rules.sample, answer(row)));
        let walks = walks(batch, &filter.name, unit).into_iter();
        of_filter(filter, &rules, unit).into_iter().chain(walks).chain(answers).collect()
    };
    let mut value = so_far(&batch.rows, batch.inches);
    value["filters"] = batch.filters.iter().map(lines).collect();
    value["notes"] = json!(batch.notes);
    value["leaves_out"] = json!(left_out_in_brief(&batch.model_leaves_out));
    value
}

const SHOWN: [&str; 7] = ["result", "rule", "authority", "quantity", "value", "limit", "note"];

/// Rules in groups with their results for the pair; the page computes nothing.
pub(crate) fn rules_of_pair(pair: &PairRules) -> Value {
    let decision = pair.decision();
    let listed = decision.listed();
    let part = |(role, title)| {
        let rules = listed.iter().map(AsRef::as_ref).filter(|rule| rule.role == role);
        let mut part = table(rule::columns(SizeUnit::Mm).only(&SHOWN), rules, |rule| match result_of(rule) {
            RuleResult::Met => Some("keeps"),
            RuleResult::NotMet => Some("breaks"),
            _ => Some("none"),
        });
        part["title"] = json!(title);
        part
    };
    let named = |result| -> Vec<&str> {
        let rules = listed.iter().map(AsRef::as_ref).filter(|rule| result_of(rule) == result);
        rules.map(|rule| rule.name.as_str()).collect()
    };
    json!({
        "base": pair.base,
        "parts": PARTS.map(part),
        "not_met": named(RuleResult::NotMet),
        "open": named(RuleResult::NoResult),
        "notes": pair.notes.iter().map(|note| sentence(note, SizeUnit::Mm)).collect::<Vec<_>>(),
        "practice": practice_line(&decision, SizeUnit::Mm),
        "why": regrade_reason(pair.base.why),
        "rounded": LIMITS_ROUNDED,
    })
}

const MOST_SHOWN: usize = 1000;

pub(crate) fn samples(
    sheets: &Sheets,
    base: &str,
    filters: &[&str],
    options: PairOptions,
) -> Result<BatchTable, String> {
    let paths = filter_paths(sheets, filters)?;
    let table = pairs_of(&sheets.path(whole_sheet(base))?, &paths, options, true);
    let mut table = table.map_err(|problem| sheets.as_named(&problem.to_string()))?;
    // Sheets appear here under their own names, which may repeat, without folders.
    let names = filter_names(sheets, &paths);
    let of_filter = (table.rows.len() / table.filters.len()).max(1);
    for (at, row) in table.rows.iter_mut().enumerate() {
        row.filter.clone_from(&names[at / of_filter]);
    }
    table.filters.iter_mut().zip(names).for_each(|(filter, name)| filter.name = name);
    table.notes.iter_mut().for_each(|note| *note = sheets.as_named(note));
    Ok(table)
}

/// JSON of the samples for the page, with sentences on each filter.
pub(crate) fn of_samples(samples: &BatchTable) -> Value {
    let all = &samples.rows;
    let rows = &all[..all.len().min(MOST_SHOWN)];
    let cut = (rows.len() < all.len())
        .then(|| format!("the first {MOST_SHOWN} of {} rows; the file has all", all.len()));
    let notes = samples.notes.iter().cloned().chain(cut);
    let mut value = table(batch::columns(SizeUnit::Mm), rows, |row| class_of(row, row.may_lose_fines));
    value["filters"] = samples.filters.iter().map(|filter| of_filter(filter, all, SizeUnit::Mm)).collect();
    value["notes"] = notes.collect();
    value
}

#[cfg(test)]
mod tests {
    use super::*;
    use voidwalk_core::gradation::Gradation;
    use voidwalk_sheets::SoilSample;

    #[test]
    fn what_is_met_and_in_doubt_does_not_stand_in_green() {
        let curve = |points: &[(f64, f64)]| Gradation::from_lines(points).unwrap();
        let base = curve(&[(0.08, 0.0), (0.3, 100.0)]);
        let sample = SoilSample { name: "A".into(), path: "A".into(), curve: base };
        let filter = vec![("F".to_owned(), curve(&[(0.5, 0.0), (2.0, 100.0)]))];
        let row = BatchRow::of(&sample, ("F", &filter), PairOptions::default());
        assert_eq!([class_of(&row, false), class_of(&row, true)], [Some("keeps"), None]);
        let dispersive = BatchRow { breaks_if_dispersive: true, ..row.clone() };
        let broken = BatchRow { met: Some(false), ..row };
        assert_eq!([class_of(&dispersive, false), class_of(&broken, true)], [None, Some("breaks")]);
    }
}
