//! Checkpoints: columns in a file that is either read whole or refused.
//!
//! # Format 1
//! A file holds, in this order (numbers are little-endian, as on every machine that voidwalk is built for):
//!
//! | bytes | field | meaning |
//! |---|---|---|
//! | 8 | `magic` | `vwcheckp` |
//! | 4 | `version` | version of this format: 1; another is refused |
//! | 4 | `byte_order` | 0x0a0b0c0d, read reversed on a machine of the other byte order |
//! | 8 | `header_length` | bytes of the header, its checksum included |
//! | 8 | `file_length` | bytes of the file |
//! | 32 | `scene` | fingerprint of the scene (of a packing: of its plan), as text |
//! | 8 | `part` | 0: a walk of the scene itself; from 1: a walk of the sensitivity study |
//! | 8 | `replicate` | replicate, counted from 1 |
//! | 8 | `seed` | seed of the replicate |
//! | 8 | `n_base` | base particles per run |
//! | 8 | `network` | fingerprint of the network; 0 for a finished replicate or a packing |
//! | 8 | `run` | current run, counted from 1; 0 for a finished replicate or a packing |
//! | 8 | `increment` | last completed increment |
//! | 8 | `generation` | number of the checkpoint under its name, counted from 1 |
//! | 8 | `sections` | number of sections, at most 64 |
//! | 24 | `program` | version of the program, as text |
//! | 56 each | | one row per section, as below |
//! | 8 each | | XXH3-64 of every piece of 1 MiB of each section, in order |
//! | 8 | | XXH3-64 of everything before it: the end of the header |
//! | | | zeros up to a multiple of 4096, then the sections, each at a multiple of 64, zeros between |
//!
//! A row of the table: `name` (32 bytes, text), `element` (4, bytes of an element), zero (4), `count` (8,
//! elements), `offset` (8, of its first byte in the file).
//!
//! Text is UTF-8 padded with zeros. A packing leaves `part`, `replicate` and `n_base` 0. The checksums
//! detect accidents, not forgery.
//!
//! A section is a column of numbers, or a record with named fields as JSON text that restores every
//! floating-point number bit for bit. The sections:
//!
//! | checkpoint of | sections |
//! |---|---|
//! | a run under way | `done`, and those that `walk::SavedState` names |
//! | a finished replicate | `done`: a record of its results and rows, `run::checkpoints::Done` |
//! | a study | `found`: a record of its finished networks or lattices |
//! | a packing | `state`, see `packing::Compression::to_bytes`, and `seconds` (f64), spent so far |
//!
//! # Slots
//! A checkpoint named `x` is stored in `x.0` or `x.1`, whichever is older, and is written whole before
//! it gets its name. The previous one remains until the next is on the disk, and is used if the next is
//! corrupt. A checkpoint that the system fails to read may be intact: no other is used in its place, and
//! the program ends with an error instead.
//!
//! # Read, not mapped
//! A checkpoint is read piece by piece into the columns; each piece is checked before use. It is not
//! mapped: a mapped file that is truncated ends the process (SIGBUS), and a mapped page can change after
//! its checksum was verified. The cost is one copy in memory; `results/faults.md` gives the time of a
//! whole resume in seconds.

mod header;

pub use header::{CheckpointError, Identity, Label, Section};

use header::{Entry, PIECE};

use crate::store::disk::{Call, ask, open_own};
use crate::store::whole::write_whole_with;
use crate::store::{StoreError, platform};
use bytemuck::Pod;
use serde::de::DeserializeOwned;
use std::cmp::Reverse;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use xxhash_rust::xxh3::xxh3_64;

/// A checkpoint whose header has been checked; its sections are checked as they are read.
#[derive(Debug)]
pub struct Checkpoint {
    /// Subject of the checkpoint.
    pub label: Label,
    path: PathBuf,
    source: Source,
    sections: Vec<Entry>,
    /// Offset and length of the gaps between the sections, all zeros.
    gaps: Vec<(u64, usize)>,
}

#[derive(Debug)]
enum Source {
    File(File),
    Memory(Vec<u8>),
}

impl Source {
    fn read_at(&self, offset: u64, bytes: &mut [u8]) -> io::Result<()> {
        match self {
            Self::File(file) => platform::read_exact_at(file, bytes, offset),
            Self::Memory(content) => {
                let begin = usize::try_from(offset).ok();
                let part = begin.and_then(|begin| content.get(begin..begin.checked_add(bytes.len())?));
                bytes.copy_from_slice(part.ok_or(io::ErrorKind::UnexpectedEof)?);
                Ok(())
            }
        }
    }
}

