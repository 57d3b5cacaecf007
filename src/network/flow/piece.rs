//! The equations of one slab of a network, or of the cuts between slabs.

use std::ops::Range;

use super::rest::Link;

/// Sums that are made side by side: fixed, so that instructions change nothing.
const SIDE_BY_SIDE: usize = 8;

/// The equations of one slab, or of all cuts.
pub(super) struct Piece {
    /// Its rows among all.
    pub rows: Range<usize>,
    /// Rows of cuts that it leads to, counted from the first row of all cuts; the cuts themselves lead to
    /// none.
    pub met: Range<usize>,
    /// Conductances between its rows, and to those of cuts that it leads to, which are counted after them.
    pub links: Vec<Link>,
    /// By row: conductance to pressures that are known.
    pub ground: Vec<f64>,
    /// By row: flow in from where pressure is known.
    pub inflow: Vec<f64>,
}

impl Piece {
    /// Of these rows, joined with nothing yet; with room for so many links.
    pub(super) fn new(rows: Range<usize>, met: Range<usize>, links: usize) -> Self {
        let of_none = vec![0.0; rows.len()];
        Self { rows, met, links: Vec::with_capacity(links), ground: of_none.clone(), inflow: of_none }
    }

    /// Joined with nothing again.
    pub(super) fn clear(&mut self) {
        self.links.clear();
        self.ground.fill(0.0);
        self.inflow.fill(0.0);
    }

    /// Multiplies both sides.
    pub(super) fn scale(&mut self, unit: f64) {
        let sides = self.ground.iter_mut().chain(&mut self.inflow);
        sides.chain(self.links.iter_mut().map(|link| &mut link.conductance)).for_each(|g| *g *= unit);
    }

    /// The most that a row conducts by itself.
    pub(super) fn largest(&self) -> f64 {
        let mut diagonal = self.ground.clone();
        diagonal.resize(self.rows.len() + self.met.len(), 0.0);
        for link in &self.links {
            diagonal[link.one as usize] += link.conductance;
            diagonal[link.other as usize] += link.conductance;
        }
        diagonal.iter().fold(0.0, |a: f64, &b| a.max(b))
    }

    /// The matrix times a column, of its rows and of those of cuts that it leads to; for the latter what its
    /// links come to. Link by link: loops over those of each row would end where no processor expects it.
    pub(super) fn times(&self, x: &[f64], out: &mut [f64]) {
        out.iter_mut().zip(self.ground.iter().zip(x)).for_each(|(out, (ground, x))| *out = ground * x);
        out[self.rows.len()..].fill(0.0);
        for &Link { one, other, conductance } in &self.links {
            let flow = conductance * (x[one as usize] - x[other as usize]);
            out[one as usize] += flow;
            out[other as usize] -= flow;
        }
    }
}

/// What conjugate gradients carry along for a piece: a number by row, and by row of cuts that it leads to.
pub(super) struct Columns {
    /// Pressures.
    pub x: Vec<f64>,
    /// What is missing of the right side; of its own rows alone.
    pub residual: Vec<f64>,
    /// Where the next step goes.
    pub direction: Vec<f64>,
    /// The matrix times one of them.
    pub product: Vec<f64>,
    /// The residual, solved by the factor.
    pub solved: Vec<f64>,
    /// What the factor works with.
    pub scratch: Vec<f64>,
    /// What a sum comes to in this piece.
    pub sum: f64,
}

impl Columns {
    /// Of zeros.
    pub(super) fn of(piece: &Piece) -> Self {
        // Zeros that nobody writes over cost nothing.
        let own = || vec![0.0; piece.rows.len()];
        let all = || vec![0.0; piece.rows.len() + piece.met.len()];
        Self {
            x: all(),
            residual: own(),
            direction: all(),
            product: all(),
            solved: own(),
            scratch: all(),
            sum: 0.0,
        }
    }
}

/// Sum of products.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; SIDE_BY_SIDE];
    for (a, b) in a.chunks(SIDE_BY_SIDE).zip(b.chunks(SIDE_BY_SIDE)) {
        sums.iter_mut().zip(a.iter().zip(b)).for_each(|(sum, (a, b))| *sum += a * b);
    }
    sums.iter().sum()
}
