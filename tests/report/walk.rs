//! What a page says of the walk: where it can be relied on, and what it was made with.

use voidwalk::Gradation;
use voidwalk::outcome::record::{
    Classed, Confidence, Direction, FindingRecord, Outcome, PanBounds, PanReading, PanSize, RuleQuantity,
    RuleRole, Statistic, Verdict,
};
use voidwalk::verdict::PairRules;

use super::folder::Plan;
use super::{made, words};

/// What the walk is worth stands beside its class, on the first page.
#[test]
fn the_line_of_the_walk_says_where_it_cannot_be_relied_on() {
    let walk = |change: &dyn Fn(&mut Outcome)| {
        let mut plan = Plan::usual();
        plan.outcome.verdict = Verdict::None;
        change(&mut plan.outcome);
        plan.outcome.walk_in_words()
    };
    let said = walk(&|_| ());
    for doubt in ["open path", "beyond the boundary", "unsafe side"] {
        assert!(!said.contains(doubt), "{doubt}: {said}");
    }
    let closed = walk(&|outcome| {
        outcome.replicates.iter_mut().skip(1).for_each(|of| of.runs[1].backbone_fraction = 0.0);
    });
    let of = Plan::usual().outcome.replicates.len();
    let closed_in = of - 1;
    let said = format!(
        ". No open path for base particles is left in {closed_in} of {of} networks after the second run; this \
         says nothing of the filter's drainage"
    );
    assert!(closed.ends_with(&said), "{closed}");
    // Readings of the base's finest part were walked with the curve itself.
    let read = walk(&|outcome| {
        let first = |high| Statistic { mean: 0.105, sd: None, low: Some(0.091), high: Some(high) };
        let runs = vec![first(0.118)];
        let walked = Classed { replicates: 10, stopped_when_clear: false, verdict: Verdict::Some, runs };
        let reading = PanReading { taken_as: PanSize::Passive, n_base: 100, walked, stopping: None };
        outcome.summary[0].eroded_mass_fraction = first(0.11);
        outcome.curve_range = None;
        outcome.pan_bounds = Some(PanBounds {
            mass_fraction: 0.4,
            finest_sieve_mm: 0.075,
            finest_constriction_mm: 0.0121,
            readings: vec![reading],
        });
    });
    let said = ", and up to 11.8 % in the first run over the readings of the base's finest part";
    assert!(read.contains(said), "{read}");
    let beyond = walk(&|outcome| {
        let rule = &mut outcome.rules[0];
        (rule.id, rule.unit, rule.at_least) = ("paper-no-erosion".into(), String::new(), false);
        (rule.met, rule.value, rule.limit) = (Some(false), Some(5.58), Some(5.0));
    });
    let said = "; beyond the boundary of no erosion of the network with which the model was published \
                (Shire & O'Sullivan: D15F/D85B 5.58 > 5.00)";
    assert!(beyond.contains(said), "{beyond}");
    let finding = |verdict: Verdict| {
        walk(&|outcome| {
            outcome.verdict = verdict;
            outcome.findings = vec![FindingRecord {
                id: "evidence_unsafe".into(),
                direction: Direction::Unsafe,
                ..FindingRecord::of_earlier("For filters like this the walk errs on the unsafe side.")
            }];
        })
    };
    let said = "; the walk errs on the unsafe side for this pair";
    assert!(finding(Verdict::None).contains(said) && finding(Verdict::Some).contains(said));
    assert!(!finding(Verdict::Continuing).contains(said));
}

/// The class that another amount of base gives stands in the headline, and in no other words.
#[test]
fn a_walk_whose_class_follows_from_the_amount_of_base_does_not_agree() {
    let mut plan = Plan::usual();
    let outcome = &mut plan.outcome;
    (outcome.verdict, outcome.confidence) = (Verdict::None, Confidence::Outside);
    let rule = &mut outcome.rules[0];
    (rule.id, rule.role) = ("sherard-dunnigan".into(), RuleRole::Retention);
    (rule.quantity, rule.applies, rule.met) = (RuleQuantity::D15F, true, Some(true));
    outcome.rules.truncate(1);
    for row in &mut outcome.sensitivity {
        row.walked.verdict = if row.factor < 0.5 { Verdict::Some } else { Verdict::None };
    }
    assert_eq!(
        outcome.headline(),
        "holds by practice; the walk: no erosion with base of 5 % of the filter's mass, some erosion with \
         1.25 %"
    );
    outcome.sensitivity.clear();
    assert_eq!(
        outcome.headline(),
        "holds by practice; no erosion in the walk, outside the range in which it was checked"
    );
}

