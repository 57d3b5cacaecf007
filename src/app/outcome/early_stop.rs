//! Early stop of a point of a study with a clear class: another number of base particles, or another
//! thickness of the filter.
//!
//! A point is walked on the networks and random numbers of the scene's first replicates, and the scene's
//! own replicates are all known. The first one or two replicates of the point can therefore show that it
//! erodes continually, far above the threshold, as the scene does. Such a point stops; any other is
//! walked in full and judged by the scatter of its own replicates alone.
//!
//! # Conditions for a stop
//! - The scene's verdict is **continuing erosion**, by at least [`FEWEST_OWN`] replicates. Points of no
//!   and some erosion, which a user may rely on, are walked in full.
//! - Each run is wholly above the threshold. Its interval takes **twice** the scatter of the scene's
//!   replicates, or the point's own scatter if that is wider, each with its own Student's factor. The
//!   error is 5 % over both looks and all runs (Bonferroni).
//! - In every replicate, each run is above the threshold, like the scene's run on the same network, and
//!   keeps at least a third of its distance from it. A point that moves more may scatter more.
//!
//! The assumption is that a point scatters at most twice as much as the scene; `results/precision.md`
//! counts how often it fails and how often it misleads.
//!
//! # The ends of the curve's range
//! One replicate is enough at an end whose class equals that of the curve itself: the end is walked to see if
//! it *changes* the class, and the class rests on the case's own replicates. Every run that decides the class
//! is wholly on its side of the threshold, by an interval as above with a scatter of at least 5 % of its
//! value, and keeps a third of its distance. An end of another class, or an unclear one, is walked in full.

use super::record::{Statistic, Verdict};
use super::statistic::two_sided;
use super::stopping::{ReplicateValues, statistic};
use super::verdict::THRESHOLD;

/// Minimum number of replicates of the scene to estimate its scatter.
pub(crate) const FEWEST_OWN: usize = 5;

/// Maximum scatter of a point, as a multiple of the scene's scatter.
const SCATTER: f64 = 2.0;

/// Minimum fraction of its distance from the threshold that a point keeps.
const KEPT: f64 = 1.0 / 3.0;

/// Minimum number of the case's replicates to estimate the scatter at an end of its curve's range.
pub(crate) const FEWEST_OF_RANGE: usize = 4;

/// Minimum scatter of an end, relative to its value: replicates of the case may agree by chance.
const LEAST_SCATTER: f64 = 0.05;

/// Error probability of the class of each of the two ends of a range, unless the scene sets another.
pub(crate) const ERROR_OF_END: f64 = ERROR / 2.0;

/// Error probability of all looks and runs together, and of the intervals shown.
const ERROR: f64 = 0.05;

/// Looks at a point: after one replicate and after two.
const LOOKS: usize = 2;

/// Numbers of replicates at which to look at a point of a study with `of_study` replicates, all of them
/// last; `class` is the scene's class, from `replicates` of it.
pub(crate) fn looks(class: Verdict, replicates: usize, of_study: u64) -> Vec<u64> {
    let may_stop = class == Verdict::Continuing && replicates >= FEWEST_OWN;
    let fewest = if may_stop { 1 } else { of_study };
    (fewest..=LOOKS as u64).filter(|&look| look < of_study).chain([of_study]).collect()
}

/// Eroded mass of each run at a clear point, with wide 95 % intervals; `None` if it is not clear.
/// `scene[run]` holds the scene's replicates, `point[run]` the first ones of the point.
pub(crate) fn clear(
    scene: &[ReplicateValues],
    class: Verdict,
    point: &[ReplicateValues],
) -> Option<Vec<Statistic>> {
    if class != Verdict::Continuing || scene.first()?.len() < FEWEST_OWN {
        return None;
    }
    let error_of_run = ERROR / (LOOKS * scene.len()) as f64;
    let is_clear = scene.iter().zip(point).all(|(scene, point)| is_above(scene, point, error_of_run));
    is_clear.then(|| scene.iter().zip(point).map(|(scene, point)| wide(scene, point, ERROR)).collect())
}

