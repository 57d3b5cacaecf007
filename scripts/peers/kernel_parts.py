#!/usr/bin/env python3
"""Prints where the time of each kernel of `benches/roofline.rs` goes, function by function, as a table in Markdown.

    scripts/peers/kernel_parts.py [--bench PROGRAM] [KERNEL ...]

Builds the bench with line numbers, unless a program is given that has them, and lets `perf` take samples of one kernel after
another (all, or those named, such as "counts avx512"). A sample counts for the innermost function of this repository at its
address, whether the compiler made it part of another or not. Its share is that of the samples within the calls that are timed, so
what prepares a kernel counts as far as it uses the same functions. Shares below 3 % are left out. `instructions` of a processor
are not asked for: a virtual machine may not count them.
"""

import argparse
import json
import re
import subprocess
import tempfile
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

#: Kernel and instructions: what its functions have in their path, so that what prepares it does not count.
KERNELS = {
    "insert and step": "walk/|stream|gradation/|kernel",
    "insert, step and block": "walk/|stream|gradation/|kernel",
    "counts": "walk/counts|stream|kernel",
    "expected": "walk/|kernel",
    "lattice": "network/cubic|constrictions/curve",
    "flow, from nothing": "network/",
    "contacts of grains": "packing/",
    "triangulation": "constrictions/triangulation",
    "constrictions": "constrictions/(?!triangulation|curve)",
}

ONE_SET = {"lattice", "flow, from nothing", "contacts of grains", "triangulation", "constrictions"}

LEAST = 0.03


def built():
    """The bench with line numbers of this crate."""
    command = ["cargo", "build", "--release", "--bench", "roofline", "--message-format=json"]
    command += ["--config", 'profile.release.package."voidwalk".debug=1']
    lines = subprocess.run(command, check=True, capture_output=True, text=True, cwd=ROOT).stdout.splitlines()
    found = [json.loads(line) for line in lines if line.startswith("{")]
    return next(m["executable"] for m in found if m.get("executable") and m["target"]["name"] == "roofline")


def samples(bench, kernel):
    """Lets `perf` look at one kernel, and gives what `counted` does."""
    with tempfile.NamedTemporaryFile() as file:
        record = ["perf", "record", "-q", "-e", "cpu-clock", "-F", "4000", "-o", file.name, bench, kernel]
        subprocess.run(record, check=True, capture_output=True)
        return counted(bench, file.name)


def counted(bench, recorded):
    """How many samples were taken at each address of the program, and by name where it is another's code."""
    script = ["perf", "script", "-i", recorded, "-F", "ip,sym,symoff,dso", "--no-demangle"]
    lines = subprocess.run(script, check=True, capture_output=True, text=True).stdout.splitlines()
    start = {}
    for line in subprocess.run(["nm", bench], check=True, capture_output=True, text=True).stdout.splitlines():
        parts = line.split()
        if len(parts) == 3:
            start[parts[2]] = int(parts[0], 16)
    at = Counter()
    for line in lines:
        found = re.match(r"\s*[0-9a-f]+ (\S+)\+0x([0-9a-f]+) \((.*)\)", line)
        if found and found[1] in start and Path(found[3]).name == Path(bench).name:
            at[start[found[1]] + int(found[2], 16)] += 1
        else:
            at["the kernel of the system" if "kernel" in line else "library of C"] += 1
    return at


def functions(bench, addresses):
    """By address: function and file of the innermost of this repository."""
    asked = "\n".join(hex(address) for address in addresses)
    command = ["addr2line", "-a", "-f", "-i", "-C", "-e", bench]
    lines = subprocess.run(command, check=True, input=asked, capture_output=True, text=True).stdout.splitlines()
    found, address, frames = {}, None, iter(lines)
    for line in frames:
        if re.fullmatch(r"0x[0-9a-f]+", line):
            address = int(line, 16)
            continue
        file = next(frames)
        own = re.search(r"(?:^|/)src/(.*?):", file) if "/rustc/" not in file and "/registry/" not in file else None
        if own and address not in found:
            name = re.sub(r"::\{\{?closure\}?\}(?:#\d+)?|::<.*>$|<.*>::", "", line).split("::")[-1]
            found[address] = (name, own[1])
    return found


def parts(bench, kernel, wanted):
    """Shares of functions, the largest first, and how many samples they are of."""
    at = samples(bench, kernel)
    named = functions(bench, [address for address in at if isinstance(address, int)])
    shares = Counter()
    for address, count in at.items():
        name, file = (address, "kernel") if isinstance(address, str) else named.get(address, ("not known", "kernel"))
        if re.search(wanted, file):
            shares[name if file == "kernel" else f"`{name}` ({file})"] += count
    return shares.most_common(), sum(shares.values())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bench", help="a bench with line numbers, built before")
    parser.add_argument("kernels", nargs="*", metavar="KERNEL")
    arguments = parser.parse_args()
    bench = arguments.bench or built()
    every = [name if name in ONE_SET else f"{name} {isa}" for name in KERNELS for isa in ("portable", "avx2", "avx512")]
    print("| kernel | samples | share of each function |\n|---|---|---|")
    for kernel in arguments.kernels or dict.fromkeys(every):
        wanted = KERNELS.get(kernel) or KERNELS[kernel.rsplit(" ", 1)[0]]
        shares, all_samples = parts(bench, kernel, wanted)
        most = [f"{name} {count / all_samples:.0%}".replace("%", " %") for name, count in shares if count >= LEAST * all_samples]
        print(f"| {kernel} | {all_samples} | {', '.join(most)} |", flush=True)


if __name__ == "__main__":
    main()
