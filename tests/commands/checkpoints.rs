//! Runs that are stopped, killed and resumed: at every increment, on other threads, with corrupt checkpoints.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use bitvec::vec::BitVec;
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::{ExitRule, Network};
use voidwalk::store::checkpoint::{Identity, Label, newest, save};
use voidwalk::walk::{Engine, RunPlan, SavedState, SizeClasses, State, Supply, Walk, WalkControl};

use crate::program::{call, voidwalk};
use crate::small_run::{outcome, without_seconds};

/// A lattice on which a graded base blocks and passes.
fn network(seed: u64) -> Network {
    let curve = voidwalk::constrictions::find("shire2016-cu1.5-loose").unwrap().curve().unwrap();
    Network::cubic([6, 5, 7], &curve.in_mm(1.0).unwrap(), 1.0, seed).unwrap()
}

fn fresh(network: &Network, supply: &Supply, blocked: &BitVec, seed: u64, run: u64) -> State {
    let classes = SizeClasses::logarithmic(0.1, 0.3, 16);
    State::new(network, supply, classes, blocked.clone(), seed, run)
}

/// Everything of a finished state that results follow from, as text.
fn shown(state: &State) -> String {
    format!(
        "{:?} {:?} {:?} {:?} {:?} {:?} {:?} {}",
        state.tally,
        state.history,
        state.blocked.as_raw_slice(),
        state.retained_in_constrictions,
        state.retained_in_voids,
        state.eroded_sizes,
        state.retained_sizes,
        state.increment
    )
}

/// So much base that voids lose all their exits between two solutions of the flow, and their particles wait: what
/// waits is known after any increment.
#[test]
fn a_walk_with_flow_goes_on_while_particles_wait() {
    let root = tempfile::tempdir().unwrap();
    // The flow is solved every ten increments: so many wait.
    let network = network(4).undirected_lattice(ExitRule::Flux, 0.0, 4.0).unwrap().with_flow_tolerance(1e9);
    let open: BitVec = BitVec::repeat(false, network.constrictions());
    for (engine, cu, n) in
        [(Engine::Particles, 1.2, 3_000), (Engine::Counts, 2.0, 150_000), (Engine::Expected, 2.0, 150_000)]
    {
        let gradation = Gradation::linear_from_dx(85.0, 0.33, cu).unwrap();
        let sampler = SizeSampler::new(&gradation, 1.0).unwrap();
        let supply = RunPlan::new(engine, &network, &sampler, &open, n / 50).supply(sampler, n, 50, 3, 1);
        let mut whole = fresh(&network, &supply, &open, 3, 1);
        Walk::new(&network, &supply, &whole)
            .run(&mut whole, &mut |state| {
                let label = Label { generation: state.increment, ..Label::default() };
                let folder = root.path().join(format!("{engine:?}-{}", state.increment));
                fs::create_dir(&folder).unwrap();
                save(&folder, "x", &label, &SavedState::new(state).sections()).unwrap();
                WalkControl::Continue
            })
            .unwrap();
        assert!(whole.tally.blocked > 50 && whole.tally.retained_in_voids > 20, "{:?}", whole.tally);
        for increment in 1..whole.increment {
            let folder = root.path().join(format!("{engine:?}-{increment}"));
            let saved = newest(&folder, "x", &Identity::default()).unwrap().0.unwrap();
            let mut state = fresh(&network, &supply, &open, 3, 1);
            state.restore(&network, &supply, &saved).unwrap();
            let mut walk = Walk::new(&network, &supply, &state);
            walk.run(&mut state, &mut |_| WalkControl::Continue).unwrap();
            assert_eq!(shown(&state), shown(&whole), "{engine:?}, from increment {increment}");
        }
    }
}

