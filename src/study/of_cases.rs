//! A study whose cases are those of a campaign inside its folder: each has a run folder of its own, those
//! that are done are kept, and what was stopped continues.

use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::kept;
use crate::campaign::cases::{CASES, PreparedCase};
use crate::campaign::plan::PlannedCase;
use crate::campaign::{self, CampaignCallbacks, CampaignOptions, CampaignPlan};
use crate::campaign::{FinishedCampaign, ReadyCases, Walk};
use crate::outcome::record::{Outcome, SheetCover};
use crate::run::error::{Exit, RunError};
use crate::run::folder::{FolderKind, claim, shown};
use crate::run::unfinished::Unfinished;
use crate::scene::Scene;
use crate::store::Folder;
use crate::store::format::from_json;

/// What a sheet says of itself, as a part of what its study follows from; nothing where nothing is said.
pub(super) fn of_sheet(cover: &SheetCover, inches: bool) -> String {
    if cover.is_unset() && !inches { String::new() } else { format!(" {cover:?} {inches}") }
}

/// How many cases of a campaign in this folder were walked by an earlier call with another cover, which their
/// own pages keep.
pub(super) fn with_other_cover(campaign: &CampaignPlan, walks: &Path) -> usize {
    let is_other = |planned: &&PlannedCase| {
        let scene = walks.join(CASES).join(planned.folder_name()).join("scene.toml");
        Scene::read(&scene, &[]).is_ok_and(|there| there.about.cover() != planned.scene.about.cover())
    };
    campaign.cases.iter().filter(is_other).count()
}

/// A study of cases.
pub(super) struct StudyOfCases<'a> {
    /// What its folder is.
    pub kind: FolderKind,
    /// Folder of the campaign, inside its own.
    pub walks: &'static str,
    /// The cases.
    pub campaign: &'a CampaignPlan,
    /// Everything that its results follow from, as the cases are.
    pub work: &'a dyn Fn(&[PreparedCase]) -> String,
}

impl StudyOfCases<'_> {
    fn of_campaign(&self, options: &CampaignOptions) -> CampaignOptions {
        CampaignOptions { out: options.out.join(self.walks), ..options.clone() }
    }

    /// Walks every case that is not done, and makes the record of them all, which is written last. With
    /// `overwrite` an earlier study there is replaced; its cases that are asked for again are kept.
    ///
    /// # Errors
    /// A folder that cannot be claimed is refused before any work; then as [`campaign::run()`], and a case
    /// that cannot be walked leaves no record. After a stop, the same call continues.
    pub fn run<R: Serialize + DeserializeOwned>(
        &self,
        options: &CampaignOptions,
        overwrite: bool,
        callbacks: &CampaignCallbacks,
        made: impl FnOnce(&Folder, &str, &FinishedCampaign) -> Result<R, RunError>,
    ) -> Result<R, RunError> {
        let of_campaign = self.of_campaign(options);
        let stopped = |error: RunError| match error.exit() {
            Exit::Stopped => RunError::Stopped(format!(
                "progress saved; continue with the same command on {}",
                shown(&options.out)
            )),
            _ => error,
        };
        let folder = claim(&options.out, self.kind, overwrite)?;
        // What is there stays until every case is known to have what it needs.
        let study = |cases: ReadyCases, walk: Walk| {
            let place = (&folder, self.kind, overwrite);
            let work = (self.work)(cases?);
            kept::study(place, work.clone(), &callbacks.run, |_, _: Option<()>| {
                let walked = walk()?;
                walked.problem().map_or(Ok(()), Err)?;
                made(&folder, &work, &walked)
            })
        };
        let of_campaign = CampaignOptions { out: folder.path().join(self.walks), ..of_campaign };
        campaign::run_around(self.campaign, &of_campaign, callbacks, study).map_err(stopped)
    }

    /// The record that the folder holds already, where it is of this very study; `None` where
    /// [`run`](Self::run) without `overwrite` begins there or goes on. Writes no result.
    ///
    /// # Errors
    /// A folder that holds anything else, another study of this kind too.
    pub fn found<R: DeserializeOwned>(
        &self,
        options: &CampaignOptions,
        is_this: impl FnOnce(&R, &[PreparedCase]) -> bool,
    ) -> Result<Option<R>, RunError> {
        let (kind, of_campaign) = (self.kind, self.of_campaign(options));
        if options.out.symlink_metadata().is_err() {
            return Ok(None);
        }
        let folder = claim(&options.out, kind, true)?;
        let other = || {
            let name = kind.name();
            let problem = format!("holds another {name}; name another folder, or add --overwrite");
            Err(RunError::Refused(format!("{}: {problem}", shown(&options.out))))
        };
        if kind.is_finished(folder.path())? {
            let bytes = folder.read(kind.record())?;
            let there = bytes.and_then(|bytes| from_json::<R>(&bytes).ok());
            let is_walked = |cases: Option<&[PreparedCase]>| {
                let cases = cases.filter(|all| all.iter().all(|of| of.line(&of_campaign.out).is_some()));
                there.filter(|there| cases.is_some_and(|cases| is_this(there, cases)))
            };
            let there = campaign::look(self.campaign, &of_campaign, is_walked)?;
            return there.map_or_else(other, |there| Ok(Some(there)));
        }
        match Unfinished::read(&folder)? {
            Some(begun) => {
                // Where a packing was taken away it is made again, and other work is refused then.
                let is_this =
                    |cases: Option<&[PreparedCase]>| cases.is_none_or(|all| (self.work)(all) == begun.work);
                let is_this = campaign::look(self.campaign, &of_campaign, is_this)?;
                if is_this { Ok(None) } else { other() }
            }
            None => Ok(None),
        }
    }
}

/// The outcome of a case that is done.
pub(super) fn outcome(case: &Path) -> Result<Outcome, RunError> {
    kept::record(case, FolderKind::Run)
}
