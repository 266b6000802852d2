"""Stribeck friction as the block asks for it: three shapes of one friction law."""

from typing import Iterator, Optional, Tuple

from fmi.table import ABOVE_ZERO, Item, Quantity, Variable

from ...interface import FIRST_OWN, Own, parameter
from ...settings import Settings
from ..coulomb.coefficients import clamp_warning
from ..coulomb.law import COULOMB
from ..law import Friction
from .curve import CurveFriction
from .points import MOST_POINTS, first_ignored, names_of
from .smooth import HYPERBOLIC, SmoothFriction

CURVE = 3

_SHAPE = Quantity(
    "FrictionShape",
    "Integer",
    items=(
        Item("Stribeck", 1, "mu_k + (mu_s - mu_k) exp(-(|x_dot|/v_s)^delta)"),
        Item("Hyperbolic", HYPERBOLIC, "mu_k + (mu_s - mu_k)/(1 + |x_dot|/v_s)"),
        Item("Curve", CURVE, "Straight lines through the points u, mu; constant beyond the last"),
    ),
)
_EXPONENT = Quantity("Exponent", "Real", "", "1", 1.0)


def _shared() -> Tuple[Variable, ...]:
    """Return the rows that the law has in common with Coulomb's."""
    rows = {row.name: row for row in COULOMB.interface.rows}
    used = rows["mu_k_used"]
    coefficients = tuple(names_of(point)[-1] for point in range(1, MOST_POINTS + 1))
    used = used._replace(depends=(*used.depends, "shape", "n_points", *coefficients))
    return rows["mu_s"], rows["mu_k"], used


def _points() -> Iterator[Variable]:
    """Give the rows of the points of the curve."""
    mu, text = "FrictionCoefficient", "Curve: friction coefficient at "
    first = text + "the beginning of slip, at most mu_s"
    yield parameter(FIRST_OWN + 4, "mu_1", mu, "fixed", 0.5, first, 0.0)
    for point in range(2, MOST_POINTS + 1):
        number = FIRST_OWN + 1 + 2 * point
        names = names_of(point)
        speed = f"Curve: speed of point {point}, above that of point {point - 1}"
        yield parameter(number, names[0], "Velocity", "fixed", (point - 1) / 10, speed, ABOVE_ZERO)
        yield parameter(number + 1, names[1], mu, "fixed", 0.3, f"{text}point {point}", 0.0)


_FALL = "Stribeck, Hyperbolic: speed of the fall of friction"
_COUNT = "Curve: number of points that count"
_OWN = (
    parameter(FIRST_OWN, "shape", _SHAPE, "fixed", 1, "Shape of friction over speed", 1, CURVE),
    parameter(FIRST_OWN + 1, "v_s", "Velocity", "tunable", 0.01, _FALL, ABOVE_ZERO),
    parameter(FIRST_OWN + 2, "delta", _EXPONENT, "tunable", 2.0, "Stribeck: exponent", 1.0),
    parameter(FIRST_OWN + 3, "n_points", "Count", "fixed", 2, _COUNT, 2, MOST_POINTS),
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
        rows=(*_shared(), *_OWN),
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
