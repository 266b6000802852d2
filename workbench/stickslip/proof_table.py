"""The proofs on random sets as a table: one row per statement and side."""

from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from stickslip_verification import ProofResult


def proof_table(results: Sequence[ProofResult]) -> RenderableType:
    """Make the table of all proofs, what refutes the failed ones, and the count."""
    seeds = ", ".join(sorted({str(each.seed) for each in results}))
    table = Table(
        title=f"Proofs on random sets, seed {seeds}",
        title_justify="left",
        title_style="bold",
        box=SIMPLE_HEAD,
    )
    for heading in ("statement", "side", "bound"):
        table.add_column(heading, overflow="fold")
    for heading in ("drawn", "left out", "refuted", "worst\nerror/bound"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    for each in results:
        table.add_row(
            each.name,
            each.side,
            each.bound,
            str(each.drawn),
            str(each.left_out),
            str(each.refuted),
            f"{each.worst:.2g}",
            Text("holds", style="green") if each.passed else Text("FAILS", style="bold red"),
        )
    failed = [each for each in results if not each.passed]
    worst = [Text(f"FAILS {each.name} ({each.side}): {each.where}", "red") for each in failed]
    count = f"{len(results) - len(failed)} passed, {len(failed)} failed"
    return Group(table, *worst, Text(count, style="bold red" if failed else "bold green"))
