//! Exits that draws pick: thresholds by void, renewed where an exit closes or water turns.

mod few;

use bitvec::slice::BitSlice;
use rayon::prelude::*;

use super::openings::Ways;
use super::reads::Reads;
use super::{Arching, Isa};
use crate::network::Network;
use few::FewExits;

/// Exits of one void, for draws.
#[derive(Clone, Copy)]
pub(super) struct VoidExits<'a> {
    pub void: u32,
    /// Threshold of each exit on the 64-bit scale.
    pub thresholds: &'a [u64],
    /// Position of the last open exit, or `None` where every exit is closed.
    pub last_open: Option<usize>,
    /// True if every exit is closed, and particles wait: water left the void when the flow was solved last,
    /// by exits that have been blocked since.
    pub waits: bool,
}

/// Voids that a thread renews one after another.
const PART: usize = 1 << 13;

/// Looks at the exits of one void after another; `ways` tells which are open.
pub(super) fn of_each(
    network: &Network,
    ways: Ways,
    voids: impl IntoIterator<Item = u32>,
    look: impl FnMut(VoidExits),
) {
    // Chosen here, once for all voids.
    match ways {
        Ways::Unblocked(blocked) => {
            let weight = |c| network.exit_weight(c) * f64::from(u8::from(!blocked[c]));
            let find = |void, into: &mut _| thresholds_by(network, void, weight, into);
            each_by(network, voids, find, look);
        }
        ways => {
            let weight = |c| ways.weight(network, c);
            let find = |void, into: &mut _| thresholds_by(network, void, weight, into);
            each_by(network, voids, find, look);
        }
    }
}

/// Looks at the exits of these voids, with thresholds by `find`.
#[inline(always)]
fn each_by(
    network: &Network,
    voids: impl IntoIterator<Item = u32>,
    find: impl Fn(u32, &mut Vec<u64>) -> Option<usize>,
    mut look: impl FnMut(VoidExits),
) {
    let mut scratch = Vec::new();
    for void in voids {
        let last_open = find(void, &mut scratch);
        let waits = last_open.is_none() && waits(network, void);
        look(VoidExits { void, thresholds: &scratch, last_open, waits });
    }
}

/// Thresholds of the exits of one void on the 64-bit scale, written into `thresholds`; returns the position
/// of the last open exit, or `None` if every exit is closed.
pub(super) fn thresholds(
    network: &Network,
    ways: Ways,
    void: u32,
    thresholds: &mut Vec<u64>,
) -> Option<usize> {
    thresholds_by(network, void, |c| ways.weight(network, c), thresholds)
}

/// Thresholds by the weights of exits.
#[inline(always)]
fn thresholds_by(
    network: &Network,
    void: u32,
    weight: impl Fn(usize) -> f64,
    thresholds: &mut Vec<u64>,
) -> Option<usize> {
    // Without branches: which exits are open cannot be foreseen. Weights are finite.
    let exits = network.exits(void);
    let first = exits.start;
    let (mut total, mut last) = (0.0, usize::MAX);
    thresholds.resize(exits.len(), 0);
    for (threshold, c) in thresholds.iter_mut().zip(exits) {
        let weight = weight(c);
        total += weight;
        last = if weight > 0.0 { c - first } else { last };
        *threshold = weight.to_bits();
    }
    let mut sum = 0.0;
    for threshold in thresholds {
        sum += f64::from_bits(*threshold);
        // A float beyond the range of the integer becomes the largest integer.
        *threshold = (sum / total * TWO_TO_64) as u64;
    }
    (last != usize::MAX).then_some(last)
}

const TWO_TO_64: f64 = 18_446_744_073_709_551_616.0;

/// Exit thresholds of every void, in the form that suits the network.
#[derive(Clone)]
pub struct ExitTable {
    form: Form,
    /// Instructions that read it.
    isa: Isa,
    /// Upstream void of each constriction.
    upstream: Vec<u32>,
}

#[derive(Clone)]
pub(super) enum Form {
    /// Three exits a void, targets by arithmetic.
    Lattice(Lattice),
    /// Any number of exits, targets by look-up.
    General(General),
}

