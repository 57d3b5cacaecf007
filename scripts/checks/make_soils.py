#!/usr/bin/env python3
"""Writes the files of tests/soils: sieve tables as laboratories write them, and what must be made of each.

    pip install openpyxl odfpy && scripts/checks/make_soils.py

Beside each file stands a .txt. A file that is taken has a line for each soil, `NAME | size percent, size percent, ...` (mm, percent
finer), and `note:` lines, of which each must be in a note of the first soil. A file that is refused has `refused:` lines, of which each
must be in the message. The files are committed; the script is run again only to change them.
"""

import datetime
import io
import pathlib
import struct
import sys
import zipfile

HERE = pathlib.Path(__file__).resolve().parents[2] / "tests" / "soils"
BASE = [(0.075, 2), (0.15, 10), (0.3, 30), (1.18, 60), (4.75, 98), (9.5, 100)]


def points(rows):
    return ", ".join(f"{size:g} {percent:g}" for size, percent in sorted(rows))


def put(name, content, soils=None, notes=(), refused=()):
    """A file with its expectation; soils: {name: rows} or rows of one soil without a name."""
    content = content.encode() if isinstance(content, str) else content
    (HERE / name).write_bytes(content)
    expect(name, soils, notes, refused)


def expect(name, soils, notes=(), refused=()):
    soils = soils if isinstance(soils, dict) else {"": soils} if soils else {}
    lines = [f"{soil} | {points(rows)}" for soil, rows in soils.items()]
    lines += [f"note: {note}" for note in notes] + [f"refused: {part}" for part in refused]
    (HERE / (name + ".txt")).write_text("\n".join(lines) + "\n")


def table(rows, separator=",", comma=False, percent="", header="opening_mm,percent_finer", end="\n"):
    def number(value):
        return f"{value:g}".replace(".", ",") if comma else f"{value:g}"

    lines = [header.replace(",", separator)] if header else []
    lines += [f"{number(size)}{separator}{number(share)}{percent}" for size, share in rows]
    return end.join(lines) + end


