//! Command `voidwalk rules`: the decision of filter practice on two soils, or on many samples and filters in
//! one table, without a walk.

use super::args::RulesArgs;
use super::print::{answer, lines, plain, shown, to_copy, to_stdout, wrapped};
use crate::cases::pairs_of;
use crate::outcome::table::{ColumnKind, Columns};
use crate::run::{RunError, write_new};
use crate::scene::TableOptions;
use crate::words::batch::{columns, of_filter as filter_lines};
use crate::words::left_out::NOT_COVERED;
use crate::words::rule::{LIMITS_ROUNDED, PARTS, limit, regrade_reason, result, rule_notes, value};
use crate::words::{practice_line, sentence};
use std::path::Path;
use voidwalk_core::store::format;
use voidwalk_practice::batch::{NAMED, governing};
use voidwalk_practice::quantity::{SizeUnit, significant};
use voidwalk_practice::rule_result::{RuleResult, result_of};
use voidwalk_practice::{AppliedRule, BatchFilter, BatchRow, PairOptions, PairRules, Refusal, RuleNote};
use voidwalk_sheets::{curves_in_file, notes_in_file};

const INDENT: usize = 14;

pub(crate) fn rules(args: &RulesArgs) -> Result<(), RunError> {
    let changes = args.settings.assignments.clone();
    let options = TableOptions { as_given: args.as_given, changes, ..TableOptions::default() }.of_rules()?;
    let filter = match &args.filters[..] {
        [filter] if !args.each => filter,
        _ => return rules_of_each(args, options),
    };
    if args.csv.is_some() {
        return Err(RunError::refused("--csv goes with --each, or with several filters"));
    }
    let bases = curves_in_file(&args.base, None).map_err(RunError::refused)?;
    let filters = curves_in_file(filter, None).map_err(RunError::refused)?;
    let pair = PairRules::guarded(&bases, &filters, options).map_err(|mistake| {
        let files = format!("base {}, filter {}", shown(&args.base), shown(filter));
        RunError::Refused(format!("{files}: {}", Refusal(&mistake, "--as-given")))
    })?;
    let assumed = |path| notes_in_file(path).map_err(RunError::refused);
    let notes = [("base", assumed(&args.base)?), ("filter", assumed(filter)?)];
    answer((args.json, false), format::RULES, &pair, || words(&pair, (&args.base, filter), &notes))
}

fn words(
    pair: &PairRules,
    (base_file, filter_file): (&Path, &Path),
    notes: &[(&str, Vec<String>)],
) -> String {
    let (filter, base) = (&pair.filter, &pair.base);
    let mut text = String::new();
    let mut line = |s: String| text += &(plain(&s) + "\n");
    let of_curve = |curves: &[String], curve: &str| {
        if curves.is_empty() { String::new() } else { format!(", curve {curve}") }
    };
    let how = match base.regraded_at_mm {
        Some(at) => format!(
            "regraded on {} mm ({} as sampled)",
            number(Some(at)),
            sizes(&[("D85", base.d85_as_sampled_mm)])
        ),
        None => "as sampled".into(),
    };
    line(format!(
        "base    {}{}: {}, {how}; {}, Cu {} as sampled",
        base_file.display(),
        of_curve(&base.curves, &base.curve),
        sizes(&[("D85", base.d85_mm), ("D95", base.d95_mm)]),
        sizes(&[("D15", base.d15_mm)]),
        number(base.cu)
    ));
    let category =
        base.category.map_or("category not known".into(), |category| format!("category {category}"));
    let fines =
        base.fines_percent.map_or("fines not known".into(), |percent| format!("{percent:.1} % fines"));
    let regraded = match base.regraded_at_mm {
        Some(at) => {
            format!("D85, D95 and fines after regrading on {at:.3} mm ({})", regrade_reason(base.why))
        }
        None => format!("not regraded ({})", regrade_reason(base.why)),
    };
    let dispersive = if base.dispersive { ", dispersive" } else { "" };
    line(format!("        {category}{dispersive}, {fines}; {regraded}"));
    line(format!(
        "filter  {}{}: {}, Cu {}",
        filter_file.display(),
        of_curve(&filter.curves, &filter.curve),
        sizes(&[("D15", filter.d15_mm), ("D85", filter.d85_mm)]),
        number(filter.cu)
    ));
    let decision = pair.decision();
    line(format!("practice {}", practice_line(&decision, SizeUnit::Mm)));
    for note in &pair.notes {
        let word = if note.is_of_a_mistake() { "warning" } else { "note   " };
        line(format!("{word} {}", sentence(note, SizeUnit::Mm)));
    }
    for (whose, notes) in notes {
        notes.iter().for_each(|note| line(format!("note    {whose}: {note}")));
    }
    let notes = |notes: &[RuleNote]| rule_notes(notes, SizeUnit::Mm);
    let listed = decision.listed();
    for (role, heading) in PARTS {
        line(String::new());
        line(heading.to_owned());
        for rule in listed.iter().filter(|rule| rule.role == role) {
            line(row(rule));
            let curves = [("filter", &rule.filter_curve), ("base", &rule.base_curve)];
            let named = curves.iter().filter(|(_, curve)| !curve.is_empty());
            let curves: Vec<String> = named.map(|(whose, curve)| format!("{whose} curve {curve}")).collect();
            let curves = curves.join(", ");
            // The rule's name gives its authority unless a manual states it as well.
            let is_stated = !rule.stated_by.is_empty();
            let authorities = is_stated.then(|| format!("authority: {}", rule.authorities().join(", ")));
            let more = [curves, notes(&rule.notes), notes(&rule.needs), authorities.unwrap_or_default()];
            for text in more.iter().filter(|text| !text.is_empty()) {
                wrapped(text, INDENT).into_iter().for_each(&mut line);
            }
            wrapped(&rule.source, INDENT).into_iter().for_each(&mut line);
        }
    }
    line(String::new());
    line(format!("{LIMITS_ROUNDED} {NOT_COVERED}"));
    text
}

