//! The content of the files of a run folder, as values.

use crate::outcome::Recorded;
use crate::outcome::packing::PackingRecord;
use crate::outcome::record::{Manifest, Outcome};
use voidwalk_practice::AboutPage;
use voidwalk_practice::Decision;

/// The content of the files of a run folder and the derived values from which its page is made.
pub struct RunFiles {
    /// `outcome.json`.
    pub outcome: Outcome,
    /// The decision of practice on the pair.
    pub decision: Decision,
    /// `manifest.json`.
    pub manifest: Manifest,
    /// `scene.toml`.
    pub scene: String,
    /// Its settings of the page.
    pub about: AboutPage,
    /// `inputs/packing.json`, if the filter was packed.
    pub packing: Option<PackingRecord>,
    /// The rows of the CSV files.
    pub recorded: Recorded,
}
