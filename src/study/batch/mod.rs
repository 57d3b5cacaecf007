//! Many samples against one or several filters: what practice says of each pair, each pair walked, and one
//! table of both.
//!
//! The walks are the cases of a campaign inside the batch's folder, all with one seed: each has a run
//! folder of its own, those that are done are kept, and what was stopped or killed continues. The table
//! follows from samples, filters and settings alone.

mod plan;

pub use plan::{BatchPlan, BatchWalks};

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::days::last_day;
use super::kept::hash_of;
use super::of_cases::{StudyOfCases, of_sheet, outcome, with_other_cover};
use crate::campaign::cases::{CASES, PreparedCase};
use crate::campaign::{CampaignCallbacks, CampaignOptions, FinishedCampaign};
use crate::outcome::leaves_out_of_all;
use crate::outcome::ledger::LedgerLine;
use crate::outcome::quantity::SizeUnit;
use crate::run::error::RunError;
use crate::run::folder::{FolderKind, shown};
use crate::store::Folder;
use crate::verdict::{SampleWalk, WalkedBatch, WalkedRow};
use crate::words::batch::walked_columns;

/// Folder of the campaign, inside the batch's.
const WALKS: &str = "pairs";

/// One row a sample and filter.
const TABLE: &str = "batch.csv";

/// Walks every pair that is not done, in a campaign inside the folder that the options name, and writes
/// `batch.csv` and, last, `batch.json`. With `overwrite` an earlier batch there is replaced; its walks that
/// are asked for again are kept.
///
/// # Errors
/// A folder that cannot be claimed is refused before any work; then as
/// [`campaign::run()`](crate::campaign::run()), and a pair that cannot be walked to its end leaves no table.
/// After a stop, the same call continues.
pub fn run(
    plan: &BatchPlan,
    options: &CampaignOptions,
    overwrite: bool,
    callbacks: &CampaignCallbacks,
) -> Result<WalkedBatch, RunError> {
    plan.study(&|cases| plan.work(cases)).run(options, overwrite, callbacks, |folder, work, walked| {
        let batch = plan.walked(folder, work, walked)?;
        folder.write(TABLE, &walked_columns(SizeUnit::Mm).csv(&batch.rows))?;
        Ok(batch)
    })
}

/// The batch that the folder holds already, where it is this very one; `None` where [`run`] without
/// `overwrite` begins there or goes on. Writes no result.
///
/// # Errors
/// A folder that holds anything else, another batch too.
pub fn found(plan: &BatchPlan, options: &CampaignOptions) -> Result<Option<WalkedBatch>, RunError> {
    let is_this = |there: &WalkedBatch, cases: &[PreparedCase]| there.work == plan.work(cases);
    plan.study(&|cases| plan.work(cases)).found(options, is_this)
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

    /// How many of its walks in this folder were kept from an earlier call with another cover, which their
    /// own pages have.
    pub fn with_other_cover(&self, folder: &Path) -> usize {
        with_other_cover(&self.campaign, &folder.join(WALKS))
    }

    fn study<'a>(&'a self, work: &'a dyn Fn(&[PreparedCase]) -> String) -> StudyOfCases<'a> {
        StudyOfCases { kind: FolderKind::Batch, walks: WALKS, campaign: &self.campaign, work }
    }

    /// Everything that the table follows from.
    fn work(&self, cases: &[PreparedCase]) -> String {
        let of_case = |case: &PreparedCase| format!("{} {}", case.planned.name, case.fingerprint);
        let all: Vec<String> = cases.iter().map(of_case).collect();
        let of_row = |(row, case): (&WalkedRow, &String)| {
            (row.rules.clone(), row.governs, row.not_walked.clone(), self.in_full.contains(case))
        };
        let rows: Vec<_> = self.rows.iter().zip(&self.cases).map(of_row).collect();
        let sheet = of_sheet(&self.cover(), self.shows_inches());
        let samples = shown(&self.samples);
        hash_of(&format!("{samples} {rows:?} {:?} {:?} {all:?}{sheet}", self.filters, self.notes))
    }

    /// The rows with what was walked of them.
    fn walked(
        &self,
        folder: &Folder,
        work: &str,
        walked: &FinishedCampaign,
    ) -> Result<WalkedBatch, RunError> {
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
