//! Keeps the lists complete while the grains move: their reach follows from how long they last.

use super::compression::Compression;
use super::neighbours::{Reach, Remembered, list, morton};

/// Steps that a pick of close pairs is meant to last.
const PICKS: (u64, u64) = (10, 25);

/// Steps that lists are meant to last.
const LISTS: (u64, u64) = (100, 300);

/// Lengthens a reach that lasted too short a time, shortens one that lasted too long.
fn follow(reach: &mut Reach, strained: bool, lasted: u64, meant: (u64, u64), least: Reach) {
    if lasted < meant.0 {
        if strained {
            reach.relative = (reach.relative * 1.5).min(0.05);
        } else {
            reach.absolute = (reach.absolute * 1.3).min(1.0);
        }
    } else if lasted > meant.1 {
        reach.relative *= 0.8;
        reach.absolute *= 0.8;
    }
    reach.relative = reach.relative.max(least.relative);
    reach.absolute = reach.absolute.max(least.absolute);
}

impl Compression {
    /// Makes sure that every pair that can touch is among the close ones; returns the reach of a new pick if
    /// one is due.
    ///
    /// Both reaches follow from how long they last: a longer one costs more pairs a step, a shorter one is
    /// renewed more often.
    pub(super) fn renew(&mut self) -> Option<Reach> {
        if self.close.holds(Reach::CONTACT, self.cell, self.picked_cell, self.moved) {
            return None;
        }
        let strained = self.picked_cell > self.cell * (1.0 + self.close.relative);
        follow(
            &mut self.close,
            strained,
            self.steps - self.picked_at,
            PICKS,
            Reach { relative: 2e-5, absolute: 2e-4 },
        );
        let listed_moved = self.position.iter().zip(&self.listed).fold(0.0, |far: f64, (p, l)| {
            let d = [p[0] - l[0], p[1] - l[1], p[2] - l[2]];
            far.max(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
        });
        if !self.reach.holds(self.close, self.cell, self.listed_cell, listed_moved.sqrt()) {
            let strained =
                self.listed_cell * (1.0 + self.close.relative) > self.cell * (1.0 + self.reach.relative);
            let least = Reach { relative: 3.0 * self.close.relative, absolute: 3.0 * self.close.absolute };
            follow(&mut self.reach, strained, self.steps - self.listed_at, LISTS, least);
            self.relist();
        }
        self.picked.clone_from(&self.position);
        self.picked_cell = self.cell;
        self.picked_at = self.steps;
        self.moved = 0.0;
        Some(self.close)
    }

    /// Makes new lists, with the grains in the order of a space-filling curve.
    pub(super) fn relist(&mut self) {
        let remembered = Remembered::collect(&self.chunks, &self.rank);
        for p in &mut self.position {
            let [x, y, z, radius] = *p;
            let [x, y, z] = self.aspect.wrapped([x, y, z]);
            *p = [x, y, z, radius];
        }
        let mut order: Vec<u64> = (0..self.rank.len() as u64)
            .map(|i| {
                let [x, y, z, _] = self.position[i as usize];
                (u64::from(morton([x, y, z / self.aspect.height()])) << 32) | u64::from(self.rank[i as usize])
            })
            .collect();
        order.sort_unstable();
        let mut place = vec![0u32; self.rank.len()];
        for (i, &r) in self.rank.iter().enumerate() {
            place[r as usize] = i as u32;
        }
        let from: Vec<usize> =
            order.iter().map(|&key| place[(key & 0xffff_ffff) as usize] as usize).collect();
        self.rank = from.iter().map(|&i| self.rank[i]).collect();
        for column in [&mut self.position, &mut self.velocity, &mut self.spin] {
            *column = from.iter().map(|&i| column[i]).collect();
        }
        self.listed.clone_from(&self.position);
        self.listed_cell = self.cell;
        self.listed_at = self.steps;
        self.chunks = list(&self.position, &self.rank, self.cell, self.aspect, self.reach);
        remembered.restore(&mut self.chunks, &self.rank);
    }
}
