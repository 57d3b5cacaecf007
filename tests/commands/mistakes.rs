//! The mistakes of a first hour, word for word: `mistakes.txt` holds command lines with the exit code and all
//! that the program says of them. With `VOIDWALK_WRITE_GOLDEN` set the file is written anew instead of compared.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use crate::program::call;

const GOLDEN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/commands/mistakes.txt");

/// The files that the command lines name.
fn files(folder: &Path) {
    let write = |name: &str, text: &[u8]| fs::write(folder.join(name), text).unwrap();
    let sand = "opening_mm,percent_finer\n2,100\n0.5,40\n0.1,0\n";
    for name in ["sand.csv", "gravel.csv", "my sand.csv"] {
        write(name, sand.as_bytes());
    }
    let scene = |set: &str| {
        format!(
            "replicates = 1\n[filter]\ncurve = \"cu3-loose\"\n[base]\ncu = 1.5\nd85_at_dc = 5\nn_base = 500\n{set}"
        )
    };
    write("dam.toml", scene("[network]\nnx = 5\nny = 5\nnz = 5\n").as_bytes());
    write("plan.toml", b"[[case]]\nname = \"x\"\n");
    write("unquoted.toml", b"[base]\nsieve = sand.csv\n");
    write("windows.toml", b"[base]\nsieve = \"csv\\sand.csv\"\n");
    write("comma.toml", b"[base]\ncu = 1,5\n");
    write("unit.toml", b"[network]\nthickness_mm = 500 mm\n");
    write("micron.toml", b"[base]\nd85_mm = 75 um\n");
    write("word.toml", b"[filter]\ndensity = \"tight\"\n");
    write("key.toml", b"[filtre]\ncu = 3\n");
    write("far.toml", b"[walk]\nbias = 1\n");
    write("lost.toml", b"[filter]\ncurve = \"cu3-loose\"\n[base]\nsieve = \"nosuch.csv\"\n");
    write("curve.toml", b"[filter]\ncurve = \"cu3-lose\"\n[base]\nsieve = \"sand.csv\"\n");
    write("open.toml", b"[filter]\nsieve = \"gravel.csv\"\n[base]\nsieve = \"sand.csv\"\n");
    let utf_16: Vec<u8> = scene("").encode_utf16().flat_map(u16::to_le_bytes).collect();
    write("utf16.toml", &[&[0xff, 0xfe], &utf_16[..]].concat());
    write("site.xlsx", &fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/soils/one.xlsx")).unwrap());
    let box_lines = "0 2\n0 2\n0 2\n";
    let dump = format!(
        "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp pp\n{box_lines}ITEM: ATOMS x y z radius\n1 1 1 0.5\n"
    );
    write("liggghts.dump", dump.as_bytes());
    write("atoms.dump", format!("ITEM: UNITS\nreal\n{dump}").as_bytes());
    write("yade.txt", b"#format x_y_z_r\n1 1 1 0.5\n");
    write("words.txt", b"some words\n");
    write("arrays.npz", b"no zip");
    let arrays =
        "[network]\nfile = \"arrays.npz\"\n[filter]\ncu = 1.5\n[base]\nsingle_mm = 0.1\nn_base = 5\n";
    write("arrays.toml", arrays.as_bytes());
    write("folder", b"a file");
    // Finished, with somebody's own things where the tables go.
    for name in ["finished", "linked"] {
        fs::create_dir(folder.join(name)).unwrap();
        write(&format!("{name}/constrictions.json"), b"{}");
        write(&format!("{name}/.voidwalk.lock"), b"");
    }
    write("finished/export", b"a file");
    std::os::unix::fs::symlink("..", folder.join("linked/export")).unwrap();
}

#[test]
fn every_mistake_is_answered_word_for_word() {
    let golden = fs::read_to_string(GOLDEN).unwrap();
    let root = tempfile::tempdir().unwrap();
    files(root.path());
    let before = fs::read_dir(root.path()).unwrap().count();
    let mut said = String::new();
    let lines: Vec<&str> = golden.lines().filter_map(|line| line.strip_prefix("$ ")).collect();
    assert!(lines.len() >= 30, "{} mistakes", lines.len());
    for line in lines {
        let words: Vec<String> = split(line);
        let args: Vec<&str> = words.iter().skip(1).map(String::as_str).collect();
        let output = call(root.path(), &args);
        let code = output.status.code().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        // Nobody is sent to the whole help where a word says what is meant.
        let kept =
            stderr.lines().filter(|line| !line.is_empty() && !line.starts_with("For more information"));
        write!(said, "$ {line}\n[{code}]\n{}\n\n", kept.collect::<Vec<_>>().join("\n")).unwrap();
        assert!(output.stdout.is_empty(), "{line}");
        assert_eq!(code, 2, "{line}: {stderr}");
    }
    if std::env::var_os("VOIDWALK_WRITE_GOLDEN").is_some() {
        fs::write(GOLDEN, &said).unwrap();
    } else {
        let differ = golden.lines().zip(said.lines()).find(|(was, is)| was != is);
        assert_eq!(golden, said, "first difference: {differ:?}");
    }
    assert_eq!(fs::read_dir(root.path()).unwrap().count(), before, "a refusal writes nothing");
}

/// As a shell does; `LONG` is a name of 300 letters.
fn split(line: &str) -> Vec<String> {
    let long = "a".repeat(300);
    let parts = line.split('"').enumerate();
    let words = parts.flat_map(|(at, part)| match at % 2 {
        0 => part.split_whitespace().map(String::from).collect::<Vec<_>>(),
        _ => vec![part.to_owned()],
    });
    words.map(|word| word.replace("LONG", &long)).collect()
}

/// A folder in which nobody but its owner may write, tried as somebody else.
#[test]
fn a_folder_without_permission_is_refused_with_a_way_out() {
    use std::os::unix::fs::PermissionsExt;
    use std::os::unix::process::CommandExt;
    let root = tempfile::tempdir().unwrap();
    files(root.path());
    let closed = root.path().join("closed");
    fs::create_dir(&closed).unwrap();
    fs::set_permissions(&closed, PermissionsExt::from_mode(0o555)).unwrap();
    fs::set_permissions(root.path(), PermissionsExt::from_mode(0o755)).unwrap();
    let mut command =
        crate::program::voidwalk(root.path(), &["run", "dam.toml", "-q", "--out", "closed/dam"]);
    // Root may write anywhere.
    if is_root() {
        // The program itself may lie where only root looks.
        let copy = root.path().join("voidwalk");
        fs::copy(env!("CARGO_BIN_EXE_voidwalk"), &copy).unwrap();
        command = std::process::Command::new(copy);
        command.current_dir(root.path()).args(["run", "dam.toml", "-q", "--out", "closed/dam"]).uid(65534);
    }
    let output = command.output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("closed/dam") && stderr.contains("Permission denied"), "{stderr}");
    assert!(stderr.contains("name a folder of your own by --out"), "{stderr}");
}

fn is_root() -> bool {
    use std::os::unix::fs::MetadataExt;
    fs::metadata("/proc/self").is_ok_and(|of| of.uid() == 0)
}
