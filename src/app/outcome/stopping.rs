//! Number of replicates needed for a small error, or for a verdict at a confidence level.
//!
//! # Looks
//! The rule looks at the replicates when there are `n_1` of them (the scene's number, at least 8), then
//! at `n_2 = 1.5 n_1`, and so on, rounded up, until it is met or there are `most_replicates`.
//!
//! # Confidence level of the verdict
//! A fixed interval that is looked at repeatedly errs more often than its level states. Look `k`
//! therefore takes intervals with an error probability of `1 / (k (k + 1))` of the whole, which sums to 1
//! over all looks; the two runs share it. If each interval has its nominal coverage, the verdict is wrong
//! with at most the requested error probability for any number of looks (Bonferroni), at the price of
//! somewhat wide intervals. The intervals are Student's, for means of independent replicates.
//!
//! If the constriction curve is known only within a range, the curve and the ends of its range share the
//! error, `1 / curves` each. An end is looked at twice, after one replicate and after as many as the
//! curve has, with half of its share each. At a level below the usual one, an end is classified at the
//! usual level.
//!
//! # Target error
//! Met if the 95 % interval of the mean extends at most the target to either side, in every run (Chow and
//! Robbins). Its coverage is measured in the tests.

use super::record::{ShortOf, Statistic, Stopping, Verdict};
use super::statistic::two_sided;
use super::verdict::{BelowThreshold, THRESHOLD, below_by_interval, class_of, classify};
use voidwalk_core::schema::{only, section, whole, within};

/// Error probability of the deciding intervals if no level is requested.
const USUAL_ERROR: f64 = 0.05;

/// Minimum number of replicates: fewer hardly reveal their own scatter.
const FEWEST: u64 = 8;

section! {
    /// Adds replicates until the eroded mass is known closely enough or the verdict is decided;
    /// `replicates` is then the number at the first look.
    pub struct StopRule in "stop" {
        /// Half width of the 95 % interval of the eroded mass, in every run: percentage points of the base.
        pub target_error_pp: Option<f64> = None, off "0.1",
            only("percentage points of the base, above 0 and below 100", |n| *n > 0.0 && *n < 100.0);
        /// Confidence level (%) at which the verdict is to be decided, corrected for repeated looks.
        pub decide_percent: Option<f64> = None, off "99.9",
            within(50.0..=99.999, "a probability from 50 to 99.999 (%)");
        /// Maximum number of replicates, after which the run stops and reports how many it would need.
        pub most_replicates: u64 = 1000, off, whole(2..=100_000);
    }
}

/// Result of a look at the replicates.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Look {
    /// Add replicates until there are this many.
    Until(u64),
    /// Stop, with this result.
    Stop(Stopping),
}

/// Eroded mass fraction of each replicate, with `true` if it is below the threshold by exact comparison.
pub(crate) type ReplicateValues = Vec<(f64, bool)>;

impl StopRule {
    /// True if the number of replicates is fixed by the scene.
    pub(crate) fn is_unset(&self) -> bool {
        self.target_error_pp.is_none() && self.decide_percent.is_none()
    }

    /// True if a target or a confidence level is set.
    pub(crate) fn is_set(&self) -> bool {
        !self.is_unset()
    }

    /// Number of replicates at look `look`, counted from 1, if the first look is at `first`.
    pub(crate) fn replicates_at(&self, first: u64, look: u64) -> u64 {
        let grow = |n: u64| n.saturating_add(n.div_ceil(2)).min(self.most_replicates);
        (1..look).fold(first.max(FEWEST).min(self.most_replicates), |n, _| grow(n))
    }

    /// Looks at `runs[r][replicate]` of one of several constriction curves, which share the error; the
    /// first look is at `first` replicates.
    pub(crate) fn look_at_one_of(&self, curves: usize, first: u64, runs: &[ReplicateValues]) -> Look {
        let replicates = runs.first().map_or(0, |values| values.len() as u64);
        let look = (1..)
            .find(|&k| self.replicates_at(first, k) >= replicates.min(self.most_replicates))
            .unwrap_or(1);
        let half = |values: &ReplicateValues| {
            let statistic = statistic(values, USUAL_ERROR);
            Some(statistic.high? - statistic.mean)
        };
        let half_width = runs.iter().map(half).try_fold(0.0, |widest, half| Some(f64::max(widest, half?)));
        let near = |target: f64| half_width.is_some_and(|half| 100.0 * half <= target);
        let close = self.target_error_pp.is_none_or(near);
        let of_curve = self.error_of_curve(curves);
        let error = of_curve.map(|error| error / (look * (look + 1)) as f64 / runs.len().max(1) as f64);
        let below: Vec<BelowThreshold> =
            error.map_or(vec![], |error| runs.iter().map(|run| lies(run, error)).collect());
        let verdict = error.map(|_| class_of(&below));
        let met = close && verdict != Some(Verdict::Undecided);
        let next = self.replicates_at(first, look + 1);
        if !met && next > replicates && replicates < self.most_replicates && !self.is_hopeless(runs) {
            return Look::Until(next);
        }
        Look::Stop(Stopping {
            target_error_pp: self.target_error_pp,
            decide_percent: self.decide_percent,
            most: self.most_replicates,
            looks: look,
            met,
            verdict,
            half_width_pp: half_width.map(|half| 100.0 * half),
            short_of: match verdict {
                Some(Verdict::Undecided) => Some(self.undecided(error.unwrap_or(1.0), &below, runs)),
                _ => self.too_wide(replicates, half_width, close),
            },
        })
    }

