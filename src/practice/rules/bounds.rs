//! Tests of values that sieves only bound: no bound reads as a measurement, and a rule is met or broken only
//! if the bound itself meets or breaks its limit.

use super::*;
use crate::RuleNote;
use crate::applied::{AppliedRule, ValueBound};
use voidwalk_core::gradation::Gradation;

/// Rules of a filter, or of a band of several.
fn rules(filters: &[&[(f64, f64)]]) -> Vec<AppliedRule> {
    let soil = |points: &[(f64, f64)]| ("soil".to_owned(), Gradation::from_lines(points).unwrap());
    let filters: Vec<NamedCurve> = filters.iter().map(|points| soil(points)).collect();
    apply_to_envelopes(&[soil(&[(0.2, 0.0), (0.6, 100.0)])], &filters, false, None)
}

fn applied(id: &str, filters: &[&[(f64, f64)]]) -> AppliedRule {
    rules(filters).into_iter().find(|rule| rule.id == id).unwrap()
}

/// No. 57 stone as a quarry delivers it: no sieve is finer than 2.36 mm.
#[test]
fn fines_below_the_finest_sieve_are_at_most_what_passes_it() {
    let stone = |passing| [(2.36, passing), (4.75, 8.0), (12.5, 42.0), (25.0, 97.0), (37.5, 100.0)];
    let bound = applied(FILTER_FINES, &[&stone(2.0)]);
    assert_eq!(
        (bound.value, bound.value_bound, bound.met),
        (Some(2.0), Some(ValueBound::AtMost), Some(true))
    );
    assert_eq!(bound.notes, [RuleNote::FinestSieveOfFilter(2.36)]);
    let open = applied(FILTER_FINES, &[&stone(6.0)]);
    assert_eq!((open.value, open.value_bound, open.met), (None, None, None));
    let sieved = applied(FILTER_FINES, &[&[(0.075, 2.0), (1.0, 30.0), (4.0, 100.0)]]);
    assert_eq!((sieved.value, sieved.value_bound, sieved.met), (Some(2.0), None, Some(true)));
}

#[test]
fn a_cu_and_a_d15f_that_sieves_bound_are_broken_by_the_bound() {
    let wide = applied("filter-uniformity", &[&[(0.5, 12.0), (4.0, 60.0), (8.0, 100.0)]]);
    assert_eq!((wide.value, wide.value_bound, wide.met), (Some(8.0), Some(ValueBound::AtLeast), Some(false)));
    let fine = applied(PERMEABILITY, &[&[(0.5, 20.0), (4.0, 100.0)]]);
    assert_eq!((fine.value, fine.value_bound, fine.met), (Some(0.5), Some(ValueBound::AtMost), Some(false)));
}

/// With 20 % below the finest sieve no split at 17.6 % is judged: the hidden part may be worse.
#[test]
fn what_the_finest_part_hides_is_not_met() {
    let [narrow, gap] =
        [&[(0.5, 20.0), (4.0, 100.0)][..], &[(0.5, 20.0), (0.6, 30.0), (6.0, 30.0), (8.0, 100.0)]];
    for (filter, met) in [(narrow, None), (gap, Some(false))] {
        let rule = applied("kezdi", &[filter]);
        assert_eq!((rule.value_bound, rule.met), (Some(ValueBound::AtLeast), met), "{rule:?}");
    }
    let band = applied("filter-band", &[&[(0.5, 8.0), (4.0, 100.0)], &[(0.6, 8.0), (5.0, 100.0)]]);
    assert_eq!((band.value_bound, band.met), (Some(ValueBound::AtLeast), None), "{band:?}");
    let from = band.notes.iter().find_map(|note| match *note {
        RuleNote::BandFrom(percent) => Some(percent),
        _ => None,
    });
    assert!(from.is_some_and(|percent| (percent - 8.0).abs() < 1e-9), "{band:?}");
}

#[test]
fn a_shape_index_says_from_where_it_was_judged() {
    let judged = applied("kenney-lau", &[&[(0.5, 2.0), (1.0, 30.0), (4.0, 100.0)]]);
    assert_eq!(judged.met, Some(true));
    assert!(
        matches!(judged.notes[..], [RuleNote::ShapeAbovePan(_, from, most)]
            if (from - 2.0).abs() < 1e-9 && most == 30.0),
        "{judged:?}"
    );
    let whole = applied("kenney-lau", &[&[(0.5, 0.0), (1.0, 30.0), (4.0, 100.0)]]);
    assert!(matches!(whole.notes[..], [RuleNote::ShapeAt(..)]), "{whole:?}");
}

/// In a band, the curve with the coarsest remainder counts, whichever has the worst index.
#[test]
fn what_is_left_of_a_band_is_that_of_its_coarsest_curve() {
    let gap = |scale: f64, fines: f64| {
        [(0.1, 0.0), (0.2, fines), (2.0, fines), (6.0, 100.0)].map(|(size, finer)| (scale * size, finer))
    };
    let (fine, coarse) = (gap(1.0, 18.0), gap(2.0, 12.0));
    let left = |filters: &[&[(f64, f64)]]| applied(LI_FANNIN, filters).without_finer.unwrap();
    let both = left(&[&fine, &coarse]);
    assert_eq!(both, left(&[&coarse]));
    assert!(both.d15f > left(&[&fine]).d15f, "{both:?}");
}
