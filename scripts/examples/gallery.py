"""Every picture of the gallery (scripts/book/tutorials/gallery.md), made by the commands that stand there, in FOLDER/gallery.

    python scripts/examples/gallery.py [VOIDWALK] [FOLDER]      target/release/voidwalk and target unless given

Needs nothing but the program and Python. Fails where a command prints something else than the page says.
"""

import pathlib
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "scripts" / "book"))
import console  # type: ignore[import-not-found]  # pyright: ignore

binary = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "target" / "release" / "voidwalk").resolve()
folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else ROOT / "target")
page = ROOT / "scripts" / "book" / "tutorials" / "gallery.md"
with tempfile.TemporaryDirectory() as work:
    try:
        console.page(page.read_text(), page.name, pathlib.Path(work), binary, folder)
    except console.Stale as error:
        raise SystemExit(str(error)) from None
for path in sorted((folder / page.stem).iterdir()):
    print(f"{path}: {path.stat().st_size / 1000:.0f} kB")
