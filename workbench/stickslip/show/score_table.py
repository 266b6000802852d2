"""The score of a curve as a table, with the cause below."""

from collections.abc import Iterator
from typing import Final

from rich.box import SIMPLE_HEAD
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from stickslip.show.fitted import Fitted
from stickslip.show.scales import LENGTHS, TIMES, Scale, Scales, scale_for
from stickslip_score import Compared, Score

_QUANTITIES: Final[tuple[tuple[str, str, Scales], ...]] = (
    ("period", "T", TIMES),
    ("stick", "t_stick", TIMES),
    ("slip", "t_slip", TIMES),
    ("jump", "delta_x", LENGTHS),
)


def score_table(score: Score) -> RenderableType:
    """Make the table of a score: curve beside exact cycle, then cause, sentence and findings.

    Parameters
    ----------
    score
        What a curve came to.

    Returns
    -------
    RenderableType
        Errors and resolutions each in a unit of their own size; symbols and resolution are
        left out where the line is short.
    """
    forms = [
        _table(score, named=named, resolved=resolved)
        for named, resolved in ((True, True), (True, False), (False, False))
    ]
    mild = dict.fromkeys(("noisy", "solver_tolerance"), "bold yellow")
    style = {"exact": "bold green", **mild}.get(score.cause, "bold red")
    cause = Text.assemble((score.cause, style), f": {_sentence(score)}")
    return Fitted(forms, cause, *(Text(f"note: {finding}") for finding in score.findings))


def _sentence(score: Score) -> str:
    """Return the explanation without the name of the cause that stands before it."""
    first, colon, rest = score.explanation.partition(": ")
    return rest if colon and first.startswith(("regularised", "fixed steps")) else score.explanation


def _table(score: Score, *, named: bool, resolved: bool) -> Table:
    cycles = f"{score.cycles} cycle{'' if score.cycles == 1 else 's'}"
    table = Table(
        title=f"Curve against exact cycle, mean of {cycles}",
        title_justify="left",
        title_style="bold",
        box=SIMPLE_HEAD,
    )
    table.add_column("quantity", no_wrap=True)
    if named:
        table.add_column("", no_wrap=True)
    for heading in ("curve", "exact", "error", *(["resolution"] if resolved else [])):
        table.add_column(heading, justify="right", no_wrap=True)
    for meaning, name, scales in _QUANTITIES:
        compared = getattr(score, "period" if name == "T" else name)
        cells = list(_cells(compared, scales))
        table.add_row(meaning, *([name] if named else []), *(cells if resolved else cells[:-1]))
    return table


def _cells(compared: Compared, scales: Scales) -> Iterator[str]:
    shown = next((x for x in (compared.exact, compared.got) if x is not None), 0.0)
    scale = scale_for(shown, scales)
    yield _number(compared.got, scale)
    yield _number(compared.exact, scale)
    yield _small(compared.error, scales, "+")
    yield _small(compared.resolution, scales, "")


def _number(value: float | None, scale: Scale) -> str:
    return "–" if value is None else f"{value / scale.size:.6g} {scale.symbol}"


def _small(value: float | None, scales: Scales, sign: str) -> str:
    if value is None:
        return "–"
    scale = scale_for(value, scales)
    return f"{'' if sign else '±'}{value / scale.size:{sign}.3g} {scale.symbol}"
