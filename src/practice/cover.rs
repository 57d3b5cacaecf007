//! Cover of a sheet that is handed in: client, author and date.

use serde::{Deserialize, Serialize};

use crate::quantity::SizeUnit;

/// The page of a run, as its author states it.
#[derive(Clone, Debug, PartialEq)]
pub struct AboutPage {
    /// Cover of the sheet, without a date unless one is stated.
    pub cover: SheetCover,
    /// True to draw gradations with coarse sizes on the left.
    pub coarse_left: bool,
    /// The unit of sizes in words and on the first sheet.
    pub unit: SizeUnit,
}

/// The cover of a sheet, as its author states it.
///
/// ```
/// use voidwalk_practice::SheetCover;
/// let stated = SheetCover { project: Some("Main dam".into()), ..SheetCover::default() };
/// let dated = stated.clone().dated(Some("2026-11-25".into()));
/// assert_eq!(dated.date.as_deref(), Some("2026-11-25"));
/// assert_eq!(SheetCover { date: None, ..dated }, stated);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct SheetCover {
    /// The project.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub project: Option<String>,
    /// The number of the project.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub number: Option<String>,
    /// What the sheet is for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub purpose: Option<String>,
    /// The client.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub client: Option<String>,
    /// The author.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub author: Option<String>,
    /// Who checked it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub checker: Option<String>,
    /// The revision of the sheet.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub revision: Option<String>,
    /// The date on the sheet: the one that is stated, else the day of its results.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub date: Option<String>,
}

impl SheetCover {
    /// True if the cover states nothing.
    pub fn is_unset(&self) -> bool {
        *self == Self::default()
    }

    /// Fills in the day of the results if no date is stated.
    pub fn dated(self, day: Option<String>) -> Self {
        Self { date: self.date.or(day), ..self }
    }
}
