//! Arbitrary bytes for the reader `graph`.
#![no_main]

#[path = "../../readers/mod.rs"]
mod readers;

#[global_allocator]
static BOUNDED: readers::Bounded = readers::Bounded;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| readers::graph(bytes));
