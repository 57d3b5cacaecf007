#!/usr/bin/env python3
"""Counts the house: lines of src by kind, words of the texts, programs in scripts, crates in the program for Linux.

    scripts/checks/measure_house.py [COMMIT]      the checkout as it is, or a commit, which is not checked out
"""

import io
import os
import re
import subprocess
import sys
import tarfile
import tempfile
from collections import Counter
from pathlib import Path, PurePosixPath

TEXTS = re.compile(r"(README|CHANGELOG|CONTRIBUTING)\.md|(src/docs|results)/[^/]*\.md")
KINDS = ["statements", "lone brackets", "use", "text", "comment", "blank", "tests"]


def git(*arguments):
    return subprocess.run(["git", *arguments], check=True, capture_output=True).stdout


def files_of(commit):
    """Names and bytes of every file of a commit, or of the checkout: what git tracks or would add."""
    if commit:
        with tarfile.open(fileobj=io.BytesIO(git("archive", commit))) as archive:
            return {member.name: archive.extractfile(member).read() for member in archive if member.isfile()}
    names = git("ls-files", "--cached", "--others", "--exclude-standard", "-z").decode().split("\0")
    return {name: Path(name).read_bytes() for name in names if name and Path(name).is_file()}


def test_files(sources):
    """Files that hold nothing but tests: by their name, or declared by another as `#[cfg(test)] mod name;`."""
    found = set()
    for name, text in sources.items():
        path = PurePosixPath(name)
        if path.stem == "tests" or path.stem.endswith("_tests") or "tests" in path.parts[:-1]:
            found.add(name)
        folder = path.parent if path.name in ("mod.rs", "lib.rs") else path.with_suffix("")
        found |= {f"{folder}/{child}.rs" for child in re.findall(r"#\[cfg\(test\)\]\s+(?:pub\(\w+\) )?mod (\w+);", text)}
    return found


def kinds(text):
    """How many lines of a file are of which kind."""
    found = Counter()
    depth, in_tests, marked, in_use, in_text = 0, False, False, False, False
    for line in text.splitlines():
        bare = line.strip()
        # Rustfmt puts the item on the next line, indented as its mark.
        if not in_tests and bare == "#[cfg(test)]" and not in_text:
            marked, indent = True, line[: len(line) - len(line.lstrip())]
            found["tests"] += 1
            continue
        if marked:
            marked = False
            found["tests"] += 1
            in_tests = bare.endswith("{")
            continue
        if in_tests:
            found["tests"] += 1
            in_tests = line != indent + "}"
            continue
        if in_text:
            # The string that begins on an earlier line ends here, or not.
            found["text"] += 1
            in_text = not ends_text(line, True)
        elif not bare:
            found["blank"] += 1
        elif bare.startswith("//"):
            found["comment"] += 1
        elif in_use or re.match(r"(pub(\([a-z]+\))? )?use ", bare):
            found["use"] += 1
            in_use = not bare.endswith(";")
        elif not re.search(r"\w|[\"'_|&]", bare):
            found["lone brackets"] += 1
        else:
            in_text = not ends_text(line, False)
            found["text" if re.match(r'(r#*)?"', bare) else "statements"] += 1
    return found


def ends_text(line, inside):
    """Whether no string is open at the end of the line."""
    line = re.sub(r"\\.|'\"'", "", line)
    if not inside:
        line = re.sub(r"//[^\"]*$", "", line)
    return (line.count('"') + inside) % 2 == 0


def programs(files):
    """Programs around voidwalk, without its Python package."""
    found = [name for name in files if re.fullmatch(r"scripts/.*\.(py|sh|rs)", name)]
    return [name for name in found if not re.match(r"scripts/python/.*/", name)]


def crates(files):
    """Lines of `cargo tree` that differ: crates that others lean on stand there twice."""
    with tempfile.TemporaryDirectory() as folder:
        for name in files:
            if name.endswith((".toml", ".lock", ".rs")):
                path = Path(folder, name)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(files[name])
        tree = ["cargo", "tree", "--locked", "-e", "normal", "--target", "x86_64-unknown-linux-gnu", "--prefix", "none"]
        said = subprocess.run(tree, cwd=folder, check=True, capture_output=True, text=True).stdout
    lines = set(said.splitlines())
    return len(lines), len({line.removesuffix(" (*)") for line in lines})


def main():
    if len(sys.argv) > 2 or sys.argv[1:2] in (["-h"], ["--help"]):
        sys.exit(__doc__.strip())
    commit = sys.argv[1] if len(sys.argv) == 2 else None
    top = git("rev-parse", "--show-toplevel").decode().strip()
    os.chdir(top)
    files = files_of(commit)
    sources = {name: data.decode() for name, data in files.items() if re.fullmatch(r"src/.*\.rs", name)}
    tests = test_files(sources)
    total = Counter()
    for name, text in sources.items():
        total += Counter(tests=len(text.splitlines())) if name in tests else kinds(text)
    words = sum(len(data.decode().split()) for name, data in files.items() if TEXTS.fullmatch(name))
    lines, different = crates(files)
    print(f"src: {sum(total.values()):,} lines in {len(sources)} files")
    for kind in KINDS:
        print(f"  {total[kind]:>7,} {kind}")
    print(f"texts: {words:,} words")
    print(f"scripts: {len(programs(files))} programs")
    print(f"crates for Linux: {different} ({lines} lines of cargo tree)")


if __name__ == "__main__":
    main()
