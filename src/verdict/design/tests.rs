//! Answers of designs, and what stands beside them.

use super::*;
use crate::gradation::Gradation;
use crate::outcome::design::Boundary;
use crate::outcome::design::band::Band;
use crate::verdict::washout::tests::{GRAVEL_0_32, REGRADED_TILL};
use crate::verdict::{PairRules, SpecificationOptions};

/// A design in which the walk holds to this D15F/D85B, `None` where it holds nothing, as its file has it.
fn design(base: &Gradation, held: Option<f64>) -> Design {
    let regraded = base.regraded();
    let d85 = regraded.gradation.d(85.0).unwrap();
    let filter = Gradation::linear_from_dx(15.0, 4.0 * d85, 1.5).unwrap();
    let no_erosion = held.and_then(|held| Boundary::of(&[Ok(held), Ok(held)], Some(d85)));
    let text = serde_json::json!({
        "version": "1", "inverse": false, "filter": "f", "filter_cu": 1.5, "filter_d15_mm": null,
        "unit": "mm",
        "base": {"name": "b", "cu": null, "d15_mm": null, "d85_mm": d85, "d95_over_d85": null,
                "tail_mass_fraction": 0.0},
        "threshold": 0.075, "replicates": 2, "seed": 1, "engine": "expected", "bracket": [0.5, 100.0],
            "step": 0.005,
        "rules": PairRules::of(base, &filter).rules,
        "rules_at": 4.0, "products": [], "model_leaves_out": [], "settings": [],
        "seconds": 1.0,
        "boundaries": [{"density": "loose", "thickness": "60 layers", "layers": 60, "thickness_mm": null,
            "grains_per_void": 0.6, "no_erosion": no_erosion, "continuing": null, "not_monotone": 0,
            "networks": [], "band": null}],
    });
    serde_json::from_value(text).unwrap()
}

fn till() -> Gradation {
    let points = [(0.001, 0.0), (0.075, 35.0), (0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)];
    Gradation::from_lines(&points).unwrap()
}

fn sand() -> Gradation {
    Gradation::from_lines(&[(0.1, 0.0), (0.5, 100.0)]).unwrap()
}

/// The till of the third trial: the walk holds it to 12.6 D85B, here 19.3 mm, and practice to 1.12 mm.
#[test]
fn a_till_is_limited_by_practice_and_the_walks_figure_stands_nowhere() {
    let found = design(&till(), Some(12.6));
    let answer = found.answer();
    assert!((answer.d15f_max_mm.unwrap() - 1.124).abs() < 1e-3, "{answer:?}");
    assert_eq!((answer.set_by, answer.rule.as_deref()), (SetBy::Practice, Some("sherard-dunnigan")));
    assert_eq!(answer.walk.as_deref(), Some("The walk sets no tighter limit, and is no check of it"));
    assert_eq!(answer.said, format!("{}. {}", answer.limit, answer.walk.as_ref().unwrap()));
    assert!(!serde_json::to_string(&answer).unwrap().contains("19."), "{answer:?}");
}

#[test]
fn a_walk_that_holds_less_than_practice_sets_the_answer() {
    let base = sand();
    let (d85, answer) = (base.d(85.0).unwrap(), design(&base, Some(3.0)).answer());
    assert!((answer.d15f_max_mm.unwrap() - 3.0 * d85).abs() < 1e-9);
    assert_eq!((answer.set_by, answer.rule), (SetBy::Walk, None));
    assert!(answer.said.contains("by the walk; practice allows D15F up to"), "{}", answer.said);
    let answer = design(&base, Some(7.0)).answer();
    assert!((answer.d15f_max_mm.unwrap() - 4.0 * d85).abs() < 1e-9);
    assert_eq!(answer.rule.as_deref(), Some("sherard-dunnigan"));
}

