//! Notes on boundaries: of thin filters, and of searches that end too soon.

use super::tests::{found_within, of_base, options, searched, tiny};
use super::*;
use voidwalk_practice::Note;
use voidwalk_practice::design::RowNote;

#[test]
fn a_thickness_of_less_than_a_layer_is_not_passed_off_as_one() {
    let folder = tempfile::tempdir().unwrap();
    let base = of_base(folder.path(), "base.csv", &[(0.1, 0.0), (0.2, 100.0)]);
    let thicknesses = vec![Thickness::Mm(0.05), Thickness::Mm(0.9)];
    let options = options(&folder.path().join("out"), &["no layers"]);
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

/// An end of the range of a curve that holds more than was searched does not take the least ratio away.
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
    // A note reports that even the loosest holds everything, or holds nothing.
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
        let plain = options(&folder.path().join(&name), &["no layers", &format!("filter.thickness_mm={mm}")]);
        let all =
            searched(&BoundaryOptions { base: base.clone(), thicknesses: vec![Thickness::Mm(mm)], ..plain });
        let is_thicker = |row: &RowNote| row.note.id() == "layers_thicker";
        assert!(!all.notes.iter().any(is_thicker), "{:?}", all.notes);
    }
}
