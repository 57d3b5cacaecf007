//! Networks of the voids of a packing.

use super::file::unlinked;
use super::flow::system::{CONVERGED, FlowError, System, Together};
use super::undirected::{Link, LinkEnd, LinkedVoids};
use super::{ExitRule, Network, NetworkError};
use crate::constrictions::VoidGraph;

/// Settings for turning a packing's voids into a network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GraphShape {
    /// Number of identical cells in a row along the flow.
    pub copies: u32,
    /// Rule by which particles choose exits.
    pub rule: ExitRule,
    /// Fraction of its conductance that a blocked constriction keeps.
    pub rho: f64,
    /// Length of one unit of diameter (mm).
    pub unit_mm: f64,
}

impl Network {
    /// Builds the network of the voids of a packing, in `copies` identical cells in a row along z,
    /// periodic in x and y: void `v` of copy `k` is void `k N + v`. A constriction that enters the first
    /// copy from outside is an inlet, one that leaves the last copy an outlet. A layer is as thick as the
    /// edge of a cube with the mean volume per void.
    ///
    /// # Errors
    /// Errors of [`Network::linked`], such as no open path through the filter.
    pub fn of_graph(graph: &VoidGraph, shape: GraphShape) -> Result<Self, NetworkError> {
        let (voids, unit) = (graph.voids() as u32, shape.unit_mm);
        let copies = shape.copies;
        let links_in_all = (graph.from.len() as u64 + 1).checked_mul(u64::from(copies) + 1);
        if copies == 0 || links_in_all.is_none_or(|n| n >= u64::from(u32::MAX) / 2) {
            return unlinked(format!(
                "{copies} copies of {voids} voids and {} constrictions are too many",
                graph.from.len()
            ));
        }
        let place = |copy: i64, void: u32| match (0..i64::from(copies)).contains(&copy) {
            true => LinkEnd::Void(copy as u32 * voids + void),
            false => LinkEnd::Outside,
        };
        let mut links = Vec::with_capacity(graph.from.len() * copies as usize);
        let furthest = graph.shift.iter().map(|shift| i64::from(shift[2].abs())).max().unwrap_or(0);
        for copy in -furthest..i64::from(copies) {
            for c in 0..graph.from.len() {
                let along = i64::from(graph.shift[c][2]);
                // Each is taken once, in the direction of the flow.
                let (from, to, along) = match along >= 0 {
                    true => (graph.from[c], graph.to[c], along),
                    false => (graph.to[c], graph.from[c], -along),
                };
                let (from_end, to_end) = (place(copy, from), place(copy + along, to));
                if from_end == LinkEnd::Outside && to_end == LinkEnd::Outside {
                    continue;
                }
                let z = |void: u32| graph.point_mm[void as usize][2];
                links.push(Link {
                    from: from_end,
                    to: to_end,
                    diameter: (graph.diameter_mm[c] / unit) as f32,
                    conductance: graph.conductance_mm3[c],
                    rise: z(to) + along as f64 * graph.cell_mm[2] - z(from),
                });
            }
        }
        let spacing = graph.spacing_mm();
        let [x, y, z] = graph.cell_mm;
        let origin = graph.point_mm.iter().map(|p| p[2]).fold(f64::INFINITY, f64::min);
        let layer = |copy: u32, void: u32| {
            let down = graph.point_mm[void as usize][2] - origin + f64::from(copy) * z;
            libm::floor(down / spacing) as u32
        };
        let copied_voids = || (0..copies).flat_map(|copy| (0..voids).map(move |void| (copy, void)));
        let cube = unit * unit * unit;
        let linked = LinkedVoids {
            layer: copied_voids().map(|(copy, void)| layer(copy, void)).collect(),
            volume: copied_voids().map(|(_, void)| graph.volume_mm3[void as usize] / cube).collect(),
            unit_mm: unit,
            rule: shape.rule,
            rho: shape.rho,
            // The reservoirs lie half a layer upstream and downstream of the filter.
            permeability_mm2: Some((f64::from(copies) * z + spacing) / (x * y)),
        };
        Self::linked(linked, &links)
    }
}

/// Permeability (mm2) of the infinite periodic medium, along `axis` (0, 1, 2 for x, y, z).
///
/// Pressure falls by 1 from each cell to the next and is otherwise periodic, so there are no end effects.
/// Darcy's law `k = mu Q L / (A dP)` then gives the permeability.
///
/// # Errors
/// Conductances that differ too much.
pub fn permeability_mm2(graph: &VoidGraph, axis: usize) -> Result<f64, FlowError> {
    let voids = graph.voids();
    let links = || (0..graph.from.len()).filter(|&c| graph.conductance_mm3[c] > 0.0);
    // Pressures are known up to a constant, so one void of each connected component is set to 0.
    let mut together = Together::new(voids);
    links().for_each(|c| together.join(graph.from[c], graph.to[c]));
    let root: Vec<u32> = (0..voids as u32).map(|void| together.root(void)).collect();
    let inside = |void: u32| root[void as usize] != void;
    let system = System::new(voids, inside, |system| {
        for c in links() {
            let (a, b, g) = (graph.from[c], graph.to[c], graph.conductance_mm3[c]);
            let flow = g * f64::from(graph.shift[c][axis]);
            system.join(a, b, g);
            system.feed(a, -flow);
            system.feed(b, flow);
        }
    });
    let mut pressure = vec![0.0; voids];
    let layers = libm::cbrt(voids as f64) as usize;
    system.solve(&mut pressure, layers, CONVERGED, &mut None)?;
    let through: f64 = (0..graph.from.len())
        .map(|c| {
            let by = f64::from(graph.shift[c][axis]);
            let fall = pressure[graph.from[c] as usize] - (pressure[graph.to[c] as usize] - by);
            by * graph.conductance_mm3[c] * fall
        })
        .sum();
    let [x, y, z] = graph.cell_mm;
    let length = graph.cell_mm[axis];
    Ok(through * length * length / (x * y * z))
}

