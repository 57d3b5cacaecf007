//! Two soils judged by filter practice, without a walk.

use crate::quantity::significant;
use crate::rules::{BaseSoil, NamedCurve, RuleInputs, apply_and_decide, tested_range};
use crate::{AppliedRule, Decision, Headline, IfDispersive, Note, Practice};
use serde::Serialize;
use std::fmt;
use voidwalk_core::gradation::{Gradation, RegradeReason};

/// Result of the rules of practice for two sieve curves, without a walk.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct PairRules {
    /// The filter.
    pub filter: FilterSizes,
    /// The base after regrading.
    pub base: BaseSizes,
    /// Every rule.
    pub rules: Vec<AppliedRule>,
    /// Answer of practice; `None` if the limit of design was not applied.
    pub headline: Option<Headline>,
    /// Decision of practice as a record; `None` if the limit of design was not applied.
    pub practice: Option<Practice>,
    /// Limit of D15F if the base is dispersive, for a base with enough fines that was not stated to be.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub if_dispersive: Option<IfDispersive>,
    /// Warnings about the two tables, and assumptions made about them.
    pub notes: Vec<Note>,
}

/// Further inputs of the rules for two soils.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PairOptions {
    /// True if the base is dispersive.
    pub dispersive: bool,
    /// Width of an open joint at the exit (mm).
    pub joint_mm: Option<f64>,
    /// True to accept base and filter as given, though they look exchanged.
    pub as_given: bool,
}

/// Sizes of a filter (mm); of an envelope, the curve that keeps the limit of design worst. `None` if a
/// size is finer than the finest sieve.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct FilterSizes {
    /// Names of its curves, if there are several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub curves: Vec<String>,
    /// Curve with these sizes.
    pub curve: String,
    /// D15.
    pub d15_mm: Option<f64>,
    /// D50.
    pub(crate) d50_mm: Option<f64>,
    /// D85.
    pub d85_mm: Option<f64>,
    /// D60 / D10.
    pub cu: Option<f64>,
    /// D30^2 / (D10 D60).
    pub(crate) cc: Option<f64>,
}

/// A base as practice describes it (mm); of an envelope, the curve that keeps the limit of design worst.
/// `None` if a size is finer than the finest sieve.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct BaseSizes {
    /// Names of its curves, if there are several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub curves: Vec<String>,
    /// Curve with these sizes.
    pub curve: String,
    /// True if the base was stated to be dispersive.
    pub dispersive: bool,
    /// NRCS category, 1 to 4; `None` if the fines are not known closely enough.
    pub category: Option<u8>,
    /// Percent finer than 0.075 mm after regrading.
    pub fines_percent: Option<f64>,
    /// True if the base was regraded.
    pub(crate) regraded: bool,
    /// Size on which the base was regraded.
    pub regraded_at_mm: Option<f64>,
    /// Reason for regrading or not.
    pub why: RegradeReason,
    /// D15 before regrading.
    pub d15_mm: Option<f64>,
    /// D85 after regrading.
    pub d85_mm: Option<f64>,
    /// D85 before regrading.
    pub d85_as_sampled_mm: Option<f64>,
    /// D95 after regrading.
    pub d95_mm: Option<f64>,
    /// D60 / D10, before regrading.
    pub cu: Option<f64>,
    /// D30^2 / (D10 D60), before regrading.
    pub(crate) cc: Option<f64>,
}

impl PairRules {
    /// Applies every rule to a base and a filter of one curve each, both in mm.
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

    /// Applies every rule to two envelopes after checking that they are not exchanged.
    ///
    /// # Errors
    /// The two can hardly be a base and its filter, and `options` does not say they are as given.
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

    /// Applies every rule to the curves of a base and of a filter, all in mm; the worst curves count.
    ///
    /// # Panics
    /// Either envelope has no curve.
    pub fn of_envelopes(bases: &[NamedCurve], filters: &[NamedCurve], options: PairOptions) -> Self {
        Self::with_mistake(bases, filters, options, Mistake::of_envelopes(bases, filters).as_ref())
    }

