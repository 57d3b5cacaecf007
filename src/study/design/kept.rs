//! What a design that is stopped or killed has found: the networks that are done.

use serde::{Deserialize, Serialize};

use super::search::Found;
use crate::run::folder::DESIGN;
use crate::study::kept::KeptKind;

/// How a design keeps it.
pub(super) const KEPT: KeptKind =
    KeptKind { name: "networks", files: DESIGN, study: "design", parts: "networks" };

/// A network that is done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Done {
    /// Row, counted from 0.
    pub row: usize,
    /// Network, counted from 1.
    pub network: u64,
    /// What it says.
    pub found: Found,
}
