//! Two soils judged by filter practice, without a walk.

use serde::Serialize;

use super::decision::Decision;
use super::mistake::Mistake;
use crate::rules::{BaseSoil, NamedCurve, RuleInputs, apply_and_decide, tested_range};
use crate::{AppliedRule, Headline, IfDispersive, Note, Practice};
use voidwalk_core::gradation::{Gradation, RegradeReason};

/// What is said of two sieve curves by the rules of practice alone.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct PairRules {
    /// The filter.
    pub filter: FilterSizes,
    /// The base after regrading.
    pub base: BaseSizes,
    /// Every rule.
    pub rules: Vec<AppliedRule>,
    /// The answer of practice; `None` where the limit of design was not applied.
    pub headline: Option<Headline>,
    /// What practice says of the pair; `None` likewise.
    pub practice: Option<Practice>,
    /// The limit of D15F if the base is dispersive, where it was not said to be and has fines enough.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub if_dispersive: Option<IfDispersive>,
    /// What may be wrong with the two tables, and what was taken for what.
    pub notes: Vec<Note>,
}

/// Further inputs of the rules for two soils.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PairOptions {
    /// True if the base is dispersive.
    pub dispersive: bool,
    /// Width of an open joint at the exit (mm).
    pub joint_mm: Option<f64>,
    /// True to take base and filter as given, though they look exchanged.
    pub as_given: bool,
}

/// Sizes of a filter (mm), of the curve that keeps the limit of design worst where it is an envelope; `None`
/// where they lie in a finest tail of unknown size.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct FilterSizes {
    /// Its curves, where there are several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub curves: Vec<String>,
    /// The curve that these sizes are of.
    pub curve: String,
    /// 15 % finer.
    pub d15_mm: Option<f64>,
    /// 50 % finer.
    pub d50_mm: Option<f64>,
    /// 85 % finer.
    pub d85_mm: Option<f64>,
    /// D60 / D10.
    pub cu: Option<f64>,
    /// D30^2 / (D10 D60).
    pub cc: Option<f64>,
}

/// A base as practice describes it (mm), of the curve that keeps the limit of design worst where it is an
/// envelope; `None` where a size lies in a finest tail of unknown size.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct BaseSizes {
    /// Its curves, where there are several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub curves: Vec<String>,
    /// The curve that these sizes are of.
    pub curve: String,
    /// Whether it was said to be dispersive.
    pub dispersive: bool,
    /// Category of NRCS, 1 to 4; `None` where the fines are not known closely enough.
    pub category: Option<u8>,
    /// Percent finer than 0.075 mm after regrading.
    pub fines_percent: Option<f64>,
    /// Whether it was regraded.
    pub regraded: bool,
    /// The size on which it was regraded.
    pub regraded_at_mm: Option<f64>,
    /// Why it was regraded, or not.
    pub why: RegradeReason,
    /// 15 % finer, before regrading.
    pub d15_mm: Option<f64>,
    /// 85 % finer, after regrading.
    pub d85_mm: Option<f64>,
    /// 85 % finer, before regrading.
    pub d85_as_sampled_mm: Option<f64>,
    /// 95 % finer, after regrading.
    pub d95_mm: Option<f64>,
    /// D60 / D10, before regrading.
    pub cu: Option<f64>,
    /// D30^2 / (D10 D60), before regrading.
    pub cc: Option<f64>,
}

impl PairRules {
    /// Every rule on a base and a filter of one curve each, both in mm.
    ///
    /// ```
    /// use voidwalk_core::Gradation;
    /// use voidwalk_practice::PairRules;
    /// let filter = Gradation::from_lines(&[(0.5, 0.0), (2.0, 100.0)])?;
    /// let base = Gradation::from_lines(&[(0.08, 0.0), (0.3, 100.0)])?;
    /// let pair = PairRules::of(&base, &filter);
    /// assert_eq!(pair.base.category, Some(4));
    /// let rule = pair.rules.iter().find(|rule| rule.id == "sherard-dunnigan").unwrap();
    /// assert_eq!(rule.met, Some(true));
    /// # Ok::<(), voidwalk_core::gradation::GradationError>(())
    /// ```
    pub fn of(base: &Gradation, filter: &Gradation) -> Self {
        let one = |name: &str, curve: &Gradation| vec![(name.to_owned(), curve.clone())];
        Self::of_envelopes(&one("base", base), &one("filter", filter), PairOptions::default())
    }

    /// Applies every rule to two envelopes, after a check of their sizes for an exchange.
    ///
    /// # Errors
    /// The two can hardly be a base and its filter, and `options` do not say that they are as given.
    ///
    /// # Panics
    /// Either envelope has no curve.
    pub fn guarded(
        bases: &[NamedCurve],
        filters: &[NamedCurve],
        options: PairOptions,
    ) -> Result<Self, Mistake> {
        match Mistake::of_envelopes(bases, filters) {
            Some(mistake) if mistake.is_refused() && !options.as_given => Err(mistake),
            mistake => Ok(Self::with_mistake(bases, filters, options, mistake.as_ref())),
        }
    }

