//! What a sheet says where it lists the rules of one authority alone: its limit, and what is left out.

use super::pair::{PairRules, StatedByAuthority};
use super::practice_words::MET_UNLESS_DISPERSIVE;
use super::rule_words::{against, credit, without_margin};
use super::tested::tested_in_brief;
use super::washout::washout;
use super::words::capital;
use crate::outcome::design::band::{limits, retention};
use crate::outcome::record::{AppliedRule, IfDispersive, RuleQuantity, RuleRole};
use crate::outcome::rules::{
    Authority, DESIGN, PERMEABILITY, PERMEABILITY_LEAST, TESTS_CONTINUING, TESTS_NO_EROSION, is_stated_by,
};

/// The rules of practice that one authority states, in their order, as a sheet lists them; those of the walk
/// are none of them.
pub fn stated_by(rules: &[AppliedRule], by: Authority) -> Vec<AppliedRule> {
    listed(&all_stated_by(rules, by))
}

fn all_stated_by(rules: &[AppliedRule], by: Authority) -> Vec<AppliedRule> {
    rules.iter().filter(|rule| rule.role != RuleRole::Walk && is_stated_by(rule, by)).cloned().collect()
}

/// Rules as a sheet lists them: of two rules of drainage that come to one limit, their floor, the first; the
/// limit of a dispersive base, which is one for design and for no erosion, once and under its own name.
pub fn listed(rules: &[AppliedRule]) -> Vec<AppliedRule> {
    let repeats = |rule: &&AppliedRule| {
        let is_said =
            |of: &AppliedRule| of.id == PERMEABILITY && of.limit.is_some() && of.limit == rule.limit;
        rule.id == PERMEABILITY_LEAST && !rule.limit_at_most && rules.iter().any(is_said)
    };
    let is_one = without_margin(rules).is_some();
    let once = rules.iter().filter(|rule| !(repeats(rule) || is_one && rule.id == TESTS_NO_EROSION));
    let named = |rule: &AppliedRule| match is_one && rule.id == DESIGN {
        true => {
            let [name, source, applies_to] =
                [OF_DISPERSIVE, OF_DISPERSIVE_SOURCE, FOR_DISPERSIVE].map(str::to_owned);
            AppliedRule { name, source, applies_to, ..rule.clone() }
        }
        false => rule.clone(),
    };
    once.map(named).collect()
}

/// The name of the limit of a dispersive base, which leaves design no margin.
const OF_DISPERSIVE: &str =
    "Fell et al.: no erosion of a highly dispersive base (taken for design, too, without a margin)";

/// What it was made for.
const FOR_DISPERSIVE: &str = "highly dispersive bases: the lower boundary of no erosion, without a margin of \
                              safety; this program takes it for design, too";

/// Where it is stated.
const OF_DISPERSIVE_SOURCE: &str = "Fell, MacGregor, Stapledon & Bell, Geotechnical Engineering of Dams, \
                                    Table 9.2, note (b)";

impl PairRules {
    /// With what one authority states of the two soils; of all authorities it says nothing.
    ///
    /// ```
    /// use voidwalk::{Gradation, outcome::rules::Authority, verdict::PairRules};
    /// let filter = Gradation::from_lines(&[(0.5, 0.0), (2.0, 100.0)])?;
    /// let base = Gradation::from_lines(&[(0.08, 0.0), (0.3, 100.0)])?;
    /// let stated = PairRules::of(&base, &filter).stated_by(Authority::Nrcs).by_authority.unwrap();
    /// assert!(stated.said.starts_with("NRCS: met: D15F 0.616 mm is within 0.98"), "{}", stated.said);
    /// # Ok::<(), voidwalk::gradation::GradationError>(())
    /// ```
    pub fn stated_by(mut self, by: Authority) -> Self {
        let said = of_pair(&self.rules, by, self.filter.d15_mm, self.if_dispersive);
        self.by_authority = said.map(|said| StatedByAuthority {
            authority: by.word().to_owned(),
            rules: all_stated_by(&self.rules, by).into_iter().map(|rule| rule.id).collect(),
            said,
        });
        self
    }
}

