//! The random words of binomial draws, and probabilities as 64-bit fractions.

use super::normal::Normal;
use crate::stream::{Key, LANES, Lanes};

/// The probability 1.
pub(in crate::walk::counts) const CERTAIN: u64 = u64::MAX;

pub(super) const TWO_TO_MINUS_64: f64 = 1.0 / 18_446_744_073_709_551_616.0;

/// The random words of one stream, one after another or a block at a time.
pub(in crate::walk::counts) struct Draws {
    lanes: Lanes,
    block: [u64; LANES],
    used: usize,
    pub(super) normal: &'static Normal,
}

impl Draws {
    pub fn new(key: Key) -> Self {
        Self { lanes: key.lanes(), block: [0; LANES], used: LANES, normal: Normal::table() }
    }

    #[inline(always)]
    pub fn word(&mut self) -> u64 {
        if self.used == LANES {
            self.block = self.lanes.next_block();
            self.used = 0;
        }
        self.used += 1;
        self.block[self.used - 1]
    }

    /// State word by lane of the stream's generators.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(super) fn state(&self) -> &[[u64; LANES]; 4] {
        self.lanes.state()
    }

    /// State word by lane, to be changed by callers that have drawn blocks in vector registers.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(super) fn state_mut(&mut self) -> &mut [[u64; LANES]; 4] {
        self.lanes.state_mut()
    }

    /// A fresh block; words left of the current one stay for [`Draws::word`].
    #[inline(always)]
    pub(super) fn block(&mut self) -> [u64; LANES] {
        self.lanes.next_blocks::<1>()[0]
    }
}

/// Successes, if the rarer outcome turned up `drawn` times.
#[inline(always)]
pub(super) fn turned(n: u64, p: u64, drawn: u64) -> u64 {
    if p > 1 << 63 { n.wrapping_sub(drawn) } else { drawn }
}

/// Probability of the rarer outcome.
#[inline(always)]
pub(super) fn rarer(p: u64) -> u64 {
    p.min(p.wrapping_neg())
}

/// A share of 2^64 as a number; 1 for [`CERTAIN`].
#[inline(always)]
pub(in crate::walk::counts) fn as_unit(p: u64) -> f64 {
    p as f64 * TWO_TO_MINUS_64
}
