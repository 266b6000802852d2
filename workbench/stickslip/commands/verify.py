"""`stickslip verify`: judge an FMU and the reference, and write the report."""

import math
import os
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import typer

from stickslip.commands.expanded import command
from stickslip.commands.shared import (
    COULOMB,
    console,
    current_fmu,
    long_work,
    pack_evidence,
    say,
    tell_of,
)
from stickslip.errors import CommandError

if TYPE_CHECKING:
    from stickslip.judgements import FmuVerdict

DEFAULT_REPORT = Path("report")

LEAST_MEMORY = 0.1
"""Gigabytes; the suite takes half of them itself."""


@command
def verify(
    *,
    fmu: Path | None = None,
    law: str = COULOMB,
    names: Path | None = None,
    interface: Literal["cs", "me"] = "cs",
    contract: Literal["exact", "physics"] | None = None,
    strict: bool = False,
    cases: str | None = None,
    sequences: int | None = None,
    seed: int = 1,
    list_: bool = False,
    all_: bool = False,
    jobs: int | None = None,
    time_limit: float = 60.0,
    budget: float | None = None,
    memory: float = 4.0,
    within: str | None = None,
    pack: bool = False,
    full: bool = False,
    paper: bool = False,
    output: Path = DEFAULT_REPORT,
) -> None:
    """Check an FMU and the reference against the truth; exit 0 if all checks pass, else 1."""
    from stickslip import judgements
    from stickslip.show import verdict as tables

    if list_:
        console().print(tables.case_table(judgements.load_cases(cases)))
        return
    from stickslip_verification import Limits

    for option, seconds in (("--time-limit", time_limit), ("--budget", budget)):
        if seconds is not None and not 0.0 < seconds < math.inf:
            raise CommandError(f"{option} {seconds!r}: must be above 0 s and finite")
    if not LEAST_MEMORY <= memory < math.inf:
        raise CommandError(f"--memory {memory!r}: must be {LEAST_MEMORY} GB at least and finite")
    solved = interface == "me"
    there = "not a file" if fmu and fmu.exists() else "no such file"
    refusals = {
        f"--fmu {fmu}: {there}": fmu and not fmu.is_file(),
        "--law goes without --fmu: an FMU's variables say its friction law": fmu and law != COULOMB,
        "--names goes with --fmu: the default FMU has the standard names": names and not fmu,
        "--interface me goes with --fmu: the default FMU has co-simulation alone": solved
        and not fmu,
        "--strict, --pack and the exact contract do not go with --interface me: the motion is that "
        "of the solver, not of the FMU": solved and (strict or pack or contract == "exact"),
        "--strict does not go with --contract": contract and strict,
        "--pack does not go with --contract": contract and pack,
        "--pack does not go with --names: only the exact block takes evidence": pack and names,
        "--pack does not go with --cases: the report in the FMU is on all cases": pack and cases,
    }
    for refusal, is_wrong in refusals.items():
        if is_wrong:
            raise CommandError(refusal)
    if pack and fmu:
        _check_packable(fmu)
    if cases is not None and fmu is None:
        # Wrong ones are refused before an FMU is built.
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
            interface=interface,
            contract=contract,
            strict=strict,
            jobs=jobs,
            time_limit=time_limit,
            limits=Limits(max(Limits.budget, time_limit) if budget is None else budget, memory),
            seed=seed,
            full=full or sequences is not None,
            command=shlex.join(["stickslip", *sys.argv[1:]]),
        )
    if within is not None and found.verdict.exact:
        say(f"--within {within} is not asked of an FMU that is held to the exact contract")
    written = _write(found, output, full=paper)
    console().print(tables.verdict_table(found.verdict) if all_ else found.table())
    for file in written:
        print(file)
    if pack:
        pack_evidence(fmu, found.verdict, "--fmu")
        tell_of(fmu)
    if not found.passed:
        raise typer.Exit(1)


def _check_packable(fmu: Path) -> None:
    """Refuse to pack a report into a file that cannot take it."""
    from stickslip.files import check_writable
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
    from stickslip.progress import meter
    from stickslip_verification import write_json

    with meter("Writing the report"):
        if output.suffix == ".json":
            write_json(found.verdict, output)
            return [output]
        return [found.report(output, full=full), output / "report.json"]
