//! Step: every moving particle of a chunk attempts one move, including those inserted in this increment.
//!
//! A kernel is a pure function of the network, the exits open at the start of the increment, the chunk and
//! its stream; it writes to its own chunk and events only.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod general;
mod lattice;

use super::chunks::{ChunkColumns, Events};
use super::exits::{Classed, Form, Jamming, OpenExits, Plain, Reads, Widths};
use super::insert::Insertion;
use super::openings::Ways;
use super::{CHUNK, ExitTable, Isa, State, Supply, chunks};
use crate::network::Network;
use crate::stream::{Key, Lanes, Purpose};
use general::Jams;
use lattice::LatticeChunk;

/// Inserts the particles of this increment and moves those of all chunks, in parallel if that pays;
/// results are in `events`.
pub(super) fn step(
    network: &Network,
    table: &ExitTable,
    supply: &Supply,
    state: &mut State,
    events: &mut Vec<Events>,
) {
    events.resize_with(state.particles.live.len(), Events::default);
    let key = state.key(Purpose::Step);
    let insertion = Insertion::new(network, supply, table.isa, state);
    let moving: u64 = state.particles.live.iter().map(|&live| u64::from(live)).sum();
    let effort = moving
        + INSERTED * (insertion.inserted.end - insertion.inserted.start)
        + EMPTY_CHUNK * events.len() as u64;
    let (size, receiving) = (supply.single_size(), insertion.inserted.start as usize / CHUNK);
    let exits = OpenExits {
        network,
        table,
        ways: match &state.openings {
            None => Ways::Unblocked(&state.blocked),
            // Only lattice tables use these weights, and there is none if water sets the weights.
            Some(openings) => Ways::Openings(&openings.widths, None),
        },
        widths: state.openings.as_ref().map_or(network.diameters(), |openings| &openings.widths),
        passive_limit: state.passive_limit,
        arching: supply.arching(),
    };
    let classes = &state.classes;
    chunks::for_each(&mut state.particles, size, events, receiving, effort, |mut columns| {
        insertion.append(&mut columns);
        let ChunkColumns { chunk, void, diameter, live, events } = columns;
        let moving = *live as usize;
        if moving == 0 {
            return;
        }
        let key = Key { chunk, ..key };
        events.lend_buffer(moving + 16);
        let kept = step_chunk(&exits, key, &mut void[..moving], &mut diameter[..moving], events);
        let stayed = events.stopped.len() + events.stranded.len() + events.jams.len();
        events.tally.particle_moves = (moving - stayed) as u64 - events.waiting;
        events.sum(classes, exits.passive_limit);
        *live = kept as u32;
    });
}

/// Cost of a nearly empty chunk, in attempted moves.
const EMPTY_CHUNK: u64 = 16;

/// Cost of inserting a particle and moving it once, in attempted moves.
const INSERTED: u64 = 8;

/// Moves the particles of one chunk; those that still move are compacted at the front, in order, and counted.
fn step_chunk(
    exits: &OpenExits,
    key: Key,
    void: &mut [u32],
    diameter: &mut [f32],
    events: &mut Events,
) -> usize {
    match &exits.table.form {
        Form::Lattice(table) => {
            lattice::fetch_range(void, diameter, 0..lattice::AHEAD);
            let isa = exits.table.isa;
            let reads = (table.by_widths, lattice::reads_classes(diameter, exits.passive_limit));
            let jams = exits.arching.map(|arching| (arching, jam_lanes(key)));
            let jams_any = jams.is_some();
            let chunk = LatticeChunk { exits, table, lanes: key.lanes(), jams, void, diameter, events };
            match reads {
                (true, _) if jams_any => step_lattice::<Jamming>(chunk, isa),
                (true, _) => step_lattice::<Widths>(chunk, isa),
                (false, true) => step_lattice::<Classed>(chunk, isa),
                (false, false) => step_lattice::<Plain>(chunk, isa),
            }
        }
        Form::General(table) => {
            // Two loops, one of them without arching.
            let (network, jams) = (exits.network, exits.arching.map(|law| Jams::new(law, jam_lanes(key))));
            match jams {
                None => general::step(network, table, None, key, void, diameter, events),
                jams => general::step(network, table, jams, key, void, diameter, events),
            }
        }
    }
}

