//! Rules by which a filter drains and can be placed. None of them says whether it retains its base.

use super::rule::{Judged, RuleInputs};
use crate::gradation::{FINES_MM, Gradation};

/// Times D15B that D15F is at least.
const TIMES: f64 = 5.0;

/// The least D15F whatever the base (mm).
const LEAST_MM: f64 = 0.1;

/// The filter is coarse enough to drain the base, as it is before regrading.
pub fn permeability(inputs: &RuleInputs) -> Judged {
    let least = if inputs.scale_free { 0.0 } else { LEAST_MM };
    let d15f = inputs.d15f();
    if let Some(d15b) = inputs.base.d(15.0) {
        return Judged::of(d15f, Some((TIMES * d15b).max(least))).noted("base before regrading");
    }
    // D15B is finer than the finest sieve: the limit is at most this.
    let at_most = (TIMES * inputs.base.smallest_mm()).max(least);
    match d15f {
        Some(d15f) if d15f >= at_most => Judged {
            met: Some(true),
            ..Judged::of(Some(d15f), Some(at_most))
                .noted("D15B is finer than the finest sieve: the limit is at most this")
        },
        _ => Judged::of(d15f, None).lacking("needs the base's D15: finer sieves, or base.d0_mm"),
    }
}

/// The filter has few fines.
pub fn fines(inputs: &RuleInputs) -> Judged {
    const MOST: Option<f64> = Some(5.0);
    if inputs.scale_free || !inputs.filter_is_measured {
        return Judged { limit: MOST, ..Judged::default() }.lacking("needs the filter's sieve curve in mm");
    }
    let (filter, finer) = (inputs.filter, inputs.filter.percent_finer_by_mass(FINES_MM));
    match filter.pan_fraction() == 0.0 || filter.smallest_mm() <= FINES_MM || finer <= 5.0 {
        true => Judged::of(Some(finer), MOST),
        false => Judged::of(None, MOST).lacking("needs finer sieves of the filter, down to 0.075 mm"),
    }
}

/// The filter has no cobbles.
pub fn greatest_size(inputs: &RuleInputs) -> Judged {
    const MOST: Option<f64> = Some(75.0);
    match inputs.scale_free || !inputs.filter_is_measured {
        true => Judged { limit: MOST, ..Judged::default() }.lacking("needs the filter's sieve curve in mm"),
        false => Judged::of(Some(inputs.filter.largest_mm()), MOST),
    }
}

/// The filter is uniform enough: a band of wider curves leaves room for gap-graded ones.
pub fn uniformity(inputs: &RuleInputs) -> Judged {
    const MOST: Option<f64> = Some(6.0);
    match (inputs.filter_is_measured, inputs.filter.cu()) {
        (false, _) => Judged { limit: MOST, ..Judged::default() }.lacking("needs the filter's sieve curve"),
        (true, None) => Judged::of(None, MOST).lacking("needs the filter's D10: finer sieves"),
        (true, cu) => Judged::of(cu, MOST),
    }
}

/// Percent finer over which the sides of a band are compared: D5 is the lowest size that designs state, and
/// tails below it depend on the finest sieve; the second limit is the rule's.
const BAND: [f64; 2] = [5.0, 60.0];

/// The band of the filter is narrow: its coarse side over its fine side.
pub fn band(inputs: &RuleInputs) -> Judged {
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
    // Between two points of any of the curves the ratio has no extreme.
    let of_curve = |curve: &&Gradation| curve.points().into_iter().map(|(_, percent)| percent);
    let percents = inputs.filter_curves.iter().flat_map(of_curve).chain(BAND);
    let within = percents.filter(|percent| (BAND[0]..=BAND[1]).contains(percent));
    let Some((percent, ratio)) = within.filter_map(widest).max_by(|a, b| a.1.total_cmp(&b.1)) else {
        return Judged::of(None, Some(5.0)).lacking("needs finer sieves of the filter");
    };
    Judged::of(Some(ratio), Some(5.0)).noted(format!("at {percent:.0} % finer"))
}
