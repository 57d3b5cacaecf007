//! Compares filters on one base, bases on one filter, or scenes: each case walked with the same seed, so that
//! their replicates are pairs.
//!
//! The cases are those of a [`campaign`] inside the comparison's folder: each has a run folder
//! of its own, those that are done are kept, and what was stopped continues.

mod plan;

use std::path::Path;

pub use plan::{ComparePlan, Compared};

use super::kept;
use crate::campaign::cases::PreparedCase;
use crate::campaign::{self, CampaignCallbacks, CampaignOptions, FinishedCampaign, ReadyCases, Walk};
use crate::outcome::comparison::{ComparedCase, ComparedPair, Comparison};
use crate::outcome::record::Outcome;
use crate::outcome::rules::Authority;
use crate::run::error::{Exit, RunError};
use crate::run::folder::{FolderKind, claim, shown};
use crate::run::unfinished::Unfinished;
use crate::store::{Folder, read_whole};
use crate::verdict::by_authority::{ON_ALL_RULES, of_pair};

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
    let kind = FolderKind::Comparison;
    let of_campaign = CampaignOptions { out: options.out.join(WALKS), ..options.clone() };
    let stopped = |error: RunError| match error.exit() {
        Exit::Stopped => RunError::Stopped(format!(
            "progress saved; continue with the same command on {}",
            shown(&options.out)
        )),
        _ => error,
    };
    campaign::check(&plan.campaign, &of_campaign)?;
    let folder = claim(&options.out, kind, overwrite)?;
    // What is there stays until every case is known to have what it needs.
    let study = |cases: ReadyCases, walk: Walk| {
        let place = (&folder, kind, overwrite);
        kept::study(place, plan.work(cases?), &callbacks.run, |_, _: Option<()>| {
            let walked = walk()?;
            walked.problem().map_or(Ok(()), Err)?;
            let comparison = plan.compared(&folder, &walked)?;
            folder.write(CASES, &ComparedCase::columns().csv(&comparison.cases))?;
            folder.write(PAIRS, &ComparedPair::columns().csv(&comparison.pairs))?;
            Ok(comparison)
        })
    };
    let of_campaign = CampaignOptions { out: folder.path().join(WALKS), ..of_campaign };
    campaign::run_around(&plan.campaign, &of_campaign, callbacks, study).map_err(stopped)
}

/// The comparison that the folder holds already, where it is this very one; `None` where [`run`] without
/// `overwrite` begins there or goes on. Writes no result.
///
/// # Errors
/// A case that is wrong, and a folder that holds anything else, another comparison too.
pub fn found(plan: &ComparePlan, options: &CampaignOptions) -> Result<Option<Comparison>, RunError> {
    let kind = FolderKind::Comparison;
    let of_campaign = CampaignOptions { out: options.out.join(WALKS), ..options.clone() };
    campaign::check(&plan.campaign, &of_campaign)?;
    if options.out.symlink_metadata().is_err() {
        return Ok(None);
    }
    let folder = claim(&options.out, kind, true)?;
    let other = || {
        let problem = "holds another comparison; name another folder, or remove that one";
        Err(RunError::Refused(format!("{}: {problem}", shown(&options.out))))
    };
    if kind.is_finished(folder.path())? {
        let is_walked = |cases: Option<&[PreparedCase]>| {
            cases.is_some_and(|all| all.iter().all(|case| case.line(&of_campaign.out).is_some()))
        };
        let is_walked = campaign::look(&plan.campaign, &of_campaign, is_walked)?;
        let bytes = folder.read(kind.record())?;
        let there = bytes.and_then(|bytes| serde_json::from_slice::<Comparison>(&bytes).ok());
        let there = there.filter(|there| there.of == plan.of && is_walked);
        let there = there.filter(|there| there.cases.iter().map(|case| case.name.as_str()).eq(plan.names()));
        return there.map_or_else(other, |there| Ok(Some(there)));
    }
    match Unfinished::read(&folder)? {
        Some(begun) => {
            // Where a packing was taken away it is made again, and other work is refused then.
            let is_this =
                |cases: Option<&[PreparedCase]>| cases.is_none_or(|all| plan.work(all) == begun.work);
            let is_this = campaign::look(&plan.campaign, &of_campaign, is_this)?;
            if is_this { Ok(None) } else { other() }
        }
        None => Ok(None),
    }
}

impl ComparePlan {
    /// Everything that the results follow from.
    fn work(&self, cases: &[PreparedCase]) -> String {
        let of_case = |case: &PreparedCase| format!("{} {}", case.planned.name, case.fingerprint);
        let all: Vec<String> = cases.iter().map(of_case).collect();
        // Not the path of what is common: the cases know its bytes.
        let text = format!("{} {all:?}", self.of);
        format!("{:032x}", xxhash_rust::xxh3::xxh3_128(text.as_bytes()))
    }

    /// Whose rules the sheet of a case lists.
    fn authority_of(&self, case: &str) -> Authority {
        let planned = self.campaign.cases.iter().find(|planned| planned.name == case);
        planned.and_then(|planned| planned.scene.about.authority).unwrap_or_default()
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
        for (case, (.., outcome)) in comparison.cases.iter_mut().zip(&outcomes) {
            case.headline = outcome.headline();
            case.practice = outcome.practice_in_words();
            case.walk = outcome.walk_in_words();
            case.next = outcome.next_in_words();
            case.beside = outcome.beside_the_verdict();
            case.found = outcome.ordered().into_iter().map(|finding| finding.sentence).collect();
            let d15f = Some(outcome.inputs.filter.d15_mm);
            let of_authority = of_pair(&outcome.rules, self.authority_of(&case.name), d15f);
            case.by_authority = of_authority.map_or(String::new(), |said| format!("{said} {ON_ALL_RULES}"));
        }
        Ok(comparison)
    }
}

/// The outcome of a case that is done.
fn outcome(case: &Path) -> Result<Outcome, RunError> {
    let path = case.join(FolderKind::Run.record());
    let failed = |error: &dyn std::fmt::Display| RunError::failed(format!("{}: {error}", shown(&path)));
    let bytes = read_whole(&path).map_err(|error| failed(&error))?;
    serde_json::from_slice(&bytes).map_err(|error| failed(&error))
}
