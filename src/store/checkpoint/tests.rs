//! Checkpoints that come back, and harm that does not go unnoticed.

use super::*;

fn label(generation: u64) -> Label {
    Label { scene: "s".repeat(32), network: 7, seed: 1, replicate: 2, run: 1, increment: 9, generation }
}

fn kept(folder: &Path, generation: u64) -> (Vec<u32>, Vec<u64>) {
    let numbers: Vec<u32> = (0..1000).map(|i| i * generation as u32).collect();
    let words = vec![generation; 3];
    let (a, b) = numbers.split_at(400);
    keep(
        folder,
        "x",
        &label(generation),
        &[Section::parts("numbers", [a, b]), Section::new("words", &words)],
    )
    .unwrap();
    (numbers, words)
}

#[test]
fn what_is_kept_comes_back_and_the_newest_is_taken() {
    let root = tempfile::tempdir().unwrap();
    for generation in 1..=3 {
        let (numbers, words) = kept(root.path(), generation);
        let (saved, harmed) = newest(root.path(), "x", &"s".repeat(32)).unwrap();
        let saved = saved.unwrap();
        assert!(harmed.is_empty());
        assert_eq!(saved.label, label(generation));
        assert_eq!(saved.read::<u32>("numbers").unwrap(), numbers);
        assert_eq!(saved.read::<u64>("words").unwrap(), words);
        assert!(saved.read::<u32>("words").is_err() && saved.read::<u64>("none").is_err());
    }
    assert!(newest(root.path(), "x", "other").unwrap_err().problem.contains("another scene"));
    assert!(newest(root.path(), "y", "other").unwrap().0.is_none());
}

#[test]
fn sections_of_many_pieces_and_odd_parts_come_back() {
    let root = tempfile::tempdir().unwrap();
    let column: Vec<u32> = (0..(3 * PIECE as u32) / 4 + 17).collect();
    let parts: Vec<&[u32]> = column.chunks(12_345).collect();
    keep(root.path(), "x", &label(1), &[Section::parts("c", parts), Section::new::<u64>("empty", &[])])
        .unwrap();
    let saved = newest(root.path(), "x", &"s".repeat(32)).unwrap().0.unwrap();
    assert_eq!(saved.read::<u32>("c").unwrap(), column);
    assert!(saved.read::<u64>("empty").unwrap().is_empty());
}
