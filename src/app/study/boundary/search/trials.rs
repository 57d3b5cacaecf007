//! The ratios of one network that have been tried, each once, and the steps that both runs are searched with.

use std::collections::BTreeMap;

use crate::outcome::boundary::{BETWEEN_STEPS, Beyond};
use crate::outcome::verdict::THRESHOLD;
use crate::outcome::{Eroded, Straight};
use crate::run::error::RunError;

/// Steps from stop to stop.
pub(super) const STOP: i64 = 16;

/// First step away from a hint.
const NEAR: i64 = 4;

/// Start nodes of the usual lattice, 40 x 40.
pub(in crate::study::boundary) const USUAL_ACROSS: u64 = 1600;

/// Steps below the smallest eroding ratio at which further runs are tried on that lattice: every step down to
/// the first number, then at growing distances down to the second.
const USUAL_REACH: [f64; 2] = [4.0, 21.0];

/// The most of either on a small one: 26 %.
const FARTHEST: f64 = 60.0;

/// Steps below the smallest eroding ratio at which further runs are tried, on a lattice with this many start
/// nodes. The scatter of the eroded mass falls with the root of their number, and the time of a walk grows
/// with it. The first step is known after halving, but not below a single ratio that erodes.
pub(super) fn tried_below(across: u64) -> Vec<i64> {
    let spread = (USUAL_ACROSS as f64 / across.max(1) as f64).sqrt().max(1.0);
    let every = (USUAL_REACH[0] * spread * spread).min(FARTHEST) as i64;
    let far = (USUAL_REACH[1] * spread).min(FARTHEST) as i64;
    let farther = |&step: &i64| Some((step * 7 / 5).max(step + 2));
    let seldom = std::iter::successors(farther(&every), farther).take_while(|step| *step <= far);
    (1..=every).chain(seldom).collect()
}

/// Result of a trial at one ratio.
#[derive(Clone, Debug, PartialEq)]
pub enum Trial {
    /// Eroded mass.
    Eroded(Eroded),
    /// The base cannot be walked at this ratio: it is too coarse (below) or too fine (above), and why.
    CannotBe(Beyond, String),
}

impl Trial {
    /// True if 7.5 % or more eroded; `None` if the base cannot be walked.
    pub(super) fn erodes(&self) -> Option<bool> {
        match self {
            Self::Eroded(eroded) => Some(!eroded.below_threshold),
            Self::CannotBe(..) => None,
        }
    }
}

/// Walks of a search at a ratio; called once for each ratio.
pub trait Walker {
    /// The first run at D15F/D85B `ratio`.
    fn first(&mut self, step: i64, ratio: f64) -> Result<Trial, RunError>;
    /// The second run, after a walk of the first.
    fn second(&mut self, step: i64, ratio: f64) -> Result<Trial, RunError>;
}

impl<W: Walker + ?Sized> Walker for &mut W {
    fn first(&mut self, step: i64, ratio: f64) -> Result<Trial, RunError> {
        (**self).first(step, ratio)
    }

    fn second(&mut self, step: i64, ratio: f64) -> Result<Trial, RunError> {
        (**self).second(step, ratio)
    }
}

/// D15F/D85B at a step.
pub(super) fn ratio_at(step: i64) -> f64 {
    libm::exp(BETWEEN_STEPS * step as f64)
}

/// Two neighbouring steps: the last that holds and the first that erodes; `None` if nothing holds below.
pub(super) type Pair = (i64, i64);

/// Eroded mass at steps below a boundary, tried one after another, each below the one before.
#[derive(Default)]
pub(super) struct Fall(Vec<(f64, f64, f64)>);

impl Fall {
    /// Least number of steps that tell a line from the scatter about it.
    const FEWEST: usize = 5;
    /// Least distance of the last step below the threshold, as a fraction of the threshold.
    const CLEAR: f64 = 0.15;
    /// Least distance between the last step and the threshold, in deviations from the line.
    const DEVIATIONS: f64 = 8.0;

    pub(super) fn add(&mut self, step: i64, eroded: f64) {
        self.0.push((step as f64, eroded, 1.0));
    }

