//! Water through a network: pressures, fluxes, and the conductance of the whole.
//!
//! At every void inflow equals outflow, `sum over its constrictions of g (p - p_other) = 0`, with pressure 1
//! in the reservoir and 0 behind the filter. A blocked constriction keeps a part `rho` of its conductance.
//! The system is symmetric and positive, and is solved by conjugate gradients from the last answer on, with
//! an approximate factor (module `elimination`) of the open constrictions, or of those that were open until a
//! few closed. So an answer depends, within the accuracy asked for, on those before. If conductances lie so
//! far apart that fluxes cannot be told from residuals, voids are eliminated without subtraction (module
//! `exact`), provided the network is small enough. Module `system` defines when a flow counts as solved.

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
    /// Flow times viscosity for a pressure of 1 across the whole.
    pub conductance: f64,
    /// Permeability (mm2), where the network knows its own lengths.
    pub k_mm2: Option<f64>,
}

struct Passage {
    /// The void that it is an exit of.
    one: u32,
    /// The void beyond; the reservoir counts as a void, and so does the space behind the filter.
    other: u32,
    exit: u32,
}

/// Sides of the filter that a void is connected to, without passing the other side.
#[derive(Clone, Copy, Default, PartialEq)]
struct Meets {
    reservoir: bool,
    end: bool,
}

const THROUGH: Meets = Meets { reservoir: true, end: true };

/// The flow through an undirected network, solved again and again as constrictions close.
pub struct Flow {
    passages: Vec<Passage>,
    reservoir: Option<u32>,
    inlets: std::ops::Range<usize>,
    /// Pressure by void, and behind the filter.
    pressure: Vec<f64>,
    /// Conductance by exit, as it is now.
    open: Vec<f64>,
    /// Flow times viscosity out of its void, by exit.
    flux: Vec<f64>,
    /// Exits that were blocked when the flow was solved last.
    blocked: BitVec,
    /// True if that solution was for parts of conductances.
    is_of_parts: bool,
    /// Flow times viscosity in from the reservoir.
    through: f64,
    /// Residual allowed in the last solution, over the inflow.
    accuracy: f64,
    /// Largest possible error of a flux of the last solution.
    missing: f64,
    /// Fluxes up to this may have the wrong sign, and lead round in a circle; 0 if they follow pressures.
    noise: f64,
    /// Largest conductance found for the network.
    most: f64,
    /// Number of voids that were too many to eliminate; far fewer are tried again.
    too_many: usize,
    kept: Option<Kept>,
    /// By void: true if water flowed through it when the kept factor was first wanted.
    inside: BitVec,
}

impl Flow {
    /// Prepares the flow of a clean network; pressures are a guess until it is solved.
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
            // Pressure falls evenly from layer to layer.
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

    /// Pressure by void (1 in the reservoir), and 0 behind the filter.
    pub fn pressure(&self) -> &[f64] {
        &self.pressure
    }

    /// Rounds of conjugate gradients for the system whose factor is kept; 0 if no factor is kept.
    pub fn rounds(&self) -> usize {
        self.kept.as_ref().map_or(0, |kept| kept.rounds)
    }

    /// Flow times viscosity through an exit, out of its void.
    pub fn flux(&self, exit: usize) -> f64 {
        self.flux[exit]
    }

    /// Absolute flux through a constriction over the inflow, by one of its exits; 0 if nothing flows in.
    pub fn share(&self, exit: usize) -> f64 {
        let through = self.through;
        if through > 0.0 { (self.flux[exit] / through).abs() } else { 0.0 }
    }

    /// Solves for the constrictions that `blocked` leaves open: a bit for each exit, equal for both exits of
    /// one constriction. The conductance found is 0 if no way leads through, and only then.
    ///
    /// # Errors
    /// Conductances so far apart that the flow is not known to half a millionth of the largest conductance
    /// found for the network, or, while open ways lead through, that it does not tell where water goes: every
    /// flux would count as zero and all particles would wait, so that a filter that lets everything through
    /// would seem to hold it.
    pub fn solve(&mut self, network: &Network, blocked: &BitSlice) -> Result<Permeability, FlowError> {
        self.solve_as(network, blocked, false)
    }

