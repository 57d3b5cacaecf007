//! Rules of practice in words: their table, from which every face shows some columns, their results, and
//! values with limits.

use crate::outcome::table::{Columns, Emphasis, Shown, TableCell};
use voidwalk_core::gradation::{FEW_FINES, RegradeCause, RegradeReason};
use voidwalk_practice::quantity::{
    SizeUnit, Unit, beside_limit, given, greatest_length, least_length, length, significant,
};
use voidwalk_practice::rule_result::{RuleResult, result_of};
use voidwalk_practice::rules::PERMEABILITY_LEAST;
use voidwalk_practice::{AppliedRule, RuleNote, RuleRole, RuleUnit, ValueBound};

/// Note beside lists of limits, for readers who compare them with unrounded numbers.
pub(crate) const LIMITS_ROUNDED: &str = "Limits are rounded to the safe side.";

/// Parts in which rules of practice are listed, with their headings.
pub(crate) const PARTS: [(RuleRole, &str); 5] = [
    (RuleRole::Retention, "The filter retains the base"),
    (RuleRole::Continuation, "Coarser filters: where erosion still ends"),
    (RuleRole::Drainage, "The filter drains the base"),
    (RuleRole::Placing, "The filter can be placed"),
    (RuleRole::Stability, "Internal stability of the filter"),
];

/// Columns of rules: those of a workbook, and under their headings those from which other faces choose,
/// with sizes in this unit.
pub(crate) fn columns<'a>(unit: SizeUnit) -> Columns<'a, AppliedRule> {
    Columns::default()
        .name("rule", "Rule", |rule: &AppliedRule| rule.name.clone())
        .text("authority", "Authority", |rule| {
            Some(rule.authorities().join(", ")).filter(|names| !names.is_empty())
        })
        .text("quantity", "Quantity", |rule| rule.quantity.name().to_owned())
        .column("value", |rule| rule.value)
        .page_number("Value", move |rule| value(rule, unit))
        .column("The value is", |rule| rule.value_bound.map(value_is))
        .column("limit", |rule| rule.limit)
        .page_number("Limit", move |rule| {
            let is_none = result_of(rule) == RuleResult::NotALimit;
            limit(rule, unit).or(is_none.then(|| result(RuleResult::NotALimit).to_owned()))
        })
        .column("Unit of value and limit", |rule| rule.unit.name())
        .column("The limit is", |rule| rule.limit.map(|_| limit_is(rule)))
        .column("Applies", |rule| rule.applies)
        .text("result", "Result", shown_result)
        // A boundary of continuing erosion that is not reached does not count as met.
        .column("Met", |rule| rule.met.filter(|met| rule.role != RuleRole::Continuation || !met))
        .column("Formula", |rule| rule.formula.clone())
        .column("Applies to", |rule| rule.applies_to.clone())
        .column("note", move |rule| notes(rule, unit))
        .headed("Note")
        .page_text("Note, source", move |rule| {
            let texts = [notes(rule, unit), rule.source.clone()];
            texts.into_iter().filter(|text| !text.is_empty()).collect::<Vec<_>>().join(" – ")
        })
        .column("Source", |rule| rule.source.clone())
        .column("Id", |rule| rule.id.clone())
}

fn value_is(bound: ValueBound) -> &'static str {
    match bound {
        ValueBound::AtMost => "an upper bound",
        ValueBound::AtLeast => "a lower bound",
    }
}

fn limit_is(rule: &AppliedRule) -> &'static str {
    match (rule.at_least, rule.limit_at_most) {
        _ if rule.role == RuleRole::Continuation => "a boundary: continuing erosion beyond it",
        (true, false) => "the least",
        (true, true) => "sufficient; the minimum is not known",
        (false, false) => "the most",
        (false, true) => "an upper bound",
    }
}

/// Notes of a rule beside its result, and its missing data.
fn notes(rule: &AppliedRule, unit: SizeUnit) -> String {
    rule_notes(&[&rule.notes[..], &rule.needs].concat(), unit)
}

