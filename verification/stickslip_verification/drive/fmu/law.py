"""The friction law of an FMU, and the cases that fit it."""

from collections.abc import Sequence

from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.suite.cases import Case
from stickslip_verification.truth.named import BUILT_IN, COULOMB_NAME


def law_of(fmu: FmuFile) -> str:
    """Return the name of the built-in friction law whose parameters an FMU has all.

    Coulomb's law where it has those of no other.
    """
    for name, law in BUILT_IN.items():
        if name != COULOMB_NAME:
            fmu.look_for(law.parameters, optional=True)
            if all(fmu.has(each.name) for each in law.parameters):
                return name
    return COULOMB_NAME


def fitting(fmu: FmuFile, cases: Sequence[Case]) -> list[Case]:
    """Return the cases of the friction law of an FMU, or from elsewhere; `FmuError` if none is."""
    law = law_of(fmu)
    fit = [case for case in cases if case.law == law or case.law not in BUILT_IN]
    if not fit:
        laws = " and ".join(dict.fromkeys(case.law for case in cases))
        raise FmuError(
            f"{fmu.path}: its friction law is {law}, and the cases are of the friction law {laws}; "
            f"choose cases of {law}, or build the FMU with stickslip build --law {cases[0].law}"
        )
    return fit
