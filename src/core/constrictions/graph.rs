//! The void graph of a packing: voids, the constrictions between them, and their conductances.

use rayon::prelude::*;

use super::measure::{Constrictions, ConstrictionsError, Facets, Passages, merged};
use super::throat::{Throat, power_centre, solid_angle};
use super::triangulation::{GrainPoint, Positions, Shift, Triangulation};
use super::voids::{Insphere, Voids};
use crate::packing::Packing;

/// Least distance of two void points, as a part of the smallest grain: a path of no length would conduct
/// without limit.
const LEAST_WAY: f64 = 0.05;

/// The voids of a periodic packing and the constrictions between them, as a graph that repeats in x, y and z.
///
/// Constriction `c` is constriction `c` of the [`Constrictions`] that it was measured with: it leads from
/// void `from[c]` in the cell to void `to[c]` in the cell that is shifted by `shift[c]`, and back.
///
/// ```
/// use voidwalk_core::constrictions::VoidGraph;
/// use voidwalk_core::packing::{Cell, Packing};
/// // Simple cubic: 3 x 3 x 3 touching grains of 1 mm.
/// let along = |stride: usize| (0..27).map(|i| (i / stride % 3) as f64).collect();
/// let packing = Packing {
///     cell: Cell::Periodic([3.0; 3]),
///     x: along(1), y: along(3), z: along(9),
///     diameter: vec![1.0; 27],
/// };
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
    /// Shift of that other void in cells along x, y, z, by constriction.
    pub shift: Vec<[i32; 3]>,
    /// Diameter (mm) by constriction.
    pub diameter_mm: Vec<f64>,
    /// Conductance times viscosity (mm3) by constriction.
    pub conductance_mm3: Vec<f64>,
    /// Centre (mm) of the largest tangent sphere by void, inside the cell.
    pub point_mm: Vec<[f64; 3]>,
    /// Volume outside the grains (mm3) by void.
    pub volume_mm3: Vec<f64>,
    /// Number of grains that take part.
    pub grains: usize,
    /// Sum of their diameters cubed (mm3).
    pub cubes_mm3: f64,
    /// Sauter mean of the grains, sum d^3 / sum d^2 (mm).
    pub d32_mm: f64,
    /// Smallest grain (mm).
    pub d0_mm: f64,
    /// Porosity: volume of the voids over the cell's.
    pub porosity: f64,
}

impl VoidGraph {
    /// Triangulates a packing and measures its constrictions and its graph.
    ///
    /// # Errors
    /// Errors of [`Constrictions::measure`]; a packing without a periodic cell, or whose grains do not fit
    /// their cell; a void that meets itself through the cell.
    pub fn measure(
        packing: &Packing,
        merge_overlap: f64,
    ) -> Result<(Constrictions, Self), ConstrictionsError> {
        let t = Triangulation::new(packing)?;
        let voids = merged(&t, merge_overlap)?;
        let passages = Passages::new(&t, &t.positions(), &voids, Facets::All);
        let constrictions = Constrictions::between(&t, &voids, &passages, merge_overlap, Facets::All);
        // Checked first, or an error of the cell would appear as one of the graph.
        constrictions.check()?;
        Ok((constrictions, Self::between(&t, &voids, &passages, merge_overlap)?))
    }

    /// Makes the graph of a triangulation.
    ///
    /// # Errors
    /// A triangulation without a periodic cell; a void that meets itself through the cell.
    pub fn of(t: &Triangulation, merge_overlap: f64) -> Result<Self, ConstrictionsError> {
        let voids = merged(t, merge_overlap)?;
        let passages = Passages::new(t, &t.positions(), &voids, Facets::All);
        Self::between(t, &voids, &passages, merge_overlap)
    }

