//! Decision of filter practice on a pair, made once from its rules for records, notes and every face.

use crate::applied::d15f_between;
use crate::dispersion::BeyondDispersive;
use crate::retention::{Washout, open_retention, retaining, retention, washout};
use crate::rule_result::{has_no_margin, listed, met_of, without_margin};
use crate::rules::{DESIGN, PERMEABILITY, TESTS_CONTINUING, TESTS_NO_EROSION, authority};
use crate::{AppliedRule, IfDispersive, Note, RuleNote, RuleQuantity, RuleRole};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// All decisions of practice on a pair.
#[derive(Clone, Debug, PartialEq)]
pub struct Decision {
    /// Every rule.
    pub rules: Vec<AppliedRule>,
    /// D15F in the unit of the rules, or 1 if it is not known.
    d15f: f64,
    /// Standing of the filter.
    pub standing: Standing,
    /// Headline. It assumes a base that is not dispersive if the filter would not hold a dispersive one;
    /// `None` if no rule of design was applied.
    pub headline: Option<Headline>,
    /// Class by the boundaries of Foster and Fell.
    pub tests: TestedClass,
    /// True if the filter is coarser than any for which tests found no erosion.
    pub is_beyond_tests: bool,
    /// True if the filter is beyond a boundary of continuing erosion that tests leave unclear.
    pub is_beyond_unclear: bool,
    /// Remainder of a filter that is too coarse without its finer part.
    pub washout: Option<Washout>,
    /// True if a limit of retention is only an upper bound, so that the strictest limit is not known.
    pub is_strictest_open: bool,
    /// Limit of D15F for a dispersive base, if dispersion is not stated.
    pub if_dispersive: Option<IfDispersive>,
    /// D15F that breaks this limit, if the filter keeps the others.
    pub beyond_dispersive: Option<BeyondDispersive>,
    /// Openings of two widely spaced sieves that decide the limit of design or the stability of the filter.
    pub(crate) open_sieves: Option<RuleNote>,
    /// True if the rule of drainage has no result.
    pub is_drainage_unknown: bool,
}

/// Standing of a filter by practice, worst first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Standing {
    /// A rule of retention or of continuing erosion is not kept, and tests do not excuse it.
    Fails,
    /// The filter as placed does not fail, but it breaks a limit without the finer part that it may lose.
    WashedOut,
    /// The limit of design is not kept, but the filter is within the tests' boundary of no erosion.
    NoMargin,
    /// The limits are kept, but the filter may lose its own fines.
    Unstable,
    /// The limit of design has no result because this input is missing.
    Unknown(Option<RuleNote>),
    /// A result depends on sizes between two widely spaced sieves.
    Open(RuleNote),
    /// The limit of design is kept.
    Met,
    /// No rule of design was applied.
    NoRules,
}

impl Standing {
    pub(crate) fn class(&self) -> PracticeClass {
        match self {
            Self::Fails | Self::WashedOut | Self::NoMargin => PracticeClass::DoesNotMeet,
            Self::Unstable | Self::Unknown(_) | Self::Open(_) | Self::NoRules => PracticeClass::NotKnown,
            Self::Met => PracticeClass::Meets,
        }
    }
}

