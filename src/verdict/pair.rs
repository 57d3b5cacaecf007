//! Two soils as filter practice sees them, without a walk.

use serde::Serialize;

use super::entry::Finding;
use super::finding;
use super::mistake::Mistake;
use super::practice_words::practice_line;
use crate::gradation::Gradation;
use crate::outcome::record::{AppliedRule, IfDispersive};
use crate::outcome::rules::{BaseSoil, DESIGN, NamedCurve, Sides, apply_to_envelopes};

/// What is said of two sieve curves by the rules of practice alone.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PairRules {
    /// The filter.
    pub filter: FilterSizes,
    /// The base after regrading.
    pub base: BaseSizes,
    /// Every rule.
    pub rules: Vec<AppliedRule>,
    /// What they say together, in a line, as it stands on every page: whether practice is met, and why.
    pub practice: String,
    /// The limit of D15F if the base is dispersive, where it was not said to be and has fines enough.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub if_dispersive: Option<IfDispersive>,
    /// What may be wrong with the two tables, and what was taken for what.
    pub warnings: Vec<String>,
    /// What one authority states of them, where one is asked for; `rules` has all of them all the same.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by_authority: Option<StatedByAuthority>,
}

/// The rules of one authority on two soils.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct StatedByAuthority {
    /// Its word: nrcs, usbr, usace or foster-fell.
    pub authority: String,
    /// The `id` of every rule that it states, in the order of `rules`.
    pub rules: Vec<String>,
    /// Its limit of D15F, and what is left out: stricter limits, rules that are not met, rules without a
    /// result.
    pub said: String,
}

/// What else the rules are told of two soils.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PairOptions {
    /// Whether the base is dispersive.
    pub dispersive: bool,
    /// Width of an open joint at the exit (mm).
    pub joint_mm: Option<f64>,
    /// Whether base and filter are taken as they are given, though they look exchanged.
    pub as_given: bool,
}

/// Sizes of a filter (mm), of its coarsest curve where it is an envelope; `None` where they lie in a finest
/// tail of unknown size.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
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

/// A base as practice describes it (mm), its finest curve where it is an envelope; `None` where a size lies
/// in a finest tail of unknown size.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
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
    pub why: String,
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
    /// use voidwalk::{Gradation, verdict::PairRules};
    /// let filter = Gradation::from_points(&[(0.5, 0.0), (2.0, 100.0)], None)?;
    /// let base = Gradation::from_points(&[(0.08, 0.0), (0.3, 100.0)], None)?;
    /// let pair = PairRules::of(&base, &filter);
    /// assert_eq!(pair.base.category, Some(4));
    /// let rule = pair.rules.iter().find(|rule| rule.id == "sherard-dunnigan").unwrap();
    /// assert_eq!(rule.met, Some(true));
    /// # Ok::<(), voidwalk::gradation::GradationError>(())
    /// ```
    pub fn of(base: &Gradation, filter: &Gradation) -> Self {
        let one = |name: &str, curve: &Gradation| vec![(name.to_owned(), curve.clone())];
        Self::of_envelopes(&one("base", base), &one("filter", filter), PairOptions::default())
    }

    /// The same of two envelopes that are not exchanged, as far as their sizes tell.
    ///
    /// # Errors
    /// The two can hardly be a base and its filter, and `options` do not say that they are as given.
    ///
    /// # Panics
    /// Where either has no curve.
    pub fn guarded(
        bases: &[NamedCurve],
        filters: &[NamedCurve],
        options: PairOptions,
    ) -> Result<Self, Mistake> {
        match Mistake::of_envelopes(bases, filters).filter(|of| of.is_refused() && !options.as_given) {
            Some(mistake) => Err(mistake),
            None => Ok(Self::of_envelopes(bases, filters, options)),
        }
    }

    /// Every rule on the curves of a base and of a filter, all in mm: retention reads the finest base and the
    /// coarsest filter, permeability the coarsest base and the finest filter.
    ///
    /// # Panics
    /// Where either has no curve.
    pub fn of_envelopes(bases: &[NamedCurve], filters: &[NamedCurve], options: PairOptions) -> Self {
        let sides = Sides::of(bases, filters);
        let (curve, filter) = &filters[sides.coarsest_filter];
        let (base_curve, base) = &bases[sides.finest_base];
        let BaseSoil { gradation, regraded, regraded_at_mm, why, fines_percent, category, .. } =
            BaseSoil::of(base, false);
        let names = |curves: &[NamedCurve]| match curves.len() {
            1 => Vec::new(),
            _ => curves.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>(),
        };
        let mistake = Mistake::of_envelopes(bases, filters);
        let mut found: Vec<Finding> = mistake.iter().map(Mistake::finding).collect();
        for (whose, curves) in [("filter", filters), ("base", bases)] {
            if curves.len() > 1 {
                found.push(finding::envelope(whose, curves.len() as u64, &names(curves).join(", ")));
            }
        }
        let rules = apply_to_envelopes(bases, filters, options.dispersive, options.joint_mm);
        found.extend(stricter(filters, bases, options, sides, &rules));
        let if_dispersive = match options.dispersive {
            true => None,
            false => IfDispersive::of_bases(bases, filter),
        };
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
                why: why.words(),
                d15_mm: base.d(15.0),
                d85_mm: gradation.d(85.0),
                d85_as_sampled_mm: base.d(85.0),
                d95_mm: gradation.d(95.0),
                cu: base.cu(),
                cc: base.cc(),
            },
            practice: practice_line(&rules, if_dispersive, filter.d(15.0)),
            if_dispersive,
            rules,
            warnings: found.iter().map(Finding::with_to_do).collect(),
            by_authority: None,
        }
    }
}

