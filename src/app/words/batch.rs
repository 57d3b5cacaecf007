//! Many samples against filters: columns of their table, and sentences on each filter.

use super::note::sentence;
use super::practice::{dispersive_limit, tested_in_brief};
use super::rule::rule_note;
use crate::outcome::record::Verdict;
use crate::outcome::table::{Columns, TableCell};
use crate::verdict::{SampleWalk, WalkedBatch, WalkedRow};
use voidwalk_practice::batch::{NAMED, governing, may_govern, more_with_that_limit};
use voidwalk_practice::quantity::{
    SizeUnit, Unit, beside_limit, beside_limit_in_cells, least_length, length, significant,
};
use voidwalk_practice::{BatchFilter, BatchRow, IfDispersive};

/// Words for a sample whose limit is open.
pub(crate) const MAY_GOVERN: &str = "may govern, as its limit is not known or may be lower";

/// Reason why a pair is neither judged nor walked.
pub(crate) const EXCHANGED: &str = "base and filter look exchanged";

/// Columns of a batch in its file, and under their headings on a terminal and a page, with sizes in this
/// unit. Details are the columns that the table of walks omits.
pub(crate) fn columns<'a>(unit: SizeUnit) -> Columns<'a, BatchRow> {
    let size = move |mm: Option<f64>| mm.map(|mm| length(mm, unit).in_cell());
    let limit = move |row: &BatchRow| {
        let at_most = if row.limit_at_most { " at most" } else { "" };
        let [_, limit] = d15f_and_limit_in_cells(row, unit);
        limit.map(|limit| limit + at_most)
    };
    Columns::default()
        .name("sample", "Sample", |row: &BatchRow| row.sample.clone())
        .text("filter", "Filter", |row| row.filter.clone())
        .text("group", "Group", |row| row.group.clone())
        .number("category", "Category", |row| row.category.map(u64::from))
        .detail()
        .digits("fines_percent", 1, |row| row.fines_percent)
        .page_number("Fines, %", |row| row.fines_percent)
        .detail()
        .digits("regraded_at_mm", 4, |row| row.regraded_at_mm)
        .digits("d85b_mm", 4, |row| row.d85b_mm)
        .page_number("D85B, mm", move |row| size(row.d85b_mm))
        .digits("d15f_mm", 4, |row| row.d15f_mm)
        .page_number("D15F, mm", move |row| {
            let [d15f, _] = d15f_and_limit_in_cells(row, unit);
            d15f
        })
        .detail()
        .digits("limit_mm", 4, |row| row.limit_mm)
        .page_number("Limit, mm", limit)
        .column("limit_at_most", |row| row.limit_at_most)
        .text("rule", "Whose limit", |row| row.rule.clone())
        .detail()
        .text("result", "Result", result)
        .text("tests", "Tests (Foster and Fell)", |row| tested_in_brief(row.tests, row.is_beyond_tests))
        .detail()
        .text("note", "Note", move |row| besides(row, unit))
        .place(9)
}

/// Columns of `batch.csv`, and under their headings of a terminal and a page, with sizes in this unit.
pub(crate) fn walked_columns<'a>(unit: SizeUnit) -> Columns<'a, WalkedRow> {
    let walk = |row: &WalkedRow| row.walk.clone();
    let of_walk = Columns::default()
        .number("governs", "Governs", |row: &WalkedRow| row.governs)
        .text("walked", "Walked", |row| {
            let why_not = row.walk.is_none().then(|| row.not_walked.clone()).filter(|why| !why.is_empty());
            let depth = match &row.walk {
                None => "not walked",
                Some(walk) if walk.in_full => "in full",
                Some(_) => "first look",
            };
            depth.shown().below(why_not)
        })
        .text("class", "Class by walk", move |row| walk(row).map(|walk| walk.verdict))
        .column("replicates", move |row| walk(row).map(|walk| walk.replicates))
        .digits("d15f_over_d85b", 4, move |row| walk(row).map(|walk| walk.ratios.d15f_over_d85b))
        .eroded(|row, run| {
            let walk = row.walk.as_ref();
            let range = walk.and_then(|walk| walk.curve_range.get(run).copied());
            (walk.and_then(|walk| walk.runs.get(run).copied()), range)
        })
        .detail()
        .column("not_walked", |row| row.not_walked.clone())
        .column("folder", move |row| walk(row).map(|walk| walk.folder));
    columns(unit).of_part(|row: &WalkedRow| &row.rules).and(of_walk).in_brief()
}

