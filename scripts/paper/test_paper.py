#!/usr/bin/env python3
"""Tests of the paper's page: rules by hand, the last result, and the page of plans that voidwalk walks on a small network in seconds.

    scripts/paper/test_paper.py [PROGRAM]        # PROGRAM: target/release/voidwalk
"""

import csv
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import plans
from measures import Measures, best_boundary, exceptions, fraction_within, height, rank_correlation, ranks, takes
from statements import AGREES, COUNTED, DIFFERS, FITTED, INCONCLUSIVE, SET, THEIRS, Ours, statements
from study import MAIN, VARIANT, Value, known, size_at, student

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "target/release/voidwalk").resolve()


def table(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def by_hand():
    assert [size_at([(1, 0), (2, 50), (4, 100)], percent) for percent in (0, 25, 50, 75, 100)] == [1, 1.5, 2, 3, 4]
    assert abs(student(1) - 12.706204736) < 1e-8 and abs(student(9) - 2.262157163) < 1e-8 and abs(student(30) - 2.042272456) < 1e-8
    assert ranks([3, 1, 3]) == [2.5, 1, 2.5] and abs(rank_correlation([(i, i * i) for i in range(9)]) - 1) < 1e-12
    assert known(lambda x: height([(1, 10), (2, 30), (4, 20)], x), [0.9, 1, 1.5, 3, 4.1]) == [10, 20, 25]
    share = fraction_within([9.0, 1.0, 5.0, 0.5], 5)
    assert (share.value, share.words) == (75, "3 of 4; the median spread is 3.0 %, the largest 9.0 %")
    # Two cases of one ratio are not parted, whatever their kinds.
    assert best_boundary([(3, False), (6, True), (4, False), (5.5, True)]) == (4, 5.5, 0)
    assert best_boundary([(3, False), (5, False), (5, True), (6, True)]) == (3, 6, 1)


def the_rule_of_judgement():
    records = {one.id: one for one in statements()}
    for value, interval, judgement, by in [(47.9, [], AGREES, None), (50, [42, 58], AGREES, None), (50, [47, 53], INCONCLUSIVE, None),
                                           (50, [49, 51], DIFFERS, 2), (36, [], DIFFERS, -2)]:
        assert records["43"].judge(Value(value, *interval)) == (judgement, by), value
    assert records["43"].judge(None)[0] == records["loose-below-5"].judge(exceptions([False] * 9, 2))[0] == INCONCLUSIVE
    standings = [records["csd-cu1.5-loose"].standing_with(VARIANT[name]) for name in (MAIN, "paper-hull", "overlap-0.5")]
    assert standings == [FITTED, THEIRS, COUNTED]
    for name, value, sentence in [("43", 36, "differs by −7\u202fpoints"), ("voids", 96000, "not counted: the plan sets it"),
                                  ("combinations", 78, "not counted: the plan sets it; differs by +12")]:
        one, measured = records[name], Value(value)
        one.ours = [Ours(VARIANT[MAIN], measured, *one.judge(measured), one.standing_with(VARIANT[MAIN]))]
        assert one.sentence() == sentence, one.sentence()


def the_last_result_is_judged_as_it_was():
    """Statements, tolerances and judgements beside every line of results/paper/statements.csv, which paper.sh renews."""
    records, rows = {one.id: one for one in statements()}, table(ROOT / "results/paper/statements.csv")
    assert {row["id"] for row in rows} == set(records)
    for row in rows:
        one, variant = records[row["id"]], VARIANT[row["variant"]]
        assert [row[key] for key in ("shown", "place", "says", "states", "why")] == [one.shown, one.place, one.says, one.states, one.why]
        assert (float(row["allowed_from"] or "-inf"), float(row["allowed_to"] or "inf")) == (one.low, one.high), one.id
        assert hasattr(Measures, one.measure) and takes(one.measure, variant)
        # No number decides an undecided class, or a largest particle that is only known to be at least as large.
        if row["ours"] and not row["words"].startswith("undecided") and "at least so large" not in row["words"]:
            measured = Value(*(float(row[key]) for key in ("ours", "low", "high") if row[key]), words=row["words"])
            ours = Ours(variant, measured, *one.judge(measured), one.standing_with(variant))
            assert row["judgement"] == ours.words() and (ours.by is None) == (row["differs_by"] == ""), (one.id, variant.name)


def page(folder):
    return subprocess.run([sys.executable, ROOT / "scripts/paper/page.py", folder], capture_output=True, text=True, check=False)


def a_small_reproduction(folder):
    small = "replicates = 2\nnetwork.nx = 6\nnetwork.ny = 6\nnetwork.nz = 8"
    texts = {plan: (ROOT / f"scripts/campaigns/{plan}.toml").read_text(encoding="utf-8") for plan in ("paper", "kenney", "progress")}
    for plan, text in (texts | {made: plans.plan(made) for made in ("table3", "paper-capped")}).items():
        # Of Kenney's bases, those with one or two digits are enough.
        text = re.sub(r'^"0\.\d{3}" .*\n', "", text, flags=re.M)
        (folder / f"{plan}.toml").write_text(text.replace("replicates = 10", small), encoding="utf-8")
        subprocess.run([PROGRAM, "campaign", folder / f"{plan}.toml", "--out", folder / plan, "--quiet"], check=True)
    (folder / "constrictions").mkdir()
    packing = {"grains": 8, "merge_overlap": 0.1, "mean_connectivity": 5.5}
    (folder / "constrictions/constrictions.json").write_text(json.dumps(packing))
    made = page(folder)
    assert (made.returncode, made.stderr) == (0, ""), made.stderr
    rows = table(folder / "statements.csv")
    ours, capped = ({row["id"]: row for row in rows if row["variant"] == plan} for plan in (MAIN, "paper-capped"))
    # 4 filters x 3 bases x 7 sizes, less Dc0 of two filters; 6 x 6 x 8 voids with six constrictions each.
    worked_out = {"combinations": "78", "voids": "288", "connections": "6", "connections-packed": "5.5", "e-cu1.5-loose": "0.6535"}
    assert {name: ours[name]["ours"] for name in worked_out} == worked_out
    assert ours["voids"]["judgement"] == SET and ours["e-cu1.5-loose"]["judgement"] == AGREES
    assert ours["loose-below-5"]["words"].startswith("of 24") and ours["one-dc1"]["judgement"] == INCONCLUSIVE
    # The table that the program writes of the same cases; the cap bites in none, so that its plan tells the same.
    widest = next(row for row in table(folder / "paper/cases.csv") if row["case"] == "filter=cu1.5-loose,cu_b=4.5,d85b=dc0")
    for name, run in (("43", "first"), ("18", "second")):
        assert abs(float(ours[name]["ours"]) - float(widest[f"{run}_eroded_mass_percent"])) < 1e-3
        assert ours[name]["ours"] == capped[name]["ours"]
    text = (folder / "report.html").read_text(encoding="utf-8")
    counts = [sum(row["judgement"] == word for row in ours.values()) for word in (AGREES, DIFFERS, INCONCLUSIVE)]
    assert "Of {} statements, <b>{} agree</b>, <b>{} differ</b>, and <b>{}</b> inconclusive.".format(sum(counts), *counts) in text
    for words in ("Fig. 6", "Table 2", "Table 3", "Every combination", "inconclusive: not walked", "no flow, no gradient, no time"):
        assert words in text, words
    drawn = {path.stem for path in (folder / "figures").iterdir()}
    assert drawn >= {"fig7b", "fig9a", "fig13", "fig14a", "fig16a", "fig17b", "fig18", "fig19b", "fig20"} and "fig6" not in drawn


def what_is_no_reproduction_is_refused(folder):
    refused = page(folder / "paper")
    assert refused.returncode == 2 and "holds no paper/ledger.jsonl" in refused.stderr
    path = next((folder / "paper/cases").iterdir()) / "outcome.json"
    path.write_text(path.read_text(encoding="utf-8").replace('"seed": ', '"seed": 1', 1), encoding="utf-8")
    (folder / "report.html").unlink()
    failed = page(folder)
    assert failed.returncode == 1 and "not what ledger.jsonl says" in failed.stderr and not (folder / "report.html").exists()


if __name__ == "__main__":
    by_hand()
    the_rule_of_judgement()
    the_last_result_is_judged_as_it_was()
    with tempfile.TemporaryDirectory() as place:
        a_small_reproduction(pathlib.Path(place))
        what_is_no_reproduction_is_refused(pathlib.Path(place))
    print("paper: ok")