    /// True if the eroded mass falls away from the threshold so steadily that no step farther down erodes by
    /// scatter: the last step is clear of it, and so is the straight line through all, by many deviations.
    pub(super) fn is_steady(&self) -> bool {
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

/// A search under way.
pub(super) struct Search<W> {
    pub(super) walker: W,
    /// The first stop and the last.
    pub(super) stops: [i64; 2],
    /// Steps below the smallest ratio that erodes, at which further runs are tried.
    pub(super) below: Vec<i64>,
    pub(super) first: BTreeMap<i64, Trial>,
    pub(super) second: BTreeMap<i64, Trial>,
}

impl<W: Walker> Search<W> {
    pub(super) fn eroded(&self, run: u64, step: i64) -> Option<f64> {
        match if run == 1 { &self.first } else { &self.second }.get(&step)? {
            Trial::Eroded(eroded) => Some(eroded.mass_fraction),
            Trial::CannotBe(..) => None,
        }
    }

    pub(super) fn try_first(&mut self, step: i64) -> Result<Trial, RunError> {
        if !self.first.contains_key(&step) {
            let trial = self.walker.first(step, ratio_at(step))?;
            self.first.insert(step, trial);
        }
        Ok(self.first[&step].clone())
    }

    /// True if the first run erodes at a step.
    pub(super) fn erodes(&mut self, step: i64) -> Result<bool, RunError> {
        Ok(self.try_first(step)?.erodes() == Some(true))
    }

    /// Tries the second run at a step: erosion continues if both runs erode.
    pub(super) fn try_second(&mut self, step: i64) -> Result<Trial, RunError> {
        let first = self.try_first(step)?;
        if first.erodes() != Some(true) {
            return Ok(first);
        }
        if !self.second.contains_key(&step) {
            let trial = self.walker.second(step, ratio_at(step))?;
            self.second.insert(step, trial);
        }
        Ok(self.second[&step].clone())
    }

    /// Steps away from a hint, ever farther, to one that holds and one that erodes, and halves the steps
    /// between; `None` without a hint, or with a base that cannot be walked.
    pub(super) fn away_from(
        &mut self,
        hint: Option<i64>,
        trial: fn(&mut Self, i64) -> Result<Trial, RunError>,
    ) -> Result<Option<Pair>, RunError> {
        let Some(hint) = hint.filter(|hint| (self.stops[0]..=self.stops[1]).contains(hint)) else {
            return Ok(None);
        };
        let Some(first) = trial(self, hint)?.erodes() else { return Ok(None) };
        let (mut at, mut far) = (hint, NEAR);
        loop {
            let next = if first { at - far } else { at + far };
            if !(self.stops[0]..=self.stops[1]).contains(&next) {
                return Ok(None);
            }
            match trial(self, next)?.erodes() {
                None => return Ok(None),
                Some(erodes) if erodes != first => {
                    return self.halved((at.min(next), at.max(next)), trial).map(Some);
                }
                Some(_) => (at, far) = (next, 2 * far),
            }
        }
    }

    /// Halves the steps between one that holds and one that erodes.
    pub(super) fn halved(
        &mut self,
        (mut low, mut high): Pair,
        trial: fn(&mut Self, i64) -> Result<Trial, RunError>,
    ) -> Result<Pair, RunError> {
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            match trial(self, middle)? {
                Trial::Eroded(eroded) if !eroded.below_threshold => high = middle,
                _ => low = middle,
            }
        }
        Ok((low, high))
    }

    /// True if a step holds, and so do the steps below it that are tried as well.
    pub(super) fn surely_holds(&mut self, step: i64) -> Result<bool, RunError> {
        let holds = self.try_first(step)?.erodes() == Some(false);
        Ok(holds && self.smallest_that_erodes(step + 1, Self::try_first)? == step + 1)
    }

    /// The smallest eroding step that is seen, starting from one that erodes, after trials of single steps
    /// below it: all of them, or enough to show that the eroded mass falls steadily.
    pub(super) fn smallest_that_erodes(
        &mut self,
        boundary: i64,
        trial: fn(&mut Self, i64) -> Result<Trial, RunError>,
    ) -> Result<i64, RunError> {
        let (mut least, lowest) = (boundary, self.stops[0]);
        'again: loop {
            let mut fall = Fall::default();
            for at in 0..self.below.len() {
                let step = least - self.below[at];
                if step < lowest {
                    break;
                }
                match trial(self, step)? {
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

    /// True if a ratio holds above one that erodes, in either run.
    pub(super) fn is_not_monotone(&self) -> bool {
        [&self.first, &self.second].into_iter().any(|trials| {
            let mut eroded = false;
            trials.values().any(|trial| match trial {
                Trial::Eroded(result) => {
                    eroded |= !result.below_threshold;
                    eroded && result.below_threshold
                }
                Trial::CannotBe(..) => false,
            })
        })
    }
}

/// The smallest of these steps that erodes.
pub(super) fn smallest_seen(trials: &BTreeMap<i64, Trial>) -> Option<i64> {
    trials.iter().find(|(_, trial)| trial.erodes() == Some(true)).map(|(step, _)| *step)
}

/// The ratio at which 7.5 % erode, straight between two neighbouring steps; halfway if the lower one was not
/// walked.
pub(super) fn between((low, high): Pair, eroded: impl Fn(i64) -> Option<f64>) -> f64 {
    let part = match (eroded(low), eroded(high)) {
        (Some(a), Some(b)) if b > a && a <= THRESHOLD => ((THRESHOLD - a) / (b - a)).clamp(0.0, 1.0),
        _ => 0.5,
    };
    libm::exp(BETWEEN_STEPS * (low as f64 + part * (high - low) as f64))
}