impl Checkpoint {
    /// Opens a checkpoint and checks its header; `None` if there is no such file.
    ///
    /// # Errors
    /// A file that is truncated, corrupt, of another version or not a checkpoint.
    pub fn open(path: &Path) -> Result<Option<Self>, CheckpointError> {
        let unreadable = |source| CheckpointError::from_io(path, source);
        let is_file = match path.symlink_metadata() {
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(e) => return Err(unreadable(e)),
            Ok(meta) => meta.is_file(),
        };
        if !is_file {
            return Err(CheckpointError::corrupt(path, "is not a regular file"));
        }
        let mut file = ask(Call::Read(path), || open_own(path)).map_err(unreadable)?;
        let length = file.metadata().map_err(unreadable)?.len();
        let header = header::read(path, &mut file, length)?;
        Self::with_header(path, header, length, Source::File(file)).map(Some)
    }

    /// Parses the content of a file like [`Checkpoint::open`]; `name` is used in messages.
    pub fn parse(name: &str, content: Vec<u8>) -> Result<Self, CheckpointError> {
        let (path, length) = (Path::new(name), content.len() as u64);
        let header = header::read(path, &mut content.as_slice(), length)?;
        Self::with_header(path, header, length, Source::Memory(content))
    }

    fn with_header(
        path: &Path,
        (label, sections, header): (Label, Vec<Entry>, u64),
        length: u64,
        source: Source,
    ) -> Result<Self, CheckpointError> {
        let apart = || CheckpointError::corrupt(path, "its sections do not follow one another");
        let gaps = gaps(&sections, header, length).ok_or_else(apart)?;
        Ok(Self { label, path: path.to_owned(), source, sections, gaps })
    }

    /// Makes the error for wrong content whose checksums are right.
    pub fn corrupt(&self, problem: impl Into<String>) -> CheckpointError {
        CheckpointError::corrupt(&self.path, problem)
    }

    /// Makes the error for another network.
    pub fn of_another_network(&self) -> CheckpointError {
        self.other("is of another network".into())
    }

    /// Makes the error for another walk of the same scene.
    pub(crate) fn of_another_walk(&self, walk: &str, expected: &str) -> CheckpointError {
        self.other(format!("is of another walk of this scene: {walk}; expected: {expected}"))
    }

    fn other(&self, problem: String) -> CheckpointError {
        CheckpointError::Other { file: self.path.clone(), problem }
    }

    /// Checks that the checkpoint has the expected subject.
    fn expect(&self, expected: &Identity) -> Result<(), CheckpointError> {
        let identity = &self.label.identity;
        if identity.scene != expected.scene {
            return Err(self.other("is of another scene, or of another version of voidwalk".into()));
        }
        if identity != expected {
            return Err(self.of_another_walk(&identity.to_string(), &expected.to_string()));
        }
        Ok(())
    }

    /// Returns the number of elements of a section.
    ///
    /// # Errors
    /// No such section, or elements of another size.
    pub(crate) fn count<T: Pod>(&self, name: &str) -> Result<usize, CheckpointError> {
        self.entry::<T>(name).map(|entry| entry.count as usize)
    }

    fn entry<T: Pod>(&self, name: &str) -> Result<&Entry, CheckpointError> {
        let entry = self.sections.iter().find(|entry| entry.name == name);
        let entry = entry.ok_or_else(|| self.corrupt(format!("has no section {name}")))?;
        if entry.element != size_of::<T>() as u64 {
            return Err(self.corrupt(format!("section {name} has elements of {} bytes", entry.element)));
        }
        Ok(entry)
    }

    /// Reads a whole section.
    ///
    /// # Errors
    /// Errors of `Checkpoint::count`; a piece whose checksum is wrong.
    pub fn read<T: Pod>(&self, name: &str) -> Result<Vec<T>, CheckpointError> {
        // The allocation is bounded by the length in the header, which equals the file's.
        let mut all = Vec::with_capacity(self.count::<T>(name)?);
        self.read_pieces::<T>(name, |piece| all.extend_from_slice(piece))?;
        Ok(all)
    }

    /// Reads a whole section of `count` elements.
    ///
    /// # Errors
    /// Errors of [`Checkpoint::read`]; another number of elements.
    pub(crate) fn read_exact<T: Pod>(&self, name: &str, count: usize) -> Result<Vec<T>, CheckpointError> {
        let elements = self.count::<T>(name)?;
        if elements != count {
            return Err(self.corrupt(format!("section {name} has {elements} elements, not {count}")));
        }
        self.read(name)
    }

