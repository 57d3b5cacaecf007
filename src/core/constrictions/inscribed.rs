//! Estimates a filter's constrictions from its gradation alone, by circles inscribed between touching grains.
//!
//! After an idea of Silveira: the grains around a constriction are drawn from the gradation and placed
//! in a plane so that they touch. *Dense*: three touch each other, and the constriction is the circle
//! between them. *Loose*: four touch in a ring that is opened until the area between them is largest,
//! and the constriction is the largest circle in it. Each grain is drawn with a probability proportional
//! to its surface. In between, diameters at the same percentage are interpolated by relative density;
//! linear interpolation is this program's choice.
//!
//! Only three or four grains of the packing are considered. In a widely graded filter coarse grains meet
//! through many fine ones, and fine grains hide in the gaps between coarse ones, so the estimate gets
//! worse the wider the gradation: `results/packing.md` gives the errors of its Dc50 against the
//! triangulation of the same filters.

use super::curve::{Curve, CurveError, CurveUnit};
use super::discs::circle;
use crate::gradation::Gradation;
use crate::stream::{Key, Purpose, unit};
use rand::Rng;
use std::collections::VecDeque;
use std::f64::consts::PI;
use std::sync::{Arc, Mutex, PoisonError};

/// Number of constrictions drawn for a curve.
const DRAWS: usize = 8_000;

/// Number of sizes that represent a gradation.
const SIZES: usize = 4000;

/// Number of steps to find the angle of a ring.
const STEPS: usize = 34;

/// Makes the constriction curve (mm, by number) of touching grains of this gradation, at a relative
/// density from 0 (loose) to 1 (dense). A pan fraction is left out.
///
/// ```
/// use voidwalk_core::{constrictions::inscribed, gradation::Gradation};
/// let equal = Gradation::single(2.0).unwrap();
/// let dc = |density| inscribed(&equal, density).unwrap().dc(50.0).unwrap();
/// assert!((dc(1.0) - 2.0 * 0.154_701).abs() < 1e-5, "three grains");
/// assert!((dc(0.0) - 2.0 * 0.414_214).abs() < 1e-5, "four grains in a square");
/// ```
///
/// # Errors
/// Never, for a gradation with a known size.
pub fn inscribed(gradation: &Gradation, relative_density: f64) -> Result<Curve, CurveError> {
    let drawn = Drawn::cached(Sizes::new(gradation));
    let (dense, loose) = (&drawn.dense, &drawn.loose);
    let density = relative_density.clamp(0.0, 1.0);
    let last = (DRAWS - 1) as f64;
    let points: Vec<(f64, f64)> = (0..=400)
        .map(|k| {
            let percent = 0.25 * f64::from(k);
            let i = (percent / 100.0 * last) as usize;
            (percent, density * dense[i] + (1.0 - density) * loose[i])
        })
        .collect();
    Curve::from_points(&points, CurveUnit::Mm)
}

/// Diameters of the constrictions drawn for a gradation, ascending; all densities share the draws.
struct Drawn {
    sizes: Sizes,
    dense: Vec<f64>,
    loose: Vec<f64>,
}

/// Filters of the latest requests. Drawing takes most of the time of a small case, and a check, a run or
/// a search asks several times for the same filter, at its own density and at both ends of the range.
static KEPT: Mutex<VecDeque<Arc<Drawn>>> = Mutex::new(VecDeque::new());

/// Number of filters kept, of 200 kB each: enough for one comparison.
const KEPT_FILTERS: usize = 8;

impl Drawn {
    /// Returns the cached constrictions, or draws them; no thread waits for another filter to be drawn.
    fn cached(sizes: Sizes) -> Arc<Self> {
        let kept = || KEPT.lock().unwrap_or_else(PoisonError::into_inner);
        let known = kept().iter().find(|drawn| drawn.sizes == sizes).cloned();
        known.unwrap_or_else(|| {
            let drawn = Arc::new(Self::new(sizes));
            let mut kept = kept();
            kept.push_front(Arc::clone(&drawn));
            kept.truncate(KEPT_FILTERS);
            drawn
        })
    }