    /// Applies every rule, given a mistake found in the two soils.
    pub(super) fn with_mistake(
        bases: &[NamedCurve],
        filters: &[NamedCurve],
        options: PairOptions,
        mistake: Option<&Mistake>,
    ) -> Self {
        let (rules, [filter, base], soil) =
            apply_and_decide(bases, filters, options.dispersive, options.joint_mm);
        let ((curve, filter), (base_curve, base)) = (&filters[filter], &bases[base]);
        let BaseSoil { gradation, regraded_at_mm, why, fines_percent, category, .. } = soil.clone();
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
        let if_dispersive = if options.dispersive { None } else { IfDispersive::of_bases(bases, filter) };
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
                regraded: regraded_at_mm.is_some(),
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

/// Error of two tables that are unlikely to be a base and its filter.
#[derive(Clone, Debug, PartialEq)]
pub struct Mistake {
    /// Kind of mistake.
    pub kind: MistakeKind,
    /// Note if they are not refused.
    pub note: Note,
    /// D15 and D50 of the base, and of the filter.
    sizes: Box<[[Bounds; 2]; 2]>,
    /// Size (mm) on which the base was regraded for this D50.
    regraded_at_mm: Option<f64>,
}

/// Kind of mistake in two tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MistakeKind {
    /// Sizes so far apart that a unit is wrong or the files are exchanged.
    Unit,
    /// The D15 of the base is far above the D15 of the filter.
    Exchanged,
    /// The base is the coarser of the two, but not by enough to prove an exchange.
    Coarser,
    /// The filter's sizes may be micrometres.
    Boulders,
}

/// Bounds of a size (mm); they differ if the size is finer than the finest sieve.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bounds {
    least: f64,
    most: f64,
}

impl Bounds {
    fn of(soil: &Gradation, percent: f64) -> Self {
        match soil.d(percent) {
            Some(size) => Self { least: size, most: size },
            None => Self { least: 0.0, most: soil.smallest_mm() },
        }
    }
}

impl fmt::Display for Bounds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let below = if self.least > 0.0 { "" } else { "below " };
        write!(f, "{below}{:.3} mm", self.most)
    }
}

impl fmt::Display for Mistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [[d15b, d50b], [d15f, d50f]] = &*self.sizes;
        match self.kind {
            MistakeKind::Unit => write!(
                f,
                "the base (D50 {d50b}) is {:.0} times as coarse as the filter (D50 {d50f}): are its sizes \
                 micrometres under a header in mm, or are the two files exchanged?",
                d50b.least / d50f.most
            ),
            MistakeKind::Exchanged | MistakeKind::Coarser => {
                let regraded = self.regraded_at_mm.map(|at| format!(" regraded on {} mm", significant(at)));
                write!(
                    f,
                    "the base is coarser than the filter (D15 {d15b} against {d15f}, D50 {d50b}{} against \
                     {d50f}): are the two files exchanged? Or its sizes micrometres under a header in mm?",
                    regraded.unwrap_or_default()
                )
            }
            MistakeKind::Boulders => write!(
                f,
                "the filter's D50 is {:.0} mm: are its sizes micrometres under a header in mm?",
                d50f.least
            ),
        }
    }
}

/// Error of a refusal: the mistake, and the setting that says that the two are as given.
pub struct Refusal<'a>(pub &'a Mistake, pub &'a str);

impl fmt::Display for Refusal<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(mistake, as_given) = self;
        write!(
            f,
            "{mistake} The base is named first, then the filter: exchange the two, or say that they are as \
             given ({as_given})"
        )
    }
}

