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
    inserted: Range<u64>,
}

impl<'a> Insertion<'a> {
    /// Prepares the insertion for the current increment of `state`.
    pub(crate) fn new(network: &'a Network, supply: &'a Supply, isa: Isa, state: &State) -> Self {
        let increment = state.increment;
        Self {
            network,
            supply,
            isa,
            passive_limit: state.passive_limit,
            key: state.key(Purpose::Insertion),
            inserted: supply.inserted(increment - 1)..supply.inserted(increment),
        }
    }

    /// Number of base particles inserted in this increment.
    pub(crate) fn share(&self) -> u64 {
        self.inserted.end - self.inserted.start
    }

    /// First chunk that receives particles, if there are any.
    pub(crate) fn first_chunk(&self) -> usize {
        self.inserted.start as usize / CHUNK
    }

    /// Appends the particles of a chunk to its columns; records their number and mass in its events.
    pub(crate) fn append(&self, columns: &mut ChunkColumns) {
        let ChunkColumns { chunk, void, diameter, live, events } = columns;
        let begin = *chunk * CHUNK as u64;
        let (first, end) = (self.inserted.start.max(begin), self.inserted.end.min(begin + CHUNK as u64));
        if first >= end {
            return;
        }
        events.inserted = (end - first) as u32;
        let (old, new) = (**live as usize, (**live + events.inserted) as usize);
        **live = new as u32;
        let drawing = Drawing {
            network: self.network,
            supply: self.supply,
            key: Key { chunk: *chunk, ..self.key },
            before: begin.saturating_sub(self.inserted.start),
            passive_limit: self.passive_limit,
            void: &mut void[old..new],
            diameter: &mut diameter[old..new],
        };
        let Drawn { mass, passive } = drawing.draw(self.isa);
        (events.inserted_mass, events.passive_inserted) = (mass, passive);
    }
}

/// Number of particles drawn at a time.
const BATCH: usize = 8 * LANES;

type Words = [[u64; LANES]; 2 * BATCH / LANES];

/// Particles of one chunk to draw, and their columns.
///
/// Each step of a draw is a loop over a whole batch, so that it is vectorised. Only masses are added one
/// after another, as the result depends on their order.
struct Drawing<'a> {
    pub(crate) network: &'a Network,
    pub(crate) supply: &'a Supply,
    pub(crate) key: Key,
    /// Number of particles that the increment inserts before these.
    pub(crate) before: u64,
    pub(crate) passive_limit: f32,
    pub(crate) void: &'a mut [u32],
    pub(crate) diameter: &'a mut [f32],
}

struct Drawn {
    /// Sum of diameters cubed, in particle order.
    pub(crate) mass: f64,
    pub(crate) passive: u32,
}

impl Drawing<'_> {
    /// Draws them with the instructions of `isa`; the bits are the same for all.
    pub(crate) fn draw(self, isa: Isa) -> Drawn {
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
    fn draw_by(self, next: impl Fn(&mut Lanes, &mut Words)) -> Drawn {
        let Self { network, supply, key, before, passive_limit, void, diameter } = self;
        let (mut lanes, strata) = (key.lanes(), supply.strata(key.increment));
        let mut drawn = Drawn { mass: 0.0, passive: 0 };
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
            drawn.mass = cubes[..diameter.len()].iter().fold(drawn.mass, |mass, cube| mass + cube);
            drawn.passive += diameter.iter().map(|&d| u32::from(d <= passive_limit)).sum::<u32>();
        }
        drawn
    }
}

