//! Packings and networks of other programs: one packing in six formats, one network as arrays.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use serde_json::Value;
use voidwalk::store::{Array, Npz, Numbers, npz};

use crate::program::{call, done, refused};

/// Length of the cell (mm).
const CELL: f64 = 6.4;

/// Centres and diameters (mm): beside the places of a face-centred lattice, few of the grains touching.
fn grains() -> Vec<[f64; 4]> {
    let mut word = 7u64;
    let mut draw = |low: f64, high: f64| {
        word = word.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let share = (word >> 40) as f64 / (1u64 << 24) as f64;
        ((low + share * (high - low)) * 1e4).round() / 1e4
    };
    let corners = [[0.0, 0.0, 0.0], [0.0, 0.8, 0.8], [0.8, 0.0, 0.8], [0.8, 0.8, 0.0]];
    let mut grains = Vec::new();
    for place in 0..64u32 {
        let at = [place % 4, place / 4 % 4, place / 16].map(|n| 1.6 * f64::from(n));
        for corner in corners {
            let centre: [f64; 3] = std::array::from_fn(|axis| at[axis] + corner[axis] + draw(0.3, 0.5));
            grains.push([centre[0], centre[1], centre[2], draw(0.85, 1.1)]);
        }
    }
    grains
}

fn lines(grains: &[[f64; 4]], of: impl Fn(usize, [f64; 4]) -> String) -> String {
    grains.iter().enumerate().map(|(i, grain)| of(i, *grain) + "\n").collect()
}

/// The packing as seven files, and what has to be said of each besides.
fn write(folder: &Path) -> Vec<(&'static str, Vec<String>)> {
    let grains = grains();
    let file = |name: &str, text: String| fs::write(folder.join(name), text).unwrap();
    let own = lines(&grains, |_, [x, y, z, d]| format!("{x},{y},{z},{d}"));
    file("own.csv", format!("# cell_mm = {CELL}, {CELL}, {CELL}\nx_mm,y_mm,z_mm,diameter_mm\n{own}"));
    let dump = |units: &str, low: f64, scale: f64, columns: &str| {
        let bounds = format!("{:?} {:?}\n", low * scale, (low + CELL) * scale).repeat(3);
        let head = format!("{units}ITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n{}\n", grains.len());
        let rows = lines(&grains, |i, [x, y, z, d]| {
            let [x, y, z, r] = [x + low, y + low, z + low, 0.5 * d].map(|length| length * scale);
            format!("{} 1 {x:?} {y:?} {z:?} {r:?}", i + 1)
        });
        format!("{head}ITEM: BOX BOUNDS pp pp pp\n{bounds}ITEM: ATOMS {columns}\n{rows}")
    };
    file("lammps.dump", dump("ITEM: UNITS\nsi\n", -1.0, 1e-3, "id type x y z radius"));
    // LIGGGHTS does not say its units, and ends the line of columns with a space.
    file("liggghts.dump", dump("", 0.0, 0.1, "id type x y z radius "));
    let metres = |[x, y, z, d]: [f64; 4]| [x, y, z, 0.5 * d].map(|mm| mm * 1e-3);
    let yade = lines(&grains, |_, grain| {
        let [x, y, z, r] = metres(grain);
        format!("{x:?}\t{y:?}\t{z:?}\t{r:?}")
    });
    file("yade.txt", format!("#format x_y_z_r\n{yade}"));
    let mercury = lines(&grains, |_, grain| {
        let [x, y, z, r] = metres(grain);
        format!("{x:?} {y:?} {z:?} 0 0 0 {r:?} 0 0 0 0 0 0 0")
    });
    let cell = CELL * 1e-3;
    file("mercury.data", format!("{} 0.25 0 0 0 {cell} {cell} {cell}\n{mercury}", grains.len()));
    let points = lines(&grains, |i, [x, y, z, d]| {
        let [x, y, z, d] = [x, y, z, d].map(|mm| mm * 1e3);
        format!("{d:?},{i},{x:?},{y:?},{z:?}")
    });
    file(
        "paraview.csv",
        format!("\"Diameter\",\"Particle_ID\",\"Points:0\",\"Points:1\",\"Points:2\"\n{points}"),
    );
    let words = |line: &str| line.split_whitespace().map(String::from).collect();
    vec![
        ("own.csv", words("")),
        ("lammps.dump", words("")),
        ("liggghts.dump", words("--unit cm")),
        ("yade.txt", words("--unit m --cell 0.0064,0.0064,0.0064")),
        ("mercury.data", words("--unit m --cell bounds")),
        ("paraview.csv", words("--unit um --cell 6400,6400,6400")),
    ]
}

