//! `voidwalk campaign --slurm` and `--collect` without Slurm: the scripts are run by hand, with Slurm's commands played by
//! small scripts that note how they were called. `scripts/checks/test_slurm.sh` does the same on a real one.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, SystemTime};

use serde_json::Value;

/// Twelve cases, whose names a shell would act on.
const PLAN: &str = "title = \"twelve\"\nseed = 5\n[set]\nreplicates = 2\n\
    network = { nx = 8, ny = 8, nz = 10 }\nrecord = { sensitivity = [], series_every = 0, size_curves = [] }\n\
    [[factor]]\nname = \"cu_b\"\nsetting = \"base.cu\"\nvalues = [1.5, 2, 3]\n\
    [[factor]]\nname = \"d85\"\nsetting = \"base.d85_at_dc\"\nvalues = [5, 25]\n\
    [[factor]]\nname = \"f; touch $(echo hacked)\"\n[factor.levels]\n\"-x *\" = { \"filter.curve\" = \"shire2016-cu1.5-loose\" }\n\
    \"`touch hacked` & >hacked\" = { \"filter.curve\" = \"shire2016-cu1.5-dense\" }\n";

/// Two replicates that take seconds each: a task can be stopped in them three times on a fast machine, too.
const LONG: &str = "[[case]]\nname = \"long\"\n[case.set]\nreplicates = 2\nnetwork = { nx = 24, ny = 24, nz = 200 }\n\
    record = { sensitivity = [], series_every = 0, size_curves = [] }\n";

struct Place {
    _root: tempfile::TempDir,
    at: PathBuf,
}

impl Place {
    /// A folder whose name a shell would act on, with a plan and Slurm's commands.
    fn new(plan: &str) -> Self {
        let root = tempfile::tempdir().unwrap();
        let at = root.path().join("it's $(touch hacked) `x`");
        fs::create_dir_all(at.join("bin")).unwrap();
        fs::write(at.join("plan.toml"), plan).unwrap();
        let place = Self { _root: root, at };
        place.command("sbatch", "echo \"sbatch $*\" >>\"$NOTES\"; wc -l <\"$NOTES\"");
        place.state("RUNNING");
        place
    }

    fn command(&self, name: &str, text: &str) {
        let path = self.at.join("bin").join(name);
        fs::write(&path, format!("#!/bin/sh\n{text}\n")).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    }

    /// What `scontrol show job` says.
    fn state(&self, state: &str) {
        let text = format!(
            "echo \"scontrol $*\" >>\"$NOTES\"; case $1 in -o) echo \"JobId=8 JobState={state} Reason=None\";; esac"
        );
        self.command("scontrol", &text);
    }

    fn notes(&self) -> String {
        fs::read_to_string(self.at.join("notes")).unwrap_or_default()
    }

