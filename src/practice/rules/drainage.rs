//! Rules by which a filter drains and can be placed.
//!
//! An unknown never hides a failure: a size finer than the finest sieve is at most that sieve.

use super::rule::{Judged, RuleInputs};
use crate::{RuleNote, ValueBound};
use voidwalk_core::gradation::{FINES_MM, Gradation};

/// Minimum D15F for any base (mm).
pub const LEAST_D15F_MM: f64 = 0.1;

/// Maximum fines of a filter (%).
pub const MOST_FINES_PERCENT: f64 = 5.0;

/// Maximum size of a filter (mm).
pub const GREATEST_SIZE_MM: f64 = 75.0;

/// Maximum Cu of a side of a filter's band.
pub const MOST_CU: f64 = 6.0;

/// Maximum ratio of sizes of the coarse side of a band to the fine side.
pub const WIDEST_BAND: f64 = 5.0;

/// Checks that the filter drains the base: D15F is at least `times` D15B, before regrading.
pub(crate) fn permeability(inputs: &RuleInputs, times: f64) -> Judged {
    let least = if inputs.scale_free { 0.0 } else { LEAST_D15F_MM };
    let (d15f, d15b) = (inputs.d15f(), inputs.base.coarse_d(15.0));
    let of_base = times * d15b.unwrap_or(inputs.base.smallest_mm());
    let limit = of_base.max(least);
    let finest = inputs.filter.smallest_mm();
    if d15b.is_none() && of_base <= least {
        // The minimum for any filter governs, however fine D15B is.
        let judged = Judged::of(d15f, Some(limit)).noted(RuleNote::LeastGoverns(times, of_base));
        return match d15f {
            Some(_) => judged,
            None if finest < limit => {
                let judged = Judged { value: Some(finest), met: Some(false), ..judged };
                judged.bound(ValueBound::AtMost).noted(RuleNote::D15FAtMost)
            }
            None => judged.lacking(RuleNote::NeedsD15FSieved),
        };
    }
    // If D15B is finer than the finest sieve, the limit lies between that minimum and this one.
    let surely = if d15b.is_some() { limit } else { least };
    let judged = match (d15f, d15b) {
        (Some(_), Some(_)) => Judged::of(d15f, Some(limit)).noted(RuleNote::BeforeRegrading),
        (None, _) if finest < surely => {
            let judged = Judged { met: Some(false), ..Judged::of(Some(finest), Some(limit)) };
            judged.bound(ValueBound::AtMost).noted(RuleNote::D15FAtMost)
        }
        (None, Some(_)) => Judged::of(None, Some(limit)).lacking(RuleNote::NeedsD15FSieved),
        (Some(d15f), None) if d15f >= limit => {
            Judged::of(Some(d15f), Some(limit)).noted(RuleNote::LimitAtMost)
        }
        (Some(d15f), None) if d15f < least => {
            Judged { met: Some(false), ..Judged::of(Some(d15f), Some(least)) }.noted(RuleNote::LimitAtLeast)
        }
        (_, None) => Judged::of(d15f, Some(limit)).lacking(RuleNote::NeedsD15B),
    };
    Judged { limit_at_most: d15b.is_none() && judged.limit == Some(limit), ..judged }
}

pub(crate) fn fines(inputs: &RuleInputs) -> Judged {
    const MOST: Option<f64> = Some(MOST_FINES_PERCENT);
    if inputs.scale_free || !inputs.filter_is_measured {
        return Judged { limit: MOST, ..Judged::default() }.lacking(RuleNote::NeedsCurveOfFilterInMm);
    }
    let filter = inputs.filter;
    match (filter.percent_finer_if_known(FINES_MM), filter.percent_finer_by_mass(FINES_MM)) {
        (Some(known), _) => Judged::of(Some(known), MOST),
        (None, most) if most <= MOST_FINES_PERCENT => {
            let note = RuleNote::FinestSieveOfFilter(filter.smallest_mm());
            Judged::of(Some(most), MOST).bound(ValueBound::AtMost).noted(note)
        }
        (None, _) => Judged::of(None, MOST).lacking(RuleNote::NeedsFinesOfFilter),
    }
}

pub(crate) fn greatest_size(inputs: &RuleInputs) -> Judged {
    const MOST: Option<f64> = Some(GREATEST_SIZE_MM);
    if inputs.scale_free || !inputs.filter_is_measured {
        return Judged { limit: MOST, ..Judged::default() }.lacking(RuleNote::NeedsCurveOfFilterInMm);
    }
    Judged::of(Some(inputs.filter.largest_mm()), MOST)
}

/// Checks that the filter is uniform enough: a band of broader curves leaves room for gap-graded ones.
pub(crate) fn uniformity(inputs: &RuleInputs) -> Judged {
    const MOST: Option<f64> = Some(MOST_CU);
    match (inputs.filter_is_measured, inputs.filter.cu()) {
        (false, _) => Judged { limit: MOST, ..Judged::default() }.lacking(RuleNote::NeedsCurveOfFilter),
        (true, None) => {
            // D10 is at most the finest sieve, or D60 is also finer than it.
            let least = inputs.filter.d(60.0).map(|d60| d60 / inputs.filter.smallest_mm());
            match least.filter(|least| Some(*least) > MOST) {
                Some(least) => {
                    Judged::of(Some(least), MOST).bound(ValueBound::AtLeast).noted(RuleNote::CuAtLeast)
                }
                None => Judged::of(None, MOST).lacking(RuleNote::NeedsD10F),
            }
        }
        (true, cu) => Judged::of(cu, MOST),
    }
}

/// Percents finer between which the sides of a band are compared. D5 is the smallest size that designs
/// state, and sizes below it depend on the finest sieve; the upper percent is the rule's.
const BAND: [f64; 2] = [5.0, 60.0];

/// Checks that the band of the filter is narrow: ratio of its coarse side to its fine side.
pub(crate) fn band(inputs: &RuleInputs) -> Judged {
    if inputs.filter_curves.len() < 2 {
        return Judged::left_out();
    }
    let widest = |percent: f64| {
        let sizes: Vec<f64> =
            inputs.filter_curves.iter().map(|curve| curve.d(percent)).collect::<Option<_>>()?;
        let (least, most) =
            sizes.iter().fold((f64::INFINITY, 0.0f64), |(low, high), &d| (low.min(d), high.max(d)));
        Some((percent, most / least))
    };
    // Between two points of the curves the ratio has no extreme.
    let of_curve = |curve: &&Gradation| curve.points().into_iter().map(|point| point.percent);
    let percents = inputs.filter_curves.iter().flat_map(of_curve).chain(BAND);
    let within = percents.filter(|percent| (BAND[0]..=BAND[1]).contains(percent));
    let Some((percent, ratio)) = within.filter_map(widest).max_by(|a, b| a.1.total_cmp(&b.1)) else {
        return Judged::of(None, Some(WIDEST_BAND)).lacking(RuleNote::NeedsSievesOfFilter);
    };
    let judged = Judged::of(Some(ratio), Some(WIDEST_BAND)).noted(RuleNote::AtPercentFiner(percent));
    // Below the finest sieve the band may be wider.
    let pan = inputs.filter_curves.iter().map(|curve| 100.0 * curve.pan_fraction()).fold(0.0, f64::max);
    if pan > BAND[0] { judged.bound(ValueBound::AtLeast).noted(RuleNote::BandFrom(pan)) } else { judged }
}
