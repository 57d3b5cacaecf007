//! Finds a filter's constrictions in a library of packings, by interpolation between the curves of
//! similar gradations.
//!
//! `src/core/data/library.csv` holds packings of gradations of many shapes, each dense (friction 0),
//! medium (0.1) and loose (0.3), made by `scripts/studies/library_of_packings.py`. It contains no
//! lengths: sizes are in units of `S50`, the size that divides the surface of the grains in half.
//!
//! Grains that touch form the constrictions, and grains meet by surface. So six numbers describe a
//! shape, `ln(S/S50)` of the sizes below which 5, 20, 30, 70, 80 and 95 % of the surface lie; these and
//! the relative density give a place in the library. Each percentile of the curve is `ln(Dc/S50)`: a
//! trend, linear in the shape and quadratic in the density, plus a Gaussian process that draws it
//! towards nearby measurements (universal kriging; Rasmussen & Williams 2006, section 2.7). Grains per
//! void and void ratio are found in the same way.

use super::curve::{Curve, CurveError, CurveUnit};
use crate::gradation::Gradation;
use libm::{exp, log, sqrt};
use multiversion::multiversion;
use std::sync::OnceLock;

const TABLE: &str = include_str!("../data/library.csv");

/// Percentages of the surface whose sizes describe a shape, besides 50 %.
const SHAPE: [f64; 6] = [5.0, 20.0, 30.0, 70.0, 80.0, 95.0];
/// Number of coordinates of a place: those of the shape, and the relative density.
const PLACE: usize = SHAPE.len() + 1;
/// Number of terms of the trend: 1, each coordinate, the square of the density, and its product with
/// each coordinate of the shape.
const TREND: usize = 1 + PLACE + 1 + SHAPE.len();
/// Distance at which two places are still correlated.
const REACH: f64 = 0.7;
/// Variance of the scatter of a packing over that of the process.
const SCATTER: f64 = 0.05;
/// Ridge that keeps the trend from being singular if the library is small.
const RIDGE: f64 = 1e-6;
/// Relative errors of the library, by distance to its nearest shape: for constrictions from Dc5 to Dc95,
/// and for grains per void. At least nine in ten of the packings whose shape was left out were within
/// both (`results/library.md`). A shape at a larger distance resembles no shape of the library.
const ERRORS: [LibraryError; 3] = [
    LibraryError { up_to: 0.2, curve: 0.03, grains: 0.06 },
    LibraryError { up_to: 0.35, curve: 0.10, grains: 0.25 },
    LibraryError { up_to: 0.7, curve: 0.13, grains: 0.75 },
];

/// Errors for shapes whose nearest shape in the library is within the distance `up_to`.
struct LibraryError {
    up_to: f64,
    curve: f64,
    grains: f64,
}

/// A filter's values from the library.
#[derive(Clone, Debug, PartialEq)]
pub struct FromLibrary {
    /// The constriction curve (mm), by number.
    pub curve: Curve,
    /// Number of grains of the filter per void.
    pub grains_per_void: f64,
    /// Volume of the voids over the volume of the grains.
    pub void_ratio: f64,
    /// Relative error of the curve, for shapes outside the library.
    pub curve_error: f64,
    /// Relative error of the grains per void, for the same shapes.
    pub grains_error: f64,
}

/// Finds the constrictions of a filter from its gradation, at a relative density from 0 (loose) to 1
/// (dense). A pan fraction is left out. `None` for a shape that resembles no shape of the library.
///
/// ```
/// use voidwalk_core::{constrictions::from_library, gradation::Gradation};
/// let filter = Gradation::linear_from_d0(1.0, 1.5)?;
/// let [loose, dense] = [0.0, 1.0].map(|density| from_library(&filter, density).unwrap().unwrap());
/// assert!(loose.curve.dc(50.0) > dense.curve.dc(50.0));
/// # Ok::<(), voidwalk_core::gradation::GradationError>(())
/// ```
///
/// # Errors
/// Never, for a gradation with a known size.
pub fn from_library(gradation: &Gradation, relative_density: f64) -> Result<Option<FromLibrary>, CurveError> {
    static LIBRARY: OnceLock<Library> = OnceLock::new();
    LIBRARY.get_or_init(|| Library::fitted(packings(TABLE))).filter(gradation, relative_density)
}

