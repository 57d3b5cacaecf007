#!/usr/bin/env python3
"""Opens a report in a headless Chromium, as a person would, and takes a picture of the whole page, or prints it.

    scripts/browser/look_at_report.py REPORT.html OUT.png [WIDTH [dark]]
    scripts/browser/look_at_report.py REPORT.html OUT.pdf [a4|letter]

WIDTH is that of the window in pixels, 1280 unless given (390 is a telephone); dark sets the screen to dark colours. Fails when the page
breaks its content security policy, logs an error, asks for any other file, is wider than the window, holds two labels that overlap in a
figure or one that is cut off, when a box of a figure does not hide its curve or enlarge it, or when the picture is blank; in print, when
the first page lacks verdict, warnings, rules or the places to sign, when Figure 1 is lettered below 7 pt, when a page has no number, when
a page but the last is mostly empty, or when a word lies on itself. Installs Debian's chromium, and for print poppler-utils, when they are
missing.
"""

import base64
import html
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import zlib

from browser import Browser, need

# What a person would trip over; runs in the finished page.
INSPECT = """(() => {
  const found = [];
  const root = document.documentElement;
  if (root.scrollWidth > root.clientWidth)
    found.push(`page is ${root.scrollWidth} px wide in a window of ${root.clientWidth} px`);
  for (const svg of document.querySelectorAll('svg')) {
    const frame = svg.getBoundingClientRect();
    if (frame.width === 0) continue;
    const texts = [...svg.querySelectorAll('text')].map(t => [t.textContent, t.getBoundingClientRect()]);
    texts.forEach(([a, p], i) => {
      if (p.left < frame.left - 0.5 || p.right > frame.right + 0.5 || p.top < frame.top - 0.5
          || p.bottom > frame.bottom + 0.5) found.push(`${svg.id}: "${a}" is cut off`);
      if (p.height < 9.95) found.push(`${svg.id}: "${a}" is ${p.height.toFixed(1)} px high`);
      for (const [b, q] of texts.slice(i + 1))
        if (p.left < q.right - 1 && q.left < p.right - 1 && p.top < q.bottom - 3 && q.top < p.bottom - 3)
          found.push(`${svg.id}: "${a}" lies on "${b}"`);
    });
  }
  return found;
})()"""


# Each box of a figure hides its curve and no other; the larger figure is larger, and the page no wider.
TRY_BOXES = """(() => {
  const found = [];
  const seen = (part) => part.getClientRects().length > 0;
  for (const figure of document.querySelectorAll('figure:has(.looks)')) {
    const name = figure.querySelector('.looks').getAttribute('aria-label');
    const shown = () => [...figure.querySelectorAll('[class^=curve-]')].filter(seen).map(part => part.getAttribute('class'));
    const all = shown();
    for (const box of figure.querySelectorAll('input:not(.larger)')) {
      const curve = box.className.replace('show-', 'curve-');
      if (!all.includes(curve)) found.push(`${name}: ${curve} is not drawn`);
      box.click();
      if (shown().join() !== all.filter(other => other !== curve).join()) found.push(`${name}: the box of ${curve} hides something else`);
      box.click();
    }
    const [larger, wide] = [figure.querySelector('.larger'), figure.querySelector('.wide svg')];
    const before = Math.max(...[...figure.querySelectorAll('svg')].map(svg => svg.getBoundingClientRect().width));
    larger.click();
    if (!(wide.getBoundingClientRect().width > 1.2 * before)) found.push(`${name}: larger is not larger`);
    if (document.documentElement.scrollWidth > document.documentElement.clientWidth) found.push(`${name}: larger makes the page wide`);
    larger.click();
    if (shown().join() !== all.join()) found.push(`${name}: a curve stays hidden`);
  }
  return found;
})()"""

# Every box the other way round than the page has it.
TURN_BOXES = "document.querySelectorAll('.looks input').forEach(box => box.click())"

# What a reader has hidden on the screen is printed all the same, and no box is.
PRINTED_CURVES = """[...document.querySelectorAll('[class^=curve-]')].filter(part => getComputedStyle(part).display === 'none')
  .concat([...document.querySelectorAll('.looks')].filter(part => part.getClientRects().length > 0)).length"""

