//! The boundary of the first run: the least ratio at which it erodes 7.5 %.

use super::trials::{Pair, STOP, Search, Trial, Walker, ratio_at};
use super::{Beside, Ended, erodes_down_to};
use crate::outcome::boundary::Beyond;
use crate::run::error::RunError;

impl<W: Walker> Search<W> {
    /// The boundary of the first run near a hint, below which two stops hold as well; `None` if there is no
    /// such boundary.
    pub(super) fn near_hint(&mut self, hint: Option<i64>) -> Result<Option<Pair>, RunError> {
        let Some(pair) = self.away_from(hint, Self::try_first)? else { return Ok(None) };
        let below = (pair.0 - 1).div_euclid(STOP) * STOP;
        let lowest = self.stops[0];
        for stop in [below, below - STOP].into_iter().filter(|stop| *stop >= lowest) {
            if self.erodes(stop)? {
                return Ok(None);
            }
        }
        Ok(Some(pair))
    }

    pub(super) fn no_erosion(&mut self, start: i64) -> Result<Result<Pair, Beside>, RunError> {
        let lowest = self.stops[0];
        let top = match self.stop_that_erodes(start)? {
            Ok(top) => top,
            Err(beyond) => return Ok(Err(beyond)),
        };
        // Down to two stops in a row that hold.
        let (mut least, mut held, mut at) = (top, 0, top);
        while held < 2 {
            at -= STOP;
            if at < lowest {
                break;
            }
            match self.try_first(at)? {
                Trial::Eroded(eroded) if eroded.below_threshold => held += 1,
                Trial::Eroded(_) => (least, held) = (at, 0),
                Trial::CannotBe(_, why) if held == 0 => {
                    return Ok(Err((Beyond::Below, Ended::ErodesTo(ratio_at(least), why))));
                }
                Trial::CannotBe(..) => break,
            }
        }
        if held == 0 && !self.first.contains_key(&(least - STOP)) {
            return Ok(Err(erodes_down_to(least)));
        }
        self.halved((least - STOP, least), Self::try_first).map(Ok)
    }

    /// The first stop from `start` on upwards that erodes; if the base is too fine for any of them, the first
    /// downwards that can be walked.
    fn stop_that_erodes(&mut self, start: i64) -> Result<Result<i64, Beside>, RunError> {
        let [lowest, highest] = self.stops;
        let (mut at, mut too_fine) = (start, None);
        loop {
            let trial = self.try_first(at)?;
            match (trial, &too_fine) {
                (Trial::Eroded(eroded), _) if !eroded.below_threshold => return Ok(Ok(at)),
                (Trial::CannotBe(Beyond::Above, why), _) if at <= start && at > lowest => {
                    too_fine = Some(why);
                    at -= STOP;
                }
                (Trial::CannotBe(Beyond::Above, why), _) => {
                    return Ok(Err((Beyond::Above, Ended::NotWalked(why))));
                }
                (_, Some(why)) => return Ok(Err((Beyond::Above, Ended::NotWalked(why.clone())))),
                (trial, None) if at + STOP > highest => {
                    return Ok(Err(match trial {
                        Trial::CannotBe(beyond, why) => (beyond, Ended::NotWalked(why)),
                        Trial::Eroded(_) => (Beyond::Above, Ended::Holds(1, ratio_at(at))),
                    }));
                }
                _ => at += STOP,
            }
        }
    }
}
