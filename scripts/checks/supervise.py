#!/usr/bin/env python3
"""Harms every command of voidwalk that writes a folder, lets it go on, and compares the whole folder with that of unbroken work.

    scripts/checks/supervise.py [--kills 1000] [--seed 1] [--binary target/release/voidwalk] [--commands run pack ...]
    scripts/checks/supervise.py --kills 10000              # overnight
    scripts/checks/supervise.py --trial 1-run-17           # one trial again, by the name that a find gives it
    scripts/checks/supervise.py --python target/python/bin/python    # also works of the Python package that is installed there

A trial is one work that is harmed one to six times, each time in one of these ways, and is continued as a user would who does not
know how far it was (`resume`, or the same command); when it has ended well, every file of its folder is compared:

    kill      SIGKILL after a random time
    stop      SIGTERM, SIGINT, SIGHUP or SIGXCPU after a random time
    full      no file may grow beyond a random size (RLIMIT_FSIZE); as root also: a small disk (tmpfs) that is full, and gets room
    cut       a file of the unfinished folder is cut to a random length (not of
              results that are written but for their page: they have no sums)
    flip      one bit of a checkpoint changes
    other     a command of another kind is pointed at the unfinished folder: it must be refused, and change no file

A cut or changed file may be noticed and refused (exit code 1 or 2 with the file's name); then it is put back, and the work goes
on. Everything else must end in the folder of the unbroken work: the same names, the same bytes, but for times, host, threads and
command. Pages and figures are compared as `voidwalk report` makes them from records in which these are alike, and the page that
was left must be the one that its own files give. Ends at the first difference with exit code 1 and the name of the trial; else
prints a table. How a trial goes depends on its name, and on how quick the machine is. Python 3's standard library only; Linux.
"""

import argparse
import collections
import csv
import io
import json
import os
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SMALL = "[network]\nnx = 6\nny = 6\nnz = 8\n[record]\nsensitivity = [2.0]\nsensitivity_replicates = 1\n"
FILES = {
    "run.toml": 'seed = 3\nreplicates = 2\nengine = "particles"\n[filter]\ncurve = "shire2016-cu1.5-loose"\n[base]\ncu = 1.5\n'
    f"d85_at_dc = 5\nn_base = 40000\n{SMALL}",
    "files.toml": 'seed = 4\nreplicates = 2\nengine = "particles"\n[filter]\ncurve = "shire2016-cu1.5-loose"\nsieve = "filter.csv"\n'
    f'grains_per_void = 0.6\n[base]\nsieve = "base.csv"\nn_base = 40000\n{SMALL}',
    "packed.toml": 'seed = 5\nreplicates = 2\n[filter]\ncu = 1.5\ndensity = "loose"\n[packing]\ngrains = 200\nstiffness_ratio = 0.01\n'
    f"[base]\ncu = 1.5\nd85_at_dc = 5\nn_base = 4000\n{SMALL}",
    "pack.toml": '[filter]\ncu = 1.5\ndensity = "loose"\n[packing]\ngrains = 300\nstiffness_ratio = 0.01\n',
    "filter.csv": "opening_mm,percent_finer\n4,100\n2,50\n1,0\n",
    "other.csv": "opening_mm,percent_finer\n2,100\n1.4,50\n0.7,0\n",
    "base.csv": "opening_mm,percent_finer\n0.4,100\n0.2,50\n0.08,0\n",
    "samples.csv": "Sieve (mm),north,south\n0.4,100,100\n0.2,50,40\n0.08,0,0\n",
    "plan.toml": 'title = "two"\nseed = 5\n[set]\nreplicates = 2\nnetwork = { nx = 5, ny = 5, nz = 6 }\nbase = { n_base = 20000 }\n'
    'engine = "particles"\nrecord = { sensitivity = [] }\n[[factor]]\nname = "cu_b"\nsetting = "base.cu"\nvalues = [1.5, 3]\n',
}
EVERY = ["--checkpoint-every", "10increments"]
TABLES = ["--set", "replicates=2", "--set", "base.n_base=20000", "--set", "network.nx=5", "--set", "network.ny=5", "--set",
          "network.nz=6", "--set", "engine=particles", "--set", "record.sensitivity=[]"]
