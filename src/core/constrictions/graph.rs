//! The void graph of a packing: voids, the constrictions between them, and their conductances.
//!
//! After Chareyre, Cortis, Catalano & Barthelemy (2012), *Pore-scale modeling of viscous flow and
//! induced forces in dense sphere packings*, doi:10.1007/s11242-011-9915-6. A throat is the bipyramid of
//! a facet and the power centres on either side of it. Its hydraulic radius is its volume of water over
//! its surface of grains, `R_h = phi / gamma`, and its conductance is
//!
//! ```text
//! g = A_f R_h^2 / (2 mu L)
//! ```
//! with `A_f` the area of the facet outside the grains and `L` the path between the two voids. Volumes
//! and solid angles are signed: a power centre on the far side of a facet counts as negative. So the
//! sums over all facets are exactly the volume of the voids and the surface of the grains.

use super::discs::solver;
use super::triangulation::{GrainPoint, Shift, Triangulation, cross, dot, edges, facet, offset, six_volume};
use super::voids::{Insphere, Voids, solid_angle};
use super::{Constrictions, ConstrictionsError, Facets, Passages};
use crate::packing::Packing;
use rayon::prelude::*;
use std::fmt::Write;

/// Minimum distance of two void points, over the smallest grain diameter: a path of zero length would
/// have an infinite conductance.
const LEAST_WAY: f64 = 0.05;

/// The voids of a periodic packing and the constrictions between them, as a graph periodic in x, y and z.
///
/// Constriction `c` is also constriction `c` of the [`Constrictions`] measured with it. It leads from
/// void `from[c]` in the cell to void `to[c]` in the cell shifted by `shift[c]`, and back.
///
/// ```
/// use voidwalk_core::constrictions::VoidGraph;
/// use voidwalk_core::packing::{Cell, Packing};
/// // Simple cubic: 3 x 3 x 3 touching grains of 1 mm.
/// let grains = (0..27).map(|i| [i % 3, i / 3 % 3, i / 9, 1].map(f64::from));
/// let packing = Packing::from_grains(Cell::Periodic([3.0; 3]), grains);
/// let (_, graph) = VoidGraph::measure(&packing, 0.1)?;
/// assert_eq!((graph.voids(), graph.from.len()), (27, 81));
/// // A cube's window, with the hydraulic radius of the cube: volume of water over surface of grains.
/// let pi = std::f64::consts::PI;
/// let (window, radius) = (1.0 - pi / 4.0, (1.0 - pi / 6.0) / pi);
/// assert!(graph.conductance_mm3.iter().all(|g| (g / (window * radius * radius / 2.0) - 1.0).abs() < 1e-9));
/// # Ok::<(), voidwalk_core::constrictions::ConstrictionsError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct VoidGraph {
    /// Lengths of the cell (mm).
    pub cell_mm: [f64; 3],
    /// Void in the cell, by constriction.
    pub from: Vec<u32>,
    /// Void on the other side, by constriction.
    pub to: Vec<u32>,
    /// Shift of the void on the other side, in cells along x, y, z, by constriction.
    pub shift: Vec<[i32; 3]>,
    /// Diameter (mm) by constriction.
    pub diameter_mm: Vec<f64>,
    /// Conductance times viscosity (mm3) by constriction.
    pub conductance_mm3: Vec<f64>,
    /// Centre (mm) of the largest tangent sphere by void, inside the cell.
    pub point_mm: Vec<[f64; 3]>,
    /// Volume outside the grains (mm3) by void.
    pub volume_mm3: Vec<f64>,
    pub(crate) grains: usize,
    /// Sum of their diameters cubed (mm3).
    pub cubes_mm3: f64,
    /// Sauter mean of the grains, sum d^3 / sum d^2 (mm).
    pub d32_mm: f64,
    /// Smallest grain (mm).
    pub d0_mm: f64,
    /// Porosity: volume of the voids over the volume of the cell.
    pub(crate) porosity: f64,
}

impl VoidGraph {
    /// Triangulates a packing and measures its constrictions and its graph.
    ///
    /// # Errors
    /// Errors of [`Constrictions::measure`]; a packing without a periodic cell, or with grains that do
    /// not fit their cell; a void that meets itself through the cell.
    pub fn measure(
        packing: &Packing,
        merge_overlap: f64,
    ) -> Result<(Constrictions, Self), ConstrictionsError> {
        let t = Triangulation::new(packing)?;
        let passages = Passages::find(&t, merge_overlap, Facets::All)?;
        let constrictions = Constrictions::between(&t, &passages);
        // Checked first; else an error of the cell would appear as one of the graph.
        constrictions.check()?;
        Ok((constrictions, Self::between(&t, &passages)?))
    }

