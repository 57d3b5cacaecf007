//! Compact forms of the exits of a void: two words on a cubic lattice, a record of few exits on other
//! networks.

use bitvec::slice::BitSlice;

/// Thresholds of a cubic lattice, two words per void, and its shape.
///
/// A step reads the words that suit the particles of its chunk. Both kinds give the same exits, but words
/// with fewer bits per threshold leave more draws undecided.
#[derive(Clone)]
pub(in crate::walk) struct Lattice {
    /// Words for chunks of particles that are nearly all as fine as the finest open exit of the network.
    /// Bits 16..32: top sixteen bits of the second threshold. Bits 2..16: top fourteen bits of the first.
    /// Bit 1: +y wraps. Bit 0: +x wraps. If no exit is open, the first threshold is above the second.
    pub(crate) plain: Vec<u32>,
    /// Words for chunks of coarser particles, unless widths are read. They are like `plain`, but bits
    /// 21..32 are the top eleven bits of the second threshold, and bits 16..21 the class of the void's
    /// finest open exit.
    pub(crate) classed: Vec<u32>,
    /// Number that a move adds to the void, modulo 2^32. Bits 0 and 1 of the index: bits 0 and 1 of the
    /// word. Bit 2: not the first exit. Bit 3: the third exit. Bit 3 without bit 2 means no open exit and
    /// leads to a void that does not exist.
    pub(crate) moves: [u32; 16],
    /// Bits, as an integer, of a lower bound of the diameters of open exits. Particles up to `finest +
    /// (class << CLASS_SHIFT)`, compared as bits, pass every open exit of a void of that class.
    pub(crate) finest: u32,
    /// True if particles are compared with widths; then there are no words with classes.
    pub(crate) by_widths: bool,
    nx: u32,
    plane: u32,
}

/// Number of bits of a diameter below its class: 32 classes per factor of two.
pub(in crate::walk) const CLASS_SHIFT: u32 = 18;

/// Bits of the class in a word of [`Lattice::classed`].
pub(in crate::walk) const CLASS: u32 = 0x001f_0000;

/// Class of a void with this finest open exit, at its place in a word.
#[inline]
fn class_of(finest: f32, of_all: u32) -> u32 {
    // Exits never reopen.
    let class = finest.to_bits().checked_sub(of_all).expect("no open exit is finer") >> CLASS_SHIFT;
    (class << 16).min(CLASS)
}

impl Lattice {
    /// Creates a table without values; without `finest` it is read by widths.
    pub(crate) fn new(voids: usize, nx: u32, plane: u32, finest: Option<f32>) -> Self {
        let moves = std::array::from_fn(|index| match index {
            0 | 2 => 1,
            1 | 3 => 1u32.wrapping_sub(nx),
            4 | 5 => nx,
            6 | 7 => nx.wrapping_sub(plane),
            8..12 => 1 << 31,
            _ => plane,
        });
        let classed = vec![0; if finest.is_some() { voids } else { 0 }];
        let (by_widths, finest) = (finest.is_none(), finest.map_or(0, f32::to_bits));
        Self { plain: vec![0; voids], classed, moves, finest, by_widths, nx, plane }
    }

    pub(crate) fn set(&mut self, void: u32, thresholds: &[u64], last_open: Option<usize>, finest: f32) {
        self.set_plain(void, thresholds, last_open);
        let (class, plain) = (class_of(finest, self.finest), self.plain[void as usize]);
        self.classed[void as usize] = (plain >> 21) << 21 | class | plain & 0xffff;
    }

    /// Recomputes the class of every void; no open exit is finer than `finest`.
    pub(crate) fn class_anew(&mut self, diameters: &[f32], blocked: &BitSlice, finest: f32) {
        self.finest = finest.to_bits();
        let of_voids = diameters.as_chunks::<3>().0.iter().zip(&mut self.classed);
        for (void, (diameters, word)) in of_voids.enumerate() {
            let open = diameters.iter().zip(3 * void..).filter(|&(&d, c)| d > 0.0 && !blocked[c]);
            let finest = open.map(|(&d, _)| d).fold(f32::INFINITY, f32::min);
            *word = *word & !CLASS | class_of(finest, self.finest);
        }
    }

    pub(crate) fn set_plain(&mut self, void: u32, thresholds: &[u64], last_open: Option<usize>) {
        let (x, row) = (void % self.nx, void % self.plane);
        let wraps = u32::from(x + 1 == self.nx) | u32::from(row + self.nx >= self.plane) << 1;
        let [first, second] = match last_open {
            Some(_) => [thresholds[0] >> 50, thresholds[1] >> 48],
            None => [0x3fff, 0],
        };
        self.plain[void as usize] = (second as u32) << 16 | (first as u32) << 2 | wraps;
    }