# What must stand on the first printed page, so that it can be handed in by itself.
FIRST_PAGE = """[...document.querySelectorAll('.names, header .model, .about div:not(.signed), .practice, .counted, .verdict li, .band, .pair .sizes, .caution, .short, .sheet > figure figcaption')]
  .map(part => part.innerText).concat(document.querySelector('.sign') ? ['Name Date Signature Prepared Checked Approved'] : [])"""

# The least lettering of Figure 1 in print (points), where it stands on the first page.
LEAST_LETTERS = 7
LETTERS = """(() => {
  const found = [];
  for (const svg of document.querySelectorAll('.sheet figure svg, .sheet + figure svg')) {
    const { width } = svg.getBoundingClientRect();
    if (width === 0) continue;
    const scale = width / svg.viewBox.baseVal.width;
    for (const text of svg.querySelectorAll('text'))
      found.push(0.75 * scale * parseFloat(text.getAttribute('font-size') ?? svg.getAttribute('font-size')));
  }
  return found.length ? Math.min(...found) : null;
})()"""

# Width and height in inches.
PAPER = {"a4": (8.27, 11.69), "letter": (8.5, 11.0)}

# Left and right of the text, as the style says (inches).
MARGIN = 13 / 25.4

# A page on which a larger share of the height than this holds no word in one piece is mostly empty.
EMPTY = 0.45


def is_blank(png):
    """Whether a PNG has hardly any values: rows of one colour leave a few after a PNG's filters."""
    place, data = 8, b""
    while place < len(png):
        length, kind = struct.unpack(">I4s", png[place:place + 8])
        data += png[place + 8:place + 8 + length] if kind == b"IDAT" else b""
        place += 12 + length
    return len(set(zlib.decompress(data))) < 8


# What a page takes from a screen that is set to dark.
IS_DARK = "getComputedStyle(document.body).backgroundColor.match(/[0-9]+/g).every(part => Number(part) < 60)"


def look(page, picture, width, dark):
    wanted = pathlib.Path(page).resolve().as_uri()
    faults = []
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile, Browser(profile) as browser:
        tab = browser.open(wanted, width, 900)
        if dark:
            scheme = [{"name": "prefers-color-scheme", "value": "dark"}]
            browser.ask("Emulation.setEmulatedMedia", tab, features=scheme)
        if browser.run(tab, IS_DARK) != dark:
            faults.append("is light on a dark screen" if dark else "is dark on a light screen")
        faults += browser.run(tab, INSPECT) + browser.run(tab, TRY_BOXES)
        size = browser.ask("Page.getLayoutMetrics", tab)["cssContentSize"]
        area = {"x": 0, "y": 0, "width": width, "height": size["height"]}

        def shoot(scale):
            shot = browser.ask("Page.captureScreenshot", tab, format="png", captureBeyondViewport=True,
                               clip={**area, "scale": scale})
            return base64.b64decode(shot["data"])

        pathlib.Path(picture).write_bytes(shoot(1))
        if is_blank(shoot(0.1)):
            faults.append("the picture is blank")
        browser.ask("Page.disable", tab)  # everything logged so far has arrived with this answer
        for event in browser.events:
            faults += complaints(event, wanted)
    return faults


