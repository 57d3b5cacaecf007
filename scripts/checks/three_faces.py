#!/usr/bin/env python3
"""Random pairs of soils through the command line, the page of `voidwalk serve` and the Python package: the same answer from each.

    scripts/checks/three_faces.py --python target/python/bin/python [--binary target/release/voidwalk] [--pairs 500] [--seed 1]

Each pair is written as two sheets and given to `voidwalk rules`, to `serve` and to `voidwalk.rules`, some said to be dispersive, some beside an open
joint, some exchanged, some as given. Compared are every rule with its value and limit, D85B with the size that it was regraded on, the order of the rules
(of the page the sizes of the base and the rules that are not met), or the words of the refusal. `voidwalk judge` must refuse the pairs that `rules` refuses, and no others, and its outcome has the same D85B and rules.
Exit code 1 where any two differ. Python 3's standard library only; the environment of --python has the package.
"""

import argparse
import json
import os
import pathlib
import random
import re
import signal
import subprocess
import sys
import tempfile
import urllib.error
import urllib.parse
import urllib.request

# A server keeps at most 200 sheets.
PAIRS_A_SERVER = 95
SIEVES = [75, 37.5, 19, 9.5, 4.75, 2.36, 1.18, 0.6, 0.3, 0.15, 0.075, 0.02, 0.005, 0.002]
# Seconds for a walk: a lattice of four voids across may have loops whose way out is very narrow, of which the program warns.
PATIENCE = 20
SMALL = ["replicates=1", "network.nx=4", "network.ny=4", "network.nz=4", "base.n_base=50", "record.sensitivity=[]", "filter.grains_per_void=0.6"]


def soil(draw, top, bottom):
    """Percent finer on the sieves between two sizes, rising from a few percent or none to 100; sometimes with a gap."""
    sieves = [size for size in SIEVES if bottom <= size <= top]
    if len(sieves) < 3:
        at = max(0, min(len(SIEVES) - 3, next((i for i, size in enumerate(SIEVES) if size <= top), 0)))
        sieves = SIEVES[at:at + 3]
    shares = [draw.random() ** 2 + 0.02 for _ in sieves]
    if draw.random() < 0.15 and len(sieves) > 4:
        shares[draw.randrange(1, len(sieves) - 2)] = 0.0
    tail = draw.choice([0, 0, draw.uniform(0, 5), draw.uniform(0, 40)])
    passed, rows = 100.0, []
    for size, share in zip(sieves, shares[:-1] + [0]):
        rows.append((size, abs(round(passed, 1))))
        passed -= (100 - tail) * share / sum(shares[:-1])
    return rows


def pairs(count, seed):
    draw = random.Random(seed)
    for _ in range(count):
        d = draw.choice(SIEVES[1:9])
        base = soil(draw, draw.choice([d, 4 * d]), d / draw.choice([4, 16, 300]))
        factor = draw.choice([2, 4, 8, 16])
        filter_ = soil(draw, min(75, factor * d), factor * d / draw.choice([4, 16, 64]))
        flags = {"dispersive": draw.random() < 0.2, "as_given": draw.random() < 0.3}
        if draw.random() < 0.2:
            flags["joint_mm"] = round(draw.uniform(0.1, 10), 2)
        yield (filter_, base, flags) if draw.random() < 0.25 else (base, filter_, flags)


def told(rules):
    """What is compared of a pair of soils: all that is said of it but the names of the two files."""
    return {"rules": rules["rules"], "base": {k: v for k, v in rules["base"].items() if k not in ("curve", "curves")},
            "filter": {k: v for k, v in rules["filter"].items() if k not in ("curve", "curves")}}


#: A second rule of drainage, which the page leaves out where both ask for the same; of it nothing is compared.
LEAST = "Permeability, the least by EM 1110-2-1901"


