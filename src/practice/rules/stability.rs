//! Rules by which the filter holds its own fines.

use super::rule::{Judged, RuleInputs};
use crate::{RuleNote, ValueBound, WithoutFiner};
use voidwalk_core::gradation::{BROAD_CU, FINES_MM, Gradation, KEZDI_RANGE, ShapeIndex, WIDE_LOOSE_PERCENT};

/// Limit of Kezdi's ratio.
const KEZDI: f64 = 4.0;

/// Percent finer than the finest sieve above which an index of the rest of the curve is only a bound.
pub(super) const MOST_HIDDEN_PERCENT: f64 = 5.0;

/// Kezdi's ratio over the range of splits that is judged.
pub(crate) fn kezdi(inputs: &RuleInputs) -> Judged {
    let filter = inputs.filter;
    let [from, to] = KEZDI_RANGE.map(|of_fine_d85| of_fine_d85 / 0.85);
    let tail = 100.0 * filter.pan_fraction();
    let worst = filter.kezdi();
    let notes = worst.map(|split| {
        let at = RuleNote::KezdiAt(split.percent, split.coarse_d15_mm, split.fine_d85_mm);
        let hidden = (tail > KEZDI_RANGE[0]).then_some(RuleNote::KezdiHidden(tail));
        [Some(at), Some(RuleNote::KezdiSplits(from, to)), hidden].into_iter().flatten().collect()
    });
    let judged = index(inputs, KEZDI, worst.map(|split| split.value), notes.unwrap_or_default());
    // The part that may be lost is the largest one that the rest does not hold, not the one with the
    // worst ratio. If no such part can lie loose, the one with the worst ratio counts.
    let lost = worst.map(|worst| filter.greatest_split_above(KEZDI, WIDE_LOOSE_PERCENT).unwrap_or(worst));
    let left = lost.map(|split| WithoutFiner { percent: split.percent, d15f: split.coarse_d15_mm });
    let judged = Judged { without_finer: left, ..judged };
    // The part below the finest sieve may have a greater ratio.
    if tail > KEZDI_RANGE[0] { judged.bound(ValueBound::AtLeast) } else { judged }
}

/// Index of the shape curve: Kenney and Lau's, or Li and Fannin's, which combines theirs and Kezdi's.
pub(crate) fn shape(inputs: &RuleInputs, index_of: fn(&Gradation) -> Option<ShapeIndex>) -> Judged {
    let (filter, shape) = (inputs.filter, index_of(inputs.filter));
    let most = filter.loose_percent().unwrap_or(f64::NAN);
    let at_f = |shape: ShapeIndex| match 100.0 * filter.pan_fraction() {
        0.0 => RuleNote::ShapeAt(shape.percent, most),
        pan => RuleNote::ShapeAbovePan(shape.percent, pan, most),
    };
    let judged = index(inputs, 1.0, shape.map(|shape| shape.value), shape.map(at_f).into_iter().collect());
    let left = shape.and_then(|shape| without(filter, shape.lost_percent?));
    let judged = Judged { without_finer: left, ..judged };
    // Below the finest sieve the index may be smaller.
    let is_hidden = 100.0 * filter.pan_fraction() > MOST_HIDDEN_PERCENT;
    if is_hidden { judged.bound(ValueBound::AtMost) } else { judged }
}

/// Remainder of a filter without the part finer than this percent.
fn without(filter: &Gradation, percent: f64) -> Option<WithoutFiner> {
    Some(WithoutFiner { percent, d15f: filter.d(percent + 0.15 * (100.0 - percent))? })
}

/// Result of an index of the filter's shape, with its notes.
fn index(inputs: &RuleInputs, limit: f64, value: Option<f64>, notes: Vec<RuleNote>) -> Judged {
    let lacking = |needs| Judged::of(None, Some(limit)).lacking(needs);
    if !inputs.filter_is_measured {
        return Judged { applies: false, ..lacking(RuleNote::NeedsCurveOfFilter) };
    }
    match value {
        Some(value) => Judged { notes, ..Judged::of(Some(value), Some(limit)) },
        None => lacking(RuleNote::NeedsFinestPartOfFilter),
    }
}

/// True if a filter is neither broadly graded nor gap-graded.
fn is_uniform(filter: &Gradation) -> bool {
    filter.cu().is_some_and(|cu| cu < BROAD_CU) && filter.gap(0.0).is_none()
}