    /// Every rule on the curves of a base and of a filter, all in mm, each for the curves that keep it worst.
    ///
    /// # Panics
    /// Either envelope has no curve.
    pub fn of_envelopes(bases: &[NamedCurve], filters: &[NamedCurve], options: PairOptions) -> Self {
        Self::with_mistake(bases, filters, options, Mistake::of_envelopes(bases, filters).as_ref())
    }

    /// Applies every rule, given the mistake found in the two soils.
    pub(super) fn with_mistake(
        bases: &[NamedCurve],
        filters: &[NamedCurve],
        options: PairOptions,
        mistake: Option<&Mistake>,
    ) -> Self {
        let (rules, [filter, base], soil) =
            apply_and_decide(bases, filters, options.dispersive, options.joint_mm);
        let ((curve, filter), (base_curve, base)) = (&filters[filter], &bases[base]);
        let BaseSoil { gradation, regraded, regraded_at_mm, why, fines_percent, category, .. } = soil.clone();
        let names = |curves: &[NamedCurve]| match curves.len() {
            1 => Vec::new(),
            _ => curves.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>(),
        };
        let mut notes: Vec<Note> = mistake.map(|mistake| mistake.note.clone()).into_iter().collect();
        for (whose, curves) in [("filter", filters), ("base", bases)] {
            if curves.len() > 1 {
                notes.push(Note::Envelope { soil: whose.into(), curves: names(curves) });
            }
        }
        let if_dispersive = match options.dispersive {
            true => None,
            false => IfDispersive::of_bases(bases, filter),
        };
        let range = tested_range(&RuleInputs {
            dispersive: options.dispersive,
            ..RuleInputs::with_soil(base, soil, filter)
        });
        let decision = Decision::new(&rules, if_dispersive, filter.d(15.0));
        let (headline, practice) = (decision.headline, decision.record(range));
        Self {
            filter: FilterSizes {
                curves: names(filters),
                curve: curve.clone(),
                d15_mm: filter.d(15.0),
                d50_mm: filter.d(50.0),
                d85_mm: filter.d(85.0),
                cu: filter.cu(),
                cc: filter.cc(),
            },
            base: BaseSizes {
                curves: names(bases),
                curve: base_curve.clone(),
                dispersive: options.dispersive,
                category,
                fines_percent,
                regraded,
                regraded_at_mm,
                why,
                d15_mm: base.d(15.0),
                d85_mm: gradation.d(85.0),
                d85_as_sampled_mm: base.d(85.0),
                d95_mm: gradation.d(95.0),
                cu: base.cu(),
                cc: base.cc(),
            },
            headline,
            practice,
            if_dispersive,
            rules,
            notes,
        }
    }

