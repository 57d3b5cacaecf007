#!/usr/bin/env python3
"""Prints where the time of `judge`, `compare`, `design`, `judge --each` and `serve` goes, from the sheets to the page, in Markdown.

    scripts/peers/where_time_goes.py SOILS.json [--binary target/release/voidwalk] [--turns 5] [--soil 1] [--filter "C33 sand"] [--samples 8]

Parts of `judge`, one thread, processor time (user and system) of whole processes, median of the turns, in which the calls follow one
another: start-up is `--version`; the sheets are `rules` less that; the page is `report` of the finished folder less start-up; the studies
and the margin are what the call takes less when they are left out, so noise may take them below nothing; what the curve's range takes (the
walks at its ends) is not told apart from the replicates. By kind of work: samples of `perf` (no counters needed) by the module that the
function is in; without perf that table is left out. A server's first answers are wall time on its own threads. VOIDWALK_ISA chooses the
instructions. Before a change and after: once with each binary, on the same load.
"""

import argparse
import json
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.request
from collections import Counter
from pathlib import Path
from statistics import median

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
sys.path.insert(0, str(Path(__file__).parents[1] / "checks"))
from batch import D15F_MM, write_filter, write_samples  # noqa: E402
from real_pairs import FILTERS, table  # noqa: E402

#: A kind of work, and what the names of its functions hold; the first that fits.
KINDS = [
    ("expectation of passive particles", r"walk::counts::(expected|passive|PassiveWalk)|PassiveWalk"),
    ("particles one by one", r"walk::kernel"),
    ("inserting particles, drawing sizes", r"walk::(fill|insert|supply|strata)|stream::|gradation::sampler"),
    ("adding up events and sizes", r"walk::(merge|sizes|tally|arches)|counts::sizes|SizeCounts"),
    ("exits of voids", r"walk::(exits|openings|engine)|counts::shares|Shares|ExitTable"),
    ("who is trapped", r"walk::trapped|Trap"),
    ("the rest of the walk", r"voidwalk::walk"),
    ("networks and ways through them", r"voidwalk::network|constrictions::curve"),
    ("figures of a run", r"outcome::"),
    ("pages and files", r"voidwalk::(report|store|text)|serde|zip|deflate|html"),
    ("sheets, library, case", r"voidwalk::"),
]
OTHER = "memory, system, libraries"


