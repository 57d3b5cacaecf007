//! Water through a network: pressures, fluxes, and how well the whole conducts.
//!
//! At every void what flows in flows out, `sum over its constrictions of g (p - p_other) = 0`, with pressure
//! 1 in the reservoir and 0 behind the filter. A blocked constriction keeps a part `rho` of its conductance.
//! The system is symmetric and positive, and is solved by conjugate gradients, with an approximate factor
//! (module `elimination`) of what is open, or was until a little of it closed, from the last answer on. So an
//! answer depends, within what is asked of it, on those before; it is the same to the bit on any number of
//! threads.
//!
//! A thick network is solved near what has closed since the last time (module `stretch`), and the whole is
//! checked. Where water has turned follows from that ([`Turned`]): elsewhere all fluxes change by one factor,
//! and exits keep their weights.

mod elimination;
mod error;
mod joining;
mod passages;
mod permeability;
mod piece;
mod rest;
mod rounds;
mod slabs;
mod stretch;
mod system;
mod thick;
mod together;
mod turned;

use bitvec::slice::BitSlice;
use bitvec::vec::BitVec;

use super::{END, Network};
use passages::{Meets, Passage, Passages, THROUGH};
use slabs::each;
use system::{CLOSEST, CONVERGED, Fit, Kept, ROUNDING, System};
use thick::Thick;
use together::Together;

pub use error::FlowError;
pub use permeability::permeability_mm2;
pub use turned::Turned;

/// A flux below this part of what an inlet passes on average is none: pressures are no more exact.
const NO_FLUX: f64 = 1e-8;

/// The mean flux of an inlet is at least so many times what the residual may stand for.
const RESOLVED: f64 = 30.0;

/// Where it is less than so many times that, pressures come as close as rounding lets them: fluxes that the
/// residual may stand for are none, and what is left of a filter that clogs may be small.
const CLEAR: f64 = 1e3;

/// Flow that pressures may be wrong by, over the most that the network was found to conduct.
const KNOWN: f64 = 5e-7;

/// The same over what passes now, for a reader of every flux.
const CLOSELY: f64 = 1e-8;

/// A factor is kept until more than one in so many exits have closed: so it serves where little closes from
/// one solution to the next, and costs fewer rounds then than making another would.
const KEPT_UNTIL: usize = 100;

/// From so many layers on balances that are each off by [`CONVERGED`] leave the flow of all of them less
/// known than [`KNOWN`], so that every solution would be done again, to what rounding allows. Most of so
/// thick a network is far from what closes at a time: it is solved by stretches.
const THICK: usize = 400;

/// The residual of a thick network, as part of what flows in.
const CONVERGED_THICK: f64 = 1e-12;

/// A factor of a thick network is kept until more than one in so many exits have closed: its rounds cost more
/// beside making another.
const KEPT_UNTIL_THICK: usize = 300;

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
    passages: Passages,
    /// Void that each exit leads to: END is one more void, without pressure.
    other: Vec<u32>,
    /// Pressure by void, and behind the filter.
    pressure: Vec<f64>,
    /// Conductance by exit, as it is now.
    open: Vec<f64>,
    /// Exits that were blocked when the flow was solved last.
    blocked: BitVec,
    /// Whether it was solved for parts of conductances then.
    is_of_parts: bool,
    /// Residual that the last solution may have, over the inflow.
    accuracy: f64,
    /// Flow that no flux of the last solution is wrong by more than.
    missing: f64,
    /// The most that the network was found to conduct.
    most: f64,
    /// What serves solution after solution.
    kept: Option<Kept>,
    /// By void: whether water flowed through it when the factor or the equations that are kept were first
    /// wanted.
    inside: BitVec,
    /// Where water has turned since the network was given directions.
    turned: Turned,
    /// What a thick network keeps from one solution to the next.
    thick: Option<Thick>,
}

