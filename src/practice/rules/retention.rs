//! Rules by which a filter retains its base, boundaries of coarser filters, an open joint beside the
//! base, and checks of the walk.

use super::rule::{Fines, Judged, RuleInputs};
use crate::RuleNote;
use std::f64::consts::SQRT_2;
use voidwalk_core::gradation::{FEW_FINES, FINES_MM};

/// Maximum D15F of a base with between `few` and `many` percent fines: from 4 D85B down to 0.7 mm.
fn between(few: f64, many: f64, fines: f64, d85b: f64) -> f64 {
    (many - fines) / (many - few) * (4.0 * d85b - 0.7) + 0.7
}

/// Limit of D15F for a base with this percent of fines and this D85B.
#[derive(Clone, Copy)]
enum Limit {
    /// The limit itself.
    Is(f64),
    /// Upper bound of a limit that no source gives.
    AtMost(f64),
}

impl Limit {
    fn most(self) -> f64 {
        match self {
            Self::Is(limit) | Self::AtMost(limit) => limit,
        }
    }
}

/// Minimum of the limit of design (mm): for fine clays 9 D85B is smaller.
pub const DESIGN_FLOOR_MM: f64 = 0.2;

/// Sherard and Dunnigan's limit of design; for a dispersive base, with the limits for dispersive soils.
pub(crate) fn sherard_dunnigan(inputs: &RuleInputs) -> Judged {
    let limit = |fines: f64, d85b: f64| match (inputs.dispersive, fines) {
        (false, fines) if fines > 85.0 => Limit::Is((9.0 * d85b).max(DESIGN_FLOOR_MM)),
        (true, fines) if fines > 85.0 => Limit::Is((6.4 * d85b).max(DESIGN_FLOOR_MM)),
        (false, fines) if fines >= 40.0 => Limit::Is(0.7),
        (true, fines) if fines >= 40.0 => Limit::Is(0.5),
        (true, fines) if fines >= FEW_FINES => Limit::AtMost(between(FEW_FINES, 40.0, fines, d85b)),
        (_, fines) if fines >= FEW_FINES => Limit::Is(between(FEW_FINES, 40.0, fines, d85b)),
        _ => Limit::Is(4.0 * d85b),
    };
    let judged = by_fines(inputs, limit, true);
    let times = if inputs.dispersive { 6.4 } else { 9.0 };
    let of_base = times * inputs.size_of_base(85.0).most;
    let is_floor =
        !judged.limit_at_most && judged.limit == Some(DESIGN_FLOOR_MM) && of_base < DESIGN_FLOOR_MM;
    judged.noted(is_floor.then_some(RuleNote::FloorGoverns(times, of_base))).noted(formula(inputs, 1.0, 40.0))
}

/// Foster and Fell's boundary of no erosion; for a dispersive base, with their limits for dispersive soils.
pub(crate) fn no_erosion(inputs: &RuleInputs) -> Judged {
    let limit = |fines: f64, d85b: f64| match (inputs.dispersive, fines) {
        (false, fines) if fines > 85.0 => Limit::Is(9.0 * d85b),
        (true, fines) if fines > 85.0 => Limit::Is(6.4 * d85b),
        (false, fines) if fines >= 35.0 => Limit::Is(0.7),
        (true, fines) if fines >= 35.0 => Limit::Is(0.5),
        (true, fines) if fines >= FEW_FINES => Limit::AtMost(1.6 * between(FEW_FINES, 35.0, fines, d85b)),
        (_, fines) if fines >= FEW_FINES => Limit::Is(1.6 * between(FEW_FINES, 35.0, fines, d85b)),
        _ => Limit::Is(7.0 * d85b),
    };
    by_fines(inputs, limit, false).noted(formula(inputs, 1.6, 35.0))
}

/// Note on the formula of a limit between few fines and the percent `until`, so that it can be checked.
fn formula(inputs: &RuleInputs, times: f64, until: f64) -> Option<RuleNote> {
    let Fines::Percent(fines) = inputs.fines() else { return None };
    let is_known = !inputs.dispersive && inputs.size_of_base(85.0).is_known;
    let is_between = (FEW_FINES..until).contains(&fines);
    (is_known && is_between).then_some(RuleNote::ByFines(times, until, fines))
}

/// Range of D15F (mm) in which tests of bases with this percent of fines, after regrading, and this D85B
/// (mm) had their boundary of no erosion (Fell et al., Geotechnical Engineering of Dams, Table 9.2, after
/// Foster 1999).
pub fn range_of_tests(fines: f64, d85b: f64) -> [f64; 2] {
    match fines {
        fines if fines > 85.0 => [6.4, 13.5].map(|times| times * d85b),
        fines if fines >= 35.0 => [0.7, 1.7],
        fines if fines >= FEW_FINES => [1.6, 2.5].map(|times| times * between(FEW_FINES, 35.0, fines, d85b)),
        _ => [6.8, 10.0].map(|times| times * d85b),
    }
}

