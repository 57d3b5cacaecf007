//! Names that would run in a page, a spreadsheet or a terminal, and links that lead out of a folder.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const SCENE: &str = "replicates = 1\n[filter]\ncurve = \"shire2016-cu1.5-loose\"\n[base]\ncu = 1.5\nd85_at_dc = 5\nn_base = 2000\n\
    [network]\nnx = 4\nny = 4\nnz = 5\n[record]\nsensitivity = []\n";

/// Clears the screen, turns the direction of writing, and is markup.
const EVIL: &str = "\u{1b}[2J\u{202e}<script>alert(1)<b>";

fn voidwalk(at: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_voidwalk")).current_dir(at).args(args).output().unwrap()
}

fn room(files: &[(&str, &str)]) -> (tempfile::TempDir, PathBuf) {
    let root = tempfile::tempdir().unwrap();
    for (name, text) in files {
        fs::write(root.path().join(name), text).unwrap();
    }
    let path = root.path().to_owned();
    (root, path)
}

fn is_inert(output: &Output) -> String {
    let all = [&output.stdout[..], &output.stderr[..]].concat();
    let text = String::from_utf8_lossy(&all).into_owned();
    assert!(!text.chars().any(|c| (c.is_control() && c != '\n') || c == '\u{202e}'), "{text:?}");
    text
}

#[test]
fn an_error_of_any_reader_says_the_name_and_leaves_the_terminal_alone() {
    let (_root, at) = room(&[]);
    for (ending, text, args) in [
        ("toml", "seed = 1\n\u{1b}[2J = 3\n", &["check"][..]),
        ("toml", "title = \u{1b}", &["campaign"]),
        ("csv", "x_mm,\u{1b}[2Jy_mm\n1,2\n", &["constrictions"]),
        ("dump", "ITEM: \u{1b}[2J\n", &["constrictions"]),
        ("toml", "[filter]\ncu = 1.5\ndensity = \"\u{202e}\"\n", &["pack"]),
        ("csv", "opening_mm,percent_finer\n\u{1b}[2J,5\n", &["check", "--set", "base.sieve="]),
        ("csv", "percent_smaller,diameter_mm\n\u{1b}[2J,5\n", &["check", "--set", "filter.curve="]),
        ("csv", "from,to,diameter_mm\n\u{1b}[2J,0,1\n", &["check", "--set", "network.file="]),
    ] {
        let name = format!("{}.{ending}", EVIL.replace('/', ""));
        fs::write(at.join(&name), text).unwrap();
        let mut args: Vec<String> = args.iter().map(ToString::to_string).collect();
        match args.last_mut().filter(|word| word.ends_with('=')) {
            Some(word) => word.push_str(&toml::Value::from(name.as_str()).to_string()),
            None => args.push(name.clone()),
        }
        let output = voidwalk(&at, &args.iter().map(String::as_str).collect::<Vec<_>>());
        assert_eq!(output.status.code(), Some(2), "{args:?}: {}", is_inert(&output));
        let said = is_inert(&output);
        assert!(said.contains("script") || said.contains("base.sieve"), "{args:?}: {said}");
        fs::remove_file(at.join(name)).unwrap();
    }
    // Folders: of a run that is not one, and one that holds other things.
    fs::create_dir(at.join(EVIL)).unwrap();
    fs::write(at.join(EVIL).join("thesis.txt"), "years").unwrap();
    for args in [&["resume", EVIL][..], &["report", EVIL], &["run", "--out", EVIL]] {
        let output = voidwalk(&at, args);
        assert_eq!(output.status.code(), Some(2));
        assert!(is_inert(&output).contains("script"));
    }
}

