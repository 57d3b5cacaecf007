//! Line of practice, and the limit for a base that may be dispersive.

use super::rule::{missing, rule_note, value_and_limit};
use crate::outcome::record::Outcome;
use voidwalk_practice::decision::Standing;
use voidwalk_practice::dispersion::BeyondDispersive;
use voidwalk_practice::quantity::{SizeUnit, Unit, beside_limit, greatest_length, significant};
use voidwalk_practice::retention::Washout;
use voidwalk_practice::rule_result::credit;
use voidwalk_practice::rules::{DESIGN, TESTS_NO_EROSION, authority, authority_in_brief};
use voidwalk_practice::{
    AppliedRule, Decision, DispersiveLack, Headline, IfDispersive, Note, RuleNote, RuleRole, RuleUnit,
    TestedClass,
};

/// Note that the rules that are met were judged for a single curve of each soil; `None` for envelopes.
pub(crate) fn judged_alone(outcome: &Outcome, decision: &Decision) -> Option<&'static str> {
    let is_envelope = outcome.notes.iter().any(|note| matches!(note, Note::Envelope { .. }));
    (decision.standing == Standing::Met && !is_envelope).then_some(
        "Judged for these two gradations alone. The coarsest filter and the finest base that the works allow \
         must keep the limit, too; that was not checked here.",
    )
}

/// Line of practice: headline, D15F and the limit of design, class of tests, other rules that are not
/// kept, and the limit that the filter breaks if the base is dispersive.
pub(crate) fn practice_line(decision: &Decision, unit: SizeUnit) -> String {
    let (Some(headline), Some(design)) = (decision.headline, decision.applied(DESIGN)) else {
        return "the limit of design was not applied".into();
    };
    let mut clauses = vec![of_design(design, decision.standing, unit)];
    if design.met.is_none() {
        clauses.extend(of_other_retention(decision, unit));
    }
    clauses.extend(of_tests(decision, unit));
    clauses.extend(decision.washout.as_ref().map(|washout| without_finer(washout, unit)));
    clauses.extend(besides(decision, headline).into_iter().map(str::to_owned));
    clauses.extend(decision.beyond_dispersive.as_ref().map(|beyond| beyond_dispersive(beyond, unit)));
    format!("{}: {}", headline.words(), clauses.join("; "))
}

fn of_design(rule: &AppliedRule, standing: Standing, unit: SizeUnit) -> String {
    let [value, limit] = value_and_limit(rule, unit);
    let known = format!("D15F {}", value.as_deref().unwrap_or("unknown"));
    let d15f = match standing {
        // The sieves leave D15F itself open.
        Standing::Open(sieves @ (RuleNote::D15FBetween(..) | RuleNote::FilterBetween(..))) => {
            rule_note(sieves, unit)
        }
        Standing::Open(sieves) => format!("{known}; {}", rule_note(sieves, unit)),
        _ => known,
    };
    let limit = match limit {
        Some(limit) if rule.limit_at_most => format!("limit not known, at most {limit} ({})", credit(rule)),
        Some(limit) => format!("limit {limit} ({})", credit(rule)),
        None => "limit not known".to_owned(),
    };
    let needs = match (rule.met, rule.needs.first()) {
        (None, Some(need)) => missing(*need).map(|missing| format!(" (needs {missing})")),
        _ => None,
    };
    format!("{d15f}, {limit}{}", needs.unwrap_or_default())
}

/// Rules of retention that are not kept, other than the limit of design and the boundary of no erosion.
fn of_other_retention(decision: &Decision, unit: SizeUnit) -> impl Iterator<Item = String> {
    let others = decision.broken(RuleRole::Retention);
    let others = others.filter(|rule| ![DESIGN, TESTS_NO_EROSION].contains(&&*rule.id));
    others.map(move |rule| {
        let [value, limit] = value_and_limit(rule, unit).map(Option::unwrap_or_default);
        format!("{} {value}, limit {limit} ({})", rule.quantity, authority(rule))
    })
}

