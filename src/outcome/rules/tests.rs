//! Each rule against an example worked by hand; formulas are those of the source that the table names.

use super::*;
use crate::gradation::Gradation;

fn sieve(points: &[(f64, f64)]) -> Gradation {
    Gradation::from_points(points, None).unwrap()
}

fn of(id: &str, filter: &Gradation, base: &Gradation) -> AppliedRule {
    let rules = apply(&RuleInputs::of_soils(filter, base));
    rules.into_iter().find(|rule| rule.id == id).unwrap()
}

/// A filter with this D15, of Cu 1.5.
fn filter(d15: f64) -> Gradation {
    Gradation::linear_from_dx(15.0, d15, 1.5).unwrap()
}

/// A base with `fines` percent finer than 0.075 mm and this D85.
fn base(fines: f64, d85: f64) -> Gradation {
    match fines < 85.0 {
        true => sieve(&[(0.001, 0.0), (0.075, fines), (d85, 85.0), (4.0, 100.0)]),
        false => sieve(&[(0.001, 0.0), (d85, 85.0), (0.075, fines), (4.0, 100.0)]),
    }
}

fn close(found: Option<f64>, expected: f64) -> bool {
    found.is_some_and(|found| (found - expected).abs() < 1e-9)
}

#[test]
fn sherard_and_dunnigan_by_hand_in_each_category() {
    // 9 x 0.05; 9 x 0.01 = 0.09 is less than 0.2; 0.7; the till of the first trial: (40 - 38)/25 (4 x 1.488 -
    // 0.7) + 0.7 = 1.12016; at 15 % it is 4 D85B; below, too.
    for (fines, d85, limit) in [
        (90.0, 0.05, 0.45),
        (90.0, 0.01, 0.2),
        (60.0, 0.5, 0.7),
        (40.0, 0.5, 0.7),
        (38.0, 1.488, 1.12016),
        (27.5, 0.6, 1.55),
        (15.0, 0.6, 2.4),
        (5.0, 0.6, 2.4),
    ] {
        let rule = of("sherard-dunnigan", &filter(6.3), &base(fines, d85));
        assert!(close(rule.limit, limit) && close(rule.value, 6.3), "{fines} {d85}: {rule:?}");
        assert_eq!((rule.met, rule.applies, rule.unit.as_str()), (Some(false), true, "mm"));
        assert_eq!(of("sherard-dunnigan", &filter(0.999 * limit), &base(fines, d85)).met, Some(true));
    }
}

#[test]
fn foster_and_fell_no_erosion_by_hand_in_each_group() {
    // 1.6 ((35 - 25)/20 (4 x 0.6 - 0.7) + 0.7) = 1.6 x 1.55 = 2.48.
    for (fines, d85, limit) in
        [(90.0, 0.05, 0.45), (60.0, 0.5, 0.7), (35.0, 0.5, 0.7), (25.0, 0.6, 2.48), (5.0, 0.6, 4.2)]
    {
        let rule = of("foster-fell-no-erosion", &filter(0.4), &base(fines, d85));
        assert!(close(rule.limit, limit), "{fines} {d85}: {rule:?}");
        assert_eq!(rule.met, Some(true));
        assert_eq!(of("foster-fell-no-erosion", &filter(1.001 * limit), &base(fines, d85)).met, Some(false));
    }
}

#[test]
fn continuing_erosion_is_nine_d95_of_the_regraded_base() {
    // Straight from 85 % at 1 mm to 100 % at 4 mm: D95B = 4^(2/3); 9 D95B = 22.68.
    let soil = base(5.0, 1.0);
    let limit = 9.0 * 4.0f64.powf(2.0 / 3.0);
    for (d15f, met) in [(22.0, true), (23.0, false)] {
        let rule = of("foster-fell-continuing", &filter(d15f), &soil);
        assert!(close(rule.limit, limit) && rule.met == Some(met), "{rule:?}");
    }
    // With gravel the base is regraded: D95 of what passes No. 4, not of all.
    let gravelly = sieve(&[(0.01, 0.0), (0.075, 30.0), (1.0, 60.0), (4.75, 80.0), (50.0, 100.0)]);
    let d95 = 4.75f64.powf((76.0 - 60.0) / 20.0);
    let rule = of("foster-fell-continuing", &filter(1.0), &gravelly);
    assert!(close(rule.limit, 9.0 * d95) && rule.note.contains("no clear boundary"), "{rule:?}");
}

