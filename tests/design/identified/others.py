"""Records made by others' ways, and a twin of a real one: what the model does not have."""

import math
from collections.abc import Callable, Iterator
from typing import Final

import numpy as np
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

from stickslip_design.identify.model import Kind, Record
from stickslip_ref import Change, Parameters, simulate
from tests.design.identified.loops import Array
from tests.design.identified.records import KINDS, moved, trips

Columns = dict[str, Array]
Law = Callable[[Array, Array, Array], tuple[Array, Array]]
"""From position [m], speed [m/s], deflection [m] the friction [N] and the deflection's rate."""

M, K, C, F_S, F_K, BRISTLES = 200.0, 2e6, 600.0, 300.0, 200.0, 1e8
TRUTH: Final = {
    "axis.mass": M, "axis.c": C, "c forward": C, "c backward": C, "friction.F_k": F_K,
    "axis.stiffness": K, "k/m": K / M, "c/m": C / M, "friction.F_s": F_S, "gap": (F_S - F_K) / K,
    "friction.mu_s": F_S / M / 9.81, "friction.mu_k": F_K / M / 9.81, "axis.force_along": 0.0,
    "F_s - F_k": F_S - F_K,
}  # fmt: skip
"""By any law F_k is the friction of high speeds, F_s the greatest, to 0.1 %."""


def _stribeck(v: Array, v_s: float) -> Array:
    return np.asarray(F_K + (F_S - F_K) * np.exp(-((v / v_s) ** 2)))


def laws(top: float) -> dict[str, Law]:
    """Return frictions, without the viscous part, for speeds up to about this [m/s]."""

    def lugre(x: Array, v: Array, z: Array) -> tuple[Array, Array]:
        rate = v - BRISTLES * np.abs(v) / _stribeck(v, 0.05 * top) * z
        return BRISTLES * z + 0.02 * math.sqrt(BRISTLES * M) * rate, rate

    def sharp(friction: Callable[[Array, Array], Array], v_0: float = 2e-6) -> Law:
        return lambda x, v, z: (friction(x, v) * np.tanh(v / (v_0 * top)), 0.0 * v)

    return {
        "tanh": sharp(lambda x, v: _stribeck(v, 0.02 * top), 2e-4),
        "LuGre": lugre,
        "Stribeck": sharp(lambda x, v: _stribeck(v, 0.2 * top)),
        "by position": sharp(
            lambda x, v: _stribeck(v, 1e-3 * top) * (1.0 + 0.2 * np.sin(x / (0.05 * top)))
        ),
        "plain": sharp(lambda x, v: _stribeck(v, 1e-3 * top)),
    }  # fmt: skip


def made(kind: Kind, name: str, rng: np.random.Generator) -> Columns:
    """Return a record at 1 kHz of an axis on a rigid drive, with little noise."""
    if kind == "stick-slip":
        t, feed, small = np.arange(0.0, 2.5, 1e-3), 1e-3, 1e-4
        law, command = laws(5.0 * feed)[name], feed * np.maximum(t - 0.1, 0.0)

        def rate(time: float, y: Array) -> list[float]:
            friction, z = law(y[0], y[1], y[2])
            force = K * (feed * max(time - 0.1, 0.0) - y[0])
            return [y[1], float(force - friction - C * y[1]) / M, float(z)]

        if name == "plain":
            block = Parameters(m=M, k=K, c=C, mu_s=F_S / M / 9.81, mu_k=F_K / M / 9.81, v=0.0)
            x = simulate(block, 2.5, times=t, changes=[Change(0.1, {"v": feed})]).x
        else:
            exact = {"rtol": 1e-8, "atol": 1e-12, "max_step": 1e-3}
            x = solve_ivp(rate, (0.0, 2.5), np.zeros(3), "LSODA", t, **exact).y[0]
        force = K * (command - x)
    else:
        t, small = np.arange(0.0, 12.0, 1e-3), 1e-6
        v = 0.2 * np.geomspace(0.03, 1.0, 7)
        if kind == "steady runs":
            x, v, a = trips(t, np.ravel([v, -v], order="F"), 0.84, 0.08)
        else:
            x, v, a = trips(t, 0.2 * rng.uniform(0.3, 1.0, 16) * np.resize([1, -1], 16), 0.73, 0.5)
        law, z, command = laws(0.2)[name], np.zeros(len(t)), x
        for n in range(1, len(t) * (name == "LuGre")):
            # Exact for a speed that is constant over a sample.
            end = _stribeck(v[n], 0.01) / BRISTLES * np.sign(v[n])
            part = math.exp(-1e-3 * abs(v[n]) / max(abs(end), 1e-12))
            z[n] = end + (z[n - 1] - end) * part if v[n] else z[n - 1]
        force = M * a + law(x, v, z)[0] + C * v
    return {
        "t": t, "command": command, "position": x + rng.normal(0.0, small * np.ptp(x), len(t)),
        "force": force + rng.normal(0.0, 0.005 * np.ptp(force), len(t)),
    }  # fmt: skip


