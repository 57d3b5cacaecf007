#!/usr/bin/env python3
"""Random pairs of soils through the command line, the page of `voidwalk serve` and the Python package: the same answer from each.

    scripts/checks/three_faces.py --python target/python/bin/python [--binary target/release/voidwalk] [--pairs 500] [--seed 1]

Each pair is written as two sheets and given to `voidwalk rules`, to `serve` and to `voidwalk.rules`, some said to be dispersive, some
beside an open joint, some exchanged, some as given. Compared are every rule with its value and limit, D85B with the size that it was
regraded on, the order of the rules (of the page the sizes of the base and the rules that are not met), or the words of the refusal.
`voidwalk judge` must refuse what `rules` refuses, and its outcome has the same rules. Exit code 1 where any two differ. The environment
of --python has the package.
"""

import json
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import urllib.error
import urllib.parse
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "studies"))
import common  # noqa: E402

# A server keeps at most 200 sheets.
PAIRS_A_SERVER = 95
SIEVES = [75, 37.5, 19, 9.5, 4.75, 2.36, 1.18, 0.6, 0.3, 0.15, 0.075, 0.02, 0.005, 0.002]
# A lattice of four voids across may have loops whose way out is very narrow: after so many seconds its walk is left alone.
PATIENCE = 20
SMALL = ["replicates=1", *(f"network.n{axis}=4" for axis in "xyz"), "base.n_base=50", "record.sensitivity=[]", "filter.grains_per_void=0.6"]
# A second rule of drainage, which the page leaves out where both ask for the same; of it nothing is compared.
LEAST = "Permeability, the least by EM 1110-2-1901"
# One limit of a dispersive base, which the page names once.
BOTH = {"Sherard and Dunnigan: the filter retains the base (design)", "Foster and Fell: no erosion rather than some"}
ONE = "Fell et al.: no erosion of a highly dispersive base (taken for design, too, without a margin)"


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


def sizes(soil):
    """All that is said of a soil but the names of its files."""
    return {key: of for key, of in soil.items() if key not in ("curve", "curves")}


def told(rules):
    """What is compared of a record of rules."""
    return {"rules": rules["rules"], "base": sizes(rules["base"]), "filter": sizes(rules["filter"])}


def shown(page):
    """What the page of serve shows of a pair: the sizes of the base, and the rules that are not met, as their table has them."""
    rows = [row for part in page["parts"] for row in part["rows"]]
    return {"base": sizes(page["base"]), "not met": sorted(row[1] for row in rows if row[0] == "not met" and LEAST not in row[1])}


def as_shown(rules):
    """The same of a record of rules: the page leaves out those of the walk, and names two rules of one limit once."""
    listed = {rule["name"]: rule for rule in rules["rules"] if rule["role"] != "walk" and LEAST not in rule["name"]}
    broken = {name for name, rule in listed.items() if rule["met"] is False}
    if rules["base"]["dispersive"] and len({listed[name]["limit"] for name in BOTH}) == 1 and broken & BOTH:
        broken = broken - BOTH | {ONE}
    return {"base": rules["base"], "not met": sorted(broken)}


def refusal(words):
    """A refusal without the names of the files and of the flag, which differ by face, and without what leads it."""
    words = re.sub(r"^(error|refused): (base \S+, filter \S+: )?|^base \S+, filter \S+: ", "", words.strip())
    return {"refused": " ".join(re.sub(r",? or say that they are as given.*$", "", words).split())}


def called(binary, folder, at, flags, command, *more):
    words = [binary, command, f"base-{at}.csv", f"filter-{at}.csv", *more]
    words += ["--dispersive"] * flags["dispersive"] + ["--as-given"] * flags["as_given"]
    words += ["--joint-mm", str(flags["joint_mm"])] if "joint_mm" in flags else []
    before = os.listdir(folder)
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode in (0, 2), f"{words}: exit code {done.returncode}\n{done.stderr}"
    assert done.returncode == 0 or os.listdir(folder) == before, f"{words}: refused and left something"
    return done


