//! Kills at every change of a name (rename, removal, new folder), in all commands that write a folder, `--overwrite` and a
//! second command on the same folder included. What is found afterwards is the old work whole, or is continued by the same
//! command or `resume`; then the whole folder, its page too, is that of unbroken work but for times, host, threads and command.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::{FILTER, RUN, SCENE, TIMES, Work, call, copy, is_all, lasting, room, stderr};

const WITH_FILES: &str = "seed = 4\nreplicates = 2\nengine = \"particles\"\n[filter]\ncurve = \"shire2016-cu1.5-loose\"\n\
    sieve = \"filter.csv\"\ngrains_per_void = 0.6\n[base]\nsieve = \"base.csv\"\nn_base = 1000\n\
    [network]\nnx = 4\nny = 4\nnz = 5\n[record]\nsensitivity = [2.0]\nsensitivity_replicates = 1\n";
const PACKED: &str = "seed = 5\nreplicates = 2\n[filter]\ncu = 1.5\ndensity = \"loose\"\n[packing]\ngrains = 150\n\
    stiffness_ratio = 0.01\n[base]\ncu = 1.5\nd85_at_dc = 5\nn_base = 1000\n\
    [network]\nnx = 4\nny = 4\nnz = 5\n[record]\nsensitivity = []\n";
const FILES: &[(&str, &str)] = &[
    ("scene.toml", SCENE),
    ("files.toml", WITH_FILES),
    ("packed.toml", PACKED),
    ("pack.toml", FILTER),
    ("filter.csv", "opening_mm,percent_finer\n4,100\n2,50\n1,0\n"),
    ("base.csv", "opening_mm,percent_finer\n0.4,100\n0.2,50\n0.08,0\n"),
    ("grains.csv", GRAINS),
    ("fewer.csv", FEWER),
];
/// Grains of somebody's own, some of which are in a smaller sample too.
macro_rules! grains {
    ($($more:literal)?) => {
        concat!(
            "# cell = none\nx_mm,y_mm,z_mm,diameter_mm\n\
            0.5,1.1,0.7,0.55\n1.3,0.1,0.0,0.61\n0.5,0.5,2.0,0.52\n1.7,1.0,1.3,0.44\n1.3,1.7,1.0,0.59\n\
            1.3,0.1,1.5,0.55\n0.6,0.1,1.7,0.52\n1.4,1.8,1.4,0.63\n0.8,1.6,0.9,0.63\n1.8,0.2,0.3,0.45\n\
            1.9,0.9,1.3,0.48\n1.0,0.8,0.7,0.55\n1.2,1.8,1.4,0.63\n1.7,2.0,1.3,0.44\n1.7,1.9,1.8,0.54\n\
            1.4,0.4,1.7,0.54\n0.7,0.4,1.9,0.65\n0.2,1.6,0.8,0.44\n0.6,1.5,1.7,0.41\n1.2,0.1,1.4,0.48\n\
            1.8,2.0,1.0,0.65\n0.6,0.2,1.2,0.41\n0.4,0.8,1.2,0.44\n0.1,1.7,0.6,0.64\n"
            $(, $more)?
        )
    };
}
const FEWER: &str = grains!();
const GRAINS: &str = grains!(
    "1.8,0.8,0.9,0.53\n1.3,1.2,1.1,0.56\n1.9,1.0,0.9,0.58\n0.5,0.6,2.0,0.53\n1.1,0.0,0.8,0.54\n\
    0.0,1.2,1.3,0.42\n"
);

/// The scene of files, of a packed filter, or the third, into `r`.
macro_rules! run {
    ($scene:literal $(, $more:literal)*) => {
        &["run", $scene, "--out", "r", "-q", "--threads", "1", "--packings", "kept", "--checkpoint-every", "70increments"
          $(, $more)*]
    };
}
const PACK_KEPT: &[&str] =
    &["run", "packed.toml", "--out", "first", "-q", "--threads", "1", "--packings", "kept"];
