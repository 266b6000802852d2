"""The critical velocity: its familiar formula against the exact one, docs/theory.md (13), (14)."""

from collections.abc import Mapping

from mpmath import mp, mpf

from stickslip_design.claims.finding import Axis, Finding, Panel, Series, mark, plotted
from stickslip_design.claims.numbers import Number, figure, percent, pulled_at, spoken, threshold
from stickslip_design.claims.told import Claim
from stickslip_verification import truth
from stickslip_verification.model import formulas

GRID = ("zeta", "curve", "within")
"""What its data file lists."""


def familiar(p: Mapping[str, Number], zeta: Number) -> Number:
    """Return ``(mu_s - mu_k) m g/sqrt(4 pi zeta k m)`` [m/s], docs/theory.md (14)."""
    with mp.workdps(formulas.DIGITS):
        return pulled_at(mp.sqrt(4 * mp.pi * mpf(zeta)), p)["v"]


def exact(p: Mapping[str, Number], zeta: Number) -> Number:
    """Return ``w Delta/lambda_c(zeta)`` [m/s], docs/theory.md (13)."""
    with mp.workdps(formulas.DIGITS):
        return pulled_at(mpf(truth.critical_lambda(zeta, digits=formulas.DIGITS)), p)["v"]


def excess(p: Mapping[str, Number], zeta: Number) -> Number:
    """Return by how much of the exact critical velocity the familiar one is high."""
    return familiar(p, zeta) / exact(p, zeta) - 1


def examine(claim: Claim) -> Finding:
    """Try the claim over the damping ratio."""
    block, grid = claim.parameters, claim.grid
    rows = tuple(
        (
            f"{zeta:g}",
            f"{figure(1000 * familiar(block, zeta))} mm/s",
            f"{figure(1000 * exact(block, zeta))} mm/s",
            _high_by(excess(block, zeta)),
        )
        for zeta in grid["zeta"]
    )
    low, high = min(grid["curve"]), max(grid["curve"])

    def of_zeta(zeta: Number) -> Number:
        return excess(block, zeta)

    levels = sorted(grid["within"])
    most = {level: threshold(of_zeta, level, low, high) for level in levels}
    reached = spoken([f"{100 * level:g} % up to ζ = {figure(most[level], 2)}" for level in levels])
    sentence = (
        f"The familiar formula is always too high: at most by {reached}. It is "
        f"{_high_by(of_zeta(0.01))} high at ζ = 0.01 and {_high_by(of_zeta(0.1))} high at 0.1; at "
        f"0.5 it gives {figure(1 + of_zeta(0.5), 2)} times the exact value. The error is on the "
        f"safe side for a designer who raises the speed to end stick-slip. From ζ = 1 on there is "
        f"no cycle at any speed, but the formula still gives a critical velocity. Without damping "
        f"there is no critical velocity."
    )
    return claim.found(
        verdict=f"holds to {100 * levels[-1]:g} % for ζ ≤ {figure(most[levels[-1]], 2)}",
        sentence=sentence,
        header=("ζ", "formula", "exact", "formula high by"),
        rows=rows,
        panels=_panels(claim, most),
    )


def _high_by(fraction: Number) -> str:
    """Return an excess in percent, or as a factor where percents get out of hand."""
    return percent(fraction) if fraction < 1 else f"a factor of {figure(1 + fraction, 2)}"


def _panels(claim: Claim, most: Mapping[float, Number]) -> tuple[Panel, ...]:
    zetas = claim.grid["curve"]
    x = Axis("damping ratio ζ", min(zetas), max(zetas), log=True)
    block = claim.parameters
    speeds = Panel(
        x=x,
        y=Axis("critical velocity  [mm/s]", 1.0, 1000.0, log=True),
        series=(
            Series(
                "familiar formula",
                plotted(zetas),
                plotted(1000 * familiar(block, zeta) for zeta in zetas),
                kind="dashed",
                colour=1,
                name_at=(0.025, 170),
            ),
            Series(
                "exact",
                plotted(zetas),
                plotted(1000 * exact(block, zeta) for zeta in zetas),
                name_at=(0.05, 18),
            ),
        ),
        title=f"m = {block['m']:g} kg, k = {block['k']:g} N/m, "
        f"μₛ − μₖ = {block['mu_s'] - block['mu_k']:g}",
    )
    high = Panel(
        x=x,
        y=Axis("formula above exact  [%]", 0.1, 1000.0, log=True, ticks=(0.1, 1, 5, 10, 100, 1000)),
        series=(
            Series(
                "any damped block",
                plotted(zetas),
                plotted(100 * excess(block, zeta) for zeta in zetas),
                name_at=(0.0005, 25),
            ),
            *(
                mark(f"ζ = {figure(at, 2)}", at, 100 * level, name_at=(1.4 * float(at), 70 * level))
                for level, at in most.items()
            ),
        ),
    )
    return speeds, high
