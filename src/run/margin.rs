//! How much coarser the filter could be before the base begins to erode: the first run of the first replicate
//! with the filter so many times as large.
//!
//! A coarser filter is a finer base to the walk, of which as much is offered as the coarser filter would be.
//! Two sizes are walked side by side, outwards by steps of 30 % until one erodes and one does not, then
//! inwards by thirds to 4 %. One network is walked, so the boundary scatters as networks do: 2 to 5 %.

use rayon::prelude::*;

use super::callbacks::Event;
use super::error::RunError;
use super::replicates::{ReplicateContext, ReplicateResult, walk_replicate};
use crate::case::Case;
use crate::outcome::record::{Margin, MarginWalk};

/// From one size of the filter to the next, where nothing is known yet.
const STEP: f64 = 1.3;
/// Sizes as close as this are close enough.
const CLOSE: f64 = 1.04;
/// Times as large, and by as much smaller, as is looked.
const FARTHEST: f64 = 8.0;
/// More base particles than this are walked only where the case itself has as many.
const MOST_PARTICLES: u64 = 20_000_000;
/// Names the checkpoints of these walks, beyond those of all others.
const FIRST_PART: u64 = 1 << 32;

/// Walks the margin of a case of which these replicates were walked, with the first reading of its base;
/// `None` where it is not asked for.
///
/// # Errors
/// As [`super::replicates::replicates`].
pub fn margin(
    case: &Case,
    walked: &[ReplicateResult],
    context: &ReplicateContext,
) -> Result<Option<Margin>, RunError> {
    let Some(own) = walked.first().filter(|_| case.scene.record.margin == Some(true)) else {
        return Ok(None);
    };
    let mut walks = vec![walk_of(1.0, own)];
    let mut part = FIRST_PART;
    while let Some(factors) = next(&walks) {
        let cases: Vec<(u64, f64, Case)> = (part..)
            .zip(factors)
            .filter_map(|(part, factor)| Some((part, factor, of_size(case, factor)?)))
            .collect();
        part += cases.len() as u64;
        context.tell(Event::MoreRuns { runs: cases.len() as u64 });
        let one = |(part, factor, case): &(u64, f64, Case)| {
            Ok(walk_of(*factor, &walk_replicate(case, *part, 1, case.n_base, context)?))
        };
        let found: Result<Vec<_>, RunError> = cases.par_iter().map(one).collect();
        walks.extend(found?);
        walks.sort_by(|a, b| a.factor.total_cmp(&b.factor));
        if cases.len() < factors.len() {
            break;
        }
    }
    Ok(Some(Margin { walks }))
}

fn walk_of(factor: f64, walked: &ReplicateResult) -> MarginWalk {
    let eroded_mass_fraction = walked.replicate.runs[0].eroded_mass_fraction;
    MarginWalk { factor, eroded_mass_fraction, holds: walked.below[0] }
}

/// The sizes to be walked next; `None` where the boundary is known closely enough, or lies too far.
fn next(walks: &[MarginWalk]) -> Option<[f64; 2]> {
    let margin = Margin { walks: walks.to_vec() };
    let factors = match (margin.holds_to(), margin.erodes_from()) {
        (Some(holds), Some(erodes)) => {
            let third = libm::cbrt(erodes / holds);
            if erodes / holds <= CLOSE { return None } else { [holds * third, holds * third * third] }
        }
        (Some(holds), None) => [holds * STEP, holds * STEP * STEP],
        (None, Some(erodes)) => [erodes / STEP / STEP, erodes / STEP],
        (None, None) => return None,
    };
    factors.iter().all(|factor| (1.0 / FARTHEST..=FARTHEST).contains(factor)).then_some(factors)
}

/// The case with its filter so many times as large, its first run alone; `None` where that cannot be walked.
fn of_size(case: &Case, factor: f64) -> Option<Case> {
    let mut other = case.with_larger_filter(factor).ok()?;
    other.scene.walk.runs = 1;
    (other.n_base <= MOST_PARTICLES.max(case.n_base)).then_some(other)
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
        let mut walks = vec![walk(1.0)];
        while let Some(factors) = next(&walks) {
            walks.extend(factors.map(walk));
            walks.sort_by(|a, b| a.factor.total_cmp(&b.factor));
        }
        Margin { walks }
    }

    #[test]
    fn a_boundary_is_found_to_4_percent_in_few_walks() {
        for boundary in [0.2, 0.5, 0.99, 1.0, 1.001, 1.69, 3.0, 4.8] {
            let found = searched(boundary);
            let (holds, erodes) = (found.holds_to().unwrap(), found.erodes_from().unwrap());
            assert!(
                holds < boundary && boundary <= erodes && erodes <= CLOSE * holds,
                "{boundary}: {found:?}"
            );
            assert!((holds..=erodes).contains(&found.boundary().unwrap()));
            assert!(found.walks.len() <= 15, "{boundary}: {}", found.walks.len());
        }
    }

    #[test]
    fn what_is_too_far_is_bounded_on_one_side() {
        let far = searched(20.0);
        assert!(far.erodes_from().is_none() && far.holds_to().unwrap() > 4.0 && far.boundary().is_none());
        let near = searched(0.01);
        assert!(near.holds_to().is_none() && near.erodes_from().unwrap() < 0.25);
    }
}