fn jam_lanes(key: Key) -> Lanes {
    Key { purpose: Purpose::Arching, ..key }.lanes()
}

/// Performs the step on a lattice, for the data that it reads of each void.
fn step_lattice<R: Reads>(chunk: LatticeChunk, isa: Isa) -> usize {
    match isa {
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512 if lattice::fits_gathers(chunk.table) => avx512::step::<R>(chunk),
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2 if lattice::fits_gathers(chunk.table) => avx2::step::<R>(chunk),
        _ => lattice::step::<R>(chunk),
    }
}

#[cfg(test)]
mod tests {
    use ::rand::Rng as _;
    use bitvec::vec::BitVec;
    use proptest::prelude::*;

    use super::*;
    use crate::stream::{DRAWS_PER_BLOCK, LANES, draw16};
    use crate::walk::chunks::Jam;
    use crate::walk::{Arching, Isa, LAWS, exits};

    type Scene = (Network, BitVec);

    fn scene(shape: [u32; 3], diameters: Vec<f32>, blocked: Vec<bool>) -> Scene {
        let network = Network::cubic_from_diameters(shape, diameters, 1.0).unwrap();
        (network, blocked.into_iter().collect())
    }

    #[derive(Debug, Default, PartialEq)]
    struct After {
        void: Vec<u32>,
        diameter: Vec<f32>,
        eroded: Vec<f32>,
        stopped: Vec<(u32, f32)>,
        stranded: Vec<(u32, f32)>,
        jams: Vec<Jam>,
    }

    #[derive(Clone, Copy, Debug, PartialEq)]
    enum Reading {
        Plain,
        Classed,
        Widths,
        Jamming(usize),
    }

    type Kernel = (Isa, Reading);

    fn after(scene: &Scene, key: Key, (isa, reading): Kernel, void: &[u32], diameter: &[f32]) -> After {
        let (network, blocked) = scene;
        let ways = Ways::Unblocked(blocked);
        let mut table = match reading {
            Reading::Plain | Reading::Classed => ExitTable::new(network, blocked),
            Reading::Widths | Reading::Jamming(_) => ExitTable::by_widths(network, ways),
        };
        table.isa = isa;
        let arching = arching(reading);
        let finest = network.finest_open(|c| blocked[c]);
        let exits = OpenExits {
            network,
            table: &table,
            ways,
            widths: network.diameters(),
            passive_limit: if arching.is_some() { 0.0 } else { finest },
            arching: arching.as_ref(),
        };
        let (mut void, mut diameter) = (void.to_vec(), diameter.to_vec());
        let mut events = Events::default();
        let Form::Lattice(form) = &table.form else { panic!("a lattice") };
        let chunk = LatticeChunk {
            exits: &exits,
            table: form,
            lanes: key.lanes(),
            jams: arching.as_ref().map(|arching| (arching, jam_lanes(key))),
            void: &mut void,
            diameter: &mut diameter,
            events: &mut events,
        };
        let kept = match reading {
            Reading::Plain => step_lattice::<Plain>(chunk, isa),
            Reading::Classed => step_lattice::<Classed>(chunk, isa),
            Reading::Widths => step_lattice::<Widths>(chunk, isa),
            Reading::Jamming(_) => step_lattice::<Jamming>(chunk, isa),
        };
        void.truncate(kept);
        diameter.truncate(kept);
        let Events { eroded, stopped, stranded, jams, .. } = events;
        After { void, diameter, eroded, stopped, stranded, jams }
    }

    fn arching(reading: Reading) -> Option<Arching> {
        let Reading::Jamming(law) = reading else { return None };
        Some(Arching::new(&LAWS[law], 0.25))
    }

    fn key(seed: u64) -> Key {
        Key { seed, purpose: Purpose::Step, run: 1, increment: 1, chunk: 0 }
    }

    fn available() -> impl Iterator<Item = Isa> {
        Isa::ALL.into_iter().filter(|isa| isa.is_available())
    }

    fn kernels() -> impl Iterator<Item = Kernel> {
        let readings = [Reading::Plain, Reading::Classed, Reading::Widths];
        available().flat_map(move |isa| readings.map(|reading| (isa, reading)))
    }

