//! Shares of the passive particles of a void by exit.

use super::binomial::CERTAIN;
use crate::network::Network;
use crate::walk::exits::{self, VoidExits};
use crate::walk::openings::Ways;

/// Route of the passive particles of a void.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::walk) enum Way {
    /// No exit is open, and they are retained.
    None,
    /// No exit is open until the flow is solved again.
    Wait,
    /// Three exits; the third is the last open one.
    Three,
    /// Three exits; the first is the only open one.
    First,
    /// Three exits; the second is the last open one.
    Second,
    /// There are more or fewer than three exits.
    Other,
}

#[derive(Clone)]
pub(in crate::walk) struct Shares {
    /// Probability, by constriction, that a particle which has not taken an earlier exit of its void takes
    /// this one, as a 64-bit fraction. The last open exit is certain; closed exits have 0.
    probability: Vec<u64>,
    /// Number of exits to the next open one of the void, by constriction; no open exit is skipped.
    on: Vec<u8>,
    route: Vec<Way>,
    shut: Vec<u64>,
    of_three: Vec<u64>,
    /// Upper sixteen bits of the thresholds of each void; 0 if it does not have three exits.
    tops: Vec<[u16; 2]>,
}

impl Shares {
    pub(crate) fn new(network: &Network, ways: Ways) -> Self {
        let mut shares = Self::empty(network);
        exits::of_each(network, ways, 0..network.voids() as u32, |exits| shares.set(network, exits));
        shares
    }

    pub(crate) fn empty(network: &Network) -> Self {
        Self {
            probability: vec![0; network.constrictions()],
            on: vec![1; network.constrictions()],
            route: vec![Way::None; network.voids()],
            shut: vec![0; network.voids().div_ceil(64)],
            of_three: vec![0; network.voids().div_ceil(64)],
            tops: vec![[0; 2]; network.voids()],
        }
    }

    /// Renews the shares of one void.
    ///
    /// They follow from the thresholds of the walk one by one, so both engines give an exit the same
    /// probability, to 2^-64.
    pub(crate) fn set(&mut self, network: &Network, of_void: VoidExits) {
        let VoidExits { void, thresholds, last_open: last, waits } = of_void;
        let exits = network.exits(void);
        let mut before = 0u64;
        for (e, probability) in self.probability[exits.clone()].iter_mut().enumerate() {
            *probability = match last {
                Some(last) if e == last => CERTAIN,
                Some(last) if e < last && thresholds[e] > before => {
                    let (width, rest) = (thresholds[e] - before, before.wrapping_neg());
                    // Before the first open exit nothing has been taken: all of 2^64 is left.
                    let of_rest =
                        if rest == 0 { width } else { ((u128::from(width) << 64) / u128::from(rest)) as u64 };
                    of_rest.min(CERTAIN - 1)
                }
                _ => 0,
            };
            before = thresholds[e];
        }
        let mut on = 1u8;
        for (probability, to_next) in
            self.probability[exits.clone()].iter().zip(&mut self.on[exits.clone()]).rev()
        {
            *to_next = on;
            on = if *probability == 0 { on.saturating_add(1) } else { 1 };
        }
        self.route[void as usize] = match last {
            None if waits => Way::Wait,
            None => Way::None,
            Some(_) if exits.len() != 3 => Way::Other,
            Some(0) => Way::First,
            Some(1) => Way::Second,
            Some(_) => Way::Three,
        };
        let (word, bit) = (void as usize / 64, 1 << (void % 64));
        self.shut[word] = self.shut[word] & !bit | if last.is_none() { bit } else { 0 };
        if exits.len() == 3 {
            self.of_three[word] |= bit;
            self.tops[void as usize] = self.thresholds_of_three(exits.start).map(|t| (t >> 48) as u16);
        }
    }

    pub(crate) fn probability(&self) -> &[u64] {
        &self.probability
    }

