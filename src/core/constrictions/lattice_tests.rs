//! Lattices, exact and disturbed: known sizes and counts.

use super::{Constrictions, ConstrictionsError, Facets, Triangulation, TriangulationError};
use crate::packing::{Cell, Packing, uniform};

/// Grains of a lattice: a basis in a box of given lengths, repeated, all of the same diameter.
struct Lattice {
    name: &'static str,
    basis: Vec<[f64; 3]>,
    lengths: [f64; 3],
    repeat: [usize; 3],
    /// Constriction over grain diameter, and constrictions per grain.
    size: f64,
    per_grain: usize,
}

/// All lattices, with grains of diameter 1 that touch.
fn lattices() -> Vec<Lattice> {
    let (root2, root3, root6) = (2f64.sqrt(), 3f64.sqrt(), 6f64.sqrt());
    let scaled = |points: &[[f64; 3]], by: [f64; 3]| -> Vec<[f64; 3]> {
        points.iter().map(|p| std::array::from_fn(|axis| p[axis] * by[axis])).collect()
    };
    let fcc = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]];
    let bcc = [[0.0; 3], [0.5; 3]];
    // Orthorhombic cell of hexagonal close packing: 1 x sqrt 3 x 2 sqrt(2/3).
    let hcp_lengths = [1.0, root3, 2.0 * root6 / 3.0];
    let hcp = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 1.0 / 6.0, 0.5], [0.0, 2.0 / 3.0, 0.5]];
    let lattice = |name, basis, lengths, repeat, size, per_grain| Lattice {
        name,
        basis: scaled(basis, lengths),
        lengths,
        repeat,
        size,
        per_grain,
    };
    let size = 2.0 / root3 - 1.0;
    vec![
        lattice("simple cubic", &[[0.0; 3]], [1.0; 3], [4, 5, 6], root2 - 1.0, 3),
        lattice("FCC", &fcc, [root2; 3], [3, 4, 2], size, 8),
        lattice("HCP", &hcp, hcp_lengths, [4, 3, 2], size, 8),
        lattice("BCC", &bcc, [2.0 / root3; 3], [3, 4, 3], 0.224_745, 12),
    ]
}

fn measure(packing: &Packing) -> Constrictions {
    Constrictions::measure(packing, 0.1).unwrap()
}

impl Lattice {
    /// Places the scaled lattice in a periodic box, with axes rotated `turn` times and each centre moved
    /// by up to `jitter`.
    fn periodic(&self, scale: f64, jitter: f64, turn: usize) -> Packing {
        let [nx, ny, nz] = self.repeat;
        let lengths = [nx as f64 * self.lengths[0], ny as f64 * self.lengths[1], nz as f64 * self.lengths[2]];
        let (mut columns, mut cell) = (self.centres(jitter), lengths);
        columns.rotate_left(turn);
        cell.rotate_left(turn);
        let [x, y, z] = columns.map(|c| c.into_iter().map(|v| v * scale).collect::<Vec<_>>());
        let diameter = vec![scale; x.len()];
        Packing { cell: Cell::Periodic(cell.map(|l| l * scale)), x, y, z, diameter }
    }

    fn centres(&self, jitter: f64) -> [Vec<f64>; 3] {
        let mut u = uniform(5, self.per_grain as u64);
        let mut columns = [Vec::new(), Vec::new(), Vec::new()];
        for i in 0..self.repeat[0] {
            for j in 0..self.repeat[1] {
                for k in 0..self.repeat[2] {
                    for p in &self.basis {
                        for (axis, n) in [i, j, k].into_iter().enumerate() {
                            let moved = jitter * (2.0 * u() - 1.0);
                            columns[axis].push(p[axis] + n as f64 * self.lengths[axis] + moved);
                        }
                    }
                }
            }
        }
        columns
    }

