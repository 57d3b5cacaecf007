//! One increment of passive particles kept as counts per void.
//!
//! The voids are divided into blocks of fixed size, each with its own stream. Workers take the next free
//! block and add the moving particles to their own column; the columns are then added. Integer sums do not
//! depend on order. A few particles in a void with three exits choose individually, with one random word for
//! both thresholds. Larger counts are split exit by exit, with draws for many voids at once.

use super::binomial::{CERTAIN, Draws, FEW, FewTrials, Portable, fill, one};
use super::passive::fraction;
use super::shares::{Shares, Way};
use crate::network::{END, Network};
use crate::stream::{Key, below};
use crate::walk::Isa;
use rayon::prelude::*;
#[cfg(target_arch = "x86_64")]
use std::hint::black_box;
#[cfg(target_arch = "x86_64")]
use std::mem::MaybeUninit;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

#[cfg(target_arch = "x86_64")]
use super::binomial::{Avx2, Avx512};

/// Number of voids that share a stream. Part of the definition of every stream: changing it changes results.
const BLOCK: usize = 1 << 10;

/// Chunk number of the stream for insertion.
const INSERTION: u64 = u64::MAX;

/// Number of occupied blocks below which waking other threads does not pay.
const ALONE: usize = 4;

#[derive(Debug, Default)]
pub(super) struct Moved {
    pub(crate) moves: u64,
    pub(crate) waiting: u64,
    pub(crate) eroded: u64,
    /// Void and number of particles without an open exit.
    pub(crate) stranded: Vec<(u32, u64)>,
}

/// Data for moving counts; rebuilt from network and counts, never stored.
pub(super) struct Flow {
    downstream: Vec<Vec<u32>>,
    occupied: Vec<bool>,
    workers: Vec<Worker>,
    /// Number of moving particles: insertions are added, and every step recounts them.
    pub(crate) moving: u64,
    pub(crate) isa: Isa,
}

struct Worker {
    /// Number of particles that this worker moved to each void; the last entry is for those that left the
    /// filter.
    next: Vec<u64>,
    /// True for each block where `next` may be non-zero.
    touched: Vec<bool>,
    moved: Moved,
    batch: Box<SplitBatch>,
}

/// Counts to be split over the exits of their voids, as columns: each row is a void whose particles still
/// have to choose between one exit and the later ones.
struct SplitBatch {
    rows: usize,
    /// Exit, as a constriction.
    exit: [u32; BLOCK],
    count: [u64; BLOCK],
    probability: [u64; BLOCK],
    taken: [u64; BLOCK],
}

impl Flow {
    pub(crate) fn new(network: &Network, moving: &[u64]) -> Self {
        let blocks = moving.len().div_ceil(BLOCK);
        let worker = || Worker {
            next: vec![0; moving.len() + 1],
            touched: vec![false; blocks],
            moved: Moved::default(),
            batch: Box::new(SplitBatch::new()),
        };
        Self {
            downstream: (0..blocks).map(|block| downstream(network, block)).collect(),
            occupied: moving.chunks(BLOCK).map(|counts| counts.iter().any(|&n| n > 0)).collect(),
            workers: (0..rayon::current_num_threads()).map(|_| worker()).collect(),
            moving: moving.iter().sum(),
            isa: Isa::chosen(),
        }
    }

    /// Puts `count` particles on start nodes, drawn uniformly or `evenly`: the same number on each, and
    /// the remaining ones on one node in each of as many equal parts.
    pub(crate) fn insert(
        &mut self,
        network: &Network,
        count: u64,
        evenly: bool,
        key: Key,
        moving: &mut [u64],
    ) {
        let nodes = network.start();
        let mut draws = Draws::new(Key { chunk: INSERTION, ..key });
        let mut left = count;
        self.moving += count;
        let mut put = |node: usize, n: u64| {
            moving[nodes[node] as usize] += n;
            self.occupied[nodes[node] as usize / BLOCK] = true;
        };
        if evenly {
            let all = nodes.len() as u64;
            let rest = count % all;
            (0..rest).for_each(|m| put(((m * all + below(draws.word(), all)) / rest) as usize, 1));
            if count >= all {
                (0..nodes.len()).for_each(|node| put(node, count / all));
            }
            return;
        }
        if count < nodes.len() as u64 {
            (0..count).for_each(|_| put(below(draws.word(), nodes.len() as u64) as usize, 1));
            return;
        }
        for node in 0..nodes.len() {
            let n = one(&mut draws, left, fraction(1, (nodes.len() - node) as u128));
            if n > 0 {
                put(node, n);
                left -= n;
            }
        }
    }

