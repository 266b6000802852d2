"""`stickslip verify`: judge an FMU and the reference, and write the report."""

import math
import os
import shlex
import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stickslip.commands.expanded import command
from stickslip.commands.options import FrictionLaw
from stickslip.commands.shared import (
    COULOMB,
    console,
    current_fmu,
    long_work,
    pack_evidence,
    tell_of,
)
from stickslip.errors import CommandError

if TYPE_CHECKING:
    from stickslip.judgements import FmuVerdict
    from stickslip_verification import Limits

DEFAULT_REPORT = Path("report")

LEAST_MEMORY = 0.1
"""Gigabytes; the suite takes half of them itself."""


class ContractName(StrEnum):
    """The contracts that a person may choose."""

    EXACT = "exact"
    PHYSICS = "physics"


@command
def verify(
    *,
    fmu: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="The FMU to verify; default: build/StickSlip.fmu, built anew."
        ),
    ] = None,
    law: FrictionLaw = COULOMB,
    names: Annotated[
        Path | None,
        typer.Option(metavar="FILE.toml", help="Names file: the FMU's names of the variables."),
    ] = None,
    contract: Annotated[
        ContractName | None,
        typer.Option(help="The contract; default: exact if the FMU's description names it."),
    ] = None,
    strict: Annotated[
        bool, typer.Option("--strict", help="Contract checks decide for any FMU.")
    ] = False,
    cases: Annotated[
        str | None,
        typer.Option(
            metavar="PATTERN|DIR|FILE.toml",
            help="Only the cases of shell patterns ('damped-*,heat'), or cases of your own. Beside "
            "single cases (PATTERN, FILE.toml) no probe runs that takes a fresh process: memory, "
            "serialized state, environment.",
        ),
    ] = None,
    sequences: Annotated[
        int | None,
        typer.Option(
            min=0, help="Number of random sequences beside the cases; default: 320, 0 with --cases."
        ),
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of the random sequences.")] = 1,
    list_: Annotated[bool, typer.Option("--list", help="List the cases and exit.")] = False,
    all_: Annotated[
        bool, typer.Option("--all", help="Print every comparison, not one row per case.")
    ] = False,
    jobs: Annotated[
        int | None,
        typer.Option(min=1, help="Parallel processes, 4 per processor at most; default: one."),
    ] = None,
    time_limit: Annotated[
        float, typer.Option(metavar="SECONDS", help="Limit for one run of the FMU.")
    ] = 60.0,
    budget: Annotated[
        float | None,
        typer.Option(
            metavar="SECONDS",
            help="Limit for all runs of the FMU without a result together; default: 120, or the "
            "time limit if that is longer.",
        ),
    ] = None,
    memory: Annotated[
        float,
        typer.Option(metavar="GB", help="Limit for a process of the FMU; none on Windows."),
    ] = 4.0,
    within: Annotated[
        str | None,
        typer.Option(
            metavar="PERCENT|RATIO",
            help="What an FMU of the physics contract must be within ('1%', 0.01) in jump, stick, "
            "slip, period and force; default: 1e-6.",
        ),
    ] = None,
    pack: Annotated[
        bool, typer.Option("--pack", help="Put the report into the FMU as evidence (extra/).")
    ] = False,
    full: Annotated[
        bool,
        typer.Option("--full", help="Try an FMU of the physics contract on all cases, sequences."),
    ] = False,
    paper: Annotated[
        bool, typer.Option("--paper", help="Print every comparison in the report on paper.")
    ] = False,
    output: Annotated[
        Path,
        typer.Option(
            "--output", "-o", metavar="DIR|FILE.json", help="Folder of the report, or JSON alone."
        ),
    ] = DEFAULT_REPORT,
) -> None:
    """Check an FMU and the reference against the truth; exit 0 if all checks pass, else 1."""
    from stickslip import judgements
    from stickslip.show import verdict_table as tables

    if list_:
        console().print(tables.case_table(judgements.load_cases(cases)))
        return
    _check(fmu, law, names)
    _check_contract(contract, strict, pack)
    limits = _limits(time_limit, budget, memory)
    _check_pack(pack, fmu, names, cases)
    if cases is not None:
        judgements.load_cases(cases)
    judgements.share(within)
    _check_targets(output)
    fmu = fmu or current_fmu(law)
    with long_work("Verifying") as progress:
        found = judgements.verify(
            fmu,
            cases=cases,
            names=names,
            within=within,
            sequences=sequences,
            progress=progress,
            contract=None if contract is None else contract.value,
            strict=strict,
            jobs=jobs,
            time_limit=time_limit,
            limits=limits,
            seed=seed,
            full=full or sequences is not None,
            command=shlex.join(["stickslip", *sys.argv[1:]]),
        )
    written = _write(found, output, full=paper)
    screen = console()
    screen.print(tables.verdict_table(found.verdict) if all_ else found.table())
    for file in written:
        print(file)
    if pack:
        pack_evidence(fmu, found.verdict, "--fmu")
        tell_of(fmu)
    if not found.passed:
        raise typer.Exit(1)


