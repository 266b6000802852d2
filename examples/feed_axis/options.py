"""The options of `run` that change the axis; what is not given stays as it is in `Axis`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Final

import typer

from stickslip.units import parse

from .axis import Axis, critically_damped

# Typed with or without a unit, and numbers without one: field of the axis and SI unit.
_QUANTITIES: Final = {
    "feed": "m/s",
    "distance": "m",
    "acceleration": "m/s2",
    "m": "kg",
    "k": "N/m",
    "c": "N.s/m",
    "dead_band": "m",
    "friction_feedforward": "N",
    "lag": "s",
    "dead_time": "s",
    "dry": "N",
}
_NUMBERS: Final = {"K_v": "1/s", "omega_v": "1/s", "low_pass": "Hz", "notch": "Hz"}

_FLAGS: Final = {"K_v": "--kv"}


def option(field: str, text: str) -> Any:
    """Return the option for a field of the axis, whose help shows what the field is."""
    unit = {**_QUANTITIES, **_NUMBERS}.get(field, "")
    shown = f"{getattr(Axis(), field):g} {unit}".rstrip()
    return typer.Option(_flag(field), help=text, show_default=shown)


def axis_with(given: Mapping[str, str | float | None], integral: bool | None) -> Axis:
    """Return the axis with what was given.

    Parameters
    ----------
    given
        By field of the axis, what was typed; None where nothing was.
    integral
        Whether the velocity loop has an integral; None: as in `Axis`.

    Raises
    ------
    CommandError
        If a quantity cannot be read; the message names its option.
    ValueError
        If a value is out of range.
    """
    axis = replace(
        Axis(),
        **{
            field: parse(value, _QUANTITIES[field], _flag(field))
            if isinstance(value, str)
            else value
            for field, value in given.items()
            if value is not None
        },  # type: ignore[arg-type]
    )
    if given.get("omega_v") is None and integral is None:
        return axis
    # The integral time belongs to the bandwidth.
    wanted = axis.T_n > 0.0 if integral is None else integral
    return replace(axis, T_n=critically_damped(axis.omega_v) if wanted and axis.omega_v else 0.0)


def _flag(field: str) -> str:
    return _FLAGS.get(field, "--" + field.replace("_", "-"))
