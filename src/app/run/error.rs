//! Reasons for an early end of a command.

use crate::case::{CaseError, PackedError};
use crate::scene::SceneError;
use voidwalk_core::constrictions::{ConstrictionsError, CurveError, TriangulationError};
use voidwalk_core::gradation::GradationError;
use voidwalk_core::network::NetworkError;
use voidwalk_core::packing::{ImportError, PackingError};
use voidwalk_core::store::StoreError;
use voidwalk_core::store::checkpoint::CheckpointError;
use voidwalk_core::walk::WalkError;

/// Reason why a command did not succeed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// The input was refused before any work, and nothing was written.
    Refused,
    /// Stopped on request; progress is saved and the work can be continued.
    Stopped,
    /// The work failed.
    Failed,
    /// The work is done, but the caller does not accept its verdict.
    NotAccepted,
}

impl Exit {
    pub(crate) const fn code(self) -> u8 {
        match self {
            Self::Refused => 2,
            Self::Stopped => 3,
            Self::Failed => 1,
            Self::NotAccepted => 4,
        }
    }
}

/// Error of any kind, to be shown to a user.
pub(crate) type AnyError = Box<dyn std::error::Error + Send + Sync>;

/// Reason for the early end of a command; [`RunError::exit`] distinguishes refused, stopped and failed
/// commands.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// Input that is refused.
    #[error("{0}")]
    Refused(String),
    /// A folder that cannot be claimed.
    #[error(transparent)]
    Claim(StoreError),
    /// A checkpoint from which the work cannot be continued.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// A checkpoint that cannot be written.
    #[error(transparent)]
    Save(StoreError),
    /// A file that cannot be written or read while the work is done.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// Stopped on request.
    #[error("{0}")]
    Stopped(String),
    /// The caller does not accept the verdict.
    #[error("{0}")]
    NotAccepted(String),
    /// The walk failed or was stopped.
    #[error(transparent)]
    Walk(#[from] WalkError),
    /// Grains that cannot be packed.
    #[error(transparent)]
    Packing(#[from] PackingError),
    /// Too little room for the base particles.
    #[error("cannot keep {particles} base particles: {source}")]
    Room {
        /// Base particles that are walked one by one.
        particles: u64,
        /// Error of the system.
        source: std::io::Error,
    },
    /// Results that cannot be formatted.
    #[error("cannot write {file}: {source}")]
    Format {
        /// The file.
        file: &'static str,
        /// Cause of the problem.
        source: AnyError,
    },
    /// The caller's work on finished results failed.
    #[error("{0}")]
    Results(AnyError),
    /// Anything else that failed.
    #[error("{0}")]
    Failed(AnyError),
}

impl RunError {
    /// A refusal with this message.
    pub fn refused(problem: impl std::fmt::Display) -> Self {
        Self::Refused(problem.to_string())
    }

    /// A failure with this message.
    pub fn failed(problem: impl Into<AnyError>) -> Self {
        Self::Failed(problem.into())
    }

    /// A thread that the system does not start.
    pub(crate) fn no_thread(problem: impl std::fmt::Display) -> Self {
        let limits = "allow more memory or processes (ulimit -v, ulimit -u), or fewer --threads";
        Self::failed(format!("no thread can be started: {problem}; {limits}"))
    }

    /// Kind of early end: refused, stopped, failed or not accepted.
    pub fn exit(&self) -> Exit {
        let refused_if = |refused| if refused { Exit::Refused } else { Exit::Failed };
        match self {
            Self::Refused(_) => Exit::Refused,
            Self::Claim(error) => refused_if(error.is_refusal()),
            Self::Checkpoint(error) => refused_if(!error.is_unreadable()),
            Self::Stopped(_) | Self::Walk(WalkError::Stopped { .. }) => Exit::Stopped,
            Self::NotAccepted(_) => Exit::NotAccepted,
            // The request for a packing is checked before its first step.
            Self::Packing(error) => refused_if(matches!(
                error,
                PackingError::Setting { .. }
                    | PackingError::NarrowCell { .. }
                    | PackingError::Placement { .. }
            )),
            _ => Exit::Failed,
        }
    }

    /// Advice on a full or failing disk: which work is kept, and the next step.
    pub fn advice(&self) -> Option<&'static str> {
        use std::io::ErrorKind::{
            FileTooLarge, InvalidFilename, NotADirectory, PermissionDenied, QuotaExceeded,
            ReadOnlyFilesystem, StorageFull,
        };
        let mut error: &(dyn std::error::Error + 'static) = match self {
            Self::Claim(error) | Self::Save(error) | Self::Store(error) => error,
            Self::Room { source, .. } => source,
            Self::Results(error) => &**error,
            _ => return None,
        };
        let kind = loop {
            if let Some(StoreError::Io { action: "read" | "read the folder", .. }) = error.downcast_ref() {
                return None;
            }
            match error.downcast_ref::<std::io::Error>() {
                Some(error) => break error.kind(),
                None => error = error.source()?,
            }
        };
        Some(match kind {
            StorageFull | QuotaExceeded => {
                "files in its folder under their own names are whole and kept; make room on that disk, then \
                 `voidwalk resume FOLDER` continues a run, and the same command any other work"
            }
            FileTooLarge => {
                "a larger file than is allowed here (ulimit -f); files in its folder under their own names \
                 are whole and kept; allow larger files, then `voidwalk resume FOLDER` continues a run, and \
                 the same command any other work"
            }
            PermissionDenied | ReadOnlyFilesystem => {
                "nothing may be written there; name a folder of your own by --out, or ask for \
                 permission"
            }
            InvalidFilename => {
                "name another folder by --out: this name is too long, or has a character that is not \
                 allowed there"
            }
            NotADirectory => "a part of that path is a file; name another folder by --out",
            _ => return None,
        })
    }

    /// True if a retry may soon succeed, because another process was replacing the same files.
    pub(crate) fn is_of_files(&self) -> bool {
        matches!(self, Self::Store(_) | Self::Claim(_) | Self::Format { .. } | Self::Results(_))
    }
}

