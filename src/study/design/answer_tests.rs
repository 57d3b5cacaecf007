//! What is said of boundaries: of thin filters, of searches that end too soon, of products.

use super::tests::{found, of_base, options, tiny};
use super::*;
use crate::outcome::design::DesignFinding;
use crate::outcome::design::band::SetBy;

#[test]
fn a_thickness_of_less_than_a_layer_is_not_passed_off_as_one() {
    let folder = tempfile::tempdir().unwrap();
    let base = of_base(folder.path(), "base.csv", &[(0.1, 0.0), (0.2, 100.0)]);
    let thicknesses = vec![Thickness::Mm(0.05), Thickness::Mm(0.9)];
    let options = options(&folder.path().join("out"), &["no layers"]);
    let design = found(&DesignOptions { base: Some(base), thicknesses, ..options });
    let (thin, row) = (&design.boundaries[0], &design.boundaries[1]);
    assert!(thin.layers == 1 && thin.thickness_mm.unwrap() > 0.1, "{thin:?}");
    assert!(thin.no_erosion_note.as_ref().unwrap().contains("a filter of 0.05 mm holds less"), "{thin:?}");
    assert!(row.thickness_mm == Some(0.9) && row.no_erosion_note.is_none(), "{row:?}");
    let thicker: Vec<_> =
        design.findings.iter().filter(|found| found.finding.id == "layer_thicker").collect();
    assert!(thicker.len() == 1 && thicker[0].row.as_deref() == Some("loose, 0.05 mm"), "{thicker:?}");
}

/// An end of the range of a curve that holds more than was searched does not take the band away.
#[test]
fn an_end_that_holds_all_that_was_searched_limits_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let of = |name: &str, bracket: [f64; 2]| {
        let (densities, filter) = (vec!["estimate=0.5".into()], Some("1.5".into()));
        let options = tiny(&folder.path().join(name), &["network.nz=6"]);
        found(&DesignOptions { densities, filter, bracket, ..options })
    };
    let wide = of("wide", [0.8, 30.0]);
    let end = |number: usize| wide.boundaries[number].networks.iter().filter_map(|of| of.no_erosion);
    let narrow = of("narrow", [0.8, 1.01 * end(0).fold(0.0, f64::max)]);
    assert!(narrow.boundaries[1].no_erosion.is_none(), "{:?}", narrow.boundaries[1]);
    assert_eq!(narrow.boundaries[0].band, wide.boundaries[0].band);
    assert!(narrow.boundaries[0].band.is_some() && narrow.boundaries[0].band_note.is_none());
    // Where even the loosest holds all, or the loosest none, that is said.
    let short = of("short", [0.5, 0.9 * end(2).fold(f64::MAX, f64::min)]);
    let row = &short.boundaries[0];
    assert!(row.band.is_none() && row.band_note.is_some() && row.held().is_some(), "{row:?}");
    let high = of("high", [1.1 * end(2).fold(0.0, f64::max), 30.0]);
    let row = &high.boundaries[0];
    assert!(
        row.band.is_none() && row.band_note.as_ref().unwrap().contains("searched (loosest guess)"),
        "{row:?}"
    );
}

/// What is delivered within both limits is no coarser than practice allows, however coarse the walk has it.
#[test]
fn products_are_judged_at_what_walk_and_practice_both_allow() {
    // As wide as none is in doubt for.
    const WIDE: [&str; 4] = ["network.nz=60", "network.nx=10", "network.ny=10", "base.d85_mm=0.15"];
    let folder = tempfile::tempdir().unwrap();
    let of = |name: &str, more: &[&str]| found(&tiny(&folder.path().join(name), &[&WIDE[..], more].concat()));
    let design = of("sand", &[]);
    let band = design.boundaries[0].band.as_ref().unwrap();
    let walked = design.boundaries[0].no_erosion.as_ref().unwrap().d15f_mm.unwrap().median;
    assert!(band.practice == Some(band.greatest) && band.greatest < walked && !band.is_empty, "{band:?}");
    assert_eq!((band.set_by, design.answer.as_ref().unwrap().d15f_max_mm), (SetBy::Practice, band.practice));
    // Practice alone set the limit, so that a doubt of the walk is none of the products.
    for design in [design, of("few", &["replicates=4"])] {
        assert!(design.fits_by_practice(), "{:?}", design.findings);
    }
}

