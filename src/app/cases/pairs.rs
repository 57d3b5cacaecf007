//! Walks of a batch: the pairs of samples and filters as the cases of a campaign that share one seed.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use super::file_names::{as_folders, names, refuse_twice};
use super::inputs::InputSoils;
use super::plan::{CasePlan, PlannedCase};
use super::run::{CaseOptions, unsound};
use crate::run::error::RunError;
use crate::run::folder::shown;
use crate::scene::{Scene, TableOptions};
use crate::verdict::WalkedRow;
use crate::words::batch::{EXCHANGED, MAY_GOVERN};
use voidwalk_core::gradation::GradationError;
use voidwalk_core::schema::setting_name;
use voidwalk_practice::SheetCover;
use voidwalk_practice::batch::{NAMED, governing};
use voidwalk_practice::{BatchFilter, BatchRow, BatchTable, PairOptions};
use voidwalk_sheets::curves_in_file;

/// Voids across the lattice of a first look, as `voidwalk boundary` searches.
const ACROSS: u64 = 20;

/// Settings that give the lattice a size of the user's own.
const OWN_LATTICE: [&str; 4] = ["network.nx", "network.ny", "network.file", "network.packing"];

/// Which pairs are walked, and how.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BatchWalks {
    /// A first look at every sample, and the three that govern each filter in full.
    #[default]
    GoverningInFull,
    /// A first look at every sample.
    FirstLook,
    /// The three that govern each filter alone, in full.
    GoverningAlone,
    /// The one base against every filter, as the settings say.
    OneBase,
}

/// A batch, its pairs worked out.
#[derive(Clone, Debug)]
pub struct BatchPlan {
    /// The samples, as they were named.
    pub(super) samples: PathBuf,
    /// The filters.
    pub(super) filters: Vec<BatchFilter>,
    /// The curve of the one base as sampled; empty if each soil is a sample.
    pub(super) base: Vec<[f64; 2]>,
    /// Answer of practice on each pair, before any walk.
    pub(super) rows: Vec<WalkedRow>,
    /// Name of the case of each row, walked or not.
    pub(super) cases: Vec<String>,
    /// Cases that are walked in full.
    pub(super) in_full: HashSet<String>,
    /// Assumptions about the files.
    pub(super) notes: Vec<String>,
    /// The cases that are walked.
    pub(super) campaign: CasePlan,
}

impl BatchPlan {
    /// The pairs of the samples of a file or a folder with filters. `tables` holds the further options of
    /// each scene. A pair that cannot be walked stays in the table, with the reason.
    ///
    /// # Errors
    /// A file that cannot be read; a filter that is named twice; several soils in place of one base; cases
    /// that do not fit the memory; no pair that can be walked.
    pub fn new(
        samples: &Path,
        filters: &[PathBuf],
        tables: &TableOptions,
        walks: BatchWalks,
        options: &CaseOptions,
    ) -> Result<Self, RunError> {
        let table = pairs_of(samples, filters, tables.of_rules()?, walks != BatchWalks::OneBase)?;
        let cases = case_names(&table, filters);
        let mut plan = Self {
            samples: samples.to_owned(),
            rows: governed(&table),
            filters: table.filters,
            base: if walks == BatchWalks::OneBase { table.base } else { Vec::new() },
            cases,
            in_full: HashSet::new(),
            notes: table.notes,
            campaign: CasePlan {
                file: "batch".into(),
                title: format!("samples of {}", shown(samples)),
                factors: vec!["sample".into(), "filter".into()],
                cases: Vec::new(),
            },
        };
        let looks = first_look(tables);
        for (row, case) in plan.rows.iter_mut().zip(&plan.cases) {
            let in_full = match walks {
                BatchWalks::OneBase => !tables.quick,
                BatchWalks::FirstLook => false,
                BatchWalks::GoverningInFull | BatchWalks::GoverningAlone => row.governs.is_some(),
            };
            if walks == BatchWalks::GoverningAlone && !in_full {
                row.not_walked = match (row.rules.is_refused, row.rules.limit_is_open()) {
                    (true, _) => EXCHANGED,
                    (false, true) => MAY_GOVERN,
                    (false, false) => "does not govern",
                }
                .into();
                continue;
            }
            let as_stated = in_full || walks == BatchWalks::OneBase;
            match scene(row, &plan.filters, if as_stated { tables } else { &looks }) {
                Ok(scene) => {
                    let pair = [("sample", &row.rules.sample), ("filter", &row.rules.filter)];
                    let levels = pair.map(|(factor, level)| (factor.to_owned(), level.clone())).to_vec();
                    plan.campaign.cases.push(PlannedCase { name: case.clone(), levels, scene });
                    plan.in_full.extend(in_full.then(|| case.clone()));
                }
                Err(problem) => row.not_walked = problem,
            }
        }
        plan.leave_out_unsound(options)?;
        Ok(plan)
    }

    /// Replaces the paths of the samples and of each filter by these names, and notes that may hold paths by
    /// the result of `reworded`.
    #[must_use]
    pub fn named(mut self, samples: &str, filters: &[String], reworded: impl Fn(&str) -> String) -> Self {
        let of_filter = (self.rows.len() / self.filters.len().max(1)).max(1);
        for (at, row) in self.rows.iter_mut().enumerate() {
            row.rules.filter.clone_from(&filters[at / of_filter]);
            row.not_walked = reworded(&row.not_walked);
            let case = self.campaign.cases.iter_mut().find(|case| case.name == self.cases[at]);
            let levels = case.into_iter().flat_map(|case| &mut case.levels);
            let level = levels.filter(|(factor, _)| factor == "filter");
            level.for_each(|(_, level)| level.clone_from(&filters[at / of_filter]));
        }
        self.filters.iter_mut().zip(filters).for_each(|(filter, name)| filter.name.clone_from(name));
        self.notes.iter_mut().for_each(|note| *note = reworded(note));
        self.campaign.title = format!("samples of {samples}");
        self.samples = samples.into();
        self
    }

