//! The mistakes of a first hour: what a command line is answered with, and with which exit code.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn voidwalk(folder: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_voidwalk"))
        .current_dir(folder)
        .args(words)
        .stdin(Stdio::null())
        .output()
        .unwrap()
}

/// A scene of a second.
const SMALL: &str = "replicates = 1\nruns = 1\n[filter]\ncurve = \"shire2016-cu1.5-loose\"\n[base]\ncu = 1.5\nd85_at_dc = 5\n\
    n_base = 500\n[network]\nnx = 5\nny = 5\nnz = 5\n[record]\nsensitivity = []\n";

const PLAN: &str = "[set]\nreplicates = 1\nruns = 1\nnetwork = { nx = 5, ny = 5, nz = 5 }\nrecord = { sensitivity = [] }\n\
    base = { cu = 1.5, d85_at_dc = 5, n_base = 500 }\n[[case]]\nname = \"x\"\n[[case]]\nname = \"y\"\n";

/// The files that the command lines name.
fn files(folder: &Path) {
    let write = |name: &str, text: &[u8]| fs::write(folder.join(name), text).unwrap();
    write("small.toml", SMALL.as_bytes());
    write("plan.toml", PLAN.as_bytes());
    write("sand.csv", b"opening_mm,percent_finer\n2,100\n0.5,40\n0.1,0\n");
    write("comma.toml", b"[base]\ncu = 1,5\n");
    write("windows.toml", b"[base]\nsieve = \"csv\\sand.csv\"\n");
    let sieve = |path: &str| {
        format!("[filter]\ncurve = \"shire2016-cu1.5-loose\"\n[base]\nsieve = {path}\nn_base = 5\n")
    };
    write("tab.toml", sieve("\"csv\\table.csv\"").as_bytes());
    write("missing.toml", sieve("\"nosuch.csv\"").as_bytes());
    let utf_16: Vec<u8> = SMALL.encode_utf16().flat_map(u16::to_le_bytes).collect();
    write("utf16.toml", &[&[0xff, 0xfe], &utf_16[..]].concat());
    write("latin.toml", b"# gr\xf6\xdfer\nseed = 1\n");
    write("key.toml", b"[walk]\nbias = 1\n");
    write("other.toml", b"[quxxy]\nbias = 1\n");
    write("table.toml", b"[filtre]\ncu = 1\n");
    let grains = "# cell = none\nx_mm,y_mm,z_mm,diameter_mm\n0,0,0,1\n1,0,0,1\n0,1,0,1\n";
    write("three.csv", grains.as_bytes());
    write("four.csv", format!("{grains}0,0,1,1\n").as_bytes());
    write("flat.csv", format!("{grains}1,1,0,1\n2,1,0,1\n").as_bytes());
    fs::create_dir(folder.join("thesis")).unwrap();
    write("thesis.txt", b"years of work");
    fs::hard_link(folder.join("thesis.txt"), folder.join("thesis/.voidwalk.lock")).unwrap();
    let made = Command::new("mkfifo").arg(folder.join("pipe")).status().unwrap();
    assert!(made.success());
}