/// Result in a table cell; for a comparison of the walk with tests, within the tests or not.
fn shown_result(rule: &AppliedRule) -> Shown {
    let rule_result = result_of(rule);
    match (rule.role, rule.met) {
        (RuleRole::Walk, Some(true)) => "within".shown(),
        (RuleRole::Walk, Some(false)) => "beyond".shown(),
        _ => {
            let is_decided = [RuleResult::Met, RuleResult::NotMet].contains(&rule_result);
            let emphasis = is_decided.then_some(Emphasis::Kept(rule_result == RuleResult::Met));
            result(rule_result).shown().emphasised(emphasis)
        }
    }
}

/// Value of a rule as `= 0.8`, or as `at most 0.8` if sieves give only a bound.
pub(crate) fn value(rule: &AppliedRule, unit: SizeUnit) -> Option<String> {
    let [value, _] = value_and_limit(rule, unit);
    value.map(|value| format!("{} {value}", value_begins(rule)))
}

/// Limit of a rule with the words around it.
pub(crate) fn limit(rule: &AppliedRule, unit: SizeUnit) -> Option<String> {
    let [_, limit] = value_and_limit(rule, unit);
    limit.map(|limit| format!("{} {limit}{}", limit_begins(rule), limit_ends(rule)))
}

pub(crate) fn result(result: RuleResult) -> &'static str {
    match result {
        RuleResult::Met => "met",
        RuleResult::NotMet => "not met",
        RuleResult::NotReached => "not reached",
        RuleResult::ExcessiveNotJudged => "not reached; excessive erosion not judged",
        RuleResult::NotALimit => "not a limit",
        RuleResult::NoLimit => "no limit",
        RuleResult::NoResult => "no result",
        RuleResult::DoesNotApply => "does not apply",
    }
}

/// Words before a limit: minimum, maximum, or boundary beyond which erosion continues.
pub(crate) fn limit_begins(rule: &AppliedRule) -> &'static str {
    match (rule.role, rule.at_least, rule.limit_at_most) {
        (RuleRole::Continuation, ..) => "continuing beyond",
        // D15B is finer than the finest sieve, and a sufficient value is known.
        (_, true, true) if rule.id == PERMEABILITY_LEAST => "≥ 3 D15B;",
        (_, true, true) => "≥ 5 D15B;",
        (_, true, false) => "≥",
        (_, false, _) => "≤",
    }
}

/// Words after a limit that is itself unknown.
pub(crate) fn limit_ends(rule: &AppliedRule) -> &'static str {
    match (rule.limit_at_most, rule.at_least) {
        (true, true) => " is enough",
        (true, false) => " or less",
        (false, _) => "",
    }
}

/// Words before a value that is only a bound.
pub(crate) fn value_begins(rule: &AppliedRule) -> &'static str {
    match rule.value_bound {
        None => "=",
        Some(ValueBound::AtMost) => "at most",
        Some(ValueBound::AtLeast) => "at least",
    }
}

/// Value and limit of a rule with their unit, if known, and in inches if these are shown: with enough
/// digits to tell them apart, so that a value beyond its limit never reads as within it.
pub(crate) fn value_and_limit(rule: &AppliedRule, unit: SizeUnit) -> [Option<String>; 2] {
    let unit = match rule.unit {
        RuleUnit::One => Unit::None,
        RuleUnit::Percent => Unit::Percent,
        RuleUnit::D0f => Unit::Size(SizeUnit::D0f),
        RuleUnit::Mm => Unit::Size(unit),
    };
    beside_limit([rule.value, rule.limit], rule.at_least, unit)
}

/// Notes of rules beside their results, as part of a sentence.
pub(crate) fn rule_notes(notes: &[RuleNote], unit: SizeUnit) -> String {
    notes.iter().map(|note| rule_note(*note, unit)).collect::<Vec<_>>().join("; ")
}

