#!/usr/bin/env python3
"""Uses the page of `voidwalk serve` in a headless Chromium, as a person would: pastes and drops sheets, gives wrong input, judges, stops,
loads the page again, continues, compares; and takes a picture of every state into target/serve/.

    [PATIENCE=5] scripts/browser/test_serve.py [BINARY]      target/release/voidwalk unless given; every wait PATIENCE times as long

Fails where a state is not reached, where the page logs an error, breaks its content security policy or is wider than its window.
"""

import base64
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

from browser import Browser, need

BASE = "size_mm,percent\n0.08,0\n0.15,40\n0.2,70\n0.3,100\n"
FINE = "size_mm,percent\n0.5,0\n0.7,30\n1.0,70\n1.5,100\n"
COARSE = "size_mm,percent\n1.0,0\n1.5,30\n2.0,70\n3.0,100\n"
SMALL = "network.nx=8\nnetwork.ny=8\nnetwork.nz=10\nrecord.sensitivity=[]"

# Every wait is so many times as long: for a debug build, or a machine that has other things to do.
PATIENCE = float(os.environ.get("PATIENCE", "1"))

# A run that does not end while it is looked at.
LONG = "network.nx=36\nnetwork.ny=36\nnetwork.nz=20\nreplicates=2000\nrecord.sensitivity=[]"

WIDE = "document.documentElement.scrollWidth > document.documentElement.clientWidth"


# Words whose contrast with what lies behind them is below 4.5, as WCAG 2 asks at level AA; buttons that cannot be pressed and drawings apart.
FAINT = """(() => {
  const parts = (text) => { const [r, g, b, a = 1] = text.match(/[\\d.]+/g).map(Number); return { rgb: [r, g, b], a }; };
  const light = (rgb) => rgb.map((c) => c / 255).map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4))
    .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
  const behind = (at) => {
    for (; at; at = at.parentElement) {
      const found = parts(getComputedStyle(at).backgroundColor);
      if (found.a === 1) return found.rgb;
    }
    return matchMedia("(prefers-color-scheme: dark)").matches ? [18, 18, 18] : [255, 255, 255];
  };
  const found = [];
  for (const at of document.querySelectorAll("body *")) {
    const says = [...at.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim());
    if (!says || at.closest("svg, :disabled, script, noscript, [hidden]") || !at.getClientRects().length) continue;
    const [a, b] = [parts(getComputedStyle(at).color).rgb, behind(at)].map(light);
    const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (contrast < 4.5) found.push(`${at.textContent.trim().slice(0, 40)}: ${contrast.toFixed(2)}`);
  }
  return found;
})()"""


# The curves of the figure as their drawn paths say them against the ticks of the axes: names, and rows of size and percent.
DRAWN = """(() => {
  const svg = document.querySelector("#curves svg");
  const scale = (anchor, at, value) => {
    const texts = [...svg.querySelectorAll(`text[text-anchor="${anchor}"]:not([font-size], [stroke])`)];
    const ticks = texts.map((text) => ({ at: at(text), value: value(Number(text.textContent)) })).sort((a, b) => a.value - b.value);
    const [low, high] = [ticks[0], ticks.at(-1)];
    return (pixel) => low.value + (pixel - low.at) / (high.at - low.at) * (high.value - low.value);
  };
  const size = scale("middle", (text) => Number(text.getAttribute("x")), Math.log10);
  const percent = scale("end", (text) => Number(text.getAttribute("y")) - 4.5, Number);
  return [...svg.querySelectorAll("[class^=curve-] path")].map((path) => ({
    name: svg.querySelector(`.${path.parentNode.getAttribute("class")} text`).textContent,
    rows: path.getAttribute("d").slice(1).split("L").map((pair) => pair.split(" ").map(Number)).map(([x, y]) => [10 ** size(x), percent(y)]),
  }));
})()"""


