#!/usr/bin/env python3
"""Kills voidwalk at random instants until its work ends, and compares the results with those of unbroken work.

    scripts/kill_runs.py [--program target/release/voidwalk] [--kills 1000] [--seed 1] [--starts 200]

Runs, resumes and packings are killed with SIGKILL after a random time, also while they write checkpoints, and go on. Every file
must then hold the bytes of the unbroken work, but for times and process numbers. Then many processes are started at once on one
folder: one may win, the others must leave within a second and name it. Python 3's standard library only.
"""

import argparse
import hashlib
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time

RUN = """seed = {seed}
replicates = 2
engine = "particles"
[filter]
curve = "shire2016-cu1.5-loose"
[base]
cu = 1.5
d85_at_dc = 5
n_base = 60000
[network]
nx = 8
ny = 8
nz = 10
[record]
sensitivity = [2.0]
sensitivity_replicates = 1
"""
PACKING = """[filter]
cu = 1.5
density = "loose"
[packing]
seed = {seed}
grains = 400
stiffness_ratio = 0.01
"""


def stripped(value):
    """JSON without what a clock says."""
    if isinstance(value, dict):
        return {k: stripped(v) for k, v in value.items() if k not in ("seconds", "made")}
    return [stripped(v) for v in value] if isinstance(value, list) else value


def lasting(folder):
    """Digest of every file of a finished folder."""
    found = {}
    for at, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(at, name)
            with open(path, "rb") as file:
                data = file.read()
            if name in (".voidwalk.lock", "manifest.json", "report.html"):
                data = b""
            elif name.endswith(".json"):
                data = json.dumps(stripped(json.loads(data))).encode()
            found[os.path.relpath(path, folder)] = hashlib.sha256(data).hexdigest()
    return found


def ended(program, at, words):
    done = subprocess.run([program, *words], cwd=at, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{words} ended with {done.returncode}: {done.stderr}")


class Work:
    def __init__(self, program, at, name, text, command, resumed):
        self.program, self.at, self.name = program, at, name
        self.command, self.resumed = command, resumed
        with open(os.path.join(at, f"{name}.toml"), "w") as file:
            file.write(text)
        begun = time.monotonic()
        ended(program, at, [w.replace("OUT", f"{name}-whole") for w in command])
        self.seconds = time.monotonic() - begun
        self.whole = lasting(os.path.join(at, f"{name}-whole"))

    def broken(self, chance, number, most, tally):
        """Starts the work again and again, each start but the last killed; gives the number of kills."""
        out = f"{self.name}-{number}"
        folder = os.path.join(self.at, out)
        kills = 0
        while True:
            begun = self.resumed and os.path.exists(os.path.join(folder, "scene.toml"))
            words = [w.replace("OUT", out) for w in (self.resumed if begun else self.command)]
            child = subprocess.Popen(
                [self.program, *words], cwd=self.at, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
            )
            if kills < most:
                # Short times as well as long ones, so that starts are hit while they still read.
                time.sleep(self.seconds * chance.random() ** 2)
                child.send_signal(signal.SIGKILL)
            text = child.communicate()[1]
            if child.returncode == -signal.SIGKILL:
                kills += 1
                tally["resumes" if begun else "first starts"] += 1
                left = [n for _, _, names in os.walk(folder) for n in names if n.startswith(".voidwalk-part-")]
                tally["while a file was being written"] += bool(left)
                continue
            if child.returncode == 2 and ("finished" in text or "holds a packing" in text):
                # Killed when all but the page was there.
                ended(self.program, self.at, ["report", out])
            elif child.returncode != 0:
                sys.exit(f"{words} ended with {child.returncode}: {text}")
            if lasting(folder) != self.whole:
                differ = {k for k in {**lasting(folder), **self.whole} if lasting(folder).get(k) != self.whole.get(k)}
                sys.exit(f"{out} differs from the unbroken work after {kills} kills: {sorted(differ)}")
            return kills


def kill(program, kills, seed):
    chance = random.Random(seed)
    total, works = 0, 0
    tally = {"first starts": 0, "resumes": 0, "while a file was being written": 0}
    by_kind = {"run": 0, "packing": 0}
    with tempfile.TemporaryDirectory() as at:
        run = Work(
            program, at, "run", RUN.format(seed=seed),
            ["run", "run.toml", "--out", "OUT", "-q", "--checkpoint-every", "10increments"],
            ["resume", "OUT", "-q", "--checkpoint-every", "3increments"],
        )
        packing = Work(
            program, at, "packing", PACKING.format(seed=seed),
            ["pack", "packing.toml", "--out", "OUT", "-q", "--checkpoint-every", "20ms"], None,
        )
        print(f"unbroken: run {run.seconds:.2f} s, packing {packing.seconds:.2f} s", flush=True)
        while total < kills:
            work = packing if works % 4 == 3 else run
            done = work.broken(chance, works, min(25, kills - total), tally)
            total, works = total + done, works + 1
            by_kind[work.name] += done
    print(f"{total} kills of {works} works ({by_kind}; {tally}): 0 results differ")


def race(program, starts, seed):
    with tempfile.TemporaryDirectory() as at:
        with open(os.path.join(at, "run.toml"), "w") as file:
            file.write(RUN.format(seed=seed).replace("60000", "20000000"))
        children = [
            subprocess.Popen(
                [program, "run", "run.toml", "--out", "one", "-q", "--threads", "1"],
                cwd=at, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
            )
            for _ in range(starts)
        ]
        losers = []
        deadline = time.monotonic() + 120
        while len(losers) < starts - 1 and time.monotonic() < deadline:
            for child in children:
                if child not in losers and child.poll() is not None:
                    losers.append(child)
            time.sleep(0.005)
        running = [child for child in children if child.poll() is None]
        assert len(running) == 1, f"{len(running)} of {starts} hold the folder"
        winner, named = running[0], 0
        for child in losers:
            text = child.stderr.read()
            assert child.returncode == 2, f"{child.returncode}: {text}"
            assert "another run writes to this folder" in text, text
            named += f"process {winner.pid} on" in text
        # How long a start takes to leave, the machine quiet again.
        begun = time.monotonic()
        late = subprocess.run(
            [program, "run", "run.toml", "--out", "one", "-q"], cwd=at, capture_output=True, text=True
        )
        seconds = time.monotonic() - begun
        assert late.returncode == 2 and f"process {winner.pid} on" in late.stderr, late.stderr
        winner.send_signal(signal.SIGTERM)
        begun = time.monotonic()
        code = winner.wait()
        assert code == 3, code
        print(
            f"{starts} starts at once: 1 wins, {len(losers)} leave with exit code 2, {named} of them naming it; another leaves within {seconds:.3f} s and names it; "
            f"SIGTERM ends the winner with a checkpoint and exit code 3 after {time.monotonic() - begun:.2f} s"
        )


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--program", default="target/release/voidwalk")
    words.add_argument("--kills", type=int, default=1000)
    words.add_argument("--seed", type=int, default=1)
    words.add_argument("--starts", type=int, default=200)
    words = words.parse_args()
    program = os.path.abspath(words.program)
    if words.starts:
        race(program, words.starts, words.seed)
    if words.kills:
        kill(program, words.kills, words.seed)


if __name__ == "__main__":
    main()
