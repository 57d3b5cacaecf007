//! Water through a network: pressures, fluxes, and how well the whole conducts.
//!
//! At every void what flows in flows out, `sum over its constrictions of g (p - p_other) = 0`, with pressure
//! 1 in the reservoir and 0 behind the filter. A blocked constriction keeps a part `rho` of its conductance.
//! The system is symmetric and positive, and is solved by conjugate gradients with a modified incomplete
//! Cholesky factor, from the last answer on. Sums run over fixed blocks in a fixed order, so that an answer
//! is the same to the bit on any number of threads.

use bitvec::slice::BitSlice;
use rayon::prelude::*;

use super::coarse::{Coarse, MOST_PARTS};
use super::{END, Network};

/// The residual is below this part of what flows in.
const CONVERGED: f64 = 1e-10;

/// The residual that is taken, as part of what flows in, where rounding lets it come no closer.
const BEST_OF_ROUNDING: f64 = 1e-6;

/// A flux below this part of what an inlet passes on average is none: pressures are no more exact.
const NO_FLUX: f64 = 1e-8;

/// The mean flux of an inlet is at least so many times what the residual may stand for.
const RESOLVED: f64 = 30.0;

/// Rounds after which a system that has not converged is given up, for each layer and a hundred besides.
const ROUNDS: usize = 100;

/// Part of what would be filled in that is taken from the diagonal: all of it converges fastest, but where
/// voids end dead it would leave nothing.
const FILL_TAKEN: f64 = 0.97;

/// Entries whose sum is made at once: fixed, so that threads change nothing.
const BLOCK: usize = 1 << 12;

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
        let from_reservoir = self.joined(network, reservoir, reservoir);
        let to_end = self.joined(network, reservoir, network.voids() as u32);
        let inside: Vec<bool> = from_reservoir.iter().zip(&to_end).map(|(a, b)| *a && *b).collect();
        for (void, pressure) in self.pressure.iter_mut().enumerate().take(network.voids()) {
            if !inside[void] && void != reservoir as usize {
                *pressure = f64::from(u8::from(from_reservoir[void]));
            }
        }
        let system = System::new(network, self, &inside, reservoir);
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

    /// Whether the flow that was solved last tells where water goes. Where it does not, every flux counts as
    /// none, and all particles would wait: a filter that lets everything through would seem to hold it.
    ///
    /// # Errors
    /// Open ways lead through the network, but conductances of the inlets are so large that rounding hides
    /// what passes.
    pub fn resolved(&self, network: &Network) -> Result<(), FlowError> {
        let Some(reservoir) = network.reservoir() else { return Ok(()) };
        let outside = network.voids() as u32;
        let inlets = network.exits(reservoir);
        let (from, to) =
            (self.joined(network, reservoir, reservoir), self.joined(network, reservoir, outside));
        let leads_through = from.iter().zip(&to).any(|(from, to)| *from && *to);
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

    /// Voids that hang together with one side, the reservoir or the end, without the other.
    fn joined(&self, network: &Network, reservoir: u32, side: u32) -> Vec<bool> {
        let outside = network.voids() as u32;
        let mut joined = vec![false; network.voids()];
        let mut stack: Vec<u32> = Vec::new();
        for void in (0..outside).filter(|&v| v != reservoir) {
            if network.exits(void).any(|c| self.open[c] > 0.0 && self.other[c] == side) {
                joined[void as usize] = true;
                stack.push(void);
            }
        }
        while let Some(void) = stack.pop() {
            for c in network.exits(void).filter(|&c| self.open[c] > 0.0) {
                let to = self.other[c];
                if to != reservoir && to != outside && !std::mem::replace(&mut joined[to as usize], true) {
                    stack.push(to);
                }
            }
        }
        joined
    }
}

/// The equations of the voids inside, as columns: row `i` has its neighbours before it, then those after it.
pub(super) struct System {
    /// Void by row.
    void: Vec<u32>,
    begin: Vec<u32>,
    /// First neighbour after the row itself.
    after: Vec<u32>,
    row: Vec<u32>,
    conductance: Vec<f64>,
    diagonal: Vec<f64>,
    /// Flow in from the reservoir at pressure 1.
    inflow: Vec<f64>,
    /// Reciprocal of the diagonal of the incomplete factor.
    pivot: Vec<f64>,
    coarse: Option<Coarse>,
}

impl System {
    fn new(network: &Network, flow: &Flow, inside: &[bool], reservoir: u32) -> Self {
        let outside = network.voids() as u32;
        let of = |v: u32, neighbours: &mut Vec<(u32, f64)>| {
            let (mut diagonal, mut inflow) = (0.0, 0.0);
            for c in network.exits(v).filter(|&c| flow.open[c] > 0.0) {
                let (to, g) = (flow.other[c], flow.open[c]);
                diagonal += g;
                if to == reservoir {
                    inflow += g;
                } else if to != outside {
                    neighbours.push((to, g));
                }
            }
            (diagonal, inflow)
        };
        let layers = network.layers().max(1);
        let part = |void: u32| {
            let layer = (network.layer_of()[void as usize] as usize).min(layers - 1);
            (layer * layers.min(MOST_PARTS) / layers) as u32
        };
        Self::of_voids(inside, part, of)
    }

