//! Ratios tried on one network, each once, and the steps by which both runs are searched.

use std::collections::BTreeMap;

use crate::outcome::boundary::{BETWEEN_STEPS, Beyond};
use crate::outcome::verdict::THRESHOLD;
use crate::outcome::{Eroded, Straight};
use crate::run::RunError;

pub(super) const STOP: i64 = 16;

const NEAR: i64 = 4;

/// Start nodes of the usual lattice, 40 x 40.
pub(super) const USUAL_ACROSS: u64 = 1600;

/// Steps below the smallest eroding ratio at which further runs are tried on that lattice: every step down to
/// the first number, then steps at growing distances down to the second.
const USUAL_REACH: [f64; 2] = [4.0, 21.0];

/// Maximum of both numbers on a small lattice: 26 %.
const FARTHEST: f64 = 60.0;

/// Steps below the smallest eroding ratio at which further runs are tried, on a lattice with this many start
/// nodes. The scatter of the eroded mass falls with the square root of their number; the time of a walk grows
/// with it. Halving has already tried the first step, but not below a single ratio that erodes.
fn tried_below(across: u64) -> Vec<i64> {
    let spread = (USUAL_ACROSS as f64 / across.max(1) as f64).sqrt().max(1.0);
    let every = (USUAL_REACH[0] * spread * spread).min(FARTHEST) as i64;
    let far = (USUAL_REACH[1] * spread).min(FARTHEST) as i64;
    let farther = |&step: &i64| Some((step * 7 / 5).max(step + 2));
    let seldom = std::iter::successors(farther(&every), farther).take_while(|step| *step <= far);
    (1..=every).chain(seldom).collect()
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Trial {
    Eroded(Eroded),
    /// The base is too coarse (below) or too fine (above) to be walked at this ratio; with the reason.
    CannotBe(Beyond, String),
}

impl Trial {
    /// True if 7.5 % or more eroded; `None` if the base cannot be walked.
    pub(crate) fn erodes(&self) -> Option<bool> {
        match self {
            Self::Eroded(eroded) => Some(!eroded.below_threshold),
            Self::CannotBe(..) => None,
        }
    }
}

/// Walker of a search; each walk is requested once.
pub(super) trait Walker {
    /// Walks run 1 or 2 at the D15F/D85B of a step; run 2 only after run 1.
    fn walk(&mut self, run: u64, step: i64, ratio: f64) -> Result<Trial, RunError>;
}

const BRACKETS: [f64; 2] = [0.1, 1000.0];

/// D15F/D85B at a step.
pub(super) fn ratio_at(step: i64) -> f64 {
    libm::exp(BETWEEN_STEPS * step as f64)
}

/// Number of steps up to a ratio, as a fraction.
pub(super) fn steps_to(ratio: f64) -> f64 {
    libm::log(ratio) / BETWEEN_STEPS
}

/// Two neighbouring steps: the last that holds and the first that erodes.
pub(super) type Pair = (i64, i64);

/// Eroded mass at steps below a boundary, tried in descending order.
#[derive(Default)]
struct Fall(Vec<(f64, f64, f64)>);

impl Fall {
    /// Minimum number of steps that distinguish a line from the scatter about it.
    const FEWEST: usize = 5;
    /// Minimum distance of the last step below the threshold, as a fraction of the threshold.
    const CLEAR: f64 = 0.15;
    /// Minimum distance between the last step and the threshold, in deviations from the line.
    const DEVIATIONS: f64 = 8.0;

    fn add(&mut self, step: i64, eroded: f64) {
        self.0.push((step as f64, eroded, 1.0));
    }

    /// True if the eroded mass falls so steadily that no lower step erodes by scatter: both the last step and
    /// the straight line through all steps are many deviations below the threshold.
    fn is_steady(&self) -> bool {
        let Some(&(step, eroded, _)) = self.0.last() else { return false };
        if self.0.len() < Self::FEWEST {
            return false;
        }
        let line = Straight::through(&self.0);
        let deviation = (line.chi_squared / (self.0.len() - 2) as f64).sqrt();
        let gap = THRESHOLD - eroded.max(line.offset + line.slope * step);
        line.slope > 0.0 && gap >= (Self::CLEAR * THRESHOLD).max(Self::DEVIATIONS * deviation)
    }
}

pub(super) struct Search<W> {
    walker: W,
    pub(crate) stops: [i64; 2],
    /// Steps below the smallest ratio that erodes, at which further runs are tried.
    below: Vec<i64>,
    /// Trials of the first run and of the second, by step.
    tried: [BTreeMap<i64, Trial>; 2],
}

impl<W: Walker> Search<W> {
    pub(crate) fn new(walker: W, bracket: [f64; 2], across: u64) -> Self {
        let up = |ratio: f64| (steps_to(ratio) / STOP as f64 - 1e-9).ceil() as i64 * STOP;
        let down = |ratio: f64| (steps_to(ratio) / STOP as f64 + 1e-9).floor() as i64 * STOP;
        // Stops lie outside the bracket, but within the allowed range.
        let stops = [down(bracket[0]).max(up(BRACKETS[0])), up(bracket[1]).min(down(BRACKETS[1]))];
        Self { walker, stops, below: tried_below(across), tried: Default::default() }
    }

    fn of_run(&self, run: u64) -> &BTreeMap<i64, Trial> {
        &self.tried[run as usize - 1]
    }

    pub(crate) fn is_tried(&self, run: u64, step: i64) -> bool {
        self.of_run(run).contains_key(&step)
    }

    fn eroded(&self, run: u64, step: i64) -> Option<f64> {
        match self.of_run(run).get(&step)? {
            Trial::Eroded(eroded) => Some(eroded.mass_fraction),
            Trial::CannotBe(..) => None,
        }
    }

    /// Every ratio that was walked, in rising order, with the eroded mass fraction of either run.
    pub(crate) fn walks(&self) -> Vec<(f64, f64, Option<f64>)> {
        let walk = |step: &i64| Some((ratio_at(*step), self.eroded(1, *step)?, self.eroded(2, *step)));
        self.of_run(1).keys().filter_map(walk).collect()
    }

    /// Tries a run at a step. The second run is walked only if the first erodes: otherwise nothing continues.
    pub(crate) fn trial(&mut self, run: u64, step: i64) -> Result<Trial, RunError> {
        if run > 1 {
            let first = self.trial(1, step)?;
            if first.erodes() != Some(true) {
                return Ok(first);
            }
        }
        if !self.is_tried(run, step) {
            let trial = self.walker.walk(run, step, ratio_at(step))?;
            self.tried[run as usize - 1].insert(step, trial);
        }
        Ok(self.of_run(run)[&step].clone())
    }

    pub(crate) fn erodes(&mut self, step: i64) -> Result<bool, RunError> {
        Ok(self.trial(1, step)?.erodes() == Some(true))
    }

    /// Steps away from a hint, ever farther, to one ratio that holds and one that erodes, and halves the
    /// steps between them; `None` without a hint, or if the base cannot be walked.
    pub(crate) fn away_from(&mut self, hint: Option<f64>, run: u64) -> Result<Option<Pair>, RunError> {
        let hint = hint.map(|ratio| steps_to(ratio).round() as i64);
        let Some(hint) = hint.filter(|hint| (self.stops[0]..=self.stops[1]).contains(hint)) else {
            return Ok(None);
        };
        let Some(first) = self.trial(run, hint)?.erodes() else { return Ok(None) };
        let (mut at, mut far) = (hint, NEAR);
        loop {
            let next = if first { at - far } else { at + far };
            if !(self.stops[0]..=self.stops[1]).contains(&next) {
                return Ok(None);
            }
            match self.trial(run, next)?.erodes() {
                None => return Ok(None),
                Some(erodes) if erodes != first => {
                    return self.halved((at.min(next), at.max(next)), run).map(Some);
                }
                Some(_) => (at, far) = (next, 2 * far),
            }
        }
    }

    pub(crate) fn halved(&mut self, (mut low, mut high): Pair, run: u64) -> Result<Pair, RunError> {
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            match self.trial(run, middle)?.erodes() {
                Some(true) => high = middle,
                _ => low = middle,
            }
        }
        Ok((low, high))
    }

    /// True if a step holds together with the steps below it that are also tried.
    pub(crate) fn surely_holds(&mut self, step: i64) -> Result<bool, RunError> {
        let holds = self.trial(1, step)?.erodes() == Some(false);
        Ok(holds && self.smallest_that_erodes(step + 1, 1)? == step + 1)
    }

    /// Smallest eroding step found by trials of single steps below one that erodes: all of them, or enough to
    /// show that the eroded mass falls steadily.
    fn smallest_that_erodes(&mut self, boundary: i64, run: u64) -> Result<i64, RunError> {
        let (mut least, lowest) = (boundary, self.stops[0]);
        'again: loop {
            let mut fall = Fall::default();
            for at in 0..self.below.len() {
                let step = least - self.below[at];
                if step < lowest {
                    break;
                }
                match self.trial(run, step)? {
                    Trial::Eroded(eroded) if !eroded.below_threshold => {
                        least = step;
                        continue 'again;
                    }
                    Trial::Eroded(eroded) => {
                        fall.add(step, eroded.mass_fraction);
                        if fall.is_steady() {
                            break;
                        }
                    }
                    Trial::CannotBe(..) => break,
                }
            }
            return Ok(least);
        }
    }

    /// Ratio from which a run erodes, starting from a step at which it does: the smallest that was seen to
    /// erode, or the step itself if it is the lowest of the search.
    pub(crate) fn boundary(&mut self, step: i64, run: u64) -> Result<Result<f64, i64>, RunError> {
        let least = self.smallest_that_erodes(step, run)?;
        let seen = self.of_run(run).iter().find(|(_, trial)| trial.erodes() == Some(true));
        let least = seen.map_or(least, |(step, _)| *step);
        Ok(if least > self.stops[0] { Ok(self.between((least - 1, least), run)) } else { Err(least) })
    }

    /// Ratio at which 7.5 % erode, linear between two neighbouring steps; halfway if the lower was not
    /// walked.
    fn between(&self, (low, high): Pair, run: u64) -> f64 {
        let part = match (self.eroded(run, low), self.eroded(run, high)) {
            (Some(a), Some(b)) if b > a && a <= THRESHOLD => ((THRESHOLD - a) / (b - a)).clamp(0.0, 1.0),
            _ => 0.5,
        };
        libm::exp(BETWEEN_STEPS * (low as f64 + part * (high - low) as f64))
    }

    /// True if a ratio holds above one that erodes, in either run.
    pub(crate) fn is_not_monotone(&self) -> bool {
        self.tried.iter().any(|trials| {
            let mut erodes = trials.values().filter_map(Trial::erodes);
            erodes.any(|erodes| erodes) && erodes.any(|erodes| !erodes)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_lattices_have_more_steps_to_try() {
        assert_eq!(tried_below(USUAL_ACROSS), [1, 2, 3, 4, 6, 8, 11, 15, 21]);
        assert_eq!(tried_below(100), (1..=60).collect::<Vec<_>>());
        for across in 1..5000 {
            let steps = tried_below(across);
            assert!(steps.is_sorted_by(|a, b| a < b) && steps[0] == 1, "{across}");
            assert!(steps.len() >= 9 && *steps.last().unwrap() <= 60, "{across}");
            assert!(steps.len() >= tried_below(across + 1).len());
        }
    }

    #[test]
    fn a_fall_is_steady_only_where_it_is_clear_of_the_threshold_by_what_scatters() {
        let after = |eroded: &dyn Fn(i64) -> f64| {
            let mut fall = Fall::default();
            (1..=60).find(|&at| {
                fall.add(-at, eroded(at));
                fall.is_steady()
            })
        };
        // A straight line is clear by 15 % of the threshold; five steps are the fewest.
        assert_eq!(after(&|at| 0.075 - 0.001 * at as f64), Some(12));
        assert_eq!(after(&|at| 0.075 - 0.01 * at as f64), Some(5));
        // Scattered erosion becomes clear later; erosion that does not fall never does.
        let scattered = after(&|at| 0.075 - 0.001 * at as f64 + if at % 2 == 0 { 0.003 } else { -0.003 });
        assert!(scattered.is_some_and(|at| (24..=32).contains(&at)), "{scattered:?}");
        assert_eq!(after(&|at| if at % 2 == 0 { 0.01 } else { 0.07 }), None);
        assert_eq!(after(&|_| 0.05), None);
    }
}
