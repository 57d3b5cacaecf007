//! Answer for a base if dispersion is not stated.
//!
//! A sieve table does not show dispersion. Dispersive soils have other boundaries in tests and other
//! limits in practice.

use crate::retention::{lost_beyond, open_retention, retention, washout};
use crate::rules::{NamedCurve, RuleInputs, apply};
use crate::{AppliedRule, Note};
use serde::{Deserialize, Serialize};
use voidwalk_core::gradation::{FEW_FINES, Gradation};

/// Limit of practice if a base is dispersive, for a base without a statement about dispersion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct IfDispersive {
    /// Maximum D15F (mm) for a dispersive base.
    pub d15f_max_mm: f64,
    /// True if the limit is not known exactly and is at most `d15f_max_mm`.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub at_most: bool,
    /// Reason why the limit is not known; `None` if it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lacks: Option<DispersiveLack>,
}

/// Reason why the limit of a dispersive base is not known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub enum DispersiveLack {
    /// No available source gives a limit of design for such fines; that of no erosion is an upper bound.
    #[serde(rename = "limit of design")]
    LimitOfDesign,
    /// No source that was read gives any limit for such fines; the limit of other bases is an upper
    /// bound.
    #[serde(rename = "any limit")]
    AnyLimit,
    /// The sieves do not give the base's D85.
    #[serde(rename = "D85B")]
    D85B,
}

impl IfDispersive {
    /// Limit for a pair whose base is taken as dispersive; `None` if its fines are few or not known.
    pub fn of(if_dispersive: &RuleInputs) -> Option<Self> {
        if if_dispersive.base_soil.fines_percent? < FEW_FINES {
            return None;
        }
        let rules = apply(if_dispersive);
        let (strictest, d15f_max_mm) = retention(&rules, if_dispersive.filter.d(15.0).unwrap_or(1.0))?;
        // A rule that is broken in any case does not report a missing input.
        let lack = match if_dispersive.size_of_base(85.0).is_known {
            true if strictest.limit_at_most => DispersiveLack::AnyLimit,
            true => DispersiveLack::LimitOfDesign,
            false => DispersiveLack::D85B,
        };
        let lacks = open_retention(&rules).map(|_| lack);
        Some(Self { d15f_max_mm, at_most: lacks.is_some(), lacks })
    }

    /// Strictest limit among the curves of a base with one filter.
    pub(crate) fn of_bases(bases: &[NamedCurve], filter: &Gradation) -> Option<Self> {
        let limit = |(_, base): &NamedCurve| {
            Self::of(&RuleInputs { dispersive: true, ..RuleInputs::of_soils(base, filter) })
        };
        Self::strictest(&bases.iter().filter_map(limit).collect::<Vec<_>>())
    }

    /// Strictest of several limits of one base; `None` if there are none.
    pub(crate) fn strictest(all: &[Self]) -> Option<Self> {
        let least = all.iter().min_by(|a, b| a.d15f_max_mm.total_cmp(&b.d15f_max_mm))?;
        let at_most = all.iter().any(|limit| limit.at_most);
        // If the strictest limit is known, it is no lower than a limit that another curve leaves open.
        let of_another = || match all.iter().find_map(|limit| limit.lacks)? {
            DispersiveLack::AnyLimit => Some(DispersiveLack::LimitOfDesign),
            lack => Some(lack),
        };
        Some(Self { at_most, lacks: least.lacks.or_else(of_another), ..*least })
    }

    /// D15F of a filter that would break the limit of a dispersive base, as placed or without the finer
    /// part that it may lose, if it keeps `rules` otherwise. A filter that fails anyway is not reported
    /// again.
    pub(super) fn broken_by(&self, rules: &[AppliedRule], d15f_mm: Option<f64>) -> Option<BeyondDispersive> {
        let is_kept = |d15f: f64| retention(rules, d15f).is_none_or(|(_, limit)| d15f <= limit);
        if !d15f_mm.is_none_or(is_kept) {
            return None;
        }
        if let Some(d15f_mm) = d15f_mm.filter(|d15f| self.is_broken_by(*d15f)) {
            return Some(BeyondDispersive { limit: *self, d15f_mm, without_percent: None });
        }
        let left = lost_beyond(rules, self.d15f_max_mm).filter(|_| washout(rules).is_none())?;
        let without_percent = Some(left.percent);
        Some(BeyondDispersive { limit: *self, d15f_mm: left.d15f, without_percent })
    }

    /// True if a filter with this D15F (mm) is known to be too coarse for a dispersive base.
    pub fn is_broken_by(&self, d15f_mm: f64) -> bool {
        d15f_mm > self.d15f_max_mm * (1.0 + 1e-9)
    }
}

/// A filter that is too coarse for a dispersive base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeyondDispersive {
    /// Limit that the filter breaks.
    pub limit: IfDispersive,
    /// D15F of the filter (mm).
    pub d15f_mm: f64,
    /// Finer part (percent by mass) whose loss leaves this D15F; `None` for the filter as placed.
    pub without_percent: Option<f64>,
}

