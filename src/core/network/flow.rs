//! Flow of water through a network: pressures, fluxes and total conductance.
//!
//! At every void inflow equals outflow, `sum over its constrictions of g (p - p_other) = 0`, with pressure
//! 1 in the reservoir and 0 downstream of the filter. A blocked constriction keeps a fraction `rho` of its
//! conductance. The system is solved by conjugate gradients starting from the last solution, preconditioned
//! by an approximate factor (module `elimination`) that is kept while few more constrictions close. So a
//! solution depends, within the required accuracy, on earlier ones. If conductances differ so much that
//! fluxes cannot be distinguished from residuals, voids are eliminated without subtraction (module `exact`).
//! Module `system` defines when a flow counts as solved.

mod elimination;
mod exact;
pub(super) mod system;

use super::exit_rule::NO_TWIN;
use super::{END, Network};
use bitvec::slice::BitSlice;
use bitvec::vec::BitVec;
use exact::Eliminated;
use system::{
    CLEAR, CLOSELY, CLOSEST, CONVERGED, ELIMINATED, KEPT_UNTIL, KNOWN, Kept, NO_FLUX, RESOLVED, ROUNDING,
    System, Together,
};

pub use system::FlowError;

/// Conductance and permeability of a network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Permeability {
    /// Flow times viscosity for a pressure difference of 1 across the network.
    pub conductance: f64,
    /// Permeability (mm2), if the lengths of the network are known.
    pub(crate) k_mm2: Option<f64>,
}

struct Passage {
    /// Void that the exit leaves.
    one: u32,
    /// Void that the exit enters; the reservoir and the space downstream of the filter count as voids.
    other: u32,
    exit: u32,
}

/// Sides of the filter to which a void is connected, not counting paths through the other side.
#[derive(Clone, Copy, Default, PartialEq)]
struct Meets {
    reservoir: bool,
    end: bool,
}

const THROUGH: Meets = Meets { reservoir: true, end: true };

/// Flow through an undirected network, solved repeatedly as constrictions close.
pub struct Flow {
    passages: Vec<Passage>,
    reservoir: Option<u32>,
    inlets: std::ops::Range<usize>,
    /// Pressure by void, and downstream of the filter.
    pressure: Vec<f64>,
    /// Current conductance by exit.
    open: Vec<f64>,
    /// Outward flow times viscosity by exit.
    flux: Vec<f64>,
    /// Exits that were blocked in the last solution.
    blocked: BitVec,
    /// True if the last solution was for fractions of conductances.
    is_of_parts: bool,
    /// Inflow from the reservoir times viscosity.
    through: f64,
    /// Residual allowed in the last solution, relative to the inflow.
    accuracy: f64,
    /// Largest possible error of a flux of the last solution.
    missing: f64,
    /// Fluxes up to this value may have the wrong sign and form circles; 0 if fluxes follow from pressures.
    noise: f64,
    /// Largest conductance of the network so far.
    most: f64,
    /// Number of voids that was too large to eliminate; at most half of it is tried again.
    too_many: usize,
    kept: Option<Kept>,
    /// True for each void with flow when the kept factor was first needed.
    inside: BitVec,
}

impl Flow {
    /// Prepares the flow of a clean network, with initial guesses of the pressures.
    pub fn new(network: &Network) -> Self {
        let (outside, reservoir) = (network.voids() as u32, network.reservoir());
        let twins = network.undirected.as_ref().map(|undirected| &undirected.twin);
        let mut passages = Vec::with_capacity(network.constrictions() / 2);
        for one in 0..outside {
            for c in network.exits(one) {
                let (to, twin) = (network.targets()[c], twins.map_or(NO_TWIN, |twin| twin[c]));
                let other = if to == END { outside } else { to };
                if twin >= c as u32 {
                    passages.push(Passage { one, other, exit: c as u32 });
                }
            }
        }
        let open: Vec<f64> = (0..network.constrictions()).map(|c| whole(network, c)).collect();
        let mut pressure = vec![0.0; network.voids() + 1];
        if let Some(reservoir) = reservoir {
            // Pressure falls linearly from layer to layer.
            let layers = network.layers().max(1) as f64;
            for (p, &layer) in pressure.iter_mut().zip(network.layer_of()) {
                *p = 1.0 - (f64::from(layer) + 0.5) / layers;
            }
            pressure[reservoir as usize] = 1.0;
        }
        Self {
            passages,
            reservoir,
            inlets: reservoir.map_or(0..0, |reservoir| network.exits(reservoir)),
            pressure,
            flux: vec![0.0; open.len()],
            blocked: BitVec::repeat(false, open.len()),
            open,
            is_of_parts: false,
            through: 0.0,
            accuracy: CONVERGED,
            missing: 0.0,
            noise: 0.0,
            most: 0.0,
            too_many: usize::MAX,
            kept: None,
            inside: BitVec::new(),
        }
    }

