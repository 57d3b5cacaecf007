//! The equations of pressures in a network of conductances, and their solution by conjugate gradients.
//!
//! On one thread, and sums run in a fixed order, so that a solution is the same to the bit on any number of
//! threads and with any instructions.

use std::ops::Range;

use super::elimination::Factor;
use super::rest::Link;

/// The residual is below this part of what flows in.
pub(super) const CONVERGED: f64 = 1e-10;

/// Asks for no less than rounding lets them come: a part of what flows in that a residual hardly gets below.
pub(super) const CLOSEST: f64 = f64::EPSILON / 4.0;

/// The residual that is taken, as part of what flows in, where rounding lets it come no closer.
const BEST_OF_ROUNDING: f64 = 1e-6;

/// What sums of each row may lose in rounding, as part of the flow through its known pressures.
pub(super) const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Rounds after which a system that has not converged is given up, for each layer and a hundred besides.
const ROUNDS: usize = 100;

/// The most rounds with a factor of another system: so many, or so many times those that its own system took,
/// whichever is more.
const ROUNDS_OF_ANOTHER: [usize; 2] = [60, 3];

/// Sums that are made side by side: fixed, so that instructions change nothing.
const SIDE_BY_SIDE: usize = 8;

/// Conductances so far apart that numbers do not tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NotConverged {
    /// Rounds.
    pub rounds: usize,
    /// Residual over inflow.
    pub residual: f64,
}

/// How well pressures fit their equations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    /// Residual over the inflow, both as roots of sums of squares.
    pub residual: f64,
    /// What the balances of all voids are off by together, rounding included. No flux, and no sum of fluxes
    /// through a cut, differs by more from that of the exact pressures: a unit of flow that is fed into a
    /// void passes no constriction more than once.
    pub missing: f64,
}

impl Fit {
    /// In the unit of conductance that a system had before it was multiplied by `unit`.
    fn over(self, unit: f64) -> Self {
        Self { missing: self.missing / unit, ..self }
    }
}

/// A factor that serves one system after another of the same rows.
pub(super) struct Kept {
    factor: Factor,
    /// Rounds that the system took that it is of.
    rounds: usize,
    /// Exits that have closed since.
    pub closed: usize,
}

/// The equations of the voids inside: a row for each.
pub(super) struct System {
    /// Void by row.
    void: Vec<u32>,
    /// Row by void, or [`NONE`].
    row_of: Vec<u32>,
    /// Conductances between rows.
    links: Vec<Link>,
    /// Conductance to pressures that are known.
    ground: Vec<f64>,
    /// Flow in from where pressure is known.
    inflow: Vec<f64>,
}

/// No row.
const NONE: u32 = u32::MAX;

impl System {
    /// The voids `inside`, joined with nothing yet; with room for so many links.
    pub(super) fn of_voids(inside: impl Iterator<Item = bool>, links: usize) -> Self {
        let mut void = Vec::new();
        let row = |(v, is_inside): (u32, bool)| {
            is_inside.then(|| void.push(v)).map_or(NONE, |()| void.len() as u32 - 1)
        };
        let row_of: Vec<u32> = (0u32..).zip(inside).map(row).collect();
        let rows = void.len();
        Self {
            void,
            row_of,
            links: Vec::with_capacity(links),
            ground: vec![0.0; rows],
            inflow: vec![0.0; rows],
        }
    }

    /// Joins two voids. One that is not inside has pressure 0, and between two of these nothing is asked; nor
    /// does a void lead to itself.
    pub(super) fn join(&mut self, one: u32, other: u32, conductance: f64) {
        match [one, other].map(|void| self.row_of[void as usize]) {
            [NONE, NONE] => {}
            [row, NONE] | [NONE, row] => self.ground[row as usize] += conductance,
            [one, other] if one == other => {}
            [one, other] => self.links.push(Link { one, other, conductance }),
        }
    }

    /// Joins a void that is inside with a known pressure.
    pub(super) fn hold(&mut self, void: u32, conductance: f64, pressure: f64) {
        let row = self.row_of[void as usize] as usize;
        self.ground[row] += conductance;
        self.inflow[row] += conductance * pressure;
    }

    /// Lets so much flow into a void, if it is inside.
    pub(super) fn feed(&mut self, void: u32, inflow: f64) {
        if let Some(sum) = self.inflow.get_mut(self.row_of[void as usize] as usize) {
            *sum += inflow;
        }
    }