/// The numbers of a table.
fn numbers(path: &Path) -> Vec<f64> {
    let text = fs::read_to_string(path).unwrap();
    let rows = text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    rows.flat_map(|row| row.split(',').map(|field| field.parse::<f64>().unwrap()).collect::<Vec<_>>())
        .collect()
}

#[test]
fn one_packing_in_six_formats_gives_one_curve() {
    let root = tempfile::tempdir().unwrap();
    let mut wanted = Vec::new();
    for (name, besides) in write(root.path()) {
        let out = format!("of-{name}");
        let mut args = vec!["constrictions", name, "--out", &out];
        args.extend(besides.iter().map(String::as_str));
        let output = call(root.path(), &args);
        done(&output);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(stderr.contains("converted to mm"), name != "own.csv", "{name}: {stderr}");
        assert_eq!(stderr.matches(&format!("{name}: lengths are")).count(), usize::from(name != "own.csv"));
        let found = numbers(&root.path().join(&out).join("constrictions.csv"));
        assert!(found.len() > 600, "{name}: {}", found.len());
        if wanted.is_empty() {
            wanted = found;
            continue;
        }
        assert_eq!(found.len(), wanted.len(), "{name}");
        // But for the rounding of lengths that are written in another unit.
        let off =
            found.iter().zip(&wanted).map(|(a, b)| (a - b).abs() / b.abs().max(1e-3)).fold(0.0, f64::max);
        assert!(off < 1e-9, "{name}: off by {off}");
    }
}

/// What is not said is asked for, and nothing is written.
#[test]
fn a_file_without_its_unit_or_its_boundaries_is_refused() {
    let root = tempfile::tempdir().unwrap();
    write(root.path());
    let said = |args: &[&str], message: &str| {
        refused(&call(root.path(), &[&["constrictions"], args].concat()), message)
    };
    for name in ["liggghts.dump", "yade.txt", "mercury.data", "paraview.csv"] {
        said(&[name], &format!("{name} does not say the unit of its lengths"));
    }
    for name in ["yade.txt", "mercury.data", "paraview.csv"] {
        said(&[name, "--unit", "m"], &format!("{name} does not say whether its boundaries are periodic"));
    }
    said(&["lammps.dump", "--unit", "mm"], "the file states the unit of its lengths");
    assert!(!root.path().join("voidwalk-constrictions").exists());
}

/// Every number of every replicate, but for how long it took.
fn replicates(folder: &Path) -> Value {
    let outcome: Value = serde_json::from_slice(&fs::read(folder.join("outcome.json")).unwrap()).unwrap();
    let mut replicates = outcome["replicates"].clone();
    for replicate in replicates.as_array_mut().unwrap() {
        for run in replicate["runs"].as_array_mut().unwrap() {
            run.as_object_mut().unwrap().remove("seconds");
        }
    }
    replicates
}