#[test]
fn every_mistake_is_answered_with_a_way_out() {
    let root = tempfile::tempdir().unwrap();
    files(root.path());
    // The command line, its exit code, and what it must say on stderr.
    let table: &[(&str, i32, &[&str])] = &[
        ("check --seed -1", 2, &["--seed", "a whole number from 0 to 18446744073709551615"]),
        ("pack small.toml --seed -1", 2, &["--seed", "a whole number from 0"]),
        ("percolation --seed 1.5", 2, &["--seed", "a whole number from 0"]),
        ("run --threads -2", 2, &["--threads", "a whole number from 1 to 1024"]),
        ("run --memory -2GB", 2, &["--memory", "a size above 0 as 4GB"]),
        ("check --set filter.cu 3", 2, &["--set", "write KEY=VALUE, as --set filter.cu=3"]),
        ("check --decide-percent 150", 2, &["--decide-percent", "from 50 to 99.999 (%)"]),
        ("check --target-error-pp 0.5pp", 2, &["percentage points of the base, above 0 and below 100"]),
        ("check comma.toml", 2, &["comma.toml, line 2: `1,5` has a decimal comma; write cu = 1.5"]),
        ("check windows.toml", 2, &["windows.toml, line 2", "backslashes; write sieve = \"csv/sand.csv\""]),
        ("check tab.toml", 2, &["named by base.sieve", "write / between folders, not a backslash"]),
        ("check missing.toml", 2, &["nosuch.csv, named by base.sieve: No such file"]),
        ("check utf16.toml", 2, &["utf16.toml: is UTF-16 text", "save it as UTF-8"]),
        ("campaign utf16.toml", 2, &["utf16.toml: is UTF-16 text", "save it as UTF-8"]),
        ("check latin.toml", 2, &["latin.toml: is not UTF-8 text (line 1); save it as UTF-8"]),
        ("check key.toml", 2, &["line 2: there is no setting `walk.bias`; [walk] has exit, rho"]),
        (
            "check other.toml",
            2,
            &["line 1: there is no setting `quxxy`; there are [stop], [filter]", "seed, "],
        ),
        ("check table.toml", 2, &["line 1: there is no setting `filtre`; did you mean [filter]?"]),
        (
            "check --set stop.bias=1",
            2,
            &["no setting `stop.bias`; [stop] has target_error_pp, decide_percent"],
        ),
        ("check --set record.foo=1", 2, &["no setting `record.foo`; [record] has "]),
        (
            "check --set base.d85_mm=1 --set base.d85_at_dc=5",
            2,
            &["--set: base.d85_mm and base.d85_at_dc both set D85B: keep one"],
        ),
        ("run sand.csv", 2, &["sand.csv: is a table of numbers, not a scene", "base.sieve ="]),
        ("run plan.toml", 2, &["plan.toml: is the plan of a campaign, not a scene", "voidwalk campaign"]),
        ("campaign small.toml", 2, &["small.toml: is a scene, not the plan of a campaign", "voidwalk run"]),
        ("campaign sand.csv", 2, &["sand.csv: is a table of numbers, not the plan of a campaign"]),
        ("run pipe", 2, &["pipe: is a pipe, a device or a socket; allowed: a regular file of at most 1 MB"]),
        ("campaign pipe", 2, &["pipe: is a pipe, a device or a socket; allowed: "]),
        ("constrictions pipe", 2, &["pipe: cannot be read: is not a regular file"]),
        ("check --set base.sieve=pipe", 2, &["refused: pipe: is a pipe, a device or a socket; allowed: "]),
        ("check --set filter.curve=pipe.csv", 2, &["pipe.csv, named by filter.curve: No such file"]),
        ("constrictions three.csv --out c", 2, &["three.csv: 3 grains: a triangulation needs at least 4"]),
        (
            "constrictions four.csv --out c",
            2,
            &["four.csv: no grain is surrounded by others", "at least three grains along each axis"],
        ),
        ("constrictions flat.csv --out c", 2, &["flat.csv: the centres of all 5 grains lie in one plane"]),
        (
            "run small.toml --out thesis",
            2,
            &["thesis/.voidwalk.lock: is not a voidwalk lock file", "name another folder"],
        ),
    ];
    let before = fs::read_dir(root.path()).unwrap().count();
    for (line, code, messages) in table {
        let output = voidwalk(root.path(), &line.split(' ').collect::<Vec<_>>());
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(*code), "{line}: {stderr}");
        for message in *messages {
            assert!(stderr.contains(message), "{line}: {stderr:?} lacks {message:?}");
        }
    }
    assert_eq!(fs::read_dir(root.path()).unwrap().count(), before, "a refusal writes nothing");
    assert_eq!(fs::read_to_string(root.path().join("thesis.txt")).unwrap(), "years of work");
}