/// Burenkova's range of uniformity, for soils like those on which Wan and Fell assessed it. They found no
/// clear boundary, and uniform stones without fines to lose lie below it. Above it her own zone III is
/// also suffusive; Wan and Fell tested no soil there and expect such soils to be stable.
pub(crate) fn burenkova(inputs: &RuleInputs) -> Judged {
    let filter = inputs.filter;
    if !inputs.filter_is_measured {
        return Judged::default().lacking(RuleNote::NeedsCurveOfFilter);
    }
    let Some(factors) = filter.uniformity_factors() else {
        return Judged::of(None, None).lacking(RuleNote::NeedsD15F);
    };
    let [low, high] = factors.stable();
    let judged =
        Judged::of(Some(factors.coarse), Some(low)).noted(RuleNote::BurenkovaRange(factors.whole, low, high));
    let is_too_wide = filter.cu().is_some_and(|cu| cu > 200.0);
    if filter.largest_mm() > 100.0 && !inputs.scale_free || is_too_wide {
        return judged.not_for(RuleNote::BurenkovaSoils);
    }
    if is_uniform(filter) {
        return judged.not_for(RuleNote::UniformFilter);
    }
    if factors.coarse >= high { judged.not_for(RuleNote::BurenkovaThirdZone(high)) } else { judged }
}

