#!/usr/bin/env python3
"""Lines and words of what an engineer is handed: stdout of `judge`, the first printed sheet, and the number of sheets (A4).

    scripts/checks/faces.py [--binary target/release/voidwalk] [--keep FOLDER] [--again] [NAME ...]

Its names are pairs and scenes of tests/words/pairs.json; without any, ten of them: pairs that meet practice, that do not, that are
not known, a till, a clay, a dispersive clay, a sheet of a laboratory, and a scene without two sheets. Networks are small, so
that all take a minute; a page of a large network has the same words. The cover is filled in. A word is what stands between
two spaces, lettering of the figure and cells of tables with it. --keep leaves the folders there, and --again draws the pages of such folders
anew, without stdout. Exit code 1 where a budget is exceeded. Needs Chromium and pdftotext, as look_at_report.sh does.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from words import ROOT, SMALL, WORDS, table

TEN = [
    "C33 on till",
    "No. 8 on CL core",
    "C33 on dispersive CL",
    "base table ends at 0.15 mm",
    "two-sieve filter on silty sand",
    "gap-graded filter on dune sand",
    "D15F 0.53 on CL, dispersion not known",
    "D15F = 5 D85B on uniform sand",
    "sheet hydrometer.csv and C33 sand",
    "scene: particles",
]
COVER = {
    "project": "Main dam, zone 2B", "number": "D-2031", "purpose": "Chimney filter", "client": "Water Board", "author": "N. N.",
    "checker": "M. M.", "revision": "A, issued for review",
}
LINES, STDOUT_WORDS, SHEET_WORDS, SHEETS = 12, 120, 400, 4


def walked(binary: Path, folder: Path, pair: dict) -> str:
    """Walks a pair or a scene into `out` of the folder; what it prints."""
    settings = SMALL + [f"about.{key}={json.dumps(text)}" for key, text in COVER.items()]
    small = [word for setting in settings for word in ("--set", setting)] + ["--threads", "1", "--out", "out", "--overwrite"]
    if "scene" in pair:
        (folder / "scene.toml").write_text(pair["scene"])
        words = ["run", "scene.toml", *small]
    else:
        base = table(folder / "base.csv", pair["base"]) if "base" in pair else Path(pair["sheet"]).name
        if "sheet" in pair:
            (folder / base).write_bytes((ROOT / pair["sheet"]).read_bytes())
        filter_ = table(folder / "filter.csv", pair["filter"])
        words = ["judge", base, filter_, "--quick", *small, *pair["options"]]
    run = subprocess.run([binary, *words], cwd=folder, capture_output=True, text=True)
    if not (folder / "out" / "report.html").is_file():
        raise SystemExit(f"{pair['name']}: {run.stderr}")
    return run.stdout


def printed(folder: Path) -> list[str]:
    """The text of each printed sheet (A4)."""
    look, pdf = ROOT / "scripts" / "browser" / "look_at_report.sh", folder / "a4.pdf"
    run = subprocess.run([look, folder / "out" / "report.html", pdf, "a4"], capture_output=True, text=True)
    if run.returncode:
        print(run.stderr, file=sys.stderr)
    text = subprocess.run(["pdftotext", pdf, "-"], capture_output=True, text=True, check=True).stdout
    return text.split("\f")[:-1]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--binary", type=Path, default=ROOT / "target" / "release" / "voidwalk")
    parser.add_argument("--keep", type=Path, help="folder that keeps runs, pages and PDFs")
    parser.add_argument("--again", action="store_true", help="draw the pages in --keep anew")
    options = parser.parse_args()
    binary = options.binary.resolve()
    pairs = {pair["name"]: pair for pair in json.loads((WORDS / "pairs.json").read_text())}
    exceeded = False
    print(f"{'pair':42}{'lines':>6}{'words':>6}{'sheet 1':>9}{'sheets':>7}{'printed':>9}")
    with tempfile.TemporaryDirectory() as name:
        root = options.keep or Path(name)
        for number, pair in enumerate(options.names or TEN):
            folder = root / str(number)
            folder.mkdir(parents=True, exist_ok=True)
            if options.again:
                subprocess.run([binary, "report", "out"], cwd=folder, check=True, capture_output=True)
                stdout = ""
            else:
                stdout = walked(binary, folder, pairs[pair])
            sheets = printed(folder)
            counts = [len(stdout.splitlines()), len(stdout.split()), len(sheets[0].split()), len(sheets)]
            over = any(count > most for count, most in zip(counts, (LINES, STDOUT_WORDS, SHEET_WORDS, SHEETS)))
            exceeded |= over
            lines, words, first, count = counts
            whole = sum(len(sheet.split()) for sheet in sheets)
            print(f"{pair:42}{lines:6}{words:6}{first:9}{count:7}{whole:9}{'  over' if over else ''}", flush=True)
    print(f"{'at most':42}{LINES:6}{STDOUT_WORDS:6}{SHEET_WORDS:9}{SHEETS:7}")
    return int(exceeded)


if __name__ == "__main__":
    sys.exit(main())
