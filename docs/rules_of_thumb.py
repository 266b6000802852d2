"""Rules of thumb of designers against the exact solution: claims.md and its pictures.

`docs/generate.py` writes them; claims.md.in has the text of the page. Every rule is tried on the
block of the start values, as far as its function does not vary it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from stickslip_ref import Parameters, coulomb_limit, simplified, steady_cycle
from stickslip_verification import truth
from stickslip_verification.model.quantities import FORMULAS
from stickslip_verification.report.svg import BASE, as_svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]
Values = dict[Any, str]
"""What the text of the page takes of a rule: figures by name, thresholds by their level."""

BLOCK: Any = Parameters()
LEVELS = (10, 5, 1)
"""Deviations asked for [%]."""

# Told apart by the colour-blind too: M. Okabe and K. Ito, Color Universal Design, 2008.
PALETTE = ("#0072B2", "#D55E00", "#009E73")
GREY = "#666666"
STYLE: Any = BASE | {
    "axes.edgecolor": GREY,
    "axes.grid": True,
    "axes.grid.which": "major",
    "axes.labelcolor": "black",
    "axes.labelsize": 9.0,
    "axes.linewidth": 0.8,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlesize": 9.0,
    "axes.titlelocation": "left",
    "figure.facecolor": "white",
    "font.size": 9.0,
    "grid.color": "#E4E4E4",
    "grid.linewidth": 0.8,
    "legend.frameon": False,
    "lines.linewidth": 1.8,
    "lines.solid_capstyle": "round",
    "xtick.color": GREY,
    "xtick.labelcolor": "black",
    "ytick.color": GREY,
    "ytick.labelcolor": "black",
}
POINTS = {"linestyle": "none", "marker": "o", "clip_on": False}
LARGE = {"markersize": 6.0, "markeredgewidth": 1.2, "markeredgecolor": "white"} | POINTS
SMALL = {"markersize": 2.6, "markeredgewidth": 0.0, "markeredgecolor": "white"} | POINTS
DASHED = {"linestyle": (0, (4, 2))}
LINE = {"linestyle": "-"}


def pages() -> dict[str, str]:
    """Return the texts of claims.md and of claims/*.svg by their names inside docs/."""
    import matplotlib
    from matplotlib.figure import Figure

    text = Path(__file__).with_name("claims.md.in").read_text(encoding="utf-8")
    values, pictures = {}, {}
    with matplotlib.rc_context(STYLE):
        for name, (title, rule, rows, columns) in RULES.items():
            # Inches; 7 in are 504 pt in SVG, which is 672 px on a page.
            height = 3.4 if columns == 1 else 2.9 * rows
            picture = Figure(figsize=(7.0, height), layout="constrained")
            axes = picture.subplots(rows, columns, squeeze=False).ravel()
            values[name] = rule(*axes)
            pictures[f"claims/{name}.svg"] = as_svg(picture, Title=title)
    return {"claims.md": text.format_map(values)} | pictures


def jump(of_lambda: Axes, of_speed: Axes) -> Values:
    """Try the jump of the designers' formula, (12), against the real one, (10)."""
    lambdas, stiffness = geometric(0.1, 1000.0, 121), (1000.0, 3000.0, 10000.0)
    speeds = geometric(0.0001, 0.1, 91)
    least = thresholds(short_jump)
    short_by = ("formula short of the jump  [%]", 0.1, 100.0, (0.1, 1, 5, 10, 100))
    scales(of_lambda, ("λ = w Δ / v", 0.1, 1000.0), short_by)
    line(of_lambda, "any undamped block", lambdas, 100 * short_jump(lambdas), at=(4.5, 45))
    for level, at in least.items():
        points(of_lambda, f"λ = {figure(at)}", [at], [level], at=(1.3 * at, level))
    title = f"m = {BLOCK.m:g} kg, μₛ − μₖ = {BLOCK.mu_s - BLOCK.mu_k:g}"
    scales(of_speed, ("pulling velocity  [mm/s]", 0.1, 100.0), short_by, title)
    for k, colour, y in zip(stiffness, PALETTE, (0.7, 1.2, 2.1), strict=True):
        short = 100 * short_jump(speed_at(speeds, k))
        line(of_speed, f"k = {k:g} N/m", 1000 * speeds, short, colour, at=(7, y))
    rows = [
        (
            f"{level} %",
            f"λ ≥ {figure(at)}",
            *(f"v ≤ {millimetres(speed_at(at, k))}/s" for k in stiffness),
        )
        for level, at in least.items()
    ]
    return shown(least) | {
        "rows": table(rows),
        "at 1": percent(1 - short_jump(1.0)),
        "lambda": figure(BLOCK.lambda_),
        "formula": millimetres(simplified(BLOCK).delta_x, 4),
        "exact": millimetres(steady_cycle(BLOCK).delta_x, 4),
    }


def gap(on: Axes) -> Values:
    """Try what doubling the friction gap does to the jump, (7) and (10)."""
    told, speeds = np.array([0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1]), geometric(1e-4, 1.0, 121)
    factors = growth(speed_at(told, BLOCK.k))
    y = ("jump with twice the gap / jump", 0.95, 2.1, (1, 1.25, 1.5, 1.75, 2))
    scales(on, ("pulling velocity  [mm/s]", 0.1, 1000.0), y)
    for k, colour, at in ((1000.0, PALETTE[0], (45, 1.4)), (10000.0, PALETTE[1], (1.4, 1.5))):
        line(on, f"k = {k:g} N/m", 1000 * speeds, growth(speed_at(speeds, k)), colour, at)
    points(on, "the speeds of the table", 1000 * told, factors)
    line(on, "twice, as told", (0.1, 1000.0), (2.0, 2.0), GREY, (30, 2.02), DASHED)
    one = steady_cycle(replace(BLOCK, v=told))
    two = steady_cycle(replace(BLOCK, v=told, mu_s=2 * BLOCK.mu_s - BLOCK.mu_k))
    columns: tuple[Any, ...] = (
        told,
        one.delta_x,
        two.delta_x,
        factors,
        two.spring_drop / one.spring_drop,
    )
    rows = [
        (f"{1000 * v:g}", millimetres(a), millimetres(b), figure(factor), figure(relief))
        for v, a, b, factor, relief in zip(*columns, strict=True)
    ]
    of_gap = shown(thresholds(lambda lambda_: 1 - growth(lambda_) / 2))
    return of_gap | {"rows": table(rows), "slow": figure(factors[0]), "fast": figure(factors[-1])}


def slip_time(on: Axes) -> Values:
    """Try the slip time of the designers' formula, (12), against the exact one, (8)."""
    lambdas = geometric(0.1, 1000.0, 121)
    least = thresholds(lambda lambda_: 1 - 1 / lasting(lambda_))
    y = ("slip time / half a period", 0.9, 2.1, (1.0, 1.25, 1.5, 1.75, 2.0))
    scales(on, ("λ = w Δ / v", 0.1, 1000.0), y)
    line(on, "exact", lambdas, lasting(lambdas), at=(0.9, 1.62))
    line(on, "half a period, as told", (0.1, 1000.0), (1, 1), GREY, (0.13, 1.03), DASHED)
    for level, at in least.items():
        factor = 1 / (1 - 0.01 * level)
        points(on, f"{level} % short", [at], [factor], at=(at, factor + 0.03))
    rows = [
        (f"{level} %", f"λ ≥ {figure(at)}", f"v ≤ {millimetres(speed_at(at, BLOCK.k))}/s")
        for level, at in least.items()
    ]
    ends = {"at 1": figure(lasting(1.0)), "at 0.1": figure(lasting(0.1))}
    return shown(least) | ends | {"rows": table(rows)}


def stick_time(on: Axes) -> Values:
    """Try the stick time of the designers' formula against first load-up and cycle, (6), (9)."""
    ratios, speeds = (0.0, 0.25, 0.5, 0.6, 0.8, 0.9), (0.002, 0.02, 0.2)
    at = [ratio for ratio in ratios for _ in speeds]
    first, cycle = np.array([sticks(ratio, v) for ratio in ratios for v in speeds]).T
    curve = 1 - geometric(0.001, 0.99, 121)[::-1]
    y = ("formula / stick time", 0.4, 20.0, (0.5, 1, 2, 5, 10, 20))
    scales(on, ("μₖ / μₛ", 0.0, 1.0, (0, 0.25, 0.5, 0.75, 1)), y)
    line(on, "stick in the cycle", curve, load_up_over_stick(curve), at=(0.5, 1.9))
    line(on, "first load-up", (0, 1), (1, 1), PALETTE[1], (0.03, 1.08))
    points(on, "cycle, exact runs at each speed", at, cycle)
    points(on, "first load-up, exact runs at each speed", at, first, PALETTE[1])
    each = slice(None, None, len(speeds))
    # All speeds give the same, to more digits than a figure has.
    assert np.ptp(cycle.reshape(-1, len(speeds)).astype(float), axis=1).max() < 1e-14
    rows = [
        (f"{ratio:g}", figure(one), figure(other))
        for ratio, one, other in zip(ratios, first[each], cycle[each], strict=True)
    ]
    # mu_s/(2 (mu_s - mu_k)) = 1 -+ a tenth, solved for mu_k/mu_s.
    low, high = (1 - 1 / (2 * (1 + side * 0.01 * LEVELS[0])) for side in (-1, 1))
    return {
        "rows": table(rows),
        # The runs carry fifty digits; ten of them are more than two arcs can lose.
        "first": "exact" if max(abs(first - 1)) < 1e-40 else "off",
        "most": figure(max(*cycle, *(1 / cycle)), 2),
        "default": figure(load_up_over_stick(BLOCK.mu_k / BLOCK.mu_s)),
        "last": figure(cycle[-1]),
        "low": figure(low),
        "high": figure(high),
    }


def critical(speed: Axes, high: Axes) -> Values:
    """Try the familiar formula of the critical velocity, (14), against the exact one, (13)."""
    zetas, told = geometric(0.0003, 0.7, 121), (0.001, 0.003, 0.01, 0.03, 0.1, 0.2, 0.3, 0.5)
    most = thresholds(excess, 0.0003, 0.7)
    x = ("damping ratio ζ", 0.0003, 0.7)
    title = f"m = {BLOCK.m:g} kg, k = {BLOCK.k:g} N/m, μₛ − μₖ = {BLOCK.mu_s - BLOCK.mu_k:g}"
    scales(speed, x, ("critical velocity  [mm/s]", 1.0, 1000.0), title)
    line(speed, "familiar formula", zetas, 1000 * familiar(zetas), PALETTE[1], (0.025, 170), DASHED)
    line(speed, "exact", zetas, 1000 * damped_limit(zetas), at=(0.05, 18))
    scales(high, x, ("formula above exact  [%]", 0.1, 1000.0, (0.1, 1, 5, 10, 100, 1000)))
    line(high, "any damped block", zetas, 100 * excess(zetas), at=(0.0005, 25))
    for level, at in sorted(most.items()):
        points(high, f"ζ = {figure(at, 2)}", [at], [level], at=(1.4 * at, 0.7 * level))
    # Where percents get out of hand, as a factor.
    above = {
        zeta: percent(off) if off < 1 else f"a factor of {figure(1 + off, 2)}"
        for zeta, off in ((zeta, excess(zeta)) for zeta in told)
    }
    rows = [
        (
            f"{zeta:g}",
            f"{millimetres(familiar(zeta))}/s",
            f"{millimetres(damped_limit(zeta))}/s",
            above[zeta],
        )
        for zeta in told
    ]
    factor = figure(1 + excess(0.5), 2)
    ends = {"at 0.01": above[0.01], "at 0.1": above[0.1], "at 0.5": factor}
    return shown(most, 2) | ends | {"rows": table(rows)}


QUANTITIES = {
    "break_away": "first break-away",
    "T": "period",
    "delta_x": "jump",
    "t_slip": "slip time",
    "t_stick": "stick time",
}


def fixed_step(*axes: Axes) -> Values:
    """Try a fixed step of 1 ms against the exact events, (6), (8), (9) and (10)."""
    h, speeds = 1e-3, geometric(0.001, 0.1, 25)
    stiffness = geometric(1000.0, 10000.0, 10)
    k, v = (each.ravel() for each in np.meshgrid(stiffness, speeds, indexing="ij"))
    main, fine = (errors(replace(BLOCK, k=k, v=v, mu_k=mu_k), h) for mu_k in (0.3, 0.48))
    x = ("pulling velocity  [mm/s]", 1.0, 100.0)
    y = ("largest error  [%]", 0.01, 100.0, (0.01, 0.1, 1, 10, 100))
    classes = {
        f"k = {few[0]:.0f} … {few[-1]:.0f} N/m": (colour, np.isin(k, few))
        for colour, few in zip(PALETTE, np.array_split(stiffness, 3), strict=True)
    }
    for on, (name, words) in zip(axes, QUANTITIES.items(), strict=False):
        scales(on, x, y, words)
        for of_class, (colour, here) in classes.items():
            off = np.clip(100 * main[name][here], 0.01, 100.0)
            points(on, of_class, 1000 * v[here], off, colour, style=SMALL)
        # Both are stretches of constant pull, so that a step of error is in proportion to v.
        if name in ("break_away", "t_stick"):
            ends = np.array([0.001, 0.1])
            share = 100 * h / exact(replace(BLOCK, k=k.max(), v=ends))[name]
            words = f"one step, k = {k.max():.0f} N/m"
            line(on, words, 1000 * ends, share, GREY, (1.15, 6.0), DASHED)
    marks: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 6.0}
    lines = [axes[-1].plot([], [], color=colour, **marks)[0] for colour, _ in classes.values()]
    axes[-1].set_axis_off()
    axes[-1].legend(lines, list(classes), loc="center left")
    rows = [
        (words, *(percent(of(each[name])) for each in (main, fine) for of in (np.median, np.max)))
        for name, words in QUANTITIES.items()
    ]
    for name in ("missed", "invented"):
        counts = [f"{each[name].sum()} of {k.size}" for each in (main, fine)]
        rows.append((f"sticks {name}", "", counts[0], "", counts[1]))
    every = np.max([main[name] for name in QUANTITIES], axis=0)
    most: Values = {name: percent(np.max(main[name])) for name in QUANTITIES}
    counted: Values = {level: str(np.count_nonzero(every <= 0.01 * level)) for level in LEVELS}
    return (
        most
        | counted
        | {
            "rows": table(rows),
            "t_stick of the small gap": percent(np.max(fine["t_stick"])),
            "missed": str(fine["missed"].sum()),
        }
    )


RULES: dict[str, tuple[str, Callable[..., Values], int, int]] = {
    "jump": ("The jump", jump, 1, 2),
    "gap": ("Twice the gap, twice the jump", gap, 1, 1),
    "slip_time": ("The slip time", slip_time, 1, 1),
    "stick_time": ("The stick time", stick_time, 1, 1),
    "critical": ("The critical velocity", critical, 1, 2),
    "fixed_step": ("A fixed step of 1 ms", fixed_step, 3, 2),
}
"""The title of each rule's picture, what tries it, and rows and columns of its picture."""


CYCLES = 5
"""Cycles looked at in each run of the script."""


def errors(p: Any, h: float) -> dict[str, Any]:
    """March every block with the step `h` [s] and hold it against the exact events.

    Returns
    -------
    dict
        The largest relative error of each quantity over the cycles, infinite where one of them
        never came; "missed", whether a stick was passed over: a slip outlasts a period of the free
        oscillation, or the stick between two has no length; "invented": a slip ends within half a
        period. Shape (blocks,).
    """
    of_exact, half_period, count = exact(p), np.pi / p.w, p.k.size
    off: dict[str, Any] = {name: np.empty(count) for name in QUANTITIES}
    missed, invented = np.full((2, count), False)
    # Twice as long as the cycles take exactly: a script may pass over a stick now and then.
    longest = 2 * (of_exact["break_away"] + (CYCLES + 1) * (of_exact["T"] + 2 * h))
    for block, (k, v) in enumerate(zip(p.k, p.v, strict=True)):
        run = march(replace(p, k=k, v=v), h, CYCLES, longest[block])
        slips = run.values["t_slip"]
        for name, values in run.values.items():
            ratios = [abs(each / of_exact[name][block] - 1) for each in values]
            off[name][block] = max(ratios) if len(run.values["T"]) == CYCLES else math.inf
        # A slip lasts between half a period and a whole one, docs/theory.md (8), and each of its
        # ends is seen at most a step late.
        short = len(run.values["T"]) < CYCLES or run.skipped > 0
        missed[block] = short or max(slips) > 2 * half_period[block] + h
        invented[block] = min(slips) < half_period[block] - h
    return off | {"missed": missed, "invented": invented}


class Marched(NamedTuple):
    """What a script reads off its run, by the names of `QUANTITIES`; a list over the cycles.

    `skipped` counts sticks without length: at the end of the step in which the mass stopped, the
    spring was beyond break-away already.
    """

    values: dict[str, list[float]]
    skipped: int


def march(p: Parameters, h: float, cycles: int, longest: float) -> Marched:
    """March a block from a relaxed spring at rest, as a script does, till it has shown its cycles.

    A step moves the pulled end by ``v h``. A mass in slip goes on by velocity Verlet. Then, at the
    end of the step: a velocity that has reached zero or changed its sign is set to zero, and a
    mass at rest sticks if ``|k z| <= mu_s m g``, else slips in the direction of ``k z``.

    Parameters
    ----------
    p
        The block, its v above 0; only m, g, k, mu_s, mu_k and v count.
    h
        The step [s].
    cycles
        How many cycles are looked at, from the first break-away on.
    longest
        Time after which the run is given up [s].
    """
    m, k, v = float(p.m), float(p.k), float(p.v)
    F_s, F_k = (float(mu) * m * float(p.g) for mu in (p.mu_s, p.mu_k))
    x = x_dot = a = s = 0.0
    starts: list[tuple[float, float]] = []
    ends: list[tuple[float, float]] = []
    step = skipped = 0
    while len(starts) <= cycles and step * h < longest:
        step += 1
        x += (x_dot + 0.5 * h * a) * h
        force = k * (v * (step * h) - x)
        new_a = (force - s * F_k) / m if s else 0.0
        x_dot += 0.5 * h * (a + new_a)
        a = new_a
        if s * x_dot > 0.0:
            continue
        breaks = abs(force) > F_s
        if s:
            ends.append((step * h, x))
            skipped += breaks
            x_dot = a = s = 0.0
        if breaks:
            starts.append((step * h, x))
            s = math.copysign(1.0, force)
            a = (force - s * F_k) / m
    pairs = list(zip(starts, ends, starts[1:], strict=False))
    values = {
        "break_away": [starts[0][0]] if starts else [math.inf],
        "T": [following[0] - start[0] for start, _, following in pairs],
        "t_slip": [end[0] - start[0] for start, end, _ in pairs],
        "t_stick": [following[0] - end[0] for _, end, following in pairs],
        "delta_x": [end[1] - start[1] for start, end, _ in pairs],
    }
    return Marched(values, skipped)


def exact(p: Parameters) -> dict[str, Any]:
    """Return the exact value of each quantity that a script reads off."""
    cycle = steady_cycle(p)
    values = {name: getattr(cycle, name) for name in ("T", "delta_x", "t_slip", "t_stick")}
    return {"break_away": p.F_s / (p.k * p.v), **values}


def speed_at(lambda_: Any, k: float) -> Any:
    """Return the speed v [m/s] at a lambda, docs/theory.md (2); the lambda at a speed likewise."""
    p = replace(BLOCK, k=k)
    return p.w * p.Delta / lambda_


def short_jump(lambda_: Any) -> Any:
    """Return by how much of the jump the formula is short, ``1 - 2 Delta/delta_x``."""
    cycle = steady_cycle(replace(BLOCK, v=speed_at(lambda_, BLOCK.k)))
    return 1 - cycle.spring_drop / cycle.delta_x


def growth(lambda_: Any) -> Any:
    """Return the jump with twice the gap, at the same kinetic friction, over the jump."""
    p = replace(BLOCK, v=speed_at(lambda_, BLOCK.k))
    wider = replace(p, mu_s=2 * BLOCK.mu_s - BLOCK.mu_k)
    return steady_cycle(wider).delta_x / steady_cycle(p).delta_x


def lasting(lambda_: Any) -> Any:
    """Return the slip time over half a period, ``w t_slip/pi``."""
    return steady_cycle(replace(BLOCK, v=speed_at(lambda_, BLOCK.k))).t_slip * BLOCK.w / math.pi


def sticks(ratio: float, v: float) -> tuple[Any, Any]:
    """Return the formula over the first load-up and over a cycle's stick, of an exact run.

    It goes from a relaxed spring at v [m/s] past the second break-away, at mu_k = ratio mu_s.
    """
    p = {**truth.START_VALUES, "mu_k": ratio * truth.START_VALUES["mu_s"], "v": v}
    told, half = FORMULAS["first_load_up"](p), FORMULAS["half_period"](p) / 2
    # Past each break-away by half a slip: long enough to have it, too short for another.
    steps = [truth.Step(float(told + half)), truth.Step(float(FORMULAS["period"](p)))]
    first, cycle = (told / sample["t_stick"] for sample in truth.run(p, steps).samples)
    return first, cycle


def load_up_over_stick(ratio: Any) -> Any:
    """Return the formula over the stick time in the cycle, at a ratio mu_k/mu_s."""
    return 1 / (2 * (1 - ratio))


def damped_limit(zeta: Any) -> Any:
    """Return the exact critical velocity [m/s] at a damping ratio, docs/theory.md (13)."""
    return coulomb_limit(replace(BLOCK, c=2 * zeta * np.sqrt(BLOCK.k * BLOCK.m)))


def familiar(zeta: Any) -> Any:
    """Return ``(mu_s - mu_k) m g/sqrt(4 pi zeta k m)`` [m/s], docs/theory.md (14)."""
    return BLOCK.w * BLOCK.Delta / np.sqrt(4 * math.pi * zeta)


def excess(zeta: Any) -> Any:
    """Return by how much of the exact critical velocity the familiar one is high."""
    return familiar(zeta) / damped_limit(zeta) - 1


def thresholds(
    deviation: Callable[[Any], Any], low: float = 0.1, high: float = 1e4
) -> dict[int, float]:
    """Return where a monotone deviation passes each of `LEVELS`, between two numbers above 0."""

    def excess(x: float, level: int) -> float:
        return float(deviation(math.exp(x))) - 0.01 * level

    ends = math.log(low), math.log(high)
    return {level: math.exp(brentq(excess, *ends, args=(level,))) for level in LEVELS}


def geometric(low: float, high: float, count: int) -> Array:
    """Return numbers in equal ratios, to five digits: the same doubles everywhere."""
    return np.array([float(f"{each:.5g}") for each in np.geomspace(low, high, count)])


def figure(value: Any, digits: int = 3) -> str:
    """Return a number to so many significant digits, without an exponent."""
    number = float(f"{float(value):.{digits - 1}e}")
    exponent = int(f"{number:e}".partition("e")[2]) if number else 0
    return f"{number:.{max(digits - 1 - exponent, 0)}f}"


def millimetres(length: Any, digits: int = 3) -> str:
    """Return a length [m] in mm."""
    return f"{figure(1000 * length, digits)} mm"


def percent(fraction: Any) -> str:
    """Return a fraction in percent to two digits; an infinite error never came to its end."""
    return f"{figure(100 * fraction, 2)} %" if np.isfinite(fraction) else "never came"


def shown(thresholds: dict[int, float], digits: int = 3) -> Values:
    """Return thresholds as figures."""
    return {level: figure(at, digits) for level, at in thresholds.items()}


def table(rows: Iterable[Iterable[str]]) -> str:
    """Return the rows of a table in Markdown."""
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def scales(on: Axes, x: tuple[Any, ...], y: tuple[Any, ...], title: str = "") -> None:
    """Set label, range and ticks of both axes; wide ranges are logarithmic."""
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter

    for name, (label, low, high, *ticks), axis in (("x", x, on.xaxis), ("y", y, on.yaxis)):
        scale = "log" if high > 5 * low > 0 else "linear"
        settings = {"label": label, "scale": scale, "lim": (low, high)}
        on.set(**{f"{name}{what}": value for what, value in settings.items()})
        if ticks:
            axis.set_major_locator(FixedLocator(*ticks))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())
    on.set_title(title)


def line(
    on: Axes,
    name: str,
    x: Iterable[float],
    y: Iterable[float],
    colour: str = PALETTE[0],
    at: tuple[float, float] | None = None,
    style: dict[str, Any] = LINE,
) -> None:
    """Draw a line, or points; its name stands at a place beside it."""
    # Six digits: enough for any plot, and no rounding of a library function is seen in them.
    x, y = ([float(f"{float(each):.6g}") for each in axis] for axis in (x, y))
    on.plot(x, y, color=colour, label=name, **style)
    if at is not None:
        on.annotate(name, at, color=colour, va="bottom")


points = partial(line, style=LARGE)
