//! Why a scene cannot be walked.

use super::packed_filter::{PackedError, PackingPlan};
use crate::scene::SceneError;
use voidwalk_core::constrictions::CurveError;
use voidwalk_core::gradation::{GradationError, NumberError};
use voidwalk_core::network::NetworkError;

/// Why a scene cannot be walked.
#[derive(Debug, thiserror::Error)]
pub enum CaseError {
    /// The scene itself.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A gradation.
    #[error(transparent)]
    Gradation(#[from] GradationError),
    /// A constriction curve.
    #[error(transparent)]
    Curve(#[from] CurveError),
    /// A number worked out from the scene.
    #[error(transparent)]
    Number(#[from] NumberError),
    /// The network.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// The packing.
    #[error(transparent)]
    Packed(#[from] PackedError),
    /// The filter has to be packed first.
    #[error("{file}: the filter has not been packed yet")]
    NotPacked {
        /// The scene.
        file: String,
    },
    /// So few grains that the cell would be no wider than two of the largest.
    #[error("{file}: {problem}")]
    NarrowCell {
        /// The scene.
        file: String,
        /// Description of the problem.
        problem: String,
        /// The plan with enough grains.
        would_do: Box<PackingPlan>,
    },
    /// More memory, or more disk, than there is.
    #[error(
        "{n_base} base particles walked one by one{study} on {voids} voids need {needed} of memory, but \
         {available} are available{disk}; set base.cap or base.n_base lower, or a smaller network"
    )]
    Memory {
        /// Base particles.
        n_base: u64,
        /// The study that asks for them, unless it is the scene itself.
        study: String,
        /// Voids.
        voids: u64,
        /// Bytes needed, in words.
        needed: String,
        /// Bytes available, in words.
        available: String,
        /// State of the disk, in words.
        disk: String,
    },
}
