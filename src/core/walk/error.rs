//! Reasons why a walk ended before its run did.

use crate::network::FlowError;

/// Reason why a walk ended before its run did.
#[derive(Debug, thiserror::Error)]
pub enum WalkError {
    /// Inserted particles are not all accounted for.
    #[error("increment {increment}: {inserted} base particles inserted, but {accounted} accounted for")]
    NotConserved {
        /// The increment.
        increment: u64,
        /// Inserted so far.
        inserted: u64,
        /// Moving, retained, trapped and eroded.
        accounted: u64,
    },
    /// The flow through the network is not known.
    #[error("increment {increment}: {source}")]
    Flow {
        /// The increment.
        increment: u64,
        /// The reason.
        source: FlowError,
    },
    /// The caller asked the run to stop.
    #[error("stopped on request in increment {increment}")]
    Stopped {
        /// The last whole increment.
        increment: u64,
    },
}