/// What stands behind [`of_pair`] where there is a walk.
pub const ON_ALL_RULES: &str = "The verdict rests on all rules.";

/// The strictest limit of D15F that one authority has for this pair, and what it leaves out; `None` for all
/// authorities, which leave nothing out. With `if_dispersive` nobody says whether the base is dispersive.
pub fn of_pair(
    rules: &[AppliedRule],
    by: Authority,
    d15f: Option<f64>,
    if_dispersive: Option<IfDispersive>,
) -> Option<String> {
    if by == Authority::All {
        return None;
    }
    let beyond = if_dispersive.and_then(|of| of.beyond_in_words(rules, d15f));
    let met = if beyond.is_some() { MET_UNLESS_DISPERSIVE } else { "met" };
    // A D15F that lies in a finest tail has the limits in mm all the same.
    let governing = match governing(rules, &stated_by(rules, by), d15f.unwrap_or(1.0), met) {
        Some((rule, value)) => format!("{value} ({})", credit(&rule)),
        None => "no limit of D15F for this base".into(),
    };
    let left = left_by(rules, by);
    let said = match broken(&left) {
        None if left.iter().all(|rule| rule.met == Some(true)) => vec!["none of them is broken".into()],
        None if left.iter().all(|rule| !rule.applies || rule.met == Some(true)) => {
            [vec!["all that have a limit for these soils are met".into()], without_result(&left)].concat()
        }
        broken => broken.into_iter().chain(without_result(&left)).collect(),
    };
    Some(format!("{}: {governing}. {}", by.name(), left_out(rules, &left, &said)))
}

/// The strictest limit of D15F that one authority has for a base, which others are stricter, and that the
/// answer rests on all rules. Sizes of a design are in mm, or have no unit.
///
/// The rules were read at a D15F that keeps all of them: it is their limits that tell them apart.
pub fn of_design(rules: &[AppliedRule], by: Authority, unit: &str) -> Option<String> {
    if by == Authority::All {
        return None;
    }
    let (stated, left) = (stated_by(rules, by), left_by(rules, by));
    let d15f = rules.iter().find(|rule| rule.quantity == RuleQuantity::D15F).and_then(|rule| rule.value);
    let d15f = d15f.unwrap_or(1.0);
    let has_unit = unit == "mm";
    let own = retention(&stated, d15f).filter(|_| has_unit);
    let governing = match own {
        _ if !has_unit => "the limit is not known, as sizes have no unit".into(),
        Some((rule, limit)) => format!("D15F up to {} ({})", in_mm(rule, limit), credit(rule)),
        None => "no limit of D15F for this base".into(),
    };
    let is_less = |limit: f64| own.is_none_or(|(_, own)| limit < own * (1.0 - 1e-9));
    let stricter = left.iter().filter(|_| has_unit).filter_map(|rule| {
        let is_retained = matches!(rule.role, RuleRole::Retention | RuleRole::Continuation);
        let (_, limit) = *limits(std::slice::from_ref(*rule), d15f).first()?;
        let whose = if rule.role == RuleRole::Retention { credit(rule) } else { &rule.name };
        (is_retained && !rule.at_least && is_less(limit)).then(|| format!("{whose}, {}", in_mm(rule, limit)))
    });
    let stricter: Vec<String> = stricter.collect();
    let mut said = Vec::new();
    match (has_unit, &stricter[..]) {
        (false, _) => {}
        (true, []) => said.push("no limit among them is known to be stricter".into()),
        (true, _) => said.push(format!("stricter among them: {}", stricter.join("; "))),
    }
    said.extend(broken(&left));
    said.extend(without_result(&left));
    let left = left_out(rules, &left, &said);
    Some(format!("{}: {governing}. {left} The answer rests on all rules.", by.name()))
}

fn in_mm(rule: &AppliedRule, limit: f64) -> String {
    format!("{limit:.3} mm{}", if rule.limit_at_most { " at most" } else { "" })
}

