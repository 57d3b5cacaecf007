//! Page of a batch, made from `batch.json` alone.

use std::path::Path;

use maud::{Markup, Render, html};

use super::cases;
use super::figures::{
    Across, Axis, BLACK, BLUE, Colour, Dash, Figure, GREEN, Mark, ORANGE, PURPLE, Shape, VERMILLION,
    positive_range, shorten,
};
use super::files::{ReportError, json, refused};
use super::names::{brief_name, file_notes, is_named, soil_name, titled, told_apart};
use super::run_figures::size_axis;
use super::section::{Sections, Written};
use super::shell::{Drawn, citation, clean, leaves_out, program};
use super::table::Table;
use crate::outcome::statistic::interval_in_percent;
use crate::verdict::{SampleWalk, WalkedBatch, WalkedRow};
use crate::words::batch::{
    answer, counts, d15f_and_limit, governs_drainage, open_limits, walked_columns, walks,
};
use crate::words::capital;
use crate::words::left_out::NOT_COVERED;
use voidwalk_practice::quantity::{SizeUnit, percent};
use voidwalk_practice::{BatchFilter, BatchRow};

const RECORD: &str = "batch.json";

/// Maximum number of rows in the page's table; all are in `batch.csv`.
const LISTED: usize = 2000;

/// Colours and dashes of the lines that show the filters' D15F.
const LINES: [(Colour, Dash); 6] = [
    (BLACK, Dash::Dashed),
    (VERMILLION, Dash::Dotted),
    (GREEN, Dash::Dashed),
    (PURPLE, Dash::Dotted),
    (ORANGE, Dash::Dashed),
    (BLACK, Dash::Dotted),
];

/// Writes `batch.html` and `figures/*.svg` into the folder of a batch. A missing or malformed file is an
/// error, and nothing is written then.
pub(crate) fn write_batch(folder: &Path) -> Result<Written, ReportError> {
    let path = folder.join(RECORD);
    let batch: WalkedBatch = json(&path)?;
    if batch.rows.is_empty() {
        return Err(refused(&path, "rows", "empty".into(), "one or more"));
    }
    page(folder, &batch).write(folder, "batch.html", &citation())
}

fn alike<'a>(batch: &'a WalkedBatch, filter: &str) -> Vec<&'a str> {
    let names = batch.filters.iter().map(|other| other.name.as_str());
    names.filter(|other| soil_name(other) == soil_name(filter)).collect()
}

/// Name of a filter on the page: its soil, with a number if another filter has the same soil name.
fn filter_name(batch: &WalkedBatch, filter: &str) -> String {
    let (alike, soil) = (alike(batch, filter), soil_name(filter));
    match alike.iter().position(|other| *other == filter) {
        Some(at) if alike.len() > 1 => brief_name(&format!("{soil} ({})", at + 1)),
        _ => brief_name(soil),
    }
}

/// Files of the numbered filters; empty if names alone distinguish them.
fn key(batch: &WalkedBatch) -> Markup {
    let line = |filter: &BatchFilter| {
        let alike = alike(batch, &filter.name);
        let shown = filter_name(batch, &filter.name);
        (alike.len() > 1).then(|| format!("{shown}: {}", brief_name(&told_apart(&filter.name, &alike))))
    };
    let all: Vec<String> = batch.filters.iter().filter_map(line).collect();
    html! { @if !all.is_empty() { p.small { "The filters: " (all.join("; ")) "." } } }
}

