//! Walks the studies of a case: the change of its verdict with the number of base particles and with the
//! thickness of the filter.
//!
//! A point of a study, one other number or thickness, is walked on the random numbers of the first
//! replicates: the same networks; a lattice of another thickness has the first layers in common with them.
//! The walk of a point stops when its class is clear ([`crate::outcome::early_stop`]). All points are walked
//! side by side, so that one replicate of each keeps all threads busy.

use std::borrow::Cow;
use std::cmp::Reverse;

use rayon::prelude::*;

use super::callbacks::Event;
use super::case_walks::CaseWalks;
use super::error::RunError;
use super::planned::replicates_at_least;
use super::replicates::{ReplicateContext, ReplicateResult, values_by_run, walk_replicate};
use super::summary::classed;
use crate::case::Case;
use crate::outcome::early_stop::{clear, looks};
use crate::outcome::record::{Classed, OfThickness, Sensitivity, Statistic, Verdict};

/// Results of the studies; empty if they are left out.
#[derive(Clone, Default)]
pub struct Studies {
    /// Other numbers of base particles, and the case's own.
    pub sensitivity: Vec<Sensitivity>,
    /// Filters of other thicknesses, and the case's own.
    pub thickness: Vec<OfThickness>,
}

/// One other number of base particles, or one other thickness.
struct Point<'a> {
    case: Cow<'a, Case>,
    /// Names its checkpoints.
    part: u64,
    n_base: u64,
    /// Factor on the base particles; `None` if the point changes the thickness.
    base_factor: Option<f64>,
}

/// Walked replicates of a point.
#[derive(Default)]
struct Walked {
    replicates: Vec<ReplicateResult>,
    /// Eroded mass by run, if it stopped because it was clear.
    clear: Option<Vec<Statistic>>,
}

/// The points of both studies of a case.
fn points(case: &Case) -> Vec<Point<'_>> {
    let factors = case.sensitivity_factors();
    // The parts between belong to the ends of the curve's range.
    let thicknesses = (factors.len() + case.filter.curve_ends.len()) as u64 + 1..;
    let of_base = |(part, factor): (u64, f64)| Point {
        case: Cow::Borrowed(case),
        part,
        n_base: case.times_base(factor),
        base_factor: Some(factor),
    };
    // Impossible thicknesses are reported among the parts that are left out.
    let of_thickness = |(part, factor): (u64, f64)| {
        let other = case.of_thickness(factor).ok()?;
        Some(Point { part, n_base: other.supply.n_base, case: Cow::Owned(other), base_factor: None })
    };
    let thick = thicknesses.zip(case.thickness_factors()).filter_map(of_thickness);
    (1..).zip(factors).map(of_base).chain(thick).collect()
}

impl Studies {
    /// Walks the studies of a case whose verdict has been walked for.
    ///
    /// # Errors
    /// See [`super::replicates::replicates`].
    pub fn walk(case: &Case, walks: &CaseWalks, context: &ReplicateContext) -> Result<Self, RunError> {
        let (of_case, class, points) = (&walks.replicates, walks.verdict, points(case));
        let own_values = values_by_run(of_case);
        let most = case.scene.record.sensitivity_replicates;
        let mut walked: Vec<Walked> = points.iter().map(|_| Walked::default()).collect();
        let mut known = replicates_at_least(case);
        for until in looks(class, of_case.len(), most) {
            let open: Vec<usize> = (0..points.len()).filter(|&point| walked[point].clear.is_none()).collect();
            let more = until.saturating_sub(known) * open.len() as u64 * case.scene.walk.runs;
            if more > 0 {
                context.tell(Event::MoreRuns { runs: more });
            }
            known = known.max(until);
            let first = |point: usize| walked[point].replicates.len() as u64 + 1;
            let jobs = open.iter().flat_map(|&point| (first(point)..=until).map(move |k| (point, k)));
            for (point, _, replicate) in walk_all(&points, jobs.collect(), context)? {
                walked[point].replicates.push(replicate);
            }
            for &point in open.iter().filter(|_| until < most) {
                let walked_point = &mut walked[point];
                walked_point.clear = clear(&own_values, class, &values_by_run(&walked_point.replicates));
            }
        }
        let mut studies = Self::default();
        for (point, walked_point) in points.iter().zip(&walked) {
            studies.add(case, point, walked_point, class);
        }
        studies.add_own(case, of_case, class);
        Ok(studies)
    }