fn row(rule: &AppliedRule) -> String {
    // Short words fit the column; the note below explains rules that are not judged.
    let word = match result_of(rule) {
        RuleResult::NotMet => "NOT MET",
        RuleResult::DoesNotApply => "not for it",
        RuleResult::ExcessiveNotJudged => result(RuleResult::NotReached),
        other => result(other),
    };
    let value = value(rule, SizeUnit::Mm).unwrap_or_else(|| "= not known".into());
    let limit = limit(rule, SizeUnit::Mm).map_or(String::new(), |limit| format!(", {limit}"));
    let limit = limit.replace('≥', ">=").replace('≤', "<=");
    format!("  {word:<12}{}: {} {value}{limit}", rule.name, rule.quantity)
}

/// Sizes by their names, with the unit only once if all of them are known.
fn sizes(sizes: &[(&str, Option<f64>)]) -> String {
    let all_known = sizes.iter().all(|(_, size)| size.is_some());
    let words = |(name, size): &(&str, Option<f64>)| {
        let unit = if size.is_some() && !all_known { " mm" } else { "" };
        format!("{name} {}{unit}", number(*size))
    };
    let words: Vec<String> = sizes.iter().map(words).collect();
    format!("{}{}", words.join(", "), if all_known { " mm" } else { "" })
}

fn number(value: Option<f64>) -> String {
    value.map_or_else(|| "not known".into(), |value| significant(value).to_string())
}

fn rules_of_each(args: &RulesArgs, options: PairOptions) -> Result<(), RunError> {
    if args.json {
        return Err(RunError::refused("--json goes with one filter, without --each"));
    }
    let table = pairs_of(&args.base, &args.filters, options, args.each)?;
    let rows = &table.rows;
    if let Some(path) = &args.csv {
        let csv = columns(SizeUnit::Mm).csv(rows);
        // A continued call finds the table that it wrote.
        if std::fs::read(path).ok().as_ref() != Some(&csv) {
            write_new(path, &csv)?;
        }
    }
    let mut text = aligned(columns(SizeUnit::Mm), rows);
    text += &in_notes(&table.notes);
    for filter in &table.filters {
        text.push('\n');
        text += &of_filter(rows, filter, false);
        text += &to_walk(&args.base, options, rows, Path::new(&filter.name));
    }
    if let Some(path) = &args.csv {
        text += &format!("\n{}\n", shown(path));
    }
    to_stdout(&text);
    Ok(())
}

pub(super) fn in_notes(notes: &[String]) -> String {
    let lines = lines(notes.iter().map(|note| format!("note  {note}")));
    if lines.is_empty() { lines } else { format!("\n{lines}") }
}

pub(super) fn aligned<T>(columns: Columns<T>, rows: &[T]) -> String {
    let columns: Vec<_> = columns.of_page().collect();
    let mut table = vec![columns.iter().map(|column| column.heading.text.clone()).collect::<Vec<_>>()];
    let cells = |row: &T| columns.iter().map(|column| plain(&(column.cell)(row).line())).collect();
    table.extend(rows.iter().map(cells));
    let width = |at: usize| table.iter().map(|line| line[at].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns.len()).map(width).collect();
    let mut text = String::new();
    for line in &table {
        let cell = |(at, cell): (usize, &String)| match columns[at].kind {
            ColumnKind::Number => format!("{cell:>0$}", widths[at]),
            _ => format!("{cell:<0$}", widths[at]),
        };
        let line: Vec<String> = line.iter().enumerate().map(cell).collect();
        text.extend([line.join("  ").trim_end(), "\n"]);
    }
    text
}

pub(super) fn of_filter(rows: &[BatchRow], filter: &BatchFilter, inches: bool) -> String {
    let lines = filter_lines(filter, rows, SizeUnit::of(false, inches));
    lines.iter().map(|line| plain(line)).collect::<Vec<_>>().join("\n  ") + "\n"
}

fn to_walk(samples: &Path, options: PairOptions, rows: &[BatchRow], filter: &Path) -> String {
    let governing = governing(rows, &filter.display().to_string(), NAMED);
    let paths: Vec<String> = governing.iter().map(|row| to_copy(&row.path)).collect();
    let (which, walk) = match paths.len() {
        0 => return String::new(),
        1 => ("the one that governs", format!("{} {}", paths[0], to_copy(filter))),
        _ => {
            let samples = to_copy(samples);
            ("those that govern", format!("{samples} {} --each --governing", to_copy(filter)))
        }
    };
    let dispersive = if options.dispersive { " --dispersive" } else { "" };
    let as_given = if options.as_given { " --as-given" } else { "" };
    let joint = options.joint_mm.map_or_else(String::new, |mm| format!(" --joint-mm {mm}"));
    format!("  Nothing was walked. To walk {which}: voidwalk judge {walk}{dispersive}{joint}{as_given}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let numbers = [Some(1.1202), Some(0.012_34), Some(62.51), Some(340.0), None].map(number);
        assert_eq!(numbers, ["1.12", "0.0123", "62.5", "340", "not known"]);
        assert_eq!(sizes(&[("D85", Some(0.3)), ("D95", Some(1.5))]), "D85 0.300, D95 1.50 mm");
        assert_eq!(sizes(&[("D85", Some(0.3)), ("D95", None)]), "D85 0.300 mm, D95 not known");
        assert_eq!(sizes(&[("D15", None)]), "D15 not known");
    }
}