def print_out(page, pdf, paper):
    """Prints the page as a reader would, without backgrounds, and looks at what is on each sheet."""
    width, height = PAPER[paper]
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile, Browser(profile) as browser:
        tab = browser.open(pathlib.Path(page).resolve().as_uri(), 1280, 900)
        first = browser.run(tab, FIRST_PAGE)
        browser.run(tab, TURN_BOXES)
        inside = int(96 * (width - 2 * MARGIN))
        browser.ask("Emulation.setDeviceMetricsOverride", tab, width=inside, height=900, deviceScaleFactor=1, mobile=False)
        browser.ask("Emulation.setEmulatedMedia", tab, media="print")
        wide, letters, hidden = (browser.run(tab, script) for script in ("document.documentElement.scrollWidth", LETTERS, PRINTED_CURVES))
        browser.ask("Emulation.setEmulatedMedia", tab, media="")
        printed = browser.ask("Page.printToPDF", tab, paperWidth=width, paperHeight=height,
                              printBackground=False, preferCSSPageSize=True)
        pathlib.Path(pdf).write_bytes(base64.b64decode(printed["data"]))
    faults = list(faults_of_sheets(sheets(pdf), first))
    if letters is not None and letters < LEAST_LETTERS:
        faults.append(f"Figure 1 is lettered at {letters:.1f} pt on {paper}")
    if hidden != 0:
        faults.append("what is hidden on the screen is not printed, or a box is")
    if wide > inside:
        faults.append(f"is {wide} px wide on a sheet of {inside} px: all of it is printed smaller")
    return faults


def sheets(pdf):
    """Each sheet of a PDF: its height, and its words with where they stand."""
    found = subprocess.run(["pdftotext", "-bbox", pdf, "-"], capture_output=True, check=True, text=True).stdout
    for sheet in found.split("<page ")[1:]:
        words = re.findall(r'<word xMin="(.*?)" yMin="(.*?)" xMax="(.*?)" yMax="(.*?)">(.*?)</word>', sheet)
        height = float(re.search(r'height="(.*?)"', sheet)[1])
        yield height, [([float(edge) for edge in word[:4]], html.unescape(word[4])) for word in words]


def faults_of_sheets(found, first):
    found = list(found)
    there = "".join(word for _, word in found[0][1])
    for part in first:
        missing = [word for word in part.split() if word not in there]
        # a word that is broken at the end of a line is not there in one piece
        if len(missing) > 0.05 * len(part.split()):
            yield f"the first printed page lacks: {' '.join(missing)[:200]}"
    for number, (height, words) in enumerate(found, 1):
        edges = sorted((box[1], box[3]) for box, _ in words)
        gap, reached = 0.0, 0.06 * height
        for top, bottom in edges + [(0.94 * height, 0.94 * height)]:
            gap, reached = max(gap, top - reached), max(reached, bottom)
        if gap > EMPTY * height and number < len(found):
            yield f"printed page {number} of {len(found)} is mostly empty"
        said = [word for box, word in words if box[1] > 0.93 * height]
        if ["page", str(number), "of", str(len(found))] != said[-4:]:
            yield f"printed page {number} does not end with its number: {' '.join(said)}"
        for place, (box, word) in enumerate(words):
            near = (other for other in words[place + 1:] if other[1] == word)
            if any(max(abs(a - b) for a, b in zip(box, other)) < 2.0 for other, _ in near):
                yield f"printed page {number}: \"{word}\" is there twice at one place"


def complaints(event, wanted):
    method, params = event.get("method"), event.get("params", {})
    if method == "Log.entryAdded" and params["entry"]["level"] in ("error", "warning"):
        yield f"{params['entry']['source']}: {params['entry']['text']}"
    elif method == "Runtime.exceptionThrown":
        yield f"script: {params['exceptionDetails']['text']}"
    elif method == "Runtime.consoleAPICalled":
        yield f"console: {params['type']}"
    elif method == "Network.requestWillBeSent" and params["request"]["url"] != wanted:
        yield f"asks for {params['request']['url'][:200]}"


def main():
    if len(sys.argv) not in (3, 4, 5) or not pathlib.Path(sys.argv[1]).is_file():
        sys.exit(__doc__)
    page, out = sys.argv[1:3]
    is_print = out.endswith(".pdf")
    how = (sys.argv + ["a4" if is_print else "1280"])[3]
    dark = sys.argv[4:] == ["dark"]
    need("chromium", *["pdftotext"] * is_print)
    faults = print_out(page, out, how) if is_print else look(page, out, int(how), dark)
    for fault in faults:
        print(f"{page}: {fault}", file=sys.stderr)
    if faults:
        raise SystemExit(1)
    print(f"{out}: {how if is_print else how + ' px wide' + (', dark' if dark else '')}, no complaint")


main()