def texts():
    down = sorted(BASE, reverse=True)
    # As today.
    put("plain.csv", table(down), BASE)
    put("ascending.csv", table(BASE), BASE)
    put("no_header.csv", table(down, header=""), BASE)
    put("bom.csv", b"\xef\xbb\xbf" + table(down).encode(), BASE)
    put("crlf.csv", table(down, end="\r\n"), BASE)
    put("semicolon_comma.csv", table(down, ";", True), BASE)
    put("tab.csv", table(down, "\t"), BASE)
    put("quoted_decimals.csv", "size,passing\n" + "".join(f'"{s:g}","{p:g}"\n'.replace(".", ",") for s, p in down), BASE)
    put("nbsp.csv", "size;passing\n" + "".join(f"{s:g}\u00a0;\u00a0{p:g}\n" for s, p in down), BASE)
    put("blank_lines.csv", table(down).replace("\n", "\n\n"), BASE)
    put("trailing_columns.csv", table(down).replace("\n", ",,\n"), BASE)
    put("comments.csv", "# lab 7\n" + table(down) + "# end\n", BASE)
    put("several_100.csv", table([(75, 100), (19, 100)] + down), BASE)
    put("swapped.csv", "percent_finer,opening_mm\n" + "".join(f"{p:g},{s:g}\n" for s, p in down), BASE)
    # Encodings.
    put("utf16le.csv", b"\xff\xfe" + table(down, "\t").encode("utf-16-le"), BASE, ["UTF-16LE"])
    put("utf16be.csv", b"\xfe\xff" + table(down, ";", True).encode("utf-16-be"), BASE, ["UTF-16BE"])
    put("utf16_no_mark.csv", table(down).encode("utf-16-le"), BASE, ["UTF-16LE"])
    put("cp1252.csv", table(down, ";", True, header="Sieböffnung (mm);Durchgang (%)").encode("cp1252"), BASE, ["Windows-1252"])
    put("old_mac.csv", table(down, end="\r"), BASE)
    put("sep_line.csv", "sep=;\r\n" + table(down, ";", True, end="\r\n"), BASE)
    # Percents.
    put("percent_sign.csv", table(down, percent="%"), BASE)
    put("percent_sign_comma.csv", table(down, ";", True, percent=" %"), BASE)
    put("percent_0_decimals.csv", "size;passing\n9,5;100,0 %\n4,75;98,0 %\n0,075;2,0 %\n", [(9.5, 100), (4.75, 98), (0.075, 2)])
    put("fractions.csv", "size_mm,fraction finer\n" + "".join(f"{s:g},{p / 100:g}\n" for s, p in down), BASE, ["fractions"])
    put("fractions_no_header.csv", "".join(f"{s:g},{p / 100:g}\n" for s, p in down), BASE, ["fractions"])
    put("fractions_as_percent.csv", "opening_mm,percent_finer\n" + "".join(f"{s:g},{p / 100:g}\n" for s, p in down),
        refused=["line 2, percent_finer", "look like fractions"])
    put("fractions_short.csv", "size_mm,passing\n4,0.97\n2,0.5\n1,0.1\n", refused=["line 2, percent_finer: \"0.97\"", "look like fractions"])
    # US sieves, inches, units.
    c33 = [(9.5, 100), (4.75, 97), (2.36, 85), (1.18, 65), (0.6, 40), (0.3, 18), (0.15, 5), (0.075, 1)]
    put("us_names.csv", 'Sieve,Percent passing\n"3/8""",100\nNo. 4,97\nNo. 8,85\nNo. 16,65\nNo. 30,40\nNo. 50,18\nNo. 100,5\nNo. 200,1\n',
        c33, ["ASTM E11"])
    put("us_unquoted.csv", 'Sieve,Percent passing\n3/8",100\n#4,97\n#8,85\n#16,65\n#30,40\n#50,18\n#100,5\n#200,1\n', c33, ["ASTM E11"])
    gravel = [(75, 100), (37.5, 90), (19, 60), (9.5, 30), (4.75, 5)]
    put("inches.csv", 'Sieve;% passing\n3";100\n1 1/2";90\n3/4";60\n3/8";30\nNo. 4;5\n', gravel, ["ASTM E11"])
    put("inches_bare.csv", 'Opening (in),% passing\n3,100\n1.5,90\n0.75,60\n0.375,30\n0.187,5\n',
        gravel[:-1] + [(0.187 * 25.4, 5)], ["ASTM E11"])
    put("inches_mixed.csv", 'Sieve,% passing\n1 1/2,100\n1,80\n3/4,60\n3/8,30\n', [(37.5, 100), (25, 80), (19, 60), (9.5, 30)], ["as inches"])
    put("inches_or_mm.csv", 'Sieve,% passing\n1 1/2",100\n1,80\n', refused=["line 3, opening_mm: \"1\"", "its unit"])
    put("cell_units.csv", "Size,Passing\n9.5 mm,100\n4.75 mm,97\n600 um,40\n75 µm,1\n", [(9.5, 100), (4.75, 97), (0.6, 40), (0.075, 1)])
    put("micrometres.csv", "Opening (µm),Passing %\n2000,100\n600,40\n75,1\n", [(2, 100), (0.6, 40), (0.075, 1)], ["micrometres"])
    put("micrometres_as_mm.csv", "opening_mm,passing\n4750,100\n600,40\n75,1\n", [(4750, 100), (600, 40), (75, 1)], ["is the column in micrometres"])
    put("phi.csv", "phi,percent finer\n-2,100\n-1,80\n0,60\n1,40\n3,2\n", [(4, 100), (2, 80), (1, 60), (0.5, 40), (0.125, 2)], ["phi"])
    put("sieve_numbers.csv", "Sieve No.,% passing\n4,100\n10,80\n40,30\n200,3\n", [(4.75, 100), (2, 80), (0.425, 30), (0.075, 3)], ["ASTM E11"])
    put("date.csv", "Sieve,% passing\n04-Mar,100\n03-Aug,40\nNo. 4,5\n", refused=["line 2, opening_mm: \"04-Mar\"", "a date"])
    # The pan, what is retained.
    put("pan.csv", table(down) + "Pan,0\n", BASE, ["pan"])
    put("pan_zero.csv", table(down) + "0,0\n", BASE, ["pan"])
    put("pan_above_0.csv", table(down) + "Pan,2.1\n", refused=["line 8, percent_finer: \"2.1\"", "pan"])
    put("pan_0_mm.csv", "Sieve,% passing\n4 mm,100\n1 mm,20\n0 mm,2\n", refused=["line 4, percent_finer: \"2\"", "pan"])
    put("below.csv", "Opening (µm),% finer\n2000,100\n600,40\n<75,1\n", [(2, 100), (0.6, 40), (0.075, 1)])
    soil = [(4, 100), (2, 80), (1, 50), (0.5, 10)]
    put("mass_retained.csv", "Sieve (mm),Mass retained (g)\n4,0\n2,100\n1,150\n0.5,200\nPan,50\n", soil, ["masses retained"])
    put("mass_total.csv", "Sieve (mm),Mass retained (g)\n4,0\n2,200\n1,150\n0.5,100\nTotal,500\n", [(4, 100), (2, 60), (1, 30), (0.5, 10)], ["masses retained"])
    put("mass_no_pan.csv", "Sieve (mm),Mass retained (g)\n4,0\n2,100\n1,150\n0.5,200\n", refused=["line 5, percent_finer", "pan"])
    put("percent_retained.csv", "Sieve (mm),% retained\n4,0\n2,20\n1,30\n0.5,40\nPan,10\n", soil, ["percents retained"])
    put("cumulative_retained.csv", "Sieve (mm),Cumulative % retained\n4,0\n2,20\n1,50\n0.5,90\n", soil, ["cumulative percents retained"])
    put("retained_unclear.csv", "Sieve (mm),% retained\n4,0\n2,10\n1,20\n0.5,40\n", refused=["cumulative", "individual"])
    put("retained_wrong_sum.csv", "Sieve (mm),% retained\n4,0\n2,20\n1,30\n0.5,10\nPan,10\n", refused=["sum to 70"])
    # Titles, other columns.
    put("titles.csv", "Project: Dam, north abutment\nDate,22.11.2026\nSample no.,12\nDepth,3.5\n\nOpening (mm),% passing\n"
        + table(down, header=""), BASE)
    put("titles_comma_semicolon.csv", "Damm, Nordseite\nProbe, 12\n" + table(down, ";", True, header="Siebgröße in mm;Durchgang in %"), BASE)
    put("units_row.csv", "Sieve,Passing\nmm,%\n" + table(down, header=""), BASE)
    put("three_columns.csv", 'Sieve,Opening (mm),% passing\n"3/8""",9.5,100\nNo. 4,4.75,97\nNo. 200,0.075,1\nPan,,0\n',
        [(9.5, 100), (4.75, 97), (0.075, 1)], ["pan"])
    put("three_no_header.csv", "No. 4,4.75,100\nNo. 40,0.425,30\nNo. 200,0.075,1\n", [(4.75, 100), (0.425, 30), (0.075, 1)])
    put("all_columns.csv", "Sieve mm,Mass retained g,% retained,Cum. % retained,% passing\n4,0,0,0,100\n2,100,20,20,80\n1,150,30,50,50\n0.5,200,40,90,10\nPan,50,10,100,\n", soil)
    put("blank_cell.csv", "mm,passing\n9.5,100\n4.75,\n2,-\n1,50\n0.5,10\n", [(9.5, 100), (1, 50), (0.5, 10)], ["lines 3, 4 have no percent"])
    put("hydrometer.csv", "Sieve (mm),% finer\n2,100\n0.425,70\n0.075,35\nHydrometer\nSieve (mm),% finer\n0.032,21\n0.002,6\n",
        [(2, 100), (0.425, 70), (0.075, 35), (0.032, 21), (0.002, 6)], ["line 5 taken as a remark"])
    put("footer.csv", table(down) + "Tested by,J. Smith\n", BASE, ["remark"])
    put("several.csv", "Sieve (mm),Filter A,Base 1\n9.5,100,100\n4.75,60,100\n2,10,\n0.075,0,40\n",
        {"Filter A": [(9.5, 100), (4.75, 60), (2, 10), (0.075, 0)], "Base 1": [(9.5, 100), (4.75, 100), (0.075, 40)]})
    # Refused, as it should be.
    put("not_monotone.csv", table([(4, 100), (2, 40), (1, 50)]), refused=["line 4, percent_finer", "line 3"])
    put("twice.csv", table([(4, 100), (2, 40), (2, 30)]), refused=["line 4, opening_mm", "line 3"])
    put("top_97.csv", table([(4, 97), (2, 40), (1, 5)]), refused=["line 2, percent_finer", "100 at the coarsest"])
    put("empty.csv", "", refused=["no row of numbers"])
    put("only_header.csv", "opening_mm,percent_finer\n", refused=["no row of numbers"])
    put("one_row.csv", "opening_mm,percent_finer\n4,100\n", refused=["at least two openings"])
    put("comma_in_comma.csv", "opening_mm,percent_finer\n4,100\n0,5,20\n", refused=["line 3", "decimal commas"])
    put("thousands.csv", "opening;finer\n1,000;20.5\n2,000;100.0\n", refused=["thousands"])
    put("old_excel.csv", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600), refused=["old kind (.xls)"])
    put("pdf.csv", b"%PDF-1.7\n...", refused=["PDF"])
    put("zeros.csv", b"4,100\n2,\x0050\n", refused=["line 2", "0x00"])
    put("by_number.csv", "opening_mm,percent finer by number\n4,100\n2,50\n", refused=["line 1, header", "by mass"])
    put("metres.csv", "opening (m),passing\n0.004,100\n0.002,50\n", refused=["line 1, header", "openings in mm"])