    fn prepared(&self, program: &str, args: &[&str]) -> Command {
        let mut command = Command::new(program);
        let path = format!("{}:{}", self.at.join("bin").display(), std::env::var("PATH").unwrap());
        command.current_dir(&self.at).args(args).env("PATH", path).env("NOTES", self.at.join("notes"));
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    fn voidwalk(&self, args: &[&str]) -> Output {
        self.prepared(env!("CARGO_BIN_EXE_voidwalk"), args).output().unwrap()
    }

    fn write_scripts(&self, args: &[&str]) -> String {
        let all = [&["campaign", "plan.toml", "--out", "out", "--slurm", "--threads", "1"], args].concat();
        done(self.voidwalk(&all))
    }

    /// A script as Slurm would start it.
    fn script(&self, name: &str, task: &str, restarts: &str) -> Command {
        let path = self.at.join("out/slurm").join(name);
        let mut command = self.prepared("sh", &[path.to_str().unwrap()]);
        command.envs([("SLURM_JOB_ID", "8"), ("SLURM_CPUS_PER_TASK", "1"), ("SLURM_MEM_PER_NODE", "500")]);
        if !task.is_empty() {
            command.envs([("SLURM_ARRAY_JOB_ID", "7"), ("SLURM_ARRAY_TASK_ID", task)]);
        }
        if restarts != "0" {
            command.env("SLURM_RESTART_COUNT", restarts);
        }
        command
    }

    fn lines(&self, folder: &str) -> Vec<Value> {
        let text = fs::read_to_string(self.at.join(folder).join("ledger.jsonl")).unwrap();
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    }

    fn assert_same(&self, one: &str, other: &str) {
        let without = |folder: &str| -> Vec<String> {
            let mut lines = self.lines(folder);
            lines.iter_mut().for_each(|line| drop(line.as_object_mut().unwrap().remove("made")));
            lines.iter().map(Value::to_string).collect()
        };
        assert_eq!(without(one), without(other));
        for file in ["cases.csv", "campaign.json"] {
            let read = |folder: &str| fs::read_to_string(self.at.join(folder).join(file)).unwrap();
            assert_eq!(read(one), read(other), "{file}");
        }
    }
}

fn text(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

fn done(output: Output) -> String {
    assert!(output.status.success(), "{}", text(&output));
    text(&output)
}

/// Waits until a file is there.
fn await_file(folder: &Path, is: impl Fn(&Path) -> bool) {
    for _ in 0..6000 {
        let mut open = vec![folder.to_owned()];
        while let Some(path) = open.pop() {
            if is(&path) {
                return;
            }
            open.extend(fs::read_dir(&path).into_iter().flatten().flatten().map(|entry| entry.path()));
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    panic!("{}: nothing came", folder.display());
}

fn signal(child: &Child, signal: &str) {
    done(Command::new("kill").args([signal, &child.id().to_string()]).output().unwrap());
}

#[test]
fn the_scripts_of_a_plan_give_the_ledger_of_the_local_run() {
    let place = Place::new(PLAN);
    done(place.voidwalk(&["campaign", "plan.toml", "--out", "local", "--quiet"]));
    let said = place.write_scripts(&["--tasks", "5"]);
    assert!(said.contains("12 cases in 5 tasks") && said.contains("submit.sh"), "{said}");
    let folder = place.at.join("out/slurm");
    for entry in fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "sh") {
            done(place.prepared("sh", &["-n", path.to_str().unwrap()]).output().unwrap());
        }
    }
    let array = fs::read_to_string(folder.join("array.sh")).unwrap();
    for wanted in
        ["--array=1-5\n", "--cpus-per-task=1\n", "--mem=", "--time=", "--signal=B:TERM@", "--requeue"]
    {
        assert!(array.contains(wanted), "{array}");
    }
    done(
        place
            .prepared("sh", &[folder.join("submit.sh").to_str().unwrap(), "--partition=short"])
            .output()
            .unwrap(),
    );
    let notes = place.notes();
    let wanted = "sbatch --parsable --partition=short slurm/array.sh\n\
        sbatch --parsable --dependency=afterany:1 --partition=short slurm/collect.sh\n";
    assert_eq!(notes, wanted);
    for task in ["5", "4", "3", "2"] {
        done(place.script("array.sh", task, "0").output().unwrap());
    }
    // A ledger with holes is refused, and nothing is written.
    let early = place.script("collect.sh", "", "0").output().unwrap();
    assert_eq!(early.status.code(), Some(2), "{}", text(&early));
    assert!(text(&early).contains("of 12 cases are missing") && text(&early).contains("not begun"));
    assert!(!place.at.join("out/ledger.jsonl").exists() && !place.at.join("out/cases.csv").exists());
    // What is done is in no task of scripts that are written again; those that wait in a queue keep their list.
    let lists = fs::read_dir(&folder).unwrap().flatten().map(|entry| entry.path());
    let list = lists.into_iter().find(|path| path.extension().is_some_and(|e| e == "tsv")).unwrap();
    let left = fs::read_to_string(&list).unwrap().lines().filter(|line| line.starts_with("1\t")).count();
    assert!((1..12).contains(&left));
    let again = place.write_scripts(&["--tasks", "1"]);
    assert!(
        again.contains(&format!("{} cases are done already\n{left} cases in 1 tasks", 12 - left)),
        "{again}"
    );
    fs::write(folder.join("array.sh"), array).unwrap();
    let last = done(place.script("array.sh", "1", "0").output().unwrap());
    assert_eq!(last.matches("begins: ").count(), left, "{last}");
    done(place.script("collect.sh", "", "0").output().unwrap());
    place.assert_same("local", "out");
    for line in place.lines("out") {
        assert!(line["made"]["job"].as_str().unwrap().starts_with("7_"), "{line}");
        assert_eq!(line["made"]["threads"], 1, "{line}");
    }
    assert!(place.at.join("out/report.html").is_file());
    assert!(place.write_scripts(&[]).contains("All 12 cases are done"));
    for folder in [&place.at, &place.at.join("out")] {
        let stray = fs::read_dir(folder).unwrap().flatten().find(|e| e.file_name() == "hacked");
        assert!(stray.is_none(), "a name was taken for a command");
    }
}

#[test]
fn a_task_that_is_stopped_goes_back_into_the_queue_and_goes_on() {
    let place = Place::new(LONG);
    done(place.voidwalk(&["campaign", "plan.toml", "--out", "local", "--quiet"]));
    place.write_scripts(&["--checkpoint-every", "50ms"]);
    let in_checkpoints = |path: &Path| path.parent().is_some_and(|p| p.ends_with("checkpoint"));
    // Saved after this moment: by a task that has begun and listens.
    let saved_since = |moment: SystemTime| {
        move |path: &Path| {
            in_checkpoints(path) && path.metadata().is_ok_and(|m| m.modified().unwrap() > moment)
        }
    };
    // Asked to stop, as before a time limit. The processes may be asked twice.
    let child = place.script("array.sh", "1", "0").spawn().unwrap();
    await_file(&place.at.join("out"), in_checkpoints);
    signal(&child, "-TERM");
    signal(&child, "-TERM");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(3), "{}", text(&output));
    // The array's number alone would put all of its tasks back.
    assert_eq!(place.notes(), "scontrol -o show job 7_1\nscontrol requeue 7_1\n", "{}", text(&output));
    // Cancelled: it is left where it is, and what was kept is taken up.
    place.state("CANCELLED");
    let begun = SystemTime::now();
    let child = place.script("array.sh", "1", "1").spawn().unwrap();
    await_file(&place.at.join("out"), saved_since(begun));
    signal(&child, "-TERM");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(3), "{}", text(&output));
    assert!(text(&output).contains("continues: long"), "{}", text(&output));
    assert_eq!(place.notes().matches("requeue").count(), 1, "{}", text(&output));
    let missing = place.voidwalk(&["campaign", "plan.toml", "--out", "out", "--collect"]);
    assert_eq!(missing.status.code(), Some(2));
    assert!(
        text(&missing).contains("case long: stopped or killed; its checkpoints are kept"),
        "{}",
        text(&missing)
    );
    // Stopped too often.
    place.state("RUNNING");
    let begun = SystemTime::now();
    let child = place.script("array.sh", "1", "100").spawn().unwrap();
    await_file(&place.at.join("out"), saved_since(begun));
    signal(&child, "-TERM");
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(3));
    assert_eq!(place.notes().matches("requeue").count(), 1);
    let last = done(place.script("array.sh", "1", "2").output().unwrap());
    assert!(last.contains("attempt 3") && last.contains("continues: long"), "{last}");
    done(place.script("collect.sh", "", "0").output().unwrap());
    place.assert_same("local", "out");
}