    pub(crate) fn words<R: Reads>(&self) -> &[u32] {
        if R::CLASSED { &self.classed } else { &self.plain }
    }

    /// Mask of the bits of a word below the thresholds.
    pub(crate) const fn below<R: Reads>() -> u32 {
        if R::CLASSED { CLASS | 3 } else { 3 }
    }

    /// Exit picked by a draw; `None` if no exit is open, or if the bits of the word do not decide.
    #[inline(always)]
    pub(crate) fn pick<R: Reads>(word: u32, draw: u16) -> Option<u32> {
        let below = Self::below::<R>();
        let [first, second] = [word | below, (word | below) >> 16].map(|half| half as u16);
        let [to_first, to_second] = [draw | below as u16, draw | (below >> 16) as u16];
        match (to_first > first, to_second > second) {
            _ if to_first == first || to_second == second => None,
            (false, true) => None,
            (past_first, past_second) => Some(u32::from(past_first) + u32::from(past_second)),
        }
    }
}

/// Methods by which a lattice kernel determines which particles a constriction stops.
pub(in crate::walk) trait Reads {
    /// Compares with the class of the finest open exit of the void; if false, and without widths, with the
    /// finest open exit of the network.
    const CLASSED: bool = false;
    /// Compares with the width of the chosen exit.
    const WIDTHS: bool = false;
    /// Particles that fit may jam.
    const JAMS: bool = false;
}

/// Nearly all particles are as fine as the finest open exit of the network.
pub(in crate::walk) struct Plain;

pub(in crate::walk) struct Classed;

/// Blocked constrictions leave openings, whose widths change.
pub(in crate::walk) struct Widths;

/// Particles arch; blocked constrictions may leave openings, too.
pub(in crate::walk) struct Jamming;

impl Reads for Plain {}

impl Reads for Classed {
    const CLASSED: bool = true;
}

impl Reads for Widths {
    const WIDTHS: bool = true;
}

impl Reads for Jamming {
    const WIDTHS: bool = true;
    const JAMS: bool = true;
}

/// Open exits of a void if they are few, otherwise the range of its exits.
#[derive(Clone, Copy)]
#[repr(align(32))]
pub(crate) struct FewExits {
    /// Top sixteen bits of the threshold of each open exit except the last; unused entries are the maximum.
    pub(crate) top: [u16; FEW_EXITS],
    /// Position of each open exit among all exits of the void.
    pub(crate) position: [u8; FEW_EXITS],
    pub(crate) begin: u32,
    /// Number of exits of a void whose open exits do not fit in here; 0 if they fit, all are closed, or
    /// the number overflows.
    pub(crate) exits: u16,
    /// True if the void has open exits and they fit in here.
    pub(crate) is_few: bool,
}

const FEW_EXITS: usize = 8;

/// Maximum number of exits counted without branches.
const COUNTED: usize = 64;

impl FewExits {
    pub(crate) const NONE: Self =
        Self { top: [u16::MAX; FEW_EXITS], position: [0; FEW_EXITS], begin: 0, exits: 0, is_few: false };

    /// Builds the record of a void whose exits from `begin` on have these thresholds, which rise at each
    /// open exit; `last` is the position of the last open exit.
    pub(crate) fn new(begin: u32, thresholds: &[u64], last: usize) -> Self {
        // It is unpredictable which exits are open: a closed exit is overwritten by the next.
        let (mut top, mut position) = ([u16::MAX; FEW_EXITS + 1], [0; FEW_EXITS + 1]);
        let (mut before, mut open) = (0, 0);
        for (place, &threshold) in thresholds[..last].iter().enumerate() {
            (top[open], position[open]) = ((threshold >> 48) as u16, place as u8);
            open = (open + usize::from(threshold != before)).min(FEW_EXITS);
            before = threshold;
        }
        (top[open], position[open]) = (u16::MAX, last as u8);
        let is_few = open < FEW_EXITS && last <= usize::from(u8::MAX);
        Self {
            top: std::array::from_fn(|i| top[i]),
            position: std::array::from_fn(|i| position[i]),
            begin,
            exits: if is_few { 0 } else { u16::try_from(thresholds.len()).unwrap_or(0) },
            is_few,
        }
    }

    /// Exit picked by the top sixteen bits of a draw; `None` if they do not decide.
    #[inline(always)]
    pub(crate) fn chosen(&self, draw: u16) -> Option<usize> {
        let passed: u16 = self.top.iter().map(|&top| u16::from(top < draw)).sum();
        let is_tie = self.top.iter().fold(false, |tie, &top| tie | (top == draw));
        // Thresholds rise, and the last exit has none.
        (!is_tie).then(|| self.begin as usize + usize::from(self.position[usize::from(passed)]))
    }

