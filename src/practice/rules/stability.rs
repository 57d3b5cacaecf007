//! Rules by which the filter holds its own fines.

use super::rule::{Judged, RuleInputs};
use crate::{RuleNote, ValueBound, WithoutFiner};
use voidwalk_core::gradation::{BROAD_CU, FINES_MM, Gradation, KEZDI_RANGE, ShapeIndex, WIDE_LOOSE_PERCENT};

/// Limit of Kezdi's ratio.
const KEZDI: f64 = 4.0;

/// Percent below the finest sieve from which an index of the rest of the curve is only a bound.
pub(super) const MOST_HIDDEN_PERCENT: f64 = 5.0;

/// Kezdi's ratio over sensible splits.
pub fn kezdi(inputs: &RuleInputs) -> Judged {
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
    // The part that may be lost is the greatest part that the rest does not hold, rather than the part of the
    // worst ratio; if no such part may lie loose, the part of the worst ratio.
    let lost = worst.map(|worst| filter.greatest_split_above(KEZDI, WIDE_LOOSE_PERCENT).unwrap_or(worst));
    let left = lost.map(|split| WithoutFiner { percent: split.percent, d15f: split.coarse_d15_mm });
    let judged = Judged { without_finer: left, ..judged };
    // The hidden part may have a greater ratio.
    if tail > KEZDI_RANGE[0] { judged.bound(ValueBound::AtLeast) } else { judged }
}

/// Kenney and Lau's shape curve.
pub fn kenney_lau(inputs: &RuleInputs) -> Judged {
    shape(inputs, Gradation::kenney_lau)
}

/// Li and Fannin's criterion: Kezdi's and Kenney and Lau's together.
pub fn li_fannin(inputs: &RuleInputs) -> Judged {
    shape(inputs, Gradation::li_fannin)
}

fn shape(inputs: &RuleInputs, index_of: fn(&Gradation) -> Option<ShapeIndex>) -> Judged {
    let (filter, shape) = (inputs.filter, index_of(inputs.filter));
    let most = filter.loose_percent().unwrap_or(f64::NAN);
    let at_f = |shape: ShapeIndex| match 100.0 * filter.pan_fraction() {
        0.0 => RuleNote::ShapeAt(shape.percent, most),
        pan => RuleNote::ShapeAbovePan(shape.percent, pan, most),
    };
    let judged = index(inputs, 1.0, shape.map(|shape| shape.value), shape.map(at_f).into_iter().collect());
    let left = shape.and_then(|shape| without(filter, shape.lost_percent?));
    let judged = Judged { without_finer: left, ..judged };
    // Below the finest sieve the index may be less.
    let is_hidden = 100.0 * filter.pan_fraction() > MOST_HIDDEN_PERCENT;
    if is_hidden { judged.bound(ValueBound::AtMost) } else { judged }
}

/// Remainder of a filter without the part finer than this percent.
fn without(filter: &Gradation, percent: f64) -> Option<WithoutFiner> {
    Some(WithoutFiner { percent, d15f: filter.d(percent + 0.15 * (100.0 - percent))? })
}

/// An index of the filter's shape, and its place.
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

/// Burenkova's range of uniformity, for soils like those on which Wan and Fell judged it. They found no clear
/// boundary, and uniform stones without fines to lose lie below it. Above it her own zone III is suffusive
/// too; Wan and Fell tested no soil there, and expect such soils to be stable.
pub fn burenkova(inputs: &RuleInputs) -> Judged {
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
    match factors.coarse >= high {
        true => judged.not_for(RuleNote::BurenkovaThirdZone(high)),
        false => judged,
    }
}

/// Wan and Fell's probability of instability. They state contours and no limit.
pub fn wan_fell(inputs: &RuleInputs) -> Judged {
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
    let is_known = filter.pan_fraction() == 0.0 || filter.smallest_mm() <= FINES_MM;
    if !is_known && fines > 10.0 {
        return Judged::of(None, None).lacking(RuleNote::NeedsFinesOfFilter);
    }
    let soil = match fines <= 10.0 {
        true => RuleNote::WanFellSand,
        false => RuleNote::WanFellSilt,
    };
    Judged::of(Some(100.0 * factors.probability_of_instability(fines <= 10.0)), None)
        .noted(soil)
        .noted(RuleNote::WanFellContours)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::RULES;

    #[test]
    fn the_row_of_kezdi_names_the_splits_that_are_judged() {
        let [from, to] = KEZDI_RANGE.map(|of_fine_d85| of_fine_d85 / 0.85);
        let rule = RULES.iter().find(|rule| rule.id == "kezdi").unwrap();
        assert_eq!(rule.quantity.to_string(), format!("D'15/d'85, split at {from:.1} to {to:.1} %"));
    }
}
