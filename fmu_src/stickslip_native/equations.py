"""The block as a solver of the simulator's integrates it: core/continuous.h, in its order."""

from fmi.description import Equations
from fmi.table import Quantity, Unit
from stickslip_fmu.interface import QUANTITIES

_POWER = Quantity("Power", "Real", "Power", "W", 1.0)
_SIGN = Quantity("Sign", "Real")
_FORCES = ("x_dot", "z", "load", "F_ext")

EQUATIONS = Equations(
    states={
        "x": "x_dot",
        "x_dot": "x_ddot",
        "z": "z_dot",
        "W_pull": "P_pull",
        "Q_friction": "P_friction",
    },
    indicators=("to_event_1", "to_event_2"),
    local={
        "x_ddot": (QUANTITIES["Acceleration"], "Acceleration of the mass"),
        "z_dot": (QUANTITIES["Velocity"], "Velocity at which the spring grows"),
        "P_pull": (_POWER, "Power of the pulling end"),
        "P_friction": (_POWER, "Power of friction and damping"),
        "to_event_1": (_SIGN, "Above 0 up to an event: force to break-away forward, or velocity"),
        "to_event_2": (_SIGN, "Above 0 up to an event: the same backward, or acceleration"),
    },
    units={"W": Unit({"kg": 1, "m": 2, "s": -3})},
    depends={
        "x": ("x",),
        "x_dot": ("x_dot",),
        "x_pull": ("x", "z"),
        "z": ("z",),
        "F": ("z",),
        "F_friction": _FORCES,
        "F_s": ("load",),
        "W_pull": ("W_pull",),
        "Q_friction": ("Q_friction",),
        "x_ddot": _FORCES,
        "z_dot": ("x_dot", "v"),
        "P_pull": ("z", "v"),
        "P_friction": ("x_dot", "load"),
        "to_event_1": (*_FORCES, "v"),
        "to_event_2": _FORCES,
    },
)