#[test]
fn a_scene_walks_a_packing_of_yade_to_the_bits_of_its_csv() {
    let root = tempfile::tempdir().unwrap();
    write(root.path());
    let mut text = String::from("#format x_y_z_r\n");
    for [x, y, z, d] in grains() {
        writeln!(text, "{x} {y} {z} {:?}", 0.5 * d).unwrap();
    }
    fs::write(root.path().join("mm.txt"), text).unwrap();
    let scene = |packing: &str| {
        format!(
            "replicates = 2\n[base]\nsingle_mm = 0.3\nn_base = 2000\n[network]\nkind = \"graph\"\ncopies = 2\n{packing}\n[record]\n\
             sensitivity = []\n"
        )
    };
    let walk = |name: &str, text: String| {
        fs::write(root.path().join(format!("{name}.toml")), text).unwrap();
        done(&call(root.path(), &["run", &format!("{name}.toml"), "--out", name, "-q"]));
        replicates(&root.path().join(name))
    };
    let own = walk("own", scene("packing = \"own.csv\""));
    let yade = walk("yade", scene("packing = \"mm.txt\"\nunit = \"mm\"\ncell = \"6.4, 6.4, 6.4\""));
    assert_eq!(own, yade);
    // What is said of a file says its name once.
    let metres = scene("packing = \"yade.txt\"\nunit = \"m\"\ncell = \"0.0064, 0.0064, 0.0064\"");
    fs::write(root.path().join("metres.toml"), metres).unwrap();
    let checked = call(root.path(), &["check", "metres.toml"]);
    done(&checked);
    let said = String::from_utf8_lossy(&checked.stderr) + String::from_utf8_lossy(&checked.stdout);
    assert!(
        said.contains("yade.txt: lengths are in metres") && !said.contains("yade.txt: yade.txt"),
        "{said}"
    );
    assert!(own[0]["runs"][0]["blocked"].as_u64().unwrap() > 0);
    // The folder holds what it takes to walk it again.
    done(&call(root.path(), &["run", "yade/scene.toml", "--out", "again", "-q"]));
    assert_eq!(replicates(&root.path().join("again")), yade);
    fs::write(root.path().join("silent.toml"), scene("packing = \"mm.txt\"")).unwrap();
    refused(&call(root.path(), &["check", "silent.toml"]), "in a scene network.unit = \"m\"");
}

/// A ring of four voids with a wide and a narrow way, as OpenPNM names its arrays.
fn ring(folder: &Path, outlets: Array) {
    let whole = |columns, all: &[i64]| Array {
        rows: all.len() / columns,
        columns: Some(columns),
        numbers: Numbers::Whole(all.to_vec()),
    };
    let inlets = Array { rows: 4, columns: None, numbers: Numbers::Truth(vec![true, false, false, false]) };
    let arrays = [
        ("throat.conns", whole(2, &[0, 1, 1, 2, 0, 3, 3, 2])),
        ("throat.diameter", Array::of_floats(vec![1e-3, 1e-3, 0.4e-3, 0.4e-3])),
        ("pore.inlets", inlets),
        ("pore.outlets", outlets),
    ];
    let arrays = arrays.map(|(name, array)| (name.to_owned(), array));
    fs::write(folder.join("ring.npz"), npz(&arrays).unwrap()).unwrap();
}

