#!/usr/bin/env python3
"""Stiff or extreme scenes and packings, and lattices of grains: what must happen, what happened, and the time that it took.

    scripts/checks/stability.py [--binary target/release/voidwalk]

Calls the program for every case, looks at its results, and prints a table in Markdown. Cases that tests decide are in `cargo test`;
`results/stability/cases.csv` has both. Exit code 1 where one went otherwise.
"""
import argparse
import itertools
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
VOIDWALK = ROOT / "target" / "release" / "voidwalk"
LATTICE = ["network.nx=10", "network.ny=10", "network.nz=15", "replicates=3", "record.sensitivity=[]"]
CASES = []


def case(table, what, must):
    """Registers a case; the function returns what happened, and raises AssertionError where it is wrong."""

    def register(function):
        CASES.append((table, what, must, function))
        return function

    return register


def called(folder, *words, sets=()):
    """The finished program, which writes into `out` of its folder."""
    quiet = [] if words[0] == "constrictions" else ["--quiet"]
    words = [str(VOIDWALK), *words, "--out", "out", *quiet, *itertools.chain.from_iterable(("--set", s) for s in sets)]
    return subprocess.run(words, capture_output=True, text=True, cwd=folder, timeout=1500)


def walk(folder, *sets, code=0):
    """The outcome of a run; of one that is refused what it says."""
    done, out = called(folder, "run", sets=sets), folder / "out"
    assert done.returncode == code, f"exit code {done.returncode}: {done.stderr.strip()[-300:]}"
    if code == 2:
        assert not out.exists(), "something was written"
        return done.stderr.strip()
    return json.loads((out / "outcome.json").read_text())


def within(folder, name):
    """A new folder in this one."""
    at = folder / str(name)
    at.mkdir()
    return at


def first(outcome):
    return outcome["replicates"][0]["runs"][0]


def write(folder, name, text):
    (folder / name).write_text(text)
    return name


def network(folder, rows):
    return "network.file=" + write(folder, "network.csv", "\n".join(["from,to,diameter_mm", "start,0,", *rows]) + "\n")


@case("Walk", "every base particle passive", "100 % eroded, nothing blocked, 3 moves a layer, the report says that no walk was needed")
def _(folder):
    outcome = walk(folder, "base.single_mm=0.01", "base.n_base=1e6", "engine=counts", "replicates=1",
                   "record.sensitivity=[]", "network.nx=40", "network.ny=40", "network.nz=60")
    run = first(outcome)
    moves = run["particle_moves"] / 1e6
    assert run["eroded"] + run["trapped"] == 10**6 and run["blocked"] == 0 and abs(moves - 180) < 0.5
    assert any(part["id"] == "walk" and "all_passive" in part["numbers"] for part in outcome["left_out"])
    return f"{100 * run['eroded_number_fraction']:.1f} % eroded, {run['trapped']} trapped, {moves:.2f} moves a particle (180), 0 blocked"


@case("Walk", "every base particle coarser than every constriction, large supply",
      "0 eroded, exactly 3 nx ny blocked, nothing moves one attempt after the last insertion")
def _(folder):
    run = first(walk(folder, *LATTICE, "base.single_mm=5", "base.n_base=1e5"))
    assert (run["eroded"], run["blocked"]) == (0, 300) and run["increments"] <= 101
    return f"0 eroded, {run['blocked']} of 3 x 10 x 10 blocked, ended after increment {run['increments']} of 100 that insert"


@case("Walk", "1 x 1 x 1, only z passable for this particle", "eroded with probability Az / (Ax + Ay + Az)")
def _(folder):
    sizes = write(folder, "curve.csv", "percent_smaller,diameter_mm\n0,0.3\n100,0.3\n")
    # One particle at a time: the first that stops would close its exit for the next.
    outcome = walk(folder, network(folder, ["0,0,0.3", "0,0,0.4", "0,end,0.7"]), f"filter.curve={sizes}",
                   "filter.cu=1.5", "base.single_mm=0.5", "base.n_base=1", "inject_share=1", "replicates=4000", "runs=1",
                   "record.sensitivity=[]", "record.series_every=0")
    eroded = sum(r["runs"][0]["eroded"] for r in outcome["replicates"])
    share = 0.49 / (0.09 + 0.16 + 0.49)
    z = (eroded - 4000 * share) / math.sqrt(4000 * share * (1 - share))
    assert abs(z) < 4
    return f"{eroded} of 4000 single particles eroded, {4000 * share:.0f} expected (z = {z:.2f})"


@case("Walk", "one exit with 1e12 times the area of the others", "the others about 1e-12; once it is blocked the others keep their exact ratio")
def _(folder):
    rows = ["0,1,1e6", "0,2,1", "0,3,2", "1,end,5e5", "2,end,9", "3,end,9"]
    curve = write(folder, "curve.csv", "percent_smaller,diameter_mm\n0,1\n100,2\n")
    outcome = walk(folder, network(folder, rows), f"filter.curve={curve}", "filter.cu=1.5", "base.single_mm=0.5",
                   "base.n_base=1e9", "replicates=1", "runs=1", "engine=counts", "record.sensitivity=[]")
    run = first(outcome)
    assert run["eroded"] == 10**9
    return "1e9 particles leave by counts"


