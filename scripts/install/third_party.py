#!/usr/bin/env python3
"""Writes the licence texts of the crates inside voidwalk into a file, which every archive, wheel and image holds.

    scripts/install/third_party.py FILE

The texts are those in the crates' own archives. A crate that brings none gets the text of its licence from this checkout,
with its authors in place of ours.
"""

import json
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: The systems that binaries and wheels are made for.
TARGETS = [
    "x86_64-unknown-linux-gnu",
    "aarch64-unknown-linux-gnu",
    "x86_64-apple-darwin",
    "aarch64-apple-darwin",
    "x86_64-pc-windows-msvc",
]
#: The program, its crates and the Python module.
OURS = {"voidwalk", "voidwalk-app", "voidwalk-core", "voidwalk-practice", "voidwalk-python", "voidwalk-sheets"}
TEXT_FILE = re.compile(r"(licen[cs]e|copying|notice|unlicense|copyright)", re.IGNORECASE)
RULE = "=" * 100 + "\n"


def crates():
    """Every crate that is linked into a binary or wheel, on any system: its package by name and version."""
    found = {}
    for target in TARGETS:
        command = ["cargo", "metadata", "--format-version=1", "--locked", f"--filter-platform={target}"]
        told = json.loads(subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE).stdout)
        packages = {package["id"]: package for package in told["packages"]}
        nodes = {node["id"]: node for node in told["resolve"]["nodes"]}
        to_do = [node for node in nodes if packages[node]["name"] in OURS]
        seen = set()
        while to_do:
            node = to_do.pop()
            if node in seen:
                continue
            seen.add(node)
            package = packages[node]
            if any("proc-macro" in kind for target in package["targets"] for kind in target["kind"]):
                continue  # It writes code while voidwalk is compiled, and is not in it.
            if package["name"] not in OURS:
                found[package["name"], package["version"]] = package
            for dependency in nodes[node]["deps"]:
                if any(kind["kind"] is None for kind in dependency["dep_kinds"]):
                    to_do.append(dependency["pkg"])
    return [found[key] for key in sorted(found)]


def texts(package):
    """The licence texts of a crate. Of two licences to choose from, MIT is taken where it is one."""
    folder = Path(package["manifest_path"]).parent
    files = sorted(path for path in folder.iterdir() if path.is_file() and TEXT_FILE.match(path.name))
    files = [path for path in files if path.suffix.lower() in ("", ".md", ".txt") or "-" in path.name]
    mit = re.search(r"(^|OR |/)MIT($| OR|/)", package["license"] or "")
    if mit:
        files = [path for path in files if "mit" in path.name.lower()] or files
    if files:
        return [path.read_text(encoding="utf-8", errors="replace") for path in files]
    if not mit:
        sys.exit(f"{package['name']} brings no licence text, and {package['license']} is not one that is known here")
    authors = ", ".join(re.sub(r" <.*?>", "", author) for author in package["authors"]) or f"the authors of {package['name']}"
    ours = (ROOT / "LICENSE-MIT").read_text(encoding="utf-8")
    return [re.sub(r"^Copyright .*$", f"Copyright (c) {authors}", ours, count=1, flags=re.MULTILINE)]


def tidy(text):
    """The same words for texts that differ in line ends and blanks alone."""
    return "\n".join(line.rstrip() for line in text.replace("\r\n", "\n").strip().split("\n")) + "\n"


def whole():
    """The file: the crates with their licences, then every text once, under the crates that it belongs to."""
    packages = crates()
    owners = {}
    for package in packages:
        for text in map(tidy, texts(package)):
            owners.setdefault(text, []).append(f"{package['name']} {package['version']}")
    head = (
        "The programs and wheels of voidwalk hold the crates below, each under its own licence, and the standard\n"
        "library of Rust (MIT OR Apache-2.0, the Rust project contributors).\n"
        "Made by scripts/install/third_party.py from Cargo.lock.\n\n"
    )
    table = "".join(f"{p['name']} {p['version']}: {p['license']}\n" for p in packages)
    return head + table + "".join(f"\n{RULE}{', '.join(names)}\n{RULE}\n{text}" for text, names in owners.items())


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    Path(sys.argv[1]).write_bytes(whole().encode())


if __name__ == "__main__":
    main()
