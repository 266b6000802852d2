"""What came out for a series of machines, in sentences and tables."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

from stickslip_units import EXACT, NONE, number, per_minute, told

from ..points.axes import check
from ..report.tables import Grid
from .machines import Distribution
from .statistics import Indices, Probability, probability
from .study import Outcome, Scatter

_LEAST_TOLD: Final = 0.05
"""Parts of a variance below this are left out of a sentence."""
_LEAST_CUT: Final = 1e-6
"""Parts of a distribution below this are left out without a word."""
_MOST_DECIMALS: Final = 5


def feed(value: float) -> str:
    """Return a feed [m/s] in mm/s, or in mm/min where that is a much rounder number."""
    in_seconds, in_minutes = number(1e3 * value, EXACT), per_minute(value, EXACT)
    digits = [len(text.replace(".", "").strip("0")) for text in (in_seconds, in_minutes)]
    return f"{in_minutes} mm/min" if digits[1] < digits[0] - 1 else f"{in_seconds} mm/s"


def percent(found: Probability) -> str:
    """Return a probability with its interval, in digits that the interval leaves."""
    width = 100.0 * (found.high - found.low)
    decimals = min(max(math.ceil(1.0 - math.log10(width)), 0), _MOST_DECIMALS)
    value, low, high = (f"{100.0 * each:.{decimals}f}" for each in found)
    return f"{value} % ({low} to {high} %)"


def sentences(found: Scatter) -> Iterator[str]:
    """Yield what came out, the answer first."""
    count = found.question.count
    for outcome in found.outcomes:
        yield _of_feed(outcome)
        if outcome.swings:
            each = probability(outcome.swings, count)
            yield f"At {feed(outcome.feed)} {percent(each)} swing without rest or are unstable."
        if outcome.unknown:
            yield (
                f"At {feed(outcome.feed)} {outcome.unknown} of {count} machines could not be "
                "computed; they count as none that jumps."
            )
        if outcome.unmeasured:
            yield (
                f"At {feed(outcome.feed)} {outcome.unmeasured} machines hunt along the way: their "
                "jumps are no even row, and have no part in the quantiles."
            )
    if found.clamped:
        each = probability(found.clamped, count)
        yield (
            f"mu_k came above mu_s in {found.clamped} of {count} machines, {percent(each)}, and "
            "was taken as mu_s; a correlation of the two makes that rarer."
        )
    for path, distribution in found.question.population.varied.items():
        if (cut := distribution.cut) > _LEAST_CUT:
            yield f"{path}: {100.0 * cut:.2g} % of its distribution is out of range, and left out."
    yield from _of_indices(found)
    yield from _of_solved(found)


def _of_feed(outcome: Outcome) -> str:
    share, _, interval = percent(outcome.jumps).partition(" (")
    text = f"At {feed(outcome.feed)} {share} of machines jump ({interval}"
    if math.isnan(outcome.jump[1]):
        return f"{text}."
    return (
        f"{text}; of those half by more than {told(outcome.jump[1], 'm')}, "
        f"5 % by more than {told(outcome.jump[2], 'm')}."
    )


def name_of(found: Scatter, result: str) -> str:
    """Return what a result is called: ``jump 1`` is that of the first feed."""
    if result == "critical_feed":
        return "critical feed"
    return f"jump at {feed(found.question.feeds[int(result.split()[1]) - 1])}"


def _of_indices(found: Scatter) -> Iterator[str]:
    if found.question.rows and not found.indices:
        yield (
            "Sobol indices: none; what they would split is the same at all machines, or not finite."
        )
    names = list(found.question.population.varied)
    for result, each in list(found.indices.items())[:1]:
        parts = sorted(zip(each.total.tolist(), names, strict=True), reverse=True)
        listed = ", ".join(
            f"{name} {100.0 * part:.0f} %" for part, name in parts if part >= _LEAST_TOLD
        )
        yield f"The {name_of(found, result)} scatters with {listed} (total Sobol indices)."
    if found.indices and any(found.question.population.correlation.values()):
        yield "Sobol indices are those of independent numbers: the correlation is left out in them."


def _of_solved(found: Scatter) -> Iterator[str]:
    held = found.solved
    if held is None:
        return
    aim = f"{100.0 * held.share:.6g} % of machines run evenly at {feed(held.feed)}"
    value, low, high, now, *within = (
        told(each, held.unit, EXACT)
        for each in (held.value, held.low, held.high, held.now, *held.within)
    )
    if held.unsolved:
        lowest, highest = (f"{100.0 * each:.4g} %" for each in held.at_ends)
        yield (
            f"{aim} by {held.path}: {held.unsolved}; {lowest} do at {within[0]}, {highest} at "
            f"{within[1]}, and now, at {now}, {percent(held.share_now)}."
        )
        return
    interval = " to ".join(
        "beyond the range or the sample" if each == NONE else each for each in (low, high)
    )
    yield (
        f"{aim} with a nominal {held.path} of at {'most' if held.at_most else 'least'} {value} "
        f"({interval}); now it is {now}, and {percent(held.share_now)} do."
    )
    if not held.checked.low <= held.share <= held.checked.high:
        yield (
            f"Counted anew at {value}, {percent(held.checked)} run evenly: some machines turn "
            f"from jumping to even motion more than once, and {value} is not the answer."
        )


def feeds(found: Scatter) -> Grid:
    """Return the table of the feeds."""
    rows = [
        (
            feed(each.feed), percent(each.jumps), percent(each.even),
            *(told(jump, "m") for jump in each.jump), str(each.swings), str(each.unknown),
        )
        for each in found.outcomes
    ]  # fmt: skip
    head = (
        "feed", "machines that jump", "that run evenly", "jump, 5 %", "median", "95 %",
        "swing", "not computed",
    )  # fmt: skip
    return Grid(head, rows, frozenset(range(1, len(head))))


def numbers(found: Scatter) -> Grid:
    """Return the table of the numbers that vary."""
    rows = []
    for path, each in found.question.population.varied.items():
        stated = check(found.question.population.file, path)
        rows.append((path, told(stated.value, stated.unit, EXACT), in_words(each, stated.unit)))
    return Grid(("number", "stated", "distribution"), rows, frozenset({1}))


def correlations(found: Scatter) -> str:
    """Return the pairs of numbers that are correlated; empty without any."""
    asked = found.question
    return ", ".join(
        f"{one} and {other} {number(value, EXACT)}"
        for (one, other), value in asked.population.correlation.items()
    )


def in_words(distribution: Distribution, unit: str) -> str:
    """Return a distribution as one reads it aloud."""
    kind, values = distribution.kind, distribution.numbers
    if kind == "lognormal":
        spread = f"{100.0 * values[1]:.4g} %"
        return f"lognormal, median {told(values[0], unit, EXACT)}, sigma {spread}"
    shown = [told(each, unit, EXACT) for each in values]
    if kind == "normal":
        return f"normal, mean {shown[0]}, sigma {shown[1]}"
    if kind == "uniform":
        return f"uniform, {shown[0]} to {shown[1]}"
    return f"triangular, {shown[0]} to {shown[2]}, likeliest {shown[1]}"


def parts(found: Scatter) -> Grid:
    """Return the table of the Sobol indices: total, with the first order behind it."""
    columns = [list(_cells(each)) for each in found.indices.values()]
    rows = list(zip(found.question.population.varied, *columns, strict=True)) if columns else []
    head = ("number", *(name_of(found, result) for result in found.indices))
    return Grid(head, rows, frozenset(range(1, len(head))))


def _cells(found: Indices) -> Iterator[str]:
    for total, ends, first in zip(found.total, found.total_range, found.first, strict=True):
        # A zero has no sign.
        whole, low, high, alone = (f"{round(each, 2) + 0.0:.2f}" for each in (total, *ends, first))
        yield f"{whole} ({low} to {high}), alone {alone}"
