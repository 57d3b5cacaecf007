//! The search of one network: the minimum D15F/D85B at which its first run, and its second, erodes 7.5 %.
//!
//! # Method
//! Ratios are tried on one fixed scale, steps of 0.5 %, whatever the bracket; every sixteenth step (8 %) is a
//! *stop*. From a stop near the closed form for a lone particle the search goes by stops to one that holds
//! and below which another holds too, and up to the first that erodes; between these two neighbours it halves
//! the steps until two neighbouring ones are left. The second run goes by every other stop. So the result
//! depends neither on a bracket that is wider than the ratios tried nor on the start of the search, unless
//! the eroded mass does not rise with the ratio: then the smallest ratio that was seen to erode counts, and a
//! note reports it.
//!
//! A walk scatters: on small networks of broad bases single ratios up to 8.7 % below this boundary were found
//! to erode. So single steps down to 10 % below are tried besides, in either run, closer ones more often, and
//! again below each that erodes. On lattices of less than 40 x 40 voids across the eroded mass scatters more,
//! and a walk by area takes less time: more steps are tried there, and farther down, on ten across every step
//! to 26 % below. The tries end early if the eroded mass falls steadily with the ratio: after five tries or
//! more, if a straight line through them lies below the threshold by 15 % of it, and by eight times the
//! scatter about the line. In 711 searches whose tries went all the way this rule halved the tries, and two
//! boundaries rose, by 4 and 8 % (`results/boundary.md`).
//!
//! Networks of one filter and base lie close together: with the boundaries of the first of them as a hint,
//! the search of another steps away from there, 2 % and then ever more, until it has one that holds and one
//! that erodes; two stops below are tried as well. If this finds nothing, the search goes by stops.
//!
//! The boundary of the second run is searched once the boundary of the first is known, so that other networks
//! can begin meanwhile. The second run is walked only at ratios whose first run erodes, and only near the
//! ratio from which it erodes itself: a ratio that holds in the first run holds in the second.

mod first;
mod second;
#[cfg(test)]
mod tests;
mod trials;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::outcome::boundary::{BETWEEN_STEPS, Beyond};
use crate::outcome::verdict::THRESHOLD;
use crate::run::error::RunError;
pub(super) use trials::USUAL_ACROSS;
use trials::{Pair, STOP, Search, between, ratio_at, smallest_seen, tried_below};
pub(super) use trials::{Trial, Walker};
use voidwalk_practice::Note;

/// Names this search: networks that another has found are not continued with.
pub(super) const METHOD: &str = "design search 9";

/// The ends of the scale.
const BRACKETS: [f64; 2] = [0.1, 1000.0];

/// Why a search found no boundary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum Ended {
    /// The smallest ratio of the search erodes.
    Erodes(f64),
    /// All ratios down to this one erode; with the reason why smaller ones cannot be walked.
    ErodesTo(f64, String),
    /// The largest ratio of the search holds, in this run.
    Holds(u64, f64),
    /// Reason why further ratios are not walked.
    NotWalked(String),
}

impl Ended {
    /// The note for this many networks.
    pub fn note(&self, networks: u64) -> Note {
        match self {
            Self::Erodes(ratio) => Note::ErodesToEnd { ratio: *ratio, networks },
            Self::ErodesTo(ratio, reason) => {
                Note::ErodesTo { ratio: *ratio, networks, reason: reason.clone() }
            }
            Self::Holds(run, ratio) => Note::HoldsToEnd { run: *run, ratio: *ratio, networks },
            Self::NotWalked(reason) => Note::NotWalked { networks, reason: reason.clone() },
        }
    }
}

/// Side of the search on which a boundary lies, and the reason.
pub(super) type Beside = (Beyond, Ended);

