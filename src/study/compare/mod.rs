//! Compares filters on one base, bases on one filter, or scenes: each case walked with the same seed, so that
//! their replicates are pairs.
//!
//! The cases are those of a [`campaign`] inside the comparison's folder: each has a run folder
//! of its own, those that are done are kept, and what was stopped continues.

mod plan;

pub use plan::{ComparePlan, Compared};

use super::days::last_day;
use super::kept::hash_of;
use super::of_cases::{StudyOfCases, of_sheet, outcome, with_other_cover};
use std::path::{Path, PathBuf};

use crate::campaign::cases::PreparedCase;
use crate::campaign::{self, CampaignCallbacks, CampaignOptions, FinishedCampaign};
use crate::outcome::comparison::Comparison;
use crate::outcome::quantity::SizeUnit;
use crate::run::error::RunError;
use crate::run::folder::FolderKind;
use crate::store::Folder;
use crate::verdict::practice::counts_as;
use crate::words::comparison::{case_columns, pair_columns};

/// Folder of the campaign, inside the comparison's.
const WALKS: &str = "walks";

/// One row a case.
const CASES: &str = "compare.csv";

/// One row a difference.
const PAIRS: &str = "compare_pairs.csv";

/// Walks every case that is not done, in a campaign inside the folder that the options name, and writes
/// `compare.csv`, `compare_pairs.csv` and, last, `compare.json`. With `overwrite` an earlier comparison there
/// is replaced; its cases that are asked for again are kept.
///
/// # Errors
/// A case that is wrong and a folder that cannot be claimed are refused before any work; then as
/// [`campaign::run()`], and a case that cannot be walked leaves nothing to compare. After a stop, the same
/// call continues.
pub fn run(
    plan: &ComparePlan,
    options: &CampaignOptions,
    overwrite: bool,
    callbacks: &CampaignCallbacks,
) -> Result<Comparison, RunError> {
    campaign::check(&plan.campaign, &CampaignOptions { out: options.out.join(WALKS), ..options.clone() })?;
    plan.study(&|cases| plan.work(cases)).run(options, overwrite, callbacks, |folder, _, walked| {
        let comparison = plan.compared(folder, walked)?;
        folder.write(CASES, &case_columns(SizeUnit::Mm).csv(&comparison.cases))?;
        folder.write(PAIRS, &pair_columns().csv(&comparison.pairs))?;
        Ok(comparison)
    })
}

/// The comparison that the folder holds already, where it is this very one; `None` where [`run`] without
/// `overwrite` begins there or goes on. Writes no result.
///
/// # Errors
/// A case that is wrong, and a folder that holds anything else, another comparison too.
pub fn found(plan: &ComparePlan, options: &CampaignOptions) -> Result<Option<Comparison>, RunError> {
    campaign::check(&plan.campaign, &CampaignOptions { out: options.out.join(WALKS), ..options.clone() })?;
    let walks = options.out.join(WALKS);
    let is_this = |there: &Comparison, cases: &[PreparedCase]| {
        let folders = cases.iter().filter_map(|case| Some(walks.join(case.line(&walks)?.folder)));
        let folders: Vec<PathBuf> = folders.collect();
        let day = last_day(folders.iter().map(PathBuf::as_path));
        let cover = plan.cover.clone().dated(day);
        there.of == plan.of
            && (&there.cover, there.inches) == (&cover, plan.inches)
            && there.cases.iter().map(|case| case.name.as_str()).eq(plan.names())
    };
    plan.study(&|cases| plan.work(cases)).found(options, is_this)
}

impl ComparePlan {
    /// How many of its walks in this folder were kept from an earlier call with another cover, which their
    /// own pages have.
    pub fn with_other_cover(&self, folder: &Path) -> usize {
        with_other_cover(&self.campaign, &folder.join(WALKS))
    }

    fn study<'a>(&'a self, work: &'a dyn Fn(&[PreparedCase]) -> String) -> StudyOfCases<'a> {
        StudyOfCases { kind: FolderKind::Comparison, walks: WALKS, campaign: &self.campaign, work }
    }

    /// Everything that the results follow from.
    fn work(&self, cases: &[PreparedCase]) -> String {
        let of_case = |case: &PreparedCase| format!("{} {}", case.planned.name, case.fingerprint);
        let all: Vec<String> = cases.iter().map(of_case).collect();
        // Not the path of what is common: the cases know its bytes.
        hash_of(&format!("{} {all:?}{}", self.of, of_sheet(&self.cover, self.inches)))
    }

    /// The cases that were walked, side by side.
    fn compared(&self, folder: &Folder, walked: &FinishedCampaign) -> Result<Comparison, RunError> {
        let mut outcomes = Vec::new();
        for line in walked.lines.iter().flatten() {
            let case = format!("{WALKS}/{}", line.folder);
            let outcome = outcome(&folder.path().join(&case))?;
            outcomes.push((line.case.clone(), case, outcome));
        }
        let mut comparison = Comparison::new(self.of, &self.common, self.seed, &outcomes);
        let folders: Vec<PathBuf> = outcomes.iter().map(|(_, case, _)| folder.path().join(case)).collect();
        let day = last_day(folders.iter().map(PathBuf::as_path));
        (comparison.cover, comparison.inches) = (self.cover.clone().dated(day), self.inches);
        for (case, (.., outcome)) in comparison.cases.iter_mut().zip(&outcomes) {
            case.by_practice = counts_as(&outcome.rules);
        }
        Ok(comparison)
    }
}