AGS = """"GROUP","PROJ"
"HEADING","PROJ_ID"
"DATA","P1"

"GROUP","GRAT"
"HEADING","LOCA_ID","SAMP_TOP","SPEC_DPTH","GRAT_SIZE","GRAT_PERP","GRAT_TYPE"
"UNIT","","m","m","%s","%%",""
"TYPE","ID","2DP","2DP","3SF","0DP","PA"
"DATA","BH1","1.50","1.50","0.063","12","HD"
"DATA","BH1","1.50","1.50","0.02","5","HD"
"DATA","BH1","1.50","1.50","2","100","WS"
"DATA","BH1","1.50","1.50","0.425","60","WS"
"DATA","BH1","1.50","1.50","0.063","12","WS"
"DATA","BH2","3.00","3.00","20","100","WS"
"DATA","BH2","3.00","3.00","2","%s","WS"
"DATA","BH2","3.00","3.00","0.063","1","WS"
"""


def ags():
    bh1 = [(0.02, 5), (0.063, 12), (0.425, 60), (2, 100)]
    put("gradings.ags", AGS % ("mm", "30"), {"BH1 1.50 1.50": bh1, "BH2 3.00 3.00": [(0.063, 1), (2, 30), (20, 100)]})
    put("gradings_bad.ags", AGS % ("mm", "x"), refused=["line 15, percent_finer: \"x\""])
    put("gradings_unit.ags", AGS % ("furlong", "30"), refused=["line 7", "GRAT_SIZE"])
    grag = ('"GROUP","GRAG"\n"HEADING","LOCA_ID","SAMP_TOP","GRAG_UC","GRAG_GRAV","GRAG_SAND","GRAG_FINE"\n'
            '"UNIT","","m","","%","%","%"\n"DATA","BH1","1.50","6.8","0","88","12"\n\n')
    both = AGS % ("mm", "30")
    put("gradings_summary.ags", '"GROUP","PROJ"\n"HEADING","PROJ_ID"\n"DATA","P1"\n\n' + grag,
        refused=["line 8", "GRAG", "a group GRAT with a row for each opening"])
    put("gradings_both.ags", both.replace('"GROUP","GRAT"', grag + '"GROUP","GRAT"'),
        {"BH1 1.50 1.50": bh1, "BH2 3.00 3.00": [(0.063, 1), (2, 30), (20, 100)]}, notes=["GRAG, which sums"])
    put("gradings_types.ags", (AGS % ("mm", "30")),
        {"BH1 1.50 1.50": bh1, "BH2 3.00 3.00": [(0.063, 1), (2, 30), (20, 100)]}, notes=["GRAT_TYPE HD, WS", "line 13 left out, the same"])
    put("gradings_no_unit.ags", AGS % ("", "30"), {"BH1 1.50 1.50": bh1, "BH2 3.00 3.00": [(0.063, 1), (2, 30), (20, 100)]}, notes=["without a unit taken as mm"])
    put("gradings_percent_unit.ags", (AGS % ("mm", "30")).replace('"mm","%"', '"mm","kg"'), refused=["line 7", "GRAT_PERP"])
    put("no_gradings.ags", '"GROUP","PROJ"\n"HEADING","PROJ_ID"\n"DATA","P1"\n', refused=["GRAT"])


def xlsx(name, sheets, change=None, **expected):
    """A workbook of sheets: {name: rows}; `change` may work on the workbook before it is saved."""
    import openpyxl

    book = openpyxl.Workbook()
    book.remove(book.active)
    for title, rows in sheets.items():
        sheet = book.create_sheet(title)
        for row in rows:
            sheet.append(row)
    if change:
        change(book)
    out = io.BytesIO()
    book.save(out)
    put(name, out.getvalue(), **expected)


def ods(name, sheets, percents=False, **expected):
    from odf.opendocument import OpenDocumentSpreadsheet
    from odf.table import Table, TableCell, TableRow
    from odf.text import P

    book = OpenDocumentSpreadsheet()
    for title, rows in sheets.items():
        sheet = Table(name=title)
        for row in rows:
            line = TableRow()
            for value in row:
                if isinstance(value, str):
                    cell = TableCell(valuetype="string")
                else:
                    cell = TableCell(valuetype="percentage" if percents and value is row[1] else "float", value=value)
                cell.addElement(P(text=str(value)))
                line.addElement(cell)
            sheet.addElement(line)
        # As spreadsheets do: empty rows to the end.
        sheet.addElement(TableRow(numberrowsrepeated=1048000))
        book.spreadsheet.addElement(sheet)
    out = io.BytesIO()
    book.write(out)
    put(name, out.getvalue(), **expected)


def workbooks():
    sand = [(0.075, 1), (0.6, 40), (4.75, 97), (9.5, 100)]
    till = [(0.002, 6), (0.075, 35), (4.75, 90), (19, 100)]

    def rows(soil, heading=("Opening (mm)", "% passing")):
        return [list(heading)] + [list(point) for point in sorted(soil, reverse=True)]

    titles = [["Project", "Dam, north"], ["Date", datetime.date(2026, 11, 22)], [], ["Depth (m)", 3.5]]
    xlsx("one.xlsx", {"Sheet1": titles + rows(sand)}, soils=sand)
    xlsx("sheets.xlsx", {"Cover": [["Soils of the dam"]], "Filter A": rows(sand), "Base 1": rows(till)},
         soils={"Filter A": sand, "Base 1": till}, notes=["\"Cover\""])

    def merge(book):
        book.active.merge_cells("B1:C1")

    both = [[size] + [dict(soil).get(size) for soil in (sand, till)] for size in (19, 9.5, 4.75, 0.6, 0.075, 0.002)]
    xlsx("columns.xlsx", {"Soils": [["Sieve (mm)", "Percent passing", None], [None, "Filter A", "Base 1"]] + both}, merge,
         soils={"Soils/Filter A": sand, "Soils/Base 1": till})

    def percents(book):
        for row in book.active.iter_rows(min_row=2, min_col=2):
            row[0].number_format = "0.0%"

    parts = [(size, percent / 100) for size, percent in sand]
    xlsx("percent_cells.xlsx", {"A": rows(parts)}, percents, soils=sand)
    xlsx("fractions.xlsx", {"A": rows(parts)}, soils=sand, notes=["fractions"])
    names = [["Sieve", "mm", "% passing"], ['3/8"', 9.5, 100], ["No. 4", 4.75, 97], ["No. 30", 0.6, 40], ["No. 200", 0.075, 1], ["Pan", None, 0]]
    xlsx("names.xlsx", {"A": names}, soils=sand, notes=["pan"])
    xlsx("only_names.xlsx", {"A": [[row[0], row[2]] for row in names]}, soils=sand, notes=["ASTM E11"])
    xlsx("masses.xlsx", {"A": [["Sieve mm", "Mass retained, g"], [9.5, 0], [4.75, 15], [0.6, 285], [0.075, 195], ["Pan", 5], ["Total", 500]]},
         soils=sand, notes=["masses retained"])
    xlsx("decimal_text.xlsx", {"A": [["Siebgröße, mm", "Durchgang"], ["9,5", "100 %"], ["4,75 mm", "97 %"], ["0,6", "40 %"], ["0,075", "1 %"]]}, soils=sand)
    xlsx("hydrometer.xlsx", {"A": rows(till[1:]) + [["Hydrometer"], [0.002, 6]]}, soils=till)
    xlsx("formula.xlsx", {"A": rows(sand)[:-1] + [[0.075, "=100-99"]]}, refused=["sheet \"A\", cell B5", "formula"])
    xlsx("date.xlsx", {"A": [["Sieve", "% passing"], [datetime.date(2026, 3, 8), 100], ["No. 4", 60], ["No. 10", 10]]},
         refused=["sheet \"A\", cell A2", "a date"])
    xlsx("bad_value.xlsx", {"A": titles + rows(sand[1:]) + [[0.3, "sixty"], [0.1, 2]]}, refused=["sheet \"A\", cell B9", "sixty"])
    xlsx("not_monotone.xlsx", {"A": rows([(4, 100), (2, 30), (1, 40)])}, refused=["sheet \"A\", cell B4", "row 3"])
    xlsx("empty.xlsx", {"A": []}, refused=["no row of numbers"])
    ods("one.ods", {"Filter": [["Project X"]] + rows(sand)}, soils={"Filter": sand})
    ods("two.ods", {"Filter": rows(sand), "Base": rows(till)}, soils={"Filter": sand, "Base": till})
    ods("percents.ods", {"A": rows(parts[1:])}, percents=True, soils=sand[1:])
    ods("twice.ods", {"A": rows(sand) + [[0.075, 1]]}, refused=["sheet \"A\", cell A6", "every size once"])
    hostile((HERE / "one.xlsx").read_bytes())


