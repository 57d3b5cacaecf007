#!/usr/bin/env python3
"""Prints how far each kernel is from what this machine could do, as a table in Markdown.

    scripts/peers/roofline.py [LINES.jsonl]

Runs `cargo bench --bench roofline`, or reads the lines that it printed before. Beside each kernel stands what an item takes as the
source has it, counted by hand: bytes, single words read at random that nothing waits for, additions and multiplications, divisions,
square roots, additions that wait for one another because their order is part of the result, and random words. The least time is that
of whichever takes longest at the machine's best, as if each were all there is. Divisions and roots share a part of the processor and
are added up. Random words have a limit in portable code alone; comparisons, integers and conversions have none.
"""

import json
import subprocess
import sys
from statistics import median

CACHE = {"second": "second cache", "third": "third cache"}

INSERTED = "the inverse cube root, then random words and the sum of masses"
STEP = "random reads of the table; portable code: arithmetic in vectors of four, which hand-written SSE2 has 2 to 6 % faster"

#: Kernel: what an item is; what it takes; what holds it up next.
KERNELS = {
    "step": ("attempted move", {"bytes": 16, "cache": "third", "reads": 1}, STEP),
    "insert and step": (
        "attempted move",
        {"bytes": 24, "cache": "third", "reads": 1, "operations": 36, "in order": 1, "words": 2.25},
        INSERTED,
    ),
    "insert, step and block": (
        "attempted move",
        {"bytes": 24, "cache": "third", "reads": 2, "operations": 36, "in order": 1, "words": 2.25},
        "insertion, as above; blocking events one by one and in order",
    ),
    "counts": (
        "void and increment",
        {"bytes": 36, "cache": "third", "operations": 150, "divisions": 2, "roots": 2, "words": 2},
        "two binomial draws a void and where they go",
    ),
    "expected": ("void and increment", {"bytes": 32, "cache": "third", "operations": 9}, "bytes from the third cache"),
    "expected, small": ("void and increment", {"bytes": 32, "cache": "second", "operations": 9}, "not taken apart: rows of 20 voids in the second cache"),
    "lattice": (
        "constriction",
        {"bytes": 11, "cache": "third", "operations": 6, "divisions": 2, "words": 1},
        "words that wait for one another, a look-up in the curve, memory written for the first time",
    ),
    "flow, from nothing": (
        "constriction",
        {"bytes": 108, "cache": "third", "operations": 16, "a round": True},
        "down and up through the factor",
    ),
    "contacts of grains": (
        "grain and step",
        {"bytes": 320, "cache": "second", "operations": 460, "divisions": 18, "roots": 12},
        "which pairs touch, gathers and scatters, motion: the law is a tenth",
    ),
    "triangulation": ("grain", None, "which facets meet, and the cavity of each grain: exact tests are a quarter"),
    "constrictions": ("grain", None, "discs between grains, and which voids they join"),
}

SHOWN = ["bytes", "reads", "operations", "divisions", "roots", "in order", "words"]


def lines():
    if len(sys.argv) > 1:
        return open(sys.argv[1]).read().splitlines()
    bench = ["cargo", "bench", "--bench", "roofline"]
    return subprocess.run(bench, check=True, capture_output=True, text=True).stdout.splitlines()


def least(takes, limits, isa):
    """The least time of an item (ns), and what it is that of."""
    fastest = lambda name: limits.get((name, isa)) or min(ns for (of, _), ns in limits.items() if of == name)
    of = {
        "bytes": takes.get("bytes", 0) * limits[("copy", CACHE[takes["cache"]])],
        "reads": takes.get("reads", 0) * limits[("random read", "96,000 words")],
        "operations": takes.get("operations", 0) * fastest("multiply or add"),
        "divisions, roots": takes.get("divisions", 0) * fastest("divide") + takes.get("roots", 0) * fastest("square root"),
        "in order": takes.get("in order", 0) * limits[("add in order", "any")],
        "words": takes.get("words", 0) * limits[("random word", "portable")] if isa == "portable" else 0,
    }
    longest = max(of, key=of.get)
    return of[longest], longest


def main():
    if sys.argv[1:] in (["-h"], ["--help"]):
        sys.exit(__doc__)
    found = [json.loads(line) for line in lines() if line.startswith("{")]
    limits = {(row["name"], row["of"]): min(row["ns"]) for row in found if row["kind"] == "limit"}
    rounds = {row["of"]: row["ns"][0] for row in found if row["kind"] == "count"}
    print("| what the machine does | of | ns | a second |\n|---|---|---|---|")
    for (name, of), ns in limits.items():
        unit = "GB" if name == "copy" else "thousand million"
        print(f"| {name}{', a byte read or written' if name == 'copy' else ''} | {of} | {ns:.4f} | {1 / ns:.2f} {unit} |")
    print("\n| kernel | instructions | an item | ns an item: median (least to most) | bytes | random reads | operations | divisions"
          " | roots | additions in order | random words | least ns | that of | part of the limit | what holds it up |")
    print("|---" * 15 + "|")
    for row in (row for row in found if row["kind"] == "kernel"):
        item, takes, why = KERNELS[row["name"]]
        ns, name = median(row["ns"]), row["name"]
        cells = [name, row["of"] or "all", item, f"{ns:.2f} ({min(row['ns']):.2f} to {max(row['ns']):.2f})"]
        if takes is None:
            cells += ["–"] * (len(SHOWN) + 3)
        else:
            times = rounds[name] if takes.get("a round") else 1
            all_rounds = {key: value * times if key in SHOWN else value for key, value in takes.items()}
            ns_least, of = least(all_rounds, limits, row["of"])
            cells += [f"{all_rounds.get(key, 0):g}" for key in SHOWN]
            cells += [f"{ns_least:.2f}", of, f"{100 * ns_least / ns:.0f} %"]
        print("| " + " | ".join(map(str, [*cells, why])) + " |")
    for name, number in rounds.items():
        print(f"\n{name}: {number:.0f} rounds of conjugate gradients; bytes and operations are those of all rounds.")


if __name__ == "__main__":
    main()