    /// Exit picked by a draw from the upper sixteen bits of all thresholds of the network, if more exits
    /// are open than fit in here.
    #[inline(always)]
    pub(crate) fn chosen_of(&self, tops: &[u16], draw: u16) -> Option<usize> {
        let tops = &tops[self.begin as usize..][..usize::from(self.exits)];
        let passed = if tops.len() <= COUNTED {
            tops.iter().map(|&top| u16::from(top < draw)).sum::<u16>().into()
        } else {
            // A reservoir has thousands of exits.
            tops.partition_point(|&top| top < draw)
        };
        // Thresholds rise, so an equal one is the first that is not passed.
        tops.get(passed).filter(|&&top| top != draw).map(|_| self.begin as usize + passed)
    }
}

#[cfg(test)]
mod tests {
    use super::super::TWO_TO_64;
    use super::*;
    use crate::stream::{Key, Purpose};
    use rand::Rng;

    fn thresholds_of(weight: &[f64]) -> Vec<u64> {
        let total: f64 = weight.iter().sum();
        let sums = weight.iter().scan(0.0, |sum, w| {
            *sum += w;
            Some(*sum)
        });
        sums.map(|sum| (sum / total * TWO_TO_64) as u64).collect()
    }

    /// Any number of exits, some closed, also at the end, and every sixteen-bit draw: the exit by definition
    /// for any other bits, or no exit if the other bits decide. Voids with more exits than can be counted are
    /// left to the slow path.
    #[test]
    fn exits_are_chosen_as_by_the_definition() {
        let mut draws =
            Key { seed: 1, purpose: Purpose::Network, run: 0, increment: 0, chunk: 0 }.generator();
        let mut next = || draws.next_u64() >> 33;
        let few_exits = (0..300).map(|_| 0).chain([9, 40, 64, 65, 300, 3000, 65_535, 65_536]);
        for exits in few_exits {
            let count = if exits == 0 { 1 + next() as usize % 14 } else { exits };
            let mut weight = |e: usize| match next() % 5 {
                _ if exits > 0 && e + 3 > exits => 0.0,
                0 | 1 => 0.0,
                2 if exits == 0 => 1e-9,
                _ => (1 + next() % 97) as f64,
            };
            let weight: Vec<f64> = (0..count).map(&mut weight).collect();
            let Some(last) = weight.iter().rposition(|&w| w > 0.0) else { continue };
            let thresholds = thresholds_of(&weight);
            let few = FewExits::new(7, &thresholds, last);
            let open = weight.iter().filter(|&&w| w > 0.0).count();
            assert!(few.is_few || open > FEW_EXITS || last > 255, "{weight:?}");
            // Seven exits of other voids come first.
            let tops: Vec<u16> =
                [9; 7].into_iter().chain(thresholds.iter().map(|t| (t >> 48) as u16)).collect();
            let mut decided = 0;
            for draw in 0..=u16::MAX {
                let by = |low: u64| {
                    let draw = u64::from(draw) << 48 | low;
                    7 + thresholds.iter().position(|&t| draw < t).unwrap_or(last)
                };
                let chosen = if few.is_few { few.chosen(draw) } else { few.chosen_of(&tops, draw) };
                decided += usize::from(chosen.is_some());
                match chosen {
                    Some(exit) if count <= 300 || draw % 61 == 0 => {
                        assert_eq!([exit; 2], [by(0), by((1 << 48) - 1)], "{count} {draw}");
                    }
                    Some(_) => {}
                    None => assert!(
                        count > 65_535 || draw == u16::MAX || tops[7..].contains(&draw),
                        "{count} {draw}"
                    ),
                }
            }
            match count {
                65_536 => assert_eq!(decided, 0),
                65_535 => assert!(decided > (1 << 16) / 8, "{decided}"),
                _ => assert!(decided > (1 << 16) - 2 * count, "{count}: {decided}"),
            }
        }
        assert_eq!(FewExits::NONE.chosen_of(&[], 9), None);
    }

    #[test]
    fn exits_beyond_a_byte_are_not_few() {
        for (last, is_few) in [(255, true), (256, false), (299, false)] {
            let thresholds: Vec<u64> = (0..300).map(|e| if e < last { 1 << 62 } else { u64::MAX }).collect();
            let few = FewExits::new(7, &thresholds, last);
            let chosen = few.chosen(1 << 15).filter(|_| is_few);
            assert_eq!((few.is_few, chosen), (is_few, is_few.then_some(7 + last)));
            assert_eq!(few.chosen(1), Some(7));
        }
    }
}