#[test]
fn what_neither_or_one_of_them_knows_is_said() {
    let nothing = design(&sand(), None).answer();
    assert_eq!((nothing.d15f_max_mm, nothing.set_by), (None, SetBy::Walk));
    // What programs read: null where nothing is known.
    let json = serde_json::to_value(&nothing).unwrap();
    assert!(json["d15f_max_mm"].is_null() && json["rule"].is_null() && json["set_by"] == "walk", "{json}");
    assert!(nothing.said.contains("practice alone allows D15F up to"), "{}", nothing.said);
    // The minimum D15F that was searched is above the limit of practice: 1.53 against 1.12 mm.
    let below = Design { bracket: [1.0, 100.0], ..design(&till(), None) }.answer();
    assert!(below.d15f_max_mm.is_none() && below.said.starts_with("Practice allows D15F up to 1.12 mm"));
    assert!(below.said.contains("searched from a D15F of 1.53 mm only"), "{}", below.said);
    // A third of the base may be anything: the walk says nothing against it.
    let mut open = design(&till(), None);
    open.base.tail_mass_fraction = 0.38;
    let answer = open.answer();
    assert!((answer.d15f_max_mm.unwrap() - 1.124).abs() < 1e-3, "{answer:?}");
    assert!(answer.said.contains("by practice alone") && answer.said.contains("38.0 %"), "{}", answer.said);
    let mut scale_free = design(&sand(), Some(5.2));
    (scale_free.base.d85_mm, scale_free.unit) = (None, "D85B".into());
    let answer = scale_free.answer();
    assert_eq!((answer.d15f_max_mm, answer.d15f_over_d85b), (None, Some(5.2)));
    assert!(answer.said.starts_with("D15F up to 5.20 D85B in the model alone"), "{}", answer.said);
    assert!(answer.said.contains("the limit of practice is not known"), "{}", answer.said);
    let mut unknown = design(&sand(), Some(5.2));
    unknown.rules.clear();
    assert!(unknown.answer().said.ends_with("the limit of practice is not known for this base"));
}

/// 30 % pass the finest sieve: with as many fines the limit would be less than half of four D85B.
#[test]
fn a_limit_that_is_at_most_some_size_is_no_known_limit() {
    let base =
        Gradation::from_points(&[(0.25, 30.0), (0.5, 45.0), (1.0, 60.0), (2.0, 90.0), (4.0, 100.0)], None);
    let base = base.unwrap();
    for held in [Some(3.0), None] {
        let mut open = design(&base, held);
        open.base.tail_mass_fraction = 0.3;
        let answer = open.answer();
        assert_eq!((answer.d15f_max_mm, answer.d15f_over_d85b, &answer.rule), (None, None, &None));
        assert!(answer.said.starts_with("The maximum D15F is not known: the limit of practice is at most 7"));
        assert_eq!(
            answer.said.contains("The walk alone holds D15F up to"),
            held.is_some(),
            "{}",
            answer.said
        );
        assert!(Band::new(&open.rules, 4.0, 4.0, "mm").is_none());
    }
}

/// A loose filter that erodes at all that was searched is not held by what a dense one holds.
#[test]
fn a_row_that_holds_nothing_leaves_the_walk_without_an_answer() {
    let mut two = design(&sand(), Some(3.0));
    two.boundaries.push(design(&sand(), None).boundaries.remove(0));
    let answer = two.answer();
    assert_eq!((answer.d15f_max_mm, answer.set_by), (None, SetBy::Walk));
    assert!(answer.said.contains("practice alone allows D15F up to"), "{}", answer.said);
    // Nor does an open tail leave the answer to practice, where another row says less than it allows.
    two.base.tail_mass_fraction = 0.08;
    assert_eq!(two.answer().d15f_max_mm, None);
}

#[test]
fn the_inverse_stops_at_the_base_that_practice_allows() {
    let mut inverse = design(&sand(), Some(7.0));
    (inverse.inverse, inverse.filter_d15_mm, inverse.base.d85_mm) = (true, Some(2.0), None);
    let rule = inverse.rules.iter().find(|rule| rule.id == "sherard-dunnigan").unwrap().clone();
    let finest = FinestBase { ratio: Some(4.0), rule, is_open: false, washout: None };
    let answer = design_answer(&inverse, Some(&finest));
    assert_eq!((answer.d85b_min_mm, answer.d15f_max_mm), (Some(0.5), None));
    assert!(answer.said.starts_with("D85B down to 0.500 mm, by practice"), "{}", answer.said);
    let none = design_answer(&inverse, Some(&FinestBase { ratio: None, ..finest.clone() }));
    assert!(none.d85b_min_mm.is_none() && none.said.starts_with("No base is known that both"));
    let open = |ratio| design_answer(&inverse, Some(&FinestBase { ratio, is_open: true, ..finest.clone() }));
    let unknown = open(None);
    assert_eq!((unknown.d85b_min_mm, unknown.d15f_over_d85b, &unknown.rule), (None, None, &None));
    assert!(
        unknown.said.starts_with("The finest D85B is not known: only an upper bound"),
        "{}",
        unknown.said
    );
    assert!(unknown.said.ends_with(". The walk alone holds D85B down to 0.286 mm"), "{}", unknown.said);
    assert_eq!(open(Some(4.0)).d85b_min_mm, Some(0.5));
    assert!(open(Some(4.0)).said.contains("whose limit for a finer base is not known"));
}

