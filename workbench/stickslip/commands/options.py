"""Options that several commands share."""

from dataclasses import dataclass, field
from typing import Annotated

import typer

_PANEL = "Computing"

FrictionLaw = Annotated[
    str,
    typer.Option(
        "--law",
        metavar="NAME",
        help="Friction law: coulomb (the default), stribeck, or MODULE:NAME for one of your own.",
    ),
]


@dataclass(frozen=True, kw_only=True)
class Computing:
    """How a study is computed."""

    workers: int | None = field(
        default=None,
        metadata={
            "metavar": "N",
            "help": "Processes on this machine; default: one a core.",
            "panel": _PANEL,
        },
    )
    cluster: str | None = field(
        default=None,
        metadata={
            "metavar": "ADDRESS",
            "help": "Compute on the workers of a dask scheduler (tcp://host:8786), which share the "
            "folder of the study.",
            "panel": _PANEL,
        },
    )
    fresh: bool = field(
        default=False,
        metadata={
            "help": "Throw away what an earlier run of another study, or of other versions, has "
            "left.",
            "panel": _PANEL,
        },
    )
    yes: bool = field(
        default=False,
        metadata={"help": "Compute more than 10^9 points.", "panel": _PANEL},
    )