BOUNDARY = ["boundary", "base.csv", "--out", "r", "-q", "--set", "network.nx=5", "--set", "network.ny=5", "--set", "replicates=3"]
PERCOLATION = ["percolation", "--out", "r", "--sizes", "4,6,8", "--realisations", "40"]

# Command: the work; what was done in the folder before; the folders that are compared.
WORKS = {
    "run": (["run", "run.toml", "--out", "r", "-q", *EVERY], None, ["r"]),
    "run-files": (["run", "files.toml", "--out", "r", "-q", *EVERY], None, ["r"]),
    "run-packed": (["run", "packed.toml", "--out", "r", "-q", "--packings", "kept", *EVERY], None, ["r", "kept"]),
    "run-overwrite": (
        ["run", "files.toml", "--out", "r", "-q", "--overwrite", *EVERY],
        ["run", "packed.toml", "--out", "r", "-q", "--packings", "kept"],
        ["r"],
    ),
    "pack": (["pack", "pack.toml", "--out", "r", "-q", "--checkpoint-every", "20ms"], None, ["r"]),
    "pack-overwrite": (
        ["pack", "pack.toml", "--out", "r", "-q", "--seed", "7", "--overwrite", "--checkpoint-every", "20ms"],
        ["pack", "packed.toml", "--out", "r", "-q"],
        ["r"],
    ),
    "campaign": (["campaign", "plan.toml", "--out", "r", "-q", *EVERY], None, ["r"]),
    "judge": (["judge", "base.csv", "filter.csv", "--out", "r", "-q", *TABLES, *EVERY], None, ["r"]),
    "filters": (["judge", "base.csv", "filter.csv", "other.csv", "--out", "r", "-q", *TABLES, *EVERY], None, ["r"]),
    "batch": (["judge", "base.csv", "filter.csv", "other.csv", "--each", "--out", "r", "-q", *TABLES, *EVERY], None, ["r"]),
    "constrictions": (["constrictions", "grains.csv", "--out", "r"], None, ["r"]),
    "constrictions-overwrite": (
        ["constrictions", "grains.csv", "--out", "r", "--overwrite"], ["constrictions", "fewer.csv", "--out", "r"], ["r"]
    ),
    "percolation": (PERCOLATION, None, ["r"]),
    "percolation-overwrite": ([*PERCOLATION, "--overwrite"], [*PERCOLATION[:3], "--sizes", "5", "--realisations", "2"], ["r"]),
    "boundary": ([*BOUNDARY, "--thickness", "6layers"], None, ["r"]),
    "designs": (["design", "samples.csv", "--each", "--out", "r", "-q"], None, ["r"]),
    "specification": (["design", "base.csv", "--out", "r", "-q"], None, ["r"]),
    "boundary-overwrite": ([*BOUNDARY, "--thickness", "6layers", "--overwrite"], [*BOUNDARY, "--thickness", "5layers"], ["r"]),
}
# Works of the Python package, each line a call of its own; a run is resumed by the package or by the program.
PYTHON_WORKS = {
    "python-run": (["python", "run", "files.toml"], None, ["r"]),
    "python-campaign": (["python", "campaign", "plan.toml"], None, ["r"]),
}
PYTHON = """
import sys, voidwalk
call, file = sys.argv[1:]
more = {"checkpoint_every": "10increments"}
try:
    if call == "run":
        voidwalk.run(file, "r", **more)
    elif call == "campaign":
        voidwalk.campaign(file, "r", **more)
    else:
        voidwalk.resume(file, **more)
except ValueError as problem:
    sys.exit(print("refused:", problem, file=sys.stderr) or 2)
except voidwalk.VoidwalkError as problem:
    sys.exit(print("error:", problem, file=sys.stderr) or 1)
"""
WORKS |= PYTHON_WORKS
HARMS = ["kill", "kill", "kill", "kill", "kill", "stop", "full", "cut", "flip", "other"]