    /// Makes the graph of a triangulation.
    ///
    /// # Errors
    /// A triangulation without a periodic cell; a void that meets itself through the cell.
    pub fn of(t: &Triangulation, merge_overlap: f64) -> Result<Self, ConstrictionsError> {
        Self::between(t, &Passages::find(t, merge_overlap, Facets::All)?)
    }

    /// Makes the graph of a triangulation's voids and of all facets between them.
    fn between(t: &Triangulation, passages: &Passages) -> Result<Self, ConstrictionsError> {
        let cell = t.cell().ok_or(ConstrictionsError::NoCell)?;
        let voids = &passages.voids;
        if let Some(void) = voids.endless.iter().position(|&endless| endless) {
            return Err(ConstrictionsError::Endless(void as u32, voids.merge_overlap));
        }
        let unit = t.unit_mm();
        let smallest = t.least_radius();
        let points = void_points(t, voids);
        let folds: Vec<Shift> = points.iter().map(|p| fold(p, &cell)).collect();
        let centres = power_centres(t, voids);
        let (mut grains, mut squares, mut cubes) = (0, 0.0, 0.0);
        for d in t.visible().map(|s| 2.0 * s[3] * unit) {
            grains += 1;
            squares += d * d;
            cubes += d * d * d;
        }
        let cell_mm = cell.map(|l| l * unit);
        let [x, y, z] = cell_mm;
        let mut graph = Self {
            cell_mm,
            from: Vec::new(),
            to: Vec::new(),
            shift: Vec::new(),
            diameter_mm: Vec::new(),
            conductance_mm3: Vec::new(),
            point_mm: (points.iter().zip(&folds))
                .map(|(p, &fold)| t.in_mm(moved(p, &t.displacement(fold))))
                .collect(),
            volume_mm3: volumes(t, voids),
            grains,
            cubes_mm3: cubes,
            d32_mm: cubes / squares,
            d0_mm: 2.0 * smallest * unit,
            porosity: 1.0 - std::f64::consts::PI / 6.0 * cubes / (x * y * z),
        };
        for passage in &passages.open {
            let ((i, k), (u, across)) = (passage.facet, passage.across);
            let (a, b) = (voids.by_tetrahedron[i] as usize, voids.by_tetrahedron[u] as usize);
            // Shift of the far void from the near one; below, its shift if the near one is in the cell.
            let by = voids.shift[i].plus(across).minus(voids.shift[u]);
            let path = offset(&points[a], &moved(&points[b], &t.displacement(by)));
            let length = dot(&path, &path).sqrt().max(LEAST_WAY * 2.0 * smallest);
            let throat = Throat::new(t, (i, k), &centres);
            let conductance = throat.conductance(length) * unit * unit * unit;
            match graph.conductance_mm3.get_mut(passage.constriction) {
                Some(sum) => *sum += conductance,
                None => {
                    graph.from.push(a as u32);
                    graph.to.push(b as u32);
                    graph.shift.push(by.plus(folds[a]).minus(folds[b]).cells());
                    graph.diameter_mm.push(2.0 * passage.disc.radius * unit);
                    graph.conductance_mm3.push(conductance);
                }
            }
        }
        Ok(graph)
    }

    /// Number of voids.
    pub fn voids(&self) -> usize {
        self.point_mm.len()
    }

    /// Edge of a cube with the mean volume per void (mm): the thickness of a layer.
    pub fn spacing_mm(&self) -> f64 {
        let [x, y, z] = self.cell_mm;
        libm::cbrt(x * y * z / self.voids() as f64)
    }

    /// Permeability (mm2) by Kozeny and Carman: `n^3 d32^2 / (180 (1 - n)^2)` with porosity n.
    pub fn kozeny_carman_mm2(&self) -> f64 {
        let (n, solid) = (self.porosity, 1.0 - self.porosity);
        n * n * n * self.d32_mm * self.d32_mm / (180.0 * solid * solid)
    }