def several_tables():
    """Sheets with several tables, each with its own openings."""
    stone8 = [(12.5, 100), (9.5, 90), (4.75, 20), (2.36, 5), (1.18, 2)]
    stone57 = [(37.5, 100), (25, 97), (12.5, 40), (4.75, 5), (2.36, 2)]
    both = {"No. 8 stone": stone8, "No. 57 stone": stone57}
    side = [["No. 8 stone", None, None, "No. 57 stone"], ["Opening (mm)", "% passing", None, "Opening (mm)", "% passing"]]
    side += [[a, b, None, c, d] for (a, b), (c, d) in zip(stone8, stone57)]
    close = [[row[0], row[1]] + row[3:] for row in side]

    def text(rows, separator=","):
        return "".join(separator.join("" if c is None else str(c) for c in row) + "\n" for row in rows)

    def merge(book):
        book.active.merge_cells("A1:B1")
        book.active.merge_cells("D1:E1")

    put("side_by_side.csv", text(side), both)
    put("side_by_side_close.csv", text(close + [["", "", 1.18, 0]]), {"No. 8 stone": stone8, "No. 57 stone": stone57 + [(1.18, 0)]})
    xlsx("side_by_side.xlsx", {"A": side}, merge, soils={f"A/{name}": soil for name, soil in both.items()})
    ods("side_by_side.ods", {"A": [["" if c is None else c for c in row] for row in close]}, soils={f"A/{name}": soil for name, soil in both.items()})
    um = [row[:3] + (["Size (um)", "% finer"] if r == 1 else [round(row[3] * 1000), row[4]] if r > 1 else row[3:]) for r, row in enumerate(side)]
    put("side_by_side_units.csv", text(um), both)
    put("side_by_side_low.csv", text([side[0], ["Opening (mm)", "% passing"], side[2][:2] + [None, "Opening (mm)", "% passing"]]
        + [stone8_row + [None] + row[3:] for stone8_row, row in zip([r[:2] for r in side[3:]] + [["", ""]], side[2:])]),
        {"": stone8, " ": stone57})
    put("side_by_side_low_close.csv", "Sieve (mm),% passing,,\n4,100,Sieve (mm),% passing\n2,60,8,100\n1,10,1,5\n", refused=["line 2, heading: \"Sieve (mm)\""])
    put("openings_behind.csv", "Opening (mm),% passing,Sieve\n4.75,100,No. 4\n2,80,No. 10\n0.075,5,No. 200\n", [(4.75, 100), (2, 80), (0.075, 5)])
    put("openings_behind_differ.csv", "Opening (mm),% passing,Sieve\n4.75,100,3/4 in\n2,80,No. 4\n0.075,5,No. 200\n", refused=["heading: \"Sieve\""])
    put("values_far.csv", "Sieve (mm),A,,Sieve (mm),B,,C\n4,100,,8,100,,100\n2,80,,3,50,,60\n1,50,,1,5,,20\n", refused=["columns 4 to 7", "heading: \"C\""])
    put("openings_unnamed.csv", "Opening (mm),% passing,,Weite,% passing\n12.5,100,,37.5,100\n9.5,90,,25,97\n4.75,20,,12.5,40\n", refused=["heading: \"Weite\"", "what these numbers are"])
    put("openings_no_heading.csv", "Opening (mm),% passing,,,% passing\n12.5,100,,37.5,100\n9.5,90,,25,97\n4.75,20,,12.5,40\n", refused=["line 1, heading", "what these numbers are"])
    put("names_are_numbers.csv", "Sieve (mm),57,8,5\n37.5,100,100,100\n25,97,100,100\n12.5,40,100,50\n4.75,5,20,2\n", refused=["line 1"])
    # A hydrometer beside the sieves, or below them.
    sieved, fine = [(4.75, 100), (2, 91), (0.425, 72), (0.075, 36)], [(0.05, 30), (0.02, 20), (0.005, 15), (0.001, 10)]
    wide = [["Sieve (mm)", "% passing", None, "Diameter (mm)", "% finer"]] + [[a, b, None, c, d] for (a, b), (c, d) in zip(sieved, fine)]
    of_fines = [row[:4] + [new] for row, new in zip(wide, ["% finer", 100, 72, 48, 20])]
    put("hydrometer_right.csv", text(wide), sieved + fine, ["continue the sieves"])
    xlsx("hydrometer_right.xlsx", {"A": wide}, soils=sieved + fine, notes=["rows 2 to 5 of column E continue the sieves"])
    put("hydrometer_of_fines.csv", text(of_fines), refused=["columns 4 to 5, line 2, percent_finer: \"100\"", "at most 36"])
    xlsx("hydrometer_of_fines.xlsx", {"A": of_fines}, refused=["cell E2, percent_finer: \"100\"", "at most 36"])
    put("hydrometer_of_fines_below.csv", "Sieve (mm),% passing\n4.75,100\n0.075,36\nSieve (mm),% passing\n0.05,100\n0.002,10\n", refused=["line 5, percent_finer: \"100\""])
    # Tables below each other, sieves across, samples above the headings, both ends of a specification.
    put("stacked.csv", "Sample ST-5\nSieve (mm),% passing\n4.75,100\n2,91\n\nSample ST-7\nSieve (mm),% passing\n19,100\n2,31\n0.075,3\n",
        {"Sample ST-5": [(4.75, 100), (2, 91)], "Sample ST-7": [(19, 100), (2, 31), (0.075, 3)]})
    st5, st7 = [(4.75, 100), (2, 91), (0.075, 36)], [(4.75, 100), (2, 80), (0.075, 20)]
    across = [["Sample", "No. 4", "No. 10", "No. 200", "Pan"], ["ST-5", 100, 91, 36, 0], ["ST-7", 100, 80, 20, 0]]
    put("across.csv", text(across), {"ST-5": st5, "ST-7": st7}, ["a row for each soil", "ASTM E11"])
    xlsx("across.xlsx", {"A": across}, soils={"A/ST-5": st5, "A/ST-7": st7})
    xlsx("across_bad.xlsx", {"A": [row[:2] + ["x" if row[0] == "ST-7" else row[2]] + row[3:] for row in across]}, refused=["cell C3, percent_finer: \"x\""])
    xlsx("across_not_monotone.xlsx", {"A": across[:1] + [["ST-5", 100, 30, 36, 0]]}, refused=["cell D2, percent_finer: \"36\"", "column C"])
    core = [["Sample:", None, "ST-5", "ST-7"], ["Depth (m)", None, 3.5, 4.5], ["Sieve", "Opening (mm)", "Percent passing", None], ["No. 4", 4.75, 100, 100],
            ["No. 10", 2, 91, 80], ["No. 200", 0.075, 36, 20], ["Hydrometer"], [None, 0.03, 22, 11], ["Dry mass (g)", None, 500, 600],
            ["Specific gravity", None, 2.65, 2.66], ["Notes: washed"]]
    cores = {"ST-5": st5 + [(0.03, 22)], "ST-7": st7 + [(0.03, 11)]}
    put("core.csv", text(core), cores, ["lines 9 to 11 below the table (\"Dry mass (g)\" 500"])
    xlsx("core.xlsx", {"Core": core}, lambda book: book.active.merge_cells("C3:D3"), soils={f"Core/{name}": soil for name, soil in cores.items()})
    mass = [["Sieve", "Opening (mm)", "Retained (g)", "% passing"], ["3/8 in", 9.5, 0, 100], ["No. 4", 4.75, 15, 97], ["No. 200", 0.075, 480, 1],
            ["Pan", None, 5, None], ["Total", None, 500, None], ["Fineness modulus", None, None, 2.65]]
    xlsx("fineness_modulus.xlsx", {"A": mass}, soils=[(9.5, 100), (4.75, 97), (0.075, 1)], notes=["\"Fineness modulus\" 2.65", "not used: column C"])
    xlsx("words_within.xlsx", {"A": core[:3] + [core[8]] + core[3:6] + [core[8], core[7]]}, refused=["sheet \"A\", cell A4", "Dry mass (g)"])
    put("masses_lost.csv", "Sieve (mm),Retained (g)\n4,0\n2,100\n1,150\nPan,50\nLoss on washing,120\n", refused=["line 6", "a part of the whole"])
    put("masses_dry.csv", "Sieve (mm),Retained (g)\n4,0\n2,100\n1,150\nPan,50\nDry mass (g),500\n", refused=["line 6, dry mass: \"500\"", "come to 300"])
    put("ranges.csv", "Sieve (mm),% passing\n9.5,100\n4.75,95-100\n2.36,80 to 100\n0.3,10-30\n0.15,2-10\n",
        {"% passing min": [(9.5, 100), (4.75, 95), (2.36, 80), (0.3, 10), (0.15, 2)],
         "% passing max": [(9.5, 100), (4.75, 100), (2.36, 100), (0.3, 30), (0.15, 10)]}, ["two curves"])
    put("minus_no_4.csv", "Sieve (mm),% passing\n4.75,74\n2,60\n0.075,10\n", refused=["line 2, percent_finer: \"74\"", "100 at the coarsest"])
    # Sizes without a unit.
    put("no_unit.csv", "Sieve,Passing\n4,100\n2,80\n1,50\n0.5,20\n0.25,10\n0.125,1\n", [(4, 100), (2, 80), (1, 50), (0.5, 20), (0.25, 10), (0.125, 1)], ["without a unit taken as mm"])
    put("no_unit_inches.csv", "Sieve,Passing\n1.5,100\n1,95\n.5,40\n.187,5\n.0937,2\n", refused=["line 2, opening_mm: \"1.5\"", "1.5 in or 1.5 mm"])
    put("no_unit_french.csv", "Tamis;Passant\n5;100\n2,5;80\n1,25;50\n0,63;20\n0,315;10\n0,16;5\n0,08;1\n",
        [(5, 100), (2.5, 80), (1.25, 50), (0.63, 20), (0.315, 10), (0.16, 5), (0.08, 1)], ["without a unit taken as mm"])
    put("numbers_among_inches.csv", "Sieve,% passing\n1 1/2,100\n1,97\n1/2,40\n#4,5\n#8,2\n", [(37.5, 100), (25, 97), (12.5, 40), (4.75, 5), (2.36, 2)])
    # Thousands, dates, slips of the pen.
    put("thousands_quoted.csv", 'opening_um,percent\n"1,180",10\n"2,360",50\n"4,750",100\n', refused=["line 2, number: \"1,180\"", "1.180 or 1180"])
    put("thousands_decided.csv", 'opening_mm,percent\n"1,180",10\n"2,360",50\n"4,75",100\n', [(1.18, 10), (2.36, 50), (4.75, 100)], ["read as decimal signs"])
    put("dates_first.csv", "Sieve,% passing\n04-Mar,05-Mar\nNo. 4,100\nNo. 10,40\n", refused=["line 2, opening_mm: \"04-Mar\"", "a date"])
    put("slips_first.csv", "Sieve,% passing\n4..75,1O0\n2,100\n1,40\n", refused=["line 2, opening_mm: \"4..75\""])
    xlsx("dates_first.xlsx", {"A": [["Sieve", "% passing"], [datetime.date(2026, 3, 8), datetime.date(2026, 3, 9)], ["No. 4", 100], ["No. 10", 10]]},
         refused=["sheet \"A\", cell A2", "a date"])
    # What nobody sees, and what stands twice.
    def hide(book):
        book["Old"].sheet_state = "veryHidden"
        book["A"].row_dimensions[3].hidden = True
        book["A"].column_dimensions["B"].hidden = True

    table8 = [["Opening (mm)", "% passing"]] + [list(point) for point in stone8]
    xlsx("hidden.xlsx", {"Old": [["Opening (mm)", "% passing"]] + [list(point) for point in stone57], "A": table8}, hide, soils={"Old": stone57, "A": stone8},
         notes=["its sheet is hidden"])
    xlsx("hidden_rows.xlsx", {"A": table8}, lambda book: setattr(book["A"].row_dimensions[3], "hidden", True), soils=stone8, notes=["row 3 of the sheet, though hidden"])
    one = (HERE / "one.ods").read_bytes()
    cell = '<table:table-cell office:value-type="float" office:value="%s"/>'
    head = '<table:table-cell office:value-type="string"><text:p>%s</text:p></table:table-cell>'
    lines = [head % "Opening (mm)" + head % "% passing"] + [cell % a + cell % b for a, b in stone8]
    content = ('<office:document-content><style:style style:name="t" style:family="table"><style:table-properties table:display="false"/></style:style>'
               '<table:table table:name="A" table:style-name="t">' + "".join(f'<table:table-row{" table:visibility=" + chr(34) + "filter" + chr(34) if r == 2 else ""}>{line}</table:table-row>'
               for r, line in enumerate(lines)) + "</table:table></office:document-content>")
    put("hidden.ods", repacked(one, {"content.xml": content}), stone8, ["its sheet is hidden", "row 3 of the sheet, though hidden"])
    book, sheet = (HERE / "one.xlsx").read_bytes(), "xl/worksheets/sheet1.xml"
    twice = "".join(f'<row r="{r}"><c r="A{r}"><v>{a}</v></c><c r="B{r}"><v>{b}</v></c></row>' for r, a, b in [(1, 4, 100), (2, 2, 50), (2, 1, 20), (3, 0.5, 10)])
    put("row_twice.xlsx", repacked(book, {sheet: f"<worksheet><sheetData>{twice}</sheetData></worksheet>"}), refused=["row 2 stands in sheet \"Sheet1\" twice"])
    cell_twice = '<row r="1"><c r="A1"><v>4</v></c><c r="B1"><v>100</v></c><c r="B1"><v>90</v></c></row>'
    put("cell_twice.xlsx", repacked(book, {sheet: f"<worksheet><sheetData>{cell_twice}</sheetData></worksheet>"}), refused=["cell B1 stands in it twice"])


