//! Order in which grains are inserted: coarse to fine, each level along a Hilbert curve.
//!
//! Neighbours on the curve are neighbours in space, so a walk from the grain before is short; and
//! each level is an even sample of the whole, so no cavity grows long (the purpose of the biased
//! randomised order of Amenta, Choi & Rote, doi:10.1145/777792.777824, without the random numbers).

use super::points::GrainPoint;

/// Bits per axis of a place on the curve.
const BITS: u32 = 16;

/// Growth of the number of grains from one level to the next, about.
const GROWTH: usize = 8;

/// Distance along the Hilbert curve of a cell of a grid of 2^[`BITS`] cells a side (Skilling,
/// *Programming the Hilbert curve*, doi:10.1063/1.1751381).
fn along_curve(mut x: [u32; 3]) -> u64 {
    let mut q = 1 << (BITS - 1);
    while q > 1 {
        let p = q - 1;
        for i in 0..3 {
            if x[i] & q != 0 {
                x[0] ^= p;
            } else {
                let t = (x[0] ^ x[i]) & p;
                x[0] ^= t;
                x[i] ^= t;
            }
        }
        q >>= 1;
    }
    x[1] ^= x[0];
    x[2] ^= x[1];
    let mut t = 0;
    q = 1 << (BITS - 1);
    while q > 1 {
        if x[2] & q != 0 {
            t ^= q - 1;
        }
        q >>= 1;
    }
    let spread = |value: u32| -> u64 {
        let mut v = u64::from(value ^ t);
        v = (v | v << 32) & 0x001f_0000_0000_ffff;
        v = (v | v << 16) & 0x001f_0000_ff00_00ff;
        v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
        v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
        (v | v << 2) & 0x1249_2492_4924_9249
    };
    spread(x[0]) << 2 | spread(x[1]) << 1 | spread(x[2])
}

/// Sorts all points along the curve through the box from `low` to `low + extent`.
pub(super) fn sorted(at: &[GrainPoint], low: [f64; 3], extent: f64) -> Vec<u32> {
    let scale = f64::from(1u32 << BITS) / extent;
    let mut keyed: Vec<(u64, u32)> = at
        .iter()
        .zip(0u32..)
        .map(|(point, i)| {
            let cell = |axis: usize| (((point[axis] - low[axis]) * scale) as u32).min((1 << BITS) - 1);
            (along_curve([cell(0), cell(1), cell(2)]), i)
        })
        .collect();
    keyed.sort_unstable();
    keyed.into_iter().map(|(_, i)| i).collect()
}

/// Reorders the points: every `stride`th first, then level by level the rest.
pub(super) fn levels(sorted: &[u32], mut stride: usize) -> Vec<u32> {
    let mut placed = vec![false; sorted.len()];
    let mut order = Vec::with_capacity(sorted.len());
    loop {
        for i in (0..sorted.len()).step_by(stride) {
            if !std::mem::replace(&mut placed[i], true) {
                order.push(sorted[i]);
            }
        }
        if stride == 1 {
            return order;
        }
        stride = (stride / GROWTH).max(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_steps_from_cell_to_neighbouring_cell() {
        let mut cells = Vec::new();
        for x in 0..8u32 {
            for y in 0..8 {
                for z in 0..8 {
                    cells.push((along_curve([x, y, z]), [x as i32, y as i32, z as i32]));
                }
            }
        }
        cells.sort_unstable();
        for pair in cells.windows(2) {
            let step: i32 = (0..3).map(|axis| (pair[0].1[axis] - pair[1].1[axis]).abs()).sum();
            assert_eq!(step, 1, "{pair:?}");
        }
    }

    #[test]
    fn every_point_has_one_place() {
        let mut order = levels(&(0..1000).collect::<Vec<_>>(), 77);
        assert_eq!(order[..3], [0, 77, 154]);
        order.sort_unstable();
        assert!(order.into_iter().eq(0..1000));
    }
}
