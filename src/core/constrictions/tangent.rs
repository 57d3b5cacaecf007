//! Circles and spheres that touch given ones from outside.
//!
//! Seen from the centre of the smallest grain (radius `r0`), a centre `q` at distance `s = rho + r0`
//! touches grain `k` (centre `d`, radius `r0 + delta`) when `d.q + s delta = (|d|^2 - delta^2) / 2`:
//! linear in `q` and `s`. So `q = A + B s`, and `|q| = s` is a quadratic. Differences of squares are
//! taken as products, so that a grain of one in a gap of grains of a million keeps its digits.

/// A tangent circle or sphere: its centre and radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tangent<const N: usize> {
    pub(super) centre: [f64; N],
    pub(super) radius: f64,
}

fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(super) fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `(|d|^2 - delta^2) / 2`.
fn half_power<const N: usize>(d: &[f64; N], delta: f64) -> f64 {
    let length = dot(d, d).sqrt();
    0.5 * (length - delta) * (length + delta)
}

/// Distance `s` of `A + B s` from the origin that equals `s`: the smaller positive root. This root changes
/// smoothly with the sizes; a larger one, if any, comes in from infinity (a sphere that holds the grains on
/// its other side).
fn distance<const N: usize>(a: &[f64; N], b: &[f64; N]) -> Option<f64> {
    let (square, half, constant) = (dot(b, b) - 1.0, dot(a, b), dot(a, a));
    let discriminant = half * half - square * constant;
    if discriminant < 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    let s = if half <= 0.0 { constant / (root - half) } else { (-half - root) / square };
    (s.is_finite() && s > 0.0).then_some(s)
}

/// Finds the sphere that touches four grains (centre and radius each); `None` if they leave no such room.
pub(super) fn sphere(grains: &[[f64; 4]; 4]) -> Option<Tangent<3>> {
    let first = least(grains.map(|g| g[3]));
    let origin = grains[first];
    let others = [1, 2, 3].map(|k| grains[(first + k) % 4]);
    let d = others.map(|g| [g[0] - origin[0], g[1] - origin[1], g[2] - origin[2]]);
    let delta = others.map(|g| g[3] - origin[3]);
    let normals = [cross(&d[1], &d[2]), cross(&d[2], &d[0]), cross(&d[0], &d[1])];
    let volume = dot(&d[0], &normals[0]);
    let solve = |right: [f64; 3]| -> [f64; 3] {
        std::array::from_fn(|axis| (0..3).map(|k| right[k] * normals[k][axis]).sum::<f64>() / volume)
    };
    let a = solve(std::array::from_fn(|k| half_power(&d[k], delta[k])));
    let b = solve(delta.map(|delta| -delta));
    let s = distance(&a, &b)?;
    let centre = std::array::from_fn(|axis| origin[axis] + (a[axis] + b[axis] * s));
    (s > origin[3]).then_some(Tangent { centre, radius: s - origin[3] })
}

/// Finds the circle that touches three circles (centre and radius each); `None` if they leave no room.
pub(super) fn circle(circles: &[[f64; 3]; 3]) -> Option<Tangent<2>> {
    let first = least(circles.map(|c| c[2]));
    let origin = circles[first];
    let others = [1, 2].map(|k| circles[(first + k) % 3]);
    let d = others.map(|c| [c[0] - origin[0], c[1] - origin[1]]);
    let delta = others.map(|c| c[2] - origin[2]);
    let area = d[0][0] * d[1][1] - d[1][0] * d[0][1];
    let solve = |right: [f64; 2]| -> [f64; 2] {
        [(right[0] * d[1][1] - right[1] * d[0][1]) / area, (right[1] * d[0][0] - right[0] * d[1][0]) / area]
    };
    let a = solve([half_power(&d[0], delta[0]), half_power(&d[1], delta[1])]);
    let b = solve(delta.map(|delta| -delta));
    let s = distance(&a, &b)?;
    let centre = [origin[0] + (a[0] + b[0] * s), origin[1] + (a[1] + b[1] * s)];
    (s > origin[2]).then_some(Tangent { centre, radius: s - origin[2] })
}

