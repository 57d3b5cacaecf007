//! Finds close pairs of grains: Verlet lists from a multi-level grid.
//!
//! Grains are sorted into levels by size, each a factor of two wide, and every level has its own grid of
//! cells about as wide as its largest grain. A grain is compared only with its own level and the finer
//! ones: a grain 36 times as large visits as many cells as the shell around it holds, and the many small
//! grains never visit coarse cells.
//!
//! A pair is listed, by its larger grain, if the grains are nearer than `R (1 + relative) + absolute`, where
//! `R` is the sum of the radii. The list is complete as long as no grain has moved by more than `absolute /
//! 2` relative to the deforming cell and the cell has shrunk by less than `relative`: see [`Reach::holds`].
//!
//! Every few steps the pairs within a much shorter reach are picked from the lists; the force pass uses
//! only those. Most of them touch.
//!
//! Grains are divided into chunks that depend only on their number; each chunk owns the pairs that its
//! grains list. A chunk is the unit of parallel work, so no sum depends on the number of threads.

use rayon::prelude::*;

/// Target number of grains per chunk.
const CHUNK: usize = 1024;

/// `1.5 * 2^52`: adding and subtracting it rounds to the nearest integer.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// Maps a difference of two positions, in units of the cell, to its nearest image.
#[inline(always)]
pub(super) fn nearest(d: f64) -> f64 {
    d - ((d + ROUND) - ROUND)
}

/// Ratio of height to width of the cell. The width is the unit of all positions; along z they repeat
/// after this height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Aspect {
    height: f64,
    per_height: f64,
}

impl Aspect {
    /// Maximum ratio of height to width.
    pub(crate) const TALLEST: f64 = 100.0;

    pub(crate) fn new(height: f64) -> Self {
        Self { height, per_height: 1.0 / height }
    }

    pub(crate) fn height(self) -> f64 {
        self.height
    }

    /// Maps a difference of two positions along z to its nearest image; for a cube it gives the same
    /// bits as [`nearest`].
    #[inline(always)]
    pub(crate) fn nearest(self, d: f64) -> f64 {
        d - self.height * ((d * self.per_height + ROUND) - ROUND)
    }

    /// Square of the distance of the nearest images of two positions.
    #[inline(always)]
    pub(crate) fn square(self, p: &[f64], q: &[f64]) -> f64 {
        let [x, y, z] = [nearest(q[0] - p[0]), nearest(q[1] - p[1]), self.nearest(q[2] - p[2])];
        x * x + y * y + z * z
    }

    /// Number of cells along z, none flatter than the width of a cell if there are `across` along x.
    pub(crate) fn along(self, across: usize) -> usize {
        (across as f64 * self.height) as usize
    }

    pub(crate) fn wrapped(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let inside = |s: f64, length: f64| {
            let s = s - length * libm::floor(s / length);
            if s < length { s } else { 0.0 }
        };
        [inside(x, 1.0), inside(y, 1.0), inside(z, self.height)]
    }
}

/// Reach of the lists beyond contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reach {
    /// Fraction of the sum of the radii.
    pub(crate) relative: f64,
    /// Additional length.
    pub(crate) absolute: f64,
}

impl Reach {
    pub(super) const CONTACT: Self = Self { relative: 0.0, absolute: 0.0 };

    /// Distance within which two grains count if their radii sum to `radii`.
    #[inline(always)]
    fn around(self, radii: f64) -> f64 {
        radii * (1.0 + self.relative) + self.absolute
    }

    /// Tells if lists made when the cell was `listed_cell` wide still hold every pair within the shorter
    /// `reach`, if no grain has since moved farther than `moved` (in units of the cell).
    ///
    /// A pair that was not listed is, in units of the cell, at least
    /// `(R (1 + self.relative) + self.absolute) / listed_cell - 2 moved` apart, for every `R`; that has to
    /// reach `(R (1 + reach.relative) + reach.absolute) / cell`.
    pub(super) fn holds(&self, reach: Reach, cell: f64, listed_cell: f64, moved: f64) -> bool {
        let shrunk = listed_cell / cell;
        shrunk * (1.0 + reach.relative) <= 1.0 + self.relative
            && 2.0 * moved * listed_cell + reach.absolute * shrunk <= self.absolute
    }
}

/// Tangential memory of a pair: spring force on the larger grain along x, y, z, and the tangential
/// stiffness when it was computed; zero for pairs that do not touch.
pub(super) type Memory = [f64; 4];

