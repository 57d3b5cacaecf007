#!/usr/bin/env python3
"""Fifty samples against three filters: one table in under a minute; killed and continued, the same to the byte.

    scripts/checks/batch.py [--binary target/release/voidwalk] [--curves FILE.json] [--samples 50] [--kills 5] [--seed 38] [--most 60]
    scripts/checks/batch.py --curves ../../shared/soils/real_curves.json      # real soils; without it soils are made up

An AGS4 file of drawn samples and three sheets of filters are written into a folder of /tmp. `voidwalk judge SAMPLES FILTERS --each`
is timed; then the same work is done again in another folder, where the program is killed (SIGKILL) at drawn moments and called again
until it ends. Another sample and another filter must be refused (exit code 2), and the same command must give the table at once.
The exit code is 1 where two tables differ by a byte, where one took longer than --most seconds, where no kill met a running
program, where a walk that was done is done again, or where anything else is not as said.
"""

import argparse
import json
import math
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]

# Percent finer of a graded filter at multiples of its D15.
FILTER = [(8, 100), (4, 80), (2, 50), (1, 15), (0.6, 3), (0.4, 0)]
D15F_MM = {"fine": 0.3, "usual": 0.6, "coarse": 2.0}
SIEVES_MM = [0.002, 0.006, 0.02, 0.063, 0.15, 0.212, 0.425, 0.6, 1.18, 2, 4.75, 10, 20, 37.5, 75]

# What a folder says of a batch; its page is made of the record.
TABLES = ("batch.csv", "batch.json", "batch.html")


def made_up(draw):
    """A soil between a clayey silt and a gravelly sand, after Rosin and Rammler."""
    size, exponent = math.exp(draw.uniform(math.log(0.03), math.log(3))), draw.uniform(0.35, 0.9)
    points = [(mm, 100 * (1 - math.exp(-((mm / size) ** exponent)))) for mm in SIEVES_MM]
    top = draw.choice([mm for mm in SIEVES_MM if mm >= 10])
    return [(mm, min(100.0, percent)) for mm, percent in points if mm < top] + [(top, 100.0)]


def write_samples(path, soils):
    lines = ['"GROUP","PROJ"', '"HEADING","PROJ_ID"', '"DATA","P1"', ""]
    lines += ['"GROUP","GRAT"', '"HEADING","LOCA_ID","SAMP_TOP","SPEC_DPTH","GRAT_SIZE","GRAT_PERP","GRAT_TYPE"']
    lines += ['"UNIT","","m","m","mm","%",""', '"TYPE","ID","2DP","2DP","3SF","1DP","PA"']
    for number, soil in enumerate(soils, 1):
        rows = sorted(soil, reverse=True)
        lines += [f'"DATA","BH{number}","1.50","1.50","{mm:g}","{percent:.1f}","WS"' for mm, percent in rows]
    path.write_text("\r\n".join(lines) + "\r\n")


def write_filter(path, d15_mm):
    rows = "".join(f"{factor * d15_mm:g},{percent}\n" for factor, percent in FILTER)
    path.write_text("opening_mm,percent_finer\n" + rows)


def call(words, at, wanted=0):
    """Calls the program; ends this one where it does not end as it must."""
    done = subprocess.run(words, cwd=at, capture_output=True, text=True)
    if done.returncode != wanted:
        sys.exit(f"exit code {done.returncode}, not {wanted}: {' '.join(words)}\n{done.stderr}")
    return done


def tables(folder):
    return {name: (folder / name).read_bytes() for name in TABLES}


def walks(folder):
    """Every walk that is done: when its outcome was written. It is done with `case.json`, which comes last."""
    done = sorted((folder / "pairs/cases").glob("*/case.json"))
    return {path: path.with_name("outcome.json").stat().st_mtime_ns for path in done}


