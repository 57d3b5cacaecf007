//! The voids of a packing as the network: measured, walked, resumed, refused.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::program::{call, done, refused};

/// Grains of several sizes on a disturbed lattice in a periodic cell, as CSV.
fn grains(n: usize) -> String {
    let mut seed = 5u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / 9_007_199_254_740_992.0
    };
    let mut text = format!("# cell_mm = {n}, {n}, {n}\nx_mm,y_mm,z_mm,diameter_mm\n");
    for i in 0..n * n * n {
        let [x, y, z] = [i % n, i / n % n, i / n / n].map(|at| at as f64 + 0.06 * random());
        writeln!(text, "{x},{y},{z},{}", 0.9 + 0.1 * random()).unwrap();
    }
    text
}

const SCENE: &str = r#"
replicates = 2
[base]
cu = 3
d15f_over_d85b = 4
mass_ratio = 0.02
[network]
kind = "graph"
packing = "grains.csv"
copies = 2
[record]
sensitivity = []
"#;

fn prepared(root: &Path) {
    fs::write(root.join("grains.csv"), grains(6)).unwrap();
    fs::write(root.join("scene.toml"), SCENE).unwrap();
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

#[test]
fn constrictions_writes_the_graph_and_its_permeability() {
    let root = tempfile::tempdir().unwrap();
    prepared(root.path());
    done(&call(root.path(), &["constrictions", "grains.csv", "--out", "c"]));
    let summary = json(&root.path().join("c/constrictions.json"));
    let k = summary["k_over_d32_squared"].as_f64().unwrap();
    let by_rule = summary["kozeny_carman_over_d32_squared"].as_f64().unwrap();
    // Not a random packing, but near one.
    assert!((0.5..2.0).contains(&(k / by_rule)), "{k} {by_rule}");
    let graph = fs::read_to_string(root.path().join("c/graph.csv")).unwrap();
    let mut lines = graph.lines();
    assert_eq!(lines.next(), Some("from,to,shift_x,shift_y,shift_z,diameter_mm,conductance_mm3"));
    assert_eq!(lines.count() as u64, summary["constrictions"].as_u64().unwrap());
    // Those of a packing without a cell have no graph.
    let free = grains(4).replacen("# cell_mm = 4, 4, 4", "# cell = none", 1);
    fs::write(root.path().join("free.csv"), free).unwrap();
    let said = call(root.path(), &["constrictions", "free.csv", "--out", "f"]);
    done(&said);
    assert!(String::from_utf8_lossy(&said.stdout).contains("no void graph"));
    assert!(!root.path().join("f/graph.csv").exists());
}

#[test]
fn the_graph_is_walked_and_its_folder_says_what_it_is() {
    let root = tempfile::tempdir().unwrap();
    prepared(root.path());
    done(&call(root.path(), &["check", "scene.toml"]));
    let run = call(root.path(), &["run", "scene.toml", "--out", "one", "--threads", "1"]);
    done(&run);
    let outcome = json(&root.path().join("one/outcome.json"));
    assert!(outcome["notes"].to_string().contains("\"permeability\""), "{}", outcome["notes"]);
    let network = &outcome["network"];
    assert_eq!((&network["kind"], &network["exit"]), (&"graph".into(), &"flux".into()));
    assert_eq!((&network["copies"], &network["thickness_mm"]), (&2.into(), &12.0.into()));
    assert!(network["voids"].as_u64().unwrap() > 150 && network["inlets"].as_u64().unwrap() > 20);
    assert!(network["k0_m2"].as_f64().unwrap() > 0.0 && network["k0_m_per_s"].as_f64().unwrap() > 0.0);
    assert_eq!((&network["flow_tolerance"], &network["flow_error_pp"]), (&0.03.into(), &0.3.into()));
    for replicate in outcome["replicates"].as_array().unwrap() {
        for run in replicate["runs"].as_array().unwrap() {
            let k = run["k_over_k0"].as_f64().unwrap();
            assert!((0.0..=1.0).contains(&k), "{k}");
            assert!(run["fullness_max"].as_f64().unwrap() >= 0.0);
            assert_eq!(run["trapped"], 0);
            assert!(run["flow_solutions"].as_u64().unwrap() >= 1 && run["flow_closed_most"].is_number());
        }
    }
    let flow = fs::read_to_string(root.path().join("one/flow.csv")).unwrap();
    assert!(
        flow.starts_with("replicate,run,increment,k_over_k0,closed_flow_fraction\n1,1,0,1.0,0.0\n"),
        "{flow}"
    );
    // Again on other threads, and from what the folder keeps.
    done(&call(root.path(), &["run", "scene.toml", "--out", "three", "--threads", "3"]));
    done(&call(root.path(), &["run", "one/scene.toml", "--out", "again", "--threads", "2"]));
    for other in ["three", "again"] {
        for file in ["series.csv", "layers.csv", "retained.csv", "eroded.csv", "flow.csv"] {
            let read = |folder: &str| fs::read(root.path().join(folder).join(file)).unwrap();
            assert!(read("one") == read(other), "{other}/{file}");
        }
    }
}

#[test]
fn a_graph_and_its_exits_are_refused_by_name_where_they_do_not_go_together() {
    let root = tempfile::tempdir().unwrap();
    prepared(root.path());
    for (set, message) in [
        ("walk.exit=area", "walk.exit: `area` is not allowed; \"flux\", \"area-along-flow\", \"height\""),
        ("walk.exit=up", "walk.exit: `up` is not allowed"),
        ("walk.rho=2", "walk.rho: `2` is not allowed; a fraction from 0 to 1"),
        ("network.copies=0", "network.copies: `0` is not allowed"),
        ("walk.conductance_exponent=3", "is for a lattice"),
        ("network.packing=none.csv", "none.csv"),
    ] {
        refused(&call(root.path(), &["check", "scene.toml", "--set", set]), message);
    }
    refused(&call(root.path(), &["check", "--set", "network.packing=grains.csv"]), "goes with network.kind");
    refused(&call(root.path(), &["check", "--set", "network.kind=graph"]), "needs grains");
    refused(&call(root.path(), &["check", "--set", "walk.rho=0.1"]), "says nothing where no water flows");
    refused(&call(root.path(), &["check", "--set", "walk.exit=height"]), "`height` is not allowed");
    // Grains without a cell, and voids that run through it.
    let free = grains(4).replacen("# cell_mm = 4, 4, 4", "# cell = none", 1);
    fs::write(root.path().join("free.csv"), free).unwrap();
    let packing = "network.packing=free.csv";
    refused(&call(root.path(), &["check", "scene.toml", "--set", packing]), "have no periodic cell");
    let broken = grains(4).replacen("\n0", "\nNaN", 1);
    fs::write(root.path().join("nan.csv"), broken).unwrap();
    refused(&call(root.path(), &["check", "scene.toml", "--set", "network.packing=nan.csv"]), "NaN");
}

/// A wrong cell gives finer constrictions: a filter that seems to hold more.
#[test]
fn grains_that_do_not_fit_their_cell_are_refused_and_loose_ones_warned_of() {
    let root = tempfile::tempdir().unwrap();
    prepared(root.path());
    let both = |name: &str, cell: Option<&str>, message: &str| {
        let measured = ["constrictions", name, "--out", "m", "--cell", cell.unwrap_or_default()];
        refused(&call(root.path(), &measured[..if cell.is_some() { 6 } else { 4 }]), message);
        let packing = format!("network.packing={name}");
        let hand = format!("network.cell=\"{}\"", cell.unwrap_or_default());
        let scene = ["check", "scene.toml", "--set", &packing, "--set", &hand];
        refused(&call(root.path(), &scene[..if cell.is_some() { 6 } else { 4 }]), message);
    };
    let write = |name: &str, text: String| fs::write(root.path().join(name), text).unwrap();
    let own = |cell: &str| grains(4).replacen("4, 4, 4", cell, 1);
    // The last layer of grains falls onto the first.
    write("short.csv", own("4, 4, 3"));
    both("short.csv", None, "lie inside others");
    write("full.csv", own("4, 4, 1"));
    both("full.csv", None, "times the volume of the cell");
    let no_cell = grains(4).split_once('\n').unwrap().1.to_owned();
    write("open.csv", no_cell);
    both("open.csv", Some("4, 4, 2.9"), "the cell is 2.9 long there");
    assert!(!root.path().join("m").exists());

    let smaller =
        |line: &str| match line.rsplit_once(',').and_then(|(at, d)| Some((at, d.parse::<f64>().ok()?))) {
            Some((at, d)) if !line.starts_with('#') => format!("{at},{}\n", 0.88 * d),
            _ => format!("{line}\n"),
        };
    write("loose.csv", grains(4).lines().map(smaller).collect());
    let measured = call(root.path(), &["constrictions", "loose.csv", "--out", "m"]);
    done(&measured);
    let said = String::from_utf8_lossy(&measured.stdout).into_owned();
    assert!(said.contains("warning: the void ratio is 2.2") && said.contains("another unit"), "{said}");
    let loose = ["--set", "network.packing=loose.csv"];
    let checked = call(root.path(), &["check", "scene.toml", loose[0], loose[1]]);
    done(&checked);
    let said = [checked.stdout, checked.stderr].concat();
    assert!(String::from_utf8_lossy(&said).contains("loose.csv: the void ratio is 2.2"));
    let usual = call(root.path(), &["check", "scene.toml"]);
    assert!(!String::from_utf8_lossy(&[usual.stdout, usual.stderr].concat()).contains("void ratio is"));
}

/// A thickness is layers of a lattice, and copies of a packing.
#[test]
fn thickness_is_layers_or_copies() {
    let root = tempfile::tempdir().unwrap();
    prepared(root.path());
    let of = |args: &[&str]| {
        let small = ["--set", "replicates=1", "--set", "record.sensitivity=[]", "--overwrite", "--out", "t"];
        let all: Vec<&str> = [&["run"], args, &small].concat();
        done(&call(root.path(), &all));
        json(&root.path().join("t/outcome.json"))
    };
    let lattice = of(&["--set", "network.thickness_mm=30", "--set", "network.nx=5", "--set", "network.ny=5"]);
    let thickness = lattice["inputs"]["network"]["thickness_mm"].as_f64().unwrap();
    let layers = lattice["inputs"]["network"]["nz"].as_f64().unwrap();
    assert!((thickness - 30.0).abs() <= 0.5 * thickness / layers, "{thickness} {layers}");
    let graph = of(&["scene.toml", "--set", "network.thickness_mm=13"]);
    assert_eq!((&graph["network"]["copies"], &graph["network"]["thickness_mm"]), (&3.into(), &18.0.into()));
    // A real layer of what was asked for is thinner than whole copies of the cell are.
    let args = ["scene.toml", "--set", "network.thickness_mm=13", "--set", "filter.thickness_mm=13"];
    // Of a verdict that this makes the surer it stands among the notes.
    let outcome = of(&args);
    let reasons = outcome["notes"].to_string();
    assert!(reasons.contains("copies_thicker"), "{reasons}");
    let flowing = of(&["--set", "walk.exit=flux", "--set", "network.nx=5", "--set", "network.ny=5"]);
    assert_eq!(flowing["network"]["kind"], "lattice");
    assert!(flowing["replicates"][0]["runs"][0]["k_over_k0"].as_f64().unwrap() <= 1.0);
}

#[test]
fn a_graph_of_twice_the_copies_is_walked_beside_it() {
    let root = tempfile::tempdir().unwrap();
    prepared(root.path());
    let thick = ["run", "scene.toml", "--out", "o", "--set", "record.thickness=[2]", "--set", "replicates=3"];
    done(&call(root.path(), &thick));
    let asked = ["run", "scene.toml", "--out", "thick", "--set", "network.copies=4", "--set", "replicates=3"];
    done(&call(root.path(), &asked));
    let [row, whole] = ["o", "thick"].map(|folder| json(&root.path().join(folder).join("outcome.json")));
    let row = &row["thickness"][1];
    assert_eq!((&row["n_base"], &row["verdict"]), (&whole["n_base"], &whole["model"]["class"]));
    assert_eq!(row["runs"][1], whole["summary"][1]["eroded_mass_fraction"]);
}

/// The numbers of an array of doubles in a `.vtu`.
fn doubles(file: &[u8], name: &str) -> Vec<f64> {
    let begin = file.windows(2).position(|pair| pair == b"\n_").unwrap() + 2;
    let head = String::from_utf8_lossy(&file[..begin]).into_owned();
    let (_, rest) = head.split_once(&format!("Name=\"{name}\"")).unwrap();
    let offset: usize = rest.split_once("offset=\"").unwrap().1.split('"').next().unwrap().parse().unwrap();
    let data = &file[begin + offset..];
    let length = u64::from_le_bytes(data[..8].try_into().unwrap()) as usize;
    data[8..8 + length].chunks_exact(8).map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap())).collect()
}

