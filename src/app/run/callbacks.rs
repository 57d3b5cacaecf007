//! Callbacks by which a caller follows the work and stops it.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use super::RunError;
use super::error::AnyError;
use super::folder::{FolderKind, Unfinished};
use crate::case::PackingPlan;
use crate::outcome::record::Outcome;
use crate::verdict::RunFiles;
use voidwalk_core::packing::CompressionProgress;
use voidwalk_core::store::Folder;
use voidwalk_practice::quantity::SizeUnit;
use voidwalk_practice::{Decision, Note};

/// Event while a filter is packed and a case is walked.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// Another process is making the packing that is needed, and this one waits.
    PackingElsewhere {
        /// The packing's folder.
        folder: &'a Path,
        /// Process that makes it.
        holder: &'a str,
    },
    /// The packing of a filter begins, from the start or from a checkpoint.
    PackingBegun(&'a PackingPlan),
    /// Progress of the packing.
    Packing(&'a CompressionProgress),
    /// The packing has ended, successfully or not.
    PackingEnded,
    /// Notes on a case before its walk.
    Noted {
        /// Notes, most important first.
        notes: &'a [Note],
        /// Unit of sizes in the case.
        unit: SizeUnit,
    },
    /// The walk of replicates begins.
    WalkBegun {
        /// Number of runs, as far as is known.
        runs: u64,
    },
    /// An increment of a run is done.
    Increment {
        /// Replicate, counted from 1.
        replicate: u64,
        /// Run, counted from 1.
        run: u64,
        /// The increment.
        increment: u64,
        /// Base particles still moving.
        moving: u64,
    },
    /// A run is done.
    RunDone,
    /// Result of a run of the case itself, with its own curve and amount of base.
    RunWalked {
        /// Replicate, counted from 1.
        replicate: u64,
        /// Run, counted from 1.
        run: u64,
        /// Mass eroded over mass inserted.
        eroded_mass_fraction: f64,
        /// True if the fraction is below the threshold, without rounding.
        below_threshold: bool,
    },
    /// Number of walks that decide the verdict, as far as is known; sent again if more replicates are needed.
    VerdictNeeds {
        /// Replicates of the case itself.
        replicates: u64,
        /// Runs of each.
        runs: u64,
        /// True if the ends of the range of its curve are walked as well.
        readings: bool,
    },
    /// The verdict is final; all further walks are studies.
    VerdictStands {
        /// The outcome, still without its studies.
        outcome: &'a Outcome,
        /// The decision of practice.
        decision: &'a Decision,
        /// Unit of sizes in the case.
        unit: SizeUnit,
    },
    /// More runs are needed than were known.
    MoreRuns {
        /// Number of runs.
        runs: u64,
    },
    /// Current step of a study, in words.
    Studying(&'a str),
}

/// Callbacks by which a caller follows the work, from any thread, and stops it; by default they do nothing.
/// [`resume`](super::resume) has an example.
#[derive(Clone, Copy)]
pub struct Callbacks<'a> {
    /// Receives every event.
    pub on_event: &'a (dyn Fn(Event) + Sync),
    /// Set to stop: the work ends after the current increment or step and saves its progress.
    pub stop: &'a AtomicBool,
    /// Receives warnings for the user.
    pub warn: &'a (dyn Fn(&str) + Sync),
    /// Called when results of this kind in this folder are complete, before the work counts as done. It gets
    /// the content of the files of a run that was walked in this call.
    pub on_results: &'a TakeResults<'a>,
}

/// Receives results of a kind in a folder.
type TakeResults<'a> = dyn Fn(FolderKind, &Path, Option<RunFiles>) -> Result<(), AnyError> + Sync + 'a;

/// Stop flag that is never set.
static NEVER: AtomicBool = AtomicBool::new(false);

impl Default for Callbacks<'_> {
    fn default() -> Self {
        Self { on_event: &|_| {}, stop: &NEVER, warn: &|_| {}, on_results: &|_, _, _| Ok(()) }
    }
}

impl Callbacks<'_> {
    /// True if the work must stop.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Reports that results are written.
    pub(crate) fn results(
        &self,
        kind: FolderKind,
        folder: &Path,
        run: Option<RunFiles>,
    ) -> Result<(), RunError> {
        (self.on_results)(kind, folder, run).map_err(RunError::Results)
    }

    /// Reports that results are written, and removes the mark of unfinished work.
    pub(crate) fn finish(&self, kind: FolderKind, folder: &Folder) -> Result<(), RunError> {
        self.results(kind, folder.path(), None)?;
        Ok(Unfinished::end(folder)?)
    }
}
