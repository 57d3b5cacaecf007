//! The page of a comparison, from `compare.json` alone.

use std::path::Path;

use maud::{Markup, Render, html};

use super::cases;
use super::cover::program;
use super::error::ReportError;
use super::figures::{Across, Axis, BLACK, BLUE, Dash, Figure, PURPLE, Point, Rule, Shape, shorten};
use super::files::json;
use super::first_page::colour;
use super::names::{is_named, titled};
use super::run_figures::run_name;
use super::section::Sections;
use super::shell::{Drawn, citation, clean, unbroken};
use super::table::Table;
use super::written::Written;
use crate::outcome::comparison::{ComparedCase, ComparedPair, Comparison};
use crate::outcome::quantity::{SizeUnit, percent};
use crate::outcome::record::Verdict;
use crate::words::capital;
use crate::words::comparison::{case_columns, difference, not_in_intervals};
use crate::words::left_out::left_out_in_brief;
use crate::words::{FOREMOST, lines_of, sentence};

const RECORD: &str = "compare.json";

/// Writes `compare.html` and `figures/*.svg` into the folder of a comparison.
///
/// # Errors
/// A file that is missing or malformed; nothing is written then.
pub fn write_comparison(folder: &Path) -> Result<Written, ReportError> {
    let path = folder.join(RECORD);
    let comparison: Comparison = json(&path)?;
    if comparison.cases.is_empty() {
        let (field, value, allowed) = ("cases".into(), "empty".into(), "two or more".into());
        return Err(ReportError::Value { path, field, value, allowed });
    }
    page(folder, &comparison).write(folder, "compare.html", &citation())
}

fn name(name: &str) -> String {
    clean(&shorten(name, 60))
}

/// First and second run of each case.
fn both_runs(comparison: &Comparison) -> Drawn {
    let cases = comparison.cases.iter();
    let cases: Vec<_> =
        cases.map(|case| (case.name.as_str(), [case.runs.first(), case.runs.get(1)])).collect();
    let caption = "Base eroded in the first and in the second run of each case, with 95 % intervals over its \
                   replicates.";
    let figure = cases::both_runs(&cases, comparison.threshold, height(cases.len()));
    Drawn::new("compared-runs", figure, caption)
}

/// Height of a figure of so many rows.
fn height(rows: usize) -> f64 {
    110.0 + 26.0 * rows as f64
}

/// Every difference with its interval; none where no two cases share a run.
fn differences(comparison: &Comparison) -> Option<Drawn> {
    let pairs = &comparison.pairs;
    let ends = |pair: &ComparedPair| {
        let of = &pair.difference;
        [of.mean, of.low.unwrap_or(of.mean), of.high.unwrap_or(of.mean)].map(|share| 100.0 * share)
    };
    let all = || pairs.iter().flat_map(ends);
    let (low, high) = (all().fold(0.0, f64::min), all().fold(0.0, f64::max));
    let margin = 0.06 * (high - low).max(0.1);
    let label = |pair: &ComparedPair| {
        let [one, other] = [&pair.first, &pair.second].map(|name| shorten(name, 15));
        format!("{one} − {other}, {}", if pair.run == 1 { "1st" } else { "2nd" })
    };
    if pairs.is_empty() {
        return None;
    }
    let (y, height) = (Axis::rows(pairs.iter().map(label)), height(pairs.len()));
    let x = Axis::linear("Difference of the mass eroded (percentage points)", low - margin, high + margin);
    let what = "Difference of the percent of base mass eroded between every two cases, with 95 % intervals";
    let mut figure =
        Figure::new("Differences", what, "", x, y).sizes((720.0, height), (358.0, height)).names_above();
    figure.add(Rule::new(Across::X, 0.0, BLACK).dash(Dash::Dashed).label("no difference"));
    for (run, colour, shape) in [(1, BLUE, Shape::Circle), (2, PURPLE, Shape::Square)] {
        let of_run = (1..).zip(pairs).filter(|(_, pair): &(u32, _)| pair.run == run);
        let points = of_run.map(|(row, pair)| {
            let [mean, low, high] = ends(pair);
            let interval = pair.difference.low.map(|_| (low, high));
            Point::new(mean, f64::from(row), colour, shape).x_interval(interval)
        });
        figure.add_points(run_name(run), points);
    }
    let caption = "Mass eroded of the one case less that of the other, replicate by replicate on the same \
                   random numbers, with the 95 % interval of each difference by itself.";
    Some(Drawn::new("compared-differences", figure, caption))
}

