//! Water through a network: pressures, fluxes, and how well the whole conducts.
//!
//! At every void what flows in flows out, `sum over its constrictions of g (p - p_other) = 0`, with pressure
//! 1 in the reservoir and 0 behind the filter. A blocked constriction keeps a part `rho` of its conductance.
//! The system is symmetric and positive, and is solved by conjugate gradients, with an approximate factor of
//! what is open (module `elimination`), from the last answer on. An answer is the same to the bit on any
//! number of threads.

use bitvec::slice::BitSlice;

use super::system::{CONVERGED, NotConverged, Sides, System};
use super::{END, Network};

/// A flux below this part of what an inlet passes on average is none: pressures are no more exact.
const NO_FLUX: f64 = 1e-8;

/// The mean flux of an inlet is at least so many times what the residual may stand for.
const RESOLVED: f64 = 30.0;

/// Why no flow is known.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FlowError {
    /// Conductances so far apart that numbers do not tell.
    #[error(
        "the flow through the network cannot be solved: after {rounds} rounds the residual is \
         still {residual:.1e} \
         of the inflow; constrictions whose conductances lie many orders apart do that"
    )]
    NotConverged {
        /// Rounds.
        rounds: usize,
        /// Residual over inflow.
        residual: f64,
    },
    /// So large conductances where water comes in that what passes is lost in their rounding.
    #[error(
        "the flow through the network cannot be told: constrictions from the reservoir conduct so well that \
         what passes them is {part:.1e} of what rounding may stand for, where {RESOLVED} times is needed; \
         give them conductances that lie fewer orders above those inside"
    )]
    Unresolved {
        /// Mean flux of an inlet over what the residual may stand for.
        part: f64,
    },
}

impl From<NotConverged> for FlowError {
    fn from(NotConverged { rounds, residual }: NotConverged) -> Self {
        Self::NotConverged { rounds, residual }
    }
}

/// How well a network conducts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Permeability {
    /// Flow times viscosity for a pressure of 1 across the whole.
    pub conductance: f64,
    /// Permeability (mm2), where the network knows its own lengths.
    pub k_mm2: Option<f64>,
}

/// The flow through an undirected network, solved again and again as constrictions close.
pub struct Flow {
    /// Void that each exit leads to: END is one more void, without pressure.
    other: Vec<u32>,
    /// Pressure by void, and behind the filter.
    pressure: Vec<f64>,
    /// Conductance by exit, as it is now.
    open: Vec<f64>,
    /// Residual that the last solution may have, over the inflow.
    accuracy: f64,
}

impl Flow {
    /// Before anything is known.
    pub fn new(network: &Network) -> Self {
        let outside = network.voids() as u32;
        let other = network.targets().iter().map(|&to| if to == END { outside } else { to }).collect();
        let mut pressure = vec![0.0; network.voids() + 1];
        if let Some(reservoir) = network.reservoir() {
            // Falls evenly from layer to layer.
            let layers = network.layers().max(1) as f64;
            for (p, &layer) in pressure.iter_mut().zip(network.layer_of()) {
                *p = 1.0 - (f64::from(layer) + 0.5) / layers;
            }
            pressure[reservoir as usize] = 1.0;
        }
        Self { other, pressure, open: vec![0.0; network.constrictions()], accuracy: CONVERGED }
    }

    /// Pressure by void (1 in the reservoir), and 0 behind the filter.
    pub fn pressure(&self) -> &[f64] {
        &self.pressure
    }

    /// Flow times viscosity out of a void through one of its exits.
    pub fn flux(&self, void: u32, exit: usize) -> f64 {
        self.open[exit] * (self.pressure[void as usize] - self.pressure[self.other[exit] as usize])
    }

    /// Solves for the constrictions that `blocked` leaves open. A conductance below 1e-10 of the inlets' is
    /// 0, and so is one that what comes out does not bear out: pressures are no more exact.
    ///
    /// # Errors
    /// Conductances too far apart.
    pub fn solve(&mut self, network: &Network, blocked: &BitSlice) -> Result<Permeability, FlowError> {
        let undirected = network.undirected.as_ref();
        let rho = undirected.map_or(0.0, |u| u.rho);
        for (c, open) in self.open.iter_mut().enumerate() {
            *open = match (network.diameter[c] == 0.0, blocked[c]) {
                (true, _) => 0.0,
                (false, false) => network.conductance(c),
                (false, true) => rho * network.conductance(c),
            };
        }
        let Some(reservoir) = network.reservoir() else {
            return Ok(Permeability { conductance: 0.0, k_mm2: None });
        };
        // Water flows where it comes in and gets out; elsewhere it stands under the pressure of the one side.
        let joined = self.joined(network, reservoir);
        let inside = joined.inside();
        for (void, pressure) in self.pressure.iter_mut().enumerate().take(network.voids()) {
            if !inside[void] && void != reservoir as usize {
                *pressure = f64::from(u8::from(joined.to_reservoir[void]));
            }
        }
        let system = self.system(network, &inside, reservoir);
        let residual = system.solve(&mut self.pressure, network.layers())?;
        // What is asked for, but where rounding allows no more.
        self.accuracy = if residual <= 2.0 * CONVERGED { CONVERGED } else { residual };
        let inlets = network.exits(reservoir);
        let least = CONVERGED * inlets.clone().map(|c| self.open[c]).sum::<f64>();
        let through: f64 = inlets.map(|c| self.flux(reservoir, c)).sum();
        let imbalance = (through - self.outflow(network)).abs();
        let conductance = if through > least.max(imbalance) { through } else { 0.0 };
        let factor = undirected.and_then(|u| u.permeability_mm2);
        Ok(Permeability { conductance, k_mm2: factor.map(|factor| factor * conductance) })
    }

