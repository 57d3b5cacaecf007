//! Networks whose constrictions can be passed in both directions, until a rule gives them one.
//!
//! A constriction between two voids is an exit of both: the two exits are *twins*, and one blocking closes
//! both. An *inlet* leads from the reservoir, a void of its own with the last number and the only start node,
//! into a void; an *outlet* leaves the filter.

use super::exit_rule::{NO_TWIN, Undirected};
use super::file::unlinked;
use super::in_order_of_voids;
use super::{END, ExitRule, Network, NetworkError};

/// Default flow tolerance of a walk.
pub const FLOW_TOLERANCE: f64 = 0.03;

/// Flow tolerances, each with the largest difference in eroded mass (percentage points) from walks of
/// tolerance 0, rounded up. Measured in two runs on each of eleven filters from open to sealed, on a
/// lattice (`src/docs/graph.md`) and on the voids of a packing (`results/graph.md`).
const FLOW_ERRORS: [(f64, f64); 4] = [(0.0, 0.0), (FLOW_TOLERANCE, 0.3), (0.1, 0.5), (1.0, 11.0)];

/// Measured error of the eroded mass at a flow tolerance (percentage points); `None` above 1 (not measured).
///
/// ```
/// assert_eq!(voidwalk_core::network::flow_error_pp(0.02), Some(0.3));
/// ```
pub fn flow_error_pp(tolerance: f64) -> Option<f64> {
    FLOW_ERRORS.iter().find(|(most, _)| tolerance <= *most).map(|(_, error)| *error)
}

/// Diameter of an unblockable way in, in units of the network.
pub const WIDE: f32 = 1e30;

/// A constriction of an undirected network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Upstream void, or the reservoir.
    pub from: LinkEnd,
    /// Downstream void, or the space behind the filter.
    pub to: LinkEnd,
    /// Diameter, in units of the network's reference length.
    pub diameter: f32,
    /// Conductance times viscosity, in any consistent unit.
    pub conductance: f64,
    /// Direction relative to the axis of flow: along it if positive, against it if negative, level if 0.
    pub rise: f64,
}

/// An end of a [`Link`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkEnd {
    /// A void.
    Void(u32),
    /// Outside: reservoir upstream of the filter, or space downstream of it.
    Outside,
}

/// Data of an undirected network besides its links.
#[derive(Clone, Debug, Default)]
pub struct LinkedVoids {
    /// Layer by void.
    pub layer: Vec<u32>,
    /// Volume by void, in units of the reference length cubed; empty if unknown.
    pub volume: Vec<f64>,
    /// Length of one unit of diameter (mm).
    pub unit_mm: f64,
    /// Rule by which particles choose exits.
    pub rule: ExitRule,
    /// Fraction of its conductance that a blocked constriction keeps.
    pub rho: f64,
    /// Factor that converts the conductance of the network to its permeability (mm2).
    pub permeability_mm2: Option<f64>,
}

impl Network {
    /// Builds an undirected network of voids joined by constrictions.
    ///
    /// # Errors
    /// A diameter or a conductance that is negative or NaN; a void that does not exist; no inlet; no
    /// outlet; no open path from an inlet to an outlet; more exits than 32 bits can count.
    pub fn linked(voids: LinkedVoids, links: &[Link]) -> Result<Self, NetworkError> {
        Ok(Self::linked_numbered(voids, links)?.0)
    }

