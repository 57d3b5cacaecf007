//! The step on any network: exits and targets by look-up.

use crate::network::{END, Network};
use crate::stream::{DRAWS_PER_BLOCK, Extension, Key, draw16};
use crate::walk::exits::{General, NONE, WAIT};
use crate::walk::merge::Events;

/// Moves the particles of one chunk; returns how many still move.
pub(super) fn step(
    network: &Network,
    table: &General,
    key: Key,
    void: &mut [u32],
    diameter: &mut [f32],
    events: &mut Events,
) -> usize {
    let mut lanes = key.lanes();
    let extension = lanes.extension();
    let mut kept = 0;
    for begin in (0..void.len()).step_by(DRAWS_PER_BLOCK) {
        let block = lanes.next_block();
        for j in begin..void.len().min(begin + DRAWS_PER_BLOCK) {
            let (from, d) = (void[j], diameter[j]);
            let last_open = table.last_open[from as usize];
            if last_open >= WAIT {
                if last_open == NONE {
                    events.stranded.push((from, d));
                } else {
                    events.waiting += 1;
                    (void[kept], diameter[kept]) = (from, d);
                    kept += 1;
                }
                continue;
            }
            let exits = network.exits(from);
            let thresholds = &table.threshold[exits.clone()];
            let chosen = choose(thresholds, draw16(&block, j - begin), j, extension);
            let exit = chosen.map_or(last_open as usize, |e| exits.start + e);
            if d > network.diameters()[exit] {
                events.stopped.push((exit as u32, d));
                continue;
            }
            match network.targets()[exit] {
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

/// The first exit whose threshold exceeds the draw; sixteen bits decide unless they are equal.
#[inline]
fn choose(thresholds: &[u64], draw: u16, index: usize, extension: Extension) -> Option<usize> {
    let is_above = |threshold: u64| {
        let top = (threshold >> 48) as u16;
        draw < top || (draw == top && extension.complete(draw, index as u64) < threshold)
    };
    if thresholds.len() <= FEW_EXITS {
        return thresholds.iter().position(|&threshold| is_above(threshold));
    }
    // Thresholds rise. A reservoir has thousands.
    let first = thresholds.partition_point(|&threshold| !is_above(threshold));
    (first < thresholds.len()).then_some(first)
}

/// Up to so many exits are looked at one after another.
const FEW_EXITS: usize = 16;