/// D15F of the filter and its limit, with enough digits to tell them apart.
pub(crate) fn d15f_and_limit(row: &BatchRow, unit: SizeUnit) -> [Option<String>; 2] {
    beside_limit([row.d15f_mm, row.limit_mm], false, Unit::Size(unit))
}

fn d15f_and_limit_in_cells(row: &BatchRow, unit: SizeUnit) -> [Option<String>; 2] {
    beside_limit_in_cells([row.d15f_mm, row.limit_mm], false, Unit::Size(unit))
}

fn result(row: &BatchRow) -> &'static str {
    match row.met {
        Some(true) if row.breaks_if_dispersive => "met unless the base is dispersive",
        Some(true) => "met",
        Some(false) => "not met",
        None => "no result",
    }
}

/// Remarks on a row for a table cell.
fn besides(row: &BatchRow, unit: SizeUnit) -> String {
    let mut all: Vec<String> = row.notes.iter().map(|note| sentence(note, unit)).collect();
    all.extend(row.open_sieves.map(|sieves| rule_note(sieves, unit)));
    if let Some(limit) = row.if_dispersive.filter(|_| row.breaks_if_dispersive) {
        all.push(format!("if the base is dispersive, D15F must be {}", dispersive_limit(limit, unit)));
    }
    match row.too_coarse_without_percent {
        Some(part) => all.push(format!(
            "too coarse without its finest {} %, which it may lose",
            significant(part).decimals(1)
        )),
        None if row.may_lose_fines => all.push("may lose its finer part".into()),
        None => {}
    }
    let others = [
        (row.drains == Some(false), "may not drain"),
        (row.may_segregate, "may segregate"),
        (row.is_drainage_judged && row.drains.is_none(), DRAINAGE_UNKNOWN),
    ];
    all.extend(others.into_iter().filter(|(holds, _)| *holds).map(|(_, words)| words.to_owned()));
    all.extend(row.joint.map(|joint| match (joint.percent, joint.is_below_source) {
        (Some(percent), _) => format!("joint: {} % continuing", significant(percent).in_digits(2)),
        (None, true) => "joint: less than 0.01 % continuing".into(),
        (None, false) => "joint: no result".into(),
    }));
    all.join("; ")
}

const DRAINAGE_UNKNOWN: &str = "drainage not known";

/// Number of samples that the filter retains, and the governing samples, one sentence each; the curves of
/// an envelope are named.
pub(crate) fn of_filter(filter: &BatchFilter, rows: &[BatchRow], unit: SizeUnit) -> Vec<String> {
    let BatchFilter { name, curves, .. } = filter;
    let mut lines = vec![format!("{name}: {}", counts(rows, name))];
    if curves.len() > 1 {
        lines.push(format!(
            "an envelope of {} curves ({}): the worst of them counts for each rule",
            curves.len(),
            curves.join(", ")
        ));
    }
    let strictest = governing(rows, name, NAMED);
    for (at, row) in strictest.iter().enumerate() {
        let what = if at == 0 { "governing sample" } else { "then" };
        let at_most = if row.limit_at_most { " at most" } else { "" };
        let [_, limit] = d15f_and_limit(row, unit);
        let limit = limit.unwrap_or_default();
        lines.push(format!("{what} {}: D15F up to {limit}{at_most} ({})", row.sample, row.rule));
    }
    let more = more_with_that_limit(rows, name, &strictest);
    if more > 0 {
        lines.push(format!("and {more} more with the same limit"));
    }
    lines.extend(governs_drainage(rows, name, unit));
    lines.extend(open_limits(rows, name));
    lines
}