/// Pairs listed by the grains `first .. last`.
#[derive(Clone, Debug, Default)]
pub(super) struct GrainChunk {
    pub(crate) first: usize,
    /// One past the last grain.
    pub(crate) last: usize,
    /// First pair of grain `first + g`; one entry more than there are grains.
    pub(crate) start: Vec<u32>,
    /// The smaller grain of each pair.
    pub(crate) neighbour: Vec<u32>,
    /// The close pairs, in list order: larger grain, smaller grain.
    pub(crate) close: Vec<[u32; 2]>,
    /// Index of each close pair among the listed pairs.
    pub(crate) close_pair: Vec<u32>,
    pub(crate) memory: Vec<Memory>,
}

impl GrainChunk {
    #[inline(always)]
    pub(crate) fn pairs(&self, i: usize) -> std::ops::Range<usize> {
        self.start[i - self.first] as usize..self.start[i - self.first + 1] as usize
    }

    /// Picks new close pairs; those that remain keep their memory, and those that touch remain.
    pub(crate) fn pick(&mut self, position: &[[f64; 4]], cell: f64, aspect: Aspect, reach: Reach) {
        let per_cell = 1.0 / cell;
        let old_pair = std::mem::take(&mut self.close_pair);
        let old_memory = std::mem::take(&mut self.memory);
        let mut old = old_pair.iter().zip(&old_memory).peekable();
        self.close.clear();
        self.close_pair.reserve(old_pair.len() + old_pair.len() / 8);
        self.memory.reserve(old_pair.len() + old_pair.len() / 8);
        for i in self.first..self.last {
            let p = position[i];
            for pair in self.start[i - self.first]..self.start[i - self.first + 1] {
                let j = self.neighbour[pair as usize];
                let q = position[j as usize];
                let far = reach.around(p[3] + q[3]) * per_cell;
                if aspect.square(&p, &q) < far * far {
                    while old.next_if(|o| *o.0 < pair).is_some() {}
                    let memory = old.next_if(|o| *o.0 == pair).map_or([0.0; 4], |o| *o.1);
                    self.close.push([i as u32, j]);
                    self.close_pair.push(pair);
                    self.memory.push(memory);
                }
            }
        }
    }
}

/// Bounds of the chunks of `grains` grains; they depend on that number only.
pub(super) fn chunk_bounds(grains: usize) -> Vec<(usize, usize)> {
    let count = match grains / CHUNK {
        0 | 1 => 1,
        n => n & !1,
    };
    (0..count).map(|c| (c * grains / count, (c + 1) * grains / count)).collect()
}

struct Level {
    radius: f64,
    /// Number of cells along x and along y; `along` is the number along z.
    cells: usize,
    along: usize,
    /// First grain of cell `(x * cells + y) * along + z`.
    start: Vec<u32>,
    grain: Vec<u32>,
    /// Position in units of the cell, and radius, by cell.
    position: Vec<[f64; 4]>,
}

#[inline(always)]
fn cell_of(s: f64, cells: usize) -> usize {
    ((s * cells as f64) as usize).min(cells - 1)
}

/// Level of each radius: the number of factors of two above the smallest.
fn levels_of(position: &[[f64; 4]]) -> Vec<u8> {
    let smallest = position.iter().fold(f64::INFINITY, |m, p| m.min(p[3]));
    let level = |p: &[f64; 4]| {
        let (mut level, mut bound) = (0, 2.0 * smallest);
        while p[3] >= bound && level < 60 {
            bound *= 2.0;
            level += 1;
        }
        level
    };
    position.iter().map(level).collect()
}

/// Index of the first entry of each of `count` keys among entries sorted by key, and the number of entries.
fn starts(keys: impl Iterator<Item = u32>, count: usize) -> Vec<u32> {
    let mut start = vec![0u32; count + 1];
    keys.for_each(|key| start[key as usize + 1] += 1);
    for key in 0..count {
        start[key + 1] += start[key];
    }
    start
}

