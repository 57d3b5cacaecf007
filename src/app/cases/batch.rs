//! Many samples against one or several filters: the answer of practice on each pair, each pair walked, and
//! one table of both.
//!
//! The walks are the cases of a campaign inside the batch's folder, all with one seed: each has a run folder
//! of its own, finished ones are kept, and stopped or killed ones continue. The table follows from samples,
//! filters and settings alone.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::days::last_day;
use super::kept::{self, hash_of};
use super::pairs::BatchPlan;
use super::plan::PlannedCase;
use super::prepared::{CASES, PreparedCase};
use super::run::{CaseOptions, FinishedCases, ReadyCases, Walk, look, run_around};
use super::walk::CaseCallbacks;
use crate::outcome::leaves_out_of_all;
use crate::outcome::ledger::LedgerLine;
use crate::outcome::record::Outcome;
use crate::run::error::{Exit, RunError};
use crate::run::folder::{FolderKind, claim, shown};
use crate::run::unfinished::Unfinished;
use crate::scene::Scene;
use crate::verdict::{SampleWalk, WalkedBatch, WalkedRow};
use crate::words::batch::walked_columns;
use voidwalk_core::store::Folder;
use voidwalk_core::store::format::from_json;
use voidwalk_practice::quantity::SizeUnit;

/// Folder of the campaign, inside the batch's.
const WALKS: &str = "pairs";

/// One row a sample and filter.
const TABLE: &str = "batch.csv";

/// Kind of the folder of a batch.
const KIND: FolderKind = FolderKind::Batch;

/// Walks every pair that is not done, in a campaign inside the folder that the options name, and writes
/// `batch.csv` and, last, `batch.json`. With `overwrite` an earlier batch there is replaced; its walks that
/// are asked for again are kept.
///
/// # Errors
/// A folder that cannot be claimed is refused before any work; then as [`super::run()`], and a pair that
/// cannot be walked to its end leaves no table. After a stop, the same call continues.
pub fn run(
    plan: &BatchPlan,
    options: &CaseOptions,
    overwrite: bool,
    callbacks: &CaseCallbacks,
) -> Result<WalkedBatch, RunError> {
    let stopped = |error: RunError| match error.exit() {
        Exit::Stopped => RunError::Stopped(format!(
            "progress saved; continue with the same command on {}",
            shown(&options.out)
        )),
        _ => error,
    };
    let folder = claim(&options.out, KIND, overwrite)?;
    // Earlier files stay until every case is known to have its inputs.
    let study = |cases: ReadyCases, walk: Walk| {
        let work = plan.work(cases?)?;
        kept::study((&folder, KIND, overwrite), work.clone(), &callbacks.run, |_, _: Option<()>| {
            let walked = walk()?;
            walked.problem().map_or(Ok(()), Err)?;
            let batch = plan.walked(&folder, &work, &walked)?;
            folder.write(TABLE, &walked_columns(SizeUnit::Mm).csv(&batch.rows))?;
            Ok(batch)
        })
    };
    let of_walks = CaseOptions { out: folder.path().join(WALKS), ..options.clone() };
    run_around(&plan.campaign, &of_walks, callbacks, study).map_err(stopped)
}

/// The batch that the folder holds already, if it is this very one; `None` if [`run`] without `overwrite`
/// begins or continues there. Writes no result.
///
/// # Errors
/// A folder that holds anything else, another batch too.
pub fn found(plan: &BatchPlan, options: &CaseOptions) -> Result<Option<WalkedBatch>, RunError> {
    if options.out.symlink_metadata().is_err() {
        return Ok(None);
    }
    let of_walks = CaseOptions { out: options.out.join(WALKS), ..options.clone() };
    let folder = claim(&options.out, KIND, true)?;
    let other = || {
        let problem = format!("holds another {}; name another folder, or add --overwrite", KIND.name());
        Err(RunError::Refused(format!("{}: {problem}", shown(&options.out))))
    };
    if KIND.is_finished(folder.path())? {
        let bytes = folder.read(KIND.record())?;
        let there = bytes.and_then(|bytes| from_json::<WalkedBatch>(&bytes).ok());
        let is_walked = |cases: Option<&[PreparedCase]>| {
            let cases = cases.filter(|all| all.iter().all(|case| case.line(&of_walks.out).is_some()));
            there.filter(|there| cases.is_some_and(|cases| plan.has_work(cases, &there.work)))
        };
        let there = look(&plan.campaign, &of_walks, is_walked)?;
        return there.map_or_else(other, |there| Ok(Some(there)));
    }
    let Some(begun) = Unfinished::read(&folder)? else { return Ok(None) };
    // A packing that was removed is made again, and other work is refused then.
    let is_this = |cases: Option<&[PreparedCase]>| cases.is_none_or(|all| plan.has_work(all, &begun.work));
    if look(&plan.campaign, &of_walks, is_this)? { Ok(None) } else { other() }
}