/// Number of samples that a filter retains; unless it drains all, also the numbers that it may not drain
/// and for which drainage is unknown.
pub(crate) fn counts(rows: &[BatchRow], filter: &str) -> String {
    let in_filter = || rows.iter().filter(|row| row.filter == filter);
    let samples = in_filter().count();
    let one_or_more = if samples == 1 { "sample" } else { "samples" };
    let [met, not_met, none] =
        [Some(true), Some(false), None].map(|met| in_filter().filter(|row| row.met == met).count());
    let dry = in_filter().filter(|row| row.drains == Some(false)).count();
    let open = in_filter().filter(|row| row.drains.is_none() && row.d15f_min_mm.is_some()).count();
    let drainage = [(dry, "may not drain"), (open, DRAINAGE_UNKNOWN)].into_iter();
    let drainage = drainage.filter(|(count, _)| *count > 0);
    let drainage: String = drainage.map(|(count, what)| format!("; {count} {what}")).collect();
    let on_condition = match in_filter().filter(|row| row.breaks_if_dispersive).count() {
        0 => String::new(),
        count => format!(" ({count} of them unless the base is dispersive)"),
    };
    let others = format!("{not_met} not met, {none} without a result{drainage}");
    format!("of {samples} {one_or_more} {met} met{on_condition}, {others}")
}

/// Sample with the largest minimum D15F for drainage, in words; `None` if the filter drains all, or
/// without a limit.
pub(crate) fn governs_drainage(rows: &[BatchRow], filter: &str, unit: SizeUnit) -> Option<String> {
    let undrained = rows.iter().filter(|row| row.filter == filter && row.drains != Some(true));
    let limits = undrained.filter_map(|row| Some((row.d15f_min_mm?, row)));
    let (least, row) = limits.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let limit = match row.d15f_min_at_most {
        true => format!("the minimum D15F is not known, and at most {}", least_length(least, unit)),
        false => format!("D15F {} or more", least_length(least, unit)),
    };
    Some(format!("drainage is governed by {}: {limit}", row.sample))
}

/// Samples of a filter that may govern, and those to which nothing was applied, one sentence each without
/// its end.
pub(crate) fn open_limits(rows: &[BatchRow], filter: &str) -> Vec<String> {
    let names = |rows: Vec<&BatchRow>| {
        let names: Vec<&str> = rows.iter().map(|row| row.sample.as_str()).collect();
        (!names.is_empty()).then(|| names.join(", "))
    };
    let refused = rows.iter().filter(|row| row.filter == filter && row.is_refused).collect();
    let open = names(may_govern(rows, filter)).map(|names| format!("{MAY_GOVERN}: {names}"));
    let refused = names(refused).map(|names| format!("nothing applied, as {EXCHANGED}: {names}"));
    open.into_iter().chain(refused).collect()
}

/// Sentences without their ends on the walks of a filter: number of samples, kinds of walks and classes,
/// then the samples for which the walk is stricter than practice.
pub(crate) fn walks(batch: &WalkedBatch, filter: &str, unit: SizeUnit) -> Vec<String> {
    let rows: Vec<&WalkedRow> = batch.of_filter(filter).collect();
    let walks: Vec<&SampleWalk> = rows.iter().filter_map(|row| row.walk.as_ref()).collect();
    let not_walked = rows.len() - walks.len();
    let mut sentence = format!("{} walked", walks.len());
    if !walks.is_empty() {
        let in_full = walks.iter().filter(|walk| walk.in_full).count();
        let looks = walks.len() - in_full;
        let one_or_more = if looks == 1 { "first look" } else { "first looks" };
        sentence += &format!(" ({in_full} in full, {looks} {one_or_more}): {}", classes(&walks));
    }
    if not_walked > 0 {
        sentence += &format!("; {not_walked} not walked");
    }
    let erodes = |row: &&&WalkedRow| row.rules.met == Some(true) && row.erodes();
    let stricter: Vec<&str> = rows.iter().filter(erodes).map(|row| row.rules.sample.as_str()).collect();
    let mut all = vec![sentence];
    if !stricter.is_empty() {
        all.push(format!("met by practice, and the walk erodes: {}", stricter.join(", ")));
    }
    all.extend(dispersive_samples(&rows, unit));
    all
}

