//! The voids and constrictions of a run as they fill and close, for ParaView.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::error::ReportError;
use super::files::rows;
use super::vtu::{CellKind, Grid};
use crate::outcome::record::{BlockedRow, ConstrictionRow, RetainedRow, VoidRow};

/// A moment: run, and increments that were done.
type Moment = (u64, u64);

/// Contents and moments of the drawing: the tables of a folder.
pub(super) struct Tables {
    voids: Vec<[f64; 3]>,
    constrictions: Vec<ConstrictionRow>,
    /// Moment at which each constriction was blocked, by its number.
    blocked: BTreeMap<u64, Moment>,
    /// Contents of voids, by moment.
    retained: BTreeMap<Moment, Vec<RetainedRow>>,
    /// Moments that are drawn.
    moments: BTreeSet<Moment>,
}

/// Writes grids of a run that kept its voids: for each moment `voids_N.vtu`, a point for each void with its
/// contents, and `constrictions_N.vtu`, a line for each constriction with its diameter, its conductance and
/// the time of blocking, if any; and `voids.pvd` and `constrictions.pvd`, which ParaView opens as a sequence
/// of moments.
///
/// # Errors
/// Returns the errors of `write`.
pub(super) fn grids(
    tables: &Tables,
    mut write: impl FnMut(&str, &[u8]) -> Result<(), ReportError>,
) -> Result<(), ReportError> {
    for (kind, grid) in GRIDS {
        let mut sets = String::new();
        for (number, &moment) in tables.moments.iter().enumerate() {
            let name = format!("{kind}_{number:04}.vtu");
            write(&name, &grid(tables, moment))?;
            let time = tables.time_of(moment);
            sets += &format!("<DataSet timestep=\"{time}\" file=\"{name}\"/>\n");
        }
        let text = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" \
             byte_order=\"LittleEndian\">\n<Collection>\n{sets}</Collection>\n</VTKFile>\n"
        );
        write(&format!("{kind}.pvd"), text.as_bytes())?;
    }
    Ok(())
}

/// Draws a moment: the bytes of a grid.
type Draw = fn(&Tables, Moment) -> Vec<u8>;

/// Functions that draw each moment, by the name of its files.
const GRIDS: [(&str, Draw); 2] = [("voids", Tables::voids_at), ("constrictions", Tables::lines_at)];

impl Tables {
    /// The tables of a folder.
    ///
    /// # Errors
    /// [`ReportError`] names the table and the line.
    pub(super) fn read(folder: &Path) -> Result<Self, ReportError> {
        let path = |name: &str| folder.join(name);
        let voids = rows::<VoidRow>(&path("voids.csv"))?;
        let count = voids.len() as u64;
        // The row number of a void is its number.
        for (index, (line, row)) in (0u64..).zip(&voids) {
            check(&path("voids.csv"), *line, row.void == index, || {
                format!("void is {}, allowed: {index}", row.void)
            })?;
        }
        let mut constrictions = Vec::new();
        for (line, row) in rows::<ConstrictionRow>(&path("constrictions_of_network.csv"))? {
            let known = |void: i64| void < count as i64;
            check(
                &path("constrictions_of_network.csv"),
                line,
                known(row.from) && known(row.to) && row.from.max(row.to) >= 0,
                || format!("joins {} and {}, but voids.csv holds {count} voids", row.from, row.to),
            )?;
            constrictions.push(row);
        }
        let mut blocked = BTreeMap::new();
        for (_, row) in rows::<BlockedRow>(&path("blocked.csv"))? {
            blocked.entry(row.constriction).or_insert((row.run, row.increment));
        }
        let mut retained: BTreeMap<Moment, Vec<RetainedRow>> = BTreeMap::new();
        for (line, row) in rows::<RetainedRow>(&path("retained_by_void.csv"))? {
            check(&path("retained_by_void.csv"), line, row.void < count as i64, || {
                format!("void is {}, but voids.csv holds {count} voids", row.void)
            })?;
            retained.entry((row.run, row.increment)).or_default().push(row);
        }
        let moments = [(1, 0)].into_iter().chain(retained.keys().copied()).collect();
        let voids = voids.into_iter().map(|(_, row)| [row.x_mm, row.y_mm, row.z_mm]).collect();
        Ok(Self { voids, constrictions, blocked, retained, moments })
    }

    /// The time of a moment: increments, with the second run after the first.
    fn time_of(&self, (run, increment): Moment) -> u64 {
        let last = |run: u64| self.moments.iter().filter(|m| m.0 == run).map(|m| m.1).max().unwrap_or(0);
        let before: u64 = self.moments.iter().map(|m| m.0).filter(|&r| r < run).max().map_or(0, last);
        before.saturating_add(increment)
    }

    fn voids_at(&self, moment: Moment) -> Vec<u8> {
        let mut held = [vec![0.0; self.voids.len()], vec![0.0; self.voids.len()]];
        for row in self.retained.get(&moment).into_iter().flatten() {
            // The reservoir before the filter, -1, is no void of it.
            if let Ok(void) = usize::try_from(row.void) {
                held[0][void] = row.retained_in_constrictions as f64;
                held[1][void] = row.retained_in_voids as f64;
            }
        }
        let [in_constrictions, in_voids] = held;
        // The second run counts from zero again.
        let columns = [
            ("retained_in_constrictions_in_this_run".to_owned(), in_constrictions),
            ("retained_in_voids_in_this_run".to_owned(), in_voids),
        ];
        let corners: Vec<i64> = (0..self.voids.len() as i64).collect();
        Grid { points: &self.voids, kind: CellKind::Vertex, corners: &corners, columns: &columns }.file()
    }

    fn lines_at(&self, moment: Moment) -> Vec<u8> {
        let ends = |row: &ConstrictionRow| {
            let vector = [row.dx_mm, row.dy_mm, row.dz_mm];
            let by = |p: [f64; 3], sign: f64| [0, 1, 2].map(|axis| p[axis] + sign * vector[axis]);
            match usize::try_from(row.from) {
                Ok(from) => [self.voids[from], by(self.voids[from], 1.0)],
                Err(_) => [by(self.voids[row.to as usize], -1.0), self.voids[row.to as usize]],
            }
        };
        let points: Vec<[f64; 3]> = self.constrictions.iter().flat_map(ends).collect();
        let corners: Vec<i64> = (0..points.len() as i64).collect();
        let column = |name: &str, value: &dyn Fn(&ConstrictionRow) -> f64| {
            (name.to_owned(), self.constrictions.iter().map(value).collect::<Vec<f64>>())
        };
        let blocked_at =
            |row: &ConstrictionRow| self.blocked.get(&row.constriction).filter(|&&at| at <= moment);
        let columns = [
            column("diameter_mm", &|row| row.diameter_mm),
            column("conductance", &|row| row.conductance),
            column("blocked", &|row| f64::from(u8::from(blocked_at(row).is_some()))),
            // An open constriction has -1.
            column("blocked_at", &|row| blocked_at(row).map_or(-1.0, |&at| self.time_of(at) as f64)),
        ];
        Grid { points: &points, kind: CellKind::Line, corners: &corners, columns: &columns }.file()
    }
}

fn check(path: &Path, line: u64, holds: bool, message: impl Fn() -> String) -> Result<(), ReportError> {
    match holds {
        true => Ok(()),
        false => Err(ReportError::Form { path: path.to_owned(), line, message: message() }),
    }
}
