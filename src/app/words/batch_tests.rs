//! Tables of many samples beside the rules of their pairs.

use super::batch::{columns, counts, of_filter, open_limits};
use voidwalk_core::gradation::Gradation;
use voidwalk_practice::BatchFilter;
use voidwalk_practice::batch::*;
use voidwalk_practice::design::retention::retention;
use voidwalk_practice::quantity::SizeUnit;
use voidwalk_practice::rules::NamedCurve;
use voidwalk_practice::{PairOptions, PairRules, TestedClass};
use voidwalk_sheets::SoilSample;

fn soil(points: &[(f64, f64)]) -> Gradation {
    Gradation::from_lines(points).unwrap()
}

fn row(name: &str, curve: &Gradation, filter: &[NamedCurve], options: PairOptions) -> BatchRow {
    let sample = SoilSample { name: name.into(), path: name.into(), curve: curve.clone() };
    BatchRow::of(&sample, ("F", filter), options)
}

fn rows() -> Vec<BatchRow> {
    let filter = vec![("F".to_owned(), soil(&[(0.5, 0.0), (2.0, 100.0)]))];
    let samples = [
        ("sand", soil(&[(0.08, 0.0), (0.3, 100.0)])),
        ("fine sand", soil(&[(0.076, 0.0), (0.15, 100.0)])),
        ("silty", soil(&[(0.01, 0.0), (0.075, 60.0), (0.4, 100.0)])),
        ("open", soil(&[(0.4, 30.0), (1.0, 100.0)])),
        ("gravel", soil(&[(10.0, 0.0), (30.0, 100.0)])),
    ];
    let row_of = |(name, base): &(&str, Gradation)| row(name, base, &filter, PairOptions::default());
    samples.iter().map(row_of).collect()
}

#[test]
fn a_row_is_what_the_rules_say_of_the_pair_alone() {
    let filter = soil(&[(0.5, 0.0), (2.0, 100.0)]);
    let rows = rows();
    let pair = PairRules::of(&soil(&[(0.08, 0.0), (0.3, 100.0)]), &filter);
    let d15f = filter.d(15.0).unwrap();
    assert_eq!(rows[0].d15f_mm, Some(d15f));
    assert_eq!(rows[0].limit_mm, retention(&pair.rules, d15f).map(|(_, limit)| limit));
    assert_eq!((rows[0].met, rows[0].tests), (Some(true), TestedClass::None));
    assert_eq!((rows[1].met, rows[2].limit_mm, rows[2].category), (Some(false), Some(0.7), Some(2)));
    // Fines that nobody sieved: an upper bound of the limit, and no result for a filter within it.
    assert!(rows[3].limit_at_most && rows[3].met != Some(true), "{:?}", rows[3]);
    assert!(rows[4].met.is_none() && rows[4].is_refused, "{:?}", rows[4]);
    let csv = String::from_utf8(columns(SizeUnit::Mm).csv(&rows)).unwrap();
    assert!(csv.starts_with("sample,filter,group,category,fines_percent,regraded_at_mm,d85b_mm,d15f_mm,"));
    assert_eq!(csv.lines().count(), 6);
}

