"""The contract that an FMU is held to: what a person says, or else what the FMU promises."""

from collections.abc import Mapping
from typing import Final, Literal

from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.judge.checks import (
    EXACT_CONTRACT,
    PHYSICS_CONTRACT,
    STRICT_CONTRACT,
    Contract,
)
from stickslip_verification.model.verdict import ChosenContract

Wanted = Literal["exact", "physics"]

CONTRACTS: Final[Mapping[str, Contract]] = {
    "exact": EXACT_CONTRACT,
    "physics": PHYSICS_CONTRACT,
    "strict": STRICT_CONTRACT,
}
"""How an FMU is judged, by the name of the contract."""


def chosen_contract(
    fmu: FmuFile, wanted: Wanted | None = None, *, strict: bool = False
) -> ChosenContract:
    """Choose the contract of an FMU, and say why.

    Parameters
    ----------
    fmu
        The FMU. With a names file it is held to the physics contract, whatever it promises.
    wanted
        What the person says, or None.
    strict
        Hold an FMU that would be held to the physics contract to the strict one.
    """
    if wanted is not None:
        return ChosenContract(wanted, f"--contract {wanted}")
    if fmu.stated.exact and not fmu.names.targets:
        return ChosenContract("exact", fmu.stated.told)
    if strict:
        return ChosenContract("strict", "--strict")
    return ChosenContract(
        "physics", "a names file is given" if fmu.names.targets else fmu.stated.told
    )
