"""What all probes need: values before the start, and what an FMU lacks for them."""

from collections.abc import Iterable

from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.stepping import NotApplicableError
from stickslip_verification.truth.parameters import START_VALUES


def defaults(fmu: FmuFile) -> dict[str, float]:
    """Return our default of every parameter and input that the FMU has (SI)."""
    return {name: value for name, value in START_VALUES.items() if fmu.has(name)}


def need(fmu: FmuFile, names: Iterable[str]) -> None:
    """Raise `NotApplicableError` with the names that the FMU lacks, if it lacks any."""
    absent = [name for name in names if not fmu.has(name)]
    if absent:
        raise NotApplicableError(f"it has no variable {', '.join(absent)}")


def need_instances(fmu: FmuFile) -> None:
    """Raise `NotApplicableError` if only one instance may be made in a process."""
    if fmu.once_per_process:
        raise NotApplicableError("it cannot be instantiated twice in a process, by its description")
