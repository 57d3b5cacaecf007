//! What the rules of filter practice say of a pair: where the filter stands by all of them, and notes.

use super::rule_result::{has_no_margin, met_of};
use super::tested::{is_beyond_tests, tested};
use super::washout::washout;
use crate::outcome::design::retention::retaining;
use crate::outcome::record::{
    AppliedRule, Headline, Note, Practice, PracticeClass, RuleNote, RuleQuantity, RuleRole, TestedClass,
    Verdict, d15f_between,
};
use crate::outcome::rules::{DESIGN, PERMEABILITY, TESTS_CONTINUING, TESTS_NO_EROSION, authority};

/// The rules of a role that were made for these soils and are not kept.
pub fn broken(rules: &[AppliedRule], role: RuleRole) -> Vec<&AppliedRule> {
    match role {
        RuleRole::Retention => retaining(rules).filter(|rule| rule.is_broken()).collect(),
        _ => rules.iter().filter(|rule| rule.is_broken() && rule.role == role).collect(),
    }
}

/// Notes on rules of stability, drainage and placing that are not kept, and on a limit without a margin.
/// Rules of retention stand in the line of practice.
pub fn notes(rules: &[AppliedRule]) -> Vec<Note> {
    let [unstable, undrained, placing] =
        [RuleRole::Stability, RuleRole::Drainage, RuleRole::Placing].map(|role| broken(rules, role));
    let limit = |of_size: bool| {
        let is_wanted = |rule: &&&AppliedRule| (rule.quantity == RuleQuantity::D15F) == of_size;
        undrained.iter().find(is_wanted).and_then(|rule| rule.limit)
    };
    let authorities = unstable.iter().map(|rule| authority(rule).to_owned()).collect();
    let quantities = placing.iter().map(|rule| rule.quantity.name().to_owned()).collect();
    [
        (!unstable.is_empty()).then_some(Note::LosesFines { authorities }),
        limit(true).map(|least_d15f_mm| Note::TooFineToDrain { least_d15f_mm }),
        limit(false).map(|most_fines_percent| Note::FinesOfFilter { most_fines_percent }),
        (!placing.is_empty()).then_some(Note::MaySegregate { quantities }),
        limit_without_margin(rules).map(|most_d15f_mm| Note::LimitWithoutMargin { most_d15f_mm }),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// A limit of design (mm) that is not broken and has no margin.
fn limit_without_margin(rules: &[AppliedRule]) -> Option<f64> {
    let design = rules.iter().find(|rule| rule.id == DESIGN && rule.applies)?;
    design.limit.filter(|_| design.met != Some(false) && has_no_margin(rules))
}

/// What practice says of a pair, for programs; `None` where no rule of design was applied.
pub fn record(rules: &[AppliedRule], range_of_tests_mm: Option<[f64; 2]>) -> Option<Practice> {
    let design = rules.iter().find(|rule| rule.id == DESIGN && rule.applies)?;
    Some(Practice {
        class: standing(rules).class(),
        d15f_mm: d15f_between(&design.needs).or(design.value.map(|d15f| [d15f, d15f])),
        limit_mm: design.limit,
        limit_at_most: design.limit_at_most,
        tests: tested(rules),
        range_of_tests_mm,
    })
}

/// The answer of practice, which is on the condition that the base is not dispersive where it would not hold
/// such a base; `None` where no rule of design was applied.
pub fn headline(rules: &[AppliedRule], breaks_if_dispersive: bool) -> Option<Headline> {
    let breaks = |role| !broken(rules, role).is_empty();
    Some(match standing(rules) {
        Standing::NoRules => return None,
        Standing::Fails => Headline::DoesNotMeet,
        Standing::WashedOut => Headline::TooCoarseWithoutFiner,
        Standing::NoMargin => Headline::BeyondDesign,
        Standing::Unstable => Headline::MayLoseFiner,
        Standing::Unknown(_) => Headline::TestMissing,
        Standing::Open(_) => Headline::SievesMissing,
        Standing::Met if breaks_if_dispersive => Headline::MeetsUnlessDispersive,
        Standing::Met if breaks(RuleRole::Drainage) => Headline::MayNotDrain,
        Standing::Met if breaks(RuleRole::Placing) => Headline::MaySegregate,
        Standing::Met if is_drainage_unknown(rules) => Headline::DrainageNotKnown,
        Standing::Met => Headline::Meets,
    })
}

/// Whether the rule of drainage has no result.
pub fn is_drainage_unknown(rules: &[AppliedRule]) -> bool {
    rules.iter().any(|rule| rule.id == PERMEABILITY && rule.applies && rule.met.is_none())
}

/// Where a filter stands by practice, the worst first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Standing {
    /// A rule of retention or of coarser filters is not kept, and no test held either.
    Fails,
    /// No test speaks against it as placed, and it breaks a limit without the finer part that it may lose.
    WashedOut,
    /// The limit of design is not kept, but such a filter is within the boundary of no erosion of tests.
    NoMargin,
    /// It keeps the limits, but may lose its own fines.
    Unstable,
    /// The limit of design has no result: what is missing.
    Unknown(Option<RuleNote>),
    /// A result depends on sizes between two sieves that stand far apart.
    Open(RuleNote),
    /// The limit of design is kept.
    Met,
    /// No rule of design was applied.
    NoRules,
}

impl Standing {
    /// Whether practice is met.
    pub fn class(&self) -> PracticeClass {
        match self {
            Self::Fails | Self::WashedOut | Self::NoMargin => PracticeClass::DoesNotMeet,
            Self::Unstable | Self::Unknown(_) | Self::Open(_) | Self::NoRules => PracticeClass::NotKnown,
            Self::Met => PracticeClass::Meets,
        }
    }
}

/// The sizes between two sieves that stand far apart, on which the limit of design or the stability of the
/// filter depends.
pub fn open_sieves(rules: &[AppliedRule]) -> Option<RuleNote> {
    let counts = |rule: &&AppliedRule| {
        [DESIGN, TESTS_CONTINUING].contains(&&*rule.id) || rule.role == RuleRole::Stability
    };
    let open = rules.iter().filter(counts).filter(|rule| rule.applies && rule.met.is_none());
    open.flat_map(|rule| &rule.needs).copied().find(|need| need.sieves_between().is_some())
}

/// Where the filter of a pair stands.
pub fn standing(rules: &[AppliedRule]) -> Standing {
    let Some(design) = rules.iter().find(|rule| rule.id == DESIGN && rule.applies) else {
        return Standing::NoRules;
    };
    let mut retention = broken(rules, RuleRole::Retention);
    if met_of(rules, TESTS_NO_EROSION) == Some(true) {
        // Beyond the limit of design alone, of which Terzaghi's ratio is that of a sand.
        retention.retain(|rule| ![DESIGN, "terzaghi"].contains(&&*rule.id));
    }
    let fails = !retention.is_empty() || !broken(rules, RuleRole::Continuation).is_empty();
    let open = open_sieves(rules);
    match (design.met, open) {
        _ if fails => Standing::Fails,
        _ if washout(rules).is_some() => Standing::WashedOut,
        (Some(false), _) => Standing::NoMargin,
        (_, Some(sieves)) => Standing::Open(sieves),
        _ if !broken(rules, RuleRole::Stability).is_empty() => Standing::Unstable,
        (Some(true), None) => Standing::Met,
        (None, None) => Standing::Unknown(design.needs.first().copied()),
    }
}

/// The class as which practice counts where verdicts are accepted or not, the worst that nobody excludes;
/// `None` where no rule was applied.
pub fn counts_as(rules: &[AppliedRule]) -> Option<Verdict> {
    let coarse = match tested(rules) {
        TestedClass::Continuing => Verdict::Continuing,
        TestedClass::Unknown if is_beyond_tests(rules) => Verdict::Undecided,
        _ => Verdict::Some,
    };
    match standing(rules) {
        Standing::NoRules => None,
        Standing::Met => Some(Verdict::None),
        Standing::Unknown(_) | Standing::Open(_) => Some(Verdict::Undecided),
        Standing::NoMargin | Standing::Unstable => Some(Verdict::Some),
        Standing::WashedOut if washout(rules).is_some_and(|of| of.continues()) => Some(Verdict::Continuing),
        Standing::Fails | Standing::WashedOut => Some(coarse),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::outcome::rules::NamedCurve;
    use crate::verdict::{BatchRow, PairOptions, PairRules};

    fn soil(points: &[(f64, f64)]) -> Vec<NamedCurve> {
        vec![("soil".to_owned(), Gradation::from_lines(points).unwrap())]
    }

    fn filter(d15f: f64) -> Vec<NamedCurve> {
        soil(&[(0.9 * d15f, 0.0), (d15f, 15.0), (2.0 * d15f, 100.0)])
    }

    /// A fat clay with a D85B of 0.0185 mm, and 37 % fines with a D85B of 1.40 mm.
    const CLAY: [(f64, f64); 6] =
        [(0.002, 52.0), (0.005, 66.0), (0.01, 77.0), (0.02, 86.0), (0.04, 93.0), (0.425, 100.0)];
    const SILTY: [(f64, f64); 6] =
        [(0.005, 13.0), (0.075, 37.0), (0.25, 60.0), (0.85, 78.0), (2.0, 90.0), (4.75, 100.0)];

    /// Sherard and Dunnigan allow 0.2 and 1.28 mm, Foster and Fell 0.166 and 0.7 mm.
    #[test]
    fn practice_goes_by_design_where_tests_are_stricter() {
        for (base, d15f, [design, tests]) in [(&CLAY, 0.178, [0.2, 0.166]), (&SILTY, 0.85, [1.28, 0.7])] {
            let options = PairOptions { dispersive: false, ..PairOptions::default() };
            let rules = PairRules::of_envelopes(&soil(base), &filter(d15f), options).rules;
            assert_eq!((met_of(&rules, DESIGN), met_of(&rules, TESTS_NO_EROSION)), (Some(true), Some(false)));
            assert_eq!(standing(&rules), Standing::Met);
            assert_eq!(counts_as(&rules), Some(Verdict::None));
            assert!(matches!(notes(&rules)[..], [Note::LimitWithoutMargin { .. }]));
            for (id, wanted) in [(DESIGN, design), (TESTS_NO_EROSION, tests)] {
                let limit = rules.iter().find(|rule| rule.id == id).and_then(|rule| rule.limit).unwrap();
                assert!((limit / wanted - 1.0).abs() < 0.01, "{id} {limit}");
            }
            let sample = crate::gradation::SoilSample {
                name: "s".into(),
                path: "s".into(),
                curve: soil(base).remove(0).1,
            };
            assert_eq!(BatchRow::of(&sample, ("F", &filter(d15f)), options).met, Some(true));
            // Beyond the limit of design it is not met.
            let coarse = PairRules::of_envelopes(&soil(base), &filter(2.0 * d15f), options).rules;
            assert_eq!(record(&coarse, None).unwrap().class, PracticeClass::DoesNotMeet);
        }
    }

    #[test]
    fn a_record_and_what_is_accepted_follow_where_the_filter_stands() {
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
            let rules = PairRules::of_envelopes(base, &filter, PairOptions::default()).rules;
            assert_eq!((record(&rules, None).unwrap().class, counts_as(&rules)), (class, Some(counts)));
        }
        assert_eq!(counts_as(&[]), None);
    }
}
