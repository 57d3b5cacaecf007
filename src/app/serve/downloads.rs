//! Files that the page offers to take away: sheets to try it with, and a workbook to fill in.

use super::http::Answer;
use crate::run::EXAMPLE_FILES;

/// A sheet to try the page with.
pub(super) fn example(name: &str) -> Result<Answer, (u16, String)> {
    let example = EXAMPLE_FILES.iter().find(|file| file.name == name);
    let file = example.ok_or_else(|| (404, "there is no such example".to_owned()))?;
    Ok(Answer::new(200, "text/plain; charset=utf-8", file.text))
}

/// A workbook to fill in.
#[cfg(feature = "xlsx")]
pub(super) fn template(path: &str) -> Result<Answer, (u16, String)> {
    let bytes = crate::report::soil_template().map_err(|error| (500, error.to_string()))?;
    let answer = Answer::new(200, "application/octet-stream", bytes);
    Ok(Answer { download: Some(path.into()), ..answer })
}
