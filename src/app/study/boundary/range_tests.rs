//! Filters whose constriction curve is known only within a range: the ends that are searched and shown. Notes
//! on boundaries of thin filters, and of searches that end too soon.

use super::tests::{found_within, of_base, options, searched, stopped, timeless, tiny};
use super::*;
use crate::outcome::boundary::BoundaryRow;
use crate::run::prepare::PrepareOptions;
use voidwalk_practice::Note;
use voidwalk_practice::design::RowNote;

/// A guess for the constrictions covers a range. A run walks its ends as well, and so does a search for
/// boundaries.
#[test]
fn a_guess_at_the_constrictions_is_found_at_both_ends_of_its_range() {
    let folder = tempfile::tempdir().unwrap();
    let result = |name: &str, densities: &[&str]| {
        let densities = densities.iter().map(ToString::to_string).collect();
        let filter = Some("1.5".into());
        let options = tiny(&folder.path().join(name), &["network.nz=6"]);
        searched(&BoundaryOptions { densities, filter, ..options })
    };
    let rows = |all: &Boundaries| -> Vec<(String, f64)> {
        let median = |row: &BoundaryRow| row.no_erosion.as_ref().unwrap().median;
        all.boundaries.iter().map(|row| (row.density.clone(), median(row))).collect()
    };
    let guess = result("one", &["estimate=0.5"]);
    let guessed = rows(&guess);
    let names: Vec<&str> = guessed.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["estimate 0.5", "densest guess", "loosest guess"]);
    // The denser a filter, the finer its constrictions, and the coarser it may be.
    assert!(guessed[1].1 > 1.2 * guessed[0].1 && guessed[0].1 > 1.2 * guessed[2].1, "{guessed:?}");
    let end_of: Vec<Option<&str>> = guess.boundaries.iter().map(|row| row.end_of.as_deref()).collect();
    assert_eq!(end_of, [None, Some("estimate 0.5"), Some("estimate 0.5")]);
    let least = guess.boundaries.iter().map(|row| row.no_erosion.as_ref().unwrap().cautious().unwrap());
    let least = least.fold(f64::INFINITY, f64::min);
    assert_eq!(guess.least_held().unwrap().1.to_bits(), least.to_bits());
    let is_guess = |id: &str| guess.notes.iter().any(|row| row.note.id() == id);
    assert!(is_guess("guessed_constrictions") || is_guess("guessed_grains"), "{:?}", guess.notes);
    // An end that was asked for is searched only once, with the same bits.
    let asked = rows(&result("all", &["estimate=0", "estimate=1"]));
    let names: Vec<&str> = asked.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["loosest guess", "densest guess"]);
    assert_eq!(
        (asked[0].1.to_bits(), asked[1].1.to_bits()),
        (guessed[2].1.to_bits(), guessed[1].1.to_bits())
    );
}

/// A filter of unknown density is loose, dense or in between: its ends are searched, and the worse end
/// counts. The ratios that networks hold scatter so much here that either end may be the worse.
#[test]
fn a_filter_of_unknown_density_is_as_the_worse_of_its_ends() {
    let folder = tempfile::tempdir().unwrap();
    let options = BoundaryOptions {
        filter: Some("1.5".into()),
        ..tiny(&folder.path().join("out"), &["network.nz=5", "replicates=2", "base.cu=3"])
    };
    let all = searched(&options);
    let [unknown, dense] = &all.boundaries[..] else { panic!("{:?}", all.boundaries) };
    assert_eq!((unknown.density.as_str(), unknown.end_of.as_deref()), ("unknown", None));
    assert_eq!(dense.end_of.as_deref(), Some("unknown"));
    assert!(unknown.searched().starts_with("loose, constrictions "), "{}", unknown.searched());
    assert!(unknown.held().unwrap() < dense.held().unwrap());
    assert_eq!(unknown.networks.len(), 2);
    assert_eq!(all.least_held().unwrap().0, unknown);
    let table = std::fs::read_to_string(folder.path().join("out/boundary.csv")).unwrap();
    let density = |line: &str| line.trim_start_matches('"').starts_with("loose") as u8;
    assert!(table.lines().skip(1).all(|line| density(line) == 1 || line.contains("dense, constrictions")));
    assert!(table.lines().skip(1).any(|line| density(line) == 1), "{table}");
}

