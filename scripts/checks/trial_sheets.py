#!/usr/bin/env python3
"""The third trial of a dam engineer, again: sheets as laboratories write them, each read right or refused, each limit worked out by hand.

    scripts/checks/trial_sheets.py --binary target/release/voidwalk [--walk] [--out FILE.md]

Writes the soils of the trial as workbooks, CSV and AGS4, asks `voidwalk soil` and `voidwalk rules` for them, and compares what they say with
sizes and limits that this script works out by itself (linear in percent over the logarithm of size; regrading, Sherard and Dunnigan, Foster and Fell).
With `--walk` it also judges and designs: no page is green where practice says no, the first lines of stdout say what practice says, and no
limit of `design` is beyond practice. Exit code 1 where a row is wrong. Python 3's standard library only.
"""

import argparse
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import zipfile
from xml.sax.saxutils import escape

# Percent finer by mass, by opening (mm), the coarsest first.
NO_8 = [(12.5, 100), (9.5, 92), (4.75, 20), (2.36, 5), (1.18, 2)]
NO_57 = [(37.5, 100), (25, 97), (12.5, 42), (4.75, 5), (2.36, 2)]
SAND_095 = [(2, 100), (1.18, 92), (0.6, 70), (0.3, 30), (0.15, 6), (0.075, 0)]
C33_MID = [(9.5, 100), (4.75, 97), (2.36, 90), (1.18, 68), (0.6, 42), (0.3, 18), (0.15, 4), (0.075, 1)]
C33_COARSE = [(9.5, 100), (4.75, 95), (2.36, 80), (1.18, 55), (0.6, 32), (0.3, 9), (0.15, 2), (0.075, 0)]
GRAVEL_0_32 = [(37.5, 100), (31.5, 95), (16, 70), (8, 48), (4, 36), (2, 27), (1, 20), (0.5, 13), (0.25, 8), (0.125, 4), (0.075, 2)]
SEGREGATED = [(63, 100), (37.5, 75), (19, 45), (9.5, 25), (4, 8), (2, 3), (0.075, 0)]
TILL = [(37.5, 100), (19, 89), (9.5, 82), (4.75, 74), (2, 64), (0.85, 55), (0.425, 48), (0.15, 37), (0.075, 28)]
SILTY_SAND = [(0.85, 100), (0.6, 99), (0.425, 92), (0.25, 80), (0.15, 52), (0.075, 22)]
CLAY_CORE = [(2, 100), (0.425, 98), (0.15, 94), (0.075, 88), (0.05, 80), (0.02, 62), (0.005, 41), (0.002, 30)]
ROCK_TOE = [(400, 100), (250, 60), (150, 35), (100, 20), (60, 8), (20, 0)]
DREDGED = [(1, 100), (0.5, 97), (0.3, 85), (0.2, 55), (0.1, 8), (0.063, 1)]
GAP = [(19, 100), (9.5, 60), (4.75, 25), (0.6, 25), (0.3, 14), (0.15, 3), (0.075, 0)]
FINE_SAND = [(0.25, 100), (0.2, 95), (0.15, 60), (0.1, 20), (0.075, 5)]


# ---- By hand.

def d(soil, percent):
    """The size that `percent` are finer than; None in an open finest tail."""
    rows = sorted(soil)
    if percent < rows[0][1]:
        return None
    for (a, p), (b, q) in zip(rows, rows[1:]):
        if p <= percent <= q and q > p:
            return a * (b / a) ** ((percent - p) / (q - p))
    return rows[0][0] if percent == rows[0][1] else None


def finer(soil, size):
    rows = sorted(soil)
    for (a, p), (b, q) in zip(rows, rows[1:]):
        if a <= size <= b:
            return p + (q - p) * math.log(size / a) / math.log(b / a)
    return 100.0 if size >= rows[-1][0] else None


