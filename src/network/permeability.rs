//! Permeability of a packing's voids in an endless medium.

use super::flow::FlowError;
use super::system::{Sides, System};
use crate::constrictions::VoidGraph;

/// Permeability (mm2) of the medium that the graph repeats without end, along `axis` (0, 1, 2 for x, y, z).
///
/// Pressure falls by 1 from each cell to the next, and is otherwise the same in all: so no face of the filter
/// plays a part. Darcy's law `k = mu Q L / (A dP)` then gives the permeability.
///
/// # Errors
/// Conductances too far apart.
pub fn permeability_mm2(graph: &VoidGraph, axis: usize) -> Result<f64, FlowError> {
    let voids = graph.voids();
    let mut meeting: Vec<Vec<(u32, f64, f64)>> = vec![Vec::new(); voids];
    for c in (0..graph.from.len()).filter(|&c| graph.conductance_mm3[c] > 0.0) {
        let (a, b, g) = (graph.from[c], graph.to[c], graph.conductance_mm3[c]);
        let by = f64::from(graph.shift[c][axis]);
        meeting[a as usize].push((b, g, by));
        meeting[b as usize].push((a, g, -by));
    }
    // Pressures are known but for a constant: one void of each part that hangs together is at 0.
    let mut inside = vec![false; voids];
    let mut seen = vec![false; voids];
    for first in 0..voids as u32 {
        if std::mem::replace(&mut seen[first as usize], true) {
            continue;
        }
        let mut stack = vec![first];
        while let Some(void) = stack.pop() {
            for &(to, _, _) in &meeting[void as usize] {
                if !std::mem::replace(&mut seen[to as usize], true) {
                    inside[to as usize] = true;
                    stack.push(to);
                }
            }
        }
    }
    // Conductances to the voids that are held are among those to neighbours.
    let system = System::of_voids(&inside, |void, neighbours| {
        let all = &meeting[void as usize];
        neighbours.extend(all.iter().map(|&(to, g, _)| (to, g)));
        Sides { ground: 0.0, inflow: -all.iter().map(|(_, g, by)| g * by).sum::<f64>() }
    });
    let mut pressure = vec![0.0; voids];
    let layers = libm::cbrt(voids as f64) as usize;
    system.solve(&mut pressure, layers)?;
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
