//! Choice of exits by draws: thresholds by void, renewed when an exit closes or water changes direction.

mod forms;

use bitvec::slice::BitSlice;
use rayon::prelude::*;

use super::openings::Ways;
use super::{Arching, Isa};
use crate::network::Network;
use forms::FewExits;
pub(super) use forms::{CLASS, CLASS_SHIFT, Classed, Jamming, Lattice, Plain, Reads, Widths};

#[derive(Clone, Copy)]
pub(super) struct VoidExits<'a> {
    pub(crate) void: u32,
    /// Threshold of each exit on the 64-bit scale.
    pub(crate) thresholds: &'a [u64],
    /// Position of the last open exit, or `None` if all exits are closed.
    pub(crate) last_open: Option<usize>,
    /// True if all exits are closed and particles wait: in the last solution water left the void through
    /// exits that have been blocked since.
    pub(crate) waits: bool,
}

/// Number of voids that a thread renews at a time.
const PART: usize = 1 << 13;

/// Visits the exits of one void after another; `ways` defines which are open.
pub(super) fn of_each(
    network: &Network,
    ways: Ways,
    voids: impl IntoIterator<Item = u32>,
    look: impl FnMut(VoidExits),
) {
    // Chosen once for all voids.
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

/// Thresholds of the exits of one void on the 64-bit scale, written into `thresholds`; returns the
/// position of the last open exit, or `None` if all exits are closed.
pub(super) fn thresholds(
    network: &Network,
    ways: Ways,
    void: u32,
    thresholds: &mut Vec<u64>,
) -> Option<usize> {
    thresholds_by(network, void, |c| ways.weight(network, c), thresholds)
}

#[inline(always)]
fn thresholds_by(
    network: &Network,
    void: u32,
    weight: impl Fn(usize) -> f64,
    thresholds: &mut Vec<u64>,
) -> Option<usize> {
    // Branch-free, as it is unpredictable which exits are open. Weights are finite.
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

/// Exit thresholds of all voids, in a form suited to the network.
#[derive(Clone)]
pub(crate) struct ExitTable {
    pub(super) form: Form,
    pub(super) isa: Isa,
    pub(super) upstream: Vec<u32>,
}

#[derive(Clone)]
pub(super) enum Form {
    /// Three exits per void, with targets by arithmetic.
    Lattice(Lattice),
    /// Any number of exits, with targets by look-up.
    General(General),
}

#[derive(Clone)]
pub(super) struct General {
    /// Threshold of each constriction, and its upper sixteen bits.
    pub(crate) threshold: Vec<u64>,
    pub(crate) top: Vec<u16>,
    /// Last open exit of each void as a constriction, or `NONE`, or `WAIT`.
    pub(crate) last_open: Vec<u32>,
    /// Exits of each void if few are open, in half a cache line.
    pub(crate) few: Vec<FewExits>,
    /// Target void and width of each constriction, adjacent in memory.
    pub(crate) beyond: Vec<(u32, f32)>,
}

/// Marks a void without an open exit.
pub(super) const NONE: u32 = u32::MAX;
/// Marks a void whose exits have all closed since the last solution of the flow: particles wait for the next.
pub(super) const WAIT: u32 = u32::MAX - 1;

/// Tells if water left a void in the last solution of the flow.
fn waits(network: &Network, void: u32) -> bool {
    network.exit_rule().needs_flow() && network.exits(void).any(|c| network.exit_weight(c) > 0.0)
}

/// Network and exits open at the start of the increment, for a kernel to read.
pub(super) struct OpenExits<'a> {
    pub(crate) network: &'a Network,
    pub(crate) table: &'a ExitTable,
    pub(crate) ways: Ways<'a>,
    pub(crate) widths: &'a [f32],
    pub(crate) passive_limit: f32,
    /// Law of arching; only with a table of the general form, or one that reads widths.
    pub(crate) arching: Option<&'a Arching>,
}

impl ExitTable {
    /// Builds the table with `blocked` constrictions closed.
    #[cfg(test)]
    pub(crate) fn new(network: &Network, blocked: &BitSlice) -> Self {
        let finest = network.finest_open(|c| blocked[c]);
        Self::empty(network, Some(finest)).filled(network, Ways::Unblocked(blocked))
    }

    /// Creates a table without values. On a lattice, particles are compared with the finest open exit of
    /// the void, in classes from the `finest` of all on; without it, with the width of their chosen exit.
    pub(super) fn empty(network: &Network, finest: Option<f32>) -> Self {
        let (voids, constrictions) = (network.voids(), network.constrictions());
        let form = match network.shape() {
            Some([nx, ny, _]) => Form::Lattice(Lattice::new(voids, nx, nx * ny, finest)),
            None => Form::General(General {
                threshold: vec![0; constrictions],
                top: vec![0; constrictions],
                last_open: vec![NONE; voids],
                few: vec![FewExits::NONE; voids],
                beyond: network.targets().iter().copied().zip(network.diameters().iter().copied()).collect(),
            }),
        };
        Self { form, isa: Isa::chosen(), upstream: network.upstream() }
    }

    /// Recomputes the classes after many constrictions have closed, as the open ones may be coarser than
    /// every class.
    pub(super) fn class_anew(&mut self, network: &Network, blocked: &BitSlice) {
        if let Form::Lattice(lattice) = &mut self.form
            && !lattice.by_widths
        {
            lattice.class_anew(network.diameters(), blocked, network.finest_open(|c| blocked[c]));
        }
    }

    /// Builds a table for particles that arch or constrictions that leave openings.
    pub(super) fn by_widths(network: &Network, ways: Ways) -> Self {
        Self::empty(network, None).filled(network, ways)
    }

    fn filled(mut self, network: &Network, ways: Ways) -> Self {
        let voids = 0..network.voids() as u32;
        of_each(network, ways, voids, |exits| self.set(network, ways, exits));
        self
    }

    /// Renews a void with an exit that has just closed, narrowed or changed direction.
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
}

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

    fn parts(&mut self, network: &Network) -> Vec<GeneralPart<'_>> {
        fn front<'a, T>(column: &mut &'a mut [T], length: usize) -> &'a mut [T] {
            column.split_off_mut(..length).expect("columns of one table")
        }
        let (mut left, mut parts) = (self.all(), Vec::new());
        while !left.few.is_empty() {
            let voids = left.few.len().min(PART);
            let exits = network.exits(left.first_void + voids as u32 - 1).end - left.first_exit;
            parts.push(GeneralPart {
                first_void: left.first_void,
                first_exit: left.first_exit,
                threshold: front(&mut left.threshold, exits),
                top: front(&mut left.top, exits),
                last_open: front(&mut left.last_open, voids),
                few: front(&mut left.few, voids),
                beyond: front(&mut left.beyond, exits),
            });
            left.first_void += voids as u32;
            left.first_exit += exits;
        }
        parts
    }
}

