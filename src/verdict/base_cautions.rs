//! What is said of the base itself, as it was sampled. The specification of a design warns of it, and what
//! the walk says of the same is then not said again.

use super::entry::{BROAD_BASE, Finding};
use super::finding;
use crate::gradation::{BROAD_CU, Gradation};
use crate::outcome::design::{Design, DesignFinding};
use crate::outcome::numbers::{rounded_down, significant};

/// What is said alike of the soil as it was sampled and of the walk: that it is not stable itself, and that
/// it is broadly graded.
const ALIKE: [&str; 2] = ["unstable_base", BROAD_BASE];

/// That a base, as sampled, is so broad that practice looks at its finer part alone. Where D10 is finer than
/// the finest sieve, its Cu is more than with D10 of that size.
pub(super) fn broad_base(sampled: &Gradation) -> Option<Finding> {
    let cu = match sampled.cu() {
        Some(cu) => (cu >= BROAD_CU).then(|| significant(cu))?,
        None => {
            let least = sampled.d(60.0)? / sampled.smallest_mm();
            (least >= BROAD_CU).then(|| format!("more than {}", rounded_down(least)))?
        }
    };
    Some(finding::broad_base(&cu))
}

impl Design {
    /// What its specification warns of; nothing without one.
    pub fn cautions(&self) -> &[DesignFinding] {
        self.specification.as_ref().map_or(&[], |of| &of.findings)
    }

    /// Whether the specification says what a finding of the walk says.
    pub fn is_cautioned(&self, of: &DesignFinding) -> bool {
        let id = of.finding.id.as_str();
        ALIKE.contains(&id) && self.cautions().iter().any(|said| said.finding.id == id)
    }

    /// What was found besides, without what the specification says.
    pub fn findings_beside_cautions(&self) -> Vec<String> {
        let others = self.findings.iter().filter(|found| !self.is_cautioned(found));
        others.map(DesignFinding::words).collect()
    }
}