/// Class of such pairs in tests, with the boundary that the filter exceeds.
fn of_tests(decision: &Decision, unit: SizeUnit) -> Option<String> {
    // Within the single limit of a dispersive base, tests add nothing.
    if decision.without_margin().is_some_and(|rule| rule.met == Some(true)) {
        return None;
    }
    let class = match decision.tests {
        // Rules that are met as placed say nothing about the filter without its finer part.
        TestedClass::None if decision.washout.is_some() => return None,
        TestedClass::None => "no-erosion criterion met",
        TestedClass::Unknown if !decision.is_beyond_tests => return None,
        class => tested_in_brief(class, decision.is_beyond_tests),
    };
    let boundary = decision.boundary().and_then(|rule| {
        let at_most = if rule.limit_at_most { "at most " } else { "" };
        let [_, limit] = value_and_limit(rule, unit);
        let limit = limit.map(|limit| format!("{at_most}{limit}"))?;
        Some(match decision.tests {
            TestedClass::Continuing if decision.is_beyond_unclear => {
                format!(" (beyond {limit}, a boundary that tests leave unclear)")
            }
            TestedClass::Continuing => format!(" (beyond {limit})"),
            _ => format!(" (no erosion up to {limit})"),
        })
    });
    Some(format!("Foster and Fell: {class}{}", boundary.unwrap_or_default()))
}

/// Class by the boundaries of Foster and Fell in brief. Beyond the boundary of no erosion (`is_beyond`) a
/// base erodes, even if tests identified no boundary of the further classes.
pub(super) fn tested_in_brief(class: TestedClass, is_beyond: bool) -> &'static str {
    match class {
        TestedClass::None => "no erosion",
        TestedClass::Some => "at least some erosion, excessive not excluded",
        TestedClass::Excessive => "excessive erosion",
        TestedClass::Continuing => "continuing erosion",
        TestedClass::Unknown if is_beyond => "at least some erosion, worse not excluded",
        TestedClass::Unknown => "class not known",
    }
}

/// D15F of a filter without the finer part that it may lose.
fn without_finer(washout: &Washout, unit: SizeUnit) -> String {
    let more = if washout.is_capped() { " or more" } else { "" };
    let d15f = match washout.unit {
        RuleUnit::Mm => {
            let numbers = [Some(washout.left.d15f), Some(washout.least)];
            beside_limit(numbers, false, Unit::Size(unit))[0].clone().unwrap_or_default()
        }
        unit => format!("{} {}", significant(washout.left.d15f).decimals(3), unit.name()),
    };
    format!(
        "D15F {d15f} without its finest {} %{more} ({}){}",
        significant(washout.left.percent).decimals(1),
        authority_in_brief(&washout.by),
        if washout.continues { ", beyond the continuing-erosion boundary" } else { "" }
    )
}

/// Other rules that are not kept and that the headline does not name.
fn besides(decision: &Decision, headline: Headline) -> Vec<&'static str> {
    let breaks = |role| decision.breaks(role);
    let dry = breaks(RuleRole::Drainage);
    let all = [
        (breaks(RuleRole::Stability), Headline::MayLoseFiner, "may lose its finer part"),
        (dry, Headline::MayNotDrain, "may not drain"),
        (breaks(RuleRole::Placing), Headline::MaySegregate, "may segregate"),
        (!dry && decision.is_drainage_unknown, Headline::DrainageNotKnown, "drainage not known"),
    ];
    // This headline names the finer part, too.
    let named = if headline == Headline::TooCoarseWithoutFiner { Headline::MayLoseFiner } else { headline };
    all.into_iter().filter(|(holds, says, _)| *holds && *says != named).map(|(.., words)| words).collect()
}

