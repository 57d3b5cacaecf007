//! What filter practice says of a pair, as it is written.

use serde::{Deserialize, Serialize};

/// What filter practice says of a pair, for programs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Practice {
    /// All of it, as the line of practice and the headline have it; folders of earlier versions do not say.
    #[serde(default)]
    pub class: PracticeClass,
    /// The limit of design.
    pub design: LimitOfDesign,
    /// What tests of Foster and Fell showed for such a pair; folders of earlier versions do not say.
    #[serde(default)]
    pub foster_fell: TestedClass,
}

/// Whether a filter meets practice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub enum PracticeClass {
    /// The limit of design is kept, and the filter holds its own finer part. Whether it drains, and holds a
    /// base that may be dispersive, is said beside it.
    #[serde(rename = "meets")]
    Meets,
    /// A limit is not kept.
    #[serde(rename = "does not meet")]
    DoesNotMeet,
    /// A limit or a size that is needed is not known, or the filter may lose its finer part.
    #[default]
    #[serde(rename = "not known")]
    NotKnown,
}

/// What practice allows if a base is dispersive, of which nobody has said whether it is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct IfDispersive {
    /// The most that D15F (mm) may be then.
    pub d15f_max_mm: f64,
    /// Whether the true limit is not known, and is at most that.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub at_most: bool,
    /// Why it is not known; `None` where it is, and in files of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lacks: Option<DispersiveLack>,
}

/// Why the limit of a dispersive base is not known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub enum DispersiveLack {
    /// No source that was read gives a limit of design for such fines: at most that of no erosion.
    #[serde(rename = "limit of design")]
    LimitOfDesign,
    /// No source that was read gives any limit for such fines: the most is the limit of bases that are not
    /// dispersive.
    #[serde(rename = "any limit")]
    AnyLimit,
    /// No sieve tells the base's D85.
    #[serde(rename = "D85B")]
    D85B,
}

/// What filter tests showed, by the boundaries of Foster and Fell.
///
/// Their boundary of excessive erosion stands in figures whose numbers no text gives, so what lies between
/// the boundaries of no and of continuing erosion is "some erosion" here, though it may be excessive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub enum TestedClass {
    /// Within the boundary of no erosion.
    #[serde(rename = "no erosion")]
    None,
    /// Beyond that of no erosion, within that of continuing erosion.
    #[serde(rename = "some erosion")]
    Some,
    /// Beyond that of excessive erosion: never said until its numbers can be read.
    #[serde(rename = "excessive erosion")]
    Excessive,
    /// Beyond the boundary of continuing erosion.
    #[serde(rename = "continuing erosion")]
    Continuing,
    /// A boundary that is needed is not known for these soils.
    #[default]
    #[serde(rename = "unknown")]
    Unknown,
}

/// A limit of D15F, and whether the filter keeps it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
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
