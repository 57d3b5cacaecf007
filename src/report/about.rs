//! The settings of a scene that are of its page alone.

use std::path::Path;

use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::cover::LINE;
use super::error::ReportError;
use super::figures::shorten;
use crate::outcome::record::SheetCover;

/// The table `about` of a scene.
pub(super) struct About {
    /// The cover of the page.
    pub cover: SheetCover,
    /// The way in which sizes are shown.
    pub sizes: ShownSizes,
}

/// The way in which sizes are shown.
#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct ShownSizes {
    /// Gradations are drawn with coarse sizes on the left.
    pub coarse_left: bool,
    /// The units of sizes; mm where nothing is stated.
    pub units: Option<SheetUnits>,
}

/// The units of sizes.
#[derive(Clone, Copy, Deserialize, PartialEq)]
#[serde(rename_all = "lowercase")]
pub(super) enum SheetUnits {
    /// mm alone.
    Metric,
    /// Inches beside mm.
    Us,
}

impl About {
    /// Reads the text of a scene, which `path` names in errors.
    ///
    /// # Errors
    /// A value that cannot be read, with its line: a page without it may go to a client.
    pub(super) fn read(path: &Path, scene: &str) -> Result<Self, ReportError> {
        Ok(Self { cover: about(path, scene)?, sizes: about(path, scene)? })
    }
}

/// The settings of one kind in the table `about`; nothing else of the scene is looked at. Each kind is read
/// apart, as an error within a flattened struct would have no line.
fn about<T: Default + DeserializeOwned>(path: &Path, scene: &str) -> Result<T, ReportError> {
    #[derive(Deserialize)]
    struct Scene<T> {
        #[serde(default)]
        about: T,
    }
    toml::from_str(scene).map(|scene: Scene<T>| scene.about).map_err(|error| {
        let before = scene.bytes().take(error.span().map_or(0, |span| span.start));
        let line = before.filter(|byte| *byte == b'\n').count();
        let text = shorten(scene.lines().nth(line).unwrap_or_default().trim(), LINE);
        let message = format!("`{text}`: {}", error.message());
        ReportError::Form { path: path.to_owned(), line: line as u64 + 1, message }
    })
}
