//! What the rules of filter practice say of a pair: where the filter stands by all of them, and findings.

use super::entry::Finding;
use super::finding;
use super::rule_words::{against, bounded, first_clause, listed, met_of};
use super::tested::{is_beyond_tests, tested};
use super::washout::washout;
use crate::outcome::design::band::retaining;
use crate::outcome::record::{
    AppliedRule, Headline, Practice, PracticeClass, RuleQuantity, RuleRole, TestedClass, Verdict,
};
use crate::outcome::rules::{DESIGN, TESTS_CONTINUING, TESTS_NO_EROSION, authority};

/// Said where the rule of drainage has no result.
pub(super) const DRAINAGE_UNKNOWN: &str = "drainage not known";

/// The rules of a role that were made for these soils and are not kept.
pub(super) fn broken(rules: &[AppliedRule], role: RuleRole) -> Vec<&AppliedRule> {
    match role {
        RuleRole::Retention => retaining(rules).filter(|rule| rule.is_broken()).collect(),
        _ => rules.iter().filter(|rule| rule.is_broken() && rule.role == role).collect(),
    }
}

/// What rules of stability, drainage and placing that are not kept say; what several authors say alike is
/// one finding. Rules of retention stand in the line of practice.
pub fn findings(rules: &[AppliedRule]) -> Vec<Finding> {
    let mut all = Vec::new();
    let list = |rules: &[&AppliedRule], one: fn(&AppliedRule) -> String| {
        listed(&rules.iter().map(|rule| one(rule)).collect::<Vec<_>>())
    };
    let unstable = broken(rules, RuleRole::Stability);
    if !unstable.is_empty() {
        all.push(finding::loses_fines(&list(&unstable, |rule| {
            let [value, limit] = against(rule, 3);
            format!("{} ({} {}, limit {limit})", authority(rule), rule.quantity, bounded(rule, &value))
        })));
    }
    all.extend(drainage(rules));
    let placing = broken(rules, RuleRole::Placing);
    if !placing.is_empty() {
        all.push(finding::may_segregate(&list(&placing, asked)));
    }
    all
}

/// A quantity, and what practice asks for.
fn asked(rule: &AppliedRule) -> String {
    let [value, limit] = against(rule, 3);
    let allowed = if rule.at_least { "at least" } else { "up to" };
    format!("{} is {}, and practice asks for {allowed} {limit}", rule.quantity, bounded(rule, &value))
}

fn drainage(rules: &[AppliedRule]) -> Vec<Finding> {
    let too_fine = too_fine(rules).map(|[value, asked]| finding::too_fine_to_drain(&value, &asked));
    too_fine.into_iter().chain(too_many_fines(rules).map(|fines| finding::fines_of_filter(&fines))).collect()
}

/// Rules of drainage that are not kept: of D15F, and of anything else.
fn undrained(rules: &[AppliedRule]) -> (Vec<&AppliedRule>, Vec<&AppliedRule>) {
    let all = broken(rules, RuleRole::Drainage).into_iter();
    all.partition(|rule| rule.quantity == RuleQuantity::D15F)
}

/// D15F of a filter that is too fine to drain, and what practice asks for.
fn too_fine(rules: &[AppliedRule]) -> Option<[String; 2]> {
    let (of_size, _) = undrained(rules);
    let first = *of_size.first()?;
    let [value, limit] = against(first, 3);
    let value = bounded(first, &value);
    let least = of_size.get(1).map_or(String::new(), |least| {
        format!(", and EM 1110-2-1901 for {} at the least", against(least, 3)[1])
    });
    Some([value, format!("USBR and NRCS ask for {limit} or more{least}")])
}

/// What practice asks of the fines of a filter that has too many to drain.
fn too_many_fines(rules: &[AppliedRule]) -> Option<String> {
    let (_, of_fines) = undrained(rules);
    let all: Vec<String> = of_fines.into_iter().map(asked).collect();
    (!all.is_empty()).then(|| listed(&all))
}

/// What practice says of a pair, for programs; `None` where no rule of design was applied.
pub fn record(rules: &[AppliedRule], range_of_tests_mm: Option<[f64; 2]>) -> Option<Practice> {
    let design = rules.iter().find(|rule| rule.id == DESIGN && rule.applies)?;
    Some(Practice {
        class: standing(rules).class(),
        d15f_mm: design.needs.d15f_between().or(design.value.map(|d15f| [d15f, d15f])),
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
        Standing::Met => Headline::Meets,
    })
}

/// Where a filter stands by practice, the worst first.
#[derive(Clone, Debug, PartialEq)]
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
    Unknown(String),
    /// A result hangs on sizes between two sieves that stand far apart: which.
    Open(String),
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
/// filter hangs.
pub(super) fn open_sieves(rules: &[AppliedRule]) -> Option<String> {
    let counts = |rule: &&AppliedRule| {
        [DESIGN, TESTS_CONTINUING].contains(&&*rule.id) || rule.role == RuleRole::Stability
    };
    let open = rules.iter().filter(counts).filter(|rule| rule.applies && rule.met.is_none());
    open.filter_map(|rule| rule.needs.of_sieves_between()).next()
}