    pub(crate) fn step(&mut self, network: &Network, shares: &Shares, key: Key, moving: &mut [u64]) -> Moved {
        let occupied: Vec<usize> = (0..self.occupied.len()).filter(|&b| self.occupied[b]).collect();
        let next_block = AtomicUsize::new(0);
        let (counts, downstream, isa) = (&*moving, &self.downstream, self.isa);
        let work = |worker: &mut Worker| {
            while let Some(&block) = occupied.get(next_block.fetch_add(1, Ordering::Relaxed)) {
                let voids = block * BLOCK..counts.len().min((block + 1) * BLOCK);
                let key = Key { chunk: block as u64, ..key };
                step(isa, worker, Block { network, shares, key, counts, voids });
                downstream[block].iter().for_each(|&to| worker.touched[to as usize] = true);
            }
        };
        if occupied.len() < ALONE {
            work(&mut self.workers[0]);
        } else {
            self.workers.par_iter_mut().for_each(work);
        }
        self.gather(&occupied, moving)
    }

    fn gather(&mut self, occupied: &[usize], moving: &mut [u64]) -> Moved {
        for &block in occupied {
            let end = moving.len().min((block + 1) * BLOCK);
            moving[block * BLOCK..end].fill(0);
            self.occupied[block] = false;
        }
        self.moving = 0;
        let mut moved = Moved::default();
        for worker in &mut self.workers {
            let mut part = std::mem::take(&mut worker.moved);
            if part.moves == 0 && part.waiting == 0 && part.stranded.is_empty() {
                continue;
            }
            let (next, left) = worker.next.split_at_mut(moving.len());
            moved.moves += part.moves;
            moved.eroded += std::mem::take(&mut left[0]);
            moved.stranded.append(&mut part.stranded);
            let touched = worker.touched.par_iter_mut().zip(next.par_chunks_mut(BLOCK));
            let blocks = touched.zip(moving.par_chunks_mut(BLOCK)).zip(&mut self.occupied);
            self.moving += blocks
                .with_min_len(16)
                .filter(|(((touched, _), _), _)| **touched)
                .map(|(((touched, next), moving), occupied)| {
                    *touched = false;
                    let mut sum = 0;
                    for (moving, next) in moving.iter_mut().zip(next) {
                        sum += *next;
                        *moving += std::mem::take(next);
                    }
                    *occupied |= sum > 0;
                    sum
                })
                .sum::<u64>();
        }
        // The distribution over workers depends on threads; the order of voids does not.
        moved.stranded.sort_unstable();
        moved
    }
}

struct Block<'a> {
    network: &'a Network,
    shares: &'a Shares,
    key: Key,
    counts: &'a [u64],
    voids: Range<usize>,
}

/// Performs [`Worker::step`] with the instructions of `isa`; the bits are the same for all.
fn step(isa: Isa, worker: &mut Worker, block: Block) {
    assert!(isa.is_available());
    match isa {
        // SAFETY: the machine supports the instructions.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512 => unsafe { with_avx512(worker, block) },
        // SAFETY: the machine supports the instructions.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2 => unsafe { with_avx2(worker, block) },
        // SAFETY: every machine supports these instructions.
        _ => unsafe { worker.step::<Portable>(block) },
    }
}