/// Eroded mass of each run at an end of the curve's range after its first replicate, with wide 95 %
/// intervals; `None` unless its class, with this error probability, is clearly that of the curve itself.
pub(crate) fn clear_end(
    case: &[ReplicateValues],
    class: Verdict,
    end: &[ReplicateValues],
    error: f64,
) -> Option<Vec<Statistic>> {
    let deciding = match class {
        Verdict::Undecided => return None,
        Verdict::None => 1,
        Verdict::Some | Verdict::Continuing => case.len(),
    };
    if case.first()?.len() < FEWEST_OF_RANGE {
        return None;
    }
    let error_of_run = error / deciding as f64;
    let is_clear =
        case.iter().zip(end).take(deciding).all(|(case, end)| is_on_its_side(case, end, error_of_run));
    is_clear.then(|| case.iter().zip(end).map(|(case, end)| wide(case, end, ERROR)).collect())
}

/// True if a run at an end is on the side of the threshold where all replicates of the case are.
fn is_on_its_side(case: &ReplicateValues, end: &ReplicateValues, error: f64) -> bool {
    let (Some(&(_, below)), Some(&(value, _))) = (case.first(), end.first()) else { return false };
    let interval = wide(case, end, error);
    let of_value = two_sided((case.len() - 1) as u64, error) * SCATTER * LEAST_SCATTER * value;
    let is_whole = match below {
        true => interval.high.is_some_and(|high| high.max(value + of_value) < THRESHOLD),
        false => interval.low.is_some_and(|low| low.min(value - of_value) >= THRESHOLD),
    };
    let keeps = (value - THRESHOLD) / (statistic(case, ERROR).mean - THRESHOLD) >= KEPT;
    is_whole && keeps && case.iter().chain(end).all(|&(_, side)| side == below)
}

/// True if a run of a point is above the threshold with certainty.
fn is_above(scene: &ReplicateValues, point: &ReplicateValues, error: f64) -> bool {
    let keeps = |(&(scene, scene_below), &(value, value_below)): (&(f64, bool), &(f64, bool))| {
        !scene_below && !value_below && value - THRESHOLD >= KEPT * (scene - THRESHOLD)
    };
    let is_whole = wide(scene, point, error).low.is_some_and(|low| low >= THRESHOLD);
    is_whole && scene.iter().zip(point).all(keeps)
}

