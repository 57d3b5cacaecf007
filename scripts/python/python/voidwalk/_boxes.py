"""What a notebook shows of a thing that has no page."""

from __future__ import annotations

from html import escape
from typing import Mapping, Sequence, Tuple

#: Rows that a box shows.
_MOST = 12


def box(title: str, facts: Mapping[str, str], heading: Sequence[str] = (), rows: Sequence[Tuple[str, ...]] = ()) -> str:
    """A title with facts below it, and a table; of a long one the ends."""
    shown = list(rows)
    if len(shown) > _MOST:
        half = _MOST // 2
        shown = shown[:half] + [("...",) * len(shown[0])] + shown[-half:]

    def line(cells: Sequence[str], tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    said = "".join(f"<div>{escape(name)}: {escape(fact)}</div>" for name, fact in facts.items())
    table = f"<table>{line(heading, 'th')}{''.join(line(row, 'td') for row in shown)}</table>" if shown else ""
    return f"<div><strong>{escape(title)}</strong>{said}{table}</div>"