# What a record says of the clock, the machine and the call.
TIMES = {"seconds", "made", "threads", "host", "machine", "started", "finished", "command"}
LOCK, MARK, PART = ".voidwalk.lock", ".voidwalk.unfinished", ".voidwalk-part-"
RECORDS = [f"{name}.json" for name in "outcome packing percolation boundary specification constrictions batch designs case".split()]
PAGES = [f"{name}.html" for name in "report boundary specification batch designs".split()]


class Find(Exception):
    """What should not be."""


def grains(side):
    """Grains on a disturbed cubic lattice of so many each way, which fit their cell."""
    chance, step = random.Random(1), 5 / side
    places = [(x, y, z) for x in range(side) for y in range(side) for z in range(side)]
    rows = [",".join(f"{step * (at + 0.06 * chance.random()):.6f}" for at in place) + f",{0.93 * step:.6f}" for place in places]
    return "# cell_mm = 5, 5, 5\nx_mm,y_mm,z_mm,diameter_mm\n" + "\n".join(rows) + "\n"


def is_clear(done):
    """Whether work ended with an error that says what is wrong."""
    said = {1: "error: ", 2: "refused: "}.get(done.returncode, "\0")
    lines = done.stderr.strip().splitlines()
    return any(line.startswith((said, "error: ")) and len(line) > 20 for line in lines) and "panicked" not in done.stderr


def alike(value, name=None):
    """A record with the same times, host, threads and command as every other."""
    if name in TIMES and isinstance(value, (str, int, float)):
        return "alike" if isinstance(value, str) else 1
    if isinstance(value, dict):
        if str(value.get("name", "")).endswith("packing.json") and "xxh3" in value:
            # A sum over a record with times in it.
            value = {**value, "xxh3": "alike"}
        return {key: alike(inner, key) for key, inner in value.items()}
    return [alike(inner) for inner in value] if isinstance(value, list) else value


def made_alike(name, data):
    if name == LOCK:
        return b""
    if name.endswith((".json", ".jsonl")):
        text = data.decode(errors="replace")
        try:
            values = [json.loads(line) for line in (text.splitlines() if name.endswith(".jsonl") else [text])]
        except json.JSONDecodeError:
            return data  # harmed: like no other
        return "\n".join(json.dumps(alike(value)) for value in values).encode()
    if name.endswith(".csv") and TIMES & set(data.split(b"\n", 1)[0].decode(errors="replace").split(",")):
        rows = list(csv.reader(io.StringIO(data.decode())))
        clock = {at for at, column in enumerate(rows[0]) if column in TIMES}
        for row in rows[1:]:
            row[:] = ["1" if at in clock and cell else cell for at, cell in enumerate(row)]
        return "\n".join(",".join(row) for row in rows).encode()
    return data


def files_of(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in pathlib.Path(folder).rglob("*") if path.is_file()}


