//! The answer of filter practice on a pair, in its written form.

use serde::{Deserialize, Serialize};

/// What filter practice says of a pair, for programs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct Practice {
    /// All of it, as the headline has it.
    pub class: PracticeClass,
    /// D15F (mm), twice; of one that lies between two sieves that stand far apart their openings. `None`
    /// where it lies in the filter's finest part.
    pub d15f_mm: Option<[f64; 2]>,
    /// The limit of design (mm): the most that D15F may be; `None` where that is not known.
    pub limit_mm: Option<f64>,
    /// Whether the true limit is not known, and is at most `limit_mm`.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub limit_at_most: bool,
    /// Class of such pairs in tests, by the boundaries of Foster and Fell.
    pub tests: TestedClass,
    /// D15F (mm) between which tests of bases with such fines began to erode (Fell et al., Table 9.2); `None`
    /// of a dispersive base, which had other tests, and where fines or D85B are not known.
    pub range_of_tests_mm: Option<[f64; 2]>,
}

/// Whether a filter meets the rules checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub enum PracticeClass {
    /// The limit of design is kept, and the filter holds its own finer part. Whether it drains, and holds a
    /// base that may be dispersive, is said beside it.
    #[serde(rename = "meets")]
    Meets,
    /// A limit is not kept.
    #[serde(rename = "does not meet")]
    DoesNotMeet,
    /// A limit or a size that is needed is not known, or the filter may lose its finer part.
    #[serde(rename = "not known")]
    NotKnown,
}

/// The answer of filter practice, with which every face begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub enum Headline {
    /// The limit of design is kept, and no other rule of retention, stability, drainage or placing is broken.
    #[serde(rename = "meets the rules checked")]
    Meets,
    /// The same, unless the base is dispersive, of which nobody has said whether it is.
    #[serde(rename = "meets the rules checked unless the base is dispersive")]
    MeetsUnlessDispersive,
    /// The limit of design is kept; whether the filter drains the base is not known.
    #[serde(rename = "meets the limit of retention, drainage not known")]
    DrainageNotKnown,
    /// The limit of design is kept by a filter that breaks a rule of drainage.
    #[serde(rename = "meets the limit of retention, but may not drain")]
    MayNotDrain,
    /// The limit of design is kept by a filter that breaks a rule of placing.
    #[serde(rename = "meets the limit of retention, but may segregate")]
    MaySegregate,
    /// Beyond the limit of design, within the boundary of no erosion of tests.
    #[serde(rename = "does not meet the limit of design")]
    BeyondDesign,
    /// Beyond a limit of retention.
    #[serde(rename = "does not meet practice")]
    DoesNotMeet,
    /// Not internally stable, and beyond a limit of retention without its finer part.
    #[serde(rename = "does not meet practice: it may lose its finer part, and is too coarse without it")]
    TooCoarseWithoutFiner,
    /// Not internally stable.
    #[serde(rename = "not known: the filter may lose its finer part")]
    MayLoseFiner,
    /// A result depends on sizes between two sieves that lie far apart.
    #[serde(rename = "not known: sieves are missing")]
    SievesMissing,
    /// A limit that decides is not known.
    #[serde(rename = "not known: a test is missing")]
    TestMissing,
}

impl Headline {
    /// Every headline.
    pub const ALL: [Self; 11] = [
        Self::Meets,
        Self::MeetsUnlessDispersive,
        Self::DrainageNotKnown,
        Self::MayNotDrain,
        Self::MaySegregate,
        Self::BeyondDesign,
        Self::DoesNotMeet,
        Self::TooCoarseWithoutFiner,
        Self::MayLoseFiner,
        Self::SievesMissing,
        Self::TestMissing,
    ];

    /// Words of the headline, on every face and in every file.
    pub fn words(self) -> &'static str {
        match self {
            Self::Meets => "meets the rules checked",
            Self::MeetsUnlessDispersive => "meets the rules checked unless the base is dispersive",
            Self::DrainageNotKnown => "meets the limit of retention, drainage not known",
            Self::MayNotDrain => "meets the limit of retention, but may not drain",
            Self::MaySegregate => "meets the limit of retention, but may segregate",
            Self::BeyondDesign => "does not meet the limit of design",
            Self::DoesNotMeet => "does not meet practice",
            Self::TooCoarseWithoutFiner => {
                "does not meet practice: it may lose its finer part, and is too coarse without it"
            }
            Self::MayLoseFiner => "not known: the filter may lose its finer part",
            Self::SievesMissing => "not known: sieves are missing",
            Self::TestMissing => "not known: a test is missing",
        }
    }

    /// Class of the headline: practice met, not met, or not known.
    pub fn class(self) -> PracticeClass {
        match self {
            Self::Meets
            | Self::MeetsUnlessDispersive
            | Self::DrainageNotKnown
            | Self::MayNotDrain
            | Self::MaySegregate => PracticeClass::Meets,
            Self::BeyondDesign | Self::DoesNotMeet | Self::TooCoarseWithoutFiner => {
                PracticeClass::DoesNotMeet
            }
            Self::MayLoseFiner | Self::SievesMissing | Self::TestMissing => PracticeClass::NotKnown,
        }
    }
}

/// What practice allows if a base is dispersive, of which nobody has said whether it is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct IfDispersive {
    /// The most that D15F (mm) may be then.
    pub d15f_max_mm: f64,
    /// Whether the true limit is not known, and is at most that.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub at_most: bool,
    /// Why it is not known; `None` where it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lacks: Option<DispersiveLack>,
}

/// Why the limit of a dispersive base is not known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
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
    #[serde(rename = "unknown")]
    Unknown,
}