/// Wan and Fell's probability of instability, given as contours without a limit.
pub(crate) fn wan_fell(inputs: &RuleInputs) -> Judged {
    let filter = inputs.filter;
    if !inputs.filter_is_measured || inputs.scale_free {
        return Judged::default().lacking(RuleNote::NeedsCurveOfFilter);
    }
    if is_uniform(filter) {
        return Judged::default().not_for(RuleNote::UniformFilter);
    }
    let Some(factors) = filter.uniformity_factors() else {
        return Judged::of(None, None).lacking(RuleNote::NeedsD15F);
    };
    let fines = filter.percent_finer_by_mass(FINES_MM);
    if filter.percent_finer_if_known(FINES_MM).is_none() && fines > 10.0 {
        return Judged::of(None, None).lacking(RuleNote::NeedsFinesOfFilter);
    }
    let soil = if fines <= 10.0 { RuleNote::WanFellSand } else { RuleNote::WanFellSilt };
    Judged::of(Some(100.0 * factors.probability_of_instability(fines <= 10.0)), None)
        .noted(soil)
        .noted(RuleNote::WanFellContours)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::tests::{applied, base, close, filter, of_band};
    use crate::rules::{LI_FANNIN, RULES, apply};
    use crate::test_soils::curve;
    use crate::{RuleRole, RuleUnit};

    #[test]
    fn the_row_of_kezdi_names_the_splits_that_are_judged() {
        let [from, to] = KEZDI_RANGE.map(|of_fine_d85| of_fine_d85 / 0.85);
        let rule = RULES.iter().find(|rule| rule.id == "kezdi").unwrap();
        assert_eq!(rule.quantity.to_string(), format!("D'15/d'85, split at {from:.1} to {to:.1} %"));
    }

    /// The gap-graded filter of the first trial: 40 % below 0.5 mm, nothing up to 5 mm. Also a filter
    /// with 15 % below the gap, a percent that Kenney and Lau judge.
    #[test]
    fn internal_stability_by_hand() {
        let soil = base(5.0, 0.5);
        let gap = curve(&[(0.1, 0.0), (0.5, 40.0), (5.0, 40.0), (20.0, 100.0)]);
        // From F = 25 % the next 15 % end beyond the gap: 5 mm over D25 = 0.1 x 5^(25/40).
        let rule = applied("kezdi", &gap, &soil);
        assert!(close(rule.value, 50.0 / 5.0f64.powf(0.625)) && rule.met == Some(false), "{rule:?}");
        // The ratio belongs to a split at 25/0.85 = 29.4 % finer: D40 above the gap over D25 below it.
        // Splits from 15/0.85 to 55/0.85 % finer are judged.
        let [RuleNote::KezdiAt(split, coarse, fine), RuleNote::KezdiSplits(from, to)] = rule.notes[..] else {
            panic!("{rule:?}")
        };
        let wanted = [25.0 / 0.85, 5.0, 0.1 * 5.0f64.powf(0.625), 15.0 / 0.85, 55.0 / 0.85];
        for (value, wanted) in [split, coarse, fine, from, to].into_iter().zip(wanted) {
            assert!((value / wanted - 1.0).abs() < 1e-6, "{value} {wanted}");
        }
        let unstable = curve(&[(0.1, 0.0), (0.2, 15.0), (4.0, 15.0), (20.0, 100.0)]);
        for id in ["kenney-lau", "li-fannin"] {
            let rule = applied(id, &unstable, &soil);
            assert!(close(rule.value, 0.0) && rule.met == Some(false), "{rule:?}");
            let [RuleNote::ShapeAt(at, _)] = rule.notes[..] else { panic!("{rule:?}") };
            assert!(close(Some(at), 15.0), "{rule:?}");
        }
        // Straight with Cu 60: H = 50 ln 4 / ln 60 = 16.93 %, less than F = 20 % and more than 15 %.
        let broad = curve(&[(0.1, 0.0), (360.0, 100.0)]);
        let h = 50.0 * 4.0f64.ln() / 60.0f64.ln();
        assert!(close(applied("kenney-lau", &broad, &soil).value, h / 20.0));
        assert!(close(applied("li-fannin", &broad, &soil).value, h / 15.0));
    }

    #[test]
    fn a_linear_filter_is_an_assumption_and_has_no_stability() {
        let (filter, base) = (filter(1.0), base(5.0, 0.5));
        let inputs = RuleInputs { filter_is_measured: false, ..RuleInputs::of_soils(&base, &filter) };
        for rule in apply(&inputs).iter().filter(|rule| rule.role == RuleRole::Stability) {
            assert_eq!((rule.value, rule.met), (None, None));
            assert_eq!(rule.needs, [RuleNote::NeedsCurveOfFilter]);
        }
    }

    #[test]
    fn burenkova_and_wan_and_fell_by_hand() {
        // h' = 2, h'' = 100: the range begins at 2.52; the probability is 1 / (1 + exp(-3.004)).
        let soil = base(5.0, 0.5);
        let broad = curve(&[(0.08, 0.0), (0.1, 15.0), (2.0, 30.0), (5.0, 60.0), (10.0, 90.0), (20.0, 100.0)]);
        let rule = applied("burenkova", &broad, &soil);
        assert!(close(rule.value, 2.0) && close(rule.limit, 2.52) && rule.met == Some(false), "{rule:?}");
        let gap =
            [(0.08, 0.0), (0.1, 15.0), (0.2, 30.0), (2.0, 30.0), (5.0, 60.0), (10.0, 90.0), (20.0, 100.0)];
        let rule = applied("wan-fell", &curve(&gap), &soil);
        let by_hand = 100.0 / (1.0 + (-3.004f64).exp());
        assert!(rule.value.is_some_and(|value| (value - by_hand).abs() < 1e-6), "{rule:?}");
        assert!(rule.met.is_none() && rule.limit.is_none() && rule.applies && rule.unit == RuleUnit::Percent);
        // Wan and Fell tested neither uniform sand nor No. 78 stone, which Burenkova's range would reject.
        let uniform = curve(&[(1.0, 0.0), (2.25, 100.0)]);
        assert!(!applied("wan-fell", &uniform, &soil).applies);
        let stone =
            curve(&[(1.18, 2.5), (2.36, 5.0), (4.75, 15.0), (9.5, 57.5), (12.5, 95.0), (19.0, 100.0)]);
        let rule = applied("burenkova", &stone, &soil);
        assert!(rule.value < rule.limit && !rule.applies && rule.met.is_none(), "{rule:?}");
        // A long coarse tail lies in her third zone, which has no result.
        let tailed = curve(&[(0.05, 0.0), (0.1, 5.0), (1.0, 15.0), (2.5, 60.0), (19.0, 90.0), (30.0, 100.0)]);
        let rule = applied("burenkova", &tailed, &soil);
        assert!(!rule.applies && rule.met.is_none(), "{rule:?}");
        assert!(rule.notes.iter().any(|note| matches!(note, RuleNote::BurenkovaThirdZone(_))), "{rule:?}");
    }

    /// Kezdi's ratio exceeds 4 at splits of 1 % and 100 % of an ordinary filter, which is no reason for
    /// concern.
    #[test]
    fn the_ends_of_an_ordinary_filter_raise_no_alarm() {
        let filter = curve(&[(0.075, 0.5), (0.3, 2.0), (0.6, 10.0), (1.2, 40.0), (4.0, 100.0)]);
        assert!(filter.d(15.85).unwrap() / filter.d(0.85).unwrap() > 4.0);
        let sieves = [0.075, 0.15, 0.3, 0.6, 1.18, 2.36, 4.75, 9.5];
        let middle = [1.5, 5.0, 17.5, 37.5, 67.5, 90.0, 97.5, 100.0];
        let c33 = curve(&sieves.into_iter().zip(middle).collect::<Vec<_>>());
        assert!(c33.d(100.0).unwrap() / c33.d(85.0).unwrap() > 4.0);
        for filter in [filter, c33] {
            for id in ["kezdi", "kenney-lau", "li-fannin", "burenkova"] {
                let rule = applied(id, &filter, &base(5.0, 0.5));
                assert!(rule.met != Some(false), "{rule:?}");
            }
        }
    }

    /// Half of the mass between two sieves of a filter, placed at each of them, makes a gap, though all
    /// of it at either end does not.
    #[test]
    fn a_step_that_may_hide_a_gap_leaves_stability_open() {
        let of_rows = |rows: &[(f64, f64)]| Gradation::from_points(rows, None).unwrap();
        let silt = base(22.0, 0.7);
        let two_sieves = of_rows(&[(0.3, 12.0), (38.0, 100.0)]);
        let open = applied("kezdi", &two_sieves, &silt);
        assert_eq!((open.met, open.value), (None, None), "{open:?}");
        assert_eq!(open.needs, [RuleNote::FilterBetween(0.3, 38.0)]);
        // With sieves between, the filter is stable by Kézdi, and with a gap there it is not.
        let line =
            [(0.3, 12.0), (0.75, 28.7), (1.9, 45.5), (4.75, 62.2), (9.5, 74.8), (19.0, 87.4), (38.0, 100.0)];
        assert_eq!(applied("kezdi", &of_rows(&line), &silt).met, Some(true));
        let gap = curve(&[(0.3, 12.0), (0.31, 56.0), (37.0, 56.1), (38.0, 100.0)]);
        assert_eq!(applied("kezdi", &gap, &silt).met, Some(false));
        // Where next to nothing passes, a wide step hides no gap.
        let stone = of_rows(&[(0.3, 0.0), (1.5, 3.0), (3.0, 30.0), (6.0, 70.0), (12.0, 100.0)]);
        assert_eq!(applied("kezdi", &stone, &silt).met, Some(true));
    }

    /// With 20 % below the finest sieve, no split at 17.6 % is judged: the hidden part may be worse.
    #[test]
    fn what_the_finest_part_hides_is_not_met() {
        let [narrow, gap] =
            [&[(0.5, 20.0), (4.0, 100.0)][..], &[(0.5, 20.0), (0.6, 30.0), (6.0, 30.0), (8.0, 100.0)]];
        for (filter, met) in [(narrow, None), (gap, Some(false))] {
            let rule = of_band("kezdi", &[filter]);
            assert_eq!((rule.value_bound, rule.met), (Some(ValueBound::AtLeast), met), "{rule:?}");
        }
        let band = of_band("filter-band", &[&[(0.5, 8.0), (4.0, 100.0)], &[(0.6, 8.0), (5.0, 100.0)]]);
        assert_eq!((band.value_bound, band.met), (Some(ValueBound::AtLeast), None), "{band:?}");
        let is_from_8 =
            |note: &RuleNote| matches!(*note, RuleNote::BandFrom(percent) if (percent - 8.0).abs() < 1e-9);
        assert!(band.notes.iter().any(is_from_8), "{band:?}");
    }

    #[test]
    fn a_shape_index_says_from_where_it_was_judged() {
        let judged = of_band("kenney-lau", &[&[(0.5, 2.0), (1.0, 30.0), (4.0, 100.0)]]);
        assert_eq!(judged.met, Some(true));
        let [RuleNote::ShapeAbovePan(_, from, most)] = judged.notes[..] else { panic!("{judged:?}") };
        assert!((from - 2.0).abs() < 1e-9 && most == 30.0, "{judged:?}");
        let whole = of_band("kenney-lau", &[&[(0.5, 0.0), (1.0, 30.0), (4.0, 100.0)]]);
        assert!(matches!(whole.notes[..], [RuleNote::ShapeAt(..)]), "{whole:?}");
    }

    /// In a band, the curve with the coarsest remainder counts, even if another has the worst index.
    #[test]
    fn what_is_left_of_a_band_is_that_of_its_coarsest_curve() {
        let gap = |scale: f64, fines: f64| {
            [(0.1, 0.0), (0.2, fines), (2.0, fines), (6.0, 100.0)].map(|(size, finer)| (scale * size, finer))
        };
        let (fine, coarse) = (gap(1.0, 18.0), gap(2.0, 12.0));
        let left = |filters: &[&[(f64, f64)]]| of_band(LI_FANNIN, filters).without_finer.unwrap();
        let both = left(&[&fine, &coarse]);
        assert_eq!(both, left(&[&coarse]));
        assert!(both.d15f > left(&[&fine]).d15f, "{both:?}");
    }
}
