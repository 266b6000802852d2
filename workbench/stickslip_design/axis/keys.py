"""The keys of an axis file: names, units, ranges, defaults, examples and meanings, here alone.

The reader, its refusals, the template, the example and the table of the documentation are made
from `SECTIONS` and `KEYS`.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from typing import Any, Final

from stickslip_ref import COULOMB, STRIBECK, OwnParameter

from ..quantity import KINDS, Kind, Units, on_data_sheet
from .model import STANDARD_GRAVITY, AxisError

_OF_DRIVES: Final = (
    Kind("an inertia", "kg.m2", "60 kg cm2"),
    Kind("a torque", "N.m", "19 N m"),
    Kind("a damping at the motor", "N.m.s/rad", "2 mN m s/rad"),
    Kind("a damping at the motor", "N.m.s", "2 mN m s"),
    Kind("a rate", "1/s", "25 1/s"),
    Kind("an angular frequency", "rad/s", "300 rad/s"),
    Kind("a frequency", "Hz", "400 Hz"),
    Kind("counts per turn", "1/turn", "1000000 counts/turn"),
)
UNITS: Final = Units(on_data_sheet, KINDS | {kind.unit: kind for kind in _OF_DRIVES})
"""How quantities are written in an axis file."""

FORCE: Final = ("N", "N.m")
"""Units of a force: at the slide, at the motor."""
DAMPING: Final = ("N.s/m", "N.m.s/rad", "N.m.s")
"""Units of a damping or a gain: at the slide, at the motor."""
NUMBER: Final = ("1",)
"""Units of a plain number."""


@dataclass(frozen=True)
class Range:
    """The range of a number, in the SI unit in which it is stated; infinity and NaN are outside."""

    low: float = -math.inf
    strict: bool = False
    high: float = math.inf

    def __contains__(self, value: float) -> bool:
        low = value > self.low if self.strict else value >= self.low
        return low and value <= self.high and math.isfinite(value)

    def __str__(self) -> str:
        if self.high < math.inf:
            return f"from {self.low:g} to {self.high:g}"
        if self.low == -math.inf:
            return "any finite number"
        return f"{'above' if self.strict else 'at least'} {self.low:g}"


ANY: Final = Range()
ABOVE: Final = Range(0.0, strict=True)
LEAST: Final = Range(0.0)
PART: Final = Range(0.0, high=1.0)


@dataclass(frozen=True)
class Section:
    """A section of an axis file."""

    name: str
    """Its name; behind a point a table of an array, `[[drive.filter]]`."""
    meaning: str
    """What it says, in a line."""
    otherwise: str = ""
    """What is taken without it; empty: a file must have it."""
    reason: str = ""
    """Why that is taken."""

    @property
    def is_array(self) -> bool:
        """Whether there may be several."""
        return "." in self.name

    @property
    def header(self) -> str:
        """Its header in the file."""
        return f"[[{self.name}]]" if self.is_array else f"[{self.name}]"


@dataclass(frozen=True)
class Key:
    """A key of an axis file."""

    symbol: str
    """What it sets in `Axis`, by its own name there, as ``K_v``; empty: that is computed."""
    meaning: str
    """One line."""
    example: str
    """A value as it stands in a file."""
    units: tuple[str, ...] = ()
    """SI units of what may be stated, the first that of the symbol; empty: it is a text."""
    within: Range = ANY
    """Range of its number."""
    spread: bool = False
    """Whether it may have a ±."""
    most: int = 1
    """How many values it may have; above 1 they are a list, or one value."""
    choices: tuple[str, ...] = ()
    """The texts that it may be; empty: any."""
    default: str = ""
    """What it is where it is not stated, as it would stand in a file; empty: see `otherwise`."""
    otherwise: str = ""
    """What is taken where it is not stated, in words."""
    reason: str = ""
    """Why that is taken; empty: nothing is assumed."""
    optional: bool = False
    """Whether it may be left out though nothing is taken in its place."""
    unless: tuple[str, ...] = ()
    """Keys of its section that may stand in its place."""
    excludes: tuple[str, ...] = ()
    """Keys of its section that must not stand beside it."""
    goes_with: tuple[str, ...] = ()
    """A key of its section and the texts of it, one of which it needs; no text: any value."""
    in_example: bool = False
    """Whether the axis of docs/feed-axis.md states it."""
    section: str = ""
    name: str = ""
    """Where it stands: `KEYS` states it."""

    @property
    def path(self) -> str:
        """Its name with that of its section: ``axis.mass``."""
        return f"{self.section}.{self.name}"

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """The kinds of quantities that it may be."""
        return tuple(UNITS.kinds[unit] for unit in self.units)

    @property
    def bare(self) -> Kind | None:
        """What a number without a unit is."""
        return self.kinds[0] if self.units == NUMBER else None

    @property
    def required(self) -> bool:
        """Whether it must be stated, where its section and `goes_with` are."""
        return not (self.taken or self.optional)

    @property
    def expected(self) -> str:
        """What is expected, in words."""
        if self.choices:
            return f"one of {', '.join(self.marks())}"
        if not self.units:
            return "a text"
        many = {1: "", 2: "one or two values, each "}.get(self.most, "a list, each ")
        names = [kind.in_words for kind in self.kinds if kind.unit != "N.m.s"]
        if len(names) > 1 and self.units[-1] == "1":
            names[-1] = "percent of drive.rated_torque"
        within = "" if self.within == ANY else f", {self.within}"
        return f"{many}{' or '.join(names)}{within}"

    def marks(self, quote: str = "") -> list[str]:
        """Return its choices, each in quotes, or its range and ±."""
        marks = [f'{quote}"{choice}"{quote}' for choice in self.choices]
        return marks + [str(self.within)] * (self.within != ANY) + ["±"] * self.spread

    def refusal(self, path: str, reason: str, value: str = "", remedy: str = "") -> AxisError:
        """Return the refusal of what stands at a path, or of what is missing there."""
        remedy = remedy or f"write such as {self.name} = {self.example}"
        return AxisError(reason, key=path, value=value, within=self.expected, remedy=remedy)

    @property
    def needs(self) -> str:
        """What it goes with, as it stands in a file."""
        name, *texts = self.goes_with
        return " = ".join((name, *(f'"{text}"' for text in texts)))

    @property
    def taken(self) -> str:
        """What is taken where it is not stated, in words."""
        return self.default.strip('"') or self.otherwise


_ALL: Final = (
    Section("axis", "The table on its guideway, and the screw that moves it."),
    Section("friction", "The friction of the guideway: one of the ways to say it."),
    Section(
        "drive",
        "Motor and controller. Forces, dampings and the inertia are stated at the slide (N, "
        "N s/m, kg) or at the motor (N m, N m s/rad, kg cm2).",
        "a rigid drive", "the nut is taken to move at the feed, whatever the force",
    ),
    Section(
        "drive.filter", "A filter of the motor's force or current; one such section for each.",
        "no filter", "none is stated",
    ),
    Section(
        "demand", "What is asked of the axis.", "nothing is asked",
        "the critical feed is told, without a verdict on a feed",
    ),
)  # fmt: skip
SECTIONS: Final = {section.name: section for section in _ALL}
"""The sections by name, in the order of the template."""

_COULOMB: Final = ("law", "coulomb")
_STRIBECK: Final = ("law", "stribeck")


def _of_law(own: OwnParameter, meaning: str, example: str, **more: Any) -> Key:
    """Return the key of a parameter of a friction law, with the law's unit, default and range."""
    unit = own.bound.unit or "1"
    if "reason" in more:
        more["default"] = f"{own.start:g}" if unit == "1" else f'"{own.start:g} {unit}"'
    within = Range(own.bound.low, own.bound.strict)
    return Key("", meaning, example, (unit,), within, spread=True, **more)