#[cfg(test)]
mod tests {
    use super::super::Flow;
    use super::*;
    use crate::packing::{Cell, Packing};
    use bitvec::vec::BitVec;

    /// Touching grains of 1 mm on a lattice.
    fn lattice(basis: &[[f64; 3]], edge: f64, cells: [usize; 3]) -> VoidGraph {
        let mut columns = [Vec::new(), Vec::new(), Vec::new()];
        for at in 0..cells[0] * cells[1] * cells[2] {
            let cell = [at % cells[0], at / cells[0] % cells[1], at / cells[0] / cells[1]];
            for p in basis {
                (0..3).for_each(|axis| columns[axis].push((cell[axis] as f64 + p[axis]) * edge));
            }
        }
        let [x, y, z] = columns;
        let diameter = vec![1.0; x.len()];
        let packing = Packing { cell: Cell::Periodic(cells.map(|n| n as f64 * edge)), x, y, z, diameter };
        VoidGraph::measure(&packing, 0.1).unwrap().1
    }

    /// Touching simple cubic lattice: closed form of the scheme, and the exact solution of Zick & Homsy
    /// (1982), doi:10.1017/S0022112082000627, k / D^2 = 1 / (18 c K) with K = 42.1 at c = 0.5236.
    #[test]
    fn permeability_of_a_simple_cubic_packing() {
        let graph = lattice(&[[0.0; 3]], 1.0, [4, 5, 6]);
        let pi = std::f64::consts::PI;
        let radius = (1.0 - pi / 6.0) / pi;
        let scheme = (1.0 - pi / 4.0) * radius * radius / 2.0;
        for axis in 0..3 {
            let k = permeability_mm2(&graph, axis).unwrap();
            assert!((k / scheme - 1.0).abs() < 1e-9, "{k}");
            assert!((k / (1.0 / (18.0 * pi / 6.0 * 42.1)) - 1.0).abs() < 0.03, "{k}");
        }
    }

    /// Touching body-centred and face-centred cubic lattices: closed form of the scheme. All throats are
    /// equal, so they share void and surface equally, and pressure falls evenly along the axis: k is the
    /// sum of g dz^2 over the throats of a cell of edge 1, divided by its volume. It is within 10 % of the
    /// Stokes flow through the same grains (k / D^2 to 0.2 %), by lattice Boltzmann (`results/graph.md`).
    #[test]
    fn permeability_of_body_centred_and_face_centred_cubic_packings() {
        let pi = std::f64::consts::PI;
        let body: (&[[f64; 3]], _, _, _, _, _) =
            (&[[0.0; 3], [0.5; 3]], 3f64.sqrt() / 2.0, 24.0, 1.0 / 8f64.sqrt(), 2f64.sqrt() / 4.0, 5.016e-4);
        let basis: &[[f64; 3]] = &[[0.0; 3], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]];
        let face = (basis, 0.5f64.sqrt(), 32.0, 3f64.sqrt() / 8.0, 3f64.sqrt() / 4.0, 1.7345e-4);
        for (basis, diameter, throats, facet, length, stokes) in [body, face] {
            let (grains, square) = (basis.len() as f64, diameter * diameter);
            let open_area = facet - pi * square / 8.0;
            let radius = (1.0 - grains * pi * square * diameter / 6.0) / (grains * pi * square);
            let throat = open_area * radius * radius / (2.0 * length);
            let scheme = throat * throats * length * length / 3.0 / square;
            assert!((scheme / stokes - 1.0).abs() < 0.1, "{scheme} {stokes}");
            let graph = lattice(basis, 1.0 / diameter, [3, 4, 3]);
            assert_eq!(graph.from.len(), throats as usize * 36);
            for axis in 0..3 {
                let k = permeability_mm2(&graph, axis).unwrap();
                assert!((k / scheme - 1.0).abs() < 1e-9, "{k} {scheme}");
            }
        }
    }

    /// Three equal constrictions per void, and columns without sideways flow.
    #[test]
    fn a_simple_cubic_packing_has_straight_columns() {
        let graph = lattice(&[[0.0; 3]], 1.0, [3, 4, 5]);
        let shape = GraphShape { copies: 2, rule: ExitRule::Flux, rho: 0.0, unit_mm: 1.0 };
        let mut network = Network::of_graph(&graph, shape).unwrap();
        assert_eq!((network.filter_voids(), network.entries(), network.layers()), (120, 12, 10));
        assert_eq!(network.passages(), 3 * 120 + 12);
        let open: BitVec = BitVec::repeat(false, network.constrictions());
        let mut flow = Flow::new(&network);
        let solution = flow.solve(&network, &open).unwrap();
        let k = permeability_mm2(&graph, 2).unwrap();
        assert!((solution.k_mm2.unwrap() / k - 1.0).abs() < 1e-9);
        flow.direct(&mut network);
        for void in 0..network.filter_voids() as u32 {
            let out: Vec<usize> = network.exits(void).filter(|&c| network.exit_weight(c) > 0.0).collect();
            let [only] = out[..] else { panic!("{out:?}") };
            let to = network.targets()[only];
            let layer = network.layer_of();
            assert!(to == super::super::END || layer[to as usize] == layer[void as usize] + 1);
        }
    }
}