/// The rule with the strictest limit, and value and limit in words.
fn governing(
    rules: &[AppliedRule],
    stated: &[AppliedRule],
    d15f: f64,
    met: &str,
) -> Option<(AppliedRule, String)> {
    let (rule, _) = retention(stated, d15f)?;
    let [value, limit] = against(rule, 3);
    let quantity = &rule.quantity;
    let at_most = if rule.limit_at_most { " at most" } else { "" };
    let said = match rule.met {
        Some(true) => match washout(stated) {
            Some(of) => format!("not met: {quantity} {value} is within {limit}{}", of.as_placed()),
            None if washout(rules).is_some() => {
                format!("met as placed, not by all rules: {quantity} {value} is within {limit}")
            }
            None => format!("{met}: {quantity} {value} is within {limit}"),
        },
        Some(false) => format!("not met: {quantity} {value} is more than {limit}{at_most}"),
        None => format!("no result: {quantity} {value}, limit {limit}{at_most}"),
    };
    Some((rule.clone(), said))
}

/// The rules of practice that an authority does not state.
fn left_by(rules: &[AppliedRule], by: Authority) -> Vec<&AppliedRule> {
    rules.iter().filter(|rule| rule.role != RuleRole::Walk && !is_stated_by(rule, by)).collect()
}

/// The rules that are not met; `None` where there are none.
fn broken(left: &[&AppliedRule]) -> Option<String> {
    let names: Vec<&str> = left.iter().filter(|of| of.is_broken()).map(|of| of.name.as_str()).collect();
    (!names.is_empty()).then(|| format!("not met among them: {}", names.join("; ")))
}

/// Rules that were made for these soils and neither are met nor broken: their probability, where they have
/// one, or that they have no result; and how many have no limit for these soils.
fn without_result(left: &[&AppliedRule]) -> Vec<String> {
    let open = || left.iter().filter(|rule| rule.applies && rule.met.is_none());
    let share = |rule: &&&AppliedRule| rule.unit == "%" && rule.limit.is_none() && rule.value.is_some();
    let of_share = |rule: &&AppliedRule| {
        let name = rule.name.split(':').next().unwrap_or_default();
        format!("{name}: {}", against(rule, 2)[0])
    };
    let shares = open().filter(share).map(of_share);
    let none: Vec<&str> = open().filter(|rule| !share(rule)).map(|rule| rule.name.as_str()).collect();
    let none = (!none.is_empty()).then(|| format!("no result: {}", none.join("; ")));
    let not_for = left.iter().filter(|rule| !rule.applies).count();
    let not_for = (not_for > 0).then(|| format!("no limit for these soils: {not_for}"));
    none.into_iter().chain(shares).chain(not_for).collect()
}