def spent(words, **more):
    """Processor time of a whole process (s)."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, **more)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        sys.exit(f"exit code {done.returncode}: {' '.join(map(str, words))}\n{done.stderr[-800:]}")
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def parts(binary, pair, out, turns, quick):
    """Seconds of each part of `judge`."""

    def judge(*settings):
        return [binary, "judge", *pair, *quick, "--quiet", "--threads", "1", "--overwrite", "--out", out, *settings]

    calls = {
        "all": judge(),
        "report": [binary, "report", out],
        "start": [binary, "--version"],
        "rules": [binary, "rules", *pair],
        "no margin": judge("--set", "record.margin=false"),
        "no studies": judge("--set", "record.sensitivity=[]"),
    }
    if quick:
        del calls["no studies"]
    found = {name: [] for name in calls}
    for _ in range(turns):
        for name, words in calls.items():
            found[name].append(spent(words))
    took = {name: median(seconds) for name, seconds in found.items()}
    margin = took["all"] - took["no margin"]
    studies = took["all"] - took["no studies"] if "no studies" in took else 0.0
    sheets, page = took["rules"] - took["start"], took["report"] - took["start"]
    walks = took["all"] - took["start"] - sheets - page - margin - studies
    return took["all"], {
        "start-up": took["start"], "sheets and rules": sheets, "networks, replicates and ends of the curve": walks,
        "margin": margin, "studies": studies, "page": page,
    }


def kinds(words, folder):
    """Shares of the kinds of work, by samples of perf; nothing without it."""
    if not shutil.which("perf"):
        return None
    data = folder / "perf.data"
    subprocess.run(["perf", "record", "-q", "-F", "499", "-o", data, "--", *map(str, words)], check=True, capture_output=True)
    said = subprocess.run(["perf", "report", "-i", data, "--no-children", "-F", "overhead,symbol", "--stdio"], capture_output=True, text=True)
    shares = Counter()
    for line in said.stdout.splitlines():
        row = re.match(r"\s*([\d.]+)%\s+\[(.)\]\s+(.+)", line)
        if row:
            kind = next((kind for kind, names in KINDS if row[2] == "." and re.search(names, row[3])), OTHER)
            shares[kind] += float(row[1])
    return shares


class Server:
    """`voidwalk serve` in a folder."""

    def __init__(self, binary, folder):
        self.log = folder / "serve.log"
        with open(self.log, "w") as log:
            self.child = subprocess.Popen([str(binary), "serve", "--out", str(folder / "serve")], stdout=log, stderr=log)
        while not (found := re.search(r"http://\S+", self.log.read_text())):
            if self.child.poll() is not None:
                sys.exit(self.log.read_text())
            time.sleep(0.01)
        self.url = found.group(0)

    def ask(self, path, body=None):
        with urllib.request.urlopen(urllib.request.Request(self.url + path, data=body)) as answer:
            return json.load(answer)

    def answers(self, pair, quick):
        """Seconds from sending the sheets to the rules, to the first class of the walk, and to the page."""
        begun = time.monotonic()
        base, of_filter = (self.ask(f"api/sheet?name={path.name}", path.read_bytes())["id"] for path in pair)
        self.ask(f"api/rules?base={base}&filter={of_filter}")
        rules = time.monotonic() - begun
        body = json.dumps({"base": str(base), "filter": str(of_filter), "quick": quick}).encode()
        job = self.ask("api/judge", body)["id"]
        first = None
        while True:
            state = next(one for one in self.ask("api/state")["jobs"] if one["id"] == job)
            now = time.monotonic() - begun
            so_far = state["live"]["so_far"]
            if first is None and ((so_far and so_far["class"]) or state["result"]):
                first = now
            if state["state"] == "done":
                return [rules, first or now, now]
            if state["state"] not in ("waiting", "running"):
                sys.exit(f"serve: {state['state']}: {state['message']}")
            time.sleep(0.005)

    def stop(self):
        self.child.terminate()
        self.child.wait()


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("soils", type=Path)
    words.add_argument("--binary", type=Path, default="target/release/voidwalk")
    words.add_argument("--turns", type=int, default=5)
    words.add_argument("--soil", type=int, default=1)
    words.add_argument("--filter", default="C33 sand")
    words.add_argument("--samples", type=int, default=8)
    words = words.parse_args()
    soils = {soil["id"]: soil["points_mm_percent"] for soil in json.loads(words.soils.read_text())}
    binary = words.binary.resolve()
    print(f"Instructions: {os.environ.get('VOIDWALK_ISA', 'the widest of the machine')}; load {os.getloadavg()[0]:.1f}.\n")
    with tempfile.TemporaryDirectory() as work:
        work = Path(work)
        base, of_filter = pair = [work / "base.csv", work / "filter.csv"]
        table(base, soils[words.soil])
        table(of_filter, FILTERS[words.filter])
        others = [work / f"other-{k}.csv" for k in range(3)]
        for other, name in zip(others, FILTERS):
            table(other, FILTERS[name])
        draw = random.Random(38)
        write_samples(work / "site.ags", draw.sample(list(soils.values()), words.samples))
        filters = [work / f"{name}.csv" for name in D15F_MM]
        for path, d15_mm in zip(filters, D15F_MM.values()):
            write_filter(path, d15_mm)

        judged = {name: parts(binary, pair, work / "parts", words.turns, quick) for name, quick in (("judge", []), ("judge --quick", ["--quick"]))}
        names = list(judged["judge"][1])
        print("| one thread | processor s | " + " | ".join(names) + " |\n|---|---|" + "---|" * len(names))
        for name, (whole, shares) in judged.items():
            print(f"| {name} | {whole:.2f} | " + " | ".join(f"{100 * shares[part] / whole:.0f} %" for part in names) + " |")

        calls = {
            "judge": ["judge", *pair],
            "judge --quick": ["judge", *pair, "--quick"],
            "compare, three filters": ["compare", "--base", base, *others, "--quick"],
            "design": ["design", base, "--filter", of_filter],
            f"judge --each, {words.samples} samples and three filters": ["judge", work / "site.ags", *filters, "--each"],
        }
        found = {}
        for number, (name, call) in enumerate(calls.items()):
            found[name] = kinds([binary, *call, "--quiet", "--threads", "1", "--out", work / f"kinds-{number}"], work)
        if all(found.values()):
            print("\n| kind of work | " + " | ".join(found) + " |\n|---|" + "---|" * len(found))
            for kind in [kind for kind, _ in KINDS] + [OTHER]:
                print(f"| {kind} | " + " | ".join(f"{shares[kind]:.0f} %" for shares in found.values()) + " |")

        server = Server(binary, work)
        try:
            rows = {quick: [server.answers(pair, quick) for _ in range(words.turns)] for quick in (False, True)}
        finally:
            server.stop()
        print("\n| serve, all threads | rules, s | first class of the walk, s | page, s |\n|---|---|---|---|")
        for quick, turns in rows.items():
            print(f"| judge{' --quick' if quick else ''} | " + " | ".join(f"{median(column):.2f}" for column in zip(*turns)) + " |")


if __name__ == "__main__":
    main()