class Tab:
    """The page in a tab."""

    def __init__(self, browser, url, pictures, width=1280, height=900):
        self.browser, self.pictures = browser, pictures
        self.tab = browser.open(url, width, height)

    def run(self, script):
        return self.browser.run(self.tab, script)

    def until(self, script, seconds=30):
        end = time.monotonic() + PATIENCE * seconds
        while time.monotonic() < end:
            if self.run(f"Boolean({script})"):
                return
            time.sleep(0.1)
        self.picture("not-reached")
        raise SystemExit(f"not reached within {seconds} s: {script}\n{self.run('document.body.innerText')}")

    def paste(self, role, text):
        box = f'document.querySelector(\'.sheet[data-role="{role}"]\')'
        self.run(f"{box}.querySelector('details').open = true; {box}.querySelector('textarea').value = {json.dumps(text)};"
                 f"{box}.querySelector('.paste').click()")

    def drop(self, role, name, content):
        data = base64.b64encode(content).decode()
        self.run(f"""(() => {{
          const bytes = Uint8Array.from(atob({json.dumps(data)}), c => c.charCodeAt(0));
          const moved = new DataTransfer();
          moved.items.add(new File([bytes], {json.dumps(name)}));
          document.querySelector('.sheet[data-role="{role}"]').dispatchEvent(
            new DragEvent('drop', {{ dataTransfer: moved, bubbles: true, cancelable: true }}));
        }})()""")

    def settings(self, text):
        self.run(f"document.querySelector('#free').value = {json.dumps(text)}")

    def click(self, selector):
        self.run(f"document.querySelector({json.dumps(selector)}).click()")

    def job(self, at, state, seconds=30):
        self.until(f"document.querySelectorAll('.job')[{at}]?.dataset.state === {json.dumps(state)}", seconds)

    def picture(self, name):
        time.sleep(0.15)
        if self.run(WIDE):
            raise SystemExit(f"{name}: the page is wider than its window")
        picture = self.browser.ask("Page.captureScreenshot", self.tab, captureBeyondViewport=True)["data"]
        (self.pictures / f"{name}.png").write_bytes(base64.b64decode(picture))

    def readable(self, name):
        """Nothing is faint, in the light and in the dark; a picture of the latter."""
        for scheme in ("light", "dark"):
            self.browser.ask("Emulation.setEmulatedMedia", self.tab, features=[{"name": "prefers-color-scheme", "value": scheme}])
            faint = self.run(FAINT)
            if faint:
                raise SystemExit(f"{name}: faint in the {scheme}: {faint}")
            if scheme == "dark":
                self.picture(f"{name}-in-the-dark")
        self.browser.ask("Emulation.setEmulatedMedia", self.tab, features=[])

    def printed(self, name):
        page = self.browser.ask("Page.printToPDF", self.tab, printBackground=True, paperWidth=8.27, paperHeight=11.69)["data"]
        (self.pictures / f"{name}.pdf").write_bytes(base64.b64decode(page))


def serve(binary, folder, out):
    """The program, and the address that it prints."""
    log = folder / "log.txt"
    process = subprocess.Popen([binary, "serve", "--out", out], cwd=folder, stdout=log.open("w"), stderr=subprocess.STDOUT)
    for _ in range(100):
        lines = [line for line in log.read_text().splitlines() if line.startswith("open ")]
        if lines:
            return process, lines[0].removeprefix("open ")
        time.sleep(0.05)
    raise SystemExit(f"does not begin: {log.read_text()}")


# What a page logs whose program has just ended: whoever was about to be answered is cut off, later callers find nobody.
GONE = ["ERR_CONNECTION_REFUSED", "ERR_CONNECTION_RESET", "ERR_EMPTY_RESPONSE"]


def complaints(browser, ended=False):
    """What the pages have logged, but for answers that say what is wrong with the input and, if the program has `ended`, for that."""
    found, expected = [], ["status of 4"] + (GONE if ended else [])
    for event in browser.events:
        said = event.get("params", {})
        if event.get("method") == "Runtime.exceptionThrown":
            found.append(str(said["exceptionDetails"]))
        if event.get("method") == "Log.entryAdded" and said["entry"]["level"] == "error":
            text = said["entry"]["text"]
            if not any(known in text for known in expected):
                found.append(text)
    return found


def quiet(browser, ended=False):
    """Refuses complaints; what was logged is then forgotten."""
    found = complaints(browser, ended)
    if found:
        raise SystemExit("\n".join(found))
    browser.events = []


def main(binary, pictures):
    binary, pictures = str(pathlib.Path(binary).resolve()), pathlib.Path(pictures)
    pictures.mkdir(parents=True, exist_ok=True)
    workbook = pathlib.Path("tests/soils/sheets.xlsx").read_bytes()
    with tempfile.TemporaryDirectory() as root, tempfile.TemporaryDirectory() as profile, Browser(profile) as browser:
        root = pathlib.Path(root)
        process, url = serve(binary, root, "served")
        try:
            look(browser, url, pictures, workbook, root, process, binary)
        finally:
            if process.poll() is None:
                process.kill()
                process.wait()
        quiet(browser, ended=True)
    print(f"the page of serve: no complaint; pictures in {pictures}")


