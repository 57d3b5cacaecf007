#!/usr/bin/env python3
"""What `voidwalk check` says that a scene takes, against what it takes: seconds of one thread.

    scripts/checks/check_times.py [--binary target/release/voidwalk] [--core 0]

Each scene is checked, packed where its filter is to be packed, and walked, on one thread that is held on one core; what counts is its
processor time (user and system), as other work may share the machine. Prints a table in Markdown; exit code 1 where a figure is off by
more than a factor of 1.5. Scenes that take less than a second and a half are listed but not judged: there the start of the program and
the page count for most.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "studies"))
import common  # noqa: E402

# Sieve tables: percent finer by opening (mm).
SHEETS = {
    "c33": [(9.5, 100), (4.75, 97.5), (2.36, 90), (1.18, 67.5), (0.6, 42.5), (0.3, 20), (0.15, 6), (0.075, 0)],
    "sand": [(0.425, 100), (0.25, 60), (0.15, 15), (0.1, 0)],
    "till": [(19, 100), (4.75, 92), (2, 82), (0.425, 60), (0.075, 38), (0.02, 20), (0.005, 8), (0.002, 0)],
    "gravel": [(20, 100), (10, 45), (6.3, 15), (5, 0)],
    "coarse": [(4, 100), (2, 45), (1.1, 15), (0.9, 0)],
}
ALONE = "record.sensitivity=[]"
LINEAR, GUESSED = "filter.d0_mm=1 base.cu=2 base.d15f_over_d85b=5", "filter.estimate=0.5 filter.grains_per_void=0.6"
# Scenes by what they set in the built-in one, four replicates unless they say otherwise.
SCENES = {
    "built-in": "",
    "base Cu 3": "base.cu=3",
    "particles engine": f"engine=particles replicates=2 {ALONE}",
    "cap 200 000": "base.cu=3 base.cap=2e5 replicates=10",
    "connectivity of Table 3": f"network.connectivity=table3 replicates=3 {ALONE}",
    "one coarse size, n_base 1e6": "base.single_mm=0.3 base.n_base=1e6",
    "one fine size, n_base 1e6": f"base.single_mm=0.2 base.n_base=1e6 {ALONE}",
    "engine expected": f"engine=expected {ALONE}",
    "base coarser, D85B at Dc25": f"base.d85_at_dc=25 {ALONE}",
    "base much coarser, D85B at Dc10": f"base.d85_at_dc=10 {ALONE}",
    "20 x 20 x 300": f"network.nz=300 network.nx=20 network.ny=20 {ALONE}",
    "80 x 80 x 30": f"network.nz=30 network.nx=80 network.ny=80 {ALONE}",
    "flow, exit rule flux": f"walk.exit=flux replicates=1 {ALONE}",
    "100 layers": f"network.nz=100 network.nx=30 network.ny=30 {ALONE}",
    "loose 3 000 grains, fine sand": f"filter.sieve=coarse.csv base.sieve=sand.csv filter.density=loose packing.grains=3000 {ALONE}",
    "dense 3 000 grains, fine sand": f"filter.sieve=coarse.csv base.sieve=sand.csv filter.density=dense packing.grains=3000 {ALONE}",
    "linear Cu 3 loose 5 000 grains": f"filter.cu=3 {LINEAR} filter.density=loose packing.grains=5000 {ALONE}",
    "linear Cu 1.5 loose, default grains": f"filter.cu=1.5 {LINEAR} filter.density=loose {ALONE}",
    "linear Cu 6 loose 6 000 grains": f"filter.cu=6 {LINEAR} filter.density=loose packing.grains=6000 {ALONE}",
    "linear Cu 2 dense 4 000 grains": f"filter.cu=2 {LINEAR} filter.density=dense packing.grains=4000 {ALONE}",
    "gravel dense 2 000 grains, fine sand": f"filter.sieve=gravel.csv base.sieve=sand.csv filter.density=dense packing.grains=2000 {ALONE}",
    "C33 loose, till": f"filter.sieve=c33.csv base.sieve=till.csv filter.density=loose {ALONE}",
    "estimate C33, till": f"filter.sieve=c33.csv base.sieve=till.csv {GUESSED} {ALONE}",
    "estimate gravel, sand": f"filter.sieve=gravel.csv base.sieve=sand.csv {GUESSED} {ALONE}",
    "estimate coarse, till": f"filter.sieve=coarse.csv base.sieve=till.csv {GUESSED} {ALONE}",
}


def main():
    parser = common.parser(__doc__)
    parser.add_argument("--core", default="0")
    options = parser.parse_args()
    binary = options.binary.resolve()
    off = 0

    def row(name, what, said, words):
        """Says how long a command takes beside what was said."""
        nonlocal off
        command = ["taskset", "-c", options.core, binary, *words, "--threads", "1", "-q"]
        done, took = common.spent(command, cwd=folder, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{name}: {done.stderr[-500:]}")
        is_judged = took >= 1.5
        off += is_judged and not 1 / 1.5 <= said / took <= 1.5
        print(f"| {name} | {what} | {said:.1f} | {took:.1f} | {said / took:.2f}{'' if is_judged else ' (short)'} |", flush=True)

    print("| scene | what | check says (s) | took (s) | said / took |\n|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for name, points in SHEETS.items():
            common.sheet(pathlib.Path(folder, f"{name}.csv"), points)
        subprocess.run([binary, "init", "scene.toml"], cwd=folder, check=True, capture_output=True)
        for number, (name, settings) in enumerate(SCENES.items()):
            changes = {"replicates": 4} | dict(setting.split("=", 1) for setting in settings.split())
            scene = ["scene.toml", *common.sets(changes)]
            told = subprocess.run([binary, "check", "--json", *scene], cwd=folder, check=True, capture_output=True).stdout
            check = json.loads(told)
            if check["packing"]:
                row(name, "packing", check["packing"]["core_seconds"], ["pack", *scene])
            row(name, "walks", check["core_seconds"], ["run", *scene, "--out", f"out{number}"])
    sys.exit(1 if off else 0)


if __name__ == "__main__":
    main()