impl Decision {
    /// Decides from the rules of a pair, the limit if the base may be dispersive, and D15F (mm; `None` if
    /// it is finer than the finest sieve).
    pub fn new(rules: &[AppliedRule], if_dispersive: Option<IfDispersive>, d15f_mm: Option<f64>) -> Self {
        let [no_erosion, continuing] = [TESTS_NO_EROSION, TESTS_CONTINUING].map(|id| met_of(rules, id));
        let is_unclear = |rule: &AppliedRule| {
            rule.id == TESTS_CONTINUING && rule.notes.contains(&RuleNote::BeyondUnclearBoundary)
        };
        let is_open_drainage =
            |rule: &AppliedRule| rule.id == PERMEABILITY && rule.applies && rule.met.is_none();
        let mut decision = Self {
            rules: rules.to_vec(),
            // Without a known D15F the limits are still in mm.
            d15f: d15f_mm.unwrap_or(1.0),
            standing: Standing::NoRules,
            headline: None,
            tests: match (no_erosion, continuing) {
                (_, Some(false)) => TestedClass::Continuing,
                (Some(true), _) => TestedClass::None,
                // At least some erosion: no text that was read gives the boundary of excessive erosion.
                (Some(false), Some(true)) => TestedClass::Some,
                _ => TestedClass::Unknown,
            },
            is_beyond_tests: no_erosion == Some(false),
            is_beyond_unclear: rules.iter().any(is_unclear),
            washout: washout(rules),
            is_strictest_open: open_retention(rules).is_some(),
            if_dispersive,
            beyond_dispersive: if_dispersive.and_then(|limit| limit.broken_by(rules, d15f_mm)),
            open_sieves: open_sieves(rules),
            is_drainage_unknown: rules.iter().any(is_open_drainage),
        };
        decision.standing = decision.stand();
        decision.headline = decision.answer();
        decision
    }

    /// Returns the rule with this id if it was made for these soils.
    pub fn applied(&self, id: &str) -> Option<&AppliedRule> {
        self.rules.iter().find(|rule| rule.id == id && rule.applies)
    }

