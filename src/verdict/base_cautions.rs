//! What a design says of the base itself: the specification warns of the soil as it was sampled, and what the
//! walk says of the same is then not said again.

use crate::outcome::design::{Design, DesignFinding};

/// Of a base that is not stable itself, whichever way it was read.
const UNSTABLE: &str = "unstable_base";

impl Design {
    /// What its specification warns of; nothing without one, and in files of earlier versions.
    pub fn cautions(&self) -> &[DesignFinding] {
        self.specification.as_ref().map_or(&[], |of| &of.findings)
    }

    /// Whether the specification says what a finding of the walk says.
    pub fn is_cautioned(&self, of: &DesignFinding) -> bool {
        of.finding.id == UNSTABLE && self.cautions().iter().any(|said| said.finding.id == UNSTABLE)
    }

    /// The warnings without what the specification says.
    pub fn warnings_beside_cautions(&self) -> Vec<String> {
        let said: Vec<String> =
            self.findings.iter().filter(|of| self.is_cautioned(of)).map(DesignFinding::words).collect();
        self.warnings.iter().filter(|warning| !said.contains(warning)).cloned().collect()
    }
}