impl From<PackedError> for RunError {
    fn from(error: PackedError) -> Self {
        match error {
            PackedError::Read(error) => Self::Claim(error),
            other => Self::refused(other),
        }
    }
}

/// Errors that end a command in this way.
macro_rules! errors {
    ($ending:ident: $($error:ty),*) => {
        $(impl From<$error> for RunError {
            fn from(error: $error) -> Self {
                Self::$ending(error)
            }
        })*
    };
}

errors!(refused: SceneError, CaseError, ImportError);
// No accepted input causes these.
errors!(
    failed: ConstrictionsError,
    CurveError,
    GradationError,
    NetworkError,
    TriangulationError,
    csv::Error,
    serde_json::Error
);
errors!(no_thread: rayon::ThreadPoolBuildError);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_end_of_a_command_has_its_code() {
        let codes = [
            (RunError::refused("no"), 2),
            (RunError::Stopped("later".into()), 3),
            (RunError::Walk(WalkError::Stopped { increment: 3 }), 3),
            (RunError::failed("broken"), 1),
            (RunError::Store(held()), 1),
            (RunError::Claim(held()), 2),
            (RunError::Packing(PackingError::Stopped(1)), 1),
        ];
        for (error, code) in codes {
            assert_eq!(error.exit().code(), code, "{error:?}");
        }
    }

    #[test]
    fn a_disk_that_is_full_or_closed_has_a_way_out() {
        let io = |kind: std::io::ErrorKind, action| StoreError::Io {
            path: "x/y".into(),
            action,
            source: kind.into(),
        };
        use std::io::ErrorKind::{FileTooLarge, NotFound, PermissionDenied, StorageFull};
        let advice = |error: RunError| error.advice().unwrap_or_default();
        assert!(advice(RunError::Store(io(StorageFull, "write"))).contains("make room"));
        assert!(advice(RunError::Save(io(FileTooLarge, "write"))).contains("ulimit"));
        assert!(advice(RunError::Results(io(StorageFull, "write").into())).contains("make room"));
        assert!(advice(RunError::Claim(io(PermissionDenied, "make the folder"))).contains("--out"));
        for other in [io(PermissionDenied, "read"), io(NotFound, "write")] {
            assert_eq!(RunError::Store(other).advice(), None);
        }
        assert_eq!(RunError::refused("no").advice(), None);
    }

    fn held() -> StoreError {
        StoreError::Held { path: "x".into(), holder: "process 1".into() }
    }
}