    fn check(&self, packing: &Packing, scale: f64, tolerance: f64, case: &str) {
        let measured = measure(packing);
        let grains = packing.diameter.len();
        assert_eq!(measured.constrictions(), self.per_grain * grains, "{} {case}", self.name);
        for &d in &measured.diameter_mm {
            let error = d / scale / self.size - 1.0;
            assert!(error.abs() < tolerance, "{} {case}: {d}, {error:e}", self.name);
        }
        assert_eq!(measured.closed, 0);
    }
}

#[test]
fn lattices_have_their_sizes_and_counts_jittered_too() {
    let scales = [1.0, 1e-6, 1e-3, 0.1, 7.3, 1e6].map(|scale| (scale, 0.0, 2e-6));
    let jitters = [(1.0, 1e-16, 2e-6), (1.0, 1e-12, 2e-6), (1.0, 1e-6, 5e-5)];
    for lattice in lattices() {
        for (scale, jitter, tolerance) in scales.into_iter().chain(jitters) {
            for turn in 0..3 {
                let case = format!("scale {scale:e}, jitter {jitter:e}, turned {turn} times");
                lattice.check(&lattice.periodic(scale, jitter, turn), scale, tolerance, &case);
            }
        }
    }
}

/// A lattice turned by an arbitrary angle fits no periodic box: it becomes a free packing, and in its
/// inner region every size equals the lattice's.
#[test]
fn rotated_lattices_keep_their_sizes() {
    let (c, s) = (0.8, 0.6);
    for mut lattice in lattices() {
        lattice.repeat = lattice.lengths.map(|l| libm::ceil(7.0 / l) as usize);
        for jitter in [0.0, 1e-12, 1e-6] {
            let [x, y, z] = lattice.centres(jitter);
            let turned = |p: &[f64], q: &[f64], a: f64, b: f64| -> Vec<f64> {
                p.iter().zip(q).map(|(p, q)| a * p + b * q).collect()
            };
            let (x, y) = (turned(&x, &y, c, -s), turned(&x, &y, s, c));
            let (y, z) = (turned(&y, &z, c, -s), turned(&y, &z, s, c));
            let diameter = vec![1.0; x.len()];
            let packing = Packing { cell: Cell::Free, x, y, z, diameter };
            let measured = measure(&packing);
            // At the hull tetrahedra stretch along its faces; the middle is unaffected.
            let middle = |axis: usize, column: &[f64]| {
                let (low, high) = column.iter().fold((f64::MAX, f64::MIN), |(a, b), &v| (a.min(v), b.max(v)));
                (axis, 0.5 * (low + high))
            };
            let middle = [middle(0, &packing.x), middle(1, &packing.y), middle(2, &packing.z)];
            let inner: Vec<f64> = measured
                .centre_mm
                .iter()
                .zip(&measured.diameter_mm)
                .filter(|(p, _)| middle.iter().all(|&(axis, m)| (p[axis] - m).abs() < 1.2))
                .map(|(_, &d)| d)
                .collect();
            assert!(inner.len() > 20, "{}", lattice.name);
            for d in inner {
                assert!((d / lattice.size - 1.0).abs() < 5e-5, "{} {jitter:e}: {d}", lattice.name);
            }
        }
    }
}

/// A factor of two on all lengths changes no bit.
#[test]
fn a_factor_of_two_changes_no_bit() {
    for lattice in lattices() {
        let base = measure(&lattice.periodic(1.0, 1e-3, 0));
        for factor in [0.25, 1024.0, 2f64.powi(-60)] {
            let scaled = measure(&lattice.periodic(factor, 1e-3, 0));
            let back = |d: &[f64]| -> Vec<f64> { d.iter().map(|d| d / factor).collect() };
            assert_eq!(back(&scaled.diameter_mm), base.diameter_mm);
            assert_eq!(back(&scaled.void_diameter_mm), base.void_diameter_mm);
            assert_eq!((&scaled.upstream, &scaled.downstream), (&base.upstream, &base.downstream));
            assert_eq!(scaled.void_ratio.to_bits(), base.void_ratio.to_bits());
        }
    }
}