def shown(page):
    """What the page of serve shows of a pair: the sizes of the base, and the rules that are not met, as their table has them."""
    rows = [row for part in page["parts"] for row in part["rows"]]
    return {"base": {k: v for k, v in page["base"].items() if k not in ("curve", "curves")},
            "not met": sorted(row[1] for row in rows if row[0] == "not met" and LEAST not in row[1])}


#: One limit of a dispersive base, which the page names once.
BOTH = ("Sherard and Dunnigan: the filter retains the base (design)", "Foster and Fell: no erosion rather than some")
ONE = "Fell et al.: no erosion of a highly dispersive base (taken for design, too, without a margin)"


def as_shown(rules):
    """The same of a record of rules: the page leaves out those of the walk, and names two rules of one limit once."""
    listed = {rule["name"]: rule for rule in rules["rules"] if rule["role"] != "walk" and LEAST not in rule["name"]}
    broken = {name for name, rule in listed.items() if rule["met"] is False}
    if rules["base"]["dispersive"] and listed[BOTH[0]]["limit"] == listed[BOTH[1]]["limit"] and broken & {*BOTH}:
        broken = broken - {*BOTH} | {ONE}
    return {"base": rules["base"], "not met": sorted(broken)}


def plain(words):
    """A refusal without the names of the files and of the flag, which differ by face, and without what leads it."""
    words = re.sub(r"^(error|refused): ", "", words.strip())
    words = re.sub(r"^base \S+, filter \S+: ", "", words)
    words = re.sub(r",? or say that they are as given.*$", "", words)
    return re.sub(r"\s+", " ", words)


def by_command(binary, folder, at, flags, command="rules", more=()):
    words = [binary, command, f"base-{at}.csv", f"filter-{at}.csv", *more]
    words += ["--json"] * (command == "rules") + ["--dispersive"] * flags["dispersive"] + ["--as-given"] * flags["as_given"]
    words += ["--joint-mm", str(flags["joint_mm"])] if "joint_mm" in flags else []
    before = set(os.listdir(folder))
    try:
        done = subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        return None
    if done.returncode == 2:
        assert set(os.listdir(folder)) == before, f"{command} refused and left something"
        return {"refused": plain(done.stderr)}
    assert done.returncode == 0, f"{' '.join(words)}: exit code {done.returncode}\n{done.stderr}"
    return told(json.loads(done.stdout)) if command == "rules" else {}


class Server:
    def __init__(self, binary, folder):
        self.log = folder / "log"
        with open(self.log, "w") as log:
            self.child = subprocess.Popen([binary, "serve", "--out", str(folder / "serve")], stdout=log, stderr=log)
        for _ in range(200):
            found = re.search(r"http://\S+", self.log.read_text())
            if found:
                break
            self.child.poll() is None or sys.exit(self.log.read_text())
            __import__("time").sleep(0.05)
        self.url = found.group(0)

    def ask(self, path, body=None):
        try:
            with urllib.request.urlopen(urllib.request.Request(self.url + path, data=body)) as answer:
                return json.load(answer)
        except urllib.error.HTTPError as error:
            return {"refused": plain(json.load(error)["problem"])}

    def rules(self, folder, at, flags):
        ids = {}
        for role in ("base", "filter"):
            name = f"{role}-{at}.csv"
            sheet = self.ask(f"api/sheet?name={name}", (folder / name).read_bytes())
            if "refused" in sheet:
                return sheet
            ids[role] = sheet["id"]
        changes = ["base.dispersive=true"] * flags["dispersive"]
        changes += [f"filter.joint_mm={flags['joint_mm']}"] if "joint_mm" in flags else []
        asked = {**ids, **({"as_given": 1} if flags["as_given"] else {}), "changes": "\n".join(changes)}
        got = self.ask("api/rules?" + urllib.parse.urlencode(asked))
        return got if "refused" in got else shown(got)

    def stop(self):
        self.child.send_signal(signal.SIGINT)
        self.child.wait()


