"""`stickslip build`: write the FMU with its documentation and its evidence."""

from pathlib import Path
from typing import Literal

import typer

from stickslip.commands.expanded import command
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
    output: Path = BUILD_FOLDER,
    fmi: Literal["2", "3"] = "2",
    bare: bool = False,
    law: str = COULOMB,
    native: bool = False,
    this_machine: bool = False,
    interface: Literal["cs", "me"] = "cs",
    ssp: Literal["source", "drive", "pair"] | None = None,
    axis: Path | None = None,
) -> None:
    """Build the FMU; print its path, size and SHA-256.

    The FMU contains its documentation and its evidence: the default experiment, its result and a
    report on it. `stickslip verify --pack` replaces that report by the one on all cases. The FMU of
    another --law is named by the law's model, such as StickSlipStribeck.fmu, and is built without
    evidence.

    The --native FMU needs no Python in the simulator. It knows the built-in friction laws. That for
    model exchange (--interface me) has no evidence.

    With --ssp it is a system ready to run, without evidence: the FMU pulled by a source of speed,
    the table of an --axis by its servo drive, or a pair of such tables by one drive.
    """
    if this_machine and not native and fmi == "2" and interface == "cs":
        raise CommandError("--this-machine is for --native; the Python FMU is not compiled")
    options = {"native": native, "law": law, "this_machine": this_machine, "ssp": ssp, "axis": axis}
    fmu = built(output, "-o", fmi=int(fmi), interface=interface, **options)
    failed = False
    stepped = fmi == "3" or interface == "cs"
    if not bare and stepped and law == COULOMB and ssp is None:
        from stickslip.judgements import verify

        with long_work("Verifying the default experiment") as progress:
            verdict = verify(fmu, cases=_CASE, progress=progress).verdict
        failed = not verdict.passed
        pack_evidence(fmu, verdict, "-o")
    tell_of(fmu)
    if failed:
        say("the default experiment fails its checks; for details run stickslip verify")
        raise typer.Exit(1)
