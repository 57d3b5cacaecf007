//! One column of a simulation, wherever its memory comes from.

use std::ops::{Deref, DerefMut};

use bytemuck::Pod;

/// A column of plain values that is used as a slice.
///
/// The simulation sees slices only, so that a column can live in memory or in a mapped file without a
/// change to any kernel.
#[derive(Debug)]
pub struct Column<T: Pod> {
    values: Vec<T>,
}

impl<T: Pod> Column<T> {
    /// `len` zeros. Pages are touched when they are first written.
    pub fn zeroed(len: usize) -> Self {
        Self { values: bytemuck::zeroed_vec(len) }
    }
}

impl<T: Pod> Deref for Column<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.values
    }
}

impl<T: Pod> DerefMut for Column<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.values
    }
}
