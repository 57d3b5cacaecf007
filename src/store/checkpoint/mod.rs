//! Checkpoints: columns in a file that is whole and unharmed, or refused.
//!
//! # Bytes
//! Little-endian, in this order:
//!
//! | offset | bytes | what |
//! |---|---|---|
//! | 0 | 8 | `vwcheckp` |
//! | 8 | 4 | version of this format, 1 |
//! | 12 | 4 | 0x0a0b0c0d, which another byte order would turn round |
//! | 16 | 8 | length of the header, its checksum included |
//! | 24 | 8 | length of the file |
//! | 32 | 32 | fingerprint of the scene, as text |
//! | 64 | 8 | fingerprint of the network |
//! | 72 | 40 | seed, replicate, run, increment, generation |
//! | 112 | 8 | number of sections, at most 64 |
//! | 120 | 24 | version of the program, as text |
//! | 144 | 48 each | sections: name (24), bytes of an element (4), zero (4), elements (8), offset (8) |
//! | then | 8 each | XXH3-64 of every piece of 1 MiB of each section, in order |
//! | then | 8 | XXH3-64 of everything before |
//! | a multiple of 4096 | | the sections, each at a multiple of 64; zeros between them |
//!
//! The checksums find accidents, not forgers.
//!
//! # Slots
//! A checkpoint called `x` lives in `x.0` or `x.1`, whichever is older, and is written whole before it has its name. So the
//! one before stays until the next is on the disk, and is taken when that one turns out to be harmed. One that the system
//! fails to read may be whole: nothing is taken in its place, and the program ends with an error instead.
//!
//! # Read, not mapped
//! A checkpoint is read piece by piece into the columns, each piece checked before it is used. It is not mapped: a mapped file
//! that somebody cuts short ends the process (SIGBUS), and a mapped page can change after its sum was found right. What
//! that costs is one copy in memory; `results/robustness-2026-11-21.md` holds the seconds of a whole resume.

use std::fs::File;
use std::io::{self, Read, Write};
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};

use bytemuck::Pod;
use rayon::prelude::*;
use xxhash_rust::xxh3::{Xxh3, xxh3_64};

use super::StoreError;
use super::disk::{Call, ask};
use super::folder::write_whole_with;

const MAGIC: [u8; 8] = *b"vwcheckp";
const VERSION: u32 = 1;
const BYTE_ORDER: u32 = 0x0a0b_0c0d;
const FIXED: usize = 144;
const ENTRY: usize = 48;
const PIECE: usize = 1 << 20;
const MOST_SECTIONS: u64 = 64;
/// A longer header is no header (bytes): that of 8 TB of columns.
const LONGEST_HEADER: u64 = 64 << 20;

/// What a checkpoint is of.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Label {
    /// Fingerprint of the scene, at most 32 characters.
    pub scene: String,
    /// Fingerprint of the network.
    pub network: u64,
    /// Seed of the replicate.
    pub seed: u64,
    /// Replicate.
    pub replicate: u64,
    /// Run.
    pub run: u64,
    /// Last whole increment.
    pub increment: u64,
    /// Which one of its name it is, counted from 1.
    pub generation: u64,
}

/// A column to be kept, in one or more parts.
pub struct Section<'a> {
    /// Name, at most 24 characters.
    pub name: &'static str,
    /// Bytes of an element.
    element: usize,
    parts: Vec<&'a [u8]>,
}

impl<'a> Section<'a> {
    /// A whole column.
    pub fn new<T: Pod>(name: &'static str, column: &'a [T]) -> Self {
        Self::parts(name, [column])
    }

    /// A column from its parts, one after another.
    pub fn parts<T: Pod>(name: &'static str, parts: impl IntoIterator<Item = &'a [T]>) -> Self {
        Self { name, element: size_of::<T>(), parts: parts.into_iter().map(bytemuck::cast_slice).collect() }
    }

    fn bytes(&self) -> u64 {
        self.parts.iter().map(|part| part.len() as u64).sum()
    }

    /// XXH3 of each piece, on as many threads as there are.
    fn sums(&self) -> Vec<u64> {
        let mut pieces: Vec<Vec<&[u8]>> = Vec::new();
        let mut room = 0;
        for part in &self.parts {
            let mut rest = *part;
            while !rest.is_empty() {
                if room == 0 {
                    pieces.push(Vec::new());
                    room = PIECE;
                }
                let (now, later) = rest.split_at(rest.len().min(room));
                pieces.last_mut().expect("one was pushed").push(now);
                (room, rest) = (room - now.len(), later);
            }
        }
        let sum = |piece: Vec<&[u8]>| {
            let mut hash = Xxh3::new();
            piece.iter().for_each(|part| hash.update(part));
            hash.digest()
        };
        pieces.into_par_iter().map(sum).collect()
    }
}