/// Filter that is too coarse only for a dispersive base, in a clause.
pub(super) fn beyond_dispersive(beyond: &BeyondDispersive, unit: SizeUnit) -> String {
    let at_most = if beyond.limit.at_most { "at most " } else { "" };
    let numbers = [Some(beyond.d15f_mm), Some(beyond.limit.d15f_max_mm)];
    let [value, most] = beside_limit(numbers, false, Unit::Size(unit)).map(Option::unwrap_or_default);
    let without = beyond.without_percent.map_or_else(String::new, |part| {
        format!(" (D15F {value} without the filter's finest {} %)", significant(part).decimals(1))
    });
    format!("dispersive base: limit {at_most}{most}, not kept{without}")
}

/// Limit after a recommended D15F (mm); `None` if that D15F holds for a dispersive base too.
pub(super) fn beside_dispersive(limit: IfDispersive, d15f_mm: f64, unit: SizeUnit) -> Option<String> {
    if !limit.at_most && limit.d15f_max_mm >= d15f_mm {
        return None;
    }
    let bound = match limit.lacks {
        Some(DispersiveLack::AnyLimit) => "less than",
        Some(DispersiveLack::D85B | DispersiveLack::LimitOfDesign) | None => "at most",
    };
    let most = greatest_length(limit.d15f_max_mm, unit);
    Some(format!("dispersive base: {bound} {most}"))
}

/// Limit of D15F. A limit that no source gives is never stated as the limit of other bases.
pub(crate) fn dispersive_limit(limit: IfDispersive, unit: SizeUnit) -> String {
    let most = greatest_length(limit.d15f_max_mm, unit).to_string();
    match limit.lacks.filter(|_| limit.at_most) {
        Some(DispersiveLack::AnyLimit) => {
            format!("less than {most}, by an amount that no available source gives")
        }
        Some(DispersiveLack::D85B) => format!("at most {most}, as D85B is not known"),
        Some(DispersiveLack::LimitOfDesign) | None => format!("at most {most}"),
    }
}

