//! The rules of practice on two sheets as the page shows them.

use serde_json::{Value, json};

use crate::outcome::quantity::SizeUnit;
use crate::verdict::PairRules;
use crate::words::rule::{LIMITS_ROUNDED, limit_begins, limit_ends, result, value_and_limit, value_begins};
use crate::words::rule_note::{regrade_reason, rule_notes};
use crate::words::{practice_line, sentence};

/// Every rule with its words: the page shows value and limit as every sheet does, and works nothing out.
pub fn rules_of_pair(pair: PairRules) -> serde_json::Result<Value> {
    let (rules, decision) = (&pair.rules, pair.decision());
    // What a sheet lists once is no row of its own.
    let names: Vec<_> = rules
        .iter()
        .map(|rule| {
            decision
                .listed
                .iter()
                .find(|of| of.id == rule.id)
                .map(|of| [of.name.clone(), of.source.clone(), of.authorities().join(", ")])
        })
        .map(|of| json!(of))
        .collect();
    let shown: Vec<_> = rules.iter().map(|rule| value_and_limit(rule, SizeUnit::Mm)).collect();
    let results: Vec<_> = decision.results.iter().map(|found| result(*found)).collect();
    let begins: Vec<_> = rules.iter().map(limit_begins).collect();
    let ends: Vec<_> = rules.iter().map(limit_ends).collect();
    let values: Vec<_> = rules.iter().map(value_begins).collect();
    let words: Vec<_> =
        rules.iter().map(|rule| rule_notes(&[&rule.notes[..], &rule.needs].concat(), SizeUnit::Mm)).collect();
    let mut value = serde_json::to_value(&pair)?;
    value["listed"] = json!(names);
    value["value_begins"] = json!(values);
    value["shown"] = json!(shown);
    value["rule_words"] = json!(words);
    value["results"] = json!(results);
    value["limit_begins"] = json!(begins);
    value["limit_ends"] = json!(ends);
    value["notes"] = json!(pair.notes.iter().map(|note| sentence(note, SizeUnit::Mm)).collect::<Vec<_>>());
    value["practice"] = json!(practice_line(&decision, SizeUnit::Mm));
    value["why"] = json!(regrade_reason(pair.base.why));
    value["rounded"] = json!(LIMITS_ROUNDED);
    Ok(value)
}
