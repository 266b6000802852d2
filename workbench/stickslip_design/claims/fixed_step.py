"""A fixed step against the exact events, docs/theory.md (6), (8), (9) and (10)."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from stickslip_design.claims.finding import Axis, Finding, Panel, Series, plotted
from stickslip_design.claims.numbers import Number, percent, spoken
from stickslip_design.claims.told import Claim
from stickslip_design.claims.verlet import Array, march
from stickslip_verification.model import formulas

GRID = ("mu_k", "h", "cycles", "k", "v", "within")
"""What its data file lists."""

Flags = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class _Quantity:
    """What a script reads off: its words and its exact value."""

    words: str
    exact: Callable[[formulas.Parameters], Number]


_QUANTITIES = {
    "break_away": _Quantity("first break-away", formulas.first_load_up),
    "T": _Quantity("period", formulas.period),
    "delta_x": _Quantity("jump", formulas.delta_x),
    "t_slip": _Quantity("slip time", formulas.t_slip),
    "t_stick": _Quantity("stick time", formulas.t_stick),
}


# Both are stretches of constant pull, so that a step of error is a share in proportion to v.
_STEPWISE = ("break_away", "t_stick")


@dataclass(frozen=True)
class Errors:
    """What a script gets wrong on each block of a grid.

    Attributes
    ----------
    k, v
        Stiffness [N/m] and pulling velocity [m/s], shape (blocks,).
    largest
        Largest relative error of each quantity over the cycles looked at, shape (blocks,);
        infinite where one of the cycles never came.
    missed
        Whether a stick was passed over: a slip outlasts a period of the free oscillation, or the
        stick between two has no length; shape (blocks,).
    made_up
        Whether a stick was made up: a slip ends within half a period; shape (blocks,).
    """

    k: Array
    v: Array
    largest: Mapping[str, Array]
    missed: Flags
    made_up: Flags


def errors(claim: Claim, *, h: float, mu_k: float) -> Errors:
    """March every block of the grid with the step `h` [s] and hold it against the exact events."""
    k, v = (each.ravel() for each in np.meshgrid(claim.grid["k"], claim.grid["v"], indexing="ij"))
    cycles = int(claim.grid["cycles"][0])
    block = {**claim.parameters, "mu_k": mu_k}
    blocks = [{**block, "k": float(a), "v": float(b)} for a, b in zip(k, v, strict=True)]
    exact = {
        name: np.array([float(quantity.exact(p)) for p in blocks])
        for name, quantity in _QUANTITIES.items()
    }
    half_period = np.array([float(formulas.half_period(p)) for p in blocks])
    # Twice as long as the cycles take exactly: a script may pass over a stick now and then.
    longest = 2.0 * (exact["break_away"] + (cycles + 1) * (exact["T"] + 2.0 * h))
    run = march(k, v, h=h, block=block, cycles=cycles, longest=longest)
    got = {name: getattr(run, name).reshape(k.size, -1) for name in _QUANTITIES}
    largest = {
        name: np.nan_to_num(
            np.max(np.abs(got[name] / exact[name][:, np.newaxis] - 1.0), axis=1), nan=np.inf
        )
        for name in got
    }
    # A slip lasts between half a period and a whole one, docs/theory.md (8), and each of its ends
    # is seen at most a step late.
    late = run.t_slip > (2.0 * half_period + h)[:, np.newaxis]
    early = run.t_slip < (half_period - h)[:, np.newaxis]
    return Errors(
        k=k,
        v=v,
        largest=largest,
        missed=np.any(late | np.isnan(run.T), axis=1) | (run.skipped > 0),
        made_up=np.any(early, axis=1),
    )


def examine(claim: Claim) -> Finding:
    """Try the claim: the largest errors over the grid, for each kinetic friction."""
    grid = claim.grid
    (h,) = grid["h"]
    mu_s = claim.parameters["mu_s"]
    found = {mu_k: errors(claim, h=h, mu_k=mu_k) for mu_k in grid["mu_k"]}
    header = ["error at a step of " + f"{1000 * h:g} ms"]
    for mu_k in found:
        gap = f"gap {mu_s - mu_k:.2g}"
        header += [f"{gap}: median", "largest"]
    rows = [
        (
            quantity.words,
            *(
                shown
                for each in found.values()
                for shown in (
                    _shown(float(np.median(each.largest[name]))),
                    _shown(float(np.max(each.largest[name]))),
                )
            ),
        )
        for name, quantity in _QUANTITIES.items()
    ]
    for words, flag in (("sticks missed", "missed"), ("sticks invented", "made_up")):
        counts = [f"{getattr(each, flag).sum()} of {each.k.size}" for each in found.values()]
        rows.append((words, *(cell for count in counts for cell in ("", count))))
    main, *others = found.values()
    return claim.found(
        verdict=_verdict(main, max(grid["within"])),
        sentence=_sentence(claim, main, others),
        header=tuple(header),
        rows=tuple(rows),
        panels=_panels(claim, main),
    )


def _verdict(main: Errors, within: float) -> str:
    most = {name: float(np.max(main.largest[name])) for name in _QUANTITIES}
    words = {name: quantity.words for name, quantity in _QUANTITIES.items()}
    good = [words[name] for name in most if most[name] <= within]
    bad = [f"{words[name]} ({_shown(most[name])})" for name in most if most[name] > within]
    parts = [f"holds to {100 * within:g} % for {spoken(good)}" if good else ""]
    parts.append(f"not for {spoken(bad)}" if bad else "")
    return ", ".join(part for part in parts if part)


def _sentence(claim: Claim, main: Errors, others: list[Errors]) -> str:
    grid = claim.grid
    mu_s = claim.parameters["mu_s"]
    most = {name: _shown(float(np.max(main.largest[name]))) for name in _QUANTITIES}
    every = np.max([main.largest[name] for name in _QUANTITIES], axis=0)
    shares = [
        f"within {100 * level:g} % on {np.count_nonzero(every <= level)}"
        for level in sorted(grid["within"], reverse=True)
    ]
    text = (
        f"The script is velocity Verlet; it finds break-away and re-stick at the end of the step "
        f"in which they fall. It ran on {main.k.size} blocks, k = {min(grid['k']):g} to "
        f"{max(grid['k']):g} N/m and v = {1000 * min(grid['v']):g} to {1000 * max(grid['v']):g} "
        f"mm/s, {grid['cycles'][0]:g} cycles each. The largest error is {most['t_slip']} in the "
        f"slip time, {most['delta_x']} in the jump and {most['T']} in the period, but "
        f"{most['break_away']} in the first break-away and {most['t_stick']} in the stick time: "
        f"these two are off by about one step, however short they are. All five are "
        f"{', '.join(shares)} of the blocks."
    )
    for mu_k, each in zip(grid["mu_k"][1:], others, strict=True):
        text += (
            f" With a gap of {mu_s - mu_k:.2g} the stick time is off by up to "
            f"{_shown(float(np.max(each.largest['t_stick'])))}, and on "
            f"{np.count_nonzero(each.missed)} blocks the script misses whole sticks."
        )
    return text


def _shown(error: float) -> str:
    return percent(error) if np.isfinite(error) else "never came"


def _panels(claim: Claim, found: Errors) -> tuple[Panel, ...]:
    """Show every block of the grid, in three classes of stiffness."""
    low, high = 0.01, 100.0
    k = np.array(claim.grid["k"])
    classes = [each for each in np.array_split(k, 3) if each.size]
    speeds = Axis(
        "pulling velocity  [mm/s]",
        1000.0 * min(claim.grid["v"]),
        1000.0 * max(claim.grid["v"]),
        log=True,
    )
    panels = []
    for name, quantity in _QUANTITIES.items():
        series = []
        for colour, of_class in enumerate(classes):
            here = np.isin(found.k, of_class)
            shown = np.clip(100.0 * found.largest[name][here], low, high)
            series.append(
                Series(
                    f"k = {of_class[0]:.0f} … {of_class[-1]:.0f} N/m",
                    plotted(1000.0 * found.v[here]),
                    plotted(shown),
                    kind="points",
                    colour=colour,
                )
            )
        if name in _STEPWISE:
            block = {**claim.parameters, "mu_k": claim.grid["mu_k"][0], "k": float(k.max())}
            ends = (float(found.v.min()), float(found.v.max()))
            share = [claim.grid["h"][0] / quantity.exact({**block, "v": v}) for v in ends]
            series.append(
                Series(
                    f"one step, k = {k.max():.0f} N/m",
                    plotted(1000.0 * v for v in ends),
                    plotted(100.0 * each for each in share),
                    kind="dashed",
                    colour=-1,
                    name_at=(1.15, 6.0),
                )
            )
        panels.append(
            Panel(
                x=speeds,
                y=Axis("largest error  [%]", low, high, log=True, ticks=(0.01, 0.1, 1, 10, 100)),
                series=tuple(series),
                title=quantity.words,
            )
        )
    return tuple(panels)