/// Results of one network.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Found {
    /// D15F/D85B from which the first run erodes 7.5 %.
    pub no_erosion: Option<f64>,
    /// Reason why there is no such ratio.
    pub no_erosion_beyond: Option<Beside>,
    /// D15F/D85B from which the second run does too.
    pub continuing: Option<f64>,
    /// Reason why there is no such ratio.
    pub continuing_beyond: Option<Beside>,
    /// True if some larger ratio was seen to hold.
    pub is_not_monotone: bool,
    /// Every ratio that was walked, rising, with the eroded mass fraction in the first run and in the second.
    pub walks: Vec<(f64, f64, Option<f64>)>,
    /// For an end of a range that cannot set its answer: a ratio that it holds, the only one that was tried.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spared_at: Option<f64>,
}

/// A network that is done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Done {
    /// Row, counted from 0.
    pub row: usize,
    /// Network, counted from 1.
    pub network: u64,
    /// Results of the network.
    pub found: Found,
}

/// The stop nearest to a ratio, in steps.
fn stop_near(ratio: f64) -> i64 {
    (libm::log(ratio) / BETWEEN_STEPS / STOP as f64).round() as i64 * STOP
}

/// Reports that the smallest ratio of the search erodes.
fn erodes_down_to(step: i64) -> Beside {
    (Beyond::Below, Ended::Erodes(ratio_at(step)))
}

/// Boundaries of another network of the same filter, as a start for this one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Hint {
    /// Both boundaries, if it has them.
    pub boundaries: [Option<f64>; 2],
    /// True if the smallest ratio of the search erodes.
    pub erodes_to_end: bool,
}

impl Hint {
    pub fn of(result: &Found) -> Self {
        let is_beyond = |side: &Option<Beside>| matches!(side, Some((_, Ended::Erodes(_))));
        let all_erode = result.walks.iter().all(|(_, eroded, _)| *eroded >= THRESHOLD);
        let erodes_to_end = is_beyond(&result.no_erosion_beyond) && all_erode;
        Self { boundaries: [result.no_erosion, result.continuing], erodes_to_end }
    }
}

/// Start of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Start {
    /// Ratio at which a search without a hint begins.
    pub ratio: f64,
    /// Boundaries of another network of the filter.
    pub hint: Hint,
    /// Start nodes of a lattice that is walked by area; for another network, the number of the usual lattice.
    pub across: u64,
}

/// A network whose first boundary has been searched, between the ratios of a bracket, and whose second is
/// still to be searched.
pub(super) struct Begun<W> {
    search: Search<W>,
    /// The last step that holds and the first that erodes, as they were found first.
    pair: Option<Pair>,
    found: Found,
}

impl<W: Walker> Search<W> {
    fn new(walker: W, bracket: [f64; 2], across: u64) -> Self {
        let up = |ratio: f64| (libm::log(ratio) / BETWEEN_STEPS / STOP as f64 - 1e-9).ceil() as i64 * STOP;
        let down = |ratio: f64| (libm::log(ratio) / BETWEEN_STEPS / STOP as f64 + 1e-9).floor() as i64 * STOP;
        // Outwards, within the allowed range.
        let stops = [down(bracket[0]).max(up(BRACKETS[0])), up(bracket[1]).min(down(BRACKETS[1]))];
        let (first, second) = (BTreeMap::new(), BTreeMap::new());
        Self { walker, stops, below: tried_below(across), first, second }
    }

    /// Every ratio that was walked, rising, with the eroded mass fraction in the first run and in the second.
    fn walks(&self) -> Vec<(f64, f64, Option<f64>)> {
        let walk = |step: &i64| Some((ratio_at(*step), self.eroded(1, *step)?, self.eroded(2, *step)));
        self.first.keys().filter_map(walk).collect()
    }
}

