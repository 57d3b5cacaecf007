#!/usr/bin/env python3
"""Lists the public items of the library, a line each: kind and path, as others write it.

    scripts/checks/public_api.py                  every item
    scripts/checks/public_api.py --unused         items that neither a face nor an example, a test or a benchmark names
    scripts/checks/public_api.py --count          how many there are in each module of the top

From the JSON of rustdoc, which a stable compiler writes with RUSTC_BOOTSTRAP=1; its form changes with the compiler, and only what
has long been the same is read. Methods count as items, methods of traits and fields do not. `--unused` goes by names: an
item is used where its name stands as a word in a file that calls the library.
"""

import argparse
import collections
import json
import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: Its own: crates look at RUSTC_BOOTSTRAP, and would be compiled anew in the target of everything else.
TARGET = ROOT / "target" / "public-api"
#: Who calls the library from outside it.
CALLERS = ["src/main.rs", "scripts/python/src", "scripts/examples", "benches", "tests"]


CRATES = ["voidwalk-core", "voidwalk-sheets", "voidwalk-practice", "voidwalk-app"]


def told(crate):
    """The JSON that rustdoc writes of a crate."""
    command = ["cargo", "rustdoc", "--locked", "--quiet", "-p", crate, "--lib", "--", "-Z", "unstable-options",
               "--output-format", "json", "--cap-lints", "allow"]
    own = {"RUSTC_BOOTSTRAP": "1", "CARGO_TARGET_DIR": str(TARGET)}
    subprocess.run(command, cwd=ROOT, check=True, env={**os.environ, **own})
    return json.loads((TARGET / "doc" / f"{crate.replace('-', '_')}.json").read_text(encoding="utf-8"))


def items(said):
    """Kind and path of every public item; one that has two paths stands twice."""
    index = said["index"]

    def walk(number, path, seen):
        item = index.get(str(number))
        # Of another crate, or met already on the way here.
        if item is None or number in seen:
            return
        ((kind, inner),) = item["inner"].items()
        if kind == "use":
            if inner["is_glob"]:
                for child in (index.get(str(inner["id"])) or {"inner": {"module": {"items": []}}})["inner"]["module"]["items"]:
                    yield from walk(child, path, seen | {number})
            elif inner["id"] is not None:
                yield from walk(inner["id"], path[:-1] + [inner["name"]] if path[-1] is None else path + [inner["name"]], seen | {number})
            return
        if item["visibility"] != "public":
            return
        here = path if path and path[-1] == item["name"] else path + [item["name"]]
        yield kind, "::".join(here)
        if kind == "module":
            for child in inner["items"]:
                yield from walk(child, here, seen | {number})
        for number_of_impl in inner.get("impls", []) if isinstance(inner, dict) else []:
            one = index.get(str(number_of_impl))
            if one is not None and one["inner"]["impl"]["trait"] is None:
                for child in one["inner"]["impl"]["items"]:
                    method = index[str(child)]
                    if method["visibility"] == "public":
                        yield next(iter(method["inner"])), "::".join([*here, method["name"]])

    yield from walk(said["root"], [], frozenset())


def called():
    """Every word of the files that call the library."""
    words = set()
    for caller in CALLERS:
        path = ROOT / caller
        for file in [path] if path.is_file() else path.rglob("*.rs"):
            words |= set(re.findall(r"\w+", file.read_text(encoding="utf-8")))
    return words


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--unused", action="store_true", help="items that no caller names")
    parser.add_argument("--count", action="store_true", help="how many there are in each module of the top")
    args = parser.parse_args()
    found = sorted({item for crate in CRATES for item in items(told(crate))}, key=lambda item: item[1])
    if args.unused:
        words = called()
        found = [(kind, path) for kind, path in found if path.rsplit("::", 1)[-1] not in words]
    if args.count:
        top = collections.Counter("::".join(path.split("::")[:2]) for _, path in found)
        for name, count in sorted(top.items()):
            print(f"{count:5}  {name or 'modules'}")
        print(f"{len(found):5}  in all")
        return 0
    for kind, path in found:
        print(f"{kind:12} {path}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