    const PORTABLE: Kernel = (Isa::Portable, Reading::Plain);

    /// Picks `count` values from `palette`.
    fn picked<T: Copy>(count: usize, palette: &[T], seed: u64) -> Vec<T> {
        let mut draws = key(seed).generator();
        (0..count).map(|_| palette[(draws.next_u64() >> 33) as usize % palette.len()]).collect()
    }

    proptest! {
        // Under Miri the test is a thousand times slower.
        #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 6 } else { 400 }))]

        /// Any number of particles, passive, coarse or exactly as wide as a constriction; closed
        /// constrictions, voids without open exits, everything closed.
        #[test]
        fn every_kernel_leaves_the_same_behind(
            shape in [1u32..7, 1u32..7, 1u32..5],
            constrictions in prop::sample::select(vec![
                vec![1.0f32, 1.5, 2.0], vec![0.0, 1.0, 2.0], vec![1e-6, 1.0, 1e6], vec![1.0], vec![0.0],
                vec![1.0, 1.05, 1.1, 1.2, 1.5, 2.1, 3.0],
            ]),
            sizes in prop::sample::select(vec![
                vec![0.5f32], vec![0.5, 1.0, 1.5, 2.0, 3.0],
                vec![0.5, 0.5, 0.5, 0.5, 1.25], vec![9.0], vec![1e-7, 1e7],
                vec![1.0, 1.03, 1.06, 1.1, 1.19, 1.21, 2.0],
            ]),
            blocked in prop::sample::select(vec![
                vec![false], vec![false, false, false, true], vec![false, true, true], vec![true],
            ]),
            count in 0usize..1200,
            seed: u64,
        ) {
            let voids: Vec<u32> = (0..shape.iter().product()).collect();
            let diameters = picked(3 * voids.len(), &constrictions, seed);
            let scene = scene(shape, diameters, picked(3 * voids.len(), &blocked, !seed));
            let (void, diameter) = (picked(count, &voids, seed ^ 1), picked(count, &sizes, seed ^ 2));
            let expected = after(&scene, key(seed), PORTABLE, &void, &diameter);
            prop_assert_eq!(&by_definition(&scene, key(seed), Reading::Plain, &void, &diameter), &expected);
            let gone = expected.eroded.len() + expected.stopped.len() + expected.stranded.len();
            prop_assert_eq!(expected.void.len() + gone, count);
            for kernel in kernels() {
                let result = after(&scene, key(seed), kernel, &void, &diameter);
                prop_assert_eq!(&result, &expected, "{:?}", kernel);
            }
            for law in 0..LAWS.len() {
                let reading = Reading::Jamming(law);
                let expected = by_definition(&scene, key(seed), reading, &void, &diameter);
                for isa in available() {
                    let result = after(&scene, key(seed), (isa, reading), &void, &diameter);
                    prop_assert_eq!(&result, &expected, "{:?} {}", isa, law);
                }
            }
        }
    }

    /// Performs the step by definition: all 64 bits of every draw, every diameter compared.
    fn by_definition(scene: &Scene, key: Key, reading: Reading, void: &[u32], diameter: &[f32]) -> After {
        let (network, blocked) = scene;
        let (mut lanes, mut block) = (key.lanes(), [0; LANES]);
        let mut after = After::default();
        let (arching, mut jam_lanes, mut jam_block) = (arching(reading), jam_lanes(key), [0; LANES]);
        for (j, (&from, &d)) in void.iter().zip(diameter).enumerate() {
            if j % DRAWS_PER_BLOCK == 0 {
                (block, jam_block) = (lanes.next_block(), jam_lanes.next_block());
            }
            let jam_draw = jam_lanes.extension().complete(draw16(&jam_block, j % DRAWS_PER_BLOCK), j as u64);
            let draw = lanes.extension().complete(draw16(&block, j % DRAWS_PER_BLOCK), j as u64);
            let mut thresholds = Vec::new();
            let last_open = exits::thresholds(network, Ways::Unblocked(blocked), from, &mut thresholds);
            let Some(last_open) = last_open else {
                after.stranded.push((from, d));
                continue;
            };
            let exit = thresholds.iter().position(|&t| draw < t).unwrap_or(last_open);
            let constriction = network.exits(from).start + exit;
            let width = network.diameters()[constriction];
            let jams = arching.as_ref().filter(|_| d <= width);
            if let Some(particles) = jams.and_then(|law| law.jams(width, d, jam_draw)) {
                let (rank, exit) = (after.void.len() as u32, constriction as u32);
                after.jams.push(Jam { rank, exit, diameter: d, particles });
                continue;
            }
            match network.targets()[constriction] {
                _ if d > width => after.stopped.push((constriction as u32, d)),
                crate::network::END => after.eroded.push(d),
                to => {
                    after.void.push(to);
                    after.diameter.push(d);
                }
            }
        }
        after
    }