/// Note on a base if dispersion is not stated.
pub fn note(if_dispersive: IfDispersive) -> Note {
    let most_d15f_mm = if_dispersive.d15f_max_mm;
    if if_dispersive.at_most {
        Note::DispersiveLimitNotKnown { most_d15f_mm }
    } else {
        Note::DispersionNotKnown { most_d15f_mm }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PairRules;
    use crate::test_soils::{curve, filter};

    fn with_fines(fines: f64) -> [(f64, f64); 4] {
        [(0.01, 0.0), (0.075, fines), (0.3, 92.0), (0.6, 100.0)]
    }

    /// Returns true if a filter with this D15 breaks only the limit of a dispersive base, and this limit.
    fn broken(base: &[(f64, f64)], d15f: f64) -> Option<(bool, IfDispersive)> {
        let pair = PairRules::of(&curve(base), &filter(d15f)[0].1);
        let limit = pair.if_dispersive?;
        Some((limit.broken_by(&pair.rules, Some(d15f)).is_some(), limit))
    }

    /// The limit for such soils is 0.7 mm, or 0.5 mm if they are dispersive.
    #[test]
    fn a_filter_that_a_dispersive_base_would_have_finer_is_told_from_one_that_holds_it() {
        for fines in [36.0, 45.0, 80.0] {
            let base = with_fines(fines);
            for (d15f, is_beyond) in [(0.6, true), (0.45, false)] {
                let (breaks, limit) = broken(&base, d15f).unwrap();
                assert_eq!((breaks, limit.is_broken_by(d15f)), (is_beyond, is_beyond));
                assert!((limit.d15f_max_mm - 0.5).abs() < 1e-9, "{limit:?}");
                // Below 40 % fines, no source that was read gives a limit of design for such a soil; it
                // may be lower.
                assert_eq!(limit.at_most, fines < 40.0);
            }
            // A filter that fails anyway is not reported again.
            assert!(!broken(&base, 0.9).unwrap().0);
        }
    }

    /// A clay whose table ends at No. 200 lacks only its D85: practice has a limit for such fines. This
    /// holds for filters finer and coarser than the maximum possible limit, 6.4 times 0.075 mm.
    #[test]
    fn a_clay_that_no_hydrometer_tested_lacks_its_d85_and_no_source() {
        let clay = [(0.075, 97.0), (0.15, 99.0), (0.3, 100.0)];
        for d15f in [0.4, 0.8] {
            let (_, limit) = broken(&clay, d15f).unwrap();
            assert_eq!(limit.lacks, Some(DispersiveLack::D85B));
        }
        assert!(!broken(&clay, 0.4).unwrap().0);
        // One curve lacks a limit of design, and a finer one lacks nothing.
        let limit_of =
            |d15f_max_mm, lacks: Option<_>| IfDispersive { d15f_max_mm, at_most: lacks.is_some(), lacks };
        let open = limit_of(0.9, Some(DispersiveLack::LimitOfDesign));
        let both = IfDispersive::strictest(&[limit_of(0.5, None), open]).unwrap();
        assert_eq!(both, limit_of(0.5, open.lacks));
        // The known limit must not be read as an upper bound.
        let any = limit_of(0.9, Some(DispersiveLack::AnyLimit));
        assert_eq!(IfDispersive::strictest(&[any, limit_of(0.5, None)]).unwrap(), both);
        assert_eq!(IfDispersive::strictest(&[any, limit_of(1.0, open.lacks)]).unwrap(), any);
    }

    /// A filter of 0.40 mm is within 0.500 mm as placed, and within 0.700 mm after losing its finer part,
    /// but then beyond 0.500 mm.
    #[test]
    fn what_is_left_of_an_unstable_filter_is_judged_by_the_limit_of_a_dispersive_base_too() {
        // Beyond 0.700 mm the filter does not hold the base in any case.
        for (scale, is_washed_out, is_beyond) in [(0.1, false, false), (0.2, false, true), (0.3, true, false)]
        {
            let gap = [(0.30, 0.0), (0.36, 15.0), (2.4, 15.0), (6.0, 100.0)];
            let filter = curve(&gap.map(|(size, percent)| (scale * size, percent)));
            let PairRules { if_dispersive, rules, .. } = PairRules::of(&curve(&with_fines(45.0)), &filter);
            let (limit, d15f) = (if_dispersive.unwrap(), filter.d(15.0));
            let beyond = limit.broken_by(&rules, d15f);
            assert_eq!((washout(&rules).is_some(), beyond.is_some()), (is_washed_out, is_beyond), "{scale}");
            assert!(!limit.is_broken_by(d15f.unwrap()));
            assert!(beyond.is_none_or(|beyond| beyond.without_percent.is_some()));
        }
    }

    #[test]
    fn with_fewer_fines_no_limit_is_known_and_sands_need_no_statement() {
        let (breaks, limit) = broken(&with_fines(25.0), 0.6).unwrap();
        assert_eq!((breaks, limit.lacks), (false, Some(DispersiveLack::AnyLimit)));
        // For other bases the limit is 0.902 mm, which a dispersive base cannot have.
        assert!((limit.d15f_max_mm - 0.902).abs() < 1e-3, "{limit:?}");
        assert!(broken(&with_fines(10.0), 0.6).is_none());
    }
}