/// Thresholds of a cubic lattice, two words a void, and its shape.
///
/// A step reads the words that suit the particles of its chunk: both kinds say the same, but the one that
/// says it with fewer bits leaves more draws open.
#[derive(Clone)]
pub(super) struct Lattice {
    /// For particles that are nearly all as fine as the finest open exit of the network. Bits 16..32: top
    /// sixteen bits of the second threshold. Bits 2..16: top fourteen bits of the first. Bit 1: +y wraps. Bit
    /// 0: +x wraps. A void without open exits has the first above the second.
    pub plain: Vec<u32>,
    /// For coarser ones, unless widths are read: like `plain`, but bits 21..32: top eleven bits of the second
    /// threshold, and bits 16..21: class of the void's finest open exit.
    pub classed: Vec<u32>,
    /// Number that a move adds to the void, modulo 2^32. Bits 0 and 1 of the index: those of a word. Bit 2:
    /// not the first exit. Bit 3: the third exit. With the latter alone there is no open exit: a void that
    /// does not exist.
    pub moves: [u32; 16],
    /// Bits, as an integer, of a diameter that no open exit is finer than. Particles up to
    /// `finest + (class << CLASS_SHIFT)`, compared as bits, pass every open exit of a void of that class.
    pub finest: u32,
    /// True if particles are held against widths: there are no words with classes.
    by_widths: bool,
    nx: u32,
    plane: u32,
}

/// Bits of a diameter below its class: 32 classes in a factor of two.
pub(super) const CLASS_SHIFT: u32 = 18;

/// Bits of the class in a word of [`Lattice::classed`].
pub(super) const CLASS: u32 = 0x001f_0000;

/// Thresholds of a general network.
#[derive(Clone)]
pub(super) struct General {
    /// By constriction: its threshold, and the upper sixteen bits of that.
    pub threshold: Vec<u64>,
    pub top: Vec<u16>,
    /// By void: its last open exit as a constriction, or `NONE`, or `WAIT`.
    pub last_open: Vec<u32>,
    /// By void: its exits if few are open, in half a cache line.
    pub few: Vec<FewExits>,
    /// By constriction: the void that it leads to and its width, next to each other.
    pub beyond: Vec<(u32, f32)>,
}

/// Marks a void without an open exit.
pub(super) const NONE: u32 = u32::MAX;
/// Marks a void that has had no open exit since the flow was solved last: particles wait until it is solved
/// again.
pub(super) const WAIT: u32 = u32::MAX - 1;

/// Tells if water left a void when the flow was solved last.
fn waits(network: &Network, void: u32) -> bool {
    network.exit_rule().needs_flow() && network.exits(void).any(|c| network.exit_weight(c) > 0.0)
}

/// Network and exits open at the start of the increment, for a kernel to read.
pub(super) struct OpenExits<'a> {
    pub network: &'a Network,
    pub table: &'a ExitTable,
    /// Open exits.
    pub ways: Ways<'a>,
    /// By constriction: its widest way.
    pub widths: &'a [f32],
    pub passive_limit: f32,
    /// Law by which particles arch; only with a table of the general form, or one that has widths read.
    pub arching: Option<&'a Arching>,
}

impl ExitTable {
    /// The table for the constrictions that `blocked` leaves open.
    pub fn new(network: &Network, blocked: &BitSlice) -> Self {
        Self::empty(network, blocked).filled(network, Ways::Unblocked(blocked))
    }

    /// Table with no void set yet.
    pub(super) fn empty(network: &Network, blocked: &BitSlice) -> Self {
        let Some([nx, ny, _]) = network.shape() else { return Self::empty_general(network) };
        let finest = network.finest_open(|c| blocked[c]).to_bits();
        Self::of_form(network, Form::Lattice(Lattice::new(network.voids(), nx, nx * ny, finest)))
    }

    /// Recomputes the classes after many constrictions have closed: the remaining ones may be coarser than
    /// every class.
    pub(super) fn class_anew(&mut self, network: &Network, blocked: &BitSlice) {
        if let Form::Lattice(lattice) = &mut self.form
            && !lattice.by_widths
        {
            lattice.class_anew(network.diameters(), blocked, network.finest_open(|c| blocked[c]));
        }
    }

    /// Table for particles that arch or constrictions that leave openings: each particle is held against the
    /// width of the exit that it chose.
    pub(super) fn by_widths(network: &Network, ways: Ways) -> Self {
        let Some([nx, ny, _]) = network.shape() else {
            return Self::empty_general(network).filled(network, ways);
        };
        let mut lattice = Lattice::new(network.voids(), nx, nx * ny, 0);
        (lattice.by_widths, lattice.classed) = (true, Vec::new());
        Self::of_form(network, Form::Lattice(lattice)).filled(network, ways)
    }

