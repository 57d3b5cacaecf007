//! The rules of practice on two sheets as the page shows them.

use serde_json::{Value, json};

use super::batches::table;
use crate::words::rule::{LIMITS_ROUNDED, PARTS, columns};
use crate::words::rule_note::regrade_reason;
use crate::words::{practice_line, sentence};
use voidwalk_practice::PairRules;
use voidwalk_practice::quantity::SizeUnit;
use voidwalk_practice::rule_result::{RuleResult, result_of};

/// The columns that the page shows.
const SHOWN: [&str; 7] = ["result", "rule", "authority", "quantity", "value", "limit", "note"];

/// The rules part by part with their results for the pair: the page computes nothing.
pub fn rules_of_pair(pair: &PairRules) -> Value {
    let decision = pair.decision();
    let listed = decision.listed();
    let part = |(role, title)| {
        let rules = listed.iter().map(AsRef::as_ref).filter(|rule| rule.role == role);
        let mut part = table(columns(SizeUnit::Mm).only(&SHOWN), rules, |rule| match result_of(rule) {
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
