#!/usr/bin/env python3
"""What `voidwalk check` says that a scene takes, against what it takes: seconds of one thread.

    scripts/checks/check_times.py --binary target/release/voidwalk [--core 0]

Each scene is checked, packed where its filter is to be packed, and walked, on one thread that is held on one core; what counts is its
processor time (user and system), as other work may share the machine. Prints a table in Markdown; exit code 1 where a figure is off by
more than a factor of 1.5. Scenes that take less than a second and a half are listed but not judged: there the start of the program and
the page count for most.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

# Sieve tables: percent finer by opening (mm).
SHEETS = {
    "c33": [(9.5, 100), (4.75, 97.5), (2.36, 90), (1.18, 67.5), (0.6, 42.5), (0.3, 20), (0.15, 6), (0.075, 0)],
    "sand": [(0.425, 100), (0.25, 60), (0.15, 15), (0.1, 0)],
    "till": [(19, 100), (4.75, 92), (2, 82), (0.425, 60), (0.075, 38), (0.02, 20), (0.005, 8), (0.002, 0)],
    "gravel": [(20, 100), (10, 45), (6.3, 15), (5, 0)],
    "coarse": [(4, 100), (2, 45), (1.1, 15), (0.9, 0)],
}

# Scenes by what they set in the built-in one; a scene with `toml` is written whole.
SCENES = {
    "built-in": ["replicates=4"],
    "base Cu 3": ["base.cu=3", "replicates=4"],
    "particles engine": ["engine=particles", "replicates=2", "record.sensitivity=[]"],
    "cap 200 000": ["base.cu=3", "base.cap=2e5"],
    "connectivity of Table 3": ["network.connectivity=table3", "replicates=3", "record.sensitivity=[]"],
    "one coarse size, n_base 1e6": ["base.cu=none", "base.d85_at_dc=none", "base.single_mm=0.3", "base.n_base=1e6", "replicates=4"],
    "one fine size, n_base 1e6": ["base.cu=none", "base.d85_at_dc=none", "base.single_mm=0.2", "base.n_base=1e6", "replicates=4", "record.sensitivity=[]"],
    "engine expected": ["engine=expected", "replicates=4", "record.sensitivity=[]"],
    "base coarser, D85B at Dc25": ["base.d85_at_dc=25", "replicates=4", "record.sensitivity=[]"],
    "base much coarser, D85B at Dc10": ["base.d85_at_dc=10", "replicates=4", "record.sensitivity=[]"],
    "20 x 20 x 300": ["network.nz=300", "network.nx=20", "network.ny=20", "replicates=4", "record.sensitivity=[]"],
    "80 x 80 x 30": ["network.nz=30", "network.nx=80", "network.ny=80", "replicates=4", "record.sensitivity=[]"],
    "flow, exit rule flux": ["walk.exit=flux", "replicates=1", "record.sensitivity=[]"],
    "100 layers": ["network.nz=100", "network.nx=30", "network.ny=30", "replicates=4", "record.sensitivity=[]"],
}
FILES = {
    "loose 3 000 grains, fine sand": ("coarse", "sand", 'density = "loose"', 3000),
    "dense 3 000 grains, fine sand": ("coarse", "sand", 'density = "dense"', 3000),
    "linear Cu 3 loose 5 000 grains": ("cu 3", "", 'density = "loose"', 5000),
    "linear Cu 1.5 loose, default grains": ("cu 1.5", "", 'density = "loose"', 0),
    "linear Cu 6 loose 6 000 grains": ("cu 6", "", 'density = "loose"', 6000),
    "linear Cu 2 dense 4 000 grains": ("cu 2", "", 'density = "dense"', 4000),
    "gravel dense 2 000 grains, fine sand": ("gravel", "sand", 'density = "dense"', 2000),
    "C33 loose, till": ("c33", "till", 'density = "loose"', 0),
    "estimate C33, till": ("c33", "till", "estimate = 0.5\ngrains_per_void = 0.6", 0),
    "estimate gravel, sand": ("gravel", "sand", "estimate = 0.5\ngrains_per_void = 0.6", 0),
    "estimate coarse, till": ("coarse", "till", "estimate = 0.5\ngrains_per_void = 0.6", 0),
}


def scene_of_files(folder, filter_name, base_name, how, grains):
    filter_lines = f'd0_mm = 1.0\ncu = {filter_name[3:]}' if filter_name.startswith("cu ") else f'sieve = "{filter_name}.csv"'
    base_lines = f'sieve = "{base_name}.csv"' if base_name else "cu = 2\nd15f_over_d85b = 5"
    packing = f"[packing]\ngrains = {grains}\n" if grains else ""
    return f"replicates = 4\n[filter]\n{filter_lines}\n{how}\n{packing}[base]\n{base_lines}\n[record]\nsensitivity = []\n"


def processor_seconds(words, core, folder):
    """Processor time of a command; it must succeed."""
    child = subprocess.Popen(["taskset", "-c", str(core), *words], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    message = child.stderr.read()
    _, status, usage = os.wait4(child.pid, 0)
    if status:
        sys.exit(f"{' '.join(words)}: {message.decode()[-500:]}")
    return usage.ru_utime + usage.ru_stime


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", type=pathlib.Path, required=True)
    parser.add_argument("--core", type=int, default=0)
    options = parser.parse_args()
    binary = str(options.binary.resolve())
    off = 0

    def row(name, what, said, took):
        nonlocal off
        ratio = said / took
        judged = took >= 1.5
        off += judged and not 1 / 1.5 <= ratio <= 1.5
        print(f"| {name} | {what} | {said:.1f} | {took:.1f} | {ratio:.2f}{'' if judged else ' (short)'} |", flush=True)

    print("| scene | what | check says (s) | took (s) | said / took |\n|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for name, rows in SHEETS.items():
            (folder / f"{name}.csv").write_text("opening_mm,percent_finer\n" + "".join(f"{d},{p}\n" for d, p in rows))
        init = folder / "init.toml"
        subprocess.run([binary, "init", init], check=True, capture_output=True)
        for number, name in enumerate([*SCENES, *FILES]):
            scene = folder / f"scene{number}.toml"
            settings = []
            if name in SCENES:
                text = init.read_text()
                for setting in SCENES[name]:
                    key, value = setting.split("=", 1)
                    if value == "none":
                        last = key.rsplit(".", 1)[1]
                        text = "\n".join(line for line in text.split("\n") if not line.startswith(f"{last} ="))
                    else:
                        settings += ["--set", setting]
                scene.write_text(text)
            else:
                scene.write_text(scene_of_files(folder, *FILES[name]))
            check = json.loads(subprocess.run([binary, "check", "--json", scene, *settings], cwd=folder, check=True, capture_output=True).stdout)
            if check["packing"]:
                took = processor_seconds([binary, "pack", str(scene), *settings, "--threads", "1", "-q"], options.core, folder)
                row(name, "packing", check["packing"]["core_seconds"], took)
            words = [binary, "run", str(scene), *settings, "--threads", "1", "-q", "--out", f"out{number}"]
            row(name, "walks", check["core_seconds"], processor_seconds(words, options.core, folder))
    sys.exit(1 if off else 0)


if __name__ == "__main__":
    main()