impl BatchPlan {
    /// The rows, with the walk of each pair that is done in this folder of the batch, to whatever end.
    pub fn so_far(&self, folder: &Path) -> Vec<WalkedRow> {
        let walked = |case: &String| {
            let planned = self.campaign.cases.iter().find(|planned| planned.name == *case)?;
            let place = format!("{WALKS}/{CASES}/{}", planned.folder_name());
            let at = folder.join(&place);
            let is_done = at.is_dir() && FolderKind::Run.is_finished(&at).unwrap_or(false);
            let outcome = is_done.then(|| outcome(&at).ok()).flatten()?;
            Some(SampleWalk::of(&outcome, place, self.in_full.contains(case)))
        };
        let rows = self.rows.iter().zip(&self.cases);
        rows.map(|(row, case)| WalkedRow { walk: walked(case), ..row.clone() }).collect()
    }

    /// The row of a case that was just done in this folder, and its place among all.
    pub fn walked_row(&self, folder: &Path, line: &LedgerLine) -> Option<(usize, WalkedRow)> {
        let at = self.cases.iter().position(|case| *case == line.case)?;
        let place = format!("{WALKS}/{}", line.folder);
        let outcome = outcome(&folder.join(&place)).ok()?;
        let walk = SampleWalk::of(&outcome, place, self.in_full.contains(&line.case));
        Some((at, WalkedRow { walk: Some(walk), ..self.rows[at].clone() }))
    }

    /// Number of its walks in this folder that were kept from an earlier call with another cover; their own
    /// pages have that cover.
    pub fn with_other_cover(&self, folder: &Path) -> usize {
        let is_other = |planned: &&PlannedCase| {
            let scene = folder.join(WALKS).join(CASES).join(planned.folder_name()).join("scene.toml");
            Scene::read(&scene, &[]).is_ok_and(|there| there.about.cover() != planned.scene.about.cover())
        };
        self.campaign.cases.iter().filter(is_other).count()
    }

    /// Everything that the table follows from, as the record writes it; fields that the record leaves out are
    /// left out here, too.
    ///
    /// # Errors
    /// A name that is not UTF-8.
    fn work(&self, cases: &[PreparedCase]) -> Result<String, RunError> {
        let cases: Vec<_> = cases.iter().map(|case| (&case.planned.name, &case.fingerprint)).collect();
        let in_full: Vec<bool> = self.cases.iter().map(|case| self.in_full.contains(case)).collect();
        let (samples, sheet) = (shown(&self.samples), (self.cover(), self.shows_inches()));
        let work = (samples, &self.rows, in_full, &self.filters, &self.notes, cases, sheet);
        Ok(hash_of(&serde_json::to_string(&work).map_err(RunError::failed)?))
    }

    /// Compares this work with the work of the batch with these cases.
    fn has_work(&self, cases: &[PreparedCase], work: &str) -> bool {
        self.work(cases).is_ok_and(|all| all == work)
    }

    /// The rows with their walks.
    fn walked(&self, folder: &Folder, work: &str, walked: &FinishedCases) -> Result<WalkedBatch, RunError> {
        let mut modelled = Vec::new();
        let mut walks = HashMap::new();
        for line in walked.lines.iter().flatten() {
            let place = format!("{WALKS}/{}", line.folder);
            let outcome = outcome(&folder.path().join(&place))?;
            let in_full = self.in_full.contains(&line.case);
            walks.insert(line.case.as_str(), SampleWalk::of(&outcome, place, in_full));
            modelled.push(outcome.modelled());
        }
        let of_row = |(row, case): (&WalkedRow, &String)| WalkedRow {
            walk: walks.get(case.as_str()).cloned(),
            ..row.clone()
        };
        let rows = self.rows.iter().zip(&self.cases).map(of_row).collect();
        let batch = WalkedBatch::new(shown(&self.samples), self.filters.clone(), rows);
        let base = self.base.clone();
        let (work, notes) = (work.to_owned(), self.notes.clone());
        let seed = self.campaign.cases.first().map_or(0, |case| case.scene.walk.seed);
        let folders =
            batch.rows.iter().filter_map(|row| Some(folder.path().join(&row.walk.as_ref()?.folder)));
        let folders: Vec<PathBuf> = folders.collect();
        let cover = self.cover().dated(last_day(folders.iter().map(PathBuf::as_path)));
        let (inches, model_leaves_out) = (self.shows_inches(), leaves_out_of_all(modelled));
        Ok(WalkedBatch { base, work, seed, notes, cover, inches, model_leaves_out, ..batch })
    }
}

/// The outcome of a case that is done.
fn outcome(case: &Path) -> Result<Outcome, RunError> {
    kept::record(case, FolderKind::Run)
}
