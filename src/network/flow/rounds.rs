//! Conjugate gradients on the equations of a network, or of some of its slabs.
//!
//! Threads work on slabs side by side. Sums run in a fixed order within a piece, and from piece to piece, so
//! that a solution is the same to the bit on any number of threads and with any instructions.

use std::ops::Range;

use super::elimination::Factor;
use super::piece::{Columns, Piece, dot};
use super::rest::{Beyond, Link};
use super::slabs::each;

/// Conductances so far apart that numbers do not tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NotConverged {
    /// Rounds.
    pub rounds: usize,
    /// Residual over inflow.
    pub residual: f64,
}

/// Equations of slabs that meet in cuts only. Columns and factors are those of the slabs in their order, and
/// at last those of the cuts.
pub(super) struct Equations<'a> {
    /// With the rows of cuts that each leads to, counted among those of `cuts`.
    pub slabs: Vec<(&'a Piece, Range<usize>)>,
    /// Of all cuts.
    pub cuts: &'a Piece,
}

impl Equations<'_> {
    /// Of each slab, and of the cuts.
    fn piece(&self, at: usize) -> &Piece {
        self.slabs.get(at).map_or(self.cuts, |(slab, _)| slab)
    }

    /// Columns of zeros.
    pub fn columns(&self) -> Vec<Columns> {
        (0..=self.slabs.len()).map(|at| Columns::of(self.piece(at))).collect()
    }

    /// A factor of the cuts, with what is left of the slabs between them.
    pub fn factor_of_cuts<'b>(&self, left: impl IntoIterator<Item = &'b Beyond>) -> Factor {
        let (mut ground, mut links) = (self.cuts.ground.clone(), self.cuts.links.clone());
        for ((_, met), left) in self.slabs.iter().zip(left) {
            ground[met.clone()].iter_mut().zip(&left.ground).for_each(|(sum, part)| *sum += part);
            let first = met.start as u32;
            let moved = |link: &Link| Link { one: first + link.one, other: first + link.other, ..*link };
            links.extend(left.links.iter().map(moved));
        }
        Factor::new(&ground, 0, &links).0
    }

    /// Makes ready a column of all pieces, `of` which with their products, and multiplies the matrix by it.
    /// Gives the sum of products of both.
    fn times(
        &self,
        columns: &mut [Columns],
        make_ready: impl Fn(&mut Columns) + Sync,
        of: impl Fn(&mut Columns) -> [&mut Vec<f64>; 2] + Sync,
    ) -> f64 {
        let Some((of_cuts, of_slabs)) = columns.split_last_mut() else { return 0.0 };
        make_ready(of_cuts);
        let [at_cuts, at_cuts_product] = of(of_cuts);
        each(of_slabs, |at, own| {
            let (piece, met) = &self.slabs[at];
            let rows = piece.rows.len();
            make_ready(own);
            let [x, product] = of(own);
            x[rows..].copy_from_slice(&at_cuts[met.clone()]);
            piece.times(x, product);
            own.sum = dot(&x[..rows], &product[..rows]);
        });
        self.cuts.times(at_cuts, at_cuts_product);
        let mut sum = 0.0;
        for ((piece, met), own) in self.slabs.iter().zip(of_slabs) {
            let parts = &own.product[piece.rows.len()..];
            at_cuts_product[met.clone()].iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
            sum += own.sum;
        }
        sum + dot(at_cuts, at_cuts_product)
    }

    /// What is missing of the right side, and its size.
    pub fn find_residual(&self, columns: &mut [Columns]) -> f64 {
        self.times(columns, |_| {}, |own| [&mut own.x, &mut own.product]);
        each(columns, |at, own| {
            let sides = self.piece(at).inflow.iter().zip(&own.product);
            own.residual.iter_mut().zip(sides).for_each(|(residual, (b, a))| *residual = b - a);
            own.sum = dot(&own.residual, &own.residual);
        });
        columns.iter().map(|own| own.sum).sum::<f64>().sqrt()
    }

    /// Solves the residual by the factors. Gives the sum of products of both.
    fn precondition(&self, factors: &[&Factor], columns: &mut [Columns]) -> f64 {
        let Some((of_cuts, of_slabs)) = columns.split_last_mut() else { return 0.0 };
        let slabs = of_slabs.len();
        each(of_slabs, |at, own| factors[at].down(&own.residual, &mut own.scratch));
        let Columns { residual, product: right, solved, scratch, .. } = of_cuts;
        right.copy_from_slice(residual);
        for ((piece, met), own) in self.slabs.iter().zip(&*of_slabs) {
            let parts = &own.scratch[piece.rows.len()..];
            right[met.clone()].iter_mut().zip(parts).for_each(|(right, part)| *right += part);
        }
        factors[slabs].down(right, scratch);
        factors[slabs].up(scratch, solved);
        each(of_slabs, |at, own| {
            let (piece, met) = &self.slabs[at];
            own.scratch[piece.rows.len()..].copy_from_slice(&solved[met.clone()]);
            factors[at].up(&mut own.scratch, &mut own.solved);
            own.sum = dot(&own.residual, &own.solved);
        });
        of_slabs.iter().map(|own| own.sum).sum::<f64>() + dot(residual, solved)
    }

    /// Conjugate gradients until the residual that they carry along, which begins so large, is small; the
    /// rounds that there were.
    pub fn descend(
        &self,
        factors: &[&Factor],
        columns: &mut [Columns],
        [mut size, scale, within]: [f64; 3],
        allowed: Range<usize>,
    ) -> Result<usize, NotConverged> {
        each(columns, |_, own| own.direction.fill(0.0));
        let mut before = 0.0;
        for round in allowed.start.. {
            if size <= within * scale {
                return Ok(round);
            }
            if round >= allowed.end || !size.is_finite() {
                return Err(NotConverged { rounds: round, residual: size / scale });
            }
            let now = self.precondition(factors, columns);
            let keep = if round == allowed.start { 0.0 } else { now / before };
            before = now;
            let turn = |own: &mut Columns| {
                own.direction.iter_mut().zip(&own.solved).for_each(|(d, s)| *d = s + keep * *d);
            };
            let step = now / self.times(columns, turn, |own| [&mut own.direction, &mut own.product]);
            each(columns, |_, own| {
                own.x.iter_mut().zip(&own.direction).for_each(|(x, d)| *x += step * d);
                own.residual.iter_mut().zip(&own.product).for_each(|(r, p)| *r -= step * p);
                own.sum = dot(&own.residual, &own.residual);
            });
            size = columns.iter().map(|own| own.sum).sum::<f64>().sqrt();
        }
        unreachable!("rounds are counted up to the most")
    }
}
