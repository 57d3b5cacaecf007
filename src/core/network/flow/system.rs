//! Equations for the pressures in a network of conductances, their solution by conjugate gradients, and
//! all criteria for a solved flow, each with the error that it prevents.
//!
//! Sums run in a fixed order, so that solutions are the same to the bit with any instruction set.

use super::elimination::{Factor, Link};
use std::ops::Range;

/// Reason why the flow is unknown.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FlowError {
    /// Conductances that differ too much for pressures to be resolved.
    #[error(
        "the flow through the network cannot be solved: after {rounds} rounds the residual is \
         still {residual:.1e} \
         of the inflow, because conductances lie too many orders apart"
    )]
    NotConverged {
        /// Number of rounds.
        rounds: usize,
        /// Residual divided by the inflow.
        residual: f64,
    },
    /// Conductances that differ so much that rounding hides the flow.
    #[error(
        "the flow through the network cannot be determined: because of rounding, inflow and outflow of the \
         voids differ by {off:.1e} of the flow through the network. Conductances lie too many orders apart: \
         leave out constrictions that conduct many orders more than the ways through, also in dead ends, \
         since a way in that nothing can block has the mean conductance of all constrictions"
    )]
    Unresolved {
        /// Sum of the imbalances of all voids, divided by the flow through the filter.
        off: f64,
    },
}

/// Residual of conjugate gradients, as a fraction of the inflow. Prevents wrong pressures: fluxes are then
/// accurate to ten digits.
pub(in crate::network) const CONVERGED: f64 = 1e-10;

/// Residual if fluxes are small compared with the inflow: the minimum that rounding allows.
pub(super) const CLOSEST: f64 = f64::EPSILON / 4.0;

/// Possible rounding error of the sums of each row, as a fraction of the flow from its known pressures.
pub(super) const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Largest residual accepted, as a fraction of the inflow, if rounding prevents a smaller one.
const BEST_OF_ROUNDING: f64 = 1e-6;

/// Minimum ratio of the mean inlet flux to the flux that the residual may account for. Below it pressures
/// are solved more accurately, and finally by elimination. Prevents fluxes of a clogging filter that are
/// mostly residual.
pub(super) const CLEAR: f64 = 1e4;

/// Minimum of the same ratio if neither is possible; below it the flow is refused. Prevents a filter from
/// seeming to hold because the fluxes do not show where particles go.
pub(super) const RESOLVED: f64 = 30.0;

/// Largest possible error of fluxes, relative to the largest conductance of the network so far; above it
/// the flow is refused.
pub(super) const KNOWN: f64 = 5e-7;

/// Largest possible error of fluxes, relative to the current flow, for uses of individual fluxes.
pub(super) const CLOSELY: f64 = 1e-8;

/// Fluxes below this fraction of the mean inlet flux count as zero, except the largest flux out of a void.
/// Prevents paths that exist only because of the residual.
pub(super) const NO_FLUX: f64 = 1e-8;

/// Largest possible error of a flux found by elimination, relative to the flow through the filter.
pub(super) const ELIMINATED: f64 = 1e-12;

/// Maximum number of rounds of conjugate gradients for each layer, plus a hundred layers; after that the
/// flow is refused or found by elimination. Prevents an endless search.
pub(super) const ROUNDS: usize = 100;

/// Maximum number of rounds with the factor of another system: this number, or this multiple of the rounds
/// that its own system took, whichever is larger. Prevents the use of a factor that no longer fits.
const ROUNDS_OF_ANOTHER: [usize; 2] = [60, 3];

/// A factor is kept until more than one in this many exits have closed; until then the extra rounds cost
/// less than a new factor.
pub(super) const KEPT_UNTIL: usize = 100;

/// Maximum number of pairs of neighbours in an elimination (some seconds).
pub(super) const PAIRS: usize = 50_000_000;

/// Number of parallel sums; fixed, so that results do not depend on the instruction set.
const SIDE_BY_SIDE: usize = 8;

const NONE: u32 = u32::MAX;

