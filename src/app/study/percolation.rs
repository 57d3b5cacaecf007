//! Runs a study of the percolation threshold and writes it into a folder.

use std::path::PathBuf;
use std::time::Instant;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::cases::kept::{self, Kept};
use crate::outcome::percolation::{PercolationStudy, is_cube, lattice_name};
use crate::outcome::table::Columns;
use crate::run::RunError;
use crate::run::callbacks::Callbacks;
use crate::run::folder::{FolderKind, claim};
use crate::run::machine::on_threads;
use voidwalk_core::network::{Network, NetworkError, percolation_threshold};

/// Options of a percolation study, and the folder of its results.
#[derive(Clone, Debug)]
pub struct PercolationOptions {
    /// Plan of the study.
    pub plan: PercolationPlan,
    /// Folder for the results.
    pub out: PathBuf,
    /// True if earlier results there are replaced.
    pub overwrite: bool,
    /// Worker threads; by default the number that a cluster's job has, else one per core.
    pub threads: Option<usize>,
}

impl Default for PercolationOptions {
    fn default() -> Self {
        let plan = PercolationPlan::default();
        Self { plan, out: "voidwalk-percolation".into(), overwrite: false, threads: None }
    }
}

/// Plan of a study; the same seed always gives the same bits.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PercolationPlan {
    /// Voids along x and y, and layers, of each lattice.
    pub shapes: Vec<[u32; 3]>,
    /// Realisations of each size.
    pub realisations: u64,
    /// Seed.
    pub seed: u64,
}

impl Default for PercolationPlan {
    fn default() -> Self {
        Self { shapes: [10, 20, 40, 80, 160].map(|size| [size; 3]).to_vec(), realisations: 100, seed: 1 }
    }
}

#[derive(Default, Serialize, Deserialize)]
struct Found {
    /// Lengths of a lattice, and the thresholds of its realisations in order.
    thresholds: Vec<([u32; 3], Vec<f64>)>,
    seconds: f64,
}

/// Finds the thresholds and writes `percolation.csv` and, last, `percolation.json`.
///
/// # Errors
/// Sizes that no lattice can have, or a folder that cannot be claimed, are refused before any work; then
/// errors of the folder. After a kill the same command continues with the lattice that was under way.
pub fn run(options: &PercolationOptions, callbacks: &Callbacks) -> Result<PercolationStudy, RunError> {
    let plan = options.plan.clone().checked().map_err(RunError::refused)?;
    let kind = FolderKind::Percolation;
    let folder = claim(&options.out, kind, options.overwrite)?;
    let work = serde_json::to_string(&plan)?;
    kept::study((&folder, kind, options.overwrite), work, callbacks, |kept, earlier| {
        let results = on_threads(options.threads, || plan.run(earlier.unwrap_or_default(), Some(kept)))?;
        folder.write("percolation.csv", &csv(&results))?;
        Ok(PercolationStudy::new(plan.seed, &results.thresholds, results.seconds))
    })
}

impl PercolationPlan {
    /// Sorts cubes first, by size, and keeps each lattice once. Errors: a length of 0, or too many
    /// constrictions for 32 bits.
    pub(crate) fn checked(mut self) -> Result<Self, NetworkError> {
        self.shapes.sort_unstable_by_key(|&shape| (!is_cube(shape), shape));
        self.shapes.dedup();
        for &shape in &self.shapes {
            Network::lattice_constrictions(shape)?;
        }
        Ok(self)
    }

    /// Finds every missing threshold, realisations side by side, and saves each lattice as soon as it is
    /// done; gives the same bits for any number of threads. [`PercolationPlan::checked`] rules out all errors
    /// except those of the folder.
    fn run(&self, mut found: Found, kept: Option<&Kept>) -> Result<Found, RunError> {
        let (begun, seconds_before) = (Instant::now(), found.seconds);
        for &shape in &self.shapes[found.thresholds.len()..] {
            let one = |realisation| percolation_threshold(shape, self.seed, realisation);
            let all: Result<Vec<f64>, NetworkError> =
                (1..=self.realisations).into_par_iter().map(one).collect();
            found.thresholds.push((shape, all?));
            found.seconds = seconds_before + begun.elapsed().as_secs_f64();
            kept.map_or(Ok(()), |kept| kept.keep(found.thresholds.len(), &found))?;
        }
        Ok(found)
    }
}

/// `percolation.csv`: one row per realisation; a lattice that is not a cube is written as 40x40x60.
fn csv(found: &Found) -> Vec<u8> {
    let of_lattice = |(shape, all): &'_ ([u32; 3], Vec<f64>)| {
        let shape = *shape;
        (1..).zip(all.clone()).map(move |(realisation, threshold)| (shape, realisation, threshold))
    };
    let rows: Vec<([u32; 3], u64, f64)> = found.thresholds.iter().flat_map(of_lattice).collect();
    Columns::default()
        .column("size", |row: &([u32; 3], u64, f64)| lattice_name(row.0))
        .column("realisation", |row| row.1)
        .column("threshold", |row| row.2)
        .csv(&rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(shapes: Vec<[u32; 3]>, realisations: u64, seed: u64) -> Result<PercolationPlan, NetworkError> {
        PercolationPlan { shapes, realisations, seed }.checked()
    }

    #[test]
    fn threads_change_no_bit() {
        let plan = plan(vec![[4, 5, 6], [12; 3], [6; 3], [4, 5, 6], [6; 3], [4, 3, 9]], 20, 3).unwrap();
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            String::from_utf8(csv(&pool.install(|| plan.run(Found::default(), None)).unwrap())).unwrap()
        };
        let one = on(1);
        assert_eq!(one, on(3));
        assert!(one.starts_with("size,realisation,threshold\n6,1,"));
        let firsts: Vec<&str> =
            one.lines().filter_map(|row| row.split_once(",1,")).map(|row| row.0).collect();
        assert_eq!(firsts, ["6", "12", "4x3x9", "4x5x6"]);
        assert_eq!(one.lines().count(), 81);
    }

    /// Continues after a kill, and in a folder whose lattices are all done.
    #[test]
    fn a_study_continues_with_the_lattices_that_are_left() {
        let plan = plan(vec![[6; 3], [8; 3], [4, 5, 6]], 10, 3).unwrap();
        let whole = plan.run(Found::default(), None).unwrap();
        for done in 0..=whole.thresholds.len() {
            let kept = Found { thresholds: whole.thresholds[..done].to_vec(), seconds: 1000.0 };
            let kept: Found = serde_json::from_str(&serde_json::to_string(&kept).unwrap()).unwrap();
            let again = plan.run(kept, None).unwrap();
            assert_eq!(again.thresholds, whole.thresholds, "{done}");
            assert!(again.seconds >= 1000.0);
        }
    }

    #[test]
    fn impossible_sizes_are_refused_before_any_work() {
        assert!(plan(vec![[10, 10, 0]], 1, 1).is_err());
        assert!(plan(vec![[2000; 3]], 1, 1).is_err());
    }
}
