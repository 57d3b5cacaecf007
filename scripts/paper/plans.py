#!/usr/bin/env python3
"""Writes the plans that differ in a few lines from scripts/campaigns/paper.toml or paper-published.toml into a folder.

    scripts/paper/plans.py FOLDER

Same names and seeds: what differs from the plan that a variant is made of is the doing of its changes.
"""

import pathlib
import re
import sys

CAMPAIGNS = pathlib.Path(__file__).resolve().parents[1] / "campaigns"
TITLE = "Base-filter combinations of the paper, "
GRAINS, CAP = ["filter.grains_per_void = 2.5"], ["base.cap = 2e8"]
#: Variant: the plan that it is made of; the end of its title; what all cases set; grains per void of single filters; Cu of the bases and
#: combinations that are left out, where only cases are walked in which the cap may bite.
VARIANTS = {
    # What the paper's own Table 3 implies, in place of the grains per void of the packings.
    "paper-2.5": ("paper", "own curves, 2.5 grains per void", GRAINS, {}, None, []),
    "paper-capped": ("paper", "own curves, at most 2e8 base particles", CAP, {}, "4.5", ['d85b = "dc25"', 'd85b = "dc50"', 'd85b = "dc75"']),
    # The nearest to what the paper did, as far as that can be told.
    "paper-2.5-capped": ("paper", "own curves, 2.5 grains per void, at most 2e8 base particles", CAP + GRAINS, {}, "3, 4.5", [
        'd85b = "dc75"', *(f'cu_b = "3"\nd85b = "{size}"' for size in ("dc10", "dc15", "dc25", "dc50")),
    ]),
    # As if the ratio of Eq. (2) had been taken the wrong way round. Table 3's 96 particles a void are those of both runs then.
    "paper-inverse": ("paper", "own curves, voids per grain, at most 2e8 base particles", CAP, {
        "cu1.5-loose": 2.31, "cu1.5-dense": 2.92, "cu3-loose": 2.15, "cu3-dense": 2.6,
    }, None, []),
    # The published curves are those of the voids' convex hulls at 50 % overlap: with the grains per void of that same rule, where the
    # shipped ones carry those of all facets at 10 %.
    "paper-hull": ("paper-published", "published constriction curves with their own grains per void", [], {
        "cu1.5-loose": 0.433, "cu1.5-dense": 0.343, "cu3-loose": 0.465,
    }, None, []),
    "paper-published-2.5": ("paper-published", "published constriction curves, 2.5 grains per void", GRAINS, {}, None, []),
    # Fig. 20 and Table 3: voids with four to eight connections.
    "table3": ("paper", "loose filter with Cu 1.5, voids connected as in Table 3", ['network.connectivity = "table3"'], {}, None, []),
    # What the overlap rule does: the grains of cu1.5-loose, packed again, with voids merged at the number that the paper gives, in place
    # of the one fitted to its Table 2.
    "overlap-0.5": ("paper", "loose filter with Cu 1.5, voids merged at an overlap of 0.5", [], {}, None, []),
}
#: What the only filter of a variant sets.
ALONE = {
    "table3": '"filter.curve" = "cu1.5-loose", "base.dc_curve" = "cu1.5-loose"',
    "overlap-0.5": '"filter.cu" = 1.5, "filter.friction" = 0.3, "packing.grains" = 9313, "packing.merge_overlap" = 0.5',
}
#: The case of Table 3 with the grains per void of paper-2.5 and of paper-inverse.
CASES = {"table3": {"table3-2.5": 2.5, "table3-inverse": 2.31}}


def plan(name):
    """The text of a variant."""
    made_of, title, settings, grains, bases, left_out = VARIANTS[name]
    text = (CAMPAIGNS / f"{made_of}.toml").read_text(encoding="utf-8")
    text = re.sub(r"\A(#.*\n)+", f"# Made of {made_of}.toml by scripts/paper/plans.py.\n", text)
    text = re.sub(r'^title = ".*"$', f'title = "{TITLE}{title}"', text, flags=re.M)
    text = text.replace("replicates = 10\n", "\n".join(["replicates = 10", *settings, ""]))
    for filter, number in grains.items():
        text = text.replace(f'"{filter}" = {{ ', f'"{filter}" = {{ "filter.grains_per_void" = {number}, ')
    if bases:
        text = text.replace("values = [1.5, 3, 4.5]", f"values = [{bases}]")
    if name in ALONE:
        text = re.sub(r'(?s)"cu1.5-loose" = .*?\n\n', f'"cu1.5-loose" = {{ {ALONE[name]} }}\n\n', text).split("\n[[leave_out]]")[0]
    for case, number in CASES.get(name, {}).items():
        sets = f'"filter.curve" = "cu1.5-loose", "filter.grains_per_void" = {number}, "base.cu" = 1.5, "base.d85_at_dc" = 5'
        text += f'\n[[case]]\nname = "{case}"\nset = {{ {sets} }}\n'
    return text + "".join(f"\n[[leave_out]]\n{combination}\n" for combination in left_out)


if __name__ == "__main__":
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for variant in VARIANTS:
        (folder / f"{variant}.toml").write_text(plan(variant), encoding="utf-8")