/// Interval of a point: from twice the scatter of the scene, or from its own scatter if that is wider.
fn wide(scene: &ReplicateValues, point: &ReplicateValues, error: f64) -> Statistic {
    let of_point = statistic(point, ERROR);
    let reach =
        |scatter: f64, replicates: usize| two_sided((replicates as u64).saturating_sub(1), error) * scatter;
    let of_scene = reach(SCATTER * statistic(scene, ERROR).sd.unwrap_or(0.0), scene.len());
    let of_itself = of_point.sd.map_or(0.0, |sd| reach(sd, point.len()));
    let half = of_scene.max(of_itself) / (point.len() as f64).sqrt();
    Statistic {
        low: Some((of_point.mean - half).max(0.0)),
        high: Some((of_point.mean + half).min(1.0)),
        ..of_point
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(values: &[f64]) -> ReplicateValues {
        values.iter().map(|&v| (v, v < THRESHOLD)).collect()
    }

    /// Ten replicates of a run with this mean and a standard deviation of 0.02.
    fn ten_values(mean: f64) -> ReplicateValues {
        let steps = [-1.5, -1.2, -0.8, -0.4, -0.1, 0.1, 0.4, 0.8, 1.2, 1.5];
        values(&steps.map(|step| mean + 0.02 * step))
    }

    #[test]
    fn one_replicate_does_for_continuing_erosion_far_from_the_threshold() {
        let scene = [ten_values(0.6), ten_values(0.55)];
        let cleared = clear(&scene, Verdict::Continuing, &[values(&[0.5]), values(&[0.4])]).unwrap();
        // Student's t for 9 degrees of freedom is 2.262; twice the scatter of the scene.
        let sd = statistic(&scene[0], ERROR).sd.unwrap();
        assert!((cleared[0].low.unwrap() - (0.5 - 2.262_157 * 2.0 * sd)).abs() < 1e-6);
        assert_eq!((cleared[0].mean, cleared[0].sd), (0.5, None));
        // A point close to the threshold, or moved over two thirds of the distance to it, is not clear.
        assert_eq!(clear(&scene, Verdict::Continuing, &[values(&[0.5]), values(&[0.17])]), None);
        assert_eq!(clear(&scene, Verdict::Continuing, &[values(&[0.2]), values(&[0.5])]), None);
    }

    #[test]
    fn what_a_reader_may_rely_on_is_walked_in_full() {
        let scene = [ten_values(0.6), ten_values(0.55)];
        for point in [[0.001, 0.001], [0.6, 0.001]] {
            let point = point.map(|value| values(&[value, value]));
            assert_eq!(clear(&scene, Verdict::Continuing, &point), None);
        }
        assert_eq!(clear(&scene, Verdict::Undecided, &[values(&[0.6, 0.6]), values(&[0.5, 0.5])]), None);
        let some = [ten_values(0.6), values(&[0.01; 10])];
        assert_eq!(clear(&some, Verdict::Some, &[values(&[0.5, 0.52]), values(&[0.01, 0.011])]), None);
        let none = [values(&[0.001; 10]), values(&[0.001; 10])];
        assert_eq!(clear(&none, Verdict::None, &[values(&[0.002, 0.003]), values(&[0.0, 0.0])]), None);
    }

    #[test]
    fn its_own_scatter_counts_with_its_own_degrees_of_freedom() {
        let scene = [ten_values(0.6), ten_values(0.55)];
        // Two values 0.02 apart: 63.657 for 1 degree of freedom at 1 %, 0.0141 / sqrt(2) each.
        let cleared = |replicates: [f64; 2]| {
            clear(&scene, Verdict::Continuing, &[values(&replicates), values(&[0.5, 0.5])])
        };
        assert!(cleared([0.5, 0.5]).is_some());
        assert!(cleared([0.49, 0.51]).is_none(), "0.5 less 0.64 is below the threshold");
        assert!(cleared([0.4999, 0.5001]).is_some());
    }

    #[test]
    fn an_end_of_the_same_class_needs_one_replicate_and_any_other_all() {
        let one = |means: [f64; 2]| means.map(|value| values(&[value])).to_vec();
        let four = |mean: f64| values(&[0.99 * mean, mean, mean, 1.01 * mean]);
        let some = [four(0.3), four(0.01)];
        let cleared = clear_end(&some, Verdict::Some, &one([0.35, 0.012]), ERROR_OF_END).unwrap();
        // Student's t for 3 degrees of freedom is 3.182; twice the scatter of 0.3 times 0.00816.
        assert!((cleared[0].low.unwrap() - (0.35 - 3.182_446 * 2.0 * 0.3 * 0.008_165)).abs() < 1e-5);
        // Another class of either run, or a value close to it.
        for other in [[0.05, 0.01], [0.35, 0.2], [0.35, 0.06], [0.12, 0.01]] {
            assert_eq!(clear_end(&some, Verdict::Some, &one(other), ERROR_OF_END), None, "{other:?}");
        }
        let none = [four(0.0), four(0.0)];
        // The second run decides nothing if the first is below the threshold.
        assert!(clear_end(&none, Verdict::None, &one([0.002, 0.2]), ERROR_OF_END).is_some());
        // Zero scatter is no reason to trust a value near the threshold.
        assert_eq!(clear_end(&none, Verdict::None, &one([0.052, 0.0]), ERROR_OF_END), None);
        assert_eq!(clear_end(&none, Verdict::None, &one([0.08, 0.0]), ERROR_OF_END), None);
        assert_eq!(clear_end(&some, Verdict::Undecided, &one([0.35, 0.012]), ERROR_OF_END), None);
        let three = some.clone().map(|replicates| replicates[..3].to_vec());
        assert_eq!(clear_end(&three, Verdict::Some, &one([0.35, 0.012]), ERROR_OF_END), None);
    }

    #[test]
    fn few_replicates_of_the_scene_tell_nothing_of_its_scatter() {
        let four = [values(&[0.6, 0.61, 0.62, 0.63]), values(&[0.6, 0.61, 0.62, 0.63])];
        assert_eq!(clear(&four, Verdict::Continuing, &[values(&[0.6]), values(&[0.6])]), None);
        assert_eq!(looks(Verdict::Continuing, 4, 3), [3]);
        assert_eq!(looks(Verdict::Continuing, 5, 3), [1, 2, 3]);
        assert_eq!((looks(Verdict::None, 10, 3), looks(Verdict::Some, 10, 3)), (vec![3], vec![3]));
        assert_eq!(looks(Verdict::Undecided, 10, 3), [3]);
        assert_eq!(
            (looks(Verdict::Some, 10, 1), looks(Verdict::Continuing, 10, 100)),
            (vec![1], vec![1, 2, 100])
        );
    }
}