    /// First open exit of a void from `exit` on; it must exist.
    #[inline(always)]
    pub(crate) fn open_from(&self, mut exit: usize) -> usize {
        while self.probability[exit] == 0 {
            exit += usize::from(self.on[exit]);
        }
        exit
    }

    /// Next open exit of the void after an open exit that is not certain.
    #[inline(always)]
    pub(crate) fn open_after(&self, exit: usize) -> usize {
        self.open_from(exit + usize::from(self.on[exit]))
    }

    /// Thresholds of the first two of three exits for one 64-bit draw: below the first it picks the first
    /// exit, otherwise below the second the second exit, otherwise the third. They are not valid after an
    /// exit that is certain.
    #[inline(always)]
    pub(crate) fn thresholds_of_three(&self, exit: usize) -> [u64; 2] {
        let (first, second) = (self.probability[exit], self.probability[exit + 1]);
        let of_rest = second - ((u128::from(second) * u128::from(first)) >> 64) as u64;
        // The sum is a probability below 1, except after an exit that is certain: there it wraps to the
        // threshold that is not valid.
        [first, first.wrapping_add(of_rest)]
    }

    #[inline(always)]
    pub(crate) fn route(&self, void: usize) -> Way {
        self.route[void]
    }

    /// Upper sixteen bits of the thresholds of a void with three exits.
    #[inline(always)]
    pub(crate) fn tops(&self, void: usize) -> [u16; 2] {
        self.tops[void]
    }

    /// Two bits for each of the 64 voids of `word`: set if it has no open exit, and if it has three exits.
    #[inline(always)]
    pub(crate) fn shut_and_of_three(&self, word: usize) -> [u64; 2] {
        [self.shut[word], self.of_three[word]]
    }

    /// Tells if the particles of a void without open exits wait there until the flow is solved again.
    pub(crate) fn waits(&self, void: usize) -> bool {
        self.route[void] == Way::Wait
    }