#[test]
fn one_replicate_is_said_to_have_no_scatter() {
    let root = tempfile::tempdir().unwrap();
    files(root.path());
    let one = voidwalk(root.path(), &["run", "small.toml", "--out", "one"]);
    let text = String::from_utf8_lossy(&one.stdout);
    // Sizes are multiples of D0F: the model's line alone.
    assert!(text.starts_with("Model (research): "), "{text}");
    let ids = |folder: &str| {
        let text = fs::read_to_string(root.path().join(folder).join("outcome.json")).unwrap();
        let outcome: serde_json::Value = serde_json::from_str(&text).unwrap();
        outcome["notes"].to_string()
    };
    // One run of two: what it leaves open, and that one replicate has no scatter.
    assert!(
        ids("one").contains("second_run_missing") && ids("one").contains("one_replicate"),
        "{}",
        ids("one")
    );
    voidwalk(root.path(), &["run", "small.toml", "--set", "replicates=2", "--out", "two"]);
    assert!(ids("two").contains("few_replicates") && !ids("two").contains("one_replicate"), "{}", ids("two"));
}

/// The words of a page before its scene, without the rules of practice, whose sources speak of mm.
fn words_of_page(folder: &Path) -> String {
    let page = fs::read_to_string(folder.join("report.html")).unwrap();
    let body = page.split("</style>").nth(1).unwrap();
    let body = body.split("<pre>").next().unwrap();
    let without = |body: &str, heading: &str| {
        let (before, section) = body.split_once(&format!(">{heading}</h2>")).unwrap();
        format!("{before} {}", section.split_once("<h2").unwrap().1)
    };
    without(&without(body, "All rules"), "Sources")
}

/// Nothing has a scale in the built-in scene: sizes are multiples of D0F.
#[test]
fn a_scene_without_a_scale_says_nothing_in_mm() {
    let root = tempfile::tempdir().unwrap();
    files(root.path());
    let set = ["--set", "replicates=2", "--set", "engine=counts"];
    let run = voidwalk(root.path(), &[&["run", "small.toml", "--out", "free"], &set[..]].concat());
    let words = [String::from_utf8(run.stdout).unwrap(), words_of_page(&root.path().join("free"))];
    for text in &words {
        for unit in [" mm", "\u{202f}mm", "(mm)"] {
            let at = text.find(unit);
            assert!(
                at.is_none(),
                "{}",
                at.map_or("", |at| text.get(at.saturating_sub(80)..at + 20).unwrap_or_default())
            );
        }
    }
    assert!(words[1].contains(" D0F)") && words[1].contains("Size / D0F"));
}

/// Digits as people write them: `19.65 %`, `1 core`, `1 replicate`.
#[test]
fn percentages_and_counts_read_as_people_write_them() {
    let root = tempfile::tempdir().unwrap();
    files(root.path());
    for (name, n_base) in [("few", 300), ("many", 200_000)] {
        let n_base = format!("base.n_base={n_base}");
        let run =
            voidwalk(root.path(), &["run", "small.toml", "--set", &n_base, "--threads", "1", "--out", name]);
        let text = String::from_utf8(run.stdout).unwrap() + &words_of_page(&root.path().join(name));
        let words: Vec<&str> = text.split(|c: char| c.is_whitespace() || "<>()".contains(c)).collect();
        for pair in words.windows(2) {
            let is_power = |word: &str| word.contains("e-") || word.contains("e0") || word.contains("e1");
            let is_number =
                pair[0].starts_with(|c: char| c.is_ascii_digit()) && pair[0].parse::<f64>().is_ok();
            assert!(!(is_number && is_power(pair[0]) && pair[1].starts_with('%')), "{pair:?}");
            let plural = ["replicates", "cores", "constrictions", "runs", "grains", "voids", "warnings"];
            assert!(
                !(pair[0] == "1" && plural.contains(&pair[1].trim_end_matches([',', '.', ';', ':']))),
                "{pair:?}"
            );
        }
    }
}

#[test]
fn what_a_changed_plan_does_to_finished_cases_is_said() {
    let root = tempfile::tempdir().unwrap();
    files(root.path());
    let stderr = |text: &str| {
        fs::write(root.path().join("plan.toml"), text).unwrap();
        let output = voidwalk(root.path(), &["campaign", "plan.toml", "--out", "c", "-q"]);
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{stderr}");
        stderr
    };
    assert_eq!(stderr(PLAN), "");
    assert_eq!(stderr(PLAN), "");
    let more = stderr(&PLAN.replace("replicates = 1", "replicates = 2"));
    assert!(
        more.contains("2 finished cases (x; y): settings or files have changed since; walked again"),
        "{more}"
    );
    let fewer =
        stderr(&PLAN.replace("replicates = 1", "replicates = 2").replace("[[case]]\nname = \"y\"\n", ""));
    assert!(fewer.contains("1 finished case (y): not in the plan any more; left out of ledger"), "{fewer}");
    assert!(root.path().join("c/cases/y/case.json").exists());
}

