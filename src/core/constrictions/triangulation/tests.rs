//! The triangulation against brute force in exact arithmetic, against itself, and on lattices.

use super::{SanityError, Triangulation, TriangulationError};
use crate::packing::{Cell, Packing};
use crate::stream::{Key, Purpose, unit};
use num_bigint::{BigInt, Sign};
use rand::Rng;
use std::collections::BTreeSet;

fn key(chunk: u64) -> impl Rng {
    Key { seed: 20_261_121, purpose: Purpose::Packing, run: 0, increment: 0, chunk }.generator()
}

/// Random grains, with any overlap, of diameters between two sizes.
fn random(grains: usize, cell: Cell, extent: [f64; 3], sizes: [f64; 2], chunk: u64) -> Packing {
    let mut rng = key(chunk);
    let mut column = |low: f64, high: f64| -> Vec<f64> {
        (0..grains).map(|_| low + (high - low) * unit(rng.next_u64())).collect()
    };
    let [x, y, z] = extent.map(|length| column(0.0, length));
    Packing { cell, x, y, z, diameter: column(sizes[0], sizes[1]) }
}

/// Determinant by cofactors: slow and obvious.
fn determinant(m: &[Vec<BigInt>]) -> BigInt {
    if m.is_empty() {
        return BigInt::from(1);
    }
    let mut sum = BigInt::ZERO;
    for (column, factor) in m[0].iter().enumerate() {
        let minor: Vec<Vec<BigInt>> = m[1..]
            .iter()
            .map(|row| row.iter().enumerate().filter(|(c, _)| *c != column).map(|(_, v)| v.clone()).collect())
            .collect();
        let term = factor * determinant(&minor);
        if column % 2 == 0 { sum += term } else { sum -= term }
    }
    sum
}

/// Lexicographic rank of each point.
fn ranks(points: &[[i64; 4]]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by_key(|&i| (points[i][0], points[i][1], points[i][2], i));
    let mut rank = vec![0; points.len()];
    order.into_iter().enumerate().for_each(|(place, i)| rank[i] = place);
    rank
}

fn height(point: &[i64; 4]) -> BigInt {
    let [x, y, z, r] = point.map(BigInt::from);
    &x * &x + &y * &y + &z * &z - &r * &r
}

/// Finds all tetrahedra whose lifted plane has every other lifted point above it, according to `above`.
fn brute_force(
    points: &[[i64; 4]],
    mut above: impl FnMut([usize; 4], usize) -> Option<bool>,
) -> BTreeSet<[u32; 4]> {
    let n = points.len();
    let mut regular = BTreeSet::new();
    for a in 0..n {
        for b in a + 1..n {
            for c in b + 1..n {
                for d in c + 1..n {
                    let four = [a, b, c, d];
                    if (0..n).all(|e| four.contains(&e) || above(four, e) == Some(true)) {
                        regular.insert(four.map(|i| i as u32));
                    }
                }
            }
        }
    }
    regular
}

/// Raises heights by actual powers of two in lexicographic order instead of symbols, and writes out the
/// determinant of the five lifted points.
fn literal(points: &[[i64; 4]]) -> BTreeSet<[u32; 4]> {
    const STEP: usize = 400;
    let (rank, n) = (ranks(points), points.len());
    let lifted: Vec<Vec<BigInt>> = (0..n)
        .map(|i| {
            let [x, y, z, _] = points[i].map(BigInt::from);
            let raised = (height(&points[i]) << (STEP * n)) + (BigInt::from(1) << (STEP * rank[i]));
            vec![x, y, z, BigInt::from(1), raised]
        })
        .collect();
    brute_force(points, |four, e| {
        let flat: Vec<Vec<BigInt>> = four.iter().map(|&i| lifted[i][..4].to_vec()).collect();
        let rows: Vec<Vec<BigInt>> = four.iter().chain([&e]).map(|&i| lifted[i].clone()).collect();
        let orientation = determinant(&flat).sign();
        (orientation != Sign::NoSign).then(|| determinant(&rows).sign() == orientation)
    })
}