struct Shipped {
    place: [f64; PLACE],
    /// Logarithms of the curve's percentiles over `S50`, of grains per void, and of the void ratio.
    measured: Vec<f64>,
}

/// Percentages of the curve, from the header of the table.
fn percentages() -> Vec<f64> {
    let head = TABLE.lines().find(|line| !line.starts_with('#')).unwrap_or_default();
    head.split(',').filter_map(|name| name.strip_prefix("dc")?.parse().ok()).collect()
}

/// Reads the table: number of the shape, Cu, relative density, grains per void, void ratio, the sizes by
/// surface, and the curve.
fn packings(table: &str) -> Vec<Shipped> {
    let rows = table.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    rows.map(|line| {
        let numbers: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        let place = std::array::from_fn(|k| if k == SHAPE.len() { numbers[2] } else { log(numbers[5 + k]) });
        let curve = numbers[5 + SHAPE.len()..].iter().chain(&numbers[3..5]).map(|value| log(*value));
        Shipped { place, measured: curve.collect() }
    })
    .collect()
}

struct Library {
    places: Vec<[f64; PLACE]>,
    /// Coefficients of the trend, for each measured number.
    trend: Vec<[f64; TREND]>,
    /// Weights of the places, for each measured number.
    weights: Vec<Vec<f64>>,
}

impl Library {
    fn fitted(packings: Vec<Shipped>) -> Self {
        let places: Vec<_> = packings.iter().map(|packing| packing.place).collect();
        let n = places.len();
        let covariance: Vec<Vec<f64>> = (0..n)
            .map(|i| {
                (0..=i).map(|j| near(&places[i], &places[j]) + if i == j { SCATTER } else { 0.0 }).collect()
            })
            .collect();
        let root = root_of(covariance);
        let terms: Vec<[f64; TREND]> = places.iter().map(terms).collect();
        let by_term: Vec<Vec<f64>> =
            (0..TREND).map(|t| solve(&root, terms.iter().map(|row| row[t]).collect())).collect();
        let normal: Vec<Vec<f64>> = (0..TREND)
            .map(|t| {
                (0..=t).map(|u| column(&terms, t, &by_term[u]) + if t == u { RIDGE } else { 0.0 }).collect()
            })
            .collect();
        let normal = root_of(normal);
        let (mut trend, mut weights) = (Vec::new(), Vec::new());
        for k in 0..packings.first().map_or(0, |packing| packing.measured.len()) {
            let mut values: Vec<f64> = packings.iter().map(|packing| packing.measured[k]).collect();
            let right = by_term.iter().map(|solution| product(solution, &values)).collect();
            let factors = solve(&normal, right);
            let factors: [f64; TREND] = std::array::from_fn(|t| factors[t]);
            for (value, terms) in values.iter_mut().zip(&terms) {
                *value -= product(terms, &factors);
            }
            trend.push(factors);
            weights.push(solve(&root, values));
        }
        Self { places, trend, weights }
    }

    fn filter(&self, gradation: &Gradation, density: f64) -> Result<Option<FromLibrary>, CurveError> {
        let half_mm = by_surface(gradation, 50.0);
        let place = std::array::from_fn(|k| match SHAPE.get(k) {
            Some(share) => log(by_surface(gradation, *share) / half_mm),
            None => density.clamp(0.0, 1.0),
        });
        let nearest = self.distance(&place);
        let Some(error) = ERRORS.iter().find(|error| nearest < error.up_to) else { return Ok(None) };
        let values = self.at(&place);
        let (curve, rest) = values.split_at(values.len() - 2);
        let mut size = 0.0f64;
        let points: Vec<(f64, f64)> = percentages()
            .into_iter()
            .zip(curve)
            .map(|(percent, value)| {
                // Each percentile is predicted alone, but the curve must never fall.
                size = size.max(half_mm * value);
                (percent, size)
            })
            .collect();
        Ok(Some(FromLibrary {
            curve: Curve::from_points(&points, CurveUnit::Mm)?,
            grains_per_void: rest[0],
            void_ratio: rest[1],
            curve_error: error.curve,
            grains_error: error.grains,
        }))
    }