/// Note of a rule as part of a sentence.
pub(super) fn rule_note(note: RuleNote, unit: SizeUnit) -> String {
    let between = |what: &str, from: f64, to: f64| {
        let [low, high] = [from, to].map(|sieve| length(sieve, unit).in_digits(6));
        format!("{what} between {} and {high}: test the sieves between", low.in_cell())
    };
    let places = |number: f64, decimals: u8| significant(number).decimals(decimals);
    match note {
        RuleNote::D15FBetween(from, to) => between("D15F lies", from, to),
        RuleNote::D15BBetween(from, to) => between("D15B lies", from, to),
        RuleNote::D85BBetween(from, to) => between("D85B lies", from, to),
        RuleNote::D95BBetween(from, to) => between("D95B lies", from, to),
        RuleNote::FilterBetween(from, to) => between("sizes of the filter are not known", from, to),
        RuleNote::BaseBetween(from, to) => between("sizes of the base are not known", from, to),
        RuleNote::FlatBase(limit) => format!(
            "the base may be gap-graded: the stricter limit; the other is {}",
            greatest_length(limit, unit)
        ),
        RuleNote::Category(category) => format!("base category {category}"),
        RuleNote::RegradedOn(size) => format!("base regraded on {}", length(size, unit)),
        RuleNote::ByFines(times, until, fines) => {
            let [width, until] = [until - FEW_FINES, until].map(given);
            let fines = given((100.0 * fines).round() / 100.0);
            let times = if times == 1.0 { String::new() } else { format!("{} ", given(times)) };
            format!("{times}[({until} - {fines})/{width} (4 D85B - 0.7) + 0.7] mm for {fines} % fines")
        }
        RuleNote::FloorGoverns(times, size) => {
            format!("its floor: {} D85B would be {}", given(times), greatest_length(size, unit))
        }
        RuleNote::LeastGoverns(times, size) => {
            format!("its floor: {} D15B is below {}", given(times), least_length(size, unit))
        }
        RuleNote::FinestSieveOfFilter(size) => {
            format!("the finest sieve is {}: at most what passes it", length(size, unit))
        }
        RuleNote::AtPercentFiner(percent) => format!("at {} % finer", places(percent, 0)),
        RuleNote::BandFrom(percent) => {
            format!("compared from {} % finer, as there is no finer sieve", places(percent, 0))
        }
        RuleNote::Joint(joint, d95b, ratio) => format!(
            "joint of {} mm, D95B {} mm: JOS/D95B = {}; steady flow",
            given(joint),
            places(d95b, 3),
            places(ratio, 2)
        ),
        RuleNote::FarFinerThanTests(times) => {
            let times = significant(times).in_digits(2);
            format!("{times} times finer: the openings walked are not those of such tests")
        }
        RuleNote::KezdiAt(split, coarse, fine) => format!(
            "split at {} % finer: D'15 of the coarser part {} mm, d'85 of the finer part {} mm",
            places(split, 1),
            significant(coarse),
            significant(fine)
        ),
        RuleNote::KezdiSplits(from, to) => {
            format!("judged over splits at {} to {} % finer", places(from, 1), places(to, 1))
        }
        RuleNote::KezdiHidden(share) => {
            format!("not known for the {} % finer than the finest sieve", places(share, 0))
        }
        RuleNote::ShapeAt(at, most) => {
            format!("at F = {} %, judged up to F = {} %", places(at, 1), given(most))
        }
        RuleNote::ShapeAbovePan(at, from, most) => format!(
            "at F = {} %, judged from F = {} % (finest sieve) up to F = {} %",
            places(at, 1),
            places(from, 1),
            given(most)
        ),
        RuleNote::BurenkovaRange(whole, low, high) => {
            let [whole, low, high] = [whole, low, high].map(|value| places(value, 2));
            format!("h'' = D90/D15 = {whole}; the range is {low} to {high}")
        }
        RuleNote::LimitsByFines(percent) => {
            format!("{} % of the base is fines: limits by fines apply instead", places(percent, 0))
        }
        RuleNote::BurenkovaThirdZone(high) => format!(
            "h' is above {}: Burenkova's third zone, where Wan and Fell have no tests and expect no loss of \
             fines",
            places(high, 2)
        ),
        RuleNote::Dispersive => "dispersive".into(),
        RuleNote::BeforeRegrading => "base before regrading".into(),
        RuleNote::TakenAsSand => "sizes are multiples of D0F: taken as a sand without fines".into(),
        RuleNote::ResultOfModel => "a result of the model, for the base as it is walked".into(),
        RuleNote::BeyondAnyLimit => "beyond any possible limit".into(),
        RuleNote::NoClearBoundary => {
            "not a limit: with 15 to 85 % fines and D95B above 2 mm tests identified no boundary of \
             continuing erosion (Fell et al., section 9.3.2); the manual of the Corps has one in a figure \
             alone"
                .into()
        }
        RuleNote::BeyondUnclearBoundary => {
            "beyond 9 D95B, though with 15 to 85 % fines and D95B above 2 mm tests identified no boundary \
             of continuing erosion (Fell et al., section 9.3.2)"
                .into()
        }
        RuleNote::ExcessiveNotJudged => "continuing erosion not reached; excessive erosion not judged".into(),
        RuleNote::D15FAtMost => "D15F is finer than the finest sieve: at most this".into(),
        RuleNote::LimitAtMost => "D15B is finer than the finest sieve: no more than this is needed".into(),
        RuleNote::LimitAtLeast => {
            "D15B is finer than the finest sieve; the limit is never less than this".into()
        }
        RuleNote::CuAtLeast => "D10 is finer than the finest sieve: Cu is at least this".into(),
        RuleNote::LessThanSource => "less than 0.01 %".into(),
        RuleNote::ChecksWalk => "checks the walk against their tests, not the filter".into(),
        RuleNote::WanFellSand => "as sand and gravel with up to 10 % of fines that are not plastic".into(),
        RuleNote::WanFellSilt => {
            "as silt, sand and gravel with up to 10 % of clay and a plasticity index of up to 12".into()
        }
        RuleNote::WanFellContours => {
            "the source states contours from 5 to 95 % and no limit, and is unsure of soils with less than \
             15 % of finer fraction"
                .into()
        }
        RuleNote::BurenkovaSoils => "for grains of up to 100 mm and a Cu of up to 200".into(),
        RuleNote::UniformFilter => {
            "the filter is neither broadly graded (Cu of 6 and more) nor gap-graded".into()
        }
        _ => missing(note).map_or_else(String::new, |need| format!("needs {need}")),
    }
}

