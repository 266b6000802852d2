"""LuGre's friction law: bristles that bend before the mass slides. docs/theory.md.

The friction is ``sigma_0 zeta + sigma_1(u) zeta'``, and ``zeta' = u - sigma_0 |u| zeta / g(u)``.
"""

from collections.abc import Mapping, Sequence

from .law import FrictionLaw
from .parameters import Context, Kind, Number, Numbers, Parameter
from .series import Series


class LuGre(FrictionLaw):
    """The own state is the deflection zeta [m]."""

    parameters = (
        Parameter("sigma_0", "N/m", 1e5, Kind.FIXED, low=0.0, strict=True),
        Parameter("sigma_1", "N.s/m", 300.0, Kind.FIXED, low=0.0),
        Parameter("v_s", "m/s", 1e-3, Kind.FIXED, low=0.0, strict=True),
        Parameter("delta", "1", 2.0, Kind.FIXED, low=1.0, chosen=True),
        Parameter("v_d", "m/s", 0.0, Kind.FIXED, low=0.0),
        Parameter("zeta_start", "m", 0.0, Kind.FIXED, directed=True),
        Parameter("v_stick", "m/s", 1e-4, Kind.FIXED, low=0.0),
    )
    sticks = False
    digits = 20

    def check(self, values: Mapping[str, float]) -> None:
        """Refuse an exponent that is not whole, and bristles that give way to nothing.

        g has no Taylor series at rest with the one, and hardly a least value with the other.
        """
        for name in ("mu_s", "mu_k"):
            if values[name] == 0.0:
                raise ValueError(
                    f"{name} = 0.0 is outside {name} > 0, which the truth of LuGre's law is "
                    "limited to"
                )
        if values["delta"] != int(values["delta"]):
            raise ValueError(
                f"delta = {values['delta']!r} is outside the whole numbers, which the truth of "
                "LuGre's law is limited to"
            )

    def knots(self, context: Context, n: Numbers) -> Sequence[Number]:
        """Return 0 and the speeds [m/s], both ways, where an exponential is a rounding."""
        v_s, delta, v_d = (n.own[name] for name in ("v_s", "delta", "v_d"))
        falls = [(v_s, delta)] * bool(n.gap) + [(v_d, 2)] * bool(v_d)
        limits = {_fades(context, *each) for each in falls}
        return sorted({context.zero, *limits, *(-u for u in limits)})

    def kinetic_between(
        self, n: Numbers, band: int, speed: Series, state: Sequence[Series]
    ) -> Series:
        """Return ``sigma_0 zeta + sigma_1 zeta'`` [N]."""
        own = n.own
        force: Series = state[0] * own["sigma_0"]
        (rate,) = self.rates_between(n, band, speed, state)
        if own["v_d"]:
            if self._place(speed.context, n, band)[1] >= _fades(speed.context, own["v_d"], 2):
                return force
            rate = rate * (-((speed / own["v_d"]) ** 2)).exp()
        whole: Series = force + rate * own["sigma_1"]
        return whole

    def rates_between(
        self, n: Numbers, band: int, speed: Series, state: Sequence[Series]
    ) -> Sequence[Series]:
        """Return zeta' [m/s]."""
        context, own = speed.context, n.own
        forward, level = self._place(context, n, band)
        size = speed if forward else -speed
        part = size * state[0] * own["sigma_0"]
        if n.gap == 0 or level >= _fades(context, own["v_s"], own["delta"]):
            return (speed - part / n.F_k,)
        g = (-((size / own["v_s"]) ** own["delta"])).exp() * n.gap + n.F_k
        return (speed - part / g,)

    def _place(self, context: Context, n: Numbers, band: int) -> tuple[bool, Number]:
        """Return whether a band is forward, and how far from 0 it begins [m/s]."""
        knots = self.knots(context, n)
        forward = 2 * band > len(knots)
        return forward, abs(knots[band - 1] if forward else knots[band])

    def state_start(self, n: Numbers) -> tuple[Number, ...]:
        """Return zeta at the start [m]."""
        return (n.own["zeta_start"],)

    def stored(self, n: Numbers, state: Sequence[Number]) -> Number:
        """Return the energy in the bristles [J]."""
        return n.own["sigma_0"] * state[0] * state[0] / 2

    def shown(
        self, context: Context, n: Numbers, x_dot: Number, state: Sequence[Number]
    ) -> dict[str, Number]:
        """Return zeta [m] and the energy in the bristles [J]."""
        return {"zeta": state[0], "E_bristles": self.stored(n, state)}


def _fades(context: Context, speed: Number, exponent: Number) -> Number:
    """Return where ``exp(-(u/speed)^exponent)`` is below a rounding [m/s]."""
    return speed * (context.prec * context.ln2) ** (context.one / exponent)


LUGRE = LuGre()
