//! How much coarser the filter could be before the base begins to erode: the first run of the first replicate
//! with the filter so many times as large.
//!
//! A coarser filter is a finer base to the walk, of which as much is offered as the coarser filter would be.
//! Two sizes are walked at a time, outwards by growing steps until one erodes and one does not, then inwards
//! by thirds to 4 %. One narrow network is walked, as in the study of real soils, so the boundary scatters as
//! networks do: 2 to 7 %. A base that erodes again in finer filters has several boundaries; this is the one
//! that is nearest below the sizes that were seen to erode.

use super::callbacks::Event;
use super::error::RunError;
use super::replicates::{ReplicateContext, ReplicateResult, each, walk_replicate};
use crate::case::Case;
use crate::outcome::record::{Margin, MarginWalk};

/// From one size of the filter to the next, where nothing is known yet: in the first round, the second, and
/// all others.
const STEPS: [f64; 3] = [1.3, 1.5, 2.0];
/// Sizes as close as this are close enough.
const CLOSE: f64 = 1.04;
/// Times as large, and by as much smaller, as is looked.
const FARTHEST: [f64; 2] = [0.02, 8.0];
/// More particles than this are walked one by one only where the case itself has as many.
const MOST_PARTICLES: u64 = 20_000_000;
/// What that many take: 8 bytes each, and as much to move them.
pub const MOST_BYTES: u64 = 16 * MOST_PARTICLES;
/// Voids across of the lattice, as in the study of real soils that the margin is compared with.
const ACROSS: u64 = 20;
/// As many sizes are walked at most, besides the case's own.
pub const MOST_WALKS: u64 = 16;
/// Names the checkpoints of these walks, beyond those of all others.
const FIRST_PART: u64 = 1 << 32;

/// Walks the margin of a case of which this is the first replicate, with the first reading of its base.
///
/// # Errors
/// As [`super::replicates::replicates_and`].
pub fn margin(case: &Case, own: &ReplicateResult, context: &ReplicateContext) -> Result<Margin, RunError> {
    let mut margin = Margin { walks: vec![walk_of(1.0, own)] };
    let mut part = FIRST_PART;
    loop {
        let factors = next(&margin);
        let cases: Vec<(u64, f64, Case)> = (part..)
            .zip(&factors)
            .filter_map(|(part, &factor)| Some((part, factor, of_size(case, factor)?)))
            .collect();
        if cases.is_empty() {
            return Ok(margin);
        }
        part += factors.len() as u64;
        context.tell(Event::MoreRuns { runs: cases.len() as u64 });
        let one = |(part, factor, case): (u64, f64, Case)| {
            Ok(walk_of(factor, &walk_replicate(&case, part, 1, case.n_base, context)?))
        };
        let threads = rayon::current_num_threads() as u64;
        let fit = cases.iter().all(|(_, _, case)| case.side_by_side(case.n_base, threads) > 1);
        let is_whole = cases.len() == factors.len();
        margin.walks.extend(each(cases, fit, one)?);
        margin.walks.sort_by(|a, b| a.factor.total_cmp(&b.factor));
        if !is_whole {
            return Ok(margin);
        }
    }
}

fn walk_of(factor: f64, walked: &ReplicateResult) -> MarginWalk {
    let eroded_mass_fraction = walked.replicate.runs[0].eroded_mass_fraction;
    MarginWalk { factor, eroded_mass_fraction, holds: walked.below[0] }
}

/// The sizes to be walked next; none where the boundary is known closely enough, or lies too far.
fn next(margin: &Margin) -> Vec<f64> {
    let step = STEPS[(margin.walks.len() / 2).min(STEPS.len() - 1)];
    let factors = match (margin.holds_to(), margin.erodes_from()) {
        (Some(holds), Some(erodes)) if erodes / holds <= CLOSE => return Vec::new(),
        (Some(holds), Some(erodes)) => {
            let third = libm::cbrt(erodes / holds);
            [holds * third, holds * third * third]
        }
        (Some(holds), None) => [holds * step, holds * step * step],
        (None, Some(erodes)) => [erodes / step / step, erodes / step],
        (None, None) => return Vec::new(),
    };
    let [least, most] = FARTHEST;
    factors.into_iter().filter(|factor| (least..=most).contains(factor)).collect()
}

/// The case with its filter so many times as large, its first run alone; `None` where that cannot be walked,
/// or not with as large a share of base.
fn of_size(case: &Case, factor: f64) -> Option<Case> {
    let mut other = case.with_larger_filter(factor, ACROSS).ok()?;
    other.scene.walk.runs = 1;
    let most = MOST_PARTICLES.max(case.one_by_one(case.n_base));
    let as_much = match (case.mass_ratio, other.mass_ratio) {
        (Some(own), Some(other)) => (other / own - 1.0).abs() < 0.01,
        _ => true,
    };
    (as_much && other.one_by_one(other.n_base) <= most).then_some(other)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sizes that are walked where a filter erodes from this size on.
    fn searched(boundary: f64) -> Margin {
        let walk = |factor: f64| {
            let eroded_mass_fraction = 0.075 * factor / boundary;
            MarginWalk { factor, eroded_mass_fraction, holds: factor < boundary }
        };
        let mut margin = Margin { walks: vec![walk(1.0)] };
        loop {
            let factors = next(&margin);
            if factors.is_empty() {
                return margin;
            }
            margin.walks.extend(factors.into_iter().map(walk));
            margin.walks.sort_by(|a, b| a.factor.total_cmp(&b.factor));
        }
    }

    #[test]
    fn a_boundary_is_found_to_4_percent_in_few_walks() {
        for boundary in [0.07, 0.2, 0.5, 0.99, 1.0, 1.001, 1.69, 3.0, 7.0] {
            let found = searched(boundary);
            let (holds, erodes) = (found.holds_to().unwrap(), found.erodes_from().unwrap());
            assert!(
                holds < boundary && boundary <= erodes && erodes <= CLOSE * holds,
                "{boundary}: {found:?}"
            );
            assert!((holds..=erodes).contains(&found.boundary().unwrap()));
            assert!(found.walks.len() as u64 <= 1 + MOST_WALKS, "{boundary}: {}", found.walks.len());
        }
    }

    #[test]
    fn what_is_too_far_is_bounded_on_one_side() {
        let far = searched(20.0);
        assert!(far.walks.len() as u64 <= 1 + MOST_WALKS);
        assert!(far.erodes_from().is_none() && far.holds_to().unwrap() > 4.0 && far.boundary().is_none());
        let near = searched(0.001);
        assert!(near.walks.len() as u64 <= 1 + MOST_WALKS);
        assert!(near.holds_to().is_none() && near.erodes_from().unwrap() < 0.05);
    }
}