    /// The equations of the voids that water flows through.
    fn system(&self, network: &Network, inside: &[bool], reservoir: u32) -> System {
        let outside = network.voids() as u32;
        System::of_voids(inside, |void, neighbours| {
            let mut sides = Sides::default();
            for c in network.exits(void).filter(|&c| self.open[c] > 0.0) {
                let (to, g) = (self.other[c], self.open[c]);
                if to == reservoir {
                    sides.inflow += g;
                    sides.ground += g;
                } else if to == outside {
                    sides.ground += g;
                } else {
                    neighbours.push((to, g));
                }
            }
            sides
        })
    }

    /// Whether the flow that was solved last tells where water goes. Where it does not, every flux counts as
    /// none, and all particles would wait: a filter that lets everything through would seem to hold it.
    ///
    /// # Errors
    /// Open ways lead through the network, but conductances of the inlets are so large that rounding hides
    /// what passes.
    pub fn resolved(&self, network: &Network) -> Result<(), FlowError> {
        let Some(reservoir) = network.reservoir() else { return Ok(()) };
        let inlets = network.exits(reservoir);
        let leads_through = self.joined(network, reservoir).inside().contains(&true);
        let mean = inlets.clone().map(|c| self.flux(reservoir, c)).sum::<f64>() / inlets.len().max(1) as f64;
        let part = mean / self.residual_of(inlets);
        if leads_through && part.is_nan() | (part < RESOLVED) {
            return Err(FlowError::Unresolved { part });
        }
        Ok(())
    }

    /// Flux that the residual may stand for.
    fn residual_of(&self, inlets: std::ops::Range<usize>) -> f64 {
        self.accuracy * inlets.map(|c| self.open[c] * self.open[c]).sum::<f64>().sqrt()
    }

    /// Flow times viscosity out behind the filter.
    fn outflow(&self, network: &Network) -> f64 {
        let of =
            |void: u32| network.exits(void).filter(|&c| network.targets()[c] == END).map(move |c| (void, c));
        (0..network.voids() as u32).flat_map(of).map(|(void, c)| self.flux(void, c)).sum()
    }

    /// Gives each exit of the network its weight by the flow that was solved last.
    pub fn direct(&self, network: &mut Network, blocked: &BitSlice) {
        let Some(reservoir) = network.reservoir() else { return };
        let rule = network.exit_rule();
        let inlets = network.exits(reservoir);
        let through: f64 = inlets.clone().map(|c| self.flux(reservoir, c)).sum();
        // Nor is one that the residual may stand for.
        let least = (NO_FLUX * through / inlets.len().max(1) as f64).max(self.residual_of(inlets));
        let mut weight = std::mem::take(&mut network.undirected.as_mut().expect("it has a reservoir").weight);
        for void in 0..network.voids() as u32 {
            for c in network.exits(void) {
                let area = f64::from(network.diameter[c]) * f64::from(network.diameter[c]);
                weight[c] = if blocked[c] { 0.0 } else { rule.weight(area, self.flux(void, c), least) };
            }
        }
        network.undirected.as_mut().expect("it has a reservoir").weight = weight;
    }

    /// Which voids hang together with the reservoir and which with the end, neither by way of the other.
    fn joined(&self, network: &Network, reservoir: u32) -> Joined {
        let (voids, outside) = (network.voids(), network.voids() as u32);
        let mut joined = Joined { to_reservoir: vec![false; voids], to_end: vec![false; voids] };
        let mut seen = vec![false; voids];
        let mut together: Vec<u32> = Vec::new();
        for first in (0..outside).filter(|&void| void != reservoir) {
            if std::mem::replace(&mut seen[first as usize], true) {
                continue;
            }
            together.clear();
            together.push(first);
            let (mut meets_reservoir, mut meets_end, mut looked_at) = (false, false, 0);
            while let Some(&void) = together.get(looked_at) {
                looked_at += 1;
                for c in network.exits(void).filter(|&c| self.open[c] > 0.0) {
                    let to = self.other[c];
                    if to == reservoir {
                        meets_reservoir = true;
                    } else if to == outside {
                        meets_end = true;
                    } else if !std::mem::replace(&mut seen[to as usize], true) {
                        together.push(to);
                    }
                }
            }
            for &void in &together {
                joined.to_reservoir[void as usize] = meets_reservoir;
                joined.to_end[void as usize] = meets_end;
            }
        }
        joined
    }
}

/// Voids that hang together with the two sides of the filter.
struct Joined {
    to_reservoir: Vec<bool>,
    to_end: Vec<bool>,
}

impl Joined {
    /// Voids that hang together with both: water flows through them.
    fn inside(&self) -> Vec<bool> {
        self.to_reservoir.iter().zip(&self.to_end).map(|(one, other)| *one && *other).collect()
    }
}