/// Data missing for a result, without an introductory word; `None` if nothing is missing.
pub(crate) fn missing(note: RuleNote) -> Option<&'static str> {
    Some(match note {
        RuleNote::NeedsFinesOfBase => "finer sieves of the base, to tell whether it has 15 % fines or more",
        RuleNote::NeedsD85B => "the base's D85",
        RuleNote::NeedsD95B => "the base's D95",
        RuleNote::NeedsD15B => "the base's D15",
        RuleNote::NeedsD15F | RuleNote::NeedsD15FSieved => "the filter's D15",
        RuleNote::NeedsD10F => "the filter's D10",
        RuleNote::NeedsFinesOfFilter => "finer sieves of the filter, down to 0.075 mm",
        RuleNote::NeedsSievesOfFilter => "finer sieves of the filter",
        RuleNote::NeedsFinestPartOfFilter => "finer sieves of the filter, as too much passes the finest",
        RuleNote::NeedsCurveOfFilter => "the filter's sieve curve",
        RuleNote::NeedsCurveOfFilterInMm => "the filter's sieve curve in mm",
        RuleNote::NeedsTestOfDispersive => {
            "a test of this dispersive soil, for whose fines no source gives a limit"
        }
        RuleNote::NeedsErosion => "a walk with erosion in the first run",
        _ => return None,
    })
}

