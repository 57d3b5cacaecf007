#!/usr/bin/env python3
"""Prints where the time of `judge`, `boundary`, `judge --each` and `serve` goes, from the sheets to the page: all its tables (some are in
`results/speed.md`), in Markdown.

    scripts/peers/where_time_goes.py SOILS.json [--binary target/release/voidwalk] [--before OTHER] [--turns 5] [--first]
        [--soil 1] [--filter "C33 sand"] [--samples 8] [--pairs 12] [--only aims parts kinds disk serve]

Each table has the load before and after it. --first lets the timed processes run before all others (`chrt`, which asks for the right to):
then other work takes no turns from them, though it shares their caches.

aims: how long a user waits for each command on real pairs, by the clock and with all threads, as `waits.py` measures it, with each
instruction set that the machine has (or with VOIDWALK_ISA alone); and how many threads were busy on average, which says how much of the
wait is processor time. With --before the other program in turns with this one.
parts: of `judge`, one thread, processor time (user and system) of whole processes, median of the turns, in which the calls follow one
another: start-up is `--version`; the sheets are `rules` less that; the page is `report` of the finished folder less start-up; the studies
are what the call takes less when they are left out. A difference that is less than the scatter of the whole call (from its
least to its most turn) is told as less than that. What the curve's range takes is not told apart from the replicates.
kinds: samples of `perf` (no counters needed) by the module that the function is in, one thread; the number of samples stands in the
heading, and a share below three of them is told as less than that. Without perf that table is left out.
disk: how often a process waits for the disk, and how long, by `strace`; left out without it.
serve: a server's first answers by the clock, on its own threads.
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
from waits import BEFORE_OTHERS, drawn, measured, spread  # noqa: E402

#: A kind of work, and what the names of its functions hold; the first that fits.
KINDS = [
    ("expectation of passive particles", r"walk::counts::(expected|passive|PassiveWalk)|PassiveWalk"),
    ("particles one by one", r"walk::kernel"),
    ("inserting particles, drawing sizes", r"walk::(fill|insert|supply|strata)|stream::|gradation::sampler"),
    ("adding up events and sizes", r"walk::(merge|sizes|tally|arches)|counts::sizes|SizeCounts"),
    ("exits of voids", r"walk::(exits|openings|engine)|counts::shares|Shares|ExitTable|PlainExits"),
    ("who is trapped", r"walk::trapped|Trap|leads_out|leading_to"),
    ("the rest of the walk", r"voidwalk::walk"),
    ("networks and ways through them", r"voidwalk::network|constrictions::curve"),
    ("figures of a run", r"outcome::"),
    ("pages and files", r"voidwalk::(report|store|text)|serde|zip|deflate|html"),
    ("sheets, library, case", r"voidwalk::"),
]
OTHER = "memory, system, libraries"


#: Samples a second, and the fewest of a share that is told.
RATE, FEWEST = 1999, 3


def spent(words, **more):
    """Processor time of a whole process (s)."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, **more)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        sys.exit(f"exit code {done.returncode}: {' '.join(map(str, words))}\n{done.stderr[-800:]}")
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def parts(binary, pair, out, turns, quick, first):
    """Seconds of `judge`, their scatter, and of each part its seconds and whether it is a difference of whole calls."""

    def judge(*settings):
        return [*first, binary, "judge", *pair, *quick, "--quiet", "--threads", "1", "--overwrite", "--out", out, *settings]

    calls = {
        "all": judge(),
        "report": [binary, "report", out],
        "start": [binary, "--version"],
        "rules": [binary, "rules", *pair],
        "no studies": judge("--set", "record.sensitivity=[]"),
    }
    if quick:
        del calls["no studies"]
    found = {name: [] for name in calls}
    for _ in range(turns):
        for name, words in calls.items():
            found[name].append(spent(words))
    took = {name: median(seconds) for name, seconds in found.items()}
    studies = took["all"] - took["no studies"] if "no studies" in took else 0.0
    sheets, page = took["rules"] - took["start"], took["report"] - took["start"]
    walks = took["all"] - took["start"] - sheets - page - max(0, studies)
    return took["all"], max(found["all"]) - min(found["all"]), {
        "start-up": (took["start"], False), "sheets and rules": (sheets, False),
        "networks, replicates and ends of the curve": (walks, False),
        "studies": (studies, not quick), "page": (page, False),
    }


