"""Friction of rate and state. docs/theory.md.

``mu = a asinh(u / (2 V_0) E)`` with ``E = exp(mu_0 / a) (V_0 theta / D_c)^(b / a)``; theta' is
``1 - r`` (aging) or ``-r ln r`` (slip), r being |u| theta / D_c.
"""

from collections.abc import Callable, Mapping, Sequence

from .law import FrictionLaw
from .parameters import Context, Kind, Number, Numbers, Parameter, sign
from .series import Series

_NEWTON_STEPS = 200


class RateState(FrictionLaw):
    """The own state is theta [s]; without inertia also q = mu/a, which the velocity follows from.

    From x_dot_start = 0 a mass with inertia creeps in pieces too short for a march, and under the
    slip law it never reaches 0 in finitely many: such runs are the reference's.
    """

    parameters = (
        Parameter("mu_0", "1", 0.6, Kind.FIXED, low=0.0),
        Parameter("a", "1", 0.01, Kind.FIXED, low=0.0, strict=True),
        Parameter("b", "1", 0.015, Kind.FIXED, low=0.0),
        Parameter("D_c", "m", 1e-5, Kind.FIXED, low=0.0, strict=True),
        Parameter("V_0", "m/s", 1e-6, Kind.FIXED, low=0.0, strict=True),
        Parameter("alpha", "1", 0.0, Kind.FIXED, low=0.0),
        Parameter("evolution", "1", 1.0, Kind.FIXED, low=1.0, chosen=True),
        Parameter("inertia", "1", 1.0, Kind.FIXED, low=1.0, chosen=True),
        Parameter("theta_start", "s", 10.0, Kind.FIXED, low=0.0, strict=True),
        Parameter("v_stick", "m/s", 1e-4, Kind.FIXED, low=0.0),
    )
    sticks = False
    lacks = ("mu_s", "mu_k", "mu_k_used")
    digits = 20

    def check(self, values: Mapping[str, float]) -> None:
        """Refuse another evolution or inertia than 1 and 2."""
        for name in ("evolution", "inertia"):
            if values[name] not in (1, 2):
                raise ValueError(f"{name} = {values[name]!r} is outside 1, 2")

    def mu_k_used(self, n: Numbers) -> None:
        """Return nothing: the law has no mu_k."""

    def hold(self, n: Numbers, age: Series, state: Sequence[Number]) -> Number:
        """Return mu_0 N [N]."""
        return n.own["mu_0"] * n.N

    def knots(self, context: Context, n: Numbers) -> Sequence[Number]:
        """Return 0 [m/s], where |u| has its corner."""
        return [context.zero]

    def kinetic(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Series:
        """Return N mu [N]."""
        resistance = n.N * n.own["a"]
        if len(state) == 2:
            balanced: Series = state[1] * resistance
            return balanced
        ratio = speed / _unit(n, state[0])
        backward = ratio.term(0) < 0
        size = -ratio if backward else ratio
        logarithm: Series = (size + (size * size + 1) ** 0.5).log()
        force: Series = logarithm * (-resistance if backward else resistance)
        return force

    def rates_between(
        self, n: Numbers, band: int, speed: Series, state: Sequence[Series]
    ) -> Sequence[Series]:
        """Return theta' [1], and q' [1/s] where there is no inertia."""
        own, theta = n.own, state[0]
        r = (speed if band else -speed) * theta / own["D_c"]
        aging = 1 - r if own["evolution"] == 1 else -(r * r.log())
        if len(state) == 1:
            return (aging,)
        # k (V - u) = N a q' + c u', and u' = unit cosh(q) q' - (b / a) theta' / theta u.
        falling = aging / theta * speed * (n.c * own["b"] / own["a"])
        width = _cosh(state[1]) * _unit(n, theta)
        q_rate = ((n.v - speed) * n.k + falling) / (width * n.c + n.N * own["a"])
        return aging, q_rate

    def state_start(self, n: Numbers) -> tuple[Number, ...]:
        """Return theta at the start [s]."""
        return (n.own["theta_start"],)

    def changed(self, before: Numbers, n: Numbers, state: tuple[Number, ...]) -> tuple[Number, ...]:
        """Return theta after a change of N: Linker and Dieterich (1992), 10.1029/92JB00017."""
        if not (before.N > 0 and n.N > 0 and n.own["b"] > 0):
            return state
        jump = (before.N / n.N) ** (n.own["alpha"] / n.own["b"])
        return (state[0] * jump, *state[1:])

    def velocity(self, context: Context, n: Numbers) -> Callable[[Sequence[Series]], Series] | None:
        """Return ``unit(theta) sinh(q)`` [m/s] without inertia."""
        if n.own["inertia"] == 1:
            return None
        return lambda state: _sinh(state[1]) * _unit(n, state[0])

    def started(
        self, context: Context, n: Numbers, force: Number, speed: Number, state: tuple[Number, ...]
    ) -> tuple[Number, tuple[Number, ...]]:
        """Return velocity and (theta, q) that balance the force, without inertia; by Newton.

        ``N a q + c unit sinh(q)`` is convex for q > 0: from above the steps never overshoot.
        """
        if n.own["inertia"] == 1:
            return speed, state
        if n.N == 0 and n.c == 0:
            raise ValueError("N = 0 and c = 0 are outside N + c > 0: nothing balances the spring")
        unit = _unit(n, Series(context, [state[0]])).term(0)
        stiff, size = n.N * n.own["a"], abs(force)
        bounds = [size / stiff] if stiff else []
        if n.c:
            bounds.append(context.asinh(size / (n.c * unit)))
        q = min(bounds)
        for _ in range(_NEWTON_STEPS):
            lack = stiff * q + n.c * unit * context.sinh(q) - size
            step = lack / (stiff + n.c * unit * context.cosh(q))
            q -= step
            if abs(step) <= context.ldexp(abs(q), 8 - context.prec):
                break
        q = sign(force) * q
        return unit * context.sinh(q), (state[0], q)

    def shown(
        self, context: Context, n: Numbers, x_dot: Number, state: Sequence[Number]
    ) -> dict[str, Number]:
        """Return theta [s] and mu [1]."""
        unit = _unit(n, Series(context, [state[0]])).term(0)
        return {"theta": state[0], "mu": n.own["a"] * context.asinh(x_dot / unit)}


def _unit(n: Numbers, theta: Series) -> Series:
    """Return 2 V_0 / E [m/s], the velocity at which mu is a asinh(1)."""
    own, context = n.own, theta.context
    first: Number = 2 * own["V_0"] * context.exp(-own["mu_0"] / own["a"])
    if not own["b"]:
        return Series(context, [first])
    unit: Series = (theta * (own["V_0"] / own["D_c"])) ** (-own["b"] / own["a"]) * first
    return unit


def _sinh(q: Series) -> Series:
    half: Series = (q.exp() - (-q).exp()) / 2
    return half


def _cosh(q: Series) -> Series:
    half: Series = (q.exp() + (-q).exp()) / 2
    return half


RATE_STATE = RateState()
