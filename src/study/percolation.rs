//! Runs a study of the percolation threshold and writes it into a folder.

use std::path::PathBuf;
use std::time::Instant;

use rayon::prelude::*;

use crate::network::{Network, NetworkError, percolation_threshold};
use crate::outcome::percolation::{PercolationStudy, is_cube, lattice_name};
use crate::outcome::table::Columns;
use crate::run::callbacks::Callbacks;
use crate::run::error::RunError;
use crate::run::folder::{FolderKind, claim, clear};
use crate::run::machine::on_threads;
use crate::run::results::json;
use crate::run::unfinished::Unfinished;

/// What a percolation study is asked for, and where it goes.
#[derive(Clone, Debug)]
pub struct PercolationOptions {
    /// Voids along x and y, and layers, of one lattice after another.
    pub shapes: Vec<[u32; 3]>,
    /// Realisations of each size.
    pub realisations: u64,
    /// Seed; the same seed gives the same bits.
    pub seed: u64,
    /// Folder for the results.
    pub out: PathBuf,
    /// Whether earlier results there are replaced.
    pub overwrite: bool,
    /// Worker threads; without a number as many as a cluster's job has, else one per core.
    pub threads: Option<usize>,
}

impl Default for PercolationOptions {
    fn default() -> Self {
        Self {
            shapes: [10, 20, 40, 80, 160].map(|size| [size; 3]).to_vec(),
            realisations: 100,
            seed: 1,
            out: "voidwalk-percolation".into(),
            overwrite: false,
            threads: None,
        }
    }
}

/// Finds the thresholds and writes `percolation.csv` and, last, `percolation.json`.
///
/// # Errors
/// Sizes that no lattice can have and a folder that cannot be claimed are refused before any work; what the
/// folder says.
pub fn run(options: &PercolationOptions, callbacks: &Callbacks) -> Result<PercolationStudy, RunError> {
    let plan = PercolationPlan::new(options.shapes.clone(), options.realisations, options.seed);
    let plan = plan.map_err(RunError::refused)?;
    let folder = claim(&options.out, FolderKind::Percolation, options.overwrite)?;
    let (kind, name) = (FolderKind::Percolation, FolderKind::Percolation.record());
    let mark = Unfinished { kind: kind.name().into(), work: format!("{plan:?}"), ..Unfinished::default() };
    if let Some(study) = mark.whole(&folder, name)?.filter(|_| !options.overwrite) {
        callbacks.finish(kind, &folder)?;
        return Ok(study);
    }
    let run = on_threads(options.threads, || Ok(plan.run()?))?;
    clear(&folder, kind)?;
    mark.begin(&folder)?;
    folder.write("percolation.csv", &run.csv())?;
    folder.write(name, &json(name, &run.study)?)?;
    callbacks.finish(kind, &folder)?;
    Ok(run.study)
}

/// Thresholds of several sizes of lattice.
#[derive(Debug)]
pub struct PercolationRun {
    /// What `percolation.json` holds.
    pub study: PercolationStudy,
    /// Voids along x and y, and layers; and the threshold of each realisation in order.
    pub thresholds: Vec<([u32; 3], Vec<f64>)>,
}

/// What a study is asked for, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct PercolationPlan {
    /// Voids along x and y, and layers: cubes first, ascending, each lattice once.
    shapes: Vec<[u32; 3]>,
    realisations: u64,
    seed: u64,
}

impl PercolationPlan {
    /// `realisations` lattices of each of these shapes.
    ///
    /// # Errors
    /// A length of 0, or more constrictions than 32 bits can number.
    pub fn new(mut shapes: Vec<[u32; 3]>, realisations: u64, seed: u64) -> Result<Self, NetworkError> {
        shapes.sort_unstable_by_key(|&shape| (!is_cube(shape), shape));
        shapes.dedup();
        for &shape in &shapes {
            Network::lattice_constrictions(shape)?;
        }
        Ok(Self { shapes, realisations, seed })
    }

    /// Finds every threshold, realisations side by side; the same bits for any number of threads.
    ///
    /// # Errors
    /// None that [`PercolationPlan::new`] has not found.
    pub fn run(&self) -> Result<PercolationRun, NetworkError> {
        let begun = Instant::now();
        let mut thresholds = Vec::new();
        for &shape in &self.shapes {
            let one = |realisation| percolation_threshold(shape, self.seed, realisation);
            let all: Result<Vec<f64>, NetworkError> =
                (1..=self.realisations).into_par_iter().map(one).collect();
            thresholds.push((shape, all?));
        }
        let study = PercolationStudy::new(self.seed, &thresholds, begun.elapsed().as_secs_f64());
        Ok(PercolationRun { study, thresholds })
    }
}

impl PercolationRun {
    /// One row a realisation: `size,realisation,threshold`; the size of a lattice that is no cube is written
    /// as 40x40x60.
    pub fn csv(&self) -> Vec<u8> {
        let of_lattice = |(shape, all): &'_ ([u32; 3], Vec<f64>)| {
            let shape = *shape;
            (1..).zip(all.clone()).map(move |(realisation, threshold)| (shape, realisation, threshold))
        };
        let rows: Vec<([u32; 3], u64, f64)> = self.thresholds.iter().flat_map(of_lattice).collect();
        Columns::default()
            .column("size", |row: &([u32; 3], u64, f64)| lattice_name(row.0))
            .column("realisation", |row| row.1)
            .column("threshold", |row| row.2)
            .csv(&rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_change_no_bit() {
        let plan =
            PercolationPlan::new(vec![[4, 5, 6], [12; 3], [6; 3], [4, 5, 6], [6; 3], [4, 3, 9]], 20, 3)
                .unwrap();
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            String::from_utf8(pool.install(|| plan.run()).unwrap().csv()).unwrap()
        };
        let one = on(1);
        assert_eq!(one, on(3));
        assert!(one.starts_with("size,realisation,threshold\n6,1,"));
        let firsts: Vec<&str> =
            one.lines().filter_map(|row| row.split_once(",1,")).map(|row| row.0).collect();
        assert_eq!(firsts, ["6", "12", "4x3x9", "4x5x6"]);
        assert_eq!(one.lines().count(), 81);
    }

    #[test]
    fn impossible_sizes_are_refused_before_any_work() {
        assert!(PercolationPlan::new(vec![[10, 10, 0]], 1, 1).is_err());
        assert!(PercolationPlan::new(vec![[2000; 3]], 1, 1).is_err());
    }
}