fn slot(folder: &Path, name: &str, generation: u64) -> PathBuf {
    folder.join(format!("{name}.{}", generation % 2))
}

/// Keeps a checkpoint in the slot of its generation.
///
/// # Errors
/// What the system says; the other slot is untouched then, and so is what this one held before.
pub fn keep(folder: &Path, name: &str, label: &Label, sections: &[Section]) -> Result<(), StoreError> {
    let header = header(label, sections);
    write_whole_with(&slot(folder, name, label.generation), |file| {
        file.write_all(&header)?;
        let mut at = header.len() as u64;
        for section in sections {
            pad(file, &mut at, 64)?;
            for part in &section.parts {
                file.write_all(part)?;
            }
            at += section.bytes();
        }
        Ok(())
    })
}

fn pad(file: &mut dyn Write, at: &mut u64, to: u64) -> io::Result<()> {
    let gap = at.next_multiple_of(to) - *at;
    *at += gap;
    file.write_all(&[0; 4096][..gap as usize])
}

/// The header, filled up to a multiple of 4096 bytes.
fn header(label: &Label, sections: &[Section]) -> Vec<u8> {
    let sums: Vec<u64> = sections.iter().flat_map(Section::sums).collect();
    let length = FIXED + ENTRY * sections.len() + 8 * sums.len() + 8;
    let mut at = (length as u64).next_multiple_of(4096);
    let mut table = Vec::new();
    for section in sections {
        at = at.next_multiple_of(64);
        table.extend(text::<24>(section.name));
        table.extend((section.element as u32).to_le_bytes());
        table.extend([0; 4]);
        table.extend((section.bytes() / section.element as u64).to_le_bytes());
        table.extend(at.to_le_bytes());
        at += section.bytes();
    }
    let mut bytes = MAGIC.to_vec();
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend(BYTE_ORDER.to_le_bytes());
    bytes.extend((length as u64).to_le_bytes());
    bytes.extend(at.to_le_bytes());
    bytes.extend(text::<32>(&label.scene));
    for word in [
        label.network,
        label.seed,
        label.replicate,
        label.run,
        label.increment,
        label.generation,
        sections.len() as u64,
    ] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(text::<24>(env!("CARGO_PKG_VERSION")));
    bytes.extend(table);
    sums.iter().for_each(|sum| bytes.extend(sum.to_le_bytes()));
    bytes.extend(xxh3_64(&bytes).to_le_bytes());
    debug_assert_eq!(bytes.len(), length);
    bytes.resize(length.next_multiple_of(4096), 0);
    bytes
}

/// Text in a field of fixed length.
fn text<const N: usize>(text: &str) -> [u8; N] {
    let mut field = [0; N];
    field[..text.len()].copy_from_slice(text.as_bytes());
    field
}

/// Why a checkpoint is refused.
#[derive(Debug, thiserror::Error)]
#[error("{file}: {problem}")]
pub struct Harmed {
    /// The file.
    pub file: String,
    /// What is wrong with it.
    pub problem: String,
    /// Whether the system failed to read it: it may be whole.
    pub unread: bool,
}

impl Harmed {
    /// A file whose content is wrong.
    pub fn new(file: impl Into<String>, problem: impl Into<String>) -> Self {
        Self { file: file.into(), problem: problem.into(), unread: false }
    }

    /// A file that the system did not read, unless it is that it ends too early.
    fn unread(path: &Path, error: &io::Error) -> Self {
        let unread = error.kind() != io::ErrorKind::UnexpectedEof;
        let problem = match unread {
            true => {
                format!("cannot be read: {error}; it is left as it is, and nothing was taken in its place")
            }
            false => "ends early".into(),
        };
        Self { file: path.display().to_string(), problem, unread }
    }
}

/// A checkpoint whose header has been checked; its sections are as they are read.
#[derive(Debug)]
pub struct Saved {
    /// What it is of.
    pub label: Label,
    path: PathBuf,
    file: File,
    sections: Vec<Entry>,
    /// Offset and length of what lies between the sections, all zeros.
    gaps: Vec<(u64, usize)>,
}

#[derive(Debug)]
struct Entry {
    name: String,
    element: u64,
    count: u64,
    offset: u64,
    sums: Vec<u64>,
}

impl Saved {
    /// Opens a checkpoint and checks its header; `None` where there is no such file.
    ///
    /// # Errors
    /// A file that is cut, harmed, of another version or no checkpoint at all.
    pub fn open(path: &Path) -> Result<Option<Self>, Harmed> {
        let unread = |error: io::Error| Harmed::unread(path, &error);
        let harmed = |problem: String| Harmed::new(path.display().to_string(), problem);
        let is_file = match path.symlink_metadata() {
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(e) => return Err(unread(e)),
            Ok(meta) => meta.is_file(),
        };
        if !is_file {
            return Err(harmed("is no regular file".into()));
        }
        let mut file = ask(Call::Read(path), || File::open(path)).map_err(unread)?;
        let length = file.metadata().map_err(unread)?.len();
        let bytes = header_bytes(path, &mut file, length)?;
        let (label, sections) = parse_header(&bytes, length).map_err(harmed)?;
        let gaps = gaps(&sections, bytes.len() as u64, length).map_err(harmed)?;
        Ok(Some(Self { label, path: path.to_owned(), file, sections, gaps }))
    }

