"""Stribeck friction as the block asks for it: three shapes of one friction law."""

from typing import Optional, Tuple

from fmi.table import ABOVE_ZERO, Item, Quantity, Variable

from ...interface import Own, parameter
from ...settings import Settings
from ..coulomb.coefficients import clamp_warning
from ..coulomb.law import COULOMB
from ..law import Friction
from .curve import CurveFriction
from .points import MOST_POINTS, first_ignored, names_of
from .smooth import HYPERBOLIC, SmoothFriction

STRIBECK_SHAPE, CURVE = 1, 3

_SHAPE = Quantity(
    "FrictionShape",
    "Integer",
    items=(
        Item("Stribeck", STRIBECK_SHAPE, "mu_k + (mu_s - mu_k) exp(-(|x_dot|/v_s)^delta)"),
        Item("Hyperbolic", HYPERBOLIC, "mu_k + (mu_s - mu_k)/(1 + |x_dot|/v_s)"),
        Item("Curve", CURVE, "Straight lines through the points u, mu; constant beyond the last"),
    ),
)
_EXPONENT = Quantity("Exponent", "Real", "", "1", 1.0)
_FIRST = 34


def _shared() -> Tuple[Variable, ...]:
    """Return the rows that the law has in common with Coulomb's."""
    rows = {row.name: row for row in COULOMB.interface.rows}
    used = rows["mu_k_used"]
    coefficients = tuple(names_of(point)[-1] for point in range(1, MOST_POINTS + 1))
    used = used._replace(depends=(*used.depends, "shape", "n_points", *coefficients))
    return rows["mu_s"], rows["mu_k"], used


def _points() -> Tuple[Variable, ...]:
    """Return the rows of the points of the curve."""
    number = _FIRST + 4
    rows = [
        parameter(
            number,
            "mu_1",
            "FrictionCoefficient",
            "fixed",
            0.5,
            "Curve: friction coefficient at the beginning of slip, at most mu_s",
            0.0,
        )
    ]
    for point in range(2, MOST_POINTS + 1):
        u, mu = names_of(point)
        rows.append(
            parameter(
                number + 1,
                u,
                "Velocity",
                "fixed",
                (point - 1) / 10,
                f"Curve: speed of point {point}, above that of point {point - 1}",
                ABOVE_ZERO,
            )
        )
        rows.append(
            parameter(
                number + 2,
                mu,
                "FrictionCoefficient",
                "fixed",
                0.3,
                f"Curve: friction coefficient at point {point}",
                0.0,
            )
        )
        number += 2
    return tuple(rows)


_OWN = (
    Variable(
        _FIRST,
        "shape",
        _SHAPE,
        "parameter",
        "fixed",
        STRIBECK_SHAPE,
        "Shape of friction over speed",
        minimum=STRIBECK_SHAPE,
        maximum=CURVE,
    ),
    parameter(
        _FIRST + 1,
        "v_s",
        "Velocity",
        "tunable",
        0.01,
        "Stribeck, Hyperbolic: speed of the fall of friction",
        ABOVE_ZERO,
    ),
    parameter(_FIRST + 2, "delta", _EXPONENT, "tunable", 2.0, "Stribeck: exponent", 1.0),
    Variable(
        _FIRST + 3,
        "n_points",
        Quantity("Count", "Integer"),
        "parameter",
        "fixed",
        2,
        "Curve: number of points that count",
        minimum=2,
        maximum=MOST_POINTS,
    ),
    *_points(),
)


class Stribeck:
    """Friction that depends on the speed of slip, with a break-away force at rest."""

    interface = Own(
        model="StickSlipStribeck",
        description=(
            "A mass pulled through a spring over dry friction that depends on its speed: "
            "Stribeck's curve, a hyperbola or measured points. Solved exactly from event to event, "
            "so no result depends on the communication step."
        ),
        rows=(
            *_shared(),
            *_OWN,
        ),
        at_rest=("mu_s",),
        in_slip=("mu_k", *(row.name for row in _OWN)),
    )

    def warning(self, settings: Settings) -> Optional[str]:
        """Return that mu_k is clamped, or what the shape ignores although it is set; or None."""
        if settings.shape != CURVE:
            return clamp_warning(settings.mu_s, settings.mu_k)
        count = settings.n_points
        texts = []
        if settings.mu_k != settings.table.by_name["mu_k"].start:
            texts.append(
                f"mu_k = {settings.mu_k!r} is ignored: shape is 3 (Curve), whose friction is mu_1 "
                f"to mu_{count}"
            )
        ignored = first_ignored(settings)
        if ignored is not None:
            value = getattr(settings, ignored)
            texts.append(f"{ignored} = {value!r} is ignored: n_points = {count}")
        return "; ".join(texts) if texts else None

    def under(self, settings: Settings, before: Optional[Friction] = None) -> Friction:
        """Return the law under these settings."""
        if settings.shape == CURVE:
            return CurveFriction(settings, before)
        return SmoothFriction(settings, before)


STRIBECK = Stribeck()