/// Evaluates that determinant as a polynomial in the raises: the factor of height `i` is a volume.
fn polynomial(points: &[[i64; 4]]) -> BTreeSet<[u32; 4]> {
    let rank = ranks(points);
    let heights: Vec<BigInt> = points.iter().map(height).collect();
    let volume = |i: [usize; 4]| -> i128 {
        let d = |k: usize, axis: usize| i128::from(points[i[k]][axis] - points[i[0]][axis]);
        let minor = |j: usize, k: usize| d(j, 1) * d(k, 2) - d(k, 1) * d(j, 2);
        d(1, 0) * minor(2, 3) - d(2, 0) * minor(1, 3) + d(3, 0) * minor(1, 2)
    };
    brute_force(points, |four, e| {
        let whole = volume(four).signum();
        // Barycentric weights of e, times the volume, and -1 for e itself: zero if the plane through the four
        // passes through e, negative if e lies above it.
        let mut terms: Vec<(usize, i128)> = (0..4)
            .map(|k| {
                let mut replaced = four;
                replaced[k] = e;
                (four[k], whole * volume(replaced))
            })
            .collect();
        terms.push((e, -whole * volume(four)));
        let main: BigInt = terms.iter().map(|&(i, factor)| &heights[i] * BigInt::from(factor)).sum();
        terms.sort_by_key(|&(i, _)| std::cmp::Reverse(rank[i]));
        let raised = terms.iter().map(|&(_, factor)| factor).find(|&factor| factor != 0);
        (whole != 0).then(|| match main.sign() {
            Sign::NoSign => raised < Some(0),
            sign => sign == Sign::Minus,
        })
    })
}

/// Tetrahedra as sorted grains; translates of the same four grains remain apart by count.
fn tetrahedra(t: &Triangulation) -> Vec<[u32; 4]> {
    let mut all: Vec<[u32; 4]> = (0..t.tetrahedra())
        .map(|i| {
            let mut corners = t.corners(i);
            corners.sort_unstable();
            corners
        })
        .collect();
    all.sort_unstable();
    all
}

fn integers(points: &[[i64; 4]]) -> Packing {
    let column = |axis: usize| points.iter().map(|p| p[axis] as f64).collect();
    let diameter = points.iter().map(|p| 2.0 * p[3] as f64).collect();
    Packing { cell: Cell::Free, x: column(0), y: column(1), z: column(2), diameter }
}

/// Ten thousand sets of five to eight grains: a third on a grid of 4 x 4 x 4 (nothing but ties, duplicates
/// among them), a third on one of 32, a third with 40 bits.
#[test]
fn small_sets_agree_with_brute_force() {
    let mut flat = 0;
    for set in 0..10_000u64 {
        let mut rng = key(set);
        let grains = 5 + (set % 4) as usize;
        let (range, radius) = [(4, 2), (32, 12), (1 << 40, 1 << 38)][(set % 3) as usize];
        let points: Vec<[i64; 4]> = (0..grains)
            .map(|_| {
                let mut below = |n: u64| (rng.next_u64() % n) as i64;
                [below(range), below(range), below(range), 1 + below(radius)]
            })
            .collect();
        match Triangulation::new(&integers(&points)) {
            Ok(t) => {
                assert_eq!(t.sanity_check(), Ok(()), "set {set}: {points:?}");
                let actual = tetrahedra(&t);
                let expected: Vec<_> = polynomial(&points).into_iter().collect();
                assert_eq!(actual, expected, "set {set}: {points:?}");
                if set % 101 == 0 {
                    assert!(literal(&points).into_iter().eq(expected), "set {set}: {points:?}");
                }
            }
            Err(TriangulationError::Coplanar { .. }) => {
                assert!(polynomial(&points).is_empty());
                flat += 1;
            }
            Err(other) => panic!("{other}"),
        }
    }
    assert!(flat < 500);
}

#[test]
fn random_periodic_packings_are_sane() {
    for (chunk, (grains, extent, sizes)) in [
        (4, [10.0, 10.0, 10.0], [0.1, 1.0]),
        (5, [1.0, 2.0, 1.5], [0.1, 0.5]),
        (20, [10.0, 10.0, 10.0], [0.1, 5.0]),
        (100, [10.0, 3.0, 5.0], [0.1, 1.5]),
        (700, [10.0, 10.0, 10.0], [0.5, 1.0]),
        (3_000, [10.0, 10.0, 10.0], [0.01, 0.6]),
        (3_000, [10.0, 10.0, 10.0], [0.01, 5.0]),
    ]
    .into_iter()
    .enumerate()
    {
        let packing = random(grains, Cell::Periodic(extent), extent, sizes, chunk as u64);
        match Triangulation::new(&packing) {
            Ok(t) => assert_eq!(t.sanity_check(), Ok(()), "{grains} grains"),
            Err(error) => panic!("{grains} grains: {error}"),
        }
    }
}

