//! Checkpoints that were cut short or changed by a bit, at every place.

use std::fs::{self, File};
use std::io::{Seek, SeekFrom, Write};
use std::path::Path;

use voidwalk::store::checkpoint::{Identity, Label, Section, newest, save};

/// Bytes that have a checksum of their own.
const PIECE: usize = 1 << 20;

/// Every length up to the end of the header and around every edge of a piece, every bit of the header, and
/// bits all over the rest, what lies between the sections included: all are detected, and the older slot is
/// taken. A fixed part of all; with `VOIDWALK_FAULTS=all` all lengths up to 4,096, all header bits, and
/// 10,000 bits of the rest.
#[test]
fn no_corruption_goes_unnoticed() {
    let all = std::env::var("VOIDWALK_FAULTS").is_ok_and(|value| value == "all");
    let memory = Path::new("/dev/shm");
    let root = if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() }.unwrap();
    let numbers: Vec<u32> = (0..2 * (PIECE as u32 / 4) + 12_345).collect();
    let identity = Identity { scene: "a scene".into(), ..Identity::default() };
    for generation in [1, 2] {
        let words = [generation; 3];
        let sections = [Section::new("words", &words), Section::new("numbers", &numbers)];
        save(
            root.path(),
            "x",
            &Label { identity: identity.clone(), generation, ..Label::default() },
            &sections,
        )
        .unwrap();
    }
    let path = root.path().join("x.0");
    let whole = fs::read(&path).unwrap();
    let header = u64::from_le_bytes(whole[16..24].try_into().unwrap()) as usize;
    let older = |what: &str| {
        let (saved, passed_over) = newest(root.path(), "x", &identity).unwrap();
        assert_eq!(saved.unwrap().label.generation, 1, "{what}");
        assert_eq!(passed_over.len(), 1, "{what}");
        assert!(passed_over[0].to_string().contains("x.0: "), "{what}: {}", passed_over[0]);
    };
    let mut file = File::options().write(true).open(&path).unwrap();
    let mut write = |at: usize, bytes: &[u8]| {
        file.seek(SeekFrom::Start(at as u64)).and_then(|_| file.write_all(bytes)).unwrap();
    };
    let step = if all { 1 } else { 37 };
    let first = header.next_multiple_of(4096) + 64;
    let edges =
        (first..whole.len()).step_by(PIECE).chain([whole.len()]).flat_map(|edge| [edge - 1, edge, edge + 1]);
    let lengths: Vec<usize> =
        (0..=4096).step_by(step).chain(edges.filter(|&length| length < whole.len())).collect();
    for &length in &lengths {
        File::options().write(true).open(&path).unwrap().set_len(length as u64).unwrap();
        older(&format!("cut to {length}"));
        write(length, &whole[length..]);
    }
    let header_bits: Vec<usize> = (0..8 * header).step_by(step).collect();
    // A generator of its own would be too much: Weyl's sequence is spread evenly.
    let others = if all { 10_000 } else { 300 };
    let rest = 8 * (whole.len() - header);
    let bit = |k: usize| 8 * header + (k as f64 * 0.618_033_988_749_895 % 1.0 * rest as f64) as usize;
    let between = 8 * header..8 * (header + 8);
    let payload_bits: Vec<usize> = (0..others).map(bit).chain(between).collect();
    for &bit in header_bits.iter().chain(&payload_bits) {
        write(bit / 8, &[whole[bit / 8] ^ (1 << (bit % 8))]);
        older(&format!("bit {bit}"));
        write(bit / 8, &whole[bit / 8..][..1]);
    }
    assert_eq!(newest(root.path(), "x", &identity).unwrap().0.unwrap().label.generation, 2);
    println!(
        "{} lengths, {} bits of the header, {} of the rest",
        lengths.len(),
        header_bits.len(),
        payload_bits.len()
    );
    let mut newer = whole.clone();
    newer[8] = 3;
    for (bytes, what) in [(&newer[..], "a newer format"), (b"something else altogether", "another file")] {
        fs::write(&path, bytes).unwrap();
        older(what);
    }
}
