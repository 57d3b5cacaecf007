//! Whole files that are written together, and wait for the disk together.

use std::io::Write;
use std::path::{Path, PathBuf};

use super::disk::{self, PartFile};
use super::folder::{StoreError, make_folder};

/// Files of one folder, and of folders inside it. The disk takes each while the next is being made. They
/// appear in the order in which they were added, when all are there; each folder is then synced once.
///
/// Files that are given up, as one of them cannot be written, appear nowhere.
pub struct Together {
    folder: PathBuf,
    parts: Vec<(PartFile, PathBuf)>,
}

impl Together {
    /// None yet, for this folder.
    pub fn in_folder(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), parts: Vec::new() }
    }

    /// Adds a file by its name in the folder; a folder inside is made where it is missing.
    ///
    /// # Errors
    /// What the system says, with the file's path.
    pub fn add(&mut self, name: &str, bytes: &[u8]) -> Result<(), StoreError> {
        let path = self.folder.join(name);
        let io = |action| {
            let path = path.clone();
            move |source| StoreError::Io { path, action, source }
        };
        let folder = path.parent().unwrap_or(Path::new(""));
        if folder != self.folder {
            make_folder(folder)?;
        }
        let mut part = PartFile::beside(folder).map_err(io("write beside the file"))?;
        part.write_all(bytes).map_err(io("write"))?;
        part.send_all().map_err(io("sync"))?;
        self.parts.push((part, path));
        Ok(())
    }

    /// Waits for the disk, then gives the files their names; those of a folder are on the disk before the
    /// first of another folder appears.
    ///
    /// # Errors
    /// What the system says, with the path of a file.
    pub fn finish(mut self) -> Result<(), StoreError> {
        let io = |path: &Path, action| {
            let path = path.to_owned();
            move |source| StoreError::Io { path, action, source }
        };
        for (part, path) in &mut self.parts {
            part.sent().map_err(io(path, "sync"))?;
        }
        let mut parts = self.parts.into_iter().peekable();
        while let Some((part, path)) = parts.next() {
            part.rename(&path).map_err(io(&path, "rename"))?;
            let folder = path.parent().unwrap_or(Path::new(""));
            if parts.peek().is_none_or(|(_, next)| next.parent() != Some(folder)) {
                disk::sync_folder(folder).map_err(io(&path, "sync the folder"))?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn files_appear_all_at_the_end_or_not_at_all() {
        let root = tempfile::tempdir().unwrap();
        let add = |files: &mut Together| {
            files.add("inside/one", b"1").unwrap();
            files.add("two", b"22").unwrap();
        };
        let mut files = Together::in_folder(root.path());
        add(&mut files);
        let shown = |name: &str| root.path().join(name).exists();
        assert!(!shown("inside/one") && !shown("two"));
        drop(files);
        assert_eq!(names(root.path()), ["inside"]);
        assert_eq!(names(&root.path().join("inside")), [""; 0]);

        let mut files = Together::in_folder(root.path());
        add(&mut files);
        files.finish().unwrap();
        assert_eq!(std::fs::read(root.path().join("inside/one")).unwrap(), b"1");
        assert_eq!(std::fs::read(root.path().join("two")).unwrap(), b"22");
        assert_eq!(names(root.path()), ["inside", "two"]);
    }

    #[test]
    fn a_name_that_cannot_be_given_leaves_those_after_it_out() {
        let root = tempfile::tempdir().unwrap();
        std::fs::create_dir_all(root.path().join("two/taken")).unwrap();
        let mut files = Together::in_folder(root.path());
        for name in ["one", "two", "three"] {
            files.add(name, b"text").unwrap();
        }
        let error = files.finish().unwrap_err();
        assert!(error.to_string().contains("two: cannot rename"), "{error}");
        assert_eq!(names(root.path()), ["one", "two"]);
    }
}
