"""Options for the FMU's parameters and inputs, described by its variable table."""

from typing import Annotated, Any

import typer

from stickslip.commands.quantities import help_text, option_name

_PARAMETERS = "Parameters (a number in SI, or with a unit: 1kN/m, 0.5 N/um, 2 kg)"
_INPUTS = "Inputs, held over the run (20mm/s, 5 N)"


def _quantity(name: str, panel: str, *spellings: str) -> Any:
    """Return the option of a variable; what is typed stays a text until it is read."""
    return typer.Option(
        option_name(name),
        *spellings,
        help=help_text(name),
        metavar="VALUE",
        rich_help_panel=panel,
        show_default=False,
    )


FrictionLaw = Annotated[
    str | None,
    typer.Option(
        "--law", metavar="MODULE:NAME", help="Friction law by its dotted name; default: Coulomb's."
    ),
]
Mass = Annotated[str | None, _quantity("m", _PARAMETERS)]
Gravity = Annotated[str | None, _quantity("g", _PARAMETERS)]
Stiffness = Annotated[str | None, _quantity("k", _PARAMETERS)]
Damping = Annotated[str | None, _quantity("c", _PARAMETERS)]
StaticFriction = Annotated[str | None, _quantity("mu_s", _PARAMETERS)]
KineticFriction = Annotated[str | None, _quantity("mu_k", _PARAMETERS)]
StartPosition = Annotated[str | None, _quantity("x_start", _PARAMETERS)]
StartVelocity = Annotated[str | None, _quantity("x_dot_start", _PARAMETERS)]
StartExtension = Annotated[str | None, _quantity("z_start", _PARAMETERS)]
PullingVelocity = Annotated[str | None, _quantity("v", _INPUTS)]
Load = Annotated[str | None, _quantity("load", _INPUTS)]
ExternalForce = Annotated[str | None, _quantity("F_ext", _INPUTS, "--f-ext")]
