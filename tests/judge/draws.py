"""Random feed axes as machine tools have them, and their axis files."""

from __future__ import annotations

import json
import math
from itertools import pairwise
from pathlib import Path
from random import Random

from tests.fmu.blocks import log_uniform
from tests.judge.axes import Tables, carries, quantity, radius

LAWS = ("coulomb", "curve", "formula", "curve", "dwell")
"""Curves twice: they alone have plateaus and rises."""
SLOWEST = 1e-4
"""Least speed at which friction falls [m/s]: guideways are not known better."""

FASTEST = 0.5
"""Greatest feed [m/s]."""


def axis(number: int, seed: int = 1) -> Tables:
    draw = Random(f"judge of axes {seed} {number}")
    while True:
        m, w = log_uniform(draw, 50.0, 5e3), 2.0 * math.pi * log_uniform(draw, 20.0, 150.0)
        table: Tables = {"mass": _text(m, "kg"), "stiffness": _text(m * w * w / 1e6, "N/um")}
        zeta = log_uniform(draw, 2e-3, 0.08)
        damping = {"zeta": _text(100.0 * zeta, "%")}, {"c": _text(2.0 * zeta * m * w, "N s/m")}
        drawn = {"axis": table | draw.choice(damping), "friction": {"mu_s": 0.0, "mu_k": 0.0}}
        if number % 2:
            drawn["drive"] = _drive(draw, m, w)
            # A loop that shakes the table without any friction is no axis.
            if radius(drawn) >= 1.0:
                continue
        drawn = _slides(draw, drawn, LAWS[number // 2 % len(LAWS)], m, w)
        if max(map(quantity, drawn["demand"]["feeds"])) < FASTEST:
            return drawn


def _slides(draw: Random, drawn: Tables, law: str, m: float, w: float) -> Tables:
    table, most = drawn["axis"], carries(drawn)
    load = m * 9.81 * (draw.uniform(-0.5, 2.0) if draw.random() < 0.2 else 0.0)
    N = m * 9.81 + load
    table["load"] = _text(load, "N")
    mu_s = log_uniform(draw, 0.02, 0.3)
    mu_k = mu_s * draw.uniform(0.5, 0.97)
    if draw.random() < 0.2:
        table["force_along"] = _text(0.3 * mu_k * N * draw.uniform(-1.0, 1.0), "N")
    # The speed that the gap of friction gives the table in the time 1 / w, the speed where jumps
    # end (docs/theory.md (14)), and the widest fall that is too steep.
    gap = (mu_s - mu_k) * N / (m * w)
    ends, widest = gap / math.sqrt(2.0 * math.pi * most / (m * w)), gap * m * w / most
    widest = max(widest, 2.0 * SLOWEST)
    friction: Tables = {"mu_s": round(mu_s, 5), "mu_k": round(mu_k, 5)}
    feeds = [max(ends * log_uniform(draw, 0.1, 3.0), gap / 60.0) for _ in range(2)]
    if law == "dwell":
        tau = log_uniform(draw, 0.02, 20.0) / w
        friction["tau_s"] = _text(1e3 * tau, "ms")
        if draw.random() < 0.3:
            friction |= {"B": round(mu_s * draw.uniform(0.01, 0.05), 6), "t_0": friction["tau_s"]}
        # Growth ends stick-slip where a stick is too short for it.
        feeds = [feed * min(1.0, 3.0 / (w * tau)) for feed in feeds]
    elif law == "formula":
        v_s = log_uniform(draw, max(0.05 * gap, SLOWEST), widest)
        shapes = {"shape": "hyperbolic"}, {"delta": draw.choice([1.0, 1.5, 2.0, 3.0])}
        friction |= {"law": "stribeck", "v_s": _text(1e3 * v_s, "mm/s"), **draw.choice(shapes)}
        feeds = [max(v_s * log_uniform(draw, 0.1, 4.0), gap / 60.0) for _ in range(2)]
    elif law == "curve":
        curve = _curve(draw, mu_s, mu_k, max(0.1 * gap, SLOWEST), widest)
        friction = {"law": "stribeck", "curve": curve}
        if draw.random() < 0.3:
            friction["mu_s"] = round(mu_s * draw.uniform(1.0, 1.3), 5)
        # Where friction falls, or beside.
        falls = [(u, faster) for (u, mu), (faster, less) in pairwise(curve) if less < mu]
        beside = 1.0, 1.0, 0.6, 1.5
        at = [draw.uniform(*draw.choice(falls)) * draw.choice(beside) for _ in range(2)]
        feeds = [max(1e-3 * feed, gap / 60.0) for feed in at]
    elif draw.random() < 0.2:
        friction = {"F_s": _text(mu_s * N, "N"), "F_k": _text(mu_k * N, "N")}
    demand: Tables = {"feeds": [_text(1e3 * feed, "mm/s") for feed in sorted(feeds)]}
    # Half a second to the feed at most: a slow start shows the motion at lower feeds.
    demand["acceleration"] = _text(max(log_uniform(draw, 0.05, 2.0), 2.0 * max(feeds)), "m/s2")
    return drawn | {"friction": friction, "demand": demand}


def _curve(
    draw: Random, mu_s: float, mu_k: float, slowest: float, widest: float
) -> list[tuple[float, float]]:
    u, apart = log_uniform(draw, slowest, widest), 3.0
    mu = [mu_s] * draw.choice([1, 2, 2, 2])
    if len(mu) == 2 and draw.random() < 0.7:
        # A fall behind a plateau, so fast that swings do not stop the table.
        u, apart = widest * log_uniform(draw, 0.7, 3.0), 1.5
    mu.append(mu_k)
    for low, high in draw.choice([[], [(1.0, 1.0)], [(1.0, 1.6)], [(1.0, 1.6), (0.6, 1.0)]]):
        mu.append(mu[-1] * draw.uniform(low, high))
    speeds = [0.0]
    for _ in mu[1:]:
        speeds.append(float(f"{1e3 * u:.5g}"))
        u *= draw.uniform(1.1, apart)
    return [(speed, round(value, 5)) for speed, value in zip(speeds, mu, strict=True)]


def _drive(draw: Random, m: float, w: float) -> Tables:
    pitch = draw.choice([5.0, 10.0, 16.0, 20.0])
    m_d, bandwidth = m * log_uniform(draw, 0.4, 6.0), log_uniform(draw, 100.0, 800.0)
    inertia, sample = m_d * (pitch / 2e3 / math.pi) ** 2, draw.choice([0.125, 0.25, 0.5, 1.0])
    F = m * 9.81 * log_uniform(draw, 0.02, 0.3)
    gain = {"velocity_gain": _text(bandwidth * inertia, "N m s/rad")}
    drive = {"pitch": _text(pitch, "mm"), "inertia": _text(1e4 * inertia, "kg cm2")}
    drive["K_v"] = _text(bandwidth * draw.uniform(0.05, 0.25), "1/s")
    drive |= draw.choice([{"bandwidth": _text(bandwidth, "1/s")}, gain])
    notch = {"kind": "notch", "damping": 0.7, "leaves": "10 %"}
    filters = notch, {"kind": "low pass"}, {"kind": "low pass", "damping": 0.7}
    integral_time = draw.choice([0.0, draw.uniform(3.0, 9.0) / bandwidth])
    options = {
        "sample_time": _text(sample, "ms"),
        "position": draw.choice(["table", "motor"]),
        "integral_time": _text(1e3 * integral_time, "ms"),
        "current_lag": _text(draw.uniform(0.1, 0.8), "ms"),
        "dead_time": _text(sample * draw.choice([0.3, 0.5, 1.0, 1.5]), "ms"),
        "viscous_friction": _text(m_d * w * draw.uniform(0.0, 0.05), "N s/m"),
        "dry_friction": _text(F * draw.uniform(0.05, 0.5), "N"),
        "velocity_feedforward": round(draw.uniform(0.0, 1.0), 2),
        "friction_feedforward": _text(F * draw.uniform(0.2, 0.8), "N"),
        "limit": _text(m * 9.81 * draw.uniform(2.0, 4.0), "N"),
        "filter": [{**draw.choice(filters), "frequency": _text(draw.uniform(200, 450), "Hz")}],
    }
    return drive | {key: value for key, value in options.items() if draw.random() < 0.3}


def _text(value: float, unit: str) -> str:
    return f"{value:.5g} {unit}"


def write(drawn: Tables, folder: Path) -> Path:
    tables = {name: dict(table) for name, table in drawn.items()}
    if "curve" in tables["friction"]:
        rows = [f"{speed}, {mu}\n" for speed, mu in tables["friction"]["curve"]]
        (folder / "curve.csv").write_text("speed [mm/s], mu\n" + "".join(rows), encoding="utf-8")
        tables["friction"]["curve"] = "curve.csv"
    filters = tables.get("drive", {}).pop("filter", [])
    sections = [(f"[{name}]", table) for name, table in tables.items()]
    sections += [("[[drive.filter]]", one) for one in filters]
    path = folder / "axis.toml"
    lines: list[str] = []
    for head, table in sections:
        # JSON writes numbers, texts and lists of them as TOML does.
        lines += [head, *(f"{key} = {json.dumps(value)}" for key, value in table.items())]
    path.write_text("\n".join([*lines, ""]), encoding="utf-8")
    return path