/// A loop with a way out that is taken once in a million million moves.
#[test]
fn a_walk_that_may_not_end_is_warned_of_before_it_begins() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("leak.csv"), "from,to,diameter_mm\nstart,0,\n0,0,1000\n0,end,0.001\n")
        .unwrap();
    let scene = "replicates = 1\nruns = 1\n[filter]\nd0_mm = 1\ncu = 1.5\ngrains_per_void = 0.6\n[base]\n\
        single_mm = 0.0005\nn_base = 10\n[network]\nfile = \"leak.csv\"\n[record]\nsensitivity = []\n";
    fs::write(root.path().join("n.toml"), scene).unwrap();
    let check = voidwalk(root.path(), &["check", "n.toml", "--json"]);
    let check: serde_json::Value = serde_json::from_slice(&check.stdout).unwrap();
    assert!(check["notes"].to_string().contains("long_way_out"), "{check}");
}

/// A file where the program wants to read one of its own, or to write where a link leads, ends nothing.
#[test]
fn pipes_and_links_inside_a_folder_are_no_trap() {
    let root = tempfile::tempdir().unwrap();
    files(root.path());
    let campaign = |more: &[&str]| {
        voidwalk(root.path(), &[&["campaign", "plan.toml", "--out", "c", "-q"], more].concat())
    };
    assert!(campaign(&[]).status.success());
    let line = root.path().join("c/cases/x/case.json");
    fs::remove_file(&line).unwrap();
    assert!(Command::new("mkfifo").arg(&line).status().unwrap().success());
    // It is no finished case: walked again, and the pipe is replaced.
    let again = campaign(&[]);
    assert!(again.status.success(), "{}", String::from_utf8_lossy(&again.stderr));
    assert!(line.is_file());

    let packed = PLAN.replace("[[case]]\nname = \"y\"\n", "").replace(
        "[[case]]",
        "filter = { cu = 1.5, density = \"loose\" }\npacking = { grains = 100 }\n[[case]]",
    );
    fs::write(root.path().join("packed.toml"), packed).unwrap();
    fs::create_dir(root.path().join("elsewhere")).unwrap();
    std::os::unix::fs::symlink("../elsewhere", root.path().join("c/packings")).unwrap();
    let refused = voidwalk(root.path(), &["campaign", "packed.toml", "--out", "c", "-q"]);
    let stderr = String::from_utf8_lossy(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("c/packings: is a symbolic link, which is not followed"), "{stderr}");
    assert_eq!(fs::read_dir(root.path().join("elsewhere")).unwrap().count(), 0);
}

/// The shell says how large a file may be, and how much processor time there is.
#[test]
fn limits_of_the_system_end_a_run_with_a_word_or_a_checkpoint() {
    let root = tempfile::tempdir().unwrap();
    files(root.path());
    let shell = |script: &str| {
        let program = env!("CARGO_BIN_EXE_voidwalk");
        Command::new("bash").current_dir(root.path()).args(["-c", script, "bash", program]).output().unwrap()
    };
    let small = shell("ulimit -c 0; ulimit -f 4; \"$1\" run small.toml --out small -q");
    let stderr = String::from_utf8_lossy(&small.stderr);
    assert_eq!(small.status.code(), Some(1), "{stderr}");
    assert!(stderr.contains("small/") && stderr.contains("ulimit -f"), "{stderr}");

    let long = SMALL.replace("n_base = 500", "n_base = 30000000").replace("nz = 5", "nz = 200");
    fs::write(root.path().join("long.toml"), long.replace("runs = 1", "runs = 1\nengine = \"particles\""))
        .unwrap();
    for signal in ["HUP", "XCPU", "TERM"] {
        // Not as `nohup` would have it, and as soon as the walk has begun.
        let script = format!(
            "env --default-signal={signal} \"$1\" run long.toml --out {signal} -q & \
             until [ -e {signal}/.voidwalk.unfinished ] || ! kill -0 $!; do sleep 0.02; done; \
             sleep 0.1; kill -{signal} $!; wait $!"
        );
        let output = shell(&script);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{signal}: {stderr}");
        assert!(stderr.contains("progress saved; continue with `voidwalk resume"), "{signal}: {stderr}");
        assert!(fs::read_dir(root.path().join(signal).join("checkpoint")).unwrap().count() > 0);
    }
}

