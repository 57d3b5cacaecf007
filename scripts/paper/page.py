#!/usr/bin/env python3
"""Writes the page of the paper's reproduction: report.html, figures/*.svg and statements.csv.

    scripts/paper/page.py FOLDER

FOLDER is one that scripts/paper/paper.sh filled. Every number is read from it; what was not walked is said to be missing. Exit codes:
0 done, 1 failed, 2 refused before anything was written. Python 3.11's standard library only.
"""

import argparse
import base64
import hashlib
import pathlib
import sys
import unicodedata
from html import escape

import figures
from statements import AGREES, ALWAYS, COUNTED, DIFFERS, FITTED, INCONCLUSIVE, PAPER, READING, SET, significant, statements, table, whole
from study import MAIN, VARIANT, Malformed, Study, known

STYLE = """
body { font: 16px/1.45 Helvetica, Arial, sans-serif; color: #1a1a1a; max-width: 76rem; margin: 0 auto; padding: 0 1rem 2rem; }
table { border-collapse: collapse; font-size: 0.9rem; } .scroll { overflow-x: auto; }
th, td { text-align: left; vertical-align: top; padding: 0.3rem 0.8rem 0.3rem 0; border-bottom: 1px solid #dddddd; }
td.n, th.n { text-align: right; } table.wide td, table.wide th { font-size: 0.75rem; padding-right: 0.6rem; }
figure { margin: 1rem 0; } svg { max-width: 100%; height: auto; } .small { color: #555555; font-size: 0.85rem; } .keeps { color: #00684c; }
"""
#: Limits of the model, by their names in outcome.json.
LIMITS = {
    "hydraulics": "hydraulics: no flow, no gradient, no time; an increment is not an interval of time",
    "bridging": "bridging: a particle is stopped only by a constriction finer than itself",
    "partial_clogging": "partial clogging: a constriction is open at its full size or blocked",
    "supply": "a limit to what enters: all base particles are offered to the filter",
    "excessive": "the excessive-erosion class of Foster and Fell: the verdict knows no, some and continuing erosion",
    "cohesion": "cohesion, dispersion, suffusion of the filter itself, segregation and layering of the filter",
}
SIGNS = {AGREES: "", DIFFERS: " ✗", INCONCLUSIVE: " ?"}
LETTERS = {"no erosion": "N", "some erosion": "S", "continuing erosion": "C", "undecided": "?"}


def clean(text):
    """A text from a file, without characters that show nothing or turn the writing, escaped."""
    return escape("".join("\ufffd" if unicodedata.category(letter) in ("Cc", "Cf") else letter for letter in str(text)))


def rows(head, body, look=""):
    """A table; cells of the body are HTML, and a cell of a number begins with #."""

    def line(tag, cells):
        made = [f'<{tag} class="n">{cell[1:]}</{tag}>' if cell.startswith("#") else f"<{tag}>{cell}</{tag}>" for cell in cells]
        return f"<tr>{''.join(made)}</tr>"

    lines = "\n".join(line("td", cells) for cells in body)
    return f'<div class="scroll"><table class="{look}"><thead>{line("th", head)}</thead><tbody>\n{lines}\n</tbody></table></div>'


def lead(compared):
    def count(standing):
        return sum(statement.first.standing == standing for statement in compared)

    agree, differ, undecided = (sum(statement.counts_as(word) for statement in compared) for word in (AGREES, DIFFERS, INCONCLUSIVE))
    return f"""<p>Of {count(COUNTED)} statements, <b>{agree} agree</b>, <b>{differ} differ</b>, and <b>{undecided}</b> inconclusive.</p>
<p>{len(compared) - count(COUNTED)} more are shown and not counted: {count(SET)} that the plans set, so that they agree or differ by
construction; {count(ALWAYS)} that every model keeps; {count(FITTED)} to which our rule for merging voids was fitted; {count(READING)}
other readings of statements that are counted.</p>
<p>A statement agrees when our value lies within what the paper states and its tolerance, or when our 95 % interval covers the stated
value. It is inconclusive when nothing was walked or when the interval lies on both sides of what decides; it differs otherwise. No
judgement is typed in, and nothing is tuned to the paper case by case. Where a number differs, the same is measured in campaigns that
change what their names say: grains per void, cap, constriction curves, overlap rule. There, ✗ differs and ? is inconclusive; a campaign
that cannot tell, or in which nothing changes for a number, is not named.</p>"""


def thickness(study):
    """Thickness of the filters of the campaign: the paper counts layers and gives no length."""
    cases = study.cases(MAIN)
    sizes = {}
    for case in cases:
        length, cu = case.network.get("thickness_mm"), case.filter.get("cu")
        length = "" if length is None else significant(length / case.filter["d0_mm"])
        sizes[f"{length} D0F with Cu {'' if cu is None else f'{round(cu, 2):g}'}"] = None
    return f"""<p>Every filter is {cases[0].network["layers"]} layers of voids thick. The voids are as far apart as the median grain by
number is wide, so that this is {clean(", ".join(sizes))}; the paper gives no length. A thicker filter erodes less at the same
D15F/D85B: every boundary on this page holds for this thickness only.</p>""" if cases else ""


def left_out(study):
    names = study.cases(MAIN)[0].outcome["model_leaves_out"] if study.cases(MAIN) else LIMITS
    return f"<h2>What the model leaves out</h2><ul>{''.join(f'<li>{clean(LIMITS.get(name, name))}</li>' for name in names)}</ul>"


