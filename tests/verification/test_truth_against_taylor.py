"""The truth against a second solution that shares nothing with it but the five equations.

The march below knows no closed form: it carries the equations of docs/theory.md (1) and the
energies (15) forward by Taylor series in short steps and finds events on the series. Sixty digits
of working precision and series cut below 1e-60 leave agreement to 1e-40 no room for an accident.
"""

import random
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import mpmath
import pytest

from stickslip_verification import truth

CTX = mpmath.mp.clone()
CTX.dps = 60
DRAWS = 24
ORDER = 44
# With w h and c h/m below this, the terms of order 44 are below 0.3^44/44! = 1e-77.
REACH = CTX.mpf("0.3")

Real = Any


class March:
    """The block carried forward by Taylor series, docs/theory.md (1), (15), (16)."""

    def __init__(self, values: Mapping[str, float]) -> None:
        self.p = {name: CTX.mpf(value) for name, value in values.items()}
        self.time = CTX.zero
        self.x = self.p["x_start"]
        self.z = self.p["z_start"]
        self.u = self.p["x_dot_start"]
        self.W_pull = self.W_k = self.Q = CTX.zero
        self.meter = dict.fromkeys(
            ("delta_x", "spring_drop", "t_stick", "t_slip", "T", "f", "x_dot_peak", "t_event"),
            CTX.zero,
        )
        self.n_slips = 0
        self.stick_start = CTX.zero
        self.break_away_time: Real = None
        self.kinds: list[str] = []
        self.mode = int(CTX.sign(self.u))
        if self.mode:
            self._begin_slip()

    def force(self) -> Real:
        """Return k z + F_ext."""
        return self.p["k"] * self.z + self.p["F_ext"]

    def break_away_force(self) -> Real:
        """Return the break-away force."""
        return self.p["mu_s"] * (self.p["m"] * self.p["g"] + self.p["load"])

    def kinetic_friction(self) -> Real:
        """Return the kinetic friction."""
        return self.p["mu_k"] * (self.p["m"] * self.p["g"] + self.p["load"])

    def _begin_slip(self) -> None:
        self.slip_start = (self.time, self.x, self.z)
        self.peak = self.u

    def _break_away(self, direction: int) -> None:
        self.mode = direction
        self._begin_slip()
        self.meter["t_stick"] = self.time - self.stick_start
        if self.break_away_time is not None:
            self.meter["T"] = self.time - self.break_away_time
            self.meter["f"] = 1 / self.meter["T"]
        self.break_away_time = self.meter["t_event"] = self.time
        self.kinds.append("break-away")

    def change(self, changes: Mapping[str, float]) -> None:
        """Set inputs and parameters now."""
        k_before = self.p["k"]
        for name, value in changes.items():
            self.p[name] = CTX.mpf(value)
        self.W_k += (self.p["k"] - k_before) * self.z**2 / 2

    def _series(self) -> tuple[list[Real], list[Real]]:
        """Return the Taylor coefficients of x_dot and z about now, by recurrence on (1)."""
        m, k, c, v = (self.p[name] for name in ("m", "k", "c", "v"))
        u, z = [self.u], [self.z]
        constant = self.p["F_ext"] - self.mode * self.kinetic_friction()
        for n in range(ORDER):
            rate = (k * z[n] + (constant if n == 0 else 0) - c * u[n]) / m
            u.append(rate / (n + 1))
            z.append(((v if n == 0 else 0) - u[n]) / (n + 1))
        return u, z

    def _slip(self, h: Real) -> bool:
        """Slip for h; return whether the mass came to a stop in it, then only up to there."""
        u, z = self._series()
        du = [n * u[n] for n in range(1, ORDER + 1)]
        end = h
        # A minimum inside is looked at too, so that no shallow stop is lost.
        turn = None
        if du[0] * _at(du, h) < 0:
            turn = _bisect(lambda t: _at(du, t), CTX.zero, h)
            if abs(_at(u, turn)) > abs(self.peak):
                self.peak = _at(u, turn)
        inner = [t for t in (turn, h) if t is not None]
        stopped = False
        before = CTX.zero
        for t in inner:
            if self.mode * _at(u, t) <= 0:
                # From rest the speed has another zero at 0 itself: start just beyond it.
                end = _bisect(lambda t: self.mode * _at(u, t), before or h * 1e-30, t)
                stopped = True
                break
            before = t
        self.x += _integral(u, end)
        self.W_pull += self.p["k"] * self.p["v"] * _integral(z, end)
        power = _product(
            u,
            [self.mode * self.kinetic_friction() + self.p["c"] * u[0]]
            + [self.p["c"] * a for a in u[1:]],
        )
        self.Q += _integral(power, end)
        self.z = _at(z, end)
        self.u = CTX.zero if stopped else _at(u, end)
        if abs(self.u) > abs(self.peak):
            self.peak = self.u
        self.time += end
        return stopped

    def _stop(self) -> None:
        start_time, start_x, start_z = self.slip_start
        self.meter["t_slip"] = self.time - start_time
        self.meter["delta_x"] = self.x - start_x
        self.meter["spring_drop"] = start_z - self.z
        self.meter["x_dot_peak"] = self.peak
        self.meter["t_event"] = self.time
        self.n_slips += 1
        if abs(self.force()) > self.break_away_force():
            self.mode = int(CTX.sign(self.force()))
            self.kinds.append("reversal")
            self._begin_slip()
        else:
            self.mode = 0
            self.kinds.append("re-stick")
            self.stick_start = self.time

    def _stick(self, h: Real) -> None:
        v, k = self.p["v"], self.p["k"]
        direction = int(CTX.sign(v))
        wait = CTX.inf
        if direction:
            wait = (direction * self.break_away_force() - self.p["F_ext"] - k * self.z) / (k * v)
        elapsed = min(wait, h)
        self.W_pull += v * k * (self.z + v * elapsed / 2) * elapsed
        self.z += v * elapsed
        self.time += elapsed
        if wait < h:
            self._break_away(direction)

    def advance(self, h: float) -> None:
        """Let h seconds pass."""
        if self.mode == 0 and abs(self.force()) > self.break_away_force():
            self._break_away(int(CTX.sign(self.force())))
        target = self.time + CTX.mpf(h)
        while self.time < target:
            left = target - self.time
            if self.mode == 0:
                self._stick(left)
                continue
            w = CTX.sqrt(self.p["k"] / self.p["m"])
            longest = REACH / max(w, self.p["c"] / self.p["m"])
            if self._slip(min(left, longest)):
                self._stop()

    def outputs(self) -> dict[str, Real]:
        """Return every output of the block by name."""
        slipping = -(self.mode * self.kinetic_friction() + self.p["c"] * self.u)
        return {
            "x": self.x,
            "x_dot": self.u,
            "x_pull": self.x + self.z,
            "z": self.z,
            "F": self.p["k"] * self.z,
            "F_friction": slipping if self.mode else -self.force(),
            "F_s": self.break_away_force(),
            "sticking": self.mode == 0,
            "mode": self.mode,
            **self.meter,
            "n_slips": self.n_slips,
            "W_pull": self.W_pull,
            "W_k": self.W_k,
            "Q_friction": self.Q,
            "mu_k_used": self.p["mu_k"],
        }


