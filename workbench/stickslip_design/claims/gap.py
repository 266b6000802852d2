"""What doubling the friction gap does to the jump, docs/theory.md (7) and (10)."""

from collections.abc import Mapping

from mpmath import mp, mpf

from stickslip_design.claims.finding import Axis, Finding, Panel, Series, plotted
from stickslip_design.claims.numbers import Number, figure, pulled_at, spoken, threshold
from stickslip_design.claims.told import Claim
from stickslip_verification.model import formulas

GRID = ("v", "curve", "k", "within")
"""What its data file lists."""


def doubled(p: Mapping[str, Number]) -> dict[str, Number]:
    """Return the block with twice the gap, at the same kinetic friction."""
    with mp.workdps(formulas.DIGITS):
        return {**p, "mu_s": 2 * mpf(p["mu_s"]) - mpf(p["mu_k"])}


def growth(p: Mapping[str, Number]) -> Number:
    """Return the jump with twice the gap over the jump."""
    return formulas.delta_x(doubled(p)) / formulas.delta_x(p)


def examine(claim: Claim) -> Finding:
    """Try the claim at several speeds."""
    block, grid = claim.parameters, claim.grid
    speeds = grid["v"]
    rows = []
    for v in speeds:
        p = {**block, "v": v}
        rows.append(
            (
                f"{1000 * v:g}",
                f"{figure(1000 * formulas.delta_x(p))} mm",
                f"{figure(1000 * formulas.delta_x(doubled(p)))} mm",
                figure(growth(p)),
                figure(formulas.spring_relief(doubled(p)) / formulas.spring_relief(p)),
            )
        )

    def missing(lambda_: Number) -> Number:
        return 1 - growth(pulled_at(lambda_, block)) / 2

    levels = sorted(grid["within"], reverse=True)
    least = {level: threshold(missing, level, 0.1, 1e4) for level in levels}
    reached = spoken([f"{100 * level:g} % from λ = {figure(least[level])}" for level in levels])
    slow, fast = min(speeds), max(speeds)
    sentence = (
        f"Twice the gap makes {figure(growth({**block, 'v': slow}))} times the jump at "
        f"{1000 * slow:g} mm/s and {figure(growth({**block, 'v': fast}))} times at "
        f"{1000 * fast:g} mm/s. The factor is below 2 by at most {reached} on (λ of the single "
        f"gap). Towards fast pull the factor goes to 1: there the gap hardly changes the jump. "
        f"The relief of the spring, 2Δ, doubles at every speed."
    )
    return claim.found(
        verdict=f"holds to {100 * levels[0]:g} % for λ ≥ {figure(least[levels[0]])}",
        sentence=sentence,
        header=("v [mm/s]", "jump", "with twice the gap", "factor", "factor of the relief"),
        rows=tuple(rows),
        panels=(_panel(claim),),
    )


def _panel(claim: Claim) -> Panel:
    speeds = claim.grid["curve"]
    named_at = ((45, 1.4), (1.4, 1.5))
    series = [
        Series(
            f"k = {k:g} N/m",
            plotted(1000 * v for v in speeds),
            plotted(growth({**claim.parameters, "k": k, "v": v}) for v in speeds),
            colour=colour,
            name_at=named_at[colour] if colour < len(named_at) else None,
        )
        for colour, k in enumerate(claim.grid["k"])
    ]
    told_at = claim.grid["v"]
    series.append(
        Series(
            "the speeds of the table",
            plotted(1000 * v for v in told_at),
            plotted(growth({**claim.parameters, "v": v}) for v in told_at),
            kind="points",
        )
    )
    ends = (1000 * min(speeds), 1000 * max(speeds))
    series.append(
        Series("twice, as told", ends, (2.0, 2.0), kind="dashed", colour=-1, name_at=(30, 2.02))
    )
    return Panel(
        x=Axis("pulling velocity  [mm/s]", *ends, log=True),
        y=Axis("jump with twice the gap / jump", 0.95, 2.1, ticks=(1, 1.25, 1.5, 1.75, 2)),
        series=tuple(series),
    )
