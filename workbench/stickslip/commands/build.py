"""`stickslip build`: write the FMU with its documentation and its evidence."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from stickslip.commands.expanded import FrictionLaw, command, opt
from stickslip.commands.shared import (
    BUILD_FOLDER,
    COULOMB,
    built,
    long_work,
    pack_evidence,
    say,
    tell_of,
)
from stickslip.errors import CommandError

_CASE = "default"
"""The case that a build judges; `stickslip verify --pack` judges all of them."""


@command
def build(
    *,
    output: Annotated[
        Path,
        opt(
            "File to write, or folder for StickSlip.fmu.",
            "DIR|FILE.fmu",
            "--output",
            "-o",
        ),
    ] = BUILD_FOLDER,
    fmi: Annotated[
        Literal["2", "3"], opt("The standard: 2.0, or 3.0 in C: StickSlip_native_fmi3.fmu.")
    ] = "2",
    bare: Annotated[bool, opt("Leave out the evidence (extra/), which takes seconds.")] = False,
    law: FrictionLaw = COULOMB,
    native: Annotated[
        bool, opt("The FMU in C for all platforms, StickSlip_native.fmu; needs ziglang.")
    ] = False,
    this_machine: Annotated[bool, opt("With --native: for this machine, by its cc.")] = False,
) -> None:
    """Build the FMU; print its path, size and SHA-256.

    The FMU contains its documentation and its evidence: the default experiment, its result and a
    report on it. `stickslip verify --pack` replaces that report by the one on all cases. The FMU of
    another --law is named by the law's model, such as StickSlipStribeck.fmu, and is built without
    evidence.

    The --native FMU needs no Python in the simulator. It knows the built-in friction laws.
    """
    if this_machine and not native and fmi == "2":
        raise CommandError("--this-machine is for --native; the Python FMU is not compiled")
    fmu = built(output, "-o", native=native, fmi=int(fmi), law=law, this_machine=this_machine)
    failed = False
    if not bare and law == COULOMB:
        from stickslip.judgements import verify

        with long_work("Verifying the default experiment") as progress:
            verdict = verify(fmu, cases=_CASE, progress=progress).verdict
        failed = not verdict.passed
        pack_evidence(fmu, verdict, "-o")
    tell_of(fmu)
    if failed:
        say("the default experiment fails its checks; for details run stickslip verify")
        raise typer.Exit(1)