    /// Reads a section that is a record with named fields.
    ///
    /// # Errors
    /// Errors of [`Checkpoint::read`]; a field that is missing, unknown or of another type.
    pub fn read_record<T: DeserializeOwned>(&self, name: &str) -> Result<T, CheckpointError> {
        let text = self.read::<u8>(name)?;
        serde_json::from_slice(&text).map_err(|e| self.corrupt(format!("section {name}: {e}")))
    }

    /// Reads a section piece by piece; each is checked before it is passed on.
    pub(crate) fn read_pieces<T: Pod>(
        &self,
        name: &str,
        mut take: impl FnMut(&[T]),
    ) -> Result<(), CheckpointError> {
        let entry = self.entry::<T>(name)?;
        let size = (entry.count * entry.element) as usize;
        let mut words: Vec<T> = vec![T::zeroed(); PIECE.min(size).div_ceil(size_of::<T>())];
        for piece in 0..entry.sums.len() {
            let now = PIECE.min(size - piece * PIECE);
            self.read_piece(entry, piece, &mut bytemuck::cast_slice_mut(&mut words)[..now])?;
            take(&words[..now / size_of::<T>()]);
        }
        Ok(())
    }

    /// Fills `bytes` with piece `piece` of a section, and checks it.
    fn read_piece(&self, entry: &Entry, piece: usize, bytes: &mut [u8]) -> Result<(), CheckpointError> {
        self.read_at(entry.offset + (piece * PIECE) as u64, bytes)?;
        if xxh3_64(bytes) != entry.sums[piece] {
            let name = &entry.name;
            return Err(self.corrupt(format!("section {name}, piece {piece}: its checksum is wrong")));
        }
        Ok(())
    }

    fn read_at(&self, offset: u64, bytes: &mut [u8]) -> Result<(), CheckpointError> {
        let read = ask(Call::Read(&self.path), || self.source.read_at(offset, bytes));
        read.map_err(|source| CheckpointError::from_io(&self.path, source))
    }

    /// Reads and checks every piece of every section, and the gaps between them, in file order.
    ///
    /// # Errors
    /// The first problem found.
    pub fn check(&self) -> Result<(), CheckpointError> {
        let longest = self.sections.iter().map(|entry| entry.count * entry.element).max().unwrap_or(0);
        let mut bytes = vec![0; PIECE.min(longest.max(4096) as usize)];
        for &(offset, length) in &self.gaps {
            self.read_at(offset, &mut bytes[..length])?;
            if bytes[..length].iter().any(|&byte| byte != 0) {
                return Err(self.corrupt(format!("is not zero between its sections, near byte {offset}")));
            }
        }
        for entry in &self.sections {
            let size = (entry.count * entry.element) as usize;
            for piece in 0..entry.sums.len() {
                self.read_piece(entry, piece, &mut bytes[..PIECE.min(size - piece * PIECE)])?;
            }
        }
        Ok(())
    }
}

/// Finds the gaps between the header and the sections; `None` if these do not follow one another to the end
/// of the file.
fn gaps(sections: &[Entry], header: u64, length: u64) -> Option<Vec<(u64, usize)>> {
    let mut spans: Vec<(u64, u64)> = sections.iter().map(|e| (e.offset, e.count * e.element)).collect();
    spans.sort_unstable();
    spans.push((length, 0));
    let (mut at, mut gaps) = (header, Vec::new());
    for (offset, size) in spans {
        match offset.checked_sub(at) {
            Some(gap) if gap < 4096 => gaps.push((at, gap as usize)),
            _ => return None,
        }
        at = offset + size;
    }
    gaps.retain(|&(_, gap)| gap > 0);
    Some(gaps)
}

/// Finds the newest intact checkpoint of this name and the expected subject, and the errors of newer ones.
///
/// # Errors
/// Checkpoints of this name exist, none intact and of the expected subject; or the system fails to read one.
pub fn newest(
    folder: &Path,
    name: &str,
    expected: &Identity,
) -> Result<(Option<Checkpoint>, Vec<CheckpointError>), CheckpointError> {
    let mut refused = Vec::new();
    let mut candidates = Vec::new();
    let open = |parity| match Checkpoint::open(&slot(folder, name, parity))? {
        None => Ok(None),
        Some(checkpoint) => checkpoint.expect(expected).map(|()| Some(checkpoint)),
    };
    for parity in 0..2 {
        match open(parity) {
            Ok(checkpoint) => candidates.extend(checkpoint),
            Err(error) if error.is_unreadable() => return Err(error),
            Err(error) => refused.push(error),
        }
    }
    candidates.sort_by_key(|checkpoint| Reverse(checkpoint.label.generation));
    for checkpoint in candidates {
        match checkpoint.check() {
            Ok(()) => return Ok((Some(checkpoint), refused)),
            Err(error) if error.is_unreadable() => return Err(error),
            Err(error) => refused.push(error),
        }
    }
    match refused.pop() {
        Some(error) => Err(error),
        None => Ok((None, refused)),
    }
}