    /// Rules as a sheet lists them.
    pub fn listed(&self) -> Vec<Cow<'_, AppliedRule>> {
        listed(&self.rules)
    }

    /// Limit of design of a dispersive base, if the boundary of no erosion is the same number.
    pub fn without_margin(&self) -> Option<&AppliedRule> {
        without_margin(&self.rules)
    }

    /// Strictest rule of retention with its limit of D15F, in the unit of the rules.
    pub fn strictest(&self) -> Option<(&AppliedRule, f64)> {
        retention(&self.rules, self.d15f)
    }

    /// Rules of a role that apply to these soils and are not kept. Among rules of retention, only those
    /// that practice uses count.
    pub fn broken(&self, role: RuleRole) -> impl Iterator<Item = &AppliedRule> {
        let others = self.rules.iter().filter(|rule| rule.role != RuleRole::Retention);
        let broken = retaining(&self.rules).chain(others).filter(|rule| rule.is_broken());
        broken.filter(move |rule| rule.role == role)
    }

    /// True if a rule of a role is not kept.
    pub fn breaks(&self, role: RuleRole) -> bool {
        self.broken(role).next().is_some()
    }

    fn stand(&self) -> Standing {
        let Some(design) = self.applied(DESIGN) else { return Standing::NoRules };
        // A filter within the tests' boundary may break design alone; for a sand, design is Terzaghi's ratio.
        let is_within_tests = met_of(&self.rules, TESTS_NO_EROSION) == Some(true);
        let is_excused = |rule: &AppliedRule| is_within_tests && [DESIGN, "terzaghi"].contains(&&*rule.id);
        let fails = self.broken(RuleRole::Retention).any(|rule| !is_excused(rule));
        match (design.met, self.open_sieves) {
            _ if fails || self.breaks(RuleRole::Continuation) => Standing::Fails,
            _ if self.washout.is_some() => Standing::WashedOut,
            (Some(false), _) => Standing::NoMargin,
            (_, Some(sieves)) => Standing::Open(sieves),
            _ if self.breaks(RuleRole::Stability) => Standing::Unstable,
            (Some(true), None) => Standing::Met,
            (None, None) => Standing::Unknown(design.needs.first().copied()),
        }
    }

    fn answer(&self) -> Option<Headline> {
        Some(match self.standing {
            Standing::NoRules => return None,
            Standing::Fails => Headline::DoesNotMeet,
            Standing::WashedOut => Headline::TooCoarseWithoutFiner,
            Standing::NoMargin => Headline::BeyondDesign,
            Standing::Unstable => Headline::MayLoseFiner,
            Standing::Unknown(_) => Headline::TestMissing,
            Standing::Open(_) => Headline::SievesMissing,
            Standing::Met if self.beyond_dispersive.is_some() => Headline::MeetsUnlessDispersive,
            Standing::Met if self.breaks(RuleRole::Drainage) => Headline::MayNotDrain,
            Standing::Met if self.breaks(RuleRole::Placing) => Headline::MaySegregate,
            Standing::Met if self.is_drainage_unknown => Headline::DrainageNotKnown,
            Standing::Met => Headline::Meets,
        })
    }

    /// Boundary of tests that adds to the limit of design: continuing erosion if the filter is beyond it,
    /// or no erosion if that is stricter than design or design is not kept.
    pub fn boundary(&self) -> Option<&AppliedRule> {
        let (design, no_erosion) = (self.applied(DESIGN), self.applied(TESTS_NO_EROSION));
        let limits = no_erosion.and_then(|rule| rule.limit).zip(design.and_then(|rule| rule.limit));
        match self.tests {
            TestedClass::Continuing => self.applied(TESTS_CONTINUING),
            _ if limits.is_some_and(|(tests, design)| tests < design) => no_erosion,
            _ => no_erosion.filter(|_| design.is_some_and(|rule| rule.met == Some(false))),
        }
    }

    /// Decision as a record; `None` if no rule of design was applied.
    pub fn record(&self, range_of_tests_mm: Option<[f64; 2]>) -> Option<Practice> {
        let design = self.applied(DESIGN)?;
        Some(Practice {
            class: self.standing.class(),
            d15f_mm: d15f_between(&design.needs).or(design.value.map(|d15f| [d15f, d15f])),
            limit_mm: design.limit,
            limit_at_most: design.limit_at_most,
            tests: self.tests,
            range_of_tests_mm,
        })
    }

    /// Notes on rules of stability, drainage and placing that are not kept, and on a limit without a
    /// margin. The line of practice covers rules of retention.
    pub fn notes(&self) -> impl Iterator<Item = Note> {
        let limit = |of_size: bool| {
            let is_wanted = |rule: &&AppliedRule| (rule.quantity == RuleQuantity::D15F) == of_size;
            self.broken(RuleRole::Drainage).find(is_wanted).and_then(|rule| rule.limit)
        };
        let named = |role: RuleRole, name: fn(&AppliedRule) -> &str| -> Vec<String> {
            self.broken(role).map(|rule| name(rule).to_owned()).collect()
        };
        let authorities = named(RuleRole::Stability, authority);
        let quantities = named(RuleRole::Placing, |rule| rule.quantity.name());
        [
            (!authorities.is_empty()).then_some(Note::LosesFines { authorities }),
            limit(true).map(|least_d15f_mm| Note::TooFineToDrain { least_d15f_mm }),
            limit(false).map(|most_fines_percent| Note::FinesOfFilter { most_fines_percent }),
            (!quantities.is_empty()).then_some(Note::MaySegregate { quantities }),
            self.limit_without_margin().map(|most_d15f_mm| Note::LimitWithoutMargin { most_d15f_mm }),
        ]
        .into_iter()
        .flatten()
    }

    /// Limit of design (mm), if it is not broken and has no margin.
    fn limit_without_margin(&self) -> Option<f64> {
        let design = self.applied(DESIGN)?;
        design.limit.filter(|_| design.met != Some(false) && has_no_margin(&self.rules))
    }
}

fn open_sieves(rules: &[AppliedRule]) -> Option<RuleNote> {
    let counts = |rule: &&AppliedRule| {
        [DESIGN, TESTS_CONTINUING].contains(&&*rule.id) || rule.role == RuleRole::Stability
    };
    let open = rules.iter().filter(counts).filter(|rule| rule.applies && rule.met.is_none());
    open.flat_map(|rule| &rule.needs).copied().find(|need| need.sieves_between().is_some())
}

