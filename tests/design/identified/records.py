"""Records of axes whose numbers are known: three kinds, three levels of noise, both drives.

Of the identification they take the types alone. The block on a rigid drive is `stickslip_ref`'s,
a servo is solved in `loops`, other motions on a rigid drive are prescribed.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy.signal import lfilter

from stickslip_design.axis import Axis, Drive, Friction
from stickslip_design.identify.model import Kind, Record
from stickslip_design.loop.stability import is_stable
from stickslip_ref import Change, critical_lambda, simulate
from tests.design.identified.loops import Array, loops

KINDS: Final[tuple[Kind, ...]] = ("steady runs", "stick-slip", "excitation")
FORCE: Final = (0.003, 0.01, 0.05)
"""Levels of the noise of the force: its standard deviation over the range of the force."""
POSITION: Final = {"stick-slip": 1e-5, "steady runs": 1e-7, "excitation": 1e-7}
"""The least noise of the position, likewise; where the speed comes from it, that of an encoder."""
_N: Final = 16_000
"""Samples of a controller in a record."""

Sizes = Mapping[str, float]
Errors = Callable[[Sizes], Sizes]
"""From the noise of each column the least standard errors of numbers, after Cramér and Rao."""
Plan = tuple[Axis, float, Array, float]
"""An axis, its feed [m/s], times [s] and when it starts [s]."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """A record, and the truth."""

    record: Record
    stated: Axis | None
    """The axis as it is stated: table and friction of a servo are off by some 20 %."""
    truth: Sizes
    """Numbers by name, SI."""
    white: bool
    """Whether its noise is white, and no column is counted."""
    errors: Errors
    noise: Sizes

    def bounds(self) -> Sizes:
        """Return the least standard errors of the numbers."""
        return self.errors(self.noise)


def moved(t: Array, changes: Iterable[tuple[float, float, float]]) -> Array:
    """Return position, speed and acceleration of smooth changes of speed: begin, length, by."""
    x, v, a = np.zeros((3, len(t)))
    for begin, length, by in changes:
        s = np.clip((t - begin) / length, 0.0, 1.0)
        a += by / length * 6.0 * s * (1.0 - s)
        v += by * s**2 * (3.0 - 2.0 * s)
        x += by * (length * (s**3 - 0.5 * s**4) + np.maximum(t - begin - length, 0.0))
    return np.array([x, v, a])


def trips(t: Array, v: Array, part: float, ramp: float) -> Array:
    """Return the motion at one speed after the other, each for a part of the time [s]."""
    by = np.diff([0.0, *v, 0.0])
    return moved(t, [(part * (n + 0.05), ramp, change) for n, change in enumerate(by)])


def truth_of(axis: Axis, back: float, kind: Kind) -> dict[str, float]:
    """Return all numbers by name that a record of this kind may tell."""
    c, rubs = 0.5 * (axis.c + back), axis.friction
    truth = {
        "axis.mass": axis.m, "axis.c": c, "c forward": axis.c, "c backward": back,
        "c/m": c / axis.m, "friction.F_k": axis.F_k, "friction.mu_k": rubs.mu_k,
        "axis.force_along": axis.along,
    }  # fmt: skip
    if kind == "stick-slip":
        truth |= {"axis.stiffness": axis.k, "k/m": axis.k / axis.m, "friction.F_s": axis.F_s}
        truth |= {"friction.mu_s": rubs.mu_s, "F_s - F_k": axis.F_s - axis.F_k}
        truth["gap"] = truth["F_s - F_k"] / axis.k
    return truth


def cases(kind: Kind, level: int, servo: bool, count: int) -> list[Case]:
    """Return the records of a cell; a smaller count is the begin of a larger one."""
    rng = np.random.default_rng([36, KINDS.index(kind), level, servo])
    make, made = _jumping if kind == "stick-slip" else _moving, list[Case]()
    while len(made) < count:
        made += make(rng, kind, level, servo)
    return made[:count]


def _log(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def drawn(rng: np.random.Generator, kind: Kind, servo: bool) -> Axis:
    """Return a random axis; the loop of a servo is stable, with twice its K_v too."""
    m, jumps = _log(rng, 10.0, 2000.0), kind == "stick-slip"
    w = 2.0 * math.pi * (_log(rng, 5.0, 50.0) if jumps else _log(rng, 25.0, 150.0))
    mu_s = _log(rng, 0.05, 0.4) if jumps else _log(rng, 0.005, 0.1)
    mu_k = mu_s * (rng.uniform(0.4, 0.9) if jumps else 1.0)
    axis = Axis(
        name="drawn", m=m, k=m * w * w, c=2.0 * m * w * _log(rng, 0.005, 0.08),
        friction=Friction(mu_s=mu_s, mu_k=mu_k),
        along=0.0 if jumps else mu_k * m * Axis.g * rng.uniform(-0.3, 0.3),
    )  # fmt: skip
    while servo:
        bandwidth, T_s = _log(rng, 80.0, 500.0), 2.5e-4 * rng.choice([1.0, 2.0])
        drive = Drive(
            inertia=m * _log(rng, 0.3, 5.0), K_v=_log(rng, 10.0, 60.0), bandwidth=bandwidth,
            T_n=_log(rng, 4.0, 16.0) / bandwidth, lag=_log(rng, 2e-4, 1e-3),
            T_s=T_s if kind != "steady runs" else 4.0 * T_s, on_table=bool(rng.random() < 0.5),
        )  # fmt: skip
        if is_stable(replace(axis, drive=replace(drive, K_v=2.0 * drive.K_v))):
            return replace(axis, drive=drive)
    return axis


def _moving(rng: np.random.Generator, kind: Kind, level: int, servo: bool) -> list[Case]:
    """Draw 16 steady runs or excitations; the directions of half of them differ."""
    plans = list[tuple[Axis, float, Array, Array]]()
    for _ in range(16):
        axis = drawn(rng, kind, servo)
        t = np.arange(_N) * (axis.drive.T_s if axis.drive else 5e-4 * rng.choice([1, 2]))
        part = t[-1] / (14.2 if kind == "steady runs" else 8.2)
        ramp = part * rng.uniform(0.4, 0.9)
        top = _log(rng, 1.0, 8.0) * axis.friction.mu_k * Axis.g * ramp / 1.5
        if kind == "steady runs":
            # The controller takes its force from one side to the other in a part of each run.
            loop = axis.drive.K_p * axis.drive.K_v if axis.drive else 15e3 * axis.m
            feeds = 15.0 * axis.F_k / loop / part * np.geomspace(1.0, _log(rng, 5.0, 20.0), 7)
            motion = trips(t, np.ravel([feeds, -feeds], order="F"), part, 0.1 * part)
        elif rng.random() < 0.5:
            v = rng.uniform(0.3, 1.0, 8) * np.resize([1.0, -1.0], 8)
            motion = trips(t, top * v, part, ramp)
        else:
            w = 2.0 * math.pi * rng.choice(np.arange(2, 20), 5, replace=False) / t[-1]
            phase, size = np.outer(w, t), top * rng.uniform(0.5, 1.0, 5) / w * w.min()
            x, a = (size / w) @ (1.0 - np.cos(phase)), (size * w) @ np.cos(phase)
            motion = np.array([x, size @ np.sin(phase), a])
        c = _log(rng, 0.2, 2.0) * axis.F_k / np.abs(motion[1]).max()
        back = c * (_log(rng, 0.5, 2.0) if rng.random() < 0.5 else 1.0)
        plans.append((replace(axis, c=c), back, t, motion))
    axes, backs, times, motions = zip(*plans, strict=True)
    x, v, a = np.stack(motions, axis=1)
    if servo:
        motor, table, v, force = loops(axes, np.array(backs), x, v)
        a = np.gradient(v, axis=1) / np.diff(times, axis=1)[:, :1]
    made = []
    for n, (axis, back, t, _) in enumerate(plans):
        if axis.drive:
            seen, pull = (table if axis.drive.on_table else motor)[n], force[n]
        else:
            # A table at rest is taken to be held by half its friction.
            dry = axis.F_k * np.where(v[n] == 0.0, 0.5, np.sign(v[n])) - axis.along
            seen, pull = x[n], axis.m * a[n] + np.where(v[n] > 0.0, axis.c, back) * v[n] + dry
        if np.abs(seen).max() > 2.0 * np.ptp(x[n]):
            # Some loops swing up under friction that differs by direction: no record.
            continue
        rows = np.arange(0, _N, rng.choice([1, 2, 4] if t[1] < 2e-3 else [1, 2]))
        columns = {"command": x[n][rows], "position": seen[rows], "force": pull[rows]}
        errors = _errors_of_lines(kind, t[rows], v[n][rows], a[n][rows], back == axis.c)
        made.append(_measured(rng, kind, level, axis, back, t[rows], columns, errors))
    return made


def _errors_of_lines(kind: Kind, t: Array, v: Array, a: Array, alike: bool) -> Errors:
    """Of the force over a motion that is known, in the even parts of steady runs.

    Each direction has its own slope, as only what survives that is called a force along the way.
    """
    used = np.abs(v) > 0.02 * np.abs(v).max()
    by = {"c forward": v.clip(0.0), "c backward": v.clip(None, 0.0), "friction.F_k": np.sign(v)}
    by |= {"axis.force_along": -np.ones(len(v))}
    if kind == "steady runs":
        used &= (t * 14.2 / t[-1] % 1.0 > 0.4) & (t < t[-1] * 14.0 / 14.2)
    else:
        by["axis.mass"] = a
    X = np.array(list(by.values()))[:, used]
    covariance = np.linalg.inv(X @ X.T)
    least = dict(zip(by, np.sqrt(np.diag(covariance)), strict=True))
    if alike:
        least["axis.c"] = 0.5 * math.sqrt(covariance[:2, :2].sum())
    return lambda noise: {name: noise["force"] * each for name, each in least.items()}


def _jumping(rng: np.random.Generator, kind: Kind, level: int, servo: bool) -> list[Case]:
    """Draw up to 16 records of stick-slip at one feed, of 6 cycles or more."""
    plans = list[Plan]()
    for _ in range(16):
        axis, begin = drawn(rng, kind, servo), rng.uniform(0.1, 0.4)
        w, gap = math.sqrt(axis.k / axis.m), (axis.F_s - axis.F_k) / axis.k
        limit = float(critical_lambda(axis.c / (2.0 * axis.m * w)))
        feed = w * gap / limit / _log(rng, 1.5, 12.0)
        dt = float(np.clip(math.pi / w / rng.uniform(10.0, 40.0), 2.5e-4, 4e-3))
        end = begin + axis.F_s / axis.k / feed
        end += rng.uniform(8.0, 15.0) * (2.0 * gap / feed + 4.0 / w)
        if axis.drive:
            dt, end = axis.drive.T_s, _N * axis.drive.T_s
            feed = 2.0 * gap * rng.uniform(15.0, 30.0) / end
        plans.append((axis, feed, np.arange(0.0, end, dt), begin))
    made = []
    for plan, run in zip(plans, _runs(plans), strict=True):
        axis, _, t, begin = plan
        rests = np.diff(run["table"], prepend=0.0) == 0.0
        starts = t[1:][rests[:-1] & ~rests[1:] & (t[1:] > begin)]
        step, seen = rng.choice([1, 2, 4]) if servo else 1, rng.integers(2 if servo else 3)
        # Few of a servo's cycles do not settle: nothing can be told of such a motion by its model.
        if len(starts) < 8 or np.ptp(cycles := np.diff(starts)[-4:]) > 0.02 * cycles.mean():
            continue
        # Half of them are cut out of the motion, where no column knows its zero but the force.
        cut = float(rng.uniform(starts[1], starts[2])) if rng.random() < 0.5 else 0.0
        rows = np.flatnonzero(t >= cut)[::step]
        names = [["position"], ["position", "force"], ["force"]][seen]
        columns = {name: run[name][rows] for name in ("command", *names)}
        if cut:
            columns |= {n: columns[n] - columns[n][0] for n in columns if n != "force"}
        errors = _errors_of_runs(plan, rows)
        made.append(_measured(rng, kind, level, axis, axis.c, t[rows], columns, errors))
    return made


def _runs(
    plans: Sequence[Plan], struck: int = -1, by: Array | float = 0.0
) -> list[dict[str, Array]]:
    """Return the columns of each, without noise; servos struck as in `loops`."""
    if not plans[0][0].drive:
        runs = [
            simulate(
                axis.block(0.0), float(t[-1]), times=t, changes=[Change(begin, {"v": feed})],
                rtol=1e-12,
            )
            for axis, feed, t, begin in plans
        ]  # fmt: skip
        columns = [(run.x_pull, run.x, run.x, run.F) for run in runs]
    else:
        motions = [moved(t, [(begin, 0.05, feed)]) for _, feed, t, begin in plans]
        x, v, _ = np.stack(motions, axis=1)
        axes = [axis for axis, *_ in plans]
        back = np.array([axis.c for axis in axes])
        motor, table, _, force = loops(axes, back, x, v, struck=struck, by=by)
        on_table = np.array([[axis.drive is not None and axis.drive.on_table] for axis in axes])
        columns = list(zip(x, table, np.where(on_table, table, motor), force, strict=True))
    names = ("command", "table", "position", "force")
    return [dict(zip(names, each, strict=True)) for each in columns]


def _errors_of_runs(plan: Plan, rows: Array) -> Errors:
    """By central differences of runs; where one starts in position, and if cut in time, is unknown.

    Of a servo, how its motor and command stand there, too: from the record alone nobody knows it.
    """
    (axis, feed, t, begin), h = plan, 1e-6

    def varied(name: str, by: float) -> Axis:
        rubs = axis.friction
        if name in ("m", "k", "c"):
            return replace(axis, **{name: by * getattr(axis, name)})
        return replace(axis, friction=replace(rubs, **{name: by * getattr(rubs, name)}))

    def errors(noise: Sizes) -> Sizes:
        names = ("m", "k", "c", "mu_s", "mu_k")
        sides = [varied(name, 1.0 + by) for name in names for by in (h, -h)]
        force = axis.F_s - axis.F_k
        gap = force / axis.k
        sizes = np.diag([gap, feed, force, force, gap]) * (axis.drive is not None)
        blows = h * np.concatenate([sizes, -sizes])
        every = [*sides, axis, *[axis] * len(blows)]
        by = np.concatenate([np.zeros((len(sides) + 1, 5)), blows])
        runs = _runs([(each, feed, t, begin) for each in every], int(rows[0]), by)
        columns = []
        for name, size in noise.items():
            y, struck = np.split(np.array([run[name] for run in runs]), [len(sides) + 1])
            shifted = [
                np.gradient(y[-1], t) * (rows[0] > 0),
                np.full(len(t), float(name == "position")),
            ]
            moved = (struck[:5] - struck[5:]) / (2.0 * h)
            by = np.array([*(y[:-1:2] - y[1::2]) / (2.0 * h), *shifted, *moved])
            columns.append(by[:, rows] / size)
        J = np.concatenate(columns, axis=1)
        scale = np.linalg.norm(J, axis=1) + 1e-300
        u, s, _ = np.linalg.svd(J / scale[:, None], full_matrices=False)
        truths, least = [truth_of(each, each.c, "stick-slip") for each in (*sides, axis)], {}
        for name, value in truths[-1].items():
            own = np.array([truth[name] for truth in truths[:-1]])
            part = u.T @ (np.append((own[::2] - own[1::2]) / (2.0 * h), np.zeros(7)) / scale)
            part, lost = part[s > 1e-6 * s[0]] / s[s > 1e-6 * s[0]], part[s <= 1e-6 * s[0]]
            # What a direction changes that the columns do not show cannot be told.
            if value and np.abs(lost).max(initial=0.0) < 1e-6 * np.linalg.norm(part):
                least[name] = float(np.linalg.norm(part))
        return least

    return errors


def _measured(
    rng: np.random.Generator, kind: Kind, level: int, axis: Axis, back: float, t: Array,
    columns: Mapping[str, Array], errors: Errors,
) -> Case:  # fmt: skip
    """Put noise on columns: half of the middle level coloured, positions of a third counted."""
    coloured, counted = level == 1 and rng.random() < 0.5, rng.random() < 1.0 / 3.0
    a = math.exp(-(t[1] - t[0]) / 5e-3) if coloured else 0.0
    levels = {"position": POSITION[kind] * 10.0**level, "force": FORCE[level]}
    noise = {n: levels[n] * float(np.ptp(columns[n])) for n in levels if n in columns}
    seen, rounding = dict(columns), {}
    for name, size in noise.items():
        seen[name] = columns[name] + lfilter(
            [math.sqrt(1.0 - a * a)], [1.0, -a], rng.normal(0.0, size, len(t))
        )
    if counted and "position" in noise:
        rounding["position"] = half = noise["position"]
        seen["position"] = np.round(seen["position"] / (2.0 * half)) * 2.0 * half
    stated = axis
    if axis.drive:
        off = np.exp(rng.normal(0.0, 0.2, 4))
        mu_k = axis.friction.mu_k * off[0]
        rubs = Friction(mu_k=mu_k, mu_s=max(mu_k, axis.friction.mu_s * off[3]))
        stated = replace(axis, m=axis.m * off[1], k=axis.k * off[2], friction=rubs)
    record = Record(
        t=t - t[0], command=seen["command"], position=seen.get("position"),
        force=seen.get("force"), rounding=rounding,
    )  # fmt: skip
    return Case(
        record=record, stated=stated if axis.drive else None, errors=errors, noise=noise,
        truth=truth_of(axis, back, kind), white=not (coloured or rounding),
    )  # fmt: skip
