"""The keys of an axis file: names, units, ranges, defaults, examples and meanings, here alone.

The reader, its refusals, the template, the example and the table of the documentation are made
from `SECTIONS` and `KEYS`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from stickslip_ref import COULOMB, STRIBECK, FrictionLaw

from ..quantity import KINDS, Kind, Units, on_data_sheet
from .model import STANDARD_GRAVITY

UNITS: Final = Units(
    on_data_sheet,
    {
        **KINDS,
        **{
            kind.unit: kind
            for kind in (
                Kind("an inertia", "kg.m2", "60 kg cm2"),
                Kind("a torque", "N.m", "19 N m"),
                Kind("a damping at the motor", "N.m.s/rad", "2 mN m s/rad"),
                Kind("a damping at the motor", "N.m.s", "2 mN m s"),
                Kind("a rate", "1/s", "25 1/s"),
                Kind("an angular frequency", "rad/s", "300 rad/s"),
                Kind("a frequency", "Hz", "400 Hz"),
                Kind("counts per turn", "1/turn", "1000000 counts/turn"),
            )
        },
    },
)
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
    """A section of an axis file.

    Attributes
    ----------
    name
        Its name; behind a point a table of an array, `[[drive.filter]]`.
    meaning
        What it says, in a line.
    required
        Whether a file must have it.
    otherwise, reason
        What is taken without it, and why.
    """

    name: str
    meaning: str
    required: bool = False
    otherwise: str = ""
    reason: str = ""

    @property
    def is_array(self) -> bool:
        """Whether there may be several."""
        return "." in self.name

    @property
    def header(self) -> str:
        """Its header in the file."""
        return f"[[{self.name}]]" if self.is_array else f"[{self.name}]"


@dataclass(frozen=True, kw_only=True)
class Key:
    """A key of an axis file.

    Attributes
    ----------
    section, name
        Where it stands.
    field
        What it sets in `Axis`, by name there, or how that is computed.
    meaning
        One line.
    example
        A value as it stands in a file.
    units
        SI units of what may be stated, the first that of the field; empty: it is a text.
    choices
        The texts that it may be; empty: any.
    within
        Range of its number.
    spread
        Whether it may have a ±.
    most
        How many values it may have; above 1 they are a list, or one value.
    required
        Whether it must be stated, where its section and `goes_with` are.
    unless
        Keys of its section that may stand in its place.
    excludes
        Keys of its section that must not stand beside it.
    goes_with
        A key of its section and the texts of it, one of which it needs; no text: any value.
    default
        What it is where it is not stated, as it would stand in a file; empty: see `otherwise`.
    otherwise
        What is taken where it is not stated, in words.
    reason
        Why that is taken; empty: nothing is assumed.
    in_example
        Whether the axis of docs/feed-axis.md states it.
    """

    section: str
    name: str
    field: str
    meaning: str
    example: str
    units: tuple[str, ...] = ()
    choices: tuple[str, ...] = ()
    within: Range = ANY
    spread: bool = False
    most: int = 1
    required: bool = False
    unless: tuple[str, ...] = ()
    excludes: tuple[str, ...] = ()
    goes_with: tuple[str, ...] = ()
    default: str = ""
    otherwise: str = ""
    reason: str = ""
    in_example: bool = False

    @property
    def path(self) -> str:
        """Its name with that of its section: ``axis.mass``."""
        return f"{self.section}.{self.name}"

    @property
    def symbol(self) -> str:
        """The field's own name, as ``K_v``."""
        return self.field.rpartition(".")[2].partition(",")[0]

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """The kinds of quantities that it may be."""
        return tuple(UNITS.kinds[unit] for unit in self.units)

    @property
    def bare(self) -> Kind | None:
        """What a number without a unit is."""
        return self.kinds[0] if self.units == NUMBER else None

    @property
    def expected(self) -> str:
        """What is expected, in words."""
        if self.choices:
            return "one of " + ", ".join(f'"{each}"' for each in self.choices)
        if not self.units:
            return "a text"
        many = {1: "", 2: "one or two values, each "}.get(self.most, "a list, each ")
        names = [kind.in_words for kind in self.kinds if kind.unit != "N.m.s"]
        if len(names) > 1 and self.units[-1] == "1":
            names[-1] = "percent of drive.rated_torque"
        within = "" if self.within == ANY else f", {self.within}"
        return f"{many}{' or '.join(names)}{within}"

    @property
    def needs(self) -> str:
        """What it goes with, as it stands in a file."""
        name, *texts = self.goes_with
        return " = ".join((name, *(f'"{text}"' for text in texts)))

    @property
    def taken(self) -> str:
        """What is taken where it is not stated, in words."""
        return self.default.strip('"') or self.otherwise


