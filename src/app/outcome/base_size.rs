//! D85 of a base, and the base that it belongs to: as sampled or regraded.

use serde::{Deserialize, Serialize};

use super::record::{BaseRecord, Inputs};

/// D85 of a base (mm), of the base as it is walked.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
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

impl BaseRecord {
    /// D85, and the base that it belongs to.
    pub fn size(&self) -> BaseSize {
        BaseSize {
            d85_mm: self.d85_mm,
            regraded_at_mm: self.regraded_at_mm,
            as_sampled_mm: self.as_sampled.as_ref().and_then(|before| before.d85_mm),
        }
    }
}

impl Inputs {
    /// D85 of the base, and the base that it belongs to; `None` where sizes have no unit.
    pub fn base_size(&self) -> Option<BaseSize> {
        (!self.scale_free).then(|| self.base.size())
    }
}