#[test]
fn terzaghi_is_for_few_fines_and_takes_the_regraded_base() {
    let rule = of("terzaghi", &filter(2.1), &base(5.0, 0.5));
    assert!(close(rule.value, 4.2) && rule.met == Some(false) && rule.unit.is_empty());
    let rule = of("terzaghi", &filter(2.1), &base(30.0, 0.5));
    assert!(!rule.applies && rule.met.is_none() && rule.note.contains("30 % of the base"));
}

#[test]
fn permeability_is_five_d15_of_the_base_as_it_is() {
    // D15B of the whole is 0.3 mm; of the part that passes No. 4 it is less.
    let soil = sieve(&[(0.1, 0.0), (0.3, 15.0), (1.0, 40.0), (4.75, 60.0), (40.0, 100.0)]);
    for (d15f, met) in [(1.49, false), (1.51, true)] {
        let rule = of("permeability", &filter(d15f), &soil);
        assert!(close(rule.limit, 1.5) && rule.at_least && rule.met == Some(met), "{rule:?}");
    }
    // Never less than 0.1 mm.
    let clay = sieve(&[(0.001, 0.0), (0.002, 15.0), (0.02, 100.0)]);
    assert!(close(of("permeability", &filter(0.09), &clay).limit, 0.1));
    // A till whose table ends at No. 200 with 35 %: at most 5 x 0.075 mm.
    let till = sieve(&[(0.075, 35.0), (1.0, 100.0)]);
    let rule = of("permeability", &filter(0.4), &till);
    assert!(rule.met == Some(true) && close(rule.limit, 0.375) && rule.note.contains("at most"));
    let rule = of("permeability", &filter(0.3), &till);
    assert!(rule.met.is_none() && rule.needs.contains("D15"));
}

#[test]
fn fines_and_cobbles_of_the_filter() {
    let dirty = sieve(&[(0.075, 6.0), (5.0, 60.0), (80.0, 100.0)]);
    let soil = base(5.0, 0.5);
    let fines = of("filter-fines", &dirty, &soil);
    assert!(close(fines.value, 6.0) && fines.met == Some(false) && fines.unit == "%");
    assert_eq!(of("filter-greatest-size", &dirty, &soil).met, Some(false));
    let clean = sieve(&[(0.3, 2.0), (5.0, 60.0), (75.0, 100.0)]);
    assert_eq!(of("filter-fines", &clean, &soil).met, Some(true));
    assert_eq!(of("filter-greatest-size", &clean, &soil).met, Some(true));
    let coarse_table = sieve(&[(0.3, 8.0), (5.0, 60.0), (75.0, 100.0)]);
    assert!(of("filter-fines", &coarse_table, &soil).needs.contains("finer sieves"));
}