    /// Divides both sides by a power of two, which changes no digit of a solution, so that squares of very
    /// large and very small conductances are numbers still. Gives that power.
    fn normalise(&mut self) -> f64 {
        let mut diagonal = self.ground.clone();
        for link in &self.links {
            diagonal[link.one as usize] += link.conductance;
            diagonal[link.other as usize] += link.conductance;
        }
        let largest = diagonal.iter().fold(0.0, |a: f64, &b| a.max(b));
        if !(largest > 0.0 && largest.is_finite()) {
            return 1.0;
        }
        let unit = libm::scalbn(1.0, -libm::ilogb(largest).max(-1000));
        let sides = self.ground.iter_mut().chain(&mut self.inflow);
        sides.chain(self.links.iter_mut().map(|link| &mut link.conductance)).for_each(|g| *g *= unit);
        unit
    }

    /// Conjugate gradients from the pressures that there are, and again from where they end while what they
    /// carry along as the residual has left the true one, until that is about `within` of the inflow or
    /// rounding lets it come no closer. What is kept is a factor of nearly this system; where there is none,
    /// or it takes too many rounds, one of this system is made and left there.
    pub(super) fn solve(
        mut self,
        pressure: &mut [f64],
        layers: usize,
        within: f64,
        kept: &mut Option<Kept>,
    ) -> Result<Fit, NotConverged> {
        let unit = self.normalise();
        let scale = dot(&self.inflow, &self.inflow).sqrt();
        if self.void.is_empty() || scale == 0.0 {
            let x = self.rows_of(pressure);
            return Ok(self.fit(&x, &self.residual(&x), 0.0).over(unit));
        }
        if !scale.is_finite() {
            return Err(NotConverged { rounds: 0, residual: f64::INFINITY });
        }
        if let Some(Kept { factor, rounds, closed }) = kept.take() {
            let [least, times] = ROUNDS_OF_ANOTHER;
            let mut other = Some(factor);
            let most = least.max(times * rounds);
            if let Ok((fit, _)) = self.solve_within(pressure, scale, within, &mut other, most) {
                *kept = other.map(|factor| Kept { factor, rounds, closed });
                return Ok(fit.over(unit));
            }
        }
        let mut factor = None;
        let most = ROUNDS * (layers + 100);
        let (fit, rounds) = self.solve_within(pressure, scale, within, &mut factor, most)?;
        *kept = factor.map(|factor| Kept { factor, rounds, closed: 0 });
        Ok(fit.over(unit))
    }

    /// Pressures by row.
    fn rows_of(&self, pressure: &[f64]) -> Vec<f64> {
        self.void.iter().map(|&v| pressure[v as usize]).collect()
    }

    /// How well pressures fit that leave this residual, so large over the inflow.
    fn fit(&self, x: &[f64], residual: &[f64], part: f64) -> Fit {
        let sum = |flows: &mut dyn Iterator<Item = f64>| flows.map(f64::abs).sum::<f64>();
        let held = sum(&mut self.ground.iter().zip(x).map(|(ground, x)| ground * x));
        let fed = sum(&mut self.inflow.iter().copied());
        Fit { residual: part, missing: sum(&mut residual.iter().copied()) + ROUNDING * (held + fed) }
    }