def what_differs(compared):
    """The statements that differ, but for those that a setting or a second reading makes differ."""
    lines = [f"<li>{escape(one.says)}: paper <b>{escape(one.states)}</b>, ours <b>{escape(one.show_measured(one.first.measured))}</b>; "
             f"{escape(one.sentence())}.</li>" for one in compared
             if one.first.standing in (COUNTED, FITTED) and one.first.judgement == DIFFERS]
    return f"<h2>What differs, and in which campaign it does not</h2><ul>{''.join(lines)}</ul>" if lines else ""


def small(text):
    return f'<br><span class="small">{escape(text)}</span>' if text else ""


def section(compared):
    body = []
    for one in compared:
        first = one.first
        ours = escape(one.show_measured(first.measured)) + small(first.measured.words) if first.measured else "–"
        others = [f"{other.variant.name} {one.show(other.measured.value)}{'' if other.standing == SET else SIGNS[other.judgement]}"
                  for other in one.ours[1:] if other.measured]
        look = "" if first.judgement == DIFFERS else "keeps" if one.counts_as(AGREES) else "small"
        judgement = f'<span class="{look}">{escape(one.sentence())}</span>'
        body.append([escape(one.says) + small(f"{one.id}: {one.place}"), escape(one.states) + small(one.why), ours, judgement,
                     f'<span class="small">{escape("; ".join(others))}</span>'])
    return rows(["What", "Paper", "Ours (95 % interval)", "Judgement", "Other campaigns"], body)


def combinations(study):
    factors = ("filter", "cu_b", "d85b")

    def cell(plan, levels):
        for case in known(lambda levels: study.case(plan, **levels), [levels]):
            return f"#{case.mean(1):.1f} → {case.mean(2):.1f} {LETTERS[case.verdict]}{' capped' if case.line['capped'] else ''}"
        return ""

    body = []
    for case in study.cases(MAIN):
        levels = {factor: case.level(factor) for factor in factors}
        numbers = [significant(case.d85_ratio), significant(case.d95_ratio), whole(case.line["n_base"])]
        body.append([*map(clean, levels.values()), *("#" + number for number in numbers)]
                    + [cell(variant.name, levels) for variant in study.variants()])
    head = ["filter", "base Cu", "D85B", "#D15F/D85B", "#D15F/D95B", "#N_base"]
    return rows(head + ["#" + variant.title for variant in study.variants()], body, "wide")


def provenance(study):
    def every(key):
        return clean(", ".join(sorted({str(case.line[key] or "not known") for cases in study.campaigns.values() for case in cases})))

    body = []
    for name, cases in study.campaigns.items():
        minutes = sum(case.line["made"]["seconds"] for case in cases) / 60
        replicates = min((case.line["replicates"] for case in cases), default=0)
        title = VARIANT[name].title if name in VARIANT else ""
        body.append([f"<code>{name}.toml</code>", title, f"#{len(cases)}", f"#{replicates}", f"#{minutes:.1f}"])
    plans = rows(["Plan", "Campaign", "#cases", "#replicates", "#minutes"], body)
    return f"{plans}<p>voidwalk {every('version')}, commit {every('commit')}. Seeds are in the plans; a case’s seed is in its ledger.</p>"


def page(study, compared, drawn):
    parts = ['<h1>The paper’s numbers, and ours</h1><p>Shire and O’Sullivan, <cite>A network model to assess base-filter combinations'
             "</cite></p>", lead(compared), thickness(study), left_out(study), what_differs(compared)]
    for key, heading in PAPER["sections"].items():
        parts.append(f"<h2>{escape(heading)}</h2>")
        for figure in drawn:
            if figure.name.rstrip("abc") == f"fig{key}":
                caption = f"<figcaption><b>{escape(figure.title)}.</b> {escape(figure.caption)}</figcaption>"
                parts.append(f"<figure>{figures.svg(figure)}{caption}</figure>")
        parts.append(section([one for one in compared if one.shown == key]))
    parts.append(f"""<h2>Every combination</h2><p class="small">Percent of the base eroded in the first and the second run, and the
class: N no, S some, C continuing erosion, ? undecided. These are all combinations of the paper’s list of filters and bases. It says that
there were 66, which is the list without any one of the six sizes Dc5 to Dc75; it does not say which, so none is left out here.</p>
{combinations(study)}<h2>How this was made</h2>{provenance(study)}""")
    digest = base64.b64encode(hashlib.sha256(STYLE.encode()).digest()).decode()
    policy = f"default-src 'none'; style-src 'sha256-{digest}'; base-uri 'none'; form-action 'none'"
    return f"""<!DOCTYPE html><html lang="en"><head><meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy}"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>The paper’s numbers, and ours</title><style>{STYLE}</style></head><body>
""" + "\n".join(parts) + '\n<p class="small">Regenerated by <code>scripts/paper/paper.sh</code>.</p></body></html>\n'


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    folder = parser.parse_args().folder
    if not (folder / MAIN / "ledger.jsonl").is_file():
        print(f"refused: {folder}: holds no {MAIN}/ledger.jsonl; name a folder that scripts/paper/paper.sh filled", file=sys.stderr)
        return 2
    try:
        study = Study(folder)
        compared = [statement.compare(study) for statement in statements()]
        drawn = figures.figures(study)
        files = {"statements.csv": table(compared), **{f"figures/{figure.name}.svg": figures.svg(figure) for figure in drawn},
                 "report.html": page(study, compared, drawn)}
        (folder / "figures").mkdir(exist_ok=True)
        for name, text in files.items():
            (folder / name).write_text(text, encoding="utf-8")
    except (Malformed, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    print(folder / "report.html")
    return 0


if __name__ == "__main__":
    sys.exit(main())
