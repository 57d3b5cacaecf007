//! Packings of filter grains: the grains themselves, and how they are compressed.

mod grains;

pub use grains::{Cell, Packing};
