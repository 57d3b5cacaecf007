//! The content of the files of a run folder, as values.

use super::Recorded;
use super::packing::PackingRecord;
use super::record::{Manifest, Outcome};

/// The content of the files of a run folder, of which its page is made.
pub struct RunFiles {
    /// `outcome.json`.
    pub outcome: Outcome,
    /// `manifest.json`.
    pub manifest: Manifest,
    /// `scene.toml`.
    pub scene: String,
    /// `inputs/packing.json`, where the filter was packed.
    pub packing: Option<PackingRecord>,
    /// The rows of the CSV files.
    pub recorded: Recorded,
}
