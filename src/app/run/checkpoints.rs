//! Saves the replicates of a case in checkpoints, so that a stopped or killed run continues from where it
//! was.
//!
//! A replicate under way is saved with its state and its records so far, a finished one with its figures and
//! rows, each in a checkpoint of its own ([`voidwalk_core::store::checkpoint`]).

use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::{Mutex, MutexGuard};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::outcome::record::Run;
use crate::outcome::{Recorded, Recorder};
use voidwalk_core::network::Network;
use voidwalk_core::store::checkpoint::{Checkpoint, CheckpointError, Identity, Label, Section, newest, save};
use voidwalk_core::store::{Folder, StoreError, files_in, make_folder, remove_folder};
use voidwalk_core::walk::{SavedState, State};

/// Folder of the checkpoints, inside the run's folder.
pub(crate) const FOLDER: &str = "checkpoint";

/// Finished part of a replicate.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Done {
    pub(crate) complete: bool,
    pub(crate) runs: Vec<Run>,
    /// True, by run, if the eroded mass was below the threshold.
    pub(crate) below: Vec<bool>,
    pub(crate) recorded: Recorded,
    /// Records of the current run.
    pub(crate) recorder: Recorder,
}

/// Identity of a walk of a case: a checkpoint belongs to one walk only.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WalkId {
    /// 0 for the walks of the scene itself. From 1: walks of the sensitivity study, then those at the ends of
    /// the constriction curve's range, then those of other thicknesses. From 2^32: those of the margin.
    pub(crate) part: u64,
    /// Replicate, counted from 1.
    pub(crate) replicate: u64,
    pub(crate) seed: u64,
    /// Base particles of each run.
    pub(crate) n_base: u64,
}

impl WalkId {
    fn name(self) -> String {
        format!("{}-{}", self.part, self.replicate)
    }
}

/// Interval between saves of a walk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckpointInterval {
    /// A save after this much time.
    Time(Duration),
    /// A save after this many increments.
    Increments(u64),
}

impl Default for CheckpointInterval {
    fn default() -> Self {
        Self::Time(Duration::from_secs(600))
    }
}

impl FromStr for CheckpointInterval {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong =
            || "a time, as 10min or 90s, or a number of increments from 1, as 50increments".to_string();
        match text.trim_end_matches('s').strip_suffix("increment") {
            Some(number) => match number.trim().parse() {
                Ok(number @ 1..) => Ok(Self::Increments(number)),
                _ => Err(wrong()),
            },
            None => humantime::parse_duration(text).map(Self::Time).map_err(|_| wrong()),
        }
    }
}

impl fmt::Display for CheckpointInterval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Time(time) => {
                write!(f, "{}", humantime::format_duration(*time).to_string().replace(' ', ""))
            }
            Self::Increments(number) => write!(f, "{number}increments"),
        }
    }
}

/// Saves the replicates of one case.
pub(crate) struct Checkpoints {
    folder: PathBuf,
    scene: String,
    every: CheckpointInterval,
    shared: Mutex<Shared>,
}

#[derive(Default)]
struct Shared {
    /// Finished replicates that are not on disk yet, by name.
    waiting: BTreeMap<String, (Label, Done)>,
    generations: BTreeMap<String, u64>,
    passed_over: Vec<String>,
}

impl Checkpoints {
    /// Checkpoints of the case with this fingerprint, in a run's folder.
    pub(crate) fn new(folder: &Folder, scene: &str, every: CheckpointInterval) -> Result<Self, StoreError> {
        let path = folder.path().join(FOLDER);
        make_folder(&path)?;
        Ok(Self { folder: path, scene: scene.to_owned(), every, shared: Mutex::default() })
    }