const PERCOLATION: &[&str] =
    &["percolation", "--sizes", "3,4", "--realisations", "3", "--out", "r", "--threads", "1"];

const WORKS: [Work; 10] = [
    Work {
        name: "constrictions",
        files: FILES,
        command: &["constrictions", "grains.csv", "--out", "r"],
        one_in: 1,
        ..RUN
    },
    Work {
        name: "constrictions --overwrite",
        files: FILES,
        before: &[&["constrictions", "fewer.csv", "--out", "r"]],
        command: &["constrictions", "grains.csv", "--out", "r", "--overwrite"],
        one_in: 1,
        ..RUN
    },
    Work { name: "scene with files", files: FILES, command: run!("files.toml"), one_in: 6, ..RUN },
    Work {
        name: "packed filter",
        files: FILES,
        before: &[PACK_KEPT],
        command: run!("packed.toml"),
        one_in: 6,
        ..RUN
    },
    Work {
        name: "--overwrite of a packed filter by a scene with files",
        files: FILES,
        before: &[run!("packed.toml")],
        command: run!("files.toml", "--overwrite"),
        one_in: 5,
        ..RUN
    },
    Work {
        name: "--overwrite of a scene with files by one without",
        files: FILES,
        before: &[run!("files.toml")],
        command: run!("scene.toml", "--overwrite"),
        one_in: 6,
        ..RUN
    },
    Work {
        name: "packing",
        files: FILES,
        command: &["pack", "pack.toml", "--out", "r", "-q", "--threads", "1"],
        one_in: 1,
        ..RUN
    },
    Work {
        name: "packing --overwrite",
        files: FILES,
        before: &[&["pack", "pack.toml", "--out", "r", "-q", "--threads", "1"]],
        command: &["pack", "pack.toml", "--out", "r", "-q", "--threads", "1", "--seed", "7", "--overwrite"],
        one_in: 4,
        ..RUN
    },
    Work { name: "percolation", command: PERCOLATION, one_in: 1, ..RUN },
    Work {
        name: "percolation --overwrite",
        before: &[&["percolation", "--sizes", "5", "--realisations", "2", "--out", "r"]],
        command: &[
            "percolation",
            "--sizes",
            "3,4",
            "--realisations",
            "3",
            "--out",
            "r",
            "--threads",
            "1",
            "--overwrite",
        ],
        one_in: 1,
        ..RUN
    },
];

/// The folder, with the page that its files give when times, host, threads and command are made alike.
fn whole(at: &Path) -> BTreeMap<PathBuf, String> {
    let mut found = lasting(&at.join("r"));
    if !at.join("r/report.html").exists() {
        // Constrictions have no page; the names of the others are compared.
        return found;
    }
    let root = room();
    let copied = root.path().join("r");
    fs::create_dir(&copied).unwrap();
    copy(&at.join("r"), &copied);
    let page = || {
        let output = call(root.path(), &["report", "r"], None);
        assert!(output.status.success(), "{}", stderr(&output));
        fs::read_to_string(copied.join("report.html")).unwrap()
    };
    assert!(
        fs::read_to_string(at.join("r/report.html")).unwrap() == page(),
        "the page is not that of its files"
    );
    for entry in fs::read_dir(&copied).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|kind| kind == "json") {
            let mut value: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
            make_alike(&mut value);
            fs::write(&path, value.to_string()).unwrap();
        }
    }
    found.insert("report.html".into(), page());
    found
}

fn make_alike(value: &mut Value) {
    match value {
        Value::Object(map) => {
            for (name, value) in map.iter_mut() {
                match value {
                    Value::Number(_) if TIMES.contains(&name.as_str()) => *value = 1.into(),
                    Value::String(_) if TIMES.contains(&name.as_str()) => *value = "alike".into(),
                    other => make_alike(other),
                }
            }
        }
        Value::Array(items) => items.iter_mut().for_each(make_alike),
        _ => {}
    }
}

