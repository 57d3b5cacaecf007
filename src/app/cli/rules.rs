//! `voidwalk rules`: the answer of filter practice on two soils, without a walk.

use super::args::RulesArgs;
use super::batch::each;
use super::print::{as_it_is, json, plain, shown, to_stdout, wrapped};
use crate::run::RunError;
use crate::scene::TableOptions;
use crate::words::left_out::NOT_COVERED;
use crate::words::rule::{LIMITS_ROUNDED, PARTS, limit, result, value};
use crate::words::rule_note::{regrade_reason, rule_notes};
use crate::words::{practice_line, sentence};
use std::fmt::Write;
use std::path::Path;
use voidwalk_core::store::format;
use voidwalk_practice::PairRules;
use voidwalk_practice::quantity::{SizeUnit, significant};
use voidwalk_practice::rule_result::{RuleResult, result_of};
use voidwalk_practice::{AppliedRule, RuleNote};
use voidwalk_sheets::{curves_in_file, notes_in_file};

/// Spaces before the text below a row.
const INDENT: usize = 14;

/// Applies every rule to two sieve tables, or to the curves of two envelopes.
pub fn rules(args: &RulesArgs) -> Result<(), RunError> {
    let changes = args.settings.assignments.clone();
    let options = TableOptions { as_given: args.as_given, changes, ..TableOptions::default() }.of_rules()?;
    let filter = match &args.filters[..] {
        [filter] if !args.each => filter,
        _ => return each(args, options),
    };
    if args.csv.is_some() {
        return Err(RunError::refused("--csv goes with --each, or with several filters"));
    }
    let bases = curves_in_file(&args.base, None).map_err(RunError::refused)?;
    let filters = curves_in_file(filter, None).map_err(RunError::refused)?;
    let pair = PairRules::guarded(&bases, &filters, options).map_err(|mistake| {
        let files = format!("base {}, filter {}", shown(&args.base), shown(filter));
        RunError::Refused(format!("{files}: {}", mistake.refusal()))
    })?;
    let assumed = |path| notes_in_file(path).map_err(RunError::refused);
    let notes = [("base", assumed(&args.base)?), ("filter", assumed(filter)?)];
    if args.json {
        as_it_is(&json(format::RULES, &pair)?);
    } else {
        to_stdout(&words(&pair, (&args.base, filter), &notes));
    }
    Ok(())
}

fn words(
    pair: &PairRules,
    (base_file, filter_file): (&Path, &Path),
    notes: &[(&str, Vec<String>)],
) -> String {
    let (filter, base) = (&pair.filter, &pair.base);
    let mut text = String::new();
    // Writing to a string cannot fail.
    let mut line = |s: String| {
        let _ = writeln!(text, "{}", plain(&s));
    };
    let of_curve = |curves: &[String], curve: &str| match curves.is_empty() {
        true => String::new(),
        false => format!(", curve {curve}"),
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
            // The rule's name gives its authority if no manual states it as well.
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

/// Result, name, value and limit of a rule.
fn row(rule: &AppliedRule) -> String {
    // Short words for a column: the note below explains rules that are not judged.
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

/// Sizes by their names, with the unit once if all of them are known.
fn sizes(sizes: &[(&str, Option<f64>)]) -> String {
    let all_known = sizes.iter().all(|(_, size)| size.is_some());
    let words = |(name, size): &(&str, Option<f64>)| {
        let unit = if size.is_some() && !all_known { " mm" } else { "" };
        format!("{name} {}{unit}", number(*size))
    };
    let words: Vec<String> = sizes.iter().map(words).collect();
    format!("{}{}", words.join(", "), if all_known { " mm" } else { "" })
}

/// Three digits that mean something.
fn number(value: Option<f64>) -> String {
    value.map_or_else(|| "not known".into(), |value| significant(value).to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        assert_eq!(
            [1.1202, 0.012_34, 62.51, 340.0].map(|v| number(Some(v))),
            ["1.12", "0.0123", "62.5", "340"]
        );
        assert_eq!(number(None), "not known");
        assert_eq!(sizes(&[("D85", Some(0.3)), ("D95", Some(1.5))]), "D85 0.300, D95 1.50 mm");
        assert_eq!(sizes(&[("D85", Some(0.3)), ("D95", None)]), "D85 0.300 mm, D95 not known");
        assert_eq!(sizes(&[("D15", None)]), "D15 not known");
    }
}