/// Cubes meet six others; octahedra (one per grain) meet eight tetrahedra (two per grain), which meet four.
#[test]
fn voids_and_their_connectivity() {
    let all = lattices();
    let cubic = measure(&all[0].periodic(1.0, 0.0, 0));
    assert_eq!(cubic.connectivity(), [0, 0, 0, 0, 0, 0, 120]);
    assert_eq!((cubic.grains_per_void(), cubic.mean_connectivity()), (1.0, 6.0));
    assert!((cubic.void_ratio - (6.0 / std::f64::consts::PI - 1.0)).abs() < 1e-12);
    assert!(cubic.void_diameter_mm.iter().all(|d| (d - 0.732_051).abs() < 1e-6));
    let fcc = measure(&all[1].periodic(1.0, 0.0, 0));
    assert_eq!(fcc.connectivity(), [0, 0, 0, 0, 192, 0, 0, 0, 96]);
    // Each constriction leads up: the windows of a cubic cell along x and y have no direction along z.
    for c in 0..cubic.constrictions() {
        let z = |v: u32| cubic.void_centre_mm[v as usize][2];
        let rise = z(cubic.downstream[c]) - z(cubic.upstream[c]);
        assert!(rise.abs() < 1e-9 || (rise - 1.0).abs() < 1e-9 || (rise + 5.0).abs() < 1e-9, "{rise}");
    }
}

/// The middle of a free simple cubic block, without the outer 5 %, has the lattice's void ratio.
#[test]
fn a_free_block_has_the_void_ratio_of_its_middle() {
    let mut block = lattices().swap_remove(0).periodic(1.0, 0.0, 0);
    block.cell = Cell::Free;
    let measured = measure(&block);
    let ratio = measured.void_ratio;
    assert!((ratio - (6.0 / std::f64::consts::PI - 1.0)).abs() < 1e-9, "{ratio}");
    assert_eq!((measured.grains, measured.voids()), (2 * 3 * 4, 3 * 4 * 5));
}

#[test]
fn grains_that_cannot_be_a_packing_are_refused() {
    let measured = |change: &dyn Fn(&mut Packing)| {
        let mut block = lattices().swap_remove(0).periodic(1.0, 1e-6, 0);
        block.cell = Cell::Free;
        change(&mut block);
        Constrictions::measure(&block, 0.1)
    };
    let checked = |change: &dyn Fn(&mut Packing)| measured(change).unwrap().check();
    let doubts = |factor: f64| {
        let swollen = |p: &mut Packing| p.diameter.iter_mut().for_each(|d| *d *= factor);
        let swollen = measured(&swollen).unwrap();
        (swollen.check().is_ok(), swollen.doubts().len())
    };
    // A simple cubic lattice has 0.91; grains 1.25 times as large fill 0.98 of the volume, 1.26 times
    // all of it.
    assert_eq!([1.0, 0.9, 1.2, 1.26].map(doubts), [(true, 0), (true, 1), (true, 1), (false, 1)]);
    let again = |by: f64| {
        move |p: &mut Packing| {
            for (column, by) in [(&mut p.x, by), (&mut p.y, 0.0), (&mut p.z, 0.0), (&mut p.diameter, 0.0)] {
                column.push(column[20] + by);
            }
        }
    };
    for by in [0.0, 1e-9, 1e-5] {
        let error = checked(&again(by)).unwrap_err();
        assert!(matches!(error, ConstrictionsError::Twice(1, _)), "{error}");
    }
    // Nearer than a quarter of a diameter.
    let near = |by: f64| {
        let doubled = measured(&again(by)).unwrap();
        (doubled.check().is_ok(), doubled.near.len(), doubled.doubts().len())
    };
    assert_eq!([0.002, 0.2].map(near), [(true, 1, 1); 2]);
    assert_eq!(near(0.3).1, 0);
    // Two layers, one in the hollows of the other, level or tilted, smooth or rough, and a third on top.
    for (layers, tilt, rough) in
        [(2, 0.0, 0.0), (2, 0.4, 0.0), (2, 0.0, 0.1), (2, 0.4, 0.1), (3, 0.0, 0.1), (3, 0.4, 0.0)]
    {
        let layer = measured(&|p: &mut Packing| {
            let grains = (0..144 * layers).map(|at| {
                let (i, j, k) = ((at % 12) as f64, (at / 12 % 12) as f64, (at / 144) as f64);
                let x = i + 0.5 * k;
                [x, 0.866 * j + 0.3 * k, 0.8 * k + tilt * x + rough * (at * 7 % 5) as f64 / 5.0, 1.0]
            });
            *p = Packing::from_grains(Cell::Free, grains);
        });
        let refused = matches!(layer.unwrap().check(), Err(ConstrictionsError::Outside));
        assert_eq!(refused, layers == 2, "{layers} {tilt} {rough}");
    }
    // One layer, tilted, and displaced out of its plane by less than a millionth of a diameter.
    for (tilt, off) in [(0.0, 0.0), (0.0, 1e-8), (0.7, 1e-8)] {
        let flat = measured(&|p: &mut Packing| {
            for i in 0..p.x.len() {
                p.z[i] = tilt * p.x[i] - 0.3 * tilt * p.y[i] + off * (i % 7) as f64;
            }
        });
        let flat =
            matches!(flat, Err(ConstrictionsError::Triangulation(TriangulationError::Coplanar { .. })));
        assert!(flat, "{tilt} {off}");
    }
}