/// The gap-graded filter of the first trial: 40 % below 0.5 mm, nothing to 5 mm. And one at which Kenney and
/// Lau look: 15 % below the gap.
#[test]
fn internal_stability_by_hand() {
    let soil = base(5.0, 0.5);
    let gap = sieve(&[(0.1, 0.0), (0.5, 40.0), (5.0, 40.0), (20.0, 100.0)]);
    // From F = 25 % the next 15 % end beyond the gap: 5 mm over D25 = 0.1 x 5^(25/40).
    let rule = of("kezdi", &gap, &soil);
    assert!(close(rule.value, 50.0 / 5.0f64.powf(0.625)) && rule.met == Some(false), "{rule:?}");
    assert!(rule.note.contains("at F = 25 %, judged from F = 15 to 55 %"), "{}", rule.note);
    let unstable = sieve(&[(0.1, 0.0), (0.2, 15.0), (4.0, 15.0), (20.0, 100.0)]);
    for (id, value) in [("kenney-lau", 0.0), ("li-fannin", 0.0)] {
        let rule = of(id, &unstable, &soil);
        assert!(close(rule.value, value) && rule.met == Some(false) && rule.note.contains("F = 15.0 %"));
    }
    // Straight with Cu 60: H = 50 ln 4 / ln 60 = 16.93 %, less than F = 20 % and more than 15 %.
    let broad = sieve(&[(0.1, 0.0), (360.0, 100.0)]);
    let h = 50.0 * 4.0f64.ln() / 60.0f64.ln();
    assert!(close(of("kenney-lau", &broad, &soil).value, h / 20.0));
    assert!(close(of("li-fannin", &broad, &soil).value, h / 15.0));
}

#[test]
fn a_linear_filter_is_an_assumption_and_has_no_stability() {
    let (filter, base) = (filter(1.0), base(5.0, 0.5));
    let inputs = RuleInputs { filter_is_measured: false, ..RuleInputs::of_soils(&filter, &base) };
    for rule in apply(&inputs).iter().filter(|rule| rule.role == RuleRole::Stability) {
        assert_eq!(
            (rule.value, rule.met, rule.needs.as_str()),
            (None, None, "needs the filter's sieve curve")
        );
    }
}

#[test]
fn sizes_without_a_unit_are_those_of_a_sand() {
    let filter = Gradation::linear_from_d0(1.0, 1.5).unwrap();
    let base = Gradation::linear_from_dx(85.0, 0.2, 1.5).unwrap();
    let inputs = RuleInputs {
        scale_free: true,
        base_soil: BaseSoil::of(&base, true),
        largest_eroded_over_d15f: Some(0.19),
        filter_is_measured: false,
        ..RuleInputs::of_soils(&filter, &base)
    };
    let all = apply(&inputs);
    let find = |id: &str| all.iter().find(|rule| rule.id == id).unwrap();
    let d15f = 1.5f64.powf(0.3);
    for (id, limit) in [("sherard-dunnigan", 0.8), ("foster-fell-no-erosion", 1.4)] {
        let rule = find(id);
        assert!(close(rule.limit, limit) && close(rule.value, d15f) && rule.unit == "D0F");
        assert!(rule.applies && rule.note.contains("sand without fines"));
    }
    assert_eq!(find("sherard-dunnigan").met, Some(false));
    let limits =
        ["terzaghi", "kenney-controlling", "paper-no-erosion", "paper-continuing"].map(|id| find(id).limit);
    assert_eq!(limits, [Some(4.0), Some(0.2), Some(5.0), Some(4.7)]);
    assert!(close(find("paper-no-erosion").value, d15f / 0.2));
}

#[test]
fn fines_that_are_not_known_are_asked_for() {
    let hidden = sieve(&[(0.3, 25.0), (1.0, 100.0)]);
    for id in ["sherard-dunnigan", "foster-fell-no-erosion"] {
        let rule = of(id, &filter(1.0), &hidden);
        assert!(rule.met.is_none() && rule.limit.is_none() && rule.needs.contains("fines"), "{rule:?}");
    }
}

/// No number of the boundary of excessive erosion was read: it has no result, and says so.
#[test]
fn a_boundary_without_a_source_has_no_result() {
    let rule = of("foster-fell-excessive", &filter(1.0), &base(5.0, 0.5));
    assert!(!rule.applies && rule.met.is_none() && rule.limit.is_none() && !rule.needs.is_empty());
}

#[test]
fn every_rule_says_what_it_is() {
    let ids: std::collections::BTreeSet<&str> = RULES.iter().map(|rule| rule.id).collect();
    assert_eq!(ids.len(), RULES.len());
    for rule in &RULES {
        assert!(
            !rule.source.is_empty() && !rule.applies_to.is_empty() && !rule.quantity.is_empty(),
            "{}",
            rule.id
        );
    }
}