#[test]
fn pages_and_tables_of_a_campaign_and_a_packing_hold_no_live_names() {
    let plan = "title = \"<script>alert(1)</script>\"\n[set]\nreplicates = 1\nnetwork = { nx = 3, ny = 3, nz = 3 }\n\
        base = { n_base = 500 }\nrecord = { sensitivity = [] }\n[[factor]]\nname = \"@f\"\n[factor.levels]\n\
        \"@SUM(1)\" = { \"base.cu\" = 1.5 }\n\"-1+cmd|x\" = { \"base.cu\" = 2 }\n\"<img src=x>\" = { \"base.cu\" = 3 }\n";
    let plan = plan.replace("<img src=x>", "<img onerror>");
    let filter = "[filter]\nsieve = \"<script>.csv\"\ndensity = \"loose\"\n[packing]\ngrains = 150\nstiffness_ratio = 0.01\n";
    let sieve = "opening_mm,percent_finer\n1,0\n1.5,100\n";
    let (_root, at) = room(&[("plan.toml", &plan), ("filter.toml", filter), ("<script>.csv", sieve)]);
    let output = voidwalk(&at, &["campaign", "plan.toml", "--out", "c"]);
    assert!(output.status.success(), "{}", is_inert(&output));
    let table = fs::read_to_string(at.join("c/cases.csv")).unwrap();
    for cell in ["'@SUM(1)", "'-1+cmd|x", "'@f"] {
        assert!(table.contains(cell), "{table}");
    }
    for line in table.lines() {
        for cell in line.split(',') {
            let cell = cell.trim_matches('"');
            assert!(!cell.starts_with(['=', '+', '@']), "{cell} in {line}");
            assert!(!cell.starts_with('-') || cell.parse::<f64>().is_ok(), "{cell} in {line}");
        }
    }
    let output = voidwalk(&at, &["pack", "filter.toml", "--out", "p"]);
    assert!(output.status.success(), "{}", is_inert(&output));
    let mut pages = 0;
    for folder in ["c", "c/figures", "p", "p/figures"] {
        for entry in fs::read_dir(at.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|e| e == "html" || e == "svg") {
                let text = fs::read_to_string(&path).unwrap();
                assert!(!text.contains("<script") && !text.contains("<img"), "{}", path.display());
                pages += 1;
            }
        }
    }
    assert!(pages > 4, "{pages} pages");
    assert!(fs::read_to_string(at.join("p/report.html")).unwrap().contains("&lt;script&gt;"));
}

#[test]
fn no_link_leads_out_of_a_folder() {
    let (_root, at) = room(&[("scene.toml", SCENE), ("precious.txt", "years of work")]);
    fs::create_dir(at.join("elsewhere")).unwrap();
    fs::create_dir(at.join("pack-elsewhere")).unwrap();
    let run = ["run", "scene.toml", "-q", "--checkpoint-every", "50increments", "--out"];
    let untouched = || {
        assert_eq!(fs::read_to_string(at.join("precious.txt")).unwrap(), "years of work");
        assert_eq!(fs::read_dir(at.join("elsewhere")).unwrap().count(), 0);
    };
    // Folders inside: refused. Files inside: replaced, and what they led to is as it was.
    for (number, (link, is_folder)) in [
        ("checkpoint", true),
        ("figures", true),
        ("series.csv", false),
        ("scene.toml", false),
        ("report.html", false),
        (".voidwalk-part-4999999-1", false),
        (".voidwalk.lock", true),
    ]
    .into_iter()
    .enumerate()
    {
        let out = format!("r{number}");
        fs::create_dir(at.join(&out)).unwrap();
        if link != ".voidwalk.lock" {
            fs::write(at.join(&out).join(".voidwalk.lock"), "").unwrap();
        }
        let target = if is_folder && link != ".voidwalk.lock" { "../elsewhere" } else { "../precious.txt" };
        symlink(target, at.join(&out).join(link)).unwrap();
        let output = voidwalk(&at, &[&run[..], &[out.as_str()]].concat());
        assert_eq!(output.status.success(), !is_folder, "{link}: {}", is_inert(&output));
        untouched();
    }
    // A checkpoint that is a link is none, and neither is a result.
    fs::create_dir_all(at.join("c/checkpoint")).unwrap();
    fs::write(at.join("c/.voidwalk.lock"), "").unwrap();
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/checkpoint-v1.particles");
    fs::copy(&golden, at.join("outside")).unwrap();
    symlink("../../outside", at.join("c/checkpoint/0-1.0")).unwrap();
    // Without a scene it is what was left of a run that was to be replaced: the link goes, not what it leads to.
    let output = voidwalk(&at, &[&run[..], &["c"]].concat());
    assert!(output.status.success(), "{}", is_inert(&output));
    assert_eq!(fs::read(at.join("outside")).unwrap(), fs::read(&golden).unwrap());
    let outcome = at.join("r2/outcome.json");
    fs::rename(&outcome, at.join("outcome")).unwrap();
    symlink("../outcome", &outcome).unwrap();
    let output = voidwalk(&at, &["report", "r2"]);
    assert!(!output.status.success() && is_inert(&output).contains("outcome.json"), "{}", is_inert(&output));
    // The folder itself, and those of a campaign's cases.
    symlink("elsewhere", at.join("link")).unwrap();
    for out in ["link", "link/"] {
        let output = voidwalk(&at, &[&run[..], &[out]].concat());
        assert_eq!(output.status.code(), Some(2), "{}", is_inert(&output));
    }
    let plan = "[set]\nreplicates = 1\nnetwork = { nx = 3, ny = 3, nz = 3 }\nbase = { n_base = 500 }\n[[case]]\nname = \"a\"\n";
    fs::write(at.join("plan.toml"), plan).unwrap();
    for (number, link) in ["cases", "cases/a"].into_iter().enumerate() {
        let out = format!("campaign{number}");
        fs::create_dir_all(at.join(&out).join(link).parent().unwrap()).unwrap();
        fs::write(at.join(&out).join(".voidwalk.lock"), "").unwrap();
        symlink(at.join("elsewhere"), at.join(&out).join(link)).unwrap();
        let output = voidwalk(&at, &["campaign", "plan.toml", "--out", &out]);
        assert!(!output.status.success(), "{link}: {}", is_inert(&output));
        untouched();
    }
}