/// How many rules are left out, the class of tests where that is one of them, and what is said of them.
fn left_out(rules: &[AppliedRule], left: &[&AppliedRule], said: &[String]) -> String {
    let classes = match left.iter().any(|rule| rule.id == TESTS_CONTINUING) {
        true => format!(", with Foster and Fell's classes ({})", tested_in_brief(rules)),
        false => String::new(),
    };
    let begin = format!("Left out: {} rules of others{classes}", left.len());
    let Some((first, more)) = said.split_first() else { return format!("{begin}.") };
    let more: String = more.iter().map(|said| format!(" {}.", capital(said))).collect();
    format!("{begin}; {first}.{more}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Gradation;
    use crate::verdict::PairRules;

    fn pair(filter_scale: f64) -> PairRules {
        let base = Gradation::from_lines(&[(0.08, 0.0), (0.3, 100.0)]).unwrap();
        let sizes = [(0.5 * filter_scale, 0.0), (2.0 * filter_scale, 100.0)];
        PairRules::of(&base, &Gradation::from_lines(&sizes).unwrap())
    }

    #[test]
    fn an_authority_has_its_own_limit_and_says_what_it_leaves_out() {
        let coarse = pair(2.5);
        let said = |by| of_pair(&coarse.rules, by, coarse.filter.d15_mm, None);
        assert_eq!(said(Authority::All), None);
        let nrcs = said(Authority::Nrcs).unwrap();
        assert!(nrcs.starts_with("NRCS: not met: D15F 1.54 mm is more than 0.98"), "{nrcs}");
        assert!(nrcs.contains("with Foster and Fell's classes (no erosion); not met among them: Terzaghi"));
        let tests = said(Authority::FosterFell).unwrap();
        assert!(tests.starts_with("Foster and Fell: met: D15F 1.54 mm is within 1.7"), "{tests}");
        assert!(tests.contains("not met among them: Sherard and Dunnigan: the filter retains"), "{tests}");
        assert!(!tests.contains("classes"), "{tests}");
    }

    /// The Corps states criteria of internal stability, and NRCS none.
    #[test]
    fn an_authority_with_criteria_of_stability_does_not_call_met_what_is_too_coarse_after_washout() {
        use crate::verdict::washout::tests::{GRAVEL_0_32, REGRADED_TILL};
        let soil = |points: &[(f64, f64)]| Gradation::from_lines(points).unwrap();
        let pair = PairRules::of(&soil(&REGRADED_TILL), &soil(&GRAVEL_0_32));
        let said = |by| of_pair(&pair.rules, by, pair.filter.d15_mm, None).unwrap();
        let corps = said(Authority::Usace);
        let left = " as placed, but 2.83 mm without its finest 19.4 %, which the filter may lose (Sherard";
        assert!(
            corps.contains(": not met: D15F 0.610 mm is within 1.26 mm") && corps.contains(left),
            "{corps}"
        );
        let nrcs = said(Authority::Nrcs);
        assert!(
            nrcs.starts_with("NRCS: met as placed, not by all rules: D15F 0.610 mm is")
                && nrcs.contains("Kézdi (1979)"),
            "{nrcs}"
        );
    }

    /// Whatever is not listed and not met is named.
    #[test]
    fn no_broken_rule_is_lost() {
        for scale in [0.1, 0.5, 1.0, 2.0, 4.0, 10.0] {
            let pair = pair(scale);
            for by in Authority::ALL {
                let listed = stated_by(&pair.rules, by);
                let said = of_pair(&pair.rules, by, pair.filter.d15_mm, None).unwrap_or_default();
                for rule in pair.rules.iter().filter(|rule| rule.is_broken()) {
                    let is_listed = listed.iter().any(|of| of.id == rule.id);
                    assert!(is_listed || said.contains(&rule.name), "{by:?} at {scale}: {}", rule.name);
                }
            }
        }
    }

    /// A clay has the floor of both rules of drainage; of a sand they ask for 5 and 3 times D15B.
    #[test]
    fn a_limit_of_drainage_is_listed_once() {
        let filter = Gradation::from_lines(&[(0.5, 0.0), (2.0, 100.0)]).unwrap();
        let clay = [(0.002, 51.0), (0.02, 87.0), (0.63, 100.0)];
        for (base, count) in [(&clay[..], 1), (&[(0.1, 0.0), (0.4, 100.0)], 2)] {
            let pair = PairRules::of(&Gradation::from_lines(base).unwrap(), &filter);
            let drains = |rule: &&AppliedRule| rule.id.starts_with(PERMEABILITY);
            let listed = stated_by(&pair.rules, Authority::Usace);
            assert_eq!(listed.iter().filter(drains).count(), count);
            let named = pair.clone().stated_by(Authority::Usace).by_authority.unwrap().rules;
            assert_eq!(named.iter().filter(|id| id.starts_with(PERMEABILITY)).count(), 2);
        }
    }

    /// A design reads its rules at a D15F that keeps them all: its sentence goes by limits.
    #[test]
    fn every_stricter_limit_is_named_beside_a_design() {
        let base = Gradation::from_lines(&[(0.08, 0.0), (0.3, 100.0)]).unwrap();
        let fine = Gradation::from_lines(&[(0.01, 0.0), (0.06, 90.0), (0.2, 100.0)]).unwrap();
        let till = Gradation::from_lines(&[(0.01, 0.0), (0.075, 37.0), (0.6, 80.0), (4.0, 100.0)]).unwrap();
        let mut named = 0;
        for base in [base, fine, till] {
            let least = PairRules::of(&base, &Gradation::linear_from_dx(15.0, 0.15, 1.5).unwrap()).rules;
            for by in Authority::ALL.into_iter().filter(|by| *by != Authority::All) {
                let said = of_design(&least, by, "mm").unwrap();
                let (_, own) = retention(&stated_by(&least, by), 0.15).unwrap();
                assert!(said.contains(&format!("D15F up to {own:.3} mm")), "{said}");
                assert!(!said.contains("none of them is broken"), "{said}");
                let all = limits(&least, 0.15).into_iter();
                let retains = |rule: &AppliedRule| rule.role == RuleRole::Retention;
                for (rule, limit) in all.filter(|(rule, limit)| retains(rule) && *limit < own * (1.0 - 1e-9))
                {
                    let stricter = said.split("stricter among them: ").nth(1).unwrap_or_default();
                    let one = format!("{}, {limit:.3} mm", credit(rule));
                    assert!(stricter.contains(&one), "{one}: {said}");
                    named += 1;
                }
            }
        }
        assert!(named >= 3, "{named}");
    }

    #[test]
    fn without_a_unit_no_limit_is_stated() {
        let said = of_design(&pair(1.0).rules, Authority::Nrcs, "D85B").unwrap();
        assert!(
            said.starts_with("NRCS: the limit is not known, as sizes have no unit. Left out: "),
            "{said}"
        );
        assert!(!said.contains("stricter") && !said.contains(" mm"), "{said}");
    }

    /// What has no result, or a probability alone, is no rule that is met.
    #[test]
    fn what_has_no_result_is_named_and_none_is_broken_only_where_all_are_met() {
        use crate::verdict::PairOptions;
        let soil = |points: &[(f64, f64)]| vec![("s".to_owned(), Gradation::from_lines(points).unwrap())];
        let filter = soil(&[(0.5, 0.0), (2.0, 100.0)]);
        let options = PairOptions { joint_mm: Some(2.0), ..PairOptions::default() };
        let base = soil(&[(0.08, 0.0), (0.3, 100.0)]);
        let joint = PairRules::of_envelopes(&base, &filter, options);
        let said = of_pair(&joint.rules, Authority::Nrcs, joint.filter.d15_mm, None).unwrap();
        assert!(said.contains(" Constricted exit: 90 %."), "{said}");
        assert!(!said.contains("none of them is broken") && !said.contains("are met"), "{said}");
        let without = PairRules::of_envelopes(&base, &filter, PairOptions::default());
        let said = of_pair(&without.rules, Authority::Nrcs, without.filter.d15_mm, None).unwrap();
        assert!(
            said.ends_with("; all that have a limit for these soils are met. No limit for these soils: 2.")
        );
        // Fines that nobody sieved.
        let open =
            PairRules::of_envelopes(&soil(&[(0.3, 25.0), (1.0, 100.0)]), &filter, PairOptions::default());
        let said = of_pair(&open.rules, Authority::FosterFell, open.filter.d15_mm, None).unwrap();
        let none = said.split("; no result: ").nth(1).unwrap_or_default();
        assert!(none.contains("Sherard and Dunnigan"), "{said}");
        let kept: Vec<AppliedRule> = joint.rules.iter().filter(|of| of.met == Some(true)).cloned().collect();
        let said = of_pair(&kept, Authority::Nrcs, joint.filter.d15_mm, None).unwrap();
        assert!(said.ends_with("none of them is broken."), "{said}");
    }

    #[test]
    fn a_filter_with_its_d15_in_the_pan_has_the_limit_all_the_same() {
        let base = Gradation::from_lines(&[(0.08, 0.0), (0.3, 100.0)]).unwrap();
        let filter = Gradation::from_lines(&[(0.5, 30.0), (2.0, 100.0)]).unwrap();
        let pair = PairRules::of(&base, &filter);
        assert_eq!(pair.filter.d15_mm, None);
        let said = of_pair(&pair.rules, Authority::Nrcs, None, None).unwrap();
        assert!(said.starts_with("NRCS: no result: D15F unknown, limit 0.98"), "{said}");
    }
}
