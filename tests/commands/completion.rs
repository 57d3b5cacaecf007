//! Completion of the names of soils and files in the shells that are installed: whatever they are called, nothing of it is run.
//! A terminal is made by `script` of util-linux.

use std::fmt::Write as _;
use std::fs;
use std::io::{Read, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use crate::program::call;

/// Ways to have a word run, `TOUCH` being a command, and what shells give a meaning to.
const PIECES: [&str; 43] = [
    "$(TOUCH)",
    "`TOUCH`",
    "; TOUCH; ",
    "\"; TOUCH; \"",
    "'; TOUCH; '",
    "\\\"; TOUCH; \\\"",
    "\\'; TOUCH; \\'",
    "| TOUCH |",
    "& TOUCH &",
    "&& TOUCH &&",
    "(TOUCH)",
    "<(TOUCH)",
    "> p; TOUCH",
    "\u{85}TOUCH\u{2028}",
    "\u{7}TOUCH\u{8}",
    "$'\\x24(TOUCH)'",
    "${x:-$(TOUCH)}",
    "\\$(TOUCH)",
    "\\\\$(TOUCH)",
    "\\`TOUCH\\`",
    "\"$(TOUCH)\"",
    "'$(TOUCH)'",
    "\"'$(TOUCH)'\"",
    "'\"$(TOUCH)\"'",
    "!!",
    "!TOUCH",
    "!(TOUCH)",
    "\\",
    "\"",
    "'",
    "$",
    "*",
    "~",
    "?",
    "{a,b}",
    "[a-z]",
    "#",
    "=ls",
    "^a^b",
    "\u{1b}[2J",
    "\u{202e}",
    "\u{200b}",
    "Böden – 砂 ",
];

/// The name of soil `n`: each piece by itself, then several together.
fn hostile(n: usize) -> String {
    let mut state = n as u64 + 1;
    let mut draw = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        PIECES[(state >> 33) as usize % PIECES.len()]
    };
    let name =
        PIECES.get(n).map_or_else(|| (0..n % 4 + 2).map(|_| draw()).collect(), |piece| (*piece).to_owned());
    format!("n{n:03}{name}").replace("TOUCH", &format!("touch ran-{n:03}"))
}

const SOILS: usize = 80;
const OF_SHEET: usize = 40;

/// The beginning of what names soil `n`.
fn begun(n: usize) -> String {
    format!("s{}.csv#n{n:03}", n / OF_SHEET)
}

/// Sheets of hostile names: what the program prints of each.
fn sheets(at: &Path) -> Vec<String> {
    let mut names = Vec::new();
    for first in (0..SOILS).step_by(OF_SHEET) {
        let cell = |n| format!(",\"{}\"", hostile(n).replace('"', "\"\""));
        let mut table = String::from("size_mm");
        table.extend((first..first + OF_SHEET).map(cell));
        for (size, percent) in [("0.1", "0"), ("0.2", "50"), ("0.4", "100")] {
            let _ = write!(table, "\n{size}{}", format!(",{percent}").repeat(OF_SHEET));
        }
        let name = format!("s{}.csv", first / OF_SHEET);
        fs::write(at.join(&name), table + "\n").unwrap();
        let printed = call(at, &["soil", &name, "--names"]);
        names.extend(String::from_utf8(printed.stdout).unwrap().lines().map(str::to_owned));
        assert_eq!(names.len(), first + OF_SHEET, "{}", String::from_utf8_lossy(&printed.stderr));
    }
    names
}

/// A shell in a terminal.
struct Terminal {
    script: Child,
    seen: Arc<Mutex<String>>,
}

impl Terminal {
    fn new(at: &Path, shell: &str) -> Self {
        let path = format!("{}:{}", at.join("bin").display(), std::env::var("PATH").unwrap());
        let mut script = Command::new("script")
            .args(["-qefc", shell, "/dev/null"])
            .current_dir(at)
            .envs([
                ("PATH", path.as_str()),
                ("HOME", at.to_str().unwrap()),
                ("TERM", "dumb"),
                ("LC_ALL", "C.UTF-8"),
            ])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let seen = Arc::new(Mutex::new(String::new()));
        let (mut out, into) = (script.stdout.take().unwrap(), Arc::clone(&seen));
        std::thread::spawn(move || {
            let mut bytes = [0; 4096];
            while let Ok(count @ 1..) = out.read(&mut bytes) {
                into.lock().unwrap().push_str(&String::from_utf8_lossy(&bytes[..count]));
            }
        });
        Self { script, seen }
    }

    fn send(&mut self, keys: &str) {
        self.script.stdin.as_mut().unwrap().write_all(keys.as_bytes()).unwrap();
    }

    fn seen(&self) -> String {
        self.seen.lock().unwrap().clone()
    }

    /// Waits until something holds: whether it did.
    fn until(&self, holds: impl Fn(&str) -> bool, seconds: f64) -> bool {
        let end = Instant::now() + Duration::from_secs_f64(seconds);
        while Instant::now() < end {
            if holds(&self.seen()) {
                return true;
            }
            std::thread::sleep(Duration::from_millis(3));
        }
        false
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        let _ = self.script.kill();
        let _ = self.script.wait();
    }
}