impl Mistake {
    /// Looks for exchanged tables and for micrometres instead of mm.
    ///
    /// D15 of both soils is compared as sampled, as for permeability: a broad till has a D50 above that
    /// of many filters that hold it, but a far smaller D15. Bounds are compared if D15 is finer than the
    /// finest sieve. For similar soils the D50 of the regraded base is compared, with a warning only.
    /// Sizes that are multiples of D0F (`scale_free`) have no unit that could be wrong.
    ///
    /// ```
    /// use voidwalk_core::Gradation;
    /// use voidwalk_practice::Mistake;
    /// let base = Gradation::from_lines(&[(0.08, 0.0), (0.3, 100.0)])?;
    /// let filter = Gradation::from_lines(&[(0.5, 0.0), (2.0, 100.0)])?;
    /// assert_eq!(Mistake::find(&base, &filter, false), None);
    /// assert!(Mistake::find(&filter, &base, false).unwrap().is_refused());
    /// # Ok::<(), voidwalk_core::gradation::GradationError>(())
    /// ```
    pub fn find(base: &Gradation, filter: &Gradation, scale_free: bool) -> Option<Self> {
        /// No base is coarser than its filter by this factor (D50).
        const HOPELESS: f64 = 50.0;
        /// A filter whose D15 is finer than the base's by this factor drains less than the base, while
        /// practice asks for four or five times more: the reversed order is the right one.
        const FINER: f64 = 2.0;
        /// No filter is coarser than this (D50, mm).
        const BOULDERS_MM: f64 = 300.0;
        let sizes = [base, filter].map(|soil| [15.0, 50.0].map(|percent| Bounds::of(soil, percent)));
        let [[d15b, d50b], of_filter @ [d15f, d50f]] = sizes;
        if d50b.least > HOPELESS * d50f.most && d15b.most > d15f.least && !scale_free {
            let note = Note::UnitDoubtful { base_d50_mm: d50b.least, filter_d50_mm: d50f.most };
            let sizes = Box::new(sizes);
            return Some(Self { kind: MistakeKind::Unit, note, sizes, regraded_at_mm: None });
        }
        let BaseSoil { gradation, regraded_at_mm, .. } = BaseSoil::of(base, scale_free);
        let regraded = Bounds::of(&gradation, 50.0);
        // The part of a gap-graded base that practice uses may be far finer than its D15.
        let looked_at = Bounds::of(&gradation, 85.0);
        let is_fine = regraded_at_mm.is_some() && looked_at.most < d15f.least;
        let is_far = d15b.least > FINER * d15f.most && !is_fine;
        if is_far || (d15b.least > d15f.most && regraded.least > d50f.most) {
            let kind = if is_far { MistakeKind::Exchanged } else { MistakeKind::Coarser };
            let note = Note::FilesExchanged { base_d15_mm: d15b.most, filter_d15_mm: d15f.most };
            let sizes = Box::new([[d15b, regraded], of_filter]);
            return Some(Self { kind, note, sizes, regraded_at_mm });
        }
        (d50f.least > BOULDERS_MM && !scale_free).then(|| Self {
            kind: MistakeKind::Boulders,
            note: Note::FilterOfBoulders { d50_mm: d50f.least },
            sizes: Box::new(sizes),
            regraded_at_mm: None,
        })
    }

    /// Looks for mistakes in two envelopes, with every base and the coarsest filter. A single sensible
    /// pair of curves prevents a refusal.
    pub(crate) fn of_envelopes(bases: &[NamedCurve], filters: &[NamedCurve]) -> Option<Self> {
        let d15 = |curve: &NamedCurve| curve.1.d(15.0).unwrap_or(0.0);
        let (_, coarsest) = filters.iter().max_by(|a, b| d15(a).total_cmp(&d15(b)))?;
        let mut all = Vec::new();
        for (_, base) in bases {
            all.push(Self::find(base, coarsest, false)?);
        }
        let refused = all.iter().position(|mistake| !mistake.is_refused()).unwrap_or(0);
        all.into_iter().nth(refused)
    }