/// A limit that is kept reads as kept, and one that is exceeded as exceeded; inches as well.
#[test]
fn a_d15f_stands_on_its_side_of_the_limit() {
    let texts = |d15f: f64, limit: f64| {
        let row = BatchRow { d15f_mm: Some(d15f), limit_mm: Some(limit), ..rows().remove(0) };
        let shown = |unit| {
            let columns = columns(unit);
            let columns: Vec<_> = columns.of_page().collect();
            let cell = |heading: &str| {
                let column = columns.iter().find(|column| column.heading.text == heading).unwrap();
                (column.cell)(&row).text
            };
            [cell("D15F, mm"), cell("Limit, mm")]
        };
        let filter = BatchFilter {
            name: "F".into(),
            curves: vec!["F".into()],
            d15f_mm: Some(d15f),
            gradations: Vec::new(),
        };
        (
            shown(SizeUnit::Mm),
            shown(SizeUnit::MmAndInches),
            of_filter(&filter, std::slice::from_ref(&row), SizeUnit::Mm),
        )
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
    // The upper bound among four limits governs, or may govern.
    let named = names(governing(&rows, "F", NAMED));
    let open: &[&str] = if named.contains(&"open".to_owned()) { &[] } else { &["open"] };
    assert_eq!(names(may_govern(&rows, "F")), open);
    let lines = open_limits(&rows, "F").join("\n");
    assert!(lines.ends_with("nothing applied, as base and filter look exchanged: gravel"), "{lines}");
    assert!(governing(&rows, "G", 3).is_empty());
}

#[test]
fn a_row_that_a_dispersive_base_would_break_is_met_on_that_condition_alone() {
    let silt = soil(&[(0.01, 0.0), (0.075, 45.0), (0.3, 92.0), (0.6, 100.0)]);
    let row_with = |d15f: f64| {
        let filter = soil(&[(0.9 * d15f, 0.0), (d15f, 15.0), (2.0 * d15f, 100.0)]);
        row("silt", &silt, &[("F".to_owned(), filter)], PairOptions::default())
    };
    let (beyond, within) = (row_with(0.61), row_with(0.45));
    assert_eq!((beyond.met, beyond.breaks_if_dispersive), (Some(true), true));
    assert_eq!((within.met, within.breaks_if_dispersive), (Some(true), false));
    let sentence = counts(&[beyond], "F");
    assert!(sentence.contains("1 met (1 of them unless the base is dispersive), 0 not met"), "{sentence}");
}

/// A filter that is too coarse without its finer part is not met in the table either. A filter with a tenth
/// of its sizes keeps, without its finer part, the limit of a dispersive till too, and has no result: it may
/// lose more.
#[test]
fn a_filter_that_is_too_coarse_without_its_finer_part_is_not_met() {
    use crate::test_soils::{GRAVEL_0_32, REGRADED_TILL};
    let filter = |scale: f64| soil(&GRAVEL_0_32.map(|(size, percent)| (scale * size, percent)));
    let scaled = |scale| {
        let filter = vec![("F".to_owned(), filter(scale))];
        row("till", &soil(&REGRADED_TILL), &filter, PairOptions::default())
    };
    let (coarse, fine) = (scaled(1.0), scaled(0.1));
    assert_eq!((coarse.met, coarse.may_lose_fines), (Some(false), true));
    assert!((coarse.too_coarse_without_percent.unwrap() - 19.4).abs() < 0.05, "{coarse:?}");
    assert_eq!((fine.met, fine.may_lose_fines), (None, true));
    assert_eq!(fine.too_coarse_without_percent, None);
    assert!(counts(&[coarse], "F").starts_with("of 1 sample 0 met, 1 not met"));
}

#[test]
fn doubtful_tables_and_joints_stand_in_the_note() {
    let filter = vec![("F".to_owned(), soil(&[(0.5, 0.0), (2.0, 100.0)]))];
    let gravel = soil(&[(10.0, 0.0), (30.0, 100.0)]);
    let given = row("gravel", &gravel, &filter, PairOptions { as_given: true, ..PairOptions::default() });
    assert!(given.limit_mm.is_some() && given.notes.len() == 1, "{given:?}");
    let sand = soil(&[(0.08, 0.0), (0.3, 100.0)]);
    let joint = |mm| row("sand", &sand, &filter, PairOptions { joint_mm: Some(mm), ..Default::default() });
    assert_eq!(joint(2.0).joint, Some(JointErosion { percent: Some(90.0), is_below_source: false }));
    // D95B = 0.3 (0.08/0.3)^(1/20): 0.45 of it lies below the table of the source.
    let d95b = sand.d(95.0).unwrap();
    assert_eq!(joint(0.45 * d95b).joint, Some(JointErosion { percent: None, is_below_source: true }));
}

/// Limits of fines are the same for many samples: 0.7 mm. The finer sample comes first.
#[test]
fn of_equal_limits_the_finer_base_governs_and_the_others_are_counted() {
    let filter = vec![("F".to_owned(), soil(&[(0.5, 0.0), (2.0, 100.0)]))];
    let coarsest = |at: usize| soil(&[(0.01, 0.0), (0.075, 60.0), (0.8 - 0.1 * at as f64, 100.0)]);
    let numbered = |at| row(&format!("S{at}"), &coarsest(at), &filter, PairOptions::default());
    let rows: Vec<BatchRow> = (0..5).map(numbered).collect();
    let named = governing(&rows, "F", 3);
    assert!(named.iter().all(|row| row.limit_mm == Some(0.7)), "{named:?}");
    assert_eq!(named.iter().map(|row| row.sample.as_str()).collect::<Vec<_>>(), ["S4", "S3", "S2"]);
    assert_eq!(more_with_that_limit(&rows, "F", &named), 2);
    assert_eq!(more_with_that_limit(&rows, "G", &[]), 0);
}

/// The limit of a base whose fines nobody sieved is an upper bound, with a known D15F and without.
#[test]
fn a_d15f_in_the_pan_hides_no_limit_that_is_one_at_most() {
    let filter = vec![("F".to_owned(), soil(&[(0.5, 30.0), (2.0, 100.0)]))];
    let open = row("open", &soil(&[(0.3, 25.0), (1.0, 100.0)]), &filter, PairOptions::default());
    assert!(open.d15f_mm.is_none() && open.limit_mm.is_some() && open.limit_at_most, "{open:?}");
    assert_eq!(open.met, None);
}
