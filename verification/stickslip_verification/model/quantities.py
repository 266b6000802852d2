"""What a check can look at: the outputs of the block and a few quantities made from them.

This is the suite's own list of the outputs, not a copy handed over by a side, so that a side
with a missing output or another unit is seen.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from stickslip_verification.model import formulas
from stickslip_verification.model.run import Series

Columns = Mapping[str, Series]
Parameters = Mapping[str, float]


@dataclass(frozen=True)
class Quantity:
    """One thing a check can compare with a truth, made from the outputs that it ``needs``.

    ``equation`` is the number in docs/theory.md of what the exact motion takes it from. ``compute``
    makes samples of it from the columns of those outputs and the values at the start of the case.
    A ``discrete`` one is an integer or a Boolean; a ``directed`` one changes its sign in the mirror
    image of a run.
    """

    name: str
    unit: str
    equation: int
    meaning: str
    needs: tuple[str, ...]
    compute: Callable[[Columns, Parameters], Series]
    discrete: bool = False
    directed: bool = False


def _output(name: str, unit: str, equation: int, meaning: str, *traits: str) -> Quantity:
    kind = dict.fromkeys(traits, True)
    return Quantity(name, unit, equation, meaning, (name,), lambda of, _: of[name], **kind)


OUTPUTS: tuple[Quantity, ...] = (
    _output("x", "m", 3, "position of the mass", "directed"),
    _output("x_dot", "m/s", 3, "velocity of the mass", "directed"),
    _output("x_pull", "m", 1, "position of the pulled end", "directed"),
    _output("z", "m", 3, "spring extension", "directed"),
    _output("F", "N", 1, "spring force", "directed"),
    _output("F_friction", "N", 1, "friction and damping force on the mass", "directed"),
    _output("F_s", "N", 6, "break-away force"),
    _output("sticking", "1", 4, "whether the mass sticks", "discrete"),
    _output(
        "mode", "1", 4, "-1 slips backward, 0 sticks, +1 slips forward", "discrete", "directed"
    ),
    _output("delta_x", "m", 16, "displacement in the last completed slip", "directed"),
    _output(
        "spring_drop", "m", 16, "relief of the spring over the last completed slip", "directed"
    ),
    _output("t_stick", "s", 16, "length of the last completed stick"),
    _output("t_slip", "s", 16, "length of the last completed slip"),
    _output("T", "s", 16, "time between the last two break-aways"),
    _output("f", "Hz", 16, "reciprocal of T"),
    _output("x_dot_peak", "m/s", 16, "extreme velocity of the last completed slip", "directed"),
    _output("n_slips", "1", 16, "number of completed slips", "discrete"),
    _output("t_event", "s", 5, "time of the last transition"),
    _output("W_pull", "J", 15, "work done by the pulling end"),
    _output("W_k", "J", 15, "energy put in by changing the stiffness"),
    _output("Q_friction", "J", 15, "heat made by friction and damping"),
    _output("mu_k_used", "1", 1, "kinetic friction coefficient after the clamp"),
)

OUTPUT_NAMES: tuple[str, ...] = tuple(quantity.name for quantity in OUTPUTS)

GROUPS: Mapping[str, tuple[str, ...]] = {
    "state": ("x", "x_dot", "z"),
    "forces": ("F", "F_friction"),
    "events": ("mode", "n_slips", "t_event"),
    "meter": ("delta_x", "spring_drop", "t_stick", "t_slip", "T", "x_dot_peak"),
    "energy": ("W_pull", "W_k", "Q_friction"),
}
"""Outputs that a case can name together; the others follow from these by an invariant each."""


def _divided(above: Series | float, below: Series) -> Series:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.divide(above, below)


DERIVED: tuple[Quantity, ...] = (
    Quantity(
        "jump_beyond_simplified",
        "m",
        12,
        "delta_x less the designers' 2 (mu_s - mu_k) N/k: the error of that formula",
        ("delta_x",),
        lambda columns, start: columns["delta_x"] - float(formulas.spring_relief(start)),
    ),
    Quantity(
        "slip_beyond_half_period",
        "s",
        12,
        "t_slip less the designers' pi/w: the error of that formula",
        ("t_slip",),
        lambda columns, start: columns["t_slip"] - float(formulas.half_period(start)),
    ),
    Quantity(
        "slip_short_of_full_period",
        "s",
        12,
        "2 pi/w less t_slip, which goes to 0 as the pull gets fast",
        ("t_slip",),
        lambda columns, start: 2.0 * float(formulas.half_period(start)) - columns["t_slip"],
    ),
    Quantity(
        "load_up_over_stick",
        "1",
        12,
        "the designers' mu_s N/(k v) over t_stick: by how much that formula is too long",
        ("t_stick",),
        lambda columns, start: _divided(float(formulas.first_load_up(start)), columns["t_stick"]),
    ),
    Quantity(
        "heat_per_travel",
        "N",
        15,
        "Q_friction over the way the mass has gone since the start, always in one direction",
        ("Q_friction", "x"),
        lambda columns, start: _divided(
            columns["Q_friction"], np.abs(columns["x"] - start["x_start"])
        ),
    ),
    Quantity(
        "period_beyond_phases",
        "s",
        16,
        "T less t_stick and t_slip, once both belong to the same cycle",
        ("T", "t_stick", "t_slip"),
        lambda columns, _: columns["T"] - columns["t_stick"] - columns["t_slip"],
    ),
)

QUANTITIES: dict[str, Quantity] = {q.name: q for q in (*OUTPUTS, *DERIVED)}