/// Accuracy of pressures in their equations.
#[derive(Clone, Copy, Debug)]
pub(in crate::network) struct Fit {
    /// Residual divided by the inflow, both as roots of sums of squares.
    pub(crate) residual: f64,
    /// Sum of the imbalances of all voids, including rounding. It bounds the error of every flux and of every
    /// sum of fluxes through a cut, as a unit of flow fed into a void passes no constriction more than once.
    pub(crate) missing: f64,
}

/// Factor reused for successive systems with the same rows.
pub(in crate::network) struct Kept {
    factor: Factor,
    pub(crate) rounds: usize,
    pub(crate) closed: usize,
}

/// Equations of the voids inside, one row for each.
pub(in crate::network) struct System {
    void: Vec<u32>,
    /// Row of each void, or [`NONE`].
    row_of: Vec<u32>,
    links: Vec<Link>,
    /// Conductance to known pressures, by row.
    ground: Vec<f64>,
    /// Inflow from known pressures, by row.
    inflow: Vec<f64>,
}

/// Vectors of conjugate gradients, by row.
struct Columns {
    pressure: Vec<f64>,
    /// Right-hand side minus the matrix times the pressures.
    residual: Vec<f64>,
    direction: Vec<f64>,
    /// Matrix times one of these columns.
    product: Vec<f64>,
    /// Residual after the preconditioner.
    solved: Vec<f64>,
    scratch: Vec<f64>,
}

impl System {
    /// Builds the equations of the `inside` ones of this many voids; `fill` joins them.
    pub(in crate::network) fn new(
        voids: usize,
        inside: impl Fn(u32) -> bool,
        fill: impl FnOnce(&mut Self),
    ) -> Self {
        let void: Vec<u32> = (0..voids as u32).filter(|&void| inside(void)).collect();
        let mut row_of = vec![NONE; voids];
        void.iter().zip(0..).for_each(|(&void, row)| row_of[void as usize] = row);
        let zeros = vec![0.0; void.len()];
        let mut system = Self { void, row_of, links: Vec::new(), ground: zeros.clone(), inflow: zeros };
        fill(&mut system);
        system
    }

    fn row(&self, void: u32) -> Option<u32> {
        Some(self.row_of[void as usize]).filter(|&row| row != NONE)
    }

    /// Joins two voids. A void that is not inside has pressure 0; links between two such voids, and from a
    /// void to itself, are ignored.
    pub(in crate::network) fn join(&mut self, one: u32, other: u32, conductance: f64) {
        match [one, other].map(|void| self.row(void)) {
            [None, None] => {}
            [Some(row), None] | [None, Some(row)] => self.ground[row as usize] += conductance,
            [Some(one), Some(other)] if one == other => {}
            [Some(one), Some(other)] => self.links.push(Link { one, other, conductance }),
        }
    }

    /// Joins an inside void to a known pressure.
    pub(super) fn hold(&mut self, void: u32, conductance: f64, pressure: f64) {
        let row = self.row(void).expect("it is inside") as usize;
        self.ground[row] += conductance;
        self.inflow[row] += conductance * pressure;
    }

    /// Adds an inflow to a void, if it is inside.
    pub(in crate::network) fn feed(&mut self, void: u32, inflow: f64) {
        if let Some(row) = self.row(void) {
            self.inflow[row as usize] += inflow;
        }
    }

    /// Multiplies both sides by a power of two, so that squares of very large and very small conductances
    /// stay finite and positive; the solution keeps every digit. Returns that power.
    fn normalise(&mut self) -> f64 {
        let mut diagonal = self.ground.clone();
        for link in &self.links {
            diagonal[link.one as usize] += link.conductance;
            diagonal[link.other as usize] += link.conductance;
        }
        let largest = diagonal.into_iter().fold(0.0, f64::max);
        if !(largest > 0.0 && largest.is_finite()) {
            return 1.0;
        }
        let unit = libm::scalbn(1.0, -libm::ilogb(largest).max(-1000));
        let sides = self.ground.iter_mut().chain(&mut self.inflow);
        sides.chain(self.links.iter_mut().map(|link| &mut link.conductance)).for_each(|g| *g *= unit);
        unit
    }

