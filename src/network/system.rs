//! The equations of pressures in a network of conductances, and their solution by conjugate gradients.
//!
//! Sums run over fixed blocks in a fixed order, so that a solution is the same to the bit on any number of
//! threads and with any instructions.

use std::ops::Range;

use rayon::prelude::*;

use super::elimination::Factor;

/// The residual is below this part of what flows in.
pub(super) const CONVERGED: f64 = 1e-10;

/// The residual that is taken, as part of what flows in, where rounding lets it come no closer.
const BEST_OF_ROUNDING: f64 = 1e-6;

/// Rounds after which a system that has not converged is given up, for each layer and a hundred besides.
const ROUNDS: usize = 100;

/// Entries whose sum is made at once: fixed, so that threads change nothing.
const BLOCK: usize = 1 << 12;

/// Sums that are made side by side in a block: fixed likewise.
const SIDE_BY_SIDE: usize = 8;

/// Conductances so far apart that numbers do not tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NotConverged {
    /// Rounds.
    pub rounds: usize,
    /// Residual over inflow.
    pub residual: f64,
}

/// What is to be known of a void for its equation.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sides {
    /// Conductance to pressures that are known.
    pub ground: f64,
    /// Flow in from where pressure is known.
    pub inflow: f64,
}

/// The equations of the voids inside, as columns: row `i` has neighbours `begin[i] .. begin[i + 1]`.
pub(super) struct System {
    /// Void by row.
    void: Vec<u32>,
    begin: Vec<u32>,
    row: Vec<u32>,
    conductance: Vec<f64>,
    diagonal: Vec<f64>,
    /// Conductance to pressures that are known.
    ground: Vec<f64>,
    /// Flow in from where pressure is known.
    inflow: Vec<f64>,
}

impl System {
    /// The equations of the voids `inside`; `of` gives the sides of a void and its neighbours with their
    /// conductances, of which those that are not inside have pressure 0.
    pub(super) fn of_voids(inside: &[bool], of: impl Fn(u32, &mut Vec<(u32, f64)>) -> Sides) -> Self {
        const NONE: u32 = u32::MAX;
        let void: Vec<u32> = (0u32..).zip(inside).filter(|(_, inside)| **inside).map(|(v, _)| v).collect();
        let mut row_of = vec![NONE; inside.len()];
        void.iter().zip(0..).for_each(|(&v, row)| row_of[v as usize] = row);
        let rows = void.len();
        let mut system = Self {
            begin: Vec::with_capacity(rows + 1),
            row: Vec::new(),
            conductance: Vec::new(),
            diagonal: Vec::with_capacity(rows),
            ground: Vec::with_capacity(rows),
            inflow: Vec::with_capacity(rows),
            void,
        };
        system.begin.push(0);
        let mut neighbours = Vec::new();
        for &v in &system.void {
            neighbours.clear();
            let Sides { mut ground, inflow } = of(v, &mut neighbours);
            let begin = system.row.len();
            let mut inner = 0.0;
            for &(to, g) in &neighbours {
                let to = row_of[to as usize];
                if to == NONE {
                    ground += g;
                    continue;
                }
                inner += g;
                match system.row[begin..].iter().position(|&other| other == to) {
                    Some(at) => system.conductance[begin + at] += g,
                    None => {
                        system.row.push(to);
                        system.conductance.push(g);
                    }
                }
            }
            system.begin.push(system.row.len() as u32);
            system.diagonal.push(ground + inner);
            system.ground.push(ground);
            system.inflow.push(inflow);
        }
        system.normalise();
        system
    }

    /// Divides both sides by a power of two, which changes no digit of a solution, so that squares of very
    /// large and very small conductances are numbers still.
    fn normalise(&mut self) {
        let largest = self.diagonal.iter().fold(0.0, |a: f64, &b| a.max(b));
        if largest > 0.0 && largest.is_finite() {
            let unit = libm::scalbn(1.0, -libm::ilogb(largest).max(-1000));
            let sides = self.diagonal.iter_mut().chain(&mut self.ground).chain(&mut self.inflow);
            sides.chain(&mut self.conductance).for_each(|side| *side *= unit);
        }
    }

    /// Conjugate gradients from the pressures that there are, and again from where they end while what they
    /// carry along as the residual has left the true one.
    /// Gives the residual over the inflow.
    pub(super) fn solve(&self, pressure: &mut [f64], layers: usize) -> Result<f64, NotConverged> {
        let scale = dot(&self.inflow, &self.inflow).sqrt();
        if self.void.is_empty() || scale == 0.0 {
            return Ok(0.0);
        }
        if !scale.is_finite() {
            return Err(NotConverged { rounds: 0, residual: f64::INFINITY });
        }
        let factor = Factor::new(&self.ground, &self.begin, &self.row, &self.conductance);
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
                return Err(NotConverged { rounds, residual: size / scale });
            }
            before = size;
            rounds = self.descend(&factor, &mut x, &mut residual, scale, rounds..ROUNDS * (layers + 100))?;
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
        scale: f64,
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
            if size <= CONVERGED * scale {
                return Ok(round);
            }
            if round >= allowed.end || !size.is_finite() {
                return Err(NotConverged { rounds: round, residual: size / scale });
            }
            factor.solve(residual, &mut scratch, &mut solved);
            let now = dot(residual, &solved);
            let keep = if round == allowed.start { 0.0 } else { now / before };
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
}

/// Sum of products, block by block.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let blocks = a.par_chunks(BLOCK).zip(b.par_chunks(BLOCK));
    let parts: Vec<f64> = blocks.map(|(a, b)| dot_of_block(a, b)).collect();
    parts.iter().sum()
}

fn dot_of_block(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; SIDE_BY_SIDE];
    for (a, b) in a.chunks(SIDE_BY_SIDE).zip(b.chunks(SIDE_BY_SIDE)) {
        sums.iter_mut().zip(a.iter().zip(b)).for_each(|(sum, (a, b))| *sum += a * b);
    }
    sums.iter().sum()
}