/// If the first network of an end holds clearly more than those of the worse end, its boundary is not
/// searched. The worse end is searched as usual.
#[test]
fn an_end_that_holds_clearly_more_is_asked_for_one_ratio() {
    let folder = tempfile::tempdir().unwrap();
    let stone = [(1.18, 2.5), (2.36, 5.0), (4.75, 20.0), (9.5, 92.5), (12.5, 100.0)];
    let filter = of_base(folder.path(), "stone.csv", &stone);
    let options = BoundaryOptions {
        filter: Some(filter.display().to_string()),
        ..tiny(&folder.path().join("out"), &["network.nz=6", "replicates=2"])
    };
    let all = searched(&options);
    // The end that cannot decide the answer has no row of its own; a note on the row of the range reports it.
    let [unknown] = &all.boundaries[..] else { panic!("{:?}", all.boundaries) };
    assert_eq!(unknown.networks.len(), 2);
    let end = "dense, constrictions";
    let is_spared = |note: &Note| matches!(note, Note::SparedEnd { density, .. } if density.contains(end));
    assert!(unknown.no_erosion_notes.iter().any(is_spared), "{unknown:?}");
    let table = std::fs::read_to_string(folder.path().join("out/boundary.csv")).unwrap();
    let dense: Vec<&str> = table.lines().filter(|line| line.contains(end)).collect();
    assert!(!dense.is_empty() && dense.iter().all(|line| line.contains(",6 layers,1,")), "{dense:?}");
}

/// Stops when one of two such ends is saved, and continues on three threads.
#[test]
fn a_search_goes_on_from_an_end_that_was_not_searched() {
    let folder = tempfile::tempdir().unwrap();
    let plan = |name: &str, threads: usize| BoundaryOptions {
        filter: Some("1.5".into()),
        thicknesses: vec!["4layers".parse().unwrap(), "6layers".parse().unwrap()],
        prepare: PrepareOptions { threads: Some(threads), ..PrepareOptions::default() },
        ..tiny(&folder.path().join(name), &["replicates=2"])
    };
    let whole = searched(&plan("whole", 2));
    let spared = |row: &BoundaryRow| row.no_erosion_notes.iter().any(|note| note.id() == "spared_end");
    assert_eq!(whole.boundaries.iter().filter(|row| spared(row)).count(), 2, "{:?}", whole.boundaries);
    let error = stopped(&plan("stopped", 1), " holds (");
    // Two networks of either thickness, and one end.
    assert!(error.to_string().starts_with("after 5 of 8 networks"), "{error}");
    assert_eq!(timeless(&searched(&plan("stopped", 3))), timeless(&whole));
}

/// An end that is also a row of its own is shown, and is searched only once.
#[test]
fn the_worse_end_of_an_unknown_density_stays_where_another_row_needs_it() {
    let folder = tempfile::tempdir().unwrap();
    let options = BoundaryOptions {
        filter: Some("1.5".into()),
        densities: vec!["unknown".into(), "loose".into()],
        thicknesses: vec!["4layers".parse().unwrap(), "5layers".parse().unwrap()],
        ..tiny(&folder.path().join("out"), &["replicates=2", "base.cu=3"])
    };
    let all = searched(&options);
    let densities = |thickness: &str| -> Vec<(String, Option<String>)> {
        let rows = all.boundaries.iter().filter(|row| row.thickness == thickness);
        let word =
            |text: &str| text.split(" %").next().unwrap().trim_end_matches(char::is_numeric).to_owned();
        rows.map(|row| (word(&row.density), row.end_of.clone())).collect()
    };
    let unknown = Some("unknown".to_owned());
    let expected = [
        ("unknown", None),
        ("loose, constrictions ", unknown.clone()),
        ("dense, constrictions ", unknown),
        ("loose", None),
        ("loose, constrictions ", Some("loose".to_owned())),
    ];
    let expected = expected.map(|(density, end_of)| (density.to_owned(), end_of));
    for thickness in ["4 layers", "5 layers"] {
        let mut shown = densities(thickness);
        shown.sort_by_key(|row| expected.iter().position(|other| other == row));
        assert_eq!(shown, expected, "{thickness}");
    }
    // A dense filter has fewer grains per void than the loose one.
    let grains = |row: usize| all.boundaries[row].grains_per_void.unwrap();
    let dense = all.boundaries.iter().position(|row| row.density.starts_with("dense")).unwrap();
    assert!(grains(dense) < 0.95 * grains(0), "{} {}", grains(dense), grains(0));
}

