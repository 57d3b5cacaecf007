//! The equations of pressures in a network of conductances, and their solution by conjugate gradients.
//!
//! Each slab of the network has a piece of them, and all cuts together have one: threads work on slabs side
//! by side. Sums run in a fixed order within a piece, and from piece to piece, so that a solution is the
//! same to the bit on any number of threads and with any instructions.

use std::ops::Range;

use super::elimination::Factor;
use super::joining::{Joining, NONE};
use super::piece::{Columns, Piece, dot};
use super::rest::Link;
use super::slabs::{Slabs, each};

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
    /// By piece.
    factors: Vec<Factor>,
    /// Rounds that the system took that it is of.
    pub rounds: usize,
    /// Exits that have closed since.
    pub closed: usize,
}

/// The equations of the voids inside: a row for each.
pub(super) struct System {
    /// Void by row: slab after slab, and then cuts.
    void: Vec<u32>,
    /// Row by void, or [`NONE`].
    row_of: Vec<u32>,
    /// By slab; and at last that of the cuts.
    pieces: Vec<Piece>,
}

impl System {
    /// The voids `inside`, joined with nothing yet; with room for so many links in each piece.
    pub(super) fn of(slabs: &Slabs, inside: impl Fn(u32) -> bool, links: impl Fn(usize) -> usize) -> Self {
        let mut void = Vec::with_capacity(slabs.order().len());
        let mut row_of = vec![NONE; slabs.order().len()];
        let begin: Vec<usize> = std::iter::once(0)
            .chain(slabs.begin().windows(2).map(|part| {
                void.extend(slabs.order()[part[0]..part[1]].iter().copied().filter(|&v| inside(v)));
                void.len()
            }))
            .collect();
        void.iter().zip(0u32..).for_each(|(&v, row)| row_of[v as usize] = row);
        let number = slabs.number();
        let (cuts, rows) = (begin[number], void.len());
        // A slab lies between the cut before it and the one after it.
        let met = |slab: usize| {
            begin[number + slab.saturating_sub(1)]..begin[(number + slab + 1).min(2 * number - 1)]
        };
        let slab = |slab: usize| {
            let met = met(slab);
            Piece::new(begin[slab]..begin[slab + 1], met.start - cuts..met.end - cuts, links(slab))
        };
        let mut pieces: Vec<Piece> = (0..number).map(slab).collect();
        pieces.push(Piece::new(cuts..rows, 0..0, links(number)));
        Self { void, row_of, pieces }
    }

    /// The voids `inside` of so many in one piece, in which `fill` joins them.
    pub(super) fn in_one(
        voids: usize,
        inside: impl Fn(u32) -> bool,
        fill: impl Fn(&mut Joining) + Sync,
    ) -> Self {
        let mut system = Self::of(&Slabs::one(voids), inside, |_| 0);
        system.fill(|at, joining| {
            if at == 0 {
                fill(joining);
            }
        });
        system
    }

    /// Joins voids in all pieces, each by itself: that of a slab in which one of two stands, else that of the
    /// cuts, which is the last.
    pub(super) fn fill(&mut self, fill: impl Fn(usize, &mut Joining) + Sync) {
        let cuts = self.cuts();
        let Self { row_of, pieces, .. } = self;
        each(pieces, |at, piece| fill(at, &mut Joining { row_of, cuts, piece }));
    }

    /// The first row of cuts.
    fn cuts(&self) -> usize {
        self.pieces.last().map_or(0, |cuts| cuts.rows.start)
    }

    /// Divides both sides by a power of two, which changes no digit of a solution, so that squares of very
    /// large and very small conductances are numbers still. Gives that power.
    fn normalise(&mut self) -> f64 {
        let mut largest = vec![0.0; self.pieces.len()];
        each(&mut largest, |at, largest| *largest = self.pieces[at].largest());
        let largest = largest.into_iter().fold(0.0, f64::max);
        if !(largest > 0.0 && largest.is_finite()) {
            return 1.0;
        }
        let unit = libm::scalbn(1.0, -libm::ilogb(largest).max(-1000));
        each(&mut self.pieces, |_, piece| piece.scale(unit));
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
        let scale = self.pieces.iter().map(|piece| dot(&piece.inflow, &piece.inflow)).sum::<f64>().sqrt();
        if self.void.is_empty() || scale == 0.0 {
            let mut columns = self.columns(pressure);
            self.find_residual(&mut columns);
            return Ok(self.fit(&columns, 0.0).over(unit));
        }
        if !scale.is_finite() {
            return Err(NotConverged { rounds: 0, residual: f64::INFINITY });
        }
        if let Some(Kept { factors, rounds, closed }) = kept.take() {
            let [least, times] = ROUNDS_OF_ANOTHER;
            let mut others = Some(factors);
            let most = least.max(times * rounds);
            if let Ok((fit, _)) = self.solve_within(pressure, scale, within, &mut others, most) {
                *kept = others.map(|factors| Kept { factors, rounds, closed });
                return Ok(fit.over(unit));
            }
        }
        let mut factors = None;
        let most = ROUNDS * (layers + 100);
        let (fit, rounds) = self.solve_within(pressure, scale, within, &mut factors, most)?;
        *kept = factors.map(|factors| Kept { factors, rounds, closed: 0 });
        Ok(fit.over(unit))
    }

