#!/usr/bin/env python3
"""Works small scenes and sees that no number of any result has changed, to the last bit.

    scripts/checks/same_bits.py --binary target/release/voidwalk record results/same-bits.json
    scripts/checks/same_bits.py --binary target/release/voidwalk check results/same-bits.json
    scripts/checks/same_bits.py --binary target/release/voidwalk --isa avx2 check results/same-bits.json

For changes of the code that must change no result. `record` writes down what the program gives; `check` works the same scenes and says of
each `same` or what differs, with exit code 1 where anything does. Some scenes only vary another in a way that may change nothing (threads,
instructions, mapped columns, a kill, the run's own scene.toml): they have no record of their own, and `record` too fails where they give
anything else than the one they vary.

Compared are every byte of CSV files, and every number of JSON files, with true, false, null and the words that are results (WORDS). Left
out are times; names, notes and other text, pages and figures; rules of practice, which grow in number and have tests of their own; the
settings that packing.json repeats; manifests, fingerprints and ledgers, which say who worked when.

The record holds the first 16 digits of the SHA-256 of each of these. Of JSON it holds the numbers too, so that `check` can say which
differ; of lists longer than ROWS only a hash. `--keep` keeps the files, to look at what differs in a CSV file. Recorded on x86-64 Linux.
"""

import argparse
import csv
import datetime
import hashlib
import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import time

SMALL = """seed = 11
replicates = 2
[filter]
curve = "shire2016-cu1.5-loose"
[base]
cu = 1.5
d85_at_dc = 5
[network]
nx = 10
ny = 10
nz = 16
[record]
sensitivity = []
"""

