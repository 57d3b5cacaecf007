//! Packings of filter grains, and their compression.
//!
//! # Protocol
//! All gradations and frictions use the same protocol ([`compress`]):
//!
//! 1. sizes stratified by number ([`draw`]), random positions without overlap ([`random_start`]);
//! 2. squeeze: the cell shrinks at a constant rate to a fraction of the expected packing fraction;
//! 3. compress: the strain rate is proportional to the pressure deficit, up to a limit, with the friction
//!    that sets the density; once the pressure is within 2 %, the drag on the grains is raised to
//!    `settling_drag`;
//! 4. settle: repeat step 3 with the final friction, if that is different.
//!
//! # End of a stage
//! The state is checked every 100 steps. The pressure must be within 0.5 %, the root mean square unbalanced
//! force below 5 % of the mean contact force, the coordination number within 0.05 and the void ratio within
//! 5e-4 of their values `hold_steps` ago, and at the end the kinetic energy below 1 % of the elastic energy.
//!
//! The paper's criterion is the coordination number alone, held for 20,000 of its shorter steps. That
//! also holds while a packing still creeps, so the void ratio has to hold too. No packing stops creeping
//! altogether: without friction creep continues by ever rarer avalanches, and in a wide gradation with
//! high friction by sliding, both roughly as the logarithm of time (if the unbalanced force has to fall
//! to 2 %, without friction, the void ratio is 0.003 lower for Cu 1.5 and 0.002 for Cu 3, and the steps
//! are two to three times as many). So some rate has to count as rest; this one is, per hold, a quarter
//! of the 0.002 to which the void ratio is needed. Rattlers make the kinetic energy fall slowly and the
//! void ratio not at all, so that limit is wide; [`PackReport`] gives the values reached.
//!
//! If crowded grains are given a larger mass (the largest grain at least 20 times as wide as the smallest),
//! steps are longer, and a hold lasts as many steps as the grains' own masses would take for the same time.

#[cfg(test)]
mod checks;
mod contact;
mod fields;
mod import;
#[cfg(test)]
mod import_tests;
mod motion;
mod neighbours;
mod protocol;
mod settings;
mod state;
mod tables;
mod vtk;

pub use fields::{ImportError, LengthUnit, PACKING_FILE_LIMIT_BYTES, ReadingNote};
pub use import::{CellOption, ReadOptions};
pub use protocol::{CompressionProgress, PackReport, compress};
pub use settings::{PackingError, Settings, is_wide};
pub use state::{Compression, Measure, Stage};

use crate::gradation::Gradation;
use crate::stream::{Key, Purpose, unit};
use neighbours::Aspect;
use rand::Rng;
use std::f64::consts::PI;
use std::fmt::Write;

/// Cell that holds the grains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell {
    /// Periodic box from the origin to these lengths along x, y, z (mm).
    Periodic([f64; 3]),
    /// No cell: free boundaries; every statistic ignores the outer 5 %.
    Free,
}

/// Filter grains as columns; grain `i` is entry `i` of each column.
///
/// ```
/// use voidwalk_core::packing::{Cell, Packing};
/// let grains = [[0.0, 0.0, 0.0, 1.0], [1.0, 1.0, 1.0, 0.7]];
/// let packing = Packing::from_grains(Cell::Periodic([2.0; 3]), grains);
/// assert_eq!(Packing::parse("grains.csv", packing.to_csv().as_bytes())?, packing);
/// # Ok::<(), voidwalk_core::packing::ImportError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Packing {
    /// Cell containing the grains.
    pub cell: Cell,
    /// Centre along x (mm).
    pub x: Vec<f64>,
    /// Centre along y (mm).
    pub y: Vec<f64>,
    /// Centre along z (mm).
    pub z: Vec<f64>,
    /// Diameter (mm).
    pub diameter: Vec<f64>,
}

impl Packing {
    /// Makes a packing from the x, y, z and diameter of each grain (mm).
    pub fn from_grains(cell: Cell, grains: impl IntoIterator<Item = [f64; 4]>) -> Self {
        let grains = grains.into_iter();
        let column = || Vec::with_capacity(grains.size_hint().0);
        let mut packing = Self { cell, x: column(), y: column(), z: column(), diameter: column() };
        for [x, y, z, diameter] in grains {
            packing.x.push(x);
            packing.y.push(y);
            packing.z.push(z);
            packing.diameter.push(diameter);
        }
        packing
    }

    /// Multiplies every length of the packing by `factor`.
    pub fn scaled(mut self, factor: f64) -> Self {
        let columns = [&mut self.x, &mut self.y, &mut self.z, &mut self.diameter];
        columns.into_iter().flatten().for_each(|mm| *mm *= factor);
        if let Cell::Periodic(edges) = &mut self.cell {
            edges.iter_mut().for_each(|mm| *mm *= factor);
        }
        self
    }