    #[inline]
    pub(crate) fn leads_on(&self, void: usize) -> bool {
        !matches!(self.route[void], Way::None | Way::Wait)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bitvec::vec::BitVec;

    fn shares_of(diameters: [f32; 3], closed: [bool; 3]) -> (Vec<u64>, bool) {
        let network = Network::cubic_from_diameters([1, 1, 1], diameters.to_vec(), 1.0).unwrap();
        let blocked: BitVec = closed.into_iter().collect();
        let shares = Shares::new(&network, Ways::Unblocked(&blocked));
        (shares.probability.clone(), shares.leads_on(0))
    }

    #[test]
    fn probabilities_are_conditional_and_the_last_open_exit_is_certain() {
        let (probability, on) = shares_of([1.0, 1.0, f32::sqrt(2.0)], [false; 3]);
        assert!(on && probability[2] == CERTAIN);
        assert!((probability[0] as f64 / 2f64.powi(62) - 1.0).abs() < 1e-6);
        assert!((probability[1] as f64 / 2f64.powi(64) - 1.0 / 3.0).abs() < 1e-6);
        assert_eq!(shares_of([1.0; 3], [false, true, true]).0, [CERTAIN, 0, 0]);
        assert_eq!(shares_of([1.0; 3], [true, false, true]).0, [0, CERTAIN, 0]);
        assert_eq!(shares_of([1.0; 3], [false, true, false]).0[..2], [1 << 63, 0]);
        assert!(!shares_of([1.0; 3], [true; 3]).1);
        assert!(!shares_of([0.0; 3], [false; 3]).1);
        // Beside an exit with 1e24 times their area the others remain possible.
        assert_eq!(shares_of([1e12, 1.0, 1.0], [false; 3]).0[0], CERTAIN - 1);
        assert_eq!(shares_of([1e12, 1.0, 1.0], [true, false, false]).0[1], 1 << 63);
    }

    /// Up to the last exit the thresholds agree with the walk one by one, to a unit; the value after a
    /// certain exit is not used.
    #[test]
    fn thresholds_of_three_exits_never_wrap_where_they_hold() {
        let sizes = [0.0f32, 1e-12, 1e-3, 0.7, 1.0, 3.0, 1e9, 1e19];
        let all = || sizes.into_iter();
        for d in all().flat_map(|x| all().flat_map(move |y| all().map(move |z| [x, y, z]))) {
            let network = Network::cubic_from_diameters([1, 1, 1], d.to_vec(), 1.0).unwrap();
            let blocked: BitVec = BitVec::repeat(false, 3);
            let shares = Shares::new(&network, Ways::Unblocked(&blocked));
            let [to_first, to_second] = shares.thresholds_of_three(0);
            assert_eq!(to_first, shares.probability[0]);
            assert_eq!(shares.tops(0), [to_first, to_second].map(|t| (t >> 48) as u16));
            assert_eq!(shares.route[0] == Way::First, shares.probability[0] == CERTAIN, "{d:?}");
            assert_eq!(shares.route[0] == Way::Second, shares.probability[1] == CERTAIN, "{d:?}");
            if shares.route[0] == Way::Three {
                assert!(to_second >= to_first, "{d:?}");
            }
        }
    }

    /// More exits in a row are closed than one step can skip, at either end and between open exits.
    #[test]
    fn the_next_open_exit_is_found_beyond_any_number_of_closed_ones() {
        let open = [0, 1, 256, 257, 600, 1111];
        for open in [&open[..], &open[2..], &open[4..5]] {
            let text = format!("from,to,diameter_mm\nstart,0,\n{}", "0,end,1\n".repeat(1200));
            let network = Network::from_csv(text.as_bytes(), "n.csv", 1.0).unwrap();
            let blocked: BitVec = (0..1200).map(|c| !open.contains(&c)).collect();
            let shares = Shares::new(&network, Ways::Unblocked(&blocked));
            let mut exit = shares.open_from(0);
            for (i, &is) in open.iter().enumerate() {
                assert_eq!(exit, is);
                assert_eq!(shares.probability()[exit] == CERTAIN, i + 1 == open.len());
                exit = if i + 1 < open.len() { shares.open_after(exit) } else { exit };
            }
        }
    }

    /// A void whose exits close and reopen is unchanged; its neighbours in the word of bits are unaffected.
    #[test]
    fn a_void_is_shut_and_opened_again() {
        let diameters = (0..3 * 70).map(|c| 1.0 + 0.01 * c as f32).collect();
        let network = Network::cubic_from_diameters([7, 5, 2], diameters, 1.0).unwrap();
        let mut blocked: BitVec = BitVec::repeat(false, network.constrictions());
        let open = Shares::new(&network, Ways::Unblocked(&blocked));
        assert_eq!(open.shut_and_of_three(0), [0, u64::MAX]);
        assert_eq!(open.shut_and_of_three(1), [0, 0b11_1111]);
        let mut shares = Shares::new(&network, Ways::Unblocked(&blocked));
        for (close, route, shut) in
            [([2], Way::Second, 0), ([1], Way::First, 0), ([0], Way::None, 0b1_0000), ([0], Way::First, 0)]
        {
            for exit in close {
                let is_closed = blocked[3 * 68 + exit];
                blocked.set(3 * 68 + exit, !is_closed);
            }
            exits::of_each(&network, Ways::Unblocked(&blocked), [68], |exits| shares.set(&network, exits));
            assert_eq!((shares.route(68), shares.shut_and_of_three(1)), (route, [shut, 0b11_1111]));
            let tops = shares.thresholds_of_three(3 * 68).map(|t| (t >> 48) as u16);
            assert_eq!((shares.tops(68), shares.tops(67)), (tops, open.tops(67)));
        }
        blocked.set(3 * 68 + 1, false);
        blocked.set(3 * 68 + 2, false);
        exits::of_each(&network, Ways::Unblocked(&blocked), [68], |exits| shares.set(&network, exits));
        assert_eq!((shares.route(68), shares.tops(68)), (Way::Three, open.tops(68)));
    }
}
