//! Checkpoints of every version of the format, which must be read and gone on from to the same answer for ever.
//!
//! A new version of the format adds a file and never changes one: `cargo test --release --test golden -- --ignored` writes that of
//! the version at hand.

use std::fs;
use std::path::{Path, PathBuf};

use voidwalk::store::checkpoint::newest;
use voidwalk::walk::{Engine, State};

mod readers;

use readers::SmallRun;

const VERSION: u32 = 1;
const ENGINES: [(Engine, &str); 3] =
    [(Engine::Particles, "particles"), (Engine::Counts, "counts"), (Engine::Expected, "expected")];

fn golden(version: u32, engine: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    folder.join(format!("checkpoint-v{version}.{engine}"))
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
fn old_checkpoints_are_gone_on_from_to_the_same_answer() {
    let mut tried = 0;
    for version in 1..=VERSION {
        for (engine, name) in ENGINES {
            let folder = tempfile::tempdir().unwrap();
            fs::copy(golden(version, name), folder.path().join("x.0")).unwrap();
            let (saved, harmed) = newest(folder.path(), "x", "small").unwrap();
            assert!(harmed.is_empty(), "{harmed:?}");
            let mut saved = saved.unwrap();
            assert_eq!(saved.label.increment, 50);
            assert_eq!(saved.read::<u8>("done").unwrap(), b"{\"complete\":false}");
            let run = SmallRun::new(engine);
            let mut state = run.fresh();
            state.restore(&run.network, &mut saved).unwrap();
            assert_eq!(state.increment, 50);
            run.walk(&mut state, None);
            let answer =
                fs::read_to_string(golden(version, name).with_extension(format!("{name}.txt"))).unwrap();
            assert_eq!(shown(&state), answer, "version {version}, {name}");
            tried += 1;
        }
    }
    assert_eq!(tried, 3);
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
