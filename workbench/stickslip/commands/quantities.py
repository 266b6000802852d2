"""Values typed for the FMU's parameters and inputs, and for the times of an experiment.

Names, units, ranges and defaults are those of the FMU's variable table.
"""

import math
from collections.abc import Mapping
from typing import Final

from fmi.table import Table, Variable
from stickslip import units
from stickslip.errors import CommandError
from stickslip_fmu.spec import TABLE

LARGEST_SAMPLE_COUNT: Final = 1_000_000
"""Samples of a run: they take 1.5 GB and a minute."""


def option_name(name: str) -> str:
    """Return the option of the command that sets the variable `name`: ``--mu-s`` for ``mu_s``."""
    if name not in TABLE.by_name:
        return f"--law-parameter {name}"
    return "--" + name.replace("_", "-")


def help_text(name: str) -> str:
    """Describe the option of the variable `name`: meaning, unit, range and default."""
    variable = TABLE.by_name[name]
    unit = "" if variable.unit == "1" else f" [{variable.unit}]"
    limits = "" if variable.minimum is None else f", {variable.range}"
    return f"{variable.description}{unit}{limits}; default {variable.start:g}."


def read_values(typed: Mapping[str, str | None], table: Table = TABLE) -> dict[str, float]:
    """Read what was typed for parameters and inputs; the rest takes its start value.

    Parameters
    ----------
    typed
        Name of a variable to the text given, None where none was.
    table
        The variable table, that of another friction law where there is one.

    Returns
    -------
    dict
        Every parameter and input by name, SI.

    Raises
    ------
    CommandError
        If a text is no quantity of the variable's dimension or out of its range.
    """
    values = table.start_values()
    for name, text in typed.items():
        if text is None:
            continue
        if name not in values:
            raise CommandError(f"{option_name(name)} {text!r}: the friction law has no {name}")
        variable = table.by_name[name]
        value = _number(text, variable)
        objection = variable.objection(value)
        if objection is not None:
            raise CommandError(f"{option_name(name)} {text!r}: {objection}")
        values[name] = value
    return values


def read_above_zero(typed: str | None, unit: str, option: str) -> float | None:
    """Read what was typed for an option that must be above 0, in SI; None where nothing was.

    Raises
    ------
    CommandError
        If it is no quantity of the dimension of `unit`, or not above 0.
    """
    if typed is None:
        return None
    value = units.parse(typed, unit, option, "above 0")
    if not value > 0.0:
        raise CommandError(f"{option} {typed!r} is out of range: it must be above 0 {unit}")
    return value


def _number(text: str, variable: Variable) -> float:
    """Read a value; of an enumeration by the name of an item too."""
    items = {item.name.lower(): item.value for item in variable.type.items}
    items |= {str(value): value for value in items.values()}
    option = option_name(variable.name)
    if items:
        if text.strip().lower() not in items:
            raise CommandError(f"{option} {text!r} is out of range: it must be {variable.range}")
        return items[text.strip().lower()]
    value = units.parse(text, variable.unit or "1", option, f"({variable.range})")
    if variable.kind == "Integer" and not value.is_integer():
        raise CommandError(f"{option} {text!r} is no whole number")
    return value


def read_experiment(
    start_time: str, stop_time: str, output_interval: str | None
) -> tuple[float, float, float | None]:
    """Read the times of an experiment [s].

    Raises
    ------
    CommandError
        If a text is no time, the stop is not after the start, or the interval is not positive or
        makes more than a million samples.
    """
    start = units.parse(start_time, "s", "--start-time")
    stop = units.parse(stop_time, "s", "--stop-time", "after the start")
    if not stop > start:
        raise CommandError(
            f"--stop-time {stop_time!r} is out of range: it must be after the start, > {start:g} s"
        )
    interval = read_above_zero(output_interval, "s", "--output-interval")
    smallest = max((stop - start) / LARGEST_SAMPLE_COUNT, math.ulp(max(abs(start), abs(stop))))
    if interval is not None and interval < smallest:
        raise CommandError(
            f"--output-interval {output_interval!r} is out of range: it must be at least "
            f"{smallest:.3g} s for a run of {stop - start:g} s, a million samples"
        )
    return start, stop, interval
