"""`stickslip critical`: where stick-slip ends, over the pulling velocity."""

from typing import Annotated

from stickslip.commands.expanded import command
from stickslip.commands.shared import console, say
from stickslip.parameters import Parameters


@command
def critical(
    *,
    p: Annotated[Parameters, "m g k c mu_s mu_k tau_s B t_0 v? load law own curve normal_force"],
    from_: str | None = None,
    to: str | None = None,
    json: bool = False,
) -> None:
    """Print at which pulling velocities a cycle with a stick exists, and steady sliding is stable.

    With --v also which motions exist at that velocity; the range searched holds it.
    """
    from stickslip.library import critical as limits

    found = limits(p, between=(from_, to))
    for note in found.notes:
        say(f"warning: {note}")
    if json:
        print(found.to_json())
    else:
        console().print(found.table())