    /// Distance to the nearest shape, at any density.
    fn distance(&self, place: &[f64; PLACE]) -> f64 {
        let far = |other: &[f64; PLACE]| sqrt(square(&place[..SHAPE.len()], &other[..SHAPE.len()]));
        self.places.iter().map(far).fold(f64::INFINITY, f64::min)
    }

    /// Expected measurements at a place.
    fn at(&self, place: &[f64; PLACE]) -> Vec<f64> {
        let terms = terms(place);
        let near: Vec<f64> = self.places.iter().map(|other| near(place, other)).collect();
        let sums = self.trend.iter().zip(&self.weights);
        sums.map(|(trend, weights)| exp(product(&terms, trend) + product(&near, weights))).collect()
    }
}

/// Size (mm) below which this percentage of the grains' surface lies.
fn by_surface(gradation: &Gradation, percent: f64) -> f64 {
    let (mut low, mut high) = (log(gradation.smallest_mm()), log(gradation.largest_mm()));
    for _ in 0..52 {
        let middle = 0.5 * (low + high);
        match 100.0 * (1.0 - gradation.surface_coarser_than(exp(middle))) < percent {
            true => low = middle,
            false => high = middle,
        }
    }
    exp(0.5 * (low + high))
}

fn square(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

fn near(a: &[f64; PLACE], b: &[f64; PLACE]) -> f64 {
    exp(-0.5 * square(a, b) / (REACH * REACH))
}

fn terms(place: &[f64; PLACE]) -> [f64; TREND] {
    let density = place[SHAPE.len()];
    std::array::from_fn(|t| match t {
        0 => 1.0,
        t if t <= PLACE => place[t - 1],
        t if t == PLACE + 1 => density * density,
        t => density * place[t - PLACE - 2],
    })
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn column(terms: &[[f64; TREND]], t: usize, values: &[f64]) -> f64 {
    terms.iter().zip(values).map(|(terms, value)| terms[t] * value).sum()
}

/// Cholesky factor of a positive definite matrix; both are stored as the rows of their lower triangles.
fn root_of(rows: Vec<Vec<f64>>) -> Root {
    let mut root = Root { columns: rows.iter().map(|_| Vec::with_capacity(rows.len())).collect(), rows };
    for i in 0..root.rows.len() {
        let (above, below) = root.rows.split_at_mut(i);
        let row = &mut below[0];
        eliminate(&root.columns[..i], above, &mut row[..i]);
        let sum: f64 = row[..i].iter().map(|a| a * a).sum();
        row[i] = sqrt(row[i] - sum);
        for (column, value) in root.columns.iter_mut().zip(row.iter()) {
            column.push(*value);
        }
    }
    root
}

/// The lower triangle of a Cholesky factor.
struct Root {
    rows: Vec<Vec<f64>>,
    /// Lower part of each column, from the diagonal down.
    columns: Vec<Vec<f64>>,
}

/// Solves the lower triangle for `right`, one equation after another.
#[multiversion(targets("x86_64+avx+avx2+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx+avx2"))]
fn eliminate(columns: &[Vec<f64>], rows: &[Vec<f64>], right: &mut [f64]) {
    // -0.0 is the neutral start of a sum.
    let mut sums = vec![-0.0; right.len()];
    for (i, column) in columns.iter().enumerate() {
        right[i] = (right[i] - sums[i]) / rows[i][i];
        let known = right[i];
        sums[i + 1..].iter_mut().zip(&column[1..]).for_each(|(sum, a)| *sum += a * known);
    }
}

fn solve(root: &Root, mut right: Vec<f64>) -> Vec<f64> {
    eliminate(&root.columns, &root.rows, &mut right);
    for (i, row) in root.rows.iter().enumerate().rev() {
        right[i] /= row[i];
        let known = right[i];
        right[..i].iter_mut().zip(row).for_each(|(right, a)| *right -= a * known);
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A packing, and the prediction by a library that was not fitted to it.
    struct Predicted {
        cu: f64,
        density: f64,
        distance: f64,
        /// Relative errors of the percentiles, grains per void and void ratio.
        errors: Vec<f64>,
    }

    impl Predicted {
        fn new(library: &Library, packing: &Shipped, cu: f64) -> Self {
            let values = library.at(&packing.place).into_iter().zip(&packing.measured);
            Self {
                cu,
                density: packing.place[SHAPE.len()],
                distance: library.distance(&packing.place),
                errors: values.map(|(value, measured)| value / exp(*measured) - 1.0).collect(),
            }
        }

        /// Largest error from Dc5 to Dc95.
        fn of_curve(&self) -> f64 {
            let inner = percentages().into_iter().zip(&self.errors);
            let inner = inner.filter(|(percent, _)| (5.0..=95.0).contains(percent));
            inner.map(|(_, error)| error.abs()).fold(0.0, f64::max)
        }

        fn of_grains(&self) -> f64 {
            self.errors[percentages().len()]
        }
    }

    /// Shape and Cu of each packing of the library.
    fn shapes() -> Vec<(usize, f64)> {
        let rows = TABLE.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
        rows.map(|line| {
            let mut cells = line.split(',');
            (cells.next().unwrap().parse().unwrap(), cells.next().unwrap().parse().unwrap())
        })
        .collect()
    }

    /// Predicts the packings of the shapes for which `is_out` holds, from a library of the others.
    fn left_out(is_out: impl Fn(usize) -> bool) -> Vec<Predicted> {
        let (out, others): (Vec<_>, Vec<_>) =
            shapes().into_iter().zip(packings(TABLE)).partition(|((shape, _), _)| is_out(*shape));
        let library = Library::fitted(others.into_iter().map(|(_, packing)| packing).collect());
        out.iter().map(|((_, cu), packing)| Predicted::new(&library, packing, *cu)).collect()
    }

    /// Prints the errors for `results/library.md`: `cargo test --release library -- --nocapture`.
    #[test]
    fn nine_in_ten_packings_whose_shape_is_not_in_the_library_lie_as_near_as_it_says() {
        let all_shapes: std::collections::BTreeSet<usize> =
            shapes().into_iter().map(|(shape, _)| shape).collect();
        let all: Vec<Predicted> =
            all_shapes.into_iter().flat_map(|out| left_out(|shape| shape == out)).collect();
        let percent = percentages();
        let columns: Vec<(String, usize)> = [5.0, 15.0, 50.0, 75.0, 95.0]
            .iter()
            .map(|wanted| {
                (format!("Dc{wanted}"), percent.iter().position(|percent| percent == wanted).unwrap())
            })
            .chain([("grains per void".into(), percent.len()), ("void ratio".into(), percent.len() + 1)])
            .collect();
        let table = |name: &str, is_in: &dyn Fn(&Predicted) -> bool| {
            let cases: Vec<&Predicted> = all.iter().filter(|case| is_in(case)).collect();
            let cells = columns.iter().map(|(_, k)| {
                let mut sizes: Vec<f64> = cases.iter().map(|case| 100.0 * case.errors[*k].abs()).collect();
                sizes.sort_by(f64::total_cmp);
                let at = |share: f64| sizes[((sizes.len() as f64 - 1.0) * share).round() as usize];
                format!("{:.1} ({:.1}, {:.0})", at(0.5), at(0.9), at(1.0))
            });
            println!("| {name} | {} | {} |", cases.len(), cells.collect::<Vec<_>>().join(" | "));
        };
        let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
        println!("| packings | number | {} |", names.join(" | "));
        table("all", &|_| true);
        for [low, high] in [[1.0, 2.0], [2.0, 5.0], [5.0, 10.0], [10.0, 31.0]] {
            table(&format!("Cu {low} to {high}"), &|case| (low..high).contains(&case.cu));
        }
        for (name, density) in [("loose", 0.0), ("medium", 0.5), ("dense", 1.0)] {
            table(name, &|case| case.density == density);
        }
        // From Dc5 to Dc95 together, for each range of distances with a stated error.
        let mut nearer = 0.0;
        for LibraryError { up_to, curve, grains } in ERRORS {
            let cases: Vec<&Predicted> =
                all.iter().filter(|case| (nearer..up_to).contains(&case.distance)).collect();
            let far = cases.iter().filter(|case| case.of_curve() > curve).count();
            let of_grains = cases.iter().filter(|case| case.of_grains().abs() > grains).count();
            println!(
                "nearest shape at {nearer} to {up_to}, of {}: curves of {far} beyond {curve}, grains per \
                 void of {of_grains} beyond {grains}",
                cases.len()
            );
            assert!(10 * far.max(of_grains) <= cases.len(), "at {nearer} to {up_to}: {far}, {of_grains}");
            nearer = up_to;
        }
    }

    /// Packed by `scripts/studies/library_held_out.py`; the library was never fitted to them. The error
    /// of grains per void in the farthest band was raised from 65 to 75 % because of one of them.
    #[test]
    fn packings_that_were_never_fitted_lie_as_near_as_it_says() {
        let table = concat!(env!("CARGO_MANIFEST_DIR"), "/../../results/library-held-out.csv");
        let library = Library::fitted(packings(TABLE));
        let mut beyond = [[0; 3]; ERRORS.len()];
        for packing in packings(&std::fs::read_to_string(table).unwrap()) {
            let case = Predicted::new(&library, &packing, f64::NAN);
            let band = ERRORS.iter().position(|error| case.distance < error.up_to).unwrap();
            let LibraryError { curve, grains, .. } = &ERRORS[band];
            let is_beyond = [true, case.of_curve() > *curve, case.of_grains().abs() > *grains];
            beyond[band].iter_mut().zip(is_beyond).for_each(|(count, is)| *count += usize::from(is));
        }
        println!("packings, curves beyond and grains per void beyond, by band: {beyond:?}");
        assert!(beyond.iter().all(|[all, curves, grains]| *all >= 8 && 10 * curves.max(grains) <= *all));
    }

    /// Broad filters are packed without their coarser fraction; the finer one resembles narrower filters.
    #[test]
    fn the_shapes_before_them_say_the_broad_ones() {
        const BEFORE: usize = 126;
        let broad = left_out(|shape| shape >= BEFORE);
        let most = broad.iter().map(Predicted::of_curve).fold(0.0, f64::max);
        assert!(broad.len() == 39 && most < 0.02, "{most}");
    }

    #[test]
    fn the_library_holds_enough_and_scales() {
        assert!(packings(TABLE).len() >= 400);
        let small = Gradation::linear_from_d0(0.5, 3.0).unwrap();
        let [of_small, of_large] = [small.clone(), small.scaled(20.0).unwrap()]
            .map(|filter| from_library(&filter, 0.5).unwrap().unwrap());
        let by = |percent| of_large.curve.dc(percent).unwrap() / of_small.curve.dc(percent).unwrap();
        assert!((by(5.0) - 20.0).abs() < 1e-9 && (by(95.0) - 20.0).abs() < 1e-9);
        assert!((of_large.grains_per_void / of_small.grains_per_void - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_shape_like_no_other_is_not_answered() {
        // Half of the surface belongs to dust, half to boulders.
        let dust_and_boulders = [(0.001, 0.0), (0.0011, 0.1), (1.0, 0.1), (1.1, 100.0)];
        let filter = Gradation::from_points(&dust_and_boulders, None).unwrap();
        assert_eq!(from_library(&filter, 0.0).unwrap(), None);
    }
}
