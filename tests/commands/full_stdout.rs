//! Stdout on a full disk (`/dev/full`), closed by its reader, and stderr on a full disk.

use std::fs::{self, OpenOptions};
use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};

const SCENE: &str = "replicates = 1\nruns = 1\n[filter]\ncurve = \"shire2016-cu1.5-loose\"\n[base]\ncu = 1.5\nd85_at_dc = 5\n\
    n_base = 500\n[network]\nnx = 5\nny = 5\nnz = 5\n[record]\nsensitivity = []\n";

const PLAN: &str = "[set]\nreplicates = 1\nruns = 1\nnetwork = { nx = 5, ny = 5, nz = 5 }\nrecord = { sensitivity = [] }\n\
    base = { cu = 1.5, d85_at_dc = 5, n_base = 500 }\n[[case]]\nname = \"x\"\n";

/// Every command as it prints something; `GRAINS` is written by `pack` before.
const CALLS: [&str; 40] = [
    "--version",
    "--help",
    "-h",
    "help judge",
    "judge --help",
    "rules b.csv f.csv",
    "rules b.csv f.csv --json",
    "rules b.csv f.csv --each",
    "soil b.csv",
    "soil b.csv --json",
    "soil b.csv --names",
    "soil b.csv --figure b.svg",
    "init",
    "init --plan",
    "init --json",
    "init --schema outcome",
    "init new.toml",
    "completions bash",
    "completions zsh",
    "man pages",
    "examples tried",
    "check",
    "check scene.toml --json",
    "check plan.toml",
    "run scene.toml --out r",
    "run scene.toml --json --out rj",
    "run scene.toml --out rf --fail-on some",
    "report r",
    "export r",
    "campaign plan.toml --list --out c",
    "campaign plan.toml --out c",
    "campaign plan.toml --slurm --out cj",
    "judge b.csv f.csv g.csv --quick --out jf SMALL",
    "judge b.csv f.csv --quick --out j SMALL",
    "judge b.csv f.csv --quick --each --out je SMALL",
    "design b.csv --out d",
    "pack filter.toml --out p",
    "constrictions p/grains.csv",
    "percolation --realisations 2 --sizes 4 --out perc",
    "serve --out s",
];

const SMALL: &str = "--set network.nx=3 --set network.ny=3 --set network.nz=3 --set replicates=1";

fn files(folder: &Path) {
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    write("b.csv", "size_mm,percent\n0.1,0\n0.2,50\n0.4,100\n");
    write("f.csv", "size_mm,percent\n0.5,0\n1,50\n2,100\n");
    write("g.csv", "size_mm,percent\n1,0\n2,50\n4,100\n");
    write("scene.toml", SCENE);
    write("plan.toml", PLAN);
    let packed = "[packing]\ngrains = 150\nstiffness_ratio = 0.01\n";
    write("filter.toml", &format!("[filter]\ncu = 1.5\ndensity = \"loose\"\n{packed}"));
}

fn command(folder: &Path, call: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_voidwalk"));
    command.current_dir(folder).args(call.replace("SMALL", SMALL).split(' ')).stdin(Stdio::null());
    command
}

fn full() -> Stdio {
    OpenOptions::new().write(true).open("/dev/full").unwrap().into()
}

#[test]
fn what_cannot_be_written_to_stdout_is_an_error_of_every_command() {
    let root = tempfile::tempdir().unwrap();
    files(root.path());
    let wrong = CALLS.iter().filter_map(|call| {
        let output = command(root.path(), call).stdout(full()).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        let reasons = said.matches("error: cannot write to stdout: No space left").count();
        (output.status.code() != Some(1) || reasons != 1)
            .then(|| format!("{call}: {}: {said}", output.status))
    });
    let wrong: Vec<String> = wrong.collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_reader_that_leaves_and_a_full_stderr_are_no_error() {
    let root = tempfile::tempdir().unwrap();
    files(root.path());
    for call in CALLS.iter().filter(|call| !call.starts_with("serve") && !call.contains("--fail-on")) {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = command(root.path(), call).stdout(writer).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && !said.contains("stdout"), "{call}: {said}");
    }
    let root = tempfile::tempdir().unwrap();
    files(root.path());
    for call in ["rules b.csv", "nothing", "run scene.toml --out r", "judge b.csv f.csv --quick SMALL"] {
        let mut child = command(root.path(), call).stderr(full()).stdout(Stdio::piped()).spawn().unwrap();
        let mut said = String::new();
        child.stdout.take().unwrap().read_to_string(&mut said).unwrap();
        let code = child.wait().unwrap().code();
        assert_eq!(code, Some(if said.is_empty() { 2 } else { 0 }), "{call}: {said}");
    }
}
