#!/usr/bin/env python3
"""The eleven problems of a dam engineer: the program's first lines beside limits worked out by hand, and pictures of its pages.

    scripts/checks/eleven_problems.py [--binary target/release/voidwalk] [--only a,b2] [--pictures DIR] [--set network.nx=8 ...]

Writes the soils of each problem as sheets (`trial_sheets.py` has them), runs `judge` or `design` as somebody would who gives no
density, and takes what the program says first, its seconds and its exit code. By hand: D15F by logarithmic interpolation, the limit of design by
category after regrading on 4.75 mm, and the boundaries of no and of continuing erosion. A problem is equal where the numbers in the program's
lines are these within 1 %, where it says "met" or "not met" as the limit has it, and, of `design`, where no answer is beyond the strictest limit.

`--pictures DIR` prints each page on A4 and Letter and looks at it at 1280 px, 390 px and in dark (Chromium; `scripts/browser`). What breaks
there is a fault of the problem: a first printed page that lacks a part or holds a word of the program, a table that is wider than its sheet.
`--set` makes the walks smaller, for the pages alone. Exit code 1 where a row is not equal. Python 3's standard library only.
"""

import argparse
import html
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import time

import trial_sheets as soils
from trial_sheets import csv, d, design_limit, no_erosion_limit

BROWSER = pathlib.Path(__file__).resolve().parents[1] / "browser" / "look_at_report.sh"

# (sheets {file: soil}, the call, what the base and the filter are; of a design no filter)
PROBLEMS = {
    "a": ("dispersive clay core on C33, coarse side", "CLAY_CORE", ["C33_COARSE"], ["judge", "--dispersive"]),
    "b": ("till on 0-32 gravel", "TILL", ["GRAVEL_0_32"], ["judge"]),
    "b2": ("the same till on segregated gravel", "TILL", ["SEGREGATED"], ["judge"]),
    "c": ("silty fine sand on No. 57 stone", "SILTY_SAND", ["NO_57"], ["judge"]),
    "d": ("dredged sand on a rock toe", "DREDGED", ["ROCK_TOE"], ["judge"]),
    "e": ("fine sand on a gap-graded filter", "FINE_SAND", ["GAP"], ["judge"]),
    "f1": ("clay core on C33, middle", "CLAY_CORE", ["C33_MID"], ["judge"]),
    "f2": ("C33, middle, on No. 57 stone", "C33_MID", ["NO_57"], ["judge"]),
    "g": ("design: a filter for the till", "TILL", [], ["design"]),
    "h": ("design: a filter for the silty fine sand", "SILTY_SAND", [], ["design"]),
    "k1": ("No. 8 on the silty fine sand", "SILTY_SAND", ["NO_8"], ["judge"]),
    "k2": ("No. 57 on the silty fine sand", "SILTY_SAND", ["NO_57"], ["judge"]),
    "k3": ("C33 on the silty fine sand", "SILTY_SAND", ["C33_MID"], ["judge"]),
}

# Words that say nothing to who signs the page, and places that no report can cite.
PROGRAM_WORDS = re.compile(
    r"\b(?:filter|base|walk|network|record|about)\.[a-z][a-z0-9_]+|\bJSON\b|\bestimate = |\breplicates = |\w_mm\b|\bN_base\b"
    r"|[a-z]+-em-1901|https?:|www\.|scribd|second[- ]hand", re.IGNORECASE)

# A sheet has its rules, its sizes and its figure on the first page.
FIRST_PAGE = {"judge": ["Figure 1.", "D15", "D85", "Group by ASTM D2487", "Rules of practice", "it leaves out "],
              "design": ["Figure 1.", "D15F"]}


def continuing_limit(base):
    """Foster and Fell's boundary of continuing erosion: 9 D95B of the base as it is regraded; None for 15 to 85 % fines and a
    D95B above 2 mm, where tests found no clear one."""
    base = soils.regraded(base)
    d95 = d(base, 95)
    return None if d95 > 2 and 15 <= soils.finer(base, 0.075) <= 85 else 9 * d95


def is_unstable(soil):
    """By Li and Fannin: less than min(F, 15 %) between D and 4 D, for F up to 20 % (Cu > 3) or 30 %."""
    rows = sorted(soil)
    if d(soil, 10) is None:
        return False
    sizes = [rows[0][0] * (rows[-1][0] / rows[0][0]) ** (at / 4000) for at in range(4001)]
    shares = [(soils.finer(soil, size), soils.finer(soil, 4 * size)) for size in sizes]
    most = 20 if d(soil, 60) > 3 * d(soil, 10) else 30
    return any(above - below < min(below, 15) for below, above in shares if 0 < below <= most)


