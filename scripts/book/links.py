"""Every link of the finished book leads somewhere: files, and places inside of them. Addresses on the web are counted, not asked; no page may
load anything from there."""

import html.parser
import pathlib
import urllib.parse


class Page(html.parser.HTMLParser):
    """The places that a page has, where it leads, and whether that is loaded with it."""

    def __init__(self, path):
        super().__init__()
        self.places, self.leads = set(), []
        self.feed(path.read_text())

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("id", "name") and value:
                self.places.add(value)
            elif name in ("href", "src") and value and tag != "base":
                self.leads.append((value, name == "src" or tag == "link"))


def dead(book):
    """A line for each link that leads nowhere, and how many links lead outside."""
    book = pathlib.Path(book).resolve()
    pages = {path: Page(path) for path in book.rglob("*.html")}
    faults, outside = [], 0
    for path, page in pages.items():
        for lead, is_loaded in page.leads:
            parts = urllib.parse.urlsplit(lead)
            if parts.scheme in ("http", "https", "mailto") or parts.netloc:
                outside += 1
                faults += [f"{path.relative_to(book)}: {lead}: loaded from the web"] * is_loaded
                continue
            if parts.scheme == "data":
                continue
            # Of the page of a missing address nobody knows the folder.
            target = (path if not parts.path else path.parent / urllib.parse.unquote(parts.path)).resolve()
            place = urllib.parse.unquote(parts.fragment)
            if target.is_dir():
                target /= "index.html"
            if not target.is_file():
                faults.append(f"{path.relative_to(book)}: {lead}: no such file")
            elif place and target in pages and place not in pages[target].places:
                faults.append(f"{path.relative_to(book)}: {lead}: no such place in the page")
    return sorted(set(faults)), outside