fn grids(position: &[[f64; 4]], level: &[u8], cell: f64, aspect: Aspect, reach: Reach) -> Vec<Level> {
    let count = level.iter().map(|&l| usize::from(l) + 1).max().unwrap_or(1);
    (0..count)
        .map(|l| {
            let members: Vec<u32> =
                (0..position.len() as u32).filter(|&i| usize::from(level[i as usize]) == l).collect();
            let radius = members.iter().fold(0.0, |m: f64, &i| m.max(position[i as usize][3]));
            let mut cells = 1;
            while radius > 0.0
                && (cells + 1) as f64 * reach.around(2.0 * radius) <= cell
                && (cells + 1) * (cells + 1) * aspect.along(cells + 1) <= 8 * members.len() + 64
            {
                cells += 1;
            }
            let along = aspect.along(cells);
            let home: Vec<u32> = members
                .iter()
                .map(|&i| {
                    let [x, y, z, _] = position[i as usize];
                    let column = cell_of(x, cells) * cells + cell_of(y, cells);
                    (column * along + cell_of(z / aspect.height, along)) as u32
                })
                .collect();
            let start = starts(home.iter().copied(), cells * cells * along);
            let mut next = start.clone();
            let mut grain = vec![0; members.len()];
            for (&i, &c) in members.iter().zip(&home) {
                grain[next[c as usize] as usize] = i;
                next[c as usize] += 1;
            }
            let position = grain.iter().map(|&i| position[i as usize]).collect();
            Level { radius, cells, along, start, grain, position }
        })
        .collect()
}

/// Runs of cells, at most two, that cover `s - half ..= s + half` on a periodic axis.
fn runs(s: f64, half: f64, cells: usize) -> [(usize, usize); 2] {
    let n = cells as f64;
    let low = libm::floor((s - half) * n) as i64;
    let high = libm::floor((s + half) * n) as i64;
    let n = cells as i64;
    if high - low + 1 >= n {
        return [(0, cells), (0, 0)];
    }
    let (low, high) = (low.rem_euclid(n) as usize, high.rem_euclid(n) as usize);
    if low <= high { [(low, high + 1), (0, 0)] } else { [(0, high + 1), (low, cells)] }
}

/// Lists every pair within `reach`. Positions are in units of the cell's width, `0 <= s < 1` (along z
/// below its height); the fourth entry is the radius. `rank` orders the grains from large to small.
pub(super) fn list(
    position: &[[f64; 4]],
    rank: &[u32],
    cell: f64,
    aspect: Aspect,
    reach: Reach,
) -> Vec<GrainChunk> {
    let level = levels_of(position);
    let grids = grids(position, &level, cell, aspect, reach);
    let build = |&(first, last): &(usize, usize)| {
        let mut chunk = GrainChunk { first, last, start: vec![0], ..GrainChunk::default() };
        for i in first..last {
            let at = position[i];
            let [x, y, z, radius] = at;
            for (l, grid) in grids.iter().enumerate().take(usize::from(level[i]) + 1) {
                let half = reach.around(radius + grid.radius) / cell;
                for (x0, x1) in runs(x, half, grid.cells) {
                    for cx in x0..x1 {
                        for (y0, y1) in runs(y, half, grid.cells) {
                            for cy in y0..y1 {
                                let row = (cx * grid.cells + cy) * grid.along;
                                for (z0, z1) in runs(z / aspect.height, half / aspect.height, grid.along) {
                                    if z1 <= z0 {
                                        continue;
                                    }
                                    let range = grid.start[row + z0] as usize..grid.start[row + z1] as usize;
                                    for (&j, p) in grid.grain[range.clone()].iter().zip(&grid.position[range])
                                    {
                                        let far = reach.around(radius + p[3]) / cell;
                                        if aspect.square(&at, p) < far * far
                                            && (l < usize::from(level[i]) || rank[i] < rank[j as usize])
                                        {
                                            chunk.neighbour.push(j);
                                        }
                                    }
                                }
                            }
                        }
                    }
                }
            }
            chunk.start.push(chunk.neighbour.len() as u32);
        }
        chunk
    };
    let bounds = chunk_bounds(position.len());
    if rayon::current_num_threads() == 1 {
        bounds.iter().map(build).collect()
    } else {
        bounds.par_iter().map(build).collect()
    }
}

/// Memories of the contacts, by rank of the smaller grain, which has few contacts with larger ones.
pub(super) struct Remembered {
    start: Vec<u32>,
    /// Rank of the larger grain, and the memory.
    entry: Vec<(u32, Memory)>,
}