def _backlash(x: Array, play: float) -> Array:
    y = x.copy()
    for n in range(1, len(x)):
        y[n] = min(max(y[n - 1], x[n] - play), x[n])
    return y


def _rounded(x: Array, bits: int = 12) -> Array:
    unit = 1.2 * np.ptp(x) / 2**bits
    return np.asarray(np.round(x / unit) * unit)


def _jitter(q: Columns, rng: np.random.Generator) -> Columns:
    late = np.sort(q["t"] + rng.normal(0.0, 1e-4, len(q["t"])))
    return {n: np.interp(late, q["t"], q[n]) for n in q} | {"t": q["t"]}


def _lost(q: Columns, rng: np.random.Generator) -> Columns:
    rows = rng.random(len(q["t"])) > 0.02
    rows[len(rows) // 2 : len(rows) // 2 + 30] = False
    return {n: q[n][rows] for n in q}


TWISTS: Final[dict[str, Callable[[Columns, np.random.Generator], Columns]]] = {
    "12 bits": lambda q, _: {n: _rounded(q[n]) for n in q} | {"t": q["t"]},
    "jitter": _jitter,
    "lost samples": _lost,
    "drift": lambda q, _: (
        q | {"force": q["force"] + 0.1 * np.ptp(q["force"]) * np.linspace(0.0, 1.0, len(q["t"]))}
    ),
    "backlash": lambda q, _: q | {"position": _backlash(q["position"], 5e-6)},
    "mm for m": lambda q, _: q | {"position": 1e3 * q["position"]},
    "delay": lambda q, _: {n: q[n][2:] for n in q} | {"force": q["force"][:-2]},
    "filter": lambda q, _: q | {"force": lfilter([0.05], [1.0, -0.95], q["force"])},
    "limit": lambda q, _: q | {"force": q["force"].clip(*(0.7 * np.quantile(q["force"], [0, 1])))},
}  # fmt: skip


def recorded(q: Columns) -> Record:
    """Return columns as a record."""
    return Record(t=q["t"], command=q["command"], position=q["position"], force=q["force"])


def others() -> Iterator[tuple[str, Kind, Record]]:
    """Yield 40 records, whose numbers are `TRUTH`."""
    for kind in KINDS:
        rng = np.random.default_rng([37, KINDS.index(kind)])
        plain = made(kind, "plain", rng)
        for name, twist in TWISTS.items():
            yield name, kind, recorded(twist(plain, rng))
        for name in ("tanh", "LuGre", "Stribeck", "by position"):
            columns = made(kind, name, rng)
            yield name, kind, recorded(columns)
    yield "by position, 12 bits", "excitation", recorded(TWISTS["12 bits"](columns, rng))


def twin() -> Record:
    """Return a record such as EMPS: a prismatic joint, its screw under a position controller."""
    rng, dt, begin, changes = np.random.default_rng(38), 1e-3, 0.0, []
    for n in range(32):
        sense, v = 1.0 - n // 4 % 2 * 2.0, (0.042, 0.083, 0.125, 0.042)[n % 4]
        last, ramp = (0.5, 0.9, 1.25, 0.45)[n % 4], v / 0.7
        changes += [(begin, ramp, sense * v), (begin + last - ramp, ramp, -sense * v)]
        begin += last
    t: Array = np.arange(24_841) * dt
    command = moved(t, changes)[0]
    a = math.exp(-dt / 0.015)
    rough = lfilter([1.7 * math.sqrt(1.0 - a * a)], [1.0, -a], rng.normal(size=len(t)))
    x, u, before, force, position = 0.0, 0.0, 0.0, np.zeros(len(t)), np.zeros(len(t))
    for n, aim in enumerate(command):
        position[n] = seen = round((x + rng.normal(0.0, 2e-8)) / 5e-8) * 5e-8
        force[n] = 35.15065 * 243.45 * (160.18 * (aim - seen) - (seen - before) / dt)
        before = seen
        for _ in range(4):
            pull = force[n] + rough[n] + 0.2 - (167.0 if u > 0.0 else 241.0) * u
            rubs = math.copysign(20.4, u) if u else min(max(pull, -20.4), 20.4)
            after = u + (pull - rubs) / 95.1 * dt / 4.0
            u = 0.0 if after * u < 0.0 else after
            x += u * dt / 4.0
    return Record(t=t, command=command, position=position, force=force)
