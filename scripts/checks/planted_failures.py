#!/usr/bin/env python3
"""Plants one mistake after another in a clone of the last commit and sees that the jobs of check.yml fail for them.

    scripts/checks/planted_failures.py                       every mistake
    scripts/checks/planted_failures.py form lints            those of some jobs
    scripts/checks/planted_failures.py wheel --wheel W.whl   with a wheel at hand; without one its example is left out
    scripts/checks/planted_failures.py python --program P    with a program at hand; without one the book is left out

A step of a job runs as `run_workflow.py` runs it, from the YAML itself. It must pass without the mistake, then fail with it and
say why. Where the whole step takes an hour, the part that must see the mistake runs alone, and the table says which.
`rustup` does nothing here: every job has the Rust of this machine, and `oldest-rust` its own, which must be there. Crates are those of
this machine's cargo, where it keeps them, so that they are compiled once for all jobs. Prints a row of Markdown for each mistake;
exit code 1 where one went unseen. What is compiled stays in target/planted-failures.
"""

import argparse
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from run_workflow import ROOT, Runner, combination, yaml

#: In two parts, as the spelling of this file is looked at, too.
MISSPELT = "rec" + "ieves"
TUTORIALS = "scripts/book/tutorials"
WORKFLOW = ROOT / ".github" / "workflows" / "check.yml"
BUILT = ROOT / "target" / "planted-failures"
#: The part of the Python package's tests that must see a mistake; compiled quickly, as little is walked.
PYTHON = (("scripts/checks/test_python.sh", "PROFILE=dev scripts/checks/test_python.sh -k test_package"),)


@dataclass
class Plant:
    """A mistake, and the step of a job that must see it."""

    job: str
    step: str
    #: What is planted, in words.
    what: str
    #: File, text before, text after; where the text before is empty, the text after is added at the end.
    edits: list
    #: What the step must say.
    says: str
    #: Parts of the step's script that run in the place of others: (in the YAML, here).
    instead: tuple = ()
    #: A name of the commit that was there before the mistake.
    tag: str = ""
    #: What of an earlier step must be at hand: the name of an option.
    needs: str = ""


def added(text):
    """An edit of a file of the library: at its end."""
    return [("src/text.rs", "", text)]


