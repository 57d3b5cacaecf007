//! What a page says of the walk: where it can be relied on, and what it was made with.

use voidwalk::Gradation;
use voidwalk::outcome::record::{Outcome, Verdict};
use voidwalk::practice::Note;
use voidwalk::practice::PairRules;
use voidwalk::practice::quantity::SizeUnit;

use super::folder::Plan;
use super::{made, words};

#[test]
fn a_void_ratio_that_nobody_gave_is_said_to_be_of_the_library() {
    let said = |note: Note| {
        let mut plan = Plan::usual();
        plan.outcome.inputs.filter.void_ratio = Some(0.553);
        plan.outcome.notes = vec![note];
        words(&made(&plan).0)
    };
    let other = "not given; 0.553 is that of the packing of the library";
    assert!(said(Note::LibraryOfAnyDensity { error_percent: 10.0, grains_percent: 25.0 }).contains(other));
    let given = said(Note::FewReplicates { replicates: 3 });
    assert!(given.contains("0.553") && !given.contains(other));
}

/// What is finer than the finest sieve has no sizes: of what left the filter no curve can show it.
#[test]
fn the_figure_of_what_left_says_what_only_the_curve_of_the_base_has() {
    let said = |finest: f64| {
        let mut plan = Plan::usual();
        plan.outcome.inputs.base.gradation[0][1] = finest;
        words(&made(&plan).0)
    };
    let only = " The base's curve alone has the 12.5 % of it that is finer than its finest sieve.";
    assert!(said(12.5).contains(only));
    assert!(!said(0.0).contains("The base's curve alone"));
}

fn next_step(outcome: &Outcome) -> String {
    voidwalk::words::next(outcome, &outcome.decision(), SizeUnit::Mm)
}

/// A filter that may segregate is mended; cobbles are no fault of a drain, and of a good pair nothing is asked.
#[test]
fn what_is_next_is_one_thing_that_is_wrong_with_this_pair() {
    let soil = |points: &[(f64, f64)]| Gradation::from_lines(points).unwrap();
    let base = soil(&[(0.075, 20.0), (0.2, 50.0), (0.6, 100.0)]);
    let next = |filter: &[(f64, f64)]| {
        let mut outcome = Plan::usual().outcome;
        outcome.rules = PairRules::of(&base, &soil(filter)).rules;
        outcome.notes.clear();
        outcome.model.class = Verdict::None;
        next_step(&outcome)
    };
    assert_eq!(next(&[(0.5, 0.0), (1.5, 100.0)]), "nothing by these rules");
    let wide = next(&[(0.5, 0.0), (0.8, 15.0), (1.8, 30.0), (4.0, 50.0), (9.0, 65.0), (20.0, 100.0)]);
    assert_eq!(wide, "narrow the filter's range of sizes, or specify how it is placed");
    let cobbles = next(&[(0.5, 0.0), (0.8, 15.0), (3.0, 99.0), (100.0, 100.0)]);
    assert_eq!(cobbles, "take out the grains coarser than 75 mm");
    let bedding = soil(&[(5.0, 0.0), (20.0, 100.0)]);
    let rockfill = PairRules::of(&bedding, &soil(&[(30.0, 0.0), (60.0, 15.0), (150.0, 100.0)])).rules;
    let mut outcome = Plan::usual().outcome;
    outcome.rules = rockfill;
    outcome.model.class = Verdict::None;
    outcome.inputs.scale_free = false;
    outcome.inputs.filter.d15_mm = 60.0;
    outcome.notes.clear();
    assert_eq!(next_step(&outcome), "nothing by these rules");
}
