"""Drives Chromium for axe.sh. Python's standard library only."""

import pathlib
import sys
import tempfile

from browser import Browser
from test_serve import Tab, quiet, serve

AXE = "axe.run(document, { resultTypes: ['violations'] }).then((found) => found.violations.map((one) => " \
      "`${one.id} (${one.impact}): ${one.help}: ` + one.nodes.map((node) => node.target.join(' ')).slice(0, 5).join(', ')))"

# What can be pressed or filled in, is shown and has not been reached by the Tab key. A radio button is reached with its group.
UNREACHED = """[...document.querySelectorAll('a[href], button, input, select, textarea, summary, [tabindex="0"]')]
  .filter((one) => !one.disabled && one.getClientRects().length && !one.reached && !(one.type === 'radio' && !one.checked))
  .map((one) => one.outerHTML.slice(0, 80))"""

# A walk that takes moments.
SMALL = "network.nx=6\nnetwork.ny=6\nnetwork.nz=8\nrecord.sensitivity=[]"

EXAMPLES = ["a-base-and-a-filter", "two-filters", "samples"]


class Looked:
    """What axe finds, page by page."""

    def __init__(self, axe):
        self.axe, self.pages, self.found = axe, 0, []

    def look(self, tab, name):
        for scheme in ("light", "dark"):
            tab.browser.ask("Emulation.setEmulatedMedia", tab.tab, features=[{"name": "prefers-color-scheme", "value": scheme}])
            # As the debugger evaluates it, the page's own policy is not asked.
            tab.run(self.axe + "\n0")
            self.pages += 1
            self.found += [f"{name}, {tab.width} px, {scheme}: {said}" for said in tab.run(AXE)]
        tab.browser.ask("Emulation.setEmulatedMedia", tab.tab, features=[])
        tab.picture(f"{name}-{tab.width}")

    def keys(self, tab, name):
        """Goes through the page by the Tab key, from its start."""
        tab.run("document.activeElement.blur(); document.body.tabIndex = -1; document.body.focus()")
        for _ in range(250):
            for kind in ("keyDown", "keyUp"):
                tab.browser.ask("Input.dispatchKeyEvent", tab.tab, type=kind, key="Tab", code="Tab", windowsVirtualKeyCode=9)
            tab.run("if (document.activeElement) document.activeElement.reached = true")
        self.found += [f"{name}, {tab.width} px: not reached by keys: {one}" for one in tab.run(UNREACHED)]
        tab.run("document.body.removeAttribute('tabindex')")


def pages(browser, url, pictures, looked, width):
    tab = Tab(browser, url, pictures, width, 900)
    tab.until("document.querySelector('#version').textContent")
    looked.look(tab, "empty")
    for at, name in enumerate(EXAMPLES):
        tab.run(f"document.querySelectorAll('#try button')[{at}].click()")
        tab.until(f"document.querySelector('#try-problem').hidden && document.querySelectorAll('#rules tr').length > 10")
        if name == "samples":
            tab.until("document.querySelectorAll('#samples-table tbody tr').length === 6")
        if name == "two-filters":
            tab.until("document.querySelectorAll('#more li').length === 1")
        tab.run("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
        looked.look(tab, name)
    looked.keys(tab, "samples")
    tab.printed(f"samples-{width}")
    batch(tab, looked)
    return tab


def batch(tab, looked):
    """Walks the samples by keys alone; the table is looked at while it grows, and when all is walked."""
    tab.settings(SMALL + "\nreplicates=40")
    jobs = tab.run("document.querySelectorAll('.job').length")
    tab.run("document.querySelector('#walk-samples').focus()")
    for kind in ("keyDown", "keyUp"):
        tab.browser.ask("Input.dispatchKeyEvent", tab.tab, type=kind, key="Enter", code="Enter", text="\r" if kind == "keyDown" else "", windowsVirtualKeyCode=13)
    tab.until(f"document.querySelectorAll('.job').length > {jobs} && document.querySelector('.job .samples') !== null", 60)
    looked.look(tab, "batch-growing")
    tab.job(0, "done", 300)
    tab.until("document.querySelectorAll('.job .samples tbody tr').length >= 6")
    wide = tab.run("document.documentElement.scrollWidth - document.documentElement.clientWidth")
    if wide > 0:
        looked.found.append(f"batch, {tab.width} px: the page is {wide} px too wide")
    looked.look(tab, "batch")
    looked.keys(tab, "batch")


def main(binary, axe, pictures):
    binary, pictures = str(pathlib.Path(binary).resolve()), pathlib.Path(pictures)
    pictures.mkdir(parents=True, exist_ok=True)
    looked = Looked(pathlib.Path(axe).read_text())
    with tempfile.TemporaryDirectory() as root, tempfile.TemporaryDirectory() as profile, Browser(profile) as browser:
        process, url = serve(binary, pathlib.Path(root), "served")
        try:
            for width in (1280, 390):
                tab = pages(browser, url, pictures, looked, width)
            tab.run("document.querySelectorAll('#try button')[0].click()")
            tab.settings(SMALL + "\nreplicates=4")
            tab.click("#judge")
            tab.job(0, "done", 120)
            looked.look(tab, "result")
            looked.keys(tab, "result")
        finally:
            process.kill()
            process.wait()
        quiet(browser, ended=True)
    for said in looked.found:
        print(said, file=sys.stderr)
    print(f"axe: {len(looked.found)} findings on {looked.pages} pages; pictures in {pictures}")
    sys.exit(1 if looked.found else 0)


if __name__ == "__main__":
    main(*sys.argv[1:4])