def killed(words, at, moments, place):
    """The same work, killed after each of these seconds where it still runs; how often it was."""
    kills, done = 0, {}
    for seconds in moments:
        process = subprocess.Popen(words, cwd=at, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        try:
            process.wait(timeout=seconds)
            break
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            kills += 1
        now = walks(place)
        if any(now.get(path) != when for path, when in done.items()):
            sys.exit("a walk that was done before a kill was done again")
        done = now
    call(words, at)
    if any(walks(place).get(path) != when for path, when in done.items()):
        sys.exit("a walk that was done before a kill was done again")
    return kills


def main():
    words = argparse.ArgumentParser()
    words.add_argument("--binary", default=str(ROOT / "target/release/voidwalk"))
    words.add_argument("--curves", help="JSON: a list of soils, each with points_mm_percent")
    words.add_argument("--samples", type=int, default=50)
    words.add_argument("--kills", type=int, default=5)
    words.add_argument("--seed", type=int, default=38)
    words.add_argument("--most", type=float, default=60, help="seconds that the table may take")
    words.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="settings of the walks")
    words = words.parse_args()
    draw = random.Random(words.seed)
    if words.curves:
        soils = draw.sample(json.loads(pathlib.Path(words.curves).read_text()), words.samples)
        soils = [soil["points_mm_percent"] for soil in soils]
    else:
        soils = [made_up(draw) for _ in range(words.samples)]
    binary = str(pathlib.Path(words.binary).resolve())
    with tempfile.TemporaryDirectory() as at:
        at = pathlib.Path(at)
        write_samples(at / "site.ags", soils)
        filters = [f"{name}.csv" for name in D15F_MM]
        for name, d15_mm in D15F_MM.items():
            write_filter(at / f"{name}.csv", d15_mm)
        settings = [word for setting in words.set for word in ("--set", setting)]

        def judge(out, samples="site.ags", of=filters):
            return [binary, "judge", samples, *of, "--each", "--out", out, *settings]

        begun = time.monotonic()
        call([binary, "rules", "site.ags", *filters, "--each"], at)
        of_rules = time.monotonic() - begun
        begun = time.monotonic()
        call(judge("whole"), at)
        seconds = time.monotonic() - begun
        whole = tables(at / "whole")
        rows = whole["batch.csv"].decode().splitlines()[1:]
        walked = sum(",not walked," not in row for row in rows)
        print(f"{words.samples} samples, {len(filters)} filters: rules {of_rules:.2f} s; {walked} of {len(rows)} pairs walked in {seconds:.1f} s")
        moments = [draw.uniform(0, 1.2 * seconds / max(1, words.kills)) for _ in range(words.kills)]
        kills = killed(judge("killed"), at, moments, at / "killed")
        differ = [name for name, content in tables(at / "killed").items() if content != whole[name]]
        print(f"killed {kills} times and continued: {'differ: ' + ', '.join(differ) if differ else 'the same to the byte'}")
        stood = walks(at / "whole")
        begun = time.monotonic()
        call(judge("whole"), at)
        again = time.monotonic() - begun
        print(f"the same command again: {again:.1f} s")
        wrong = []
        if words.kills and not kills:
            wrong.append("the program was never killed before it ended")
        if again > max(1.0, 0.2 * seconds):
            wrong.append("the same command again took as long as walks take")
        if not stood or walks(at / "whole") != stood:
            wrong.append("the same command walked again")
        write_samples(at / "other.ags", soils[:-1] + [made_up(draw)])
        call(judge("whole", samples="other.ags"), at, 2)
        call(judge("whole", of=filters[:-1]), at, 2)
        call(judge("whole") + ["--set", "seed=2"], at, 2)
        changed = tables(at / "whole") != whole or walks(at / "whole") != stood
        print(f"other samples, filters and settings: refused, {'and the table changed' if changed else 'and nothing changed'}")
        late = seconds > words.most
        if late:
            print(f"more than {words.most:g} s")
        for problem in wrong:
            print(problem)
        sys.exit(1 if differ or changed or late or wrong else 0)


if __name__ == "__main__":
    main()