#[test]
fn a_walk_goes_on_from_every_increment_with_every_engine_on_any_threads() {
    let root = tempfile::tempdir().unwrap();
    let gradation = Gradation::linear_from_dx(85.0, 0.2, 3.0).unwrap();
    let flowing = network(4).undirected_lattice(ExitRule::Flux, 0.0, 4.0).unwrap();
    for (engine, network) in [
        (Engine::Particles, network(4)),
        (Engine::Counts, network(4)),
        (Engine::Expected, network(4)),
        (Engine::Particles, flowing.clone()),
        (Engine::Counts, flowing.clone()),
        (Engine::Expected, flowing),
    ] {
        let seed = 11;
        let open: BitVec = BitVec::repeat(false, network.constrictions());
        let supply_of = |blocked: &BitVec, run| {
            let sampler = SizeSampler::new(&gradation, 1.0).unwrap();
            RunPlan::new(engine, &network, &sampler, blocked, 700).supply(sampler, 70_000, 100, seed, run)
        };
        let first_supply = supply_of(&open, 1);
        let mut first = fresh(&network, &first_supply, &open, seed, 1);
        Walk::new(&network, &first_supply, &first).run(&mut first, &mut |_| WalkControl::Continue).unwrap();
        // The second run, which begins on what the first left blocked, is the one that is broken off.
        let supply = supply_of(&first.blocked, 2);
        let mut whole = fresh(&network, &supply, &first.blocked, seed, 2);
        let name = format!("{engine:?}-{}", network.exit_rule().name());
        let mut splits = 0;
        Walk::new(&network, &supply, &whole)
            .run(&mut whole, &mut |state| {
                // Long tails are cut at every seventh increment only.
                if state.increment <= 110 || state.increment % 7 == 0 {
                    let label = Label { generation: state.increment, ..Label::default() };
                    let folder = root.path().join(format!("{name}-{}", state.increment));
                    fs::create_dir(&folder).unwrap();
                    save(&folder, "x", &label, &SavedState::new(state).sections()).unwrap();
                    splits += 1;
                }
                WalkControl::Continue
            })
            .unwrap();
        assert!(splits > 100 && whole.tally.blocked > first.tally.blocked, "{engine:?}: {splits} splits");
        for increment in 1..=whole.increment {
            let folder = root.path().join(format!("{name}-{increment}"));
            if !folder.exists() {
                continue;
            }
            let saved = newest(&folder, "x", &Identity::default()).unwrap().0.unwrap();
            let mut state = fresh(&network, &supply, &first.blocked, seed, 2);
            state.restore(&network, &supply, &saved).unwrap();
            let threads = [1, 2, 3, 8][increment as usize % 4];
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut walk = Walk::new(&network, &supply, &state);
                if !state.finished {
                    walk.run(&mut state, &mut |_| WalkControl::Continue).unwrap();
                }
            });
            assert_eq!(shown(&state), shown(&whole), "{engine:?}, from increment {increment}");
        }
    }
}

#[test]
fn a_state_of_another_run_is_refused() {
    let root = tempfile::tempdir().unwrap();
    let (network, gradation) = (network(4), Gradation::linear_from_dx(85.0, 0.2, 3.0).unwrap());
    let open: BitVec = BitVec::repeat(false, network.constrictions());
    let supply = |engine, n| {
        let sampler = SizeSampler::new(&gradation, 1.0).unwrap();
        RunPlan::new(engine, &network, &sampler, &open, n / 100).supply(sampler, n, 100, 1, 1)
    };
    let particles = supply(Engine::Particles, 40_000);
    let state = fresh(&network, &particles, &open, 1, 1);
    save(root.path(), "x", &Label::default(), &SavedState::new(&state).sections()).unwrap();
    let counts = supply(Engine::Counts, 40_000);
    let fewer = supply(Engine::Particles, 20_000);
    for (other_supply, seed, run) in [(&particles, 2, 1), (&particles, 1, 2), (&counts, 1, 1), (&fewer, 1, 1)]
    {
        let mut other = fresh(&network, other_supply, &open, seed, run);
        let saved = newest(root.path(), "x", &Identity::default()).unwrap().0.unwrap();
        assert!(other.restore(&network, other_supply, &saved).is_err());
    }
}