PYTHON = """
import json, sys, voidwalk as vw
for line in sys.stdin:
    base, filter_, flags = json.loads(line)
    try:
        print(json.dumps({"rules": vw.rules(base, filter_, **flags)}), flush=True)
    except (ValueError, vw.VoidwalkError) as error:
        print(json.dumps({"refused": str(error)}), flush=True)
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--binary", default="target/release/voidwalk", type=lambda text: str(pathlib.Path(text).resolve()))
    parser.add_argument("--python", default=sys.executable, type=lambda text: str(pathlib.Path(text).absolute()))
    parser.add_argument("--pairs", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    counted = {"the same rules": 0, "the same refusal": 0, "different": 0}
    regraded = broken = judged = unfinished = 0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        python = subprocess.Popen([options.python, "-c", PYTHON], cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        server = None
        for at, (base, filter_, flags) in enumerate(pairs(options.pairs, options.seed)):
            for role, rows in (("base", base), ("filter", filter_)):
                (folder / f"{role}-{at}.csv").write_text("opening_mm,percent_finer\n" + "".join(f"{s:g},{p:g}\n" for s, p in rows))
            if at % PAIRS_A_SERVER == 0:
                server and server.stop()
                (folder / f"of-{at}").mkdir()
                server = Server(options.binary, folder / f"of-{at}")
            faces = {"command line": by_command(options.binary, folder, at, flags), "serve": server.rules(folder, at, flags)}
            print(json.dumps([f"base-{at}.csv", f"filter-{at}.csv", flags]), file=python.stdin, flush=True)
            got = json.loads(python.stdout.readline())
            faces["Python"] = {"refused": plain(got["refused"])} if "refused" in got else told(got["rules"])
            first = faces["command line"]
            same = faces["Python"] == first and faces["serve"] == (first if "refused" in first else as_shown(first))
            counted["different" if not same else "the same refusal" if "refused" in first else "the same rules"] += 1
            if not same:
                print(f"pair {at} {flags} base {base} filter {filter_}")
                for face, said in faces.items():
                    said = as_shown(said) if face != "serve" and "rules" in said else said
                    print(f"  {face}: {json.dumps(said)[:900]}")
            walked = by_command(options.binary, folder, at, flags, "judge", ["--quick", "-q", "--out", f"out-{at}", *[w for s in SMALL for w in ("--set", s)]])
            if walked is None:
                unfinished += 1
            elif "refused" in walked and "refused" not in first:
                # What has no walk may have rules all the same: a base of one size, a filter that is too broad to guess.
                print(f"pair {at}: rules answer, judge refuses: {walked['refused'][:200]}")
            elif "refused" in first and "refused" not in walked:
                counted["different"] += 1
                print(f"pair {at}: rules refuse, judge walks: {first['refused'][:200]}")
            elif "refused" not in first:
                outcome = json.loads((folder / f"out-{at}" / "outcome.json").read_text())
                judged += 1
                rules = {rule["id"]: rule for rule in outcome["rules"]}
                for rule in first["rules"]:
                    other = rules.get(rule["id"])
                    if rule["role"] != "walk" and (other is None or (other["limit"], other["value"], other["met"]) != (rule["limit"], rule["value"], rule["met"])):
                        counted["different"] += 1
                        print(f"pair {at}: {rule['id']} of rules {rule['value']} {rule['limit']} {rule['met']}, of judge {other and (other['value'], other['limit'], other['met'])}")
                regraded += first["base"]["regraded"]
                broken += any(rule["met"] is False and rule["role"] == "retention" for rule in first["rules"])
        server.stop()
        python.stdin.close()
    print(", ".join(f"{count} {what}" for what, count in counted.items()) + f"; {judged} judged, {unfinished} not walked to the end in {PATIENCE} s, {regraded} regraded, {broken} break a rule of retention")
    return 1 if counted["different"] else 0


if __name__ == "__main__":
    sys.exit(main())
