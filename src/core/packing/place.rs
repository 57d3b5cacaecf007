//! Random placement without overlap: the loose start of a compression.

use super::neighbours::{Aspect, nearest};
use super::settings::PackingError;
use crate::stream::unit;
use rand::Rng;

/// Tries per grain before the placement fails.
const TRIES: usize = 2_000_000;

/// One size level: a grid of singly linked lists of the grains placed so far.
struct Grid {
    radius: f64,
    /// Cells along x and along y.
    cells: usize,
    /// Cells along z.
    along: usize,
    /// First grain of each cell, `u32::MAX` for none.
    head: Vec<u32>,
}

/// Finds centres in units of the cell's width for spheres of these radii (descending), so that no two overlap
/// in a periodic cell as wide as `cell` and of this aspect.
pub(super) fn place(
    radius: &[f64],
    cell: f64,
    aspect: Aspect,
    generator: &mut impl Rng,
) -> Result<Vec<[f64; 3]>, PackingError> {
    let mut centre: Vec<[f64; 3]> = Vec::with_capacity(radius.len());
    let mut next: Vec<u32> = Vec::with_capacity(radius.len());
    let mut grids: Vec<Grid> = Vec::new();
    for (i, &r) in radius.iter().enumerate() {
        if grids.last().is_none_or(|g| r < 0.5 * g.radius) {
            let members = radius[i..].iter().take_while(|&&q| q >= 0.5 * r).count();
            let widest = libm::cbrt(4.0 * members as f64 / aspect.height()) as usize;
            let cells = ((cell / (2.0 * r)) as usize).min(widest).max(1);
            let along = aspect.along(cells);
            grids.push(Grid { radius: r, cells, along, head: vec![u32::MAX; cells * cells * along] });
        }
        let mut tries = 0;
        let s = loop {
            let [x, y, z] = [(); 3].map(|()| unit(generator.next_u64()));
            let s = [x, y, z * aspect.height()];
            if grids.iter().all(|g| clear(s, r, g, (cell, aspect), &centre, &next, radius)) {
                break s;
            }
            tries += 1;
            if tries == TRIES {
                let volume: f64 =
                    radius.iter().map(|r| r * r * r).sum::<f64>() * (4.0 / 3.0) * std::f64::consts::PI;
                return Err(PackingError::Placement {
                    grain: i,
                    grains: radius.len(),
                    fraction: volume / (cell * cell * cell * aspect.height()),
                });
            }
        };
        let grid = grids.last_mut().expect("pushed above");
        let index = |s: f64, n: usize| ((s * n as f64) as usize).min(n - 1);
        let column = index(s[0], grid.cells) * grid.cells + index(s[1], grid.cells);
        let head = &mut grid.head[column * grid.along + index(s[2] / aspect.height(), grid.along)];
        next.push(*head);
        *head = i as u32;
        centre.push(s);
    }
    Ok(centre)
}

fn clear(
    s: [f64; 3],
    r: f64,
    grid: &Grid,
    (cell, aspect): (f64, Aspect),
    centre: &[[f64; 3]],
    next: &[u32],
    radius: &[f64],
) -> bool {
    let (across, along) = (grid.cells as i64, grid.along as i64);
    let half = (r + grid.radius) / cell;
    let range = |s: f64, half: f64, n: i64| {
        let low = libm::floor((s - half) * n as f64) as i64;
        let high = libm::floor((s + half) * n as f64) as i64;
        if high - low >= n { (0, n - 1) } else { (low, high) }
    };
    let (x, y) = (range(s[0], half, across), range(s[1], half, across));
    let z = range(s[2] / aspect.height(), half / aspect.height(), along);
    for cx in x.0..=x.1 {
        for cy in y.0..=y.1 {
            let row = (cx.rem_euclid(across) * across + cy.rem_euclid(across)) * along;
            for cz in z.0..=z.1 {
                let mut j = grid.head[(row + cz.rem_euclid(along)) as usize];
                while j != u32::MAX {
                    let q = centre[j as usize];
                    let gap = [nearest(q[0] - s[0]), nearest(q[1] - s[1]), aspect.nearest(q[2] - s[2])];
                    let d2: f64 = gap.iter().map(|d| d * d).sum();
                    let reach = (r + radius[j as usize]) / cell;
                    if d2 < reach * reach {
                        return false;
                    }
                    j = next[j as usize];
                }
            }
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::{Key, Purpose};

    #[test]
    fn no_two_grains_overlap() {
        for height in [1.0, 1.7, 6.0] {
            none_overlap(Aspect::new(height));
        }
        let mut generator =
            Key { seed: 5, purpose: Purpose::Packing, run: 0, increment: 0, chunk: 2 }.generator();
        assert!(matches!(
            place(&[1.0, 1.0], 2.0, Aspect::new(1.0), &mut generator),
            Err(PackingError::Placement { grain: 1, .. })
        ));
    }

    fn none_overlap(aspect: Aspect) {
        let mut generator =
            Key { seed: 5, purpose: Purpose::Packing, run: 0, increment: 0, chunk: 1 }.generator();
        let mut radius: Vec<f64> =
            (0..600).map(|_| 0.5 * libm::pow(20.0, unit(generator.next_u64()))).collect();
        radius.sort_by(|a, b| b.total_cmp(a));
        let volume: f64 = radius.iter().map(|r| 4.18879 * r * r * r).sum();
        let cell = libm::cbrt(volume / 0.35 / aspect.height());
        let centre = place(&radius, cell, aspect, &mut generator).unwrap();
        for i in 0..radius.len() {
            for j in 0..i {
                let [x, y, z] = [0, 1, 2].map(|a| centre[i][a] - centre[j][a]);
                let d2: f64 = [nearest(x), nearest(y), aspect.nearest(z)].map(|d| d * d).iter().sum();
                assert!(d2.sqrt() * cell >= radius[i] + radius[j]);
            }
        }
    }
}