# Runs: what each sets in the scene above.
MANY = ["base.cu=3"]  # enough particles an increment that `auto` takes counts
# A law of arching at the concentration that its scenes were recorded with.
SUSPENSION = ["walk.arching=marin-2018", "walk.concentration=0.0121580547112462"]
FEW_GRAINS = ["packing.grains=300", "packing.stiffness_ratio=0.01", "filter.cu=1.5"]
LITTLE = ["network.nx=8", "network.ny=8", "network.nz=10"]
RUNS = {
    "auto takes particles": [],
    "auto takes counts": MANY,
    "counts": ["engine=counts", *MANY],
    "particles": ["engine=particles", "base.cu=2"],
    "expected": ["engine=expected", *MANY],
    "stratified counts": ["engine=counts", "sampling=stratified", *MANY],
    "stratified particles": ["engine=particles", "sampling=stratified"],
    "stratified expected": ["engine=expected", "sampling=stratified", *MANY],
    "one run": ["runs=1", "replicates=3"],
    "one replicate": ["replicates=1", "engine=counts"],
    "a base that is held": ["base.d85_at_dc=60"],
    "a wide base": ["base.cu=6", "base.d85_at_dc=50", "base.mass_ratio=0.02"],
    "base by d85_mm": ["filter.d0_mm=2.5", "base.d85_mm=0.55"],
    "base by Dc of another filter": ["filter.curve=shire2016-cu1.5-dense", "base.d85_at_dc=7.5", "base.dc_curve=shire2016-cu1.5-loose"],
    "base by D15F/D85B": ["base.d15f_over_d85b=5.2"],
    "base of one size": ["base.single_mm=0.21"],
    "base of one size, counts": ["base.single_mm=0.15", "engine=counts"],
    "base by sieve": ["filter.d0_mm=2", "base.sieve=base.csv"],
    "base by sieve with a tail": ["filter.d0_mm=2", "base.sieve=tail.csv", "engine=counts"],
    "base by sieve with a given end": ["filter.d0_mm=2", "base.sieve=tail.csv", "base.d0_mm=0.12", "base.mass_ratio=0.02"],
    "filter by sieve and curve file": [
        "filter.curve=curve_mm.csv", "filter.sieve=filter.csv", "filter.grains_per_void=0.6", "base.sieve=base.csv",
    ],
    "filter by sieve with a given end": [
        "filter.curve=curve_mm.csv", "filter.sieve=open.csv", "filter.d0_mm=1.8", "filter.grains_per_void=0.6", "base.d85_mm=0.45",
    ],
    "filter by curve over D0F": ["filter.curve=curve_d0f.csv", "filter.cu=1.8", "filter.d0_mm=1.7", "filter.grains_per_void=0.5"],
    "filter Cu 3": ["filter.curve=cu3-loose", "base.mass_ratio=0.02"],
    "filter Cu 6 in mm": ["filter.curve=cu6-friction0.7", "filter.d0_mm=0.8", "base.mass_ratio=0.01"],
    "filter guessed": ["filter.estimate=0.3", "filter.cu=1.5", "filter.grains_per_void=0.6"],
    "filter by sieve guessed": ["filter.estimate=1", "filter.sieve=filter.csv", "filter.grains_per_void=0.5", "base.mass_ratio=0.02"],
    "filter packed loose": ["filter.density=loose", *FEW_GRAINS],
    "filter packed by friction": [
        "filter.friction=0.15", *FEW_GRAINS[:2], "filter.sieve=narrow.csv", "packing.seed=5", "packing.final_friction=0.3",
        "packing.pressure_kpa=100", "packing.merge_overlap=0.3",
    ],
    "connectivity of Table 3": ["network.connectivity=table3"],
    "connectivity of one's own, counts": ["network.connectivity={ 5 = 25, 6 = 50, 7 = 25 }", "engine=counts"],
    "network from a file": ["network.file=network.csv", "base.single_mm=0.3", "base.n_base=40000"],
    "network from a file, counts": ["network.file=network.csv", "base.cu=3", "base.d85_mm=0.4", "base.n_base=40000", "engine=counts"],
    "network from a file, stratified": [
        "network.file=network.csv", "base.cu=2", "base.d85_mm=0.4", "base.n_base=10000", "sampling=stratified",
    ],
    "stop at an error": ["stop.target_error_pp=2.5", "stop.most_replicates=40"],
    "stop when decided": ["stop.decide_percent=99", "base.d85_at_dc=35"],
    "stop at an error when decided": ["stop.target_error_pp=0.5", "stop.decide_percent=95", "base.d85_at_dc=40"],
    "stop undecided": ["stop.decide_percent=99.9", "stop.most_replicates=12", "runs=1", "base.d85_at_dc=22"],
    "cap": ["base.cap=20000"],
    "n_base": ["base.n_base=30000"],
    "inject_share": ["inject_share=0.05"],
    "record": ["record.series_every=7", "record.size_curves=[3, 20]", "record.size_classes=20"],
    "record the end only": ["record.series_every=0", "record.size_curves=[]"],
    "sensitivity": ["record.sensitivity=[0.5, 2]", "record.sensitivity_replicates=2"],
    "water on the lattice": ["walk.exit=flux", "base.cu=2"],
    "water on the lattice, counts": ["walk.exit=flux", "engine=counts", *MANY],
    "water on the lattice, expected": ["walk.exit=flux", "engine=expected", *MANY],
    "water through a thick lattice": ["walk.exit=flux", "network.nz=160"],
    "area along the water": ["walk.exit=area-along-flow", "base.cu=2"],
    "water on the packing's own voids": ["filter.density=loose", *FEW_GRAINS, "network.kind=graph", "walk.exit=flux", "base.mass_ratio=0.02"],
    "arches": [*SUSPENSION, "base.d15f_over_d85b=7"],
    "arches, counts": ["walk.arching=zuriguel-2005", "engine=counts", "base.cu=3", "base.d15f_over_d85b=14"],
    "arches, more than one keeps": ["walk.arching=critical-3", "inject_share=0.2", "base.d15f_over_d85b=9"],
    "arches, water on the lattice": [*SUSPENSION, "walk.exit=flux", "base.d15f_over_d85b=6"],
    "openings": ["walk.blocked=open", "base.cu=2"],
    "openings and arches": ["walk.blocked=open", *SUSPENSION, "base.d15f_over_d85b=7"],
    "studies that stop": ["replicates=8", "record.sensitivity=[0.5, 2]"],
}

