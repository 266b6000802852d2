"""The numbers of a feed axis: table, guideway, drive, and what is asked of it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final, NamedTuple

from stickslip_ref import Parameters, Shape


@dataclass(eq=False, repr=False)
class AxisError(ValueError):
    """An axis file cannot be used.

    The message is one line: file, line, key, value and reason, range, remedy.
    """

    reason: str
    """What is wrong."""
    key: str = ""
    """Name in the file, such as ``axis.mass``; empty where no key is meant."""
    value: str = ""
    """What stands there, as it is written; empty where nothing does."""
    within: str = ""
    """What is allowed there, in words."""
    remedy: str = ""
    """What to do."""
    name: str = ""
    """The file."""
    line: int = 0
    """Number of the line, from 1; 0 where the file cannot be read at all."""

    def __str__(self) -> str:
        line = f"line {self.line}" if self.line else ""
        subject = " = ".join(filter(None, (self.key, self.value)))
        what = f"{subject} {self.reason}".lstrip()
        first = ": ".join(filter(None, (self.name, line, what)))
        expected = f"expected {self.within}" if self.within else ""
        return "; ".join(filter(None, (first, expected, self.remedy)))


STANDARD_GRAVITY: Final = 9.81
"""Gravity where an axis file names none [m/s2]."""


@dataclass(frozen=True)
class Filter:
    """A filter of the motor's force, sampled: y = b0 u + b1 u' + b2 u'' - a1 y' - a2 y''.

    At rest it passes the force as it is.
    """

    kind: str
    """A "low pass" or a "notch"."""
    frequency: float
    """Corner or notch frequency [Hz]."""
    damping: float = math.inf
    """Damping ratio of the poles [-]; infinite for a low pass of first order."""
    depth: float = 0.0
    """What a notch leaves of its frequency [-]; 0 of a low pass."""

    def coefficients(self, T_s: float) -> tuple[float, float, float, float, float]:
        """Return b0, b1, b2, a1, a2 at a sample time [s].

        By the bilinear transform, with the frequency kept: s = q (z - 1)/(z + 1), where
        q = w/tan(w T_s/2).
        """
        w = 2.0 * math.pi * self.frequency
        q = w / math.tan(0.5 * w * T_s)
        if math.isinf(self.damping):
            # w/(s + w)
            scale = q + w
            return w / scale, w / scale, 0.0, (w - q) / scale, 0.0
        # (s^2 + 2 depth damping w s + w^2)/(s^2 + 2 damping w s + w^2); above, a low pass has w^2.
        scale = q * q + 2.0 * self.damping * w * q + w * w
        a1, a2 = 2.0 * (w * w - q * q) / scale, (q * q - 2.0 * self.damping * w * q + w * w) / scale
        s2 = 0.0 if self.kind == "low pass" else q * q
        s1, b1 = 2.0 * self.depth * self.damping * w * q, 2.0 * (w * w - s2) / scale
        return (s2 + s1 + w * w) / scale, b1, (s2 - s1 + w * w) / scale, a1, a2


@dataclass(frozen=True, kw_only=True)
class Friction:
    """The friction of the guideway."""

    mu_s: float
    """Static coefficient [-]; where forces were given, these over the normal force."""
    mu_k: float
    """Kinetic coefficient [-], as mu_s."""
    law: str = "coulomb"
    """Name of a built-in friction law, "coulomb" or "stribeck"."""
    own: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    """The other parameters of the law by name, SI."""
    in_newtons: bool = False
    """Whether it was stated as forces, which do not change with the mass."""
    presliding: float = 0.0
    """Way over which friction turns over at a reversal [m]; 0: as usual for the kind of way."""
    capped: bool = False
    """Whether the kinetic coefficient came above the static one, and was taken as that."""

    @property
    def is_curve(self) -> bool:
        """Whether it is a measured curve."""
        return self.own.get("shape") == Shape.CURVE

    @property
    def tau_s(self) -> float:
        """Time constant with which static friction grows at rest [s]; 0: it is there at once."""
        return self.own.get("tau_s", 0.0) if self.law == "coulomb" else 0.0

    @property
    def B(self) -> float:  # noqa: N802 - the symbol of rate and state
        """Growth of the static coefficient with the logarithm of the time at rest [-]."""
        return self.own.get("B", 0.0) if self.law == "coulomb" else 0.0

    @property
    def constant(self) -> bool:
        """Whether the coefficients are constant: Coulomb's law without growth in the stick."""
        return self.law == "coulomb" and not self.own


