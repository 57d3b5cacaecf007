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
use super::numbers::{SizeUnit, threshold};
use super::run_figures::run_name;
use super::section::Sections;
use super::shell::{Drawn, citation, clean, unbroken};
use super::table::Table;
use super::written::Written;
use crate::outcome::comparison::{ComparedCase, ComparedPair, Comparison};
use crate::outcome::record::{Confidence, Verdict};
use crate::verdict::FOREMOST;
use crate::verdict::left_out::left_out_in_brief;
use crate::verdict::words::capital;

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
            (doubts(comparison))
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
            "Class: with a link to the page of the case. Confidence: within or outside the range in which \
             the model was checked, contradicted by a rule of retention, or of a filter that practice would \
             not build. Below a number its 95 % interval over the replicates; the threshold between the \
             classes is " (threshold(comparison.threshold))
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
        .inches(comparison.inches)
        .words(&first)
        .contents()
        .section("Cases", &table)
        .section("Differences", &pairs(comparison))
        .words(&html! { h2 { "Figures" } })
        .figures([both_runs(comparison)].into_iter().chain(differences(comparison)))
        .words(&reasons(comparison))
        .section("How this was made", &made)
}

/// How many verdicts of each class there are, and how many of them can be relied on.
fn lead(comparison: &Comparison) -> String {
    let count = |class| comparison.cases.iter().filter(|case| case.verdict == class).count();
    let classes: Vec<String> = Verdict::ALL
        .into_iter()
        .filter(|class| count(*class) > 0)
        .map(|class| format!("{} {}", count(class), class.words()))
        .collect();
    let within = comparison.cases.iter().filter(|case| case.confidence == Confidence::Within).count();
    let relied = match (within, comparison.cases.len()) {
        (0, _) => "None of these verdicts is within the range in which the model was checked.".to_owned(),
        (within, all) if within == all => "All are within the range in which the model was checked.".into(),
        (within, all) => {
            format!("{within} of these {all} verdicts are within the range in which the model was checked.")
        }
    };
    format!("In the model: {}. {relied}", classes.join(", "))
}

/// The lines that every face begins with, of each case; records of earlier versions have some of them.
fn answers(comparison: &Comparison) -> Markup {
    html! { @for case in comparison.cases.iter().filter(|case| !case.practice.is_empty()) {
        @let headline = if case.headline.is_empty() { case.verdict.words() } else { &case.headline };
        section.verdict.(colour(case.verdict, case.confidence, case.standing)) {
            p.practice { bdi { (name(&case.name)) } ": " b { (clean(headline)) } "." }
            ul {
                @let lines = [("Practice", &case.practice), ("Walk", &case.walk), ("Next", &case.next)];
                @for (line, said) in lines {
                    @if !said.is_empty() { li { b { (line) } ": " (unbroken(said)) "." } }
                }
                @if !case.by_authority.is_empty() { li { (unbroken(&case.by_authority)) } }
            }
        }
    } }
}

fn doubts(comparison: &Comparison) -> Markup {
    html! { @for doubt in Confidence::DOUBTS {
        @let named: Vec<String> = comparison.cases.iter()
            // The line of the walk says it.
            .filter(|case| case.confidence == doubt && case.walk.is_empty())
            .map(|case| name(&case.name)).collect();
        @if !named.is_empty() {
            p { span.amber { (capital(doubt.words())) } ": " bdi { (named.join(", ")) } }
        }
    } }
}

fn cases(folder: &Path, comparison: &Comparison) -> Markup {
    Table::of(&comparison.cases)
        .class("cases")
        .columns(ComparedCase::columns(SizeUnit::of(false, comparison.inches)), |case| case)
        .named_by("case", |case| html! { bdi { (name(&case.name)) } })
        .showing("verdict", |case| cases::class(case.verdict, folder, &case.folder))
        .render()
}