def regraded(soil):
    """On No. 4, as the manual of the Corps asks where 15 % or more are fines or the soil is broadly graded."""
    fines = finer(soil, 0.075) if min(size for size, _ in soil) <= 0.075 else min(p for _, p in soil)
    d10, d60 = d(soil, 10), d(soil, 60)
    gravel = 100 - finer(soil, 4.75) if max(size for size, _ in soil) > 4.75 else 0
    least = 4 if gravel > (100 - fines) / 2 else 6
    broad = d10 is None or d60 / d10 >= least
    if max(size for size, _ in soil) <= 4.75 or fines < 15 and not broad:
        return soil
    part = finer(soil, 4.75)
    rows = [(size, p * 100 / part) for size, p in soil if size < 4.75]
    return [(4.75, 100.0)] + rows


def design_limit(soil, dispersive=False):
    """Sherard and Dunnigan's maximum D15F (mm); of a dispersive base the most that it can be."""
    soil = regraded(soil)
    fines, d85 = finer(soil, 0.075), d(soil, 85)
    if fines > 85:
        return max((6.4 if dispersive else 9) * d85, 0.2)
    if fines >= 40:
        return 0.5 if dispersive else 0.7
    if fines >= 15:
        return (40 - fines) / 25 * (4 * d85 - 0.7) + 0.7
    return 4 * d85


def no_erosion_limit(soil, dispersive=False):
    soil = regraded(soil)
    fines, d85 = finer(soil, 0.075), d(soil, 85)
    if fines > 85:
        return (6.4 if dispersive else 9) * d85
    if fines >= 35:
        return 0.5 if dispersive else 0.7
    if fines >= 15:
        return 1.6 * ((35 - fines) / 20 * (4 * d85 - 0.7) + 0.7)
    return 7 * d85


# ---- Sheets as they are delivered.

def xlsx(sheets, merged=()):
    """A workbook: sheets {name: rows of cells}; numbers stay numbers."""
    main = "http://schemas.openxmlformats.org/"

    def cell(row, column, value):
        place = f"{chr(65 + column)}{row}"
        if isinstance(value, (int, float)):
            return f'<c r="{place}"><v>{value}</v></c>'
        return f'<c r="{place}" t="inlineStr"><is><t>{escape(str(value))}</t></is></c>'

    def sheet(rows):
        body = "".join(
            f'<row r="{at}">' + "".join(cell(at, column, value) for column, value in enumerate(row) if value != "") + "</row>"
            for at, row in enumerate(rows, 1) if any(value != "" for value in row))
        joined = "".join(f'<mergeCell ref="{ref}"/>' for ref in merged)
        joined = f"<mergeCells>{joined}</mergeCells>" if joined else ""
        return f'<worksheet xmlns="{main}spreadsheetml/2006/main"><sheetData>{body}</sheetData>{joined}</worksheet>'

    import io
    held = io.BytesIO()
    with zipfile.ZipFile(held, "w") as file:
        parts = "".join(
            f'<Override PartName="/xl/worksheets/sheet{at}.xml" ContentType="application/vnd.openxmlformats-officedocument.spreadsheetml.worksheet+xml"/>'
            for at in range(1, len(sheets) + 1))
        file.writestr("[Content_Types].xml", f'<Types xmlns="{main}package/2006/content-types"><Default Extension="rels" '
                      f'ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="xml" ContentType="application/xml"/>{parts}</Types>')
        file.writestr("_rels/.rels", f'<Relationships xmlns="{main}package/2006/relationships"><Relationship Id="rId1" '
                      f'Type="{main}officeDocument/2006/relationships/officeDocument" Target="xl/workbook.xml"/></Relationships>')
        named = "".join(f'<sheet name="{escape(name)}" sheetId="{at}" r:id="rId{at}"/>' for at, name in enumerate(sheets, 1))
        file.writestr("xl/workbook.xml", f'<workbook xmlns="{main}spreadsheetml/2006/main" xmlns:r="{main}officeDocument/2006/relationships"><sheets>{named}</sheets></workbook>')
        related = "".join(f'<Relationship Id="rId{at}" Type="{main}officeDocument/2006/relationships/worksheet" Target="worksheets/sheet{at}.xml"/>'
                          for at in range(1, len(sheets) + 1))
        file.writestr("xl/_rels/workbook.xml.rels", f'<Relationships xmlns="{main}package/2006/relationships">{related}</Relationships>')
        for at, rows in enumerate(sheets.values(), 1):
            file.writestr(f"xl/worksheets/sheet{at}.xml", sheet(rows))
    return held.getvalue()