    /// Error probability of the class of each constriction curve out of `curves`, if a verdict is requested.
    pub(crate) fn error_of_curve(&self, curves: usize) -> Option<f64> {
        self.decide_percent.map(|percent| (1.0 - 0.01 * percent) / curves.max(1) as f64)
    }

    /// Reason why the verdict is open.
    fn undecided(&self, error: f64, below: &[BelowThreshold], runs: &[ReplicateValues]) -> ShortOf {
        if below == [Some(false)] {
            return ShortOf::SecondRun;
        }
        let open = below.iter().position(Option::is_none).unwrap_or(0);
        let Statistic { mean, sd, .. } = statistic(&runs[open], error);
        let sd = sd.unwrap_or(0.0);
        let distance = (mean - THRESHOLD).abs();
        let needed = needed(runs[open].len() as f64, sd / distance, error);
        ShortOf::Decision {
            run: open as u64 + 1,
            mean_percent: 100.0 * mean,
            distance_pp: 100.0 * distance,
            sd_pp: 100.0 * sd,
            needed: (needed < 1e9).then(|| two_digits(needed)),
        }
    }

    /// True if no replicate can decide the open class: the first run is clear and there is no second.
    fn is_hopeless(&self, runs: &[ReplicateValues]) -> bool {
        let clear = |values: &ReplicateValues| {
            values.len() > 1 && statistic(values, 1e-6).low.is_some_and(|low| low >= THRESHOLD)
        };
        self.decide_percent.is_some()
            && self.target_error_pp.is_none()
            && runs.len() == 1
            && runs.iter().all(clear)
    }

    fn too_wide(&self, replicates: u64, half_width: Option<f64>, close: bool) -> Option<ShortOf> {
        let target = self.target_error_pp.filter(|_| !close)?;
        let half_width_pp = 100.0 * half_width?;
        let needed = replicates as f64 * (half_width_pp / target) * (half_width_pp / target);
        Some(ShortOf::Target { half_width_pp, replicates, needed: two_digits(needed) })
    }
}

impl Stopping {
    /// Confidence level of a decided verdict, if it is below the usual level and the verdict is open at
    /// the usual level: `usual` is the verdict of the 95 % intervals.
    pub(crate) fn less_than_usual(&self, usual: Verdict) -> Option<f64> {
        let percent = self.decide_percent.filter(|percent| *percent < 95.0)?;
        let is_decided = self.verdict.is_some_and(|verdict| verdict != Verdict::Undecided);
        (is_decided && self.verdict != Some(usual)).then_some(percent)
    }
}

/// Class of runs at a single look, with this error probability or the usual one of each run if smaller,
/// and the worst class that their intervals allow.
pub(crate) fn class_at(error: f64, runs: &[ReplicateValues]) -> [Verdict; 2] {
    let error_of_run = (error / runs.len().max(1) as f64).min(USUAL_ERROR);
    let [first, second] = [0, 1].map(|run| runs.get(run).and_then(|run| lies(run, error_of_run)));
    let worst = classify(Some(first == Some(true)), Some(second == Some(true)));
    [classify(first, second), worst]
}

/// Side of the threshold on which the mean of a run lies, by an interval with this error probability.
fn lies(run: &ReplicateValues, error: f64) -> BelowThreshold {
    let is_below: Vec<bool> = run.iter().map(|&(_, below)| below).collect();
    below_by_interval(&statistic(run, error), &is_below)
}

/// Mean, standard deviation and interval of replicates.
pub(super) fn statistic(values: &ReplicateValues, error: f64) -> Statistic {
    let values: Vec<f64> = values.iter().map(|&(value, _)| value).collect();
    Statistic::with_error(&values, error)
}

