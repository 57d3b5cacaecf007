//! The sieves at which a specification states its limits.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use voidwalk_core::gradation::FINES_MM;
use voidwalk_sheets::us_sieve;

/// A series of sieves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum SieveSeries {
    /// Sieves of the United States (ASTM E11), by inches and numbers.
    #[default]
    Us,
    /// Sieves in millimetres, each half of the one before; above them 75 mm, beyond which no side goes, and
    /// below them 0.075 mm, at which fines are limited.
    Iso,
}

const US: [f64; 14] = [75.0, 50.0, 37.5, 25.0, 19.0, 12.5, 9.5, 4.75, 2.36, 1.18, 0.6, 0.3, 0.15, FINES_MM];

const ISO: [f64; 12] = [75.0, 63.0, 31.5, 16.0, 8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.125, FINES_MM];

impl SieveSeries {
    /// Openings of the sieves (mm), the coarsest first.
    pub fn openings(self) -> &'static [f64] {
        match self {
            Self::Us => &US,
            Self::Iso => &ISO,
        }
    }

    /// Name of the sieve with this opening (mm).
    pub fn name(self, opening_mm: f64) -> String {
        let in_mm = || format!("{opening_mm} mm");
        match self {
            Self::Us => us_sieve(opening_mm).unwrap_or_else(in_mm),
            Self::Iso => in_mm(),
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
            let openings = series.openings();
            assert!(openings.windows(2).all(|pair| pair[0] > pair[1]), "{series}");
            assert_eq!(*openings.last().unwrap(), voidwalk_core::gradation::FINES_MM);
            assert_eq!(series.to_string().parse::<SieveSeries>(), Ok(series));
        }
        let names =
            |series: SieveSeries| series.openings().iter().map(|mm| series.name(*mm)).collect::<Vec<_>>();
        assert_eq!(names(SieveSeries::Us)[..3], ["3 in", "2 in", "1 1/2 in"]);
        assert!(names(SieveSeries::Us).iter().all(|name| !name.ends_with("mm")));
        assert_eq!(names(SieveSeries::Iso)[10..], ["0.125 mm", "0.075 mm"]);
        assert!("bs".parse::<SieveSeries>().unwrap_err().contains("allowed: us"));
    }
}