@dataclass(frozen=True, kw_only=True)
class Drive:
    """A servo drive; SI, forces and positions at the slide."""

    inertia: float
    """Inertia of motor, coupling and screw, seen at the slide [kg]: J (2 pi/pitch)^2."""
    K_v: float
    """Position gain [1/s]."""
    bandwidth: float
    """Bandwidth of the velocity loop [rad/s]: its gain over the inertia."""
    T_n: float
    """Integral time of the velocity controller [s]; 0: no integral."""
    T_s: float
    """Sample time of the controller [s]."""
    d: float = 0.0
    """Viscous friction of motor and nut [N.s/m]."""
    dry: float = 0.0
    """Dry friction of motor and nut [N]."""
    lag: float = 0.0
    """Time constant of the current loop [s]; 0: none."""
    dead_time: float = 0.0
    """Time from a sample to its force [s]."""
    filters: tuple[Filter, ...] = ()
    """Filters of the motor's force, in their order."""
    on_table: bool = True
    """Whether the position is measured on the table, by a scale; else on the motor."""
    velocity_feedforward: float = 1.0
    """Part of the commanded speed that is added to the velocity command [-]."""
    friction_feedforward: float = 0.0
    """Force that is added in the commanded direction [N]."""
    dead_band: float = 0.0
    """Position error that is taken as none [m]."""
    F_max: float = math.inf
    """Limit of the motor's force [N]."""
    resolution_motor: float = 0.0
    """Count of the encoder [m]; 0: exact."""
    resolution_table: float = 0.0
    """Count of the scale [m]; 0: exact."""
    pitch: float = 0.01
    """Way of the slide per turn of the motor [m]."""
    kind: str = "screw"
    """What is between motor and table: "screw", "belt" or "rotary"."""
    rated_torque: float | None = None
    """Torque to which the drive refers its percent [N.m]; None: not stated."""
    torque_constant: float | None = None
    """Torque of the motor per current [N.m/A]; None: not stated."""

    @property
    def K_p(self) -> float:  # noqa: N802 - the symbol of control engineers
        """Gain of the velocity controller [N.s/m]."""
        return self.inertia * self.bandwidth


@dataclass(frozen=True, kw_only=True)
class Demand:
    """What is asked of an axis."""

    feeds: tuple[float, ...] = ()
    """Feeds at which it is judged [m/s], the slowest first."""
    acceleration: float | None = None
    """With which a feed is reached [m/s2]; None: not stated."""
    largest_jump: float | None = None
    """The largest jump that is allowed [m]; None: not stated."""
    largest_error: float | None = None
    """The largest error at rest that is allowed [m]; None: not stated."""


class Assumed(NamedTuple):
    """What an axis file does not state, and what was taken in its place."""

    key: str
    """Name in the axis file, such as "drive.sample_time"."""
    value: str
    """What was taken, as an engineer writes it."""
    reason: str
    """Why."""


@dataclass(frozen=True, kw_only=True)
class Axis:
    """A feed axis; SI. Of a rotary table rad stands for m, N m for N and kg m2 for kg."""

    name: str
    """How it is called."""
    m: float
    """Table and workpiece [kg]."""
    k: float
    """Stiffness between drive and table [N/m]; of two positions of a screw the softer."""
    friction: Friction
    """Its friction."""
    c: float = 0.0
    """Viscous friction of the guideway [N.s/m]."""
    g: float = STANDARD_GRAVITY
    """Gravity that presses the table on its way [m/s2]."""
    load: float = 0.0
    """Force that presses beside the weight [N]."""
    along: float = 0.0
    """Constant force along the way [N]."""
    drive: Drive | None = None
    """Its drive; None: rigid."""
    demand: Demand = field(default_factory=Demand)
    """What is asked of it."""
    stiffest: float | None = None
    """Stiffness at the stiffest position [N/m]."""
    spread: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    """The ± of a number, by its name in the axis file such as "axis.mass", in the SI unit of what
    is stated there. `AxisFile.changed` takes these names.
    """
    assumed: tuple[Assumed, ...] = ()
    """What the axis file does not state."""
    limits: Mapping[str, tuple[float, float]] = field(default_factory=lambda: MappingProxyType({}))
    """Lowest and highest value of what may be changed, by its name in `Axis` or `Drive`, SI."""
    without: tuple[str, ...] = ()
    """Measures that cannot be taken, by name."""

    @property
    def kind(self) -> str:
        """What is between motor and table: "rigid", or as of `Drive`."""
        return self.drive.kind if self.drive else "rigid"

    @property
    def turns(self) -> bool:
        """Whether it is a rotary table."""
        return self.kind == "rotary"

    @property
    def normal_force(self) -> float:
        """Force that presses the table on its way [N].

        Of a rotary table times the radius of its friction [N.m]; 1 N m where torques were stated.
        """
        return self.m * self.g + self.load

    @property
    def F_s(self) -> float:  # noqa: N802 - as in the block
        """Break-away force [N]."""
        return self.friction.mu_s * self.normal_force

    @property
    def F_k(self) -> float:  # noqa: N802 - as F_s
        """Kinetic friction without its viscous part [N]."""
        return self.friction.mu_k * self.normal_force

    def beyond_limits(self) -> Iterator[tuple[str, float]]:
        """Yield what is beyond its limits by more than rounding; NaN for what it does not have."""
        for name, (low, high) in self.limits.items():
            now = getattr(self if name in ("m", "k") else self.drive, name, math.nan)
            if not low * (1.0 - 1e-9) <= now <= high * (1.0 + 1e-9):
                yield name, now

    def block(self, feed: float) -> Parameters:
        """Return the table on a rigid drive at a feed [m/s], for closed forms and the FMU."""
        return Parameters(
            m=self.m, g=self.g, k=self.k, c=self.c, mu_s=self.friction.mu_s,
            mu_k=self.friction.mu_k, v=feed, load=self.load, F_ext=self.along,
        )  # fmt: skip
