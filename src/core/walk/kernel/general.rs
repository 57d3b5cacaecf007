//! Step on any network: exits and targets by look-up.

use super::lattice::fetch;
use crate::network::{END, Network};
use crate::stream::{DRAWS_PER_BLOCK, Key, LANES, Lanes, Words, draw16};
use crate::walk::Arching;
use crate::walk::chunks::{Events, Jam};
use crate::walk::exits::{General, NONE, WAIT};

/// Number of particles by which exits are prefetched ahead.
const AHEAD: usize = 24;

/// Moves the particles of one chunk, which may arch; returns the number still moving.
pub(super) fn step(
    network: &Network,
    table: &General,
    jams: Option<Jams>,
    key: Key,
    void: &mut [u32],
    diameter: &mut [f32],
    events: &mut Events,
) -> usize {
    // Two loops, one of them without arching.
    match jams {
        None => step_all(network, table, key, void, diameter, events, None),
        jams => step_all(network, table, key, void, diameter, events, jams),
    }
}

pub(super) struct Jams<'a> {
    arching: &'a Arching,
    lanes: Lanes,
    extension: Words,
    block: [u64; LANES],
}

impl<'a> Jams<'a> {
    pub(crate) fn new(arching: &'a Arching, lanes: Lanes) -> Self {
        Self { arching, extension: lanes.extension(), lanes, block: [0; LANES] }
    }

    /// Jam of the particle at place `j` in this exit, which it fits, or `None` if it passes; `rank`
    /// particles before it still move.
    #[inline]
    fn jam(&self, j: usize, (exit, width): (u32, f32), d: f32, rank: usize) -> Option<Jam> {
        let draw = draw16(&self.block, j % DRAWS_PER_BLOCK);
        if d * self.arching.reach()[Arching::class_of(draw)] <= width {
            return None;
        }
        let word = self.extension.complete(draw, j as u64);
        let particles = self.arching.jams(width, d, word)?;
        Some(Jam { rank: rank as u32, exit, diameter: d, particles })
    }
}

/// Performs the step; particles that fit may jam by `jams`.
#[inline(always)]
fn step_all(
    network: &Network,
    table: &General,
    key: Key,
    void: &mut [u32],
    diameter: &mut [f32],
    events: &mut Events,
    mut jams: Option<Jams>,
) -> usize {
    let mut lanes = key.lanes();
    let extension = lanes.extension();
    let mut kept = 0;
    let mut chosen = [Chosen::None; DRAWS_PER_BLOCK];
    for begin in (0..void.len()).step_by(DRAWS_PER_BLOCK) {
        let block = lanes.next_block();
        if let Some(jams) = &mut jams {
            jams.block = jams.lanes.next_block();
        }
        let particles = begin..void.len().min(begin + DRAWS_PER_BLOCK);
        // All particles of a block choose before any of them moves, so that distant reads do not wait for
        // moves.
        for (chosen, j) in chosen.iter_mut().zip(particles.clone()) {
            if let Some(&next) = void.get(j + AHEAD) {
                fetch(&table.few, next as usize);
            }
            let from = void[j];
            let draw = draw16(&block, j - begin);
            let few = &table.few[from as usize];
            let quick = match few.is_few {
                true => few.chosen(draw),
                false => few.chosen_of(&table.top, draw),
            };
            *chosen = match quick {
                Some(exit) => {
                    fetch(&table.beyond, exit);
                    Chosen::Exit(exit as u32)
                }
                None => any(network, table, from, draw, j, extension),
            };
        }
        for (chosen, j) in chosen.iter().zip(particles) {
            let (from, d) = (void[j], diameter[j]);
            let exit = match *chosen {
                Chosen::Exit(exit) => exit,
                Chosen::None => {
                    events.stranded.push((from, d));
                    continue;
                }
                Chosen::Wait => {
                    events.waiting += 1;
                    (void[kept], diameter[kept]) = (from, d);
                    kept += 1;
                    continue;
                }
            };
            let (target, width) = table.beyond[exit as usize];
            if d > width {
                events.stopped.push((exit, d));
                continue;
            }
            let jam = jams.as_ref().and_then(|jams| jams.jam(j, (exit, width), d, kept));
            if let Some(jam) = jam {
                events.jams.push(jam);
                continue;
            }
            match target {
                END => events.eroded.push(d),
                target => {
                    void[kept] = target;
                    diameter[kept] = d;
                    kept += 1;
                }
            }
        }
    }
    kept
}

