//! A worse soil never breaks fewer rules, over thousands of random soils.
//!
//! Monotone relations, which are tested here:
//! - a dispersive base breaks every rule that it breaks otherwise, and its limits are never wider;
//! - an open joint takes nothing away;
//! - with more of its fines sieved, a base breaks every limit of D15F that it broke before, and keeps every
//!   one that it kept before.
//!
//! Exceptions: Cu and fines decide if a base with gravel is regraded. Without sieves for them it is regraded,
//! which is the stricter reading; finer sieves may show that it need not be, and widen its limits. Terzaghi's
//! ratio also gives way to limits by fines once a base is known to have 15 % of them.

use super::decision::Decision;
use crate::rules::{BaseSoil, RuleInputs, apply};
use crate::{AppliedRule, PracticeClass, RuleRole};
use voidwalk_core::gradation::Gradation;

/// Number of pairs of soils drawn.
const PAIRS: u64 = 4000;

/// Pseudorandom numbers from 0 to 1.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64) / (1u64 << 53) as f64
    }

    /// A size (mm), equally likely in every decade.
    fn size(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }

    /// A soil down to 0 %, with random gravel, gaps and fines.
    fn soil(&mut self, low: f64, high: f64) -> Vec<(f64, f64)> {
        let count = 3 + (8.0 * self.next()) as usize;
        let mut sizes: Vec<f64> = (0..count).map(|_| self.size(low, high)).collect();
        let mut percents: Vec<f64> = (0..count).map(|_| 100.0 * self.next()).collect();
        sizes.sort_by(f64::total_cmp);
        percents.sort_by(f64::total_cmp);
        percents[0] = 0.0;
        let mut points: Vec<(f64, f64)> = Vec::new();
        for (size, percent) in sizes.into_iter().zip(percents) {
            if points.last().is_none_or(|last| size > 1.01 * last.0) {
                points.push((size, percent));
            }
        }
        points.last_mut().expect("there are points").1 = 100.0;
        points
    }

    fn filter(&mut self) -> Gradation {
        let (d15, cu) = (self.size(0.05, 60.0), 1.2 + 4.0 * self.next());
        Gradation::linear_from_dx(15.0, d15, cu).unwrap()
    }

    /// Number of the finest sieves missing from a table, with at least two left.
    fn missing(&mut self, points: &[(f64, f64)]) -> usize {
        (points.len().saturating_sub(1) as f64 * self.next()) as usize
    }
}

fn soil(points: &[(f64, f64)]) -> Option<Gradation> {
    Gradation::from_lines(points).ok()
}

fn rules(filter: &Gradation, base: &Gradation, dispersive: bool, joint_mm: Option<f64>) -> Vec<AppliedRule> {
    apply(&RuleInputs { dispersive, joint_mm, ..RuleInputs::of_soils(base, filter) })
}

fn broken(rules: &[AppliedRule]) -> Vec<&str> {
    rules.iter().filter(|rule| rule.is_broken()).map(|rule| rule.id.as_str()).collect()
}

/// Asserts that if `than` does not meet practice, `worse` does not, either.
#[track_caller]
fn no_better(worse: &[AppliedRule], than: &[AppliedRule]) {
    let fails = |rules: &[AppliedRule]| {
        Decision::new(rules, None, None).standing.class() == PracticeClass::DoesNotMeet
    };
    assert!(!fails(than) || fails(worse), "{worse:?} after {than:?}");
}

#[test]
fn a_dispersive_base_or_an_open_joint_never_breaks_fewer_rules() {
    let (mut chance, mut by_bound) = (Chance(1), 0);
    for _ in 0..PAIRS {
        let (filter, points) = (chance.filter(), chance.soil(0.0005, 40.0));
        let missing = if chance.next() < 0.5 { 0 } else { chance.missing(&points) };
        let Some(base) = soil(&points[missing..]) else { continue };
        let plain = rules(&filter, &base, false, None);
        let joint = rules(&filter, &base, false, Some(chance.size(0.01, 10.0)));
        let dispersive = rules(&filter, &base, true, None);
        for worse in [&joint, &dispersive] {
            let now = broken(worse);
            for id in broken(&plain) {
                assert!(now.contains(&id), "{id}: {points:?} from {missing}");
            }
            no_better(worse, &plain);
        }
        for (before, after) in plain.iter().zip(&dispersive) {
            assert_eq!(before.id, after.id);
            // The limit is no wider, and no rule is kept that was not kept before.
            assert!(
                before.limit.is_none_or(|limit| after.limit.is_some_and(|narrower| narrower <= limit)),
                "{after:?}"
            );
            assert!(after.met != Some(true) || before.met == Some(true), "{before:?} {after:?}");
            let is_bound = after.limit_at_most && !before.limit_at_most;
            by_bound += usize::from(is_bound && after.met == Some(false));
        }
    }
    assert!(by_bound > 100, "dispersive bases with 15 to 40 % fines beyond their bound: {by_bound}");
}

#[test]
fn testing_more_of_the_fines_never_takes_a_failure_back() {
    let limits = ["sherard-dunnigan", "foster-fell-no-erosion", "foster-fell-continuing"];
    let (mut chance, mut compared, mut found_out, mut other_part) = (Chance(2), 0, 0, 0);
    for _ in 0..PAIRS {
        let (filter, points) = (chance.filter(), chance.soil(0.0005, 40.0));
        let (dispersive, missing) = (chance.next() < 0.3, chance.missing(&points));
        let (Some(whole), Some(open)) = (soil(&points), soil(&points[missing..])) else { continue };
        // The size below which practice looks at the base.
        let part = |base: &Gradation| {
            let soil = BaseSoil::of(base, false);
            soil.regraded_at_mm.or(soil.hidden_below_mm)
        };
        // A flat part that finer sieves show may be a gap.
        let flat = |base: &Gradation| base.regraded_otherwise(base).and_then(|other| other.at_mm);
        let is_same = [part(&open), flat(&open)] == [part(&whole), flat(&whole)];
        let (before, after) = (part(&open), part(&whole));
        let [open, whole] = [&open, &whole].map(|base| rules(&filter, base, dispersive, None));
        let met = |id: &str| {
            [&open, &whole].map(|rules| rules.iter().find(|rule| rule.id == id).and_then(|rule| rule.met))
        };
        for id in ["permeability", "permeability-em-1901"] {
            let [before, after] = met(id);
            assert!(before.is_none() || before == after, "{id}: {points:?} from {missing}");
        }
        if before.is_some() && after.is_none() {
            // Finer sieves showed that it need not be regraded.
            other_part += 1;
            continue;
        }
        for id in limits {
            compared += 1;
            let [was, is] = met(id);
            found_out += usize::from(was.is_none() && is.is_some());
            assert!(was != Some(false) || is == Some(false), "{id}: {points:?} from {missing}");
            if is_same {
                assert!(was != Some(true) || is == Some(true), "{id}: {points:?} from {missing}");
            }
        }
        let [was, is] = met("terzaghi");
        assert!(!is_same || was != Some(true) || is == Some(true), "{points:?} from {missing}");
        if was != Some(false) || is == Some(false) {
            let retention = |rules: &[AppliedRule]| -> Vec<AppliedRule> {
                rules.iter().filter(|rule| rule.role == RuleRole::Retention).cloned().collect()
            };
            no_better(&retention(&whole), &retention(&open));
        }
    }
    assert!(compared > 5000 && found_out > 500 && other_part < 200, "{compared} {found_out} {other_part}");
}
