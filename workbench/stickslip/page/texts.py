"""Texts with numbers: templates that are filled with what the reference computes for a setting.

The rows of the story, the sentences, the applications and the questions are made of them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from functools import partial
from typing import Any, Final, TypeAlias

from jinja2 import Environment, StrictUndefined

from stickslip_ref import Parameters, coulomb_limit, simplified, simulate, steady_cycle

_LADDERS: Final = {
    "length": "1e3 km, 1 m, 1e-3 mm, 1e-6 µm, 1e-9 nm",
    "velocity": "1 m/s, 1e-3 mm/s, 1e-6 µm/s, 1e-9 nm/s >10, 3.168808781402895e-11 mm/year",
    "mass": "1e3 t, 1 kg, 1e-3 g, 1e-6 mg",
    "stiffness": "1e12 TN/m, 1e9 kN/µm, 1e6 N/µm, 1e3 kN/m >10, 1 N/m, 1e-3 mN/m",
    "damping": "1e12 TN·s/m, 1e9 GN·s/m, 1e6 MN·s/m, 1e3 kN·s/m, 1 N·s/m, 1e-3 mN·s/m",
    "force": "1e12 TN, 1e9 GN, 1e6 MN, 1e3 kN, 1 N, 1e-3 mN, 1e-6 µN",
    "time": "31557600 years >2, 86400 days >2, 3600 h >2, 60 min >2, 1 s, 1e-3 ms, 1e-6 µs"
    ", 1e-9 ns",
    "frequency": "1e6 MHz, 1e3 kHz, 1 Hz, 1e-3 mHz, 1e-6 µHz, 1e-9 nHz",
    "share": "0.01 %",
    "number": "1",
}
"""Size [SI] and symbol of the units of each kind of quantity, falling; behind it from how many on
it is better read than the next smaller one, where that is more than 1."""


def _rung(text: str) -> tuple[float, str, float]:
    size, unit, enough = [*text.split(" "), "", ""][:3]
    return float(size), unit, float(enough.removeprefix(">") or 0.9999)


SCALES: Final = {kind: [*map(_rung, text.split(", "))] for kind, text in _LADDERS.items()}
"""Size [SI] and symbol of the units of each kind of quantity, and from how many on it is used."""


def quantity(value: float, count: int = 4, *, kind: str) -> str:
    """Return a quantity [SI] as a person reads it, such as "6.305 mm", as view/units.js writes it.

    The count is of significant digits; the kind, such as ``"length"``, decides the units.
    ValueError if the value is not finite, as a text must not tell of a cycle that does not exist,
    or if no unit fits, so that it would need an exponent.
    """
    if not math.isfinite(value):
        raise ValueError(f"a text of the page asks for a {kind} that is {value}")
    scales = SCALES[kind]
    if value == 0.0:
        return f"0\u00a0{next((unit for size, unit, _ in scales if size == 1.0), '%')}".strip()
    fitting = (scale for scale in scales if abs(value) >= scale[0] * scale[2])
    size, unit, _ = next(fitting, scales[-1])
    shown = value / size
    if not 1e-3 <= abs(shown) < 1e5:
        raise ValueError(f"a text of the page asks for a {kind} of {value:g}, which no unit fits")
    whole = abs(shown) >= 10**count
    digits = f"{shown:.0f}" if whole else f"{shown:#.{count}g}".rstrip(".")
    return f"{digits}\u00a0{unit}".rstrip("\u00a0").replace("-", "−")


class Numbers:
    """What the reference computes for a setting, by the symbols of docs/theory.md.

    Parameters
    ----------
    setting
        m, g, load, k, c, mu_s, mu_k, v [SI].
    curve
        Speeds [m/s] and coefficients of a friction curve; without it friction is constant.

    Attributes
    ----------
    m, g, load, k, c, mu_s, mu_k, v, N, F_s, F_k, Delta, w, lambda_, zeta : float
        The setting and what follows from it alone [SI]; (2).
    delta_x, spring_drop, t_stick, t_slip, T, f, x_dot_peak, share : float
        The exact cycle [SI], NaN where there is none; (6) to (13).
    simple : SimplifiedCycle
        The cycle as designers write it [SI]; (12).
    F_max : float
        Largest spring force without damping [N], the swing about F_k; (7).
    v_c, v_c_simple : float
        Critical velocity [m/s], exact and to first order; (14). NaN and none under a curve.
    """

    def __init__(
        self, setting: Mapping[str, float], curve: Sequence[Sequence[float]] | None = None
    ) -> None:
        p = Parameters(**setting)
        cycle = steady_cycle(p)
        self.__dict__ |= {**setting, **asdict(cycle)}
        self.share = cycle.t_stick / cycle.T
        self.simple = simplified(p)
        self.N, self.w, self.zeta = p.N, p.w, p.zeta
        self.F_k = p.mu_k * p.N
        self.F_max = self.F_k + p.k * math.hypot(float(p.Delta), p.v / float(p.w))
        self.v_c = coulomb_limit(p)
        if curve is not None:
            self.__dict__ |= _cycle_under(curve, p)
        elif p.c > 0.0:
            damping = 4.0 * math.pi * p.zeta * p.k * p.m
            self.v_c_simple = p.k * p.Delta / damping**0.5


def _cycle_under(curve: Sequence[Sequence[float]], p: Parameters) -> dict[str, float]:
    """Return the numbers of the second cycle under a friction curve, NaN where there is none."""
    own = {"shape": 3.0, "n_points": float(len(curve)), "mu_1": curve[0][1]}
    for number, (u, mu) in enumerate(curve[1:], 2):
        own |= {f"u_{number}": u, f"mu_{number}": mu}
    first = float(p.F_s / (p.k * p.v))
    # A slip takes a swing or so, and a stick is no longer than twice the first load-up.
    stop = 5.0 * first + 12.0 * math.pi / float(p.w)
    run = simulate(p, stop, law="stribeck", own=own)
    names = ("delta_x", "spring_drop", "t_stick", "t_slip", "T", "x_dot_peak")
    found = {name: getattr(run.cycles[-1], name) if run.cycles else math.nan for name in names}
    gone = dict.fromkeys(("Delta", "lambda_", "F_k", "F_max", "v_c"), math.nan)
    return {**found, **gone, "f": 1.0 / found["T"], "share": found["t_stick"] / found["T"]}


def filled(text: str, numbers: Mapping[str, object]) -> str:
    """Fill a text, such as ``"It jumps {{ now.delta_x | length }}."``, a template of Jinja.

    The filters are the kinds of `quantity`; `numbers` are by name, such as ``now``: `Numbers` of a
    setting. UndefinedError if the text asks for a number that there is not; ValueError, which names
    the text, if for one that is not finite.
    """
    if "{" not in text:
        return text
    try:
        return _ENVIRONMENT.from_string(text).render(numbers)
    except ValueError as error:
        raise ValueError(f"{error}: {text}") from error


_ENVIRONMENT: Final = Environment(autoescape=False, undefined=StrictUndefined)
_ENVIRONMENT.filters |= {kind: partial(quantity, kind=kind) for kind in SCALES}
_ENVIRONMENT.filters["percent"] = lambda value: (
    ("+" if value > 0.0 else "") + quantity(value, 3, kind="share")
)


Row: TypeAlias = Mapping[str, Any]
Setting: TypeAlias = Mapping[str, float]


def story(rows: Sequence[Row], start: Setting, applications: Sequence[Row]) -> list[Row]:
    """Return the steps of the story, as story.toml explains them, each with its setting as ``set``.

    A step begins with the `start` values of the FMU [SI], or with those of one of the applications.
    """
    settings = [_complete(row, start, applications) for row in rows]
    steps: list[Row] = []
    for row, now in zip(rows, settings, strict=True):
        known = {"now": now, "tried": {**now, **row.get("tried", {})}}
        if "over" in row:
            known["over"] = settings[row["over"] - 1]
        steps.append({**_filled(row, known, row.get("curve")), "set": now})
    return steps


def sentences(rows: Sequence[Row], start: Setting) -> list[Row]:
    """Return what is often said, as said.toml explains it; `start` as for `story`."""
    found: list[Row] = []
    for row in rows:
        now = {**start, **row["set"]}
        # What the text says of the clamp it says of the values that are asked for.
        now["mu_k"] = min(now["mu_k"], now["mu_s"])
        others = {"before": row.get("before", {}), **row.get("others", {})}
        known = {"now": now} | {name: {**now, **values} for name, values in others.items()}
        found.append(_filled(row, known, row.get("curve")))
    return found


def applications(rows: Sequence[Row], start: Setting) -> list[Row]:
    """Return the applications, as applications.toml explains them; `start` names the parameters."""
    found: list[Row] = []
    for row in rows:
        own = _setting(row, start)
        cures = [
            _filled(cure, {"now": {**own, **cure.get("set", {})}, "over": own})
            for cure in row.get("cures", ())
        ]
        found.append({**_filled(row, {"now": own}), "cures": cures})
    return found


def questions(rows: Sequence[Row], start: Setting, applications: Sequence[Row]) -> list[Row]:
    """Return the questions, as questions.toml explains them; the rest is as for `story`."""
    return [_filled(row, {"now": _complete(row, start, applications)}) for row in rows]


def _complete(row: Row, start: Setting, applications: Sequence[Row]) -> Setting:
    """Return the setting of a row: that of an application or of the start, with its own values."""
    presets = {each["id"]: _setting(each, start) for each in applications}
    own = presets[row["preset"]] if "preset" in row else start
    return {**own, **row.get("set", {})}


def _setting(row: Row, names: Setting) -> Setting:
    return {name: row[name] for name in names}


def _filled(row: Row, settings: Mapping[str, Setting], curve: Any = None) -> dict[str, Any]:
    """Fill the texts of a row, those in its lists and tables of texts too."""
    numbers: dict[str, object] = {
        name: Numbers(setting, curve) for name, setting in settings.items()
    }
    numbers["known"] = row.get("known")

    def fill(value: Any) -> Any:
        if isinstance(value, str):
            return filled(value, numbers)
        if isinstance(value, list):
            return [fill(each) for each in value]
        if isinstance(value, dict):
            return {name: fill(each) for name, each in value.items()}
        return value

    return {name: fill(value) for name, value in row.items() if name != "cures"}