def without_finest(soil):
    """D15F without the part finer than Kezdi's greatest split above 4 up to 20 % (that of the greatest ratio where none is), where the filter is not internally stable; else None."""
    if not is_unstable(soil):
        return None
    ratios = [(d(soil, at / 100 + 15) / d(soil, at / 100), at / 85) for at in range(1500, 5501) if d(soil, at / 100)]
    above = [split for ratio, split in ratios if ratio > 4 and split <= 20]
    split = above[-1] if above else max(ratios)[1]
    return d(soil, split + 0.15 * (100 - split))


def by_hand(name, base, filter_):
    """D15F, the limit of design, the boundaries of no and of continuing erosion, and D15F after washout (mm)."""
    dispersive = "--dispersive" in PROBLEMS[name][3]
    limits = design_limit(base, dispersive), no_erosion_limit(base, dispersive), continuing_limit(base)
    return d(filter_, 15), *limits, without_finest(filter_)


def near(said, limit):
    """Whether a number, as it is printed, is this one within 1 % and half of its last digit."""
    decimals = len(said.split(".")[1]) if "." in said else 0
    return abs(float(said) - limit) <= 0.01 * limit + 0.5 * 10 ** -decimals


def faults_of_practice(line, hand):
    """What of a line of practice is not as by hand."""
    d15f, design, no_erosion, continuing, washed_out = hand
    strictest = min(design, no_erosion)
    if line.startswith("meets") != (d15f <= design and (washed_out is None or washed_out <= strictest)):
        yield "met or not"
    washed = re.search(r"D15F ([\d.]+) mm without its finest", line)
    if "too coarse without it" in line and not (washed and near(washed[1], washed_out)):
        yield f"D15F after washout is {washed_out:.3g} mm"
    sizes = re.search(r"D15F ([\d.]+) mm, limit ([\d.]+) mm", line)
    if not sizes:
        yield "no D15F beside a limit"
        return
    if not near(sizes[1], d15f):
        yield f"D15F {sizes[1]}"
    if not near(sizes[2], design) and not near(sizes[2], strictest):
        yield f"limit {sizes[2]}"
    beyond = "at least some erosion" if continuing is None or d15f <= continuing else "continuing erosion"
    wanted = "no erosion" if d15f <= no_erosion else beyond
    said = "no-erosion criterion met" if wanted == "no erosion" else wanted
    # The limit of a dispersive base is that of no erosion, and taken for design, too.
    if f"Foster and Fell: {said}" not in line and not (wanted == "no erosion" and "note b" in line):
        yield f"Foster and Fell: not {wanted}"
    if wanted.startswith("at least") and "not excluded" not in line:
        yield "nothing of excessive erosion"
    for word, limit in (("up to", no_erosion), ("beyond", continuing)):
        for said in re.findall(rf"{word} ([\d.]+) mm", line):
            if limit is None or not near(said, limit):
                yield f"{word} {said}"


