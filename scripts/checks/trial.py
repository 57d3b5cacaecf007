#!/usr/bin/env python3
"""The first hour of a dam engineer, again: common filters against common bases, each walked, in one table.

    scripts/checks/trial.py --binary target/release/voidwalk [--pack] [--small]

Writes the sieve sheets, walks every pair with a constriction curve that is guessed from the gradation (`filter.estimate`; with `--pack`
each filter is packed by `filter.density` instead, which takes minutes to hours), and prints for each: the model's class, the headline of
practice, its colour on the page, the rules of practice that apply and are not met, and the processor time.

Exit code 1 where a page is green although a rule of practice that applies is not met, or where a run fails; a pair that is refused is
listed with the reason. `--small` walks a few pairs on small networks, as the tests do. Python 3's standard library only.
"""

import datetime
import json
import pathlib
import re
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "studies"))
import common  # noqa: E402

# Percent finer by opening (mm).
FILTERS = {
    "ASTM C33 sand, mid-band": [(9.5, 100), (4.75, 97.5), (2.36, 90), (1.18, 67.5), (0.6, 42.5), (0.3, 20), (0.15, 6), (0.075, 0)],
    "gravel, D15 6.3 mm": [(20, 100), (10, 45), (6.3, 15), (5, 0)],
    "gravel, D15 1.1 mm": [(4, 100), (2, 45), (1.1, 15), (0.9, 0)],
    "gap-graded, 40 % below 0.5 mm": [(20, 100), (10, 70), (5, 40), (0.5, 40), (0.25, 15), (0.1, 0)],
    "broad, Cu 27": [(31.5, 100), (16, 80), (8, 60), (4, 46), (2, 34), (1, 24), (0.5, 15), (0.3, 10), (0.15, 3), (0.1, 0)],
}
BASES = {
    "till, sieves to 0.075 mm": [(19, 100), (4.75, 92), (2, 82), (0.425, 60), (0.15, 45), (0.075, 36)],
    "till, with hydrometer": [(19, 100), (4.75, 92), (2, 82), (0.425, 60), (0.15, 45), (0.075, 36), (0.02, 20), (0.005, 9), (0.002, 3), (0.001, 0)],
    "silty sand": [(2, 100), (0.425, 85), (0.15, 45), (0.075, 20), (0.02, 8), (0.005, 2), (0.002, 0)],
    "clean uniform sand": [(0.425, 100), (0.25, 60), (0.15, 15), (0.1, 0)],
}
SMALL = [(0, 0), (0, 3), (1, 0), (2, 3)]

# The colour of a headline, by the class of its box (src/app/report/page.css).
COLOURS = {"none": "green", "doubted": "amber", "some": "orange", "continuing": "red", "neutral": "grey"}


def slug(name):
    return re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")


def trial(folder, filter_name, base_name, options):
    """The row of a pair, and what is wrong with it."""
    name = f"{slug(filter_name)}-on-{slug(base_name)}"
    settings = {"filter.sieve": f"{slug(filter_name)}.csv", "base.sieve": f"{slug(base_name)}.csv", "record.sensitivity": "[]"}
    settings |= {"filter.density": "loose"} if options.pack else {"filter.estimate": 0.5, "filter.grains_per_void": 0.6}
    settings |= {"network.nx": 10, "network.ny": 10, "network.nz": 12, "replicates": 3} if options.small else {}
    command = [options.binary, "run", "--out", name, "--threads", "1", "-q"]
    done, seconds = common.spent(command + common.sets(settings), cwd=folder, capture_output=True, text=True)
    if done.returncode:
        row = [filter_name, base_name, done.stderr.strip().split("\n")[-1].replace("|", "/"), "", "", "", f"{seconds:.1f}"]
        return row, [] if done.returncode == 2 else [f"{name}: exit code {done.returncode}"]
    outcome = json.loads((folder / name / "outcome.json").read_text())
    page = (folder / name / "report.html").read_text()
    box = re.search(r'<section class="verdict ([a-z]+)', page)
    colour = COLOURS.get(box.group(1), box.group(1)) if box else "none found"
    failed = [rule["id"] for rule in outcome["rules"] if rule["applies"] and rule["met"] is False and rule["role"] != "walk"]
    wrong = [f"{name}: no headline"] if not box else []
    if colour == "green" and failed:
        wrong.append(f"{name}: green, although {', '.join(failed)} is not met")
    runs = [f"{100 * run['eroded_mass_fraction']['mean']:.2f}" for run in outcome["summary"]]
    answers = [outcome["model"]["class"], ", ".join(runs), f"{outcome['headline']}; {colour}", ", ".join(failed)]
    return [filter_name, base_name, *answers, f"{seconds:.1f}"], wrong


def main():
    parser = common.parser(__doc__)
    parser.add_argument("--pack", action="store_true", help="pack each filter instead of guessing its constrictions")
    parser.add_argument("--small", action="store_true", help="a few pairs on small networks")
    options = parser.parse_args()
    options.binary = options.binary.resolve()
    filters, bases = list(FILTERS), list(BASES)
    pairs = [(filters[f], bases[b]) for f, b in SMALL] if options.small else [(f, b) for f in filters for b in bases]
    print(f"# Common filters against common bases, {datetime.date.today()}\n\n"
          "Base eroded: mean percent of the base's mass in the first run and in the second. Time: processor time of one thread.\n\n"
          "| filter | base | model | base eroded (%) | headline; colour | rules that apply and are not met | s |\n"
          "|---|---|---|---|---|---|---|", flush=True)
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for name, rows in (FILTERS | BASES).items():
            common.sheet(folder / f"{slug(name)}.csv", rows)
        for pair in pairs:
            row, problems = trial(folder, *pair, options)
            wrong += problems
            print(f"| {' | '.join(row)} |", flush=True)
    said = [f"WRONG: {problem}" for problem in wrong] or ["No page is green where a rule of practice that applies is not met."]
    print("", *said, sep="\n")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