    /// Builds the network and lists the exit of each link (the first of two, or `u32::MAX` if it has no
    /// exit).
    pub(super) fn linked_numbered(
        voids: LinkedVoids,
        links: &[Link],
    ) -> Result<(Self, Vec<u32>), NetworkError> {
        let reservoir = voids.layer.len() as u32;
        check(links, reservoir)?;
        // One or two exits for each link: upstream void, downstream void, link.
        let mut exits: Vec<(u32, u32, u32)> = Vec::with_capacity(2 * links.len());
        for (i, link) in (0u32..).zip(links) {
            match (link.from, link.to) {
                // A void joined to itself across a periodic side carries no flow.
                (LinkEnd::Void(a), LinkEnd::Void(b)) if a == b => {}
                (LinkEnd::Void(a), LinkEnd::Void(b)) => exits.extend([(a, b, i), (b, a, i)]),
                (LinkEnd::Void(a), LinkEnd::Outside) => exits.push((a, END, i)),
                (LinkEnd::Outside, LinkEnd::Void(b)) => exits.extend([(b, reservoir, i), (reservoir, b, i)]),
                (LinkEnd::Outside, LinkEnd::Outside) => {}
            }
        }
        // Sorted by void, then by link.
        exits.sort_by_key(|&(from, _, link)| (from, link));
        let (begin, _) = in_order_of_voids(reservoir as usize + 1, exits.iter().map(|&(from, ..)| from));
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
            // Until the flow is solved, exits have no weight.
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

    /// Sets the flow tolerance of a walk. The flow is solved again once the constrictions that have closed
    /// since the last solution carried this fraction of it, summed over the whole filter: a particle meets
    /// on average at most this many closed constrictions that the flow ignores. With 0 it is solved again
    /// after every closure.
    #[must_use]
    pub fn with_flow_tolerance(mut self, tolerance: f64) -> Self {
        if let Some(undirected) = &mut self.undirected {
            undirected.flow_tolerance = tolerance;
        }
        self
    }

    /// Flow tolerance of a walk: see [`Network::with_flow_tolerance`].
    pub fn flow_tolerance(&self) -> f64 {
        self.undirected.as_ref().map_or(FLOW_TOLERANCE, |undirected| undirected.flow_tolerance)
    }

    /// Undirected version of the lattice of [`Network::cubic_from_diameters`], with six neighbours per
    /// void. The conductance of a constriction is its diameter to the power `exponent`. Each void of the
    /// first layer has an unblockable way in, with the mean conductance of all constrictions.
    ///
    /// # Errors
    /// Errors of [`Network::cubic_from_diameters`] and [`Network::linked`].
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

    /// Reservoir upstream of the filter, if the network is undirected.
    pub fn reservoir(&self) -> Option<u32> {
        self.undirected.as_ref().map(|_| self.start[0])
    }

    /// Rule by which particles choose among exits.
    pub fn exit_rule(&self) -> ExitRule {
        self.undirected.as_ref().map_or(ExitRule::Area, |u| u.rule)
    }

    /// Exit of the neighbouring void through the same constriction.
    #[inline]
    pub fn twin(&self, exit: usize) -> Option<usize> {
        let twin = self.undirected.as_ref()?.twin[exit];
        (twin != NO_TWIN).then_some(twin as usize)
    }

    /// Number of a constriction, the same in both directions: the smaller of its exit numbers.
    #[inline]
    pub fn either_way(&self, exit: usize) -> usize {
        self.twin(exit).map_or(exit, |twin| twin.min(exit))
    }

    /// Marks a constriction as blocked or open, in both directions.
    pub fn set_blocked(&self, blocked: &mut bitvec::slice::BitSlice, exit: usize, is: bool) {
        blocked.set(exit, is);
        if let Some(twin) = self.twin(exit) {
            blocked.set(twin, is);
        }
    }

    /// Tells if an exit is counted when each constriction is counted once: it has no twin or comes before
    /// it. Unblockable ways in are not counted.
    #[inline]
    pub fn counts(&self, exit: usize) -> bool {
        self.diameter[exit] != WIDE && self.twin(exit).is_none_or(|twin| exit < twin)
    }

    /// Number of constrictions, each counted once.
    pub fn passages(&self) -> usize {
        self.undirected.as_ref().map_or(self.constrictions(), |u| u.passages)
    }

    /// Number of voids of the filter, without the reservoir.
    pub fn filter_voids(&self) -> usize {
        self.voids() - usize::from(self.undirected.is_some())
    }

    /// Number of entries for particles: start nodes, or the inlets of the reservoir.
    pub fn entries(&self) -> usize {
        match self.reservoir() {
            Some(reservoir) => self.exits(reservoir).len(),
            None => self.start.len(),
        }
    }

    /// Tells if the ways in are not constrictions, so that entering is not a move.
    pub fn entry_is_free(&self) -> bool {
        self.reservoir().is_some_and(|r| self.exits(r).all(|c| self.diameter[c] == WIDE))
    }

    /// Volume by void (units of the reference length cubed); empty if unknown.
    pub fn volumes(&self) -> &[f64] {
        self.undirected.as_ref().map_or(&[], |u| &u.volume)
    }

    pub(crate) fn blocked_count(&self, blocked: &bitvec::slice::BitSlice) -> u64 {
        match &self.undirected {
            None => blocked.count_ones() as u64,
            Some(_) => blocked.iter_ones().filter(|&c| self.counts(c)).count() as u64,
        }
    }

    fn leads_through(&self) -> Result<(), NetworkError> {
        let Some(reservoir) = self.reservoir() else { return Ok(()) };
        let open = |c: usize| self.diameter[c] > 0.0 && self.conductance(c) > 0.0;
        if self.exits(reservoir).is_empty() {
            return unlinked("it has no inlet: no constriction leads in from the reservoir");
        }
        if !self.target.contains(&END) {
            return unlinked("it has no outlet: no constriction leads out of the filter");
        }
        if self.leads_out_by(open) {
            Ok(())
        } else {
            unlinked("no open way leads from an inlet to an outlet")
        }
    }

    /// Conductance times viscosity of an exit; 0 on a directed network.
    pub fn conductance(&self, exit: usize) -> f64 {
        self.undirected.as_ref().map_or(0.0, |u| u.conductance[exit])
    }
}

fn check(links: &[Link], voids: u32) -> Result<(), NetworkError> {
    if links.len() as u64 * 2 >= u64::from(END) {
        return unlinked(format!("{} constrictions are too many", links.len()));
    }
    for (i, link) in links.iter().enumerate() {
        if !(link.diameter.is_finite() && link.diameter >= 0.0) {
            return Err(NetworkError::diameter(i, link.diameter));
        }
        if !(link.conductance.is_finite() && link.conductance >= 0.0) {
            return Err(NetworkError::Number {
                quantity: "conductance",
                constriction: i,
                value: link.conductance.to_string(),
            });
        }
        for end in [link.from, link.to] {
            if let LinkEnd::Void(void) = end
                && void >= voids
            {
                return unlinked(format!(
                    "constriction {i} leads to void {void}, but there are {voids} voids"
                ));
            }
        }
    }
    Ok(())
}
