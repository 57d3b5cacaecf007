#!/usr/bin/env python3
"""Uses the Windows program as a person at a Windows machine would, in Wine, and sees that it does what it promises.

    scripts/checks/try_windows.py --binary "wine target/x86_64-pc-windows-gnu/debug/voidwalk.exe"

Sheets with CRLF in folders with spaces and umlauts, reached by backslashes; exit codes; a run that is interrupted (Ctrl-C), one that is
killed, and both continued with the bits of the unbroken run; two processes on one folder; a campaign that two processes share; files that
are open elsewhere while they are replaced; particles in files; the page of `serve`. `check_targets.sh run` calls it after it has linked the
program. What Wine is not: Windows. Locks, names and errors are Wine's, on a disk of Linux; junctions it has none, and a window that is
closed cannot be tried in it. Python 3's standard library only.
"""

import argparse
import os
import pathlib
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import urllib.request

BASE = "opening_mm,percent_finer\r\n0.5,100\r\n0.42,85\r\n0.36,50\r\n0.3,20\r\n0.25,5\r\n0.2,0\r\n"
FILTER = "Sieve (mm);Passing (%)\r\n4;100\r\n2,8;80\r\n2;50\r\n1,4;20\r\n1;0\r\n"
SMALL = ["--set", "network.nx=8", "--set", "network.ny=8", "--set", "network.nz=10", "--set", "record.sensitivity=[]"]
SCENE = """seed = 7
replicates = 2
engine = "particles"
[filter]
curve = "shire2016-cu1.5-loose"
[base]
cu = 1.5
d85_at_dc = 5
n_base = 1500000
[network]
nx = 10
ny = 10
nz = 16
[record]
sensitivity = []
"""
PLAN = 'title = "two"\n[set]\nreplicates = 2\nnetwork = { nx = 8, ny = 8, nz = 10 }\nrecord = { sensitivity = [] }\n' \
    '[[factor]]\nname = "cu_b"\nsetting = "base.cu"\nvalues = [1.5, 2, 3, 4]\n'
# Results, and not times, hosts and calls.
TABLES = ["series.csv", "layers.csv", "retained.csv", "eroded.csv"]


class Fault(Exception):
    """What should not be."""


def hold(condition, words):
    if not condition:
        raise Fault(words)


