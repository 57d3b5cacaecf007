//! Positions of the voids of a case's network.

use super::Case;
use crate::outcome::by_void::Places;
use crate::scene::NetworkSource;

impl Case {
    /// Positions of the voids of its network; `None` for a network from a file, which has no positions, and
    /// for a packing that is still to be made.
    pub fn places(&self) -> Option<Places> {
        match (self.scene.network.source(), self.network.packing()) {
            (NetworkSource::File(_), ..) => None,
            (NetworkSource::Graph(..), Some(packing)) => {
                let graph = &packing.graph.graph;
                let [x_mm, y_mm, z_mm] = graph.cell_mm;
                let lifted = |copy: u32| {
                    let by = f64::from(copy) * z_mm;
                    graph.point_mm.iter().map(move |&[x, y, z]| [x, y, z + by])
                };
                Some(Places {
                    point_mm: (0..packing.copies).flat_map(lifted).collect(),
                    period_mm: [x_mm, y_mm],
                    layer_mm: graph.spacing_mm(),
                })
            }
            (NetworkSource::Graph(..), ..) => None,
            (source, ..) => {
                let [nx, ny, nz] = source.shape()?;
                let layer_mm = self.filter.gradation.d_by_number(50.0).unwrap_or(self.filter.unit_mm);
                let middle = |at: u32| (f64::from(at) + 0.5) * layer_mm;
                let row = |z: u32, y: u32| (0..nx).map(move |x| [middle(x), middle(y), middle(z)]);
                Some(Places {
                    point_mm: (0..nz).flat_map(|z| (0..ny).flat_map(move |y| row(z, y))).collect(),
                    period_mm: [nx, ny].map(|n| f64::from(n) * layer_mm),
                    layer_mm,
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    /// By the layer in the network itself, and by its constrictions, which lead to a neighbour.
    #[test]
    fn the_voids_of_a_lattice_lie_in_their_layers_beside_their_neighbours() {
        let settings = ["network.nx=3", "network.ny=4", "network.nz=5"].map(String::from);
        let case = Case::new(Scene::built_in(&settings).unwrap()).unwrap();
        let (network, places) = (case.network(1).unwrap(), case.places().unwrap());
        assert_eq!(places.point_mm.len(), network.voids());
        for void in 0..network.voids() {
            let [x, y, z] = places.point_mm[void];
            assert_eq!((z / places.layer_mm) as u32, network.layer_of()[void]);
            for c in network.exits(void as u32) {
                let Some(&[other_x, other_y, other_z]) = places.point_mm.get(network.targets()[c] as usize)
                else {
                    continue;
                };
                let across = |from: f64, to: f64, period: f64| {
                    let by = to - from;
                    by - period * (by / period).round()
                };
                let by = [
                    across(x, other_x, places.period_mm[0]),
                    across(y, other_y, places.period_mm[1]),
                    other_z - z,
                ];
                let steps: f64 = by.iter().sum::<f64>() / places.layer_mm;
                assert!((steps - 1.0).abs() < 1e-9, "{by:?}");
            }
        }
    }
}