#[test]
fn a_base_that_is_regraded_and_scaled_says_its_share_and_that_practice_would_cut_it_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    let points = [(0.2, 0.0), (0.5, 10.0), (2.0, 30.0), (4.75, 58.0), (19.0, 100.0)];
    let base = of_base(folder.path(), "gravel.csv", &points);
    let settings = ["network.nx=6", "network.ny=6", "filter.d0_mm=2", "base.regrade=practice"];
    let options = options(&folder.path().join("out"), &[]);
    let settings = options.settings.iter().cloned().chain(settings.map(String::from));
    let settings = settings.filter(|one| !one.contains("=9")).collect();
    let design = found(&DesignOptions { inverse: true, base: Some(base), settings, ..options });
    let numbers = |id: &str| {
        let found = design.findings.iter().find(|found| found.finding.id == id);
        found.map(|found| found.finding.numbers.clone())
    };
    assert_eq!(numbers("regraded").unwrap()["part_percent"], 58.0, "{:?}", design.findings);
    assert!(numbers("regraded_elsewhere").is_some(), "{:?}", design.findings);
}

#[test]
fn a_real_thickness_is_compared_in_mm_alone() {
    let folder = tempfile::tempdir().unwrap();
    let of = |name: &str, more: &[&str]| {
        let all = [&["network.nz=20", "filter.thickness_mm=1"], more].concat();
        let design = found(&tiny(&folder.path().join(name), &all));
        let has = |id: &str| design.findings.iter().any(|found| found.finding.id == id);
        [has("thickness_without_unit"), has("layers_thicker")]
    };
    assert_eq!(of("no-size", &[]), [true, false]);
    assert_eq!(of("sized", &["base.d85_mm=0.2"]), [false, true]);
    // What was asked for is rounded to layers.
    let base = Some(of_base(folder.path(), "base.csv", &[(0.1, 0.0), (0.2, 100.0)]));
    for mm in [10.0, 10.3, 10.6, 10.9] {
        let name = format!("of-{mm}");
        let plain = options(&folder.path().join(&name), &["no layers", &format!("filter.thickness_mm={mm}")]);
        let design =
            found(&DesignOptions { base: base.clone(), thicknesses: vec![Thickness::Mm(mm)], ..plain });
        let is_thicker = |found: &DesignFinding| found.finding.id == "layers_thicker";
        assert!(!design.findings.iter().any(is_thicker), "{:?}", design.findings);
    }
}

/// 30 % of the base pass its finest sieve: of the limit of practice only the most is known.
#[test]
fn a_base_of_whose_limit_only_the_most_is_known_is_not_said_to_be_kept() {
    let folder = tempfile::tempdir().unwrap();
    let points = [(0.25, 30.0), (0.5, 45.0), (1.0, 60.0), (2.0, 90.0), (4.0, 100.0)];
    let base = of_base(folder.path(), "base.csv", &points);
    let filter = of_base(folder.path(), "filter.csv", &[(1.0, 0.0), (2.0, 50.0), (4.0, 100.0)]);
    let filter = Some(filter.display().to_string());
    let options = tiny(&folder.path().join("out"), &["replicates=1", "network.nz=6"]);
    let options = DesignOptions { inverse: true, filter, densities: vec!["loose".into()], ..options };
    let settings = options.settings.iter().filter(|of| !of.starts_with("base.")).cloned().collect();
    let design = found(&DesignOptions { base: Some(base), settings, ..options.clone() });
    let answer = design.answer();
    assert!(answer.said.starts_with("The finest D85B is not known: only an upper bound"), "{}", answer.said);
    assert_eq!((answer.d85b_min_mm, answer.d15f_over_d85b, answer.rule), (None, None, None));
    // With its fines known the same sizes have an answer.
    let closed = [&[(0.125, 0.0)][..], &points].concat();
    let base = of_base(folder.path(), "closed.csv", &closed);
    let settings = options.settings.iter().filter(|of| !of.starts_with("base.")).cloned().collect();
    let out = folder.path().join("closed");
    let known = found(&DesignOptions { base: Some(base), settings, out, ..options });
    assert!(!known.answer().said.contains("not known"), "{}", known.answer().said);
}
