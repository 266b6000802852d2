"""LuGre friction as the FMU shows it: docs/theory.md (34). Its motion is in C alone."""

from fmi.table import ABOVE_ZERO, Quantity

from ...interface import FIRST_OWN, Own, calculated, parameter
from ..coulomb.law import COULOMB
from ..native_only import NativeOnly, v_stick

_EXPONENT = Quantity("Exponent", "Real", "", "1", 1.0)
_BRISTLE = Quantity("Deflection", "Real", "Length", "m", 1e-6)
_STEADY = Quantity("BristleStiffness", "Real", "TranslationalSpringConstant", "N/m", 1e5)
_SLOW = Quantity("SlowVelocity", "Real", "Velocity", "m/s", 1e-3, "mm/s")
_FALLS = "Speed at which sigma_1 has fallen to 1/e, sigma_1 exp(-(x_dot/v_d)^2); 0 for constant"
_SHARED = tuple(row for row in COULOMB.interface.rows if row.name in ("mu_s", "mu_k", "mu_k_used"))
_ROWS = (
    parameter(FIRST_OWN, "sigma_0", _STEADY, "fixed", 1e5, "Stiffness of the bristles", ABOVE_ZERO),
    parameter(FIRST_OWN + 1, "sigma_1", "Damping", "fixed", 300.0, "Damping of the bristles", 0.0),
    parameter(
        FIRST_OWN + 2, "v_s", _SLOW, "fixed", 1e-3, "Speed of the fall of friction", ABOVE_ZERO
    ),
    parameter(FIRST_OWN + 3, "delta", _EXPONENT, "fixed", 2.0, "Exponent of the fall", 1.0),
    parameter(FIRST_OWN + 4, "v_d", _SLOW, "fixed", 0.0, _FALLS, 0.0),
    parameter(FIRST_OWN + 5, "zeta_start", _BRISTLE, "fixed", 0.0, "Initial deflection"),
    v_stick(FIRST_OWN + 6),
    calculated(
        FIRST_OWN + 7, "zeta", _BRISTLE, "Deflection of the bristles", ("zeta_start",)
    )._replace(in_proportion=True),
    calculated(
        FIRST_OWN + 8,
        "E_bristles",
        "Energy",
        "Energy in the bristles",
        ("sigma_0", "zeta_start"),
        minimum=0.0,
    ),
)

LUGRE = NativeOnly(
    Own(
        model="StickSlipLuGre",
        description=(
            "A mass pulled through a spring over LuGre friction: bristles that bend before they "
            "slide. c is its viscous part sigma_2. A slip is a fall of the spring, between a "
            "maximum and a minimum. Results do not depend on the communication step."
        ),
        rows=(*_SHARED, *_ROWS),
        at_rest=("mu_s",),
        in_slip=("mu_k", *(row.name for row in _ROWS[:7])),
    )
)
