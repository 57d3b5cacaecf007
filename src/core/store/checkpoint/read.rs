//! Reads a checkpoint: no part of it is used before its checksum was found right.

use std::cmp::Reverse;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use bytemuck::Pod;
use serde::de::DeserializeOwned;
use xxhash_rust::xxh3::xxh3_64;

use super::error::CheckpointError;
use super::header::{self, Entry};
use super::label::{Identity, Label};
use super::section::PIECE;
use super::write::slot;
use crate::store::disk::{Call, ask, open_own};
use crate::store::platform;

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

/// Place of the bytes.
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
    /// A file that is cut, corrupt, of another version or no checkpoint at all.
    pub fn open(path: &Path) -> Result<Option<Self>, CheckpointError> {
        let unreadable = |source| CheckpointError::from_io(path, source);
        let is_file = match path.symlink_metadata() {
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(e) => return Err(unreadable(e)),
            Ok(meta) => meta.is_file(),
        };
        if !is_file {
            return Err(CheckpointError::corrupt(path, "is no regular file"));
        }
        let mut file = ask(Call::Read(path), || open_own(path)).map_err(unreadable)?;
        let length = file.metadata().map_err(unreadable)?.len();
        let header = header::read(path, &mut file, length)?;
        Self::with_header(path, header, length, Source::File(file)).map(Some)
    }

    /// [`Checkpoint::open`] on the content of a file, called `name` in messages.
    ///
    /// # Errors
    /// Errors of [`Checkpoint::open`].
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
        let gaps = gaps(&sections, header, length);
        let gaps = gaps.map_err(|problem| CheckpointError::corrupt(path, problem))?;
        Ok(Self { label, path: path.to_owned(), source, sections, gaps })
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Makes the error for a checkpoint whose content is wrong although its checksums are right.
    pub fn corrupt(&self, problem: impl Into<String>) -> CheckpointError {
        CheckpointError::corrupt(&self.path, problem)
    }

    /// Checks that the checkpoint has the expected subject.
    ///
    /// # Errors
    /// [`CheckpointError::OtherScene`] or [`CheckpointError::OtherWalk`].
    pub fn expect(&self, expected: &Identity) -> Result<(), CheckpointError> {
        let (identity, file) = (&self.label.identity, self.path.clone());
        if identity.scene != expected.scene {
            return Err(CheckpointError::OtherScene { file });
        }
        if identity != expected {
            let (identity, expected) = (identity.to_string(), expected.to_string());
            return Err(CheckpointError::OtherWalk { file, found: identity, expected });
        }
        Ok(())
    }

    /// Number of elements of a section.
    ///
    /// # Errors
    /// No such section, or elements of another size.
    pub fn count<T: Pod>(&self, name: &str) -> Result<usize, CheckpointError> {
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
    /// Errors of [`Checkpoint::count`]; a piece whose checksum is wrong.
    pub fn read<T: Pod>(&self, name: &str) -> Result<Vec<T>, CheckpointError> {
        // The header's length bounds the allocation: the file is as long as the header states.
        let mut all = Vec::with_capacity(self.count::<T>(name)?);
        self.read_pieces::<T>(name, |piece| all.extend_from_slice(piece))?;
        Ok(all)
    }

    /// Reads a whole section of `count` elements.
    ///
    /// # Errors
    /// Errors of [`Checkpoint::read`]; another number of elements.
    pub fn read_exact<T: Pod>(&self, name: &str, count: usize) -> Result<Vec<T>, CheckpointError> {
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

    /// Reads a section piece by piece, each checked before it is handed on.
    ///
    /// # Errors
    /// Errors of [`Checkpoint::read`].
    pub fn read_pieces<T: Pod>(&self, name: &str, mut take: impl FnMut(&[T])) -> Result<(), CheckpointError> {
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
        match xxh3_64(bytes) == entry.sums[piece] {
            true => Ok(()),
            false => {
                Err(self.corrupt(format!("section {}, piece {piece}: its checksum is wrong", entry.name)))
            }
        }
    }

    fn read_at(&self, offset: u64, bytes: &mut [u8]) -> Result<(), CheckpointError> {
        let read = ask(Call::Read(&self.path), || self.source.read_at(offset, bytes));
        read.map_err(|source| CheckpointError::from_io(&self.path, source))
    }

    /// Reads and checks every piece of every section, and the gaps between them, in the order of the disk.
    ///
    /// # Errors
    /// The first error.
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

/// Gaps between the header and the sections, which follow one another to the end of the file.
fn gaps(sections: &[Entry], header: u64, length: u64) -> Result<Vec<(u64, usize)>, String> {
    let mut spans: Vec<(u64, u64)> = sections.iter().map(|e| (e.offset, e.count * e.element)).collect();
    spans.sort_unstable();
    spans.push((length, 0));
    let (mut at, mut gaps) = (header, Vec::new());
    for (offset, size) in spans {
        match offset.checked_sub(at) {
            Some(gap) if gap < 4096 => gaps.push((at, gap as usize)),
            _ => return Err("its sections do not follow one another".into()),
        }
        at = offset + size;
    }
    gaps.retain(|&(_, gap)| gap > 0);
    Ok(gaps)
}

/// Finds the newest whole checkpoint of this name and the expected subject, and the errors of newer ones.
///
/// # Errors
/// Checkpoints of this name exist, but no whole one of the expected subject; or the system fails to read one.
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