impl Flow {
    /// Of a clean network, before it is solved: until then pressures are a guess.
    pub fn new(network: &Network) -> Self {
        let outside = network.voids() as u32;
        let other: Vec<u32> =
            network.targets().iter().map(|&to| if to == END { outside } else { to }).collect();
        let passages = Passages::of(network, &other);
        let open = (0..network.constrictions()).map(|c| whole(network, c)).collect();
        let blocked = BitVec::repeat(false, network.constrictions());
        let mut pressure = vec![0.0; network.voids() + 1];
        if let Some(reservoir) = network.reservoir() {
            // Falls evenly from layer to layer.
            let layers = network.layers().max(1) as f64;
            for (p, &layer) in pressure.iter_mut().zip(network.layer_of()) {
                *p = 1.0 - (f64::from(layer) + 0.5) / layers;
            }
            pressure[reservoir as usize] = 1.0;
        }
        Self {
            passages,
            other,
            pressure,
            open,
            blocked,
            is_of_parts: false,
            accuracy: CONVERGED,
            missing: 0.0,
            most: 0.0,
            kept: None,
            inside: BitVec::new(),
            turned: Turned::all(network.voids()),
            thick: None,
        }
    }

    /// Pressure by void (1 in the reservoir), and 0 behind the filter.
    pub fn pressure(&self) -> &[f64] {
        &self.pressure
    }

    /// Rounds of conjugate gradients that the system took whose factor is kept; 0 where none is.
    pub fn rounds(&self) -> usize {
        self.kept.as_ref().map_or(0, |kept| kept.rounds)
    }

    /// Flow times viscosity out of a void through one of its exits.
    pub fn flux(&self, void: u32, exit: usize) -> f64 {
        self.open[exit] * (self.pressure[void as usize] - self.pressure[self.other[exit] as usize])
    }

    /// Solves for the constrictions that `blocked` leaves open: a bit for each exit, the same for both of one
    /// constriction. What is found is 0 where no way leads through, and nowhere else.
    ///
    /// # Errors
    /// Conductances so far apart that the flow is not known to half a millionth of the most that the network
    /// was found to conduct, or, while open ways lead through, that it does not tell where water goes: every
    /// flux would count as none and all particles would wait, so that a filter that lets everything through
    /// would seem to hold it.
    pub fn solve(&mut self, network: &Network, blocked: &BitSlice) -> Result<Permeability, FlowError> {
        self.solve_as(network, blocked, false)
    }

