//! One column of a simulation, in memory or in a mapped file.

use std::fs::File;
use std::io;
use std::ops::{Deref, DerefMut};
use std::path::{Path, PathBuf};

use bytemuck::Pod;
use memmap2::{MmapMut, MmapOptions};

use super::disk::{Call, ask};
use super::platform::allocate;

/// Storage of columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Placement {
    /// In memory.
    #[default]
    Memory,
    /// In files in this folder, mapped into memory. The files have no name (if the file system does not
    /// support that, the name is removed at once), and vanish with the process. The system keeps used
    /// pages in memory and moves the rest to the disk.
    Mapped(PathBuf),
}

impl Placement {
    /// Places the files in `folder`.
    pub fn within(self, folder: &Path) -> Self {
        match self {
            Self::Memory => Self::Memory,
            Self::Mapped(_) => Self::Mapped(folder.to_owned()),
        }
    }
}

/// A column of plain values, used as a slice.
///
/// The simulation sees only slices: kernels and results are the same for a column in memory and one in a
/// mapped file.
#[derive(Debug)]
pub struct Column<T: Pod> {
    values: Values<T>,
}

#[derive(Debug)]
enum Values<T: Pod> {
    Owned(Vec<T>),
    /// The mapping, dropped before its file: on Windows a file may be deleted with its last handle.
    Mapped(MmapMut, #[allow(dead_code, reason = "is kept open")] File),
}

impl<T: Pod> Column<T> {
    /// Makes a column of `len` zeros. Memory pages are touched when first written; the blocks of a file
    /// are allocated here, so that a full disk is an error now and not a crash later (but see
    /// `map_zeros` for file systems that copy on write).
    ///
    /// # Errors
    /// The file cannot be made, allocated or mapped.
    pub fn zeroed(len: usize, placement: &Placement) -> io::Result<Self> {
        let values = match placement {
            Placement::Mapped(folder) if len > 0 => {
                let bytes = len.checked_mul(size_of::<T>()).ok_or(io::ErrorKind::FileTooLarge)?;
                let (map, file) = map_zeros(folder, bytes)?;
                Values::Mapped(map, file)
            }
            _ => Values::Owned(
                bytemuck::allocation::try_zeroed_vec(len).map_err(|()| io::ErrorKind::OutOfMemory)?,
            ),
        };
        Ok(Self { values })
    }
}

/// Maps a nameless file of `bytes` zeros, with all of its blocks allocated.
///
/// So a full disk is an error here, not a signal (SIGBUS) when a page is written to the disk, if the
/// file system writes in place, as ext4, XFS, NTFS and tmpfs do. One that copies on write (btrfs, ZFS,
/// bcachefs) may take new blocks for a rewritten page, and one that compresses may allocate nothing for
/// zeros: if others fill such a disk while the program runs, the signal can end it, and it continues
/// from its last checkpoint, as after a kill.
fn map_zeros(folder: &Path, bytes: usize) -> io::Result<(MmapMut, File)> {
    ask(Call::Map(folder, bytes as u64), || {
        let file: File = tempfile::tempfile_in(folder)?;
        allocate(&file, bytes as u64)?;
        // SAFETY: others must not change or truncate the mapped file while it is used as a slice. This
        // process has one handle to the file, kept beside the mapping and used for nothing else. Other
        // processes have no name by which to open it, or are not allowed to (Windows). Two ways remain,
        // open only to this user's processes (and root's), and as deliberate as writing into this
        // process through /proc/PID/mem, which no program can prevent: the mapping under
        // /proc/PID/map_files; and, if the file system has no O_TMPFILE, the moment between the creation
        // of the file, with a random name and mode 0600, and the removal of that name. Nothing is mapped
        // beyond its end: `allocate` has made it `bytes` long.
        let map = unsafe { MmapOptions::new().len(bytes).map_mut(&file) }?;
        Ok((map, file))
    })
}

impl<T: Pod> Deref for Column<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        match &self.values {
            Values::Owned(values) => values,
            // A mapping begins on a page, so it is aligned, and its length is a whole number of values.
            Values::Mapped(map, _) => bytemuck::cast_slice(map),
        }
    }
}

impl<T: Pod> DerefMut for Column<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        match &mut self.values {
            Values::Owned(values) => values,
            Values::Mapped(map, _) => bytemuck::cast_slice_mut(map),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_slices_wherever_they_live() {
        let folder = tempfile::tempdir().unwrap();
        let mut placements = vec![Placement::Memory];
        // Miri maps no files.
        if !cfg!(miri) {
            placements.push(Placement::Mapped(folder.path().to_owned()));
        }
        for placement in placements {
            let mut column = Column::<u32>::zeroed(10_001, &placement).unwrap();
            assert!(column.len() == 10_001 && column.iter().all(|&v| v == 0));
            column[10_000] = 7;
            assert_eq!(column[9_999..], [0, 7]);
            assert_eq!(Column::<f32>::zeroed(0, &placement).unwrap().len(), 0);
        }
        // The mapped file has no name.
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    #[cfg_attr(miri, ignore = "Miri maps no files")]
    fn a_folder_or_disk_that_cannot_hold_it_is_an_error() {
        let missing = Placement::Mapped("/no/such/folder".into());
        assert!(Column::<u32>::zeroed(1, &missing).is_err());
        let folder = tempfile::tempdir().unwrap();
        let placement = Placement::Mapped(folder.path().to_owned());
        assert!(Column::<u32>::zeroed(1 << 58, &placement).is_err());
    }
}
