"""The slip time by the designers' formula against the exact one, docs/theory.md (8) and (12)."""

from mpmath import mpf

from stickslip_design.claims.finding import Axis, Finding, Panel, Series, mark, plotted
from stickslip_design.claims.numbers import Number, figure, pulled_at, spoken, threshold
from stickslip_design.claims.told import Claim
from stickslip_verification.model import formulas

GRID = ("lambda_", "within")
"""What its data file lists."""


def deviation(p: formulas.Parameters) -> Number:
    """Return by how much of the slip time half a period is short, ``1 - (pi/w)/t_slip``."""
    return 1 - formulas.half_period(p) / formulas.t_slip(p)


def examine(claim: Claim) -> Finding:
    """Try the claim: from which lambda on half a period is within each deviation."""
    block, grid = claim.parameters, claim.grid
    low, high = min(grid["lambda_"]), max(grid["lambda_"])

    def of_lambda(lambda_: Number) -> Number:
        return deviation(pulled_at(lambda_, block))

    levels = sorted(grid["within"], reverse=True)
    least = {level: threshold(of_lambda, level, low, high) for level in levels}
    rows = tuple(
        (
            f"{100 * level:g} %",
            f"λ ≥ {figure(least[level])}",
            f"v ≤ {figure(1000 * pulled_at(least[level], block)['v'])} mm/s",
        )
        for level in levels
    )
    reached = spoken([f"{100 * level:g} % from λ = {figure(least[level])}" for level in levels])
    slowest = 1 / (1 - of_lambda(low))
    sentence = (
        f"Half a period is the limit for slow pull. It is always too short, by at most {reached} "
        f"on. The slip takes {figure(1 / (1 - of_lambda(mpf(1))))} times half a period at λ = 1 "
        f"and {figure(slowest)} times at λ = {low:g}; towards fast pull it takes twice "
        f"half a period."
    )
    times = [1 / (1 - of_lambda(each)) for each in grid["lambda_"]]
    panel = Panel(
        x=Axis("λ = w Δ / v", low, high, log=True),
        y=Axis("slip time / half a period", 0.9, 2.1, ticks=(1.0, 1.25, 1.5, 1.75, 2.0)),
        series=(
            Series("exact", plotted(grid["lambda_"]), plotted(times), name_at=(0.9, 1.62)),
            Series(
                "half a period, as told",
                plotted((low, high)),
                (1.0, 1.0),
                kind="dashed",
                colour=-1,
                name_at=(0.13, 1.03),
            ),
            *(
                mark(
                    f"{100 * level:g} % short",
                    at,
                    1 / (1 - mpf(level)),
                    name_at=(float(at), 1 / (1 - level) + 0.03),
                )
                for level, at in least.items()
            ),
        ),
    )
    return claim.found(
        verdict=f"holds to {100 * levels[0]:g} % for λ ≥ {figure(least[levels[0]])}",
        sentence=sentence,
        header=("short by at most", "for", f"at k = {block['k']:g} N/m"),
        rows=rows,
        panels=(panel,),
    )
