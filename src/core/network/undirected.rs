//! Networks whose constrictions can be passed both ways, until a rule gives them a direction.
//!
//! A constriction between two voids is an exit of both: two exits that are each other's *twin*, and one
//! blocking closes both. Two more kinds end at the filter's faces: an *inlet* leads from the reservoir, a
//! void of its own and the only start node, into a void; an *outlet* leaves the filter.
//!
//! The reservoir is the last void, so that all others keep their numbers.

use super::exit_rule::{NO_TWIN, Undirected};
use super::{END, ExitRule, Network, NetworkError};

/// Default tolerance of the flow in a walk.
pub const FLOW_TOLERANCE: f64 = 0.03;

/// Tolerances, and the largest difference in eroded mass (percentage points) between walks up to each and
/// walks of tolerance 0: both runs of eleven filters from open to sealed, on a lattice (`src/docs/graph.md`)
/// and on the voids of a packing (`results/graph.md`), rounded up.
const FLOW_ERRORS: [(f64, f64); 4] = [(0.0, 0.0), (FLOW_TOLERANCE, 0.3), (0.1, 0.5), (1.0, 11.0)];

/// Measured error of the eroded mass at a tolerance of the flow (percentage points); `None` above 1, where
/// nothing was measured.
///
/// ```
/// assert_eq!(voidwalk_core::network::flow_error_pp(0.02), Some(0.3));
/// ```
pub fn flow_error_pp(tolerance: f64) -> Option<f64> {
    FLOW_ERRORS.iter().find(|(most, _)| tolerance <= *most).map(|(_, error)| *error)
}

/// Diameter, in units of the network, of a way in that nothing can block.
pub const WIDE: f32 = 1e30;

/// A constriction of an undirected network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Void that it leads from, or the reservoir.
    pub from: LinkEnd,
    /// Void that it leads to, or out of the filter.
    pub to: LinkEnd,
    /// Diameter, in units of the network's reference length.
    pub diameter: f32,
    /// Conductance times viscosity, in any one unit.
    pub conductance: f64,
    /// Direction along the axis of flow: against it, level, or along it if below, at or above 0.
    pub rise: f64,
}

/// An end of a [`Link`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkEnd {
    /// A void.
    Void(u32),
    /// Outside: the reservoir before the filter, or the space behind it.
    Outside,
}

/// Data of an undirected network besides its links.
#[derive(Clone, Debug, Default)]
pub struct LinkedVoids {
    /// Layer by void.
    pub layer: Vec<u32>,
    /// Volume by void, in units of the reference length cubed; empty where it is not known.
    pub volume: Vec<f64>,
    /// Length of one unit of diameter (mm).
    pub unit_mm: f64,
    /// Rule by which particles choose.
    pub rule: ExitRule,
    /// Part of its conductance that a blocked constriction keeps.
    pub rho: f64,
    /// Factor from the conductance of the whole to its permeability, in mm2.
    pub permeability_mm2: Option<f64>,
}

impl Network {
    /// Builds a network of voids joined by constrictions without a direction of their own.
    ///
    /// # Errors
    /// A diameter or a conductance that is negative or not a number; a void that does not exist; no inlet; no
    /// outlet; no open way from an inlet to an outlet; more exits than 32 bits can number.
    pub fn linked(voids: LinkedVoids, links: &[Link]) -> Result<Self, NetworkError> {
        Ok(Self::linked_numbered(voids, links)?.0)
    }

