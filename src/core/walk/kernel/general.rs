//! Step on any network: exits and targets by look-up.

use super::lattice::fetch;
use crate::network::{END, Network};
use crate::stream::{DRAWS_PER_BLOCK, Key, LANES, Lanes, Words, draw16};
use crate::walk::Arching;
use crate::walk::chunks::{Events, Jam};
use crate::walk::exits::{General, NONE, WAIT};

/// Number of particles by which exits are prefetched ahead.
const AHEAD: usize = 24;

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

/// Moves the particles of one chunk; those that fit may jam by `jams`. Returns the number still moving.
#[inline(always)]
pub(super) fn step(
    network: &Network,
    table: &General,
    mut jams: Option<Jams>,
    key: Key,
    void: &mut [u32],
    diameter: &mut [f32],
    events: &mut Events,
) -> usize {
    let mut lanes = key.lanes();
    let extension = lanes.extension();
    let mut kept = 0;
    let mut chosen = [NONE; DRAWS_PER_BLOCK];
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
                    exit as u32
                }
                None => any(network, table, from, draw, j, extension),
            };
        }
        for (chosen, j) in chosen.iter().zip(particles) {
            let (from, d) = (void[j], diameter[j]);
            let exit = match *chosen {
                NONE => {
                    events.stranded.push((from, d));
                    continue;
                }
                WAIT => {
                    events.waiting += 1;
                    (void[kept], diameter[kept]) = (from, d);
                    kept += 1;
                    continue;
                }
                exit => exit,
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

/// Exit by definition, for any number of exits, with all bits of the draw, or [`NONE`] or [`WAIT`].
#[cold]
#[inline(never)]
fn any(network: &Network, table: &General, from: u32, draw: u16, index: usize, extension: Words) -> u32 {
    let last_open = table.last_open[from as usize];
    if [NONE, WAIT].contains(&last_open) {
        return last_open;
    }
    let (exits, draw) = (network.exits(from), extension.complete(draw, index as u64));
    let passed = table.threshold[exits.clone()].partition_point(|&threshold| threshold <= draw);
    if passed < exits.len() { (exits.start + passed) as u32 } else { last_open }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::Purpose;
    use crate::walk::ExitTable;
    use crate::walk::exits::Form;
    use bitvec::vec::BitVec;

    /// Thousands of exits, many of them closed or with equal upper bits, compared with a linear search.
    #[test]
    fn an_exit_of_thousands_is_found_as_by_looking_at_each() {
        let key = Key { seed: 3, purpose: Purpose::Step, run: 1, increment: 1, chunk: 0 };
        let extension = key.lanes().extension();
        for exits in [17, 100, 3000] {
            let rows: String =
                (0..exits).map(|e| format!("0,end,{}\n", 0.01 + 0.1 * (e % 7) as f64)).collect();
            let text = format!("from,to,diameter_mm\nstart,0,\n{rows}");
            let network = Network::from_csv(text.as_bytes(), "n.csv", 1.0).unwrap();
            let blocked: BitVec = (0..exits).map(|e| e % 3 == 0).collect();
            let Form::General(table) = ExitTable::new(&network, &blocked).form else { panic!("no lattice") };
            let mut ties = 0;
            for draw in 0..=u16::MAX {
                let index = usize::from(draw) + exits;
                let whole = extension.complete(draw, index as u64);
                let by_each = table.threshold.iter().position(|&threshold| whole < threshold);
                let expected = by_each.map_or(table.last_open[0], |exit| exit as u32);
                assert_eq!(any(&network, &table, 0, draw, index, extension), expected, "{exits} {draw}");
                ties += table.top.iter().filter(|&&top| top == draw).count();
            }
            assert!(ties > exits / 2, "{ties}");
        }
    }
}