    fn shared(&self) -> MutexGuard<'_, Shared> {
        self.shared.lock().expect("nothing panics under this lock")
    }

    /// Fingerprint of the scene of the checkpoints in a run's folder; `None` without an intact checkpoint.
    pub(crate) fn scene_in(folder: &Path) -> Result<Option<String>, CheckpointError> {
        let folder = folder.join(FOLDER);
        let files = files_in(&folder)
            .map_err(|e| CheckpointError::Unreadable { file: folder, source: std::io::Error::other(e) })?;
        for file in files {
            match Checkpoint::open(&file) {
                Ok(Some(saved)) => return Ok(Some(saved.label.identity.scene)),
                Err(error) if error.is_unreadable() => return Err(error),
                _ => {}
            }
        }
        Ok(None)
    }

    /// True if a run's folder holds checkpoints.
    pub(crate) fn is_in(folder: &Path) -> Result<bool, StoreError> {
        Ok(!files_in(&folder.join(FOLDER))?.is_empty())
    }

    /// True if a walk that was last saved at `last` must be saved after this increment.
    pub(crate) fn is_due(&self, last: Instant, increment: u64, stop: bool) -> bool {
        stop || match self.every {
            CheckpointInterval::Time(time) => last.elapsed() >= time,
            CheckpointInterval::Increments(number) => increment.is_multiple_of(number),
        }
    }

    /// Loads a replicate: its finished part, and the checkpoint of the current run. Errors: it has
    /// checkpoints, but none is intact and belongs to this very walk.
    pub(crate) fn load(&self, walk: WalkId) -> Result<Option<(Done, Checkpoint)>, CheckpointError> {
        let name = walk.name();
        let (saved, refused) = newest(&self.folder, &name, &self.identity(walk))?;
        let mut shared = self.shared();
        shared.passed_over.extend(refused.iter().map(ToString::to_string));
        let Some(saved) = saved else { return Ok(None) };
        shared.generations.insert(name, saved.label.generation);
        // Replicates parse side by side, and a parser that panics must not poison the lock.
        drop(shared);
        Ok(Some((saved.read_record("done")?, saved)))
    }

    pub(crate) fn passed_over(&self) -> Vec<String> {
        self.shared().passed_over.clone()
    }

    /// Saves a walk after a complete increment. If saving fails, the previous checkpoint stays.
    pub(crate) fn save_walk(
        &self,
        walk: WalkId,
        network: &Network,
        state: &State,
        done: &Done,
    ) -> Result<(), StoreError> {
        let text = serde_json::to_vec(done).expect("figures are numbers and words");
        let saved = SavedState::new(state);
        let mut sections = saved.sections();
        sections.push(Section::new("done", &text));
        let label = Label {
            network: network.fingerprint(),
            run: state.run,
            increment: state.increment,
            ..self.next_label(walk)
        };
        save(&self.folder, &walk.name(), &label, &sections)?;
        self.flush()
    }

    /// Accepts a finished replicate, which is written with the next checkpoint of any replicate.
    pub(crate) fn save_finished(&self, walk: WalkId, done: Done) {
        let label = self.next_label(walk);
        self.shared().waiting.insert(walk.name(), (label, done));
    }

    /// Writes the finished replicates that are not on disk yet.
    pub(crate) fn flush(&self) -> Result<(), StoreError> {
        let waiting = std::mem::take(&mut self.shared().waiting);
        for (name, (label, done)) in &waiting {
            let text = serde_json::to_vec(done).expect("figures are numbers and words");
            save(&self.folder, name, label, &[Section::new("done", &text)])?;
        }
        Ok(())
    }

    /// Removes every checkpoint: the results are complete.
    pub(crate) fn clear(&self) -> Result<(), StoreError> {
        remove_folder(&self.folder)
    }

    fn identity(&self, walk: WalkId) -> Identity {
        let WalkId { part, replicate, seed, n_base } = walk;
        Identity { scene: self.scene.clone(), part, replicate, seed, n_base }
    }

    /// Label of the next checkpoint of a walk, before its first increment.
    fn next_label(&self, walk: WalkId) -> Label {
        let mut shared = self.shared();
        let generation = shared.generations.entry(walk.name()).or_insert(0);
        *generation += 1;
        Label { identity: self.identity(walk), generation: *generation, ..Label::default() }
    }
}

/// Removes the checkpoints in a run's folder, whichever scene they belong to.
pub(crate) fn discard(folder: &Path) -> Result<(), StoreError> {
    remove_folder(&folder.join(FOLDER))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn how_often_is_a_time_or_a_number_of_increments() {
        assert_eq!("10min".parse(), Ok(CheckpointInterval::Time(Duration::from_secs(600))));
        assert_eq!("50increments".parse(), Ok(CheckpointInterval::Increments(50)));
        assert_eq!("1 increment".parse(), Ok(CheckpointInterval::Increments(1)));
        for wrong in ["", "0increments", "increments", "-1increments", "ten", "1.5increments"] {
            assert!(wrong.parse::<CheckpointInterval>().unwrap_err().contains("as 10min or 90s"), "{wrong}");
        }
    }
}