    /// The equations of the voids `inside`, which belong to parts; `of` gives the diagonal and the right side
    /// of a void, and its neighbours with their conductances, those that are not inside at pressure 0.
    pub(super) fn of_voids(
        inside: &[bool],
        part: impl Fn(u32) -> u32,
        of: impl Fn(u32, &mut Vec<(u32, f64)>) -> (f64, f64),
    ) -> Self {
        const NONE: u32 = u32::MAX;
        let void: Vec<u32> = (0u32..).zip(inside).filter(|(_, inside)| **inside).map(|(v, _)| v).collect();
        let mut row_of = vec![NONE; inside.len()];
        void.iter().zip(0..).for_each(|(&v, row)| row_of[v as usize] = row);
        let mut system = Self {
            begin: vec![0],
            after: Vec::with_capacity(void.len()),
            row: Vec::new(),
            conductance: Vec::new(),
            diagonal: Vec::with_capacity(void.len()),
            inflow: Vec::with_capacity(void.len()),
            pivot: Vec::new(),
            coarse: None,
            void,
        };
        let (mut all, mut neighbours) = (Vec::new(), Vec::<(u32, f64)>::new());
        for (own, &v) in (0u32..).zip(&system.void) {
            all.clear();
            neighbours.clear();
            let (diagonal, inflow) = of(v, &mut all);
            for &(to, g) in all.iter().filter(|(to, _)| row_of[*to as usize] != NONE) {
                let to = row_of[to as usize];
                match neighbours.iter_mut().find(|(other, _)| *other == to) {
                    Some((_, sum)) => *sum += g,
                    None => neighbours.push((to, g)),
                }
            }
            neighbours.sort_unstable_by_key(|&(to, _)| to);
            let before = neighbours.partition_point(|&(to, _)| to < own);
            system.after.push((system.row.len() + before) as u32);
            system.row.extend(neighbours.iter().map(|&(to, _)| to));
            system.conductance.extend(neighbours.iter().map(|&(_, g)| g));
            system.begin.push(system.row.len() as u32);
            system.diagonal.push(diagonal);
            system.inflow.push(inflow);
        }
        system.normalise();
        system.factor();
        let parts = system.void.iter().map(|&v| part(v)).collect();
        let coarse = Coarse::new(parts, |entry| system.entries(entry));
        system.coarse = Some(coarse);
        system
    }

    /// Divides both sides by a power of four, which changes no digit of a solution, so that squares of very
    /// large and very small conductances are numbers still.
    fn normalise(&mut self) {
        let largest = self.diagonal.iter().fold(0.0, |a: f64, &b| a.max(b));
        if largest > 0.0 && largest.is_finite() {
            // An even power: the coarse system has square roots of the entries.
            let unit = libm::scalbn(1.0, -(libm::ilogb(largest).max(-1000) & !1));
            let sides = self.conductance.iter_mut().chain(&mut self.diagonal).chain(&mut self.inflow);
            sides.for_each(|side| *side *= unit);
        }
    }

    /// Modified incomplete Cholesky without fill in (Gustafsson 1978, doi:10.1007/BF01931691): only the
    /// diagonal differs from that of the system itself, and nearly all that would be filled in is taken from
    /// it.
    fn factor(&mut self) {
        let mut pivot: Vec<f64> = Vec::with_capacity(self.diagonal.len());
        let after = |i: usize| self.after[i] as usize..self.begin[i + 1] as usize;
        let sums: Vec<f64> =
            (0..self.diagonal.len()).map(|i| self.conductance[after(i)].iter().sum()).collect();
        for i in 0..self.diagonal.len() {
            let before = self.begin[i] as usize..self.after[i] as usize;
            let less: f64 = before
                .map(|k| {
                    let (g, j) = (self.conductance[k], self.row[k] as usize);
                    g * pivot[j] * (g + FILL_TAKEN * (sums[j] - g))
                })
                .sum();
            // Diagonally dominant, so positive but for rounding.
            pivot.push(1.0 / (self.diagonal[i] - less).max(1e-12 * self.diagonal[i]));
        }
        self.pivot = pivot;
    }

    /// Calls back with row, other row and entry.
    fn entries(&self, entry: &mut dyn FnMut(usize, usize, f64)) {
        for i in 0..self.diagonal.len() {
            entry(i, i, self.diagonal[i]);
            for k in self.begin[i] as usize..self.begin[i + 1] as usize {
                entry(i, self.row[k] as usize, -self.conductance[k]);
            }
        }
    }