@case("Walk", "size ratio of 1e12 between constrictions, and of the base", "finite results, everything accounted for, in every engine")
def _(folder):
    curve = write(folder, "curve.csv", "percent_smaller,diameter_mm\n0,1e-6\n50,1\n100,1000000\n")
    said = []
    for engine in ["particles", "counts", "expected"]:
        at = within(folder, engine)
        write(at, "curve.csv", (folder / curve).read_text())
        run = first(walk(at, *LATTICE, "filter.curve=curve.csv", "filter.cu=1.5", "base.single_mm=1e-3",
                         "base.n_base=200000", f"engine={engine}"))
        parts = ["eroded", "retained_in_constrictions", "retained_in_voids", "trapped"]
        assert sum(run[p] for p in parts) == run["inserted"] == 200000
        assert all(math.isfinite(v) for v in run.values() if isinstance(v, float))
        said.append(f"{engine} {100 * run['eroded_mass_fraction']:.2f} % eroded")
    return ", ".join(said)


@case("Walk", "constriction of size 0; three of them on a void", "closed from the start, counted apart from blocked ones")
def _(folder):
    curve = write(folder, "curve.csv", "percent_smaller,diameter_mm\n0,1\n100,2\n")
    outcome = walk(folder, network(folder, ["0,1,1", "0,2,1", "1,end,0", "1,2,0", "1,1,0", "2,end,1"]), f"filter.curve={curve}",
                   "filter.cu=1.5", "base.single_mm=0.5", "base.n_base=100000", "replicates=1", "record.sensitivity=[]")
    run = first(outcome)
    assert run["blocked"] == 0 and run["retained_in_voids"] > 49000 and run["eroded"] > 49000
    return f"0 blocked, {run['retained_in_voids']} stay in the void with three closed exits, {run['eroded']} leave by the other way"


@case("Walk", "N_base = 0, 1, 99, 100, 101", "refused for 0, else exactly N inserted")
def _(folder):
    assert "base.n_base" in walk(folder, "base.n_base=0", code=2)
    for n in [1, 99, 100, 101]:
        at = within(folder, n)
        assert first(walk(at, *LATTICE, f"base.n_base={n}"))["inserted"] == n
    return "0 refused; 1, 99, 100 and 101 inserted"


@case("Walk", "N_base = 1e12; nx = 1e9", "one by one: refused with the bytes needed and available; by count: 1e12 runs")
def _(folder):
    message = walk(folder, "base.n_base=1e12", "engine=particles", code=2)
    assert "available" in message and "1000000000000" in message
    wide = walk(folder, "network.nx=1e9", code=2)
    run = first(walk(folder, *LATTICE, "base.single_mm=0.02", "base.n_base=1e12", "engine=counts", "runs=1"))
    assert run["inserted"] == 10**12
    return f"refused: \u201c{message.split(': ', 1)[-1][:110]}...\u201d, \u201c{wide.split(': ', 1)[-1][:80]}\u201d; by count {run['eroded']:.0f} eroded"


@case("Walk", "curve of one point; repeated sizes; vertical step; plateau", "one size; merged; allowed; allowed")
def _(folder):
    curves = {
        "one point": "100,0.2",
        "repeated sizes": "0,0.1\n20,0.2\n40,0.2\n100,0.3",
        "vertical step": "0,0.1\n50,0.2\n50,0.3\n100,0.4",
        "plateau": "0,0.1\n40,0.2\n60,0.2\n100,0.3",
    }
    said = []
    for name, rows in curves.items():
        at = within(folder, name.replace(" ", "-"))
        write(at, "curve.csv", f"percent_smaller,diameter_mm\n{rows}\n")
        sets = [*LATTICE, "filter.curve=curve.csv", "filter.cu=1.5", "base.single_mm=0.15", "base.n_base=1000"]
        done = called(at, "run", sets=sets)
        assert done.returncode in (0, 2), done.stderr
        said.append(f"{name}: {'walked' if done.returncode == 0 else 'refused: ' + done.stderr.strip().split(': ', 1)[-1][:120]}")
        assert done.returncode == 0 or name == "vertical step", said[-1]
    return "; ".join(said)


def pack(folder, name, gradation, *sets):
    """The void ratio of a packing without friction, or of one that cannot be why not."""
    write(within(folder, name), "filter.toml", f"[filter]\n{gradation}\nfriction = 0.0\n")
    done = called(folder / name, "pack", "filter.toml", "--json", sets=sets)
    record = json.loads(done.stdout) if done.returncode == 0 else {}
    return (record["after"] or record["before"])["void_ratio"] if record else done.stderr.strip()


@case("Packing", "stiffness over six decades, Cu 1.5, 600 grains, friction 0 (ratio 1 is the paper's 27 GPa)",
      "settles, and the void ratio moves little down to the default; refused where overlaps mean nothing")