_KEYS: Final = {
    "axis.name": Key(
        "name", "What the axis is called in the report.", '"X axis"',
        otherwise="the name of the file", in_example=True,
    ),
    "axis.mass": Key(
        "m", "Table and workpiece.", '"500 kg"', ("kg",), ABOVE, spread=True, in_example=True,
    ),
    "axis.stiffness": Key(
        "k",
        "Screw, nut, bearings and coupling in series, seen at the slide; a list of two is the near "
        "and the far end of the screw, of which the softer is judged.", '"40 N/um"', ("N/m",),
        ABOVE, spread=True, most=2, in_example=True,
    ),
    "axis.c": Key(
        "c", "Viscous friction of the guideway.", '"4 kN s/m"', ("N.s/m",), LEAST, spread=True,
        default='"0 N s/m"', reason="the least favourable, as the drive alone takes energy out",
        excludes=("zeta",), in_example=True,
    ),
    "axis.zeta": Key(
        "", "Damping ratio of the table on the screw, in place of c.", '"1.4 %"', NUMBER, LEAST,
        spread=True, optional=True, excludes=("c",),
    ),
    "axis.load": Key(
        "load", "Force that presses on the guideway beside the weight; negative where it lifts.",
        '"2 kN"', ("N",), spread=True, default='"0 N"', reason="the weight alone",
    ),
    "axis.force_along": Key(
        "along",
        "Constant force on the table along the way: weight of a vertical axis less its "
        "counterweight, a seal's pull; positive in the direction of the feed.", '"-300 N"', ("N",),
        spread=True, default='"0 N"', reason="a horizontal axis without counterweight",
    ),
    "axis.gravity": Key(
        "g", "Gravity across the guideway; on an inclined one the part that presses.",
        '"9.81 m/s2"', ("m/s2",), ABOVE, default=f'"{STANDARD_GRAVITY} m/s2"',
        reason="a horizontal guideway",
    ),
    "friction.mu_s": Key(
        "mu_s", "Static friction coefficient: break-away force over normal force.", "0.20", NUMBER,
        LEAST, spread=True, unless=("F_s", "curve"), excludes=("F_s", "F_k"), in_example=True,
    ),
    "friction.mu_k": Key(
        "mu_k", "Kinetic friction coefficient, without the viscous part.", "0.15", NUMBER, LEAST,
        spread=True, unless=("F_k", "curve"), excludes=("F_s", "F_k", "curve"), in_example=True,
    ),
    "friction.F_s": Key(
        "",
        "Break-away force, in place of mu_s (rollers, seals): at the slide, as torque at the "
        "motor, or in percent of drive.rated_torque.", '"981 N"', (*FORCE, "1"), LEAST, spread=True,
        unless=("mu_s", "curve"), excludes=("mu_s", "mu_k"),
    ),
    "friction.F_k": Key(
        "", "Kinetic friction, in place of mu_k; as F_s.", '"736 N"', (*FORCE, "1"), LEAST,
        spread=True, unless=("mu_k", "curve"), excludes=("mu_s", "mu_k", "curve"),
    ),
    "friction.curve": Key(
        "",
        "CSV file of measured friction over speed, in place of mu_k or F_k; a path from the folder "
        "of this file.", '"guideway.csv"', optional=True, goes_with=_STRIBECK,
        excludes=("mu_k", "F_k", "shape", "v_s", "delta"),
    ),
    "friction.law": Key(
        "law", "Friction law: constant in slip, or falling with the speed, as with a curve.",
        '"coulomb"', choices=("coulomb", "stribeck"), unless=("curve",), default='"coulomb"',
        reason="two coefficients are the whole friction",
    ),
    "friction.tau_s": _of_law(
        COULOMB.parameters["tau_s"], "Time at rest over which static friction grows to mu_s.",
        '"100 ms"', goes_with=_COULOMB, reason="static friction is there at once",
    ),
    "friction.B": _of_law(
        COULOMB.parameters["B"],
        "Growth of the static coefficient with the logarithm of the time at rest.", "0.01",
        goes_with=_COULOMB, reason="static friction does not grow without end",
    ),
    "friction.t_0": _of_law(
        COULOMB.parameters["t_0"], "Time at rest from which on that growth is logarithmic.",
        '"1 ms"', goes_with=("B",), reason="the default of the friction law",
    ),
    "friction.shape": Key(
        "", "How friction falls from mu_s to mu_k: exp(-(u/v_s)^delta), or 1/(1 + u/v_s).",
        '"stribeck"', choices=("stribeck", "hyperbolic"), goes_with=_STRIBECK, default='"stribeck"',
        reason="the default of the friction law", excludes=("curve",),
    ),
    "friction.v_s": _of_law(
        STRIBECK.parameters["v_s"], "Speed over which friction falls.", '"10 mm/s"',
        goes_with=_STRIBECK, unless=("curve",), excludes=("curve",),
    ),
    "friction.delta": _of_law(
        STRIBECK.parameters["delta"], "Exponent of the fall.", "1", goes_with=_STRIBECK,
        reason="the default of the friction law", unless=("curve",), excludes=("curve",),
    ),
    "drive.kind": Key(
        "", "A screw behind a servo motor; rigid: pitch and rated torque alone are read.",
        '"screw"', choices=("screw", "rigid"), default='"screw"',
    ),
    "drive.pitch": Key(
        "pitch", "Way of the slide in a turn of the motor, a gear included.", '"10 mm"', ("m",),
        ABOVE, in_example=True,
    ),
    "drive.inertia": Key(
        "inertia", "Motor, brake, coupling and screw.", '"60 kg cm2"', ("kg", "kg.m2"), ABOVE,
        spread=True, in_example=True,
    ),
    "drive.viscous_friction": Key(
        "d", "Viscous friction of motor, bearings and nut.", '"1 kN s/m"', DAMPING, LEAST,
        spread=True, default='"0 N s/m"', reason="the least favourable", in_example=True,
    ),
    "drive.dry_friction": Key(
        "dry", "Dry friction of motor, bearings and nut: their idling torque.", '"1 N m"', FORCE,
        LEAST, spread=True, default='"0 N"', reason="all dry friction is that of the guideway",
    ),
    "drive.K_v": Key(
        "K_v", "Position gain: speed over following error.", '"25 1/s"', ("1/s",), ABOVE,
        spread=True, in_example=True,
    ),
    "drive.bandwidth": Key(
        "bandwidth", "Bandwidth of the velocity loop: its gain over the inertia.", '"300 1/s"',
        ("rad/s", "1/s"), ABOVE, spread=True, unless=("velocity_gain",),
        excludes=("velocity_gain",), in_example=True,
    ),
    "drive.velocity_gain": Key(
        "", "Gain of the velocity controller, in place of its bandwidth.", '"1.8 N m s/rad"',
        DAMPING, ABOVE, spread=True, optional=True, excludes=("bandwidth",),
    ),
    "drive.integral_time": Key(
        "T_n", "Integral time T_n of the velocity controller; 0 s: no integral.", '"13 ms"', ("s",),
        LEAST, spread=True, otherwise="4 / bandwidth",
        reason="critically damps the velocity loop of the drive alone",
    ),
    "drive.sample_time": Key(
        "T_s", "Sample time of position and velocity controller.", '"0.25 ms"', ("s",), ABOVE,
        default='"0.25 ms"', reason="usual for servo drives", in_example=True,
    ),
    "drive.current_lag": Key(
        "lag", "Time constant of the current loop.", '"0.3 ms"', ("s",), LEAST, spread=True,
        default='"0 s"', reason="the current loop is taken to be fast",
    ),
    "drive.dead_time": Key(
        "dead_time", "Time from a sample to its force: computing and bus.", '"0.25 ms"', ("s",),
        LEAST, spread=True, default='"0 s"', reason="the force is taken to follow at the sample",
    ),
    "drive.position": Key(
        "on_table", "Where the position is measured: a scale on the table, or the motor's encoder.",
        '"table"', choices=("table", "motor"), default='"table"', reason="a linear scale",
        in_example=True,
    ),
    "drive.encoder": Key(
        "resolution_motor",
        "Resolution of the motor's encoder after interpolation: at the slide, or in counts/turn or "
        "lines/turn (a line is four counts).", '"10 nm"', ("m", "1/turn"), ABOVE, otherwise="exact",
        reason="counts are left out", in_example=True,
    ),
    "drive.scale": Key(
        "resolution_table", "Resolution of the scale on the table.", '"0.1 um"', ("m",), ABOVE,
        otherwise="exact", reason="counts are left out", in_example=True,
    ),
    "drive.velocity_feedforward": Key(
        "velocity_feedforward", "Part of the commanded speed that is fed forward.", "1.0", NUMBER,
        LEAST, default="1.0", reason="usual; it moves the following error, not the jumps",
    ),
    "drive.friction_feedforward": Key(
        "friction_feedforward", "Force that is fed forward in the commanded direction.", '"736 N"',
        FORCE, LEAST, default='"0 N"', reason="none is stated",
    ),
    "drive.dead_band": Key(
        "dead_band", "Position error that the controller takes as none.", '"7 um"', ("m",), LEAST,
        default='"0 um"', reason="none is stated",
    ),
    "drive.limit": Key(
        "F_max", "The most that the motor gives: force at the slide, or torque.", '"12 kN"', FORCE,
        ABOVE, otherwise="no limit",
        reason="creeping and hunting stay far below the limit of a motor", in_example=True,
    ),
    "drive.rated_torque": Key(
        "",
        "Rated torque of the motor, to which a drive refers its percent. What it shows at a steady "
        "feed is the friction of slide, nut and motor together.", '"11 N m"', ("N.m",), ABOVE,
        optional=True,
    ),
    "drive.filter.kind": Key(
        "", "A low pass, or a notch.", '"notch"', choices=("low pass", "notch"),
    ),
    "drive.filter.frequency": Key(
        "", "Corner or notch frequency, below half the sampling frequency.", '"400 Hz"', ("Hz",),
        ABOVE,
    ),
    "drive.filter.damping": Key(
        "", "Damping ratio of the poles; of a low pass that has none: first order.", "0.7", NUMBER,
        ABOVE, optional=True, excludes=("width",),
    ),
    "drive.filter.width": Key(
        "", "Width of a notch between its -3 dB points, in place of its damping.", '"200 Hz"',
        ("Hz",), ABOVE, optional=True, excludes=("damping",), goes_with=("kind", "notch"),
    ),
    "drive.filter.leaves": Key(
        "", "What a notch leaves of its frequency; 0: nothing.", '"10 %"', NUMBER, PART,
        default="0", reason="a full notch", goes_with=("kind", "notch"),
    ),
    "demand.feeds": Key(
        "feeds", "Feeds at which the axis is judged.", '["0.5 mm/s", "2 mm/s", "5 mm/s"]', ("m/s",),
        ABOVE, most=100, otherwise="none",
        reason="the critical feed is told, without a verdict on a feed", in_example=True,
    ),
    "demand.acceleration": Key(
        "acceleration",
        "Acceleration with which a feed is reached from rest; on a rigid drive the feed acts at "
        "once.", '"0.1 m/s2"', ("m/s2",), ABOVE, otherwise="not stated",
        reason="starts from rest are not judged", in_example=True,
    ),
    "demand.largest_jump": Key(
        "largest_jump", "The largest jump that is allowed.", '"2 um"', ("m",), ABOVE,
        otherwise="not stated", reason="there is no limit to hold a jump against",
    ),
    "demand.largest_error": Key(
        "largest_error", "The largest error at rest that is allowed.", '"5 um"', ("m",), ABOVE,
        otherwise="not stated", reason="there is no limit to hold an error against",
    ),
}  # fmt: skip

KEYS: Final = {
    path: replace(key, section=section, name=name)
    for path, key in _KEYS.items()
    for section, _, name in [path.rpartition(".")]
}
"""The keys by path, in the order of the template."""
BY_SECTION: Final = {
    name: {key.name: key for key in KEYS.values() if key.section == name} for name in SECTIONS
}


def key_of(path: str) -> Key:
    """Return the key of a name in a file, such as ``drive.filter[1].frequency``."""
    return KEYS[re.sub(r"\[\d+\]", "", path)]
