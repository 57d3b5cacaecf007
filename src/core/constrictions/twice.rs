//! Grains that occur twice in a packing.

use super::triangulation::{Positions, Shift, Triangulation};

/// Distance of two centres, over the smaller diameter, below which they are one grain that occurs twice.
const SAME_GRAIN: f64 = 1e-3;

/// Distance of two centres, over the smaller diameter, below which they may well be one grain.
const NEAR: f64 = 0.25;

/// Hidden grains with the centre of another, and neighbours nearer than [`SAME_GRAIN`].
pub(super) fn duplicates(t: &Triangulation, positions: &Positions<'_>) -> Vec<[u32; 2]> {
    nearer(SAME_GRAIN, t, positions, t.duplicates().to_vec())
}

/// Neighbours nearer than [`NEAR`].
pub(super) fn near(t: &Triangulation, positions: &Positions<'_>) -> Vec<[u32; 2]> {
    nearer(NEAR, t, positions, Vec::new())
}

fn nearer(
    share: f64,
    t: &Triangulation,
    positions: &Positions<'_>,
    mut pairs: Vec<[u32; 2]>,
) -> Vec<[u32; 2]> {
    for i in 0..t.tetrahedra() {
        let (grains, at) = (t.corners(i), t.at(positions, i, Shift::ZERO));
        for (a, b) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
            let near = share * 2.0 * at[a][3].min(at[b][3]);
            let square: f64 =
                (0..3).map(|axis| (at[a][axis] - at[b][axis]) * (at[a][axis] - at[b][axis])).sum();
            if square < near * near {
                pairs.push([grains[a].max(grains[b]), grains[a].min(grains[b])]);
            }
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}
