//! A real disk that is full, or read-only: a small one in memory, filled so that so many bytes are left. It is mounted for the test, which
//! needs root; where that is not to be had the test says so and passes.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const SCENE: &str = "seed = 3\nreplicates = 2\nengine = \"particles\"\n[filter]\ncurve = \"shire2016-cu1.5-loose\"\n[base]\ncu = 1.5\n\
    d85_at_dc = 5\nn_base = 60000\n[network]\nnx = 8\nny = 8\nnz = 10\n[record]\nsensitivity = []\n";
const FILES: [&str; 6] =
    ["scene.toml", "series.csv", "layers.csv", "retained.csv", "eroded.csv", "figures/eroded.svg"];

/// A disk of 16 MB that is gone with this value.
pub struct Disk {
    path: PathBuf,
    _folder: Option<tempfile::TempDir>,
}

impl Disk {
    fn new() -> Result<Self, String> {
        let folder = tempfile::tempdir().unwrap();
        let mut disk = Self::on(folder.path())?;
        disk._folder = Some(folder);
        Ok(disk)
    }

    /// On a folder that is there.
    pub fn on(folder: &Path) -> Result<Self, String> {
        let mounted = Command::new("mount")
            .args(["-t", "tmpfs", "-o", "size=16m", "voidwalk-test"])
            .arg(folder)
            .output()
            .map_err(|e| e.to_string())?;
        match mounted.status.success() {
            true => Ok(Self { path: folder.to_owned(), _folder: None }),
            false => Err(String::from_utf8_lossy(&mounted.stderr).into_owned()),
        }
    }

    fn path(&self) -> &Path {
        &self.path
    }

    /// Fills the disk until so many bytes are left.
    pub fn leave(&self, bytes: u64) {
        let free = || {
            let disk = rustix::fs::statvfs(self.path()).unwrap();
            disk.f_bavail * disk.f_frsize
        };
        let mut filler = fs::File::create(self.path().join("filler")).unwrap();
        while free() > bytes {
            filler.write_all(&vec![1; (free() - bytes).min(1 << 20) as usize]).unwrap();
        }
    }

    pub fn free(&self) {
        fs::remove_file(self.path().join("filler")).unwrap();
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(&self.path).status();
    }
}

fn voidwalk(at: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_voidwalk")).current_dir(at).args(args).output().unwrap()
}

fn lasting(folder: &Path) -> Vec<String> {
    FILES.map(|name| fs::read_to_string(folder.join(name)).unwrap()).to_vec()
}

#[test]
fn a_folder_on_a_disk_that_is_read_only_is_refused() {
    let disk = match Disk::new() {
        Ok(disk) => disk,
        Err(problem) => return println!("skipped: a disk cannot be mounted here: {}", problem.trim()),
    };
    let at = disk.path();
    fs::write(at.join("scene.toml"), SCENE).unwrap();
    assert!(voidwalk(at, &["run", "scene.toml", "-q", "--out", "old"]).status.success());
    let remount = Command::new("mount").args(["-o", "remount,ro"]).arg(at).status().unwrap();
    assert!(remount.success());
    for args in [
        &["run", "scene.toml", "-q", "--out", "new"][..],
        &["run", "scene.toml", "-q", "--out", "old", "--overwrite"],
        &["report", "old"],
    ] {
        let output = voidwalk(at, args);
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {text}");
        assert!(text.starts_with("refused: "), "{args:?}: {text}");
    }
}

#[test]
fn a_run_on_a_full_disk_ends_with_an_error_and_goes_on_when_there_is_room() {
    let disk = match Disk::new() {
        Ok(disk) => disk,
        Err(problem) => return println!("skipped: a disk cannot be mounted here: {}", problem.trim()),
    };
    let at = disk.path();
    fs::write(at.join("scene.toml"), SCENE).unwrap();
    // Particles in mapped files, and in memory.
    for memory in ["700kB", "1GB"] {
        let mut run = vec!["run", "scene.toml", "-q", "--threads", "1", "--memory", memory];
        run.extend(["--checkpoint-every", "15increments", "--out"]);
        let whole = format!("whole-{memory}");
        let output = voidwalk(at, &[&run[..], &[whole.as_str()]].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let expected = lasting(&at.join(whole));
        // Warnings may stand before it.
        let begins = |text: &str, with: &str| text.lines().any(|line| line.starts_with(with));
        let [mut failed, mut refused, mut kept, mut done] = [0; 4];
        let steps = (0..10).map(|n| 9000 * n).chain((1..13).map(|n| 180_000 * n));
        for (number, left) in steps.enumerate() {
            let out = format!("r{memory}-{number}");
            disk.leave(left);
            let output = voidwalk(at, &[&run[..], &[out.as_str()]].concat());
            let text = String::from_utf8_lossy(&output.stderr).into_owned();
            match output.status.code() {
                Some(0) => done += 1,
                Some(1) => {
                    failed += 1;
                    assert!(begins(&text, "error: ") && text.contains("No space left"), "{left}: {text}");
                }
                Some(2) => {
                    refused += 1;
                    assert!(begins(&text, "refused: ") && text.contains("the disk has"), "{left}: {text}");
                    assert!(!at.join(&out).exists(), "{left}: it was refused and left something");
                }
                code => panic!("{left} bytes left: {code:?}, {text}"),
            }
            disk.free();
            let folder = at.join(&out);
            let checkpoints = fs::read_dir(folder.join("checkpoint")).map_or(0, Iterator::count);
            kept += usize::from(checkpoints > 0);
            if output.status.code() != Some(0) {
                let go_on = match folder.join("scene.toml").exists() {
                    true => vec!["resume", &out, "-q", "--memory", memory],
                    false => [&run[..], &[out.as_str()]].concat(),
                };
                let output = voidwalk(at, &go_on);
                let text = String::from_utf8_lossy(&output.stderr).into_owned();
                let finished = output.status.code() == Some(2) && text.contains("finished");
                assert!(output.status.success() || finished, "{left}: {text}");
                assert!(!text.contains("checksum") && !text.contains("ends early"), "{left}: {text}");
                if finished {
                    assert!(voidwalk(at, &["report", &out]).status.success());
                }
            }
            assert_eq!(lasting(&folder), expected, "{left} bytes left");
            fs::remove_dir_all(folder).unwrap();
        }
        println!(
            "{memory}: {failed} failed ({kept} with a checkpoint), {refused} refused, {done} had room; 0 other results"
        );
        assert!(failed > 5 && kept > 0 && done > 0, "{failed} failed, {kept} kept, {done} had room");
    }
}
