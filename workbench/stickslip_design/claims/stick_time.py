"""The designers' stick time against the first load-up and the cycle, docs/theory.md (6), (9)."""

from collections.abc import Mapping
from dataclasses import dataclass

from mpmath import mpf

from stickslip_design.claims.finding import Axis, Finding, Panel, Series, plotted
from stickslip_design.claims.numbers import Number, figure, percent
from stickslip_design.claims.told import Claim
from stickslip_verification import truth
from stickslip_verification.model import formulas

GRID = ("ratio", "v", "curve", "within")
"""What its data file lists."""

# The run carries fifty digits; ten of them are more than its two arcs can lose.
_EXACT = 1e-40


@dataclass(frozen=True)
class Sticks:
    """Formula over stick time, at one speed: of the first load-up and of a cycle's stick."""

    first: Number
    in_cycle: Number


def run(p: Mapping[str, float]) -> Sticks:
    """Follow the exact motion from a relaxed spring over two break-aways and read both sticks."""
    told = formulas.first_load_up(p)
    # Past the second break-away by half a slip: long enough to have it, too short for a third.
    length = float(told + formulas.period(p) + formulas.half_period(p) / 2)
    halves = [truth.Step(float(told + formulas.half_period(p) / 2)), truth.Step(length)]
    readings = [sample["t_stick"] for sample in truth.run(p, halves).samples]
    return Sticks(first=told / readings[0], in_cycle=told / readings[1])


def examine(claim: Claim) -> Finding:
    """Try the claim: the formula over the stick time, over the ratio of the two frictions."""
    block, grid = claim.parameters, claim.grid
    ratios, speeds = grid["ratio"], grid["v"]
    runs = {
        (ratio, v): run({**block, "mu_k": ratio * block["mu_s"], "v": v})
        for ratio in ratios
        for v in speeds
    }
    rows = tuple(
        (
            f"{ratio:g}",
            *_one_or_span([runs[ratio, v].first for v in speeds]),
            *_one_or_span([runs[ratio, v].in_cycle for v in speeds]),
        )
        for ratio in ratios
    )
    (within,) = grid["within"]
    # mu_s/(2 (mu_s - mu_k)) = 1 -+ within, solved for mu_k/mu_s.
    low, high = (1 - 1 / (2 * (1 + side * mpf(within))) for side in (-1, 1))
    largest = max(ratios)
    of_worst = [runs[largest, v].in_cycle for v in speeds]
    default = truth.START_VALUES
    sentence = (
        f"The formula is exact for the first load-up of a relaxed spring, at any speed. In the "
        f"cycle a slip relieves the spring by 2Δ only, so the formula is off by the factor "
        f"mu_s / (2 (mu_s − mu_k)), at any speed too. The factor is "
        f"{figure(formulas.load_up_over_stick(default))} with the default parameters and "
        f"{_one_or_span(of_worst)[0]} at mu_k = {largest:g} mu_s. In the cycle the formula is "
        f"right to {percent(within)} only for mu_k between {figure(low)} and {figure(high)} mu_s; "
        f"below this range it is too short, above it too long."
    )
    return claim.found(
        verdict=_verdict(list(runs.values())),
        sentence=sentence,
        header=("mu_k / mu_s", "formula / first load-up", "formula / stick in the cycle"),
        rows=rows,
        panels=(_panel(claim, runs),),
    )


def _verdict(runs: list[Sticks]) -> str:
    first = max(abs(each.first - 1) for each in runs)
    cycle = max(max(each.in_cycle, 1 / each.in_cycle) for each in runs)
    exactly = "exact" if first < _EXACT else f"off by up to {percent(first)}"
    return f"first load-up: {exactly}; in the cycle: off by up to a factor of {figure(cycle, 2)}"


def _one_or_span(values: list[Number]) -> tuple[str]:
    """Return the figure that all speeds share, or the least and the largest."""
    shown = sorted({figure(value) for value in values}, key=float)
    return (shown[0],) if len(shown) == 1 else (f"{shown[0]} … {shown[-1]}",)


def _panel(claim: Claim, runs: Mapping[tuple[float, float], Sticks]) -> Panel:
    mu_s = mpf(claim.parameters["mu_s"])
    curve = [1 - each for each in reversed(claim.grid["curve"])]
    factor = [
        formulas.load_up_over_stick({**claim.parameters, "mu_k": each * mu_s}) for each in curve
    ]
    at = [ratio for ratio, _ in runs]
    ends = (0.0, 1.0)
    return Panel(
        x=Axis("μₖ / μₛ", *ends, ticks=(0, 0.25, 0.5, 0.75, 1)),
        y=Axis("formula / stick time", 0.4, 20.0, log=True, ticks=(0.5, 1, 2, 5, 10, 20)),
        series=(
            Series("stick in the cycle", plotted(curve), plotted(factor), name_at=(0.5, 1.9)),
            Series("first load-up", ends, (1.0, 1.0), colour=1, name_at=(0.03, 1.08)),
            Series(
                "cycle, exact runs at each speed",
                plotted(at),
                plotted(each.in_cycle for each in runs.values()),
                kind="points",
            ),
            Series(
                "first load-up, exact runs at each speed",
                plotted(at),
                plotted(each.first for each in runs.values()),
                kind="points",
                colour=1,
            ),
        ),
    )
