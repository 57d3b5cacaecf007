//! The step on the cubic lattice: one table word a void, targets by arithmetic.

use super::OpenExits;
use crate::stream::{DRAWS_PER_BLOCK, Key, draw16};
use crate::walk::exits::{self, Lattice};
use crate::walk::merge::Events;

/// Moves the particles of one chunk; returns how many still move.
pub(super) fn step(
    exits: &OpenExits,
    table: &Lattice,
    key: Key,
    void: &mut [u32],
    diameter: &mut [f32],
    events: &mut Events,
) -> usize {
    let mut lanes = key.lanes();
    let extension = lanes.extension();
    let diameters = exits.network.diameters();
    let voids = table.entry.len() as u32;
    let mut kept = 0;
    for begin in (0..void.len()).step_by(DRAWS_PER_BLOCK) {
        let block = lanes.next_block();
        for j in begin..void.len().min(begin + DRAWS_PER_BLOCK) {
            let (from, d) = (void[j], diameter[j]);
            let entry = table.entry[from as usize];
            let draw = draw16(&block, j - begin);
            let (first, second, top) = (entry >> 17, entry >> 2 & 0x7fff, u32::from(draw >> 1));
            let exit = if top == first || top == second || first > second {
                match undecided(exits, from, extension.complete(draw, j as u64)) {
                    Some(exit) => exit,
                    None => {
                        events.stranded.push((from, d));
                        continue;
                    }
                }
            } else {
                u32::from(top >= first) + u32::from(top >= second)
            };
            if d > exits.passive_limit && d > diameters[(3 * from + exit) as usize] {
                events.stopped.push((3 * from + exit, d));
                continue;
            }
            let to = table.target(from, exit, entry);
            if to >= voids {
                events.eroded.push(d);
                continue;
            }
            void[kept] = to;
            diameter[kept] = d;
            kept += 1;
        }
    }
    kept
}

impl Lattice {
    /// Void that exit `exit` of void `from` leads to; past the last void where it leaves.
    #[inline(always)]
    pub fn target(&self, from: u32, exit: u32, entry: u32) -> u32 {
        match exit {
            0 => from + 1 - (entry & 1) * self.nx,
            1 => from + self.nx - (entry >> 1 & 1) * self.plane,
            _ => from + self.plane,
        }
    }
}

/// Exit picked by a draw whose fifteen top bits equal a threshold's; none where every exit is closed.
#[cold]
fn undecided(exits: &OpenExits, void: u32, draw: u64) -> Option<u32> {
    let mut thresholds = Vec::with_capacity(3);
    let last_open = exits::thresholds(exits.network, exits.blocked, void, &mut thresholds)?;
    let exit = thresholds.iter().position(|&t| draw < t).unwrap_or(last_open);
    Some(exit as u32)
}
