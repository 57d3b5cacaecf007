#!/usr/bin/env python3
"""Runs a job of a workflow here: its `run:` steps from the YAML, in order, as a runner of GitHub does.

    scripts/checks/run_workflow.py .github/workflows/release.yml wheel
    scripts/checks/run_workflow.py .github/workflows/release.yml binary --matrix target=x86_64-unknown-linux-gnu

The job works in a clean clone of the last commit, with a HOME, a CARGO_HOME, a Python environment and a PATH of its own. Of this
machine it has the Rust that is in use and the crates that cargo has fetched. `rustup` only says what it was asked for: a runner is
thrown away, but this machine's toolchains are everybody's. `cargo +VERSION` takes a Rust that is there. Steps that `use` an action are named and skipped, for they need GitHub:
`--instead 'PyO3/maturin-action=maturin build ...'` runs a command in the place of one, or of a step by its name. Every step is timed.
A job that failed goes on with what was compiled, and with what was mended in its clone: `--keep FOLDER`, then `--within FOLDER`.
Ends with the exit code of the first step that fails.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

try:
    import yaml
except ModuleNotFoundError:
    own = ROOT / "target" / "workflow" / "bin" / "python"
    if Path(sys.executable) == own:
        raise
    if not own.exists():
        subprocess.run([sys.executable, "-m", "venv", own.parents[1]], check=True)
    subprocess.run([own, "-m", "pip", "install", "--quiet", "pyyaml"], check=True)
    os.execv(own, [own, *sys.argv])

#: What a clean environment keeps of this one: how packages are fetched, and how many processors may be used.
KEPT = re.compile(r"(PIP_|CARGO_BUILD_JOBS$|CARGO_NET_|SSL_CERT|.*_proxy$)", re.IGNORECASE)
#: Where this machine's cargo keeps the crates that it fetched.
CARGO_HOME = os.environ.get("CARGO_HOME", str(Path.home() / ".cargo"))
#: Stands in for rustup, which would change the toolchains of this machine.
RUSTUP = """#!/bin/sh
echo "not done here: rustup $*; $(rustc --version) is taken"
"""
#: Stands before cargo: `cargo +VERSION` is cargo of that Rust, where this machine has it.
CARGO = """#!/bin/sh
case "$1" in
+*)
    for folder in {toolchains}/"${{1#+}}"-* {toolchains}/"${{1#+}}".[0-9]*-*; do
        [ -x "$folder/bin/cargo" ] || continue
        shift
        PATH="$folder/bin:$PATH" exec "$folder/bin/cargo" "$@"
    done
    echo "this machine has no Rust ${{1#+}}" >&2
    exit 1
    ;;