/// Choice of a particle.
#[derive(Clone, Copy)]
enum Chosen {
    /// This exit, if it fits.
    Exit(u32),
    None,
    Wait,
}

/// Exit by definition, for any number of exits, with all bits of the draw if needed.
#[cold]
#[inline(never)]
fn any(
    network: &Network,
    table: &General,
    from: u32,
    draw: u16,
    index: usize,
    extension: Words,
) -> Chosen {
    let last_open = table.last_open[from as usize];
    match last_open {
        NONE => return Chosen::None,
        WAIT => return Chosen::Wait,
        _ => {}
    }
    let exits = network.exits(from);
    let chosen = choose(&table.threshold[exits.clone()], draw, index, extension);
    Chosen::Exit(chosen.map_or(last_open, |e| (exits.start + e) as u32))
}

/// First exit whose threshold exceeds the draw; sixteen bits decide unless they are equal.
#[inline]
fn choose(thresholds: &[u64], draw: u16, index: usize, extension: Words) -> Option<usize> {
    let is_above = |threshold: u64| {
        let top = (threshold >> 48) as u16;
        draw < top || (draw == top && extension.complete(draw, index as u64) < threshold)
    };
    if thresholds.len() <= LOOKED_AT {
        return thresholds.iter().position(|&threshold| is_above(threshold));
    }
    // Thresholds rise. A reservoir has thousands of them: integers are compared without branches, and all
    // bits of the draw are used only in a tie.
    let passed = thresholds.partition_point(|&threshold| threshold < u64::from(draw) << 48);
    let rest = &thresholds[passed..];
    let first = match rest.first() {
        Some(&threshold) if !is_above(threshold) => rest.partition_point(|&threshold| !is_above(threshold)),
        _ => 0,
    };
    (first < rest.len()).then_some(passed + first)
}

/// Maximum number of exits searched linearly.
const LOOKED_AT: usize = 16;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::Purpose;

    /// Thousands of exits, many closed or with equal upper bits, compared with a linear search.
    #[test]
    fn an_exit_of_thousands_is_found_as_by_looking_at_each() {
        let key = Key { seed: 3, purpose: Purpose::Step, run: 1, increment: 1, chunk: 0 };
        let extension = key.lanes().extension();
        let mut word = 9u64;
        let mut next = || {
            word = word.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            word
        };
        let mut ties = 0;
        for exits in [17, 100, 3000] {
            let mut thresholds: Vec<u64> = (0..exits).map(|_| next()).collect();
            for first in (0..exits - 5).step_by(10) {
                // Thresholds as of closed exits, and others that differ in lower bits.
                thresholds[first + 1] = thresholds[first];
                thresholds[first + 2] = thresholds[first] ^ 1 << 47;
                thresholds[first + 3] = thresholds[first] ^ 0xff << 40;
            }
            thresholds.sort_unstable();
            for draw in 0..=u16::MAX {
                let index = usize::from(draw) + exits;
                let whole = extension.complete(draw, index as u64);
                let by_each = thresholds.iter().position(|&threshold| whole < threshold);
                ties += usize::from(thresholds.iter().any(|&threshold| (threshold >> 48) as u16 == draw));
                assert_eq!(choose(&thresholds, draw, index, extension), by_each, "{exits} {draw}");
            }
        }
        assert!(ties > 1000, "{ties}");
    }
}
