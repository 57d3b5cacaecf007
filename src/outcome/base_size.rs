//! D85 of a base, and which base it is of: every face says both in the same words.

use serde::{Deserialize, Serialize};

use super::numbers::SizeUnit;
use super::record::{BaseRecord, Inputs};
use crate::gradation::us_sieve;

/// D85 of a base (mm), of the base as it is walked.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct BaseSize {
    /// 85 % finer by mass.
    pub d85_mm: f64,
    /// The size that it was regraded on; `None` where it is as it was sampled.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub regraded_at_mm: Option<f64>,
    /// D85 before regrading, where it was regraded and a sieve tells it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub as_sampled_mm: Option<f64>,
}

impl BaseSize {
    /// Whether it is regraded, and on what.
    pub fn grading(&self) -> String {
        self.regraded_at_mm.map_or_else(|| "as sampled".into(), |at| format!("regraded on {} mm", three(at)))
    }

    /// All of it, as `D85B 1.80 mm, regraded on 4.75 mm (as sampled 12.8 mm)`.
    pub fn words(&self) -> String {
        self.words_in(SizeUnit::Mm)
    }

    /// The same, with inches behind each D85 and the name of a US sieve where those are shown.
    pub fn words_in(&self, unit: SizeUnit) -> String {
        let size = |mm: f64| format!("{} mm{}", three(mm), unit.beside(mm));
        let before = self.as_sampled_mm.filter(|_| self.regraded_at_mm.is_some());
        let before = before.map_or(String::new(), |d85| format!(" (as sampled {})", size(d85)));
        let comma = if self.regraded_at_mm.is_some() { "," } else { "" };
        let sieve = self.regraded_at_mm.filter(|_| unit == SizeUnit::MmAndInches);
        let grading = match sieve.and_then(|at| Some((us_sieve(at)?, at))) {
            Some((name, at)) => format!("regraded on {name}, {} mm", three(at)),
            None => self.grading(),
        };
        format!("D85B {}{comma} {grading}{before}", size(self.d85_mm))
    }
}

impl BaseRecord {
    /// D85, and which base it is of.
    pub fn size(&self) -> BaseSize {
        BaseSize {
            d85_mm: self.d85_mm,
            regraded_at_mm: self.regraded_at_mm,
            as_sampled_mm: self.as_sampled.as_ref().and_then(|before| before.d85_mm),
        }
    }
}

impl Inputs {
    /// D85 of the base, and which base it is of; `None` where sizes have no unit.
    pub fn base_size(&self) -> Option<BaseSize> {
        (!self.scale_free).then(|| self.base.size())
    }
}

/// Three digits that mean something.
pub fn three(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let decimals = (2 - value.abs().log10().floor() as i32).clamp(0, 6);
    format!("{value:.*}", decimals as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_d85_says_which_base_it_is_of() {
        let till = BaseSize { d85_mm: 1.8, regraded_at_mm: Some(4.75), as_sampled_mm: Some(12.8) };
        assert_eq!(till.words(), "D85B 1.80 mm, regraded on 4.75 mm (as sampled 12.8 mm)");
        let us = till.words_in(SizeUnit::MmAndInches);
        assert_eq!(
            us,
            "D85B 1.80 mm (0.0709\u{202f}in), regraded on No. 4, 4.75 mm (as sampled 12.8 mm \
             (0.504\u{202f}in))"
        );
        let sand = BaseSize { d85_mm: 0.4123, regraded_at_mm: None, as_sampled_mm: None };
        assert_eq!(sand.words(), "D85B 0.412 mm as sampled");
        let open = BaseSize { as_sampled_mm: None, ..till };
        assert_eq!(open.words(), "D85B 1.80 mm, regraded on 4.75 mm");
    }
}
