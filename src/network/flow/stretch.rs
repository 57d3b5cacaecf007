//! Solving a stretch of a thick network by itself, where the rest keeps its flow pattern.
//!
//! Particles move through a thick filter as a pulse, and constrictions close where it is. A width or two of
//! the network away from there water keeps its ways: all fluxes change by one factor. So with the flow
//! through the whole held as it is, pressures of a run of slabs far from what closed all change by one
//! number, and those of the run at one end of the network by none. Such a run is one row, or known pressure,
//! of a smaller system of conductances, whose other rows are the voids of the slabs in which something
//! closed and of some slabs beside them, its margin. Then pressures are divided by what the fall through the
//! whole came to.
//!
//! What this leaves out is what flows between rows at the ends of a margin and the run beyond. It falls by a
//! factor of 500 or so with each width of the network; where it is more than is asked for, the margin grows.

use std::ops::Range;

use super::elimination::Factor;
use super::joining::NONE;
use super::piece::{Columns, Piece, dot};
use super::rest::{Beyond, Link};
use super::rounds::Equations;
use super::slabs::each;

/// The residual of a stretch, and what is left beyond its margins, as parts of the residual that is asked
/// for: what earlier solutions left elsewhere comes on top.
const SHARE: f64 = 0.25;

/// A factor of a slab is kept until more than one in so many of its constrictions have changed.
const FACTOR_KEPT_UNTIL: usize = 1000;

/// Rounds after which the whole is solved instead.
const ROUNDS_OF_STRETCH: usize = 200;

/// Of slabs, solution after solution: what serves the next one.
pub(super) struct Stretches {
    /// By slab, where it was in a stretch.
    factors: Vec<Option<SlabFactor>>,
    /// Slabs of a margin.
    margin: usize,
    /// The first slab that water leaves the network by. It comes in by slab 0 alone, from which the slabs are
    /// counted.
    first_out: usize,
}

/// A factor of one slab.
struct SlabFactor {
    factor: Factor,
    /// What is left of the slab between cuts.
    left: Beyond,
    /// Constrictions that have changed since.
    changed: usize,
}

/// What a slab, or a cut, is in a stretch.
#[derive(Clone, Copy, PartialEq)]
enum Part {
    /// One of its slabs or cuts.
    Inside,
    /// In a run of which all pressures change alike: the row of the run among those of cuts.
    Run(u32),
    /// In the run whose pressures stay.
    Held,
}

impl Stretches {
    /// Of a network as clean as it will be.
    pub(super) fn of(whole: &Equations) -> Self {
        let slabs = whole.slabs.len();
        let mut first_out = slabs;
        let mut see = |ground: &[f64], inflow: &[f64], slab: usize| {
            if ground.iter().zip(inflow).any(|(ground, inflow)| ground > inflow) {
                first_out = first_out.min(slab);
            }
        };
        for (slab, (piece, _)) in whole.slabs.iter().enumerate() {
            see(&piece.ground, &piece.inflow, slab);
        }
        for cut in 0..slabs.saturating_sub(1) {
            let rows = cut_rows(whole, cut);
            see(&whole.cuts.ground[rows.clone()], &whole.cuts.inflow[rows], cut);
        }
        Self { factors: (0..slabs).map(|_| None).collect(), margin: 1, first_out }
    }

    /// Brings the pressures of the whole close to its solution, from those of before so many constrictions
    /// of each slab changed, if stretches of it will do: their residual is within a part of the one that is
    /// asked for. Which slabs these have.
    pub(super) fn improve(
        &mut self,
        whole: &Equations,
        columns: &mut [Columns],
        residual: f64,
        changed: &[usize],
    ) -> Option<Vec<bool>> {
        for (factor, &more) in self.factors.iter_mut().zip(changed) {
            factor.iter_mut().for_each(|kept| kept.changed += more);
        }
        if changed.iter().all(|&changed| changed == 0) {
            return Some(vec![false; changed.len()]);
        }
        while let Some(stretch) = Stretch::around(whole, changed, self.margin, self.first_out) {
            whole.find_residual(columns);
            if stretch.solve(whole, columns, &mut self.factors, SHARE * residual)? <= SHARE * residual {
                let is_inside = stretch.slabs.iter().map(|&part| part == Part::Inside);
                return Some(is_inside.collect());
            }
            self.margin += 1;
        }
        (self.margin, self.factors) = (1, changed.iter().map(|_| None).collect());
        None
    }
}