#[test]
fn what_is_written_can_be_read() {
    let measured = measure(&lattices()[0].periodic(1.0, 1e-6, 0));
    let summary = serde_json::to_value(measured.summary(Vec::new()).unwrap()).unwrap();
    assert_eq!((&summary["grains"], &summary["voids"]), (&120.into(), &120.into()));
    assert_eq!(summary["connectivity"].as_array().unwrap().len(), 7);
    assert!((summary["dc_mm"]["1.5"].as_f64().unwrap() - 0.414).abs() < 0.01);
    let curve = super::Curve::from_csv_text("f", measured.curve_csv().unwrap().as_bytes()).unwrap();
    assert_eq!(curve, measured.curve().unwrap());
    assert!(measured.to_vtp().contains("Name=\"downstream\""));
}

#[test]
fn a_merge_overlap_that_is_none_is_refused() {
    let packing = lattices()[0].periodic(1.0, 0.0, 0);
    for value in [-0.1, f64::NAN, f64::INFINITY] {
        let error = Constrictions::measure(&packing, value).unwrap_err().to_string();
        assert!(error.contains("merge_overlap"), "{error}");
    }
}

/// The voids of a lattice are convex, so all their facets, including square windows, lie on both hulls.
#[test]
fn on_lattices_every_facet_is_on_both_hulls() {
    for lattice in lattices() {
        for jitter in [0.0, 1e-12, 1e-6] {
            let t = Triangulation::new(&lattice.periodic(1.0, jitter, 0)).unwrap();
            let all = Constrictions::from_triangulation(&t, 0.1, Facets::All).unwrap();
            let hulls = Constrictions::from_triangulation(&t, 0.1, Facets::OnBothHulls).unwrap();
            assert_eq!(all.diameter_mm, hulls.diameter_mm, "{} {jitter:e}", lattice.name);
        }
    }
}

/// A packing of few coarse grains may be a single void.
#[test]
fn a_packing_without_a_constriction_says_so() {
    let mut measured = measure(&lattices()[0].periodic(1.0, 0.0, 0));
    measured.diameter_mm.clear();
    measured.centre_mm.clear();
    let message = measured.curve().unwrap_err().to_string();
    assert!(message.starts_with("the packing has no constriction: its "), "{message}");
}
