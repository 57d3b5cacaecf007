//! Hostile bytes for every reader: the functions that the fuzz targets call, on files that were changed at random and on bytes
//! made of the words that each reader knows. `scripts/checks/fuzz.sh` goes on for as long as you like.

use std::fs;
use std::path::Path;

use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

#[path = "../readers/mod.rs"]
mod readers;

#[global_allocator]
static BOUNDED: readers::Bounded = readers::Bounded;

/// The seeds of a fuzz target, and what else there is for it.
fn seeds(name: &str, more: &[&str]) -> Vec<Vec<u8>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let own = format!("tests/seeds/{name}");
    let mut paths: Vec<_> = std::iter::once(own.as_str())
        .chain(more.iter().copied())
        .flat_map(|folder| fs::read_dir(root.join(folder)).unwrap())
        .map(|entry| entry.unwrap().path())
        .collect();
    paths.sort();
    let all: Vec<Vec<u8>> = paths.iter().map(|path| fs::read(path).unwrap()).collect();
    assert!(all.len() >= 2, "{name} has {} seeds", all.len());
    all
}

/// Harm to a file: where, how much of it, and what with.
#[derive(Clone, Debug)]
enum Harm {
    Flip(usize, u8),
    Cut(usize),
    Remove(usize, usize),
    Repeat(usize, usize),
    Insert(usize, &'static str),
}

const WORDS: [&str; 24] = [
    "nan",
    "inf",
    "-1",
    "0",
    "1e400",
    "1e-400",
    "18446744073709551616",
    "4294967295",
    "-0.0",
    "\"",
    "'",
    ",",
    ";",
    "\t",
    "\r\n",
    "\n",
    "\u{feff}",
    "\u{0}",
    "\u{202e}",
    "[",
    "]",
    "{",
    "=",
    "#",
];

fn harm() -> impl Strategy<Value = Harm> {
    let at = || any::<usize>();
    prop_oneof![
        (at(), any::<u8>()).prop_map(|(at, byte)| Harm::Flip(at, byte)),
        at().prop_map(Harm::Cut),
        (at(), 1..40usize).prop_map(|(at, length)| Harm::Remove(at, length)),
        (at(), 1..200usize).prop_map(|(at, length)| Harm::Repeat(at, length)),
        (at(), 0..WORDS.len()).prop_map(|(at, word)| Harm::Insert(at, WORDS[word])),
    ]
}

fn damaged(mut bytes: Vec<u8>, harms: &[Harm]) -> Vec<u8> {
    for harm in harms {
        let place = |at: usize| at % (bytes.len() + 1);
        match *harm {
            Harm::Flip(at, byte) => {
                let at = place(at);
                bytes.iter_mut().skip(at).take(1).for_each(|b| *b ^= byte);
            }
            Harm::Cut(at) => bytes.truncate(place(at)),
            Harm::Remove(at, length) => {
                let at = place(at);
                bytes.drain(at..(at + length).min(bytes.len()));
            }
            Harm::Repeat(at, length) => {
                let at = place(at);
                let part = bytes[at..(at + length).min(bytes.len())].to_vec();
                bytes.splice(at..at, part);
            }
            Harm::Insert(at, word) => {
                let at = place(at);
                bytes.splice(at..at, word.bytes());
            }
        }
    }
    bytes
}

/// Every seed as it is, then `cases` damaged ones, from a fixed seed; with `VOIDWALK_FAULTS=all` thirty times as many.
fn check(name: &str, more: &[&str], cases: u32, read: fn(&[u8])) {
    let all = std::env::var("VOIDWALK_FAULTS").is_ok_and(|value| value == "all");
    let cases = if all { 30 * cases } else { cases };
    let seeds = seeds(name, more);
    seeds.iter().for_each(|seed| read(seed));
    read(b"");
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    let strategy = (0..seeds.len(), prop::collection::vec(harm(), 1..6));
    runner
        .run(&strategy, |(seed, harms)| {
            read(&damaged(seeds[seed].clone(), &harms));
            Ok(())
        })
        .unwrap();
}

#[test]
fn scenes() {
    check("scene", &[], 20_000, readers::scene);
}

#[test]
fn sieve_tables() {
    check("sieve", &["tests/bad/sieve"], 10_000, readers::sieve);
}

#[test]
fn files_of_soils() {
    check("soil", &["tests/soils"], 1500, readers::soil);
}

#[test]
fn curves() {
    check("curve", &["tests/bad/curve"], 40_000, readers::curve);
}

#[test]
fn networks() {
    check("network", &[], 40_000, readers::network);
}

#[test]
fn packings_and_dumps() {
    check("packing", &[], 40_000, readers::packing);
}

#[test]
fn graphs_of_voids() {
    check("graph", &["tests/seeds/packing"], 600, readers::graph);
}

#[test]
fn networks_of_columns() {
    check("columns", &[], 20_000, readers::columns);
}

#[test]
fn networks_of_arrays() {
    check("arrays", &[], 6000, readers::arrays);
}

#[test]
fn requests_to_the_page() {
    check("request", &[], 300, readers::request);
}

#[test]
fn checkpoints() {
    check("checkpoint", &[], 15_000, readers::checkpoint);
}

#[test]
fn plans_and_ledgers() {
    check("ledger", &[], 3000, readers::ledger);
}