    /// Makes the graph of a triangulation's voids and of all facets between them.
    fn between(
        t: &Triangulation,
        voids: &Voids,
        passages: &Passages,
        merge_overlap: f64,
    ) -> Result<Self, ConstrictionsError> {
        let cell = t.cell().ok_or(ConstrictionsError::NoCell)?;
        let positions = t.positions();
        if let Some(void) = voids.endless.iter().position(|&endless| endless) {
            return Err(ConstrictionsError::Endless { void: void as u32, merge_overlap });
        }
        let unit = t.unit_mm();
        let smallest = t.spheres().iter().map(|s| s[3]).fold(f64::INFINITY, f64::min);
        let points = void_points(t, &positions, voids);
        let folds: Vec<Shift> = points.iter().map(|p| fold(p, &cell)).collect();
        let centres = power_centres(t, &positions, voids);
        let mut graph = Self {
            cell_mm: cell.map(|l| l * unit),
            from: Vec::new(),
            to: Vec::new(),
            shift: Vec::new(),
            diameter_mm: Vec::new(),
            conductance_mm3: Vec::new(),
            point_mm: (points.iter().zip(&folds))
                .map(|(p, &fold)| place(&moved(p, &positions.displacement(fold)), t))
                .collect(),
            volume_mm3: volumes(t, &positions, voids, unit),
            grains: 0,
            cubes_mm3: 0.0,
            d32_mm: 0.0,
            d0_mm: 2.0 * smallest * unit,
            porosity: 0.0,
        };
        graph.weigh(t);
        for passage in &passages.open {
            let (i, k) = passage.facet;
            let Some((u, _, across)) = t.across(i, k) else { continue };
            let (a, b) = (voids.by_tetrahedron[i] as usize, voids.by_tetrahedron[u] as usize);
            // Place of the far void if the near one is at its own place, and then its place in the cell.
            let by = voids.shift[i].plus(across).minus(voids.shift[u]);
            let far = moved(&points[b], &positions.displacement(by));
            let length = distance(&points[a], &far).max(LEAST_WAY * 2.0 * smallest);
            let corners = t.at(&positions, i, Shift::ZERO);
            let facet = [1, 2, 3].map(|e| corners[(k + e) % 4]);
            let other = moved(&centres[u], &positions.displacement(across));
            let throat = Throat::new(&facet, &corners[k], [&centres[i], &other]);
            let conductance = throat.conductance(length) * unit * unit * unit;
            match graph.conductance_mm3.get_mut(passage.constriction) {
                Some(sum) => *sum += conductance,
                None => {
                    graph.from.push(a as u32);
                    graph.to.push(b as u32);
                    graph.shift.push(by.plus(folds[a]).minus(folds[b]).cells());
                    graph.diameter_mm.push(2.0 * passage.radius * unit);
                    graph.conductance_mm3.push(conductance);
                }
            }
        }
        Ok(graph)
    }

    /// Sums over the grains.
    fn weigh(&mut self, t: &Triangulation) {
        let unit = t.unit_mm();
        let (mut squares, mut cubes) = (0.0, 0.0);
        for (grain, s) in (0u32..).zip(t.spheres()) {
            if t.hidden().binary_search(&grain).is_err() {
                let d = 2.0 * s[3] * unit;
                self.grains += 1;
                squares += d * d;
                cubes += d * d * d;
            }
        }
        let [x, y, z] = self.cell_mm;
        self.cubes_mm3 = cubes;
        self.d32_mm = cubes / squares;
        self.porosity = 1.0 - std::f64::consts::PI / 6.0 * cubes / (x * y * z);
    }

    /// Number of voids.
    pub fn voids(&self) -> usize {
        self.point_mm.len()
    }

    /// Edge of the mean void's cube (mm): the thickness of a layer.
    pub fn spacing_mm(&self) -> f64 {
        let [x, y, z] = self.cell_mm;
        libm::cbrt(x * y * z / self.voids() as f64)
    }

    /// Permeability (mm2) by Kozeny and Carman: `n^3 d32^2 / (180 (1 - n)^2)` with n the porosity.
    pub fn kozeny_carman_mm2(&self) -> f64 {
        let (n, solid) = (self.porosity, 1.0 - self.porosity);
        n * n * n * self.d32_mm * self.d32_mm / (180.0 * solid * solid)
    }