def csv(rows, separator=",", decimal="."):
    def text(value):
        text = f"{value:g}".replace(".", decimal) if isinstance(value, (int, float)) else str(value)
        return f'"{text}"' if separator in text else text

    return "\n".join(separator.join(text(value) for value in row) for row in rows).encode() + b"\n"


def beside(blocks, heads, gap, titles=True):
    """Blocks side by side: {name: rows}, each with its own column of openings."""
    width = 2 + gap
    rows = [[""] * (width * len(blocks)) for _ in range(max(len(soil) for soil in blocks.values()) + 2)]
    for at, (name, soil) in enumerate(blocks.items()):
        rows[0][at * width] = name if titles else ""
        rows[1][at * width], rows[1][at * width + 1] = heads
        for line, (size, percent) in enumerate(soil):
            rows[2 + line][at * width], rows[2 + line][at * width + 1] = size, percent
    return rows if titles else rows[1:]


US = {37.5: '1 1/2"', 25: '1"', 12.5: '1/2"', 9.5: '3/8"', 4.75: "No. 4", 2.36: "No. 8", 1.18: "No. 16"}


def ags(soils):
    lines = ['"GROUP","GRAT"', '"HEADING","LOCA_ID","SAMP_TOP","SAMP_REF","GRAT_SIZE","GRAT_PERP"', '"UNIT","","m","","mm","%"',
             '"TYPE","ID","2DP","X","2DP","1DP"']
    for (hole, depth, ref), soil in soils.items():
        lines += [f'"DATA","{hole}","{depth}","{ref}","{size:g}","{percent:g}"' for size, percent in soil]
    return ("\r\n".join(lines) + "\r\n").encode()


def core_workbook():
    """Merged titles, two samples, a hydrometer part below, then what a laboratory adds."""
    sieve = [(2, 100, 100), (0.425, 98, 97), (0.15, 94, 93), (0.075, 88, 85)]
    hydrometer = [(0.05, 80, 76), (0.02, 62, 57), (0.005, 41, 37), (0.002, 30, 26)]
    rows = [["PARTICLE SIZE DISTRIBUTION", "", ""], ["Project: north dam", "", ""], [""], ["Sample", "ST-5", "ST-7"],
            ["Sieve opening (mm)", "Percent passing", "Percent passing"], *[list(row) for row in sieve],
            ["Hydrometer diameter (mm)", "Percent passing", "Percent passing"], *[list(row) for row in hydrometer],
            [""], ["Dry mass (g)", 112.4, 118.9], ["Specific gravity", 2.71, 2.70], ["Liquid limit", 38, 36], ["Notes: air dried", "", ""]]
    both = [[(row[0], row[1 + at]) for row in sieve + hydrometer] for at in range(2)]
    return rows, {"ST-5": both[0], "ST-7": both[1]}


