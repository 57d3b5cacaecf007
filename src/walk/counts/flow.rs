//! One increment of passive particles kept as counts per void.
//!
//! The voids are cut into blocks of fixed size, each with its own stream. Workers take blocks as they come and
//! add what moves to a column of their own; the columns are then added. Integer sums do not depend on
//! their order, so neither do the bits on the number of workers.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::binomial::{CERTAIN, Draws, Scratch, fill, one};
use super::shares::Shares;
use super::sizes::fraction;
use crate::network::{END, Network};
use crate::stream::{Key, below};

/// Voids that share a stream. Part of the definition of every stream: changing it changes results.
const BLOCK: usize = 1 << 10;

/// Chunk number of the stream that inserts.
const INSERTION: u64 = u64::MAX;

/// With fewer occupied blocks, waking other threads costs more than they bring.
const ALONE: usize = 4;

/// What one increment did to the passive particles.
#[derive(Debug, Default)]
pub(super) struct Moved {
    /// Particles that attempted a move and made it.
    pub moves: u64,
    /// Particles that left the filter.
    pub eroded: u64,
    /// Void and number of particles without an open exit.
    pub stranded: Vec<(u32, u64)>,
}

/// The machinery that moves counts; rebuilt from network and counts, and never stored.
pub(super) struct Flow {
    /// By block: the blocks that exits of its voids lead to.
    downstream: Vec<Vec<u32>>,
    /// By block: whether it holds a particle.
    occupied: Vec<bool>,
    workers: Vec<Worker>,
    /// Particles that move, counted afresh in every step.
    moving: u64,
}

struct Worker {
    /// By void: particles that this worker moved there.
    next: Vec<u64>,
    /// By block: whether `next` may hold something.
    touched: Vec<bool>,
    moved: Moved,
    parting: Parting,
}

/// Counts that part over the exits of their voids, as columns: a row is a void whose particles are yet to choose
/// between an exit and those after it.
#[derive(Default)]
struct Parting {
    /// The exit, as a constriction.
    exit: Vec<u32>,
    count: Vec<u64>,
    chance: Vec<u64>,
    taken: Vec<u64>,
    scratch: Scratch,
}

impl Flow {
    pub fn new(network: &Network, moving: &[u64]) -> Self {
        let blocks = moving.len().div_ceil(BLOCK);
        let worker = || Worker {
            next: vec![0; moving.len()],
            touched: vec![false; blocks],
            moved: Moved::default(),
            parting: Parting::default(),
        };
        Self {
            downstream: (0..blocks).map(|block| downstream(network, block)).collect(),
            occupied: moving.chunks(BLOCK).map(|counts| counts.iter().any(|&n| n > 0)).collect(),
            workers: (0..rayon::current_num_threads()).map(|_| worker()).collect(),
            moving: moving.iter().sum(),
        }
    }

    /// Particles that moved on in the last step.
    pub fn moving(&self) -> u64 {
        self.moving
    }

