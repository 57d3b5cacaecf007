//! Random placement without overlap: the loose start of a compression.

use super::neighbours::nearest;
use super::settings::PackingError;
use crate::stream::unit;
use rand::Rng;

/// Tries per grain before the placement is given up.
const TRIES: usize = 2_000_000;

/// One size level: a grid of singly linked lists of the grains placed so far.
struct Grid {
    radius: f64,
    cells: usize,
    /// First grain of each cell, `u32::MAX` for none.
    head: Vec<u32>,
}

/// Centres in units of the cell for spheres of these radii (descending), so that none overlap in a periodic
/// cell of edge `cell`.
pub(super) fn place(
    radius: &[f64],
    cell: f64,
    generator: &mut impl Rng,
) -> Result<Vec<[f64; 3]>, PackingError> {
    let mut centre: Vec<[f64; 3]> = Vec::with_capacity(radius.len());
    let mut next: Vec<u32> = Vec::with_capacity(radius.len());
    let mut grids: Vec<Grid> = Vec::new();
    for (i, &r) in radius.iter().enumerate() {
        if grids.last().is_none_or(|g| r < 0.5 * g.radius) {
            let members = radius[i..].iter().take_while(|&&q| q >= 0.5 * r).count();
            let widest = libm::cbrt(4.0 * members as f64) as usize;
            let cells = ((cell / (2.0 * r)) as usize).min(widest).max(1);
            grids.push(Grid { radius: r, cells, head: vec![u32::MAX; cells * cells * cells] });
        }
        let mut tries = 0;
        let s = loop {
            let s = [unit(generator.next_u64()), unit(generator.next_u64()), unit(generator.next_u64())];
            if grids.iter().all(|g| clear(s, r, g, cell, &centre, &next, radius)) {
                break s;
            }
            tries += 1;
            if tries == TRIES {
                let volume: f64 =
                    radius.iter().map(|r| r * r * r).sum::<f64>() * (4.0 / 3.0) * std::f64::consts::PI;
                return Err(PackingError::Placement {
                    grain: i,
                    grains: radius.len(),
                    fraction: volume / (cell * cell * cell),
                });
            }
        };
        let grid = grids.last_mut().expect("pushed above");
        let n = grid.cells;
        let c = s.map(|s| ((s * n as f64) as usize).min(n - 1));
        let head = &mut grid.head[(c[0] * n + c[1]) * n + c[2]];
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
    cell: f64,
    centre: &[[f64; 3]],
    next: &[u32],
    radius: &[f64],
) -> bool {
    let n = grid.cells as i64;
    let half = (r + grid.radius) / cell;
    let range = |s: f64| {
        let low = libm::floor((s - half) * n as f64) as i64;
        let high = libm::floor((s + half) * n as f64) as i64;
        if high - low >= n { (0, n - 1) } else { (low, high) }
    };
    let (x, y, z) = (range(s[0]), range(s[1]), range(s[2]));
    for cx in x.0..=x.1 {
        for cy in y.0..=y.1 {
            let row = (cx.rem_euclid(n) * n + cy.rem_euclid(n)) * n;
            for cz in z.0..=z.1 {
                let mut j = grid.head[(row + cz.rem_euclid(n)) as usize];
                while j != u32::MAX {
                    let q = centre[j as usize];
                    let d2: f64 = (0..3).map(|a| nearest(q[a] - s[a]) * nearest(q[a] - s[a])).sum();
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
        let mut generator =
            Key { seed: 5, purpose: Purpose::Packing, run: 0, increment: 0, chunk: 1 }.generator();
        let mut radius: Vec<f64> =
            (0..600).map(|_| 0.5 * libm::pow(20.0, unit(generator.next_u64()))).collect();
        radius.sort_by(|a, b| b.total_cmp(a));
        let volume: f64 = radius.iter().map(|r| 4.18879 * r * r * r).sum();
        let cell = libm::cbrt(volume / 0.35);
        let centre = place(&radius, cell, &mut generator).unwrap();
        for i in 0..radius.len() {
            for j in 0..i {
                let d2: f64 =
                    (0..3).map(|a| nearest(centre[i][a] - centre[j][a])).map(|d| d * d).sum::<f64>();
                assert!(d2.sqrt() * cell >= radius[i] + radius[j]);
            }
        }
        assert!(matches!(
            place(&[1.0, 1.0], 2.0, &mut generator),
            Err(PackingError::Placement { grain: 1, .. })
        ));
    }
}
