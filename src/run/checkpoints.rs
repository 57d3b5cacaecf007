//! Saves the replicates of a case in checkpoints, so that a run which is stopped or killed continues where it
//! was.
//!
//! Of a replicate that is being walked its state is saved, and what was recorded of it so far; of one that is
//! done its figures and rows. Each is a checkpoint of its own in the folder `checkpoint` of the run
//! ([`crate::store::checkpoint`]), written as often as [`CheckpointInterval`] says, and on a stop.

use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::network::Network;
use crate::outcome::record::Run;
use crate::outcome::{Recorded, Recorder};
use crate::store::checkpoint::{Harmed, Label, Saved, Section, keep, newest};
use crate::store::{Folder, StoreError, files_in, make_folder, remove_folder};
use crate::walk::{Kept, State};

/// Folder of the checkpoints, inside the run's.
pub const FOLDER: &str = "checkpoint";

/// What of a replicate is done.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Done {
    /// Whether all of it is.
    pub complete: bool,
    /// Figures of the runs that are done.
    pub runs: Vec<Run>,
    /// Whether each of them eroded less than the threshold.
    pub below: Vec<bool>,
    /// Their rows of the CSV files.
    pub recorded: Recorded,
    /// What has been watched of the run that is under way.
    pub recorder: Recorder,
}

/// How often a walk is saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckpointInterval {
    /// When this much time has passed since the last time.
    Time(Duration),
    /// After every so many increments.
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
pub struct Checkpoints {
    folder: PathBuf,
    scene: String,
    every: CheckpointInterval,
    /// Replicates that are done and not on the disk yet, and the next generation of each name.
    waiting: Mutex<BTreeMap<String, (Label, Vec<u8>)>>,
    generations: Mutex<BTreeMap<String, u64>>,
    harmed: Mutex<Vec<String>>,
}

impl Checkpoints {
    /// The checkpoints of the case with this fingerprint, in a run's folder.
    ///
    /// # Errors
    /// The folder of the checkpoints cannot be made.
    pub fn new(folder: &Folder, scene: &str, every: CheckpointInterval) -> Result<Self, StoreError> {
        let path = folder.path().join(FOLDER);
        make_folder(&path)?;
        Ok(Self {
            folder: path,
            scene: scene.to_owned(),
            every,
            waiting: Mutex::default(),
            generations: Mutex::default(),
            harmed: Mutex::default(),
        })
    }

    /// What the checkpoints in a run's folder are of, by fingerprint; `None` where there are none that are
    /// whole.
    ///
    /// # Errors
    /// The system fails to read one.
    pub fn scene_in(folder: &Path) -> Result<Option<String>, Harmed> {
        let folder = folder.join(FOLDER);
        let files = files_in(&folder).map_err(|e| Harmed::new(FOLDER, e.to_string()))?;
        for file in files {
            match Saved::open(&file) {
                Ok(Some(saved)) => return Ok(Some(saved.label.scene)),
                Err(error) if error.unread => return Err(error),
                _ => {}
            }
        }
        Ok(None)
    }

    /// Whether a run's folder holds checkpoints.
    ///
    /// # Errors
    /// The system fails to look.
    pub fn is_in(folder: &Path) -> Result<bool, StoreError> {
        Ok(!files_in(&folder.join(FOLDER))?.is_empty())
    }

    /// Whether it is time to save a walk that was saved `last` and has done this increment.
    pub fn is_due(&self, last: Instant, increment: u64, stop: bool) -> bool {
        stop || match self.every {
            CheckpointInterval::Time(time) => last.elapsed() >= time,
            CheckpointInterval::Increments(number) => increment.is_multiple_of(number),
        }
    }