impl Remembered {
    pub(crate) fn collect(chunks: &[GrainChunk], rank: &[u32]) -> Self {
        let contacts = || {
            let pairs = chunks.iter().flat_map(|chunk| chunk.close.iter().zip(&chunk.memory));
            let touching = pairs.filter(|(_, memory)| memory[3] > 0.0);
            touching.map(|(&[i, j], &memory)| (rank[i as usize], rank[j as usize], memory))
        };
        let start = starts(contacts().map(|(_, small, _)| small), rank.len());
        let mut next = start.clone();
        let mut entry = vec![(0, Memory::default()); start[rank.len()] as usize];
        for (large, small, memory) in contacts() {
            entry[next[small as usize] as usize] = (large, memory);
            next[small as usize] += 1;
        }
        Self { start, entry }
    }

    /// Restores the memories to the pairs of new lists, as close pairs.
    pub(crate) fn restore(&self, chunks: &mut [GrainChunk], rank: &[u32]) {
        for chunk in chunks {
            for i in chunk.first..chunk.last {
                for pair in chunk.pairs(i) {
                    let j = chunk.neighbour[pair];
                    let small = rank[j as usize] as usize;
                    let range = self.start[small] as usize..self.start[small + 1] as usize;
                    if let Some(&(_, memory)) = self.entry[range].iter().find(|e| e.0 == rank[i]) {
                        chunk.close.push([i as u32, j]);
                        chunk.close_pair.push(pair as u32);
                        chunk.memory.push(memory);
                    }
                }
            }
        }
    }
}

/// Position along a Morton curve of 2^10 cells per side, for points in the unit cube.
pub(super) fn morton(s: [f64; 3]) -> u32 {
    let spread = |s: f64| {
        let mut v = ((s * 1024.0) as u32).min(1023);
        v = (v | (v << 16)) & 0x0300_00ff;
        v = (v | (v << 8)) & 0x0300_f00f;
        v = (v | (v << 4)) & 0x030c_30c3;
        (v | (v << 2)) & 0x0924_9249
    };
    (spread(s[0]) << 2) | (spread(s[1]) << 1) | spread(s[2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::packing::uniform;
    use std::collections::BTreeSet;

    /// The lists equal a search of all pairs, for size ratios up to 100 and cells from two largest
    /// grains wide.
    #[test]
    fn lists_equal_all_pairs() {
        let cubes = [(1.0, 9.0), (1.5, 12.0), (10.0, 45.0), (36.0, 150.0), (100.0, 450.0), (3.0, 30.0)];
        let cubes = cubes.map(|(ratio, cell)| (ratio, cell, 1.0));
        let tall = [(1.5, 6.0, 7.0), (10.0, 25.0, 2.5), (36.0, 80.0, 1.3)];
        for (seed, (ratio, cell, height)) in cubes.iter().chain(&tall).enumerate() {
            let aspect = Aspect::new(*height);
            let mut u = uniform(seed as u64, 0);
            let mut position: Vec<[f64; 4]> =
                (0..400).map(|_| [u(), u(), u() * height, libm::pow(*ratio, u())]).collect();
            position.sort_by(|a, b| b[3].total_cmp(&a[3]));
            let rank: Vec<u32> = (0..400).collect();
            let reach = Reach { relative: 0.01, absolute: 0.3 };
            let mut listed = BTreeSet::new();
            for chunk in list(&position, &rank, *cell, aspect, reach) {
                for i in chunk.first..chunk.last {
                    for k in chunk.pairs(i) {
                        let fresh = listed.insert((i, chunk.neighbour[k] as usize));
                        assert!(fresh, "listed twice");
                    }
                }
            }
            let mut expected = BTreeSet::new();
            for i in 0..400 {
                for j in i + 1..400 {
                    let (p, q) = (position[i], position[j]);
                    let [x, y, z] = [0, 1, 2].map(|a| q[a] - p[a]);
                    // By hand, independent of the fast method.
                    let z =
                        [z - height, z, z + height].map(f64::abs).into_iter().fold(f64::INFINITY, f64::min);
                    let d2 = nearest(x) * nearest(x) + nearest(y) * nearest(y) + z * z;
                    if d2.sqrt() * cell < (p[3] + q[3]) * 1.01 + 0.3 {
                        expected.insert((i, j));
                    }
                }
            }
            assert!(expected.len() > 10);
            assert_eq!(listed, expected);
        }
    }

    #[test]
    fn chunks_cover_every_grain_once() {
        for n in [1, 2, 1023, 2048, 9313, 59_183] {
            let bounds = chunk_bounds(n);
            assert_eq!((bounds[0].0, bounds[bounds.len() - 1].1), (0, n));
            assert!(bounds.windows(2).all(|w| w[0].1 == w[1].0));
        }
    }
}