    fn new(sizes: Sizes) -> Self {
        let mut generator =
            Key { seed: 1, purpose: Purpose::Inscribed, run: 0, increment: 0, chunk: 0 }.generator();
        let (mut dense, mut loose) = (Vec::with_capacity(DRAWS), Vec::with_capacity(DRAWS));
        for _ in 0..DRAWS {
            let radius: [f64; 4] = std::array::from_fn(|_| 0.5 * sizes.draw(unit(generator.next_u64())));
            dense.push(2.0 * between_three([radius[0], radius[1], radius[2]]));
            loose.push(2.0 * between_four(radius));
        }
        dense.sort_by(f64::total_cmp);
        loose.sort_by(f64::total_cmp);
        Self { sizes, dense, loose }
    }
}

/// Sizes (mm) of a gradation, and the cumulative sum of their surfaces.
#[derive(PartialEq)]
struct Sizes {
    diameter: Vec<f64>,
    surface: Vec<f64>,
}

impl Sizes {
    fn new(gradation: &Gradation) -> Self {
        let percent = |i: usize| 100.0 * (i as f64 + 0.5) / SIZES as f64;
        let diameter: Vec<f64> = (0..SIZES).filter_map(|i| gradation.d(percent(i))).collect();
        // All sizes have the same mass, so the surface of each is proportional to 1 / D.
        let mut sum = 0.0;
        let surface = diameter
            .iter()
            .map(|d| {
                sum += 1.0 / d;
                sum
            })
            .collect();
        Self { diameter, surface }
    }

    fn draw(&self, u: f64) -> f64 {
        let total = self.surface[self.surface.len() - 1];
        let i = self.surface.partition_point(|&s| s < u * total);
        self.diameter[i.min(self.diameter.len() - 1)]
    }
}

/// Radius of the circle between three circles that touch each other (Descartes).
fn between_three(radius: [f64; 3]) -> f64 {
    let [a, b, c] = radius.map(|r| 1.0 / r);
    1.0 / (a + b + c + 2.0 * (a * b + b * c + c * a).sqrt())
}

/// Radius of the largest circle inside four circles that touch in a ring, opened until the enclosed area
/// is largest.
fn between_four(radius: [f64; 4]) -> f64 {
    let [a, b, c, d] = radius;
    // The angle at `a` runs from the contact of `b` and `d` to the contact of `a` and `c`.
    let (ab, ad) = (a + b, a + d);
    let least = angle(ab, ad, b + d);
    let most = angle(ab, a + c, b + c) + angle(ad, a + c, c + d);
    // Golden-section search for the only maximum of the area.
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = (least, most);
    let (mut x, mut y) = (high - golden * (high - low), low + golden * (high - low));
    let (mut at_x, mut at_y) = (area_between(radius, x), area_between(radius, y));
    for _ in 0..STEPS {
        if at_x < at_y {
            (low, x, at_x) = (x, y, at_y);
            y = low + golden * (high - low);
            at_y = area_between(radius, y);
        } else {
            (high, y, at_y) = (y, x, at_x);
            x = high - golden * (high - low);
            at_x = area_between(radius, x);
        }
    }
    let ring = ring(radius, 0.5 * (low + high));
    let mut largest = 0.0_f64;
    for left_out in 0..4 {
        let three: [[f64; 3]; 3] = std::array::from_fn(|k| ring[(left_out + 1 + k) % 4]);
        let Some(inner) = circle(&three) else { continue };
        let [x, y, r] = ring[left_out];
        let gap = libm::hypot(inner.centre[0] - x, inner.centre[1] - y) - r - inner.radius;
        if gap >= -1e-9 * inner.radius {
            largest = largest.max(inner.radius);
        }
    }
    // If, by rounding, no circle fits, use the circle of the three smallest.
    if largest > 0.0 {
        return largest;
    }
    let mut sorted = radius;
    sorted.sort_by(f64::total_cmp);
    between_three([sorted[0], sorted[1], sorted[2]])
}