    /// Runs conjugate gradients from the present pressures, and restarts them while the updated residual
    /// differs from the true one, until the true residual is about `within` of the inflow or rounding
    /// prevents a smaller one. `kept` holds the factor of a similar system; if it is empty or takes too
    /// many rounds, a factor of this system is made and stored there.
    pub(in crate::network) fn solve(
        mut self,
        pressure: &mut [f64],
        layers: usize,
        within: f64,
        kept: &mut Option<Kept>,
    ) -> Result<Fit, FlowError> {
        let unit = self.normalise();
        let in_unit = |fit: Fit| Fit { missing: fit.missing / unit, ..fit };
        let scale = dot(&self.inflow, &self.inflow).sqrt();
        if self.void.is_empty() || scale == 0.0 {
            let mut columns = self.columns(pressure);
            self.find_residual(&mut columns);
            return Ok(in_unit(self.fit(&columns, 0.0)));
        }
        if !scale.is_finite() {
            return Err(FlowError::NotConverged { rounds: 0, residual: f64::INFINITY });
        }
        if let Some(Kept { factor, rounds, closed }) = kept.take() {
            let [least, times] = ROUNDS_OF_ANOTHER;
            let most = least.max(times * rounds);
            let mut factor = Some(factor);
            if let Ok((fit, _)) = self.solve_within(pressure, scale, within, &mut factor, most) {
                *kept = factor.map(|factor| Kept { factor, rounds, closed });
                return Ok(in_unit(fit));
            }
        }
        let mut factor = None;
        let most = ROUNDS * (layers + 100);
        let (fit, rounds) = self.solve_within(pressure, scale, within, &mut factor, most)?;
        *kept = factor.map(|factor| Kept { factor, rounds, closed: 0 });
        Ok(in_unit(fit))
    }

    fn columns(&self, pressure: &[f64]) -> Columns {
        let zeros = || vec![0.0; self.void.len()];
        Columns {
            pressure: self.void.iter().map(|&void| pressure[void as usize]).collect(),
            residual: zeros(),
            direction: zeros(),
            product: zeros(),
            solved: zeros(),
            scratch: zeros(),
        }
    }

    /// Accuracy of the pressures of these columns, given their residual divided by the inflow.
    fn fit(&self, columns: &Columns, residual: f64) -> Fit {
        let off: f64 = columns.residual.iter().copied().map(f64::abs).sum();
        let held = self.ground.iter().zip(&columns.pressure).map(|(ground, p)| (ground * p).abs());
        let known = held.sum::<f64>() + self.inflow.iter().copied().map(f64::abs).sum::<f64>();
        Fit { residual, missing: off + ROUNDING * known }
    }

    /// Solves within a maximum number of rounds; returns the accuracy and the rounds. If the rounds are
    /// not enough, pressures stay unchanged.
    fn solve_within(
        &self,
        pressure: &mut [f64],
        scale: f64,
        within: f64,
        factor: &mut Option<Factor>,
        most: usize,
    ) -> Result<(Fit, usize), FlowError> {
        let mut columns = self.columns(pressure);
        let (mut rounds, mut before) = (0, f64::INFINITY);
        loop {
            let size = self.find_residual(&mut columns);
            let is_close = size <= if rounds == 0 { 1.0 } else { 2.0 } * within * scale;
            // Rounding prevents a smaller residual.
            let is_stuck = size > 0.5 * before && size <= BEST_OF_ROUNDING * scale;
            if is_close || is_stuck {
                self.void.iter().zip(&columns.pressure).for_each(|(&v, &p)| pressure[v as usize] = p);
                return Ok((self.fit(&columns, size / scale), rounds));
            }
            if size > 0.5 * before {
                return Err(FlowError::NotConverged { rounds, residual: size / scale });
            }
            before = size;
            let factor = factor.get_or_insert_with(|| Factor::new(&self.ground, &self.links));
            rounds = self.descend(factor, &mut columns, [size, scale, within], rounds..most)?;
        }
    }