/// Range of tests for the base of these inputs; `None` for a dispersive base, which had other tests, and
/// if fines, D85B or the unit of sizes are not known.
pub fn tested_range(inputs: &RuleInputs) -> Option<[f64; 2]> {
    let d85b = inputs.size_of_base(85.0);
    let fines = match inputs.fines() {
        Fines::Percent(percent) => percent,
        Fines::Few => 0.0,
        Fines::Assumed | Fines::Unknown => return None,
    };
    (d85b.is_known && !inputs.dispersive).then(|| range_of_tests(fines, d85b.most))
}

/// Limit of D15F that follows from fines and D85B of the regraded base.
///
/// An unknown never hides a failure: if the limit itself is not known, its upper bound is used, and a
/// filter beyond the bound breaks the rule for any result of a soil test.
fn by_fines(inputs: &RuleInputs, limit: impl Fn(f64, f64) -> Limit, says_category: bool) -> Judged {
    let (d15f, d85b) = (inputs.coarse_d15f(), inputs.size_of_base(85.0));
    let known = match inputs.fines() {
        Fines::Percent(percent) => Some(percent),
        Fines::Few | Fines::Assumed => Some(0.0),
        Fines::Unknown => None,
    };
    let (limit, needs) = match known.map(|fines| limit(fines, d85b.most)) {
        Some(Limit::Is(limit)) if d85b.is_known => (Limit::Is(limit), None),
        Some(Limit::AtMost(most)) if d85b.is_known => {
            (Limit::AtMost(most), Some(RuleNote::NeedsTestOfDispersive))
        }
        Some(limit) => (Limit::AtMost(limit.most()), Some(RuleNote::NeedsD85B)),
        None => (Limit::AtMost(whatever_its_fines(&limit, d85b.most)), Some(RuleNote::NeedsFinesOfBase)),
    };
    let is_beyond = d15f.is_some_and(|d15f| d15f > limit.most()) && matches!(limit, Limit::AtMost(_));
    let is_dispersive = inputs.dispersive && known.is_none_or(|fines| fines >= FEW_FINES);
    let category = inputs.base_soil.category.filter(|_| says_category).map(RuleNote::Category);
    let notes = [
        is_dispersive.then_some(RuleNote::Dispersive),
        category,
        base_as_read(inputs),
        is_beyond.then_some(RuleNote::BeyondAnyLimit),
    ];
    Judged {
        limit_at_most: matches!(limit, Limit::AtMost(_)),
        needs: match d15f {
            None => Some(RuleNote::NeedsD15F),
            Some(_) => needs.filter(|_| !is_beyond),
        },
        notes: notes.into_iter().flatten().collect(),
        ..Judged::of(d15f, Some(limit.most()))
    }
}

/// Maximum possible limit with unknown fines. D85B of a base that is nearly all fines is itself within
/// the fines.
fn whatever_its_fines(limit: &impl Fn(f64, f64) -> Limit, d85b: f64) -> f64 {
    let most = |fines: u32| {
        let d85b = if fines > 85 { d85b.min(FINES_MM) } else { d85b };
        limit(f64::from(fines), d85b).most()
    };
    (0..=100).map(most).fold(0.0, f64::max)
}

/// Note on a base that was not read as sampled.
fn base_as_read(inputs: &RuleInputs) -> Option<RuleNote> {
    match inputs.fines() {
        Fines::Assumed => Some(RuleNote::TakenAsSand),
        _ => inputs.base_soil.regraded_at_mm.map(RuleNote::RegradedOn),
    }
}

/// Terzaghi's ratio, for bases with few fines.
pub(crate) fn terzaghi(inputs: &RuleInputs) -> Judged {
    let d85b = Some(inputs.size_of_base(85.0)).filter(|size| size.is_known).map(|size| size.most);
    let value = inputs.coarse_d15f().zip(d85b).map(|(d15f, d85b)| d15f / d85b);
    let judged = Judged::of(value, Some(4.0));
    match inputs.fines() {
        Fines::Percent(percent) if percent >= FEW_FINES => judged.not_for(RuleNote::LimitsByFines(percent)),
        // With more fines other limits replace it, and most of them are stricter.
        Fines::Unknown => judged.at_most().lacking(RuleNote::NeedsFinesOfBase),
        _ => judged.noted(base_as_read(inputs)),
    }
}

/// D95B (mm) up to which tests of bases with 15 to 85 % fines found a clear boundary of continuing
/// erosion.
const CLEAR_TO_MM: f64 = 2.0;