def by_command(*pair):
    done = called(*pair, "rules", "--json")
    return told(json.loads(done.stdout)) if done.returncode == 0 else refusal(done.stderr)


def judged_otherwise(binary, folder, at, flags, first):
    """What `judge` says otherwise than `rules`. It may refuse more: a base of one size has rules and no walk."""
    try:
        done = called(binary, folder, at, flags, "judge", "--quick", "-q", "--out", f"out-{at}", *common.sets(SMALL))
    except subprocess.TimeoutExpired:
        return []
    if done.returncode == 2 or "refused" in first:
        return ["rules refuse, judge walks"] * (done.returncode == 0)
    outcome = json.loads((folder / f"out-{at}" / "outcome.json").read_text())
    of_rules, of_judge = ({rule["id"]: [rule[key] for key in ("value", "limit", "met")] for rule in rules if rule["role"] != "walk"}
                          for rules in (first["rules"], outcome["rules"]))
    return [f"{rule}: {said}, of judge {of_judge.get(rule)}" for rule, said in of_rules.items() if of_judge.get(rule) != said]


class Server:
    def __init__(self, binary, out):
        command = [binary, "serve", "--out", out]
        self.child = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.url = self.child.stdout.readline().split()[1]

    def stop(self):
        self.child.terminate()
        self.child.wait()

    def ask(self, path, body=None):
        try:
            with urllib.request.urlopen(urllib.request.Request(self.url + path, data=body)) as answer:
                return json.load(answer)
        except urllib.error.HTTPError as error:
            return refusal(json.load(error)["problem"])

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


PYTHON = """
import json, sys, voidwalk as vw
for line in sys.stdin:
    base, filter_, flags = json.loads(line)
    try:
        print(json.dumps(vw.rules(base, filter_, **flags)), flush=True)
    except (ValueError, vw.VoidwalkError) as error:
        print(json.dumps({"refused": str(error)}), flush=True)
"""


def main():
    parser = common.parser(__doc__)
    parser.add_argument("--python", default=sys.executable, type=lambda text: pathlib.Path(text).absolute())
    parser.add_argument("--pairs", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    binary, server = options.binary.resolve(), None
    counted = {"the same rules": 0, "the same refusal": 0, "different": 0}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        python = subprocess.Popen([options.python, "-c", PYTHON], cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        for at, (base, filter_, flags) in enumerate(pairs(options.pairs, options.seed)):
            common.sheet(folder / f"base-{at}.csv", base)
            common.sheet(folder / f"filter-{at}.csv", filter_)
            if at % PAIRS_A_SERVER == 0:
                if server:
                    server.stop()
                server = Server(binary, folder / f"serve-{at}")
            first, page = by_command(binary, folder, at, flags), server.rules(folder, at, flags)
            print(json.dumps([f"base-{at}.csv", f"filter-{at}.csv", flags]), file=python.stdin, flush=True)
            got = json.loads(python.stdout.readline())
            got = refusal(got["refused"]) if "refused" in got else told(got)
            otherwise = judged_otherwise(binary, folder, at, flags, first)
            is_same = got == first and page == (first if "refused" in first else as_shown(first)) and not otherwise
            counted["different" if not is_same else "the same refusal" if "refused" in first else "the same rules"] += 1
            if not is_same:
                print(f"pair {at} {flags} base {base} filter {filter_}", *otherwise, sep="\n  ")
                for face, said in (("command line", first), ("serve", page), ("Python", got)):
                    print(f"  {face}: {json.dumps(as_shown(said) if 'rules' in said else said)[:900]}")
        server.stop()
        python.stdin.close()
    print(", ".join(f"{count} {what}" for what, count in counted.items()))
    return 1 if counted["different"] else 0


if __name__ == "__main__":
    sys.exit(main())