// From here on: the program.

const SCENE: &str = "seed = 3\nreplicates = 3\nengine = \"particles\"\n[filter]\ncurve = \"shire2016-cu1.5-loose\"\n[base]\ncu = 1.5\n\
    d85_at_dc = 5\nn_base = 150000\n[network]\nnx = 8\nny = 8\nnz = 10\n[record]\nsensitivity = [0.5, 2.0]\n";

fn with_scene() -> (tempfile::TempDir, PathBuf) {
    // On a disk in memory, where there is one, a checkpoint every few milliseconds is no matter.
    let memory = Path::new("/dev/shm");
    let root = if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() }.unwrap();
    fs::write(root.path().join("scene.toml"), SCENE).unwrap();
    let path = root.path().to_owned();
    (root, path)
}

/// What must not depend on how often the program was started.
fn lasting(folder: &Path) -> Vec<String> {
    let outcome = without_seconds(outcome(folder));
    let files = ["series.csv", "layers.csv", "retained.csv", "eroded.csv", "scene.toml"];
    let mut all: Vec<String> = files.map(|name| fs::read_to_string(folder.join(name)).unwrap()).to_vec();
    all.push(outcome.to_string());
    all
}

#[test]
fn a_run_goes_on_after_stops_and_kills_with_the_same_bits() {
    let (_root, at) = with_scene();
    assert!(call(&at, &["run", "scene.toml", "--out", "whole"]).status.success());
    let (mut stops, mut kills) = (0, 0);
    for attempt in 0..300u64 {
        let threads = ["1", "2", "3"][attempt as usize % 3];
        let begun = attempt > 0 && at.join("broken/scene.toml").exists();
        let args = match begun {
            true => vec!["resume", "broken", "--checkpoint-every", "5ms", "--threads", threads],
            false => vec![
                "run",
                "scene.toml",
                "--out",
                "broken",
                "--checkpoint-every",
                "5ms",
                "--threads",
                threads,
            ],
        };
        let mut child = voidwalk(&at, &args).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(30 + 13 * (attempt % 7)));
        let signal = if attempt % 2 == 0 { "-TERM" } else { "-KILL" };
        let _ = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
        match child.wait().unwrap().code() {
            // 2: it was finished already.
            Some(0 | 2) => break,
            Some(3) => stops += 1,
            None => kills += 1,
            code => panic!("{code:?}"),
        }
    }
    if at.join("broken/checkpoint").exists() {
        let output = call(&at, &["resume", "broken"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    assert!(stops + kills >= 3, "{stops} stops and {kills} kills: the run is too short to be broken");
    assert_eq!(lasting(&at.join("whole")), lasting(&at.join("broken")));
    let digest = |name: &str| outcome(&at.join(name))["digest"].as_str().map(str::to_owned);
    assert!(digest("whole").is_some() && digest("whole") == digest("broken"));
    assert!(!at.join("broken/checkpoint").exists());
}

#[test]
fn a_request_before_any_work_ends_a_run_at_once() {
    let root = tempfile::tempdir().unwrap();
    let long = ["nx=120", "ny=120", "nz=120", "connectivity={5=50,7=50}"].map(|set| format!("network.{set}"));
    let mut args = vec!["run", "--out", "run", "--set", "base.n_base=1000"];
    long.iter().for_each(|set| args.extend(["--set", set]));
    let mut child = voidwalk(root.path(), &args).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(700));
    let _ = Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap();
    let asked = Instant::now();
    // Nothing is saved: it ends by the signal.
    assert_eq!(child.wait().unwrap().code(), None);
    assert!(asked.elapsed() < Duration::from_secs(3) && !root.path().join("run").exists());
}

/// A run that was stopped on its way; the folder holds its checkpoints.
fn stopped(at: &Path) -> PathBuf {
    let mut wait = 60;
    loop {
        let mut child = voidwalk(
            at,
            &["run", "scene.toml", "--out", "run", "--checkpoint-every", "5ms", "--threads", "1"],
        )
        .spawn()
        .unwrap();
        std::thread::sleep(Duration::from_millis(wait));
        let _ = Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap();
        if child.wait().unwrap().code() == Some(3) && at.join("run/checkpoint/0-1.1").exists() {
            return at.join("run");
        }
        let _ = fs::remove_dir_all(at.join("run"));
        wait = (wait * 3 / 2) % 1000 + 10;
    }
}

#[test]
fn a_corrupt_checkpoint_is_passed_over_or_refused_and_never_lost() {
    let (_root, at) = with_scene();
    assert!(call(&at, &["run", "scene.toml", "--out", "whole"]).status.success());
    let run = stopped(&at);
    // A run of another scene leaves it alone.
    let other = call(&at, &["run", "scene.toml", "--out", "run", "--seed", "9"]);
    assert_eq!(other.status.code(), Some(2), "{}", String::from_utf8_lossy(&other.stderr));
    assert!(String::from_utf8_lossy(&other.stderr).contains("another scene"));
    // Change a bit of the newest slot of the first replicate: the one before is taken, and said so.
    let slots = ["0-1.0", "0-1.1"].map(|name| run.join("checkpoint").join(name));
    let both = slots.iter().all(|slot| slot.exists());
    let generation = |slot: &PathBuf| {
        fs::read(slot).ok().map_or(0, |bytes| u64::from_le_bytes(bytes[120..128].try_into().unwrap()))
    };
    let newest = slots.iter().max_by_key(|slot| generation(slot)).unwrap();
    let mut bytes = fs::read(newest).unwrap();
    let last = bytes.len() - 1;
    bytes[last] ^= 1;
    fs::write(newest, &bytes).unwrap();
    let output = call(&at, &["resume", "run", "--checkpoint-every", "10min"]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    if both {
        assert!(output.status.success() && stderr.contains("the checkpoint before it was used"), "{stderr}");
        assert_eq!(lasting(&at.join("whole")), lasting(&run));
    } else {
        assert_eq!(output.status.code(), Some(2), "{stderr}");
    }
    let again = call(&at, &["resume", "run"]);
    assert_eq!(again.status.code(), Some(2));
}

#[test]
fn of_many_starts_on_one_folder_one_wins_and_the_others_name_it() {
    let (_root, at) = with_scene();
    let args = ["run", "scene.toml", "--set", "base.n_base=50000000", "--threads", "1", "--out", "one"];
    let mut children: Vec<Child> = (0..24).map(|_| voidwalk(&at, &args).spawn().unwrap()).collect();
    // The others leave; whoever is left is the one.
    let mut ended = Vec::new();
    while ended.len() < 23 {
        let gone = children.iter_mut().position(|child| child.try_wait().unwrap().is_some());
        match gone {
            Some(place) => ended.push(children.remove(place).wait_with_output().unwrap()),
            None => std::thread::sleep(Duration::from_millis(5)),
        }
    }
    let winner = children[0].id();
    for output in &ended {
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{stderr}");
        assert!(stderr.contains("another run writes to this folder"), "{stderr}");
    }
    let late = call(&at, &args);
    let stderr = String::from_utf8_lossy(&late.stderr);
    assert!(late.status.code() == Some(2) && stderr.contains(&format!("process {winner} on")), "{stderr}");
    let _ = Command::new("kill").args(["-TERM", &winner.to_string()]).status().unwrap();
    assert_eq!(children[0].wait().unwrap().code(), Some(3));
}

#[test]
fn resume_of_what_is_no_run_is_refused() {
    let (_root, at) = with_scene();
    fs::create_dir(at.join("empty")).unwrap();
    let output = call(&at, &["resume", "empty"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("holds no scene.toml"));
}
