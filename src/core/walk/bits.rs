//! A set of constrictions in words of 64 bits, as checkpoints hold it on machines of any width.

use bitvec::vec::BitVec;

/// Words of the machine in one of 64 bits.
const IN_64: usize = (u64::BITS / usize::BITS) as usize;

/// The bits, the first the lowest of the first word; those behind the last are 0.
pub fn to_words(bits: &BitVec) -> Vec<u64> {
    let join = |parts: &[usize]| parts.iter().rev().fold(0, |word, &part| up(word) | part as u64);
    let mut words: Vec<u64> = bits.as_raw_slice().chunks(IN_64).map(join).collect();
    if let (Some(last), unused @ 1..) = (words.last_mut(), words_for(bits.len()) * 64 - bits.len()) {
        *last &= u64::MAX >> unused;
    }
    words
}

/// `len` bits of such words; beyond these words all are 0.
pub fn from_words(words: &[u64], len: usize) -> BitVec {
    let split = |&word: &u64| (0..IN_64).map(move |part| (word >> (part as u32 * usize::BITS)) as usize);
    let mut bits = BitVec::from_vec(words.iter().flat_map(split).collect());
    bits.resize(len, false);
    bits
}

/// Number of words that hold `len` bits.
pub(super) fn words_for(len: usize) -> usize {
    len.div_ceil(64)
}

/// A word with room for another of the machine's below it.
fn up(word: u64) -> u64 {
    word.checked_shl(usize::BITS).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_come_back_from_words_and_stand_in_them_in_order() {
        for len in [0, 1, 31, 32, 33, 63, 64, 65, 127, 128, 1000] {
            let bits_where = |is: fn(usize) -> bool| (0..len).map(is).collect::<BitVec>();
            for bits in [
                bits_where(|_| false),
                bits_where(|_| true),
                bits_where(|i| i % 3 == 1),
                bits_where(|i| i * i % 7 < 3),
            ] {
                let words = to_words(&bits);
                assert_eq!(words.len(), words_for(len));
                for at in 0..64 * words.len() {
                    let is = words[at / 64] >> (at % 64) & 1 == 1;
                    assert_eq!(is, bits.get(at).is_some_and(|bit| *bit), "bit {at} of {len}");
                }
                assert_eq!(from_words(&words, len), bits);
                assert_eq!(from_words(&words, len + 70).count_ones(), bits.count_ones());
                assert_eq!(from_words(&words, len / 2), bits[..len / 2]);
            }
        }
        assert_eq!(to_words(&from_words(&[u64::MAX, 0x0123_4567_89ab_cdef], 120))[1], 0x23_4567_89ab_cdef);
    }
}
