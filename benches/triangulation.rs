//! Time to triangulate a packing and to measure its constrictions, in microseconds a grain.
//!
//! `cargo bench --bench triangulation -- [PACKING ...] [--grains FILE] [--tetrahedra FILE]`: packings from
//! files (CSV or LAMMPS dump), or else 10,000 grains at random. Goal: within twice CGAL's time for the
//! same packing with its images, which `scripts/peers/compare_triangulation.sh` measures beside it. For that
//! comparison `--grains` writes the last packing, wrapped into its cell, as CSV, and `--tetrahedra` its
//! tetrahedra, a line each.

use std::fmt::Write;
use std::time::Instant;
use voidwalk::constrictions::{Constrictions, DEFAULT_MERGE_OVERLAP, Facets, Triangulation};
use voidwalk::packing::{Cell, Packing};
use voidwalk::stream::{Key, Purpose, unit};

const REPEATS: usize = 9;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut packings = Vec::new();
    let (mut grains, mut output) = (None, None);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            // Argument that cargo itself passes on.
            "--bench" => {}
            "--grains" => grains = arguments.next(),
            "--tetrahedra" => output = arguments.next(),
            path => packings.push((path.to_string(), Packing::read(path)?)),
        }
    }
    if packings.is_empty() {
        packings.push(("at random".into(), random()));
    }
    for (name, packing) in &mut packings {
        wrap(packing);
        if let Some(path) = &grains {
            std::fs::write(path, packing.to_csv())?;
        }
        let packing = &*packing;
        let (triangulating, t) = fastest(|| Triangulation::new(packing))?;
        let (measuring, _) =
            fastest(|| Constrictions::from_triangulation(&t, DEFAULT_MERGE_OVERLAP, Facets::All))?;
        t.sanity_check()?;
        let per_grain = |seconds: f64| 1e6 * seconds / packing.diameter.len() as f64;
        println!(
            "{name}: {} grains, {} tetrahedra; triangulate {triangulating:.4} s ({:.2} us a grain), measure \
             {measuring:.4} s ({:.2} us a grain)",
            packing.diameter.len(),
            t.tetrahedra(),
            per_grain(triangulating),
            per_grain(measuring),
        );
        if let Some(path) = &output {
            std::fs::write(path, tetrahedra(&t))?;
        }
    }
    Ok(())
}

/// Shortest of several times (s), and a result.
fn fastest<T, E>(mut work: impl FnMut() -> Result<T, E>) -> Result<(f64, T), E> {
    let mut timed = || {
        let start = Instant::now();
        work().map(|made| (start.elapsed().as_secs_f64(), made))
    };
    let (mut best, mut result) = timed()?;
    for _ in 1..REPEATS {
        let (seconds, made) = timed()?;
        best = best.min(seconds);
        result = made;
    }
    Ok((best, result))
}

fn wrap(packing: &mut Packing) {
    if let Cell::Periodic(lengths) = packing.cell {
        for (column, length) in [&mut packing.x, &mut packing.y, &mut packing.z].into_iter().zip(lengths) {
            for value in column {
                *value -= (*value / length).floor() * length;
            }
        }
    }
}

/// A line for each tetrahedron: grain and shift of each corner, relative to the least, ascending.
fn tetrahedra(t: &Triangulation) -> String {
    let mut lines: Vec<String> = (0..t.tetrahedra())
        .map(|i| {
            let mut corners: Vec<(u32, [i32; 3])> = t.corners(i).into_iter().zip(t.images(i)).collect();
            corners.sort_unstable();
            let first = corners[0].1;
            corners.iter().fold(String::new(), |mut line, (grain, image)| {
                let [x, y, z] = std::array::from_fn(|axis| image[axis] - first[axis]);
                let _ = write!(line, "{grain} {x} {y} {z} ");
                line
            })
        })
        .collect();
    lines.sort_unstable();
    lines.join("\n") + "\n"
}

fn random() -> Packing {
    use rand::Rng;
    let mut rng = Key { seed: 1, purpose: Purpose::Packing, run: 0, increment: 0, chunk: 0 }.generator();
    let mut column = |low: f64, high: f64| -> Vec<f64> {
        (0..10_000).map(|_| low + (high - low) * unit(rng.next_u64())).collect()
    };
    let (x, y, z) = (column(0.0, 20.0), column(0.0, 20.0), column(0.0, 20.0));
    Packing { cell: Cell::Periodic([20.0; 3]), x, y, z, diameter: column(0.5, 1.2) }
}