impl<W: Walker> Begun<W> {
    /// Searches the boundary of the first run.
    ///
    /// # Errors
    /// A walk that goes wrong, or was stopped.
    pub fn new(walker: W, bracket: [f64; 2], start: Start) -> Result<Self, RunError> {
        let mut search = Search::new(walker, bracket, start.across);
        let mut result = Found::default();
        let stops = search.stops;
        let erodes_to_end = start.hint.erodes_to_end && search.erodes(stops[0])?;
        let hint = step_near(start.hint.boundaries[0]);
        let start = stop_near(start.ratio).clamp(stops[0], stops[1].max(stops[0]));
        let first = if erodes_to_end {
            Err(erodes_down_to(stops[0]))
        } else if let Some(pair) = search.near_hint(hint)? {
            Ok(pair)
        } else {
            search.no_erosion(start)?
        };
        let pair = match first {
            Ok(pair) => {
                let least = search.smallest_that_erodes(pair.1, Search::try_first)?;
                let least = smallest_seen(&search.first).unwrap_or(least);
                if least > stops[0] {
                    result.no_erosion = Some(between((least - 1, least), |step| search.eroded(1, step)));
                } else {
                    result.no_erosion_beyond = Some(erodes_down_to(least));
                }
                Some(pair)
            }
            Err(beyond) => {
                result.no_erosion_beyond = Some(beyond.clone());
                result.continuing_beyond = Some(beyond);
                None
            }
        };
        result.walks = search.walks();
        Ok(Self { search, pair, found: result })
    }

    /// Hint for the boundary of the first run on other networks.
    pub fn hint(&self) -> Hint {
        Hint { boundaries: [self.found.no_erosion, None], ..Hint::of(&self.found) }
    }

    /// Searches the boundary of the second run, near `hint` if it is given.
    ///
    /// # Errors
    /// A walk that goes wrong, or was stopped.
    pub fn ended(self, hint: Option<f64>) -> Result<Found, RunError> {
        let Self { mut search, pair, found: mut result } = self;
        if let Some(pair) = pair {
            let second = match search.away_from(step_near(hint), Search::try_second)? {
                Some(pair) => Ok(pair),
                None => search.continuing(pair)?,
            };
            match second {
                // A ratio that holds in the first run does not continue to erode.
                Ok(pair) => {
                    let least = search.smallest_that_erodes(pair.1, Search::try_second)?;
                    let least = smallest_seen(&search.second).unwrap_or(least);
                    if least > search.stops[0] {
                        let second = between((least - 1, least), |step| search.eroded(2, step));
                        result.continuing = Some(result.no_erosion.map_or(second, |first| second.max(first)));
                    } else {
                        result.continuing_beyond = Some(erodes_down_to(least));
                    }
                }
                Err(beyond) => result.continuing_beyond = Some(beyond),
            }
        }
        result.is_not_monotone = search.is_not_monotone();
        result.walks = search.walks();
        Ok(result)
    }
}

/// Searches both boundaries of a network.
///
/// # Errors
/// A walk that goes wrong, or was stopped.
pub(super) fn search(walker: impl Walker, bracket: [f64; 2], start: Start) -> Result<Found, RunError> {
    Begun::new(walker, bracket, start)?.ended(start.hint.boundaries[1])
}

/// The step nearest to a ratio.
fn step_near(ratio: Option<f64>) -> Option<i64> {
    ratio.map(|ratio| (libm::log(ratio) / BETWEEN_STEPS).round() as i64)
}

/// Checks that the first run holds a ratio: at the next step above it, and at the steps below that a search
/// tries as well. `None` if it erodes, or if the ratio is beyond the search.
///
/// # Errors
/// A walk that goes wrong, or was stopped.
pub(super) fn holding<W: Walker>(
    walker: W,
    bracket: [f64; 2],
    (ratio, across): (f64, u64),
) -> Result<Option<Found>, RunError> {
    let mut search = Search::new(walker, bracket, across);
    let step = (libm::log(ratio) / BETWEEN_STEPS).ceil() as i64;
    let holds = (search.stops[0]..=search.stops[1]).contains(&step) && search.surely_holds(step)?;
    Ok(holds.then(|| Found { spared_at: Some(ratio_at(step)), walks: search.walks(), ..Found::default() }))
}