    /// Solves like [`Flow::solve`], as closely as rounding allows: for a reader of every flux.
    ///
    /// # Errors
    /// Those of [`Flow::solve`], and fluxes that are not known to a hundred-millionth of the flow through the
    /// filter.
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
        let rho = network.undirected.as_ref().map_or(0.0, |u| u.rho);
        self.set_blocked(network, blocked, rho);
        // Leaks through blocked constrictions carry no particle out.
        let is_open = |passage: &Passage| !blocked[passage.exit as usize];
        self.solve_now(network, closely, rho > 0.0, is_open)
    }

    /// Solves for constrictions that keep these parts of their conductance, from 0 to 1: one for each exit,
    /// equal for both exits of one constriction. All that conduct let particles pass.
    ///
    /// # Errors
    /// Those of [`Flow::solve`].
    pub fn solve_parts(&mut self, network: &Network, parts: &[f64]) -> Result<Permeability, FlowError> {
        assert_eq!(parts.len(), self.open.len(), "one part for each exit");
        // Blocked constrictions lead on again, however much they leaked.
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

    /// Solves for the present conductances; `leaks`: some constrictions conduct that are closed to particles.
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
                // If they come no closer in time, the present solution has to do.
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

    /// Sides that each void is connected to by constrictions that conduct and are a way, and by other voids.
    fn meets(&self, is_way: impl Fn(&Passage) -> bool) -> Vec<Meets> {
        let outside = self.pressure.len() - 1;
        let is_side =
            |passage: &Passage| Some(passage.other) == self.reservoir || passage.other as usize == outside;
        let ways = || {
            self.passages.iter().filter(|passage| self.open[passage.exit as usize] > 0.0 && is_way(passage))
        };
        let mut together = Together::new(outside);
        ways()
            .filter(|passage| !is_side(passage))
            .for_each(|passage| together.join(passage.one, passage.other));
        let mut of_root = vec![Meets::default(); outside];
        for passage in ways().filter(|passage| is_side(passage)) {
            let meets = &mut of_root[together.root(passage.one) as usize];
            meets.reservoir |= Some(passage.other) == self.reservoir;
            meets.end |= passage.other as usize == outside;
        }
        (0..outside as u32).map(|void| of_root[together.root(void) as usize]).collect()
    }

    fn set_blocked(&mut self, network: &Network, blocked: &BitSlice, rho: f64) {
        assert_eq!(blocked.len(), self.open.len(), "one bit for each exit");
        if std::mem::take(&mut self.is_of_parts) {
            // Nothing is blocked, and narrowed constrictions are whole again.
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
    }

    /// Keeps the factor if few exits have changed since it was made, and no exit has opened again.
    fn keep_factor(&mut self, network: &Network, changed: &BitSlice, is_open_again: bool) {
        if let Some(kept) = &mut self.kept {
            kept.closed += changed.count_ones();
            if is_open_again || kept.closed * KEPT_UNTIL > network.constrictions() {
                self.kept = None;
            }
        }
    }

    /// Constrictions between voids that water flows through, and from them to both sides of the filter.
    fn conducting<'a>(&'a self, meets: &'a [Meets]) -> impl Iterator<Item = (&'a Passage, f64)> {
        let is_in = |passage: &&Passage| meets[passage.one as usize] == THROUGH;
        let with_open = |passage: &'a Passage| (passage, self.open[passage.exit as usize]);
        self.passages.iter().filter(is_in).map(with_open).filter(|&(_, open)| open > 0.0)
    }

    /// Finds pressures and fluxes, to this part of the inflow.
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
        // The accuracy asked for, or as much of it as rounding allows.
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

    /// Gives voids that water does not flow through the pressure of the one side that they meet.
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

    /// Mean flux of an inlet over the flux that the residual may account for.
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

    /// Gives each exit of the network its weight by the flow that was solved last; exits blocked then weigh
    /// nothing. A void whose open exits each pass too little to count keeps the one that passes most, so that
    /// it retains nothing that water carries into it.
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
            // The next number below the largest, so that this one counts.
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

/// Conductance of an exit while it is open.
fn whole(network: &Network, exit: usize) -> f64 {
    if network.diameter[exit] == 0.0 { 0.0 } else { network.conductance(exit) }
}

#[cfg(test)]
mod tests;