    /// Table in the form that any network has, with no void set yet.
    fn empty_general(network: &Network) -> Self {
        let general = General {
            threshold: vec![0; network.constrictions()],
            top: vec![0; network.constrictions()],
            last_open: vec![NONE; network.voids()],
            few: vec![FewExits::NONE; network.voids()],
            beyond: network.targets().iter().zip(network.diameters()).map(|(&to, &d)| (to, d)).collect(),
        };
        Self::of_form(network, Form::General(general))
    }

    fn of_form(network: &Network, form: Form) -> Self {
        Self { form, isa: Isa::chosen(), upstream: network.upstream() }
    }

    fn filled(mut self, network: &Network, ways: Ways) -> Self {
        let voids = 0..network.voids() as u32;
        of_each(network, ways, voids, |exits| self.set(network, ways, exits));
        self
    }

    /// Renews a void with an exit that has just closed, is narrower, or leads elsewhere.
    pub(super) fn set(&mut self, network: &Network, ways: Ways, of_void: VoidExits) {
        match &mut self.form {
            Form::Lattice(lattice) => {
                let VoidExits { void, thresholds, last_open, .. } = of_void;
                if lattice.by_widths {
                    return lattice.set_plain(void, thresholds, last_open);
                }
                let open = network.exits(void).filter(|&c| ways.weight(network, c) > 0.0);
                let finest = open.map(|c| network.diameters()[c]).fold(f32::INFINITY, f32::min);
                lattice.set(void, thresholds, last_open, finest);
            }
            Form::General(general) => general.all().set(network, ways, of_void),
        }
    }

    /// Renews all voids, on all threads.
    pub(super) fn renew(&mut self, network: &Network, ways: Ways) {
        let Form::General(general) = &mut self.form else {
            let voids = 0..network.voids() as u32;
            return of_each(network, ways, voids, |exits| self.set(network, ways, exits));
        };
        let renew_part = |mut part: GeneralPart| {
            let voids = part.first_void..part.first_void + part.few.len() as u32;
            of_each(network, ways, voids, |exits| part.set(network, ways, exits));
        };
        general.parts(network).into_par_iter().for_each(renew_part);
    }

    pub(super) fn isa(&self) -> Isa {
        self.isa
    }

    pub(super) fn set_isa(&mut self, isa: Isa) {
        self.isa = isa;
    }

    pub(super) fn form(&self) -> &Form {
        &self.form
    }

    /// Upstream void of each constriction.
    pub(super) fn upstream(&self) -> &[u32] {
        &self.upstream
    }
}

/// Thresholds of voids that follow one another.
struct GeneralPart<'a> {
    first_void: u32,
    first_exit: usize,
    threshold: &'a mut [u64],
    top: &'a mut [u16],
    last_open: &'a mut [u32],
    few: &'a mut [FewExits],
    beyond: &'a mut [(u32, f32)],
}

impl General {
    fn all(&mut self) -> GeneralPart<'_> {
        let Self { threshold, top, last_open, few, beyond } = self;
        GeneralPart { first_void: 0, first_exit: 0, threshold, top, last_open, few, beyond }
    }

    /// Parts that threads renew side by side.
    fn parts(&mut self, network: &Network) -> Vec<GeneralPart<'_>> {
        let mut parts = Vec::new();
        let mut left = self.all();
        while left.few.len() > PART {
            let exits = network.exits(left.first_void + PART as u32).start - left.first_exit;
            let GeneralPart { first_void, first_exit, threshold, top, last_open, few, beyond } = left;
            let (threshold, threshold_after) = threshold.split_at_mut(exits);
            let (top, top_after) = top.split_at_mut(exits);
            let (last_open, last_open_after) = last_open.split_at_mut(PART);
            let (few, few_after) = few.split_at_mut(PART);
            let (beyond, beyond_after) = beyond.split_at_mut(exits);
            parts.push(GeneralPart { first_void, first_exit, threshold, top, last_open, few, beyond });
            left = GeneralPart {
                first_void: first_void + PART as u32,
                first_exit: first_exit + exits,
                threshold: threshold_after,
                top: top_after,
                last_open: last_open_after,
                few: few_after,
                beyond: beyond_after,
            };
        }
        parts.push(left);
        parts
    }
}