class Trials:
    """The program in a folder of its own."""

    def __init__(self, binary, folder):
        self.binary, self.folder = shlex.split(binary), folder
        (folder / "scene.toml").write_text(SCENE.replace("\n", "\r\n"), newline="")
        (folder / "plan.toml").write_text(PLAN.replace("\n", "\r\n"), newline="")
        (folder / "packed.toml").write_text('[filter]\r\ncu = 1.5\r\ndensity = "loose"\r\n', newline="")
        sheets = folder / "My Sheets" / "Dämme"
        sheets.mkdir(parents=True)
        (sheets / "base soil.csv").write_text(BASE, newline="")
        (sheets / "filter soil.csv").write_text(FILTER, newline="")

    def start(self, *words):
        return subprocess.Popen([*self.binary, *words], cwd=self.folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True)

    def call(self, *words, code=0):
        child = self.start(*words)
        out, err = child.communicate()
        hold(child.returncode == code, f"{words}: exit code {child.returncode}, not {code}: {(out + err)[-600:]}")
        hold("panicked" not in err, f"{words}: {err}")
        return out + err

    def wait_for(self, pattern, child):
        """Waits until there is such a file."""
        end = time.monotonic() + 120
        while not list(self.folder.glob(pattern)):
            if child.poll() is not None:
                raise Fault(f"ended before {pattern}: {child.communicate()}")
            hold(time.monotonic() < end, f"no {pattern} in two minutes")
            time.sleep(0.01)

    def alike(self, one, other):
        for name in TABLES:
            same = (self.folder / one / name).read_bytes() == (self.folder / other / name).read_bytes()
            hold(same, f"{other}/{name} is not that of {one}")
        litter = list((self.folder / other).glob(".voidwalk-part-*"))
        hold(not litter, f"left: {litter}")

    # Each of these is a trial; its name says what holds.

    def a_scene_with_crlf_is_checked_and_walked(self):
        self.call("check", "scene.toml")
        self.call("run", "scene.toml", "--out", "whole", "-q")
        hold((self.folder / "whole" / "report.html").is_file(), "no page")

    def sheets_are_judged_by_a_path_with_spaces_umlauts_and_backslashes(self):
        self.call("judge", r".\My Sheets\Dämme\base soil.csv", r"My Sheets\Dämme\filter soil.csv", "--quick", "--out",
                  r"My Sheets\Ergebnis für Dämme", "-q", *SMALL)
        out = self.folder / "My Sheets" / "Ergebnis für Dämme"
        hold((out / "report.html").is_file() and (out / "outcome.json").is_file(), "the folder is not where it was asked for")
        # Its own scene, which names its files, works from there.
        self.call("run", r"My Sheets\Ergebnis für Dämme\scene.toml", "--out", "again", "-q")

    def mistakes_are_refused_with_the_place_and_nothing_is_written(self):
        (self.folder / "wrong.csv").write_text("opening_mm,percent_finer\r\n0.5,100\r\n0.3,x\r\n", newline="")
        said = self.call("judge", r".\wrong.csv", r"My Sheets\Dämme\filter soil.csv", "--out", "refused", code=2)
        hold("wrong.csv, line 3" in said and not (self.folder / "refused").exists(), said)
        said = self.call("run", r"no such folder\scene.toml", "--out", "refused", code=2)
        hold("scene.toml" in said and not (self.folder / "refused").exists(), said)
        said = self.call("run", "scene.toml", "--out", "whole", "-q", "--set", "seed=8", code=2)
        hold("whole" in said, said)
        for name in ["NUL", "a?b", "x:y"]:
            said = self.call("run", "scene.toml", "--out", name, "-q", *SMALL, code=2)
            hold("refused" in said, said)

    def a_run_that_is_killed_continues_with_the_same_bits(self):
        for number in range(3):
            out = f"killed-{number}"
            child = self.start("run", "scene.toml", "--out", out, "-q", "--checkpoint-every", "5increments")
            self.wait_for(f"{out}/checkpoint/*", child)
            time.sleep(0.1 + 0.2 * number)
            child.kill()
            child.communicate()
            hold(child.returncode == -9, "ended before it was killed")
            self.call("resume", out, "-q")
            self.alike("whole", out)

    def ctrl_c_saves_the_run(self):
        child = self.start("run", "scene.toml", "--out", "stopped", "-q", "--checkpoint-every", "1h")
        self.wait_for("stopped/.voidwalk.unfinished", child)
        time.sleep(0.3)
        child.send_signal(signal.SIGINT)
        said = child.communicate()
        hold(child.returncode == 3, f"exit code {child.returncode}: {said}")
        self.call("resume", "stopped", "-q")
        self.alike("whole", "stopped")

    def a_second_ctrl_c_ends_it_at_once(self):
        child = self.start("pack", "packed.toml", "--out", "long", "-q", "--set", "packing.grains=20000")
        self.wait_for("long/.voidwalk.lock", child)
        time.sleep(1)
        for _ in range(40):
            child.send_signal(signal.SIGINT)
            if child.poll() is not None:
                break
            time.sleep(0.002)
        said = child.communicate()
        hold(child.returncode in (1, 3), f"exit code {child.returncode}: {said}")

    def the_second_process_on_a_folder_leaves_and_names_the_first(self):
        first = self.start("run", "scene.toml", "--out", "held", "-q")
        self.wait_for("held/.voidwalk.unfinished", first)
        said = self.call("run", "scene.toml", "--out", "held", "-q", code=2)
        hold("another run writes to this folder (process " in said, said)
        hold(first.wait() == 0, "the first did not end well")
        self.alike("whole", "held")

    def two_processes_share_a_campaign(self):
        two = [self.start("campaign", "plan.toml", "--out", "campaign", "-q") for _ in range(2)]
        for child in two:
            said = child.communicate()
            hold(child.returncode == 0, f"{child.returncode}: {said}")
        rows = (self.folder / "campaign" / "cases.csv").read_text().splitlines()
        hold(len(rows) == 5, f"{len(rows)} lines")
        hold("4 of 4" in self.call("campaign", "plan.toml", "--out", "campaign"), "a finished campaign is walked again")

    def what_is_open_elsewhere_is_replaced(self):
        shutil.copytree(self.folder / "whole", self.folder / "open")
        with open(self.folder / "open" / "report.html", "rb"), open(self.folder / "open" / "outcome.json", "rb"):
            self.call("report", "open")
            self.call("run", "scene.toml", "--out", "open", "--overwrite", "-q")
        self.alike("whole", "open")

    def particles_that_do_not_fit_live_in_files(self):
        self.call("run", "scene.toml", "--out", "mapped", "-q", "--memory", "4MB")
        self.alike("whole", "mapped")

    def a_packing_is_made_twice_and_its_constrictions_measured(self):
        words = ["--set", "packing.grains=300", "--set", "packing.stiffness_ratio=0.01"]
        for more in [[], ["--overwrite"]]:
            self.call("pack", "packed.toml", *words, "--out", "packed", "-q", *more)
        said = self.call("constrictions", r"packed\grains.csv", "--out", "measured")
        hold((self.folder / "measured" / "constrictions.csv").is_file(), said)

    def the_page_of_serve_answers(self):
        log = self.folder / "serve.txt"
        with log.open("w") as out:
            child = subprocess.Popen([*self.binary, "serve", "--out", "served"], cwd=self.folder, stdin=subprocess.DEVNULL, stdout=out,
                                     stderr=subprocess.STDOUT)
        try:
            end = time.monotonic() + 60
            while "open http" not in (said := log.read_text()):
                hold(child.poll() is None and time.monotonic() < end, f"no address: {said}")
                time.sleep(0.1)
            with urllib.request.urlopen(said.partition("open ")[2].split()[0]) as answer:
                hold(b"Will this filter hold this soil?" in answer.read(), "no page")
        finally:
            child.kill()
            child.wait()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", required=True, help="the program, or the command that starts it")
    options = parser.parse_args()
    faults = 0
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        trials = Trials(options.binary, pathlib.Path(folder))
        names = [name for name in vars(Trials) if name[0] != "_" and name not in ("start", "call", "wait_for", "alike")]
        for name in names:
            begun = time.monotonic()
            try:
                getattr(trials, name)()
                said = "holds"
            except (Fault, OSError) as fault:
                faults += 1
                said = f"DOES NOT HOLD: {fault}"
            print(f"{name.replace('_', ' ')}: {said} ({time.monotonic() - begun:.1f} s)", flush=True)
    return 1 if faults else 0


if __name__ == "__main__":
    os.environ.setdefault("WINEDEBUG", "-all")
    sys.exit(main())
