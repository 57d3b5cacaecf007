"""What the studies share, and some checks: their command line, calls of the program and what they cost, sheets of soils, kept lines and
tables, figures."""

import argparse
import csv
import json
import resource
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def parser(doc, threads=None):
    """A command line with the program, and with threads where a number of them is the usual one."""
    made = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("--binary", type=Path, default=ROOT / "target/release/voidwalk")
    if threads:
        made.add_argument("--threads", default=threads)
    return made


def sets(settings):
    """Settings, as `name=value` or by name, as words of a command line."""
    listed = [f"{name}={value}" for name, value in settings.items()] if isinstance(settings, dict) else settings
    return [word for setting in listed for word in ("--set", setting)]


def spent(words, **how):
    """A finished process, and its processor time."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(word) for word in words], **how)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done, after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def bench(name):
    """The path of a benchmark, which is compiled where it has to be."""
    command = ["cargo", "bench", "--bench", name, "--no-run", "--message-format=json"]
    told = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    messages = [json.loads(line) for line in told.splitlines() if line.startswith("{")]
    return next(one["executable"] for one in messages if one.get("executable") and one["target"]["name"] == name)


def sheet(path, points):
    """Writes the sieve table of points (mm, percent finer)."""
    path.write_text("size_mm,percent_finer\n" + "".join(f"{size},{percent}\n" for size, percent in points))


def lines_of(path):
    """The JSON lines of a file, where it is there."""
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


def keep(path, line):
    """Adds a JSON line to a file."""
    with path.open("a") as file:
        file.write(json.dumps(line) + "\n")


def table(path, rows):
    """Writes rows, which are dicts, as a CSV table."""
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def pyplot():
    """Matplotlib's, which draws the same bytes every time."""
    import matplotlib
    from matplotlib import pyplot as made

    matplotlib.use("svg")
    matplotlib.rcParams |= {"svg.hashsalt": "voidwalk", "svg.fonttype": "none", "font.size": 9}
    return made