    /// The same, as close as rounding lets pressures come: for a reader of every flux.
    ///
    /// # Errors
    /// As [`Flow::solve`], and fluxes that are not known to a hundred-millionth of what passes.
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
        // What leaks through blocked constrictions carries no particle out.
        let is_open = |passage: &Passage| !blocked[passage.exit as usize];
        self.solve_now(network, closely, rho > 0.0, is_open)
    }

    /// Solves for constrictions that keep these parts of their conductance, from 0 to 1: one for each exit,
    /// the same for both of one constriction. All that conduct let particles pass.
    ///
    /// # Errors
    /// As [`Flow::solve`].
    pub fn solve_parts(&mut self, network: &Network, parts: &[f64]) -> Result<Permeability, FlowError> {
        assert_eq!(parts.len(), self.open.len(), "one part for each exit");
        // What was blocked leads on again, however much of it leaked.
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
        self.keep_factors(network, &changed, is_open_again);
        self.solve_now(network, false, false, |_| true)
    }

    /// Solves for conductances as they are; `leaks`: some conduct that are not open to particles.
    fn solve_now(
        &mut self,
        network: &Network,
        closely: bool,
        leaks: bool,
        is_open: impl Fn(&Passage) -> bool + Sync,
    ) -> Result<Permeability, FlowError> {
        let undirected = network.undirected.as_ref();
        if network.reservoir().is_none() {
            return Ok(Permeability { conductance: 0.0, k_mm2: None });
        }
        let meets = self.meet_now();
        if self.kept.is_none() && self.thick.is_none() {
            self.inside = meets.iter().map(|&meets| meets == THROUGH).collect();
        }
        let leads_through = meets.contains(&THROUGH);
        let is_passed = leads_through && (!leaks || self.meets(is_open).contains(&THROUGH));
        let within = if is_thick(network) { CONVERGED_THICK } else { CONVERGED };
        self.find_pressures(network, &meets, within)?;
        if leads_through && (closely || !self.is_known(network) || is_passed && self.part(network) < CLEAR) {
            // Where they come no closer in time, what there is has to do.
            let _ = self.find_pressures(network, &meets, CLOSEST);
        }
        let through = self.through(network);
        let tells = self.is_known(network)
            && (!is_passed || self.part(network) >= RESOLVED)
            && (!closely || self.missing <= CLOSELY * through);
        if leads_through && !tells {
            return Err(FlowError::Unresolved { off: self.missing / through.abs() });
        }
        let conductance = if leads_through && through > 0.0 { through } else { 0.0 };
        self.most = self.most.max(conductance);
        let factor = undirected.and_then(|u| u.permeability_mm2);
        Ok(Permeability { conductance, k_mm2: factor.map(|factor| factor * conductance) })
    }

    /// What each void hangs together with, by way of other voids and of such constrictions that conduct.
    fn meets(&self, is_way: impl Fn(&Passage) -> bool + Sync) -> Vec<Meets> {
        let voids = self.pressure.len() - 1;
        let mut within = Together::of(voids);
        let conducts = conducting(&self.open);
        let is_way = |passage: &Passage| conducts(passage) && is_way(passage);
        self.passages.join_within(&mut within, |_| true, is_way);
        self.passages.meet(voids, within, is_way)
    }

    /// The same by all that conduct; of a thick network from what hung together before.
    fn meet_now(&mut self) -> Vec<Meets> {
        match &mut self.thick {
            Some(thick) => thick.meet(&self.passages, conducting(&self.open)),
            None => self.meets(|_| true),
        }
    }

    /// Conducts as these blocked constrictions let it.
    fn set_blocked(&mut self, network: &Network, blocked: &BitSlice, rho: f64) {
        assert_eq!(blocked.len(), self.open.len(), "one bit for each exit");
        if std::mem::take(&mut self.is_of_parts) {
            // Nothing is blocked, and what was narrowed is whole again.
            (self.kept, self.thick) = (None, None);
            self.open.iter_mut().enumerate().for_each(|(c, open)| *open = whole(network, c));
        }
        let mut changed = std::mem::replace(&mut self.blocked, blocked.to_bitvec());
        changed ^= blocked;
        let is_open_again = changed.iter_ones().any(|c| !blocked[c]);
        self.keep_factors(network, &changed, is_open_again);
        for c in changed.iter_ones() {
            self.open[c] = if blocked[c] { rho * whole(network, c) } else { whole(network, c) };
        }
    }

    /// Keeps factors where few exits have changed since they were made, and none has opened again.
    fn keep_factors(&mut self, network: &Network, changed: &BitSlice, is_open_again: bool) {
        let kept_until = if is_thick(network) { KEPT_UNTIL_THICK } else { KEPT_UNTIL };
        if let Some(kept) = &mut self.kept {
            kept.closed += changed.count_ones();
            if is_open_again || kept.closed * kept_until > network.constrictions() {
                self.kept = None;
            }
        }
        if is_open_again {
            self.thick = None;
        }
        if let Some(thick) = &mut self.thick {
            thick.change(&self.passages, |exit| changed[exit]);
        }
    }

    /// Pressures of all voids, within so much of the inflow.
    fn find_pressures(&mut self, network: &Network, meets: &[Meets], within: f64) -> Result<(), FlowError> {
        let Some(reservoir) = network.reservoir() else { return Ok(()) };
        let (fit, turned) = match self.refilled(meets, reservoir) {
            Some((mut thick, changed)) => {
                let solved = thick.improve(&mut self.pressure, within, &changed);
                let fit = self.solve_system(network, &mut thick.system, within)?;
                self.thick = Some(thick);
                (fit, solved.filter(|_| fit.rounds == 0))
            }
            None => {
                let mut system = self.system(meets, reservoir);
                let fit = self.solve_system(network, &mut system, within)?;
                // One slab has no other far away.
                if is_thick(network) && self.passages.slabs().number() > 1 {
                    self.thick = Some(Thick::of(system, &self.passages, meets, conducting(&self.open)));
                }
                (fit, None)
            }
        };
        self.turn(turned.as_deref(), reservoir);
        // Water flows where it comes in and gets out; elsewhere it stands under the pressure of the one side.
        for (pressure, &meets) in self.pressure.iter_mut().zip(meets) {
            if meets != THROUGH {
                *pressure = f64::from(u8::from(meets.reservoir));
            }
        }
        self.pressure[reservoir as usize] = 1.0;
        self.missing = fit.missing;
        // What is asked for, but where rounding allows no more.
        let asked = within.max(ROUNDING);
        self.accuracy = if fit.residual <= 2.0 * asked { asked } else { fit.residual };
        Ok(())
    }

    /// Flow times viscosity in from the reservoir.
    fn through(&self, network: &Network) -> f64 {
        let Some(reservoir) = network.reservoir() else { return 0.0 };
        network.exits(reservoir).map(|c| self.flux(reservoir, c)).sum()
    }

    /// Mean flux of an inlet over what the residual may stand for.
    fn part(&self, network: &Network) -> f64 {
        let Some(reservoir) = network.reservoir() else { return 0.0 };
        let inlets = network.exits(reservoir);
        self.through(network) / inlets.len().max(1) as f64 / self.residual_of(inlets)
    }

    /// Whether the flow is known, over the most that there was.
    fn is_known(&self, network: &Network) -> bool {
        self.missing <= KNOWN * self.most.max(self.through(network))
    }

    /// What a thick network keeps, with the equations of now, and what had changed by slab; none where the
    /// numbers of its equations would be too small.
    fn refilled(&mut self, meets: &[Meets], reservoir: u32) -> Option<(Thick, Vec<usize>)> {
        let mut thick = self.thick.take()?;
        let changed = thick.take_changed();
        let is_wanted = |at| changed.get(at).is_none_or(|&changed| changed > 0);
        self.fill(&mut thick.system, is_wanted, meets, reservoir);
        thick.system.is_in_range().then_some((thick, changed))
    }

    /// Pressures that solve a system, within so much of the inflow.
    fn solve_system(
        &mut self,
        network: &Network,
        system: &mut System,
        within: f64,
    ) -> Result<Fit, FlowError> {
        Ok(system.solve(&mut self.pressure, network.layers(), within, &mut self.kept)?)
    }

    /// Water has turned in these slabs and the cuts beside them, or everywhere.
    fn turn(&mut self, slabs: Option<&[bool]>, reservoir: u32) {
        let Some(slabs) = slabs else {
            self.turned = Turned::all(self.pressure.len() - 1);
            return;
        };
        for (slab, _) in slabs.iter().enumerate().filter(|&(_, &has_turned)| has_turned) {
            self.passages.slabs().around(slab).for_each(|void| self.turned.add(void));
        }
        // It leads into the first alone.
        if slabs.first() == Some(&true) {
            self.turned.add(reservoir);
        }
    }

    /// The equations of the voids that water flows through, with a row for each that is `inside`: an empty
    /// one where none flows any more.
    fn system(&self, meets: &[Meets], reservoir: u32) -> System {
        let inside = |void: u32| self.inside[void as usize];
        let passages = &self.passages;
        let mut system = System::of(passages.slabs(), inside, |at| passages.of_slab(at).len());
        self.fill(&mut system, |_| true, meets, reservoir);
        system
    }

    /// Fills pieces of the equations.
    fn fill(
        &self,
        system: &mut System,
        is_wanted: impl Fn(usize) -> bool + Sync,
        meets: &[Meets],
        reservoir: u32,
    ) {
        let outside = meets.len() as u32;
        system.fill(is_wanted, |at, joining| {
            for passage in
                self.passages.of_slab(at).iter().filter(|passage| meets[passage.one as usize] == THROUGH)
            {
                let open = self.open[passage.exit as usize];
                if open <= 0.0 {
                    continue;
                }
                if passage.other == reservoir {
                    joining.hold(passage.one, open, 1.0);
                } else if passage.other == outside {
                    joining.hold(passage.one, open, 0.0);
                } else {
                    joining.join(passage.one, passage.other, open);
                }
            }
        });
    }

    /// Flux that the residual may stand for.
    fn residual_of(&self, inlets: std::ops::Range<usize>) -> f64 {
        let largest = inlets.clone().map(|c| self.open[c]).fold(0.0, f64::max);
        if largest == 0.0 {
            return 0.0;
        }
        // A power of two changes no digit, and squares of very large and very small numbers are none.
        let unit = libm::scalbn(1.0, -libm::ilogb(largest).max(-1000));
        let square = |c: usize| (self.open[c] * unit) * (self.open[c] * unit);
        self.accuracy * inlets.map(square).sum::<f64>().sqrt() / unit
    }

    /// Gives each exit of the network its weight by the flow that was solved last, where water has turned
    /// since this was done before; what was blocked then has none. Which voids these are.
    pub fn direct(&mut self, network: &mut Network) -> Turned {
        let turned = std::mem::replace(&mut self.turned, Turned::none(network.voids()));
        let Some(reservoir) = network.reservoir() else { return turned };
        let rule = network.exit_rule();
        let inlets = network.exits(reservoir);
        let through = self.through(network);
        // Nor is one that the residual may stand for.
        let least = (NO_FLUX * through / inlets.len().max(1) as f64).max(self.residual_of(inlets));
        let Network { exit_begin, diameter, undirected, .. } = network;
        let mut left = &mut undirected.as_mut().expect("it has a reservoir").weight[..];
        let (mut parts, mut first_left) = (Vec::new(), 0);
        for voids in turned.groups() {
            let begin = &exit_begin[voids.start as usize..=voids.end as usize];
            let [first, last] = [begin[0], begin[begin.len() - 1]];
            let (weights, after) =
                left[(first - first_left) as usize..].split_at_mut((last - first) as usize);
            parts.push((voids.start, begin, weights));
            (left, first_left) = (after, last);
        }
        each(&mut parts, |_, (first, begin, weights)| {
            let exits_before = begin[0];
            for (void, exits) in (*first..).zip(begin.windows(2)) {
                for exit in exits[0]..exits[1] {
                    let (c, area) = (exit as usize, f64::from(diameter[exit as usize]));
                    let is_open = f64::from(u8::from(!self.blocked[c]));
                    let weight = rule.weight(area * area, self.flux(void, c), least);
                    weights[(exit - exits_before) as usize] = is_open * weight;
                }
            }
        });
        turned
    }
}

/// Conductance of an exit while it is open.
fn whole(network: &Network, exit: usize) -> f64 {
    if network.diameter[exit] == 0.0 { 0.0 } else { network.conductance(exit) }
}

/// Whether a constriction conducts, by the conductance of each exit.
fn conducting(open: &[f64]) -> impl Fn(&Passage) -> bool + Sync + '_ {
    |passage| open[passage.exit as usize] > 0.0
}

fn is_thick(network: &Network) -> bool {
    network.layers() >= THICK
}

#[cfg(test)]
mod tests;
