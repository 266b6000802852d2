"""Options for the FMU's parameters and inputs, described by its variable table."""

from typing import Any

import typer

from stickslip.quantities import help_text, option_name


def parameter(name: str) -> Any:
    """Give the option of a parameter; what is typed stays a text until it is read."""
    return _quantity(name, "Parameters (a number in SI, or with a unit: 1kN/m, 0.5 N/um, 2 kg)")


def held_input(name: str, *spellings: str) -> Any:
    """Give the option of an input, which is held over the run; `spellings` are further names."""
    return _quantity(name, "Inputs, held over the run (20mm/s, 5 N)", *spellings)


def _quantity(name: str, panel: str, *spellings: str) -> Any:
    return typer.Option(
        option_name(name),
        *spellings,
        help=help_text(name),
        metavar="VALUE",
        rich_help_panel=panel,
        show_default=False,
    )
