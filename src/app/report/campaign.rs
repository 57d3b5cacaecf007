//! Page of a campaign, made from `campaign.json` and `ledger.jsonl` alone, with one row per case and a link
//! to its page.

use super::cases::{self, AtRatio};
use super::figures::{Across, Axis, BLACK, Dash, Figure, Mark, shorten};
use super::files::{ReportError, json, json_of, lines, text};
use super::section::{Sections, Written};
use super::shell::{Drawn, citation, clean, leaves_out};
use super::table::Table;
use crate::outcome::ledger::{Campaign, LedgerLine, leaves_out as of_ledger};
use crate::outcome::record::{Statistic, Verdict};
use crate::outcome::statistic::{interval, interval_in_percent};
use crate::outcome::table::Columns;
use crate::outcome::verdict::{THRESHOLD, UndecidedBy};
use crate::words::ledger::columns;
use crate::words::{sentence, undecided_by};
use maud::{Markup, html};
use std::collections::BTreeMap;
use std::path::Path;
use voidwalk_practice::quantity::{SizeUnit, duration, whole};
use voidwalk_practice::rules::RULES;

/// Maximum number of cases drawn one by one; all are in the table.
const DRAWN: usize = 120;

/// Writes `report.html` and `figures/*.svg` into the folder of a campaign. A missing or malformed file is an
/// error, and nothing is written then.
pub fn write_campaign(folder: &Path) -> Result<Written, ReportError> {
    let about: Campaign = json(&folder.join(ABOUT))?;
    let path = folder.join(LEDGER);
    let ledger = lines(&path, &text(&path)?)?;
    page(folder, &about, &ledger).write(folder, "report.html", &citation())
}

/// Page of a campaign whose `campaign.json` and `ledger.jsonl` hold these texts; writes nothing. A malformed
/// text is an error.
pub fn campaign_page(about: &str, ledger: &str) -> Result<String, ReportError> {
    let about: Campaign = json_of(Path::new(ABOUT), about)?;
    let ledger = lines(Path::new(LEDGER), ledger)?;
    // Without a folder, no case has a page of its own.
    Ok(page(Path::new(""), &about, &ledger).text(&citation()))
}

const ABOUT: &str = "campaign.json";
const LEDGER: &str = "ledger.jsonl";

fn eroded(line: &LedgerLine, run: usize) -> Option<&Statistic> {
    line.runs.get(run).map(|run| &run.eroded_mass_fraction)
}

/// Largest eroded particle of the first run, over D15F.
fn largest_eroded(line: &LedgerLine) -> Option<Statistic> {
    line.runs.first().and_then(|run| run.largest_eroded_over_d15f)
}

/// Quantity of each case against the ratio of the filter rules.
fn against_ratio(
    words: [&str; 2],
    y: Axis,
    rules: Vec<Mark>,
    ledger: &[LedgerLine],
    quantity: impl Fn(&LedgerLine) -> Option<(f64, Option<(f64, f64)>)>,
) -> Figure {
    let ratios = ledger.iter().map(|line| line.ratios.d15f_over_d85b);
    let (low, high) = ratios.fold((f64::MAX, 0.0_f64), |(low, high), r| (low.min(r), high.max(r)));
    let margin = 0.05 * (high - low).max(0.2 * high);
    let x = Axis::linear("D15F / D85B (–)", low - margin, high + margin);
    let symbol = |line: &LedgerLine| {
        let (value, interval) = quantity(line)?;
        Some(AtRatio {
            ratio: line.ratios.d15f_over_d85b,
            class: line.verdict,
            value,
            interval,
            is_against: false,
            is_bound: false,
        })
    };
    let symbols: Vec<AtRatio> = ledger.iter().filter_map(symbol).collect();
    cases::against_ratio(words, (x, y), rules, &symbols)
}

fn by_ratio(ledger: &[LedgerLine]) -> Drawn {
    let y = Axis::percent("Base eroded in the first run, by mass (%)");
    let what =
        "Percent of the base mass eroded in the first run against D15F/D85B, one symbol per case, by class";
    let mut rules = vec![Mark::rule(Across::Y, 100.0 * THRESHOLD, BLACK).dash(Dash::Dashed).label("7.5 %")];
    let ratios = || ledger.iter().map(|line| line.ratios.d15f_over_d85b);
    if ratios().any(|r| r < 4.0) && ratios().any(|r| r > 4.0) {
        rules.push(Mark::rule(Across::X, 4.0, BLACK).dash(Dash::Dotted).label("D15F/D85B = 4 (Terzaghi)"));
    }
    let figure = against_ratio(["Erosion against the filter ratio", what], y, rules, ledger, |line| {
        eroded(line, 0).map(|first| (100.0 * first.mean, interval_in_percent(first)))
    });
    let caption = "Base eroded in the first run against D15F/D85B: one symbol per case, with the 95 % \
                   interval over its replicates. D85B is that of the base as it is walked: the table of \
                   cases says where it is regraded. The class also takes the second run.";
    Drawn::new("by-ratio", figure, caption)
}

fn both_runs(ledger: &[LedgerLine]) -> Drawn {
    let shown = ledger.iter().take(DRAWN);
    let shown: Vec<_> = shown.map(|line| (line.case.as_str(), [eroded(line, 0), eroded(line, 1)])).collect();
    let figure = cases::both_runs(&shown, THRESHOLD, 100.0 + 19.0 * shown.len() as f64);
    let rest = ledger.len() - shown.len();
    let more = if rest > 0 { format!(" {rest} more cases are in the table.") } else { String::new() };
    let caption = format!("Base eroded in the first and in the second run, with 95 % intervals.{more}");
    Drawn::new("both-runs", figure, caption)
}