/// Draws the start node of each particle from the first of its words.
#[inline(always)]
fn start(network: &Network, pairs: &[[u64; 2]], void: &mut [u32]) {
    let nodes = network.start();
    if network.shape().is_none() {
        for (void, pair) in void.iter_mut().zip(pairs) {
            *void = nodes[below(pair[0], nodes.len() as u64) as usize];
        }
        return;
    }
    // The start nodes of a lattice are its first voids, in order.
    for (void, pair) in void.iter_mut().zip(pairs) {
        *void = below_32(pair[0], nodes.len() as u32);
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt")]
fn with_avx512(drawing: Drawing) -> Drawn {
    drawing.draw_by(|lanes, words| words.iter_mut().for_each(|block| *block = lanes.next_block()))
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,popcnt")]
fn with_avx2(drawing: Drawing) -> Drawn {
    drawing.draw_by(|lanes, words| lanes.next_blocks_avx2(words))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::{Gradation, SizeSampler};
    use crate::network::{ExitRule, NetworkColumns};
    use crate::stream::Purpose;

    /// A lattice with 15 start nodes, and a network with three that are not consecutive.
    fn networks() -> [Network; 2] {
        let columns = NetworkColumns {
            voids: 6,
            conns: &[[0, 1], [3, 2], [5, 4]],
            diameter_mm: &[1.0; 3],
            conductance: None,
            inlets: &[3, 0, 5],
            outlets: &[1, 2, 4],
            rule: ExitRule::Area,
            rho: 0.0,
            unit_mm: 1.0,
        };
        let lattice = Network::cubic_from_diameters([3, 5, 2], vec![1.0; 90], 1.0).unwrap();
        [lattice, Network::from_columns(&columns).unwrap().0]
    }

    fn supplies() -> Vec<Supply> {
        let sampler = |gradation: Gradation| SizeSampler::new(&gradation, 1.0).unwrap();
        let points: Vec<_> =
            (0..40).map(|i| (0.1 + 0.01 * f64::from(i * i), 2.5 * f64::from(i + 1))).collect();
        let whole = sampler(Gradation::linear_from_d0(0.1, 4.5).unwrap());
        let sieved = sampler(Gradation::from_points(&points, Some(0.05)).unwrap());
        vec![
            Supply::new(whole.clone(), 400, 2),
            Supply::new(whole.clone(), 400, 2).stratified(3, 1),
            Supply::coarse_part(whole, 1 << 63, &[200, 200]),
            Supply::coarse_part(sieved, 3 << 61, &[200, 200]),
        ]
    }

    /// Draws each particle by definition, from its two words of the stream.
    fn by_definition(
        network: &Network,
        supply: &Supply,
        key: Key,
        before: u64,
        count: usize,
    ) -> Vec<(u32, f32)> {
        let (mut lanes, strata, nodes) = (key.lanes(), supply.strata(key.increment), network.start());
        let words: Vec<u64> = (0..count.div_ceil(4)).flat_map(|_| lanes.next_block()).collect();
        let particle = |(place, pair): (u64, &[u64; 2])| {
            let [first, second] = *pair;
            let (node, size_word) = match &strata {
                None => (below(first, nodes.len() as u64) as usize, second),
                Some(strata) => {
                    (strata.node(place, first, nodes.len() as u64), strata.size_word(place, second))
                }
            };
            (nodes[node], supply.diameter(size_word))
        };
        (before..).zip(words.as_chunks::<2>().0).map(particle).take(count).collect()
    }

    #[test]
    fn every_instruction_set_draws_each_particle_as_it_is_defined() {
        let key = Key { seed: 3, purpose: Purpose::Insertion, run: 1, increment: 2, chunk: 7 };
        for (network, supply) in networks().iter().flat_map(|n| supplies().into_iter().map(move |s| (n, s))) {
            for count in [0, 1, 7, 63, 64, 65, 190] {
                let expected = by_definition(network, &supply, key, 9, count);
                let passive_limit = 0.2;
                for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
                    let (mut void, mut diameter) = (vec![99; count], vec![0.0; count]);
                    let drawing = Drawing {
                        network,
                        supply: &supply,
                        key,
                        before: 9,
                        passive_limit,
                        void: &mut void,
                        diameter: &mut diameter,
                    };
                    let drawn = drawing.draw(isa);
                    let particles: Vec<_> = void.into_iter().zip(diameter).collect();
                    assert_eq!(particles, expected, "{isa:?} {count}");
                    let mass = expected.iter().fold(0.0, |mass, &(_, d)| mass + cube(d));
                    let passive = expected.iter().filter(|&&(_, d)| d <= passive_limit).count();
                    assert_eq!((drawn.mass, drawn.passive), (mass, passive as u32), "{isa:?} {count}");
                }
            }
        }
    }
}