/// Answer of filter practice for a pair, for programs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct Practice {
    /// Class of the headline.
    pub class: PracticeClass,
    /// D15F (mm), twice; the openings of the two sieves around it if they are widely spaced. `None` if it
    /// is finer than the filter's finest sieve.
    pub d15f_mm: Option<[f64; 2]>,
    /// Limit of design (mm): the maximum D15F; `None` if it is not known.
    pub limit_mm: Option<f64>,
    /// True if the limit is not known exactly and is at most `limit_mm`.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub limit_at_most: bool,
    /// Class of such pairs in tests, by the boundaries of Foster and Fell.
    pub(crate) tests: TestedClass,
    /// Range of D15F (mm) in which erosion began in tests of bases with such fines (Fell et al., Table
    /// 9.2); `None` for a dispersive base, which had other tests, and if fines or D85B are not known.
    pub range_of_tests_mm: Option<[f64; 2]>,
}

/// Result of a filter under the rules checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub enum PracticeClass {
    /// The limit of design is kept, and the filter holds its own finer part. Drainage and retention of a
    /// base that may be dispersive are reported separately.
    #[serde(rename = "meets")]
    Meets,
    /// A limit is not kept.
    #[serde(rename = "does not meet")]
    DoesNotMeet,
    /// A required limit or size is not known, or the filter may lose its finer part.
    #[serde(rename = "not known")]
    NotKnown,
}

