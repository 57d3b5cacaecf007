//! Checkpoints whose checksums are right and whose numbers are of no walk: refused with a sentence, before a
//! walk relies on them.

use std::fs;
use std::path::Path;

use voidwalk::store::checkpoint::{Label, newest, save};
use voidwalk::walk::{Engine, Passive, SavedState, State, WalkControl};

use crate::readers::SmallRun;

/// What somebody makes of a state.
type Forge = fn(&mut State);

fn expected(state: &mut State) -> &mut voidwalk::walk::Expected {
    match &mut state.passive {
        Passive::Expected(expected) => expected,
        other => panic!("{other:?}"),
    }
}

fn counts(state: &mut State) -> &mut [u64] {
    match &mut state.passive {
        Passive::Counts(counts) => counts,
        other => panic!("{other:?}"),
    }
}

#[test]
fn numbers_of_no_walk_are_refused() {
    use Engine::{Counts, Expected, Particles};
    let forgeries: [(Engine, &str, Forge); 22] = [
        (Expected, "expectation", |s| expected(s).moving[1] = f64::NAN),
        (Expected, "expectation", |s| expected(s).moving[1] = f64::INFINITY),
        (Expected, "expectation", |s| expected(s).moving[1] = 1e30),
        (Expected, "expectation", |s| expected(s).moving[1] -= 1e9),
        (Expected, "expectation", |s| expected(s).retained[0] = f64::NAN),
        (Expected, "expectation", |s| expected(s).counted_retained[0] = 7_000_000),
        (Expected, "expectation", |s| expected(s).sums.moves = 1e18),
        (Expected, "expectation", |s| expected(s).sums.inserted = u64::MAX),
        (Expected, "expectation", |s| expected(s).sums.counted.eroded = u64::MAX),
        (Counts, "number of moving particles", |s| counts(s)[0] = u64::MAX),
        (Counts, "number of moving particles", |s| counts(s)[0] += 1),
        (Particles, "number of moving particles", |s| s.particles.live[0] -= 1),
        (Particles, "particles of a chunk", |s| s.particles.live[0] += 2000),
        (Particles, "diameter of a particle", |s| s.particles.diameter[0] = f32::NAN),
        (Particles, "diameter of a particle", |s| s.particles.diameter[0] = -1.0),
        (Particles, "void of a particle", |s| s.particles.void[0] = 1 << 30),
        (Particles, "increment", |s| s.increment = u64::MAX),
        (Particles, "increment", |s| s.finished = true),
        (Particles, "number of particles", |s| {
            s.tally.inserted += 1;
            s.tally.eroded += 1;
        }),
        (Particles, "sums", |s| s.tally.trapped = u64::MAX),
        (Particles, "number of retained or eroded", |s| s.eroded_sizes.number[0] = u64::MAX),
        (Particles, "history", |s| s.history.iter_mut().for_each(|b| b.increment = 99)),
    ];
    for (engine, what, forge) in forgeries {
        let run = SmallRun::new(engine);
        let folder = tempfile::tempdir().unwrap();
        for increment in [20, 50] {
            assert!(restored(&run, folder.path(), increment, |_| ()).is_ok(), "{engine:?}, {increment}");
            let refused = restored(&run, folder.path(), increment, forge).unwrap_err();
            assert!(refused.contains(what), "{engine:?}, {what}: {refused}");
            assert!(refused.ends_with("cannot belong to this run"), "{refused}");
        }
    }
}

/// Walks up to an increment, forges the state, saves it with right checksums and loads it again.
fn restored(run: &SmallRun, folder: &Path, until: u64, forge: Forge) -> Result<(), String> {
    let mut state = run.fresh();
    let stopped = run.walk_while(&mut state, |state| match state.increment < until {
        true => WalkControl::Continue,
        false => WalkControl::Stop,
    });
    assert!(stopped.is_err(), "it walks on after increment {until}");
    forge(&mut state);
    let label = Label { identity: SmallRun::identity(), generation: 2, ..Label::default() };
    save(folder, "x", &label, &SavedState::new(&state).sections()).unwrap();
    let (saved, _) = newest(folder, "x", &SmallRun::identity()).unwrap();
    let restored = run.fresh().restore(&run.network, &run.supply, &saved.unwrap());
    fs::remove_file(folder.join("x.0")).unwrap();
    restored.map_err(|error| error.to_string())
}
