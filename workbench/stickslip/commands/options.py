"""Options for the FMU's parameters and inputs, described by its variable table."""

from pathlib import Path
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


_LAW = typer.Option(
    "--law",
    metavar="NAME",
    help="Friction law: coulomb (the default), stribeck, or MODULE:NAME for one of your own.",
)
FrictionLaw = Annotated[str, _LAW]
FrictionLawOrThatOfCurve = Annotated[str | None, _LAW]
MappedLaw = Annotated[
    str | None,
    typer.Option(
        "--law",
        metavar="NAME",
        help="Friction law: coulomb, or stribeck, which is that of a --curve.",
        show_default=False,
    ),
]
LawParameter = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME=VALUE",
        help="A parameter of the --law, such as v_s=1mm/s; may be repeated.",
    ),
]
MeasuredCurve = Annotated[
    Path | None,
    typer.Option(
        "--curve",
        metavar="FILE.csv",
        help="Measured friction curve, for --law stribeck: columns such as 'speed [mm/s]' and "
        "mu, or force [N] with --normal-force.",
    ),
]
NormalForce = Annotated[
    str | None,
    typer.Option(
        metavar="VALUE",
        help="Normal force under which the forces of --curve were measured (200 N).",
    ),
]
Mass = Annotated[str | None, _quantity("m", _PARAMETERS)]
Gravity = Annotated[str | None, _quantity("g", _PARAMETERS)]
Stiffness = Annotated[str | None, _quantity("k", _PARAMETERS)]
Damping = Annotated[str | None, _quantity("c", _PARAMETERS)]
StaticFriction = Annotated[str | None, _quantity("mu_s", _PARAMETERS)]
KineticFriction = Annotated[str | None, _quantity("mu_k", _PARAMETERS)]
GrowthTime = Annotated[str | None, _quantity("tau_s", _PARAMETERS)]
LogarithmicGrowth = Annotated[str | None, _quantity("B", _PARAMETERS)]
LogarithmTime = Annotated[str | None, _quantity("t_0", _PARAMETERS)]
StartAge = Annotated[str | None, _quantity("age_start", _PARAMETERS)]
StartPosition = Annotated[str | None, _quantity("x_start", _PARAMETERS)]
StartVelocity = Annotated[str | None, _quantity("x_dot_start", _PARAMETERS)]
StartExtension = Annotated[str | None, _quantity("z_start", _PARAMETERS)]
PullingVelocity = Annotated[str | None, _quantity("v", _INPUTS)]
Load = Annotated[str | None, _quantity("load", _INPUTS)]
ExternalForce = Annotated[str | None, _quantity("F_ext", _INPUTS, "--f-ext")]

_COMPUTING = "Computing"
Workers = Annotated[
    int | None,
    typer.Option(
        "--workers",
        metavar="N",
        help="Processes on this machine; default: one a core.",
        rich_help_panel=_COMPUTING,
    ),
]
Cluster = Annotated[
    str | None,
    typer.Option(
        "--cluster",
        metavar="ADDRESS",
        help="Compute on the workers of a dask scheduler (tcp://host:8786), which share the folder "
        "of the study.",
        rich_help_panel=_COMPUTING,
    ),
]
Fresh = Annotated[
    bool,
    typer.Option(
        "--fresh",
        help="Throw away what an earlier run of another study, or of other versions, has left.",
        rich_help_panel=_COMPUTING,
    ),
]
Yes = Annotated[
    bool,
    typer.Option("--yes", help="Compute more than 10^9 points.", rich_help_panel=_COMPUTING),
]