esac
exec {rust}/bin/cargo "$@"
"""


def fail(problem):
    sys.exit(f"run_workflow.py: {problem}")


def filled(text, values):
    """A text with its `${{ }}` filled in: names such as `matrix.target`, and nothing else."""

    def value(match):
        name = match[1].strip()
        if name not in values:
            fail(f"cannot work out ${{{{ {name} }}}}; known: {', '.join(sorted(values))}")
        return str(values[name])

    return re.sub(r"\$\{\{(.*?)\}\}", value, str(text))


def combination(job, wanted):
    """The first combination of the matrix that has the wanted values and runs on Linux for x86-64."""
    matrix = job.get("strategy", {}).get("matrix", {})
    rows = [dict(row) for row in matrix.get("include", [])]
    for name, values in matrix.items():
        if name != "include":
            rows = [{**row, name: value} for row in rows or [{}] for value in values]
    for row in rows or [{}]:
        runner = filled(job["runs-on"], {f"matrix.{name}": value for name, value in row.items()})
        if all(str(row.get(name)) == value for name, value in wanted.items()):
            if runner.startswith("ubuntu") and not runner.endswith("-arm"):
                return row
    fail(f"no combination of the matrix has {wanted or 'what runs here'} and runs on Linux for x86-64")


def pairs(words):
    """`name=value` words as a dict."""
    for word in words:
        if "=" not in word:
            fail(f"{word}: name=value is expected")
    return dict(word.split("=", 1) for word in words)


def named_values(path):
    """What a step wrote into the file GITHUB_ENV or GITHUB_OUTPUT: lines `name=value`."""
    return dict(line.split("=", 1) for line in path.read_text().splitlines() if "=" in line)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("workflow", type=Path)
    parser.add_argument("job")
    parser.add_argument("--matrix", nargs="*", default=[], metavar="NAME=VALUE", help="picks a combination of the matrix")
    parser.add_argument("--instead", nargs="*", default=[], metavar="NAME=COMMAND", help="runs a command in the place of an action or a step")
    parser.add_argument("--ref", default="v0.0.0-trial", help="name of the tag or branch (v0.0.0-trial)")
    parser.add_argument("--target", type=Path, help="a folder for what cargo builds, with this machine's CARGO_HOME, to save time")
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--keep", type=Path, help="keeps the clone in this folder, which must not exist")
    where.add_argument("--within", type=Path, help="goes on in a clone that was kept, as it stands, with what was compiled there")
    args = parser.parse_args()
    workflow = yaml.safe_load(args.workflow.read_text(encoding="utf-8"))
    job = workflow["jobs"].get(args.job) or fail(f"no job {args.job}; there are: {', '.join(workflow['jobs'])}")
    if "steps" not in job:
        fail(f"{args.job} is the workflow {job['uses']}: run its jobs")
    instead = pairs(args.instead)
    matrix = combination(job, pairs(args.matrix))

    work = Path(tempfile.mkdtemp(prefix="workflow-"))
    clone = (args.within or args.keep or work / "clone").resolve()
    try:
        if not args.within:
            subprocess.run(["git", "clone", "--quiet", ROOT, clone], check=True)
        if args.target and not args.within:
            args.target.mkdir(parents=True, exist_ok=True)
            (clone / "target").symlink_to(args.target.resolve())
            dated(clone)
        return run(workflow, job, args, matrix, instead, work, clone)
    finally:
        shutil.rmtree(work)


def dated(clone):
    """Gives every file the time of its commit: cargo then takes what an earlier job compiled whose clone had the same place (`--keep`)."""
    git = ["git", "-C", clone]
    when = int(subprocess.run([*git, "log", "-1", "--format=%ct"], check=True, stdout=subprocess.PIPE).stdout)
    listed = subprocess.run([*git, "ls-files", "-z"], check=True, stdout=subprocess.PIPE, text=True).stdout
    # build.rs looks at the last.
    for name in [*listed.split("\0")[:-1], ".git/logs/HEAD"]:
        os.utime(clone / name, (when, when), follow_symlinks=False)


class Runner:
    """A clean environment in which the steps of a job run: one after the other, each with what those before it left."""

    def __init__(self, workflow, job, matrix, work, clone, ref="v0.0.0-trial"):
        self.clone = clone
        home, python = work / "home", work / "python"
        home.mkdir()
        subprocess.run([sys.executable, "-m", "venv", python], check=True)
        # The compiler itself, not rustup's proxies, which may install another.
        rust = subprocess.run(["rustc", "--print", "sysroot"], check=True, stdout=subprocess.PIPE, text=True).stdout.strip()
        self.rust = Path(rust)
        cargo, stand_ins = work / "cargo", work / "bin"
        cargo.mkdir()
        stand_ins.mkdir()
        for name, text in {"rustup": RUSTUP, "cargo": CARGO.format(rust=rust, toolchains=Path(rust).parent)}.items():
            (stand_ins / name).write_text(text)
            (stand_ins / name).chmod(0o755)
        fetched = Path(CARGO_HOME) / "registry"
        if fetched.is_dir():
            (cargo / "registry").symlink_to(fetched)
        self.files = {name: work / name for name in ["GITHUB_ENV", "GITHUB_OUTPUT", "GITHUB_PATH", "GITHUB_STEP_SUMMARY"]}
        self.environment = {name: value for name, value in os.environ.items() if KEPT.match(name)} | {
            "HOME": str(home),
            "CARGO_HOME": str(cargo),
            "PATH": f"{stand_ins}:{python}/bin:{rust}/bin:/usr/local/bin:/usr/bin:/bin",
            "LANG": "C.UTF-8",
            "CI": "true",
            "GITHUB_ACTIONS": "true",
            "GITHUB_REF_NAME": ref,
            "GITHUB_WORKSPACE": str(clone),
            "RUNNER_OS": "Linux",
            "RUNNER_ARCH": "X64",
            "RUNNER_TEMP": str(work),
            **{name: str(path) for name, path in self.files.items()},
        }
        self.values = {f"matrix.{name}": value for name, value in matrix.items()}
        self.values |= {"github.ref_name": ref, "runner.os": "Linux", "runner.arch": "X64", "github.workspace": str(clone)}
        # Nothing here may write to the forge.
        self.values |= {"github.token": "", "github.repository": "owner/voidwalk"}
        for level in (workflow, job):
            self.environment |= {name: filled(value, self.values) for name, value in level.get("env", {}).items()}
        shells = [level.get("defaults", {}).get("run", {}).get("shell") for level in (workflow, job)]
        self.shell = shells[1] or shells[0]

    def share_crates(self):
        """Takes the crates where this machine's cargo keeps them: at another place they are other crates to it."""
        # Its folder of commands comes first to cargo, where rustup stands for clippy and asks which Rust.
        rustup = {"RUSTUP_HOME": str(self.rust.parents[1]), "RUSTUP_TOOLCHAIN": self.rust.name}
        self.environment |= {"CARGO_HOME": CARGO_HOME} | rustup

    def script(self, step):
        """What a step runs, filled in."""
        return filled(step["run"], self.values)

    def run(self, step, script, shell=None, log=None):
        """Runs a step: its exit code. What it says goes to a file, where one is given."""
        if "if" in step:
            print(f"-- its condition is not looked at: {step['if']}", flush=True)
        for path in self.files.values():
            path.write_text("")
        own = {name: filled(value, self.values) for name, value in step.get("env", {}).items()}
        # As GitHub does: without a shell named, a pipe fails as its last command does.
        flags = ["-eo", "pipefail"] if (shell or step.get("shell") or self.shell) == "bash" else ["-e"]
        where = self.clone / step.get("working-directory", ".")
        command = ["bash", "--noprofile", "--norc", *flags, "-c", script]
        streams = {} if log is None else {"stdout": log, "stderr": subprocess.STDOUT}
        code = subprocess.run(command, cwd=where, env=self.environment | own, **streams).returncode
        if code == 0:
            self.environment |= named_values(self.files["GITHUB_ENV"])
            for folder in self.files["GITHUB_PATH"].read_text().splitlines():
                self.environment["PATH"] = f"{folder}:{self.environment['PATH']}"
            if "id" in step:
                outputs = named_values(self.files["GITHUB_OUTPUT"])
                self.values |= {f"steps.{step['id']}.outputs.{name}": value for name, value in outputs.items()}
        return code


def run(workflow, job, args, matrix, instead, work, clone):
    """Runs the steps of a job: the exit code of the first that fails."""
    runner = Runner(workflow, job, matrix, work, clone, args.ref)
    if (clone / "target").is_symlink():
        runner.share_crates()
    print(f"{args.workflow.name}, {args.job}, {matrix or 'no matrix'}: in {clone}", flush=True)
    begun = time.monotonic()
    for step in job["steps"]:
        shell = None
        if "uses" in step:
            action = step["uses"].split("@")[0]
            if action not in instead:
                print(f"-- skipped: {step['uses']}", flush=True)
                continue
            name, script, shell = f"{action}, here: {instead[action]}", instead[action], "bash"
        else:
            script = runner.script(step)
            name = step.get("name", script.splitlines()[0])
            if name in instead:
                name, script = f"{name}, here: {instead[name]}", instead[name]
        print(f"== {name}", flush=True)
        at = time.monotonic()
        code = runner.run(step, script, shell)
        print(f"   {time.monotonic() - at:.1f} s, exit code {code}", flush=True)
        if code:
            return code
    print(f"{args.job}: every step that runs here has passed, {time.monotonic() - begun:.0f} s", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
