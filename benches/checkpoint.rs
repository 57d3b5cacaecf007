//! Cost of a checkpoint of a long run, against writing and syncing the same bytes, and cost of resuming,
//! against reading them.
//!
//! `cargo bench --bench checkpoint -- FOLDER [N]` walks N particles (2e8 unless said otherwise; 8 bytes each
//! in memory and twice on the disk) one by one, keeps the walk after each of seven increments with all of
//! them moving, in turns with a plain file of the same bytes that takes its place in the same way, and goes
//! on from the last one. Seconds, by increment; in the first two the disk has not held any of the files
//! before, so they do not count. `cpu` is the processor time of all threads. Files go into FOLDER and are
//! removed.

use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;
use std::time::Instant;

use voidwalk::constrictions;
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::Network;
use voidwalk::store::checkpoint::{Identity, Label, newest, save};
use voidwalk::walk::{Engine, RunPlan, SavedState, SizeClasses, State, Walk, WalkControl};

const SEED: u64 = 1;
/// With two that do not count.
const ROUNDS: u64 = 7;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let [folder, rest @ ..] = &arguments[..] else {
        eprintln!("usage: checkpoint FOLDER [N]");
        std::process::exit(2);
    };
    let folder = tempfile::tempdir_in(folder).expect("a folder");
    let n = rest.first().map_or(200_000_000, |text| text.parse().expect("a whole number"));
    let curve = constrictions::find("shire2016-cu1.5-loose").unwrap().curve().unwrap();
    let network = Network::cubic([40, 40, 60], &curve, 1.0, SEED).unwrap();
    let base = Gradation::linear_from_dx(85.0, curve.dc(5.0).unwrap(), 1.5).unwrap();
    let sampler = SizeSampler::new(&base, 1.0).unwrap();
    let open = bitvec::vec::BitVec::repeat(false, network.constrictions());
    // All in the first increment, so that all are moving.
    let plan = RunPlan::new(Engine::Particles, &network, &sampler, &open, n);
    let supply = plan.supply(sampler.clone(), n, 1, SEED, 1);
    let fresh = || {
        let classes = SizeClasses::logarithmic(sampler.smallest(), sampler.largest(), 64);
        State::new(&network, &supply, classes, open.clone(), SEED, 1)
    };
    let mut state = fresh();
    println!("round,moving,bytes,checkpoint_s,checkpoint_cpu_s,plain_s,plain_cpu_s,ratio");
    let result = Walk::new(&network, &supply, &state).run(&mut state, &mut |state| {
        let ([checkpoint, cpu], bytes) = timed(|| kept(folder.path(), state));
        let ([plain, plain_cpu], ()) = timed(|| plain(folder.path(), state, bytes));
        let (round, moving) = (state.increment, state.tally.moving);
        let ratio = checkpoint / plain;
        println!("{round},{moving},{bytes},{checkpoint:.3},{cpu:.3},{plain:.3},{plain_cpu:.3},{ratio:.3}");
        if round < ROUNDS { WalkControl::Continue } else { WalkControl::Stop }
    });
    assert!(result.is_err(), "it was stopped");
    let (moving, increment) = (state.tally.moving, state.increment);
    drop(state);
    println!("round,bytes,plain_read_s,resume_s,resume_cpu_s,more_s");
    let path = folder.path().join(format!("x.{}", ROUNDS % 2));
    for round in 1..=5 {
        forget(&path);
        let ([read, _], bytes) = timed(|| read(&path));
        forget(&path);
        let ([resume, cpu], state) = timed(|| {
            let saved = newest(folder.path(), "x", &Identity::default()).unwrap().0.unwrap();
            let mut state = fresh();
            state.restore(&network, &supply, &saved).unwrap();
            state
        });
        assert_eq!((state.tally.moving, state.increment), (moving, increment));
        println!("{round},{bytes},{read:.3},{resume:.3},{cpu:.3},{:.3}", resume - read);
    }
}

/// Wall and processor time (s), and the result of the work.
fn timed<T>(work: impl FnOnce() -> T) -> ([f64; 2], T) {
    let cpu = || {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
        time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
    };
    let (begin, spent) = (Instant::now(), cpu());
    let value = work();
    ([begin.elapsed().as_secs_f64(), cpu() - spent], value)
}

/// Keeps the walk; gives the length of the file.
fn kept(folder: &Path, state: &State) -> u64 {
    let label = Label { generation: state.increment, run: 1, ..Label::default() };
    save(folder, "x", &label, &SavedState::new(state).sections()).unwrap();
    folder.join(format!("x.{}", state.increment % 2)).metadata().unwrap().len()
}

/// A plain file with the same columns, filled up to the same length, and synced.
fn plain(folder: &Path, state: &State, bytes: u64) {
    let beside = folder.join("plain");
    let mut file = File::create(&beside).unwrap();
    let mut left = bytes;
    let mut write = |part: &[u8]| {
        left -= part.len() as u64;
        file.write_all(part).unwrap();
    };
    for chunk in 0..state.particles.live.len() {
        write(bytemuck::cast_slice(state.particles.chunk(chunk).0));
    }
    for chunk in 0..state.particles.live.len() {
        write(bytemuck::cast_slice(state.particles.chunk(chunk).1));
    }
    file.write_all(&vec![0; left as usize]).unwrap();
    file.sync_all().unwrap();
    std::fs::rename(beside, folder.join(format!("plain.{}", state.increment % 2))).unwrap();
}

/// Takes a file out of the memory that the system keeps of the disk.
fn forget(path: &Path) {
    let file = File::open(path).unwrap();
    file.sync_all().unwrap();
    rustix::fs::fadvise(&file, 0, None, rustix::fs::Advice::DontNeed).unwrap();
}

fn read(path: &Path) -> u64 {
    let mut file = File::open(path).unwrap();
    let mut piece = vec![0; 1 << 20];
    let mut bytes = 0;
    loop {
        match file.read(&mut piece).unwrap() {
            0 => return bytes,
            now => bytes += now as u64,
        }
    }
}