/// Angle between sides `p` and `q` of a triangle whose third side is `opposite`.
fn angle(p: f64, q: f64, opposite: f64) -> f64 {
    libm::acos(((p * p + q * q - opposite * opposite) / (2.0 * p * q)).clamp(-1.0, 1.0))
}

/// Centres and radii of the ring with this angle at the first circle.
fn ring([a, b, c, d]: [f64; 4], at_a: f64) -> [[f64; 3]; 4] {
    let (ab, ad) = (a + b, a + d);
    let (dx, dy) = (ad * libm::cos(at_a), ad * libm::sin(at_a));
    let diagonal = libm::hypot(dx - ab, dy);
    // c lies beyond the diagonal from b to d.
    let turn = angle(diagonal, b + c, c + d);
    let (ux, uy) = ((dx - ab) / diagonal, dy / diagonal);
    let (cos, sin) = (libm::cos(turn), libm::sin(turn));
    let (cx, cy) = (ab + (b + c) * (ux * cos + uy * sin), (b + c) * (uy * cos - ux * sin));
    [[0.0, 0.0, a], [ab, 0.0, b], [cx, cy, c], [dx, dy, d]]
}

/// Area between the four circles of a ring.
fn area_between(radius: [f64; 4], at_a: f64) -> f64 {
    let [a, b, c, d] = radius;
    let at = ring(radius, at_a);
    let twice: f64 = (0..4)
        .map(|k| {
            let (p, q) = (at[k], at[(k + 1) % 4]);
            p[0] * q[1] - q[0] * p[1]
        })
        .sum();
    let ac = libm::hypot(at[2][0], at[2][1]);
    let bd = libm::hypot(at[3][0] - at[1][0], at[3][1] - at[1][1]);
    let at_b = angle(a + b, b + c, ac);
    let at_c = angle(b + c, c + d, bd);
    let at_d = 2.0 * PI - at_a - at_b - at_c;
    let sectors: f64 =
        [(a, at_a), (b, at_b), (c, at_c), (d, at_d)].into_iter().map(|(r, angle)| 0.5 * r * r * angle).sum();
    0.5 * twice - sectors
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_touches_and_its_area_is_largest() {
        assert!((between_three([1.0, 1.0, 10.0]) - 0.233_052).abs() < 1e-6);
        // Equal grains: `2 / sqrt(3) - 1` between three, `sqrt(2) - 1` between four.
        assert!((between_three([1.0; 3]) - 0.154_700_538).abs() < 1e-9);
        assert!((between_four([1.0; 4]) - 0.414_213_562).abs() < 1e-6);
        for radius in [[1.0, 2.0, 1.5, 3.0], [1.0, 1.0, 4.0, 1.0], [2.0, 1.0, 1.0, 8.0]] {
            let circle = between_four(radius);
            let smallest = radius.iter().fold(f64::MAX, |m: f64, &r| m.min(r));
            assert!(circle > 0.15 * smallest && circle < radius.iter().fold(0.0, |m: f64, &r| m.max(r)));
            let r = ring(radius, 1.2);
            for k in 0..4 {
                let (p, q) = (r[k], r[(k + 1) % 4]);
                assert!((libm::hypot(p[0] - q[0], p[1] - q[1]) - p[2] - q[2]).abs() < 1e-9, "{radius:?}");
            }
        }
    }

    #[test]
    fn the_loose_state_is_coarser_and_densities_lie_between() {
        let filter = Gradation::linear_from_d0(1.0, 1.5).unwrap();
        let dc = |density, percent| inscribed(&filter, density).unwrap().dc(percent).unwrap();
        for percent in [1.0, 50.0, 99.0] {
            assert!(dc(0.0, percent) > dc(0.5, percent) && dc(0.5, percent) > dc(1.0, percent));
        }
        assert!(dc(1.0, 0.0) >= 0.154_700 && dc(1.0, 100.0) <= 2.25 * 0.154_701);
    }
}