    /// Decision of practice on the pair.
    pub fn decision(&self) -> Decision {
        Decision::new(&self.rules, self.if_dispersive, self.filter.d15_mm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decision::Standing;
    use crate::rules::DESIGN;
    use crate::{Headline, RuleRole};

    /// The till with 35 % fines on a gravel with D15 6.3 mm, of the first trial.
    #[test]
    fn a_till_on_a_gravel_is_not_retained() {
        let till = [(0.075, 35.0), (0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)];
        let till = Gradation::from_lines(&till).unwrap();
        let gravel = Gradation::linear_from_dx(15.0, 6.3, 1.5).unwrap();
        let pair = PairRules::of(&till, &gravel);
        assert_eq!((pair.base.category, pair.base.regraded), (Some(3), true));
        let met = |id: &str| pair.rules.iter().find(|rule| rule.id == id).unwrap().met;
        assert_eq!(met("sherard-dunnigan"), Some(false));
        assert_eq!(met("foster-fell-no-erosion"), Some(false));
        assert_eq!(met("foster-fell-continuing"), None);
        assert_eq!(met("permeability"), Some(true));
        assert!(pair.notes.is_empty());
    }

    /// 45 % fines, and nobody has said whether they are dispersive: a filter that meets practice
    /// unconditionally is reported with the condition, by the rules alone too.
    #[test]
    fn a_limit_that_a_dispersive_base_would_have_stands_in_the_line() {
        let soil = |points: &[(f64, f64)]| vec![("soil".to_owned(), Gradation::from_lines(points).unwrap())];
        let base = soil(&[(0.01, 0.0), (0.075, 45.0), (0.3, 92.0), (0.6, 100.0)]);
        let judged = |d15f: f64, dispersive| {
            let filter = soil(&[(0.9 * d15f, 0.0), (d15f, 15.0), (2.0 * d15f, 100.0)]);
            PairRules::of_envelopes(&base, &filter, PairOptions { dispersive, ..PairOptions::default() })
        };
        let pair = judged(0.61, false);
        assert_eq!(pair.headline, Some(Headline::MeetsUnlessDispersive));
        assert_eq!(pair.if_dispersive.map(|limit| limit.d15f_max_mm), Some(0.5));
        assert_eq!(judged(0.45, false).headline, Some(Headline::Meets));
        let stated = judged(0.61, true);
        assert!(stated.headline == Some(Headline::DoesNotMeet) && stated.if_dispersive.is_none());
    }

    /// Bases of every category, with gravel, gaps and tails, and filters from too fine to too coarse.
    fn curves(draw: &mut impl FnMut() -> f64, middle: [f64; 2], name: &str) -> Vec<NamedCurve> {
        let count = 1 + (3.0 * draw()) as usize;
        let curve = |draw: &mut dyn FnMut() -> f64| {
            let mut size = middle[0] * libm::pow(middle[1] / middle[0], draw());
            let mut percent = if draw() < 0.4 { 20.0 * draw() } else { 0.0 };
            let mut points = vec![(size, percent)];
            while percent < 100.0 {
                size *= 1.1 + 2.0 * draw() * draw();
                percent = (percent + 35.0 * draw() * draw()).min(100.0);
                points.push((size, if points.len() > 11 { 100.0 } else { percent }));
                percent = points[points.len() - 1].1;
            }
            Gradation::from_lines(&points).unwrap()
        };
        (0..count).map(|at| (format!("{name}{at}"), curve(draw))).collect()
    }

    /// The place of a result: broken, not known, met, not made for these soils.
    fn place(rule: &AppliedRule) -> u8 {
        match rule.met {
            Some(false) => 0,
            None if rule.applies || !rule.needs.is_empty() || rule.role == RuleRole::Continuation => 1,
            Some(true) => 2,
            None => 3,
        }
    }

    fn worse(standing: &Standing) -> u8 {
        match standing {
            Standing::Fails | Standing::WashedOut => 0,
            Standing::NoMargin => 1,
            Standing::Unstable | Standing::Unknown(_) | Standing::Open(_) => 2,
            Standing::Met => 3,
            Standing::NoRules => 4,
        }
    }

    /// An envelope is never better than the worst of its curves alone, and by each rule exactly as bad.
    #[test]
    fn an_envelope_is_as_bad_as_the_worst_of_its_curves() {
        let mut state = 57u64;
        let mut draw = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut apart = 0;
        for _ in 0..300 {
            let [bases, filters] = [([0.002, 0.3], "b"), ([0.05, 2.0], "f")]
                .map(|(middle, name)| curves(&mut draw, middle, name));
            let dispersive = draw() < 0.3;
            let options = PairOptions { dispersive, joint_mm: Some(0.5), as_given: true };
            let all = PairRules::of_envelopes(&bases, &filters, options).rules;
            let one = std::slice::from_ref;
            let pairs: Vec<Vec<AppliedRule>> = filters
                .iter()
                .flat_map(|filter| {
                    let pair = |base| PairRules::of_envelopes(one(base), one(filter), options).rules;
                    bases.iter().map(pair)
                })
                .collect();
            for rule in all.iter().filter(|rule| rule.id != "filter-band") {
                let alone = pairs.iter().flatten().filter(|other| other.id == rule.id).map(place);
                assert_eq!(Some(place(rule)), alone.min(), "{} of {bases:?} and {filters:?}", rule.id);
            }
            let stands = |rules: &Vec<AppliedRule>| worse(&Decision::new(rules, None, None).standing);
            let worst = pairs.iter().map(stands).min().unwrap();
            assert!(stands(&all) <= worst, "{all:?}");
            apart += usize::from(pairs.iter().any(|rules| stands(rules) != worst));
        }
        assert!(apart > 50, "{apart} envelopes have curves of which not all are as bad");
    }

    /// A sand is finer at 85 % than a clay with gravel, and allows a coarser filter.
    #[test]
    fn the_curve_with_the_lower_limit_counts_though_its_d85_is_larger() {
        let soil =
            |name: &str, points: &[(f64, f64)]| (name.to_owned(), Gradation::from_lines(points).unwrap());
        let clay = soil("clay", &[(0.002, 54.0), (0.09, 62.8), (0.71, 72.1), (1.7, 91.0), (6.3, 100.0)]);
        let sand = soil("sand", &[(0.075, 0.0), (0.18, 12.0), (0.355, 54.0), (0.425, 73.9), (0.5, 100.0)]);
        let filter = [soil("filter", &[(0.075, 0.0), (0.85, 0.9), (16.0, 100.0)])];
        for bases in [[clay.clone(), sand.clone()], [sand, clay]] {
            let pair = PairRules::of_envelopes(&bases, &filter, PairOptions::default());
            let design = pair.rules.iter().find(|rule| rule.id == DESIGN).unwrap();
            assert_eq!((design.met, design.limit, &*design.base_curve), (Some(false), Some(0.2), "clay"));
            assert_eq!((pair.base.curve.as_str(), pair.base.category), ("clay", Some(2)));
        }
    }
}