    /// True if these are all studies of the case.
    pub(super) fn are_whole(case: &Case, sensitivity: &[Sensitivity], thickness: &[OfThickness]) -> bool {
        points(case).iter().all(|point| match point.base_factor {
            Some(_) => !sensitivity.is_empty(),
            None => !thickness.is_empty(),
        })
    }

    /// True if a case has no study.
    pub(super) fn are_none(case: &Case) -> bool {
        points(case).is_empty()
    }

    fn add(&mut self, case: &Case, point: &Point, walked: &Walked, class: Verdict) {
        let usual = classed(&walked.replicates);
        let judged = match &walked.clear {
            Some(runs) => Classed { stopped_when_clear: true, verdict: class, runs: runs.clone(), ..usual },
            None => usual,
        };
        match point.base_factor {
            Some(factor) => self.sensitivity.push(of_base(judged, case, factor, point.n_base)),
            None => self.thickness.push(of_thickness(judged, case, &point.case)),
        }
    }

    /// The case itself, with its verdict, is a point of each of its studies.
    fn add_own(&mut self, case: &Case, replicates: &[ReplicateResult], verdict: Verdict) {
        let judged = || Classed { verdict, ..classed(replicates) };
        if !self.sensitivity.is_empty() {
            self.sensitivity.push(of_base(judged(), case, 1.0, case.supply.n_base));
            self.sensitivity.sort_by(|a, b| a.factor.total_cmp(&b.factor));
        }
        if !self.thickness.is_empty() {
            self.thickness.push(of_thickness(judged(), case, case));
            self.thickness.sort_by_key(|row| row.layers);
        }
    }
}

/// Walks replicates of points, several side by side if they fit into the memory; in the order of the points
/// and replicates.
fn walk_all(
    points: &[Point],
    jobs: Vec<(usize, u64)>,
    context: &ReplicateContext,
) -> Result<Vec<(usize, u64, ReplicateResult)>, RunError> {
    let threads = rayon::current_num_threads() as u64;
    let is_small = |&(point, _): &(usize, u64)| {
        let Point { case, n_base, .. } = &points[point];
        case.side_by_side(*n_base, threads) > 1
    };
    let one = |(point, replicate): (usize, u64)| {
        let Point { case, part, n_base, .. } = &points[point];
        Ok((point, replicate, walk_replicate(case, *part, replicate, *n_base, context)?))
    };
    let (mut small, large): (Vec<_>, Vec<_>) = jobs.into_iter().partition(is_small);
    // The longest first, so that no thread is left with one at the end.
    small.sort_by_key(|&(point, _)| {
        Reverse(points[point].n_base.saturating_mul(points[point].case.network.layers))
    });
    let walked: Result<Vec<_>, RunError> = small.into_par_iter().with_max_len(1).map(one).collect();
    let mut walked = walked?;
    for job in large {
        walked.push(one(job)?);
    }
    walked.sort_by_key(|&(point, replicate, _)| (point, replicate));
    Ok(walked)
}

fn of_base(walked: Classed, case: &Case, factor: f64, n_base: u64) -> Sensitivity {
    let [grains_per_void, mass_ratio] =
        [case.filter.grains_per_void, case.supply.mass_ratio].map(|amount| Some(amount? * factor));
    Sensitivity { factor, n_base, grains_per_void, mass_ratio, walked }
}

fn of_thickness(walked: Classed, case: &Case, other: &Case) -> OfThickness {
    OfThickness {
        factor: other.network.layers as f64 / case.network.layers as f64,
        layers: other.network.layers,
        thickness_mm: other.thickness(),
        n_base: other.supply.n_base,
        walked,
    }
}