    /// Columns that begin with these pressures, by void.
    fn columns(&self, pressure: &[f64]) -> Vec<Columns> {
        let mut all: Vec<Columns> = self.pieces.iter().map(Columns::of).collect();
        each(&mut all, |at, own| {
            let voids = &self.void[self.pieces[at].rows.clone()];
            own.x.iter_mut().zip(voids).for_each(|(x, &v)| *x = pressure[v as usize]);
        });
        all
    }

    /// How well the pressures of these columns fit, whose residual is so large over the inflow.
    fn fit(&self, columns: &[Columns], part: f64) -> Fit {
        let sum = |flows: &mut dyn Iterator<Item = f64>| flows.map(f64::abs).sum::<f64>();
        let (mut missing, mut known) = (0.0, 0.0);
        for (piece, own) in self.pieces.iter().zip(columns) {
            missing += sum(&mut own.residual.iter().copied());
            known += sum(&mut piece.ground.iter().zip(&own.x).map(|(ground, x)| ground * x))
                + sum(&mut piece.inflow.iter().copied());
        }
        Fit { residual: part, missing: missing + ROUNDING * known }
    }

    /// The same in at most so many rounds, and their number; pressures stay where these do not suffice.
    fn solve_within(
        &self,
        pressure: &mut [f64],
        scale: f64,
        within: f64,
        factors: &mut Option<Vec<Factor>>,
        most: usize,
    ) -> Result<(Fit, usize), NotConverged> {
        let mut columns = self.columns(pressure);
        let (mut rounds, mut before) = (0, f64::INFINITY);
        loop {
            let size = self.find_residual(&mut columns);
            let is_close = size <= if rounds == 0 { 1.0 } else { 2.0 } * within * scale;
            // Closer than rounding lets them come they do not get.
            let is_stuck = size > 0.5 * before && size <= BEST_OF_ROUNDING * scale;
            if is_close || is_stuck {
                for (piece, own) in self.pieces.iter().zip(&columns) {
                    let voids = &self.void[piece.rows.clone()];
                    voids.iter().zip(&own.x).for_each(|(&v, &p)| pressure[v as usize] = p);
                }
                return Ok((self.fit(&columns, size / scale), rounds));
            }
            if size > 0.5 * before {
                return Err(NotConverged { rounds, residual: size / scale });
            }
            before = size;
            let factors = factors.get_or_insert_with(|| self.factors());
            rounds = self.descend(factors, &mut columns, [size, scale, within], rounds..most)?;
        }
    }

