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
    """One thing a check can compare with a truth.

    Attributes
    ----------
    name, unit, meaning
        As they stand in case files and reports; ``unit`` in the spelling of the interface.
    equation
        Number in docs/theory.md of what the exact motion takes it from.
    needs
        Outputs it is made from.
    compute
        From the columns of those outputs and the values at the start of the case to samples of
        the quantity.
    discrete
        Whether only equality makes sense (an integer or a Boolean).
    directed
        Whether it changes its sign in the mirror image of a run.
    """

    name: str
    unit: str
    equation: int
    meaning: str
    needs: tuple[str, ...]
    compute: Callable[[Columns, Parameters], Series]
    discrete: bool = False
    directed: bool = False


def _output(name: str, unit: str, equation: int, meaning: str, **traits: bool) -> Quantity:
    return Quantity(
        name, unit, equation, meaning, (name,), lambda columns, _: columns[name], **traits
    )


OUTPUTS: tuple[Quantity, ...] = (
    _output("x", "m", 3, "position of the mass", directed=True),
    _output("x_dot", "m/s", 3, "velocity of the mass", directed=True),
    _output("x_pull", "m", 1, "position of the pulled end", directed=True),
    _output("z", "m", 3, "spring extension", directed=True),
    _output("F", "N", 1, "spring force", directed=True),
    _output("F_friction", "N", 1, "friction and damping force on the mass", directed=True),
    _output("F_s", "N", 6, "break-away force"),
    _output("sticking", "1", 4, "whether the mass sticks", discrete=True),
    _output(
        "mode",
        "1",
        4,
        "-1 slips backward, 0 sticks, +1 slips forward",
        discrete=True,
        directed=True,
    ),
    _output("delta_x", "m", 16, "displacement in the last completed slip", directed=True),
    _output(
        "spring_drop", "m", 16, "relief of the spring over the last completed slip", directed=True
    ),
    _output("t_stick", "s", 16, "length of the last completed stick"),
    _output("t_slip", "s", 16, "length of the last completed slip"),
    _output("T", "s", 16, "time between the last two break-aways"),
    _output("f", "Hz", 16, "reciprocal of T"),
    _output("x_dot_peak", "m/s", 16, "extreme velocity of the last completed slip", directed=True),
    _output("n_slips", "1", 16, "number of completed slips", discrete=True),
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


def _jump_beyond_simplified(columns: Columns, start: Parameters) -> Series:
    return columns["delta_x"] - float(formulas.spring_relief(start))


def _slip_beyond_half_period(columns: Columns, start: Parameters) -> Series:
    return columns["t_slip"] - float(formulas.half_period(start))


def _slip_short_of_full_period(columns: Columns, start: Parameters) -> Series:
    return 2.0 * float(formulas.half_period(start)) - columns["t_slip"]


def _load_up_over_stick(columns: Columns, start: Parameters) -> Series:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.divide(float(formulas.first_load_up(start)), columns["t_stick"])


def _heat_per_travel(columns: Columns, start: Parameters) -> Series:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.divide(columns["Q_friction"], np.abs(columns["x"] - start["x_start"]))


def _period_beyond_phases(columns: Columns, start: Parameters) -> Series:
    return columns["T"] - columns["t_stick"] - columns["t_slip"]


DERIVED: tuple[Quantity, ...] = (
    Quantity(
        "jump_beyond_simplified",
        "m",
        12,
        "delta_x less the designers' 2 (mu_s - mu_k) N/k: the error of that formula",
        ("delta_x",),
        _jump_beyond_simplified,
    ),
    Quantity(
        "slip_beyond_half_period",
        "s",
        12,
        "t_slip less the designers' pi/w: the error of that formula",
        ("t_slip",),
        _slip_beyond_half_period,
    ),
    Quantity(
        "slip_short_of_full_period",
        "s",
        12,
        "2 pi/w less t_slip, which goes to 0 as the pull gets fast",
        ("t_slip",),
        _slip_short_of_full_period,
    ),
    Quantity(
        "load_up_over_stick",
        "1",
        12,
        "the designers' mu_s N/(k v) over t_stick: by how much that formula is too long",
        ("t_stick",),
        _load_up_over_stick,
    ),
    Quantity(
        "heat_per_travel",
        "N",
        15,
        "Q_friction over the way the mass has gone since the start, always in one direction",
        ("Q_friction", "x"),
        _heat_per_travel,
    ),
    Quantity(
        "period_beyond_phases",
        "s",
        16,
        "T less t_stick and t_slip, once both belong to the same cycle",
        ("T", "t_stick", "t_slip"),
        _period_beyond_phases,
    ),
)

QUANTITIES: dict[str, Quantity] = {q.name: q for q in (*OUTPUTS, *DERIVED)}