/// Rows of a cut among those of all cuts.
fn cut_rows(whole: &Equations, cut: usize) -> Range<usize> {
    whole.slabs[cut + 1].1.start..whole.slabs[cut].1.end
}

/// One stretch, or several.
struct Stretch {
    /// By slab.
    slabs: Vec<Part>,
    /// By cut.
    cuts: Vec<Part>,
    /// By row of all cuts: its row in the stretch.
    row: Vec<u32>,
    /// Rows of cuts and of runs.
    rows: usize,
    /// The run that the reservoir belongs to, or that what lies behind the filter belongs to: its pressure is
    /// no longer what it was.
    floating: Option<(u32, Floating)>,
}

/// Which known pressure changes.
#[derive(Clone, Copy, PartialEq)]
enum Floating {
    Reservoir,
    End,
}

impl Stretch {
    /// With margins of so many slabs around those that changed. None where that is the whole, or both of its
    /// ends.
    fn around(whole: &Equations, changed: &[usize], margin: usize, first_out: usize) -> Option<Self> {
        let number = changed.len();
        let mut inside = vec![false; number];
        for at in (0..number).filter(|&at| changed[at] > 0) {
            inside[at.saturating_sub(margin)..(at + margin + 1).min(number)].fill(true);
        }
        let leaves = first_out.min(number)..number;
        let is_out_inside = inside[leaves.clone()].contains(&true);
        inside[leaves].fill(is_out_inside);
        let is_in_inside = inside[0];
        // With both ends, the flow through what lies between changes.
        if is_in_inside && is_out_inside || !inside.contains(&false) {
            return None;
        }
        // Cuts first, then runs.
        let mut row = vec![NONE; whole.cuts.rows.len()];
        let mut rows = 0;
        for cut in (0..number - 1).filter(|&cut| inside[cut] || inside[cut + 1]) {
            for row in &mut row[cut_rows(whole, cut)] {
                *row = rows;
                rows += 1;
            }
        }
        let mut slabs = vec![Part::Inside; number];
        let last_inside = inside.iter().rposition(|&inside| inside);
        for at in (0..number).filter(|&at| !inside[at]) {
            slabs[at] = if at > 0 && !inside[at - 1] {
                slabs[at - 1]
            } else if !is_in_inside && last_inside < Some(at) {
                Part::Held
            } else {
                rows += 1;
                Part::Run(rows - 1)
            };
        }
        let floating = match [slabs[0], slabs[number - 1]] {
            [Part::Run(run), _] => Some((run, Floating::Reservoir)),
            [_, Part::Run(run)] => Some((run, Floating::End)),
            _ => None,
        };
        let cut = |pair: &[Part]| if pair[0] == pair[1] { pair[0] } else { Part::Inside };
        let cuts = slabs.windows(2).map(cut).collect();
        Some(Self { slabs, cuts, row, rows: rows as usize, floating })
    }

    /// Equations of what pressures change by: of cuts and runs.
    fn of_cuts(&self, whole: &Equations) -> Piece {
        let mut of_cuts = Piece::new(0..self.rows, 0..0, 2 * whole.cuts.links.len());
        for (&row, &ground) in self.row.iter().zip(&whole.cuts.ground) {
            if row != NONE {
                of_cuts.ground[row as usize] = ground;
            }
        }
        for link in &whole.cuts.links {
            let [one, other] = [link.one, link.other].map(|row| self.row[row as usize]);
            if one != NONE {
                of_cuts.links.push(Link { one, other, ..*link });
            }
        }
        self.across(whole, |part, row, conductance| match part {
            Part::Run(run) => of_cuts.links.push(Link { one: row, other: run, conductance }),
            _ => of_cuts.ground[row as usize] += conductance,
        });
        of_cuts
    }