    /// Writes the graph as CSV: `from,to,shift_x,shift_y,shift_z,diameter_mm,conductance_mm3`, where the
    /// conductance is multiplied by the viscosity.
    pub fn to_csv(&self) -> String {
        let mut text = String::from("from,to,shift_x,shift_y,shift_z,diameter_mm,conductance_mm3\n");
        for c in 0..self.from.len() {
            let [x, y, z] = self.shift[c];
            let (d, g) = (self.diameter_mm[c], self.conductance_mm3[c]);
            // Writing to a String never fails.
            let _ = writeln!(text, "{},{},{x},{y},{z},{d},{g:e}", self.from[c], self.to[c]);
        }
        text
    }
}

fn moved(p: &[f64; 3], by: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| p[axis] + by[axis])
}

/// Shift, in cells, that moves a point into the cell.
fn fold(p: &[f64; 3], cell: &[f64; 3]) -> Shift {
    Shift::new(std::array::from_fn(|axis| -libm::floor(p[axis] / cell[axis]) as i32))
}

/// Centre of the largest tangent sphere of each void, for the stored translate of its first tetrahedron;
/// a void without such a sphere has a corner of that tetrahedron.
fn void_points(t: &Triangulation, voids: &Voids) -> Vec<[f64; 3]> {
    let mut largest = vec![-1.0; voids.count];
    let mut points = vec![[0.0; 3]; voids.count];
    for (i, insphere) in voids.inspheres.iter().enumerate() {
        let void = voids.by_tetrahedron[i] as usize;
        let (radius, centre) = match insphere {
            Insphere::Sphere(s) => (s.radius, s.centre),
            _ => {
                let [x, y, z, _] = t.stored(i)[0];
                (0.0, [x, y, z])
            }
        };
        if radius > largest[void] {
            largest[void] = radius;
            points[void] = moved(&centre, &t.displacement(voids.shift[i]));
        }
    }
    points
}

/// Power centre of each tetrahedron, in its stored translate. For four grains on a circle it is
/// ill-defined, and the centre of the neighbour in the same void is used.
fn power_centres(t: &Triangulation, voids: &Voids) -> Vec<[f64; 3]> {
    let by_tetrahedron: Vec<[f64; 3]> =
        (0..t.tetrahedra()).into_par_iter().with_min_len(1024).map(|i| power_centre(&t.stored(i))).collect();
    let mut centres = by_tetrahedron.clone();
    for i in (0..by_tetrahedron.len()).filter(|&i| voids.inspheres[i] == Insphere::Flat) {
        let beside = (0..4).filter_map(|k| t.across(i, k)).find(|&(u, _, shift)| {
            voids.by_tetrahedron[u] == voids.by_tetrahedron[i]
                && voids.inspheres[u] != Insphere::Flat
                && voids.shift[i].plus(shift) == voids.shift[u]
        });
        if let Some((u, _, shift)) = beside {
            centres[i] = moved(&by_tetrahedron[u], &t.displacement(shift));
        }
    }
    centres
}

/// Volume of each void outside the grains (mm3); 0 if overlaps make the sum negative.
fn volumes(t: &Triangulation, voids: &Voids) -> Vec<f64> {
    let (unit_mm, mut volumes) = (t.unit_mm(), vec![0.0; voids.count]);
    for (i, &void) in voids.by_tetrahedron.iter().enumerate() {
        volumes[void as usize] += water(&t.stored(i)) * unit_mm * unit_mm * unit_mm;
    }
    volumes.iter_mut().for_each(|volume: &mut f64| *volume = volume.max(0.0));
    volumes
}

fn water(c: &[GrainPoint; 4]) -> f64 {
    let six = six_volume(&edges(c, 0));
    let solid: f64 = (0..4).map(|a| solid_angle(&edges(c, a), six) * c[a][3] * c[a][3] * c[a][3] / 3.0).sum();
    six / 6.0 - solid
}

/// Water and grains in the bipyramid of a facet, in grid units.
struct Throat {
    volume: f64,
    surface: f64,
    /// Area of the facet outside its grains.
    area: f64,
}

impl Throat {
    /// Makes the throat of the facet opposite corner `k` of tetrahedron `i`, from the power centres.
    fn new(t: &Triangulation, (i, k): (usize, usize), centres: &[[f64; 3]]) -> Self {
        let (u, _, across) = t.across(i, k).expect("a facet between two tetrahedra");
        let corners = t.stored(i);
        let (facet, inside) = (facet(&corners, k), &corners[k]);
        let here = half(&facet, inside, &centres[i]);
        // The far side's inside is this side's outside.
        let there = half(&facet, inside, &moved(&centres[u], &t.displacement(across)));
        Self { volume: here.0 - there.0, surface: here.1 - there.1, area: open_area(&facet) }
    }