def check_figure(curves):
    """Sieve curves are drawn as their tables say, and constriction curves from 0 to 100 % between sizes that the filter can have."""
    tables = {"base: base": BASE, "filter: bfine": FINE}
    names = [curve["name"] for curve in curves]
    if names != [*tables, "constrictions, loose, by number", "constrictions, dense, by number"]:
        raise SystemExit(f"other curves are drawn: {names}")
    for name, rows in ((curve["name"], curve["rows"]) for curve in curves):
        if name in tables:
            table = [[float(cell) for cell in line.split(",")] for line in tables[name].splitlines()[1:]]
            right = len(rows) == len(table) and all(
                abs(x / size - 1) < 0.01 and abs(y - percent) < 0.1 for (x, y), (size, percent) in zip(rows, table))
        else:
            rising = all(a[0] <= b[0] and a[1] <= b[1] for a, b in zip(rows, rows[1:]))
            # FINE has grains of 0.5 to 1.5 mm: three that touch leave 0.15 of the smallest one.
            right = rising and abs(rows[0][1]) < 0.1 and abs(rows[-1][1] - 100) < 0.1 and 0.07 < rows[0][0] < rows[-1][0] < 0.7
        if not right:
            raise SystemExit(f"{name} is drawn through {rows}")


def look(browser, url, pictures, workbook, root, process, binary):
    tab = Tab(browser, url, pictures)
    tab.until("document.querySelector('#version').textContent")
    tab.picture("01-empty")

    # Wrong input says what is wrong, as the command line does, and leaves nothing behind.
    tab.paste("base", "size_mm,percent\n0.1,10\n0.2,x\n")
    tab.until("document.querySelector('.sheet[data-role=base] .problem').textContent.includes('base.csv')")
    tab.picture("02-wrong-input")
    tab.readable("02-wrong-input")
    said = tab.run("document.querySelector('.sheet[data-role=base] .problem').textContent")
    (root / "base.csv").write_text("size_mm,percent\n0.1,10\n0.2,x\n")
    told = subprocess.run([binary, "soil", "base.csv"], cwd=root, capture_output=True, text=True).stderr
    if told.strip() != f"refused: {said}":
        raise SystemExit(f"not the words of the command line: {said!r}, {told!r}")

    tab.paste("base", BASE)
    tab.drop("filter", "../<b>fine\u202e.csv", FINE.encode())
    tab.until("document.querySelectorAll('#rules tr').length > 10 && document.querySelector('#curves svg .curve-2')")
    check_figure(tab.run(DRAWN))
    tab.picture("03-curves-and-rules")
    tab.readable("03-curves-and-rules")
    read = "document.querySelector('#read').textContent"
    tab.run("""(() => {
      const [svg, path] = [document.querySelector('#curves svg'), document.querySelector('#curves .curve-1 path')];
      const place = path.getPointAtLength(0).matrixTransform(svg.getScreenCTM());
      svg.dispatchEvent(new PointerEvent('pointermove', { clientX: place.x, clientY: place.y, bubbles: true }));
    })()""")
    pointed = tab.run(read)
    keys = []
    for key in ["ArrowRight", "ArrowDown"]:
        tab.run(f"document.querySelector('#curves').dispatchEvent(new KeyboardEvent('keydown', {{ key: '{key}' }}))")
        keys.append(tab.run(read))
    if not (all("Size (mm)" in said for said in [pointed, *keys]) and pointed.startswith("base: ") and keys[0].startswith("base: ")
            and keys[1].startswith("filter: ") and pointed != keys[0]):
        raise SystemExit(f"the curves do not say their values: {pointed!r}, {keys}")
    if tab.run("document.querySelector('.sheet[data-role=filter] select').selectedOptions[0].text") != "bfine.csv":
        raise SystemExit("the hostile name is not harmless")
    tab.drop("more", "site.xlsx", workbook)
    tab.until("document.querySelectorAll('#more li').length === 1")
    tab.picture("04-a-workbook")
    tab.click("#more button")

    tab.settings("base.uc=3")
    tab.click("#judge")
    tab.until("document.querySelector('#form-problem').textContent.includes('did you mean `base.cu`')")
    tab.run("document.querySelector('#form details').open = true")
    tab.picture("05-wrong-setting")
    tab.run("document.querySelector('#form details').open = false")

    tab.settings(LONG)
    tab.click("#check")
    tab.until("document.querySelector('#checked').innerText.includes('base particles')")
    tab.picture("06-what-it-would-do")
    tab.click("#judge")
    tab.until("document.querySelector('.job .so-far')", 60)
    tab.picture("07-so-far")
    tab.until("/^So far/.test(document.querySelector('.job .so-far').textContent)", 60)
    tab.picture("08-more-so-far")

    # A page that is loaded again, and another tab, find the job and the sheets.
    browser.load(tab.tab, "Page.reload")
    tab.until("document.querySelector('.job .so-far') && document.querySelector('.sheet[data-role=base] select').value === '1'")
    tab.until("document.querySelectorAll('#rules tr').length > 10")
    other = Tab(browser, url, pictures, 390, 800)
    other.until("document.querySelector('.job .so-far') && document.querySelectorAll('#rules tr').length > 10")
    if other.run("document.documentElement.scrollHeight") > 12_000:
        raise SystemExit("on a telephone the page is longer than anybody reads")
    other.picture("09-another-tab-on-a-telephone")
    tab.run("document.querySelectorAll('.job button')[0].click()")
    tab.job(0, "stopped")
    other.job(0, "stopped")
    tab.picture("10-stopped")
    tab.until("[...document.querySelectorAll('.job button')].some(button => button.textContent === 'Continue')")
    tab.run("[...document.querySelectorAll('.job button')].find(button => button.textContent === 'Continue').click()")
    tab.job(0, "running")

    # Another one waits for it.
    tab.settings(SMALL)
    tab.click("#quick")
    tab.until("document.querySelector('#seed, [data-key=seed]')")
    tab.click("#judge")
    tab.until("document.querySelectorAll('.job').length === 2")
    tab.job(0, "waiting")
    tab.picture("11-waits")
    tab.until("document.querySelectorAll('.job')[1].querySelector('button')?.textContent === 'Stop'")
    tab.run("document.querySelectorAll('.job')[1].querySelector('button').click()")
    tab.job(0, "done", 60)
    tab.picture("12-done")
    tab.readable("12-done")
    tab.printed("12-done")
    page = tab.run("document.querySelectorAll('.job')[0].querySelector('.actions a').href")
    report = Tab(browser, page, pictures)
    if not report.run("document.querySelector('.verdict .practice')?.textContent"):
        raise SystemExit("the page of the run is not there")
    report.picture("13-its-page")

    tab.drop("more", "coarse.csv", COARSE.encode())
    tab.until("document.querySelectorAll('#more li').length === 1")
    tab.click("#judge-all")
    tab.until("document.querySelectorAll('.job').length === 3")
    tab.job(0, "done", 60)
    tab.picture("14-filters")
    tab.readable("14-filters")
    page = tab.run("document.querySelectorAll('.job')[0].querySelector('.actions a').href")
    report.browser.show(report.tab, page, 1280, 900)
    if report.run("document.querySelectorAll('.cases a').length") != 2:
        raise SystemExit("the table links no page of its walks")
    report.picture("15-its-page")
    size = tab.run("fetch(document.querySelectorAll('.job')[0].querySelectorAll('.actions a')[1].href).then(a => a.blob()).then(b => b.size)")
    if size < 20_000:
        raise SystemExit(f"the folder to take away has {size} bytes")

    quiet(browser)
    process.send_signal(signal.SIGTERM)
    code = process.wait(timeout=30)
    if code not in (0, 3):
        raise SystemExit(f"ended with {code}")
    tab.until("!document.querySelector('#gone').hidden", 15)
    tab.picture("16-the-program-has-ended")
    left = sorted(entry.name for entry in (root / "served").iterdir() if not entry.name.startswith("."))
    if left != ["batch-3", "run-1", "run-2", "serve.json", "sheets"]:
        raise SystemExit(f"left behind: {left}")


if __name__ == "__main__":
    os.chdir(pathlib.Path(__file__).resolve().parents[2])
    need("chromium")
    main((sys.argv + ["target/release/voidwalk"])[1], "target/serve")
