"""The catalogue of checks: for each the consequence of its failure, and the likeliest bug."""

import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.invariants import Invariants

FILE = Path(__file__).parent / "meanings.toml"


@dataclass(frozen=True)
class Meaning:
    """The consequence of a check's failure for a user of the FMU, and the likeliest bug."""

    means: str
    look: str


@cache
def of_quantities() -> Mapping[str, Meaning]:
    """Return the meaning of each quantity that a check of a case can be about."""
    entries = tomllib.loads(FILE.read_text(encoding="utf-8"))
    return {name: Meaning(**entry) for name, entry in entries.items()}


def meanings(cases: Iterable[Case], invariants: Invariants) -> dict[str, Meaning]:
    """Return the meaning of every check by its id, those of cases first."""
    known = of_quantities()
    found = {check.id: known[check.quantity] for case in cases for check in case.checks}
    found |= {invariant.id: Meaning(invariant.means, invariant.look) for invariant in invariants}
    asymptotic = Meaning(
        "The error does not fall at one rate over all tolerances, so the observed order proves "
        "nothing about the reference.",
        "The coarsest tolerances, where a largest step limits the steps, or the finest, where "
        "rounding hides the error.",
    )
    return found | {f"{invariant.id}-asymptotic": asymptotic for invariant in invariants.orders}
