"""`stickslip score`: a curve from any tool against the exact cycle."""

from pathlib import Path
from typing import Annotated

from stickslip.commands.expanded import command
from stickslip.commands.shared import console
from stickslip.parameters import Parameters


@command
def score(
    curve: Path,
    *,
    p: Annotated[Parameters, "m g k c mu_s mu_k v load F_ext"],
    time: str | None = None,
    x: str | None = None,
    x_dot: str | None = None,
    force: str | None = None,
    json: bool = False,
) -> None:
    """Compare a curve from any tool with the exact cycle, and say why it differs.

    The exit code is 0 whatever is found; --json names the cause.
    """
    from stickslip.judgements import score as scored

    found = scored(curve, p, time=time, x=x, x_dot=x_dot, force=force)
    if json:
        print(found.to_json())
    else:
        console().print(found.table())