/// Largest eroded particle, over D15F.
fn largest(ledger: &[LedgerLine]) -> Drawn {
    let quantity = |line: &LedgerLine| largest_eroded(line).map(|s| (s.mean, interval(&s)));
    let highest =
        ledger.iter().filter_map(largest_eroded).map(|s| s.high.unwrap_or(s.mean)).fold(0.2, f64::max);
    let y = Axis::linear("Largest eroded particle / D15F, first run (–)", 0.0, 1.05 * highest);
    let what = "Largest eroded particle over D15F against D15F/D85B, one symbol per case";
    let figure = against_ratio(["Largest eroded particle", what], y, Vec::new(), ledger, quantity);
    let caption = "Largest particle that left the filter in the first run, over D15F.";
    Drawn::new("largest-eroded", figure.sizes((720.0, 340.0), (358.0, 320.0)), caption)
}

fn page(folder: &Path, about: &Campaign, ledger: &[LedgerLine]) -> Sections {
    let title = if about.title.is_empty() { about.plan.as_str() } else { about.title.as_str() };
    let count = |class| ledger.iter().filter(|line| line.verdict == class).count() as u64;
    let classes = Verdict::ALL.map(|class| (class, count(class)));
    let columns = Columns::default().name("class", "Class", |(class, _): &(Verdict, u64)| *class);
    let columns = columns.number("cases", "cases", |(_, count)| *count);
    let first = html! { div.first {
        section {
            p.lead { (whole(ledger.len() as u64)) " of " (whole(about.cases)) " cases are done." }
            (Table::new(classes.iter().filter(|(_, count)| *count > 0), columns))
            (undecided(ledger))
        }
        (leaves_out(&of_ledger(ledger), &html! {}))
    } };
    let missing = html! { @if !about.missing.is_empty() {
        p { (whole(about.missing.len() as u64)) " cases are missing: continue with the same command." }
        ul { @for name in about.missing.iter().take(50) { li { (clean(name)) } } }
    } };
    let names = html! { b { bdi { (clean(title)) } } };
    let drawn: &[fn(&[LedgerLine]) -> Drawn] =
        if ledger.is_empty() { &[] } else { &[by_ratio, both_runs, largest] };
    Sections::new(clean(title), "Which of these filters hold?", &names)
        .words(&first)
        .contents()
        .section("Missing cases", &missing)
        .section("Cases", &all(folder, about, ledger))
        .words(&html! { h2 { "Figures" } })
        .figures(drawn.iter().map(|draw| draw(ledger)))
        .section("How this was made", &provenance(about, ledger))
}

fn provenance(about: &Campaign, ledger: &[LedgerLine]) -> Markup {
    let seconds: f64 = ledger.iter().map(|line| line.made.seconds).sum();
    let mut versions: Vec<&str> = ledger.iter().map(|line| line.version.as_str()).collect();
    versions.sort_unstable();
    versions.dedup();
    html! {
        p {
            "Plan " bdi { (clean(&about.plan)) } ", voidwalk " (versions.join(", ")) ", " (duration(seconds))
            " from start to end of each case, beside other cases. Each case has a folder of its own with its \
             report; " code { "ledger.jsonl" }
            " holds one line per case, " code { "cases.csv" } " the table above."
        }
    }
}

/// Maximum number of cases listed in the page; all are in `cases.csv`.
const LISTED: usize = 2000;

/// Maximum number of different warnings listed.
const WARNINGS: usize = 40;

/// Table of all cases, with an explanation of its counts below. Cases with a page in their folder are linked.
fn all(folder: &Path, about: &Campaign, ledger: &[LedgerLine]) -> Markup {
    let table = Table::new(ledger.iter().take(LISTED), columns(&about.factors)).class("cases");
    html! {
        (table.showing("verdict", |line| class(line, folder)))
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

/// Causes that leave verdicts undecided, each with the number of cases.
fn undecided(ledger: &[LedgerLine]) -> Markup {
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

/// Class with a link to the case's own page and, below it, the classes of the replicates if they differ.
fn class(line: &LedgerLine, folder: &Path) -> Markup {
    let mixed = line.replicate_verdicts.iter().filter(|count| **count > 0).count() > 1;
    html! {
        (cases::class(line.verdict, folder, &line.folder))
        @if mixed { br; span.small { (replicates_by_class(line)) } }
    }
}

/// Classes of the replicates, counted, as in "7 no, 3 some".
fn replicates_by_class(line: &LedgerLine) -> String {
    let parts = Verdict::ALL.iter().zip(line.replicate_verdicts).filter(|(_, count)| *count > 0);
    parts
        .map(|(class, count)| format!("{count} {}", class.words().replace(" erosion", "")))
        .collect::<Vec<_>>()
        .join(", ")
}

fn rules_of(line: &LedgerLine) -> Vec<String> {
    let name = |id: &String| RULES.iter().find(|rule| rule.id == id).map(|rule| rule.name());
    line.rules_not_met.iter().map(|id| name(id).unwrap_or_else(|| id.clone())).collect()
}

/// Texts of the cases, each with the number of its cases, the most common first.
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