#[cfg(target_arch = "x86_64")]
#[repr(align(64))]
struct CacheLine {
    _bytes: [u8; 64],
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt")]
fn with_avx512(worker: &mut Worker, block: Block) {
    // Aligns this stack frame to a cache line. Otherwise vectors stored there may cross two lines,
    // depending on the callers.
    black_box(&mut MaybeUninit::<CacheLine>::uninit());
    // SAFETY: only called if the machine supports AVX-512.
    unsafe { worker.step::<Avx512>(block) };
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,popcnt")]
fn with_avx2(worker: &mut Worker, block: Block) {
    // SAFETY: only called if the machine supports AVX2.
    unsafe { worker.step::<Avx2>(block) };
}

fn downstream(network: &Network, block: usize) -> Vec<u32> {
    let end = network.voids().min((block + 1) * BLOCK) as u32;
    let exits = network.exits((block * BLOCK) as u32).start..network.exits(end - 1).end;
    let inner = network.targets()[exits].iter().filter(|&&target| target != END);
    let mut blocks: Vec<u32> = inner.map(|&target| target / BLOCK as u32).collect();
    if network.exit_rule().needs_flow() {
        // Particles may wait in the block itself.
        blocks.push(block as u32);
    }
    blocks.sort_unstable();
    blocks.dedup();
    blocks
}

impl Worker {
    /// Moves the particles of the voids of a block.
    ///
    /// # Safety
    /// The machine supports the instructions of `F`.
    #[inline(always)]
    unsafe fn step<F: FewTrials>(&mut self, block: Block) {
        let Block { network, shares, key, counts, voids } = block;
        let Self { next, moved, batch, .. } = self;
        let (targets, outside) = (network.targets(), next.len() - 1);
        // END is larger than any void.
        let mut arrive =
            |constriction: usize, n: u64| next[(targets[constriction] as usize).min(outside)] += n;
        let mut draws = Draws::new(key);
        // SAFETY: as the caller promises.
        let mut few = unsafe { F::load(&draws) };
        let (first, mut many, mut waiting) = (voids.start, [0; BLOCK / 64], Vec::new());
        for (word, counts) in counts[voids].chunks(64).enumerate() {
            let [occupied, crowded] = occupied_and_crowded(counts);
            let [shut, of_three] = shares.shut_and_of_three(first / 64 + word);
            for void in bits(occupied & shut).map(|bit| first + 64 * word + bit) {
                let n = counts[void % 64];
                if shares.waits(void) {
                    moved.waiting += n;
                    // Added to `next` after all splits.
                    waiting.push((void, n));
                } else {
                    moved.stranded.push((void as u32, n));
                }
            }
            for void in bits(occupied & !shut & of_three & !crowded).map(|bit| first + 64 * word + bit) {
                let (n, route, exit) =
                    (counts[void % 64], shares.route(void), network.exits(void as u32).start);
                let thresholds = || shares.thresholds_of_three(exit);
                let [mut to_first, mut to_second] =
                    few.below_both(&mut draws, n, shares.tops(void), thresholds);
                to_first = if matches!(route, Way::First) { n } else { to_first };
                to_second = if matches!(route, Way::First | Way::Second) { n } else { to_second };
                arrive(exit, to_first);
                arrive(exit + 1, to_second - to_first);
                arrive(exit + 2, n - to_second);
                moved.moves += n;
            }
            many[word] = occupied & !shut & (crowded | !of_three);
        }
        few.store(&mut draws);
        batch.rows = 0;
        for (word, many) in many.into_iter().enumerate() {
            for void in bits(many).map(|bit| first + 64 * word + bit) {
                let exit = shares.open_from(network.exits(void as u32).start);
                batch.rows = batch.face(batch.rows, exit, counts[void], shares, &mut arrive);
                moved.moves += counts[void];
            }
        }
        while batch.rows > 0 {
            batch.round(&mut draws, shares, &mut arrive);
        }
        waiting.iter().for_each(|&(void, n)| next[void] += n);
    }
}

/// Two bits for each of up to 64 voids: set if it holds particles, and if it holds more than a few.
/// Iterating over bits avoids branch misprediction.
#[inline(always)]
fn occupied_and_crowded(counts: &[u64]) -> [u64; 2] {
    let bit = |(i, &n): (usize, &u64)| [u64::from(n > 0) << i, u64::from(n > FEW) << i];
    counts.iter().enumerate().map(bit).fold([0; 2], |all, one| [all[0] | one[0], all[1] | one[1]])
}

#[inline(always)]
fn bits(mut word: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = (word != 0).then(|| word.trailing_zeros() as usize);
        word &= word.wrapping_sub(1);
        place
    })
}

impl SplitBatch {
    fn new() -> Self {
        Self { rows: 0, exit: [0; BLOCK], count: [0; BLOCK], probability: [0; BLOCK], taken: [0; BLOCK] }
    }

    /// Assigns `n` particles to the open exit `exit` of a void: if it is the last they pass, otherwise
    /// they form row `row`. Returns the next row.
    #[inline(always)]
    fn face(
        &mut self,
        row: usize,
        exit: usize,
        n: u64,
        shares: &Shares,
        arrive: &mut impl FnMut(usize, u64),
    ) -> usize {
        let probability = shares.probability()[exit];
        if probability == CERTAIN {
            arrive(exit, n);
            return row;
        }
        (self.exit[row], self.count[row], self.probability[row]) = (exit as u32, n, probability);
        row + 1
    }

    #[inline(always)]
    fn round(&mut self, draws: &mut Draws, shares: &Shares, arrive: &mut impl FnMut(usize, u64)) {
        let rows = self.rows;
        fill(draws, &self.count[..rows], &self.probability[..rows], &mut self.taken[..rows]);
        self.rows = 0;
        for row in 0..rows {
            let (exit, taken) = (self.exit[row] as usize, self.taken[row]);
            arrive(exit, taken);
            let left = self.count[row] - taken;
            if left > 0 {
                self.rows = self.face(self.rows, shares.open_after(exit), left, shares, arrive);
            }
        }
    }
}