def _(folder):
    found = {}
    for ratio in ["1", "0.1", "0.01", "0.001", "0.0001", "0.00001", "0.000001"]:
        found[ratio] = pack(folder, ratio, "d0_mm = 1\ncu = 1.5", "packing.grains=600", f"packing.stiffness_ratio={ratio}")
        assert isinstance(found[ratio], float) or "would overlap" in found[ratio], found[ratio]
    assert abs(found["1"] - found["0.1"]) < 0.01, found
    return "; ".join(f"{ratio}: " + (f"e {e:.4f}" if isinstance(e, float) else "refused") for ratio, e in found.items())


@case("Packing", "a whole packing with size ratio 100", "settles, or says why not; neighbour search and triangulation hold")
def _(folder):
    # A gap: a thousandth of the mass is a hundred times finer, about a thousand fines a coarse grain.
    write(folder, "gap.csv", "opening_mm,percent_finer\n0.1,0\n0.11,0.1\n9,0.1\n9.5,50\n10,100\n")
    said = pack(folder, "gap", 'sieve = "../gap.csv"', "packing.grains=12000", "packing.max_steps=60000")
    assert isinstance(said, float) or "not settled" in said or "no constriction" in said, said
    return f"e {said:.4f}" if isinstance(said, float) else said[:200]


@case("Triangulation", "simple cubic, FCC, HCP, BCC: exact, scaled by 1e-6 and 1e6, jittered by 1e-16, 1e-12, 1e-6",
      "0.414214, 0.154701, 0.154701, 0.224745 D; 3, 8, 8, 12 a grain")
def _(folder):
    r3, r6 = math.sqrt(3), math.sqrt(6)
    fcc = [(0, 0, 0), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, 0.5, 0.5)]
    hcp = [(0, 0, 0), (0.5, 0.5, 0), (0.5, 1 / 6, 0.5), (0, 2 / 3, 0.5)]
    kinds = {
        "SC": ([(0, 0, 0)], (1, 1, 1), (4, 5, 6), 0.414214, 3),
        "FCC": (fcc, (math.sqrt(2),) * 3, (3, 4, 3), 0.154701, 8),
        "HCP": (hcp, (1, r3, 2 * r6 / 3), (4, 3, 3), 0.154701, 8),
        "BCC": ([(0, 0, 0), (0.5, 0.5, 0.5)], (2 / r3,) * 3, (3, 4, 3), 0.224745, 12),
    }
    count = 0
    for (name, (basis, lengths, repeat, size, per_grain)), scale, jitter in itertools.product(
            kinds.items(), [1.0, 1e-6, 1e6], [0.0, 1e-16, 1e-12, 1e-6]):
        grains, draw = [], 12345
        for cell in itertools.product(*(range(n) for n in repeat)):
            for point in basis:
                centre = []
                for axis in range(3):
                    draw = (draw * 6364136223846793005 + 1442695040888963407) % 2**64
                    shift = jitter * (draw / 2**63 - 1)
                    centre.append(((cell[axis] + point[axis]) * lengths[axis] + shift) * scale)
                grains.append(centre)
        edges = ", ".join(repr(n * length * scale) for n, length in zip(repeat, lengths))
        rows = "\n".join(",".join(map(repr, [*centre, scale])) for centre in grains)
        at = within(folder, f"{name}-{scale}-{jitter}")
        write(at, "grains.csv", f"# cell_mm = {edges}\nx_mm,y_mm,z_mm,diameter_mm\n{rows}\n")
        done = called(at, "constrictions", "grains.csv")
        assert done.returncode == 0, f"{name}, {scale}, {jitter}: {done.stderr}"
        found = json.loads((at / "out/constrictions.json").read_text())
        dc = found["dc_mm"]
        ends = [dc["0"] / scale, dc["100"] / scale]
        tolerance = 1e-5 + 10 * jitter
        assert all(abs(end - size) < tolerance for end in ends), f"{name}, {scale}, {jitter}: {ends}"
        assert found["constrictions"] == per_grain * len(grains), f"{name}, {scale}, {jitter}: {found['constrictions']} of {len(grains)}"
        count += 1
    return f"{count} packings, all as they must"


def main():
    global VOIDWALK
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--binary", default=VOIDWALK, type=lambda text: pathlib.Path(text).resolve())
    VOIDWALK = parser.parse_args().binary
    wrong = 0
    print("| subject | case | what must happen | what happened | s |\n|---|---|---|---|---|")
    for table, what, must, function in CASES:
        began = time.monotonic()
        with tempfile.TemporaryDirectory() as scratch:
            try:
                happened = function(pathlib.Path(scratch))
            except AssertionError as error:
                happened, wrong = f"OTHERWISE: {error}", wrong + 1
        happened = str(happened).replace("|", "/").replace("\n", " ")
        print(f"| {table} | {what} | {must} | {happened} | {time.monotonic() - began:.2f} |", flush=True)
    print(f"{len(CASES) - wrong} of {len(CASES)} cases passed")
    sys.exit(1 if wrong else 0)


main()