/// Escapes, characters without a width, of other line ends, and that turn the direction of writing.
const HIDDEN: &str = "\u{1b}]0;x\u{7}\u{9b}2J\u{202e}\u{2066}\u{200b}\u{200d}\u{2028}\u{feff}\u{ad}\u{e0041}";

/// A text that no hidden character of a name has reached.
fn shows_all(place: &str, bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let found: Vec<char> = text.chars().filter(|c| HIDDEN.contains(*c) && !c.is_ascii_graphic()).collect();
    assert!(found.is_empty(), "{place}: {found:?}");
}

#[test]
fn hidden_characters_of_a_name_reach_no_face_and_the_name_is_found_as_it_is_shown() {
    let base =
        format!("size_mm,\"A{HIDDEN}\",\"b{HIDDEN}a\",\"a{HIDDEN}\",\"a\u{fffd}]0;x\u{fffd}\u{fffd}2J\"\n");
    let base = base + "0.1,0,0,0,0\n0.2,50,40,45,42\n0.4,100,100,100,100\n";
    let filter = format!("size_mm,\"f{HIDDEN}\",coarse\n0.5,0,0\n1,50,40\n2,100,100\n");
    let (_root, at) = room(&[("b.csv", &base), ("f.csv", &filter)]);
    let run = |args: &[&str]| {
        let output = voidwalk(&at, args);
        for (name, bytes) in [("stdout", &output.stdout), ("stderr", &output.stderr)] {
            shows_all(&format!("{args:?}: {name}"), bytes);
        }
        assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
        output
    };
    let names = String::from_utf8(run(&["soil", "b.csv", "--names"]).stdout).unwrap();
    assert_eq!(names.lines().count(), 4);
    for name in names.lines() {
        run(&["soil", name]);
    }
    // Exact in JSON.
    let json: serde_json::Value = serde_json::from_slice(&run(&["soil", "b.csv", "--json"]).stdout).unwrap();
    assert_eq!(json["soils"][1]["name"], format!("b{HIDDEN}a"));
    let (one, filter) = (names.lines().nth(1).unwrap(), format!("f.csv#f{HIDDEN}"));
    run(&["soil", "b.csv", "--figure", "soils.svg"]);
    run(&["rules", one, &filter]);
    run(&["rules", "b.csv", &filter, "--each", "--csv", "rules.csv"]);
    let small = "network.nx=3 network.ny=3 network.nz=3 replicates=1 runs=1 base.n_base=200";
    let small: Vec<&str> = small.split(' ').flat_map(|set| ["--set", set]).collect();
    run(&[&["judge", one, &filter, "--quick", "--out", "j"][..], &small].concat());
    run(&[&["judge", "b.csv", &filter, "--each", "--quick", "--out", "je"][..], &small].concat());
    run(&[&["judge", one, "f.csv#coarse", &filter, "--quick", "--out", "c"][..], &small].concat());
    run(&["design", one, "--out", "d"]);
    run(&["report", "j"]);
    let refused = voidwalk(&at, &["rules", "f.csv#nothing", "b.csv"]);
    shows_all("refusal", &refused.stderr);
    let (mut folders, mut files) = (vec![at], 0);
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
            match ending {
                // Copies of what was given are exact.
                _ if path.is_dir() && path.ends_with("inputs") => {}
                _ if path.is_dir() => folders.push(path),
                "html" | "svg" | "json" | "jsonl" | "csv"
                    if !path.ends_with("b.csv") && !path.ends_with("f.csv") =>
                {
                    shows_all(&path.display().to_string(), &fs::read(&path).unwrap());
                    files += 1;
                }
                _ => {}
            }
        }
    }
    assert!(files > 30, "{files}");
}