fn pairs(comparison: &Comparison) -> Markup {
    let doubted = |name: &String| {
        let of = |case: &&ComparedCase| case.name == *name && case.confidence != Confidence::Within;
        comparison.cases.iter().any(|case| of(&case))
    };
    let any_doubted = comparison.pairs.iter().any(|pair| doubted(&pair.first) || doubted(&pair.second));
    let uncertain = comparison.pairs.iter().any(|pair| pair.differ.is_none());
    html! {
        @if comparison.pairs.is_empty() { p { "No two cases share a replicate." } }
        ul { @for pair in &comparison.pairs { li { (clean(&capital(&pair.sentence()))) "." } } }
        p.small {
            "Mass eroded as a part of the base’s, replicate by replicate: replicates of the same number \
             share their random numbers, so scatter common to both cases drops out of the \
             difference (common random numbers; paired t interval). Each interval holds by itself at \
             95 %; two cases are said to differ only if the interval that holds for all "
            (comparison.pairs.len()) " differences at once excludes 0."
            @if uncertain { " One replicate does not show the scatter." }
        }
        @if let Some(what) = comparison.not_in_intervals() {
            p {
                span.amber { "Not in these intervals" } ": " (what)
                ". Its range stands in the table, as “curve”."
            }
        }
        @if any_doubted {
            p { span.amber { "A difference is the model’s" } ": if the verdict of a case is in doubt, so is \
                every comparison with it." }
        }
    }
}

/// Why the verdicts are in doubt, which rules are not kept, and what else stands beside each.
fn reasons(comparison: &Comparison) -> Markup {
    let said = |case: &&ComparedCase| {
        !case.reasons.is_empty() || !case.rules_not_kept.is_empty() || !case.beside.is_empty()
    };
    html! { @for case in comparison.cases.iter().filter(said) {
        section.warnings {
            h2 { bdi { (name(&case.name)) } ": "
                @if case.confidence == Confidence::Within { "what else to know" }
                @else { "why this verdict is in doubt" } }
            @let all: Vec<&String> = match case.found.is_empty() {
                true => case.reasons.iter().chain(&case.beside).collect(),
                false => case.found.iter().collect(),
            };
            @let (foremost, rest) = all.split_at(all.len().min(FOREMOST));
            ul { @for said in foremost { li { (clean(said)) } } }
            @if !case.rules_not_kept.is_empty() {
                p { "Rules of practice that are not kept: " (clean(&case.rules_not_kept.join("; "))) "." }
            }
            @if !rest.is_empty() {
                details {
                    summary { "and " (rest.len()) " more" }
                    ul { @for said in rest { li { (clean(said)) } } }
                }
            }
        }
    } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::outcome::record::AppliedRule;
    use crate::verdict::PairRules;
    use crate::verdict::practice::{Standing, standing};
    use crate::verdict::practice_words::practice_in_words;

    fn rules(base: &[(f64, f64)], filter: &[(f64, f64)]) -> Vec<AppliedRule> {
        let of = |points| Gradation::from_lines(points).unwrap();
        PairRules::of(&of(base), &of(filter)).rules
    }

    /// The page of a comparison of one case with some erosion, and what the case's own page is coloured.
    fn colours(rules: &[AppliedRule]) -> (String, &'static str) {
        let comparison: Comparison = serde_json::from_value(serde_json::json!({
            "of": "filters", "common": "b", "seed": 1, "version": "1", "pairs": [], "threshold": 0.075,
            "cases": [{
                "name": "a", "folder": "a", "verdict": Verdict::Some, "confidence": Confidence::Within,
                "reasons": [], "rules_not_kept": [], "practice": practice_in_words(rules),
                "standing": standing(rules).recorded(), "replicates": 1, "n_base": 1,
                "ratios": {"d15f_over_d85b": 1.0, "d15f_over_d95b": 1.0}, "runs": [],
            }],
        }))
        .unwrap();
        let own = colour(Verdict::Some, Confidence::Within, Some(standing(rules).recorded()));
        (answers(&comparison).into_string(), own)
    }

    #[test]
    fn a_case_has_the_colour_of_its_own_page_whatever_its_line_of_practice_begins_with() {
        let sand = [(0.2, 0.0), (0.6, 100.0)];
        let fails = rules(&sand, &[(8.0, 0.0), (16.0, 100.0)]);
        // Between the limit of design and the boundary that tests saw.
        let no_margin = rules(&sand, &[(2.5, 0.0), (5.0, 100.0)]);
        assert_eq!([&fails, &no_margin].map(|of| standing(of)), [Standing::Fails, Standing::NoMargin]);
        for (rules, class) in [(&fails, "continuing"), (&no_margin, "some")] {
            assert!(practice_in_words(rules).starts_with("not met"));
            let (page, own) = colours(rules);
            assert_eq!(own, class);
            assert!(page.contains(&format!("class=\"verdict {class}\"")), "{page}");
        }
    }
}