SECTIONS: Final = (
    Section("axis", "The table on its guideway, and the screw that moves it.", required=True),
    Section("friction", "The friction of the guideway: one of the ways to say it.", required=True),
    Section(
        "drive",
        "Motor and controller. Forces, dampings and the inertia are stated at the slide (N, "
        "N s/m, kg) or at the motor (N m, N m s/rad, kg cm2).",
        otherwise="a rigid drive",
        reason="the nut is taken to move at the feed, whatever the force",
    ),
    Section(
        "drive.filter",
        "A filter of the motor's force or current; one such section for each.",
        otherwise="no filter",
        reason="none is stated",
    ),
    Section(
        "demand",
        "What is asked of the axis.",
        otherwise="nothing is asked",
        reason="the critical feed is told, without a verdict on a feed",
    ),
)


def _of_law(law: FrictionLaw, name: str, kind: str, meaning: str, example: str, **more: str) -> Key:
    """Return the key of a parameter of a friction law, with the law's default and range."""
    own = law.parameters[name]
    needs = ("law", "stribeck" if law is STRIBECK else "coulomb")
    number = f"{own.start:g}"
    return Key(
        section="friction", name=name, field=f"friction.own: {name}", meaning=meaning,
        example=example, units=(kind,), spread=True, within=Range(own.bound.low, own.bound.strict),
        goes_with=(more["needs"],) if "needs" in more else needs,
        excludes=("curve",) if law is STRIBECK else (), required="reason" not in more,
        unless=("curve",) if law is STRIBECK else (),
        default="" if "reason" not in more else number if kind == "1" else f'"{number} {kind}"',
        reason=more.get("reason", ""),
    )  # fmt: skip


