//! Many samples against one or several filters: what practice says of each pair, each pair walked, and one
//! table of both.
//!
//! The walks are the cases of a campaign inside the batch's folder, all with one seed: each has a run
//! folder of its own, those that are done are kept, and what was stopped or killed continues. The table
//! follows from samples, filters and settings alone.

mod plan;

pub use plan::{BatchPlan, BatchWalks};

use std::collections::HashMap;

use super::of_cases::{StudyOfCases, outcome};
use crate::campaign::cases::PreparedCase;
use crate::campaign::{CampaignCallbacks, CampaignOptions, FinishedCampaign};
use crate::outcome::leaves_out_of_all;
use crate::run::error::RunError;
use crate::run::folder::{FolderKind, shown};
use crate::store::Folder;
use crate::verdict::{SampleWalk, WalkedBatch, WalkedRow};

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
        folder.write(TABLE, &WalkedRow::columns().csv(&batch.rows))?;
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
        let text = format!("{} {rows:?} {:?} {:?} {all:?}", shown(&self.samples), self.filters, self.notes);
        format!("{:032x}", xxhash_rust::xxh3::xxh3_128(text.as_bytes()))
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
        let (work, notes) = (work.to_owned(), self.notes.clone());
        let seed = self.campaign.cases.first().map_or(0, |case| case.scene.walk.seed);
        Ok(WalkedBatch { work, seed, notes, model_leaves_out: leaves_out_of_all(modelled), ..batch })
    }
}