fn page(folder: &Path, batch: &WalkedBatch) -> Sections {
    let names = html! {
        (titled(if batch.has_one_base() { "Base" } else { "Samples" }, &batch.samples))
        @match &batch.filters[..] {
            [only] => @if is_named("filter", &only.name) { ", " (titled("filter", &only.name)) },
            all => {
                ", filters "
                @for (at, filter) in all.iter().enumerate() {
                    @if at > 0 { ", " } b { bdi { (filter_name(batch, &filter.name)) } }
                }
            },
        }
    };
    let first = html! { div.first {
        (key(batch))
        section { @for filter in &batch.filters { (of_filter(folder, batch, filter)) } }
        (leaves_out(&batch.model_leaves_out, &html! {
            p { "The classes are the model’s. They do not replace a filter test or a designer’s judgement." }
            p { (NOT_COVERED) }
        }))
    } };
    let made = html! { p {
        "voidwalk " (clean(&batch.version)) ", seed " (batch.seed) " for every walk. Each walk has a folder \
         of its own with its report; " code { "batch.json" } " holds this page’s numbers, "
        code { "batch.csv" } " its table with further columns."
    } };
    let (kind, question) = match batch.has_one_base() {
        true => ("Filters of one base", "Which of these filters hold this base?"),
        false => ("Samples against filters", "Which samples do these filters hold?"),
    };
    Sections::new(kind, question, &names)
        .model()
        .cover(&batch.cover, &program(&batch.version, batch.commit.as_deref()), Some(batch.seed))
        .words(&first)
        .contents()
        .words(&html! { h2 { "Figures" } })
        .figures([curves(batch), limits(batch), eroded(batch)].into_iter().flatten())
        .section("Samples", &table(folder, batch))
        .section("Notes on the files", &file_notes(&batch.notes))
        .section("How this was made", &made)
}

/// Answers for a client about a filter: the number of samples that it holds, by the rules and by the walk,
/// and the samples that govern.
fn of_filter(folder: &Path, batch: &WalkedBatch, filter: &BatchFilter) -> Markup {
    let walks = walks(batch, &filter.name, SizeUnit::of(false, batch.inches));
    let rules: Vec<BatchRow> = batch.of_filter(&filter.name).map(|row| row.rules.clone()).collect();
    let besides = governs_drainage(&rules, &filter.name, SizeUnit::of(false, batch.inches)).into_iter();
    let besides = besides.chain(open_limits(&rules, &filter.name));
    html! {
        p.practice { bdi { (filter_name(batch, &filter.name)) } ", D15F "
            (d15f(&rules).unwrap_or("not known".into())) }
        ul {
            @if batch.has_one_base() {
                @for row in batch.of_filter(&filter.name) {
                    li { (limit_and_answer(folder, row, batch.inches)) }
                }
                @for walk in walks.iter().skip(1) { li { (clean(&capital(walk))) "." } }
            } @else {
                li { b { "Practice" } ": " (counts(&rules, &filter.name)) "." }
                @for (at, walk) in walks.iter().enumerate() {
                    li {
                        @if at == 0 { b { "Walk" } ": " (clean(walk)) } @else { (clean(&capital(walk))) } "."
                    }
                }
                @for row in batch.governing(&filter.name) {
                    li {
                        @if row.governs == Some(1) { b { "Governing sample" } " " } @else { "Then " }
                        bdi { (brief_name(&row.rules.sample)) } ": "
                        (limit_and_answer(folder, row, batch.inches))
                    }
                }
            }
            @for remark in besides { li { (clean(&capital(&remark))) "." } }
            @if filter.curves.len() > 1 {
                li { "An envelope of " (filter.curves.len()) " curves: the worst of them counts for each \
                    rule." }
            }
        }
    }
}

/// D15F of a filter, with enough digits to distinguish it from the nearest limit.
fn d15f(rules: &[BatchRow]) -> Option<String> {
    let beside = rules.iter().map(|row| d15f_and_limit(row, SizeUnit::Mm));
    beside.filter_map(|[d15f, _]| d15f).max_by_key(String::len)
}

/// Limit of a sample, the filter's D15F, and the answer.
fn limit_and_answer(folder: &Path, row: &WalkedRow, inches: bool) -> Markup {
    let rules = &row.rules;
    let unit = SizeUnit::of(false, inches);
    let [d15f, limit] = d15f_and_limit(rules, unit).map(|size| size.unwrap_or("not known".into()));
    html! {
        "D15F up to " (limit) @if rules.limit_at_most { " at most" }
        @if !rules.rule.is_empty() { " (" (clean(&rules.rule)) ")" }
        ", here " (d15f)
        ": " (clean(&answer(row)))
        @if let Some(walk) = &row.walk {
            ". Class by the walk: " (cases::class(walk.verdict, folder, &walk.folder))
        }
        "."
    }
}

