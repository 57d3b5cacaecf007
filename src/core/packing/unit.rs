//! Units of length, for files that do not give theirs.

use crate::schema::Leaf;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// A unit of length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LengthUnit {
    /// Metres.
    M,
    /// Centimetres.
    Cm,
    /// Millimetres.
    Mm,
    /// Micrometres.
    Um,
    /// Nanometres.
    Nm,
}

impl Leaf for LengthUnit {}

impl LengthUnit {
    /// All units, from the largest.
    pub const ALL: [Self; 5] = [Self::M, Self::Cm, Self::Mm, Self::Um, Self::Nm];

    /// Name in a scene or on a command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::M => "m",
            Self::Cm => "cm",
            Self::Mm => "mm",
            Self::Um => "um",
            Self::Nm => "nm",
        }
    }

    /// Full name, in the plural.
    pub fn words(self) -> &'static str {
        match self {
            Self::M => "metres",
            Self::Cm => "centimetres",
            Self::Mm => "millimetres",
            Self::Um => "micrometres",
            Self::Nm => "nanometres",
        }
    }

    /// Length of the unit (mm).
    pub fn mm(self) -> f64 {
        match self {
            Self::M => 1e3,
            Self::Cm => 10.0,
            Self::Mm => 1.0,
            Self::Um => 1e-3,
            Self::Nm => 1e-6,
        }
    }
}

impl FromStr for LengthUnit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim().replace(['µ', 'μ'], "u");
        let unit = Self::ALL.into_iter().find(|unit| unit.name() == text);
        unit.ok_or_else(|| "write the unit of the file's lengths: m, cm, mm, um or nm".into())
    }
}
