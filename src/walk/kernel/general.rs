//! The step on any network: exits and targets by look-up.

use std::collections::HashMap;

use crate::network::{END, Network};
use crate::stream::{DRAWS_PER_BLOCK, Extension, Key, Purpose, Words, draw16};
use crate::walk::Arching;
use crate::walk::crowding::Crowd;
use crate::walk::exits::{General, NONE, WAIT};
use crate::walk::merge::Events;
use crate::walk::sizes::cube;

/// Moves the particles of one chunk, which may arch; returns how many still move.
pub(super) fn step(
    network: &Network,
    table: &General,
    arching: Option<(&Arching, Option<&Crowd>)>,
    key: Key,
    void: &mut [u32],
    diameter: &mut [f32],
    events: &mut Events,
) -> usize {
    match arching {
        None => step_all(network, table, key, void, diameter, events, |_, _, _, _| false),
        Some((arching, crowd)) => {
            let mut arches = Arches::new(arching, crowd, key);
            step_all(network, table, key, void, diameter, events, |at, width, d, events| {
                arches.stop(at, width, d, events)
            })
        }
    }
}

/// The arches of one chunk in one increment.
struct Arches<'a> {
    arching: &'a Arching,
    /// The particles in each void, where the law depends on them.
    crowd: Option<&'a Crowd>,
    words: Words,
    /// Constrictions in which an arch has begun, and how many more particles it takes.
    begun: HashMap<u32, u32>,
}

impl<'a> Arches<'a> {
    fn new(arching: &'a Arching, crowd: Option<&'a Crowd>, key: Key) -> Self {
        let words = Key { purpose: Purpose::Arching, ..key }.words();
        Self { arching, crowd, words, begun: HashMap::new() }
    }

    /// Whether a particle, which fits through this exit, stays in an arch there; it is then counted.
    #[inline]
    fn stop(&mut self, at: At, width: f32, d: f32, events: &mut Events) -> bool {
        self.arching.may(width, d) && self.joins(at, width, d, events)
    }

    fn joins(&mut self, at: At, width: f32, d: f32, events: &mut Events) -> bool {
        match self.begun.get_mut(&at.exit) {
            Some(0) => return false,
            Some(left) => *left -= 1,
            None => match self.arching.begun(width, d, self.words.at(at.place as u64), self.crowd(at)) {
                None => return false,
                Some(particles) => {
                    self.begun.insert(at.exit, particles - 1);
                    events.arched.1 += 1;
                }
            },
        }
        events.arched.0 += 1;
        events.arched.2 += cube(d);
        true
    }

    /// The particles in the void of one: how many, and the sum of their diameters cubed.
    fn crowd(&self, at: At) -> (u32, f64) {
        self.crowd.map_or((0, 0.0), |crowd| crowd.of_void(at.from))
    }
}

/// Where a particle is: its place in the chunk, its void, and the exit that it chose.
#[derive(Clone, Copy)]
struct At {
    place: usize,
    from: u32,
    exit: u32,
}

/// The step, with what may stop a particle that fits: by where it is, the width of its exit, and its size.
#[inline(always)]
fn step_all(
    network: &Network,
    table: &General,
    key: Key,
    void: &mut [u32],
    diameter: &mut [f32],
    events: &mut Events,
    mut is_stopped: impl FnMut(At, f32, f32, &mut Events) -> bool,
) -> usize {
    let mut lanes = key.lanes();
    let extension = lanes.extension();
    let mut kept = 0;
    let mut chosen = [Chosen::None; DRAWS_PER_BLOCK];
    for begin in (0..void.len()).step_by(DRAWS_PER_BLOCK) {
        let block = lanes.next_block();
        let particles = begin..void.len().min(begin + DRAWS_PER_BLOCK);
        // All of a block choose before any moves: what one reads far away does not wait for another's move.
        for (chosen, j) in chosen.iter_mut().zip(particles.clone()) {
            let from = void[j];
            let draw = draw16(&block, j - begin);
            let few = &table.few[from as usize];
            let quick = if few.is_few { few.chosen(draw) } else { None };
            *chosen = match quick {
                Some(exit) => Chosen::Exit(exit as u32),
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
            if d > width || is_stopped(At { place: j, from, exit }, width, d, events) {
                events.stopped.push((exit, d));
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

/// Where a particle goes.
#[derive(Clone, Copy)]
enum Chosen {
    /// Through this exit, where it fits.
    Exit(u32),
    /// No exit is open.
    None,
    /// No exit is open until the flow is solved again.
    Wait,
}

/// The exit by the definition: of any number of them, and with all bits of the draw where they are needed.
#[cold]
#[inline(never)]
fn any(
    network: &Network,
    table: &General,
    from: u32,
    draw: u16,
    index: usize,
    extension: Extension,
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

/// The first exit whose threshold exceeds the draw; sixteen bits decide unless they are equal.
#[inline]
fn choose(thresholds: &[u64], draw: u16, index: usize, extension: Extension) -> Option<usize> {
    let is_above = |threshold: u64| {
        let top = (threshold >> 48) as u16;
        draw < top || (draw == top && extension.complete(draw, index as u64) < threshold)
    };
    if thresholds.len() <= LOOKED_AT {
        return thresholds.iter().position(|&threshold| is_above(threshold));
    }
    // Thresholds rise. A reservoir has thousands: whole numbers are compared without a branch, and all bits
    // of the draw are asked for in a tie alone.
    let passed = thresholds.partition_point(|&threshold| threshold < u64::from(draw) << 48);
    let rest = &thresholds[passed..];
    let first = match rest.first() {
        Some(&threshold) if !is_above(threshold) => rest.partition_point(|&threshold| !is_above(threshold)),
        _ => 0,
    };
    (first < rest.len()).then_some(passed + first)
}

/// Up to so many exits are looked at one after another.
const LOOKED_AT: usize = 16;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::Purpose;

    /// Of thousands of exits, many of which share their upper bits or are closed: as by looking at each.
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
                // As closed exits have them, and such as differ below.
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
