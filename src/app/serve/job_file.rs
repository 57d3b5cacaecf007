//! Request of a job, kept in its folder: a later server on the same folder begins it again by the same call,
//! and the work itself finds the parts that are done.

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::run::RunError;
use voidwalk_core::store::{Folder, read_regular};

/// The file.
const FILE: &str = "job.json";

/// The largest that is written, and read (bytes).
const LARGEST: u64 = 4 << 20;

/// Request of a job, and its end if it cannot continue.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JobFile {
    /// Its kind, by the name of the request.
    pub kind: String,
    /// Title of its card.
    pub title: String,
    /// The two sheets of its card.
    pub asked: Value,
    /// All that was requested.
    pub request: Value,
    /// `refused` or `failed`, with the message.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ended: Option<(String, String)>,
}

impl JobFile {
    /// Keeps this in the job's folder, which is made if it is missing.
    ///
    /// # Errors
    /// The folder is a link, not the program's own, or at work; the request is too large; or errors of the
    /// system.
    pub fn write(&self, folder: &Path) -> Result<(), RunError> {
        let bytes = self.bytes()?;
        // Its lock marks the folder as the program's own, so that the work may take it.
        Ok(Folder::open(folder)?.write(FILE, &bytes)?)
    }

    /// Reads the file of a job's folder; `None` in other folders.
    pub fn read(folder: &Path) -> Option<Self> {
        let bytes = read_regular(&folder.join(FILE), LARGEST).ok()??;
        serde_json::from_slice(&bytes).ok()
    }

    fn bytes(&self) -> Result<Vec<u8>, RunError> {
        let bytes = serde_json::to_vec_pretty(self)?;
        match bytes.len() as u64 > LARGEST {
            true => Err(RunError::Refused(format!("the request is larger than {} MB", LARGEST >> 20))),
            false => Ok(bytes),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_asked_is_kept_in_a_folder_that_the_work_may_take() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("run-1");
        let mut file = JobFile {
            kind: "judge".into(),
            title: "base on filter".into(),
            asked: serde_json::json!({ "base": "1" }),
            request: serde_json::json!({ "base": "1", "changes": ["a=1"] }),
            ended: None,
        };
        assert_eq!(JobFile::read(&folder), None);
        file.write(&folder).unwrap();
        assert_eq!(JobFile::read(&folder).as_ref(), Some(&file));
        assert!(crate::run::folder::claim(&folder, crate::run::FolderKind::Run, false).is_ok());
        file.ended = Some(("failed".into(), "the disk is full".into()));
        file.write(&folder).unwrap();
        assert_eq!(JobFile::read(&folder).as_ref(), Some(&file));
        file.request = "x".repeat(5 << 20).into();
        assert!(file.write(&root.path().join("run-2")).unwrap_err().to_string().contains("larger than 4 MB"));
        assert!(!root.path().join("run-2").exists());
        std::fs::write(folder.join("job.json"), "{").unwrap();
        assert_eq!(JobFile::read(&folder), None);
    }
}