/// A shell that completes the program's words, in a folder; the program keeps its last word in place of doing what it is asked to.
fn terminal(shell: &str, start: &str, setup: &str) -> Option<(tempfile::TempDir, Terminal)> {
    let found = |program: &str| {
        Command::new(program).arg("--version").stdout(Stdio::null()).status().is_ok_and(|s| s.success())
    };
    if !found(shell) || !found("script") {
        println!("skipped: {shell} or script is not installed");
        return None;
    }
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::create_dir(at.join("bin")).unwrap();
    let program = env!("CARGO_BIN_EXE_voidwalk");
    let stub = at.join("bin/voidwalk");
    fs::write(
        &stub,
        format!("#!/bin/sh\ncase \" $* \" in *' --names '*) exec '{program}' \"$@\" ;; esac\nfor last; do :; done\nprintf '%s\\0' \"$last\" >> '{}'\n",
            at.join("asked").display()),
    )
    .unwrap();
    fs::set_permissions(&stub, fs::Permissions::from_mode(0o755)).unwrap();
    fs::write(at.join("completions"), call(at, &["completions", shell]).stdout).unwrap();
    let mut terminal = Terminal::new(at, start);
    terminal.send(&format!("{setup}\necho rea''dy\n"));
    assert!(
        terminal.until(|seen| seen.contains("\nready") || seen.contains("\rready"), 20.0),
        "{shell}: {}",
        terminal.seen()
    );
    Some((root, terminal))
}

/// The last word that the program was given after these keys; none where quotes are open still.
fn last_word(at: &Path, terminal: &mut Terminal, keys: &str) -> String {
    let asked = || fs::read_to_string(at.join("asked")).unwrap_or_default();
    let before = asked().len();
    let waits = terminal.seen().matches("MORE>").count();
    terminal.send(keys);
    // A shell writes a word in pieces: it is whole once its end is there.
    let is_whole = || {
        let all = asked();
        all.len() > before && all.ends_with('\0')
    };
    terminal.until(|seen| is_whole() || seen.matches("MORE>").count() > waits, 20.0);
    let word = asked()[before..].split('\0').next().unwrap_or_default().to_owned();
    if word.is_empty() {
        let prompts = terminal.seen().matches("READY>").count();
        terminal.send("\u{3}");
        terminal.until(|seen| seen.matches("READY>").count() > prompts, 2.0);
    }
    let ran: Vec<_> =
        fs::read_dir(at).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    assert!(!ran.iter().any(|file| file.starts_with("ran-")), "{keys:?} ran a name: {ran:?}");
    word
}

/// The soil that a command was given after `FILE#`, for each soil whose name was completed behind `quote`.
fn completed(shell: &str, start: &str, setup: &str, quote: &str) -> Option<Vec<(String, String)>> {
    let (root, mut terminal) = terminal(shell, start, setup)?;
    let names = sheets(root.path());
    let keys = |n| format!("voidwalk soil {quote}{}\t\n", begun(n));
    let with_word = |(n, name)| (name, last_word(root.path(), &mut terminal, &keys(n)));
    Some(names.into_iter().enumerate().map(with_word).collect())
}

/// Nothing is run, and what is completed is the name: every one in a bare word, in quotes at least so many.
fn check(shell: &str, start: &str, setup: &str, in_quotes: usize) {
    for quote in ["", "\"", "'"] {
        let Some(all) = completed(shell, start, setup, quote) else { return };
        let right = all.iter().filter(|(name, word)| name == word).count();
        let wrong: Vec<_> = all
            .iter()
            .enumerate()
            .filter(|(n, (name, word))| name != word && !word.is_empty() && *word != begun(*n))
            .collect();
        println!("{shell} after {quote:?}: {right} of {} completed", all.len());
        assert!(wrong.is_empty(), "{shell} after {quote:?}: {wrong:?}");
        let least = if quote.is_empty() { all.len() } else { in_quotes };
        assert!(right >= least, "{shell} after {quote:?}: {right} of {}: {all:?}", all.len());
    }
}

const BASH: [&str; 3] = [
    "bash",
    "bash --norc --noprofile -i",
    "PS1='READY>' PS2='MORE>'; bind 'set enable-bracketed-paste off'; source ./completions",
];

#[test]
fn bash_runs_nothing_of_a_name() {
    let [shell, start, setup] = BASH;
    check(shell, start, setup, 10);
}

#[test]
fn bash_runs_nothing_of_the_name_of_a_file() {
    let [shell, start, setup] = BASH;
    let Some((root, mut terminal)) = terminal(shell, start, setup) else { return };
    let files = [
        "x$(touch${IFS}ran-x).csv",
        "y`touch${IFS}ran-y`.csv",
        "z; touch ran-z;.csv",
        "q\"'$(touch ran-q)'\".csv",
    ];
    files.iter().for_each(|file| fs::write(root.path().join(file), "").unwrap());
    fs::create_dir(root.path().join("v$(touch ran-v)")).unwrap();
    for before in [
        "judge --out",
        "run --out",
        "soil --d0-mm",
        "soil --figure",
        "rules --csv",
        "pack",
        "design x --filter",
    ] {
        for quote in ["", "\"", "'"] {
            for file in files {
                let word = last_word(
                    root.path(),
                    &mut terminal,
                    &format!("voidwalk {before} {quote}{}\t\n", &file[..1]),
                );
                assert_eq!(word, file, "{before} {quote}");
            }
            last_word(root.path(), &mut terminal, &format!("voidwalk {before} {quote}v\t\n"));
        }
    }
}

#[test]
fn zsh_runs_nothing_of_a_name() {
    check(
        "zsh",
        "zsh -f -i",
        "PS1='READY>' PS2='MORE>'; autoload -U compinit; compinit -u -D; source ./completions",
        0,
    );
}

#[test]
fn fish_runs_nothing_of_a_name() {
    check(
        "fish",
        "fish --no-config -i",
        "function fish_prompt; echo -n 'READY>'; end; source ./completions",
        SOILS,
    );
}
