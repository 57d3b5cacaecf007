#!/usr/bin/env python3
"""What the program says of 200 pairs and scenes, as text files under tests/words, a file each: a change of words is read as
a diff.

    scripts/checks/words.py [--binary target/release/voidwalk] [--only TEXT]

`pairs.json` there holds 43 pairs of a dam engineer, 119 real soils with common filters, 30 sheets of tests/soils and 8
scenes of researchers. Real soils: ground investigations in the United Kingdom, published by their owners under the Open
Government Licence in the test data of pyagsapi (British Geological Survey). Networks are small and runs few, so that all take
two minutes; numbers of the walk are not those of a design. Exit code 1 where a file has changed: read `git diff tests/words`.
"""

import argparse
import html
import json
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
WORDS = ROOT / "tests" / "words"
SMALL = ["network.nx=10", "network.ny=10", "network.nz=30", "replicates=3", "seed=1"]
# Notes and sources stand below each rule of these alone: the others have the same.
WITH_SOURCES = ("C33 on", "No. ", "gap", "filter")
# Times, and the folder of this machine.
VARYING = re.compile(r"^\s*(\d[\d.]* ?(s|ms|min)\b.*|to go on from:.*|report: .*)$")
# The number of notes and their names stand behind that folder; their sentences are on the page.
LABELS = re.compile(r"^report: .*; (\d+ notes?: .*)$")
NOTES = re.compile(r"<h2[^>]*>Notes</h2>\s*<ul[^>]*>(.*?)</ul>", re.DOTALL)


def table(path: Path, rows: list[list[float]]) -> str:
    path.write_text("sieve_mm,percent_finer\n" + "".join(f"{size:.6g},{finer:.6g}\n" for size, finer in rows))
    return path.name


def said(binary: Path, folder: Path, *words: str) -> str:
    run = subprocess.run([binary, *words], cwd=folder, capture_output=True, text=True)
    text = run.stdout if run.returncode in (0, 1) or run.stdout else run.stderr
    text = "\n".join(LABELS.sub(r"\1", line.rstrip()) for line in text.splitlines())
    lines = [line for line in text.splitlines() if not VARYING.match(line)]
    return f"$ {' '.join(words[:1])}: exit code {run.returncode}\n" + "\n".join(lines) + "\n"


def notes(folder: Path) -> str:
    """The headline, and the sentences of the notes from the page beside their names from the record."""
    outcome = folder / "out" / "outcome.json"
    if not outcome.is_file():
        return ""
    record, page = json.loads(outcome.read_text()), (folder / "out" / "report.html").read_text()
    listed = NOTES.search(page)
    items = re.findall(r"<li[^>]*>(.*?)</li>", listed[1], re.DOTALL) if listed else []
    sentences = [" ".join(html.unescape(re.sub(r"<[^>]*>", "", item)).split()) for item in items]
    lines = [f"- {note['id']}: {words}" for note, words in zip(record["notes"], sentences, strict=True)]
    return "\n".join(["notes", f"headline: {record.get('headline')}", *lines]) + "\n"


def words_of(binary: Path, pair: dict) -> str:
    small = [word for setting in SMALL for word in ("--set", setting)]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if "scene" in pair:
            (folder / "scene.toml").write_text(pair["scene"])
            text = said(binary, folder, "run", "scene.toml", "--out", "out", "--threads", "1", *small)
            return text + notes(folder)
        base = table(folder / "base.csv", pair["base"]) if "base" in pair else str(ROOT / pair["sheet"])
        if "sheet" in pair:
            base = Path(base).name
            (folder / base).write_bytes((ROOT / pair["sheet"]).read_bytes())
        two = [base, table(folder / "filter.csv", pair["filter"])]
        of_rules = [option for option in pair["options"] if option != "--as-sampled"]
        text = said(binary, folder, "rules", *two, *of_rules) + "\n"
        if not pair["name"].startswith(WITH_SOURCES):
            text = re.sub(r"(?m)^ {12,}.*\n", "", text)
        walked = ["--quick", "--out", "out", "--threads", "1", *small, *pair["options"]]
        return text + said(binary, folder, "judge", *two, *walked) + "\n" + notes(folder)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--binary", type=Path, default=ROOT / "target" / "release" / "voidwalk")
    parser.add_argument("--only", default="", help="names that hold this text alone")
    options = parser.parse_args()
    binary = options.binary.resolve()
    pairs = [pair for pair in json.loads((WORDS / "pairs.json").read_text()) if options.only in pair["name"]]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        texts = list(pool.map(lambda pair: words_of(binary, pair), pairs))
    changed = []
    for pair, text in zip(pairs, texts):
        path = WORDS / (re.sub(r"[^a-z0-9]+", "-", pair["name"].lower()).strip("-") + ".txt")
        text = f"{pair['name']}\n\n{text}"
        if not path.is_file() or path.read_text() != text:
            path.write_text(text)
            changed.append(path.name)
    print(f"{len(pairs)} pairs and scenes, {len(changed)} with other words than before", *changed[:10], sep="\n  ")
    return 1 if changed else 0


if __name__ == "__main__":
    sys.exit(main())