fn table(folder: &Path, batch: &WalkedBatch) -> Markup {
    let class = |row: &WalkedRow| match &row.walk {
        Some(walk) => cases::class(walk.verdict, folder, &walk.folder),
        None => html! {},
    };
    let columns = walked_columns(SizeUnit::of(false, batch.inches));
    let table = Table::new(batch.rows.iter().take(LISTED), columns)
        .class("cases")
        .showing("sample", |row| html! { bdi { (brief_name(&row.rules.sample)) } })
        .showing("filter", |row| html! { bdi { (filter_name(batch, &row.rules.filter)) } })
        .showing("class", class);
    html! {
        (table.render())
        @if batch.rows.len() > LISTED { p.small { "The rest is in batch.csv." } }
        p.small {
            "Limit: the strictest D15F by which the filter retains the sample. Governs: 1 for the sample \
             with the least limit of its filter. Walked: in full, or a first look, which has fewer \
             replicates on a narrower lattice where the settings do not name them. Class by walk: with a \
             link to the page of the walk. Below a number its 95 % interval over the replicates; the \
             threshold between the classes is "
            (percent(batch.threshold).in_digits(3))
            "."
        }
    }
}

/// Curves of one base and of its filters, with the limits of D15F by practice; `None` for several samples.
fn curves(batch: &WalkedBatch) -> Option<Drawn> {
    if !batch.has_one_base() {
        return None;
    }
    let rules = || batch.rows.iter().map(|row| &row.rules);
    let most = rules().filter_map(|row| Some((row.limit_mm?, row.limit_at_most)));
    let least = rules().filter_map(|row| Some((row.d15f_min_mm?, row.d15f_min_at_most)));
    let marks = [
        (most.min_by(|a, b| a.0.total_cmp(&b.0)), "limit", VERMILLION),
        (least.max_by(|a, b| a.0.total_cmp(&b.0)), "drains", GREEN),
    ];
    let marks = || marks.iter().filter_map(|(mark, name, colour)| Some(((*mark)?, *name, *colour)));
    let gradations = || batch.filters.iter().flat_map(|filter| &filter.gradations);
    let sizes = batch.base.iter().chain(gradations().flatten()).map(|row| row[0]);
    let x = size_axis(SizeUnit::Mm, sizes.chain(marks().map(|((mm, _), ..)| mm)));
    let what = "Percent finer by mass against size of the base as sampled and of every filter, with the \
                limits of D15F";
    let mut figure = Figure::new("Gradations", what, x, Axis::percent("Percent finer (%)"))
        .sizes((720.0, 460.0), (358.0, 400.0))
        .sheet((680.0, 350.0))
        .sieves();
    figure.add(Mark::rule(Across::Y, 15.0, BLACK).dash(Dash::Dotted));
    for ((mm, is_at_most), name, colour) in marks() {
        let line = Mark::line(vec![(mm, 11.0), (mm, 19.0)], colour);
        let at_most = if is_at_most { " at most" } else { "" };
        figure.add(line.width(3.0).stays().label(&format!("{name}{at_most}")));
    }
    figure.add(Mark::rows(&batch.base, VERMILLION).width(2.6).label("base, as sampled"));
    for (filter, (colour, dash)) in batch.filters.iter().zip(LINES.iter().cycle()) {
        let label = shorten(&filter_name(batch, &filter.name), 24);
        for rows in &filter.gradations {
            figure.add(Mark::rows(rows, *colour).width(2.0).dash(*dash).label(&label));
        }
    }
    let caption = "Gradations by mass. Short lines: the maximum D15F that retains the base (limit), and the \
                   minimum D15F that drains it (drains).";
    Some(Drawn::new("batch-curves", figure, caption))
}

