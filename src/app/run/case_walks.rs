//! All walks of a case. Its verdict follows from its replicates and the ends of the range of its constriction
//! curve; its studies show how the verdict changes with the number of base particles and with the thickness
//! of the filter.
//!
//! A point of a study is one other number or thickness. It is walked on the random numbers of the first
//! replicates, and so on the same networks; a lattice of another thickness shares the first layers with them.
//! The walk of a point stops when its class is clear ([`crate::outcome::early_stop`]). All points are walked
//! side by side, so that one replicate of each keeps all threads busy.

use std::borrow::Cow;
use std::cmp::Reverse;

use rayon::prelude::*;

use super::RunError;
use super::callbacks::Event;
use super::replicates::{
    ReplicateContext, ReplicateResult, classed, fit_side_by_side, map_side_by_side, replicates,
    replicates_at_least, replicates_of_end, some_replicates, stopping, summarise, values_by_run,
    walk_replicate,
};
use crate::case::{Case, OtherCurve};
use crate::outcome::early_stop::{ERROR_OF_END, clear, clear_end, looks};
use crate::outcome::record::{
    Classed, CurveEnd, CurveRange, OfThickness, RunSummary, Sensitivity, Statistic, Stopping, Verdict,
};
use crate::outcome::stopping::class_at;

/// Everything walked for the verdict of a case, and the resulting class.
pub(crate) struct CaseWalks {
    pub(crate) replicates: Vec<ReplicateResult>,
    pub(crate) summary: Vec<RunSummary>,
    /// Result of a rule that adds replicates.
    pub(crate) stopping: Option<Stopping>,
    /// Ends of the range of the curve; `None` if the curve has no range.
    pub(crate) range: Option<CurveRange>,
    pub(crate) verdict: Verdict,
    /// Confidence level (%) at which the rule decided, if below the usual level.
    pub(crate) low_level_percent: Option<f64>,
}

impl CaseWalks {
    /// Walks everything that decides a case's verdict: its replicates and, on their random numbers, the rest.
    pub(crate) fn walk(case: &Case, context: &ReplicateContext) -> Result<Self, RunError> {
        // Ends do not wait for the last replicate.
        let (walked, begun) = rayon::join(|| replicates(case, context), || begin_ends(case, context));
        let (replicates, begun) = (walked?, begun?);
        let (verdict, summary) = summarise(&replicates);
        let stopping = stopping(case, &replicates);
        let low_level_percent = stopping.as_ref().and_then(|stopping| stopping.less_than_usual(verdict));
        // If certainty was asked for, the verdict is the one reached at that confidence level.
        let verdict = stopping.as_ref().and_then(|stopping| stopping.verdict).unwrap_or(verdict);
        let range = curve_range(case, &replicates, (verdict, &summary), begun, context)?;
        let verdict = range.as_ref().map_or(verdict, CurveRange::whole);
        Ok(Self { replicates, summary, stopping, range, verdict, low_level_percent })
    }
}

/// End of the range of the curve, with its replicates walked so far.
struct BegunEnd<'a> {
    end: &'a OtherCurve,
    case: Case,
    part: u64,
    n_base: u64,
    walked: Vec<ReplicateResult>,
}

/// Begins the ends of the range of the curve. Each needs a first replicate in any case; it is walked at once,
/// on the random numbers of the case's first replicate, if the walks fit into memory side by side.
fn begin_ends<'a>(case: &'a Case, context: &ReplicateContext) -> Result<Vec<BegunEnd<'a>>, RunError> {
    // Lower part numbers belong to the sensitivity study.
    let before = case.sensitivity_factors().len() as u64 + 1;
    let fit = fit_side_by_side(case, case.supply.n_base);
    let one = |(part, end): (u64, &'a OtherCurve)| {
        let other = case.with_curve(end.curve.clone());
        let n_base = case.base_by_grains(end.times_grains);
        let walked = some_replicates(&other, part, 1..=u64::from(fit), n_base, context)?;
        Ok(BegunEnd { end, case: other, part, n_base, walked })
    };
    map_side_by_side((before..).zip(&case.filter.curve_ends).collect(), fit, one)
}