def washed():
    """What was washed out, rows that are commented out, classes that end at 0, results in other languages."""
    soil = [(8, 100), (2, 85), (0.5, 35), (0.063, 5)]
    sieved = "Sieve (mm),Retained (g)\n8,0\n2,60\n0.5,200\n0.063,120\n"
    put("washed.csv", sieved + "Pan (dry),2\nFines washed out,18\nTotal dry mass before washing,400\n", soil, ["masses retained"])
    put("washed_no_total.csv", sieved + "Pan,2\nFines washed out,18\n", refused=["line 7", "a part of the whole"])
    put("washed_wrong_total.csv", sieved + "Pan,2\nFines washed out,18\nTotal,480\n", refused=["line 7", "a part of the whole"])
    put("washed_beside_percent.csv", "Sieve (mm),% retained,% finer\n8,0,100\n2,15,85\n0.5,50,35\n0.063,30,5\nPan,0.5,5\nLoss by washing,4.5,\n",
        soil, ["that of the finest sieve again"])
    put("mass_in_comment.csv", "Sieve (mm),Retained (g)\n8,0\n# 2,60\n0.5,200\n0.063,120\nPan,20\n", refused=["line 3", "a part of the whole"])
    put("classes_to_0.csv", "Size (mm),% of mass\n8-2,15\n2-0.5,50\n0.5-0.063,30\n0.063-0,5\n", soil, ["percents of classes"])
    put("classes_rising.csv", "Size (mm),Mass (g)\n0 - 0.063,20\n0.063 - 0.5,120\n0.5 - 2,200\n2 - 8,60\n", soil)
    put("results_german.csv", "Probe;Durchgang 8 mm;Durchgang 2 mm;Durchgang 0,063 mm\nP1;100;85;5\nP2;100;91;12,5\n",
        {"P1": [(8, 100), (2, 85), (0.063, 5)], "P2": [(8, 100), (2, 91), (0.063, 12.5)]})