    fn harmed(&self, problem: impl Into<String>) -> Harmed {
        Harmed::new(self.path.display().to_string(), problem)
    }

    /// Elements of a section.
    ///
    /// # Errors
    /// There is no such section, or its elements have another size.
    pub fn count<T: Pod>(&self, name: &str) -> Result<usize, Harmed> {
        self.entry::<T>(name).map(|entry| entry.count as usize)
    }

    fn entry<T: Pod>(&self, name: &str) -> Result<&Entry, Harmed> {
        let entry = self.sections.iter().find(|entry| entry.name == name);
        let entry = entry.ok_or_else(|| self.harmed(format!("has no section {name}")))?;
        if entry.element != size_of::<T>() as u64 {
            return Err(self.harmed(format!("section {name} has elements of {} bytes", entry.element)));
        }
        Ok(entry)
    }

    /// A whole section.
    ///
    /// # Errors
    /// As [`Saved::count`]; a piece whose checksum is wrong.
    pub fn read<T: Pod>(&self, name: &str) -> Result<Vec<T>, Harmed> {
        // The header's length bounds what is allocated: the file is as long as it says.
        let mut all = Vec::with_capacity(self.count::<T>(name)?);
        self.read_pieces::<T>(name, |piece| all.extend_from_slice(piece))?;
        Ok(all)
    }

    /// A section piece by piece, each checked before it is handed on.
    ///
    /// # Errors
    /// As [`Saved::read`].
    pub fn read_pieces<T: Pod>(&self, name: &str, mut take: impl FnMut(&[T])) -> Result<(), Harmed> {
        let entry = self.entry::<T>(name)?;
        let (mut offset, mut left, sums) = (entry.offset, entry.count * entry.element, entry.sums.clone());
        let mut words: Vec<T> = vec![T::zeroed(); PIECE.min(left as usize).div_ceil(size_of::<T>())];
        for (index, sum) in sums.iter().enumerate() {
            let now = left.min(PIECE as u64) as usize;
            let piece = &mut bytemuck::cast_slice_mut::<T, u8>(&mut words)[..now];
            let read = ask(Call::Read(&self.path), || self.file.read_exact_at(piece, offset));
            read.map_err(|e| Harmed::unread(&self.path, &e))?;
            if xxh3_64(piece) != *sum {
                return Err(self.wrong_sum(name, index));
            }
            take(&words[..now / size_of::<T>()]);
            (offset, left) = (offset + now as u64, left - now as u64);
        }
        Ok(())
    }

    /// Reads every piece of every section, and what lies between them, and checks it; in order, as the disk likes it.
    ///
    /// # Errors
    /// The first that is wrong.
    pub fn check(&self) -> Result<(), Harmed> {
        let read = |offset: u64, bytes: &mut [u8]| {
            let read = ask(Call::Read(&self.path), || self.file.read_exact_at(bytes, offset));
            read.map_err(|e| Harmed::unread(&self.path, &e))
        };
        let mut bytes = vec![0; PIECE];
        for &(offset, length) in &self.gaps {
            read(offset, &mut bytes[..length])?;
            if bytes[..length].iter().any(|&byte| byte != 0) {
                return Err(self.harmed(format!("is not zero between its sections, near byte {offset}")));
            }
        }
        for entry in &self.sections {
            let size = entry.count * entry.element;
            for (index, sum) in entry.sums.iter().enumerate() {
                let from = index as u64 * PIECE as u64;
                let piece = &mut bytes[..(size - from).min(PIECE as u64) as usize];
                read(entry.offset + from, piece)?;
                if xxh3_64(piece) != *sum {
                    return Err(self.wrong_sum(&entry.name, index));
                }
            }
        }
        Ok(())
    }

    fn wrong_sum(&self, name: &str, index: usize) -> Harmed {
        self.harmed(format!("section {name}, piece {index}: its checksum is wrong"))
    }
}

