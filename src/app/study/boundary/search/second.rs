//! The boundary of the second run: the least ratio at which erosion continues.

use super::trials::{Pair, Search, Trial, Walker, ratio_at};
use super::{Beside, Ended};
use crate::outcome::boundary::Beyond;
use crate::run::error::RunError;

/// Steps from stop to stop in the search of the second run, which is far from the first's if bases are broad.
const SECOND_STOP: i64 = 32;

impl<W: Walker> Search<W> {
    pub(super) fn continuing(&mut self, first: Pair) -> Result<Result<Pair, Beside>, RunError> {
        let mut at = (first.1 + SECOND_STOP - 1).div_euclid(SECOND_STOP) * SECOND_STOP;
        at = at.min(self.stops[1].max(first.1));
        let mut below = first.0;
        loop {
            match self.try_second(at)? {
                Trial::Eroded(eroded) if !eroded.below_threshold => break,
                Trial::CannotBe(_, why) => return Ok(Err((Beyond::Above, Ended::NotWalked(why)))),
                _ if at >= self.stops[1] => {
                    return Ok(Err((Beyond::Above, Ended::Holds(2, ratio_at(at)))));
                }
                _ => (below, at) = (at, (at + SECOND_STOP).min(self.stops[1])),
            }
        }
        // If the first run held, nothing continues.
        self.halved((below, at), Self::try_second).map(Ok)
    }
}