/// `judge` calls this gravel not met on this till: its D15F of 0.61 mm is 2.84 mm without its finest 19.4 %.
#[test]
fn a_filter_that_washes_out_is_said_to_be_beyond_the_limit_of_its_design() {
    let till = Gradation::from_lines(&REGRADED_TILL).unwrap();
    let gravel = |times: f64| {
        Gradation::from_lines(&GRAVEL_0_32.map(|(size, percent)| (times * size, percent))).unwrap()
    };
    let of = |times: f64| {
        let mut found = design(&till, Some(12.6));
        let d15f = gravel(times).d(15.0).unwrap();
        found.rules = PairRules::of(&till, &gravel(times)).rules;
        found.rules_at = d15f / found.base.d85_mm.unwrap();
        found
    };
    // As it is read at another size than the answer: 1.26 mm is 2.07 times 0.61 mm.
    for times in [1.0, 2.07, 3.0] {
        let answer = of(times).answer();
        assert_eq!(
            answer.washout.as_deref(),
            Some(
                "The filter as given is not internally stable: it has this D15F as placed, but 5.86 mm \
                 without its finest 19.4 %, which the filter may lose"
            )
        );
        assert!(answer.said.starts_with(&format!("{}. {}. The walk", answer.limit, answer.washout.unwrap())));
    }
    // Where the walk allows so little that what is left retains the base.
    let held = Design { boundaries: design(&till, Some(0.05)).boundaries, ..of(1.0) };
    assert_eq!((held.answer().set_by, held.answer().washout), (SetBy::Walk, None));
    assert_eq!(design(&till, Some(12.6)).answer().washout, None);
    // The finest base for this filter: what is left of it counts.
    let rules = of(1.0).rules;
    let finest = FinestBase::at(&rules, Some(0.2)).unwrap();
    assert_eq!((finest.rule.id.as_str(), finest.is_open), ("sherard-dunnigan", false));
    let inverse = Design { inverse: true, filter_d15_mm: Some(0.61), ..of(1.0) };
    let answer = design_answer(&inverse, Some(&finest));
    assert!((answer.d85b_min_mm.unwrap() - 0.61 / 0.2).abs() < 1e-9, "{answer:?}");
    assert_eq!(
        answer.washout.as_deref(),
        Some(
            "The filter as given is not internally stable: its D15F is 0.610 mm as placed, but 2.83 mm \
             without its finest 19.4 %, which the filter may lose, and the limit of practice allows for that"
        )
    );
    // Without a finer part that it may lose no rule is broken.
    assert_eq!(FinestBase::at(&design(&till, None).rules, Some(0.2)).map(|of| of.washout), Some(None));
    let fine = PairRules::of(&till, &gravel(0.2)).rules;
    assert_eq!(FinestBase::at(&fine, Some(0.2)), None);
}

/// With the specification of its base.
fn specified(base: &Gradation, held: Option<f64>) -> Design {
    let of = Specification::of("b", &[("b".into(), base.clone())], SpecificationOptions::default());
    Design { specification: Some(of), ..design(base, held) }
}

/// 1.12 mm lies in the range of the boundary of no erosion in tests of bases with 35 to 85 % fines.
#[test]
fn an_answer_has_its_parts_and_their_text() {
    let answer = specified(&till(), Some(12.6)).answer();
    let margin = answer.margin.as_deref().unwrap();
    assert_eq!(
        margin,
        "This limit has no margin: it lies in the range in which tests put the boundary of no erosion (0.700 \
         to 1.70 mm; Fell et al., Table 9.2)"
    );
    let dispersive = answer.if_dispersive.as_deref().unwrap();
    assert!(dispersive.contains(". Design again for a dispersive base, and have"), "{dispersive}");
    let walk = answer.walk.as_deref().unwrap();
    assert_eq!(answer.said, [answer.limit.as_str(), margin, walk, dispersive].join(". "));
    // 4 D85B of a clean sand lies below what tests showed.
    let sand = specified(&sand(), Some(7.0)).answer();
    assert_eq!((sand.margin, sand.if_dispersive), (None, None));
}
