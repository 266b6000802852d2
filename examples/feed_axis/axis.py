"""The numbers of the axis, in one place: the table on its slideway and the drive that moves it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from .servo_drive import filters
from .servo_drive.motion import inertia_at_slide, objection

_ABOVE_ZERO: Final = ("m", "g", "k", "J", "pitch", "T_s", "F_max", "acceleration")
_NOT_NEGATIVE: Final = ("c", "mu_s", "mu_k", "d", "K_v", "omega_v", "T_n", "dead_band", "distance",
                        "resolution_motor", "resolution_table", "velocity_feedforward",
                        "friction_feedforward", "lag", "dead_time", "low_pass",
                        "low_pass_damping", "notch", "notch_damping", "notch_depth",
                        "dry")  # fmt: skip


_OMEGA_V: Final = 300.0


def critically_damped(omega_v: float) -> float:
    """Return the integral time [s] that critically damps a velocity loop of omega_v [rad/s].

    That of the drive alone; the spring to a table that sticks makes it swing. Its poles are the
    roots of s^2 + omega_v s + omega_v / T_n, a double one at T_n = 4 / omega_v.
    """
    return 4.0 / omega_v


@dataclass(frozen=True)
class Axis:
    """A slideway axis with a ball screw; SI, drive quantities seen at the slide.

    The numbers are illustrative, of a middle-sized machine: table and workpiece of 500 kg, a
    locked-motor frequency of 45 Hz, a screw of 10 mm pitch.

    Parameters
    ----------
    m : float
        Table and workpiece [kg].
    g : float
        Gravity [m/s2].
    k : float
        Stiffness of screw, nut, bearings and coupling, seen at the slide [N/m].
    c : float
        Viscous part of the slideway's friction [N.s/m].
    mu_s, mu_k : float
        Static and kinetic friction coefficient of the slideway [-].
    J : float
        Inertia of motor, coupling and screw [kg.m2]: a screw of 40 mm and 1.2 m has 2.4e-3.
    pitch : float
        Way of the slide per turn [m].
    d : float
        Viscous friction of the drive [N.s/m].
    T_s : float
        Sample time of the controller [s]; how long it may be depends on k, d and m_d
        (`servo_drive.motion.objection`).
    K_v : float
        Position gain [1/s]. 25 1/s is 1.5 m/min per mm of following error; with the scale a
        third of 72 1/s, from where on the table that slides is unstable
        (`stickslip_design.loop.stability.gain_limits`).
    omega_v : float
        Bandwidth of the velocity loop [rad/s]: K_p = m_d omega_v. With the scale the damping of
        the table that slides is greatest at 250 to 300 1/s; above 716 1/s it is unstable.
    T_n : float
        Integral time of the velocity controller [s], that of `critically_damped`. 0: no
        integral.
    on_table : bool
        Position is measured on the table, by a linear scale; else on the motor.
    dead_band : float
        Position error that is taken as none [m].
    velocity_feedforward : float
        Part of the commanded speed that is added to the velocity command [-].
    friction_feedforward : float
        Force that is added in the commanded direction [N].
    F_max : float
        Limit of the motor force [N]; 12 kN at 10 mm pitch are 19 N m.
    resolution_motor, resolution_table : float
        Counts of motor encoder and scale [m]; 0: exact.
    lag : float
        Time constant of the current loop [s]; 0: none.
    dead_time : float
        Time from a sample to when its force command acts [s].
    low_pass : float
        Low pass of the force command [Hz]; 0: none.
    low_pass_damping : float
        Its damping ratio [-]; 0: of first order.
    notch : float
        Notch of the force command [Hz]; 0: none.
    notch_damping, notch_depth : float
        Damping ratio of its poles, and what it leaves at its frequency [-].
    dry : float
        Dry friction of motor and nut [N].
    feed, acceleration, distance : float
        Set point: speed [m/s], acceleration [m/s2], length of the move [m]; 0 goes on for ever.
    follow : bool
        Whether the drive follows the spring within its step; False is for comparison.

    Raises
    ------
    ValueError
        If a value is out of range; the message names it and the range.
    """

    m: float = 500.0
    g: float = 9.81
    k: float = 4e7
    c: float = 4000.0
    mu_s: float = 0.20
    mu_k: float = 0.15
    J: float = 6e-3
    pitch: float = 0.01
    d: float = 1000.0
    T_s: float = 250e-6
    K_v: float = 25.0
    omega_v: float = _OMEGA_V
    T_n: float = critically_damped(_OMEGA_V)
    on_table: bool = True
    dead_band: float = 0.0
    velocity_feedforward: float = 1.0
    friction_feedforward: float = 0.0
    F_max: float = 12e3
    resolution_motor: float = 1e-8
    resolution_table: float = 1e-7
    lag: float = 0.0
    dead_time: float = 0.0
    low_pass: float = 0.0
    low_pass_damping: float = 0.0
    notch: float = 0.0
    notch_damping: float = 0.0
    notch_depth: float = 0.0
    dry: float = 0.0
    feed: float = 5e-4
    acceleration: float = 0.1
    distance: float = 0.0
    follow: bool = True

    def __post_init__(self) -> None:
        for name in _ABOVE_ZERO + _NOT_NEGATIVE:
            value, above = getattr(self, name), name in _ABOVE_ZERO
            if not (value > 0.0 if above else value >= 0.0) or math.isinf(value):
                least = "above" if above else "at least"
                raise ValueError(f"{name} = {value!r} is out of range: finite and {least} 0")
        if self.mu_k > self.mu_s:
            raise ValueError(f"mu_k = {self.mu_k!r} is out of range: at most mu_s = {self.mu_s!r}")
        if self.notch_depth > 1.0:
            raise ValueError(f"notch_depth = {self.notch_depth!r} is out of range: at most 1")
        refused = objection(self.m_d, self.d, self._followed, self.T_s) or filters.objection(
            self.T_s, self.dead_time, self.low_pass, self.notch, self.notch_damping
        )
        if refused is not None:
            raise ValueError(refused)

    @property
    def m_d(self) -> float:
        """Inertia of the drive, seen at the slide [kg]: J (2 pi / pitch)^2."""
        return inertia_at_slide(self.J, self.pitch)

    @property
    def K_p(self) -> float:  # noqa: N802 - the symbol of control engineers
        """Gain of the velocity controller [N.s/m]: m_d omega_v."""
        return self.m_d * self.omega_v

    @property
    def F_s(self) -> float:  # noqa: N802 - as in the block
        """Break-away force [N]."""
        return self.mu_s * self.m * self.g

    @property
    def F_k(self) -> float:  # noqa: N802 - as F_s
        """Kinetic friction [N], without its viscous part."""
        return self.mu_k * self.m * self.g

    def of_table(self) -> dict[str, float]:
        """Return the start values of StickSlip.fmu; the drive starts at rest, so v is 0."""
        values = {name: float(getattr(self, name)) for name in ("m", "g", "k", "c", "mu_s", "mu_k")}
        return {**values, "v": 0.0}

    def of_drive(self) -> dict[str, float]:
        """Return the start values of ServoDrive.fmu."""
        same = (
            "J pitch d T_s K_v K_p T_n dead_band velocity_feedforward friction_feedforward F_max "
            "resolution_motor resolution_table feed acceleration distance lag dead_time low_pass "
            "low_pass_damping notch notch_damping notch_depth dry"
        )
        values: dict[str, float] = {name: float(getattr(self, name)) for name in same.split()}
        return {**values, "on_table": int(self.on_table), "k": self._followed}

    @property
    def _followed(self) -> float:
        """The stiffness that the drive is told [N/m]."""
        return float(self.k) if self.follow else 0.0
