//! The page of a campaign, from `campaign.json` and `ledger.jsonl` alone.

use std::path::Path;

use maud::{Markup, html};

use super::Written;
use super::error::ReportError;
use super::figures::{Across, Axis, BLACK, BLUE, Dash, Figure, PURPLE, Point, Rule, Shape, Tick};
use super::files::{json, lines};
use super::numbers::{duration, interval, percent, significant, whole};
use super::run_figures::verdict_colour;
use super::shell::{Drawn, clean, figure, whole_page};
use crate::outcome::MODEL_LEAVES_OUT;
use crate::outcome::ledger::{Campaign, LedgerLine};
use crate::outcome::record::{Statistic, Verdict};
use crate::outcome::verdict::THRESHOLD;

/// Cases drawn one by one; all are in the table.
const DRAWN: usize = 120;

/// Cases listed in the page; all are in `cases.csv`.
const LISTED: usize = 2000;

const CLASSES: [(Verdict, &str, Shape); 4] = [
    (Verdict::None, "no erosion", Shape::Circle),
    (Verdict::Some, "some erosion", Shape::Diamond),
    (Verdict::Continuing, "continuing erosion", Shape::Square),
    (Verdict::Undecided, "undecided", Shape::Triangle),
];

/// Writes `report.html` and `figures/*.svg` into the folder of a campaign.
///
/// # Errors
/// A file that is missing or malformed; nothing is written then.
pub fn write_campaign(folder: &Path) -> Result<Written, ReportError> {
    let about: Campaign = json(&folder.join("campaign.json"))?;
    let ledger: Vec<LedgerLine> = lines(&folder.join("ledger.jsonl"))?;
    let figures: Vec<Drawn> = match ledger.is_empty() {
        true => Vec::new(),
        false => vec![by_ratio(&ledger), both_runs(&ledger), largest(&ledger)],
    };
    super::write_page(folder, &figures, &page(&about, &ledger, &figures))
}

fn eroded(line: &LedgerLine, run: usize) -> Option<&Statistic> {
    line.runs.get(run).map(|run| &run.eroded_mass_fraction)
}

fn as_percent(statistic: &Statistic) -> Option<(f64, f64)> {
    interval(statistic).map(|(low, high)| (100.0 * low, 100.0 * high))
}

fn ratio_axis(ledger: &[LedgerLine]) -> Axis {
    let ratios = ledger.iter().map(|line| line.ratios.d15f_over_d85b);
    let (low, high) = ratios.fold((f64::MAX, 0.0_f64), |(low, high), r| (low.min(r), high.max(r)));
    let margin = 0.05 * (high - low).max(0.2 * high);
    Axis::linear("D15F / D85B (–)", low - margin, high + margin)
}

/// Eroded mass of the first run against the ratio of the filter rules, by class.
fn by_ratio(ledger: &[LedgerLine]) -> Drawn {
    let y = Axis::percent("Base eroded in the first run, by mass (%)");
    let what =
        "Percent of the base mass eroded in the first run against D15F/D85B, one symbol a case, by class";
    let mut figure =
        Figure::new("Erosion against the filter ratio", what, "", ratio_axis(ledger), y).names_above();
    figure.add(Rule::new(Across::Y, 100.0 * THRESHOLD, BLACK).dash(Dash::Dashed).label("7.5 %"));
    let ratios = ledger.iter().map(|line| line.ratios.d15f_over_d85b);
    if ratios.clone().any(|r| r < 4.0) && ratios.clone().any(|r| r > 4.0) {
        figure.add(Rule::new(Across::X, 4.0, BLACK).dash(Dash::Dotted).label("D15F/D85B = 4 (Terzaghi)"));
    }
    for (class, name, shape) in CLASSES {
        let mut named = false;
        for line in ledger.iter().filter(|line| line.verdict == class) {
            let Some(first) = eroded(line, 0) else { continue };
            let point =
                Point::new(line.ratios.d15f_over_d85b, 100.0 * first.mean, verdict_colour(class), shape)
                    .y_interval(as_percent(first));
            figure.add(if named { point } else { point.label(name) });
            named = true;
        }
    }
    let caption = "Base eroded in the first run against D15F/D85B: one symbol a case, with the 95 % interval over its \
                   replicates. The class also takes the second run.";
    Drawn { name: "by-ratio", caption: caption.into(), figure }
}