    /// Pressure by void: 1 in the reservoir; the last entry, downstream of the filter, is 0.
    pub fn pressure(&self) -> &[f64] {
        &self.pressure
    }

    /// Iterations of conjugate gradients for the system whose factor is kept; 0 if no factor is kept.
    pub fn rounds(&self) -> usize {
        self.kept.as_ref().map_or(0, |kept| kept.rounds)
    }

    /// Outward flow times viscosity through an exit.
    pub fn flux(&self, exit: usize) -> f64 {
        self.flux[exit]
    }

    /// Absolute flux through an exit divided by the inflow; 0 without inflow.
    pub(crate) fn share(&self, exit: usize) -> f64 {
        let through = self.through;
        if through > 0.0 { (self.flux[exit] / through).abs() } else { 0.0 }
    }

    /// Solves the flow with `blocked` exits: one bit per exit, equal for both exits of a constriction. The
    /// conductance is 0 if and only if no path leads through.
    ///
    /// # Errors
    /// Conductances that differ so much that the error of the flow exceeds half a millionth of the largest
    /// conductance so far, or that the direction of water is unknown although an open path leads through:
    /// every flux would count as zero and all particles would wait, so that an open filter would seem to
    /// hold the base.
    pub fn solve(&mut self, network: &Network, blocked: &BitSlice) -> Result<Permeability, FlowError> {
        self.solve_as(network, blocked, false)
    }

    /// Solves like [`Flow::solve`], as accurately as rounding allows, for uses of individual fluxes.
    ///
    /// # Errors
    /// Errors of [`Flow::solve`], and errors of fluxes above 1e-8 of the flow through the filter.
    pub fn solve_closely(
        &mut self,
        network: &Network,
        blocked: &BitSlice,
    ) -> Result<Permeability, FlowError> {
        self.solve_as(network, blocked, true)
    }

    fn solve_as(
        &mut self,
        network: &Network,
        blocked: &BitSlice,
        closely: bool,
    ) -> Result<Permeability, FlowError> {
        assert_eq!(blocked.len(), self.open.len(), "one bit for each exit");
        let rho = network.undirected.as_ref().map_or(0.0, |u| u.rho);
        if std::mem::take(&mut self.is_of_parts) {
            // Nothing is blocked, and narrowed constrictions have their full conductance again.
            self.kept = None;
            self.open.iter_mut().enumerate().for_each(|(c, open)| *open = whole(network, c));
        }
        let mut changed = std::mem::replace(&mut self.blocked, blocked.to_bitvec());
        changed ^= blocked;
        let is_open_again = changed.iter_ones().any(|c| !blocked[c]);
        self.keep_factor(network, &changed, is_open_again);
        for c in changed.iter_ones() {
            self.open[c] = if blocked[c] { rho * whole(network, c) } else { whole(network, c) };
        }
        // Leaks through blocked constrictions carry no particles.
        let is_open = |passage: &Passage| !blocked[passage.exit as usize];
        self.solve_now(network, closely, rho > 0.0, is_open)
    }

    /// Solves for constrictions that keep these fractions of their conductance (0 to 1): one per exit,
    /// equal for both exits of a constriction. Every constriction that conducts lets particles pass.
    ///
    /// # Errors
    /// Errors of [`Flow::solve`].
    pub(crate) fn solve_parts(
        &mut self,
        network: &Network,
        parts: &[f64],
    ) -> Result<Permeability, FlowError> {
        assert_eq!(parts.len(), self.open.len(), "one part for each exit");
        // No constriction counts as blocked now, however much it leaked.
        let mut changed = std::mem::replace(&mut self.blocked, BitVec::repeat(false, parts.len()));
        let mut is_open_again = false;
        for (c, (open, part)) in self.open.iter_mut().zip(parts).enumerate() {
            let now = part * whole(network, c);
            if now != *open {
                changed.set(c, true);
            }
            is_open_again |= now > *open;
            *open = now;
        }
        self.is_of_parts = true;
        self.keep_factor(network, &changed, is_open_again);
        self.solve_now(network, false, false, |_| true)
    }

