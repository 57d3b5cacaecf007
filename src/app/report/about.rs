//! The settings of a scene that are of its page alone.

use std::path::Path;

use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::cover::LINE;
use super::error::ReportError;
use super::figures::shorten;
use super::quantity::SizeUnit;
use crate::outcome::record::Outcome;
use voidwalk_practice::AboutPage;

/// The way in which sizes are shown.
#[derive(Default, Deserialize)]
#[serde(default)]
struct ShownSizes {
    coarse_left: bool,
    units: Option<SheetUnits>,
}

/// The units of sizes.
#[derive(Deserialize, PartialEq)]
#[serde(rename_all = "lowercase")]
enum SheetUnits {
    Metric,
    Us,
}

/// The page that the text of a run's scene asks for; `path` names the text in errors.
///
/// # Errors
/// A value that cannot be read, with its line: a page without it may go to a client.
pub fn about_page(path: &Path, scene: &str, outcome: &Outcome) -> Result<AboutPage, ReportError> {
    let (cover, sizes): (_, ShownSizes) = (about(path, scene)?, about(path, scene)?);
    let unit = SizeUnit::of(outcome.inputs.scale_free, sizes.units == Some(SheetUnits::Us));
    Ok(AboutPage { cover, coarse_left: sizes.coarse_left, unit })
}

/// The settings of one kind in the table `about`; nothing else of the scene is read. Each kind is read
/// separately, as an error within a flattened struct would have no line.
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
