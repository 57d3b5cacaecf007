#!/usr/bin/env python3
"""Draws every figure of a results folder as a PNG beside its SVG, for programs that take no SVG.

    scripts/browser/figures_to_png.py FOLDER [WIDTH]

WIDTH is that of the pictures in pixels, 1440 unless given. Needs a Chromium (as root on Debian it installs one);
`inkscape --export-type=png figures/*.svg` and `rsvg-convert` do the same where they are.
"""

import base64
import os
import pathlib
import re
import sys
import tempfile

from browser import Browser, need


def main():
    if len(sys.argv) not in (2, 3) or not re.fullmatch("[1-9][0-9]{0,4}", (sys.argv + ["1440"])[2]):
        sys.exit(__doc__)
    folder, width = pathlib.Path(sys.argv[1]), int((sys.argv + ["1440"])[2])
    drawings = sorted((folder / "figures").glob("*.svg"))
    if not drawings:
        raise SystemExit(f"{folder}: holds no figures; name the folder of a finished run, packing or campaign")
    need("chromium")
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile, Browser(profile) as browser:
        tab = browser.open("about:blank", 100, 100)
        for drawing in drawings:
            view = re.search(r'viewBox="0 0 ([0-9.]+) ([0-9.]+)"', drawing.read_text(encoding="utf-8"))
            if view is None:
                raise SystemExit(f"{drawing}: no figure of voidwalk: it has no size")
            wide, high = float(view[1]), float(view[2])
            browser.show(tab, drawing.resolve().as_uri(), int(wide) + 1, int(high) + 1)
            area = {"x": 0, "y": 0, "width": wide, "height": high, "scale": width / wide}
            shot = browser.ask("Page.captureScreenshot", tab, format="png", clip=area, captureBeyondViewport=True)
            picture, part = drawing.with_suffix(".png"), drawing.with_suffix(".png.part")
            part.write_bytes(base64.b64decode(shot["data"]))
            os.replace(part, picture)
            print(picture)


main()
