//! What was found about a part of a design, as it is written.

use serde::{Deserialize, Serialize};

use crate::outcome::record::FindingRecord;

/// A finding about the rows of a design, or about the curves of a base for which a filter is specified.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct DesignFinding {
    /// The row or the curve that it is of, in words; `None` where it is of all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub row: Option<String>,
    /// The finding.
    #[serde(flatten)]
    pub finding: FindingRecord,
}

impl DesignFinding {
    /// Its sentence, with the name of the row or curve and with the setting that changes it.
    pub fn words(&self) -> String {
        let said = self.finding.with_to_do();
        self.row.as_ref().map_or(said.clone(), |row| format!("{row}: {said}"))
    }
}