    /// Builds the network, and lists the exit of each link, the first of two; `u32::MAX` if it has no exit.
    pub(super) fn linked_numbered(
        voids: LinkedVoids,
        links: &[Link],
    ) -> Result<(Self, Vec<u32>), NetworkError> {
        let reservoir = voids.layer.len() as u32;
        check(links, reservoir)?;
        // Two exits by link, or one: from this void, to that one, by this link.
        let mut exits: Vec<(u32, u32, u32)> = Vec::with_capacity(2 * links.len());
        for (i, link) in (0u32..).zip(links) {
            match (link.from, link.to) {
                // A void that meets itself sideways: nothing flows there.
                (LinkEnd::Void(a), LinkEnd::Void(b)) if a == b => {}
                (LinkEnd::Void(a), LinkEnd::Void(b)) => exits.extend([(a, b, i), (b, a, i)]),
                (LinkEnd::Void(a), LinkEnd::Outside) => exits.push((a, END, i)),
                (LinkEnd::Outside, LinkEnd::Void(b)) => exits.extend([(b, reservoir, i), (reservoir, b, i)]),
                (LinkEnd::Outside, LinkEnd::Outside) => {}
            }
        }
        // By void, then in the order of the links.
        exits.sort_by_key(|&(from, _, link)| (from, link));
        let mut begin = vec![0u32; reservoir as usize + 2];
        exits.iter().for_each(|&(from, _, _)| begin[from as usize + 1] += 1);
        (0..=reservoir as usize).for_each(|void| begin[void + 1] += begin[void]);
        let mut twin = vec![NO_TWIN; exits.len()];
        let mut first = vec![NO_TWIN; links.len()];
        for (exit, &(_, _, link)) in (0u32..).zip(&exits) {
            match first[link as usize] {
                NO_TWIN => first[link as usize] = exit,
                other => (twin[other as usize], twin[exit as usize]) = (exit, other),
            }
        }
        let link_at = |link: u32| &links[link as usize];
        let weight = |&(from, to, link): &(u32, u32, u32)| {
            let link = link_at(link);
            let forward = match link.from {
                LinkEnd::Void(a) => a == from && to != reservoir,
                LinkEnd::Outside => from == reservoir,
            };
            let rise = if forward { link.rise } else { -link.rise };
            let area = f64::from(link.diameter) * f64::from(link.diameter);
            // Until water is known to flow nothing leads anywhere.
            if voids.rule == ExitRule::Height && rise > 0.0 { area } else { 0.0 }
        };
        let mut layer = voids.layer;
        layer.push(0);
        let passages = links.iter().filter(|link| link.diameter != WIDE && link.from != link.to).count();
        let network = Self {
            exit_begin: begin,
            target: exits.iter().map(|&(_, to, _)| to).collect(),
            diameter: exits.iter().map(|&(_, _, link)| link_at(link).diameter).collect(),
            start: vec![reservoir],
            layer,
            unit_mm: voids.unit_mm,
            shape: None,
            undirected: Some(Box::new(Undirected {
                twin,
                conductance: exits.iter().map(|&(_, _, link)| link_at(link).conductance).collect(),
                weight: exits.iter().map(weight).collect(),
                rule: voids.rule,
                rho: voids.rho,
                flow_tolerance: FLOW_TOLERANCE,
                volume: voids.volume,
                passages,
                permeability_factor: voids.permeability_mm2,
            })),
        };
        network.leads_through()?;
        Ok((network, first))
    }

    /// This network with another tolerance of the flow in a walk. Water is solved again once the
    /// constrictions that have closed since carried this part of it, summed over the whole filter: at most
    /// this many closed constrictions on the mean way of a particle are unknown to the flow. With 0 it is
    /// solved again as soon as any has closed.
    #[must_use]
    pub fn with_flow_tolerance(mut self, tolerance: f64) -> Self {
        if let Some(undirected) = &mut self.undirected {
            undirected.flow_tolerance = tolerance;
        }
        self
    }

    /// The tolerance of the flow in a walk: [`Network::with_flow_tolerance`].
    pub fn flow_tolerance(&self) -> f64 {
        self.undirected.as_ref().map_or(FLOW_TOLERANCE, |undirected| undirected.flow_tolerance)
    }

    /// The lattice of [`Network::cubic_from_diameters`] without its directions: six neighbours a void. Water
    /// flows through a constriction in proportion to the power `exponent` of its diameter. Into each void of
    /// the first layer leads a way in that nothing can block, with the mean conductance of all constrictions.
    ///
    /// # Errors
    /// Those of [`Network::cubic_from_diameters`] and [`Network::linked`].
    pub fn undirected_lattice(&self, rule: ExitRule, rho: f64, exponent: f64) -> Result<Self, NetworkError> {
        let conductance = |c: usize| match f64::from(self.diameter[c]) {
            0.0 => 0.0,
            d => libm::pow(d, exponent),
        };
        let mean = (0..self.constrictions()).map(conductance).sum::<f64>() / self.constrictions() as f64;
        let mut links = Vec::with_capacity(self.constrictions() + self.start.len());
        let inlet = |&void: &u32| Link {
            from: LinkEnd::Outside,
            to: LinkEnd::Void(void),
            diameter: WIDE,
            conductance: mean,
            rise: 1.0,
        };
        links.extend(self.start.iter().map(inlet));
        for void in 0..self.voids() as u32 {
            for c in self.exits(void) {
                let (to, rise) = match self.target[c] {
                    END => (LinkEnd::Outside, 1.0),
                    to if self.layer[to as usize] == self.layer[void as usize] => (LinkEnd::Void(to), 0.0),
                    to => (LinkEnd::Void(to), 1.0),
                };
                links.push(Link {
                    from: LinkEnd::Void(void),
                    to,
                    diameter: self.diameter[c],
                    conductance: conductance(c),
                    rise,
                });
            }
        }
        let voids = LinkedVoids {
            layer: self.layer.clone(),
            unit_mm: self.unit_mm,
            rule,
            rho,
            ..LinkedVoids::default()
        };
        Self::linked(voids, &links)
    }