/// A large network keeps the program in its set-up.
#[test]
fn a_signal_before_anything_is_saved_ends_the_program_as_any_other() {
    use std::os::unix::process::ExitStatusExt;
    let root = tempfile::tempdir().unwrap();
    files(root.path());
    let long =
        SMALL.replace("nz = 5", "nz = 100").replace("nx = 5", "nx = 200").replace("ny = 5", "ny = 200");
    fs::write(root.path().join("long.toml"), long).unwrap();
    for (name, signal) in [("INT", 2), ("TERM", 15)] {
        let script = format!("exec env --default-signal={name} \"$1\" run long.toml --out late -q");
        let program = env!("CARGO_BIN_EXE_voidwalk");
        let mut child = Command::new("bash")
            .current_dir(root.path())
            .args(["-c", &script, "bash", program])
            .spawn()
            .unwrap();
        std::thread::sleep(std::time::Duration::from_millis(60));
        Command::new("kill").args([&format!("-{name}"), &child.id().to_string()]).status().unwrap();
        let status = child.wait().unwrap();
        let is_claimed = root.path().join("late").exists();
        assert!(is_claimed || status.signal() == Some(signal), "{name}: {status}");
        let _ = fs::remove_dir_all(root.path().join("late"));
    }
}

/// A workbook needs threads, and so many are not to be had.
#[test]
fn without_threads_a_design_says_so() {
    let root = tempfile::tempdir().unwrap();
    fs::set_permissions(root.path(), std::os::unix::fs::PermissionsExt::from_mode(0o777)).unwrap();
    let program = root.path().join("voidwalk");
    fs::copy(env!("CARGO_BIN_EXE_voidwalk"), &program).unwrap();
    fs::write(root.path().join("b.csv"), "size_mm,passing\n0.1,0\n0.2,50\n0.4,100\n").unwrap();
    let limits = ["--reuid", "65534", "--regid", "65534", "--clear-groups", "prlimit", "--nproc=1"];
    let design = Command::new("setpriv")
        .args(limits)
        .arg(&program)
        .args(["design", "b.csv", "--out", "d"])
        .current_dir(root.path())
        .output();
    let Ok(output) = design else { return };
    let stderr = String::from_utf8_lossy(&output.stderr);
    if stderr.contains("setpriv:") || stderr.contains("prlimit:") {
        return;
    }
    assert!(output.status.code() == Some(1) && stderr.contains("threads"), "{:?}: {stderr}", output.status);
}

/// Behind `FILE#` bash offers the soils of that very file, quoted where their names have blanks.
#[test]
fn bash_completes_the_soils_of_a_file() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("site.csv"), "mm,North 1,South 2\n2,100,100\n1,50,40\n0.5,0,0\n").unwrap();
    let asked = "source <(\"$1\" completions bash); COMP_WORDS=(voidwalk judge \"$2\"); COMP_CWORD=2; \
                 _voidwalk_and_values \"$1\" \"$2\" judge; printf '%s\\n' \"${COMPREPLY[@]}\"";
    let completed = |word: &str| {
        let words = ["-c", asked, "bash", env!("CARGO_BIN_EXE_voidwalk"), word];
        let bash = Command::new("bash").args(words).current_dir(root.path()).output().unwrap();
        String::from_utf8(bash.stdout).unwrap()
    };
    assert_eq!(completed("site.csv#"), "site.csv#North\\ 1\nsite.csv#South\\ 2\n");
    assert_eq!(completed("site.csv#North\\ "), "site.csv#North\\ 1\n");
    assert_eq!(completed("\"site.csv#S"), "site.csv#South 2\n");
    assert_eq!(completed("gone.csv#").trim(), "");
    let names = voidwalk(root.path(), &["soil", "site.csv", "--names"]);
    assert_eq!(String::from_utf8(names.stdout).unwrap(), "site.csv#North 1\nsite.csv#South 2\n");
}

