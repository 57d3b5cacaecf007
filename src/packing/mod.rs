//! Packings of filter grains: the grains themselves, and how they are compressed.

mod export;
mod grains;
mod import;
#[cfg(test)]
mod import_tests;

pub use export::vtp_points;
pub use grains::{Cell, Packing};
pub use import::{ImportError, PACKING_FILE_LIMIT_BYTES};