    /// Writes this packing as CSV: cell, header, a row per grain. [`Packing::parse`] restores the same bits.
    pub fn to_csv(&self) -> String {
        let mut text = match self.cell {
            Cell::Periodic([x, y, z]) => format!("# cell_mm = {x}, {y}, {z}\n"),
            Cell::Free => String::from("# cell = none\n"),
        };
        text.push_str("x_mm,y_mm,z_mm,diameter_mm\n");
        for i in 0..self.diameter.len() {
            // Writing to a String never fails.
            let _ = writeln!(text, "{},{},{},{}", self.x[i], self.y[i], self.z[i], self.diameter[i]);
        }
        text
    }

    /// Writes the grains for ParaView: points (mm) with their diameter, to be shown as spheres.
    pub fn to_vtp(&self) -> String {
        let points: Vec<[f64; 3]> =
            (0..self.diameter.len()).map(|i| [self.x[i], self.y[i], self.z[i]]).collect();
        vtp_points(&points, &[("diameter_mm", &self.diameter)])
    }
}

/// Writes points and columns of named numbers as a VTK PolyData file.
pub(crate) fn vtp_points(points: &[[f64; 3]], columns: &[(&str, &[f64])]) -> String {
    let count = points.len();
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\">\n\
         <PolyData>\n<Piece NumberOfPoints=\"{count}\" NumberOfVerts=\"{count}\" NumberOfLines=\"0\" \
         NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<PointData>\n"
    );
    for (name, values) in columns {
        let _ = writeln!(text, "<DataArray type=\"Float64\" Name=\"{name}\" format=\"ascii\">");
        values.iter().for_each(|value| {
            let _ = writeln!(text, "{value}");
        });
        text.push_str("</DataArray>\n");
    }
    text.push_str(
        "</PointData>\n<Points>\n<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n",
    );
    for [x, y, z] in points {
        let _ = writeln!(text, "{x} {y} {z}");
    }
    text.push_str("</DataArray>\n</Points>\n<Verts>\n");
    for (name, first) in [("connectivity", 0), ("offsets", 1)] {
        let _ = writeln!(text, "<DataArray type=\"Int64\" Name=\"{name}\" format=\"ascii\">");
        for i in first..first + count {
            let _ = writeln!(text, "{i}");
        }
        text.push_str("</DataArray>\n");
    }
    text.push_str("</Verts>\n</Piece>\n</PolyData>\n</VTKFile>\n");
    text
}

/// Draws diameters (mm, descending) from the known sizes of a gradation, one from each of `grains` equal
/// strata by number: the sample follows the gradation much more closely than independent draws would.
///
/// A pan fraction is left out: its grains are too fine to form the skeleton, and their number is unknown.
///
/// ```
/// use voidwalk_core::{gradation::Gradation, packing::draw};
/// let filter = Gradation::linear_from_d0(1.0, 1.5).unwrap();
/// let diameter_mm = draw(&filter, 1000, 1);
/// assert!(diameter_mm[0] <= 2.25 && diameter_mm[999] >= 1.0);
/// ```
pub fn draw(gradation: &Gradation, grains: usize, seed: u64) -> Vec<f64> {
    let mut random = uniform(seed, 0);
    let mut diameter: Vec<f64> = (0..grains)
        .map(|i| 100.0 * (i as f64 + random()) / grains as f64)
        .filter_map(|percent| gradation.d_by_number(percent))
        .collect();
    diameter.sort_by(|a, b| b.total_cmp(a));
    diameter
}

/// Random numbers from 0 to below 1.
pub(crate) fn uniform(seed: u64, chunk: u64) -> impl FnMut() -> f64 {
    let mut generator = Key { seed, purpose: Purpose::Packing, run: 0, increment: 0, chunk }.generator();
    move || unit(generator.next_u64())
}

/// Places these grains (mm, any order) at random without overlap, at the packing fraction of the
/// settings; the resulting grains are in descending order of size.
///
/// # Errors
/// Settings out of range; an invalid diameter; a cell narrower than two of the largest grain; no room.
pub fn random_start(diameter_mm: &[f64], settings: &Settings) -> Result<Packing, PackingError> {
    tall_start(diameter_mm, 1.0, settings)
}

/// Places grains like [`random_start`] in a cell whose height (along z) is `aspect` (1 to 100) times its
/// width.
///
/// # Errors
/// Errors of [`random_start`]; an aspect out of range.
pub fn tall_start(diameter_mm: &[f64], aspect: f64, settings: &Settings) -> Result<Packing, PackingError> {
    settings.check()?;
    if !(1.0..=Aspect::TALLEST).contains(&aspect) {
        return Err(PackingError::Aspect(aspect));
    }
    let aspect = Aspect::new(aspect);
    if diameter_mm.is_empty() {
        return Err(PackingError::Columns([0; 4]));
    }
    PackingError::unless_sizes(diameter_mm)?;
    let mut diameter = diameter_mm.to_vec();
    diameter.sort_by(|a, b| b.total_cmp(a));
    let unit_mm = diameter[diameter.len() - 1];
    let radius: Vec<f64> = diameter.iter().map(|d| 0.5 * (d / unit_mm)).collect();
    let volume = radius.iter().map(|r| r * r * r).sum::<f64>() * (4.0 / 3.0 * PI);
    let cell = libm::cbrt(volume / settings.start_fraction / aspect.height());
    if cell < 4.0 * radius[0] {
        return Err(PackingError::NarrowCell { cell_mm: cell * unit_mm, largest_mm: diameter[0] });
    }
    let centre = place(&radius, cell, aspect, uniform(settings.seed, 1))?;
    let edge = cell * unit_mm;
    let cell = Cell::Periodic([edge, edge, edge * aspect.height()]);
    let grains = centre.iter().zip(diameter).map(|(c, d)| [c[0] * edge, c[1] * edge, c[2] * edge, d]);
    Ok(Packing::from_grains(cell, grains))
}

