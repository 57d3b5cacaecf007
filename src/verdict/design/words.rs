//! What each case of a design's answer says.

use super::case::{Case, strictest};
use super::sizes::Sizes;
use crate::outcome::design::{Design, DesignRow};
use crate::outcome::digits::percent;
use crate::verdict::rule_words::cited_rule;

/// The limit of an answer, and what the walk says beside it; sentences without their full stops.
pub(super) struct CaseWords {
    pub limit: String,
    pub walk: Option<String>,
}

/// What a case says.
pub(super) fn words(case: &Case, design: &Design, sizes: &Sizes) -> CaseWords {
    let alone = |limit: String| CaseWords { limit, walk: None };
    let beside = |limit: String, walk: String| CaseWords { limit, walk: Some(walk) };
    match case {
        Case::Forbidden(rule) => alone(format!(
            "No base is known that both the walk and practice allow with this filter ({})",
            cited_rule(rule)
        )),
        Case::Open(limit, rule, held) => beside(
            format!(
                "The maximum D15F is not known: the limit of practice is at most {} ({}; {})",
                sizes.size(limit.ratio),
                cited_rule(limit.rule),
                if rule.needs.is_empty() { "it can only be less".into() } else { rule.needs.to_string() }
            ),
            of_walk_alone(sizes, *held),
        ),
        Case::OpenBase(rule, held) => beside(
            format!(
                "The finest D85B is not known: only an upper bound of the limit of practice is known ({}{})",
                cited_rule(rule),
                if rule.needs.is_empty() { String::new() } else { format!("; {}", rule.needs) }
            ),
            of_walk_alone(sizes, *held),
        ),
        Case::Unknown => alone("No ratio is known that nearly all networks hold".into()),
        Case::TailOpen(limit, tail) => beside(
            format!(
                "{}, by practice alone ({}{})",
                sizes.words(limit.ratio),
                cited_rule(limit.rule),
                sizes.other(design, limit.rule)
            ),
            format!(
                "The walk has no answer, as {} of the base is finer than its finest sieve",
                percent(*tail)
            ),
        ),
        Case::BelowSearch(limit, least) => alone(format!(
            "Practice allows {} ({}); the walk was searched from a {} of {} only, where networks erode: \
             search from a smaller D15F/D85B",
            sizes.words(limit.ratio),
            cited_rule(limit.rule),
            sizes.name(),
            sizes.size(*least)
        )),
        Case::NotHeld(limit) => alone(format!(
            "No ratio is known that nearly all networks hold; practice alone allows {} ({})",
            sizes.words(limit.ratio),
            cited_rule(limit.rule)
        )),
        Case::Practice(limit) => beside(
            format!(
                "{}, by practice ({}{}{})",
                sizes.words(limit.ratio),
                cited_rule(limit.rule),
                sizes.other(design, limit.rule),
                if limit.may_be_more {
                    format!(", whose limit for a finer base is not known: {}", limit.rule.needs)
                } else {
                    String::new()
                }
            ),
            NO_TIGHTER.into(),
        ),
        Case::Walk(row, held, limit) => alone(format!(
            "{}{}, by the walk; practice allows {} ({})",
            searched(row),
            sizes.words(*held),
            sizes.words(limit.ratio),
            cited_rule(limit.rule)
        )),
        Case::ModelAlone(row, held) => alone(format!(
            "{}{} in the model alone; {}",
            searched(row),
            sizes.words(*held),
            sizes.without_limit(strictest(design, sizes))
        )),
    }
}

/// What the walk is worth beside a limit of practice that sets the answer.
const NO_TIGHTER: &str = "The walk sets no tighter limit, and is no check of it";

/// What the walk holds where practice gives no answer.
fn of_walk_alone(sizes: &Sizes, held: Option<f64>) -> String {
    match held {
        Some(held) => format!("The walk alone holds {}", sizes.words(held)),
        None => "The walk has no answer either".into(),
    }
}

/// Whether a row holds all that was searched, before its size.
fn searched(row: &DesignRow) -> &'static str {
    match (&row.no_erosion, row.eroding_networks()) {
        (Some(_), _) => "",
        (None, 0) => "Holds as far as was searched: ",
        (None, _) => "Held by nearly all networks: ",
    }
}
