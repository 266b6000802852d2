"""How the margins moved since an earlier report, as a table: what changed and by how much."""

from collections.abc import Iterator, Sequence
from typing import Final

from rich.box import SIMPLE_HEAD
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from stickslip.show.fitted import Fitted
from stickslip_verification.report.earlier import FACTOR, Key, Move, Moves

_NAMED: Final = 5
"""How many of the new and the gone checks are named; the report names them all."""


def earlier_table(moves: Moves) -> RenderableType:
    """Make the table of the checks that are not as they were, and the counts.

    A margin is error over tolerance. Where the line is short, each check has one column.
    """
    chosen = list(_moved(moves))
    tables = [_full_table(moves, chosen), _short_table(moves, chosen)] if chosen else [Text("")]
    counts = (
        f"{moves.compared} compared; margins that grew more than {FACTOR:g} times: "
        f"{len(moves.grew)}, that shrank: {len(moves.shrank)}; "
        f"verdicts that changed: {len(moves.changed)}"
    )
    worse = bool(moves.grew) or any(move.before.verdict == "pass" for move in moves.changed)
    style = "bold yellow" if worse else "bold green"
    return Fitted(tables, *_names("new", moves.new), *_names("gone", moves.gone),
                  Text(counts, style=style))  # fmt: skip


def _moved(moves: Moves) -> Iterator[Move]:
    """Yield each check once: changed verdicts, then margins that grew, then those that shrank."""
    seen: set[Key] = set()
    for move in (*moves.changed, *moves.grew, *moves.shrank):
        key = (move.case, move.check, move.side)
        if key not in seen:
            seen.add(key)
            yield move


def _full_table(moves: Moves, chosen: Sequence[Move]) -> Table:
    table = _empty_table(moves)
    for heading in ("case", "check", "side"):
        table.add_column(heading, no_wrap=True)
    for heading in ("margin\nthen", "margin\nnow"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    for move in chosen:
        table.add_row(
            move.case or "the FMU itself",
            move.check,
            move.side,
            _number(move.before.margin),
            _number(move.now.margin),
            _verdict(move),
        )
    return table


def _short_table(moves: Moves, chosen: Sequence[Move]) -> Table:
    table = _empty_table(moves)
    table.add_column("case / check (side)\n margin and verdict, then → now", overflow="fold")
    for move in chosen:
        table.add_row(
            Text.assemble(
                f"{move.case or 'the FMU itself'} / {move.check} ({move.side})\n"
                f" {_number(move.before.margin)} → {_number(move.now.margin)}; ",
                _verdict(move),
            )
        )
    return table


def _empty_table(moves: Moves) -> Table:
    since = moves.baseline.created or "an unknown time"
    return Table(
        title=f"Margins since {moves.baseline.file.name} of {since}",
        title_justify="left",
        title_style="bold",
        box=SIMPLE_HEAD,
    )


def _verdict(move: Move) -> Text:
    before, now = move.before.verdict, move.now.verdict
    if before == now:
        return Text(now)
    return Text(f"{before} → {now}", style="green" if now == "pass" else "bold red")


def _names(word: str, keys: Sequence[Key]) -> Iterator[Text]:
    if keys:
        named = ", ".join(f"{case} / {check} ({side})" for case, check, side in keys[:_NAMED])
        more = f" and {len(keys) - _NAMED} more" if len(keys) > _NAMED else ""
        yield Text(f"{len(keys)} {word}: {named}{more}")


def _number(margin: float) -> str:
    return "0" if margin == 0.0 else f"{margin:.2g}"