/// Maximum number of tries per grain before the placement fails.
const TRIES: usize = 2_000_000;

/// A grid of the placed grains of one size level.
struct Grid {
    radius: f64,
    /// Number of cells along x and along y; `along` is the number along z.
    across: usize,
    along: usize,
    /// Position and radius of the grains in each cell.
    cells: Vec<Vec<[f64; 4]>>,
}

/// Finds centres, in units of the cell's width, for spheres of these radii (descending), so that no two
/// overlap in a periodic cell of width `cell` and this aspect.
fn place(
    radius: &[f64],
    cell: f64,
    aspect: Aspect,
    mut random: impl FnMut() -> f64,
) -> Result<Vec<[f64; 3]>, PackingError> {
    let mut centre: Vec<[f64; 3]> = Vec::with_capacity(radius.len());
    let mut grids: Vec<Grid> = Vec::new();
    for (i, &r) in radius.iter().enumerate() {
        if grids.last().is_none_or(|g| r < 0.5 * g.radius) {
            let members = radius[i..].iter().take_while(|&&q| q >= 0.5 * r).count();
            let widest = libm::cbrt(4.0 * members as f64 / aspect.height()) as usize;
            let across = ((cell / (2.0 * r)) as usize).min(widest).max(1);
            let along = aspect.along(across);
            grids.push(Grid { radius: r, across, along, cells: vec![Vec::new(); across * across * along] });
        }
        let mut tries = 0;
        let s = loop {
            let s = [random(), random(), random() * aspect.height()];
            if grids.iter().all(|grid| grid.is_clear(s, r, cell, aspect)) {
                break s;
            }
            tries += 1;
            if tries == TRIES {
                let volume = radius.iter().map(|r| r * r * r).sum::<f64>() * (4.0 / 3.0) * PI;
                let fraction = volume / (cell * cell * cell * aspect.height());
                return Err(PackingError::Placement { grain: i, grains: radius.len(), fraction });
            }
        };
        let grid = grids.last_mut().expect("pushed above");
        let index = |s: f64, n: usize| ((s * n as f64) as usize).min(n - 1);
        let column = index(s[0], grid.across) * grid.across + index(s[1], grid.across);
        grid.cells[column * grid.along + index(s[2] / aspect.height(), grid.along)]
            .push([s[0], s[1], s[2], r]);
        centre.push(s);
    }
    Ok(centre)
}

impl Grid {
    /// Tells if a grain of radius `r` at `s` would overlap no grain in the grid.
    fn is_clear(&self, s: [f64; 3], r: f64, cell: f64, aspect: Aspect) -> bool {
        let (across, along) = (self.across as i64, self.along as i64);
        let half = (r + self.radius) / cell;
        let range = |s: f64, half: f64, n: i64| {
            let low = libm::floor((s - half) * n as f64) as i64;
            let high = libm::floor((s + half) * n as f64) as i64;
            if high - low >= n { 0..=n - 1 } else { low..=high }
        };
        let z = range(s[2] / aspect.height(), half / aspect.height(), along);
        let is_apart = |q: &[f64; 4]| {
            let reach = (r + q[3]) / cell;
            aspect.square(&s, q) >= reach * reach
        };
        range(s[0], half, across).all(|x| {
            range(s[1], half, across).all(|y| {
                let row = (x.rem_euclid(across) * across + y.rem_euclid(across)) * along;
                z.clone().all(|z| self.cells[(row + z.rem_euclid(along)) as usize].iter().all(is_apart))
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_grains_overlap() {
        for height in [1.0, 1.7, 6.0] {
            none_overlap(Aspect::new(height));
        }
        let full = place(&[1.0, 1.0], 2.0, Aspect::new(1.0), uniform(5, 2));
        assert!(matches!(full, Err(PackingError::Placement { grain: 1, .. })));
    }

    fn none_overlap(aspect: Aspect) {
        let mut random = uniform(5, 1);
        let mut radius: Vec<f64> = (0..600).map(|_| 0.5 * libm::pow(20.0, random())).collect();
        radius.sort_by(|a, b| b.total_cmp(a));
        let volume: f64 = radius.iter().map(|r| 4.18879 * r * r * r).sum();
        let cell = libm::cbrt(volume / 0.35 / aspect.height());
        let centre = place(&radius, cell, aspect, random).unwrap();
        for i in 0..radius.len() {
            for j in 0..i {
                let apart = aspect.square(&centre[j], &centre[i]).sqrt() * cell;
                assert!(apart >= radius[i] + radius[j]);
            }
        }
    }
}
