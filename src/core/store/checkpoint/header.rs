//! The header of a checkpoint: its label, the table of its sections, and checksums. Reasons for refusing
//! it.

use crate::store::disk::{Call, ask};
use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::{fmt, io};
use xxhash_rust::xxh3::{Xxh3, xxh3_64};

const MAGIC: [u8; 8] = *b"vwcheckp";
const VERSION: u32 = 1;
const BYTE_ORDER: u32 = 0x0a0b_0c0d;
const MOST_SECTIONS: u64 = 64;
/// Longest header (bytes), enough for 8 TB of columns; a longer one is refused.
const LONGEST_HEADER: u64 = 64 << 20;

/// Start of every header, byte for byte; the [module](super) describes the fields.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Fixed {
    magic: [u8; 8],
    version: u32,
    byte_order: u32,
    header_length: u64,
    file_length: u64,
    scene: [u8; 32],
    part: u64,
    replicate: u64,
    seed: u64,
    n_base: u64,
    network: u64,
    run: u64,
    increment: u64,
    generation: u64,
    sections: u64,
    program: [u8; 24],
}

/// One row of the table of sections, byte for byte.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Row {
    name: [u8; 32],
    element: u32,
    zero: u32,
    count: u64,
    offset: u64,
}

/// A section of a file.
#[derive(Debug)]
pub(super) struct Entry {
    pub(crate) name: String,
    /// Bytes of an element.
    pub(crate) element: u64,
    /// Number of elements.
    pub(crate) count: u64,
    pub(crate) offset: u64,
    /// Checksum of each piece.
    pub(crate) sums: Vec<u64>,
}

/// Encodes the header, padded to a multiple of 4096 bytes.
pub(super) fn encode(label: &Label, sections: &[Section]) -> Vec<u8> {
    let sums: Vec<u64> = sections.iter().flat_map(Section::sums).collect();
    let length = size_of::<Fixed>() + size_of::<Row>() * sections.len() + 8 * sums.len() + 8;
    let mut at = (length as u64).next_multiple_of(4096);
    let mut table = Vec::new();
    for section in sections {
        let (element, size) = (section.element as u32, section.bytes());
        let offset = at.next_multiple_of(64);
        let count = size / u64::from(element);
        table.push(Row { name: field(section.name), element, zero: 0, count, offset });
        at = offset + size;
    }
    let Identity { scene, part, replicate, seed, n_base } = &label.identity;
    let fixed = Fixed {
        magic: MAGIC,
        version: VERSION,
        byte_order: BYTE_ORDER,
        header_length: length as u64,
        file_length: at,
        scene: field(scene),
        part: *part,
        replicate: *replicate,
        seed: *seed,
        n_base: *n_base,
        network: label.network,
        run: label.run,
        increment: label.increment,
        generation: label.generation,
        sections: sections.len() as u64,
        program: field(env!("CARGO_PKG_VERSION")),
    };
    let mut bytes = bytemuck::bytes_of(&fixed).to_vec();
    bytes.extend_from_slice(bytemuck::cast_slice(&table));
    bytes.extend_from_slice(bytemuck::cast_slice(&sums));
    bytes.extend_from_slice(&xxh3_64(&bytes).to_ne_bytes());
    debug_assert_eq!(bytes.len(), length);
    bytes.resize(length.next_multiple_of(4096), 0);
    bytes
}

/// Reads the label, the sections and the header's length in bytes, from a file of `length` bytes.
pub(super) fn read(
    path: &Path,
    file: &mut impl Read,
    length: u64,
) -> Result<(Label, Vec<Entry>, u64), CheckpointError> {
    let corrupt = |problem: String| CheckpointError::corrupt(path, problem);
    let other = |problem: String| CheckpointError::Other { file: path.to_owned(), problem };
    let mut read = |bytes: &mut [u8]| {
        let read = ask(Call::Read(path), || file.read_exact(bytes));
        read.map_err(|source| CheckpointError::from_io(path, source))
    };
    let mut bytes = vec![0; size_of::<Fixed>()];
    read(&mut bytes)?;
    let fixed: Fixed = bytemuck::pod_read_unaligned(&bytes);
    if fixed.magic != MAGIC {
        return Err(corrupt("is not a voidwalk checkpoint".into()));
    }
    if fixed.byte_order == BYTE_ORDER.swap_bytes() {
        return Err(other("was written by a machine with another byte order".into()));
    }
    if fixed.version != VERSION {
        return Err(other(format!(
            "was written by another version of voidwalk (checkpoint format {}; this one reads {VERSION}), \
             which can finish it",
            fixed.version
        )));
    }
    if fixed.file_length != length {
        return Err(corrupt(format!("has {length} bytes; its header says {}", fixed.file_length)));
    }
    let shortest = size_of::<Fixed>() as u64 + 8;
    if !(shortest..=LONGEST_HEADER.min(length)).contains(&fixed.header_length) {
        return Err(corrupt("its header has an impossible length".into()));
    }
    bytes.resize(fixed.header_length as usize, 0);
    read(&mut bytes[size_of::<Fixed>()..])?;
    let (body, sum) = bytes.split_last_chunk::<8>().expect("longer than the fixed fields");
    if xxh3_64(body) != u64::from_ne_bytes(*sum) || fixed.byte_order != BYTE_ORDER {
        return Err(corrupt("the checksum of its header is wrong".into()));
    }
    let sections = entries(&body[size_of::<Fixed>()..], fixed.sections, length).map_err(corrupt)?;
    let identity = Identity {
        scene: text(&fixed.scene).map_err(corrupt)?,
        part: fixed.part,
        replicate: fixed.replicate,
        seed: fixed.seed,
        n_base: fixed.n_base,
    };
    let Fixed { network, run, increment, generation, .. } = fixed;
    Ok((Label { identity, network, run, increment, generation }, sections, fixed.header_length))
}

