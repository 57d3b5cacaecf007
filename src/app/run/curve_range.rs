//! Walks a case at the ends of the range in which its constriction curve is known.

use super::callbacks::Event;
use super::error::RunError;
use super::planned::replicates_of_end;
use super::replicates::{
    ReplicateContext, ReplicateResult, map_side_by_side, some_replicates, values_by_run,
};
use super::summary::classed;
use crate::case::{Case, OtherCurve};
use crate::outcome::early_stop::{ERROR_OF_END, clear_end};
use crate::outcome::record::{Classed, CurveEnd, CurveRange, RunSummary, Verdict};
use crate::outcome::stopping::class_at;

/// An end of the range of the curve, and its replicates that were walked.
pub struct BegunEnd<'a> {
    end: &'a OtherCurve,
    /// The case with that curve.
    case: Case,
    part: u64,
    n_base: u64,
    walked: Vec<ReplicateResult>,
}

/// Begins the ends of the range of the curve. If walks fit into the memory side by side, walks a first
/// replicate of each, which is needed in any case, on the random numbers of the case's first replicate.
///
/// # Errors
/// See [`super::replicates::replicates`].
pub fn begin_ends<'a>(case: &'a Case, context: &ReplicateContext) -> Result<Vec<BegunEnd<'a>>, RunError> {
    // The parts before these are the sensitivity study's.
    let before = case.sensitivity_factors().len() as u64 + 1;
    let fit = fit(case);
    let one = |(part, end): (u64, &'a OtherCurve)| {
        let other = case.with_curve(end.curve.clone());
        let n_base = case.base_by_grains(end.times_grains);
        let walked = some_replicates(&other, part, 1..=u64::from(fit), n_base, context)?;
        Ok(BegunEnd { end, case: other, part, n_base, walked })
    };
    map_side_by_side((before..).zip(&case.filter.curve_ends).collect(), fit, one)
}

/// True if walks of the case fit into the memory side by side.
fn fit(case: &Case) -> bool {
    case.side_by_side(case.supply.n_base, rayon::current_num_threads() as u64) > 1
}

/// Walks each end of the range of the curve: one replicate if the class clearly stays, else as many as with
/// the curve itself, whose class and statistics by run are known. `None` if the curve has no range.
///
/// # Errors
/// See [`super::replicates::replicates`].
pub fn curve_range(
    case: &Case,
    walked: &[ReplicateResult],
    (verdict, summary): (Verdict, &[RunSummary]),
    begun: Vec<BegunEnd>,
    context: &ReplicateContext,
) -> Result<Option<CurveRange>, RunError> {
    let one = |begun: BegunEnd| of_end(case, begun, walked, verdict, context);
    let ends: Vec<(CurveEnd, Verdict)> = map_side_by_side(begun, fit(case), one)?;
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

/// Walks one end; also gives the worst class that its walks allow, if a confidence level was asked for.
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
    // Error of each of the two looks.
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