#[test]
fn voids_and_constrictions_are_shown_as_they_fill_and_close() {
    let root = tempfile::tempdir().unwrap();
    prepared(root.path());
    let lattice = ["--set", "network.nx=5", "--set", "network.ny=6", "--set", "network.nz=7"];
    let built_in = ["init", "lattice.toml"];
    done(&call(root.path(), &built_in));
    let graph = ["--set", "base.d15f_over_d85b=2"];
    for (out, scene, more) in [("g", "scene.toml", &graph[..]), ("l", "lattice.toml", &lattice[..])] {
        let wanted = [
            &["run", scene, "--out", out, "--quiet", "--set", "record.voids=[5, 20]"][..],
            &["--set", "record.sensitivity=[]", "--set", "replicates=2"],
            more,
        ];
        done(&call(root.path(), &wanted.concat()));
        done(&call(root.path(), &["export", out]));
        let file = |name: &str| fs::read(root.path().join(out).join("export").join(name)).unwrap();
        let outcome = json(&root.path().join(out).join("outcome.json"));
        let runs = &outcome["replicates"][0]["runs"];
        // Every void is one of voids.csv, or the reservoir, -1; with it the counts are those of the run.
        let table = |name: &str| fs::read_to_string(root.path().join(out).join(name)).unwrap();
        let voids = table("voids.csv").lines().count() as i64 - 1;
        let mut held = 0;
        for line in table("retained_by_void.csv").lines().skip(1) {
            let row: Vec<i64> = line.split(',').map(|field| field.parse().unwrap()).collect();
            assert!((-1..voids).contains(&row[2]) && (out == "g" || row[2] >= 0), "{out} {line}");
            if row[0] == 1 && row[1] == runs[0]["increments"].as_i64().unwrap() {
                held += row[3];
            }
        }
        assert_eq!(held, runs[0]["retained_in_constrictions"].as_i64().unwrap(), "{out}");
        // Clean, after 5 and 20 increments and at the end of the first run, and likewise of the second.
        let series = String::from_utf8(file("voids.pvd")).unwrap();
        assert_eq!(series.matches("<DataSet").count(), 7, "{series}");
        let end = |run: usize| runs[run]["increments"].as_u64().unwrap();
        assert!(series.contains(&format!("timestep=\"{}\" file=\"voids_0003.vtu\"", end(0))));
        assert!(series.contains(&format!("timestep=\"{}\" file=\"voids_0006.vtu\"", end(0) + end(1))));
        for (run, last) in [(0, 3), (1, 6)] {
            let grid = file(&format!("voids_{last:04}.vtu"));
            for name in ["retained_in_constrictions", "retained_in_voids"] {
                let all: f64 = doubles(&grid, &format!("{name}_in_this_run")).iter().sum();
                assert!(all <= runs[run][name].as_f64().unwrap(), "{out} {name}");
                // At a graph's face some are retained before the first void.
                assert!(out == "g" || all == runs[run][name].as_f64().unwrap(), "{out} {name}");
            }
            let lines = file(&format!("constrictions_{last:04}.vtu"));
            let blocked = doubles(&lines, "blocked");
            assert!(blocked.contains(&1.0), "{out}");
            assert_eq!(blocked.iter().sum::<f64>(), runs[run]["blocked"].as_f64().unwrap(), "{out}");
            let times = doubles(&lines, "blocked_at");
            assert!(times.iter().zip(&blocked).all(|(&at, &is)| (at > 0.0) == (is == 1.0)));
            // Ends of a line are neighbours, though the network repeats.
            let points = doubles(&lines, "points");
            assert_eq!(points.len(), 6 * blocked.len());
            // Half a cell of the packing across the flow; a layer of the lattice.
            let (axes, most) = if out == "g" { (2, 3.001) } else { (3, 1.5) };
            let across = |p: &[f64]| (0..axes).map(|k| (p[k] - p[3 + k]).abs()).fold(0.0, f64::max);
            assert!(points.chunks_exact(6).map(across).fold(0.0, f64::max) < most, "{out}");
        }
        assert!(doubles(&file("constrictions_0000.vtu"), "blocked").iter().all(|&is| is == 0.0));
    }
    // A void that there is not: nothing is written.
    fs::remove_dir_all(root.path().join("l/export")).unwrap();
    let kept = root.path().join("l/retained_by_void.csv");
    fs::write(&kept, fs::read_to_string(&kept).unwrap() + "2,1,210,1,0\n").unwrap();
    let damaged = call(root.path(), &["export", "l"]);
    assert_eq!(damaged.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&damaged.stderr).contains("void is 210, but voids.csv holds 210 voids"));
    assert!(!root.path().join("l/export").exists());
    // A run that takes the place of one leaves none of its moments behind, but a file of its user's.
    fs::write(root.path().join("g/network.csv"), "from,to,diameter_mm\n").unwrap();
    done(&call(root.path(), &["run", "scene.toml", "--out", "g", "--overwrite", "--quiet"]));
    assert!(!root.path().join("g/export").exists() && !root.path().join("g/voids.csv").exists());
    assert!(root.path().join("g/network.csv").exists());
    assert!(!root.path().join("g/constrictions_of_network.csv").exists());
    let many = format!("record.voids={:?}", (1..102).collect::<Vec<_>>());
    refused(&call(root.path(), &["check", "scene.toml", "--set", &many]), "at most 100 increments");
    fs::write(root.path().join("n.csv"), "from,to,diameter_mm\nstart,0,\n0,end,1\n").unwrap();
    let scene = "[base]\nsingle_mm = 0.1\nn_base = 100\n[network]\nfile = \"n.csv\"\n[record]\nvoids = []\n";
    fs::write(root.path().join("n.toml"), scene).unwrap();
    refused(&call(root.path(), &["check", "n.toml"]), "record.voids needs to know where voids lie");
}