def sheets():
    """name: (file, bytes, {soil: rows} or None where it must be refused, words of which one must be in the refusal)."""
    found = {}
    for gap in (0, 1):
        for heads in (("Opening (mm)", "% passing"), ("Sieve (mm)", "Passing (%)"), ("Opening", "%")):
            name = f"beside, {'an' if gap else 'no'} empty column, {heads[0]} | {heads[1]}"
            rows = beside({"No. 8 stone": NO_8, "No. 57 stone": NO_57}, heads, gap)
            soils = {"No. 8 stone": NO_8, "No. 57 stone": NO_57}
            found[name + ", xlsx"] = (xlsx({"Certificate": rows}), "xlsx", soils, ())
            found[name + ", csv"] = (csv(rows), "csv", soils, ())
    named = beside({"No. 8 stone": [(US[s], p) for s, p in NO_8], "No. 57 stone": [(US[s], p) for s, p in NO_57]}, ("Sieve", "% passing"), 1)
    found["beside, sieves by their US names"] = (xlsx({"Certificate": named}), "xlsx", {"No. 8 stone": NO_8, "No. 57 stone": NO_57}, ())
    hydrometer = [(0.075, 100), (0.05, 91), (0.02, 72), (0.005, 48), (0.002, 36)]
    rows = beside({"Core": [(4.75, 100), (2, 99), (0.425, 97), (0.15, 93), (0.075, 88)], "": hydrometer}, ("Opening (mm)", "% passing"), 1, titles=False)
    rows[0][3:5] = ["Diameter (mm)", "% finer"]
    found["hydrometer of the minus No. 200 beside the sieves"] = (xlsx({"Core": rows}), "xlsx", None, ("No. 200", "hydrometer", "Diameter", "finer", "0.075"))
    rows, both = core_workbook()
    found["core workbook: two samples, hydrometer below, masses and limits"] = (xlsx({"PSD": rows}, ("A1:C1", "A2:C2")), "xlsx", both, ())
    mass = [(9.5, 0), (4.75, 15), (2.36, 35), (1.18, 110), (0.6, 130), (0.3, 120), (0.15, 70), (0.075, 15)]
    total, rows, left = 500, [["Sieve (mm)", "Retained (g)", "% passing"]], 500
    for size, kept in mass:
        left -= kept
        rows.append([size, kept, round(100 * left / total, 2)])
    filter_sand = [(row[0], row[2]) for row in rows[1:]]
    rows += [["Pan", left, ""], ["Total", total, ""], [""], ["Fineness modulus", "", 2.81]]
    found["filter sand with pan, total and fineness modulus"] = (xlsx({"Sand": rows}), "xlsx", {"": filter_sand}, ())
    rows = [["Opening (mm)", "% finer"], *map(list, SAND_095), ["D10", 0.19], ["Cu", 2.5]]
    found["D10 and Cu below, csv"] = (csv(rows), "csv", {"": SAND_095}, ())
    sizes = [size for size, _ in C33_MID]
    rows = [["Sample", *[f"{size:g} mm" for size in sizes]], ["A", *[p for _, p in C33_MID]], ["B", *[p for _, p in C33_COARSE]]]
    found["sieves across, a row a sample"] = (csv(rows), "csv", {"A": C33_MID, "B": C33_COARSE}, ())
    rows = [["No. 8 stone", ""], ["Opening (mm)", "% passing"], *map(list, NO_8), ["", ""], ["No. 57 stone", ""], ["Opening (mm)", "% passing"], *map(list, NO_57)]
    found["one table below the other"] = (csv(rows), "csv", {"No. 8 stone": NO_8, "No. 57 stone": NO_57}, ())
    spec = [["Sieve (mm)", "% passing"], [9.5, "100"], [4.75, "95-100"], [2.36, "80-100"], [1.18, "50-85"], [0.6, "25-60"], [0.3, "5-30"], [0.15, "0-10"]]
    low = [(9.5, 100), (4.75, 95), (2.36, 80), (1.18, 50), (0.6, 25), (0.3, 5), (0.15, 0)]
    high = [(9.5, 100), (4.75, 100), (2.36, 100), (1.18, 85), (0.6, 60), (0.3, 30), (0.15, 10)]
    found["a specification: 95-100"] = (csv(spec), "csv", {"min": low, "max": high}, ())
    found["only what passes No. 4 (74 % on top)"] = (csv([["Opening (mm)", "% passing"], *[row for row in TILL if row[0] <= 4.75]]), "csv", None, ("100",))
    inch = [["Sieve", "Passing"], [1.5, 100], [1, 97], [0.5, 42], [0.187, 5], [0.0937, 2]]
    found["inch openings under no unit"] = (csv(inch), "csv", None, ("inch",))
    found["mm under no unit"] = (csv([["Sieve", "Passing"], *map(list, C33_MID)]), "csv", {"": C33_MID}, ())
    rows = [["1 1/2", 100], ["1", 97], ["1/2", 42], ["#4", 5], ["#8", 2]]
    found["#4 and #8 below inch sizes"] = (csv([["Sieve", "% passing"], *rows]), "csv", {"": NO_57}, ())
    found["two specimens of AGS4"] = (ags({("BH2", "6.50", "B7"): TILL, ("BH2", "8.00", "B9"): SILTY_SAND}), "ags",
                                      {"BH2 6.50 B7": TILL, "BH2 8.00 B9": SILTY_SAND}, ())
    found["semicolons and decimal commas"] = (csv([["Korngröße (mm)", "Durchgang (%)"], *map(list, GRAVEL_0_32)], ";", ","), "csv", {"": GRAVEL_0_32}, ())
    return found