    /// A factor of each piece: of slabs side by side, and of the cuts with what is left of slabs between
    /// them.
    fn factors(&self) -> Vec<Factor> {
        let Some((cuts, slabs)) = self.pieces.split_last() else { return Vec::new() };
        let mut of_slabs: Vec<_> = slabs.iter().map(|_| None).collect();
        each(&mut of_slabs, |at, made| {
            let Piece { met, links, ground, .. } = &slabs[at];
            *made = Some(Factor::new(ground, met.len(), links));
        });
        let (mut ground, mut links) = (cuts.ground.clone(), cuts.links.clone());
        let mut factors = Vec::with_capacity(self.pieces.len());
        for (slab, (factor, left)) in slabs.iter().zip(of_slabs.into_iter().flatten()) {
            ground[slab.met.clone()].iter_mut().zip(left.ground).for_each(|(sum, part)| *sum += part);
            let first = slab.met.start as u32;
            let moved = |link: Link| Link { one: first + link.one, other: first + link.other, ..link };
            links.extend(left.links.into_iter().map(moved));
            factors.push(factor);
        }
        factors.push(Factor::new(&ground, 0, &links).0);
        factors
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
            let piece = &self.pieces[at];
            let rows = piece.rows.len();
            make_ready(own);
            let [x, product] = of(own);
            x[rows..].copy_from_slice(&at_cuts[piece.met.clone()]);
            piece.times(x, product);
            own.sum = dot(&x[..rows], &product[..rows]);
        });
        self.pieces[of_slabs.len()].times(at_cuts, at_cuts_product);
        let mut sum = 0.0;
        for (piece, own) in self.pieces.iter().zip(of_slabs) {
            let parts = &own.product[piece.rows.len()..];
            at_cuts_product[piece.met.clone()].iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
            sum += own.sum;
        }
        sum + dot(at_cuts, at_cuts_product)
    }

    /// What is missing of the right side, and its size.
    fn find_residual(&self, columns: &mut [Columns]) -> f64 {
        self.times(columns, |_| {}, |own| [&mut own.x, &mut own.product]);
        each(columns, |at, own| {
            let sides = self.pieces[at].inflow.iter().zip(&own.product);
            own.residual.iter_mut().zip(sides).for_each(|(residual, (b, a))| *residual = b - a);
            own.sum = dot(&own.residual, &own.residual);
        });
        columns.iter().map(|own| own.sum).sum::<f64>().sqrt()
    }

    /// Solves the residual by the factors. Gives the sum of products of both.
    fn precondition(&self, factors: &[Factor], columns: &mut [Columns]) -> f64 {
        let Some((of_cuts, of_slabs)) = columns.split_last_mut() else { return 0.0 };
        let slabs = of_slabs.len();
        each(of_slabs, |at, own| factors[at].down(&own.residual, &mut own.scratch));
        let Columns { residual, product: right, solved, scratch, .. } = of_cuts;
        right.copy_from_slice(residual);
        for (piece, own) in self.pieces.iter().zip(&*of_slabs) {
            let parts = &own.scratch[piece.rows.len()..];
            right[piece.met.clone()].iter_mut().zip(parts).for_each(|(right, part)| *right += part);
        }
        factors[slabs].down(right, scratch);
        factors[slabs].up(scratch, solved);
        each(of_slabs, |at, own| {
            let piece = &self.pieces[at];
            own.scratch[piece.rows.len()..].copy_from_slice(&solved[piece.met.clone()]);
            factors[at].up(&mut own.scratch, &mut own.solved);
            own.sum = dot(&own.residual, &own.solved);
        });
        of_slabs.iter().map(|own| own.sum).sum::<f64>() + dot(residual, solved)
    }

    /// Conjugate gradients until the residual that they carry along, which begins so large, is small; the
    /// rounds that there were.
    fn descend(
        &self,
        factors: &[Factor],
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A column of voids that each meet themselves, too: the same bits, where the factor knew of loops it
    /// would take hundreds of rounds.
    #[test]
    fn nothing_flows_from_a_void_to_itself() {
        const VOIDS: u32 = 500;
        let of = |loops: bool| {
            let system = System::in_one(
                VOIDS as usize,
                |_| true,
                |system| {
                    system.hold(0, 1.0, 1.0);
                    system.hold(VOIDS - 1, 2.0, 0.0);
                    for void in 0..VOIDS - 1 {
                        system.join(void, void + 1, 1.0 + f64::from(void % 7));
                        if loops {
                            system.join(void, void, 50.0);
                        }
                    }
                },
            );
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
            let system = System::in_one(
                (SIDE * SIDE) as usize,
                |_| true,
                |system| {
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
                },
            );
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
        let system = System::in_one(
            VOIDS as usize + 1,
            |_| true,
            |system| {
                system.hold(0, 1.0, 1.0);
                system.hold(VOIDS - 1, 2.0, 0.0);
                (0..VOIDS - 1).for_each(|void| system.join(void, void + 1, 1.0 + f64::from(void % 7)));
                system.join(VOIDS / 2, VOIDS, 1e50);
            },
        );
        let mut pressure = vec![0.0; VOIDS as usize + 1];
        system.solve(&mut pressure, VOIDS as usize, CONVERGED, &mut None).unwrap();
        assert!(pressure[..VOIDS as usize].is_sorted_by(|above, below| above > below));
        assert!((pressure[VOIDS as usize] - pressure[VOIDS as usize / 2]).abs() < 1e-6);
    }
}
