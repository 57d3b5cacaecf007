//! The stack of functions that keep vectors on it.

use std::hint::black_box;
use std::mem::MaybeUninit;

/// As long as a line of the cache, and where one begins.
#[repr(align(64))]
struct Line {
    _bytes: [u8; 64],
}

/// Has the function that this becomes a part of begin its stack where a line of the cache begins. What the
/// compiler sets aside there of vectors lies across two lines otherwise, or does not, as its callers have it:
/// the default scene with AVX-512 took a third longer where it did.
#[inline(always)]
pub fn begin_at_a_line() {
    black_box(&mut MaybeUninit::<Line>::uninit());
}