    /// Conductance times viscosity over a path of `length`; zero if the bipyramid holds no water or no grain.
    fn conductance(&self, length: f64) -> f64 {
        if self.volume <= 0.0 || self.surface <= 0.0 {
            return 0.0;
        }
        let radius = self.volume / self.surface;
        self.area * radius * radius / (2.0 * length)
    }
}

/// Volume of water and surface of grains between a facet and a point, positive if the point is on the
/// same side as `inside`.
fn half(facet: &[GrainPoint; 3], inside: &GrainPoint, apex: &[f64; 3]) -> (f64, f64) {
    let (e, f) = (offset(&facet[0], &facet[1]), offset(&facet[0], &facet[2]));
    let normal = cross(&e, &f);
    let six = dot(&normal, &offset(&facet[0], apex));
    let sign = six.signum() * dot(&normal, &offset(&facet[0], inside)).signum();
    let (mut volume, mut surface) = (six.abs() / 6.0, 0.0);
    for k in 0..3 {
        let grain = &facet[k];
        let edges = [&facet[(k + 1) % 3][..], &facet[(k + 2) % 3][..], &apex[..]].map(|q| offset(grain, q));
        let angle = solid_angle(&edges, six.abs());
        let square = grain[3] * grain[3];
        volume -= angle * square * grain[3] / 3.0;
        surface += angle * square;
    }
    (sign * volume, sign * surface)
}

/// Area of a facet minus the sectors of its three grains, each cut at the opposite edge.
fn open_area(facet: &[GrainPoint; 3]) -> f64 {
    let edge = |a: usize, b: usize| offset(&facet[a], &facet[b]);
    let normal = cross(&edge(0, 1), &edge(0, 2));
    let area = 0.5 * dot(&normal, &normal).sqrt();
    let covered: f64 = (0..3)
        .map(|k| {
            let (b, c) = ((k + 1) % 3, (k + 2) % 3);
            let opposite = edge(b, c);
            let along = dot(&opposite, &opposite).sqrt();
            let height = 2.0 * area / along;
            // Angles of the two edges at this grain, from the perpendicular onto the opposite edge.
            let angle = |to: usize| libm::atan2(dot(&edge(k, to), &opposite) / along, height);
            sector(facet[k][3], height, angle(b), angle(c))
        })
        .sum();
    (area - covered).max(0.0)
}

/// Area of a circular sector between two angles from the perpendicular onto a line, cut at that line.
fn sector(radius: f64, height: f64, from: f64, to: f64) -> f64 {
    let reach = if radius > height { libm::acos(height / radius) } else { 0.0 };
    let (cut_from, cut_to) = (from.clamp(-reach, reach), to.clamp(-reach, reach));
    let round = (to - from) - (cut_to - cut_from);
    0.5 * radius * radius * round + 0.5 * height * height * (libm::tan(cut_to) - libm::tan(cut_from))
}

