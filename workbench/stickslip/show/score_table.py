"""The score of a curve as a table, with the cause below."""

from collections.abc import Iterator
from typing import Final

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from stickslip.show.fitted import Fitted, grid
from stickslip.show.scales import LENGTHS, TIMES, Scales, scale_for
from stickslip_score import Compared, Score

_QUANTITIES: Final[tuple[tuple[str, str, Scales], ...]] = (
    ("period", "T", TIMES),
    ("stick", "t_stick", TIMES),
    ("slip", "t_slip", TIMES),
    ("jump", "delta_x", LENGTHS),
)


def score_table(score: Score) -> RenderableType:
    """Make the table of a score: curve beside exact cycle, then cause, sentence and findings.

    Errors and resolutions stand each in a unit of their own size; symbols and resolution are left
    out where the line is short.
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
    rows = []
    for meaning, name, scales in _QUANTITIES:
        compared = getattr(score, "period" if name == "T" else name)
        cells = list(_cells(compared, scales))
        rows.append((meaning, *([name] if named else []), *(cells if resolved else cells[:-1])))
    head = ("quantity", *([""] if named else []), "curve", "exact", "error")
    return grid(
        (*head, "resolution") if resolved else head,
        rows,
        texts=(0, 1) if named else (0,),
        title=f"Curve against exact cycle, mean of {cycles}",
    )


def _cells(compared: Compared, scales: Scales) -> Iterator[str]:
    shown = next((x for x in (compared.exact, compared.got) if x is not None), 0.0)
    of_motion = scale_for(shown, scales)
    for value in (compared.got, compared.exact):
        yield "–" if value is None else of_motion.text(value)
    for value, sign, form in ((compared.error, "", "+.3g"), (compared.resolution, "±", ".3g")):
        yield "–" if value is None else sign + scale_for(value, scales).text(value, form)
