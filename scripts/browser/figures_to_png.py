"""Draws figures/*.svg as PNGs, for figures_to_png.sh. Python's standard library only."""

import base64
import os
import pathlib
import re
import sys
import tempfile

from browser import Browser


def main():
    folder, width = pathlib.Path(sys.argv[1]), int(sys.argv[2])
    drawings = sorted((folder / "figures").glob("*.svg"))
    if not drawings:
        raise SystemExit(f"{folder / 'figures'}: no SVG file")
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
