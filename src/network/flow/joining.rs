//! How the equations of a piece come about, void by void.

use super::piece::Piece;
use super::rest::Link;

/// No row.
pub(super) const NONE: u32 = u32::MAX;

/// A piece that voids are joined in.
pub(super) struct Joining<'a> {
    /// Row by void, or [`NONE`].
    pub row_of: &'a [u32],
    /// The first row of cuts.
    pub cuts: usize,
    pub piece: &'a mut Piece,
}

impl Joining<'_> {
    /// The row of a void in this piece.
    fn row(&self, void: u32) -> Option<u32> {
        let row = self.row_of[void as usize];
        let own = |row: usize| match self.piece.rows.contains(&row) {
            true => row - self.piece.rows.start,
            false => self.piece.rows.len() + row - self.cuts - self.piece.met.start,
        };
        (row != NONE).then(|| own(row as usize) as u32)
    }

    /// Joins two voids. One that is not inside has pressure 0, and between two of these nothing is asked; nor
    /// does a void lead to itself.
    pub(super) fn join(&mut self, one: u32, other: u32, conductance: f64) {
        match [one, other].map(|void| self.row(void)) {
            [None, None] => {}
            [Some(row), None] | [None, Some(row)] => self.piece.ground[row as usize] += conductance,
            [Some(one), Some(other)] if one == other => {}
            [Some(one), Some(other)] => self.piece.links.push(Link { one, other, conductance }),
        }
    }

    /// Joins a void that is inside with a known pressure.
    pub(super) fn hold(&mut self, void: u32, conductance: f64, pressure: f64) {
        let row = self.row(void).expect("it is inside") as usize;
        self.piece.ground[row] += conductance;
        self.piece.inflow[row] += conductance * pressure;
    }

    /// Lets so much flow into a void, if it is inside.
    pub(super) fn feed(&mut self, void: u32, inflow: f64) {
        if let Some(row) = self.row(void) {
            self.piece.inflow[row as usize] += inflow;
        }
    }
}