#[test]
fn a_thickness_of_less_than_a_layer_is_not_passed_off_as_one() {
    let folder = tempfile::tempdir().unwrap();
    let base = of_base(folder.path(), "base.csv", &[(0.1, 0.0), (0.2, 100.0)]);
    let thicknesses = vec![Thickness::Mm(0.05), Thickness::Mm(0.9)];
    let options = options(&folder.path().join("out"), &[]);
    let all = searched(&BoundaryOptions { base: Some(base), thicknesses, ..options });
    let (thin, row) = (&all.boundaries[0], &all.boundaries[1]);
    assert!(thin.layers == 1 && thin.thickness_mm.unwrap() > 0.1, "{thin:?}");
    let is_thicker =
        |note: &Note| matches!(note, Note::LayerThicker { thickness, .. } if thickness == "0.05 mm");
    assert!(thin.no_erosion_notes.iter().any(is_thicker), "{thin:?}");
    assert!(row.thickness_mm == Some(0.9) && row.no_erosion_notes.is_empty(), "{row:?}");
    let thicker: Vec<_> = all.notes.iter().filter(|row| row.note.id() == "layer_thicker").collect();
    assert!(thicker.len() == 1 && thicker[0].row.as_deref() == Some("loose, 0.05 mm"), "{thicker:?}");
}

/// An end of the range that holds more than was searched leaves the minimum ratio in place.
#[test]
fn an_end_that_holds_all_that_was_searched_limits_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let result = |name: &str, bracket: [f64; 2]| {
        let (densities, filter) = (vec!["estimate=0.5".into()], Some("1.5".into()));
        let options = tiny(&folder.path().join(name), &["network.nz=6"]);
        found_within(&BoundaryOptions { densities, filter, ..options }, bracket)
    };
    let least = |all: &Boundaries| all.least_held().map(|(_, ratio)| ratio);
    let has = |all: &Boundaries, id: &str| all.notes.iter().any(|row| row.note.id() == id);
    let wide = result("wide", [0.8, 30.0]);
    let end =
        |number: usize| wide.boundaries[number].networks.iter().filter_map(|network| network.no_erosion);
    let narrow = result("narrow", [0.8, 1.01 * end(0).fold(0.0, f64::max)]);
    assert!(narrow.boundaries[1].no_erosion.is_none(), "{:?}", narrow.boundaries[1]);
    assert!(least(&wide).is_some() && least(&narrow) == least(&wide));
    assert!(!has(&narrow, "holds_everywhere"));
    // A note reports if even the loosest end holds everything, or holds nothing.
    let short = result("short", [0.5, 0.9 * end(2).fold(f64::MAX, f64::min)]);
    assert!(least(&short).is_some() && has(&short, "holds_everywhere"));
    let high = result("high", [1.1 * end(2).fold(0.0, f64::max), 30.0]);
    assert_eq!(least(&high), None);
    assert!(has(&high, "erodes_everywhere"), "{:?}", high.notes);
}

#[test]
fn a_real_thickness_is_compared_in_mm_alone() {
    let folder = tempfile::tempdir().unwrap();
    let notes = |name: &str, more: &[&str]| {
        let all = [&["network.nz=20", "filter.thickness_mm=1"], more].concat();
        let all = searched(&tiny(&folder.path().join(name), &all));
        let has = |id: &str| all.notes.iter().any(|row| row.note.id() == id);
        [has("thickness_without_unit"), has("layers_thicker")]
    };
    assert_eq!(notes("no-size", &[]), [true, false]);
    assert_eq!(notes("sized", &["base.d85_mm=0.2"]), [false, true]);
    // The requested thickness is rounded to layers.
    let base = Some(of_base(folder.path(), "base.csv", &[(0.1, 0.0), (0.2, 100.0)]));
    for mm in [10.0, 10.3, 10.6, 10.9] {
        let name = format!("of-{mm}");
        let plain = options(&folder.path().join(&name), &[&format!("filter.thickness_mm={mm}")]);
        let all =
            searched(&BoundaryOptions { base: base.clone(), thicknesses: vec![Thickness::Mm(mm)], ..plain });
        let is_thicker = |row: &RowNote| row.note.id() == "layers_thicker";
        assert!(!all.notes.iter().any(is_thicker), "{:?}", all.notes);
    }
}