#[test]
fn a_network_of_arrays_is_walked_both_ways() {
    let root = tempfile::tempdir().unwrap();
    ring(root.path(), Array::of_whole(vec![2]));
    let scene = |set: &str| {
        format!(
            "replicates = 3\n[filter]\ncu = 1.5\nd0_mm = 1\n[base]\nsingle_mm = 0.5\nn_base = 1000\n[network]\n\
             file = \"ring.npz\"\n{set}\n[record]\nsensitivity = []\n"
        )
    };
    fs::write(root.path().join("silent.toml"), scene("")).unwrap();
    refused(&call(root.path(), &["check", "silent.toml"]), "ring.npz does not say the unit of its diameters");
    fs::write(root.path().join("ring.toml"), scene("unit = \"m\"")).unwrap();
    let check = call(root.path(), &["check", "ring.toml"]);
    done(&check);
    let text = String::from_utf8_lossy(&check.stdout);
    assert!(text.contains("ring.npz: 4 voids, 4 constrictions, 1 start nodes"), "{text}");
    done(&call(root.path(), &["run", "ring.toml", "--out", "ring", "-q"]));
    let found = replicates(&root.path().join("ring"));
    // Coarser than the narrow way: it is blocked, and the rest of the base leaves by the wide one.
    for replicate in found.as_array().unwrap() {
        let first = &replicate["runs"][0];
        let eroded = first["eroded_mass_fraction"].as_f64().unwrap();
        assert!((0.99..1.0).contains(&eroded), "{first}");
    }
    done(&call(root.path(), &["run", "ring/scene.toml", "--out", "again", "-q"]));
    assert_eq!(replicates(&root.path().join("again")), found);
    let outcome = fs::read_to_string(root.path().join("ring/outcome.json")).unwrap();
    let outcome: Value = serde_json::from_str(&outcome).unwrap();
    assert_eq!((&outcome["network"]["kind"], &outcome["network"]["inlets"]), (&"file".into(), &1.into()));
    assert!(outcome["inputs"]["network"]["connectivity"].as_array().is_none_or(Vec::is_empty), "{outcome}");
    // By area each constriction leads one way.
    done(&call(root.path(), &["run", "ring.toml", "--set", "walk.exit=area", "--out", "area", "-q"]));
    refused(&call(root.path(), &["check", "ring.toml", "--set", "walk.exit=height"]), "walk.exit: `height`");
    ring(root.path(), Array::of_whole(vec![7]));
    refused(&call(root.path(), &["check", "ring.toml"]), "ring.npz: pore.outlets: 7 is no void; there are 4");
}

/// Tables leave a folder as arrays and blocks, and go when the run is replaced.
#[test]
fn tables_leave_as_arrays_and_grids() {
    let root = tempfile::tempdir().unwrap();
    let scene = "replicates = 2\nruns = 1\n[filter]\ncurve = \"cu3-loose\"\n[base]\ncu = 1.5\nd85_at_dc = 5\n\
        n_base = 300\n[network]\nnx = 4\nny = 4\nnz = 6\n[record]\nsensitivity = []\n";
    fs::write(root.path().join("s.toml"), scene).unwrap();
    refused(&call(root.path(), &["export", "."]), ".: holds no finished work");
    done(&call(root.path(), &["run", "s.toml", "--out", "run", "-q"]));
    let export = call(root.path(), &["export", "run"]);
    done(&export);
    let files = "run/export/arrays.npz\nrun/export/layers.vtu\nrun/export/verdict.xlsx\n";
    assert_eq!(String::from_utf8(export.stdout).unwrap(), files);
    let bytes = fs::read(root.path().join("run/export/arrays.npz")).unwrap();
    let mut arrays = Npz::open(&bytes).unwrap();
    let mut array = |name: &str| arrays.first(&[name]).unwrap().expect(name).1;
    let (layers, blocked) = (array("layers.layer"), array("layers.blocked"));
    assert_eq!(layers.numbers, Numbers::Whole((0..6).chain(0..6).collect()));
    let Numbers::Whole(blocked) = blocked.numbers else { panic!("whole numbers") };
    let of_run: Value = replicates(&root.path().join("run"))[0]["runs"][0]["blocked"].clone();
    assert_eq!(blocked[..6].iter().sum::<i64>(), of_run.as_i64().unwrap());
    let text =
        String::from_utf8_lossy(&fs::read(root.path().join("run/export/layers.vtu")).unwrap()).into_owned();
    assert!(text.contains("NumberOfCells=\"6\"") && text.contains("Name=\"blocked_run_1\""), "{text}");
    done(&call(root.path(), &["run", "s.toml", "--out", "run", "--overwrite", "-q"]));
    assert!(!root.path().join("run/export").exists());
    // Of a packing from elsewhere: its curve and its graph.
    write(root.path());
    done(&call(root.path(), &["constrictions", "own.csv", "--out", "c"]));
    done(&call(root.path(), &["export", "c"]));
    let bytes = fs::read(root.path().join("c/export/arrays.npz")).unwrap();
    let names = Npz::open(&bytes).unwrap().names().to_vec();
    assert!(names.iter().any(|name| name == "graph.diameter_mm"), "{names:?}");
}