/// Declares the headlines, each with its words and its class.
macro_rules! headlines {
    ($($(#[$doc:meta])* $name:ident $words:literal $class:ident;)*) => {
        /// Answer of filter practice, the first line of every face.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
        #[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
        pub enum Headline {
            $($(#[$doc])* #[serde(rename = $words)] $name,)*
        }

        impl Headline {
            /// Words of the headline, on every face and in every file.
            pub fn words(self) -> &'static str {
                match self {
                    $(Self::$name => $words,)*
                }
            }

            /// Class of the headline: practice met, not met, or not known.
            pub fn class(self) -> PracticeClass {
                match self {
                    $(Self::$name => PracticeClass::$class,)*
                }
            }
        }
    };
}

headlines! {
    /// The limit of design is kept, and no other rule of retention, stability, drainage or placing is broken.
    Meets "meets the rules checked" Meets;
    /// As `Meets`, unless the base is dispersive, which is not stated.
    MeetsUnlessDispersive "meets the rules checked unless the base is dispersive" Meets;
    /// The limit of design is kept; it is not known if the filter drains the base.
    DrainageNotKnown "meets the limit of retention, drainage not known" Meets;
    /// The limit of design is kept by a filter that breaks a rule of drainage.
    MayNotDrain "meets the limit of retention, but may not drain" Meets;
    /// The limit of design is kept by a filter that breaks a rule of placing.
    MaySegregate "meets the limit of retention, but may segregate" Meets;
    /// Beyond the limit of design, within the boundary of no erosion of tests.
    BeyondDesign "does not meet the limit of design" DoesNotMeet;
    /// Beyond a limit of retention.
    DoesNotMeet "does not meet practice" DoesNotMeet;
    /// Not internally stable, and beyond a limit of retention without its finer part.
    TooCoarseWithoutFiner
        "does not meet practice: it may lose its finer part, and is too coarse without it" DoesNotMeet;
    /// Not internally stable.
    MayLoseFiner "not known: the filter may lose its finer part" NotKnown;
    /// A result depends on sizes between two widely spaced sieves.
    SievesMissing "not known: sieves are missing" NotKnown;
    /// A limit that decides is not known.
    TestMissing "not known: a test is missing" NotKnown;
}

/// Class of a pair in filter tests, by the boundaries of Foster and Fell.
///
/// Their boundary of excessive erosion appears only in figures without numbers. Erosion between the
/// boundaries of no and continuing erosion is therefore called "some erosion", though it may be excessive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub enum TestedClass {
    /// Within the boundary of no erosion.
    #[serde(rename = "no erosion")]
    None,
    /// Beyond the boundary of no erosion, within the boundary of continuing erosion.
    #[serde(rename = "some erosion")]
    Some,
    /// Beyond the boundary of excessive erosion; never reported until its numbers can be read.
    #[serde(rename = "excessive erosion")]
    Excessive,
    /// Beyond the boundary of continuing erosion.
    #[serde(rename = "continuing erosion")]
    Continuing,
    /// A required boundary is not known for these soils.
    #[default]
    #[serde(rename = "unknown")]
    Unknown,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_soils::{CLAY, SAND, SILTY, TILL, curve, filter, soil};
    use crate::{BatchRow, PairOptions, PairRules};
    use voidwalk_sheets::SoilSample;

    /// Limits of Sherard and Dunnigan: 0.2 and 1.28 mm; of Foster and Fell: 0.166 and 0.7 mm.
    #[test]
    fn practice_goes_by_design_where_tests_are_stricter() {
        for (base, d15f, [design, tests]) in [(&CLAY, 0.178, [0.2, 0.166]), (&SILTY, 0.85, [1.28, 0.7])] {
            let options = PairOptions::default();
            let pair = PairRules::of_envelopes(&soil(base), &filter(d15f), options);
            let (rules, decision) = (&pair.rules, pair.decision());
            assert_eq!((met_of(rules, DESIGN), met_of(rules, TESTS_NO_EROSION)), (Some(true), Some(false)));
            assert_eq!((decision.standing, decision.headline.is_some()), (Standing::Met, true));
            assert!(matches!(decision.notes().collect::<Vec<_>>()[..], [Note::LimitWithoutMargin { .. }]));
            for (id, wanted) in [(DESIGN, design), (TESTS_NO_EROSION, tests)] {
                let limit = decision.applied(id).and_then(|rule| rule.limit).unwrap();
                assert!((limit / wanted - 1.0).abs() < 0.01, "{id} {limit}");
            }
            let sample = SoilSample { name: "s".into(), path: "s".into(), curve: curve(base) };
            assert_eq!(BatchRow::of(&sample, ("F", &filter(d15f)), options).met, Some(true));
            // Beyond the limit of design, practice is not met.
            let coarse = PairRules::of_envelopes(&soil(base), &filter(2.0 * d15f), options);
            assert_eq!(coarse.practice.unwrap().class, PracticeClass::DoesNotMeet);
        }
    }

    /// Excessive erosion damages a dam: erosion that is not judged is never reported as less. For this
    /// sand 7 D85B and 9 D95B are 3.56 and 5.11 mm; with 38 % fines and a D95B of 2.6 mm tests identified
    /// no boundary of continuing erosion.
    #[test]
    fn beyond_no_erosion_worse_erosion_is_never_left_out() {
        for (base, d15f, class, excluded) in [
            (&SAND[..], 3.0, TestedClass::None, true),
            (&SAND, 3.7, TestedClass::Some, false),
            (&SAND, 5.0, TestedClass::Some, false),
            (&SAND, 6.0, TestedClass::Continuing, true),
            (&TILL, 6.5, TestedClass::Unknown, false),
            (&TILL, 40.0, TestedClass::Continuing, true),
        ] {
            let decision = PairRules::of(&curve(base), &filter(d15f)[0].1).decision();
            assert_eq!(decision.tests, class, "{d15f}");
            let is_open = class == TestedClass::Unknown && decision.is_beyond_tests;
            assert_eq!(is_open || class == TestedClass::Some, !excluded, "{d15f}");
            assert_eq!(decision.is_beyond_unclear, d15f == 40.0);
        }
    }
}