# Packings. The last sets all but two settings, whose names may change.
PACKINGS = {
    "pack dense": ["filter.density=dense", *FEW_GRAINS],
    "pack loose": ["filter.friction=0.3", *FEW_GRAINS, "packing.grains=400"],
    "pack intermediate": ["filter.density=intermediate", *FEW_GRAINS, "filter.cu=2"],
    "pack with other settings": ["filter.friction=0.2", *FEW_GRAINS, *(f"packing.{one}" for one in [
        "seed=3", "final_friction=0.1", "pressure_kpa=80", "shear_modulus_gpa=20", "poisson_ratio=0.25", "density_kg_m3=2500",
        "restitution=0.6", "drag=0.04", "local_damping=0.05", "start_fraction=0.3", "squeeze_rate=0.012", "servo_rate=0.003",
        "servo_gain=0.02", "mass_exponent=0.8", "step_fraction=0.6", "hold_steps=3000", "max_steps=300000", "merge_overlap=0.2",
    ])],
}

# Variants of a run that may change no bit: name, the run that they vary, and how.
LIKE = {
    "counts, 3 threads": ("counts", {"threads": 3}),
    "particles, 3 threads": ("particles", {"threads": 3}),
    "stop at an error, 3 threads": ("stop at an error", {"threads": 3}),
    "filter packed loose, 3 threads": ("filter packed loose", {"threads": 3}),
    "water on the lattice, 3 threads": ("water on the lattice", {"threads": 3}),
    "water on the lattice, portable": ("water on the lattice", {"isa": "portable"}),
    "water on the lattice, killed and resumed": ("water on the lattice", {"kill": True}),
    "water on the packing's own voids, 3 threads": ("water on the packing's own voids", {"threads": 3}),
    "water through a thick lattice, 3 threads": ("water through a thick lattice", {"threads": 3}),
    "water through a thick lattice, killed and resumed": ("water through a thick lattice", {"kill": True}),
    "particles, portable": ("particles", {"isa": "portable"}),
    "particles, AVX2": ("particles", {"isa": "avx2"}),
    "counts, portable": ("counts", {"isa": "portable"}),
    "particles, mapped": ("particles", {"memory": "1MB"}),
    "counts, mapped": ("counts", {"memory": "470kB"}),
    "particles, killed and resumed": ("particles", {"kill": True}),
    "particles, mapped, killed and resumed": ("particles", {"kill": True, "memory": "1MB"}),
    "counts, killed and resumed on 3 threads": ("counts", {"kill": True, "threads": 3}),
    "stratified counts, killed and resumed": ("stratified counts", {"kill": True}),
    "expected, killed and resumed": ("expected", {"kill": True}),
    "arches, 3 threads": ("arches", {"threads": 3}),
    "arches, portable": ("arches", {"isa": "portable"}),
    "arches, AVX2": ("arches", {"isa": "avx2"}),
    "arches, more than one keeps, 3 threads": ("arches, more than one keeps", {"threads": 3}),
    "arches, killed and resumed": ("arches", {"kill": True}),
    "openings, portable": ("openings", {"isa": "portable"}),
    "openings, AVX2": ("openings", {"isa": "avx2"}),
    "openings and arches, 3 threads": ("openings and arches", {"threads": 3}),
    "studies that stop, 3 threads": ("studies that stop", {"threads": 3}),
    "sensitivity, its own scene": ("sensitivity", {"again": True}),
    "filter by sieve and curve file, its own scene": ("filter by sieve and curve file", {"again": True}),
    "network from a file, its own scene": ("network from a file", {"again": True}),
}
# Checkpoints after which a run or packing is killed, the later ones if it ended before. A fast disk hides many from a watcher.
KILL_RUN, KILL_PACKING = (250, 60, 10), (4, 1)  # 250: in the second run of the first replicate
KILLED = 1 if os.name == "nt" else -9  # what a killed program leaves as its exit code