    /// True if the two tables are refused unless the user says they are as given.
    pub fn is_refused(&self) -> bool {
        matches!(self.kind, MistakeKind::Unit | MistakeKind::Exchanged)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::DESIGN;
    use crate::test_soils::{TILL, curve};

    /// The till of the first trial, with 35 % fines, on a gravel with a D15 of 6.3 mm.
    #[test]
    fn a_till_on_a_gravel_is_not_retained() {
        let pair = PairRules::of(&curve(&TILL), &Gradation::linear_from_dx(15.0, 6.3, 1.5).unwrap());
        assert_eq!((pair.base.category, pair.base.regraded), (Some(3), true));
        let met = |id: &str| pair.rules.iter().find(|rule| rule.id == id).unwrap().met;
        assert_eq!(met("sherard-dunnigan"), Some(false));
        assert_eq!(met("foster-fell-no-erosion"), Some(false));
        assert_eq!(met("foster-fell-continuing"), None);
        assert_eq!(met("permeability"), Some(true));
        assert!(pair.notes.is_empty());
    }

    /// A sand has a smaller D85 than a clay with gravel, and allows a coarser filter.
    #[test]
    fn the_curve_with_the_lower_limit_counts_though_its_d85_is_larger() {
        let soil = |name: &str, points: &[(f64, f64)]| (name.to_owned(), curve(points));
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

    #[test]
    fn exchanged_tables_and_micrometres_are_recognised() {
        let mistake = |base: f64, filter: f64| {
            let [base, filter] = [base, filter].map(|d0| Gradation::linear_from_d0(d0, 2.0).unwrap());
            Mistake::find(&base, &filter, false)
        };
        assert_eq!(mistake(0.2, 2.0), None);
        let exchanged = mistake(2.0, 0.2).unwrap();
        assert_eq!(exchanged.kind, MistakeKind::Exchanged);
        let refusal = Refusal(&exchanged, "--as-given").to_string();
        assert!(refusal.contains("are the two files exchanged?") && refusal.ends_with("(--as-given)"));
        // 318 um read as mm.
        let micrometres = mistake(200.0, 2.0).unwrap();
        assert!(micrometres.to_string().contains("micrometres under a header in mm"));
        assert_eq!(micrometres.kind, MistakeKind::Unit);
        let boulders = mistake(0.2, 400.0).unwrap();
        assert!(boulders.to_string().contains("the filter's D50 is 800 mm") && !boulders.is_refused());
    }

    /// A gravel regraded on a gap: practice uses its silt, which cannot be mistaken for a filter.
    #[test]
    fn a_base_that_is_regraded_at_a_gap_is_no_exchange() {
        let gravel =
            curve(&[(0.01, 0.0), (0.05, 9.0), (0.06, 12.0), (2.0, 12.0), (8.0, 60.0), (20.0, 100.0)]);
        let filter = curve(&[(0.15, 0.0), (0.2, 15.0), (0.6, 60.0), (2.0, 100.0)]);
        let BaseSoil { regraded_at_mm, gradation, .. } = BaseSoil::of(&gravel, false);
        assert!(
            regraded_at_mm.is_some() && gradation.d(85.0).unwrap() < 0.2 && gravel.d(15.0).unwrap() > 0.4
        );
        assert_eq!(Mistake::find(&gravel, &filter, false), None);
    }

    /// A till whose D50 is above the D50 of its filter sand, and sands close to their filter, which get a
    /// warning.
    #[test]
    fn a_broad_till_and_two_soils_that_are_close_are_no_exchange() {
        let till = [(0.002, 2.0), (0.02, 15.0), (0.075, 22.0), (0.425, 34.0), (5.0, 50.0), (75.0, 100.0)];
        let till = curve(&till);
        let c33 =
            [(0.075, 1.5), (0.15, 5.0), (0.3, 17.5), (0.6, 42.5), (1.18, 67.5), (2.36, 90.0), (9.5, 100.0)];
        let c33 = curve(&c33);
        assert!(till.d(50.0) > c33.d(50.0) && till.d(15.0).unwrap() < 0.021);
        let sand = |d15: f64| Gradation::linear_from_dx(15.0, d15, 2.0).unwrap();
        for (base, filter, kind, is_refused) in [
            (&till, &c33, None, false),
            (&c33, &till, Some(MistakeKind::Exchanged), true),
            (&sand(0.3), &sand(0.18), Some(MistakeKind::Coarser), false),
            (&sand(0.37), &sand(0.18), Some(MistakeKind::Exchanged), true),
        ] {
            let mistake = Mistake::find(base, filter, false);
            assert_eq!(mistake.as_ref().is_some_and(Mistake::is_refused), is_refused);
            assert_eq!(mistake.map(|mistake| mistake.kind), kind);
        }
    }
}
