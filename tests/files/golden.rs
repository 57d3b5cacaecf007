//! Checkpoints of every version of the format: those of this version are read and continued to the same
//! answer, older ones are refused with a sentence that says so.
//!
//! A new version of the format adds files and never changes one: `cargo test --release --test files --
//! golden --ignored` writes those of the version at hand.

use std::fs;
use std::path::{Path, PathBuf};

use voidwalk::store::checkpoint::{CheckpointError, newest};
use voidwalk::walk::{Engine, State};

use crate::readers::SmallRun;

/// The version that is read.
const VERSION: u32 = 2;
const ENGINES: [(Engine, &str); 3] =
    [(Engine::Particles, "particles"), (Engine::Counts, "counts"), (Engine::Expected, "expected")];

fn golden(version: u32, engine: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    folder.join(format!("checkpoint-v{version}.{engine}"))
}

/// Everything of a finished state that results follow from, as text.
fn shown(state: &State) -> String {
    // None of these walks has arches, which the files do not know.
    let tally = format!("{:?}", state.tally);
    let tally = tally.replace("retained_in_arches: 0, arches: 0, arched_mass: 0.0, ", "");
    format!(
        "{}\n{:?}\n{:?}\n{:?}\n{:?}\n{:?}\n{:?}\n{}\n",
        tally,
        state.history,
        state.blocked.as_raw_slice(),
        state.retained_in_constrictions,
        state.retained_in_voids,
        state.eroded_sizes,
        state.retained_sizes,
        state.increment
    )
}

#[test]
fn saved_walks_are_continued_to_the_same_answer() {
    for (engine, name) in ENGINES {
        let folder = tempfile::tempdir().unwrap();
        fs::copy(golden(VERSION, name), folder.path().join("x.0")).unwrap();
        let (saved, passed_over) = newest(folder.path(), "x", &SmallRun::identity()).unwrap();
        assert!(passed_over.is_empty(), "{passed_over:?}");
        let saved = saved.unwrap();
        assert_eq!(saved.label.increment, 50);
        assert_eq!(saved.read::<u8>("done").unwrap(), b"{\"complete\":false}");
        let run = SmallRun::new(engine);
        let mut state = run.fresh();
        state.restore(&run.network, &run.supply, &saved).unwrap();
        assert_eq!(state.increment, 50);
        run.walk(&mut state, None);
        let answer =
            |version| fs::read_to_string(golden(version, name).with_extension(format!("{name}.txt")));
        assert_eq!(shown(&state), answer(VERSION).unwrap(), "{name}");
        // The format changed, the walk did not.
        assert_eq!(answer(VERSION).unwrap(), answer(1).unwrap(), "{name}");
    }
}

#[test]
fn checkpoints_of_earlier_versions_are_refused_by_name() {
    for version in 1..VERSION {
        for (_, name) in ENGINES {
            let folder = tempfile::tempdir().unwrap();
            fs::copy(golden(version, name), folder.path().join("x.0")).unwrap();
            let error = newest(folder.path(), "x", &SmallRun::identity()).unwrap_err();
            assert!(matches!(error, CheckpointError::OtherVersion { .. }), "{error}");
            let said = format!(
                "{}: was written by an earlier version of voidwalk (checkpoint format {version}; this one reads \
                 {VERSION}), which can finish it",
                folder.path().join("x.0").display()
            );
            assert_eq!(error.to_string(), said);
        }
    }
}

#[test]
#[ignore = "writes the files that the other test reads"]
fn write_the_checkpoints_of_this_version() {
    for (engine, name) in ENGINES {
        let path = golden(VERSION, name);
        assert!(!path.exists(), "{} is there and stays as it is", path.display());
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        let (folder, run) = (tempfile::tempdir().unwrap(), SmallRun::new(engine));
        let mut state = run.fresh();
        run.walk(&mut state, Some((folder.path(), 50)));
        assert!(state.tally.retained_in_constrictions > 0 && state.increment > 60, "{:?}", state.tally);
        fs::copy(folder.path().join("x.0"), &path).unwrap();
        fs::write(path.with_extension(format!("{name}.txt")), shown(&state)).unwrap();
    }
}