/// Number of replicates, above those walked, for an interval as narrow as the mean's distance from the
/// threshold; `sd` is in units of this distance.
fn needed(walked: f64, sd: f64, error: f64) -> f64 {
    let mut n = walked + 1.0;
    loop {
        let wanted = (two_sided(n.min(1001.0) as u64 - 1, error) * sd).powi(2);
        if wanted <= n || n > 1e9 {
            return n.max(wanted);
        }
        // Student's factor falls with more replicates, so fewer may be enough.
        n = (1.1 * n).ceil().min(wanted.ceil()).max(n + 1.0);
    }
}

/// Rounds a number of replicates to two digits.
fn two_digits(n: f64) -> u64 {
    let unit = libm::pow(10.0, libm::floor(libm::log10(n.max(1.0))) - 1.0).max(1.0);
    (libm::ceil(n / unit) * unit) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;
    use voidwalk_core::stream::{Key, Purpose, unit};

    fn decide(percent: f64, most: u64) -> StopRule {
        StopRule { decide_percent: Some(percent), most_replicates: most, ..StopRule::default() }
    }

    fn close(pp: f64, most: u64) -> StopRule {
        StopRule { target_error_pp: Some(pp), most_replicates: most, ..StopRule::default() }
    }

    fn values(values: impl IntoIterator<Item = f64>) -> ReplicateValues {
        values.into_iter().map(|v| (v, v < THRESHOLD)).collect()
    }

    /// Replicates with this mean and standard deviation until the rule stops; skewed ones are exponential.
    fn until_stop(
        rule: StopRule,
        means: &[f64],
        sd: f64,
        skewed: bool,
        seed: u64,
    ) -> (Stopping, Vec<ReplicateValues>) {
        let mut draws =
            Key { seed, purpose: Purpose::Resampling, run: 0, increment: 0, chunk: 0 }.generator();
        let mut draw = |mean: f64| {
            let (u, v) = (unit(draws.next_u64()), unit(draws.next_u64()));
            let normal = (-2.0 * libm::log(u)).sqrt() * libm::cos(std::f64::consts::TAU * v);
            mean + sd * if skewed { -libm::log(u) - 1.0 } else { normal }
        };
        let mut runs = vec![ReplicateValues::new(); means.len()];
        let mut wanted = rule.replicates_at(10, 1);
        loop {
            while (runs[0].len() as u64) < wanted {
                runs.iter_mut().zip(means).for_each(|(run, &mean)| run.extend(values([draw(mean)])));
            }
            match rule.look_at_one_of(1, 10, &runs) {
                Look::Until(next) => wanted = next,
                Look::Stop(stopping) => return (stopping, runs),
            }
        }
    }

    #[test]
    fn looks_come_at_half_as_many_again_and_end() {
        let rule = decide(99.0, 100);
        let looks: Vec<u64> = (1..9).map(|k| rule.replicates_at(10, k)).collect();
        assert_eq!(looks, [10, 15, 23, 35, 53, 80, 100, 100]);
        assert_eq!(rule.replicates_at(1, 1), 8);
        assert_eq!(decide(99.0, 5).replicates_at(10, 1), 5);
    }

    #[test]
    fn what_is_clear_is_decided_at_once_and_what_is_not_is_said() {
        let rule = decide(99.9, 60);
        let far = [
            values((0..10).map(|k| 0.4 + 0.01 * f64::from(k))),
            values((0..10).map(|k| 0.01 + 0.001 * f64::from(k))),
        ];
        let Look::Stop(stopping) = rule.look_at_one_of(1, 10, &far) else { panic!("clear") };
        assert!(stopping.met && stopping.verdict == Some(Verdict::Some) && stopping.short_of.is_none());
        let near = values((0..10).map(|k| THRESHOLD + 0.01 * (f64::from(k) - 4.6)));
        assert_eq!(rule.look_at_one_of(1, 10, &[near.clone(), near]), Look::Until(15));
        let (stopping, runs) = until_stop(rule.clone(), &[0.0751, 0.01], 0.02, false, 3);
        assert!(!stopping.met && stopping.verdict == Some(Verdict::Undecided) && runs[0].len() == 60);
        assert!(matches!(stopping.short_of, Some(ShortOf::Decision { run: 1, .. })), "{stopping:?}");
        // The first run is clearly above, and there is no second: more replicates cannot help.
        let Look::Stop(stopping) = rule.look_at_one_of(1, 10, &far[..1]) else { panic!("hopeless") };
        assert!(!stopping.met && stopping.short_of == Some(ShortOf::SecondRun));
    }

    #[test]
    fn the_curves_of_a_range_share_the_error() {
        let rule = decide(99.0, 8);
        // Student's t with 7 degrees of freedom: 3.50 at an error of 1 %, 4.03 at 0.5 %, 4.53 at 0.25 %.
        let sd = (60.0f64 / 7.0).sqrt();
        let run = |half_widths: f64| {
            let mean = THRESHOLD - half_widths * 1e-3 * sd / 8f64.sqrt();
            values([-4.0, -3.0, -2.0, -1.0, 1.0, 2.0, 3.0, 4.0].map(|step| mean + 1e-3 * step))
        };
        let decided = |curves: usize, half_widths: f64| {
            let Look::Stop(stopping) = rule.look_at_one_of(curves, 8, &[run(half_widths), run(half_widths)])
            else {
                panic!("no more than eight are allowed")
            };
            let [at_end, worst] = class_at(rule.error_of_curve(curves).unwrap(), &[run(half_widths)]);
            let at_most = if at_end == Verdict::None { Verdict::None } else { Verdict::Continuing };
            assert_eq!(worst, at_most);
            (stopping.verdict.unwrap(), at_end)
        };
        let (none, open) = (Verdict::None, Verdict::Undecided);
        // The first look takes half of the curve's error, and each of two runs half of that; an end is
        // looked at once, here with one run.
        assert_eq!(decided(1, 3.6), (open, none));
        assert_eq!(decided(2, 3.6), (open, open));
        assert_eq!(decided(1, 4.6), (none, none));
        assert_eq!(decided(2, 4.6), (open, none));
        assert_eq!(decided(4, 4.6), (open, none));
        assert_eq!(decided(4, 4.5), (open, open));
        // At 50 % an end is classified by the usual intervals: Student's t at an error of 5 % is 2.36.
        let loose = decide(50.0, 8).error_of_curve(1).unwrap();
        assert_eq!(class_at(loose, &[run(2.3)])[0], open);
        assert_eq!(class_at(loose, &[run(2.4)])[0], none);
        assert_eq!(class_at(loose, &[run(-3.0), run(2.4)]), [Verdict::Some; 2]);
        assert_eq!(class_at(loose, &[run(0.0), run(2.4)]), [open, Verdict::Some]);
    }

    #[test]
    fn a_target_is_reached_or_what_it_takes_is_said() {
        let (stopping, runs) = until_stop(close(0.2, 1000), &[0.3, 0.1], 0.01, false, 5);
        assert!(stopping.met && stopping.half_width_pp.unwrap() <= 0.2 && runs[0].len() > 60, "{stopping:?}");
        let (stopping, runs) = until_stop(close(0.2, 40), &[0.3, 0.1], 0.01, false, 5);
        assert!(!stopping.met && runs[0].len() == 40);
        let Some(ShortOf::Target { needed, .. }) = stopping.short_of else { panic!("{stopping:?}") };
        assert!(needed.to_string().starts_with('1'), "{needed}");
    }

    /// 1,500 runs with a first-run mean a fifth of the standard deviation from the threshold, and 2 %
    /// allowed errors: the number of errors is binomial, and a true rate of 4 % would be detected with a
    /// power of 0.97. The test includes skewed replicates.
    #[test]
    fn the_error_rate_is_kept_however_often_it_looks() {
        for (skewed, mean) in
            [(false, THRESHOLD + 0.002), (false, THRESHOLD - 0.002), (true, THRESHOLD + 0.004)]
        {
            let truth = if mean < THRESHOLD { Verdict::None } else { Verdict::Some };
            let wrong = (0..1500).filter(|&seed| {
                let (stopping, _) = until_stop(decide(98.0, 200), &[mean, 0.02], 0.01, skewed, seed);
                let verdict = stopping.verdict.unwrap();
                verdict != truth && verdict != Verdict::Undecided
            });
            let wrong = wrong.count();
            assert!(wrong <= 45, "{wrong} of 1500 wrong, {skewed}, {mean}");
        }
    }

    /// 3,000 runs until a 95 % interval is narrow enough: it still covers. A true coverage of 92 % would
    /// be detected in about half of them.
    #[test]
    fn an_interval_that_was_waited_for_covers() {
        for sd in [0.005, 0.02] {
            let covered = (0..3000).filter(|&seed| {
                let (stopping, runs) = until_stop(close(0.3, 2000), &[0.2], sd, false, seed);
                let statistic = statistic(&runs[0], 0.05);
                assert!(stopping.met);
                statistic.low.unwrap() <= 0.2 && 0.2 <= statistic.high.unwrap()
            });
            let share = covered.count() as f64 / 3000.0;
            assert!((0.927..0.973).contains(&share), "{share}");
        }
    }
}