fn found(id: &str) -> FindingRecord {
    FindingRecord { id: id.into(), ..FindingRecord::of_earlier("Found.") }
}

/// Half of the grains by number are finer than 0.09 mm: 0.5 x ln(0.09 / 0.075) / ln(0.1 / 0.075) = 0.317 % of
/// the filter's mass, whatever is finer than the finest sieve.
#[test]
fn openings_that_little_of_the_filter_sets_are_said_where_practice_contradicts_the_walk() {
    let said = |pan: f64, d50_by_number_mm: f64, id: &str| {
        let mut outcome = Plan::usual().outcome;
        outcome.confidence = Confidence::Contradicted;
        outcome.findings = vec![found(id)];
        let filter = &mut outcome.inputs.filter;
        filter.gradation = vec![[0.075, pan], [0.1, pan + 0.5], [4.0, pan + 2.0], [20.0, 100.0]];
        filter.d50_by_number_mm = d50_by_number_mm;
        outcome.walk_in_words()
    };
    let part =
        " (half of the filter's grains by number, which set the openings walked, are 0.32 % of its mass)";
    for pan in [0.0, 10.0] {
        let text = said(pan, 0.09, "guessed_constrictions");
        assert!(text.contains(part), "{text}");
        assert!(!said(pan, 10.0, "guessed_constrictions").contains("half of the filter's grains"));
    }
    // Of openings that were measured nothing is said.
    assert!(!said(0.0, 0.09, "few_replicates").contains("half of the filter's grains"));
}

#[test]
fn a_void_ratio_that_nobody_gave_is_said_to_be_of_the_library() {
    let said = |id: &str| {
        let mut plan = Plan::usual();
        plan.outcome.inputs.filter.void_ratio = Some(0.553);
        plan.outcome.findings = vec![found(id)];
        words(&made(&plan).0)
    };
    let other = "not given; 0.553 is that of the packing of the library";
    assert!(said("library_of_any_density").contains(other));
    let given = said("few_replicates");
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

/// A filter that may segregate is mended; cobbles are no fault of a drain, and of a good pair nothing is asked.
#[test]
fn what_is_next_is_one_thing_that_is_wrong_with_this_pair() {
    let soil = |points: &[(f64, f64)]| Gradation::from_lines(points).unwrap();
    let base = soil(&[(0.075, 20.0), (0.2, 50.0), (0.6, 100.0)]);
    let next = |filter: &[(f64, f64)]| {
        let mut outcome = Plan::usual().outcome;
        (outcome.verdict, outcome.confidence) = (Verdict::None, Confidence::Outside);
        outcome.rules = PairRules::of(&base, &soil(filter)).rules;
        outcome.findings.clear();
        outcome.next_in_words()
    };
    assert_eq!(next(&[(0.5, 0.0), (1.5, 100.0)]), "nothing by these rules");
    let wide = next(&[(0.5, 0.0), (0.8, 15.0), (1.8, 30.0), (4.0, 50.0), (9.0, 65.0), (20.0, 100.0)]);
    assert_eq!(wide, "narrow the filter's range of sizes, or specify how it is placed");
    let cobbles = next(&[(0.5, 0.0), (0.8, 15.0), (3.0, 99.0), (100.0, 100.0)]);
    assert_eq!(cobbles, "take out the grains coarser than 75 mm");
    let bedding = soil(&[(5.0, 0.0), (20.0, 100.0)]);
    let rockfill = PairRules::of(&bedding, &soil(&[(30.0, 0.0), (60.0, 15.0), (150.0, 100.0)])).rules;
    let mut outcome = Plan::usual().outcome;
    (outcome.verdict, outcome.rules) = (Verdict::None, rockfill);
    outcome.inputs.scale_free = false;
    outcome.inputs.filter.d15_mm = 60.0;
    outcome.findings.clear();
    assert_eq!(outcome.next_in_words(), "nothing by these rules");
}
