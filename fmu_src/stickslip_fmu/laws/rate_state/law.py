"""Rate-and-state friction as the FMU shows it: docs/theory.md (35). Its motion is in C alone."""

from fmi.table import ABOVE_ZERO, Item, Quantity

from ...interface import FIRST_OWN, Own, calculated, parameter
from ..native_only import NativeOnly, v_stick

_AGE = Quantity("Age", "Real", "Time", "s", 1.0)
_LENGTH = Quantity("SlipDistance", "Real", "Length", "m", 1e-5)
_RATE = Quantity("ReferenceVelocity", "Real", "Velocity", "m/s", 1e-6)
_EFFECT = Quantity("Effect", "Real", "", "1", 0.01)
_EVOLUTION = Quantity(
    "Evolution",
    "Integer",
    items=(
        Item("Aging", 1, "theta_dot = 1 - |x_dot| theta/D_c"),
        Item("Slip", 2, "theta_dot = -(|x_dot| theta/D_c) ln(|x_dot| theta/D_c)"),
    ),
)
_INERTIA = Quantity(
    "Inertia",
    "Integer",
    items=(
        Item("Inertia", 1, "m x_ddot = k z + F_ext - N mu - c x_dot"),
        Item("RadiationDamping", 2, "0 = k z + F_ext - N mu - c x_dot; m weighs alone"),
    ),
)
_MU = "FrictionCoefficient"
_LOAD = "By how much a change of the normal force changes theta (Linker and Dieterich)"
_BALANCE = ("mu_0", "a", "b", "D_c", "V_0", "inertia", "theta_start")
_OF_MU = ("m", "g", "k", "c", *_BALANCE, "x_dot_start", "z_start", "load", "F_ext")
_ROWS = (
    parameter(4, "mu_0", _MU, "fixed", 0.6, "Steady friction coefficient at the speed V_0", 0.0),
    parameter(5, "a", _EFFECT, "fixed", 0.01, "Direct effect of the speed", ABOVE_ZERO),
    parameter(33, "b", _EFFECT, "fixed", 0.015, "Effect of the state", 0.0),
    parameter(FIRST_OWN, "D_c", _LENGTH, "fixed", 1e-5, "Distance of the evolution", ABOVE_ZERO),
    parameter(FIRST_OWN + 1, "V_0", _RATE, "fixed", 1e-6, "Speed of reference", ABOVE_ZERO),
    parameter(FIRST_OWN + 2, "alpha", _MU, "fixed", 0.0, _LOAD, 0.0),
    parameter(FIRST_OWN + 3, "evolution", _EVOLUTION, "fixed", 1, "Law of the evolution", 1, 2),
    parameter(FIRST_OWN + 4, "inertia", _INERTIA, "fixed", 1, "What balances the forces", 1, 2),
    parameter(FIRST_OWN + 5, "theta_start", _AGE, "fixed", 10.0, "Initial state", ABOVE_ZERO),
    v_stick(FIRST_OWN + 6),
    calculated(FIRST_OWN + 7, "theta", _AGE, "State", ("theta_start",), minimum=0.0),
    calculated(FIRST_OWN + 8, "mu", _MU, "Friction coefficient", _OF_MU),
)

RATE_STATE = NativeOnly(
    Own(
        model="StickSlipRateState",
        description=(
            "A mass pulled through a spring over rate-and-state friction, regularised, with "
            "inertia or radiation damping c. A slip is a fall of the spring, between a maximum and "
            "a minimum. Results do not depend on the communication step."
        ),
        rows=_ROWS,
        at_rest=("mu_0",),
        in_slip=_BALANCE[1:],
        break_away="Steady friction mu_0 N at the speed V_0",
    )
)