    /// Multiplies the matrix by a column, link by link: loops over the links of each row would have
    /// unpredictable lengths.
    fn times(&self, x: &[f64], out: &mut [f64]) {
        out.iter_mut().zip(self.ground.iter().zip(x)).for_each(|(out, (ground, x))| *out = ground * x);
        for &Link { one, other, conductance } in &self.links {
            let flow = conductance * (x[one as usize] - x[other as usize]);
            out[one as usize] += flow;
            out[other as usize] -= flow;
        }
    }

    /// Computes the residual; returns its norm.
    fn find_residual(&self, columns: &mut Columns) -> f64 {
        let Columns { pressure, residual, product, .. } = columns;
        self.times(pressure, product);
        let sides = self.inflow.iter().zip(&*product);
        residual.iter_mut().zip(sides).for_each(|(residual, (b, a))| *residual = b - a);
        dot(residual, residual).sqrt()
    }

    /// Runs conjugate gradients until the updated residual, which starts at this norm, is small; returns
    /// the number of rounds.
    fn descend(
        &self,
        factor: &Factor,
        columns: &mut Columns,
        [mut size, scale, within]: [f64; 3],
        allowed: Range<usize>,
    ) -> Result<usize, FlowError> {
        let Columns { pressure, residual, direction, product, solved, scratch } = columns;
        direction.fill(0.0);
        let mut before = 0.0;
        for round in allowed.start.. {
            if size <= within * scale {
                return Ok(round);
            }
            if round >= allowed.end || !size.is_finite() {
                return Err(FlowError::NotConverged { rounds: round, residual: size / scale });
            }
            factor.solve(residual, scratch, solved);
            let now = dot(residual, solved);
            let keep = if round == allowed.start { 0.0 } else { now / before };
            before = now;
            direction.iter_mut().zip(&*solved).for_each(|(d, s)| *d = s + keep * *d);
            self.times(direction, product);
            let step = now / dot(direction, product);
            pressure.iter_mut().zip(&*direction).for_each(|(x, d)| *x += step * d);
            residual.iter_mut().zip(&*product).for_each(|(r, p)| *r -= step * p);
            size = dot(residual, residual).sqrt();
        }
        unreachable!("rounds are counted up to the most")
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; SIDE_BY_SIDE];
    for (a, b) in a.chunks(SIDE_BY_SIDE).zip(b.chunks(SIDE_BY_SIDE)) {
        sums.iter_mut().zip(a.iter().zip(b)).for_each(|(sum, (a, b))| *sum += a * b);
    }
    sums.iter().sum()
}

/// Disjoint groups, each identified by its smallest member. Paths are halved as they are followed, which
/// keeps them short (logarithmic on average) without group sizes.
pub(in crate::network) struct Together {
    /// Member of the same group that is no larger; the smallest points at itself.
    towards: Vec<u32>,
}

impl Together {
    pub(in crate::network) fn new(members: usize) -> Self {
        Self { towards: (0..members as u32).collect() }
    }

    /// Smallest member of the group of `member`.
    pub(in crate::network) fn root(&mut self, mut member: u32) -> u32 {
        loop {
            let next = self.towards[member as usize];
            if next == member {
                return member;
            }
            // Halves the path for next time.
            let after = self.towards[next as usize];
            self.towards[member as usize] = after;
            member = after;
        }
    }

