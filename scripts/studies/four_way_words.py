"""Words and numbers as the page of scripts/studies/four_way.py writes them."""

import math
import textwrap


def paragraph(words):
    return textwrap.fill(words, 150, break_long_words=False, break_on_hyphens=False) + "\n"


def bullet(words):
    return textwrap.fill(f"- {words}", 150, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)


def down(value, digits=1):
    """A boundary, rounded down: what is said to hold was not rounded up."""
    if value == math.inf:
        return "beyond the walks"
    return f"{math.floor(value * 10**digits + 1e-9) / 10**digits:.{digits}f}"


def span(values, show=down):
    low, high = show(min(values)), show(max(values))
    return low if low == high else f"{low} to {high}"


def factors(values):
    return span(values, "{:.2f}".format)


def counted(number, what):
    return f"{number} {what}{'' if number == 1 else 's'}"


def listed(words, last="and"):
    words = list(words)
    return f" {last} ".join(filter(None, [", ".join(words[:-1]), *words[-1:]]))


def value(found, middle):
    """A boundary as the page states it: with one decimal where there is one replicate, and beyond the walks where none fails."""
    if middle == math.inf:
        return f"> {down(max(boundary.below.ratio for boundary in found if boundary.below), 2)}"
    if middle == 0:
        return f"< {down(min(boundary.above.ratio for boundary in found if boundary.above), 2)}"
    return down(middle, 1 if len(found) == 1 else 2)
