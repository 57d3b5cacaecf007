//! Arbitrary bytes for the reader `arrays`.
#![no_main]

#[path = "../../readers/mod.rs"]
mod readers;

#[global_allocator]
static BOUNDED: readers::Bounded = readers::Bounded;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| readers::arrays(bytes));
