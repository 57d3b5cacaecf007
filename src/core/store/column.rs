//! One column of a simulation, in memory or in a mapped file.

use std::fs::File;
use std::io;
use std::ops::{Deref, DerefMut};
use std::path::{Path, PathBuf};

use bytemuck::Pod;
use memmap2::{MmapMut, MmapOptions};

use super::disk::{Call, ask};
use super::platform::allocate;

/// Place of the values of columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Placement {
    /// In memory.
    #[default]
    Memory,
    /// In files without a name (if the file system supports such; else their name is removed as soon as they
    /// are made), in this folder, mapped into memory: the system keeps used pages in memory and moves the
    /// rest to the disk. The files vanish with the process.
    Mapped(PathBuf),
}

impl Placement {
    /// Puts the files of this placement in `folder`.
    pub fn within(self, folder: &Path) -> Self {
        match self {
            Self::Memory => Self::Memory,
            Self::Mapped(_) => Self::Mapped(folder.to_owned()),
        }
    }
}

/// A column of plain values that is used as a slice.
///
/// The simulation sees slices only, so that a column is in memory or in a mapped file without a change to any
/// kernel, and with the same bits.
#[derive(Debug)]
pub struct Column<T: Pod> {
    values: Values<T>,
}

#[derive(Debug)]
enum Values<T: Pod> {
    Owned(Vec<T>),
    /// The mapping, and its file: if a file goes with its last handle (Windows), the mapping must go first.
    Mapped(MmapMut, #[allow(dead_code, reason = "is kept open")] File),
}

impl<T: Pod> Column<T> {
    /// Makes a column of `len` zeros. Pages of memory are touched when they are first written; blocks of a
    /// file are allocated here, so that a full disk is an error now and not a crash later (but see
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

/// Maps a file without a name that holds `bytes` zeros, all of its blocks allocated.
///
/// So a full disk is an error here, and no signal (SIGBUS) when a page of the mapping goes to the disk, as
/// long as the file system writes in place, as ext4, XFS, NTFS and tmpfs do. One that copies on write (btrfs,
/// ZFS, bcachefs) may take new blocks for a page that is written again, and one that compresses may have
/// allocated nothing for zeros: if others fill such a disk up while the program runs, the signal can end it,
/// and it continues from its last checkpoint, as after a kill.
fn map_zeros(folder: &Path, bytes: usize) -> io::Result<(MmapMut, File)> {
    ask(Call::Map(folder, bytes as u64), || {
        let file: File = tempfile::tempfile_in(folder)?;
        allocate(&file, bytes as u64)?;
        // SAFETY: the mapped file must not change or be cut by others while it is used as a slice. This
        // process has one handle to the file, which is kept beside the mapping and is used for nothing else.
        // Others have no name by which to open it, or are not allowed to (Windows). Two paths are left, open
        // only to this user's own processes (and root's), and as deliberate as writing into this process by
        // /proc/PID/mem, which no program can rule out: the mapping under /proc/PID/map_files; and, if the
        // file system has no O_TMPFILE, the moment between the making of the file, by a random name and with
        // mode 0600, and the removal of that name. Beyond its end nothing is mapped: `allocate` has made it
        // `bytes` long.
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