/// Walks each end of the range of the curve: one replicate if the class is clearly the same, else as many as
/// with the curve itself, whose class and statistics by run are given. `None` if the curve has no range.
fn curve_range(
    case: &Case,
    walked: &[ReplicateResult],
    (verdict, summary): (Verdict, &[RunSummary]),
    begun: Vec<BegunEnd>,
    context: &ReplicateContext,
) -> Result<Option<CurveRange>, RunError> {
    let one = |begun: BegunEnd| of_end(case, begun, walked, verdict, context);
    let ends = map_side_by_side(begun, fit_side_by_side(case, case.supply.n_base), one)?;
    let (ends, mut allowed): (Vec<CurveEnd>, Vec<Verdict>) = ends.into_iter().unzip();
    allowed.push(match (verdict, case.scene.stop.error_of_curve(case.curves())) {
        (Verdict::Undecided, Some(error)) => class_at(error, &values_by_run(walked))[1],
        _ => verdict,
    });
    let worst = [Verdict::Continuing, Verdict::Some].into_iter().find(|class| allowed.contains(class));
    let could_be = case.scene.stop.decide_percent.map(|_| worst.unwrap_or(Verdict::None));
    let runs: Vec<_> = summary.iter().map(|run| run.eroded_mass_fraction).collect();
    Ok(CurveRange::new(verdict, &runs, ends, case.filter.library.is_some(), could_be))
}

/// Walks one end; also returns the worst class that its walks allow, if a confidence level was asked for.
fn of_end(
    case: &Case,
    begun: BegunEnd,
    walked: &[ReplicateResult],
    class: Verdict,
    context: &ReplicateContext,
) -> Result<(CurveEnd, Verdict), RunError> {
    let (first, all) = (replicates_of_end(walked.len() as u64), walked.len() as u64);
    let BegunEnd { end, case: other, part, n_base, walked: mut of_end } = begun;
    of_end.extend(some_replicates(&other, part, of_end.len() as u64 + 1..=first, n_base, context)?);
    // Error probability of each of the two looks.
    let error = case.scene.stop.error_of_curve(case.curves()).map(|error| 0.5 * error);
    let of_first = error.unwrap_or(ERROR_OF_END).min(ERROR_OF_END);
    let clear = clear_end(&values_by_run(walked), class, &values_by_run(&of_end), of_first);
    let mut could_be = class;
    let walked = match clear {
        Some(runs) if first < all => {
            Classed { stopped_when_clear: true, verdict: class, runs, ..classed(&of_end) }
        }
        _ => {
            if first < all {
                context.tell(Event::MoreRuns { runs: (all - first) * case.scene.walk.runs });
            }
            of_end.extend(some_replicates(&other, part, first + 1..=all, n_base, context)?);
            let usual = classed(&of_end);
            let by_level = error.map(|error| class_at(error, &values_by_run(&of_end)));
            let [verdict, worst] = by_level.unwrap_or([usual.verdict; 2]);
            could_be = worst;
            Classed { verdict, ..usual }
        }
    };
    let dc50_factor = end.curve.dc(50.0).unwrap_or(f64::NAN) / case.filter.curve.dc(50.0).unwrap_or(f64::NAN);
    Ok((CurveEnd { curve: end.name.clone(), dc50_factor, walked }, could_be))
}

/// Results of the studies; empty if they are left out.
#[derive(Clone, Default)]
pub(crate) struct Studies {
    /// Other numbers of base particles, and the case's own.
    pub(crate) sensitivity: Vec<Sensitivity>,
    /// Filters of other thicknesses, and the case's own.
    pub(crate) thickness: Vec<OfThickness>,
}

/// Another number of base particles, or another thickness.
struct Point<'a> {
    case: Cow<'a, Case>,
    /// Part number, which identifies its checkpoints.
    part: u64,
    n_base: u64,
    /// Factor on the base particles; `None` if the point changes the thickness.
    base_factor: Option<f64>,
    walked: Vec<ReplicateResult>,
    /// Eroded mass by run, if its walk stopped because the class was clear.
    clear: Option<Vec<Statistic>>,
}