class Problem:
    def __init__(self, name, options, folder):
        self.name, self.options, self.folder = name, options, folder
        self.words, base, filters, self.call = PROBLEMS[name]
        self.base, self.filters = getattr(soils, base), [getattr(soils, one) for one in filters]
        self.hand = [by_hand(name, self.base, one) for one in self.filters]
        for sheet in [base, *filters]:
            (folder / f"{sheet}.csv").write_bytes(csv([["Opening (mm)", "% passing"], *map(list, getattr(soils, sheet))]))
        files = [f"{one}.csv" for one in filters]
        command, *flags = self.call
        self.args = [command, f"{base}.csv", *files, *flags]
        if command == "judge":
            self.args += [word for one in options.set for word in ("--set", one)]
        self.faults = []

    def run(self):
        began = time.monotonic()
        done = subprocess.run([self.options.binary, *self.args, "--out", self.name], cwd=self.folder, capture_output=True, text=True)
        self.seconds, self.code, self.out = time.monotonic() - began, done.returncode, done.stdout
        if self.code:
            self.faults.append(f"exit code {self.code}: {done.stderr.strip()[-200:]}")
            return
        command = self.call[0]
        if command == "design":
            self.check_design()
            return
        practice = re.findall(r"^\s*Practice: (.*)$", self.out, re.MULTILINE)
        self.said = list(zip(practice, re.findall(r"^\s*Model \(research\): (.*)$", self.out, re.MULTILINE)))
        if len(self.said) != len(self.hand):
            self.faults.append(f"{len(self.said)} lines of practice for {len(self.hand)} filters")
        for (line, _), hand in zip(self.said, self.hand):
            self.faults += faults_of_practice(line, hand)
        # Notes stand on the page; here only their number and their labels.
        if command == "judge" and len(self.out.splitlines()) > 5:
            self.faults.append(f"{len(self.out.splitlines())} lines on stdout")

    def check_design(self):
        specification = json.loads((self.folder / self.name / "specification.json").read_text())
        strictest = min(design_limit(self.base), no_erosion_limit(self.base))
        self.hand = [(None, design_limit(self.base), no_erosion_limit(self.base), continuing_limit(self.base), None)]
        self.said = [("; ".join(line.strip() for line in self.out.splitlines() if "maximum D15F: " in line), "")]
        greatest = specification["d15f_max_mm"]
        if abs(greatest - strictest) > 0.01 * strictest:
            self.faults.append(f"{greatest} mm by practice")

    def look(self, pictures):
        """Prints and pictures of the page; what breaks there is a fault."""
        page = self.folder / self.name / {"judge": "report.html", "design": "specification.html"}[self.call[0]]
        for suffix, how in (("1280.png", ["1280"]), ("390.png", ["390"]), ("dark.png", ["1280", "dark"]), ("a4.pdf", ["a4"]), ("letter.pdf", ["letter"])):
            out = pictures / f"{self.name}-{suffix}"
            done = subprocess.run(["sh", BROWSER, page, out, *how], capture_output=True, text=True)
            if done.returncode:
                self.faults.append(done.stderr.replace(str(page), self.name).strip()[:300])
            if suffix.endswith(".pdf") and out.exists():
                self.look_at_first_page(out, suffix)

    def look_at_first_page(self, pdf, suffix):
        first = subprocess.run(["pdftotext", "-f", "1", "-l", "1", pdf, "-"], capture_output=True, check=True, text=True).stdout
        first = " ".join(first.split())
        rules = []
        if self.call[0] == "judge":
            outcome = json.loads((self.folder / self.name / "outcome.json").read_text())
            # What both rules of drainage ask for is said once.
            limits = {rule["id"]: rule.get("limit") for rule in outcome["rules"]}
            is_twice = lambda rule: rule["id"] == "permeability-em-1901" and rule.get("limit") == limits["permeability"]
            # So is the limit of a dispersive base, under a name of its own.
            one = {"sherard-dunnigan", "foster-fell-no-erosion"}
            is_one = limits["sherard-dunnigan"] == limits["foster-fell-no-erosion"] and "--dispersive" in self.call
            named = [rule for rule in outcome["rules"] if rule["role"] != "walk" and not is_twice(rule)]
            rules = ["Fell et al.: no erosion of a highly dispersive base"] * is_one + [rule["name"] for rule in named if not (is_one and rule["id"] in one)]
        lacking = [part for part in [*FIRST_PAGE[self.call[0]], *rules] if part not in first]
        if lacking:
            self.faults.append(f"the first page of {suffix} lacks {', '.join(lacking)}")
        words = sorted(set(PROGRAM_WORDS.findall(first)))
        if words:
            self.faults.append(f"the first page of {suffix} has words of the program: {', '.join(words)}")

    def row(self):
        def limits(hand):
            d15f, design, no_erosion, continuing, washed_out = hand
            here = "" if d15f is None else f"D15F {d15f:.3g}; "
            clear = "no clear CE" if continuing is None else f"CE {continuing:.3g}"
            left = "" if washed_out is None else f", D15F after washout {washed_out:.3g}"
            return f"{here}design {design:.3g}, NE {no_erosion:.3g}, {clear}{left}"

        hand = "<br>".join(limits(one) for one in self.hand)
        said = "<br>".join(f"{practice}<br>*{walk}*" for practice, walk in getattr(self, "said", []))
        cells = [f"**{self.name}** {self.words}", hand, said, f"{self.seconds:.0f}", str(self.code), "; ".join(self.faults) or "equal"]
        return "| " + " | ".join(cell.replace("|", "/").replace("\n", " ") for cell in cells) + " |"


def version(binary):
    return subprocess.run([binary, "--version"], capture_output=True, check=True, text=True).stdout.strip()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--binary", default="target/release/voidwalk", type=lambda text: str(pathlib.Path(text).resolve()))
    parser.add_argument("--only", help="names of problems, with commas between them")
    parser.add_argument("--pictures", type=pathlib.Path, help="folder for pictures and prints of each page")
    parser.add_argument("--set", nargs="*", default=[], metavar="KEY=VALUE", help="settings of every walk")
    options = parser.parse_args()
    wanted = options.only.split(",") if options.only else list(PROBLEMS)
    rows, wrong = [], 0
    with tempfile.TemporaryDirectory() as folder:
        for name in wanted:
            problem = Problem(name, options, pathlib.Path(folder))
            problem.run()
            if options.pictures and not problem.code:
                options.pictures.mkdir(parents=True, exist_ok=True)
                problem.look(options.pictures.resolve())
            rows.append(problem.row())
            wrong += bool(problem.faults)
            print(html.unescape(rows[-1]), flush=True)
    print(f"{len(rows) - wrong} of {len(rows)} equal")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
