//! Drawing diameters with wide vectors: portable code, compiled for each instruction set.

use super::{Isa, Supply};

/// [`Supply::fill`] with the instructions of `isa`, to the same bits.
pub(super) fn fill_diameters(isa: Isa, supply: &Supply, words: &mut [u64], out: &mut [f32]) {
    assert!(isa.is_available());
    match isa {
        // SAFETY: the machine has the instructions.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512 => unsafe { with_avx512(supply, words, out) },
        // SAFETY: the machine has the instructions.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2 => unsafe { with_avx2(supply, words, out) },
        _ => supply.fill(words, out),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt")]
fn with_avx512(supply: &Supply, words: &mut [u64], out: &mut [f32]) {
    supply.fill(words, out);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,popcnt")]
fn with_avx2(supply: &Supply, words: &mut [u64], out: &mut [f32]) {
    supply.fill(words, out);
}