/// Answer of practice and walk on the sample, or the reason why it was not walked.
pub(crate) fn answer(row: &WalkedRow) -> String {
    let Some(walk) = &row.walk else { return format!("not walked: {}", row.not_walked) };
    let practice = walk.headline.map(|headline| format!("{}; ", headline.words()));
    format!("{}{} in the model", practice.unwrap_or_default(), walk.verdict.words())
}

/// Number of samples that may be dispersive, and the samples that then break practice.
fn dispersive_samples(rows: &[&WalkedRow], unit: SizeUnit) -> Option<String> {
    let limit = |row: &&WalkedRow| Some((row.rules.clone(), row.walk.as_ref().and(row.rules.if_dispersive)?));
    let open: Vec<(BatchRow, IfDispersive)> = rows.iter().filter_map(limit).collect();
    let is_broken = |(row, limit): &&(BatchRow, IfDispersive)| {
        let as_placed = || row.d15f_mm.is_some_and(|d15f| limit.is_broken_by(d15f));
        row.breaks_if_dispersive || row.met.is_none() && as_placed()
    };
    let name = |(row, limit): &(BatchRow, IfDispersive)| {
        format!("{} (D15F {})", row.sample, dispersive_limit(*limit, unit))
    };
    let broken: Vec<String> = open.iter().filter(is_broken).map(name).collect();
    let samples = if open.len() == 1 { "sample" } else { "samples" };
    let then = match broken.is_empty() {
        true => String::new(),
        false => format!("; if it is, practice allows less for {}", broken.join(", ")),
    };
    let sentence =
        format!("not known whether dispersive: {} {samples} with 15 % fines or more{then}", open.len());
    (!open.is_empty()).then_some(sentence)
}