    /// Conjugate gradients from the pressures that there are, and again from where they end while what they
    /// carry along as the residual has left the true one.
    /// Gives the residual over the inflow.
    pub(super) fn solve(&self, pressure: &mut [f64], layers: usize) -> Result<f64, FlowError> {
        let scale = dot(&self.inflow, &self.inflow).sqrt();
        if self.void.is_empty() || scale == 0.0 {
            return Ok(0.0);
        }
        if !scale.is_finite() {
            return Err(FlowError::NotConverged { rounds: 0, residual: f64::INFINITY });
        }
        let mut x: Vec<f64> = self.void.iter().map(|&v| pressure[v as usize]).collect();
        let (mut rounds, mut before) = (0, f64::INFINITY);
        loop {
            let mut residual = self.residual(&x);
            let size = dot(&residual, &residual).sqrt();
            let is_close = size <= if rounds == 0 { 1.0 } else { 2.0 } * CONVERGED * scale;
            // Closer than rounding lets them come they do not get.
            let is_stuck = size > 0.5 * before && size <= BEST_OF_ROUNDING * scale;
            if is_close || is_stuck {
                self.void.iter().zip(&x).for_each(|(&v, &p)| pressure[v as usize] = p);
                return Ok(size / scale);
            }
            if size > 0.5 * before {
                return Err(FlowError::NotConverged { rounds, residual: size / scale });
            }
            before = size;
            rounds = self.descend(&mut x, &mut residual, scale, rounds, layers)?;
        }
    }

    /// What is missing of the right side.
    fn residual(&self, x: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; x.len()];
        self.times(x, &mut product);
        self.inflow.iter().zip(&product).map(|(b, a)| b - a).collect()
    }

    /// Conjugate gradients until the residual that they carry along is small; the rounds that there were.
    fn descend(
        &self,
        x: &mut [f64],
        residual: &mut [f64],
        scale: f64,
        begun: usize,
        layers: usize,
    ) -> Result<usize, FlowError> {
        let rows = self.void.len();
        let mut product = vec![0.0; rows];
        let mut direction = vec![0.0; rows];
        let mut solved = vec![0.0; rows];
        let mut before = 0.0;
        let most = ROUNDS * (layers + 100);
        for round in begun.. {
            let size = dot(residual, residual).sqrt();
            if size <= CONVERGED * scale {
                return Ok(round);
            }
            if round == most || !size.is_finite() {
                return Err(FlowError::NotConverged { rounds: round, residual: size / scale });
            }
            self.precondition(residual, &mut solved);
            let now = dot(residual, &solved);
            let keep = if round == begun { 0.0 } else { now / before };
            direction.par_chunks_mut(BLOCK).zip(solved.par_chunks(BLOCK)).for_each(|(d, s)| {
                d.iter_mut().zip(s).for_each(|(d, s)| *d = s + keep * *d);
            });
            before = now;
            self.times(&direction, &mut product);
            let step = now / dot(&direction, &product);
            let blocks = x.par_chunks_mut(BLOCK).zip(residual.par_chunks_mut(BLOCK));
            blocks.zip(direction.par_chunks(BLOCK).zip(product.par_chunks(BLOCK))).for_each(
                |((x, r), (d, p))| {
                    x.iter_mut().zip(d).for_each(|(x, d)| *x += step * d);
                    r.iter_mut().zip(p).for_each(|(r, p)| *r -= step * p);
                },
            );
        }
        unreachable!("rounds are counted up to the most")
    }

    /// The matrix times a column.
    fn times(&self, x: &[f64], out: &mut [f64]) {
        out.par_chunks_mut(BLOCK).enumerate().for_each(|(block, out)| {
            for (k, out) in out.iter_mut().enumerate() {
                let i = block * BLOCK + k;
                let of = self.begin[i] as usize..self.begin[i + 1] as usize;
                let others: f64 = self.row[of.clone()]
                    .iter()
                    .zip(&self.conductance[of])
                    .map(|(&j, g)| g * x[j as usize])
                    .sum();
                *out = self.diagonal[i] * x[i] - others;
            }
        });
    }

    /// Solves the incomplete factor, once down and once up, and the coarse system.
    fn precondition(&self, residual: &[f64], out: &mut [f64]) {
        for i in 0..out.len() {
            let before = self.begin[i] as usize..self.after[i] as usize;
            let sum: f64 = before.map(|k| self.conductance[k] * out[self.row[k] as usize]).sum();
            out[i] = self.pivot[i] * (residual[i] + sum);
        }
        for i in (0..out.len()).rev() {
            let after = self.after[i] as usize..self.begin[i + 1] as usize;
            let sum: f64 = after.map(|k| self.conductance[k] * out[self.row[k] as usize]).sum();
            out[i] += self.pivot[i] * sum;
        }
        if let Some(coarse) = &self.coarse {
            coarse.add(residual, out);
        }
    }
}

/// Sum of products, block by block.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let parts: Vec<f64> = a
        .par_chunks(BLOCK)
        .zip(b.par_chunks(BLOCK))
        .map(|(a, b)| a.iter().zip(b).map(|(a, b)| a * b).sum())
        .collect();
    parts.iter().sum()
}