/// Where the filter of a pair stands.
pub fn standing(rules: &[AppliedRule]) -> Standing {
    let Some(design) = rules.iter().find(|rule| rule.id == DESIGN && rule.applies) else {
        return Standing::NoRules;
    };
    let mut retention = broken(rules, RuleRole::Retention);
    if met_of(rules, TESTS_NO_EROSION) == Some(true) {
        // Terzaghi's ratio is the limit of design of a sand.
        retention.clear();
    }
    let fails = !retention.is_empty() || !broken(rules, RuleRole::Continuation).is_empty();
    let open = open_sieves(rules);
    match design.met {
        _ if fails => Standing::Fails,
        _ if washout(rules).is_some() => Standing::WashedOut,
        Some(false) => Standing::NoMargin,
        _ if open.is_some() => Standing::Open(open.unwrap_or_default()),
        _ if !broken(rules, RuleRole::Stability).is_empty() => Standing::Unstable,
        Some(true) => Standing::Met,
        None => {
            let needs = first_clause(&design.needs.to_string());
            Standing::Unknown(needs.strip_prefix("needs ").map_or("the limit of design", |of| of).to_owned())
        }
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
    use crate::outcome::design::Specification;
    use crate::outcome::rules::NamedCurve;
    use crate::outcome::with_inches;
    use crate::verdict::practice_words::practice_line;
    use crate::verdict::{BatchRow, PairOptions, PairRules, SpecificationOptions};

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

    /// Sherard and Dunnigan allow 0.200 and 1.28 mm, Foster and Fell 0.166 and 0.700 mm.
    #[test]
    fn practice_goes_by_design_where_tests_are_stricter() {
        for (base, d15f, [design, tests]) in
            [(&CLAY, 0.178, ["0.200 mm", "0.166 mm"]), (&SILTY, 0.85, ["1.28 mm", "0.700 mm"])]
        {
            let options = PairOptions { dispersive: false, ..PairOptions::default() };
            let rules = PairRules::of_envelopes(&soil(base), &filter(d15f), options).rules;
            assert_eq!((met_of(&rules, DESIGN), met_of(&rules, TESTS_NO_EROSION)), (Some(true), Some(false)));
            assert_eq!(standing(&rules), Standing::Met);
            assert_eq!(counts_as(&rules), Some(Verdict::None));
            assert!(findings(&rules).is_empty());
            let line = practice_line(&rules, None, None);
            assert!(line.contains(design) && line.contains(tests), "{line}");
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

    /// Every limit of D15F in every sentence that faces show of a pair, over sizes of many digits.
    #[test]
    fn no_sentence_has_inches_beyond_the_limit_that_it_names() {
        let soil = |points: &[(f64, f64)], by: f64| {
            let points: Vec<(f64, f64)> =
                points.iter().map(|(size, percent)| (size * by, *percent)).collect();
            vec![("soil".to_owned(), Gradation::from_lines(&points).unwrap())]
        };
        let bases: [&[(f64, f64)]; 4] = [
            &[(0.1, 0.0), (0.3, 15.0), (1.2, 85.0), (3.0, 100.0)],
            &[(0.01, 0.0), (0.075, 22.0), (0.3, 85.0), (0.6, 100.0)],
            &[(0.005, 13.0), (0.075, 37.0), (0.25, 60.0), (0.85, 78.0), (2.0, 90.0), (4.75, 100.0)],
            &[(0.002, 52.0), (0.005, 66.0), (0.01, 77.0), (0.02, 86.0), (0.04, 93.0), (0.425, 100.0)],
        ];
        let (mut checked, mut missed) = (0, Vec::new());
        for step in 0..60 {
            let by = libm::pow(1.01, f64::from(step));
            for base in bases {
                for d15f in [0.05, 0.16, 0.6, 0.9, 2.5, 6.0, 40.0] {
                    let filter = soil(&[(0.9, 0.0), (1.0, 15.0), (2.0, 100.0)], d15f * by);
                    let pair = PairRules::of_envelopes(&soil(base, by), &filter, PairOptions::default());
                    let mut said: Vec<String> = vec![pair.practice.clone()];
                    said.extend(findings(&pair.rules).iter().map(Finding::sentence));
                    said.extend(pair.if_dispersive.map(|of| of.words()));
                    let of = Specification::of("b", &soil(base, by), SpecificationOptions::default());
                    said.extend(
                        [of.band_in_words(), of.raised_in_words(), of.no_band.clone()].into_iter().flatten(),
                    );
                    said.extend(of.if_dispersive_in_words("again"));
                    let limits = pair.rules.iter().filter(|of| of.quantity == RuleQuantity::D15F);
                    for rule in limits {
                        let [value, limit] = against(rule, 3);
                        if value == limit {
                            continue;
                        }
                        let Ok(mm) = limit.trim_end_matches(" mm").parse::<f64>() else { continue };
                        for sentence in &said {
                            let text = with_inches(sentence);
                            for (at, _) in text.match_indices(&format!(" {limit} (")) {
                                let behind = text[at..].split_once('(').unwrap().1.split('\u{202f}').next();
                                let inches = behind.unwrap().rsplit(' ').next().unwrap();
                                let back = 25.4 * inches.parse::<f64>().unwrap();
                                checked += 1;
                                let is_within = if rule.at_least {
                                    back >= mm * (1.0 - 1e-9)
                                } else {
                                    back <= mm * (1.0 + 1e-9)
                                };
                                if !is_within {
                                    missed.push(text.clone());
                                }
                            }
                        }
                    }
                }
            }
        }
        assert!(
            checked > 1000 && missed.is_empty(),
            "{checked} {} {:#?}",
            missed.len(),
            &missed[..missed.len().min(6)]
        );
    }
}