/// First and second run of each case, one row a case.
fn both_runs(ledger: &[LedgerLine]) -> Drawn {
    let shown = &ledger[..ledger.len().min(DRAWN)];
    let ticks = shown.iter().enumerate().map(|(row, line)| {
        let name = super::figures::shorten(&line.case, 34);
        Tick::new(row as f64 + 1.0, &[name.as_str()])
    });
    let mut y = Axis::linear("", 0.0, 1.0).with_ticks(ticks.collect()).downward();
    (y.low, y.high) = (0.3, shown.len() as f64 + 0.7);
    let x = Axis::percent("Base eroded, by mass (%)");
    let height = 100.0 + 19.0 * shown.len() as f64;
    let what =
        "Percent of the base mass eroded in the first and second run of each case, with 95 % intervals";
    let mut figure = Figure::new("Both runs of each case", what, "", x, y)
        .sizes((720.0, height), (358.0, height))
        .names_above();
    figure.add(Rule::new(Across::X, 100.0 * THRESHOLD, BLACK).dash(Dash::Dashed).label("7.5 %"));
    for (run, name, colour, shape) in
        [(0, "first run", BLUE, Shape::Circle), (1, "second run", PURPLE, Shape::Square)]
    {
        for (row, line) in shown.iter().enumerate() {
            let Some(statistic) = eroded(line, run) else { continue };
            let point = Point::new(100.0 * statistic.mean, row as f64 + 1.0, colour, shape)
                .x_interval(as_percent(statistic));
            figure.add(if row == 0 { point.label(name) } else { point });
        }
    }
    let rest = ledger.len() - shown.len();
    let more = if rest > 0 { format!(" {rest} more cases are in the table.") } else { String::new() };
    let caption = format!("Base eroded in the first and in the second run, with 95 % intervals.{more}");
    Drawn { name: "both-runs", caption, figure }
}

/// Largest particle that left, over D15F.
fn largest(ledger: &[LedgerLine]) -> Drawn {
    let of = |line: &LedgerLine| line.runs.first().and_then(|run| run.largest_eroded_over_d15f);
    let highest = ledger.iter().filter_map(of).map(|s| s.high.unwrap_or(s.mean)).fold(0.2, f64::max);
    let y = Axis::linear("Largest eroded particle / D15F, first run (–)", 0.0, 1.05 * highest);
    let what = "Largest eroded particle over D15F against D15F/D85B, one symbol a case";
    let mut figure = Figure::new("Largest eroded particle", what, "", ratio_axis(ledger), y)
        .sizes((720.0, 340.0), (358.0, 320.0))
        .names_above();
    for (class, name, shape) in CLASSES {
        let mut named = false;
        for line in ledger.iter().filter(|line| line.verdict == class) {
            let Some(statistic) = of(line) else { continue };
            let point = Point::new(line.ratios.d15f_over_d85b, statistic.mean, verdict_colour(class), shape)
                .y_interval(interval(&statistic));
            figure.add(if named { point } else { point.label(name) });
            named = true;
        }
    }
    let caption = "Largest particle that left the filter in the first run, over D15F.".to_owned();
    Drawn { name: "largest-eroded", caption, figure }
}