impl GeneralPart<'_> {
    /// Renews one of its voids.
    fn set(&mut self, network: &Network, ways: Ways, of_void: VoidExits) {
        let VoidExits { void, thresholds, last_open, waits } = of_void;
        let exits = network.exits(void);
        let part = exits.start - self.first_exit..exits.end - self.first_exit;
        if let Ways::Openings(widths, _) = ways {
            let widths = &widths[exits.clone()];
            self.beyond[part.clone()].iter_mut().zip(widths).for_each(|(beyond, &width)| beyond.1 = width);
        }
        self.threshold[part.clone()].copy_from_slice(thresholds);
        self.top[part]
            .iter_mut()
            .zip(thresholds)
            .for_each(|(top, threshold)| *top = (threshold >> 48) as u16);
        let at = (void - self.first_void) as usize;
        self.few[at] = match last_open {
            Some(last) => FewExits::new(exits.start as u32, thresholds, last),
            None => FewExits::NONE,
        };
        self.last_open[at] = match last_open {
            Some(e) => (exits.start + e) as u32,
            None if waits => WAIT,
            None => NONE,
        };
    }
}

/// Class of a void whose finest open exit is this, at its place in a word.
#[inline]
fn class_of(finest: f32, of_all: u32) -> u32 {
    // Nothing opens again.
    let class = finest.to_bits().checked_sub(of_all).expect("no open exit is finer") >> CLASS_SHIFT;
    (class << 16).min(CLASS)
}

impl Lattice {
    fn new(voids: usize, nx: u32, plane: u32, finest: u32) -> Self {
        let moves = std::array::from_fn(|index| match index {
            0 | 2 => 1,
            1 | 3 => 1u32.wrapping_sub(nx),
            4 | 5 => nx,
            6 | 7 => nx.wrapping_sub(plane),
            8..12 => 1 << 31,
            _ => plane,
        });
        Self { plain: vec![0; voids], classed: vec![0; voids], moves, finest, by_widths: false, nx, plane }
    }

    /// Tells if particles are held against widths.
    pub fn by_widths(&self) -> bool {
        self.by_widths
    }

    /// Both words of a void.
    fn set(&mut self, void: u32, thresholds: &[u64], last_open: Option<usize>, finest: f32) {
        self.set_plain(void, thresholds, last_open);
        let (class, plain) = (class_of(finest, self.finest), self.plain[void as usize]);
        self.classed[void as usize] = (plain >> 21) << 21 | class | plain & 0xffff;
    }

    /// Recomputes the class of every void; no open exit is finer than `finest`.
    fn class_anew(&mut self, diameters: &[f32], blocked: &BitSlice, finest: f32) {
        self.finest = finest.to_bits();
        let of_voids = diameters.as_chunks::<3>().0.iter().zip(&mut self.classed);
        for (void, (diameters, word)) in of_voids.enumerate() {
            let open = diameters.iter().zip(3 * void..).filter(|&(&d, c)| d > 0.0 && !blocked[c]);
            let finest = open.map(|(&d, _)| d).fold(f32::INFINITY, f32::min);
            *word = *word & !CLASS | class_of(finest, self.finest);
        }
    }

    fn set_plain(&mut self, void: u32, thresholds: &[u64], last_open: Option<usize>) {
        let (x, row) = (void % self.nx, void % self.plane);
        let wraps = u32::from(x + 1 == self.nx) | u32::from(row + self.nx >= self.plane) << 1;
        let [first, second] = match last_open {
            Some(_) => [thresholds[0] >> 50, thresholds[1] >> 48],
            None => [0x3fff, 0],
        };
        self.plain[void as usize] = (second as u32) << 16 | (first as u32) << 2 | wraps;
    }

    /// The words with or without classes.
    pub fn words<R: Reads>(&self) -> &[u32] {
        if R::CLASSED { &self.classed } else { &self.plain }
    }

    /// Bits of a word that belong to no threshold.
    pub const fn below<R: Reads>() -> u32 {
        if R::CLASSED { CLASS | 3 } else { 3 }
    }

    /// Tells if no exit is open, by a plain word: thresholds of open ones rise.
    #[inline(always)]
    pub fn has_no_exit(plain: u32) -> bool {
        plain & 0xfffc > plain >> 16
    }

    /// Exit that a draw picks by a word, unless it equals a threshold as far as the word goes, or no exit is
    /// open.
    #[inline(always)]
    pub fn pick<R: Reads>(word: u32, draw: u16) -> Option<u32> {
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

#[cfg(test)]
mod tests;
