#!/usr/bin/env python3
"""Prints how far each kernel is from what this machine could do, as a table in Markdown.

    scripts/peers/roofline.py [LINES.jsonl]

Runs `cargo bench --bench roofline`, or reads the lines that it printed before. Beside each kernel stand the bytes and the operations of
an item as the source has them, counted by hand; random reads are single words that nothing waits for. The least time is the largest
of bytes over what the machine copies from that cache, operations over its peak, and random reads: as if each were all there is.
"""

import json
import subprocess
import sys
from statistics import median

#: Kernel: what an item is; bytes of an item and where they lie; random reads; operations; what holds it up next.
KERNELS = {
    "step": ("attempted move", 16, "third cache", 1, 0, "random reads of the table; in portable code the arithmetic, too"),
    "insert and step": ("attempted move", 24, "third cache", 1, 0, "drawing a diameter and a void to begin in; not taken apart"),
    "insert, step and block": ("attempted move", 24, "third cache", 2, 0, "insertion, as above; blocking events one by one and in order"),
    "counts": ("void and increment", 36, "third cache", 0, 0, "two binomial draws a void; not taken apart"),
    "expected": ("void and increment", 32, "third cache", 0, 9, "neither bytes nor operations alone; not taken apart"),
    "lattice": ("constriction", 4, "second cache", 1, 0, "a random number and a look into the curve each; not taken apart"),
    "flow, from nothing": ("constriction", None, None, None, None, "rounds of conjugate gradients, which were not counted"),
    "contacts of grains": ("grain and step", 320, "second cache", 0, 460, "up to four square roots and six divisions a contact, counted as one operation each; gathers"),
    "triangulation": ("grain", None, None, None, None, "not taken apart"),
    "constrictions": ("grain", None, None, None, None, "not taken apart"),
}


def lines():
    if len(sys.argv) > 1:
        return open(sys.argv[1]).read().splitlines()
    bench = ["cargo", "bench", "--bench", "roofline"]
    return subprocess.run(bench, check=True, capture_output=True, text=True).stdout.splitlines()


def main():
    if sys.argv[1:] in (["-h"], ["--help"]):
        sys.exit(__doc__)
    found = [json.loads(line) for line in lines() if line.startswith("{")]
    limits = {(row["name"], row["of"]): min(row["ns"]) for row in found if row["kind"] == "limit"}
    print("| what the machine does | of | ns | a second |\n|---|---|---|---|")
    for (name, of), ns in limits.items():
        unit = {"copy": "GB", "random read": "thousand million", "multiply or add": "thousand million"}[name]
        print(f"| {name}{', a byte read or written' if name == 'copy' else ''} | {of} | {ns:.4f} | {1 / ns:.1f} {unit} |")
    print("\n| kernel | instructions | an item | ns an item: median (least to most) | bytes | random reads | operations"
          " | least ns | part of the limit | what holds it up |\n|---|---|---|---|---|---|---|---|---|---|")
    read = limits[("random read", "96,000 words")]
    peak = {of: ns for (name, of), ns in limits.items() if name == "multiply or add"}
    for row in (row for row in found if row["kind"] == "kernel"):
        item, count, cache, reads, operations, why = KERNELS[row["name"]]
        ns = median(row["ns"])
        least = None
        if count is not None:
            of_isa = peak.get(row["of"], min(peak.values()))
            least = max(count * limits[("copy", cache)], reads * read, operations * of_isa)
        cells = [row["name"], row["of"] or "all", item, f"{ns:.2f} ({min(row['ns']):.2f} to {max(row['ns']):.2f})"]
        cells += ["–"] * 5 if least is None else [count, reads, operations, f"{least:.2f}", f"{100 * least / ns:.0f} %"]
        print("| " + " | ".join(map(str, [*cells, why])) + " |")


if __name__ == "__main__":
    main()
