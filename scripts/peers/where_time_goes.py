#!/usr/bin/env python3
"""Prints where the processor time of `judge` and `judge --quick` goes, from two sheets to the page, in Markdown.

    scripts/peers/where_time_goes.py SOILS.json [--binary target/release/voidwalk] [--turns 5] [--first] [--soil 1] [--filter "C33 sand"]

One thread, processor time (user and system) of whole processes, median of the turns, in which the calls follow one another: start-up
is `--version`; the sheets are `rules` less that; the page is `report` of the finished folder less start-up; the studies are what the
call takes less when they are left out. A difference that is less than the scatter of the whole call (from its least to its most turn)
is printed as less than that. --first lets the timed processes run before all others (`chrt`, which asks for the right to).
`waits.py` measures how long a user waits.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median

from waits import BEFORE_OTHERS, FILTERS, table


def spent(words):
    """Processor time of a whole process (s)."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        sys.exit(f"exit code {done.returncode}: {' '.join(map(str, words))}\n{done.stderr[-800:]}")
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def parts(binary, pair, out, turns, quick, first):
    """Seconds of `judge`, their scatter, and the seconds of each part."""

    def judge(*settings):
        return [*first, binary, "judge", *pair, *quick, "--quiet", "--threads", "1", "--overwrite", "--out", out, *settings]

    calls = {"all": judge(), "report": [binary, "report", out], "start": [binary, "--version"], "rules": [binary, "rules", *pair]}
    if not quick:
        calls["no studies"] = judge("--set", "record.sensitivity=[]")
    found = {name: [] for name in calls}
    for _ in range(turns):
        for name, words in calls.items():
            found[name].append(spent(words))
    took = {name: median(seconds) for name, seconds in found.items()}
    studies = took["all"] - took.get("no studies", took["all"])
    sheets, page = took["rules"] - took["start"], took["report"] - took["start"]
    walks = took["all"] - took["start"] - sheets - page - max(0, studies)
    return took["all"], max(found["all"]) - min(found["all"]), {
        "start-up": took["start"], "sheets and rules": sheets, "networks, replicates and ends of the curve": walks,
        "studies": studies, "page": page,
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("soils", type=Path)
    parser.add_argument("--binary", type=Path, default="target/release/voidwalk")
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--soil", type=int, default=1)
    parser.add_argument("--filter", default="C33 sand")
    parser.add_argument("--first", action="store_true")
    options = parser.parse_args()
    soils = {soil["id"]: soil["points_mm_percent"] for soil in json.loads(options.soils.read_text())}
    load = os.getloadavg()[0]
    with tempfile.TemporaryDirectory() as work:
        pair = [Path(work) / "base.csv", Path(work) / "filter.csv"]
        table(pair[0], soils[options.soil])
        table(pair[1], FILTERS[options.filter])
        first = BEFORE_OTHERS if options.first else ()
        judged = {" ".join(["judge", *quick]): parts(options.binary.resolve(), pair, Path(work) / "out", options.turns, quick, first)
                  for quick in ([], ["--quick"])}
    names = list(judged["judge"][2])
    print("| one thread | processor s (scatter) | " + " | ".join(names) + " |\n|---|---|" + "---|" * len(names))
    for name, (whole, scatter, of) in judged.items():
        is_hidden = of["studies"] < scatter and name == "judge"
        cells = {part: f"{100 * max(0.0, seconds) / whole:.0f} %" for part, seconds in of.items()}
        cells |= {"studies": f"< {100 * scatter / whole:.0f} %"} if is_hidden else {}
        print(f"| {name} | {whole:.2f} ({scatter:.2f}) | " + " | ".join(cells.values()) + " |")
    print(f"\nLoad {load:.1f} before and {os.getloadavg()[0]:.1f} after; {options.turns} turns.")


if __name__ == "__main__":
    main()