PLAN = """title = "two by two, and a packed filter"
seed = 5
[set]
replicates = 2
network = { nx = 8, ny = 8, nz = 10 }
record = { sensitivity = [], series_every = 0, size_curves = [] }
[[factor]]
name = "cu_b"
setting = "base.cu"
values = [1.5, 3]
[[factor]]
name = "filter"
[factor.levels]
loose = { "filter.curve" = "shire2016-cu1.5-loose" }
dense = { "filter.curve" = "shire2016-cu1.5-dense", "base.dc_curve" = "shire2016-cu1.5-loose" }
[[case]]
name = "packed"
set = { filter = { density = "dense", cu = 1.5 }, packing = { grains = 300, stiffness_ratio = 0.01 } }
"""

WORDS = {"verdict", "engine", "kind", "counted_facets"}  # their text is a result
DROPPED = {"seconds", "settings", "rules", "notes", "left_out", "short_of", "practice", "if_dispersive"}
LABELS = {"rules_not_met", "notes", "d85b_of"}  # columns of a campaign's table that are no result of a walk
ROWS = 12


def inputs(folder):
    """Writes the files that scenes read."""
    def write(name, lines):
        (folder / name).write_text("\n".join(lines) + "\n")

    write("small.toml", [SMALL])
    write("defaults.toml", ["[filter]", 'curve = "shire2016-cu1.5-loose"', "[base]", "cu = 1.5", "d85_at_dc = 5"])
    write("plan.toml", [PLAN])
    write("base.csv", ["opening_mm,percent_finer", "0.5,100", "0.42,85", "0.36,50", "0.3,20", "0.25,5", "0.2,0"])
    write("tail.csv", ["opening_mm;percent_finer", "0,5;100", "0,42;85", "0,36;50", "0,3;20", "0,25;8"])
    write("filter.csv", ["opening_mm,percent_finer", "1.9,0", "2.4,12", "3.1,45", "4.2,80", "5.5,100"])
    write("open.csv", ["opening_mm,percent_finer", "5.5,100", "4.2,80", "3.1,45", "2.4,12"])
    write("narrow.csv", ["opening_mm,percent_finer", "1,0", "1.3,30", "1.6,75", "2,100"])
    curve = [(0.34, 0), (0.42, 5), (0.5, 20), (0.66, 50), (0.85, 80), (1.05, 95), (1.6, 100)]
    write("curve_mm.csv", ["percent_smaller,diameter_mm", *(f"{p},{d}" for d, p in curve)])
    write("curve_d0f.csv", ["percent_smaller,diameter_over_d0f", *(f"{p},{d / 2:.3f}" for d, p in curve)])
    chance = random.Random(3)

    def size(low, high):
        return round(low + (high - low) * chance.random(), 4)

    # 12 layers of 20 voids: three exits each to the next layer, and some back to the layer before.
    rows = [f"start,{void}," for void in range(20)]
    for void in range(240):
        for to in (void + 20, *((void // 20 + 1) * 20 + chance.randrange(20) for _ in range(2))):
            rows.append(f"{void},{to if to < 240 else 'end'},{size(0.2, 0.7)}")
        if void >= 20 and void % 4 == 0:
            rows.append(f"{void},{void - 20},{size(0.4, 0.9)}")
    # Two voids between which particles circle for ever, once one has blocked the way out.
    rows += ["0,240,0.8", "240,241,0.9", "241,240,0.9", "241,end,0.15"]
    write("network.csv", ["from,to,diameter_mm", *rows])
    # Grains beside the places of a face-centred lattice, few of them touching.
    corners = [(0, 0, 0), (0, 0.8, 0.8), (0.8, 0, 0.8), (0.8, 0.8, 0)]
    grains = [
        (*(1.6 * n + c + size(0.3, 0.5) for n, c in zip((x, y, z), corner)), size(0.85, 1.1))
        for x in range(4) for y in range(4) for z in range(4) for corner in corners
    ]
    rows = [",".join(f"{v:.4f}" for v in grain) for grain in grains]
    write("periodic.csv", ["# cell_mm = 6.4, 6.4, 6.4", "x_mm,y_mm,z_mm,diameter_mm", *rows])
    write("free.csv", ["# cell = none", "x_mm,y_mm,z_mm,diameter_mm", *rows])
    write("periodic.dump", [
        "ITEM: TIMESTEP", "0", "ITEM: NUMBER OF ATOMS", str(len(grains)), "ITEM: BOX BOUNDS pp pp pp", "-1 5.4", "-1 5.4", "-1 5.4",
        "ITEM: ATOMS id x y z radius",
        *(f"{i} {x - 1:.4f} {y - 1:.4f} {z - 1:.4f} {d / 2:.5f}" for i, (x, y, z, d) in enumerate(grains, 1)),
    ])


class Failed(Exception):
    """The program did not do what was asked."""


def settings(sets):
    """Settings as words of a command line."""
    return [word for one in sets for word in ("--set", one)]


class Program:
    """The program, and how each kind of scene is worked in a folder that holds the input files; gives what is compared by file."""

    def __init__(self, binary, isa):
        self.binary, self.isa = binary, isa

    def start(self, folder, words, threads=None, isa=None):
        isa = isa or self.isa
        environment = {k: v for k, v in os.environ.items() if k != "VOIDWALK_ISA"} | ({"VOIDWALK_ISA": isa} if isa else {})
        if words[0] != "constrictions":
            words = [*words, "--threads", str(threads or 1)]
        return subprocess.Popen(
            [self.binary, *words], cwd=folder, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def call(self, folder, *words, **how):
        child = self.start(folder, words, **how)
        text = child.communicate()[1]
        if child.returncode != 0:
            raise Failed(f"{' '.join(words)}: exit code {child.returncode}: {text.strip()[-300:]}")

    def kill(self, folder, *words, watched, after):
        """Kills a call once it has written so many checkpoints."""
        for number in after:
            child, seen = self.start(folder, words), set()
            while len(seen) < number and child.poll() is None:
                for path in folder.glob(watched):
                    try:
                        seen.add((path.name, path.stat().st_mtime_ns))
                    except FileNotFoundError:
                        pass
            child.kill()
            child.communicate()
            if child.returncode == KILLED:
                return
            shutil.rmtree(folder / "out")
        raise Failed(f"{' '.join(words)}: ended before it could be killed")

    def run(self, folder, sets, scene="small.toml", threads=None, isa=None, memory=None, kill=False, again=False):
        room = ["--memory", memory] if memory else []
        words = ["run", *filter(None, [scene]), "--out", "out", "-q", *settings(sets), *room]
        if kill:
            self.kill(folder, *words, "--checkpoint-every", "1increment", watched="out/checkpoint/*", after=KILL_RUN)
            words = ["resume", "out", "-q", *room]
        self.call(folder, *words, threads=threads, isa=isa)
        if again:
            self.call(folder / "out", "run", "scene.toml", "--out", "../again", "-q")
        return results(folder / ("again" if again else "out"), "outcome.json", "series.csv", "layers.csv", "retained.csv", "eroded.csv")

    def pack(self, folder, sets, kill=False, threads=None):
        words = ["pack", "small.toml", "--out", "out", "-q", *settings(sets)]
        if kill:
            self.kill(folder, *words, "--checkpoint-every", "20ms", watched="out/compression.*", after=KILL_PACKING)
        self.call(folder, *words, threads=threads)
        return results(folder / "out", "grains.csv", "constrictions.csv", "constrictions.json", "packing.json")

    def constrictions(self, folder, grains, overlap):
        # A dump does not say that it is in mm.
        unit = ["--unit", "mm"] if grains.endswith(".dump") else []
        self.call(folder, "constrictions", grains, *unit, "--merge-overlap", overlap, "--out", "out")
        return results(folder / "out", "constrictions.csv", "constrictions.json")

    def campaign(self, folder, threads=None):
        self.call(folder, "campaign", "plan.toml", "--out", "out", "-q", threads=threads)
        outcomes = sorted(path.relative_to(folder / "out").as_posix() for path in folder.glob("out/cases/*/outcome.json"))
        return {"cases.csv": digest(without_labels(folder / "out" / "cases.csv")), **results(folder / "out", *outcomes)}

    def percolation(self, folder, threads=None):
        self.call(folder, "percolation", "--sizes", "5,8,12,20", "--realisations", "20", "--out", "out", threads=threads)
        return results(folder / "out", "percolation.csv", "percolation.json")


def scenes():
    """Every scene: name, the scene whose results it must have, the kind, and what that is given."""
    for name, sets in RUNS.items():
        yield name, name, Program.run, [sets], {}
    for name, (like, how) in LIKE.items():
        yield name, like, Program.run, [RUNS[like]], how
    for name, scene in [("the built-in scene", None), ("a scene of defaults", "defaults.toml")]:
        yield name, name, Program.run, [LITTLE], {"scene": scene}
    for name, sets in PACKINGS.items():
        yield name, name, Program.pack, [sets], {}
    for name, how in [("pack loose, 3 threads", {"threads": 3}), ("pack loose, killed and gone on with", {"kill": True})]:
        yield name, "pack loose", Program.pack, [PACKINGS["pack loose"]], how
    for grains in ["periodic.csv", "free.csv", "periodic.dump"]:
        for overlap in ["0.1", "0.5"]:
            name = f"constrictions of {grains}, overlap {overlap}"
            yield name, name, Program.constrictions, [grains, overlap], {}
    for also, how in [("", {}), (", 3 threads", {"threads": 3})]:
        yield "percolation" + also, "percolation", Program.percolation, [], how
        yield "campaign" + also, "campaign", Program.campaign, [], how


def digest(data):
    return hashlib.sha256(data).hexdigest()[:16]


def results(folder, *names):
    """What is compared of these files."""
    found = {}
    for name in map(str, names):
        data = (folder / name).read_bytes()
        if name.endswith(".json"):
            numbers = numbers_of(with_verdict(json.loads(data)))
            found[name] = {"sha256": digest(json.dumps(numbers, sort_keys=True).encode()), "numbers": shortened(numbers)}
        else:
            found[name] = digest(data)
    return found


def with_verdict(record):
    """The class of the model alone, by the name that replicates have for theirs: its other numbers are those of replicates and curve."""
    model = record.pop("model", None)
    return record if model is None else record | {"verdict": model["class"]}


def numbers_of(value):
    """JSON without times and text."""
    if isinstance(value, dict):
        return {k: numbers_of(v) for k, v in value.items() if k not in DROPPED and (k in WORDS or not isinstance(v, str))}
    if isinstance(value, list):
        return [numbers_of(v) for v in value if not isinstance(v, str)]
    return value


def shortened(value):
    """JSON with hashes in place of long lists."""
    if isinstance(value, dict):
        return {k: shortened(v) for k, v in value.items()}
    if isinstance(value, list):
        return digest(json.dumps(value, sort_keys=True).encode()) if len(value) > ROWS else [shortened(v) for v in value]
    return value


def without_labels(path):
    """A campaign's table without what is said of its verdicts."""
    with open(path, newline="") as file:
        rows = [{k: v for k, v in row.items() if k not in LABELS} for row in csv.DictReader(file)]
    return json.dumps(rows).encode()


def differences(was, now, path=""):
    """Paths at which JSON differs, each with both values."""
    if isinstance(was, dict) and isinstance(now, dict):
        for key in {**was, **now}:
            yield from differences(was.get(key, "nothing"), now.get(key, "nothing"), f"{path}.{key}" if path else key)
    elif isinstance(was, list) and isinstance(now, list) and len(was) == len(now):
        for index, pair in enumerate(zip(was, now)):
            yield from differences(*pair, f"{path}[{index}]")
    elif json.dumps(was) != json.dumps(now):
        yield f"{path}: {json.dumps(was)[:60]} is now {json.dumps(now)[:60]}"


def compared(was, now):
    """What differs of a scene, in words; nothing where all is the same."""
    words = []
    for name in {**was, **now}:
        if was.get(name) == now.get(name):
            continue
        one, other = was.get(name, "missing"), now.get(name, "missing")
        if isinstance(one, dict) and isinstance(other, dict):
            # What is dropped now may have been recorded.
            found = list(differences(numbers_of(one["numbers"]), numbers_of(other["numbers"])))
            if not found and one["numbers"] != other["numbers"]:
                continue
            more = f"; and {len(found) - 4} more" if len(found) > 4 else ""
            words.append(f"{name} ({'; '.join(found[:4])}{more})")
        else:
            words.append(f"{name} ({one} is now {other})" if "missing" in (one, other) else name)
    return "differs: " + ", ".join(words) if words else ""


def work(program, folder, known):
    """Works every scene and prints a line of each; the results, and the number of scenes that are not as they must be."""
    found, wrong = {}, 0
    for name, like, kind, given, how in scenes():
        begun = time.monotonic()
        at = folder / name.replace("/", " over ").replace(" ", "-").replace(",", "")
        at.mkdir()
        inputs(at)
        try:
            now = kind(program, at, *given, **how)
        except (Failed, OSError) as failed:
            said = f"failed: {failed}"
        else:
            found.setdefault(like, now)
            was = (found if known is None else known).get(like)
            said = "is not in the record" if was is None else compared(was, now)
        wrong += bool(said)
        print(f"{name}: {said or 'same'} ({time.monotonic() - begun:.1f} s)", flush=True)
    worked = {like for _, like, *_ in scenes()}
    for name in (name for name in known or {} if name not in worked):
        wrong += 1
        print(f"{name}: is in the record only")
    return found, wrong


def write(file, found, commit):
    """Writes the record, a line for each scene."""
    head = {"commit": (commit or "unknown")[:7], "date": datetime.date.today().isoformat()}
    rows = (f"{json.dumps(name)}: {json.dumps(scene, separators=(',', ':'))}" for name, scene in found.items())
    file.write_text(json.dumps(head)[:-1] + ', "scenes": {\n' + ",\n".join(rows) + "\n}}\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", required=True, type=pathlib.Path, help="the program itself: it is killed")
    parser.add_argument("--isa", choices=["avx512", "avx2", "portable"], help="instructions of scenes that do not set them; they change no bit")
    parser.add_argument("--keep", type=pathlib.Path, help="a new folder, in which the results stay")
    parser.add_argument("what", choices=["record", "check"])
    parser.add_argument("file", type=pathlib.Path)
    options = parser.parse_args()
    program = Program(options.binary.resolve(), options.isa)
    known = json.loads(options.file.read_text())["scenes"] if options.what == "check" else None
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=not options.keep)
        found, wrong = work(program, folder.resolve(), known)
        if options.what == "record" and not wrong:
            write(options.file, found, commit=json.loads(next(folder.glob("*/out/manifest.json")).read_text())["commit"])
    print(f"{wrong} scenes are not the same" if wrong else "all scenes are the same")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
