"""All claims, tried one after the other."""

from functools import cache

from stickslip_design.claims import critical, fixed_step, gap, jump, slip_time, stick_time
from stickslip_design.claims.finding import Finding
from stickslip_design.claims.told import HERE, load_claim

_MODULES = (jump, gap, slip_time, stick_time, critical, fixed_step)
"""In the order in which they are read; each has the name of its data file."""


@cache
def findings() -> tuple[Finding, ...]:
    """Try every claim on its own grid against the exact solution; a few seconds.

    Raises
    ------
    ClaimError
        A claim's file is broken.
    """
    return tuple(
        module.examine(load_claim(HERE / f"{module.__name__.rpartition('.')[2]}.toml", module.GRID))
        for module in _MODULES
    )