    /// Solves for the current conductances; `leaks`: some constrictions closed to particles conduct.
    fn solve_now(
        &mut self,
        network: &Network,
        closely: bool,
        leaks: bool,
        is_open: impl Fn(&Passage) -> bool,
    ) -> Result<Permeability, FlowError> {
        if self.reservoir.is_none() {
            return Ok(Permeability { conductance: 0.0, k_mm2: None });
        }
        let meets = self.meets(|_| true);
        if self.kept.is_none() {
            self.inside = meets.iter().map(|&meets| meets == THROUGH).collect();
        }
        let leads_through = meets.contains(&THROUGH);
        let is_passed = leads_through && (!leaks || self.meets(is_open).contains(&THROUGH));
        let tells = |flow: &Self, clear: f64| {
            flow.missing <= KNOWN * flow.most.max(flow.through)
                && (!is_passed || flow.part() >= clear)
                && (!closely || flow.missing <= CLOSELY * flow.through)
        };
        let mut result = self.find_pressures(network, &meets, CONVERGED);
        if leads_through && (closely || result.is_err() || !tells(self, CLEAR)) {
            if result.is_ok() {
                // If this does not converge in time, the present solution is used.
                let _ = self.find_pressures(network, &meets, CLOSEST);
            }
            if (result.is_err() || !tells(self, CLEAR)) && self.eliminate(network, &meets) {
                result = Ok(());
            }
        }
        result?;
        let through = self.through;
        if leads_through && !tells(self, RESOLVED) {
            return Err(FlowError::Unresolved { off: self.missing / through.abs() });
        }
        let conductance = if leads_through && through > 0.0 { through } else { 0.0 };
        self.most = self.most.max(conductance);
        let factor = network.undirected.as_ref().and_then(|u| u.permeability_factor);
        Ok(Permeability { conductance, k_mm2: factor.map(|factor| factor * conductance) })
    }

    /// Sides to which each void is connected, through constrictions that conduct and satisfy `is_way`.
    fn meets(&self, is_way: impl Fn(&Passage) -> bool) -> Vec<Meets> {
        let outside = self.pressure.len() - 1;
        let is_open = |passage: &&Passage| self.open[passage.exit as usize] > 0.0 && is_way(passage);
        let (mut together, mut sides) = (Together::new(outside), Vec::new());
        for passage in self.passages.iter().filter(is_open) {
            let meets = Meets {
                reservoir: Some(passage.other) == self.reservoir,
                end: passage.other as usize == outside,
            };
            if meets == Meets::default() {
                together.join(passage.one, passage.other);
            } else {
                sides.push((passage.one, meets));
            }
        }
        let mut of_root = vec![Meets::default(); outside];
        for (void, side) in sides {
            let meets = &mut of_root[together.root(void) as usize];
            meets.reservoir |= side.reservoir;
            meets.end |= side.end;
        }
        (0..outside as u32).map(|void| of_root[together.root(void) as usize]).collect()
    }

    /// Keeps the factor if few exits have changed since it was made and no exit has reopened.
    fn keep_factor(&mut self, network: &Network, changed: &BitSlice, is_open_again: bool) {
        if let Some(kept) = &mut self.kept {
            kept.closed += changed.count_ones();
            if is_open_again || kept.closed * KEPT_UNTIL > network.constrictions() {
                self.kept = None;
            }
        }
    }