/// The torus and the images give the same tetrahedra, ties included.
#[test]
fn the_torus_agrees_with_images() {
    let lattice = |i: usize, stride: usize| (i / stride % 12) as f64;
    let cubic = Packing {
        cell: Cell::Periodic([12.0; 3]),
        x: (0..1728).map(|i| lattice(i, 1)).collect(),
        y: (0..1728).map(|i| lattice(i, 12)).collect(),
        z: (0..1728).map(|i| lattice(i, 144)).collect(),
        diameter: vec![1.0; 1728],
    };
    let loose = random(1_500, Cell::Periodic([8.0; 3]), [8.0; 3], [0.2, 1.0], 7);
    for packing in [cubic, loose] {
        let by_images = Triangulation::with_samples(&packing, &[]).unwrap();
        for sample in [100, 300] {
            let on_torus = Triangulation::with_samples(&packing, &[sample]).unwrap();
            assert_eq!(tetrahedra(&on_torus), tetrahedra(&by_images));
            assert_eq!(on_torus.sanity_check(), Ok(()));
        }
    }
}

#[test]
fn a_factor_of_two_changes_nothing() {
    let packing = random(900, Cell::Periodic([6.0, 7.0, 8.0]), [6.0, 7.0, 8.0], [0.1, 1.0], 8);
    let base = tetrahedra(&Triangulation::new(&packing).unwrap());
    for factor in [0.5, 1024.0, 2f64.powi(-60)] {
        let scale = |column: &[f64]| column.iter().map(|v| v * factor).collect();
        let Cell::Periodic(cell) = packing.cell else { unreachable!() };
        let scaled = Packing {
            cell: Cell::Periodic(cell.map(|l| l * factor)),
            x: scale(&packing.x),
            y: scale(&packing.y),
            z: scale(&packing.z),
            diameter: scale(&packing.diameter),
        };
        assert_eq!(tetrahedra(&Triangulation::new(&scaled).unwrap()), base);
    }
}

#[test]
fn hidden_grains_and_duplicates_are_named() {
    let mut packing = random(300, Cell::Periodic([5.0; 3]), [5.0; 3], [0.4, 0.5], 9);
    let grain = [packing.x[17], packing.y[17], packing.z[17]];
    for (dx, diameter) in [(0.0, packing.diameter[17]), (0.01, 0.1), (0.0, 0.2)] {
        packing.x.push(grain[0] + dx);
        packing.y.push(grain[1]);
        packing.z.push(grain[2]);
        packing.diameter.push(diameter);
    }
    let t = Triangulation::new(&packing).unwrap();
    assert_eq!(t.sanity_check(), Ok(()));
    // Either of two equal grains may remain.
    let gone = if t.hidden().contains(&17) { 17 } else { 300 };
    for hidden in [gone, 301, 302] {
        assert!(t.hidden().contains(&hidden), "{:?}", t.hidden());
    }
    assert_eq!(t.duplicates(), [[gone, 317 - gone], [302, 317 - gone]]);
}

#[test]
fn what_has_no_triangulation_is_refused() {
    let cell = Cell::Periodic([5.0; 3]);
    let good = random(50, cell, [5.0; 3], [0.4, 0.5], 10);
    let refused = |change: &dyn Fn(&mut Packing)| {
        let mut packing = good.clone();
        change(&mut packing);
        Triangulation::new(&packing).unwrap_err().to_string()
    };
    let message = refused(&|p| p.cell = Cell::Periodic([5.0, 0.9, 5.0]));
    assert!(message.contains("0.9 mm along y") && message.contains("twice"), "{message}");
    assert!(refused(&|p| p.cell = Cell::Periodic([5.0, f64::NAN, 5.0])).contains("along y"));
    assert!(refused(&|p| p.x[3] = f64::INFINITY).contains("grain 3: x = inf"));
    assert!(refused(&|p| p.diameter[7] = -1.0).contains("grain 7: diameter = -1"));
    assert!(refused(&|p| p.y.truncate(9)).contains("column y has 9 rows"));
    assert!(
        refused(&|p| {
            p.x.truncate(3);
            p.y.truncate(3);
            p.z.truncate(3);
            p.diameter.truncate(3);
        })
        .contains("at least 4")
    );
    assert!(
        refused(&|p| {
            p.cell = Cell::Free;
            p.z.fill(1.25);
        })
        .contains("one plane")
    );
}

/// A triangulation broken on purpose fails the check.
#[test]
fn a_broken_triangulation_is_noticed() {
    let packing = random(200, Cell::Periodic([5.0; 3]), [5.0; 3], [0.4, 0.5], 11);
    let good = Triangulation::new(&packing).unwrap();
    let mut turned = good.clone();
    turned.mesh.corners[5].swap(0, 1);
    turned.mesh.neighbours[5].swap(0, 1);
    assert!(turned.sanity_check().is_err());
    let mut lost = good.clone();
    lost.mesh.neighbours[8][2] = 0;
    assert_eq!(lost.sanity_check(), Err(SanityError::Facet { tetrahedron: 8, facet: 2 }));
    let mut heavy = good.clone();
    heavy.points.at[3][3] *= 40.0;
    assert!(matches!(heavy.sanity_check(), Err(SanityError::Irregular { .. })));
}
