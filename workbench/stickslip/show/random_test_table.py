"""The random tests as a table: one row per statement and side."""

from collections.abc import Sequence
from typing import Final

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from stickslip.show.fitted import Fitted
from stickslip_verification import RandomTestResult

_STATEMENT: Final = 48
"""Characters of a statement or a bound in a line of the table."""


def random_test_table(results: Sequence[RandomTestResult]) -> RenderableType:
    """Make the table of all random tests, what refutes the failed ones, and the count.

    Where the line cannot hold all columns, the numbers stand in words below each bound.
    """
    failed = [each for each in results if not each.passed]
    worst = [Text(f"FAILS {each.name} ({each.side}): {each.where}", "red") for each in failed]
    count = f"{len(results) - len(failed)} passed, {len(failed)} failed"
    return Fitted(
        [_full_table(results), _short_table(results)],
        *worst,
        Text(count, style="bold red" if failed else "bold green"),
    )


def _full_table(results: Sequence[RandomTestResult]) -> Table:
    table = _empty_table(results)
    table.add_column("statement\n  bound", overflow="fold", max_width=_STATEMENT)
    table.add_column("side", no_wrap=True)
    for heading in ("drawn", "left out", "refuted", "worst\nerror/bound"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    for each in results:
        table.add_row(
            Group(Text(each.name), _below(each.bound)),
            each.side,
            str(each.drawn),
            str(each.left_out),
            str(each.refuted),
            f"{each.worst:.2g}",
            _verdict(each),
        )
    return table


def _short_table(results: Sequence[RandomTestResult]) -> Table:
    table = _empty_table(results)
    table.add_column("verdict", no_wrap=True)
    table.add_column("statement, side\n  bound", overflow="fold")
    for each in results:
        numbers = (
            f"{each.drawn} drawn, {each.left_out} left out, {each.refuted} refuted; "
            f"worst error/bound {each.worst:.2g}"
        )
        statement = Text(f"{each.name}, {each.side}")
        table.add_row(_verdict(each), Group(statement, _below(each.bound), _below(numbers)))
    return table


def _empty_table(results: Sequence[RandomTestResult]) -> Table:
    seeds = ", ".join(sorted({str(each.seed) for each in results}))
    return Table(
        title=f"Random tests, seed {seeds}",
        title_justify="left",
        title_style="bold",
        box=SIMPLE_HEAD,
    )


def _below(text: str) -> Padding:
    return Padding(Text(text), (0, 0, 0, 2))


def _verdict(result: RandomTestResult) -> Text:
    return Text("holds", style="green") if result.passed else Text("FAILS", style="bold red")