/// Limit of every sample against its D85B, with the D15F of the filters; `None` without a limit, or for one
/// base.
fn limits(batch: &WalkedBatch) -> Option<Drawn> {
    // A limit belongs to the sample; filters differ only if the rules require more of one.
    let known = batch.rows.iter().filter_map(|row| Some((row.rules.d85b_mm?, row.rules.limit_mm?, row)));
    let rows: Vec<(f64, f64, &WalkedRow)> = known.collect();
    if rows.is_empty() || batch.has_one_base() {
        return None;
    }
    let filters =
        || batch.filters.iter().take(LINES.len()).filter_map(|filter| Some((filter, filter.d15f_mm?)));
    let (low, high) = positive_range(rows.iter().map(|(d85b, ..)| *d85b));
    let x = Axis::log("D85B after regrading (mm)", low / 1.2, high * 1.2);
    let all = rows.iter().map(|(_, limit, _)| *limit).chain(filters().map(|(_, mm)| mm));
    let (low, high) = positive_range(all);
    let y = Axis::log("Limit of D15F (mm)", low / 1.2, high * 1.2);
    let what = "Strictest limit of D15F of each sample against its D85B, with the D15F of each filter";
    let mut figure = Figure::new("Limits of the samples", what, x, y).names_above();
    for ((filter, mm), (colour, dash)) in filters().zip(LINES) {
        let label = format!("D15F of {}", shorten(&filter_name(batch, &filter.name), 24));
        figure.add(Mark::rule(Across::Y, mm, colour).dash(dash).label(&label));
    }
    let point = |(d85b, limit, row): &(f64, f64, &WalkedRow)| {
        let shape = if row.governs == Some(1) { Shape::Square } else { Shape::Circle };
        let point = Mark::point(*d85b, *limit, BLUE, shape);
        if row.rules.limit_at_most { point.hollow() } else { point }
    };
    let points =
        |governs: bool| rows.iter().filter(move |(.., row)| (row.governs == Some(1)) == governs).map(point);
    figure.add_points("sample", points(false));
    figure.add_points("governs a filter", points(true));
    let caption = "Strictest limit of D15F of each sample. The D15F of a filter is within the limit of \
                   the samples that lie on or above its line. Hollow: the limit is at most this.";
    Some(Drawn::new("batch-limits", figure, caption))
}

/// Mass eroded in the first run against D15F over its limit, for comparing rule and walk.
fn eroded(batch: &WalkedBatch) -> Option<Drawn> {
    let case = |row: &WalkedRow| {
        let walk: &SampleWalk = row.walk.as_ref()?;
        let first = walk.runs.first()?;
        Some(cases::AtRatio {
            ratio: row.rules.d15f_mm? / row.rules.limit_mm?,
            class: walk.verdict,
            value: 100.0 * first.mean,
            interval: interval_in_percent(first),
            is_against: row.is_against_practice(),
            is_bound: row.rules.limit_at_most,
        })
    };
    let symbols: Vec<cases::AtRatio> = batch.rows.iter().filter_map(case).collect();
    if symbols.is_empty() {
        return None;
    }
    let ratios = symbols.iter().map(|symbol| symbol.ratio).chain([0.8, 1.25]);
    let (low, high) = positive_range(ratios);
    let x = Axis::log("D15F of the filter / limit of the sample (–)", low / 1.2, high * 1.2);
    let y = Axis::percent("Base eroded in the first run, by mass (%)");
    let limit = format!("{} %", 100.0 * batch.threshold);
    let rules = vec![
        Mark::rule(Across::Y, 100.0 * batch.threshold, BLACK).dash(Dash::Dashed).label(&limit),
        Mark::rule(Across::X, 1.0, BLACK).dash(Dash::Dotted).label("limit by practice"),
    ];
    let what = "Percent of the base mass eroded in the first run against D15F over its limit, by class";
    let figure = cases::against_ratio(["Rules and walk", what], (x, y), rules, &symbols);
    let caption = "One symbol per sample and filter, with the 95 % interval over its replicates. Up to 1 \
                   D15F is within the limit. Hollow: the limit is at most this, so the ratio is at least \
                   this. Black: nothing erodes in the model, and a rule of retention or of the filter’s own \
                   stability is not met. Below the dashed line the walk erodes less than the threshold. The \
                   class also takes the second run.";
    Some(Drawn::new("batch-eroded", figure, caption))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filters_of_one_name_have_a_key() {
        let filter = |name: &str| BatchFilter {
            name: name.into(),
            curves: vec!["f".into()],
            d15f_mm: None,
            gradations: Vec::new(),
        };
        let key_of = |names: &[&str]| {
            let filters = names.iter().map(|name| filter(name)).collect();
            key(&WalkedBatch::new("s.csv".into(), filters, Vec::new())).into_string()
        };
        assert_eq!(
            key_of(&["/lab/5/filter.csv", "/lab/7/filter.csv", "c33.csv"]),
            "<p class=\"small\">The filters: filter (1): 5/filter.csv; filter (2): 7/filter.csv.</p>"
        );
        assert_eq!(key_of(&["/lab/5/filter.csv", "c33.csv"]), "");
    }
}