class Supervisor:
    def __init__(self, binary, python, at):
        self.binary, self.python, self.at = binary, python, at
        self.ready = {}  # command: files to begin with, what unbroken work leaves, what was there before, seconds
        self.count = collections.Counter()  # by command, harm and what came of it
        self.notes = {}

    def program(self, words):
        """The program that these words are for, with them."""
        return [self.python, "-c", PYTHON, *words[1:]] if words[0] == "python" else [self.binary, *words]

    def call(self, words, at, **more):
        return subprocess.run(self.program(words), cwd=at, capture_output=True, text=True, errors="replace", timeout=600, **more)

    def must(self, words, at):
        done = self.call(words, at)
        if done.returncode != 0:
            raise Find(f"{' '.join(words)} ended with {done.returncode}: {done.stderr}")

    def whole(self, at, folders):
        """Every file of finished folders, with times, host, threads and command alike; pages and figures made of such records."""
        found = {}
        for folder in folders:
            for inside in sorted({os.path.dirname(os.path.join(folder, f)) for f in files_of(os.path.join(at, folder))}):
                found.update(self.pages(at, inside))
            for name, data in files_of(os.path.join(at, folder)).items():
                if os.path.basename(name) not in PAGES and "figures" not in pathlib.Path(name).parts:
                    found[os.path.join(folder, name)] = made_alike(os.path.basename(name), data)
        return found

    def pages(self, at, inside):
        """Page and figures of one folder, if it has a page."""
        own = os.path.join(at, inside)
        page = [name for name in PAGES if os.path.isfile(os.path.join(own, name))]
        if not page:
            return {}
        with tempfile.TemporaryDirectory(dir=self.at) as room:
            copy = os.path.join(room, os.path.basename(inside))
            shutil.copytree(own, copy)
            shown = lambda folder: {name: data for name, data in files_of(folder).items() if name in PAGES or name.startswith("figures/")}
            self.must(["report", os.path.basename(inside)], room)
            if shown(copy) != shown(own):
                differ = [n for n in shown(copy) if shown(copy)[n] != shown(own).get(n)]
                raise Find(f"the page of {inside} is not that of its files: {differ}")
            for name, data in files_of(copy).items():
                if name.endswith((".json", ".jsonl")):
                    pathlib.Path(copy, name).write_bytes(made_alike(os.path.basename(name), data))
            self.must(["report", os.path.basename(inside)], room)
            return {os.path.join(inside, name): data for name, data in shown(copy).items()}

    def prepare(self, command):
        work, before, folders = WORKS[command]
        at = os.path.join(self.at, f"{command}-unbroken")
        os.mkdir(at)
        for name, text in {**FILES, "grains.csv": grains(9), "fewer.csv": grains(7)}.items():
            pathlib.Path(at, name).write_text(text)
        if before:
            self.must(before, at)
        begin = os.path.join(self.at, f"{command}-begin")
        shutil.copytree(at, begin)
        old = self.whole(at, ["r"]) if before else None
        begun = time.monotonic()
        self.must(work, at)
        seconds = time.monotonic() - begun
        self.ready[command] = (begin, self.whole(at, folders), old, seconds)
        files = files_of(os.path.join(at, "r"))
        self.notes[command] = f"{seconds:.2f} s, {len(files)} files, {sum(map(len, files.values())) / 1e6:.1f} MB"
        shutil.rmtree(at)

    def trial(self, command, seed, most):
        """One work from its beginning to its end; gives the number of harms."""
        chance = random.Random(f"{seed}")
        begin, expected, old, seconds = self.ready[command]
        at = os.path.join(self.at, "trial")
        shutil.rmtree(at, ignore_errors=True)
        shutil.copytree(begin, at)
        log = []
        try:
            harms = Trial(self, command, at, chance, seconds, old, log).harmed(min(most, chance.randint(1, 6)))
            found = self.whole(at, WORKS[command][2])
            differ = sorted(name for name in {**found, **expected} if found.get(name) != expected.get(name))
            if differ:
                raise Find(f"these differ from unbroken work: {differ}")
            left = [name for name in files_of(at) if PART in name]
            if left:
                raise Find(f"left over: {left}")
            return harms
        except Find as find:
            kept = tempfile.mkdtemp(prefix=f"voidwalk-{command}-")
            shutil.copytree(at, kept, dirs_exist_ok=True)
            raise Find(f"trial {seed}: {find}; harms: {', '.join(log) or 'none'}; kept in {kept}") from None


