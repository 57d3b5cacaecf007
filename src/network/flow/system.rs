//! The equations of pressures in a network of conductances, and their solution by conjugate gradients.
//!
//! Each slab of the network has a piece of them, and all cuts together have one: threads work on slabs side
//! by side.

use super::elimination::Factor;
use super::joining::{Joining, NONE};
use super::piece::{Columns, Piece, dot};
use super::rounds::{Equations, NotConverged};
use super::slabs::{Slabs, each};
use super::stretch::Stretches;

/// The residual is below this part of what flows in.
pub(super) const CONVERGED: f64 = 1e-10;

/// Asks for no less than rounding lets them come: a part of what flows in that a residual hardly gets below.
pub(super) const CLOSEST: f64 = f64::EPSILON / 4.0;

/// The residual that is taken, as part of what flows in, where rounding lets it come no closer.
const BEST_OF_ROUNDING: f64 = 1e-6;

/// What sums of each row may lose in rounding, as part of the flow through its known pressures.
pub(super) const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Where nothing conducts more than this, squares of what conducts less may be 0.
const OUT_OF_RANGE: f64 = 1e-9;

/// Rounds after which a system that has not converged is given up, for each layer and a hundred besides.
const ROUNDS: usize = 100;

/// The most rounds with a factor of another system: so many, or so many times those that its own system took,
/// whichever is more.
const ROUNDS_OF_ANOTHER: [usize; 2] = [60, 3];

