//! Parts of every page: the cover of the sheet, the files that were read, and the sizes of a soil.

use crate::quantity::{SizeUnit, length, significant};
use serde::{Deserialize, Serialize};
use voidwalk_core::gradation::{FINES_MM, Gradation};

/// Page of a run as its author states it.
#[derive(Clone, Debug, PartialEq)]
pub struct AboutPage {
    /// Cover of the sheet, without a date unless one is stated.
    pub cover: SheetCover,
    /// True to draw gradations with coarse sizes on the left.
    pub coarse_left: bool,
    /// Unit of sizes in words and on the first sheet.
    pub unit: SizeUnit,
}

/// Cover of a sheet as its author states it.
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
    /// Name of the project.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub project: Option<String>,
    /// Number of the project.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub number: Option<String>,
    /// Purpose of the sheet.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub purpose: Option<String>,
    /// Name of the client.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub client: Option<String>,
    /// Name of the author.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub author: Option<String>,
    /// Name of the checker.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub checker: Option<String>,
    /// Revision of the sheet.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub revision: Option<String>,
    /// Date on the sheet: the date stated, or else the day of its results.
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

/// File that was read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct InputFile {
    /// Name of the file as given.
    pub name: String,
    /// XXH3 of its bytes, in hexadecimal. Detects accidents, not attackers.
    pub xxh3: String,
}

impl InputFile {
    /// Describes a file with these bytes.
    pub fn of(name: impl Into<String>, bytes: &[u8]) -> Self {
        Self { name: name.into(), xxh3: format!("{:016x}", xxhash_rust::xxh3::xxh3_64(bytes)) }
    }
}

/// Usual sizes of a soil by name; `None` if the sieves do not give one. Without a unit, fines and group
/// are omitted.
pub fn sizes_of(rows: &[[f64; 2]], unit: SizeUnit) -> Vec<(&'static str, Option<String>)> {
    const SIZES: [(&str, f64); 9] = [
        ("D5", 5.0),
        ("D10", 10.0),
        ("D15", 15.0),
        ("D30", 30.0),
        ("D50", 50.0),
        ("D60", 60.0),
        ("D85", 85.0),
        ("D90", 90.0),
        ("D95", 95.0),
    ];
    let soil = Gradation::of_rows(rows).ok();
    let soil = soil.as_ref();
    let size = |percent| Some(length(soil?.d(percent)?, unit).in_both_units());
    let few = |number: f64| significant(number).in_digits(3).to_string();
    let mut all: Vec<_> = SIZES.map(|(name, percent)| (name, size(percent))).into();
    all.extend([
        ("Cu", soil.and_then(Gradation::cu).map(few)),
        ("Cc", soil.and_then(Gradation::cc).map(few)),
    ]);
    if unit != SizeUnit::D0f {
        let fines = soil.and_then(|soil| soil.percent_finer_if_known(FINES_MM));
        all.extend([("Fines (%)", fines.map(few)), ("Group", soil.and_then(Gradation::group))]);
    }
    all
}