def share_of(whole, scatter, seconds, is_difference):
    """A part's share, in words."""
    if is_difference and seconds < scatter:
        return f"< {100 * scatter / whole:.0f} %"
    return f"{100 * max(0.0, seconds) / whole:.0f} %"


def kinds(words, folder):
    """Samples of perf, and by kind of work their shares (%)."""
    data = folder / "perf.data"
    record = ["perf", "record", "-q", "-e", "cpu-clock", "-F", str(RATE), "-o", data, "--", *map(str, words)]
    subprocess.run(record, check=True, capture_output=True)
    report = ["perf", "report", "-i", data, "--no-children", "-F", "overhead,sample,symbol", "--stdio"]
    said = subprocess.run(report, capture_output=True, text=True)
    shares, samples = Counter(), 0
    for line in said.stdout.splitlines():
        row = re.match(r"\s*([\d.]+)%\s+(\d+)\s+\[(.)\]\s+(.+)", line)
        if row:
            kind = next((kind for kind, names in KINDS if row[3] == "." and re.search(names, row[4])), OTHER)
            shares[kind] += float(row[1])
            samples += int(row[2])
    return samples, shares


def waits_for_disk(words):
    """How often a call waits for the disk, and the seconds that this takes, over all threads."""
    told = subprocess.run(["strace", "-f", "-c", "-w", "-e", "trace=fsync,fdatasync", *map(str, words)], capture_output=True, text=True)
    rows = re.findall(r"^\s*[\d.]+\s+([\d.]+)\s+\d+\s+(\d+)\s.*f(?:data)?sync$", told.stderr, re.MULTILINE)
    return sum(int(count) for _, count in rows), sum(float(seconds) for seconds, _ in rows)


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


class Load:
    """The load of the machine around a table."""

    def __init__(self):
        self.before = os.getloadavg()[0]

    def line(self, more=""):
        return f"\nLoad {self.before:.1f} before and {os.getloadavg()[0]:.1f} after{more}.\n"


def aims(soils, binaries, options, first):
    pairs = drawn(soils, options.pairs, 5)
    chosen = os.environ.get("VOIDWALK_ISA")
    for isa in [chosen] if chosen else [isa for isa in ("avx512", "avx2") if has(isa)] or [None]:
        load = Load()
        os.environ.pop("VOIDWALK_ISA", None)
        if isa:
            os.environ["VOIDWALK_ISA"] = isa
        found = measured(pairs, binaries, options.turns, first=first)
        heads = ["before", "now"][-len(binaries):]
        print(f"| all threads, {isa or 'portable'} | pairs | " + " | ".join(f"{head}, s" for head in heads)
              + " | threads busy |" + (" processor time, now / before |" if len(binaries) > 1 else ""))
        print("|---|---|" + "---|" * (len(binaries) + len(heads)))
        for command, rows in found.items():
            cells = [spread([row[2][at][0] for row in rows]) for at in range(len(binaries))]
            cells.append(f"{median(row[2][-1][1] / row[2][-1][0] for row in rows):.2f}")
            if len(binaries) > 1:
                cells.append(spread([row[2][1][1] / row[2][0][1] for row in rows]))
            print(f"| {command} | {len(rows)} of {options.pairs} | " + " | ".join(cells) + " |")
        print(load.line(f"; {options.turns} turns"), flush=True)
    os.environ.pop("VOIDWALK_ISA", None)
    if chosen:
        os.environ["VOIDWALK_ISA"] = chosen


