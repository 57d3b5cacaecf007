//! Insertion of the base particles of an increment into chunks, with draws of their start nodes and sizes.

use super::chunks::ChunkColumns;
use super::tally::cube;
use super::{CHUNK, Isa, State, Supply};
use crate::network::Network;
use crate::stream::{Key, LANES, Lanes, Purpose, below, below_32};
use std::ops::Range;

pub(super) struct Insertion<'a> {
    network: &'a Network,
    supply: &'a Supply,
    isa: Isa,
    passive_limit: f32,
    key: Key,
    /// Number of base particles inserted before and after this increment.
    pub(super) inserted: Range<u64>,
}

impl<'a> Insertion<'a> {
    pub(crate) fn new(network: &'a Network, supply: &'a Supply, isa: Isa, state: &State) -> Self {
        let inserted = supply.inserted(state.increment - 1)..supply.inserted(state.increment);
        let (passive_limit, key) = (state.passive_limit, state.key(Purpose::Insertion));
        Self { network, supply, isa, passive_limit, key, inserted }
    }

    /// Appends the particles of a chunk to its columns; records their number and mass in its events.
    pub(crate) fn append(&self, columns: &mut ChunkColumns) {
        let ChunkColumns { chunk, void, diameter, live, events } = columns;
        let begin = *chunk * CHUNK as u64;
        let (first, end) = (self.inserted.start.max(begin), self.inserted.end.min(begin + CHUNK as u64));
        if first >= end {
            return;
        }
        let (old, new) = (**live as usize, **live as usize + (end - first) as usize);
        **live = new as u32;
        let (void, diameter) = (&mut void[old..new], &mut diameter[old..new]);
        let before = begin.saturating_sub(self.inserted.start);
        let key = Key { chunk: *chunk, ..self.key };
        let drawing = Drawing { insertion: self, key, before, void, diameter };
        let (mass, passive) = drawing.draw(self.isa);
        let tally = &mut events.tally;
        (tally.inserted, tally.inserted_mass, tally.passive_inserted) = (end - first, mass, passive.into());
    }
}

const BATCH: usize = 8 * LANES;

type Words = [[u64; LANES]; 2 * BATCH / LANES];

/// Particles of one chunk to draw, and their columns.
///
/// Each step of a draw is a loop over a whole batch, so that it is vectorised. Only masses are added one
/// after another, as the result depends on their order.
struct Drawing<'a> {
    insertion: &'a Insertion<'a>,
    key: Key,
    /// Number of particles that the increment inserts before these.
    before: u64,
    void: &'a mut [u32],
    diameter: &'a mut [f32],
}

impl Drawing<'_> {
    /// Draws them with the instructions of `isa`; the bits are the same for all. Returns the sum of diameters
    /// cubed, in particle order, and the number of passive particles.
    fn draw(self, isa: Isa) -> (f64, u32) {
        assert!(isa.is_available());
        match isa {
            // SAFETY: the machine supports the instructions.
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512 => unsafe { with_avx512(self) },
            // SAFETY: the machine supports the instructions.
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2 => unsafe { with_avx2(self) },
            _ => self.draw_by(|lanes, words| {
                // Two blocks at a time: all at once take 1.5 times as long.
                words.as_chunks_mut::<2>().0.iter_mut().for_each(|two| *two = lanes.next_blocks());
            }),
        }
    }

    /// Draws them; `next` reads the next words of the stream.
    #[inline(always)]
    fn draw_by(self, next: impl Fn(&mut Lanes, &mut Words)) -> (f64, u32) {
        let Self { insertion, key, before, void, diameter } = self;
        let Insertion { network, supply, passive_limit, .. } = *insertion;
        let (mut lanes, strata) = (key.lanes(), supply.strata(key.increment));
        let (mut mass, mut passive) = (0.0, 0);
        let (mut words, mut place) = (Words::default(), before);
        for (void, diameter) in void.chunks_mut(BATCH).zip(diameter.chunks_mut(BATCH)) {
            // The last batch leaves some words unused.
            next(&mut lanes, &mut words);
            let pairs = words.as_flattened().as_chunks::<2>().0;
            let mut size_words = [0; BATCH];
            for (size_word, pair) in size_words.iter_mut().zip(pairs) {
                *size_word = pair[1];
            }
            match &strata {
                None => start(network, pairs, void),
                Some(strata) => {
                    let nodes = network.start();
                    let particles = void.iter_mut().zip(&mut size_words).zip(pairs);
                    for (place, ((void, size_word), pair)) in (place..).zip(particles) {
                        *void = nodes[strata.node(place, pair[0], nodes.len() as u64)];
                        *size_word = strata.size_word(place, pair[1]);
                    }
                    place += void.len() as u64;
                }
            }
            let (mut sizes, mut cubes) = ([0.0; BATCH], [0.0; BATCH]);
            supply.fill(&mut size_words, &mut sizes);
            diameter.copy_from_slice(&sizes[..diameter.len()]);
            for (cube_of, &size) in cubes.iter_mut().zip(&sizes) {
                *cube_of = cube(size);
            }
            mass = cubes[..diameter.len()].iter().fold(mass, |mass, cube| mass + cube);
            passive += diameter.iter().map(|&d| u32::from(d <= passive_limit)).sum::<u32>();
        }
        (mass, passive)
    }
}

/// Draws the start node of each particle from the first of its words.
#[inline(always)]
fn start(network: &Network, pairs: &[[u64; 2]], void: &mut [u32]) {
    let (nodes, draws) = (network.start(), void.iter_mut().zip(pairs));
    match network.shape() {
        // The start nodes of a lattice are its first voids, in order.
        Some(_) => draws.for_each(|(void, pair)| *void = below_32(pair[0], nodes.len() as u32)),
        None => draws.for_each(|(void, pair)| *void = nodes[below(pair[0], nodes.len() as u64) as usize]),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt")]
fn with_avx512(drawing: Drawing) -> (f64, u32) {
    drawing.draw_by(|lanes, words| words.iter_mut().for_each(|block| *block = lanes.next_block()))
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,popcnt")]
fn with_avx2(drawing: Drawing) -> (f64, u32) {
    drawing.draw_by(|lanes, words| lanes.next_blocks_avx2(words))
}
