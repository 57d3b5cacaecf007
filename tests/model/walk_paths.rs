//! Whole runs by every kernel, number of threads and kind of memory: the same bits.

use std::borrow::Cow;
use std::sync::Arc;

use bitvec::vec::BitVec;
use voidwalk::constrictions::{self, Curve, CurveUnit};
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::Network;
use voidwalk::store::{Column, Placement};
use voidwalk::walk::{
    CHUNK, Isa, PlainExits, Sampling, SizeClasses, State, Supply, Walk, WalkControl, threads,
};

/// Two runs of `n` particles of a base with D85 = Dc`percent`: every column after increments 7 and 60, and at
/// the end.
fn columns(isa: Isa, placement: &Placement, n: u64, cu: f64, percent: f64) -> Vec<String> {
    sampled(Sampling::Independent, isa, placement, n, cu, percent)
}

fn sampled(
    sampling: Sampling,
    isa: Isa,
    placement: &Placement,
    n: u64,
    cu: f64,
    percent: f64,
) -> Vec<String> {
    let curve = constrictions::find("shire2016-cu1.5-loose").unwrap().curve().unwrap();
    let network = Network::cubic([12, 10, 15], &curve, 1.0, 5).unwrap();
    let base = Gradation::linear_from_dx(85.0, curve.dc(percent).unwrap(), cu).unwrap();
    let sampler = SizeSampler::new(&base, 1.0).unwrap();
    let mut blocked = BitVec::repeat(false, network.constrictions());
    let mut seen = Vec::new();
    for run in 1..=2 {
        let classes = SizeClasses::logarithmic(sampler.smallest(), sampler.largest(), 32);
        let supply = match sampling {
            Sampling::Independent => Supply::new(sampler.clone(), n, 30),
            Sampling::Stratified => Supply::new(sampler.clone(), n, 30).stratified(3, run),
        };
        let mut state = State::placed(placement, &network, &supply, classes, blocked, 3, run).unwrap();
        let mut note = |state: &State| {
            let chunks = 0..state.particles.live.len();
            let columns: Vec<_> = chunks.map(|chunk| state.particles.chunk(chunk)).collect();
            let digest = xxhash_rust::xxh3::xxh3_64(format!("{columns:?}").as_bytes());
            let rest = (&state.tally, &state.history, &state.eroded_sizes, &state.retained_sizes);
            let retained = (&state.retained_in_constrictions, &state.retained_in_voids);
            seen.push(format!("{digest:x} {rest:?} {retained:?} {}", state.increment));
        };
        let mut walk = Walk::new(&network, &supply, &state).with_isa(isa);
        walk.run(&mut state, &mut |state| {
            if [7, 60].contains(&state.increment) {
                note(state);
            }
            WalkControl::Continue
        })
        .unwrap();
        note(&state);
        assert_eq!(state.tally.inserted, n);
        blocked = state.blocked;
    }
    seen
}

#[test]
fn kernels_and_threads_change_no_bit() {
    let several_chunks = 6 * CHUNK as u64 + 4321;
    for (n, cu, percent) in
        [(several_chunks, 4.5, 5.0), (several_chunks, 1.5, 50.0), (20_001, 3.0, 25.0), (33, 1.5, 10.0)]
    {
        let expected =
            threads(1, false).unwrap().install(|| columns(Isa::Portable, &Placement::Memory, n, cu, percent));
        for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
            for count in [1, 2, 3] {
                let pool = threads(count, false).unwrap();
                let seen = pool.install(|| columns(isa, &Placement::Memory, n, cu, percent));
                assert!(seen == expected, "{isa:?}, {count} threads, N = {n}");
            }
        }
    }
}

/// Particles that know their place in the increment know it whatever chunk, thread or kernel they are in.
#[test]
fn stratified_particles_are_the_same_on_every_path() {
    let n = 3 * CHUNK as u64 + 4321;
    let walked = |threads_wanted, isa| {
        let pool = threads(threads_wanted, false).unwrap();
        pool.install(|| sampled(Sampling::Stratified, isa, &Placement::Memory, n, 3.0, 15.0))
    };
    let expected = walked(1, Isa::Portable);
    for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
        for count in [2, 3] {
            assert!(walked(count, isa) == expected, "{isa:?}, {count} threads");
        }
    }
}

