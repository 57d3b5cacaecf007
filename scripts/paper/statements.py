"""Numbers that the paper states (statements.toml), our values beside them, and the rule that judges them."""

import csv
import io
import math
import pathlib
import tomllib
from decimal import Decimal
from typing import NamedTuple

from measures import OF_CURVES, Measures, takes
from study import AS_STATED, MAIN, PUBLISHED, VARIANTS, Value, Variant, known

THIN = "\u202f"
COUNTED, SET, ALWAYS, FITTED, THEIRS, READING = "counted", "by construction", "always", "fitted", "theirs", "reading"
#: Reasons for not counting a statement.
REASONS = {
    SET: "the plan sets it",
    ALWAYS: "a spread that falls as any power of the length agrees",
    FITTED: "fitted: our overlap for merging voids was chosen by Table 2",
    THEIRS: "the curve is the authors’ own",
    READING: "another reading of a statement that is counted already",
}
AGREES, DIFFERS, INCONCLUSIVE = "agrees", "differs", "inconclusive"
PAPER = tomllib.loads(pathlib.Path(__file__).with_name("statements.toml").read_text(encoding="utf-8"))
COLUMNS = "id shown place says states allowed_from allowed_to why variant ours low high words judgement differs_by".split()


def significant(value):
    """Three significant digits, without an exponent between 0.0001 and a million."""
    if value == 0 or not math.isfinite(value):
        return "0" if value == 0 else "unknown"
    digits, power = f"{value:.2e}".split("e")
    return f"{value:.{max(2 - int(power), 0)}f}" if -4 <= int(power) < 6 else f"{digits}e{int(power)}"


def whole(value):
    """A whole number with its thousands apart, from five digits on."""
    return f"{value:,.0f}".replace(",", THIN) if abs(value) >= 10000 else f"{value:.0f}"


def plain(value):
    """All digits of a number, without an exponent."""
    if value is None or not math.isfinite(value):
        return ""
    return str(int(value)) if value == int(value) else format(Decimal(repr(float(value))), "f")


def shown(value):
    if not math.isfinite(value) or value != int(value):
        return significant(value)
    return whole(value) if value >= 1e6 else str(int(value))


class Ours(NamedTuple):
    """Our value for a number of the paper, from one variant."""

    variant: Variant
    #: None where the measure says nothing about the variant.
    measured: Value
    judgement: str
    #: By how much it differs from the nearest end of what agrees.
    by: float
    standing: str

    def words(self):
        if self.standing in (COUNTED, SET):
            return self.judgement if self.standing == COUNTED else SET
        return f"{self.standing}: {self.judgement}"


class Statement:
    """A number that the paper states, or a word for one, with ours of every variant that can tell."""

    def __init__(self, record):
        self.record = record
        self.id, self.shown, self.place, self.says, self.states, self.why, self.measure = (
            record[key] for key in ("id", "shown", "place", "says", "states", "why", "measure")
        )
        self.standing = SET if record.get("standing") == "set" else record.get("standing", COUNTED)
        self.value, tolerance = record.get("value"), record.get("tolerance")
        self.low, self.high = record.get("at_least", -math.inf), record.get("at_most", math.inf)
        if self.value is not None:
            self.low, self.high = self.value - tolerance, self.value + tolerance
        self.ours = []

    def standing_with(self, variant):
        """A published curve is the authors' own, and nothing was fitted where voids are merged as the paper states."""
        if self.standing in (COUNTED, FITTED) and self.measure in OF_CURVES and variant.curves == PUBLISHED:
            return THEIRS
        return COUNTED if self.standing == FITTED and variant.curves == AS_STATED else self.standing

    def judge(self, measured):
        """A judgement, and by how much a value differs.

        Agrees when the value lies within what is stated, or the interval covers the stated value. Inconclusive when nothing was
        walked, or when the interval lies on both sides of what decides. Differs otherwise, by the distance to the nearest end.
        """
        if measured is None or measured.open or math.isnan(measured.value):
            return INCONCLUSIVE, None
        value, (start, end) = measured.value, measured.interval or (measured.value, measured.value)
        # Rounding of decimal fractions decides nothing.
        slack = 1e-9 * max(abs(value), 1.0)
        if self.low - slack <= value <= self.high + slack or self.value is not None and start <= self.value <= end:
            return AGREES, None
        if start <= self.high and end >= self.low:
            return INCONCLUSIVE, None
        return DIFFERS, value - self.high if value > self.high else value - self.low

    def compare(self, study):
        """Takes the measure of each variant; one that says nothing about it is left out, but never the first."""
        for variant in VARIANTS:
            if takes(self.measure, variant):
                take = getattr(Measures(study, variant.name), self.measure)
                measured = next(iter(known(lambda keys: take(**keys), [self.record.get("keys", {})])), None)
                if measured is not None or variant.name == MAIN:
                    self.ours.append(Ours(variant, measured, *self.judge(measured), self.standing_with(variant)))
        return self

    @property
    def first(self):
        """Ours of the variant that the page is about."""
        return self.ours[0]

    def counts_as(self, judgement):
        return self.first.standing == COUNTED and self.first.judgement == judgement

    def show(self, value):
        unit = self.record.get("unit")
        return f"{shown(value)}{THIN}{unit}" if unit else shown(value)

    def show_measured(self, measured):
        interval = " ({} to {})".format(*map(self.show, measured.interval)) if measured.interval else ""
        return self.show(measured.value) + interval

    def difference(self):
        """By how much the first value differs: from the stated value, or from the limit that it breaks."""
        off = self.first.by if self.value is None else self.first.measured.value - self.value
        unit = f"{THIN}points" if self.record.get("unit") == "%" else ""
        return f"differs by {'−' if off < 0 else '+'}{shown(abs(off))}{unit}{'' if self.value is not None else ' from the limit'}"

    def sentence(self):
        """The judgement in words, with the variants that explain a difference."""
        measured, judgement, standing = self.first.measured, self.first.judgement, self.first.standing
        if judgement == DIFFERS:
            words = self.difference()
            if standing != SET:
                others = [ours for ours in self.ours[1:] if ours.measured is not None]
                agree = [ours.variant.title for ours in others if ours.judgement == AGREES]
                if others:
                    words += "; agrees with " if agree else "; so with "
                    words += "; with ".join(agree or [ours.variant.title for ours in others])
        else:
            why = "not walked" if measured is None else "what was walked leaves both possible"
            words = judgement if judgement == AGREES else f"{judgement}: {why}"
        if standing == COUNTED:
            return words
        # A setting that is as in the paper is no agreement.
        if standing == SET:
            return f"not counted: {REASONS[SET]}" + (f"; {words}" if judgement == DIFFERS else "")
        return f"{words}. Not counted: {REASONS[standing]}"


def statements():
    """All statements, in the order of the paper."""
    return [Statement({**group, **one}) for group in PAPER["group"] for one in group["statements"]]


def table(compared):
    """The statements as CSV, a line for each variant that can tell. Where a statement does not count, `judgement` begins with why."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for statement in compared:
        for ours in statement.ours:
            measured = ours.measured or Value(None)
            stated = [statement.id, statement.shown, statement.place, statement.says, statement.states]
            allowed = [plain(statement.low), plain(statement.high), statement.why]
            values = [plain(value) for value in (measured.value, *(measured.interval or (None, None)))]
            writer.writerow([*stated, *allowed, ours.variant.name, *values, measured.words, ours.words(), plain(ours.by)])
    return text.getvalue()
