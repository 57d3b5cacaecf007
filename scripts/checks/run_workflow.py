#!/usr/bin/env python3
"""Runs a job of a workflow here: its `run:` steps from the YAML, in order, as a runner of GitHub does.

    scripts/checks/run_workflow.py .github/workflows/release.yml wheel
    scripts/checks/run_workflow.py .github/workflows/release.yml binary --matrix target=x86_64-unknown-linux-gnu

The job works in a clean clone of the last commit, with a HOME, a CARGO_HOME, a Python environment and a PATH of its own. From this
machine it takes the Rust that is in use and the crates that cargo has fetched. `rustup` only prints what it was asked for.
`cargo +VERSION` takes a Rust that is here. Steps that `use` an action are named and skipped, since they need GitHub:
`--instead 'PyO3/maturin-action=maturin build ...'` runs a command in the place of one, or of a step by its name. Every step is timed.
Ends with the exit code of the first step that fails. Needs PyYAML, which it installs into target/workflow.
"""

import argparse
import os
import re
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


def filled(text, values):
    """A text with its `${{ }}` filled in: names such as `matrix.target`, and nothing else."""

    def value(match):
        if match[1].strip() not in values:
            sys.exit(f"cannot work out ${{{{ {match[1].strip()} }}}}; known: {', '.join(sorted(values))}")
        return str(values[match[1].strip()])

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
    sys.exit(f"no combination of the matrix has {wanted or 'what runs here'} and runs on Linux for x86-64")


def pairs(lines):
    """`name=value` lines as a dict."""
    return dict(line.split("=", 1) for line in lines if "=" in line)


def environment_of(work, clone, ref):
    """A clean environment, and the files that steps write into."""
    home, python, cargo, stand_ins = (work / name for name in ("home", "python", "cargo", "bin"))
    for folder in (home, cargo, stand_ins):
        folder.mkdir()
    subprocess.run([sys.executable, "-m", "venv", python], check=True)
    # The compiler itself, not rustup's proxies, which may install another.
    rust = Path(subprocess.run(["rustc", "--print", "sysroot"], check=True, stdout=subprocess.PIPE, text=True).stdout.strip())
    for name, text in {"rustup": RUSTUP, "cargo": CARGO.format(rust=rust, toolchains=rust.parent)}.items():
        (stand_ins / name).write_text(text)
        (stand_ins / name).chmod(0o755)
    fetched = Path(os.environ.get("CARGO_HOME", Path.home() / ".cargo")) / "registry"
    if fetched.is_dir():
        (cargo / "registry").symlink_to(fetched)
    files = {name: work / name for name in ["GITHUB_ENV", "GITHUB_OUTPUT", "GITHUB_PATH", "GITHUB_STEP_SUMMARY"]}
    return files, {name: value for name, value in os.environ.items() if KEPT.match(name)} | {
        "HOME": str(home), "CARGO_HOME": str(cargo), "LANG": "C.UTF-8", "CI": "true", "GITHUB_ACTIONS": "true",
        "PATH": f"{stand_ins}:{python}/bin:{rust}/bin:/usr/local/bin:/usr/bin:/bin",
        "GITHUB_REF_NAME": ref, "GITHUB_WORKSPACE": str(clone), "RUNNER_OS": "Linux", "RUNNER_ARCH": "X64", "RUNNER_TEMP": str(work),
        **{name: str(path) for name, path in files.items()},
    }


def run(workflow, job, matrix, instead, ref, work, clone):
    """Runs the steps of a job: the exit code of the first that fails."""
    files, environment = environment_of(work, clone, ref)
    # Nothing here may write to the forge.
    values = {f"matrix.{name}": value for name, value in matrix.items()} | {
        "github.ref_name": ref, "runner.os": "Linux", "runner.arch": "X64", "github.workspace": str(clone), "github.token": "",
        "github.repository": "owner/voidwalk"}
    for level in (workflow, job):
        environment |= {name: filled(value, values) for name, value in level.get("env", {}).items()}
    shells = [level.get("defaults", {}).get("run", {}).get("shell") for level in (job, workflow)]
    for step in job["steps"]:
        action = step["uses"].split("@")[0] if "uses" in step else None
        if action and action not in instead:
            print(f"-- skipped: {step['uses']}", flush=True)
            continue
        script = instead[action] if action else filled(step["run"], values)
        name = action or step.get("name", script.splitlines()[0])
        script = instead.get(name, script)
        print(f"== {name}{', here: ' + script if name in instead else ''}", flush=True)
        if "if" in step:
            print(f"-- its condition is not looked at: {step['if']}", flush=True)
        for path in files.values():
            path.write_text("")
        own = {name: filled(value, values) for name, value in step.get("env", {}).items()}
        # As GitHub does: without a shell named, a pipe fails as its last command does.
        named = "bash" if action else step.get("shell") or shells[0] or shells[1]
        command = ["bash", "--noprofile", "--norc", *(["-eo", "pipefail"] if named == "bash" else ["-e"]), "-c", script]
        began = time.monotonic()
        code = subprocess.run(command, cwd=clone / step.get("working-directory", "."), env=environment | own).returncode
        print(f"   {time.monotonic() - began:.1f} s, exit code {code}", flush=True)
        if code:
            return code
        environment |= pairs(files["GITHUB_ENV"].read_text().splitlines())
        for folder in files["GITHUB_PATH"].read_text().splitlines():
            environment["PATH"] = f"{folder}:{environment['PATH']}"
        outputs = pairs(files["GITHUB_OUTPUT"].read_text().splitlines())
        values |= {f"steps.{step.get('id')}.outputs.{name}": value for name, value in outputs.items()}
    print("every step that runs here has passed", flush=True)
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("workflow", type=Path)
    parser.add_argument("job")
    parser.add_argument("--matrix", nargs="*", default=[], metavar="NAME=VALUE", help="picks a combination of the matrix")
    parser.add_argument("--instead", nargs="*", default=[], metavar="NAME=COMMAND", help="runs a command in the place of an action or a step")
    parser.add_argument("--ref", default="v0.0.0-trial", help="name of the tag or branch (v0.0.0-trial)")
    args = parser.parse_args()
    workflow = yaml.safe_load(args.workflow.read_text(encoding="utf-8"))
    job = workflow["jobs"].get(args.job)
    if job is None or "steps" not in job:
        sys.exit(f"no job {args.job} with steps; there are: {', '.join(workflow['jobs'])}")
    matrix = combination(job, pairs(args.matrix))
    with tempfile.TemporaryDirectory(prefix="workflow-") as work:
        clone = Path(work) / "clone"
        subprocess.run(["git", "clone", "--quiet", ROOT, clone], check=True)
        print(f"{args.workflow.name}, {args.job}, {matrix or 'no matrix'}", flush=True)
        return run(workflow, job, matrix, pairs(args.instead), args.ref, Path(work), clone)


if __name__ == "__main__":
    sys.exit(main())