    /// The reservoir before the filter, where constrictions have no direction of their own.
    pub fn reservoir(&self) -> Option<u32> {
        self.undirected.as_ref().map(|_| self.start[0])
    }

    /// Rule by which particles choose among exits.
    pub fn exit_rule(&self) -> ExitRule {
        self.undirected.as_ref().map_or(ExitRule::Area, |u| u.rule)
    }

    /// Exit of the other void that is the same constriction.
    #[inline]
    pub fn twin(&self, exit: usize) -> Option<usize> {
        let twin = self.undirected.as_ref()?.twin[exit];
        (twin != NO_TWIN).then_some(twin as usize)
    }

    /// The number of a constriction, whichever way it is passed: the lesser of its exits.
    #[inline]
    pub fn either_way(&self, exit: usize) -> usize {
        self.twin(exit).map_or(exit, |twin| twin.min(exit))
    }

    /// Marks a constriction as blocked, or as open again, both ways.
    pub fn set_blocked(&self, blocked: &mut bitvec::slice::BitSlice, exit: usize, is: bool) {
        blocked.set(exit, is);
        if let Some(twin) = self.twin(exit) {
            blocked.set(twin, is);
        }
    }

    /// Tells if an exit represents its constriction where each is to be counted once: it has no twin, or
    /// comes first; ways in that nothing can block do not count.
    #[inline]
    pub fn counts(&self, exit: usize) -> bool {
        self.diameter[exit] != WIDE && self.twin(exit).is_none_or(|twin| exit < twin)
    }

    /// Constrictions, each counted once, whichever way it can be passed.
    pub fn passages(&self) -> usize {
        self.undirected.as_ref().map_or(self.constrictions(), |u| u.passages)
    }

    /// Voids of the filter: without the reservoir.
    pub fn filter_voids(&self) -> usize {
        self.voids() - usize::from(self.undirected.is_some())
    }

    /// Places by which particles come in: start nodes, or the inlets of the reservoir.
    pub fn entries(&self) -> usize {
        match self.reservoir() {
            Some(reservoir) => self.exits(reservoir).len(),
            None => self.start.len(),
        }
    }

    /// Tells if ways in are no constrictions, so that coming in is no move.
    pub fn entry_is_free(&self) -> bool {
        self.reservoir().is_some_and(|r| self.exits(r).all(|c| self.diameter[c] == WIDE))
    }

    /// Volume by void (units of the reference length cubed); empty where it is not known.
    pub fn volumes(&self) -> &[f64] {
        self.undirected.as_ref().map_or(&[], |u| &u.volume)
    }

    /// Blocked constrictions, each counted once.
    pub fn blocked_count(&self, blocked: &bitvec::slice::BitSlice) -> u64 {
        match &self.undirected {
            None => blocked.count_ones() as u64,
            Some(_) => blocked.iter_ones().filter(|&c| self.counts(c)).count() as u64,
        }
    }

    /// Refuses a network that no water can pass.
    fn leads_through(&self) -> Result<(), NetworkError> {
        let nowhere = |problem: &str| NetworkError::Unlinked { problem: problem.into() };
        let Some(reservoir) = self.reservoir() else { return Ok(()) };
        if self.exits(reservoir).is_empty() {
            return Err(nowhere("it has no inlet: no constriction leads in from the reservoir"));
        }
        if !self.target.contains(&END) {
            return Err(nowhere("it has no outlet: no constriction leads out of the filter"));
        }
        let open = |c: usize| self.diameter[c] > 0.0 && self.conductance(c) > 0.0;
        match self.leads_out_by(open) {
            true => Ok(()),
            false => Err(nowhere("no open way leads from an inlet to an outlet")),
        }
    }

    /// Conductance times viscosity of an exit; 0 on a network whose constrictions have a direction.
    pub fn conductance(&self, exit: usize) -> f64 {
        self.undirected.as_ref().map_or(0.0, |u| u.conductance[exit])
    }
}

fn check(links: &[Link], voids: u32) -> Result<(), NetworkError> {
    if links.len() as u64 * 2 >= u64::from(END) {
        return Err(NetworkError::Unlinked {
            problem: format!("{} constrictions are too many", links.len()),
        });
    }
    for (i, link) in links.iter().enumerate() {
        if !(link.diameter.is_finite() && link.diameter >= 0.0) {
            return Err(NetworkError::Diameter { constriction: i, value: link.diameter });
        }
        if !(link.conductance.is_finite() && link.conductance >= 0.0) {
            return Err(NetworkError::Conductance { constriction: i, value: link.conductance });
        }
        for end in [link.from, link.to] {
            if let LinkEnd::Void(void) = end
                && void >= voids
            {
                let problem = format!("constriction {i} leads to void {void}, but there are {voids} voids");
                return Err(NetworkError::Unlinked { problem });
            }
        }
    }
    Ok(())
}
