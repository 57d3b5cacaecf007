//! Many samples against one or several filters: the decision of practice on each pair, a walk of each pair,
//! and one table of both. The walks are the cases of a campaign inside the batch's folder, all with one seed:
//! each has a run folder of its own, finished ones are kept, and stopped or killed ones continue. The table
//! follows from samples, filters and settings alone.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::inputs::{InputSoils, as_folders, names, refuse_twice};
use super::kept::{self, hash_of, last_day};
use super::plan::{CasePlan, PlannedCase};
use super::prepared::{CASES, PreparedCase};
use super::run::{CaseOptions, FinishedCases, ReadyCampaign, unsound, without_packing};
use super::walk::CaseCallbacks;
use crate::outcome::leaves_out_of_all;
use crate::outcome::ledger::LedgerLine;
use crate::outcome::record::Outcome;
use crate::run::folder::{FolderKind, Unfinished, claim, refused, shown};
use crate::run::{Exit, RunError};
use crate::scene::{Scene, TableOptions};
use crate::verdict::{SampleWalk, WalkedBatch, WalkedRow};
use crate::words::batch::{EXCHANGED, MAY_GOVERN, walked_columns};
use voidwalk_core::gradation::GradationError;
use voidwalk_core::schema::setting_name;
use voidwalk_core::store::Folder;
use voidwalk_core::store::format::from_json;
use voidwalk_practice::batch::{NAMED, governing};
use voidwalk_practice::quantity::SizeUnit;
use voidwalk_practice::{BatchFilter, BatchRow, BatchTable, PairOptions, SheetCover};
use voidwalk_sheets::{curves_in_file, samples_in};

const WALKS: &str = "pairs";

const TABLE: &str = "batch.csv";

const KIND: FolderKind = FolderKind::Batch;

/// Voids across the lattice of a first look, as in a search by `voidwalk boundary`.
const ACROSS: u64 = 20;

/// Settings by which a user chooses the size of the lattice.
const OWN_LATTICE: [&str; 4] = ["network.nx", "network.ny", "network.file", "network.packing"];

/// Pairs to walk, and the depth of their walks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum BatchWalks {
    /// A first look at every sample, and full walks of the three that govern each filter.
    #[default]
    GoverningInFull,
    /// A first look at every sample.
    FirstLook,
    /// Full walks of only the three that govern each filter.
    GoverningAlone,
    /// The one base against every filter, by the settings.
    OneBase,
}

#[derive(Clone, Debug)]
pub(crate) struct BatchPlan {
    samples: PathBuf,
    filters: Vec<BatchFilter>,
    /// Curve of the one base as sampled; empty if each soil is a sample.
    base: Vec<[f64; 2]>,
    rows: Vec<WalkedRow>,
    cases: Vec<String>,
    in_full: HashSet<String>,
    notes: Vec<String>,
    campaign: CasePlan,
}