/// Point of equal power to the four grains of a tetrahedron; not finite if they lie in a plane.
fn power_centre(corners: &[GrainPoint; 4]) -> [f64; 3] {
    let origin = corners[0];
    let others = [corners[1], corners[2], corners[3]];
    let d = others.map(|g| offset(&origin, &g));
    let right: [f64; 3] = std::array::from_fn(|k| {
        let delta = others[k][3] - origin[3];
        0.5 * (dot(&d[k], &d[k]) - delta * (others[k][3] + origin[3]))
    });
    moved(&[origin[0], origin[1], origin[2]], &solver(&d)(right))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::packing::{Cell, uniform};

    /// Grains of several sizes on a disturbed lattice.
    fn packing() -> Packing {
        let mut u = uniform(3, 0);
        let grains = (0..216).map(|i| {
            let [x, y, z] = [i, i / 6, i / 36].map(|i| f64::from(i % 6) + 0.06 * u());
            [x, y, z, 0.9 + 0.1 * u()]
        });
        Packing::from_grains(Cell::Periodic([6.0; 3]), grains)
    }

    /// Bipyramids fill the voids, and their solid angles cover every grain exactly once.
    #[test]
    fn throats_sum_to_all_water_and_all_surface() {
        let packing = packing();
        let t = Triangulation::new(&packing).unwrap();
        let centres = power_centres(&t, &Voids::merge(&t, 0.1));
        let (mut volume, mut surface) = (0.0, 0.0);
        for (i, k) in (0..t.tetrahedra()).flat_map(|i| (0..4).map(move |k| (i, k))) {
            let throat = Throat::new(&t, (i, k), &centres);
            // Both sides of a facet count it.
            volume += 0.5 * throat.volume;
            surface += 0.5 * throat.surface;
        }
        let unit = t.unit_mm();
        let pi = std::f64::consts::PI;
        let solid: f64 = packing.diameter.iter().map(|d| pi / 6.0 * d * d * d).sum();
        let all: f64 = packing.diameter.iter().map(|d| pi * d * d).sum();
        assert!((volume * unit * unit * unit / (216.0 - solid) - 1.0).abs() < 1e-9, "{volume}");
        assert!((surface * unit * unit / all - 1.0).abs() < 1e-9, "{surface}");
        let graph = VoidGraph::of(&t, 0.1).unwrap();
        let of_voids: f64 = graph.volume_mm3.iter().sum();
        assert!((of_voids / (216.0 - solid) - 1.0).abs() < 1e-9, "{of_voids}");
        assert!(graph.point_mm.iter().flatten().all(|&x| (0.0..6.0).contains(&x)));
        // Cubes that merged with no other are neighbours.
        let alone = |void: u32| graph.volume_mm3[void as usize] < 0.7;
        let mut seen = 0;
        for c in (0..graph.from.len()).filter(|&c| alone(graph.from[c]) && alone(graph.to[c])) {
            let (p, q) = (graph.point_mm[graph.from[c] as usize], graph.point_mm[graph.to[c] as usize]);
            let far: [f64; 3] = std::array::from_fn(|axis| q[axis] + 6.0 * f64::from(graph.shift[c][axis]));
            let path = offset(&p, &far);
            assert!((0.5..1.5).contains(&dot(&path, &path).sqrt()), "{c}: {path:?}");
            seen += 1;
        }
        assert!(seen > 30, "{seen}");
    }

    /// A graph is refused if voids merge into one that fills the cell: no path through it is known.
    #[test]
    fn a_void_through_the_whole_cell_is_refused() {
        let mut sparse = packing();
        sparse.diameter.iter_mut().for_each(|d| *d *= 0.6);
        let error = VoidGraph::measure(&sparse, 0.0).unwrap_err().to_string();
        assert!(error.contains("runs through the whole cell"), "{error}");
        let free = Packing { cell: Cell::Free, ..packing() };
        assert!(VoidGraph::measure(&free, 0.1).unwrap_err().to_string().contains("periodic cell"));
    }

    /// A grain that reaches beyond the opposite edge covers no more of the facet than there is.
    #[test]
    fn a_sector_ends_at_the_opposite_edge() {
        let long = |r| sector(r, 1.0, -0.4, 0.7);
        let triangle = 0.5 * (libm::tan(0.7) + libm::tan(0.4));
        assert!((long(10.0) - triangle).abs() < 1e-15);
        assert!((long(1.0) - 0.5 * 1.1).abs() < 1e-15);
        // Between the two cases: by quadrature.
        let steps = 100_000;
        let sum: f64 = (0..steps)
            .map(|k| {
                let angle = -0.4 + 1.1 * (f64::from(k) + 0.5) / f64::from(steps);
                let reach = 1.1f64.min(1.0 / libm::cos(angle));
                0.5 * reach * reach * 1.1 / f64::from(steps)
            })
            .sum();
        assert!((long(1.1) - sum).abs() < 1e-9);
        // The perpendicular may fall outside the edge.
        assert!((sector(0.5, 1.0, 0.3, 0.9) - 0.5 * 0.25 * 0.6).abs() < 1e-15);
    }

    #[test]
    fn a_power_centre_has_one_power() {
        let corners =
            [[0.0, 0.0, 0.0, 0.3], [1.0, 0.1, 0.0, 0.5], [0.2, 1.0, 0.3, 0.1], [0.4, 0.3, 1.2, 0.6]];
        let centre = power_centre(&corners);
        let power = corners.map(|c| {
            let d = offset(&c, &centre);
            dot(&d, &d) - c[3] * c[3]
        });
        assert!(power.iter().all(|p| (p - power[0]).abs() < 1e-12), "{power:?}");
    }

    #[test]
    fn an_equilateral_facet_loses_half_a_circle() {
        let h = 3f64.sqrt() / 2.0;
        let facet = [[0.0, 0.0, 0.0, 0.5], [1.0, 0.0, 0.0, 0.5], [0.5, h, 0.0, 0.5]];
        let half_circle = std::f64::consts::PI / 8.0;
        assert!((open_area(&facet) - (0.5 * h - half_circle)).abs() < 1e-15);
    }
}