KEYS: Final = (
    Key(
        section="axis", name="name", field="name", meaning="What the axis is called in the report.",
        example='"X axis"', otherwise="the name of the file", in_example=True,
    ),
    Key(
        section="axis", name="mass", field="m", meaning="Table and workpiece.",
        example='"500 kg"', units=("kg",), within=ABOVE, spread=True, required=True,
        in_example=True,
    ),
    Key(
        section="axis", name="stiffness", field="k, stiffest",
        meaning="Screw, nut, bearings and coupling in series, seen at the slide; a list of two is "
        "the near and the far end of the screw, of which the softer is judged.",
        example='"40 N/um"', units=("N/m",), within=ABOVE, spread=True, most=2, required=True,
        in_example=True,
    ),
    Key(
        section="axis", name="c", field="c", meaning="Viscous friction of the guideway.",
        example='"4 kN s/m"', units=("N.s/m",), within=LEAST, spread=True, excludes=("zeta",),
        default='"0 N s/m"',
        reason="the least favourable, as the drive alone takes energy out", in_example=True,
    ),
    Key(
        section="axis", name="zeta", field="c = 2 zeta sqrt(k m)",
        meaning="Damping ratio of the table on the screw, in place of c.",
        example='"1.4 %"', units=NUMBER, within=LEAST, spread=True, excludes=("c",),
    ),
    Key(
        section="axis", name="load", field="load",
        meaning="Force that presses on the guideway beside the weight; negative where it lifts.",
        example='"2 kN"', units=("N",), spread=True, default='"0 N"', reason="the weight alone",
    ),
    Key(
        section="axis", name="force_along", field="along",
        meaning="Constant force on the table along the way: weight of a vertical axis less its "
        "counterweight, a seal's pull; positive in the direction of the feed.",
        example='"-300 N"', units=("N",), spread=True, default='"0 N"',
        reason="a horizontal axis without counterweight",
    ),
    Key(
        section="axis", name="gravity", field="g",
        meaning="Gravity across the guideway; on an inclined one the part that presses.",
        example='"9.81 m/s2"', units=("m/s2",), within=ABOVE,
        default=f'"{STANDARD_GRAVITY} m/s2"', reason="a horizontal guideway",
    ),
    Key(
        section="friction", name="mu_s", field="friction.mu_s",
        meaning="Static friction coefficient: break-away force over normal force.",
        example="0.20", units=NUMBER, within=LEAST, spread=True, required=True,
        unless=("F_s", "curve"), excludes=("F_s", "F_k"), in_example=True,
    ),
    Key(
        section="friction", name="mu_k", field="friction.mu_k",
        meaning="Kinetic friction coefficient, without the viscous part.",
        example="0.15", units=NUMBER, within=LEAST, spread=True, required=True,
        unless=("F_k", "curve"), excludes=("F_s", "F_k", "curve"), in_example=True,
    ),
    Key(
        section="friction", name="F_s", field="friction.mu_s = F_s / (mass gravity + load)",
        meaning="Break-away force, in place of mu_s (rollers, seals): at the slide, as torque at "
        "the motor, or in percent of drive.rated_torque.",
        example='"981 N"', units=(*FORCE, "1"), within=LEAST, spread=True, required=True,
        unless=("mu_s", "curve"), excludes=("mu_s", "mu_k"),
    ),
    Key(
        section="friction", name="F_k", field="friction.mu_k = F_k / (mass gravity + load)",
        meaning="Kinetic friction, in place of mu_k; as F_s.",
        example='"736 N"', units=(*FORCE, "1"), within=LEAST, spread=True, required=True,
        unless=("mu_k", "curve"), excludes=("mu_s", "mu_k", "curve"),
    ),
    Key(
        section="friction", name="curve", field="friction.own, mu_s, mu_k",
        meaning="CSV file of measured friction over speed, in place of mu_k or F_k; a path from "
        "the folder of this file.",
        example='"guideway.csv"', excludes=("mu_k", "F_k", "shape", "v_s", "delta"),
        goes_with=("law", "stribeck"),
    ),
    Key(
        section="friction", name="law", field="friction.law",
        meaning="Friction law: constant in slip, or falling with the speed, as with a curve.",
        example='"coulomb"', choices=("coulomb", "stribeck"), unless=("curve",),
        default='"coulomb"',
        reason="two coefficients are the whole friction",
    ),
    _of_law(
        COULOMB, "tau_s", "s", "Time at rest over which static friction grows to mu_s.",
        '"100 ms"', reason="static friction is there at once",
    ),
    _of_law(
        COULOMB, "B", "1", "Growth of the static coefficient with the logarithm of the time at "
        "rest.", "0.01", reason="static friction does not grow without end",
    ),
    _of_law(
        COULOMB, "t_0", "s", "Time at rest from which on that growth is logarithmic.", '"1 ms"',
        needs="B", reason="the default of the friction law",
    ),
    Key(
        section="friction", name="shape", field="friction.own: shape",
        meaning="How friction falls from mu_s to mu_k: exp(-(u/v_s)^delta), or 1/(1 + u/v_s).",
        example='"stribeck"', choices=("stribeck", "hyperbolic"), goes_with=("law", "stribeck"),
        excludes=("curve",), default='"stribeck"', reason="the default of the friction law",
    ),
    _of_law(STRIBECK, "v_s", "m/s", "Speed over which friction falls.", '"10 mm/s"'),
    _of_law(
        STRIBECK, "delta", "1", "Exponent of the fall.", "1",
        reason="the default of the friction law",
    ),
    Key(
        section="drive", name="kind", field="drive",
        meaning="A screw behind a servo motor; rigid: pitch and rated torque alone are read.",
        example='"screw"', choices=("screw", "rigid"), default='"screw"',
    ),
    Key(
        section="drive", name="pitch", field="drive.pitch",
        meaning="Way of the slide in a turn of the motor, a gear included.",
        example='"10 mm"', units=("m",), within=ABOVE, required=True, in_example=True,
    ),
    Key(
        section="drive", name="inertia", field="drive.inertia",
        meaning="Motor, brake, coupling and screw.",
        example='"60 kg cm2"', units=("kg", "kg.m2"), within=ABOVE, spread=True, required=True,
        in_example=True,
    ),
    Key(
        section="drive", name="viscous_friction", field="drive.d",
        meaning="Viscous friction of motor, bearings and nut.",
        example='"1 kN s/m"', units=DAMPING, within=LEAST, spread=True, default='"0 N s/m"',
        reason="the least favourable", in_example=True,
    ),
    Key(
        section="drive", name="dry_friction", field="drive.dry",
        meaning="Dry friction of motor, bearings and nut: their idling torque.",
        example='"1 N m"', units=FORCE, within=LEAST, spread=True, default='"0 N"',
        reason="all dry friction is that of the guideway",
    ),
    Key(
        section="drive", name="K_v", field="drive.K_v",
        meaning="Position gain: speed over following error.",
        example='"25 1/s"', units=("1/s",), within=ABOVE, spread=True, required=True,
        in_example=True,
    ),
    Key(
        section="drive", name="bandwidth", field="drive.bandwidth",
        meaning="Bandwidth of the velocity loop: its gain over the inertia.",
        example='"300 1/s"', units=("rad/s", "1/s"), within=ABOVE, spread=True, required=True,
        unless=("velocity_gain",), excludes=("velocity_gain",), in_example=True,
    ),
    Key(
        section="drive", name="velocity_gain", field="drive.bandwidth = velocity_gain / inertia",
        meaning="Gain of the velocity controller, in place of its bandwidth.",
        example='"1.8 N m s/rad"', units=DAMPING, within=ABOVE, spread=True,
        excludes=("bandwidth",),
    ),
    Key(
        section="drive", name="integral_time", field="drive.T_n",
        meaning="Integral time T_n of the velocity controller; 0 s: no integral.",
        example='"13 ms"', units=("s",), within=LEAST, spread=True, otherwise="4 / bandwidth",
        reason="critically damps the velocity loop of the drive alone",
    ),
    Key(
        section="drive", name="sample_time", field="drive.T_s",
        meaning="Sample time of position and velocity controller.",
        example='"0.25 ms"', units=("s",), within=ABOVE, default='"0.25 ms"',
        reason="usual for servo drives", in_example=True,
    ),
    Key(
        section="drive", name="current_lag", field="drive.lag",
        meaning="Time constant of the current loop.",
        example='"0.3 ms"', units=("s",), within=LEAST, spread=True, default='"0 s"',
        reason="the current loop is taken to be fast",
    ),
    Key(
        section="drive", name="dead_time", field="drive.dead_time",
        meaning="Time from a sample to its force: computing and bus.",
        example='"0.25 ms"', units=("s",), within=LEAST, spread=True, default='"0 s"',
        reason="the force is taken to follow at the sample",
    ),
    Key(
        section="drive", name="position", field="drive.on_table",
        meaning="Where the position is measured: a scale on the table, or the motor's encoder.",
        example='"table"', choices=("table", "motor"), default='"table"',
        reason="a linear scale", in_example=True,
    ),
    Key(
        section="drive", name="encoder", field="drive.resolution_motor",
        meaning="Resolution of the motor's encoder after interpolation: at the slide, or "
        "in counts/turn or lines/turn (a line is four counts).",
        example='"10 nm"', units=("m", "1/turn"), within=ABOVE, otherwise="exact",
        reason="counts are left out", in_example=True,
    ),
    Key(
        section="drive", name="scale", field="drive.resolution_table",
        meaning="Resolution of the scale on the table.",
        example='"0.1 um"', units=("m",), within=ABOVE, otherwise="exact",
        reason="counts are left out", in_example=True,
    ),
    Key(
        section="drive", name="velocity_feedforward", field="drive.velocity_feedforward",
        meaning="Part of the commanded speed that is fed forward.",
        example="1.0", units=NUMBER, within=LEAST, default="1.0",
        reason="usual; it moves the following error, not the jumps",
    ),
    Key(
        section="drive", name="friction_feedforward", field="drive.friction_feedforward",
        meaning="Force that is fed forward in the commanded direction.",
        example='"736 N"', units=FORCE, within=LEAST, default='"0 N"', reason="none is stated",
    ),
    Key(
        section="drive", name="dead_band", field="drive.dead_band",
        meaning="Position error that the controller takes as none.",
        example='"7 um"', units=("m",), within=LEAST, default='"0 um"', reason="none is stated",
    ),
    Key(
        section="drive", name="limit", field="drive.F_max",
        meaning="The most that the motor gives: force at the slide, or torque.",
        example='"12 kN"', units=FORCE, within=ABOVE, otherwise="no limit",
        reason="creeping and hunting stay far below the limit of a motor", in_example=True,
    ),
    Key(
        section="drive", name="rated_torque", field="F_s, F_k in percent of it",
        meaning="Rated torque of the motor, to which a drive refers its percent. What it shows at "
        "a steady feed is the friction of slide, nut and motor together.",
        example='"11 N m"', units=("N.m",), within=ABOVE,
    ),
    Key(
        section="drive.filter", name="kind", field="drive.filters: kind",
        meaning="A low pass, or a notch.",
        example='"notch"', choices=("low pass", "notch"), required=True,
    ),
    Key(
        section="drive.filter", name="frequency", field="drive.filters: frequency",
        meaning="Corner or notch frequency, below half the sampling frequency.",
        example='"400 Hz"', units=("Hz",), within=ABOVE, required=True,
    ),
    Key(
        section="drive.filter", name="damping", field="drive.filters: damping",
        meaning="Damping ratio of the poles; of a low pass that has none: first order.",
        example="0.7", units=NUMBER, within=ABOVE, excludes=("width",),
    ),
    Key(
        section="drive.filter", name="width", field="damping = width / (2 frequency)",
        meaning="Width of a notch between its -3 dB points, in place of its damping.",
        example='"200 Hz"', units=("Hz",), within=ABOVE, excludes=("damping",),
        goes_with=("kind", "notch"),
    ),
    Key(
        section="drive.filter", name="leaves", field="drive.filters: depth",
        meaning="What a notch leaves of its frequency; 0: nothing.",
        example='"10 %"', units=NUMBER, within=PART, goes_with=("kind", "notch"), default="0",
        reason="a full notch",
    ),
    Key(
        section="demand", name="feeds", field="demand.feeds",
        meaning="Feeds at which the axis is judged.",
        example='["0.5 mm/s", "2 mm/s", "5 mm/s"]', units=("m/s",), within=ABOVE, most=100,
        otherwise="none", reason="the critical feed is told, without a verdict on a feed",
        in_example=True,
    ),
    Key(
        section="demand", name="acceleration", field="demand.acceleration",
        meaning="Acceleration with which a feed is reached from rest; on a rigid drive the feed "
        "acts at once.",
        example='"0.1 m/s2"', units=("m/s2",), within=ABOVE, otherwise="not stated",
        reason="starts from rest are not judged", in_example=True,
    ),
    Key(
        section="demand", name="largest_jump", field="demand.largest_jump",
        meaning="The largest jump that is allowed.",
        example='"2 um"', units=("m",), within=ABOVE, otherwise="not stated",
        reason="there is no limit to hold a jump against",
    ),
    Key(
        section="demand", name="largest_error", field="demand.largest_error",
        meaning="The largest error at rest that is allowed.",
        example='"5 um"', units=("m",), within=ABOVE, otherwise="not stated",
        reason="there is no limit to hold an error against",
    ),
)  # fmt: skip
"""The keys, in the order of the template."""

BY_PATH: Final = {key.path: key for key in KEYS}
BY_SECTION: Final = {
    section.name: {key.name: key for key in KEYS if key.section == section.name}
    for section in SECTIONS
}

NOT_YET: Final = ("linear motor", "rack")
"""Kinds of drives that are known and not yet computed."""
