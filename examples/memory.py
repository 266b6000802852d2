"""The limits of friction with a memory, drawn for docs/theory.md: ``python -m examples.memory``."""

import math
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from stickslip_ref import Change, Parameters, simulate

G = 9.81
BLOCK = Parameters(m=1.0, k=2.0, v=0.1, c=0.4, mu_s=1.5 / G, mu_k=1.0 / G)
"""Canudas de Wit et al., IEEE TAC 40 (1995) 419, section IV-D."""
STIFFNESSES = 10.0 ** np.arange(5.0, 12.5)
STIFF = Parameters(m=1e-3, load=1e3 - 1e-3 * G, k=1e12, v=1e-6, z_start=6e-10, x_dot_start=1e-6)
a, b, D_c = 0.01, 0.015, 1e-5


def stribeck_limit() -> list[float]:
    """Return by how much periods fall short of those under Stribeck's curve [s]."""
    limit = simulate(BLOCK, 22.0, law="stribeck", own={"v_s": 1e-3}).cycles[-1].T
    runs = (
        simulate(BLOCK, 22.0, law="lugre", own={"sigma_0": s, "sigma_1": math.sqrt(s), "v_s": 1e-3})
        for s in STIFFNESSES
    )
    return [limit - run.cycles[-1].T for run in runs]


def main(target: Path) -> None:
    """Draw both limits."""
    page, (left, right) = plt.subplots(1, 2, figsize=(9.0, 3.4), layout="constrained")
    short = np.array(stribeck_limit())
    left.loglog(
        STIFFNESSES, short, "o-", color="#1f6aa5", label="LuGre, $\\sigma_1=\\sqrt{\\sigma_0}$"
    )
    left.loglog(STIFFNESSES, short[4] * (STIFFNESSES[4] / STIFFNESSES) ** 0.5, "k--", lw=0.8,
                label="$\\sigma_0^{-1/2}$")  # fmt: skip
    left.set(xlabel="$\\sigma_0$ [N/m]", ylabel="period below Stribeck's [s]")
    times = np.concatenate(([0.0, 19.999], 20.0 + np.geomspace(1e-4, 20.0, 400)))
    for evolution, name, color in ((1.0, "aging", "#1f6aa5"), (2.0, "slip law", "#d1731c")):
        own = {"evolution": evolution, "theta_start": 10.0}
        run = simulate(STIFF, 40.0, law="rate_state", own=own, times=times,
                       changes=[Change(20.0, {"v": 1e-5})])  # fmt: skip
        way = (run.x - run.x[1]) / D_c
        right.plot(way[1:], run.own["mu"][1:], color=color, label=name)
    for height, text in (
        (a * math.log(10.0), "$a\\,\\ln 10$"),
        ((a - b) * math.log(10.0), "$(a-b)\\ln 10$"),
    ):
        right.axhline(0.6 + height, color="k", lw=0.8, ls="--")
        right.annotate(text, (7.0, 0.6 + height), va="bottom")
    right.set(xlabel="way after the step $10^{-6}\\to10^{-5}$ m/s, over $D_c$", ylabel="$\\mu$",
              xlim=(-0.5, 10.0))  # fmt: skip
    for panel in (left, right):
        panel.legend(frameon=False)
        panel.spines[["top", "right"]].set_visible(False)
    page.savefig(target, metadata={"Date": None} if target.suffix == ".svg" else None)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "memory.svg"))
