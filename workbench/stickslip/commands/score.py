"""`stickslip score`: a curve from any tool against the exact cycle."""

from pathlib import Path
from typing import Annotated, Any

from stickslip.commands.expanded import arg, command, opt
from stickslip.commands.shared import console
from stickslip.parameters import Parameters


def _column(option: str, what: str) -> Any:
    return opt(
        f"Column of {what}, with the unit that the header lacks ('x [mm]'); default: guessed.",
        "NAME",
        option,
    )


@command
def score(
    curve: Annotated[Path, arg("A time series with at least t and x or F.", "RESULT.csv")],
    p: Annotated[Parameters, "m g k c mu_s mu_k v load F_ext"],
    time: Annotated[str | None, _column("--time", "the time")] = None,
    x: Annotated[str | None, _column("--x", "the mass's position")] = None,
    x_dot: Annotated[str | None, _column("--x-dot", "the mass's velocity")] = None,
    force: Annotated[str | None, _column("--force", "the spring force")] = None,
    json: Annotated[bool, opt("Print JSON for machines.")] = False,
) -> None:
    """Compare a curve from any tool with the exact cycle, and say why it differs."""
    from stickslip.judgements import score as scored

    found = scored(curve, p, time=time, x=x, x_dot=x_dot, force=force)
    if json:
        print(found.to_json())
    else:
        console().print(found.table())