/// How well pressures fit their equations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    /// Residual over the inflow, both as roots of sums of squares.
    pub residual: f64,
    /// What the balances of all voids are off by together, rounding included. No flux, and no sum of fluxes
    /// through a cut, differs by more from that of the exact pressures: a unit of flow that is fed into a
    /// void passes no constriction more than once.
    pub missing: f64,
    /// Rounds that it took.
    pub rounds: usize,
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
    /// The power of two that conductances are multiplied by, once it is known.
    unit: Option<f64>,
    /// By piece: the most that a row conducts.
    largest: Vec<f64>,
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
            let cuts = slabs.cuts_of(slab);
            begin[cuts.start]..begin[cuts.end]
        };
        let slab = |slab: usize| {
            let met = met(slab);
            Piece::new(begin[slab]..begin[slab + 1], met.start - cuts..met.end - cuts, links(slab))
        };
        let mut pieces: Vec<Piece> = (0..number).map(slab).collect();
        pieces.push(Piece::new(cuts..rows, 0..0, links(number)));
        let largest = vec![0.0; pieces.len()];
        Self { void, row_of, pieces, unit: None, largest }
    }

    /// The voids `inside` of so many in one piece, in which `fill` joins them.
    pub(super) fn in_one(
        voids: usize,
        inside: impl Fn(u32) -> bool,
        fill: impl Fn(&mut Joining) + Sync,
    ) -> Self {
        let mut system = Self::of(&Slabs::one(voids), inside, |_| 0);
        system.fill(|at| at == 0, |_, joining| fill(joining));
        system
    }

    /// Joins voids in pieces, each by itself: that of a slab in which one of two stands, else that of the
    /// cuts, which is the last. What was joined in these before is forgotten, and other pieces stay.
    pub(super) fn fill(
        &mut self,
        is_wanted: impl Fn(usize) -> bool + Sync,
        fill: impl Fn(usize, &mut Joining) + Sync,
    ) {
        let cuts = self.cuts();
        let Self { row_of, pieces, unit, largest, .. } = self;
        let mut pieces: Vec<_> = pieces.iter_mut().zip(largest).collect();
        each(&mut pieces, |at, (piece, largest)| {
            if is_wanted(at) {
                piece.clear();
                fill(at, &mut Joining { row_of, cuts, piece });
                unit.iter().for_each(|&unit| piece.scale(unit));
                **largest = piece.largest();
            }
        });
    }

    /// Whether the power of two still suits what conducts now.
    pub(super) fn is_in_range(&self) -> bool {
        self.unit.is_none() || self.largest.iter().any(|&largest| largest > OUT_OF_RANGE)
    }

    /// The first row of cuts.
    fn cuts(&self) -> usize {
        self.pieces.last().map_or(0, |cuts| cuts.rows.start)
    }

    /// Multiplies both sides by a power of two, which changes no digit of a solution, so that squares of very
    /// large and very small conductances are numbers still. Gives that power.
    fn normalise(&mut self) -> f64 {
        if let Some(unit) = self.unit {
            return unit;
        }
        let largest = self.largest.iter().copied().fold(0.0, f64::max);
        if !(largest > 0.0 && largest.is_finite()) {
            return 1.0;
        }
        let unit = libm::scalbn(1.0, -libm::ilogb(largest).max(-1000));
        each(&mut self.pieces, |_, piece| piece.scale(unit));
        self.largest.iter_mut().for_each(|largest| *largest *= unit);
        *self.unit.insert(unit)
    }

    /// The size of what flows in.
    fn inflow(&self) -> f64 {
        self.pieces.iter().map(|piece| dot(&piece.inflow, &piece.inflow)).sum::<f64>().sqrt()
    }

    /// Brings pressures close to the solution, where stretches around the slabs in which so many
    /// constrictions changed will do; which slabs these are.
    pub(super) fn improve(
        &self,
        pressure: &mut [f64],
        within: f64,
        stretches: &mut Stretches,
        changed: &[usize],
    ) -> Option<Vec<bool>> {
        let mut columns = self.columns(pressure);
        let solved = stretches.improve(&self.equations(), &mut columns, within * self.inflow(), changed);
        if solved.is_some() {
            self.put(&columns, pressure);
        }
        solved
    }

    /// Conjugate gradients from the pressures that there are, and again from where they end while what they
    /// carry along as the residual has left the true one, until that is about `within` of the inflow or
    /// rounding lets it come no closer. What is kept is a factor of nearly this system; where there is none,
    /// or it takes too many rounds, one of this system is made and left there.
    pub(super) fn solve(
        &mut self,
        pressure: &mut [f64],
        layers: usize,
        within: f64,
        kept: &mut Option<Kept>,
    ) -> Result<Fit, NotConverged> {
        let unit = self.normalise();
        let scale = self.inflow();
        if self.void.is_empty() || scale == 0.0 {
            let mut columns = self.columns(pressure);
            self.equations().find_residual(&mut columns);
            return Ok(self.fit(&columns, 0.0, 0).over(unit));
        }
        if !scale.is_finite() {
            return Err(NotConverged { rounds: 0, residual: f64::INFINITY });
        }
        if let Some(Kept { factors, rounds, closed }) = kept.take() {
            let [least, times] = ROUNDS_OF_ANOTHER;
            let mut others = Some(factors);
            let most = least.max(times * rounds);
            if let Ok(fit) = self.solve_within(pressure, scale, within, &mut others, most) {
                *kept = others.map(|factors| Kept { factors, rounds, closed });
                return Ok(fit.over(unit));
            }
        }
        let mut factors = None;
        let most = ROUNDS * (layers + 100);
        let fit = self.solve_within(pressure, scale, within, &mut factors, most)?;
        *kept = factors.map(|factors| Kept { factors, rounds: fit.rounds, closed: 0 });
        Ok(fit.over(unit))
    }

    /// Columns that begin with these pressures, by void.
    fn columns(&self, pressure: &[f64]) -> Vec<Columns> {
        let mut all = self.equations().columns();
        each(&mut all, |at, own| {
            let voids = &self.void[self.pieces[at].rows.clone()];
            own.x.iter_mut().zip(voids).for_each(|(x, &v)| *x = pressure[v as usize]);
        });
        all
    }

    /// Puts the pressures of columns to their voids.
    fn put(&self, columns: &[Columns], pressure: &mut [f64]) {
        for (piece, own) in self.pieces.iter().zip(columns) {
            let voids = &self.void[piece.rows.clone()];
            voids.iter().zip(&own.x).for_each(|(&v, &p)| pressure[v as usize] = p);
        }
    }

    /// How well the pressures of these columns fit, whose residual is so large over the inflow.
    fn fit(&self, columns: &[Columns], part: f64, rounds: usize) -> Fit {
        let sum = |flows: &mut dyn Iterator<Item = f64>| flows.map(f64::abs).sum::<f64>();
        let (mut missing, mut known) = (0.0, 0.0);
        for (piece, own) in self.pieces.iter().zip(columns) {
            missing += sum(&mut own.residual.iter().copied());
            known += sum(&mut piece.ground.iter().zip(&own.x).map(|(ground, x)| ground * x))
                + sum(&mut piece.inflow.iter().copied());
        }
        Fit { residual: part, missing: missing + ROUNDING * known, rounds }
    }

    /// The same in at most so many rounds; pressures stay where these do not suffice.
    fn solve_within(
        &self,
        pressure: &mut [f64],
        scale: f64,
        within: f64,
        factors: &mut Option<Vec<Factor>>,
        most: usize,
    ) -> Result<Fit, NotConverged> {
        let equations = self.equations();
        let mut columns = self.columns(pressure);
        let (mut rounds, mut before) = (0, f64::INFINITY);
        loop {
            let size = equations.find_residual(&mut columns);
            let is_close = size <= if rounds == 0 { 1.0 } else { 2.0 } * within * scale;
            // Closer than rounding lets them come they do not get.
            let is_stuck = size > 0.5 * before && size <= BEST_OF_ROUNDING * scale;
            if is_close || is_stuck {
                self.put(&columns, pressure);
                return Ok(self.fit(&columns, size / scale, rounds));
            }
            if size > 0.5 * before {
                return Err(NotConverged { rounds, residual: size / scale });
            }
            before = size;
            let factors = factors.get_or_insert_with(|| self.factors());
            let factors: Vec<&Factor> = factors.iter().collect();
            rounds = equations.descend(&factors, &mut columns, [size, scale, within], rounds..most)?;
        }
    }

    /// The equations of all slabs.
    pub(super) fn equations(&self) -> Equations<'_> {
        let (cuts, slabs) = self.pieces.split_last().expect("cuts have a piece, if an empty one");
        Equations { slabs: slabs.iter().map(|piece| (piece, piece.met.clone())).collect(), cuts }
    }

    /// A factor of each piece: of slabs side by side, and of the cuts with what is left of slabs between
    /// them.
    fn factors(&self) -> Vec<Factor> {
        let equations = self.equations();
        let mut of_slabs: Vec<_> = equations.slabs.iter().map(|_| None).collect();
        each(&mut of_slabs, |at, made| {
            let Piece { met, links, ground, .. } = equations.slabs[at].0;
            *made = Some(Factor::new(ground, met.len(), links));
        });
        let (mut factors, left): (Vec<_>, Vec<_>) = of_slabs.into_iter().flatten().unzip();
        factors.push(equations.factor_of_cuts(&left));
        factors
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
            let mut system = System::in_one(
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
            let mut system = System::in_one(
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
        let mut system = System::in_one(
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