def _at(series: Sequence[Real], t: Real) -> Real:
    value = CTX.zero
    for a in reversed(series):
        value = value * t + a
    return value


def _integral(series: Sequence[Real], t: Real) -> Real:
    return t * _at([a / (n + 1) for n, a in enumerate(series)], t)


def _product(a: Sequence[Real], b: Sequence[Real]) -> list[Real]:
    return [CTX.fsum(a[i] * b[n - i] for i in range(n + 1)) for n in range(len(a))]


def _bisect(f: Callable[[Real], Real], low: Real, high: Real) -> Real:
    """Return the change of sign of f between low and high, by bisection to the last digit."""
    sign = CTX.sign(f(low))
    for _ in range(CTX.prec + 10):
        middle = (low + high) / 2
        if CTX.sign(f(middle)) == sign:
            low = middle
        else:
            high = middle
    return high


def _draw(rng: random.Random) -> tuple[dict[str, float], list[truth.Step]]:
    """Return one random block and a few steps with changes of every kind, some reversals."""
    w = 10 ** rng.uniform(-1, 2)
    m = 10 ** rng.uniform(-1, 1)
    mu_s = rng.uniform(0.05, 1.0)
    zeta = rng.choice([0.0, 0.02, 0.2, 0.9, 1.5, 4.0])
    values = dict(truth.START_VALUES)
    k = m * w * w
    amplitude = mu_s * m * 9.81 / k
    speed = w * amplitude
    values.update(
        m=m,
        k=k,
        c=2 * zeta * m * w,
        mu_s=mu_s,
        mu_k=mu_s * rng.uniform(0.0, 0.95),
        v=speed * rng.choice([0.1, 1.0, -0.5]),
        z_start=amplitude * rng.uniform(-3, 3),
        x_dot_start=speed * rng.choice([0.0, rng.uniform(-2, 2)]),
    )
    F_s = mu_s * m * 9.81
    steps = []
    for _ in range(5):
        mu_k = values["mu_k"] * rng.uniform(0.2, 1.0)
        changes: dict[str, float] = rng.choice(
            [
                {},
                {"v": -values["v"] * rng.uniform(0, 2)},
                {"v": 0.0, "load": m * rng.uniform(-9, 20)},
                {"F_ext": F_s * rng.uniform(-3, 3)},
                {"k": k * rng.uniform(0.3, 3), "mu_k": mu_k},
                {"c": values["c"] * rng.uniform(0, 2), "mu_s": mu_s * rng.uniform(1, 2)},
            ]
        )
        steps.append(truth.Step(rng.uniform(0.1, 6) / w, changes))
    return values, steps


@pytest.mark.parametrize("seed", range(DRAWS))
def test_truth_is_what_taylor_series_give_on_any_sequence(seed: int) -> None:
    """Every output after every step agrees with the march to 1e-40 of its own scale."""
    values, steps = _draw(random.Random(seed))
    exact = truth.run(values, steps)
    march = March(values)
    samples = []
    for step in steps:
        march.change(step.changes)
        march.advance(step.h)
        samples.append(march.outputs())
    assert [event.kind for event in exact.events] == march.kinds
    for name, value in exact.samples[0].items():
        course = [sample[name] for sample in exact.samples]
        largest = max(abs(sample[name]) for sample in samples)
        for got, expected in zip(course, (sample[name] for sample in samples), strict=True):
            assert abs(got - expected) <= 1e-40 * largest, (name, value)


def test_draws_meet_every_kind_of_transition() -> None:
    """The draws contain break-aways, re-sticks and reversals, and starts beyond F_s."""
    kinds = set()
    at_start = 0
    for seed in range(DRAWS):
        events = truth.run(*_draw(random.Random(seed))).events
        kinds |= {event.kind for event in events}
        at_start += bool(events) and events[0].time == 0
    assert kinds == {"break-away", "re-stick", "reversal"}
    assert at_start > 3