/// Foster and Fell's boundary of continuing erosion. It is no limit if their tests found no clear boundary,
/// and has no result if this is not known. Beyond it, the rule is broken in both cases.
pub(crate) fn continuing(inputs: &RuleInputs) -> Judged {
    let (d15f, d95b) = (inputs.coarse_d15f(), inputs.size_of_base(95.0));
    let judged = Judged::of(d15f, Some(9.0 * d95b.most));
    let is_beyond = d15f.is_some_and(|d15f| d15f > 9.0 * d95b.most);
    let fines = inputs.fines();
    let is_unclear = d95b.most > CLEAR_TO_MM
        && match fines {
            Fines::Percent(percent) => (FEW_FINES..=85.0).contains(&percent),
            Fines::Unknown => true,
            Fines::Few | Fines::Assumed => false,
        };
    match fines {
        _ if !is_unclear => {}
        _ if is_beyond => return judged.noted(RuleNote::BeyondUnclearBoundary),
        Fines::Unknown => return Judged::of(d15f, None).lacking(RuleNote::NeedsFinesOfBase),
        _ => return Judged::of(d15f, None).not_for(RuleNote::NoClearBoundary),
    }
    if !d95b.is_known {
        let judged = judged.at_most().noted(base_as_read(inputs));
        return if is_beyond { judged } else { judged.lacking(RuleNote::NeedsD95B) };
    }
    let is_between = d15f.is_some() && !is_beyond && !is_without_erosion(inputs);
    judged.noted(base_as_read(inputs)).noted(is_between.then_some(RuleNote::ExcessiveNotJudged))
}

/// True if tests of such a base are known to have shown no erosion with this filter.
fn is_without_erosion(inputs: &RuleInputs) -> bool {
    let judged = no_erosion(inputs);
    !judged.limit_at_most && judged.value.zip(judged.limit).is_some_and(|(d15f, limit)| d15f <= limit)
}

/// Width of the joint over D95B, and probability of continuing erosion.
const PROBABILITY: [(f64, f64); 5] = [(0.5, 0.0001), (0.75, 0.001), (1.0, 0.1), (2.0, 0.5), (3.0, 0.9)];

/// Below this ratio the probability is 0.
const CLOSED: f64 = 0.4;

/// Probability of continuing erosion into a joint, if a joint is given.
pub(crate) fn constricted(inputs: &RuleInputs) -> Judged {
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

/// Probability (0 to 1) of continuing erosion at this width over D95B: straight between the table's
/// points in the ratio, on the scale of a normal variate. `None` means above 0 and below 0.0001.
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

/// Fraction of a normal distribution below `z`.
fn below(z: f64) -> f64 {
    0.5 * libm::erfc(-z / SQRT_2)
}

/// Quantile `z` of a normal distribution at this fraction.
fn variate(share: f64) -> f64 {
    let (mut low, mut high) = (-10.0, 10.0);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if below(middle) < share { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Largest passing particle over D15F by Kenney et al.
const KENNEY: f64 = 0.2;

/// Fraction of Kenney's ratio below which the walk does not resemble those tests.
const FAR_FINER: f64 = 0.1;

/// Largest particle that passes, by Kenney et al.
pub(crate) fn largest_passing(inputs: &RuleInputs) -> Judged {
    let value = inputs.largest_eroded_over_d15f;
    let judged = Judged { applies: value.is_some(), ..Judged::of(value, Some(KENNEY)) };
    // If the whole base is that fine, its size says nothing about the openings.
    let is_far = |share: f64| share < FAR_FINER * KENNEY;
    let coarsest = inputs.d15f().map(|d15f| inputs.walked_base.largest_mm() / d15f);
    let is_held_back = coarsest.is_some_and(|share| !is_far(share));
    match value {
        Some(share) if is_far(share) && is_held_back => {
            judged.noted(RuleNote::ChecksWalk).noted(RuleNote::FarFinerThanTests(KENNEY / share))
        }
        Some(_) => judged.noted(RuleNote::ChecksWalk),
        None => judged.lacking(RuleNote::NeedsErosion),
    }
}

/// Boundary of the paper: maximum D15F over a size of the base as walked.
pub(crate) fn paper(inputs: &RuleInputs, percent: f64, limit: f64) -> Judged {
    let value = inputs.d15f().zip(inputs.walked_base.d(percent)).map(|(d15f, size)| d15f / size);
    Judged::of(value, Some(limit)).noted(RuleNote::ResultOfModel)
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

    /// Tables of the normal distribution give z(0.001) = -3.0902, z(0.1) = -1.2816, z(0.5) = 0 and
    /// z(0.9) = 1.2816; half-way -2.1859 (0.01441), -0.6408 (0.26083), 0.6408 (0.73917).
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