/// The points of both studies of a case.
fn points(case: &Case) -> Vec<Point<'_>> {
    let factors = case.sensitivity_factors();
    // The part numbers in between belong to the ends of the curve's range.
    let thicknesses = (factors.len() + case.filter.curve_ends.len()) as u64 + 1..;
    let point = |part, case, n_base, base_factor| {
        let (walked, clear) = (Vec::new(), None);
        Point { case, part, n_base, base_factor, walked, clear }
    };
    let of_base =
        |(part, factor): (u64, f64)| point(part, Cow::Borrowed(case), case.times_base(factor), Some(factor));
    // Impossible thicknesses are reported with the parts that are left out.
    let of_thickness = |(part, factor): (u64, f64)| {
        let other = case.of_thickness(factor).ok()?;
        let n_base = other.supply.n_base;
        Some(point(part, Cow::Owned(other), n_base, None))
    };
    let thick = thicknesses.zip(case.thickness_factors()).filter_map(of_thickness);
    (1..).zip(factors).map(of_base).chain(thick).collect()
}

impl Studies {
    /// Walks the studies of a case whose verdict is known.
    pub(crate) fn walk(case: &Case, walks: &CaseWalks, context: &ReplicateContext) -> Result<Self, RunError> {
        let (of_case, class, mut points) = (&walks.replicates, walks.verdict, points(case));
        let own_values = values_by_run(of_case);
        let most = case.scene.record.sensitivity_replicates;
        let mut known = replicates_at_least(case);
        for until in looks(class, of_case.len(), most) {
            let open: Vec<usize> = (0..points.len()).filter(|&point| points[point].clear.is_none()).collect();
            let more = until.saturating_sub(known) * open.len() as u64 * case.scene.walk.runs;
            if more > 0 {
                context.tell(Event::MoreRuns { runs: more });
            }
            known = known.max(until);
            let first = |point: usize| points[point].walked.len() as u64 + 1;
            let jobs = open.iter().flat_map(|&point| (first(point)..=until).map(move |k| (point, k)));
            let jobs = jobs.collect();
            for (point, _, replicate) in walk_all(&points, jobs, context)? {
                points[point].walked.push(replicate);
            }
            for &point in open.iter().filter(|_| until < most) {
                points[point].clear = clear(&own_values, class, &values_by_run(&points[point].walked));
            }
        }
        let mut studies = Self::default();
        for Point { case: other, n_base, base_factor, walked, clear, .. } in points {
            let usual = classed(&walked);
            let judged = match clear {
                Some(runs) => Classed { stopped_when_clear: true, verdict: class, runs, ..usual },
                None => usual,
            };
            match base_factor {
                Some(factor) => studies.sensitivity.push(of_base(judged, case, factor, n_base)),
                None => studies.thickness.push(of_thickness(judged, case, &other)),
            }
        }
        // The case itself is a point of each of its studies.
        let judged = || Classed { verdict: class, ..classed(of_case) };
        if !studies.sensitivity.is_empty() {
            studies.sensitivity.push(of_base(judged(), case, 1.0, case.supply.n_base));
            studies.sensitivity.sort_by(|a, b| a.factor.total_cmp(&b.factor));
        }
        if !studies.thickness.is_empty() {
            studies.thickness.push(of_thickness(judged(), case, case));
            studies.thickness.sort_by_key(|row| row.layers);
        }
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
}

/// Walks replicates of points, several side by side if they fit into memory; results are in the order of
/// points and replicates.
fn walk_all(
    points: &[Point],
    jobs: Vec<(usize, u64)>,
    context: &ReplicateContext,
) -> Result<Vec<(usize, u64, ReplicateResult)>, RunError> {
    let is_small = |&(point, _): &(usize, u64)| fit_side_by_side(&points[point].case, points[point].n_base);
    let one = |(point, replicate): (usize, u64)| {
        let Point { case, part, n_base, .. } = &points[point];
        Ok((point, replicate, walk_replicate(case, *part, replicate, *n_base, context)?))
    };
    let (mut small, large): (Vec<_>, Vec<_>) = jobs.into_iter().partition(is_small);
    // The longest go first, so that no thread works alone on one at the end.
    small.sort_by_key(|&(point, _)| {
        Reverse(points[point].n_base.saturating_mul(points[point].case.network.layers))
    });
    let walked: Result<Vec<_>, RunError> = small.into_par_iter().with_max_len(1).map(one).collect();
    let mut walked = walked?;
    let large: Result<Vec<_>, RunError> = large.into_iter().map(one).collect();
    walked.extend(large?);
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
