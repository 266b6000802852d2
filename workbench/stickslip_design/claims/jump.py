"""The jump by the designers' formula against the real one, docs/theory.md (10) and (12)."""

from mpmath import mpf

from stickslip_design.claims.finding import Axis, Finding, Panel, Series, mark, plotted
from stickslip_design.claims.numbers import (
    Number,
    figure,
    lambda_of,
    percent,
    pulled_at,
    spoken,
    threshold,
)
from stickslip_design.claims.told import Claim
from stickslip_verification import truth
from stickslip_verification.model import formulas

GRID = ("lambda_", "within", "k", "v")
"""What its data file lists."""


def deviation(p: formulas.Parameters) -> Number:
    """Return by how much of the real jump the formula is short, ``1 - 2 Delta/delta_x``."""
    return 1 - formulas.spring_relief(p) / formulas.delta_x(p)


def examine(claim: Claim) -> Finding:
    """Try the claim: where the formula is within each deviation, over lambda and over v."""
    block, grid = claim.parameters, claim.grid
    low, high = min(grid["lambda_"]), max(grid["lambda_"])

    def of_lambda(lambda_: Number) -> Number:
        return deviation(pulled_at(lambda_, block))

    levels = sorted(grid["within"], reverse=True)
    least = {level: threshold(of_lambda, level, low, high) for level in levels}
    fastest = {
        (level, k): pulled_at(least[level], {**block, "k": k})["v"]
        for level in levels
        for k in grid["k"]
    }
    rows = tuple(
        (
            f"{100 * level:g} %",
            f"λ ≥ {figure(least[level])}",
            *(f"v ≤ {figure(1000 * fastest[level, k])} mm/s" for k in grid["k"]),
        )
        for level in levels
    )
    default = truth.START_VALUES
    ours = formulas.spring_relief(default)
    real = formulas.delta_x(default)
    reached = spoken([f"{100 * level:g} % from λ = {figure(least[level])}" for level in levels])
    sentence = (
        f"The formula gives the relief of the spring. The jump is always larger, because the "
        f"pulled end moves on while the mass slips. The formula is short by at most {reached} on; "
        f"at λ = 1 it gives {percent(1 - of_lambda(mpf(1)))} of the jump. With the default "
        f"parameters λ = {figure(lambda_of(default))}: the formula gives "
        f"{figure(1000 * ours, 4)} mm, and the mass jumps {figure(1000 * real, 4)} mm."
    )
    return claim.found(
        verdict=f"holds to {100 * levels[0]:g} % for λ ≥ {figure(least[levels[0]])}",
        sentence=sentence,
        header=("short by at most", "for", *(f"at k = {k:g} N/m" for k in grid["k"])),
        rows=rows,
        panels=(_over_lambda(claim, least), _over_speed(claim)),
    )


_SHORT_BY = Axis("formula short of the jump  [%]", 0.1, 100.0, log=True, ticks=(0.1, 1, 5, 10, 100))


def _over_lambda(claim: Claim, least: dict[float, Number]) -> Panel:
    points = claim.grid["lambda_"]
    short = [100 * deviation(pulled_at(each, claim.parameters)) for each in points]
    return Panel(
        x=Axis("λ = w Δ / v", min(points), max(points), log=True),
        y=_SHORT_BY,
        series=(
            Series("any undamped block", plotted(points), plotted(short), name_at=(4.5, 45)),
            *(
                mark(f"λ = {figure(at)}", at, 100 * level, name_at=(1.3 * float(at), 100 * level))
                for level, at in least.items()
            ),
        ),
    )


def _over_speed(claim: Claim) -> Panel:
    speeds = claim.grid["v"]
    named_at = ((7, 0.7), (7, 1.2), (7, 2.1))
    series = []
    for colour, k in enumerate(claim.grid["k"]):
        short = [100 * deviation({**claim.parameters, "k": k, "v": v}) for v in speeds]
        series.append(
            Series(
                f"k = {k:g} N/m",
                plotted(1000 * v for v in speeds),
                plotted(short),
                colour=colour,
                name_at=named_at[colour] if colour < len(named_at) else None,
            )
        )
    return Panel(
        x=Axis("pulling velocity  [mm/s]", 1000 * min(speeds), 1000 * max(speeds), log=True),
        y=_SHORT_BY,
        series=tuple(series),
        title="m = {m:g} kg, μₛ − μₖ = {gap:g}".format(
            m=claim.parameters["m"], gap=claim.parameters["mu_s"] - claim.parameters["mu_k"]
        ),
    )