fn seed_of(file: PathBuf) -> Option<String> {
    let text = fs::read_to_string(file).ok()?;
    let line = text.lines().find(|line| line.trim_start().trim_start_matches('"').starts_with("seed"))?;
    Some(line.chars().filter(char::is_ascii_digit).collect())
}

/// Goes on after a kill as a user would who does not know how far it was.
fn go_on(work: &Work, at: &Path, what: &str) {
    let is_run = work.command[0] == "run";
    if is_run && at.join("r/scene.toml").exists() {
        let output = call(at, &["resume", "r", "-q", "--threads", "2"], None);
        assert_eq!(output.status.code(), Some(0), "{what}: {}", stderr(&output));
        return;
    }
    let command: Vec<&str> = work.command.iter().copied().filter(|word| *word != "--overwrite").collect();
    let output = call(at, &command, None);
    assert_eq!(output.status.code(), Some(0), "{what}: {}", stderr(&output));
}

pub fn at_every_name() {
    let mut kills = 0;
    for work in &WORKS {
        let ready = work.ready();
        let old = ready.path().join("r").exists().then(|| whole(ready.path()));
        let unbroken = room();
        copy(ready.path(), unbroken.path());
        let calls = work.noted(unbroken.path());
        let expected = whole(unbroken.path());
        let names = ["rename", "remove", "make", "clear"];
        let at_names: Vec<usize> =
            (1..=calls.len()).filter(|number| names.contains(&calls[number - 1].kind.as_str())).collect();
        assert!(at_names.len() > 5, "{}: {calls:?}", work.name);
        let late = at_names.len().saturating_sub(9);
        // What comes first and last is always tried: what is replaced, and the page.
        let step = if is_all() { 1 } else { work.one_in };
        let (mut stayed, mut tried) = (0, 0);
        for (index, number) in at_names.into_iter().enumerate() {
            if index % step != 0 && index > 12 && index < late {
                continue;
            }
            let root = room();
            copy(ready.path(), root.path());
            let killed = call(root.path(), work.command, Some(&format!("kill {number}")));
            let what = format!("{}: killed at call {number}, {:.0?}", work.name, calls[number - 1]);
            assert_eq!(killed.status.code(), None, "{what}: {}", stderr(&killed));
            tried += 1;
            // What is taken for finished is of one scene.
            let report = call(root.path(), &["report", "r"], None);
            if report.status.success() && work.command[0] == "run" {
                let [scene, outcome] =
                    ["scene.toml", "outcome.json"].map(|name| seed_of(root.path().join("r").join(name)));
                assert!(scene == outcome && scene.is_some(), "{what}: seeds {scene:?} and {outcome:?}");
            }
            if old.is_some() && whole_or_none(root.path()) == old {
                stayed += 1;
                continue;
            }
            go_on(work, root.path(), &what);
            let found = whole(root.path());
            assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>(), "{what}");
            for (name, text) in &expected {
                assert!(&found[name] == text, "{what}: {} differs", name.display());
            }
        }
        println!("  {}: {tried} kills, {stayed} left the old work whole; 0 other folders", work.name);
        kills += tried;
    }
    assert!(kills > 100, "{kills} kills");
}

/// The folder where it counts as finished: the command without `--overwrite` would not begin.
fn whole_or_none(at: &Path) -> Option<BTreeMap<PathBuf, String>> {
    let begun = at.join("r/.voidwalk.unfinished").exists();
    let has = |name: &str| at.join("r").join(name).exists();
    let record = ["outcome.json", "packing.json", "percolation.json"].into_iter().any(has);
    let page = record && has("report.html") && call(at, &["report", "r"], None).status.success();
    let without = !record && has("constrictions.json");
    (!begun && (page || without)).then(|| whole(at))
}
