//! Reasons why a scene cannot be walked.

use super::packed_filter::{PackedError, PackingPlan};
use crate::scene::SceneError;
use voidwalk_core::constrictions::CurveError;
use voidwalk_core::gradation::{GradationError, NumberError};
use voidwalk_core::network::NetworkError;

/// Reason why a scene cannot be walked.
#[derive(Debug, thiserror::Error)]
pub enum CaseError {
    /// The scene is refused.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A gradation is invalid.
    #[error(transparent)]
    Gradation(#[from] GradationError),
    /// A constriction curve is invalid.
    #[error(transparent)]
    Curve(#[from] CurveError),
    /// A number derived from the scene is out of range.
    #[error(transparent)]
    Number(#[from] NumberError),
    /// The network is invalid.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// The packing cannot be used.
    #[error(transparent)]
    Packed(#[from] PackedError),
    /// The filter must be packed first.
    #[error("{file}: the filter has not been packed yet")]
    NotPacked {
        /// Name of the scene.
        file: String,
    },
    /// There are so few grains that the cell would be no wider than two of the largest.
    #[error("{file}: {problem}")]
    NarrowCell {
        /// Name of the scene.
        file: String,
        /// Description of the problem.
        problem: String,
        /// Plan with enough grains.
        would_do: Box<PackingPlan>,
    },
    /// More memory or disk is needed than is available.
    #[error(
        "{n_base} base particles walked one by one{study} on {voids} voids need {needed} of memory, but \
         {available} are available{disk}; set base.cap or base.n_base lower, or a smaller network"
    )]
    Memory {
        /// Number of base particles.
        n_base: u64,
        /// Study that requires them; empty for the scene itself.
        study: String,
        /// Number of voids.
        voids: u64,
        /// Bytes needed, in words.
        needed: String,
        /// Bytes available, in words.
        available: String,
        /// State of the disk, in words.
        disk: String,
    },
}