    /// Writes the graph as CSV: `from,to,shift_x,shift_y,shift_z,diameter_mm,conductance_mm3`, where the
    /// conductance is multiplied by the viscosity.
    pub fn to_csv(&self) -> String {
        use std::fmt::Write;
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

fn distance(p: &[f64; 3], q: &[f64; 3]) -> f64 {
    let d: [f64; 3] = std::array::from_fn(|axis| p[axis] - q[axis]);
    (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt()
}

/// Shift in cells that moves a point into the cell.
fn fold(p: &[f64; 3], cell: &[f64; 3]) -> Shift {
    Shift::new(std::array::from_fn(|axis| -libm::floor(p[axis] / cell[axis]) as i32))
}

/// A point of the cell, in mm.
fn place(p: &[f64; 3], t: &Triangulation) -> [f64; 3] {
    let origin = t.origin_mm();
    std::array::from_fn(|axis| p[axis] * t.unit_mm() + origin[axis])
}

/// Centre of the largest tangent sphere of each void, beside the stored translate of its first tetrahedron; a
/// void without one has a corner of that tetrahedron.
fn void_points(t: &Triangulation, positions: &Positions<'_>, voids: &Voids) -> Vec<[f64; 3]> {
    let mut largest = vec![-1.0; voids.count];
    let mut points = vec![[0.0; 3]; voids.count];
    for (i, insphere) in voids.inspheres.iter().enumerate() {
        let void = voids.by_tetrahedron[i] as usize;
        let (radius, centre) = match insphere {
            Insphere::Sphere(s) => (s.radius, s.centre),
            _ => {
                let [x, y, z, _] = t.at(positions, i, Shift::ZERO)[0];
                (0.0, [x, y, z])
            }
        };
        if radius > largest[void] {
            largest[void] = radius;
            points[void] = moved(&centre, &positions.displacement(voids.shift[i]));
        }
    }
    points
}

/// Power centre of each tetrahedron, in its stored translate. For four grains on a circle it is ill-defined:
/// the centre of the neighbour in the same void replaces it.
fn power_centres(t: &Triangulation, positions: &Positions<'_>, voids: &Voids) -> Vec<[f64; 3]> {
    let by_tetrahedron: Vec<[f64; 3]> = (0..t.tetrahedra())
        .into_par_iter()
        .with_min_len(1024)
        .map(|i| power_centre(&t.at(positions, i, Shift::ZERO)))
        .collect();
    let mut centres = by_tetrahedron.clone();
    for i in (0..by_tetrahedron.len()).filter(|&i| voids.inspheres[i] == Insphere::Flat) {
        let beside = (0..4).filter_map(|k| t.across(i, k)).find(|&(u, _, shift)| {
            voids.by_tetrahedron[u] == voids.by_tetrahedron[i]
                && voids.inspheres[u] != Insphere::Flat
                && voids.shift[i].plus(shift) == voids.shift[u]
        });
        if let Some((u, _, shift)) = beside {
            centres[i] = moved(&by_tetrahedron[u], &positions.displacement(shift));
        }
    }
    centres
}

/// Volume of each void outside the grains (mm3); 0 if overlaps make the sum negative.
fn volumes(t: &Triangulation, positions: &Positions<'_>, voids: &Voids, unit_mm: f64) -> Vec<f64> {
    let mut volumes = vec![0.0; voids.count];
    for i in 0..t.tetrahedra() {
        volumes[voids.by_tetrahedron[i] as usize] +=
            water(&t.at(positions, i, Shift::ZERO)) * unit_mm * unit_mm * unit_mm;
    }
    volumes.iter_mut().for_each(|volume| *volume = volume.max(0.0));
    volumes
}

/// Volume of a tetrahedron outside its grains.
fn water(c: &[GrainPoint; 4]) -> f64 {
    let edges = |a: usize| {
        [1, 2, 3].map(|k| -> [f64; 3] { std::array::from_fn(|axis| c[(a + k) % 4][axis] - c[a][axis]) })
    };
    let [e, f, g] = edges(0);
    let normal = super::tangent::cross(&f, &g);
    let six = (e[0] * normal[0] + e[1] * normal[1] + e[2] * normal[2]).abs();
    let solid: f64 = (0..4).map(|a| solid_angle(&edges(a), six) * c[a][3] * c[a][3] * c[a][3] / 3.0).sum();
    six / 6.0 - solid
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::packing::Cell;
    use crate::stream::{Key, Purpose, unit};
    use rand::Rng;

    /// Grains of several sizes on a disturbed lattice.
    fn packing() -> Packing {
        let mut rng = Key { seed: 3, purpose: Purpose::Packing, run: 0, increment: 0, chunk: 0 }.generator();
        let mut random = || unit(rng.next_u64());
        let n = 6usize;
        let mut packing =
            Packing { cell: Cell::Periodic([6.0; 3]), x: vec![], y: vec![], z: vec![], diameter: vec![] };
        for i in 0..n * n * n {
            packing.x.push((i % n) as f64 + 0.06 * random());
            packing.y.push((i / n % n) as f64 + 0.06 * random());
            packing.z.push((i / n / n) as f64 + 0.06 * random());
            packing.diameter.push(0.9 + 0.1 * random());
        }
        packing
    }

    /// Bipyramids fill the voids, and their solid angles go once round every grain.
    #[test]
    fn throats_sum_to_all_water_and_all_surface() {
        let packing = packing();
        let t = Triangulation::new(&packing).unwrap();
        let positions = t.positions();
        let voids = Voids::merge(&t, &positions, 0.1);
        let centres = power_centres(&t, &positions, &voids);
        let (mut volume, mut surface) = (0.0, 0.0);
        for (i, k) in (0..t.tetrahedra()).flat_map(|i| (0..4).map(move |k| (i, k))) {
            let (u, _, across) = t.across(i, k).unwrap();
            let corners = t.at(&positions, i, Shift::ZERO);
            let facet = [1, 2, 3].map(|e| corners[(k + e) % 4]);
            let other = moved(&centres[u], &positions.displacement(across));
            let throat = Throat::new(&facet, &corners[k], [&centres[i], &other]);
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
        // Cubes that merged with no other are next to each other.
        let alone = |void: u32| graph.volume_mm3[void as usize] < 0.7;
        let mut seen = 0;
        for c in (0..graph.from.len()).filter(|&c| alone(graph.from[c]) && alone(graph.to[c])) {
            let (p, q) = (graph.point_mm[graph.from[c] as usize], graph.point_mm[graph.to[c] as usize]);
            let far: [f64; 3] = std::array::from_fn(|axis| q[axis] + 6.0 * f64::from(graph.shift[c][axis]));
            assert!((0.5..1.5).contains(&distance(&p, &far)), "{c}: {}", distance(&p, &far));
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
}
