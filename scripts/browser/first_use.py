#!/usr/bin/env python3
"""Uses the page of `voidwalk serve` as somebody would who has two workbooks and no habit of terminals, and says how long each step took.

    scripts/browser/first_use.py [--binary target/release/voidwalk] [--pictures target/first-use] [--density loose]

Makes two workbooks as a laboratory would (needs openpyxl: pip install openpyxl): three soils of a core in one sheet with title rows and
percent cells, and a filter by the names of its sieves. Then clicks with the mouse at what can be seen, by its words alone, in a headless
Chromium; chooses files in the dialog; waits for what the page says; and prints the page of the run as a PDF. A picture of each step.

The times are those of machine and program. --think SECONDS is added before each click and shown apart: what a reader takes.
"""

import argparse
import base64
import datetime
import json
import pathlib
import signal
import sys
import tempfile
import time

from browser import Browser
from test_serve import Tab, complaints, serve

CORE = [  # mm, then percent finer of three samples
    (4.75, 100, 100, 100), (2.0, 99, 100, 98), (0.85, 97, 98, 95), (0.425, 90, 94, 86), (0.25, 74, 83, 70), (0.15, 48, 61, 46),
    (0.106, 30, 42, 29), (0.075, 16, 25, 17),
]
FILTER = [("3/8 in", 100), ("No. 4", 98), ("No. 8", 88), ("No. 16", 62), ("No. 30", 30), ("No. 50", 9), ("No. 100", 2), ("No. 200", 1)]


def workbooks(folder):
    import openpyxl
    from openpyxl.styles import Font

    core = openpyxl.Workbook()
    sheet = core.active
    sheet.title = "Gradings"
    sheet["A1"] = "West Dam, raising 2026: core material, sieve analysis"
    sheet["A1"].font = Font(bold=True, size=14)
    sheet["A2"], sheet["B2"] = "Laboratory", "Soil Mechanics Laboratory, hall 3"
    sheet["A3"], sheet["B3"] = "Date", datetime.date(2026, 10, 6)
    sheet.append([])
    sheet.append(["Opening (mm)", "TP-1 2.0 m", "TP-1 4.5 m", "TP-3 1.0 m"])
    for mm, *percents in CORE:
        sheet.append([mm, *(percent / 100 for percent in percents)])
        for cell in sheet[sheet.max_row][1:]:
            cell.number_format = "0%"
    sheet.append([])
    sheet.append(["Percent passing by dry mass. Samples washed."])
    core.save(folder / "Core gradings West Dam.xlsx")

    quarry = openpyxl.Workbook()
    sheet = quarry.active
    sheet.title = "Zone 2A"
    sheet["A1"] = "Filter sand, quarry of the north bank"
    sheet["A1"].font = Font(bold=True)
    sheet.append([])
    sheet.append(["Sieve", "Passing (%)"])
    for name, percent in FILTER:
        sheet.append([name, percent])
    notes = quarry.create_sheet("Notes")
    notes["A1"] = "Delivered in three lots; see the delivery notes."
    quarry.save(folder / "Filter sand.xlsx")
    return folder / "Core gradings West Dam.xlsx", folder / "Filter sand.xlsx"


class Person(Tab):
    """Sees words, and clicks on them."""

    def __init__(self, browser, url, pictures, think):
        super().__init__(browser, url, pictures)
        self.think, self.begun, self.last, self.steps = think, time.monotonic(), time.monotonic(), []
        browser.ask("Page.setInterceptFileChooserDialog", self.tab, enabled=True)

    def step(self, name, words):
        """A picture of what is seen, and the time since the step before."""
        now = time.monotonic()
        self.steps.append((words, now - self.last))
        self.picture(f"{len(self.steps):02}-{name}")
        self.last = time.monotonic()

    def place(self, words, within="body"):
        """Where the innermost visible thing with these words is, scrolled into sight."""
        return self.run(f"""(() => {{
          const words = {json.dumps(words)};
          const seen = [...document.querySelector({json.dumps(within)}).querySelectorAll('a, button, label, summary, .link, select, option')]
            .filter(one => one.getClientRects().length && one.textContent.trim().startsWith(words) && !one.disabled);
          if (!seen.length) return null;
          const one = seen[seen.length - 1];
          one.scrollIntoView({{ block: 'center' }});
          const box = one.getBoundingClientRect();
          return [box.left + box.width / 2, box.top + box.height / 2];
        }})()""")

    def press(self, words, within="body"):
        time.sleep(self.think)
        end = time.monotonic() + 20
        while (at := self.place(words, within)) is None:
            if time.monotonic() > end:
                raise SystemExit(f"nothing to click on says {words!r} in {within}")
            time.sleep(0.1)
        for kind in ("mousePressed", "mouseReleased"):
            self.browser.ask("Input.dispatchMouseEvent", self.tab, type=kind, x=at[0], y=at[1], button="left", clickCount=1)

    def choose_file(self, role, path):
        """Clicks on "choose a file" and takes one in the dialog."""
        self.browser.events = [event for event in self.browser.events if event.get("method") != "Page.fileChooserOpened"]
        self.press("choose a file", f'.sheet[data-role="{role}"]')
        self.browser.wait("Page.fileChooserOpened")
        opened = next(event for event in self.browser.events if event.get("method") == "Page.fileChooserOpened")
        self.browser.ask("DOM.setFileInputFiles", self.tab, files=[str(path)], backendNodeId=opened["params"]["backendNodeId"])

    def pick(self, within, words):
        """An entry of a list, as the keyboard or mouse would."""
        time.sleep(self.think)
        found = self.run(f"""(() => {{
          const list = document.querySelector({json.dumps(within)});
          const entry = [...list.options].find(one => one.text.includes({json.dumps(words)}));
          if (!entry || !list.getClientRects().length) return false;
          list.value = entry.value; list.dispatchEvent(new Event('change')); return true;
        }})()""")
        if not found:
            raise SystemExit(f"no entry of {within} says {words!r}")