fn classes(walks: &[&SampleWalk]) -> String {
    let count = |class| walks.iter().filter(|walk| walk.verdict == class).count();
    let counted = Verdict::ALL.into_iter().filter(|class| count(*class) > 0);
    counted.map(|class| format!("{} {}", count(class), class.words())).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::record::Ratios;
    use crate::test_soils::{GRAVEL_0_32, REGRADED_TILL, curve, filter, soil};
    use voidwalk_practice::batch::JointErosion;
    use voidwalk_practice::retention::retention;
    use voidwalk_practice::rules::NamedCurve;
    use voidwalk_practice::{PairOptions, PairRules, TestedClass};
    use voidwalk_sheets::SoilSample;

    const SAND: [(f64, f64); 2] = [(0.08, 0.0), (0.3, 100.0)];

    const GRAVEL: [(f64, f64); 2] = [(10.0, 0.0), (30.0, 100.0)];

    const FILTER: [(f64, f64); 2] = [(0.5, 0.0), (2.0, 100.0)];

    fn row(name: &str, base: &[(f64, f64)], filter: &[NamedCurve]) -> BatchRow {
        row_with(name, base, filter, PairOptions::default())
    }

    fn row_with(name: &str, base: &[(f64, f64)], filter: &[NamedCurve], options: PairOptions) -> BatchRow {
        let sample = SoilSample { name: name.into(), path: name.into(), curve: curve(base) };
        BatchRow::of(&sample, ("F", filter), options)
    }

    fn batch_filter(d15f_mm: Option<f64>) -> BatchFilter {
        BatchFilter { name: "F".into(), curves: vec!["F".into()], d15f_mm, gradations: Vec::new() }
    }

    fn walked(sample: &str, met: bool, walk: Option<(Verdict, Verdict, bool)>) -> WalkedRow {
        let rules = BatchRow { met: Some(met), if_dispersive: None, ..row(sample, &SAND, &soil(&FILTER)) };
        let walk = walk.map(|(verdict, by_practice, in_full)| SampleWalk {
            folder: String::new(),
            in_full,
            headline: None,
            verdict,
            by_practice: Some(by_practice),
            replicates: 2,
            ratios: Ratios { d15f_over_d85b: 4.0, d15f_over_d95b: 3.0 },
            base: None,
            runs: Vec::new(),
            curve_range: Vec::new(),
        });
        let not_walked = if walk.is_none() { "no table".into() } else { String::new() };
        WalkedRow { rules, governs: None, walk, not_walked }
    }

    #[test]
    fn walks_are_counted_by_class_and_practice_speaks_against_some() {
        let rows = vec![
            walked("A", true, Some((Verdict::None, Verdict::None, true))),
            walked("B", false, Some((Verdict::None, Verdict::Some, false))),
            walked("C", true, Some((Verdict::Some, Verdict::None, false))),
            walked("D", true, None),
        ];
        assert!(rows.iter().map(WalkedRow::is_against_practice).eq([false, true, false, false]));
        assert!(rows.iter().map(WalkedRow::is_doubted).eq([false, true, true, false]));
        assert_eq!(answer(&rows[3]), "not walked: no table");
        let batch = WalkedBatch::new("s.csv".into(), vec![batch_filter(None)], rows);
        assert!(walks(&batch, "F", SizeUnit::Mm)[0].contains("2 no erosion, 1 some erosion"));
    }

    #[test]
    fn a_sample_that_may_be_dispersive_is_said_with_its_limit() {
        let sample = |name: &str, verdict, d15f_max_mm| {
            let mut row = walked(name, true, Some((verdict, Verdict::None, true)));
            row.rules.if_dispersive = Some(IfDispersive { d15f_max_mm, at_most: false, lacks: None });
            row.rules.breaks_if_dispersive = d15f_max_mm < 0.725;
            row
        };
        let sand = walked("D", true, Some((Verdict::None, Verdict::None, true)));
        let rows = [
            sample("A", Verdict::None, 0.5),
            sample("B", Verdict::None, 0.9),
            sample("C", Verdict::Some, 0.5),
            sand.clone(),
        ];
        let words = dispersive_samples(&rows.each_ref(), SizeUnit::Mm).unwrap();
        assert!(words.contains(" 3 samples ") && !words.contains("B ("), "{words}");
        assert!(words.contains("A (D15F at most 0.500\u{202f}mm)"), "{words}");
        assert_eq!(dispersive_samples(&[&sand], SizeUnit::Mm), None);
        let batch = WalkedBatch::new("s.csv".into(), vec![batch_filter(None)], rows.to_vec());
        let last = walks(&batch, "F", SizeUnit::Mm).pop().unwrap();
        assert!(last.starts_with("not known whether dispersive: 3 samples"), "{last}");
    }

    fn rows() -> Vec<BatchRow> {
        let samples: [(&str, &[(f64, f64)]); 5] = [
            ("sand", &SAND),
            ("fine sand", &[(0.076, 0.0), (0.15, 100.0)]),
            ("silty", &[(0.01, 0.0), (0.075, 60.0), (0.4, 100.0)]),
            ("open", &[(0.4, 30.0), (1.0, 100.0)]),
            ("gravel", &GRAVEL),
        ];
        samples.map(|(name, base)| row(name, base, &soil(&FILTER))).into()
    }

    #[test]
    fn a_row_is_what_the_rules_say_of_the_pair_alone() {
        let (rows, filter) = (rows(), curve(&FILTER));
        let pair = PairRules::of(&curve(&SAND), &filter);
        let d15f = filter.d(15.0).unwrap();
        assert_eq!(rows[0].d15f_mm, Some(d15f));
        assert_eq!(rows[0].limit_mm, retention(&pair.rules, d15f).map(|(_, limit)| limit));
        assert_eq!((rows[0].met, rows[0].tests), (Some(true), TestedClass::None));
        assert_eq!((rows[1].met, rows[2].limit_mm, rows[2].category), (Some(false), Some(0.7), Some(2)));
        // The fines were not sieved: the limit is an upper bound, and a filter within it has no result.
        assert!(rows[3].limit_at_most && rows[3].met != Some(true), "{:?}", rows[3]);
        assert!(rows[4].met.is_none() && rows[4].is_refused, "{:?}", rows[4]);
        let csv = String::from_utf8(columns(SizeUnit::Mm).csv(&rows)).unwrap();
        assert!(
            csv.starts_with("sample,filter,group,category,fines_percent,regraded_at_mm,d85b_mm,d15f_mm,")
        );
        assert_eq!(csv.lines().count(), 6);
    }

    /// A limit that is kept reads as kept, and one that is exceeded reads as exceeded, also in inches.
    #[test]
    fn a_d15f_stands_on_its_side_of_the_limit() {
        let texts = |d15f: f64, limit: f64| {
            let row = BatchRow { d15f_mm: Some(d15f), limit_mm: Some(limit), ..rows().remove(0) };
            let shown = |unit| {
                let columns: Vec<_> = columns(unit).of_page().collect();
                ["D15F, mm", "Limit, mm"].map(|heading| {
                    let column = columns.iter().find(|column| column.heading.text == heading).unwrap();
                    (column.cell)(&row).text
                })
            };
            let [mm, inches] = [SizeUnit::Mm, SizeUnit::MmAndInches].map(shown);
            (mm, inches, of_filter(&batch_filter(Some(d15f)), std::slice::from_ref(&row), SizeUnit::Mm))
        };
        let (mm, inches, lines) = texts(2.376, 2.3784);
        assert_eq!(mm, ["2.376", "2.378"]);
        assert_eq!(inches, ["2.376 (0.0935\u{202f}in)", "2.378 (0.0936\u{202f}in)"]);
        assert!(lines[1].contains("D15F up to 2.378\u{202f}mm"), "{lines:?}");
        let (mm, inches, lines) = texts(1.683, 1.6818);
        assert_eq!(mm, ["1.683", "1.681"]);
        assert_eq!(inches, ["1.683 (0.0663\u{202f}in)", "1.681 (0.0661\u{202f}in)"]);
        assert!(lines[1].contains("D15F up to 1.681\u{202f}mm"), "{lines:?}");
        assert_eq!(texts(1.196, 1.196).0, ["1.196", "1.196"]);
    }

    #[test]
    fn the_strictest_governs_and_open_limits_are_named() {
        let rows = rows();
        let names = |rows: Vec<&BatchRow>| rows.iter().map(|row| row.sample.clone()).collect::<Vec<_>>();
        assert_eq!(names(governing(&rows, "F", 2)), ["fine sand", "silty"]);
        // The upper bound among four limits governs or may govern.
        let named = names(governing(&rows, "F", NAMED));
        let open: &[&str] = if named.contains(&"open".to_owned()) { &[] } else { &["open"] };
        assert_eq!(names(may_govern(&rows, "F")), open);
        let lines = open_limits(&rows, "F").join("\n");
        assert!(lines.ends_with("nothing applied, as base and filter look exchanged: gravel"), "{lines}");
        assert!(governing(&rows, "G", 3).is_empty());
    }

    #[test]
    fn a_row_that_a_dispersive_base_would_break_is_met_on_that_condition_alone() {
        let silt = [(0.01, 0.0), (0.075, 45.0), (0.3, 92.0), (0.6, 100.0)];
        let [beyond, within] = [0.61, 0.45].map(|d15f| row("silt", &silt, &filter(d15f)));
        assert_eq!((beyond.met, beyond.breaks_if_dispersive), (Some(true), true));
        assert_eq!((within.met, within.breaks_if_dispersive), (Some(true), false));
        let sentence = counts(&[beyond], "F");
        assert!(sentence.contains("1 met (1 of them unless the base is dispersive), 0 not met"));
    }

    /// A filter that is too coarse without its finer part is not met in the table either. A filter with a
    /// tenth of its sizes keeps the limit of a dispersive till, also without its finer part, but has no
    /// result: it may lose more.
    #[test]
    fn a_filter_that_is_too_coarse_without_its_finer_part_is_not_met() {
        let scaled = |scale: f64| {
            let filter = soil(&GRAVEL_0_32.map(|(size, percent)| (scale * size, percent)));
            row("till", &REGRADED_TILL, &filter)
        };
        let (coarse, fine) = (scaled(1.0), scaled(0.1));
        assert_eq!((coarse.met, coarse.may_lose_fines), (Some(false), true));
        assert!((coarse.too_coarse_without_percent.unwrap() - 19.4).abs() < 0.05, "{coarse:?}");
        assert_eq!((fine.met, fine.may_lose_fines, fine.too_coarse_without_percent), (None, true, None));
        assert!(counts(&[coarse], "F").starts_with("of 1 sample 0 met, 1 not met"));
    }

    #[test]
    fn doubtful_tables_and_joints_stand_in_the_note() {
        let options = PairOptions { as_given: true, ..PairOptions::default() };
        let given = row_with("gravel", &GRAVEL, &soil(&FILTER), options);
        assert!(given.limit_mm.is_some() && given.notes.len() == 1, "{given:?}");
        // D95B = 0.3 (0.08/0.3)^(1/20): 0.45 of it lies below the table of the source.
        let d95b = curve(&SAND).d(95.0).unwrap();
        for (mm, percent) in [(2.0, Some(90.0)), (0.45 * d95b, None)] {
            let options = PairOptions { joint_mm: Some(mm), ..PairOptions::default() };
            let joint = row_with("sand", &SAND, &soil(&FILTER), options).joint;
            assert_eq!(joint, Some(JointErosion { percent, is_below_source: percent.is_none() }));
        }
    }

    /// Samples with 40 to 85 % fines have the same limit, 0.7 mm. The finer sample comes first.
    #[test]
    fn of_equal_limits_the_finer_base_governs_and_the_others_are_counted() {
        let base = |at: usize| [(0.01, 0.0), (0.075, 60.0), (0.8 - 0.1 * at as f64, 100.0)];
        let numbered = |at| row(&format!("S{at}"), &base(at), &soil(&FILTER));
        let rows: Vec<BatchRow> = (0..5).map(numbered).collect();
        let named = governing(&rows, "F", 3);
        assert!(named.iter().all(|row| row.limit_mm == Some(0.7)), "{named:?}");
        assert_eq!(named.iter().map(|row| row.sample.as_str()).collect::<Vec<_>>(), ["S4", "S3", "S2"]);
        assert_eq!(more_with_that_limit(&rows, "F", &named), 2);
        assert_eq!(more_with_that_limit(&rows, "G", &[]), 0);
    }

    /// The limit of a base whose fines were not sieved is an upper bound, whether D15F is known or not.
    #[test]
    fn a_d15f_in_the_pan_hides_no_limit_that_is_one_at_most() {
        let open = row("open", &[(0.3, 25.0), (1.0, 100.0)], &soil(&[(0.5, 30.0), (2.0, 100.0)]));
        assert_eq!((open.d15f_mm, open.met), (None, None));
        assert!(open.limit_mm.is_some() && open.limit_at_most, "{open:?}");
    }
}