    /// Calls for each link between a run and a cut of the stretch: what the run is, the row of the cut, and
    /// the conductance.
    fn across(&self, whole: &Equations, mut call: impl FnMut(Part, u32, f64)) {
        for (at, &part) in self.slabs.iter().enumerate().filter(|&(_, &part)| part != Part::Inside) {
            let is_beside = |cut: Option<usize>| {
                cut.and_then(|cut| self.cuts.get(cut)).is_some_and(|&cut| cut == Part::Inside)
            };
            if !is_beside(at.checked_sub(1)) && !is_beside(Some(at)) {
                continue;
            }
            let (piece, met) = &whole.slabs[at];
            let rows = piece.rows.len();
            for link in &piece.links {
                let cut = link.one.max(link.other) as usize;
                if let Some(cut) = cut.checked_sub(rows) {
                    let row = self.row[met.start + cut];
                    if row != NONE {
                        call(part, row, link.conductance);
                    }
                }
            }
        }
    }

    /// Solves it from the residual of the whole, and changes the pressures of that; by how much flows to the
    /// runs beyond are altered. None where it takes too many rounds, or pressures fall no longer.
    fn solve(
        &self,
        whole: &Equations,
        columns: &mut [Columns],
        factors: &mut [Option<SlabFactor>],
        goal: f64,
    ) -> Option<f64> {
        let of_cuts = self.of_cuts(whole);
        let inside: Vec<usize> = (0..self.slabs.len()).filter(|&at| self.slabs[at] == Part::Inside).collect();
        let met = |at: usize| {
            let all = whole.slabs[at].1.clone();
            let of_row = |row: usize| self.row[row] as usize;
            if all.is_empty() { 0..0 } else { of_row(all.start)..of_row(all.end - 1) + 1 }
        };
        let slabs = inside.iter().map(|&at| (whole.slabs[at].0, met(at))).collect();
        let equations = Equations { slabs, cuts: &of_cuts };
        renew(&equations, &inside, factors);
        let kept: Vec<&SlabFactor> = inside.iter().filter_map(|&at| factors[at].as_ref()).collect();
        let last = equations.factor_of_cuts(kept.iter().map(|kept| &kept.left));
        let all: Vec<&Factor> = kept.iter().map(|kept| &kept.factor).chain([&last]).collect();
        let mut changes = equations.columns();
        self.take_residual(whole, columns, &inside, &mut changes);
        let size = changes.iter().map(|own| own.sum).sum::<f64>().sqrt();
        equations.descend(&all, &mut changes, [size, 1.0, goal], 0..ROUNDS_OF_STRETCH).ok()?;
        let beyond = self.left_beyond(whole, &changes);
        self.change(whole, columns, &inside, &changes).then_some(beyond)
    }

    /// Residuals of rows of the stretch, from those of the whole.
    fn take_residual(
        &self,
        whole: &Equations,
        columns: &[Columns],
        inside: &[usize],
        changes: &mut [Columns],
    ) {
        let Some((all_cuts, all_slabs)) = columns.split_last() else { return };
        let Some((of_cuts, of_slabs)) = changes.split_last_mut() else { return };
        each(of_slabs, |i, own| own.residual.copy_from_slice(&all_slabs[inside[i]].residual));
        for (&row, &residual) in self.row.iter().zip(&all_cuts.residual) {
            if row != NONE {
                of_cuts.residual[row as usize] = residual;
            }
        }
        // Nothing flows in or out of a run but through its ends.
        for (part, own) in self.slabs.iter().zip(all_slabs) {
            if let Part::Run(run) = part {
                of_cuts.residual[*run as usize] += own.residual.iter().sum::<f64>();
            }
        }
        for (cut, part) in self.cuts.iter().enumerate() {
            if let Part::Run(run) = part {
                of_cuts.residual[*run as usize] +=
                    all_cuts.residual[cut_rows(whole, cut)].iter().sum::<f64>();
            }
        }
        each(changes, |_, own| own.sum = dot(&own.residual, &own.residual));
    }

