#!/usr/bin/env python3
"""Reads the workbooks of a run folder and of a specification's folder as other programs would, and compares every number with the
folder's JSON.

    pip install openpyxl
    scripts/checks/check_workbooks.py [--libreoffice] RUN SPECIFICATION

RUN holds outcome.json and verdict.xlsx (voidwalk judge --xlsx), SPECIFICATION what voidwalk design wrote. openpyxl reads the
cells; --libreoffice also has LibreOffice Calc open the workbook and write each sheet as CSV, with the digits that it holds (15).
LibreOffice offers to repair a workbook that is broken and, without a window, refuses it: a copy that is cut short shows that it does.
Ends with 1 where a number of a workbook is not that of the JSON, a sheet is missing, or LibreOffice refuses the workbook.
"""

import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import openpyxl

SHEETS = {
    "verdict.xlsx": ("outcome.json", ["Verdict", "Inputs", "Rules", "Runs", "Gradations", "Provenance"]),
    "specification.xlsx": ("specification.json", ["Specification", "Limits", "Band", "Products", "Steps", "Base"]),
}

# Every sheet as CSV in UTF-8, cells as they are held and not as they are shown.
AS_CSV = "csv:Text - txt - csv (StarCalc):44,34,76,1,,0,false,false,false,false,false,-1"


def numbers(value):
    """Every number of a JSON value."""
    if isinstance(value, bool):
        return
    if isinstance(value, (int, float)):
        yield float(value)
    for inner in value.values() if isinstance(value, dict) else value if isinstance(value, list) else []:
        yield from numbers(inner)


def by_openpyxl(book):
    """The numbers of each sheet, with the place of each."""
    for sheet in openpyxl.load_workbook(book):
        cells = [cell for row in sheet.iter_rows() for cell in row]
        found = [cell for cell in cells if isinstance(cell.value, (int, float)) and not isinstance(cell.value, bool)]
        yield sheet.title, [(cell.coordinate, float(cell.value)) for cell in found]


def opened(book, folder):
    """Whether LibreOffice opens a workbook, having written its sheets into a folder; and what it says."""
    profile = f"-env:UserInstallation=file://{folder}/profile"
    words = ["soffice", profile, "--headless", "--convert-to", AS_CSV, "--outdir", f"{folder}/csv", str(book)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=300)
    said = done.stdout + done.stderr
    return bool(list(pathlib.Path(folder).glob("csv/*.csv"))) and "Error" not in said, said.strip()


def as_number(text):
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def by_libreoffice(book, folder):
    """The same by LibreOffice, and what is wrong."""
    is_open, said = opened(book, folder)
    if not is_open:
        return {}, [f"{book}: LibreOffice does not open it: {said}"]
    sheets = {}
    for path in sorted(pathlib.Path(folder).glob("csv/*.csv")):
        with open(path, newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        cells = [(f"row {at + 1}, column {to + 1}", as_number(cell)) for at, row in enumerate(rows) for to, cell in enumerate(row)]
        sheets[path.stem.split("-", 1)[1]] = [(place, value) for place, value in cells if value is not None]
    return sheets, []


def is_known(value, known):
    """Whether a number with 15 digits is one of these."""
    return any(math.isclose(value, other, rel_tol=1e-14, abs_tol=0) for other in known)


def wrong(folder, with_libreoffice):
    """What is wrong with the workbook of a folder."""
    name = next((name for name in SHEETS if (folder / name).is_file()), None)
    if name is None:
        return [f"{folder}: holds no {' and no '.join(SHEETS)}"]
    record, names = SHEETS[name]
    book, record = folder / name, json.loads((folder / record).read_text())
    read = dict(by_openpyxl(book))
    if list(read) != names:
        return [f"{book}: sheets {list(read)}, not {names}"]
    known = set(numbers(record)) | {float(count) for count in range(len(record.get("replicates", [])) + 1)}
    print(f"{book}: {sum(map(len, read.values()))} numbers on {len(names)} sheets, by openpyxl")
    problems = [f"{book}: {sheet}!{place} is {value}" for sheet, of in read.items() for place, value in of if value not in known]
    if with_libreoffice:
        with tempfile.TemporaryDirectory() as at:
            sheets, refused = by_libreoffice(book.resolve(), at)
        problems += refused
        if not refused:
            print(f"{book}: {sum(map(len, sheets.values()))} numbers on {len(sheets)} sheets, by LibreOffice")
            problems += [] if sorted(sheets) == sorted(names) else [f"{book}: LibreOffice has the sheets {sorted(sheets)}"]
            # A seed is text in a workbook, as it has more digits than a cell holds, and a number of the JSON.
            problems += [f"{book}: {sheet}, {place} is {value} in LibreOffice" for sheet, of in sheets.items() for place, value in of
                         if value not in known and not is_known(value, known)]
            fewer = [sheet for sheet in names if len(sheets.get(sheet, [])) < len(read[sheet])]
            problems += [f"{book}: LibreOffice has fewer numbers on {sheet} than openpyxl" for sheet in fewer]
            with tempfile.TemporaryDirectory() as at:
                cut = pathlib.Path(at) / name
                cut.write_bytes(book.read_bytes()[:-200])
                if opened(cut, at)[0]:
                    problems.append(f"{book}: LibreOffice opens a copy that is cut short, so that it opens this one says nothing")
    return problems


def main():
    folders = [pathlib.Path(word) for word in sys.argv[1:] if not word.startswith("--")]
    problems = [problem for folder in folders for problem in wrong(folder, "--libreoffice" in sys.argv)]
    print("\n".join(problems) or "every number is that of the JSON")
    sys.exit(bool(problems) or not folders)


if __name__ == "__main__":
    main()