class Trial:
    def __init__(self, supervisor, command, at, chance, seconds, old, log):
        self.all, self.command, self.at, self.chance, self.seconds, self.old = supervisor, command, at, chance, seconds, old
        self.out = os.path.join(at, "r")
        self.is_campaign = command.endswith("campaign")
        self.log = log

    def words(self):
        """What a user calls who does not know how far it was."""
        work = WORKS[self.command][0]
        if self.old is not None and self.is_old():
            return work
        if not ({"run", "judge"} & set(work) and os.path.isfile(os.path.join(self.out, "scene.toml"))):
            return [word for word in work if word != "--overwrite"]
        if work[0] == "python" and self.chance.random() < 0.5:
            return ["python", "resume", "r"]
        return ["resume", "r", "-q"] + (["--checkpoint-every", "5increments"] if self.chance.random() < 0.3 else [])

    def is_old(self):
        """Whether what was there before is still there, whole."""
        if os.path.exists(os.path.join(self.out, MARK)):
            return False
        try:
            return self.all.whole(self.at, ["r"]) == self.old
        except (Find, FileNotFoundError):
            return False

    def is_begun(self):
        return os.path.isdir(self.out) and os.path.exists(os.path.join(self.out, MARK)) or self.is_campaign

    def did(self, harm, how, what=""):
        self.all.count[self.command, harm, how] += 1
        self.log.append(f"{harm}: {how}{what}")

    def find(self, what, done=None):
        said = f" (exit {done.returncode}: {done.stderr.strip()[-600:]})" if done else ""
        raise Find(f"{what}{said}")

    def is_done(self):
        """Whether a kill came when the last file had been written and the mark was gone."""
        has = lambda name: os.path.exists(os.path.join(self.out, name))
        # Of a run that is replaced the scene goes first, and its record a moment later.
        whole = any(map(has, RECORDS)) and has("scene.toml") >= has("outcome.json")
        return not self.is_campaign and not has(MARK) and whole and not (self.old and self.is_old())

    def harmed(self, wanted):
        """Harms the work so many times, unless it ends before; the number of harms."""
        for harms in range(1, wanted + 1):
            harm = self.chance.choice(HARMS)
            if harm in ("cut", "flip", "other") and not self.is_begun():
                # Something must have begun.
                ended = self.kill("kill")
                if not ended and self.is_begun():
                    ended = getattr(self, harm)(harm)
            else:
                ended = getattr(self, harm)(harm)
            if ended or self.is_done():
                return harms
        words = self.words()
        done = self.all.call(words, self.at)
        if done.returncode != 0:
            self.find(f"{' '.join(words)} did not end well", done)
        return wanted

    def signalled(self, number):
        """Sends a signal after a random time, short ones as well as long ones; gives the exit code and what was said."""
        words = self.words()
        child = subprocess.Popen(self.all.program(words), cwd=self.at, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                                 errors="replace")
        time.sleep(1.05 * self.seconds * self.chance.random() ** 2)
        child.send_signal(number)
        said = child.communicate(timeout=600)[1]
        return subprocess.CompletedProcess(words, child.returncode, "", said)

    def kill(self, harm):
        done = self.signalled(signal.SIGKILL)
        if done.returncode == 0:
            self.did(harm, "had ended")
            return True
        if done.returncode != -signal.SIGKILL:
            self.find("before the kill", done)
        parts = any(PART in name for name in files_of(self.at))
        self.did(harm, "while a file was written" if parts else "killed")
        return False

    def stop(self, harm):
        number = self.chance.choice([signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGXCPU])
        done = self.signalled(number)
        if done.returncode == 0:
            self.did(harm, "had ended")
            return True
        # Before the program listens, and in short work, a signal ends it.
        if done.returncode not in (3, -number):
            self.find(f"after {signal.Signals(number).name}", done)
        self.did(harm, "stopped" if done.returncode == 3 else "ended by it")
        return False

    def full(self, harm):
        if os.geteuid() == 0 and self.chance.random() < 0.5:
            return self.small_disk(harm)
        most = int(2 ** self.chance.uniform(0, 20))
        core = lambda: (resource.setrlimit(resource.RLIMIT_FSIZE, (most, most)), resource.setrlimit(resource.RLIMIT_CORE, (0, 0)))
        done = self.all.call(self.words(), self.at, preexec_fn=core)
        return self.refused(harm, f"no file above {most} bytes", done)

    def small_disk(self, harm):
        """The folder moves to a disk that is nearly full; what it leaves there moves back."""
        words = self.words()
        held = os.path.join(self.at, "held")
        begun = os.path.isdir(self.out)
        if begun:
            os.rename(self.out, held)
        os.mkdir(self.out)
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64m", "tmpfs", self.out], capture_output=True)
        if mounted.returncode != 0:
            os.rmdir(self.out)
            if begun:
                os.rename(held, self.out)
            return False
        try:
            if begun:
                shutil.copytree(held, self.out, dirs_exist_ok=True)
            state = os.statvfs(self.out)
            free = int(2 ** self.chance.uniform(0, 9)) * state.f_bsize
            with open(os.path.join(self.out, "ballast"), "wb") as ballast:
                os.posix_fallocate(ballast.fileno(), 0, state.f_bavail * state.f_frsize - free)
            if not begun:
                pathlib.Path(self.out, LOCK).touch()
            done = self.all.call(words, self.at)
            os.remove(os.path.join(self.out, "ballast"))
            back = os.path.join(self.at, "back")
            shutil.copytree(self.out, back)
        finally:
            subprocess.run(["umount", self.out], check=True)
            os.rmdir(self.out)
        shutil.rmtree(held, ignore_errors=True)
        os.rename(back, self.out)
        return self.refused(harm, "disk full", done)

    def refused(self, harm, what, done):
        """Whether work that had too little room ended all the same; else it must have said why."""
        if done.returncode == 0:
            self.did(harm, "had room")
            return True
        if not is_clear(done):
            self.find(what, done)
        self.did(harm, "ended with an error")
        return False

    def cut(self, harm):
        # Results that are written have no sums: once a record is there, only the record itself is looked at again.
        written = {os.path.dirname(name): name for name in sorted(files_of(self.out), reverse=True) if os.path.basename(name) in RECORDS}
        under = lambda name: next((r for at, r in written.items() if name.startswith(f"{at}/" if at else "")), None)
        # What was there before and stays as it was, as a finished case that is no part of this work, is nobody's to look at.
        expected = self.all.ready[self.command][1]
        stays = lambda name: self.old is not None and self.old.get(f"r/{name}", 0) == expected.get(f"r/{name}", 1)
        is_looked_at = lambda name: os.path.basename(name) != LOCK and under(name) in (None, name) and not stays(name)
        return self.changed(harm, is_looked_at, lambda data: data and data[: self.chance.randrange(len(data))])

    def flip(self, harm):
        is_checkpoint = lambda name: os.path.basename(os.path.dirname(name)) == "checkpoint" or name[-2:] in (".0", ".1")

        def flipped(data):
            at = self.chance.randrange(8 * max(len(data), 1))
            return data and data[: at // 8] + bytes([data[at // 8] ^ 1 << at % 8]) + data[at // 8 + 1 :]

        return self.changed(harm, lambda name: is_checkpoint(name) and PART not in name, flipped)

    def changed(self, harm, may, change):
        """A file that may change does. It is noticed and refused, and put back; or the work ends as unbroken work does."""
        names = sorted(filter(may, files_of(self.out)))
        if not names:
            return False
        name = self.chance.choice(names)
        path, before, words = pathlib.Path(self.out, name), files_of(self.at), self.words()
        data = path.read_bytes()
        path.write_bytes(change(data))
        done = self.all.call(words, self.at)
        if done.returncode == 0:
            self.did(harm, "went on", f" ({name})")
            return True
        if not is_clear(done):
            self.find(f"{harm} of {name}", done)
        after = files_of(self.at)
        # The user puts it back; but for the file itself, a refusal has changed nothing that cannot be made again.
        lost = [n for n in before if n not in after and os.path.basename(n) != LOCK and PART not in n]
        if done.returncode == 2 and lost:
            self.find(f"{harm} of {name} was refused, and files are gone: {lost}", done)
        self.did(harm, "refused", f" ({name})")
        path.write_bytes(data)
        return False

    def other(self, harm):
        kinds = {
            "run": ["run", "run.toml", "--out", "r", "-q"],
            "pack": ["pack", "pack.toml", "--out", "r", "-q"],
            "campaign": ["campaign", "plan.toml", "--out", "r", "-q"],
            "batch": ["judge", "base.csv", "filter.csv", "--each", "--out", "r", "-q", *TABLES],
            "constrictions": ["constrictions", "fewer.csv", "--out", "r"],
            "percolation": ["percolation", "--sizes", "3", "--realisations", "2", "--out", "r"],
            "boundary": BOUNDARY,
            "designs": ["design", "samples.csv", "--each", "--out", "r", "-q"],
        }
        if not os.path.exists(os.path.join(self.out, MARK)) and not self.is_campaign:
            return False
        if self.is_campaign and not os.path.isdir(os.path.join(self.out, "cases")):
            return False
        own = next(word for word in WORKS[self.command][0] if word != "python").replace("judge", "run")
        # Folders of these kinds are made by commands that also make others.
        own = {"filters": "batch", "batch": "batch", "designs": "designs", "specification": "specification"}.get(self.command, own)
        other = self.chance.choice(sorted(set(kinds) - {own}))
        more = ["--overwrite"] if other != "campaign" and self.chance.random() < 0.5 else []
        kept = lambda: {n: d for n, d in files_of(self.out).items() if os.path.basename(n) != LOCK and PART not in n}
        before = kept()
        done = self.all.call([*kinds[other], *more], self.at)
        if done.returncode != 2 or "holds a" not in done.stderr:
            self.find(f"{other} into the unfinished folder of {own}", done)
        if kept() != before:
            self.find(f"{other} was refused and changed the folder of {own}", done)
        self.did(harm, "refused")
        return False


def table(supervisor, commands, trials, works):
    """What came of the harms, by command and by harm, as two tables in Markdown."""
    hows = ["killed", "while a file was written", "stopped", "ended by it", "ended with an error", "had room", "went on", "refused",
            "had ended"]
    rows = lambda place, key: [sum(n for of, n in supervisor.count.items() if of[place] == key and of[2] == how) for how in hows]
    line = lambda *cells: print("| " + " | ".join(map(str, cells)) + " |")
    print()
    line("command", "unbroken", "works", "harms", *hows)
    print("|---" * (len(hows) + 4) + "|")
    for command in commands:
        line(command, supervisor.notes[command], works[command], trials[command], *rows(0, command))
    print()
    line("harm", *hows)
    print("|---" * (len(hows) + 1) + "|")
    for harm in sorted({harm for _, harm, _ in supervisor.count}):
        line(harm, *rows(1, harm))


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--binary", default=str(ROOT / "target/release/voidwalk"))
    words.add_argument("--python", help="interpreter in which the package is installed: its works too")
    words.add_argument("--kills", type=int, default=1000, help="harms in all")
    words.add_argument("--seed", type=int, default=1)
    words.add_argument("--commands", nargs="+", choices=list(WORKS), metavar="COMMAND", help="these works alone")
    words.add_argument("--trial", help="SEED-COMMAND-NUMBER: this one alone")
    words = words.parse_args()
    if words.trial:
        words.commands = [words.trial.split("-", 1)[1].rsplit("-", 1)[0]]
    words.commands = words.commands or [c for c in WORKS if words.python or c not in PYTHON_WORKS]
    if not words.python and set(words.commands) & set(PYTHON_WORKS):
        sys.exit("say --python INTERPRETER for works of the package")
    # In memory, where that can be.
    room = "/dev/shm" if os.path.isdir("/dev/shm") else None
    trials, works = ({command: 0 for command in words.commands} for _ in range(2))
    begun = time.monotonic()
    with tempfile.TemporaryDirectory(dir=room) as at:
        supervisor = Supervisor(os.path.abspath(words.binary), words.python and os.path.abspath(words.python), at)
        try:
            for command in words.commands:
                supervisor.prepare(command)
            if words.trial:
                supervisor.trial(words.commands[0], words.trial, 6)
                return
            number = 0
            while sum(trials.values()) < words.kills:
                # The command that was harmed least, so that each gets its share.
                command = min(words.commands, key=lambda c: trials[c])
                left = words.kills - sum(trials.values())
                trials[command] += supervisor.trial(command, f"{words.seed}-{command}-{number}", left)
                works[command] += 1
                number += 1
        except Find as find:
            print(f"seed {words.seed}: {find}", file=sys.stderr)
            sys.exit(1)
    seconds = time.monotonic() - begun
    print(f"seed {words.seed}: {sum(trials.values())} harms in {sum(works.values())} works, {seconds:.0f} s: 0 folders differ")
    table(supervisor, words.commands, trials, works)


if __name__ == "__main__":
    main()