fn page(about: &Campaign, ledger: &[LedgerLine], figures: &[Drawn]) -> String {
    let title = if about.title.is_empty() { about.plan.as_str() } else { about.title.as_str() };
    let header = html! {
        h1 { "Which of these filters hold?" }
        p.names { b { bdi { (clean(title)) } } }
    };
    let count = |class| ledger.iter().filter(|line| line.verdict == class).count() as u64;
    let main = html! {
        div.first {
            section {
                p.lead { (whole(ledger.len() as u64)) " of " (whole(about.cases)) " cases are done." }
                table {
                    thead { tr { th { "Class" } th.n { "cases" } } }
                    tbody { @for (class, name, _) in CLASSES { @if count(class) > 0 {
                        tr { th { (name) } td.n { (whole(count(class))) } }
                    } } }
                }
                p { "Undecided: an interval over replicates straddles 7.5 %. More replicates may decide it." }
            }
            aside.leaves {
                h2 { "What the model leaves out" }
                ul { @for item in MODEL_LEAVES_OUT { li { (item) } } }
            }
        }
        @if !about.missing.is_empty() {
            h2 { "Not done" }
            p { (whole(about.missing.len() as u64)) " cases are missing: the same command goes on with them." }
            ul { @for name in about.missing.iter().take(50) { li { (clean(name)) } } }
        }
        @for (index, drawn) in figures.iter().enumerate() { (figure(index + 1, drawn)) }
        h2 { "Cases" }
        (table(about, ledger))
        @if ledger.len() > LISTED { p.small { "The rest is in cases.csv." } }
        (provenance(about, ledger))
    };
    let footer = html! {
        h2 { "How to cite" }
        p { "The model: Shire and O’Sullivan, " cite { "A network model to assess base-filter combinations" } "." }
    };
    whole_page(&clean(title), &header, &main, &footer)
}

fn table(about: &Campaign, ledger: &[LedgerLine]) -> Markup {
    let with_interval = |statistic: Option<&Statistic>| {
        let Some(statistic) = statistic else { return "–".to_owned() };
        let around =
            interval(statistic).map(|(low, high)| format!(" ({} to {})", percent(low), percent(high)));
        format!("{}{}", percent(statistic.mean), around.unwrap_or_default())
    };
    let level = |line: &LedgerLine, factor: &str| match line.levels.get(factor) {
        Some(serde_json::Value::String(level)) => clean(level),
        _ => String::new(),
    };
    let crossed = |line: &LedgerLine| !line.levels.is_empty();
    html! {
        div.scroll { table {
            thead { tr {
                @for factor in &about.factors { th { (clean(factor)) } }
                @if about.factors.is_empty() || !ledger.iter().all(crossed) { th { "case" } }
                th.n { "D15F/D85B" } th.n { "D15F/D95B" } th.n { "N_base" }
                th.n { "first run" } th.n { "second run" } th.n { "largest / D15F" } th { "class" }
                th { "replicates by class" }
            } }
            tbody { @for line in ledger.iter().take(LISTED) { tr {
                @for factor in &about.factors { td { (level(line, factor)) } }
                @if about.factors.is_empty() || !ledger.iter().all(crossed) {
                    td { @if !crossed(line) { (clean(&line.case)) } }
                }
                td.n { (significant(line.ratios.d15f_over_d85b)) }
                td.n { (significant(line.ratios.d15f_over_d95b)) }
                td.n { (whole(line.n_base)) @if line.capped { " (capped)" } }
                td.n { (with_interval(eroded(line, 0))) }
                td.n { (with_interval(eroded(line, 1))) }
                td.n { @if let Some(s) = line.runs.first().and_then(|r| r.largest_eroded_over_d15f) { (significant(s.mean)) } }
                td { b { (line.verdict.words()) } }
                td { (replicates_by_class(line)) }
            } } }
        } }
    }
}

/// "7 none, 3 some".
fn replicates_by_class(line: &LedgerLine) -> String {
    let names = ["none", "some", "continuing", "undecided"];
    let parts = names.iter().zip(line.replicate_verdicts).filter(|(_, count)| *count > 0);
    parts.map(|(name, count)| format!("{count} {name}")).collect::<Vec<_>>().join(", ")
}

fn provenance(about: &Campaign, ledger: &[LedgerLine]) -> Markup {
    let seconds: f64 = ledger.iter().map(|line| line.made.seconds).sum();
    let mut versions: Vec<&str> = ledger.iter().map(|line| line.version.as_str()).collect();
    versions.sort_unstable();
    versions.dedup();
    html! {
        h2 { "How this was made" }
        p {
            "Plan " bdi { (clean(&about.plan)) } ", voidwalk " (versions.join(", ")) ", " (duration(seconds))
            " of walks. Each case has a folder of its own with its report; " code { "ledger.jsonl" } " holds a line a case, "
            code { "cases.csv" } " the table above."
        }
    }
}
