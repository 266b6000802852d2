"""Axes side by side: the numbers in which they differ, and what each does."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from stickslip_units import NONE, number, told

from ..verdict import Verdict, feed_in_words
from .tables import Grid, numbers, standing


def comparison(verdicts: Mapping[str, Verdict]) -> Grid:
    """Return a column for each axis, by its name: first the numbers that differ, then its verdict.

    A dash stands where an axis has no such number, or was not asked at such a feed.
    """
    stated = [_stated(verdict) for verdict in verdicts.values()]
    answers = [dict(_answers(verdict)) for verdict in verdicts.values()]
    feeds = sorted({point.feed for verdict in verdicts.values() for point in verdict.points})
    asked = ("verdict", "critical feed", *map(_margin_at, feeds), "at a target", "measure")
    names = dict.fromkeys(name for of_axis in stated for name in of_axis)
    rows = [(name, *(of_axis.get(name, NONE) for of_axis in stated)) for name in names]
    rows = [row for row in rows if len({*row[1:]}) > 1]
    rows += [(name, *(of_axis.get(name, NONE) for of_axis in answers)) for name in asked]
    return Grid(("", *verdicts), rows)


def _stated(verdict: Verdict) -> dict[str, str]:
    """Return the numbers of an axis with their ±, by name; its filters in one text."""
    found: dict[str, str] = {}
    for key, value, width in numbers(verdict.axis).rows:
        name, text = key.partition(".")[2] or key, f"{value} ± {width}" if width else value
        found[name] = f"{found[name]}; {text}" if name in found else text
    return found


def _margin_at(feed: float) -> str:
    return f"margin at {feed_in_words(feed)}"


def _answers(verdict: Verdict) -> Iterator[tuple[str, str]]:
    yield "verdict", standing(verdict).word
    if not verdict.stable:
        return
    critical, hunting, best = verdict.critical_feed, verdict.hunting, verdict.best
    yield "critical feed", told(critical, "m/s") if critical else "never jumps"
    for point in verdict.points:
        does = f", jumps {told(point.jump, 'm')}" if point.jump else ", judders"
        yield _margin_at(point.feed), number(point.margin) + (does if point.judders else "")
    if verdict.axis.drive is not None:
        yield "at a target", f"hunts {told(hunting.jump, 'm')}" if hunting else "rests"
    if verdict.measures or verdict.left_out:
        yield "measure", f"{best.name} ({best.effort})" if best else "none is enough"