#[test]
fn a_task_whose_program_is_killed_is_begun_again_a_few_times() {
    let place = Place::new(LONG);
    place.write_scripts(&[]);
    // A program that dies as one does that is out of memory.
    let array = fs::read_to_string(place.at.join("out/slurm/array.sh")).unwrap();
    place.command("dies", "kill -KILL $$");
    // The program names itself by its place, where the folder of what is compiled may be a link.
    let program = fs::canonicalize(env!("CARGO_BIN_EXE_voidwalk")).unwrap();
    let dying = array.replace(&format!("'{}'", program.display()), "dies");
    assert_ne!(array, dying);
    fs::write(place.at.join("out/slurm/array.sh"), dying).unwrap();
    for (restarts, requeues) in [("0", 1), ("4", 2), ("5", 2)] {
        let output = place.script("array.sh", "1", restarts).output().unwrap();
        assert_eq!(output.status.code(), Some(137), "{}", text(&output));
        assert_eq!(place.notes().matches("requeue 7_1").count(), requeues, "{}", text(&output));
    }
}

#[test]
fn a_list_of_tasks_that_is_not_of_the_plan_is_refused() {
    let place = Place::new(LONG);
    for (list, message) in [
        ("1\tshort\n", "has no case `short`"),
        ("2\tlong\n", "there is no task 1; it has 2"),
        ("long\n", "line 1: must be a task's number"),
    ] {
        fs::write(place.at.join("tasks.tsv"), list).unwrap();
        let output = place.voidwalk(&["campaign", "plan.toml", "--out", "out", "--task", "tasks.tsv:1"]);
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output).contains(message), "{}", text(&output));
    }
    let nothing = place.voidwalk(&["campaign", "plan.toml", "--out", "out", "--collect"]);
    assert_eq!(nothing.status.code(), Some(2));
    assert!(!place.at.join("out").exists());
}
