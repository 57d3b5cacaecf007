//! The sections of a checkpoint, and their checksums.

use bytemuck::Pod;
use rayon::prelude::*;
use xxhash_rust::xxh3::Xxh3;

/// Bytes of a section that have a checksum of their own.
pub(super) const PIECE: usize = 1 << 20;

/// A column to be saved, in one or more parts.
pub struct Section<'a> {
    /// Name, at most 32 bytes.
    pub name: &'static str,
    /// Bytes of an element.
    pub(super) element: usize,
    pub(super) parts: Vec<&'a [u8]>,
}

impl<'a> Section<'a> {
    /// Makes a section of a whole column.
    pub fn new<T: Pod>(name: &'static str, column: &'a [T]) -> Self {
        Self::parts(name, [column])
    }

    /// Makes a section of a column from its parts, one after another.
    pub fn parts<T: Pod>(name: &'static str, parts: impl IntoIterator<Item = &'a [T]>) -> Self {
        Self { name, element: size_of::<T>(), parts: parts.into_iter().map(bytemuck::cast_slice).collect() }
    }

    pub(super) fn bytes(&self) -> u64 {
        self.parts.iter().map(|part| part.len() as u64).sum()
    }

    /// XXH3 of each piece, on all available threads.
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
