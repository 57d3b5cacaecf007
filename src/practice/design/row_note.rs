//! A note on a part of boundaries or of a specification.

use serde::{Deserialize, Serialize};

use crate::Note;

/// A note on a row of boundaries, or on a curve of the base for which a filter is specified.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct RowNote {
    /// The row or the curve that it is of, in words; `None` where it is of all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub row: Option<String>,
    /// The note.
    #[serde(flatten)]
    pub note: Note,
}