fn page(folder: &Path, comparison: &Comparison) -> Sections {
    let (question, common) = match comparison.of.as_str() {
        "filters" => ("Which of these filters hold this base?", "base"),
        "bases" => ("Which of these bases does this filter hold?", "filter"),
        _ => ("Which of these filters hold?", ""),
    };
    let names = match !common.is_empty() && is_named(common, &comparison.common) {
        true => titled(&capital(common), &comparison.common),
        false => html! {},
    };
    let first = html! { section.sheet {
            (answers(comparison))
            p { (lead(comparison)) }
            @if comparison.cases.iter().any(|case| case.verdict == Verdict::Undecided) {
                p { "Undecided is not a verdict. The page of the case says what would decide it." }
            }
            p.small {
                @if comparison.model_leaves_out.is_empty() {
                    "What the model leaves out stands on the page of each case."
                } @else { (clean(&left_out_in_brief(&comparison.model_leaves_out))) }
                " The verdicts of the walk are the model’s. They do not replace a filter test or a \
                 designer’s judgement."
            }
    } };
    let table = html! {
        (cases(folder, comparison))
        p.small {
            "Class: with a link to the page of the case. Below a number its 95 % interval over the \
             replicates; the threshold between the classes is " (percent(comparison.threshold).in_digits(3))
            "."
        }
    };
    let made = html! { p {
        "voidwalk " (clean(&comparison.version)) ", seed " (comparison.seed) " for every case. Each case \
         has a folder of its own with its report; " code { "compare.json" } " holds this page’s numbers, "
        code { "compare.csv" } " and " code { "compare_pairs.csv" } " its tables."
    } };
    Sections::new(format!("Comparison of {}", clean(&comparison.of)), question, &names)
        .model()
        .cover(
            &comparison.cover,
            &program(&comparison.version, comparison.commit.as_deref()),
            Some(comparison.seed),
        )
        .words(&first)
        .contents()
        .section("Cases", &table)
        .section("Differences", &pairs(comparison))
        .words(&html! { h2 { "Figures" } })
        .figures([both_runs(comparison)].into_iter().chain(differences(comparison)))
        .words(&reasons(comparison))
        .section("How this was made", &made)
}

/// How many classes of the model there are of each kind.
fn lead(comparison: &Comparison) -> String {
    let count = |class| comparison.cases.iter().filter(|case| case.verdict == class).count();
    let classes: Vec<String> = Verdict::ALL
        .into_iter()
        .filter(|class| count(*class) > 0)
        .map(|class| format!("{} {}", count(class), class.words()))
        .collect();
    format!("In the model: {}.", classes.join(", "))
}

/// The lines that every face begins with, of each case.
fn answers(comparison: &Comparison) -> Markup {
    let lines = |case: &ComparedCase| {
        let unit = SizeUnit::of(case.scale_free, comparison.inches);
        lines_of(case.headline, case.practice.as_ref(), &case.model, unit)
    };
    html! { @for case in &comparison.cases {
        section.verdict.(colour(case.headline)) {
            p.practice { b { bdi { (name(&case.name)) } } }
            ul {
                @for (name, words) in lines(case) { li { b { (name) } ": " (unbroken(&words)) "." } }
            }
        }
    } }
}

fn cases(folder: &Path, comparison: &Comparison) -> Markup {
    Table::of(&comparison.cases)
        .class("cases")
        .columns(case_columns(SizeUnit::of(false, comparison.inches)), |case| case)
        .named_by("case", |case| html! { bdi { (name(&case.name)) } })
        .showing("verdict", |case| cases::class(case.verdict, folder, &case.folder))
        .render()
}

fn pairs(comparison: &Comparison) -> Markup {
    let uncertain = comparison.pairs.iter().any(|pair| pair.differ.is_none());
    html! {
        @if comparison.pairs.is_empty() { p { "No two cases share a replicate." } }
        ul { @for pair in &comparison.pairs { li { (clean(&capital(&difference(pair)))) "." } } }
        p.small {
            "Mass eroded as a part of the base’s, replicate by replicate: replicates of the same number \
             share their random numbers, so scatter common to both cases drops out of the \
             difference (common random numbers; paired t interval). Each interval holds by itself at \
             95 %; two cases are said to differ only if the interval that holds for all "
            (comparison.pairs.len()) " differences at once excludes 0."
            @if uncertain { " One replicate does not show the scatter." }
        }
        @if let Some(what) = not_in_intervals(comparison) {
            p {
                span.amber { "Not in these intervals" } ": " (what)
                ". Its range stands in the table, as “curve”."
            }
        }
    }
}

/// Which rules are not kept, and what else to know of each case.
fn reasons(comparison: &Comparison) -> Markup {
    let unit = SizeUnit::of(false, comparison.inches);
    html! { @for case in &comparison.cases {
        section.warnings {
            h2 { bdi { (name(&case.name)) } ": what else to know" }
            @let (foremost, rest) = case.notes.split_at(case.notes.len().min(FOREMOST));
            ul { @for note in foremost { li { (clean(&sentence(note, unit))) } } }
            @if !case.rules_not_kept.is_empty() {
                p { "Rules of practice that are not kept: " (clean(&case.rules_not_kept.join("; "))) "." }
            }
            @if !rest.is_empty() {
                details {
                    summary { "and " (rest.len()) " more" }
                    ul { @for note in rest { li { (clean(&sentence(note, unit))) } } }
                }
            }
        }
    } }
}