impl GeneralPart<'_> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use bitvec::prelude::*;

    fn thresholds_of(diameters: [f32; 3], blocked: [bool; 3]) -> (Vec<u64>, Option<usize>) {
        let network = Network::cubic_from_diameters([1, 1, 1], diameters.to_vec(), 1.0).unwrap();
        let blocked: BitVec = blocked.into_iter().collect();
        let mut out = Vec::new();
        let last = thresholds(&network, Ways::Unblocked(&blocked), 0, &mut out);
        (out, last)
    }

    #[test]
    fn widths_are_areas_and_a_closed_exit_has_none() {
        let (t, last) = thresholds_of([1.0, 1.0, f32::sqrt(2.0)], [false; 3]);
        assert_eq!(last, Some(2));
        assert!((t[0] as f64 / TWO_TO_64 - 0.25).abs() < 1e-7);
        assert!((t[1] as f64 / TWO_TO_64 - 0.5).abs() < 1e-7);
        assert_eq!(thresholds_of([0.0, 1.0, 1.0], [false; 3]).0[0], 0);
        assert_eq!(thresholds_of([1.0, 1.0, 1.0], [true, true, false]), (vec![0, 0, u64::MAX], Some(2)));
        assert_eq!(thresholds_of([1.0, 1.0, 1.0], [false, true, true]), (vec![u64::MAX; 3], Some(0)));
        assert_eq!(thresholds_of([0.0, 1.0, 1.0], [false, true, true]).1, None);
    }

    /// Once the exit with nearly all the area is blocked, the others keep their exact ratio.
    #[test]
    fn nothing_is_left_of_a_blocked_giant() {
        let (giant, _) = thresholds_of([1e6, 1.0, 1.0], [false; 3]);
        assert!(((u64::MAX - giant[0]) as f64 / TWO_TO_64 / 2e-12 - 1.0).abs() < 1e-3);
        assert_eq!(thresholds_of([1e6, 1.0, 1.0], [true, false, false]).0[1], 1 << 63);
        for scale in [1e-6, 1e6] {
            let (t, last) = thresholds_of([scale, 1.0, scale], [false; 3]);
            assert!(t[0] <= t[1] && last == Some(2));
        }
    }

    /// A table renewed void by void as constrictions closed, with classes recomputed, equals a new table
    /// of the open constrictions.
    #[test]
    fn a_table_that_a_run_leaves_is_that_of_the_next() {
        let shape = [7, 5, 4];
        let count = Network::lattice_constrictions(shape).unwrap();
        let diameters =
            (0..count).map(|c| if c % 41 == 0 { 0.0 } else { 0.2 + (c * 7919 % 1009) as f32 / 100.0 });
        let network = Network::cubic_from_diameters(shape, diameters.collect(), 1.0).unwrap();
        let mut blocked: BitVec = BitVec::repeat(false, network.constrictions());
        let mut table = ExitTable::new(&network, &blocked);
        let mut classes = [0; 2];
        for coarsest in [0.25, 1.0, 4.0, 20.0] {
            for c in (0..count).filter(|&c| network.diameters()[c] < coarsest && c % 17 > 0 || c % 29 == 0) {
                if !blocked.replace(c, true) {
                    let ways = Ways::Unblocked(&blocked);
                    of_each(&network, ways, [(c / 3) as u32], |exits| table.set(&network, ways, exits));
                }
            }
            let fresh = ExitTable::new(&network, &blocked);
            let words = |table: &ExitTable| match &table.form {
                Form::Lattice(lattice) => (lattice.plain.clone(), lattice.classed.clone(), lattice.finest),
                Form::General(_) => unreachable!("a lattice"),
            };
            classes[0] += usize::from(words(&table) != words(&fresh));
            table.class_anew(&network, &blocked);
            assert_eq!(words(&table), words(&fresh), "{coarsest}");
            classes[1] += 1;
        }
        assert!(classes[0] > 0 && classes[1] == 4, "{classes:?}");
    }
}