def has(isa):
    """Whether the processor has these instructions, as Linux tells."""
    try:
        flags = Path("/proc/cpuinfo").read_text().split()
    except OSError:
        return False
    return {"avx512": "avx512bw", "avx2": "avx2"}[isa] in flags


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("soils", type=Path)
    words.add_argument("--binary", type=Path, default="target/release/voidwalk")
    words.add_argument("--before", type=Path)
    words.add_argument("--turns", type=int, default=5)
    words.add_argument("--soil", type=int, default=1)
    words.add_argument("--filter", default="C33 sand")
    words.add_argument("--samples", type=int, default=8)
    words.add_argument("--pairs", type=int, default=12)
    words.add_argument("--first", action="store_true")
    words.add_argument("--only", nargs="*", default=["aims", "parts", "kinds", "disk", "serve"])
    words = words.parse_args()
    listed = json.loads(words.soils.read_text())
    soils = {soil["id"]: soil["points_mm_percent"] for soil in listed}
    binary = words.binary.resolve()
    first = BEFORE_OTHERS if words.first else ()
    print(f"Instructions: {os.environ.get('VOIDWALK_ISA', 'the widest of the machine where none is named')}; {os.cpu_count()} processors; "
          f"the timed processes {'before all others' if words.first else 'beside all others'}.\n")
    if "aims" in words.only:
        aims(listed, [before.resolve() for before in [words.before] if before] + [binary], words, first)
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
        calls = {
            "judge": ["judge", *pair],
            "judge --quick": ["judge", *pair, "--quick"],
            "judge, three filters": ["judge", base, *others, "--quick"],
            "boundary": ["boundary", base, "--filter", of_filter],
            f"judge --each, {words.samples} samples and three filters": ["judge", work / "site.ags", *filters, "--each"],
        }

        if "parts" in words.only:
            load = Load()
            judged = {name: parts(binary, pair, work / "parts", words.turns, quick, first)
                      for name, quick in (("judge", []), ("judge --quick", ["--quick"]))}
            names = list(judged["judge"][2])
            print("| one thread | processor s (scatter) | " + " | ".join(names) + " |\n|---|---|" + "---|" * len(names))
            for name, (whole, scatter, of) in judged.items():
                cells = " | ".join(share_of(whole, scatter, *of[part]) for part in names)
                told = f"{scatter:.2f}" if words.turns > 1 else "not known"
                print(f"| {name} | {whole:.2f} ({told}) | {cells} |")
            print(load.line(f"; {words.turns} turns"), flush=True)

        if "kinds" in words.only and shutil.which("perf"):
            load, found = Load(), {}
            for number, (name, call) in enumerate(calls.items()):
                found[name] = kinds([*first, binary, *call, "--quiet", "--threads", "1", "--out", work / f"kinds-{number}"], work)
            heads = [f"{name} ({samples} samples)" for name, (samples, _) in found.items()]
            print("| kind of work | " + " | ".join(heads) + " |\n|---|" + "---|" * len(found))
            for kind in [kind for kind, _ in KINDS] + [OTHER]:
                least = [100 * FEWEST / max(1, samples) for samples, _ in found.values()]
                of = [shares[kind] for _, shares in found.values()]
                cells = [f"{share:.0f} %" if share >= few else f"< {few:.1g} %" for share, few in zip(of, least)]
                print(f"| {kind} | " + " | ".join(cells) + " |")
            print(load.line(), flush=True)

        if "disk" in words.only and shutil.which("strace"):
            load = Load()
            print("| all threads | waits for the disk | together, s |\n|---|---|---|")
            for number, (name, call) in enumerate(calls.items()):
                count, seconds = waits_for_disk([binary, *call, "--quiet", "--out", work / f"disk-{number}"])
                print(f"| {name} | {count} | {seconds:.3f} |")
            print(load.line(), flush=True)

        if "serve" in words.only:
            load, server = Load(), Server(binary, work)
            try:
                rows = {quick: [server.answers(pair, quick) for _ in range(words.turns)] for quick in (False, True)}
            finally:
                server.stop()
            print("| serve, all threads | rules, s | first class of the walk, s | page, s |\n|---|---|---|---|")
            for quick, turns in rows.items():
                print(f"| judge{' --quick' if quick else ''} | " + " | ".join(f"{median(column):.2f}" for column in zip(*turns)) + " |")
            print(load.line(f"; {words.turns} turns; the server beside all others"))


if __name__ == "__main__":
    main()