PAIRS = {
    "a dispersive clay core on C33, coarse-ish": (CLAY_CORE, C33_COARSE, ["--dispersive"]),
    "a2 the same on C33, middle": (CLAY_CORE, C33_MID, ["--dispersive"]),
    "b till on 0-32 gravel": (TILL, GRAVEL_0_32, []),
    "b2 till on segregated gravel": (TILL, SEGREGATED, []),
    "b3 the same, said to be dispersive": (TILL, SEGREGATED, ["--dispersive"]),
    "c silty fine sand on No. 57": (SILTY_SAND, NO_57, []),
    "c2 silty fine sand on No. 8": (SILTY_SAND, NO_8, []),
    "c3 the same, said to be dispersive": (SILTY_SAND, NO_8, ["--dispersive"]),
    "d dredged sand on rock toe": (DREDGED, ROCK_TOE, []),
    "e fine sand on gap-graded filter": (FINE_SAND, GAP, []),
    "f1 clay core on C33, middle": (CLAY_CORE, C33_MID, []),
    "f2 C33 on No. 57": (C33_MID, NO_57, []),
    "sand on No. 57 of the quarry's certificate": (SAND_095, NO_57, []),
}


class Trial:
    def __init__(self, options, folder):
        self.options, self.folder, self.rows, self.wrong = options, folder, [], 0

    def program(self, *words):
        done = subprocess.run([self.options.binary, *map(str, words)], cwd=self.folder, capture_output=True, text=True)
        return done.returncode, done.stdout, done.stderr

    def row(self, name, what, good):
        self.rows.append((name, what.replace("|", "/").replace("\n", " "), "right" if good else "WRONG"))
        self.wrong += not good
        print(f"{'right' if good else 'WRONG':6} {name}: {what[:220]}")


def same(found, soil):
    # Of several sieves that all of it passes the finest counts.
    whole = min(size for size, percent in soil if percent == 100)
    got, wanted = sorted(map(tuple, found)), sorted(row for row in soil if row[0] <= whole)
    return len(got) == len(wanted) and all(math.isclose(a, c, rel_tol=2e-3) and abs(b - e) < 1e-6 for (a, b), (c, e) in zip(got, wanted))


def read_sheets(trial):
    for at, (name, (content, kind, soils, words)) in enumerate(sheets().items()):
        file = f"sheet-{at}.{kind}"
        (trial.folder / file).write_bytes(content)
        code, out, err = trial.program("soil", file, "--json")
        if soils is None:
            trial.row(name, f"refused: {err.strip()}" if code == 2 else f"exit code {code}", code == 2 and any(word in err for word in words))
            continue
        if code:
            trial.row(name, f"refused: {err.strip()}", False)
            continue
        got = json.loads(out)
        got = got if isinstance(got, list) else got.get("soils", [got])
        good = len(got) == len(soils)
        for one, (wanted, rows) in zip(got, soils.items()):
            good &= same(one["points"], rows) and wanted.lower() in one["name"].lower()
        trial.row(name, "; ".join(f"{one['name']}: D15 {one['d15_mm'] or 0:.3g} mm" for one in got), good)