    pub(in crate::network) fn join(&mut self, one: u32, other: u32) {
        let (one, other) = (self.root(one), self.root(other));
        self.towards[one.max(other) as usize] = one.min(other);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Solves this many voids joined by `fill`, starting from this pressure; returns accuracy and pressures.
    fn solved(
        voids: u32,
        from: f64,
        kept: &mut Option<Kept>,
        fill: impl FnOnce(&mut System),
    ) -> (Fit, Vec<f64>) {
        let mut pressure = vec![from; voids as usize];
        let system = System::new(voids as usize, |_| true, fill);
        (system.solve(&mut pressure, voids as usize, CONVERGED, kept).unwrap(), pressure)
    }

    /// Joins voids in a row between known pressures.
    fn chain(system: &mut System, voids: u32) {
        system.hold(0, 1.0, 1.0);
        system.hold(voids - 1, 2.0, 0.0);
        (0..voids - 1).for_each(|void| system.join(void, void + 1, 1.0 + f64::from(void % 7)));
    }

    /// A column of voids that are also joined to themselves gives the same bits; a factor with these loops
    /// would take hundreds of rounds.
    #[test]
    fn nothing_flows_from_a_void_to_itself() {
        const VOIDS: u32 = 500;
        let [with_loops, without] = [50.0, 0.0].map(|loops| {
            let fill = |system: &mut System| {
                chain(system, VOIDS);
                (0..VOIDS).filter(|_| loops > 0.0).for_each(|void| system.join(void, void, loops));
            };
            solved(VOIDS, 0.0, &mut None, fill).1
        });
        assert_eq!(with_loops, without);
        assert!(without.is_sorted_by(|above, below| above > below));
    }

    /// A factor of a different network is replaced by one that fits.
    #[test]
    fn a_factor_that_does_not_serve_is_replaced() {
        const SIDE: u32 = 40;
        let solved_for = |wide: u32, kept: &mut Option<Kept>| {
            let fill = |system: &mut System| {
                for v in 0..SIDE * SIDE {
                    let [x, y] = [v % SIDE, v / SIDE];
                    let conductance = |turn: u32| if (v + turn) % 3 == wide { 1e4 } else { 1.0 };
                    if x + 1 < SIDE {
                        system.join(v, v + 1, conductance(0));
                    }
                    if y + 1 < SIDE {
                        system.join(v, v + SIDE, conductance(1));
                    } else {
                        system.hold(v, 1.0, 0.0);
                    }
                    if y == 0 {
                        system.hold(v, 1.0, 1.0);
                    }
                }
            };
            let (fit, pressure) = solved(SIDE * SIDE, 0.5, kept, fill);
            assert!(fit.residual < 2.0 * CONVERGED, "{fit:?}");
            pressure
        };
        let (mut same, mut other) = (None, None);
        let pressure = solved_for(0, &mut same);
        solved_for(1, &mut other);
        for kept in [&mut same, &mut other] {
            kept.as_mut().unwrap().closed = 7;
        }
        // Equal to the bit: it restarts from the same pressures, with its own new factor.
        assert_eq!(solved_for(0, &mut other), pressure);
        assert_eq!(other.unwrap().closed, 0);
        assert_eq!(solved_for(0, &mut same), pressure);
        assert_eq!(same.unwrap().closed, 7, "one that serves stays");
    }

    /// Links that single precision rounds to 0 beside a dead end of enormous conductance: their voids are
    /// still solved.
    #[test]
    fn conductances_that_single_precision_does_not_tell_apart_are_solved() {
        const VOIDS: u32 = 300;
        let (_, pressure) = solved(VOIDS + 1, 0.0, &mut None, |system| {
            chain(system, VOIDS);
            system.join(VOIDS / 2, VOIDS, 1e50);
        });
        assert!(pressure[..VOIDS as usize].is_sorted_by(|above, below| above > below));
        assert!((pressure[VOIDS as usize] - pressure[VOIDS as usize / 2]).abs() < 1e-6);
    }

    #[test]
    fn what_is_joined_has_one_root() {
        let mut together = Together::new(9);
        for (one, other) in [(8, 3), (3, 5), (5, 8), (2, 7), (7, 4), (6, 4)] {
            together.join(one, other);
        }
        let roots: Vec<u32> = (0..9).map(|void| together.root(void)).collect();
        assert_eq!(roots, [0, 1, 2, 3, 2, 3, 2, 2, 3]);
    }
}
