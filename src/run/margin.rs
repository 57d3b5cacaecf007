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

/// Walks the margin of a case of which these replicates were walked, of each reading of its base; `None`
/// where it is not asked for.
///
/// # Errors
/// As [`super::replicates::replicates`].
pub fn margin(
    case: &Case,
    walked: [&[ReplicateResult]; 2],
    context: &ReplicateContext,
) -> Result<Option<Margin>, RunError> {
    if case.scene.record.margin != Some(true) {
        return Ok(None);
    }
    let own = walked.iter().filter_map(|of| Some((of.first()?, of.first()?.replicate.runs.first()?)));
    let own = own.map(|(of, run)| (run.eroded_mass_fraction, of.below[0])).reduce(worse);
    let mut margin = Margin { walks: Vec::new() };
    margin.walks.extend(own.map(|of| walk_of(1.0, of)));
    let mut part = FIRST_PART;
    while let Some(factors) = next(&margin) {
        let cases: Vec<(f64, Case)> =
            factors.into_iter().filter_map(|factor| Some((factor, of_size(case, factor)?))).collect();
        let all_there = cases.len() == factors.len();
        let readings: Vec<(u64, f64, &Case)> = (part..)
            .zip(cases.iter().flat_map(|(factor, case)| case.readings().map(move |case| (*factor, case))))
            .map(|(part, (factor, case))| (part, factor, case))
            .collect();
        part += readings.len() as u64;
        context.tell(Event::MoreRuns { runs: readings.len() as u64 });
        let one = |&(part, factor, case): &(u64, f64, &Case)| {
            let walked = walk_replicate(case, part, 1, case.n_base, context)?;
            Ok((factor, (walked.replicate.runs[0].eroded_mass_fraction, walked.below[0])))
        };
        let found: Result<Vec<_>, RunError> = readings.par_iter().map(one).collect();
        let found = found?;
        for (factor, _) in &cases {
            let of_size = found.iter().filter(|of| of.0 == *factor).map(|of| of.1).reduce(worse);
            margin.walks.extend(of_size.map(|of| walk_of(*factor, of)));
        }
        margin.walks.sort_by(|a, b| a.factor.total_cmp(&b.factor));
        if !all_there {
            break;
        }
    }
    Ok(Some(margin))
}

/// Of two readings of a base the one that erodes more.
fn worse(a: (f64, bool), b: (f64, bool)) -> (f64, bool) {
    (a.0.max(b.0), a.1 && b.1)
}

fn walk_of(factor: f64, (eroded_mass_fraction, holds): (f64, bool)) -> MarginWalk {
    MarginWalk { factor, eroded_mass_fraction, holds }
}

/// The sizes to be walked next; `None` where the boundary is known closely enough, or lies too far.
fn next(margin: &Margin) -> Option<[f64; 2]> {
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
    let mut other = case.with_base(case.base.scaled(1.0 / factor).ok()?, None).ok()?;
    let most = MOST_PARTICLES.max(case.n_base);
    other.scene.walk.runs = 1;
    if let Some(reading) = &mut other.other_reading {
        reading.scene.walk.runs = 1;
    }
    let few = other.readings().all(|reading| reading.n_base <= most);
    few.then_some(other)
}