impl BatchPlan {
    /// Pairs the samples of a file or folder with filters. `tables` holds the further options of each scene.
    /// A pair that cannot be walked stays in the table, with the reason. Errors: a file that cannot be read;
    /// a filter that is named twice; several soils in place of one base; cases that do not fit into memory;
    /// no pair that can be walked.
    pub(crate) fn new(
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

    /// Replaces the paths of the samples and of each filter by these names, and rewords notes, which may hold
    /// paths, by `reworded`.
    #[must_use]
    pub(crate) fn named(
        mut self,
        samples: &str,
        filters: &[String],
        reworded: impl Fn(&str) -> String,
    ) -> Self {
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

    /// Scene of a walk; cover, units and source of the constrictions are the same in all.
    pub(crate) fn scene(&self) -> Option<&Scene> {
        self.campaign.cases.first().map(|case| &case.scene)
    }

    pub(crate) fn shows_inches(&self) -> bool {
        self.scene().is_some_and(|scene| scene.about.shows_inches())
    }

    fn cover(&self) -> SheetCover {
        self.scene().map(|scene| scene.about.cover()).unwrap_or_default()
    }
}

/// Rows of the samples of a file or folder against filters; without `each`, of one base. Every soil in a
/// filter's file is a curve of its envelope. Errors: a file that cannot be read; a filter that is named
/// twice; several soils in place of one base.
pub(crate) fn pairs_of(
    samples: &Path,
    filters: &[PathBuf],
    options: PairOptions,
    each: bool,
) -> Result<BatchTable, RunError> {
    refuse_twice(filters)?;
    let bases = InputSoils::read(&[samples.to_owned()], samples_in)?;
    let soils = bases.soils.len();
    if soils > 1 && !each {
        let (file, instead) =
            (samples.display(), "name one of them as FILE#NAME, or add --each for all of them");
        return Err(RunError::Refused(format!("{file} holds {soils} soils; {instead}")));
    }
    let curves = |filter: &PathBuf| Ok((filter.display().to_string(), curves_in_file(filter, None)?));
    let curves: Result<Vec<_>, GradationError> = filters.iter().map(curves).collect();
    let curves = curves.map_err(RunError::refused)?;
    Ok(BatchTable::new(&bases.soils, curves, bases.notes(filters)?, options))
}

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

/// Name for each row, made of sample and filter; all different.
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

fn scene(row: &WalkedRow, filters: &[BatchFilter], tables: &TableOptions) -> Result<Scene, String> {
    let filter = filters.iter().find(|filter| filter.name == row.rules.filter);
    if filter.is_some_and(|filter| filter.curves.len() > 1) {
        return Err("the filter is an envelope; name one of its curves to walk it".into());
    }
    if row.rules.is_refused {
        return Err(EXCHANGED.into());
    }
    // Exchanged base and filter have already been noticed.
    let tables = TableOptions { as_given: true, ..tables.clone() };
    let filter = PathBuf::from(&row.rules.filter);
    Scene::of_tables(&row.rules.path, &filter, &tables).map_err(|problem| {
        // A client knows soils, not the scene made of them.
        let problem = problem.to_string();
        problem.strip_prefix("built-in scene: ").map_or(problem.clone(), str::to_owned)
    })
}

/// Settings of a first look: those of `--quick`, on a lattice no wider than the class needs.
fn first_look(tables: &TableOptions) -> TableOptions {
    let is_own = |change: &String| OWN_LATTICE.contains(&setting_name(change));
    let lattice = ["nx", "ny"].map(|side| format!("network.{side}={ACROSS}"));
    let lattice = lattice.into_iter().filter(|_| !tables.changes.iter().any(is_own));
    let changes = lattice.chain(tables.changes.iter().cloned()).collect();
    TableOptions { quick: true, changes, ..tables.clone() }
}

/// Walks every unfinished pair, in a campaign inside the folder that the options name, and writes `batch.csv`
/// and, last, `batch.json`. With `overwrite` an earlier batch there is replaced, except those of its walks
/// that are needed again. Errors: a folder that cannot be claimed is refused before any work; then see
/// [`super::run()`]. If a pair cannot be walked to its end, no table is written. After a stop, the same call
/// continues.
pub(crate) fn run(
    plan: &BatchPlan,
    options: &CaseOptions,
    overwrite: bool,
    callbacks: &CaseCallbacks,
) -> Result<WalkedBatch, RunError> {
    let folder = claim(&options.out, KIND, overwrite)?;
    let of_walks = CaseOptions { out: folder.path().join(WALKS), ..options.clone() };
    let walked = || {
        let campaign = ReadyCampaign::new(&plan.campaign, &of_walks, callbacks)?;
        // Earlier files stay until every case is known to have its inputs.
        let work = plan.work(campaign.cases()?)?;
        kept::study((&folder, KIND, overwrite), work.clone(), &callbacks.run, |_, _: Option<()>| {
            let walked = campaign.walk()?;
            walked.problem().map_or(Ok(()), Err)?;
            let batch = plan.walked(&folder, &work, &walked)?;
            folder.write(TABLE, &walked_columns(SizeUnit::Mm).csv(&batch.rows))?;
            Ok(batch)
        })
    };
    walked().map_err(|error: RunError| match error.exit() {
        Exit::Stopped => RunError::Stopped(format!(
            "progress saved; continue with the same command on {}",
            shown(&options.out)
        )),
        _ => error,
    })
}

/// Batch that the folder already holds, if it is this very one; `None` if [`run`] without `overwrite` begins
/// or continues there. Writes no result. Errors: the folder holds anything else, including another batch.
pub(crate) fn found(plan: &BatchPlan, options: &CaseOptions) -> Result<Option<WalkedBatch>, RunError> {
    if options.out.symlink_metadata().is_err() {
        return Ok(None);
    }
    let of_walks = CaseOptions { out: options.out.join(WALKS), ..options.clone() };
    let folder = claim(&options.out, KIND, true)?;
    let other = || {
        let problem = format!("holds another {}; name another folder, or add --overwrite", KIND.name());
        Err(refused(&options.out, problem))
    };
    if KIND.is_finished(folder.path())? {
        let bytes = folder.read(KIND.record())?;
        let there = bytes.and_then(|bytes| from_json::<WalkedBatch>(&bytes).ok());
        let is_walked =
            |cases: &Vec<PreparedCase>| cases.iter().all(|case| case.line(&of_walks.out).is_some());
        let cases = without_packing(&plan.campaign, &of_walks)?.filter(is_walked);
        let there = there.zip(cases).filter(|(there, cases)| plan.has_work(cases, &there.work));
        return there.map_or_else(other, |(there, _)| Ok(Some(there)));
    }
    let Some(begun) = Unfinished::read(&folder)? else { return Ok(None) };
    // A packing that was removed is made again; other work is refused after that.
    let cases = without_packing(&plan.campaign, &of_walks)?;
    if cases.is_none_or(|all| plan.has_work(&all, &begun.work)) { Ok(None) } else { other() }
}

impl BatchPlan {
    /// Rows, with the walk of each pair that has ended in this folder of the batch, successfully or not.
    pub(crate) fn so_far(&self, folder: &Path) -> Vec<WalkedRow> {
        let walked = |case: &String| {
            let place = format!("{WALKS}/{CASES}/{}", self.campaign.case(case)?.folder_name());
            let at = folder.join(&place);
            let is_done = at.is_dir() && FolderKind::Run.is_finished(&at).unwrap_or(false);
            is_done.then(|| self.walk(folder, place, case).ok()).flatten().map(|(walk, _)| walk)
        };
        let rows = self.rows.iter().zip(&self.cases);
        rows.map(|(row, case)| WalkedRow { walk: walked(case), ..row.clone() }).collect()
    }

    /// Row of a case that was just finished in this folder, and its position among all.
    pub(crate) fn walked_row(&self, folder: &Path, line: &LedgerLine) -> Option<(usize, WalkedRow)> {
        let at = self.cases.iter().position(|case| *case == line.case)?;
        let (walk, _) = self.walk(folder, format!("{WALKS}/{}", line.folder), &line.case).ok()?;
        Some((at, WalkedRow { walk: Some(walk), ..self.rows[at].clone() }))
    }

    fn walk(&self, folder: &Path, place: String, case: &str) -> Result<(SampleWalk, Outcome), RunError> {
        let outcome: Outcome = kept::record(&folder.join(&place), FolderKind::Run)?;
        Ok((SampleWalk::of(&outcome, place, self.in_full.contains(case)), outcome))
    }

    /// Number of its walks in this folder that were kept from an earlier call with another cover; their own
    /// pages show that cover.
    pub(crate) fn with_other_cover(&self, folder: &Path) -> usize {
        let is_other = |planned: &&PlannedCase| {
            let scene = folder.join(WALKS).join(CASES).join(planned.folder_name()).join("scene.toml");
            Scene::read(&scene, &[]).is_ok_and(|there| there.about.cover() != planned.scene.about.cover())
        };
        self.campaign.cases.iter().filter(is_other).count()
    }

    /// Everything that determines the table, in the form of the record; fields that the record leaves out are
    /// left out here, too. Errors: a name that is not UTF-8.
    fn work(&self, cases: &[PreparedCase]) -> Result<String, RunError> {
        let cases: Vec<_> = cases.iter().map(|case| (&case.planned.name, &case.fingerprint)).collect();
        let in_full: Vec<bool> = self.cases.iter().map(|case| self.in_full.contains(case)).collect();
        let (samples, sheet) = (shown(&self.samples), (self.cover(), self.shows_inches()));
        let work = (samples, &self.rows, in_full, &self.filters, &self.notes, cases, sheet);
        Ok(hash_of(&serde_json::to_string(&work).map_err(RunError::failed)?))
    }

    fn has_work(&self, cases: &[PreparedCase], work: &str) -> bool {
        self.work(cases).is_ok_and(|all| all == work)
    }

    fn walked(&self, folder: &Folder, work: &str, walked: &FinishedCases) -> Result<WalkedBatch, RunError> {
        let mut modelled = Vec::new();
        let mut walks = HashMap::new();
        for line in walked.lines.iter().flatten() {
            let place = format!("{WALKS}/{}", line.folder);
            let (walk, outcome) = self.walk(folder.path(), place, &line.case)?;
            walks.insert(line.case.as_str(), walk);
            modelled.push(outcome.modelled());
        }
        let walk = |case: &String| walks.get(case.as_str()).cloned();
        let rows = self.rows.iter().zip(&self.cases);
        let rows = rows.map(|(row, case)| WalkedRow { walk: walk(case), ..row.clone() }).collect();
        let batch = WalkedBatch::new(shown(&self.samples), self.filters.clone(), rows);
        let base = self.base.clone();
        let (work, notes) = (work.to_owned(), self.notes.clone());
        let seed = self.scene().map_or(0, |scene| scene.walk.seed);
        let folders =
            batch.rows.iter().filter_map(|row| Some(folder.path().join(&row.walk.as_ref()?.folder)));
        let cover = self.cover().dated(last_day(folders));
        let (inches, model_leaves_out) = (self.shows_inches(), leaves_out_of_all(modelled));
        Ok(WalkedBatch { base, work, seed, notes, cover, inches, model_leaves_out, ..batch })
    }
}