    /// The same in at most so many rounds, and their number; pressures stay where these do not suffice.
    fn solve_within(
        &self,
        pressure: &mut [f64],
        scale: f64,
        within: f64,
        factor: &mut Option<Factor>,
        most: usize,
    ) -> Result<(Fit, usize), NotConverged> {
        let mut x = self.rows_of(pressure);
        let (mut rounds, mut before) = (0, f64::INFINITY);
        loop {
            let mut residual = self.residual(&x);
            let size = dot(&residual, &residual).sqrt();
            let is_close = size <= if rounds == 0 { 1.0 } else { 2.0 } * within * scale;
            // Closer than rounding lets them come they do not get.
            let is_stuck = size > 0.5 * before && size <= BEST_OF_ROUNDING * scale;
            if is_close || is_stuck {
                self.void.iter().zip(&x).for_each(|(&v, &p)| pressure[v as usize] = p);
                return Ok((self.fit(&x, &residual, size / scale), rounds));
            }
            if size > 0.5 * before {
                return Err(NotConverged { rounds, residual: size / scale });
            }
            before = size;
            let factor = factor.get_or_insert_with(|| Factor::new(&self.ground, &self.links));
            rounds = self.descend(factor, &mut x, &mut residual, [scale, within], rounds..most)?;
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
        factor: &Factor,
        x: &mut [f64],
        residual: &mut [f64],
        [scale, within]: [f64; 2],
        allowed: Range<usize>,
    ) -> Result<usize, NotConverged> {
        let rows = self.void.len();
        let mut product = vec![0.0; rows];
        let mut direction = vec![0.0; rows];
        let mut solved = vec![0.0; rows];
        let mut scratch = vec![0.0; rows];
        let mut before = 0.0;
        for round in allowed.start.. {
            let size = dot(residual, residual).sqrt();
            if size <= within * scale {
                return Ok(round);
            }
            if round >= allowed.end || !size.is_finite() {
                return Err(NotConverged { rounds: round, residual: size / scale });
            }
            factor.solve(residual, &mut scratch, &mut solved);
            let now = dot(residual, &solved);
            let keep = if round == allowed.start { 0.0 } else { now / before };
            direction.iter_mut().zip(&solved).for_each(|(d, s)| *d = s + keep * *d);
            before = now;
            self.times(&direction, &mut product);
            let step = now / dot(&direction, &product);
            x.iter_mut().zip(&direction).for_each(|(x, d)| *x += step * d);
            residual.iter_mut().zip(&product).for_each(|(r, p)| *r -= step * p);
        }
        unreachable!("rounds are counted up to the most")
    }

    /// The matrix times a column. Link by link: loops over those of each row would end where no processor
    /// expects it.
    fn times(&self, x: &[f64], out: &mut [f64]) {
        out.iter_mut().zip(self.ground.iter().zip(x)).for_each(|(out, (ground, x))| *out = ground * x);
        for &Link { one, other, conductance } in &self.links {
            let flow = conductance * (x[one as usize] - x[other as usize]);
            out[one as usize] += flow;
            out[other as usize] -= flow;
        }
    }
}

/// Sum of products.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; SIDE_BY_SIDE];
    for (a, b) in a.chunks(SIDE_BY_SIDE).zip(b.chunks(SIDE_BY_SIDE)) {
        sums.iter_mut().zip(a.iter().zip(b)).for_each(|(sum, (a, b))| *sum += a * b);
    }
    sums.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A column of voids that each meet themselves, too: the same bits, where the factor knew of loops it
    /// would take hundreds of rounds.
    #[test]
    fn nothing_flows_from_a_void_to_itself() {
        const VOIDS: u32 = 500;
        let of = |loops: bool| {
            let mut system = System::of_voids((0..VOIDS).map(|_| true), 0);
            system.hold(0, 1.0, 1.0);
            system.hold(VOIDS - 1, 2.0, 0.0);
            for void in 0..VOIDS - 1 {
                system.join(void, void + 1, 1.0 + f64::from(void % 7));
                if loops {
                    system.join(void, void, 50.0);
                }
            }
            let mut pressure = vec![0.0; VOIDS as usize];
            system.solve(&mut pressure, VOIDS as usize, CONVERGED, &mut None).unwrap();
            pressure
        };
        assert_eq!(of(true), of(false));
        assert!(of(true).is_sorted_by(|above, below| above > below));
    }

    /// A factor of a network that conducts elsewhere does not do: it makes way for one that does.
    #[test]
    fn a_factor_that_does_not_serve_is_replaced() {
        const SIDE: u32 = 40;
        let of = |wide: u32, kept: &mut Option<Kept>| {
            let mut system = System::of_voids((0..SIDE * SIDE).map(|_| true), 0);
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
            let mut pressure = vec![0.5; (SIDE * SIDE) as usize];
            let fit = system.solve(&mut pressure, SIDE as usize, CONVERGED, kept).unwrap();
            assert!(fit.residual < 2.0 * CONVERGED, "{fit:?}");
            pressure
        };
        let (mut own, mut other) = (None, None);
        let pressure = of(0, &mut own);
        of(1, &mut other);
        for kept in [&mut own, &mut other] {
            kept.as_mut().unwrap().closed = 7;
        }
        // To the bit, since it begins anew where it began, and with the factor that it would have made.
        assert_eq!(of(0, &mut other), pressure);
        assert_eq!(other.unwrap().closed, 0);
        assert_eq!(of(0, &mut own), pressure);
        assert_eq!(own.unwrap().closed, 7, "one that serves stays");
    }

    /// Links that single precision rounds to 0 beside one dead end that conducts enormously: what they hold
    /// is solved all the same.
    #[test]
    fn conductances_that_single_precision_does_not_tell_apart_are_solved() {
        const VOIDS: u32 = 300;
        let mut system = System::of_voids((0..=VOIDS).map(|_| true), 0);
        system.hold(0, 1.0, 1.0);
        system.hold(VOIDS - 1, 2.0, 0.0);
        (0..VOIDS - 1).for_each(|void| system.join(void, void + 1, 1.0 + f64::from(void % 7)));
        system.join(VOIDS / 2, VOIDS, 1e50);
        let mut pressure = vec![0.0; VOIDS as usize + 1];
        system.solve(&mut pressure, VOIDS as usize, CONVERGED, &mut None).unwrap();
        assert!(pressure[..VOIDS as usize].is_sorted_by(|above, below| above > below));
        assert!((pressure[VOIDS as usize] - pressure[VOIDS as usize / 2]).abs() < 1e-6);
    }
}