/// Reason why practice regrades a base or not, as part of a sentence.
pub(crate) fn regrade_reason(reason: RegradeReason) -> String {
    let gap = |from| {
        let from = significant(from).decimals(3);
        format!("gap-graded: next to nothing between {from} mm and four times that")
    };
    let cause = match reason.cause {
        RegradeCause::Gap(from) => gap(from),
        RegradeCause::GapAmongGravel(from) => gap(from) + "; what is finer is regraded on No. 4 (4.75 mm)",
        RegradeCause::GravelAndFines => "grains coarser than No. 4 (4.75 mm) and 15 % fines or more".into(),
        RegradeCause::BroadGravel => "broadly graded, with grains coarser than No. 4 (4.75 mm)".into(),
        RegradeCause::GravelOfUnknownCu => {
            "grains coarser than No. 4 (4.75 mm), and Cu is not known: taken as broadly graded".into()
        }
        RegradeCause::NarrowGravel => "less than 15 % fines and not broadly graded".into(),
        RegradeCause::NoGravel => "nothing is coarser than No. 4 (4.75 mm)".into(),
        RegradeCause::NoUnit => "sizes are multiples of D0F".into(),
    };
    let left =
        if reason.nothing_passes { "; but no known size of it passes that sieve: left as it is" } else { "" };
    cause + left
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_note_reads_well_with_any_number() {
        for number in [0.0, 1e-300, -1.0, 12.345, 1e300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for note in RuleNote::all_with(number) {
                let words = rule_note(note, SizeUnit::Mm);
                assert!(!words.contains("NaN") && !words.contains("inf "), "{note:?}: {words}");
                assert!(!words.is_empty() && !words.contains("  ") && words.len() < 200, "{note:?}: {words}");
                // Others follow after a semicolon.
                assert!(!words.ends_with(['.', ';', ':', ' ']), "{note:?}: {words}");
                assert_eq!(words.starts_with("needs "), format!("{note:?}").starts_with("Needs"), "{words}");
            }
        }
    }

    #[test]
    fn every_reason_to_regrade_reads_well_with_any_number() {
        for size in [0.0, 1e-300, -1.0, 12.345, 1e300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for (cause, begin) in [
                (RegradeCause::Gap(size), "gap-graded: next to nothing between "),
                (RegradeCause::GapAmongGravel(size), "gap-graded: next to nothing between "),
                (RegradeCause::GravelAndFines, "grains coarser than No. 4 (4.75 mm) and 15 %"),
                (RegradeCause::BroadGravel, "broadly graded, with grains"),
                (RegradeCause::GravelOfUnknownCu, "grains coarser than No. 4 (4.75 mm), and Cu"),
                (RegradeCause::NarrowGravel, "less than 15 % fines"),
                (RegradeCause::NoGravel, "nothing is coarser than No. 4"),
                (RegradeCause::NoUnit, "sizes are multiples of D0F"),
            ] {
                for nothing_passes in [false, true] {
                    let words = regrade_reason(RegradeReason { cause, nothing_passes });
                    assert!(words.starts_with(begin) && words.len() < 200, "{words}");
                    assert_eq!(words.ends_with("sieve: left as it is"), nothing_passes, "{words}");
                    assert!(!words.contains("NaN") && !words.contains("inf ") && !words.ends_with('.'));
                }
            }
        }
    }

    #[test]
    fn notes_are_written_as_data_and_read_back() {
        for note in RuleNote::all_with(12.345) {
            let text = serde_json::to_string(&note).unwrap();
            assert_eq!(serde_json::from_str::<RuleNote>(&text).unwrap(), note, "{text}");
        }
        let text = serde_json::to_string(&RuleNote::RegradedOn(4.75)).unwrap();
        assert_eq!(text, "{\"id\":\"regraded_on\",\"numbers\":4.75}");
    }
}
