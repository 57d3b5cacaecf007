//! What is said of the base itself, as it was sampled. The specification of a design warns of it, and what
//! the walk says of the same is then not said again.

use crate::gradation::{BROAD_CU, Gradation};
use crate::outcome::design::{Design, DesignFinding};
use crate::outcome::record::Note;

/// That a base, as sampled, is so broad that practice looks at its finer part alone. Where D10 is finer than
/// the finest sieve, its Cu is more than with D10 of that size.
pub(super) fn broad_base(sampled: &Gradation) -> Option<Note> {
    match sampled.cu() {
        Some(cu) => (cu >= BROAD_CU).then_some(Note::BroadBase { cu }),
        None => {
            let least_cu = sampled.d(60.0)? / sampled.smallest_mm();
            (least_cu >= BROAD_CU).then_some(Note::BroadBaseAtLeast { least_cu })
        }
    }
}

impl Design {
    /// What its specification warns of; nothing without one.
    pub fn cautions(&self) -> &[DesignFinding] {
        self.specification.as_ref().map_or(&[], |of| &of.findings)
    }

    /// Whether the specification says what a finding of the walk says.
    pub fn is_cautioned(&self, of: &DesignFinding) -> bool {
        let is_alike = matches!(of.note, Note::UnstableBase { .. } | Note::BroadBase { .. } | Note::BroadBaseAtLeast { .. });
        is_alike && self.cautions().iter().any(|caution| caution.note == of.note)
    }

    /// What was found besides, without what the specification says.
    pub fn findings_beside_cautions(&self) -> Vec<String> {
        let others = self.findings.iter().filter(|found| !self.is_cautioned(found));
        others.map(DesignFinding::words).collect()
    }
}
