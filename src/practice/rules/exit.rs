//! An exit that does not erode: an open joint, defect or crack beside the base.

use std::f64::consts::SQRT_2;

use super::rule::{Judged, RuleInputs};
use crate::RuleNote;

/// Width of the joint over D95B, and the probability of continuing erosion.
const PROBABILITY: [(f64, f64); 5] = [(0.5, 0.0001), (0.75, 0.001), (1.0, 0.1), (2.0, 0.5), (3.0, 0.9)];

/// Below this ratio the probability is 0.
const CLOSED: f64 = 0.4;

/// The probability of continuing erosion into a joint, if a joint is given.
pub fn constricted(inputs: &RuleInputs) -> Judged {
    let Some(joint) = inputs.joint_mm else { return Judged::left_out() };
    let Some(d95b) = inputs.base_soil.gradation.d(95.0) else {
        return Judged::of(None, None).lacking(RuleNote::NeedsD95B);
    };
    let ratio = joint / d95b;
    let share = probability(ratio);
    let judged =
        Judged::of(share.map(|share| 100.0 * share), None).noted(RuleNote::Joint(joint, d95b, ratio));
    if share.is_none() { judged.noted(RuleNote::LessThanSource) } else { judged }
}

/// Probability (0 to 1) of continuing erosion at this width over D95B: straight between the table's points in
/// the ratio, on the scale of a normal variate. `None` means more than 0 and less than 0.0001.
fn probability(ratio: f64) -> Option<f64> {
    let [first, .., last] = PROBABILITY;
    if ratio < CLOSED {
        return Some(0.0);
    }
    if ratio < first.0 {
        return None;
    }
    if ratio >= last.0 {
        return Some(last.1);
    }
    let above = PROBABILITY.partition_point(|point| point.0 <= ratio);
    let (low, high) = (PROBABILITY[above - 1], PROBABILITY[above]);
    if ratio == low.0 {
        return Some(low.1);
    }
    let share = (ratio - low.0) / (high.0 - low.0);
    let [from, to] = [low.1, high.1].map(variate);
    Some(below(from + share * (to - from)))
}

/// Share of a normal distribution below `z`.
fn below(z: f64) -> f64 {
    0.5 * libm::erfc(-z / SQRT_2)
}

/// The `z` that this share of a normal distribution lies below.
fn variate(share: f64) -> f64 {
    let (mut low, mut high) = (-10.0, 10.0);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if below(middle) < share { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_of_the_manual_is_reproduced() {
        for (ratio, expected) in [
            (0.0, 0.0),
            (0.39, 0.0),
            (0.5, 0.0001),
            (0.75, 0.001),
            (1.0, 0.1),
            (2.0, 0.5),
            (3.0, 0.9),
            (9.0, 0.9),
        ] {
            assert_eq!(probability(ratio), Some(expected), "{ratio}");
        }
        assert_eq!((probability(0.4), probability(0.49)), (None, None));
    }

    /// By tables of the normal distribution: z(0.001) = -3.0902, z(0.1) = -1.2816, z(0.5) = 0, z(0.9) =
    /// 1.2816; half-way -2.1859 (0.01441), -0.6408 (0.26083), 0.6408 (0.73917).
    #[test]
    fn between_its_points_the_variate_is_straight() {
        for (ratio, by_hand) in [(0.875, 0.01441), (1.5, 0.26083), (2.5, 0.73917)] {
            let share = probability(ratio).unwrap();
            assert!((share - by_hand).abs() < 1e-5, "{ratio} {share}");
        }
        let rising: Vec<f64> = (50..300).map(|n| probability(f64::from(n) / 100.0).unwrap()).collect();
        assert!(rising.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
