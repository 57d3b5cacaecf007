//! Checkpoints that are read back, and refused ones.

use std::path::Path;

use super::section::PIECE;
use super::*;

fn identity() -> Identity {
    Identity { scene: "s".repeat(32), part: 3, replicate: 2, seed: 1, n_base: u64::MAX }
}

fn label(generation: u64) -> Label {
    Label { identity: identity(), network: 7, run: 1, increment: 9, generation }
}

fn saved(folder: &Path, generation: u64) -> (Vec<u32>, Vec<u64>) {
    let numbers: Vec<u32> = (0..1000).map(|i| i * generation as u32).collect();
    let words = vec![generation; 3];
    let (a, b) = numbers.split_at(400);
    save(
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
        let (numbers, words) = saved(root.path(), generation);
        let (checkpoint, refused) = newest(root.path(), "x", &identity()).unwrap();
        let checkpoint = checkpoint.unwrap();
        assert!(refused.is_empty());
        assert_eq!(checkpoint.label, label(generation));
        assert_eq!(checkpoint.read::<u32>("numbers").unwrap(), numbers);
        assert_eq!(checkpoint.read::<u64>("words").unwrap(), words);
        assert!(checkpoint.read::<u32>("words").is_err() && checkpoint.read::<u64>("none").is_err());
    }
    let other = Identity { scene: "other".into(), ..identity() };
    assert!(matches!(newest(root.path(), "x", &other), Err(CheckpointError::OtherScene { .. })));
    assert!(newest(root.path(), "y", &other).unwrap().0.is_none());
}

/// A walk of the same scene is another walk if any part of its name differs.
#[test]
fn another_walk_of_the_same_scene_is_refused() {
    let root = tempfile::tempdir().unwrap();
    saved(root.path(), 1);
    for other in [
        Identity { part: 0, ..identity() },
        Identity { replicate: 1, ..identity() },
        Identity { seed: 2, ..identity() },
        Identity { n_base: 5, ..identity() },
    ] {
        let error = newest(root.path(), "x", &other).unwrap_err();
        assert!(matches!(error, CheckpointError::OtherWalk { .. }), "{error}");
        let message = error.to_string();
        let both = message.contains(&identity().to_string()) && message.contains(&other.to_string());
        assert!(both && message.contains("x.1: is of another walk of this scene"), "{message}");
    }
}

#[test]
fn sections_of_many_pieces_and_odd_parts_come_back() {
    let root = tempfile::tempdir().unwrap();
    let column: Vec<u32> = (0..(3 * PIECE as u32) / 4 + 17).collect();
    let parts: Vec<&[u32]> = column.chunks(12_345).collect();
    save(root.path(), "x", &label(1), &[Section::parts("c", parts), Section::new::<u64>("empty", &[])])
        .unwrap();
    let saved = newest(root.path(), "x", &identity()).unwrap().0.unwrap();
    assert_eq!(saved.read::<u32>("c").unwrap(), column);
    assert!(saved.read::<u64>("empty").unwrap().is_empty());
}
