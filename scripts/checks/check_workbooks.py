#!/usr/bin/env python3
"""Reads the workbooks of a run folder and of a specification's folder with openpyxl, as another program would, and compares
every number with the folder's JSON.

    pip install openpyxl
    scripts/checks/check_workbooks.py RUN SPECIFICATION

RUN holds outcome.json and verdict.xlsx (voidwalk judge --xlsx), SPECIFICATION what voidwalk design --steps wrote. Ends with 1
where a number of a workbook is not that of the JSON, or a sheet is missing.
"""

import json
import pathlib
import sys

import openpyxl

SHEETS = {
    "verdict.xlsx": ("outcome.json", ["Verdict", "Inputs", "Rules", "Runs", "Gradations", "Provenance"]),
    "specification.xlsx": ("specification.json", ["Specification", "Limits", "Band", "Products", "Steps", "Base"]),
}


def numbers(value):
    """Every number of a JSON value."""
    if isinstance(value, bool):
        return
    if isinstance(value, (int, float)):
        yield float(value)
    for inner in value.values() if isinstance(value, dict) else value if isinstance(value, list) else []:
        yield from numbers(inner)


def wrong(folder):
    """What is wrong with the workbook of a folder."""
    book = next((name for name in SHEETS if (folder / name).is_file()), None)
    if book is None:
        return [f"{folder}: holds no {' and no '.join(SHEETS)}"]
    record, names = SHEETS[book]
    read = openpyxl.load_workbook(folder / book)
    if read.sheetnames != names:
        return [f"{folder / book}: sheets {read.sheetnames}, not {names}"]
    record = json.loads((folder / record).read_text())
    known = set(numbers(record)) | {float(count) for count in range(len(record.get("replicates", [])) + 1)}
    cells = [cell for sheet in read for row in sheet.iter_rows() for cell in row]
    found = [cell for cell in cells if isinstance(cell.value, (int, float)) and not isinstance(cell.value, bool)]
    print(f"{folder / book}: {len(found)} numbers on {len(names)} sheets")
    return [f"{folder / book}: {cell.parent.title}!{cell.coordinate} is {cell.value}" for cell in found if float(cell.value) not in known]


def main():
    problems = [problem for folder in sys.argv[1:] for problem in wrong(pathlib.Path(folder))]
    print("\n".join(problems) or "every number is that of the JSON")
    sys.exit(bool(problems) or len(sys.argv) < 2)


if __name__ == "__main__":
    main()
