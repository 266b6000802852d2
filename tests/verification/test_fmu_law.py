"""The friction law of an FMU is told by its parameters, and only all of them tell it."""

from collections.abc import Iterable
from typing import Any

import pytest

from stickslip_verification import load_cases
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.law import fitting, law_of
from stickslip_verification.truth import friction_law
from stickslip_verification.truth.parameters import Parameter

ALL = [each.name for each in friction_law("stribeck").parameters]


class Variables:
    """Stands for an FMU that has variables of these names."""

    path = "some.fmu"

    def __init__(self, names: Iterable[str]) -> None:
        self.names = set(names)

    def look_for(self, parameters: Iterable[Parameter], **how: Any) -> None:
        """Find nothing more."""

    def has(self, name: str) -> bool:
        """Tell whether there is such a variable."""
        return name in self.names


@pytest.mark.parametrize(
    ("names", "law"),
    [([], "coulomb"), (["delta"], "coulomb"), (ALL[1:], "coulomb"), (ALL, "stribeck")],
)
def test_an_fmu_of_another_law_has_all_of_its_parameters(names: list[str], law: str) -> None:
    """A variable that happens to be called delta makes no Stribeck's law."""
    fmu: Any = Variables(names)
    assert law_of(fmu) == law
    cases = [*load_cases("default"), *load_cases("stribeck-default")]
    assert [case.law for case in fitting(fmu, cases)] == [law]


def test_cases_of_another_law_alone_are_refused() -> None:
    """The message names the law of the FMU and that of the cases, and what to do."""
    fmu: Any = Variables([])
    with pytest.raises(FmuError, match=r"its friction law is coulomb.*stickslip build --law strib"):
        fitting(fmu, load_cases("stribeck-default"))