PLANTS = [
    Plant("form", "Form", "a line that rustfmt writes otherwise", added("\nfn  planted( ) {}\n"), "Diff in"),
    Plant("form", "Spelling", "a misspelt word", [("README.md", "", f"\nIt {MISSPELT} a filter.\n")], MISSPELT),
    Plant(
        "form",
        "Licences, sources and known faults of the crates",
        "a forbidden licence",
        [("scripts/python/Cargo.toml", 'license = "MIT OR Apache-2.0"', 'license = "GPL-3.0-only"')],
        "GPL-3.0-only",
        (("check_dependencies.sh", "check_dependencies.sh licenses bans sources"),),
    ),
    Plant(
        "form",
        "Licences, sources and known faults of the crates",
        "a crate of any version",
        [("scripts/python/Cargo.toml", 'numpy = "0.30"', 'numpy = "*"')],
        "wildcard",
        (("check_dependencies.sh", "check_dependencies.sh licenses bans sources"),),
    ),
    Plant(
        "form",
        "Their licence texts",
        "a crate's licence is missing from the texts",
        [("scripts/install/third-party.txt", "base64", "base46")],
        "third-party",
    ),
    Plant(
        "form",
        "Workflows, issue forms, citation",
        "an action that is named by a tag, not by its hash",
        [(".github/workflows/check.yml", "actions/setup-python@ece7cb06caefa5fff74198d8649806c4678c61a1", "actions/setup-python@v6")],
        "unpinned",
    ),
    Plant("form", "Workflows, issue forms, citation", "a citation without authors", [("CITATION.cff", "authors:", "writers:")], "writers"),
    Plant(
        "lints",
        "Lints",
        "a comparison with itself",
        added("\n/// Planted.\npub fn planted(a: u8) -> bool {\n    a == a\n}\n"),
        "equal expressions",
        (("--workspace --all-targets", "-p voidwalk --lib"),),
    ),
    Plant(
        "lints",
        "Lints",
        "a public function without a word about it",
        added("\npub fn planted() {}\n"),
        "missing documentation",
        (("--workspace --all-targets", "-p voidwalk --lib"),),
    ),
    Plant(
        "lints",
        "Documentation",
        "a dead link in the documentation",
        added("\n/// As [`no_such_thing`].\npub fn planted() {}\n"),
        "no_such_thing",
        (("--workspace", "-p voidwalk"),),
    ),
    Plant(
        "tests",
        "Tests",
        "a test that fails",
        added("\n#[cfg(test)]\nmod planted {\n    #[test]\n    fn two_and_two_are_five() {\n        assert_eq!(2 + 2, 5);\n    }\n}\n"),
        "two_and_two_are_five",
        (("--release --workspace --exclude voidwalk-python", "-p voidwalk --lib text::"),),
    ),
    Plant(
        "oldest-rust",
        "Build",
        "a function that is newer than the oldest Rust",
        added("\n/// Planted.\npub fn planted() -> bool {\n    std::path::Path::new(\"a.b\").file_prefix().is_some()\n}\n"),
        "file_prefix",
        (("check --locked --workspace", "check --locked -p voidwalk"),),
    ),
    Plant(
        "oldest-rust",
        "Build",
        "a crate that asks for a newer Rust than there is",
        [("Cargo.toml", 'rust-version = "1.89"', 'rust-version = "1.999"')],
        "rustc 1.999",
        (('cargo "+$rust" check --locked --workspace', "cargo check --locked -p voidwalk"),),
    ),
    Plant(
        "interface",
        "The public interface since the last release",
        "a public function is gone, and the version stays",
        [("src/stream.rs", "pub fn unit(", "pub(crate) fn unit(")],
        "function_missing",
        tag="v0.0.0-planted",
    ),
    Plant(
        "python",
        "The package, its tests and its examples",
        "an example in a docstring that says what is not so",
        [("scripts/python/python/voidwalk/_soil.py", "vw.Gradation.single(0.2).d(50)\n        0.2", "vw.Gradation.single(0.2).d(50)\n        0.3")],
        "_soil.py",
        PYTHON,
    ),
    Plant(
        "python",
        "The package, its tests and its examples",
        "a function that returns another type than it says",
        [("scripts/python/python/voidwalk/_scene.py", "    return _voidwalk.init_text()", "    return len(_voidwalk.init_text())")],
        "Incompatible return value type",
        PYTHON,
    ),
    Plant(
        "python",
        "The book, with every command in it",
        "a tutorial that no list has",
        [(f"{TUTORIALS}/planted.md", "", "# Planted\n")],
        "planted",
        needs="program",
    ),
    Plant(
        "wheel",
        "Wheel and source distribution",
        "a package without the page that it names",
        [("pyproject.toml", 'readme = "README.md"', 'readme = "NO-SUCH-README.md"')],
        "NO-SUCH-README.md",
        (("maturin build --locked --out packages", ":"),),
    ),
    Plant(
        "wheel",
        "A first verdict from the wheel",
        "an example that asks for what there is not",
        [("scripts/examples/first_verdict.py", "import voidwalk as vw", "import voidwalk as vw\nvw.no_such_call()")],
        "no_such_call",
        needs="wheel",
    ),
]


def planted(clone, edits):
    """Makes the edits; every text before must be there."""
    for name, before, after in edits:
        path = clone / name
        text = path.read_text() if path.exists() else ""
        if before not in text:
            sys.exit(f"planted_failures.py: {name} has no {before!r}")
        path.write_text(text.replace(before, after, 1) if before else text + after)


