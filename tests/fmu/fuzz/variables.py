"""The variables of each FMU, and the values of them that a master may set."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from fmukit.model import Spec
from stickslip_fmu.laws.named import friction_law
from stickslip_fmu.spec import spec_of

_SMALLEST = 2.2250738585072014e-308
_POINTS = range(2, 13)


@dataclass(frozen=True)
class Variables:
    """The variables of the FMU of a friction law.

    Attributes
    ----------
    spec
        The block under the friction law.
    moderate
        Ranges in which nothing may be refused but a load that lifts the mass, and points that make
        no curve; of Reals.
    whole
        The values that a settable Integer takes.
    at_least
        The smallest value that is taken, where there is one; of Reals.
    fixed
        What must not change after initialization.
    """

    spec: Spec
    moderate: Mapping[str, tuple[float, float]]
    whole: Mapping[str, range]
    at_least: Mapping[str, float]
    fixed: Sequence[str]

    @cached_property
    def names(self) -> list[str]:
        """Every name, by value reference."""
        return [each.name for each in self.spec.table.rows]

    @cached_property
    def references(self) -> dict[str, list[int]]:
        """The value references of each kind."""
        rows = list(enumerate(self.spec.table.rows))
        return {
            kind: [reference for reference, each in rows if each.kind == kind]
            for kind in ("Real", "Integer", "Boolean", "String")
        }

    @cached_property
    def settable(self) -> list[int]:
        """The value references of the Reals that are no outputs."""
        return [reference for reference, name in enumerate(self.names) if name in self.moderate]

    @cached_property
    def running(self) -> list[int]:
        """Those that may be set between two steps."""
        return [
            each.number
            for each in self.spec.table.rows
            if each.name in self.moderate and each.variability != "fixed"
        ]

    @cached_property
    def points(self) -> list[int]:
        """The value references of the points of a curve."""
        return [reference for reference in self.settable if self.names[reference][:2] == "u_"]

    @cached_property
    def settable_whole(self) -> list[int]:
        """The value references of the Integers that are no outputs."""
        return [self.names.index(name) for name in self.whole]


_MODERATE = {
    "m": (0.1, 10.0),
    "g": (1.0, 20.0),
    "k": (10.0, 1e4),
    "c": (0.0, 5.0),
    "mu_s": (0.0, 1.0),
    "mu_k": (0.0, 1.0),
    "x_start": (-1.0, 1.0),
    "x_dot_start": (-1.0, 1.0),
    "z_start": (-0.05, 0.05),
    "v": (-1.0, 1.0),
    "load": (-5.0, 50.0),
    "F_ext": (-20.0, 20.0),
}
_AT_LEAST = {
    **dict.fromkeys(("m", "g", "k"), _SMALLEST),
    **dict.fromkeys(("c", "mu_s", "mu_k"), 0.0),
}
_FIXED = ("m", "g", "x_start", "x_dot_start", "z_start")

VARIABLES = {
    "coulomb": Variables(
        spec_of(friction_law("coulomb").law),
        {
            **_MODERATE,
            "tau_s": (0.0, 2.0),
            "B": (0.0, 0.1),
            "t_0": (1e-3, 10.0),
            "age_start": (0.0, 100.0),
        },
        {},
        {**_AT_LEAST, **dict.fromkeys(("tau_s", "B", "age_start"), 0.0), "t_0": _SMALLEST},
        (*_FIXED, "age_start"),
    ),
    "stribeck": Variables(
        spec_of(friction_law("stribeck").law),
        {
            **_MODERATE,
            "v_s": (1e-3, 1.0),
            "delta": (1.0, 4.0),
            "mu_1": (0.0, 0.4),
            # Speeds that mostly rise, whichever of them are set.
            **{f"u_{i}": (0.1 * i - 0.16, 0.1 * i - 0.04) for i in _POINTS},
            **{f"mu_{i}": (0.0, 1.0) for i in _POINTS},
        },
        {"shape": range(1, 4), "n_points": _POINTS},
        {
            **_AT_LEAST,
            "v_s": _SMALLEST,
            "delta": 1.0,
            "mu_1": 0.0,
            **dict.fromkeys((f"u_{i}" for i in _POINTS), _SMALLEST),
            **dict.fromkeys((f"mu_{i}" for i in _POINTS), 0.0),
        },
        (
            *_FIXED,
            "shape",
            "n_points",
            "mu_1",
            *(f"{name}_{i}" for i in _POINTS for name in ("u", "mu")),
        ),
    ),
}
"""By the name of the friction law."""