/// Reads the sections of a file of `length` bytes from the table and the checksums after it; the error
/// is a description.
fn entries(table: &[u8], number: u64, length: u64) -> Result<Vec<Entry>, String> {
    let rows = usize::try_from(number).unwrap_or(usize::MAX).saturating_mul(size_of::<Row>());
    if number > MOST_SECTIONS || rows > table.len() {
        return Err("has an impossible number of sections".into());
    }
    let (rows, mut sums) = table.split_at(rows);
    let mut sections = Vec::new();
    for row in rows.chunks_exact(size_of::<Row>()) {
        let Row { name, element, count, offset, .. } = bytemuck::pod_read_unaligned(row);
        let (name, element) = (text(&name)?, u64::from(element));
        let size = count.checked_mul(element).filter(|_| element > 0);
        let end = size.and_then(|size| size.checked_add(offset)).filter(|end| *end <= length);
        let (Some(size), Some(_)) = (size, end) else {
            return Err(format!("section {name} does not fit the file"));
        };
        let bytes = 8 * size.div_ceil(PIECE as u64) as usize;
        let Some((bytes, later)) = sums.split_at_checked(bytes) else {
            return Err(format!("section {name} lacks checksums"));
        };
        sections.push(Entry { name, element, count, offset, sums: bytemuck::pod_collect_to_vec(bytes) });
        sums = later;
    }
    Ok(sections)
}

fn field<const N: usize>(text: &str) -> [u8; N] {
    let mut field = [0; N];
    field[..text.len()].copy_from_slice(text.as_bytes());
    field
}

fn text(field: &[u8]) -> Result<String, String> {
    let end = field.iter().position(|&b| b == 0).unwrap_or(field.len());
    let text = std::str::from_utf8(&field[..end]).map_err(|_| "a name in its header is not text")?;
    Ok(text.to_owned())
}

/// Subject of a checkpoint. Another subject is refused, even another walk of the same scene.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Identity {
    /// Fingerprint of the scene, or of the plan of a packing; at most 32 characters.
    pub scene: String,
    /// 0: the walks of the scene itself; from 1: the walks of the sensitivity study.
    pub part: u64,
    /// Replicate, counted from 1.
    pub replicate: u64,
    /// Seed of the replicate.
    pub seed: u64,
    /// Base particles of each run.
    pub n_base: u64,
}

impl fmt::Display for Identity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { part, replicate, seed, n_base, .. } = self;
        write!(f, "replicate {replicate} of part {part}, seed {seed}, {n_base} base particles")
    }
}

/// Subject and progress of a checkpoint.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Label {
    /// Subject of the checkpoint.
    pub identity: Identity,
    /// Fingerprint of the network.
    pub network: u64,
    /// Run, counted from 1.
    pub run: u64,
    /// Last completed increment.
    pub increment: u64,
    /// Number of the checkpoint under its name, counted from 1.
    pub generation: u64,
}

/// Bytes per piece; each piece of a section has a checksum.
pub(super) const PIECE: usize = 1 << 20;

/// A column to be saved, in one or more parts.
pub struct Section<'a> {
    /// Name, at most 32 bytes.
    pub(crate) name: &'static str,
    pub(super) element: usize,
    pub(super) parts: Vec<&'a [u8]>,
}

impl<'a> Section<'a> {
    /// Makes a section of a whole column.
    pub fn new<T: Pod>(name: &'static str, column: &'a [T]) -> Self {
        Self::parts(name, [column])
    }

    /// Makes a section of a column from its parts, one after another.
    pub(crate) fn parts<T: Pod>(name: &'static str, parts: impl IntoIterator<Item = &'a [T]>) -> Self {
        Self { name, element: size_of::<T>(), parts: parts.into_iter().map(bytemuck::cast_slice).collect() }
    }

    pub(super) fn bytes(&self) -> u64 {
        self.parts.iter().map(|part| part.len() as u64).sum()
    }

    /// XXH3 of each piece, computed on all available threads.
    pub(super) fn sums(&self) -> Vec<u64> {
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

/// Reasons for refusing a checkpoint. The command names the remedy, which differs between commands.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// The content of the file differs from what was written.
    #[error("{}: corrupt: {problem}", file.display())]
    Corrupt {
        /// The file.
        file: PathBuf,
        /// Description of the damage.
        problem: String,
    },
    /// The system fails to read the file, which may be intact.
    #[error(
        "{}: cannot be read: {source}; it is left as it is, and nothing was taken in its place",
        file.display()
    )]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// Error of the system.
        source: io::Error,
    },
    /// The subject of the file differs: another version of the format, machine, scene, walk or network.
    #[error("{}: {problem}", file.display())]
    Other {
        /// The file.
        file: PathBuf,
        /// Description of the difference.
        problem: String,
    },
}

impl CheckpointError {
    /// Tells if the system failed to read the file, which may then be intact.
    pub fn is_unreadable(&self) -> bool {
        matches!(self, Self::Unreadable { .. })
    }

    /// Turns a read error into an error of the checkpoint: a file that ends too early is corrupt.
    pub(super) fn from_io(file: &Path, source: io::Error) -> Self {
        match source.kind() {
            io::ErrorKind::UnexpectedEof => Self::corrupt(file, "ends early"),
            _ => Self::Unreadable { file: file.to_owned(), source },
        }
    }

    pub(super) fn corrupt(file: &Path, problem: impl Into<String>) -> Self {
        Self::Corrupt { file: file.to_owned(), problem: problem.into() }
    }
}