class Trial:
    """A clone with the environment of a job."""

    def __init__(self, name, work, args):
        workflow = yaml.safe_load(WORKFLOW.read_text(encoding="utf-8"))
        self.job = workflow["jobs"][name]
        self.work = work / name
        self.work.mkdir()
        self.clone = self.work / "clone"
        subprocess.run(["git", "clone", "--quiet", ROOT, self.clone], check=True)
        BUILT.mkdir(parents=True, exist_ok=True)
        # Environments of Python that stand on that of an earlier run, which is gone.
        for environment in ("forge", "python", "book-environment"):
            shutil.rmtree(BUILT / environment, ignore_errors=True)
        (self.clone / "target").symlink_to(BUILT)
        if args.program:
            (BUILT / "release").mkdir(exist_ok=True)
            shutil.copy(args.program, BUILT / "release" / "voidwalk")
        if args.wheel:
            (self.clone / "packages").mkdir()
            shutil.copy(args.wheel, self.clone / "packages")
        self.runner = Runner(workflow, self.job, combination(self.job, {}), self.work, self.clone)
        self.runner.share_crates()
        #: Of steps that passed without a mistake: seconds.
        self.passed = {}

    def run(self, plant):
        """Exit code, seconds, and what the step says."""
        (step,) = [step for step in self.job["steps"] if step.get("name") == plant.step]
        script = self.runner.script(step)
        for before, after in plant.instead:
            if before not in script:
                sys.exit(f"planted_failures.py: {plant.job}, {plant.step}: there is no {before!r}")
            script = script.replace(before, after)
        at = time.monotonic()
        with tempfile.TemporaryFile("w+", errors="replace") as log:
            code = self.runner.run(step, script, log=log)
            log.seek(0)
            return code, time.monotonic() - at, log.read()

    def git(self, *words):
        subprocess.run(["git", "-C", self.clone, *words], check=True, stdout=subprocess.DEVNULL)

    def of(self, plant):
        """Whether a mistake is seen, and its row."""
        if plant.tag:
            self.git("tag", "--force", plant.tag)
        key = (plant.step, plant.instead, plant.tag)
        if key not in self.passed:
            code, seconds, said = self.run(plant)
            if code:
                print(said, file=sys.stderr)
                return False, row(plant, f"fails without it, exit code {code}", seconds)
            self.passed[key] = seconds
        planted(self.clone, plant.edits)
        code, seconds, said = self.run(plant)
        self.git("checkout", "--quiet", ".")
        self.git("clean", "--quiet", "--force", "--exclude", "packages", "--exclude", "target")
        if plant.tag:
            self.git("tag", "--delete", plant.tag)
        is_seen = code != 0 and plant.says in said
        if not is_seen:
            print(said, file=sys.stderr)
        return is_seen, row(plant, f"exit code {code}" if is_seen else "**not seen**", seconds)


def row(plant, seen, seconds):
    whole = "the whole step" if not plant.instead else "; ".join(f"`{after}`" for _, after in plant.instead)
    return f"| {plant.job} | {plant.step} | {plant.what} | {whole} | {seen} | {seconds:.0f} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    jobs = list(dict.fromkeys(plant.job for plant in PLANTS))
    parser.add_argument("jobs", nargs="*", metavar="JOB", help=", ".join(jobs))
    parser.add_argument("--wheel", type=Path, help="a wheel of this checkout")
    parser.add_argument("--program", type=Path, help="a program of this checkout, compiled for release")
    parser.add_argument("--only", metavar="STEP", help="of these jobs this step alone")
    args = parser.parse_args()
    unknown = [job for job in args.jobs if job not in jobs]
    if unknown:
        parser.error(f"no job {', '.join(unknown)}; there are: {', '.join(jobs)}")
    there = yaml.safe_load(WORKFLOW.read_text(encoding="utf-8"))["jobs"]
    if set(there) != set(jobs):
        sys.exit(f"planted_failures.py: jobs without a mistake, or mistakes without a job: {set(there) ^ set(jobs)}")
    work = Path(tempfile.mkdtemp(prefix="planted-"))
    all_seen = True
    print("| job | step | planted | what ran | seen | s |\n|---|---|---|---|---|---|", flush=True)
    try:
        for job in args.jobs or jobs:
            trial = Trial(job, work, args)
            for plant in PLANTS:
                if plant.job != job or (args.only and plant.step != args.only):
                    continue
                if plant.needs and not getattr(args, plant.needs):
                    print(row(plant, f"left out: no `--{plant.needs}`", 0), flush=True)
                    continue
                seen, said = trial.of(plant)
                print(said, flush=True)
                all_seen &= seen
    finally:
        shutil.rmtree(work)
    return 0 if all_seen else 1


if __name__ == "__main__":
    sys.exit(main())