/// Test that determines an unknown limit; `of_the_pair` if no text has the limit.
pub(super) fn test(limit: IfDispersive, of_the_pair: &'static str) -> &'static str {
    match limit.lacks {
        Some(DispersiveLack::D85B) => "have the base tested with a hydrometer",
        Some(DispersiveLack::LimitOfDesign | DispersiveLack::AnyLimit) | None => of_the_pair,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_soils::{
        CLAY, GRAVEL_0_32, REGRADED_TILL, SAND, SAND_OF_1_MM, SILTY, STEPPED, TILL, curve, filter, soil,
    };
    use crate::words::{dispersive_limit, sentence, specification};
    use voidwalk_core::gradation::Gradation;
    use voidwalk_practice::design::Specification;
    use voidwalk_practice::{PairOptions, PairRules, SpecificationOptions};
    use voidwalk_practice::{PracticeClass, RuleQuantity};

    fn rules(filter: &[(f64, f64)], base: &[(f64, f64)], dispersive: bool) -> Vec<AppliedRule> {
        let options = PairOptions { dispersive, ..PairOptions::default() };
        PairRules::of_envelopes(&soil(base), &soil(filter), options).rules
    }

    const GAP: [(f64, f64); 4] = [(0.3, 0.0), (0.36, 15.0), (2.4, 15.0), (6.0, 100.0)];

    #[test]
    fn every_standing_has_its_headline() {
        let halved = GAP.map(|(size, percent)| (0.5 * size, percent));
        let coarse = STEPPED.map(|(size, percent)| (2.2 * size, percent));
        for (filter, base, expected) in [
            (&[(1.0, 0.0), (3.0, 100.0)][..], &SAND[..], Headline::Meets),
            (&SAND, &SAND, Headline::MayNotDrain),
            (&[(2.5, 0.0), (5.0, 100.0)], &SAND, Headline::BeyondDesign),
            (&[(8.0, 0.0), (16.0, 100.0)], &SAND, Headline::DoesNotMeet),
            (&[(5.0, 0.0), (6.5, 15.0), (20.0, 100.0)], &TILL, Headline::DoesNotMeet),
            (&GAP, &SAND, Headline::TooCoarseWithoutFiner),
            (&GRAVEL_0_32, &REGRADED_TILL, Headline::TooCoarseWithoutFiner),
            // Beyond the limit of design as placed, and beyond the boundary of tests without the finer part.
            (&coarse, &SAND_OF_1_MM, Headline::TooCoarseWithoutFiner),
            (&halved, &SAND, Headline::MayLoseFiner),
            (&[(1.0, 0.0), (3.0, 100.0)], &[(0.3, 25.0), (1.0, 100.0)], Headline::TestMissing),
        ] {
            let rules = rules(filter, base, false);
            let decision = Decision::new(&rules, None, None);
            assert_eq!(decision.headline, Some(expected));
            assert_eq!(decision.record(None).unwrap().class, expected.class());
            let line = practice_line(&decision, SizeUnit::Mm);
            assert!(line.starts_with(expected.words()) && line.split(' ').count() < 66, "{line}");
        }
        assert_eq!(Decision::new(&[], None, None).headline, None);
    }

    /// With 45 % fines the limit is 0.7 mm, or 0.5 mm for a dispersive base.
    #[test]
    fn a_filter_that_a_dispersive_base_would_break_meets_practice_on_that_condition() {
        let base = soil(&[(0.01, 0.0), (0.075, 45.0), (0.3, 92.0), (0.6, 100.0)]);
        let judged = |d15f: f64, dispersive| {
            let options = PairOptions { dispersive, ..PairOptions::default() };
            PairRules::of_envelopes(&base, &filter(d15f), options)
        };
        for (d15f, breaks) in [(0.61, true), (0.45, false)] {
            let pair = judged(d15f, false);
            let limit = pair.if_dispersive.unwrap();
            assert_eq!((limit.d15f_max_mm, limit.is_broken_by(d15f)), (0.5, breaks));
            let headline = if breaks { Headline::MeetsUnlessDispersive } else { Headline::Meets };
            assert_eq!(pair.headline, Some(headline));
            let line = practice_line(&pair.decision(), SizeUnit::Mm);
            assert_eq!(line.starts_with(Headline::MeetsUnlessDispersive.words()), breaks, "{line}");
            assert_eq!(line.contains("dispersive base: limit 0.500\u{202f}mm"), breaks, "{line}");
        }
        let stated = judged(0.61, true);
        assert_eq!((stated.headline, stated.if_dispersive), (Some(Headline::DoesNotMeet), None));
    }

    #[test]
    fn a_limit_of_which_only_the_most_is_known_is_recorded_as_that() {
        let silty = [(0.01, 0.0), (0.075, 22.0), (0.3, 85.0), (0.6, 100.0)];
        // (40 - 22)/25 (4 x 0.3 - 0.7) + 0.7 = 1.06.
        let rules = rules(&[(3.0, 0.0), (6.0, 100.0)], &silty, true);
        let practice = Decision::new(&rules, None, None).record(None).unwrap();
        assert_eq!((practice.class, practice.limit_at_most), (PracticeClass::DoesNotMeet, true));
        assert!((practice.limit_mm.unwrap() - 1.06).abs() < 1e-9);
        assert_eq!(Decision::new(&[], None, None).record(None), None);
    }

    #[test]
    fn a_d15f_between_distant_sieves_is_recorded_with_both() {
        let filter = Gradation::from_points(&[(0.3, 10.0), (38.0, 100.0)], None).unwrap();
        let pair = PairRules::of(&curve(&SAND), &filter);
        assert_eq!(pair.headline, Some(Headline::SievesMissing));
        assert_eq!(pair.practice.as_ref().unwrap().d15f_mm, Some([0.3, 38.0]));
        let line = practice_line(&pair.decision(), SizeUnit::Mm);
        assert!(line.contains("D15F lies between 0.3 and 38\u{202f}mm"), "{line}");
    }

    /// Limits of Sherard and Dunnigan: 0.200 and 1.28 mm; of Foster and Fell: 0.166 and 0.700 mm.
    #[test]
    fn where_tests_are_stricter_than_design_both_limits_are_said() {
        for (base, d15f, limits) in [
            (&CLAY, 0.178, ["0.200\u{202f}mm", "0.166\u{202f}mm"]),
            (&SILTY, 0.85, ["1.28\u{202f}mm", "0.700\u{202f}mm"]),
        ] {
            let rules = rules(&[(0.9 * d15f, 0.0), (d15f, 15.0), (2.0 * d15f, 100.0)], base, false);
            let line = practice_line(&Decision::new(&rules, None, Some(d15f)), SizeUnit::Mm);
            assert!(limits.iter().all(|limit| line.contains(limit)), "{line}");
        }
    }

    /// Inches after the last mm of a text, in mm; `None` without inches.
    fn back_in_mm(behind: &str) -> Option<f64> {
        let bracket = behind.strip_prefix(" (")?.split_once("\u{202f}in)")?.0;
        bracket.rsplit(' ').next()?.parse::<f64>().ok().map(|inches| 25.4 * inches)
    }

    /// All limits of D15F in all sentences that faces show for a pair, for sizes with many digits.
    #[test]
    fn no_sentence_has_inches_beyond_the_limit_that_it_names() {
        const UNIT: SizeUnit = SizeUnit::MmAndInches;
        let scaled = |points: &[(f64, f64)], by: f64| {
            soil(&points.iter().map(|(size, percent)| (size * by, *percent)).collect::<Vec<_>>())
        };
        let bases: [&[(f64, f64)]; 4] = [
            &[(0.1, 0.0), (0.3, 15.0), (1.2, 85.0), (3.0, 100.0)],
            &[(0.01, 0.0), (0.075, 22.0), (0.3, 85.0), (0.6, 100.0)],
            &SILTY,
            &CLAY,
        ];
        let mut checked = 0;
        for step in 0..60 {
            let by = libm::pow(1.01, f64::from(step));
            for base in bases {
                let design = Specification::of("b", &scaled(base, by), SpecificationOptions::default());
                let of_band = [
                    specification::band(&design, UNIT),
                    specification::raised(&design, UNIT),
                    specification::beside_limits(&design, UNIT),
                    design.no_band.as_ref().map(|why| specification::no_band(why, UNIT)),
                    specification::if_dispersive(&design, "again", UNIT),
                ];
                for d15f in [0.05, 0.16, 0.6, 0.9, 2.5, 6.0, 40.0] {
                    let filter = scaled(&[(0.9, 0.0), (1.0, 15.0), (2.0, 100.0)], d15f * by);
                    let pair = PairRules::of_envelopes(&scaled(base, by), &filter, PairOptions::default());
                    let decision = pair.decision();
                    let mut sentences = vec![practice_line(&decision, UNIT)];
                    sentences.extend(decision.notes().map(|note| sentence(&note, UNIT)));
                    sentences.extend(pair.if_dispersive.map(|limit| dispersive_limit(limit, UNIT)));
                    sentences.extend(of_band.iter().flatten().cloned());
                    for rule in pair.rules.iter().filter(|rule| rule.quantity == RuleQuantity::D15F) {
                        let [value, limit] = value_and_limit(rule, SizeUnit::Mm);
                        let Some(limit) = limit.filter(|limit| value.as_ref() != Some(limit)) else {
                            continue;
                        };
                        let mm: f64 = limit.trim_end_matches("\u{202f}mm").parse().unwrap();
                        for text in &sentences {
                            for (at, words) in text.match_indices(&format!(" {limit}")) {
                                checked += 1;
                                let back = back_in_mm(&text[at + words.len()..]);
                                let is_within = back.is_some_and(|back| match rule.at_least {
                                    true => back >= mm * (1.0 - 1e-9),
                                    false => back <= mm * (1.0 + 1e-9),
                                });
                                assert!(is_within, "{}: {text}", rule.id);
                            }
                        }
                    }
                }
            }
        }
        assert!(checked > 1000, "{checked}");
    }
}
