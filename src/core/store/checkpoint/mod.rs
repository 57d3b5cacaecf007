//! Checkpoints: columns in a file that is either whole or refused.
//!
//! # Format 1
//! A file holds, in this order (numbers are little-endian, as on every machine that voidwalk is built for):
//!
//! | bytes | field | what |
//! |---|---|---|
//! | 8 | `magic` | `vwcheckp` |
//! | 4 | `version` | of this format: 1; another is refused as [`CheckpointError::OtherVersion`] |
//! | 4 | `byte_order` | 0x0a0b0c0d, which a machine of another byte order reads the other way round |
//! | 8 | `header_length` | bytes of the header, its checksum included |
//! | 8 | `file_length` | bytes of the file |
//! | 32 | `scene` | fingerprint of the scene (of a packing: of its plan), as text |
//! | 8 | `part` | 0: a walk of the scene itself; from 1: of the sensitivity study |
//! | 8 | `replicate` | which replicate, counted from 1 |
//! | 8 | `seed` | of the replicate |
//! | 8 | `n_base` | base particles of a run of the walk |
//! | 8 | `network` | fingerprint of the network; 0 for a finished replicate or a packing |
//! | 8 | `run` | the run under way, counted from 1; 0 for a finished replicate or a packing |
//! | 8 | `increment` | its last whole increment |
//! | 8 | `generation` | which checkpoint of its name, counted from 1 |
//! | 8 | `sections` | number of sections, at most 64 |
//! | 24 | `program` | version of the program, as text |
//! | 56 each | | a row a section, as below |
//! | 8 each | | XXH3-64 of every piece of 1 MiB of each section, in order |
//! | 8 | | XXH3-64 of everything before: the end of the header |
//! | | | zeros up to a multiple of 4096, then the sections, each at a multiple of 64, zeros between |
//!
//! A row of the table: `name` (32 bytes, text), `element` (4, bytes of an element), zero (4), `count` (8,
//! elements), `offset` (8, of its first byte in the file).
//!
//! Text is UTF-8 filled up with zeros. A packing leaves `part`, `replicate` and `n_base` 0. The checksums
//! find accidents, not forgers.
//!
//! A section is a column of numbers, or a record with named fields as JSON text, in which every
//! floating-point number comes back bit for bit. The sections:
//!
//! | checkpoint of | sections |
//! |---|---|
//! | a run under way | `done`, and those that `walk::SavedState` names |
//! | a finished replicate | `done`: a record of its figures and rows, `run::checkpoints::Done` |
//! | a study | `found`: a record of its networks or lattices that are done |
//! | a packing | `state`, see `packing::Compression::to_bytes`, and `seconds` (f64), spent so far |
//!
//! # Slots
//! A checkpoint called `x` is stored in `x.0` or `x.1`, whichever is older, and is written whole before it
//! gets its name. So the previous one remains until the next is on the disk, and is taken if the next turns
//! out to be corrupt. A checkpoint that the system fails to read may be whole: no other is taken in its
//! place, and the program ends with an error instead.
//!
//! # Read, not mapped
//! A checkpoint is read piece by piece into the columns, and each piece is checked before it is used. It is
//! not mapped: a mapped file that somebody cuts short ends the process (SIGBUS), and a mapped page can change
//! after its sum was found right. The cost is one copy in memory; `results/faults.md` holds the seconds of a
//! whole resume.

mod error;
mod header;
mod label;
mod read;
mod section;
#[cfg(test)]
mod tests;
mod write;

pub use error::CheckpointError;
pub use label::{Identity, Label};
pub use read::{Checkpoint, newest};
pub use section::Section;
pub use write::save;