def repacked(book, changes, deflate=zipfile.ZIP_DEFLATED):
    """The zip with parts replaced or added."""
    out = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(book)) as old, zipfile.ZipFile(out, "w", deflate, compresslevel=9) as new:
        for name in old.namelist():
            if name not in changes:
                new.writestr(name, old.read(name))
        for name, content in changes.items():
            new.writestr(name, content)
    return out.getvalue()


def hostile(book):
    """Workbooks that would take gigabytes, or run something."""
    sheet = "xl/worksheets/sheet1.xml"
    put("macros.xlsx", repacked(book, {"xl/vbaProject.bin": b"x"}), refused=["macros"])
    put("bomb.xlsx", repacked(book, {"xl/media/image1.png": bytes(80 << 20)}), refused=["too large", "unpacked"])
    huge = repacked(book, {sheet: b"<worksheet><sheetData>" + b" " * (30 << 20)})
    put("large_sheet.xlsx", huge, refused=["too large", "sheet1.xml"])
    # The directory says a gigabyte; and says less than there is.
    put("gigabyte.xlsx", resized(huge, sheet, 1 << 30), refused=["too large", "unpacked"])
    put("understated.xlsx", resized(huge, sheet, 100), refused=["workbook cannot be read"])
    many = "".join(f'<row r="{r}"><c r="ZZZ{r}"><v>1</v></c></row>' for r in range(1, 1000))
    put("far_column.xlsx", repacked(book, {sheet: f"<worksheet><sheetData>{many}</sheetData></worksheet>"}), refused=["too large"])
    far = '<row r="1"><c r="A1"><v>1</v></c></row><row r="1048576"><c r="A1048576"><v>1</v></c></row>'
    put("far_row.xlsx", repacked(book, {sheet: f"<worksheet><sheetData>{far}</sheetData></worksheet>"}), refused=["too large"])
    # Texts that several cells share, as Excel writes them; a count that is not to be believed.
    strings = ('<sst uniqueCount="1000000000000000000"><si><t>Opening (mm)</t></si><si><r><t xml:space="preserve">% </t></r><r>'
               '<t>passing</t></r><rPh><t>x</t></rPh></si><si><t>3/8&quot; &amp; No. 4</t></si></sst>')
    cells = ('<worksheet><sheetData><row r="1"><c r="A1" t="s"><v>0</v></c><c r="B1" t="s"><v>1</v></c></row><row><c><v>4</v></c><c>'
             '<f>50+50</f><v>100</v></c></row><row r="3"><c r="A3"><v>2.0000000000000004</v></c><c r="B3"><v>%s</v></c></row></sheetData>'
             "</worksheet>")
    put("shared.xlsx", repacked(book, {"xl/sharedStrings.xml": strings, sheet: cells % 50}), {"Sheet1": [(4, 100), (2, 50)]})
    broken = cells.replace("<v>1</v>", "<v>7</v>") % 50
    put("strings.xlsx", repacked(book, {"xl/sharedStrings.xml": strings, sheet: broken}), refused=["a text that is not there"])
    put("broken_xml.xlsx", repacked(book, {sheet: "<worksheet><sheetData><row></c>"}), refused=["XML is broken"])
    put("cut.xlsx", book[: len(book) // 2], refused=["its zip cannot be read"])
    put("zip.xlsx", repacked(b"PK\x05\x06" + bytes(18), {"a.txt": "a"}), refused=["no workbook"])
    one = (HERE / "one.ods").read_bytes()
    cell = '<table:table-cell office:value-type="float" office:value="1" table:number-columns-repeated="%d"/>'
    content = ('<office:document-content><table:table table:name="A"><table:table-row table:number-rows-repeated="%d">'
               + cell + "</table:table-row></table:table></office:document-content>")
    put("repeated.ods", repacked(one, {"content.xml": content % (1000, 10**12)}), refused=["too large"])
    put("repeated_rows.ods", repacked(one, {"content.xml": content % (10**12, 4)}), refused=["too large"])
    put("repeated_both.ods", repacked(one, {"content.xml": content % (1000, 900)}), refused=["too large"])


def resized(book, name, size):
    """The zip with another unpacked size of a part in its directory."""
    data, at = bytearray(book), 0
    while (at := data.find(b"PK\x01\x02", at)) >= 0:
        length = struct.unpack_from("<H", data, at + 28)[0]
        if data[at + 46 : at + 46 + length].decode() == name:
            struct.pack_into("<I", data, at + 24, size)
        at += 4
    return bytes(data)


def results():
    """Tables of results, words of other languages, classes, and what laboratories write beside numbers."""
    a, b = [(19, 100), (4.75, 91), (0.425, 54), (0.075, 23)], [(19, 100), (4.75, 84), (0.425, 37), (0.075, 11.5)]
    both = {"Shell-3": a, "Shell-4": b}

    def rows(first, *names):
        return first + "\n" + "".join(f"{name},{','.join(f'{p:g}' for _, p in soil)}\n" for name, soil in zip(names or both, (a, b)))

    # A sample a row: headings that name openings.
    put("results_p.csv", rows("Sample,P3/4,P#4,P#40,P#200"), both, ["a row for each soil", "ASTM E11"])
    put("results_passing.csv", rows("Sample,Passing 19 mm,Passing 4.75 mm,Passing 0.425 mm,Passing 0.075 mm"), both)
    put("results_percent.csv", rows("Hole,% pass 3/4 in,% pass #4,% pass #40,% pass #200"), both)
    put("results_below.csv", rows("Sample,%<19mm,%<4.75mm,%<0.425mm,%<0.075mm"), both)
    put("results_cum.csv", rows("Sample,Cum 19,Cum 4.75,Cum 0.425,Cum 0.075"), both, ["without a unit taken as mm"])
    put("results_finer.csv", rows("Sample,% finer 3/4 in,% finer No. 4,% finer No. 40,% finer No. 200"), both)
    put("results_behind.csv", rows("Sample,19 mm (%),4.75 mm (%),0.425 mm (%),0.075 mm (%)"), both)
    put("results_fractions.csv", "Filter,P3/4,P#4,P#40,P#200\nA,1.00,0.91,0.54,0.23\nB,1.00,0.84,0.37,0.115\n", {"A": a, "B": b}, ["read as fractions"])
    put("results_properties.csv", "Hole,Depth (m),LL,PI,3/4 in,No. 4,No. 40,No. 200,USCS\nTP7,1.2,38,17,100,91,54,23,SC\n"
        "TP7,2.6,NP,NP,100,84,37,11.5,SM\nTP9,1.2,29,9,100,84,37,11.5,SM\n", {"TP7 1.2": a, "TP7 2.6": b, "TP9": b}, ["not used: column 3 (\"LL\"), column 4 (\"PI\")"])
    put("results_retained.csv", "Sample,Cum. % ret 19 mm,Cum. % ret 4.75 mm,Cum. % ret 0.425 mm,Cum. % ret 0.075 mm\nShell-3,0,9,46,77\n", a, ["percents retained"])
    put("results_numbers.csv", rows("Sample,P 4,P 10,P 40,P 200"), refused=["line 1, opening_mm: \"4\"", "US sieve numbers"])
    put("results_unread.csv", rows("Sample,F19,F4.75,F0.425,F0.075"), refused=["line 1, heading: \"F19\"", "above the percents of \"Shell-3\""])
    put("results_words.csv", rows("Sample,Gravel,Coarse sand,Fine sand,Fines"), refused=["line 1, heading: \"Gravel\""])
    put("results_slip.csv", rows("Sample,P3/4,P#4,P#4O,P#200"), refused=["line 1, heading: \"P#4O\""])
    put("results_bare.csv", rows("").lstrip("\n"), refused=["line 1, heading: \"Shell-3\"", "a row of openings above them"])
    put("results_of_samples.csv", rows("", "Sample 3", "Sample 4").lstrip("\n"), refused=["line 1, heading: \"Sample 3\""])
    put("results_mm.csv", rows("Zone,19,4.75,0.425,0.075"), both, ["a row for each soil"])
    # Lines that begin with #.
    gravel = [(50, 100), (37.5, 93), (19, 71), (4.75, 33), (0.075, 4)]
    put("hash_inches.csv", 'Sieve,% Pass\n2",100\n1.5",93\n0.75",71\n#4,33\n#200,4\n', gravel)
    put("hash_quoted.csv", 'Sieve;% Pass\n"2""";100\n"1.5""";93\n"0.75""";71\n#4;33\n#200;4\n', gravel)
    put("hash_mm.csv", "# laboratory 4\nSieve (mm),Retained (g)\n9.5,0\n#4,60\n0.425,220\n#200,80\nPan,40\n", [(9.5, 100), (4.75, 85), (0.425, 30), (0.075, 10)])
    put("hash_comment.csv", "Sieve (mm),% Pass\n9.5,100\n#6.3,95\n4.75,85\n0.075,10\n", [(9.5, 100), (4.75, 85), (0.075, 10)], ["line 3 with # and a number that is no US sieve taken as comments"])
    put("any_order.csv", 'Sieve,% Pass\nNo. 4,33\nNo. 200,4\n2 in,100\n', [(50, 100), (4.75, 33), (0.075, 4)], ["sorted"])
    # Words of other languages.
    part = [(16, 100), (4, 72), (1, 31), (0.063, 6)]
    retained = ["0", "28", "41", "25", "6"]
    for name, heading, pan in [("spanish", "Malla (mm);Peso retenido (g)", "Receptáculo"), ("turkish", "Elek (mm);Elekte kalan (%)", "Tava"),
                               ("polish", "Sito [mm];Pozostałość [%]", "Denko"), ("czech", "Síto (mm);Zbytek (%)", "Dno"),
                               ("russian", "Сито, мм;Частный остаток, %", "Поддон"), ("greek", "Κόσκινο (mm);Συγκρατούμενο (%)", "Τυφλό"),
                               ("dutch", "Zeef (mm);Zeefrest (%)", "Bodem"), ("swedish", "Sikt (mm);Stannar (%)", "Botten"),
                               ("norwegian", "Sikt (mm);Gjenliggende (%)", "Bunn"), ("japanese", "ふるい目 (mm);残留率 (%)", "受け皿"),
                               ("korean", "체눈 (mm);잔류율 (%)", "받침"), ("chinese", "筛孔 (mm);分计筛余 (%)", "底盘")]:
        sieves = ["16", "4", "1", "0,063", pan]
        put(f"pan_{name}.csv", heading + "\n" + "".join(f"{s};{r}\n" for s, r in zip(sieves, retained)), part, ["retained"])
    put("passing_turkish.csv", "Elek açıklığı (mm);Kalan (%);Geçen (%)\n16;0;100\n4;28;72\n1;69;31\n0,063;94;6\n", part)
    put("passing_polish.csv", "Wymiar oczka [mm];Odsiew [%];Przesiew [%]\n16;0;100\n4;28;72\n1;41;31\n0,063;25;6\n", part)
    put("abbreviated.csv", "Tamis (mm),Ref. part. (g),Ref. part. (%),Ref. cum. (%),Pas. cum. %\n16,0,0,0,100\n4,56,28,28,72\n1,82,41,69,31\n0.063,50,25,94,6\n", part)
    # Numbers as laboratories write them.
    put("top_99_95.csv", table([(16, 99.95)] + part[1:]), part, ["99.95 % at the coarsest size read as 100 %"])
    put("top_99_8.csv", table([(16, 99.8)] + part[1:]), refused=["line 2, percent_finer: \"99.8\""])
    put("bound.csv", "Size (mm),% passing\n16,100\n4,72\n1,31\n0.063,<1\n", part[:3] + [(0.063, 1)], ["<1 in line 5 read as 1 %"])
    put("bound_5.csv", "Size (mm),% passing\n16,100\n4,72\n0.063,<5\n", refused=["line 4, percent_finer: \"<5\"", "anything from 0 to 5"])
    put("footnotes.csv", "Size (mm),% passing\n16,100\n4,72 (1)\n1*,31\n0.063*,6 (a)\n(1) repeated\n* washed\n", part, ["marks of footnotes"])
    put("us_bare_names.csv", "Sieve,% passing\n3/4 in,100\nUS 4,91\nUS Standard Sieve 40,54\nSieve 200 (US),23\n", a, ["ASTM E11"])
    put("thousands_masses.csv", 'Sieve (mm),Mass retained (g)\n16,0\n4,"1,400.0"\n1,"2,050.0"\n0.063,"1,250.0"\nPan (dry),300.0\n', part, ["masses retained"])
    put("phi_masses.csv", "Phi,Weight retained (g),Cumulative wt %\n-4,0,0\n-2,14,28\n0,20.5,69\n2,12.5,94\nPan,3,100\n", [(16, 100), (4, 72), (1, 31), (0.25, 6)], ["rise towards the finer"])
    put("micrometres_mixed.csv", "Sieve,% passing\n20,100\n6.3,72\n600,31\n75,6\n", refused=["line 4, opening_mm: \"600\"", "600 um (0.6 mm) beside 6.3"])
    put("micrometres_rising.csv", "Sieve,% passing\n75,6\n600,31\n6.3,72\n20,100\n", refused=["line 3, opening_mm: \"600\"", "micrometres"])
    # Classes, weighings, samples named in each row.
    put("classes.csv", "Fraction (mm),% of mass\n>16,0\n16-4,28\n4-1,41\n1-0.063,25\n<0.063,6\n", part, ["percents of classes"])
    put("classes_mass.csv", "Size,Mass retained (g)\n16 - 4 mm,56\n4 - 1 mm,82\n1 - 0.063 mm,50\n< 0.063 mm,12\n", part, ["masses retained"])
    put("classes_us.csv", "Size,% retained\n-3/4 in +No. 4,9\n-No. 4 +No. 40,37\n-No. 40 +No. 200,31\n-No. 200,23\n", a)
    put("classes_gap.csv", "Fraction (mm),% retained\n16-4,28\n1-0.063,66\n<0.063,6\n", refused=["line 3, opening_mm: \"1-0.063\"", "one bound in common"])
    put("classes_passing.csv", "Fraction (mm),% passing\n16-4,100\n4-1,72\n", refused=["line 2, heading: \"% passing\""])
    put("classes_no_unit.csv", "Size,% retained\n16-4,28\n4-1,66\n<1,6\n", refused=["line 2, opening_mm: \"16-4\"", "unit"])
    put("weighings.csv", "Sieve (mm),Mass of sieve (g),Mass of sieve + soil (g)\n4,410,410\n1,395,436\nPan,370,379\n", refused=["line 1, header", "subtract"])
    put("weighings_retained.csv", "Sieve (mm),Mass of sieve + retained soil (g)\n4,41\n1,43\nPan,37\n", refused=["line 1, header", "subtract"])
    put("weighings_net.csv", "Sieve (mm),Tare (g),Gross (g),Net (g)\n16,400,400,0\n4,410,466,56\n1,395,477,82\n0.063,380,430,50\nPan,370,382,12\n", part, ["not used: column 2"])
    put("tidy.csv", "Borehole,Depth (m),Size (mm),% passing\n" + "".join(f"B1,{depth},{s:g},{p:g}\n" for depth, soil in ((1.5, a), (3, b)) for s, p in soil)
        + "".join(f"B2,3,{s:g},{p:g}\n" for s, p in part), {"B1 1.5": a, "B1 3": b, "B2": part})
    put("tidy_alone.csv", "Sample,Size (mm),% passing\nA,16,100\nB,4,72\nC,1,31\n", refused=["line 2, row: \"A\"", "a row for each opening"])
    # Workbooks: a cover, names merged over two rows, AGS4.
    upright = [["Opening (mm)", "% passing"]] + [list(point) for point in part]
    xlsx("cover_numbers.xlsx", {"Cover": [["Samples", 2], ["Revision", 1]], "Core": upright}, soils={"Core": part}, notes=["no table was found in sheet \"Cover\""])
    xlsx("covers_only.xlsx", {"Cover": [["Samples", 2], ["Revision", 1]]}, refused=["Cover"])
    merged = [["Sieve (mm)", "BH-5", None, "BH-6"], [None, "% retained", "% passing", "% retained", "% passing"]]
    merged += [[s, 100 - p, p, 100 - q, q] for (s, p), (_, q) in zip(a, b)]
    xlsx("merged_names.xlsx", {"PSD": merged}, lambda book: [book.active.merge_cells(cells) for cells in ("A1:A2", "B1:C1", "D1:E1")],
         soils={"PSD/BH-5": a, "PSD/BH-6": b})
    grat = [["HEADING", "LOCA_ID", "SAMP_TOP", "GRAT_SIZE", "GRAT_PERP"], ["UNIT", None, "m", "mm", "%"], ["TYPE", "ID", "2DP", "3SF", "0DP"]]
    grat += [["DATA", hole, "1.50", s, p] for hole, soil in (("BH5", a), ("BH6", b)) for s, p in soil]
    xlsx("gradings.xlsx", {"PROJ": [["HEADING", "PROJ_ID"], ["UNIT"], ["TYPE", "ID"], ["DATA", "P1"]], "GRAT": grat}, soils={"BH5 1.50": a, "BH6 1.50": b}, notes=["\"PROJ\""])
    put("gradings_plain.csv", "GROUP,GRAT\n" + "".join(",".join(str(c or "") for c in row) + "\n" for row in grat), {"BH5 1.50": a, "BH6 1.50": b})


def main():
    HERE.mkdir(exist_ok=True)
    for old in HERE.iterdir():
        old.unlink()
    texts()
    ags()
    workbooks()
    several_tables()
    results()
    washed()
    print(len(list(HERE.iterdir())) // 2, "files", file=sys.stderr)


if __name__ == "__main__":
    main()