def opened(browser, before):
    """The tab that a link has opened."""
    for _ in range(100):
        for target in browser.ask("Target.getTargets")["targetInfos"]:
            if target["type"] == "page" and target["targetId"] not in before:
                tab = browser.ask("Target.attachToTarget", targetId=target["targetId"], flatten=True)["sessionId"]
                for domain in ("Page", "Runtime"):
                    browser.ask(f"{domain}.enable", tab)
                return tab
        time.sleep(0.1)
    raise SystemExit("the link opens nothing")


def use(person, core, sand, density, settings):
    person.until("document.querySelector('#version').textContent")
    person.step("opened", "the address that the program prints, opened")
    person.choose_file("base", core)
    person.until("document.querySelector('.sheet[data-role=base] select').options.length > 3")
    person.step("core", "the core's workbook chosen: three soils are in the list")
    person.pick(".sheet[data-role=base] select", "TP-1 4.5 m")
    person.choose_file("filter", sand)
    person.until("document.querySelectorAll('#rules tr').length > 10 && document.querySelector('#curves').naturalWidth > 0")
    person.step("curves", "the second soil and the filter's workbook chosen: curves and rules")
    if density:
        person.pick("#density", density)
        person.step("density", f"density: {density}")
    if settings:
        person.press("Settings as text", "#form")
        person.press("One key=value a line", "#form")
        person.browser.ask("Input.insertText", person.tab, text=settings.replace(",", "\n"))
        person.step("settings", f"settings as text: {settings}")
    person.press("Judge")
    person.until("document.querySelector('.job')")
    person.step("begun", "Judge")
    person.until("['done', 'failed', 'refused'].includes(document.querySelector('.job').dataset.state)", 1800)
    person.step("answer", "the answer is there")
    before = {target["targetId"] for target in person.browser.ask("Target.getTargets")["targetInfos"]}
    # A browser without a window has no dialog to show: that it is asked for is what is seen.
    person.run("""(() => { const real = window.open; window.open = (...how) => {
      const opened = real.apply(window, how);
      opened.addEventListener('load', () => { opened.print = () => { window.asked = true; }; });
      return opened; }; })()""")
    person.press("Print, or save as PDF", ".job")
    tab = opened(person.browser, before)
    for _ in range(100):
        ready = person.browser.ask("Runtime.evaluate", tab, expression="document.readyState", returnByValue=True)
        if ready["result"].get("value") == "complete":
            break
        time.sleep(0.1)
    person.until("window.asked")
    page = person.browser.ask("Page.captureScreenshot", tab, captureBeyondViewport=True)["data"]
    (person.pictures / "page.png").write_bytes(base64.b64decode(page))
    pdf = person.browser.ask("Page.printToPDF", tab, printBackground=True, paperWidth=8.27, paperHeight=11.69)["data"]
    (person.pictures / "report.pdf").write_bytes(base64.b64decode(pdf))
    person.step("printed", "Print, or save as PDF: the run's page and the PDF")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", type=pathlib.Path, default=pathlib.Path("target/release/voidwalk"))
    parser.add_argument("--pictures", type=pathlib.Path, default=pathlib.Path("target/first-use"))
    parser.add_argument("--density", default="", help="what is picked of how densely the filter lies; nothing unless given")
    parser.add_argument("--settings", default="", help="what is typed into the settings as text, with commas: for a program that is slow")
    parser.add_argument("--think", type=float, default=0.0)
    args = parser.parse_args()
    args.pictures.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as root, tempfile.TemporaryDirectory() as profile, Browser(profile) as browser:
        root = pathlib.Path(root)
        core, sand = workbooks(root)
        begun = time.monotonic()
        process, url = serve(str(args.binary.resolve()), root, "served")
        started = time.monotonic() - begun
        try:
            person = Person(browser, url, args.pictures, args.think)
            use(person, core, sand, args.density, args.settings)
            found = complaints(browser)
        finally:
            process.send_signal(signal.SIGTERM)
            process.wait(timeout=60)
    print("| step | s |\n|---|---|")
    print(f"| `voidwalk serve` prints its address | {started:.1f} |")
    for words, seconds in person.steps:
        print(f"| {words} | {seconds:.1f} |")
    print(f"\n{started + sum(seconds for _, seconds in person.steps):.0f} s in all, of which the reader {args.think:g} s a click; pictures in {args.pictures}")
    if found:
        sys.exit("\n".join(found))


if __name__ == "__main__":
    main()