    /// What was saved of a replicate: what is done, and the checkpoint of the state of the run that is under
    /// way.
    ///
    /// # Errors
    /// There are checkpoints of it, but none is whole and of this case.
    pub fn load(&self, part: u64, replicate: u64) -> Result<Option<(Done, Saved)>, Harmed> {
        let name = name(part, replicate);
        let (saved, harmed) = newest(&self.folder, &name, &self.scene)?;
        if let Ok(mut all) = self.harmed.lock() {
            all.extend(harmed.iter().map(ToString::to_string));
        }
        let Some(saved) = saved else { return Ok(None) };
        if let Ok(mut generations) = self.generations.lock() {
            generations.insert(name, saved.label.generation);
        }
        let text = saved.read::<u8>("done")?;
        let done = serde_json::from_slice(&text).map_err(|e| {
            Harmed::new(
                self.folder.display().to_string(),
                format!("what is done of replicate {replicate}: {e}"),
            )
        })?;
        Ok(Some((done, saved)))
    }

    /// Checkpoints that were passed over, and why.
    pub fn passed_over(&self) -> Vec<String> {
        self.harmed.lock().map(|all| all.clone()).unwrap_or_default()
    }

    /// Saves a walk after a whole increment.
    ///
    /// # Errors
    /// What the system says; the checkpoint before stays then.
    pub fn save_walk(
        &self,
        part: u64,
        replicate: u64,
        network: &Network,
        state: &State,
        done: &Done,
    ) -> Result<(), StoreError> {
        let text = serde_json::to_vec(done).expect("figures are numbers and words");
        let kept = Kept::new(state);
        let mut sections = kept.sections(state);
        sections.push(Section::new("done", &text));
        let label = self.label(part, replicate, state, network_fingerprint(network));
        keep(&self.folder, &name(part, replicate), &label, &sections)?;
        self.flush()
    }

    /// Takes a replicate that is done; it goes to the disk with the next checkpoint of any.
    pub fn save_finished(&self, part: u64, replicate: u64, seed: u64, done: &Done) {
        let text = serde_json::to_vec(done).expect("figures are numbers and words");
        let label = Label {
            scene: self.scene.clone(),
            seed,
            replicate,
            generation: self.next_generation(part, replicate),
            ..Label::default()
        };
        if let Ok(mut waiting) = self.waiting.lock() {
            waiting.insert(name(part, replicate), (label, text));
        }
    }

    /// Writes the replicates that are done and not on the disk yet.
    ///
    /// # Errors
    /// What the system says.
    pub fn flush(&self) -> Result<(), StoreError> {
        let waiting = self.waiting.lock().map(|mut w| std::mem::take(&mut *w)).unwrap_or_default();
        for (name, (label, text)) in &waiting {
            keep(&self.folder, name, label, &[Section::new("done", text)])?;
        }
        Ok(())
    }

    /// Removes every checkpoint: the results are whole.
    ///
    /// # Errors
    /// What the system says.
    pub fn clear(&self) -> Result<(), StoreError> {
        remove_folder(&self.folder)
    }

    fn label(&self, part: u64, replicate: u64, state: &State, network: u64) -> Label {
        Label {
            scene: self.scene.clone(),
            network,
            seed: state.seed,
            replicate,
            run: state.run,
            increment: state.increment,
            generation: self.next_generation(part, replicate),
        }
    }

    fn next_generation(&self, part: u64, replicate: u64) -> u64 {
        let Ok(mut generations) = self.generations.lock() else { return 1 };
        let generation = generations.entry(name(part, replicate)).or_insert(0);
        *generation += 1;
        *generation
    }
}

/// Removes the checkpoints in a run's folder, whatever they are of.
///
/// # Errors
/// What the system says.
pub fn discard(folder: &Path) -> Result<(), StoreError> {
    remove_folder(&folder.join(FOLDER))
}

fn name(part: u64, replicate: u64) -> String {
    format!("{part}-{replicate}")
}

/// Fingerprint of everything that a walk takes from its network.
pub fn network_fingerprint(network: &Network) -> u64 {
    let mut hash = xxhash_rust::xxh3::Xxh3::new();
    hash.update(bytemuck::cast_slice(network.diameters()));
    hash.update(bytemuck::cast_slice(network.targets()));
    hash.update(bytemuck::cast_slice(network.start()));
    hash.digest()
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
