//! The cases of a campaign's page: one row a case, its class first, with a link to its own page.

use std::collections::BTreeMap;
use std::path::Path;

use maud::{Markup, Render, html};

use super::cases;
use super::figures::shorten;
use super::shell::clean;
use super::table::Table;
use crate::outcome::ledger::{Campaign, LedgerLine};
use crate::outcome::record::Verdict;
use crate::outcome::undecided::UndecidedBy;
use crate::words::ledger::columns;
use crate::words::{sentence, undecided_by};
use voidwalk_practice::quantity::{SizeUnit, whole};
use voidwalk_practice::rules::RULES;

/// Cases listed in the page; all are in `cases.csv`.
const LISTED: usize = 2000;

/// Different warnings that are listed.
const WARNINGS: usize = 40;

/// The table of all cases, and below it an explanation of its counts. Cases whose folder holds a page are
/// linked.
pub(super) fn all(folder: &Path, about: &Campaign, ledger: &[LedgerLine]) -> Markup {
    html! {
        (table(folder, about, ledger))
        @if ledger.len() > LISTED { p.small { "The rest is in cases.csv." } }
        p.small {
            "Class: with a link to the page of the case; below it the replicates by class, where they \
             differ. Below a number its 95 % interval over the replicates."
        }
        (listed("Rules of practice that are not met", &tally(ledger, rules_of)))
        (listed("Notes", &tally(ledger, |line| {
            line.notes.iter().map(|note| sentence(note, SizeUnit::Mm)).collect::<Vec<_>>()
        })))
    }
}

/// Causes that leave verdicts undecided, each once with the number of cases.
pub(super) fn undecided(ledger: &[LedgerLine]) -> Markup {
    let open = || ledger.iter().filter(|line| line.verdict == Verdict::Undecided);
    let count = |by| open().filter(|line| line.undecided_by == Some(by)).count() as u64;
    let causes = UndecidedBy::ALL.map(|by| (by, count(by)));
    html! {
        @for (by, count) in causes.into_iter().filter(|(_, count)| *count > 0) {
            p {
                "Undecided, " (whole(count)) @if count == 1 { " case: " } @else { " cases: " }
                (undecided_by(by)) "."
            }
        }
    }
}

fn table(folder: &Path, about: &Campaign, ledger: &[LedgerLine]) -> Markup {
    Table::of(ledger.iter().take(LISTED), columns(&about.factors))
        .class("cases")
        .showing("verdict", |line| class(line, folder))
        .render()
}

/// The class, with a link to the case's own page, and below it the replicates if they differ.
fn class(line: &LedgerLine, folder: &Path) -> Markup {
    let mixed = line.replicate_verdicts.iter().filter(|count| **count > 0).count() > 1;
    html! {
        (cases::class(line.verdict, folder, &line.folder))
        @if mixed { br; span.small { (replicates_by_class(line)) } }
    }
}

/// "7 no, 3 some".
fn replicates_by_class(line: &LedgerLine) -> String {
    let parts = Verdict::ALL.iter().zip(line.replicate_verdicts).filter(|(_, count)| *count > 0);
    parts
        .map(|(class, count)| format!("{count} {}", class.words().replace(" erosion", "")))
        .collect::<Vec<_>>()
        .join(", ")
}

/// The names of the rules that a case breaks.
fn rules_of(line: &LedgerLine) -> Vec<String> {
    let name = |id: &String| RULES.iter().find(|rule| rule.id == id).map(|rule| rule.name());
    line.rules_not_met.iter().map(|id| name(id).unwrap_or_else(|| id.clone())).collect()
}

/// Texts of the cases, each once with the number of cases that have it, the commonest first.
fn tally(ledger: &[LedgerLine], texts: impl Fn(&LedgerLine) -> Vec<String>) -> Vec<(String, u64)> {
    let mut counts: BTreeMap<String, u64> = BTreeMap::new();
    for text in ledger.iter().flat_map(texts) {
        *counts.entry(text).or_default() += 1;
    }
    let mut counts: Vec<_> = counts.into_iter().collect();
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    counts
}

fn listed(heading: &str, counts: &[(String, u64)]) -> Markup {
    html! {
        @if !counts.is_empty() {
            h3 { (heading) }
            ul {
                @for (text, count) in counts.iter().take(WARNINGS) {
                    li { (clean(&shorten(text, 400))) " (" (whole(*count))
                        @if *count == 1 { " case)" } @else { " cases)" } }
                }
                @if counts.len() > WARNINGS {
                    li { (counts.len() - WARNINGS) " more, on the pages of the cases" }
                }
            }
        }
    }
}
