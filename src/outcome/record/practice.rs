//! What filter practice says of a pair, as it is written.

use serde::{Deserialize, Serialize};

/// What filter practice says of a pair, for programs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Practice {
    /// The limit of design.
    pub design: LimitOfDesign,
}

/// A limit of D15F, and whether the filter keeps it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LimitOfDesign {
    /// The name of its rule for programs.
    pub rule: String,
    /// The most that D15F may be; `None` where that is not known.
    pub limit_mm: Option<f64>,
    /// Whether the true limit is not known, and is at most `limit_mm`.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub limit_at_most: bool,
    /// D15F.
    pub value_mm: Option<f64>,
    /// Whether the filter keeps it; `None` where that is not known.
    pub met: Option<bool>,
}
