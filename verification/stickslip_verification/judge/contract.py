"""The contract that an FMU is held to: what a person says, or else what the FMU promises."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal

from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.model.verdict import ChosenContract

Wanted = Literal["exact", "physics"]


@dataclass(frozen=True)
class Contract:
    """How a side, fmu or reference, is judged.

    ``interface``: it promises the interface, so that its own start values are tried, and a missing
    output is a failure and not a feature that it lacks. ``exact``: it is held to the tolerances of
    the exact block, not to those of a numerical solution. ``contract``: contract checks decide.
    """

    side: str
    interface: bool = True
    exact: bool = True
    contract: bool = True

    @property
    def column(self) -> str:
        """Whose tolerance it is held to: fmu or reference."""
        return "fmu" if self.exact else "reference"

    @property
    def numerical(self) -> bool:
        """Whether an FMU is judged as a numerical solution, see `run.numerical`."""
        return self.side == "fmu" and not self.exact


EXACT_CONTRACT = Contract("fmu")
REFERENCE_CONTRACT = Contract("reference", exact=False)
PHYSICS_CONTRACT = Contract("fmu", interface=False, exact=False, contract=False)
STRICT_CONTRACT = Contract("fmu", interface=False)

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

    With a names file it is held to the physics contract, whatever it promises. `wanted` is what the
    person says; `strict` holds an FMU to the strict contract in place of the physics one.
    """
    named = bool(fmu.names.targets)
    if wanted is not None:
        return ChosenContract(wanted, f"--contract {wanted}")
    if fmu.stated.exact and not named:
        return ChosenContract("exact", fmu.stated.told)
    if strict:
        return ChosenContract("strict", "--strict")
    return ChosenContract("physics", "a names file is given" if named else fmu.stated.told)