def _check_contract(contract: ContractName | None, strict: bool, pack: bool) -> None:
    """Refuse a chosen contract beside what leaves no choice."""
    for option, given in (("--strict", strict), ("--pack", pack)):
        if contract is not None and given:
            raise CommandError(f"{option} does not go with --contract")


def _check_pack(pack: bool, fmu: Path | None, names: Path | None, wanted: str | None) -> None:
    """Refuse to pack a report that is not on all cases, or into a file that cannot take it."""
    from stickslip.files import check_writable

    if not pack:
        return
    if names is not None:
        raise CommandError("--pack does not go with --names: only the exact block takes evidence")
    if wanted is not None:
        raise CommandError("--pack does not go with --cases: the report in the FMU is on all cases")
    if fmu is None:
        return
    from stickslip_fmu.laws.named import BUILT_IN, friction_law
    from stickslip_verification.drive.instance import FmuFile

    file = FmuFile(fmu)
    file.close()
    models = [friction_law(name).law.interface.model for name in BUILT_IN]
    if not file.stated.exact or file.model_identifier not in models:
        raise CommandError(f"--pack: {fmu} is not the exact block as stickslip build makes it")
    check_writable(fmu, "--pack")
    if not os.access(fmu, os.W_OK):
        raise CommandError(f"--pack {fmu}: it is write-protected")


def _check(fmu: Path | None, law: str, names: Path | None) -> None:
    if fmu is not None and not fmu.is_file():
        raise CommandError(f"--fmu {fmu}: {'not a file' if fmu.exists() else 'no such file'}")
    if fmu is not None and law != COULOMB:
        raise CommandError("--law goes without --fmu: an FMU's variables say its friction law")
    if names is not None and fmu is None:
        raise CommandError("--names goes with --fmu: the default FMU has the standard names")


def _limits(time_limit: float, budget: float | None, memory: float) -> "Limits":
    from stickslip_verification import Limits

    if not 0.0 < time_limit < math.inf:
        raise CommandError(f"--time-limit {time_limit!r}: must be above 0 s and finite")
    if budget is not None and not 0.0 < budget < math.inf:
        raise CommandError(f"--budget {budget!r}: must be above 0 s and finite")
    if not LEAST_MEMORY <= memory < math.inf:
        raise CommandError(f"--memory {memory!r}: must be {LEAST_MEMORY} GB at least and finite")
    return Limits(max(Limits.budget, time_limit) if budget is None else budget, memory)


def _check_targets(output: Path) -> None:
    """Refuse what cannot be written before the run, not after it."""
    from stickslip.files import check_writable, make_folder

    if output.suffix == ".json":
        make_folder(output.parent, "-o")
        check_writable(output, "-o")
    else:
        make_folder(output, "-o")
        for name in ("index.html", "report.json", "junit.xml"):
            check_writable(output / name, "-o")


def _write(found: "FmuVerdict", output: Path, *, full: bool) -> list[Path]:
    """Write the report, and give the files that a person may want to open."""
    from stickslip.progress import Meter
    from stickslip_verification import write_json

    with Meter("Writing the report"):
        if output.suffix == ".json":
            write_json(found.verdict, output)
            return [output]
        return [found.report(output, full=full), output / "report.json"]