    /// Puts `count` particles on start nodes, each drawn uniformly.
    pub fn insert(&mut self, network: &Network, count: u64, key: Key, moving: &mut [u64]) {
        let nodes = network.start();
        let mut draws = Draws::new(Key { chunk: INSERTION, ..key });
        let mut left = count;
        let mut put = |node: usize, n: u64| {
            moving[nodes[node] as usize] += n;
            self.occupied[nodes[node] as usize / BLOCK] = true;
        };
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

    /// Every particle attempts one move.
    pub fn step(&mut self, network: &Network, shares: &Shares, key: Key, moving: &mut [u64]) -> Moved {
        let occupied: Vec<usize> = (0..self.occupied.len()).filter(|&b| self.occupied[b]).collect();
        let next_block = AtomicUsize::new(0);
        let (counts, downstream) = (&*moving, &self.downstream);
        let work = |worker: &mut Worker| {
            while let Some(&block) = occupied.get(next_block.fetch_add(1, Ordering::Relaxed)) {
                let end = counts.len().min((block + 1) * BLOCK);
                worker.step(network, shares, Key { chunk: block as u64, ..key }, counts, block * BLOCK..end);
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

    /// Adds the workers' columns and counts.
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
            if part.moves == 0 && part.stranded.is_empty() {
                continue;
            }
            moved.moves += part.moves;
            moved.eroded += part.eroded;
            moved.stranded.append(&mut part.stranded);
            let touched = worker.touched.par_iter_mut().zip(worker.next.par_chunks_mut(BLOCK));
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
        // Which worker found what depends on the threads; the order of the voids does not.
        moved.stranded.sort_unstable();
        moved
    }
}

fn downstream(network: &Network, block: usize) -> Vec<u32> {
    let end = network.voids().min((block + 1) * BLOCK) as u32;
    let exits = network.exits((block * BLOCK) as u32).start..network.exits(end - 1).end;
    let inner = network.targets()[exits].iter().filter(|&&target| target != END);
    let mut blocks: Vec<u32> = inner.map(|&target| target / BLOCK as u32).collect();
    blocks.sort_unstable();
    blocks.dedup();
    blocks
}

impl Worker {
    /// Moves the particles of the voids in `range`.
    fn step(
        &mut self,
        network: &Network,
        shares: &Shares,
        key: Key,
        counts: &[u64],
        range: std::ops::Range<usize>,
    ) {
        let Self { next, moved, parting, .. } = self;
        let mut arrive = |constriction: usize, n: u64| match network.targets()[constriction] {
            END => moved.eroded += n,
            target => next[target as usize] += n,
        };
        parting.clear();
        for void in range {
            let n = counts[void];
            if n == 0 {
                continue;
            }
            if !shares.leads_on(void) {
                moved.stranded.push((void as u32, n));
                continue;
            }
            moved.moves += n;
            parting.face(network.exits(void as u32).start, n, shares, &mut arrive);
        }
        if !parting.exit.is_empty() {
            let mut draws = Draws::new(key);
            while !parting.exit.is_empty() {
                parting.round(&mut draws, shares, &mut arrive);
            }
        }
    }
}

impl Parting {
    fn clear(&mut self) {
        self.exit.clear();
        self.count.clear();
        self.chance.clear();
    }

    /// `n` particles face the exits of a void from `exit` on: they are through where the next open one is the last.
    #[inline(always)]
    fn face(&mut self, mut exit: usize, n: u64, shares: &Shares, arrive: &mut impl FnMut(usize, u64)) {
        while shares.chance()[exit] == 0 {
            exit += 1;
        }
        let chance = shares.chance()[exit];
        if chance == CERTAIN {
            arrive(exit, n);
        } else {
            self.exit.push(exit as u32);
            self.count.push(n);
            self.chance.push(chance);
        }
    }

    /// Draws how many take the exit they face; the others face the next.
    fn round(&mut self, draws: &mut Draws, shares: &Shares, arrive: &mut impl FnMut(usize, u64)) {
        let rows = self.exit.len();
        self.taken.resize(rows, 0);
        fill(draws, &self.count, &self.chance, &mut self.taken, &mut self.scratch);
        let mut kept = 0;
        for row in 0..rows {
            let (mut exit, taken) = (self.exit[row] as usize, self.taken[row]);
            if taken > 0 {
                arrive(exit, taken);
            }
            let left = self.count[row] - taken;
            if left == 0 {
                continue;
            }
            exit += 1;
            while shares.chance()[exit] == 0 {
                exit += 1;
            }
            let chance = shares.chance()[exit];
            if chance == CERTAIN {
                arrive(exit, left);
            } else {
                (self.exit[kept], self.count[kept], self.chance[kept]) = (exit as u32, left, chance);
                kept += 1;
            }
        }
        self.exit.truncate(kept);
        self.count.truncate(kept);
        self.chance.truncate(kept);
    }
}