    /// Constrictions of voids that carry flow: among them, and to both sides of the filter.
    fn conducting<'a>(&'a self, meets: &'a [Meets]) -> impl Iterator<Item = (&'a Passage, f64)> {
        let is_in = |passage: &&Passage| meets[passage.one as usize] == THROUGH;
        let with_open = |passage: &'a Passage| (passage, self.open[passage.exit as usize]);
        self.passages.iter().filter(is_in).map(with_open).filter(|&(_, open)| open > 0.0)
    }

    fn find_pressures(&mut self, network: &Network, meets: &[Meets], within: f64) -> Result<(), FlowError> {
        let Some(reservoir) = self.reservoir else { return Ok(()) };
        let outside = meets.len() as u32;
        let is_inside = |void: u32| self.inside[void as usize];
        let system = System::new(meets.len(), is_inside, |system| {
            for (&Passage { one, other, .. }, open) in self.conducting(meets) {
                match other {
                    _ if other == reservoir => system.hold(one, open, 1.0),
                    _ if other == outside => system.hold(one, open, 0.0),
                    _ => system.join(one, other, open),
                }
            }
        });
        let fit = system.solve(&mut self.pressure, network.layers(), within, &mut self.kept)?;
        self.stand_still(meets, reservoir);
        self.missing = fit.missing;
        // Required accuracy, or as close as rounding allows.
        let asked = within.max(ROUNDING);
        self.accuracy = if fit.residual <= 2.0 * asked { asked } else { fit.residual };
        self.noise = 0.0;
        let pressure = &self.pressure;
        let fall = |passage: &Passage| pressure[passage.one as usize] - pressure[passage.other as usize];
        let falls: Vec<f64> = self.passages.iter().map(fall).collect();
        self.set_fluxes(network, &falls);
        Ok(())
    }

    /// Finds pressures and fluxes without subtraction; returns `false`, with nothing changed, if that takes
    /// too much work.
    fn eliminate(&mut self, network: &Network, meets: &[Meets]) -> bool {
        let Some(reservoir) = self.reservoir else { return false };
        let mut nodes: Vec<u32> = vec![0; meets.len() + 1];
        let mut count = 0;
        for (node, _) in nodes.iter_mut().zip(meets).filter(|&(_, &meets)| meets == THROUGH) {
            (*node, count) = (count, count + 1);
        }
        if 2 * count as usize > self.too_many {
            return false;
        }
        (nodes[reservoir as usize], nodes[meets.len()]) = (count, count + 1);
        let node = |void: u32| nodes[void as usize];
        let links =
            self.conducting(meets).map(|(passage, open)| (node(passage.one), node(passage.other), open));
        let Some(eliminated) = Eliminated::new(count as usize, links) else {
            self.too_many = count as usize;
            return false;
        };
        let fall = |passage: &Passage| match meets[passage.one as usize] == THROUGH {
            true if self.open[passage.exit as usize] > 0.0 => {
                eliminated.fall(node(passage.one), node(passage.other))
            }
            _ => 0.0,
        };
        let falls: Vec<f64> = self.passages.iter().map(fall).collect();
        for (void, _) in meets.iter().enumerate().filter(|&(_, &meets)| meets == THROUGH) {
            self.pressure[void] = eliminated.pressure[nodes[void] as usize];
        }
        self.stand_still(meets, reservoir);
        (self.missing, self.accuracy) = (ELIMINATED * eliminated.conductance, 0.0);
        self.noise = self.missing;
        self.set_fluxes(network, &falls);
        true
    }

    /// Gives voids without flow the pressure of the side to which they are connected.
    fn stand_still(&mut self, meets: &[Meets], reservoir: u32) {
        for (pressure, &meets) in self.pressure.iter_mut().zip(meets) {
            if meets != THROUGH {
                *pressure = f64::from(u8::from(meets.reservoir));
            }
        }
        self.pressure[reservoir as usize] = 1.0;
    }

    fn set_fluxes(&mut self, network: &Network, falls: &[f64]) {
        for (passage, fall) in self.passages.iter().zip(falls) {
            let exit = passage.exit as usize;
            self.flux[exit] = self.open[exit] * fall;
            if let Some(twin) = network.twin(exit) {
                self.flux[twin] = -self.flux[exit];
            }
        }
        self.through = self.flux[self.inlets.clone()].iter().sum();
    }

    /// Mean flux of an inlet divided by the flux that the residual may account for.
    fn part(&self) -> f64 {
        self.through / self.inlets.len().max(1) as f64 / self.residual_of_inlets()
    }

    /// Flux of an inlet that the residual may account for.
    fn residual_of_inlets(&self) -> f64 {
        let open = &self.open[self.inlets.clone()];
        let largest = open.iter().copied().fold(0.0, f64::max);
        if largest == 0.0 {
            return 0.0;
        }
        // Scaling by a power of two changes no digit; unscaled squares of very large and very small numbers
        // would overflow or vanish.
        let unit = libm::scalbn(1.0, -libm::ilogb(largest).max(-1000));
        let square = |open: &f64| (open * unit) * (open * unit);
        self.accuracy * open.iter().map(square).sum::<f64>().sqrt() / unit
    }

    /// Gives each exit its weight from the last solution; exits blocked in it get weight 0. If all open
    /// exits of a void have negligible fluxes, the one with the largest flux is kept, so that the void
    /// does not retain particles that water carries into it.
    pub fn direct(&self, network: &mut Network) {
        if self.reservoir.is_none() {
            return;
        }
        let rule = network.exit_rule();
        let mean = self.through / self.inlets.len().max(1) as f64;
        let least = (NO_FLUX * mean).max(self.residual_of_inlets());
        for void in 0..network.voids() as u32 {
            let exits = network.exits(void);
            let is_open = |&c: &usize| !self.blocked[c];
            let most = exits.clone().filter(is_open).map(|c| self.flux[c]).fold(self.noise, f64::max);
            // Just below the largest flux, so that this one counts.
            let least = if most > least { least } else { most.next_down().max(self.noise) };
            for c in exits {
                let area = f64::from(network.diameter[c]);
                let weight =
                    if self.blocked[c] { 0.0 } else { rule.weight(area * area, self.flux[c], least) };
                if let Some(undirected) = &mut network.undirected {
                    undirected.weight[c] = weight;
                }
            }
        }
    }
}

fn whole(network: &Network, exit: usize) -> f64 {
    if network.diameter[exit] == 0.0 { 0.0 } else { network.conductance(exit) }
}

#[cfg(test)]
mod tests;