/// Path of the checkpoint of a generation.
fn slot(folder: &Path, name: &str, generation: u64) -> PathBuf {
    folder.join(format!("{name}.{}", generation % 2))
}

/// Saves a checkpoint in the slot of its generation.
///
/// # Errors
/// An error of the system; the other slot and the former content of this one are then unchanged.
pub fn save(folder: &Path, name: &str, label: &Label, sections: &[Section]) -> Result<(), StoreError> {
    let header = header::encode(label, sections);
    write_whole_with(&slot(folder, name, label.generation), |file| {
        file.write_all(&header)?;
        let mut at = header.len() as u64;
        for section in sections {
            let gap = at.next_multiple_of(64) - at;
            file.write_all(&[0; 64][..gap as usize])?;
            for part in &section.parts {
                file.write_all(part)?;
            }
            at += gap + section.bytes();
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identity() -> Identity {
        Identity { scene: "s".repeat(32), part: 3, replicate: 2, seed: 1, n_base: u64::MAX }
    }

    fn label(generation: u64) -> Label {
        Label { identity: identity(), network: 7, run: 1, increment: 9, generation }
    }

    fn saved(folder: &Path, generation: u64) -> (Vec<u32>, Vec<u64>) {
        let numbers: Vec<u32> = (0..1000).map(|i| i * generation as u32).collect();
        let words = vec![generation; 3];
        let (a, b) = numbers.split_at(400);
        save(
            folder,
            "x",
            &label(generation),
            &[Section::parts("numbers", [a, b]), Section::new("words", &words)],
        )
        .unwrap();
        (numbers, words)
    }

    #[test]
    fn what_is_kept_comes_back_and_the_newest_is_taken() {
        let root = tempfile::tempdir().unwrap();
        for generation in 1..=3 {
            let (numbers, words) = saved(root.path(), generation);
            let (checkpoint, refused) = newest(root.path(), "x", &identity()).unwrap();
            let checkpoint = checkpoint.unwrap();
            assert!(refused.is_empty());
            assert_eq!(checkpoint.label, label(generation));
            assert_eq!(checkpoint.read::<u32>("numbers").unwrap(), numbers);
            assert_eq!(checkpoint.read::<u64>("words").unwrap(), words);
            assert!(checkpoint.read::<u32>("words").is_err() && checkpoint.read::<u64>("none").is_err());
        }
        let other = Identity { scene: "other".into(), ..identity() };
        let error = newest(root.path(), "x", &other).unwrap_err().to_string();
        assert!(error.ends_with("x.1: is of another scene, or of another version of voidwalk"), "{error}");
        assert!(newest(root.path(), "y", &other).unwrap().0.is_none());
    }

    /// A walk of the same scene is another walk if any part of its identity differs.
    #[test]
    fn another_walk_of_the_same_scene_is_refused() {
        let root = tempfile::tempdir().unwrap();
        saved(root.path(), 1);
        for other in [
            Identity { part: 0, ..identity() },
            Identity { replicate: 1, ..identity() },
            Identity { seed: 2, ..identity() },
            Identity { n_base: 5, ..identity() },
        ] {
            let message = newest(root.path(), "x", &other).unwrap_err().to_string();
            let both = message.contains(&identity().to_string()) && message.contains(&other.to_string());
            assert!(both && message.contains("x.1: is of another walk of this scene"), "{message}");
        }
    }

    #[test]
    fn sections_of_many_pieces_and_odd_parts_come_back() {
        let root = tempfile::tempdir().unwrap();
        let column: Vec<u32> = (0..(3 * PIECE as u32) / 4 + 17).collect();
        let parts: Vec<&[u32]> = column.chunks(12_345).collect();
        save(root.path(), "x", &label(1), &[Section::parts("c", parts), Section::new::<u64>("empty", &[])])
            .unwrap();
        let saved = newest(root.path(), "x", &identity()).unwrap().0.unwrap();
        assert_eq!(saved.read::<u32>("c").unwrap(), column);
        assert!(saved.read::<u64>("empty").unwrap().is_empty());
    }
}
