"""`stickslip score`: a curve from any tool against the exact cycle."""

from pathlib import Path
from typing import Annotated, Any

import typer

from stickslip.commands.expanded import Only, command
from stickslip.commands.shared import console
from stickslip.parameters import Parameters


def _column(option: str, what: str) -> Any:
    return typer.Option(
        option,
        metavar="NAME",
        help=f"Column of {what}, with the unit that the header lacks ('x [mm]'); default: guessed.",
        show_default=False,
    )


@command
def score(
    curve: Annotated[
        Path, typer.Argument(metavar="RESULT.csv", help="A time series with at least t and x or F.")
    ],
    p: Annotated[Parameters, Only("m g k c mu_s mu_k v load F_ext")],
    time: Annotated[str | None, _column("--time", "the time")] = None,
    x: Annotated[str | None, _column("--x", "the mass's position")] = None,
    x_dot: Annotated[str | None, _column("--x-dot", "the mass's velocity")] = None,
    force: Annotated[str | None, _column("--force", "the spring force")] = None,
    json: Annotated[bool, typer.Option("--json", help="Print JSON for machines.")] = False,
) -> None:
    """Compare a curve from any tool with the exact cycle, and say why it differs."""
    from stickslip.judgements import score as scored

    found = scored(curve, p, time=time, x=x, x_dot=x_dot, force=force)
    if json:
        print(found.to_json())
    else:
        console().print(found.table())
