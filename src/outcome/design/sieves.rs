//! The sieves at which a specification states its limits.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// A series of sieves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum SieveSeries {
    /// Sieves of the United States (ASTM E11), by inches and numbers.
    #[default]
    Us,
    /// Sieves in millimetres, each half of the one before; above them 75 mm, beyond which no side goes, and
    /// below them 0.075 mm, at which fines are limited.
    Iso,
}

/// Name and opening (mm), the coarsest first.
type NamedSieve = (&'static str, f64);

const US: [NamedSieve; 14] = [
    ("3 in", 75.0),
    ("2 in", 50.0),
    ("1 1/2 in", 37.5),
    ("1 in", 25.0),
    ("3/4 in", 19.0),
    ("1/2 in", 12.5),
    ("3/8 in", 9.5),
    ("No. 4", 4.75),
    ("No. 8", 2.36),
    ("No. 16", 1.18),
    ("No. 30", 0.6),
    ("No. 50", 0.3),
    ("No. 100", 0.15),
    ("No. 200", 0.075),
];

const ISO: [NamedSieve; 12] = [
    ("75 mm", 75.0),
    ("63 mm", 63.0),
    ("31.5 mm", 31.5),
    ("16 mm", 16.0),
    ("8 mm", 8.0),
    ("4 mm", 4.0),
    ("2 mm", 2.0),
    ("1 mm", 1.0),
    ("0.5 mm", 0.5),
    ("0.25 mm", 0.25),
    ("0.125 mm", 0.125),
    ("0.075 mm", 0.075),
];

impl SieveSeries {
    /// Its sieves, name and opening (mm), the coarsest first.
    pub fn sieves(self) -> &'static [NamedSieve] {
        match self {
            Self::Us => &US,
            Self::Iso => &ISO,
        }
    }
}

impl FromStr for SieveSeries {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim().to_lowercase().as_str() {
            "us" => Ok(Self::Us),
            "iso" => Ok(Self::Iso),
            _ => Err("allowed: us (ASTM E11, by inches and numbers) or iso (mm)".into()),
        }
    }
}

impl fmt::Display for SieveSeries {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Us => "us",
            Self::Iso => "iso",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sieves_fall_and_end_where_fines_are_limited() {
        for series in [SieveSeries::Us, SieveSeries::Iso] {
            let sieves = series.sieves();
            assert!(sieves.windows(2).all(|pair| pair[0].1 > pair[1].1), "{series}");
            assert_eq!(sieves.last().unwrap().1, crate::gradation::FINES_MM);
            assert_eq!(series.to_string().parse::<SieveSeries>(), Ok(series));
        }
        assert!("bs".parse::<SieveSeries>().unwrap_err().contains("allowed: us"));
    }
}
