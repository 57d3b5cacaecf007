#!/usr/bin/env python3
"""Prints the size of the house beside its budgets: lines of code, functions that return text, words of the texts, lines of scripts.

    scripts/checks/budgets.py [BEFORE] [NOW]

BEFORE and NOW are commits (2d791bc; the checkout, with what git would add). Lines of Rust count comments and tests. A function
returns text where its type names String, str or Cow; it is counted in the folders that hold no words for a user, without tests.
A public item has `pub` at the beginning of its line, without `pub(...)`. Exit code 1 where the checkout is over a budget.
"""

import io
import re
import subprocess
import sys
import tarfile
from pathlib import Path
from statistics import median

ROOT = Path(__file__).resolve().parents[2]
FIRST = "2d791bc"
CRATES = ("core", "sheets", "practice", "app")
# Folders of a crate that hold words, and rooms of that name before there were crates.
FACES = ("words", "report", "serve", "cli", "docs")
FILES = re.compile(r"src/.*\.(rs|md)|scripts/.*|results/[^/]*\.md|(README|CHANGELOG|CONTRIBUTING)\.md")
RETURNS = re.compile(r"\bfn\s+\w+[^;{]*?->\s*([^{;]*?)\s*(?:where\b[^{]*)?\{", re.S)
TEXT = re.compile(r"\b(?:String|str|Cow)\b")
#: The most of each row.
AIMS = {
    "lines of src/core": 29_000, "lines of src/sheets": 4_500, "lines of src/practice": 6_500, "lines of src/app": 34_000,
    "lines of src": 74_000, "functions below the faces that return text": 0, "words of README.md": 600,
    "words of CHANGELOG.md": 400, "words of CONTRIBUTING.md": 1_500, "words of src/docs": 12_000, "words of results": 15_000,
    "lines of scripts": 20_000,
}


def git(*arguments):
    return subprocess.run(["git", *arguments], cwd=ROOT, check=True, capture_output=True).stdout


def texts_of(commit):
    """Names and texts of the files that are counted; of the checkout those that git tracks or would add."""
    if commit:
        with tarfile.open(fileobj=io.BytesIO(git("archive", commit))) as archive:
            found = {member.name: archive.extractfile(member).read() for member in archive if member.isfile() and FILES.fullmatch(member.name)}
    else:
        names = git("ls-files", "--cached", "--others", "--exclude-standard", "-z").decode().split("\0")
        found = {name: (ROOT / name).read_bytes() for name in names if FILES.fullmatch(name) and (ROOT / name).is_file()}
    return {name: content.decode(errors="replace") for name, content in found.items()}


def code(text):
    """Rust without comments and without the tests at its end."""
    return re.sub(r"(?m)^\s*//.*$", "", text.split("#[cfg(test)]\nmod tests {")[0])


def is_test(name):
    return name.endswith(("tests.rs", "_test.rs")) or "/tests/" in name


def counted(commit):
    """The rows of a commit, or of the checkout."""
    texts = texts_of(commit)
    lines = lambda names: sum(texts[name].count("\n") for name in names)
    words = lambda start: sum(len(text.split()) for name, text in texts.items() if name.startswith(start) and name.endswith(".md"))
    rust = [name for name in texts if name.startswith("src/") and name.endswith(".rs")]
    crates = {crate: [name for name in rust if name.startswith(f"src/{crate}/")] for crate in CRATES}
    root = [name for name in rust if not any(name in of_crate for of_crate in crates.values())]
    plain = {name: code(texts[name]) for name in rust if not is_test(name)}
    below = [text for name, text in plain.items() if not set(name.removesuffix(".rs").split("/")[1:3]) & set(FACES)]
    return {
        **{f"lines of src/{crate}": lines(names) for crate, names in crates.items()},
        "lines of src beside them": lines(root),
        "lines of src": lines(rust),
        "files of src": len(rust),
        "median lines of a file": int(median(texts[name].count("\n") for name in rust)),
        "functions below the faces that return text": sum(bool(TEXT.search(kind)) for text in below for kind in RETURNS.findall(text)),
        "public items": sum(len(re.findall(r"(?m)^\s*pub (?!use\b|mod\b)", text)) for text in plain.values()),
        **{f"words of {name}": words(name) for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "src/docs", "results")},
        "lines of scripts": lines(name for name in texts if name.startswith("scripts/")),
    }


def main():
    if len(sys.argv) > 3 or sys.argv[1:2] in (["-h"], ["--help"]):
        sys.exit(__doc__.strip())
    before = counted(sys.argv[1] if len(sys.argv) > 1 else FIRST)
    now = counted(sys.argv[2] if len(sys.argv) > 2 else None)
    print("| | before | now | at most | |\n|---|---|---|---|---|")
    over = [name for name, most in AIMS.items() if now[name] > most]
    for name, count in now.items():
        aim = f"{AIMS[name]:,}" if name in AIMS else ""
        print(f"| {name} | {before[name]:,} | {count:,} | {aim} | {'over' if name in over else ''} |")
    return 1 if over else 0


if __name__ == "__main__":
    sys.exit(main())
