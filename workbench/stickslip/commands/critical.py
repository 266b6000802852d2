"""`stickslip critical`: where stick-slip ends, over the pulling velocity."""

import warnings
from typing import Annotated

import typer

from stickslip.commands.laws import read_law
from stickslip.commands.options import (
    Damping,
    FrictionLawOrThatOfCurve,
    Gravity,
    GrowthTime,
    KineticFriction,
    LawParameter,
    Load,
    LogarithmicGrowth,
    LogarithmTime,
    Mass,
    MeasuredCurve,
    NormalForce,
    PullingVelocity,
    StaticFriction,
    Stiffness,
)
from stickslip.commands.quantities import read_above_zero
from stickslip.commands.shared import console, here_on_path, say
from stickslip.errors import CommandError


def critical(
    m: Mass = None,
    g: Gravity = None,
    k: Stiffness = None,
    c: Damping = None,
    mu_s: StaticFriction = None,
    mu_k: KineticFriction = None,
    tau_s: GrowthTime = None,
    B: LogarithmicGrowth = None,
    t_0: LogarithmTime = None,
    v: PullingVelocity = None,
    load: Load = None,
    law: FrictionLawOrThatOfCurve = None,
    law_parameter: LawParameter = None,
    curve: MeasuredCurve = None,
    normal_force: NormalForce = None,
    lowest: Annotated[
        str | None,
        typer.Option("--from", metavar="VALUE", help="Lowest pulling velocity searched."),
    ] = None,
    highest: Annotated[
        str | None,
        typer.Option("--to", metavar="VALUE", help="Highest pulling velocity searched."),
    ] = None,
) -> None:
    """Print at which pulling velocities a cycle with a stick exists, and steady sliding is stable.

    With --v also which motions exist at that velocity; the range searched holds it.
    """
    from stickslip.show.critical_table import critical_table
    from stickslip.simulate.engines import reference_parameters
    from stickslip_ref import critical_velocity, regime

    typed = {"m": m, "g": g, "k": k, "c": c, "mu_s": mu_s, "mu_k": mu_k, "v": v, "load": load}
    typed |= {"tau_s": tau_s, "B": B, "t_0": t_0}
    law, _, values = read_law(law, typed, law_parameter, curve, normal_force)
    between = (
        read_above_zero(lowest, "m/s", "--from"),
        read_above_zero(highest, "m/s", "--to"),
    )
    with here_on_path(), warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            parameters = reference_parameters(values, law)
            found = critical_velocity(parameters, law, between=between)
            if v is not None and (wider := _holding(abs(values["v"]), between, found.between)):
                found = critical_velocity(parameters, law, between=wider)
            there = regime(parameters, law) if v is not None and values["v"] else None
        except (ValueError, RuntimeError) as error:
            raise CommandError(" ".join(str(error).split())) from error
    for warning in caught:
        say(f"warning: {warning.message}")
    console().print(critical_table(found, there))


def _holding(
    speed: float, typed: tuple[float | None, float | None], searched: tuple[float, float]
) -> tuple[float, float] | None:
    """Return the range searched made wider by a speed [m/s], where no typed end is in its way.

    None if it need not or cannot be.
    """
    low, high = searched
    if 0.0 < speed < low and typed[0] is None:
        return speed, high
    if speed > high and typed[1] is None:
        return low, speed
    return None
