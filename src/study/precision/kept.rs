//! What a study of precision that is stopped or killed has found: the tiers that are done. Their numbers
//! follow from seed and budget alone.

use serde::{Deserialize, Serialize};

use crate::outcome::precision::{NetworkRow, Precision};
use crate::run::folder::STUDY;
use crate::study::kept::KeptKind;

/// How the study keeps it.
pub(super) const KEPT: KeptKind =
    KeptKind { name: "study", files: STUDY, study: "precision study", parts: "tiers" };

/// What has been found so far.
#[derive(Default, Serialize, Deserialize)]
pub(super) struct Found {
    /// The record, with the tiers that are done.
    pub precision: Precision,
    /// The networks of the tier of exact answers, at the most particles of each line.
    pub networks: Vec<NetworkRow>,
}