fn least<const N: usize>(values: [f64; N]) -> usize {
    (1..N).fold(0, |best, i| if values[i] < values[best] { i } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Three circles that touch each other.
    fn touching(r: [f64; 3]) -> [[f64; 3]; 3] {
        let (ab, ac, bc) = (r[0] + r[1], r[0] + r[2], r[1] + r[2]);
        let x = (ab * ab + (r[0] - r[1]) * (ac + bc)) / (2.0 * ab);
        // Heron, in the form that keeps the digits of thin triangles.
        let area = (r[0] * r[1] * r[2] * (r[0] + r[1] + r[2])).sqrt();
        [[0.0, 0.0, r[0]], [ab, 0.0, r[1]], [x, 2.0 * area / ab, r[2]]]
    }

    /// Known geometry: three equal grains 0.154701 of their diameter; radii of wide ratios.
    #[test]
    fn known_discs() {
        for (r, expected) in [
            ([0.5, 0.5, 0.5], 0.154_701 / 2.0),
            ([1.0, 1.0, 10.0], 0.233_052),
            ([1.0, 10.0, 10.0], 0.472_475),
            ([1.0, 1e6, 1e6], 0.997_178),
            ([1e6, 1.0, 1e6], 0.997_178),
            ([1e6, 1e6, 1.0], 0.997_178),
        ] {
            let radius = circle(&touching(r)).unwrap().radius;
            assert!((radius / expected - 1.0).abs() < 3e-6, "{r:?}: {radius}");
        }
    }

    proptest! {
        /// Descartes: 1/r4 = k1 + k2 + k3 + 2 sqrt(k1 k2 + k2 k3 + k3 k1).
        #[test]
        fn touching_circles_obey_descartes(a in -3.0..3.0, b in -3.0..3.0, c in -3.0..3.0) {
            let r = [a, b, c].map(|e: f64| libm::pow(10.0, e));
            let k = r.map(|r| 1.0 / r);
            let pairs = k[0] * k[1] + k[1] * k[2] + k[2] * k[0];
            let expected = 1.0 / (k[0] + k[1] + k[2] + 2.0 * pairs.sqrt());
            let radius = circle(&touching(r)).unwrap().radius;
            prop_assert!((radius / expected - 1.0).abs() < 1e-8, "{r:?}: {radius} {expected}");
        }

        /// A tangent sphere is at its radius from all four grains.
        #[test]
        fn a_tangent_sphere_touches(
            v in prop::collection::vec(0.0..10.0, 12), r in prop::collection::vec(0.1..1.0, 4)) {
            let grains: [[f64; 4]; 4] = std::array::from_fn(|i| [v[3 * i], v[3 * i + 1], v[3 * i + 2], r[i]]);
            if let Some(tangent) = sphere(&grains) && tangent.radius < 1e3 {
                for g in grains {
                    let d: [f64; 3] = std::array::from_fn(|axis| g[axis] - tangent.centre[axis]);
                    let gap = dot(&d, &d).sqrt() - g[3] - tangent.radius;
                    prop_assert!(gap.abs() < 1e-6 * (1.0 + tangent.radius), "{gap}");
                }
            }
        }
    }

    /// Eight touching grains at the corners of a cube leave (sqrt 3 - 1) of their diameter.
    #[test]
    fn simple_cubic_insphere() {
        let corner = |x, y, z| [x, y, z, 0.5];
        let tangent = sphere(&[
            corner(0.0, 0.0, 0.0),
            corner(1.0, 0.0, 0.0),
            corner(0.0, 1.0, 0.0),
            corner(0.0, 0.0, 1.0),
        ]);
        let tangent = tangent.unwrap();
        assert!((2.0 * tangent.radius - 0.732_051).abs() < 1e-6);
        assert!(tangent.centre.iter().all(|c| (c - 0.5).abs() < 1e-12));
    }
}
