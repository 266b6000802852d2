"""`stickslip verify`: judge an FMU and the reference, and write the report."""

import math
import os
import shlex
import sys
from collections.abc import Mapping, Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from stickslip.commands.options import FrictionLaw
from stickslip.commands.shared import (
    COULOMB,
    console,
    current_fmu,
    here_on_path,
    long_work,
    pack_evidence,
    tell_of,
)
from stickslip.errors import CommandError

if TYPE_CHECKING:
    from stickslip_verification import (
        Case,
        Limits,
        Meaning,
        NameMap,
        Verdict,
    )

DEFAULT_REPORT = Path("report")

LEAST_MEMORY = 0.1
"""Gigabytes; the suite takes half of them itself."""


class ContractName(StrEnum):
    """The contracts that a person may choose."""

    EXACT = "exact"
    PHYSICS = "physics"


def verify(
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
            help="Only the cases of this shell pattern ('damped-*'), or cases of your own. Beside "
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
    from stickslip.show import verdict_table as tables

    chosen = _cases(cases)
    if list_:
        console().print(tables.case_table(chosen))
        return
    _check(fmu, law, names)
    _check_contract(contract, strict, pack)
    share = _share(within)
    limits = _limits(time_limit, budget, memory)
    _check_pack(pack, fmu, names, cases)
    name_map = _names(names, chosen)
    _check_targets(output)
    fmu = fmu or current_fmu(law)
    verdict = _verdict(
        fmu,
        chosen,
        names=name_map,
        contract=None if contract is None else contract.value,
        strict=strict,
        jobs=jobs,
        time_limit=time_limit,
        limits=limits,
        sequences=_count_of(sequences, cases),
        seed=seed,
        long_probes=cases is None or Path(cases).is_dir(),
        within=share,
        full=full or sequences is not None,
    )
    written = _write(verdict, chosen, output, full=paper)
    screen = console()
    if all_:
        screen.print(tables.verdict_table(verdict, screen.width))
    else:
        from stickslip.show.verdict_summary import verdict_summary

        screen.print(verdict_summary(verdict, _meanings(chosen)))
    for file in written:
        print(file)
    if pack:
        pack_evidence(fmu, verdict, "--fmu")
        tell_of(fmu)
    if not verdict.passed:
        raise typer.Exit(1)


def _cases(wanted: str | None) -> "list[Case]":
    """Load the cases that a pattern, a folder or a file names."""
    from stickslip_verification import CaseError, load_case, load_cases

    try:
        with here_on_path():
            if wanted is not None and Path(wanted).is_dir():
                return load_cases(folder=Path(wanted))
            if wanted is not None and wanted.endswith(".toml"):
                return [load_case(Path(wanted))]
            return load_cases(wanted)
    except CaseError as error:
        raise CommandError(str(error)) from error


def _count_of(sequences: int | None, cases: str | None) -> int:
    """Return how many random sequences are tried: all of them, but none beside chosen cases."""
    from stickslip_verification.suite.sequences import COUNT

    if sequences is None:
        return 0 if cases is not None else COUNT
    return sequences


def _meanings(cases: "Sequence[Case]") -> "Mapping[str, Meaning]":
    from stickslip_verification import load_invariants, meanings

    return meanings(cases, load_invariants())


def _check_contract(contract: ContractName | None, strict: bool, pack: bool) -> None:
    """Refuse a chosen contract beside what leaves no choice."""
    for option, given in (("--strict", strict), ("--pack", pack)):
        if contract is not None and given:
            raise CommandError(f"{option} does not go with --contract")


def _share(within: str | None) -> float | None:
    """Read the part by which a quantity of the cycle may be off."""
    from stickslip.units import parse

    if within is None:
        return None
    share = parse(within, "1", "--within", "above 0 and below 1")
    if not 0.0 < share < 1.0:
        raise CommandError(
            f"--within {within}: must be above 0 % and below 100 %, as 1% or as 0.01"
        )
    return share


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
    from stickslip_verification.drive.fmu.description import FmuError
    from stickslip_verification.drive.fmu.instance import FmuFile

    try:
        file = FmuFile(fmu)
    except FmuError as error:
        raise CommandError(str(error)) from error
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


def _names(file: Path | None, cases: "Sequence[Case]") -> "NameMap | None":
    from stickslip_verification import NamesError, load_names

    if file is None:
        return None
    try:
        return load_names(file, [each for case in cases for each in case.own])
    except NamesError as error:
        raise CommandError(f"--names {error}") from error


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


def _verdict(fmu: Path, cases: "Sequence[Case]", **options: Any) -> "Verdict":
    """Judge the FMU; the options are those of `stickslip_verification.verify`."""
    from stickslip_verification import FmuError, verify

    command = shlex.join(["stickslip", *sys.argv[1:]])
    # The friction law of a case may stand in a module here.
    with here_on_path(), long_work("Verifying") as progress:
        try:
            return verify(fmu, cases, progress, command=command, **options)
        except FmuError as error:
            raise CommandError(str(error)) from error


def _write(verdict: "Verdict", cases: "Sequence[Case]", output: Path, *, full: bool) -> list[Path]:
    """Write the report, and give the files that a person may want to open."""
    from stickslip.progress import Meter
    from stickslip_verification import write_json, write_report

    with Meter("Writing the report"):
        if output.suffix == ".json":
            write_json(verdict, output)
            return [output]
        write_report(verdict, output, meanings=_meanings(cases), full=full)
        return [output / "index.html", output / "report.json"]
