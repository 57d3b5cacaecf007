//! Permeability of a packing's voids in an endless medium.

use super::error::FlowError;
use super::system::System;
use super::thresholds::CONVERGED;
use super::together::Together;
use crate::constrictions::VoidGraph;

/// Permeability (mm2) of the medium that the graph repeats without end, along `axis` (0, 1, 2 for x, y, z).
///
/// Pressure falls by 1 from each cell to the next, and is otherwise equal in all: so no face of the filter
/// plays a part. Darcy's law `k = mu Q L / (A dP)` then gives the permeability.
///
/// # Errors
/// Conductances too far apart.
pub fn permeability_mm2(graph: &VoidGraph, axis: usize) -> Result<f64, FlowError> {
    let voids = graph.voids();
    let links = || (0..graph.from.len()).filter(|&c| graph.conductance_mm3[c] > 0.0);
    // Pressures are known but for a constant: one void of each connected part is at 0.
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