/// A base of one size keeps no column of diameters: the same as with a full one, by every kernel and on several threads.
#[test]
fn one_size_needs_no_column_of_diameters() {
    let curve = constrictions::find("shire2016-cu1.5-loose").unwrap().curve().unwrap();
    let network = Network::cubic([12, 10, 15], &curve, 1.0, 5).unwrap();
    let size = curve.dc(8.0).unwrap();
    let sampler = SizeSampler::new(&Gradation::single(size).unwrap(), 1.0).unwrap();
    let n = 5 * CHUNK as u64 + 4321;
    let walked = |isa: Isa, full: bool| {
        let classes = SizeClasses::logarithmic(sampler.smallest(), sampler.largest(), 32);
        let supply = Supply::new(sampler.clone(), n, 30);
        let blocked = BitVec::repeat(false, network.constrictions());
        let mut state = State::new(&network, &supply, classes, blocked, 3, 1);
        assert_eq!((state.particles.void.len(), state.particles.diameter.len()), (6 * CHUNK, CHUNK));
        if full {
            state.particles.diameter = Column::zeroed(6 * CHUNK, &Placement::Memory).unwrap();
        }
        let mut seen = Vec::new();
        Walk::new(&network, &supply, &state)
            .with_isa(isa)
            .run(&mut state, &mut |state| {
                let chunks = 0..state.particles.live.len();
                let columns: Vec<_> = chunks.map(|chunk| state.particles.chunk(chunk)).collect();
                seen.push(xxhash_rust::xxh3::xxh3_64(format!("{columns:?} {:?}", state.tally).as_bytes()));
                WalkControl::Continue
            })
            .unwrap();
        assert!(state.tally.blocked > 0 && state.tally.inserted == n);
        (seen, state.history.clone(), state.retained_in_constrictions.clone(), state.eroded_sizes.clone())
    };
    let expected = threads(1, false).unwrap().install(|| walked(Isa::Portable, true));
    for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
        for count in [1, 2] {
            let pool = threads(count, false).unwrap();
            assert!(pool.install(|| walked(isa, false)) == expected, "{isa:?}, {count} threads");
        }
    }
}

/// Columns in mapped files, with the instructions that this machine walks with, against columns in memory.
#[test]
fn mapped_files_change_no_bit() {
    let folder = tempfile::tempdir().unwrap();
    let several_chunks = 6 * CHUNK as u64 + 4321;
    let on = |placement: &Placement| {
        threads(2, false).unwrap().install(|| columns(Isa::chosen(), placement, several_chunks, 4.5, 5.0))
    };
    assert!(on(&Placement::Memory) == on(&Placement::Mapped(folder.path().to_owned())));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// Exits that are known of another network, or of other blocked constrictions, of the same numbers.
#[test]
fn exits_of_another_network_or_blocked_set_are_not_taken() {
    let curve = Curve::from_points(&[(0.0, 0.1), (100.0, 0.3)], CurveUnit::Mm).unwrap();
    let [network, other] =
        [7, 8].map(|seed| Arc::new(Network::cubic([8, 8, 12], &curve, 1.0, seed).unwrap()));
    let sampler = SizeSampler::new(&Gradation::linear_from_d0(0.08, 1.5).unwrap(), 1.0).unwrap();
    let supply = Supply::new(sampler, 20_000, 100);
    let open: BitVec = BitVec::repeat(false, network.constrictions());
    let classes = SizeClasses::logarithmic(0.08, 0.18, 16);
    let walked = |known: Option<&PlainExits>, blocked: &BitVec| {
        let mut state = State::new(&network, &supply, classes.clone(), blocked.clone(), 7, 1);
        let mut walk = Walk::with_exits(&network, &supply, &state, known.map(Cow::Borrowed));
        walk.run(&mut state, &mut |_| WalkControl::Continue).unwrap();
        let (_, _, exits) = walk.end(&state).unwrap();
        (state.tally, state.blocked, exits.unwrap())
    };
    let (first, blocked, left) = walked(None, &open);
    for known in [PlainExits::unblocked(&network), PlainExits::unblocked(&other)] {
        assert_eq!(walked(Some(&known), &open).0, first);
    }
    // As many constrictions are blocked, and others.
    let mut shifted = blocked.clone();
    shifted.rotate_left(1);
    assert_ne!(walked(None, &shifted).0, walked(None, &blocked).0);
    for blocked in [&blocked, &shifted] {
        assert_eq!(walked(Some(&left), blocked).0, walked(None, blocked).0);
    }
}