    /// Thresholds whose top sixteen bits equal the draw of a particle, just above and just below it.
    #[test]
    #[cfg_attr(miri, ignore = "hours of it")]
    fn a_draw_that_equals_a_threshold_is_decided_by_all_of_its_bits() {
        let mut lanes = key(3).lanes();
        let extension = lanes.extension();
        let block = lanes.next_block();
        let mut seen = [0; 2];
        for place in 0..DRAWS_PER_BLOCK {
            let draw = draw16(&block, place);
            let share = (f64::from(draw) + 0.5) / 65536.0;
            // The first of two open exits has this fraction of the area.
            let ratio = (share / (1.0 - share)).sqrt() as f32;
            for steps in -400i32..400 {
                let first = f32::from_bits((ratio.to_bits() as i32 + 16 * steps) as u32);
                let scene = scene([1, 1, 1], vec![first, 0.0, 1.0], vec![false; 3]);
                let a = f64::from(first) * f64::from(first);
                let threshold = (a / (a + 1.0) * 2f64.powi(64)) as u64;
                if (threshold >> 48) as u16 != draw {
                    continue;
                }
                let stays = extension.complete(draw, place as u64) < threshold;
                seen[usize::from(stays)] += 1;
                let (void, diameter) = (vec![0; DRAWS_PER_BLOCK], vec![1e-6; DRAWS_PER_BLOCK]);
                let expected = after(&scene, key(3), PORTABLE, &void, &diameter);
                for kernel in kernels() {
                    assert_eq!(after(&scene, key(3), kernel, &void, &diameter), expected, "{kernel:?}");
                }
                // Only the particle at `place` can move: those before it are too coarse.
                let mut diameter = vec![9e9; DRAWS_PER_BLOCK];
                diameter[place] = 1e-6;
                for kernel in kernels() {
                    let after = after(&scene, key(3), kernel, &void, &diameter);
                    assert_eq!(after.void.len() == 1, stays, "{kernel:?}, draw {draw}");
                }
            }
        }
        assert!(seen[0].min(seen[1]) > 100, "{seen:?} ties");
    }

    /// The words of a chunk are chosen by its first particles, even if there are few.
    #[test]
    fn words_with_classes_are_for_chunks_with_coarse_particles() {
        let chunk = |fine: usize, coarse: usize| [vec![1.0; fine], vec![1.5; coarse]].concat();
        let reads_classes = |diameter: &[f32]| lattice::reads_classes(diameter, 1.0);
        let coarse = [(0, 0), (300, 0), (10, 1), (256, 900), (0, 2), (254, 2)];
        let expected = [false, false, false, false, true, true];
        assert_eq!(coarse.map(|(fine, coarse)| reads_classes(&chunk(fine, coarse))), expected);
    }

    /// A column from a damaged file gives an error, never a read beyond the table.
    #[test]
    fn a_void_that_does_not_exist_is_refused() {
        let scene = scene([2, 2, 1], vec![1.0; 12], vec![false; 12]);
        for kernel in kernels() {
            for bad in [4, 1 << 31, u32::MAX] {
                for place in [0, 17, 63, 64] {
                    let mut void = vec![0; 65];
                    void[place] = bad;
                    let step = || after(&scene, key(1), kernel, &void, &[0.5; 65]);
                    assert!(std::panic::catch_unwind(step).is_err(), "{kernel:?}: {bad} at {place}");
                }
            }
        }
    }
}
