//! Practice beside the model for a command that accepts a verdict or not (`--fail-on`).

use voidwalk_practice::decision::Standing;
use voidwalk_practice::{Decision, TestedClass};

use crate::outcome::record::Verdict;

/// The class by which practice counts when verdicts are accepted or not, the worst that nobody excludes;
/// `None` if no rule of design was applied.
pub fn counts_as(decision: &Decision) -> Option<Verdict> {
    let coarse = match decision.tests {
        TestedClass::Continuing => Verdict::Continuing,
        TestedClass::Unknown if decision.is_beyond_tests => Verdict::Undecided,
        _ => Verdict::Some,
    };
    match decision.standing {
        Standing::NoRules => None,
        Standing::Met => Some(Verdict::None),
        Standing::Unknown(_) | Standing::Open(_) => Some(Verdict::Undecided),
        Standing::NoMargin | Standing::Unstable => Some(Verdict::Some),
        Standing::WashedOut if decision.washout.as_ref().is_some_and(|washout| washout.continues) => {
            Some(Verdict::Continuing)
        }
        Standing::Fails | Standing::WashedOut => Some(coarse),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_soils::{filter, soil};
    use voidwalk_practice::{PairOptions, PairRules, PracticeClass};

    #[test]
    fn what_is_accepted_follows_where_the_filter_stands() {
        let sand = soil(&[(0.2, 0.0), (0.6, 100.0)]);
        let hidden = soil(&[(0.3, 25.0), (1.0, 100.0)]);
        let gap = [(0.3, 0.0), (0.36, 15.0), (2.4, 15.0), (6.0, 100.0)];
        let halved = gap.map(|(size, percent)| (0.5 * size, percent));
        for (base, filter, class, counts) in [
            (&sand, filter(1.0), PracticeClass::Meets, Verdict::None),
            (&sand, filter(2.5), PracticeClass::DoesNotMeet, Verdict::Some),
            (&sand, filter(4.0), PracticeClass::DoesNotMeet, Verdict::Some),
            (&sand, filter(6.0), PracticeClass::DoesNotMeet, Verdict::Continuing),
            (&sand, soil(&halved), PracticeClass::NotKnown, Verdict::Some),
            (&hidden, filter(1.0), PracticeClass::NotKnown, Verdict::Undecided),
        ] {
            let pair = PairRules::of_envelopes(base, &filter, PairOptions::default());
            let recorded = pair.practice.as_ref().unwrap().class;
            assert_eq!((recorded, counts_as(&pair.decision())), (class, Some(counts)));
        }
        assert_eq!(counts_as(&Decision::new(&[], None, None)), None);
    }
}