/// Whether a base curve that is not the finest has a stricter limit of design: its fines put it into another
/// category.
fn stricter(
    filters: &[NamedCurve],
    bases: &[NamedCurve],
    options: PairOptions,
    sides: Sides,
    rules: &[AppliedRule],
) -> Option<Finding> {
    let limit = |rules: &[AppliedRule]| {
        let rule = rules.iter().find(|rule| rule.id == DESIGN)?;
        rule.limit.filter(|_| !rule.limit_at_most)
    };
    let of_finest = limit(rules)?;
    let filter = std::slice::from_ref(&filters[sides.coarsest_filter]);
    let of_curve = |curve: &NamedCurve| {
        let alone = apply_to_envelopes(std::slice::from_ref(curve), filter, options.dispersive, None);
        Some((curve.0.clone(), limit(&alone)?))
    };
    let (name, least) = bases.iter().filter_map(of_curve).min_by(|a, b| a.1.total_cmp(&b.1))?;
    (bases.len() > 1 && least < of_finest * (1.0 - 1e-9))
        .then(|| finding::stricter_curve(&name, least, of_finest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::rules::Authority;

    /// The till with 35 % fines on a gravel with D15 6.3 mm, of the first trial.
    #[test]
    fn a_till_on_a_gravel_is_not_retained() {
        let till = [(0.075, 35.0), (0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)];
        let till = Gradation::from_points(&till, None).unwrap();
        let gravel = Gradation::linear_from_dx(15.0, 6.3, 1.5).unwrap();
        let pair = PairRules::of(&till, &gravel);
        assert_eq!((pair.base.category, pair.base.regraded), (Some(3), true));
        let met = |id: &str| pair.rules.iter().find(|rule| rule.id == id).unwrap().met;
        assert_eq!(met("sherard-dunnigan"), Some(false));
        assert_eq!(met("foster-fell-no-erosion"), Some(false));
        assert_eq!(met("foster-fell-continuing"), None);
        assert_eq!(met("permeability"), Some(true));
        assert!(pair.warnings.is_empty());
    }

    /// 45 % fines, and nobody has said whether they are dispersive: what is met without a condition is said
    /// with it, by the rules alone too.
    #[test]
    fn a_limit_that_a_dispersive_base_would_have_stands_in_the_line() {
        let soil =
            |points: &[(f64, f64)]| vec![("soil".to_owned(), Gradation::from_points(points, None).unwrap())];
        let base = soil(&[(0.01, 0.0), (0.075, 45.0), (0.3, 92.0), (0.6, 100.0)]);
        let said = |d15f: f64, dispersive| {
            let filter = soil(&[(0.9 * d15f, 0.0), (d15f, 15.0), (2.0 * d15f, 100.0)]);
            PairRules::of_envelopes(&base, &filter, PairOptions { dispersive, ..PairOptions::default() })
        };
        let pair = said(0.61, false);
        assert!(
            pair.practice.starts_with(
                "met unless the base is dispersive, without a margin in the limit: D15F 0.610 mm"
            ) && pair
                .practice
                .ends_with("; if the base is dispersive, the limit is 0.500 mm, and 0.610 mm is beyond it"),
            "{}",
            pair.practice
        );
        assert_eq!(pair.if_dispersive.map(|of| of.d15f_max_mm), Some(0.5));
        let stated = pair.clone().stated_by(Authority::Nrcs).by_authority.unwrap().said;
        assert!(stated.starts_with("NRCS: met unless the base is dispersive: D15F "), "{stated}");
        assert!(said(0.45, false).practice.starts_with("met, without a margin in the limit: "));
        let stated = said(0.61, true);
        assert!(stated.practice.starts_with("not met: ") && stated.if_dispersive.is_none());
    }
}