    /// How the changes alter the flows between runs and cuts of the stretch: the root of the sum of squares.
    /// Flows that make up for one another in a row count, too: they would turn water there.
    fn left_beyond(&self, whole: &Equations, changes: &[Columns]) -> f64 {
        let Some(of_cuts) = changes.last() else { return 0.0 };
        let mut squares = 0.0;
        self.across(whole, |part, row, conductance| {
            let of_run = match part {
                Part::Run(run) => of_cuts.x[run as usize],
                _ => 0.0,
            };
            let flow = conductance * (of_cuts.x[row as usize] - of_run);
            squares += flow * flow;
        });
        squares.sqrt()
    }

    /// Changes pressures of the whole, so that they fall from 1 to 0 again; whether they do.
    fn change(
        &self,
        whole: &Equations,
        columns: &mut [Columns],
        inside: &[usize],
        changes: &[Columns],
    ) -> bool {
        let Some((of_cuts, of_slabs)) = changes.split_last() else { return false };
        let by = |part: Part| match part {
            Part::Run(run) => of_cuts.x[run as usize],
            Part::Inside | Part::Held => 0.0,
        };
        let (mut low, mut fall) = (0.0, 1.0);
        match self.floating {
            Some((run, Floating::Reservoir)) => fall += of_cuts.x[run as usize],
            Some((run, Floating::End)) => {
                low = of_cuts.x[run as usize];
                fall -= low;
            }
            None => {}
        }
        let factor = 1.0 / fall;
        if !(fall > 0.0 && factor.is_finite()) {
            return false;
        }
        let Some((all_cuts, all_slabs)) = columns.split_last_mut() else { return false };
        let mut of_slab = vec![None; self.slabs.len()];
        inside.iter().zip(of_slabs).for_each(|(&at, own)| of_slab[at] = Some(own));
        each(all_slabs, |at, own| {
            let rows = whole.slabs[at].0.rows.len();
            let by = by(self.slabs[at]) - low;
            match of_slab[at] {
                Some(changes) => {
                    let each = own.x[..rows].iter_mut().zip(&changes.x);
                    each.for_each(|(x, change)| *x = (*x + (change + by)) * factor);
                }
                None => own.x[..rows].iter_mut().for_each(|x| *x = (*x + by) * factor),
            }
        });
        for (cut, &part) in self.cuts.iter().enumerate() {
            let by = by(part) - low;
            for row in cut_rows(whole, cut) {
                let change = if part == Part::Inside { of_cuts.x[self.row[row] as usize] } else { 0.0 };
                all_cuts.x[row] = (all_cuts.x[row] + (change + by)) * factor;
            }
        }
        true
    }
}

/// Makes factors of these slabs where there are none, or much has changed since; those of others go.
fn renew(equations: &Equations, inside: &[usize], factors: &mut [Option<SlabFactor>]) {
    for (at, factor) in factors.iter_mut().enumerate() {
        if inside.binary_search(&at).is_err() {
            *factor = None;
        }
    }
    let mut wanted: Vec<(usize, Option<SlabFactor>)> = Vec::new();
    for (i, &at) in inside.iter().enumerate() {
        let links = equations.slabs[i].0.links.len();
        if factors[at].as_ref().is_none_or(|kept| kept.changed * FACTOR_KEPT_UNTIL > links) {
            wanted.push((i, None));
        }
    }
    each(&mut wanted, |_, (i, made)| {
        let Piece { met, links, ground, .. } = equations.slabs[*i].0;
        let (factor, left) = Factor::new(ground, met.len(), links);
        *made = Some(SlabFactor { factor, left, changed: 0 });
    });
    wanted.into_iter().for_each(|(i, made)| factors[inside[i]] = made);
}
