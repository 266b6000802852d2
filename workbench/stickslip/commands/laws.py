"""The friction law that a command was given: its variable table, and values of its parameters."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from stickslip.commands.quantities import read_above_zero, read_values
from stickslip.commands.shared import COULOMB, here_on_path
from stickslip.errors import CommandError
from stickslip_fmu.interface import FIRST_OWN

if TYPE_CHECKING:
    from fmi.table import Table
    from stickslip_design.curve_file import Curve

CURVE_LAW = "stribeck"
"""The friction law that a measured curve is given to."""


def read_law(
    law: str | None,
    typed: Mapping[str, str | None],
    own: list[str] | None,
    curve: Path | None,
    normal_force: str | None,
) -> "tuple[str, Table, dict[str, float]]":
    """Return the friction law that is meant, its variable table, and every value [SI] by name.

    Parameters
    ----------
    law
        The friction law that is named, None for that of the curve or Coulomb's.
    typed
        What was typed for parameters and inputs that have an option of their own, by name.
    own, curve, normal_force
        What was typed for the law: as of `values_of_law`.
    """
    law = law_of(law, curve)
    table = table_of_law(law)
    of_law = values_of_law(own or [], table, curve, normal_force, typed["mu_s"])
    return law, table, read_values({**typed, **of_law}, table)


def law_of(law: str | None, curve: Path | None) -> str:
    """Return the friction law that is meant: that of a measured curve where none is named."""
    if curve is None:
        return COULOMB if law is None else law
    if law not in (None, CURVE_LAW):
        raise CommandError(f"--curve goes with --law {CURVE_LAW}, not with --law {law}")
    return CURVE_LAW


def table_of_law(law: str) -> "Table":
    """Return the variable table of the block under a friction law."""
    from stickslip_fmu.interface import table_of
    from stickslip_fmu.laws.named import friction_law

    try:
        with here_on_path():
            return table_of(friction_law(law).law.interface)
    except ValueError as error:
        raise CommandError(f"--law: {error}") from error


def values_of_law(
    typed: list[str],
    table: "Table",
    curve: Path | None,
    normal_force: str | None,
    mu_s: str | None,
) -> dict[str, str]:
    """Return what was typed for parameters of the friction law, by name, those of a curve too.

    Parameters
    ----------
    typed
        ``NAME=VALUE`` each.
    table
        The variable table of the friction law.
    curve
        File of a measured friction curve. It sets `mu_s` too where that is not typed: the largest
        friction at rest is then the friction of the curve at speed 0.
    normal_force
        What was typed for the normal force under which the curve was measured.
    mu_s
        What was typed for the break-away coefficient.
    """
    own = [row.name for row in table.rows if row.settable and row.number >= FIRST_OWN]
    values = dict(text.partition("=")[::2] for text in typed)
    unknown = [name for name in values if name not in own]
    if unknown:
        known = f"it has {', '.join(own)}" if own else "it has none"
        raise CommandError(
            f"--law-parameter {unknown[0]!r}: the friction law has no such parameter; {known}; "
            "expected NAME=VALUE"
        )
    if curve is None:
        if normal_force is not None:
            raise CommandError("--normal-force goes with --curve")
        return values
    of_curve = _curve(curve, read_above_zero(normal_force, "N", "--normal-force")).parameters
    twice = sorted(values.keys() & of_curve.keys())
    if twice:
        raise CommandError(f"--law-parameter {twice[0]}: --curve {curve} sets it")
    if mu_s is None:
        values["mu_s"] = repr(of_curve["mu_1"])
    return values | {name: repr(value) for name, value in of_curve.items()}


def _curve(file: Path, normal_force: float | None) -> "Curve":
    from stickslip_design.curve_file import CurveError, read_curve

    try:
        curve = read_curve(file, normal_force)
    except CurveError as error:
        raise CommandError(f"--curve {error}") from None
    if normal_force is not None and not curve.of_forces:
        raise CommandError(f"--normal-force: --curve {file} has coefficients, not forces")
    return curve