    /// Removes unsound cases from the walks.
    fn leave_out_unsound(&mut self, options: &CaseOptions) -> Result<(), RunError> {
        if !self.campaign.cases.is_empty() {
            for failed in unsound(&self.campaign, options)? {
                self.campaign.cases.retain(|case| case.name != failed.case);
                let at = self.cases.iter().position(|case| *case == failed.case);
                at.into_iter().for_each(|at| self.rows[at].not_walked = failed.problem.clone());
            }
        }
        if self.campaign.cases.is_empty() {
            let why = |row: &WalkedRow| {
                format!("{} and {}: {}", row.rules.sample, row.rules.filter, row.not_walked)
            };
            let reasons: Vec<String> = self.rows.iter().take(NAMED).map(why).collect();
            let problem = format!("no pair of a sample and a filter can be walked\n{}", reasons.join("\n"));
            return Err(RunError::Refused(problem));
        }
        Ok(())
    }

    /// Cover of the sheet: all scenes of the walks agree on it.
    pub(super) fn cover(&self) -> SheetCover {
        self.campaign.cases.first().map(|case| case.scene.about.cover()).unwrap_or_default()
    }

    /// True if page and terminal show inches beside mm.
    pub fn shows_inches(&self) -> bool {
        self.campaign.cases.first().is_some_and(|case| case.scene.about.shows_inches())
    }

    /// Source of the constrictions of the walks, in a sentence.
    pub fn constrictions_in_words(&self) -> String {
        self.campaign.cases.first().map_or(String::new(), |case| case.scene.constrictions_in_words())
    }
}

/// The rows of the samples of a file or a folder against filters, without `each` of one base; every soil of a
/// filter's file is a curve of its envelope.
///
/// # Errors
/// A file that cannot be read; a filter that is named twice; several soils in place of one base.
pub(crate) fn pairs_of(
    samples: &Path,
    filters: &[PathBuf],
    options: PairOptions,
    each: bool,
) -> Result<BatchTable, RunError> {
    refuse_twice(filters)?;
    let bases = InputSoils::samples(&[samples.to_owned()])?;
    let soils = bases.soils.len();
    if soils > 1 && !each {
        return Err(RunError::Refused(format!(
            "{} holds {soils} soils; name one of them as FILE#NAME, or add --each for all of them",
            samples.display()
        )));
    }
    let curves = |filter: &PathBuf| Ok((filter.display().to_string(), curves_in_file(filter, None)?));
    let curves: Result<Vec<_>, GradationError> = filters.iter().map(curves).collect();
    let curves = curves.map_err(RunError::refused)?;
    Ok(BatchTable::new(&bases.soils, curves, bases.notes(filters)?, options))
}

/// The rows of a table, with those that govern.
fn governed(table: &BatchTable) -> Vec<WalkedRow> {
    let of_filters: Vec<Vec<&BatchRow>> =
        table.filters.iter().map(|filter| governing(&table.rows, &filter.name, NAMED)).collect();
    let rank = |row: &BatchRow| {
        let of_filter = |named: &Vec<&BatchRow>| named.iter().position(|other| std::ptr::eq(*other, row));
        of_filters.iter().find_map(of_filter).map(|at| at as u64 + 1)
    };
    let walked = |row: &BatchRow| WalkedRow {
        rules: row.clone(),
        governs: rank(row),
        walk: None,
        not_walked: String::new(),
    };
    table.rows.iter().map(walked).collect()
}

/// A name for each row, no two the same: sample and filter.
fn case_names(table: &BatchTable, filters: &[PathBuf]) -> Vec<String> {
    let samples = table.rows.len() / filters.len().max(1);
    let of_samples = table.rows[..samples].iter().map(|row| row.sample.clone());
    let of_samples = as_folders(of_samples.collect());
    let of_filters = names(filters);
    let pair = |filter: &String| {
        let name = |sample: &String| format!("{sample} in {filter}");
        of_samples.iter().map(name).collect::<Vec<_>>()
    };
    of_filters.iter().flat_map(pair).collect()
}

/// The scene of a pair, or the reason why it has none.
fn scene(row: &WalkedRow, filters: &[BatchFilter], tables: &TableOptions) -> Result<Scene, String> {
    let filter = filters.iter().find(|filter| filter.name == row.rules.filter);
    if filter.is_some_and(|filter| filter.curves.len() > 1) {
        return Err("the filter is an envelope; name one of its curves to walk it".into());
    }
    if row.rules.is_refused {
        return Err(EXCHANGED.into());
    }
    // An exchange of base and filter is already known.
    let tables = TableOptions { as_given: true, ..tables.clone() };
    let filter = PathBuf::from(&row.rules.filter);
    Scene::of_tables(&row.rules.path, &filter, &tables).map_err(|problem| {
        // A client knows of soils, not of the scene that they are put into.
        let problem = problem.to_string();
        problem.strip_prefix("built-in scene: ").map_or(problem.clone(), str::to_owned)
    })
}

/// The settings of a first look: as `--quick`, on a lattice no wider than is needed for the class.
fn first_look(tables: &TableOptions) -> TableOptions {
    let is_own = |change: &String| OWN_LATTICE.contains(&setting_name(change));
    let lattice = ["nx", "ny"].map(|side| format!("network.{side}={ACROSS}"));
    let lattice = lattice.into_iter().filter(|_| !tables.changes.iter().any(is_own));
    let changes = lattice.chain(tables.changes.iter().cloned()).collect();
    TableOptions { quick: true, changes, ..tables.clone() }
}