/// The header of a file of this length, if it is one of this program.
fn header_bytes(path: &Path, file: &mut File, length: u64) -> Result<Vec<u8>, Harmed> {
    let harmed = |problem: String| Harmed::new(path.display().to_string(), problem);
    let mut read = |bytes: &mut [u8]| ask(Call::Read(path), || file.read_exact(bytes));
    let mut bytes = vec![0; FIXED];
    read(&mut bytes).map_err(|e| Harmed::unread(path, &e))?;
    if bytes[..8] != MAGIC {
        return Err(harmed("is no checkpoint of voidwalk".into()));
    }
    let version = u32::from_le_bytes(array(&bytes, 8));
    if version != VERSION {
        return Err(harmed(format!("has format {version}; this program reads format {VERSION}")));
    }
    if u32::from_le_bytes(array(&bytes, 12)) != BYTE_ORDER {
        return Err(harmed("was written by a machine with another byte order".into()));
    }
    let (header_length, file_length) = (word(&bytes, 16), word(&bytes, 24));
    if file_length != length {
        return Err(harmed(format!("has {length} bytes where its header says {file_length}")));
    }
    if !(FIXED as u64 + 8..=LONGEST_HEADER.min(length)).contains(&header_length) {
        return Err(harmed("its header has an impossible length".into()));
    }
    bytes.resize(header_length as usize, 0);
    read(&mut bytes[FIXED..]).map_err(|e| Harmed::unread(path, &e))?;
    Ok(bytes)
}

/// Label and sections from the header of a file of this length; or what is wrong.
fn parse_header(bytes: &[u8], length: u64) -> Result<(Label, Vec<Entry>), String> {
    let body = bytes.len() - 8;
    if xxh3_64(&bytes[..body]) != word(bytes, body) {
        return Err("the checksum of its header is wrong".into());
    }
    let count = word(bytes, 112);
    if count > MOST_SECTIONS || FIXED + ENTRY * count as usize > body {
        return Err("has an impossible number of sections".into());
    }
    let mut sum_at = FIXED + ENTRY * count as usize;
    let mut sections = Vec::new();
    for index in 0..count as usize {
        let at = FIXED + ENTRY * index;
        let name = word_text(&bytes[at..at + 24])?;
        let element = u64::from(u32::from_le_bytes(array(bytes, at + 24)));
        let (count, offset) = (word(bytes, at + 32), word(bytes, at + 40));
        let size = count.checked_mul(element).filter(|_| element > 0);
        let end = size.and_then(|size| size.checked_add(offset)).filter(|end| *end <= length);
        let (Some(size), Some(_)) = (size, end) else {
            return Err(format!("section {name} does not fit the file"));
        };
        let pieces = size.div_ceil(PIECE as u64) as usize;
        if pieces > (body - sum_at) / 8 {
            return Err(format!("section {name} lacks checksums"));
        }
        let sums = (0..pieces).map(|k| word(bytes, sum_at + 8 * k)).collect();
        sum_at += 8 * pieces;
        sections.push(Entry { name, element, count, offset, sums });
    }
    let label = Label {
        scene: word_text(&bytes[32..64])?,
        network: word(bytes, 64),
        seed: word(bytes, 72),
        replicate: word(bytes, 80),
        run: word(bytes, 88),
        increment: word(bytes, 96),
        generation: word(bytes, 104),
    };
    Ok((label, sections))
}

/// What lies between the header and the sections, which follow one another to the end of the file.
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

fn word(bytes: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(array(bytes, at))
}

fn array<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    let mut field = [0; N];
    field.copy_from_slice(&bytes[at..at + N]);
    field
}

fn word_text(field: &[u8]) -> Result<String, String> {
    let end = field.iter().position(|&b| b == 0).unwrap_or(field.len());
    let text =
        std::str::from_utf8(&field[..end]).map_err(|_| "a name in its header is no text".to_string())?;
    Ok(text.to_owned())
}

/// The newest whole checkpoint of this name for this scene, and what is wrong with any newer one.
///
/// # Errors
/// There are checkpoints of this name, but none is whole and of this scene; or the system fails to read one.
pub fn newest(folder: &Path, name: &str, scene: &str) -> Result<(Option<Saved>, Vec<Harmed>), Harmed> {
    let mut harmed = Vec::new();
    let mut found = Vec::new();
    for parity in 0..2 {
        match Saved::open(&slot(folder, name, parity)) {
            Ok(None) => {}
            Ok(Some(saved)) if saved.label.scene != scene => {
                harmed.push(saved.harmed("is of another scene or recipe"));
            }
            Ok(Some(saved)) => found.push(saved),
            Err(error) if error.unread => return Err(error),
            Err(error) => harmed.push(error),
        }
    }
    found.sort_by_key(|saved| std::cmp::Reverse(saved.label.generation));
    for saved in found {
        match saved.check() {
            Ok(()) => return Ok((Some(saved), harmed)),
            Err(error) if error.unread => return Err(error),
            Err(error) => harmed.push(error),
        }
    }
    match harmed.pop() {
        Some(error) => Err(error),
        None => Ok((None, harmed)),
    }
}

#[cfg(test)]
mod tests;
