//! Origin of a run folder: `manifest.json`.

use serde::{Deserialize, Serialize};
use voidwalk_practice::InputFile;

/// The commit from which this program was built, if known.
pub fn commit() -> Option<String> {
    option_env!("VOIDWALK_COMMIT").map(String::from)
}

/// The whole of `manifest.json`: what made the folder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Manifest {
    /// Version of voidwalk.
    pub version: String,
    /// Commit it was built from, where known.
    pub commit: Option<String>,
    /// The user's seed.
    pub seed: u64,
    /// Every file that was read.
    pub inputs: Vec<InputFile>,
    /// Worker threads.
    pub threads: u64,
    /// Name of the machine.
    pub host: String,
    /// Kind of machine: system, processor, memory.
    pub machine: String,
    /// When the work began, RFC 3339.
    pub started: String,
    /// When it ended, RFC 3339.
    pub finished: String,
    /// The command line.
    pub command: String,
}