def apply_rules(trial):
    for at, (name, (base, filter_, flags)) in enumerate(PAIRS.items()):
        write_pair(trial, at, base, filter_)
        code, out, err = trial.program("rules", f"base-{at}.csv", f"filter-{at}.csv", "--json", *flags)
        if code:
            trial.row(name + ", rules", f"refused: {err.strip()}", False)
            continue
        rules = {rule["id"]: rule for rule in json.loads(out)["rules"]}
        dispersive, good, said = "--dispersive" in flags, True, []
        for rule, limit in (("sherard-dunnigan", design_limit(base, dispersive)), ("foster-fell-no-erosion", no_erosion_limit(base, dispersive))):
            d15f, got = d(filter_, 15), rules[rule]
            good &= got["limit"] is not None and math.isclose(got["limit"], limit, rel_tol=0.01) and math.isclose(got["value"], d15f, rel_tol=0.01)
            good &= (got["met"] is False) == (d15f > limit)
            said.append(f"{rule} {got['value']} to {got['limit']} mm, by hand {limit:.4g}: {got['met']}")
        trial.row(name + ", rules", "; ".join(said), good)


def write_pair(trial, at, base, filter_):
    for role, soil in (("base", base), ("filter", filter_)):
        (trial.folder / f"{role}-{at}.csv").write_bytes(csv([["Opening (mm)", "% passing"], *map(list, soil)]))


def walk(trial):
    for at, (name, (base, filter_, flags)) in enumerate(PAIRS.items()):
        began = time.monotonic()
        code, out, err = trial.program("judge", f"base-{at}.csv", f"filter-{at}.csv", "--quick", "--out", f"judged-{at}", *flags)
        seconds = time.monotonic() - began
        if code:
            trial.row(name + ", judge", f"exit code {code}: {err.strip()}", False)
            continue
        outcome = json.loads((trial.folder / f"judged-{at}" / "outcome.json").read_text())
        page = (trial.folder / f"judged-{at}" / "report.html").read_text()
        box = re.search(r'<section class="verdict ([a-z]+)', page).group(1)
        d15f = d(filter_, 15)
        broken = d15f > design_limit(base, "--dispersive" in flags) * 1.0001
        head = "\n".join(line for line in out.splitlines()[:8])
        says = "Practice" in head and (not broken or f"{d15f:.2f}"[:3] in head)
        green = box == "none"
        labels = "as sampled" in page or regraded(base) is base
        good = says and not (green and broken) and labels
        trial.row(name + ", judge", f"{outcome['headline']}; model {outcome['model']['class']}, box {box}, {seconds:.0f} s; practice in the first lines: {says}", good)
    for name, base in (("till", TILL), ("silty sand", SILTY_SAND)):
        (trial.folder / "design-base.csv").write_bytes(csv([["Opening (mm)", "% passing"], *map(list, base)]))
        out_folder = f"design-{name.replace(' ', '-')}"
        began = time.monotonic()
        code, out, err = trial.program("design", "design-base.csv", "--out", out_folder)
        if code:
            trial.row(name + ", design", f"exit code {code}: {err.strip()}", False)
            continue
        greatest = json.loads((trial.folder / out_folder / "specification.json").read_text())["d15f_max_mm"]
        limit = design_limit(base)
        trial.row(name + ", design", f"D15F up to {greatest:.3g} mm by practice; by hand {limit:.3g} mm; {time.monotonic() - began:.0f} s",
                  greatest <= limit * 1.0001)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--binary", default="target/release/voidwalk", type=lambda text: str(pathlib.Path(text).resolve()))
    parser.add_argument("--walk", action="store_true", help="judge and design, too: minutes")
    parser.add_argument("--out", type=pathlib.Path, help="write the table as Markdown")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        trial = Trial(options, pathlib.Path(folder))
        read_sheets(trial)
        apply_rules(trial)
        if options.walk:
            walk(trial)
    if options.out:
        lines = ["| sheet or pair | what the program says | |", "|---|---|---|"] + [f"| {a} | {b} | {c} |" for a, b, c in trial.rows]
        options.out.write_text("\n".join(lines) + "\n")
    print(f"{len(trial.rows) - trial.wrong} of {len(trial.rows)} right")
    return 1 if trial.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
