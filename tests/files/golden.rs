//! Checkpoints that were saved once and are continued to the same answer; those of another version of the
//! format are refused with a sentence that says so.
//!
//! `cargo test --release --test files -- golden --ignored` writes the files of a new version of the format.

use std::fs;
use std::path::{Path, PathBuf};

use voidwalk::store::checkpoint::{CheckpointError, newest};
use voidwalk::walk::{Engine, State};

use crate::readers::SmallRun;

/// Version of the format.
const VERSION: u32 = 1;
const ENGINES: [(Engine, &str); 3] =
    [(Engine::Particles, "particles"), (Engine::Counts, "counts"), (Engine::Expected, "expected")];

fn golden(engine: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    folder.join(format!("checkpoint-v{VERSION}.{engine}"))
}

/// Everything of a finished state that results follow from, as text.
fn shown(state: &State) -> String {
    format!(
        "{:?}\n{:?}\n{:?}\n{:?}\n{:?}\n{:?}\n{:?}\n{}\n",
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

#[test]
fn saved_walks_are_continued_to_the_same_answer() {
    for (engine, name) in ENGINES {
        let folder = tempfile::tempdir().unwrap();
        fs::copy(golden(name), folder.path().join("x.0")).unwrap();
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
        let answer = fs::read_to_string(golden(name).with_extension(format!("{name}.txt"))).unwrap();
        assert_eq!(shown(&state), answer, "{name}");
    }
}

#[test]
fn checkpoints_of_another_version_of_the_format_are_refused_by_name() {
    for (version, (_, name)) in
        [0, VERSION + 1].into_iter().flat_map(|version| ENGINES.map(|of| (version, of)))
    {
        let folder = tempfile::tempdir().unwrap();
        let mut bytes = fs::read(golden(name)).unwrap();
        bytes[8..12].copy_from_slice(&version.to_le_bytes());
        fs::write(folder.path().join("x.0"), bytes).unwrap();
        let error = newest(folder.path(), "x", &SmallRun::identity()).unwrap_err();
        assert!(matches!(error, CheckpointError::Other { .. }), "{error}");
        let said = format!("checkpoint format {version}; this one reads {VERSION}");
        assert!(error.to_string().contains(&said), "{error}");
    }
}

#[test]
#[ignore = "writes the files that the other test reads"]
fn write_the_checkpoints_of_this_version() {
    for (engine, name) in ENGINES {
        let path = golden(name);
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
