"""Friction that falls with speed, as it is measured. docs/theory.md (26).

Three shapes of the coefficient mu(u) in slip at the speed u >= 0, `mu_s` being the break-away
coefficient of all three:

1. Stribeck: mu_k + (mu_s - mu_k) exp(-(u/v_s)^delta)
2. Hyperbolic: mu_k + (mu_s - mu_k)/(1 + u/v_s)
3. Curve: straight between the measured points (0, mu_1), (u_2, mu_2) ... (u_n, mu_n), mu_n beyond
"""

from collections.abc import Mapping, Sequence
from enum import IntEnum

from .law import FrictionLaw
from .march import NearRest
from .parameters import Context, Kind, Number, Numbers, Parameter
from .series import Series

MOST_POINTS = 12  # a curve has at most as many points


class Shape(IntEnum):
    """How the friction in slip depends on the speed."""

    STRIBECK = 1
    HYPERBOLIC = 2
    CURVE = 3


def _own_parameters() -> tuple[Parameter, ...]:
    points = [Parameter("mu_1", "1", 0.5, Kind.FIXED, low=0.0)]
    for i in range(2, MOST_POINTS + 1):
        points += [
            Parameter(f"u_{i}", "m/s", (i - 1) / 10, Kind.FIXED, low=0.0, strict=True),
            Parameter(f"mu_{i}", "1", 0.3, Kind.FIXED, low=0.0),
        ]
    return (
        Parameter("shape", "1", 1.0, Kind.FIXED, low=1.0, chosen=True),
        Parameter("v_s", "m/s", 0.01, Kind.TUNABLE, low=0.0, strict=True),
        Parameter("delta", "1", 2.0, Kind.TUNABLE, low=1.0, chosen=True),
        Parameter("n_points", "1", 2.0, Kind.FIXED, low=2.0, chosen=True),
        *points,
    )


class Stribeck(FrictionLaw):
    """The three shapes; the break-away force is mu_s N at any age."""

    parameters = _own_parameters()
    digits = 20

    def check(self, values: Mapping[str, float]) -> None:
        """Refuse a shape or a number of points there is none of, and a curve that is none."""
        for name, largest in (("shape", len(Shape)), ("n_points", MOST_POINTS)):
            if values[name] != int(values[name]) or values[name] > largest:
                low = "1" if name == "shape" else "2"
                raise ValueError(
                    f"{name} = {values[name]!r} is outside the whole numbers {low} .. {largest}"
                )
        if values["shape"] != Shape.CURVE:
            return
        if values["mu_1"] > values["mu_s"]:
            raise ValueError(
                f"mu_1 = {values['mu_1']!r} is outside mu_1 <= mu_s = {values['mu_s']!r}"
            )
        before = 0.0
        for i in range(2, int(values["n_points"]) + 1):
            speed = values[f"u_{i}"]
            if not speed > before:
                raise ValueError(f"u_{i} = {speed!r} is outside u_{i} > {before!r}: speeds rise")
            before = speed

    def mu_k_used(self, n: Numbers) -> Number:
        """Return mu_k after the clamp, for a curve the coefficient at its last point."""
        return _points(n)[-1][1] if _shape(n) is Shape.CURVE else n.mu_k

    def coefficient(self, values: Mapping[str, float]) -> float:
        """Return mu_k after the clamp, for a curve the coefficient at its last point."""
        if values["shape"] != Shape.CURVE:
            return super().coefficient(values)
        last = int(values["n_points"])
        return values[f"mu_{last}"]

    def spread(self, values: Mapping[str, float]) -> float:
        """Return mu_s less the least coefficient of a curve [1], which has no mu_k."""
        if values["shape"] != Shape.CURVE:
            return super().spread(values)
        count = int(values["n_points"])
        return values["mu_s"] - min(values[f"mu_{i}"] for i in range(1, count + 1))

    def gap(self, n: Numbers, hold: Number, sliding: Number) -> Number:
        """Return (mu_s - mu_1) N [N] for a curve; 0 for the others, which start at mu_s."""
        return n.F_s - _points(n)[0][1] * n.N if _shape(n) is Shape.CURVE else 0 * n.N

    def knots(self, context: Context, n: Numbers) -> Sequence[Number]:
        """Return the speeds [m/s] at which a curve has a corner.

        Stribeck's shape has one too: where its exponential has fallen to a rounding. It is 0
        beyond, and what cannot be seen makes no pieces short.
        """
        shape = _shape(n)
        if shape is Shape.CURVE:
            return [speed for speed, _ in _points(n)[1:]]
        if shape is Shape.HYPERBOLIC or n.gap == 0:
            return ()
        return [n.own["v_s"] * (context.prec * context.ln2) ** (1 / n.own["delta"])]

    def near_rest(self, n: Numbers) -> NearRest | None:
        """Return the power delta of Stribeck's shape where it is not whole."""
        delta = n.own["delta"]
        if _shape(n) is not Shape.STRIBECK or delta == int(delta) or n.gap == 0:
            return None
        return NearRest(n.own["v_s"], delta, n.gap)

    def kinetic_between(
        self, n: Numbers, band: int, speed: Series, state: Sequence[Series]
    ) -> Series:
        """Return N mu(speed) [N] in a band between two knots."""
        shape = _shape(n)
        if shape is Shape.CURVE:
            return _line(n, band, speed)
        if n.gap == 0 or band:
            return Series(speed.context, [n.F_k])
        ratio = speed / n.own["v_s"]
        if shape is Shape.HYPERBOLIC:
            fallen: Series = n.gap / (ratio + 1) + n.F_k
        elif ratio.term(0) == 0 and self.near_rest(n):
            fallen = Series(speed.context, [n.F_s])
        else:
            fallen = (-(ratio ** n.own["delta"])).exp() * n.gap + n.F_k
        return fallen


def _shape(n: Numbers) -> Shape:
    return Shape(int(n.own["shape"]))


def _points(n: Numbers) -> list[tuple[Number, Number]]:
    """Return speed [m/s] and coefficient of each point of the curve."""
    own = n.own
    return [
        (own[f"u_{i}"] if i > 1 else 0 * own["u_2"], own[f"mu_{i}"])
        for i in range(1, int(own["n_points"]) + 1)
    ]


def _line(n: Numbers, band: int, speed: Series) -> Series:
    """Return the curve on the straight line of a band [N], constant in the last one."""
    points = _points(n)
    begin, mu = points[band]
    if band == len(points) - 1:
        return Series(speed.context, [mu * n.N])
    end, mu_end = points[band + 1]
    line: Series = (speed - begin) * ((mu_end - mu) * n.N / (end - begin)) + mu * n.N
    return line


STRIBECK = Stribeck()
