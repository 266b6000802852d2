"""Rules of thumb of designers: each number held against a derivation of its own, and the page."""

import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import stickslip_ref
from stickslip_design import claims
from stickslip_design.claims import critical, fixed_step, gap, jump, slip_time, stick_time
from stickslip_design.claims.numbers import pulled_at
from stickslip_design.claims.told import HERE, Claim, geometric, load_claim
from stickslip_design.claims.verlet import march
from stickslip_verification import truth
from stickslip_verification.report.svg import tidy

START = truth.START_VALUES
OTHER = {**START, "m": 37.0, "k": 2.5e6, "mu_s": 0.21, "mu_k": 0.2, "load": 50.0}
H = 1e-3


def travel(lambda_: float) -> float:
    """Return w t_slip; docs/theory.md (8)."""
    return 2.0 * (math.pi - math.atan(lambda_))


def way(lambda_: float) -> float:
    """Return the jump in parts of v/w; docs/theory.md (10)."""
    return 2.0 * lambda_ + travel(lambda_)


@pytest.mark.parametrize("block", [START, OTHER])
@pytest.mark.parametrize(
    ("deviation", "closed"),
    [
        (jump.deviation, lambda L: travel(L) / way(L)),
        (slip_time.deviation, lambda L: 1.0 - math.pi / travel(L)),
        (gap.growth, lambda L: way(2.0 * L) / way(L)),
    ],
)
def test_what_a_rule_leaves_out_depends_on_lambda_alone(
    deviation: Callable[..., Any], closed: Callable[[float], float], block: dict[str, float]
) -> None:
    for lambda_ in (0.05, 0.3, 1.0, 3.0, 40.0):
        # Differences of numbers near 1, in doubles.
        found = float(deviation(pulled_at(lambda_, block)))
        assert found == pytest.approx(closed(lambda_), rel=1e-13), lambda_


@pytest.mark.parametrize("v", [0.0003, 0.02, 1.0])
@pytest.mark.parametrize("mu_k", [0.0, 0.125, 0.3, 0.45])
def test_the_stick_formula_is_the_first_load_up_at_any_speed(mu_k: float, v: float) -> None:
    sticks = stick_time.run({**START, "mu_k": mu_k, "v": v})
    assert abs(sticks.first - 1) < 1e-40  # fifty digits less ten for the arcs
    assert float(sticks.in_cycle) == pytest.approx(0.5 / (2 * (0.5 - mu_k)), rel=1e-14)


@pytest.mark.parametrize(("zeta", "percent"), [(1e-5, None), (0.01, 3), (0.1, 31), (0.5, None)])
def test_the_familiar_critical_velocity_is_high_as_the_reference_has_it(
    zeta: float, percent: int | None
) -> None:
    found = float(critical.excess(START, zeta))
    closed = float(stickslip_ref.critical_lambda(zeta)) / math.sqrt(4 * math.pi * zeta) - 1
    # The closed form in doubles takes 1 from a number near 1.
    assert found == pytest.approx(closed, rel=1e-9, abs=1e-12)
    assert percent is None or round(100 * found) == percent


def told(module: ModuleType, **grid: Any) -> Claim:
    """Return the claim of a module, as its file states it, on another grid."""
    claim = load_claim(HERE / f"{module.__name__.rpartition('.')[2]}.toml", module.GRID)
    return replace(claim, grid={**claim.grid, **grid})


FASTER = {"v": geometric(0.01, 0.1, 25)}
"""The faster pulls, which take few steps."""


def test_a_marching_script_is_first_order_and_late_by_less_than_a_step() -> None:
    claim = told(fixed_step, **FASTER)
    # With the gap as it comes it finds every stick, and only those there are.
    coarse, fine = (fixed_step.errors(claim, h=h, mu_k=0.3) for h in (H, H / 2))
    assert not coarse.missed.any()
    assert not coarse.made_up.any()
    for name, errors in coarse.largest.items():
        ratio = float(np.median(fine.largest[name]) / np.median(errors))
        # Nearer to a half than to one (order zero) or to a quarter (order two), in ratios.
        assert math.sqrt(0.5 * 0.25) < ratio < math.sqrt(0.5 * 1.0), name
    run = march(coarse.k, coarse.v, h=H, block=START, cycles=1, longest=np.full(coarse.k.size, 5.0))
    late = run.break_away - 0.5 * 9.81 / (coarse.k * coarse.v)
    assert np.all((late > -1e-12) & (late <= H + 1e-12))  # roundings of the time
    # The spring is left at a break-away at most a step's pull beyond break-away force.
    way = coarse.v[:, np.newaxis] * run.T
    assert np.all(np.abs(run.delta_x - way) <= coarse.v[:, np.newaxis] * H * (1 + 1e-9))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of the page and its plots, as they are written."""
    folder = tmp_path_factory.mktemp("docs")
    claims.write(folder)
    return folder


@pytest.mark.gate
def test_each_claim_stands_on_the_page_with_verdict_table_and_plot(folder: Path) -> None:
    page = (folder / "claims.md").read_text(encoding="utf-8")
    assert len(list((folder / "claims").iterdir())) == len(claims.findings()) == 6
    for finding in claims.findings():
        section = page.split(f"## {finding.title}\n")[1].split("\n## ")[0]
        assert finding.claim in section
        assert finding.sentence in section
        assert all(" | ".join(row) in section for row in finding.rows)
        svg = (folder / f"claims/{finding.id}.svg").read_text(encoding="utf-8")
        tags = {element.tag.partition("}")[2] for element in ET.fromstring(svg).iter()}
        # In a page it needs no font and nothing outside, and has ids of its own.
        assert "title" in tags
        assert not {"text", "image", "script", "metadata"} & tags
        assert not re.search(r"matplotlib\.org|20\d\d-\d\d", svg)
        ids = re.findall(r'\bid="([^"]+)"', tidy(svg, finding.id, "title"))
        assert ids
        assert all(name.startswith(f"{finding.id}-") for name in ids)