/// What a shell and `man` are given, and what the program says of itself.
#[test]
fn shells_and_man_know_every_command() {
    let root = tempfile::tempdir().unwrap();
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = String::from_utf8(voidwalk(root.path(), &["completions", shell]).stdout).unwrap();
        assert!(script.contains("voidwalk") && script.contains("merge-overlap"), "{shell}");
    }
    // As bash does it, where there is one.
    let asked = "source <(\"$1\" completions bash); COMP_WORDS=(voidwalk constr); COMP_CWORD=1; _voidwalk voidwalk \
                 constr voidwalk; echo \"${COMPREPLY[@]}\"";
    let bash =
        Command::new("bash").args(["-c", asked, "bash", env!("CARGO_BIN_EXE_voidwalk")]).output().unwrap();
    assert_eq!(String::from_utf8(bash.stdout).unwrap().trim(), "constrictions");
    let pages = voidwalk(root.path(), &["man", "pages"]);
    assert!(pages.status.success(), "{}", String::from_utf8_lossy(&pages.stderr));
    for command in ["voidwalk", "voidwalk-run", "voidwalk-export", "voidwalk-man"] {
        let page = fs::read_to_string(root.path().join(format!("pages/{command}.1"))).unwrap();
        assert!(page.contains(&format!(".TH {command} 1")), "{page}");
        assert_eq!(page.contains("Examples:"), command != "voidwalk", "{page}");
    }
    let version = String::from_utf8(voidwalk(root.path(), &["--version"]).stdout).unwrap();
    let (number, commit) = version.trim().split_once(" (").unwrap_or((version.trim(), ")"));
    assert_eq!(number, format!("voidwalk {}", env!("CARGO_PKG_VERSION")));
    let digits = commit.trim_end_matches(')');
    assert!(
        digits.is_empty() || (digits.len() == 12 && digits.chars().all(|c| c.is_ascii_hexdigit())),
        "{version}"
    );
}

#[test]
fn examples_are_written_once_and_every_short_one_runs() {
    let root = tempfile::tempdir().unwrap();
    let written = voidwalk(root.path(), &["examples", "try"]);
    assert_eq!(written.status.code(), Some(0), "{}", String::from_utf8_lossy(&written.stderr));
    assert!(String::from_utf8_lossy(&written.stdout).contains("voidwalk rules base.csv filter.csv"));
    let again = voidwalk(root.path(), &["examples", "try"]);
    assert_eq!(again.status.code(), Some(2));
    let said = String::from_utf8_lossy(&again.stderr);
    assert!(said.contains("base.csv: exists already; nothing was written. Name another folder"), "{said}");
    let folder = root.path().join("try");
    let small = ["network.nx=5", "network.ny=5", "network.nz=5", "replicates=1"];
    let small: Vec<&str> = small.iter().flat_map(|set| ["--set", set]).collect();
    for words in [
        vec!["soil", "us-sieves.csv"],
        vec!["soil", "borrow-area.ags"],
        vec!["rules", "base.csv", "filter.csv"],
        vec!["campaign", "plan.toml", "--list"],
        [&["judge", "base.csv", "filter-fine.csv", "--quick", "-q", "--out", "first"], &small[..]].concat(),
        [&["run", "scene.toml", "-q", "--out", "scene"], &small[..]].concat(),
    ] {
        let done = voidwalk(&folder, &words);
        assert_eq!(done.status.code(), Some(0), "{words:?}: {}", String::from_utf8_lossy(&done.stderr));
    }
    let page = fs::read_to_string(folder.join("scene/report.html")).unwrap();
    assert!(page.contains("Chimney filter") && page.contains("mm (in)"));
}
