"""What is changed in a slip acts from there on: the slip is that of a block that begins so."""

from __future__ import annotations

import pytest

from stickslip_fmu.block import Block
from stickslip_fmu.laws.stribeck.law import STRIBECK
from stickslip_fmu.spec import spec_of
from tests.fmu.blocks import block_of, outputs

SPEC = spec_of(STRIBECK)
STRIBECK_FALL = {"shape": 1, "v_s": 0.05}
NOT_WHOLE = {"shape": 1, "v_s": 0.05, "delta": 1.5}
HYPERBOLIC = {"shape": 2, "v_s": 0.05}
CURVE = {"shape": 3, "n_points": 3, "u_2": 0.03, "mu_2": 0.35, "u_3": 0.2, "mu_3": 0.3}
SHAPES = {"Stribeck": STRIBECK_FALL, "not whole": NOT_WHOLE, "hyperbolic": HYPERBOLIC}
INPUTS = {"v": 0.06, "load": 3.0, "F_ext": 0.5, "k": 700.0, "c": 2.0}
SMOOTH = {"mu_s": 0.6, "mu_k": 0.2, "v_s": 0.08}
CHANGES = [
    *((own, name, new) for own in SHAPES.values() for name, new in {**INPUTS, **SMOOTH}.items()),
    *((own, "delta", 3.0) for own in (STRIBECK_FALL, NOT_WHOLE)),
    *((CURVE, name, new) for name, new in INPUTS.items()),
]
STEP = 0.004


@pytest.mark.parametrize(("own", "name", "new"), CHANGES)
def test_a_change_in_slip_acts_at_once(own: dict[str, float], name: str, new: float) -> None:
    """Whatever input or tunable parameter it is; first where a step was, then elsewhere."""
    block = block_of(SPEC, own)
    slip_in(block)
    before = outputs(block)
    block.set(name, new)
    block.advance(0.0, STEP)
    starts = {f"{each}_start": before[each] for each in ("x", "x_dot", "z")}
    fresh = block_of(SPEC, {**own, **starts, name: new})
    fresh.advance(0.0, STEP)
    changed, expected = outputs(block), outputs(fresh)
    for output in ("x", "x_dot", "z", "F_friction"):
        assert changed[output] == pytest.approx(expected[output], rel=1e-11), output


def slip_in(block: Block) -> None:
    """Go on to the middle of the first slip."""
    while block.mode == 0:
        block.advance(0.0, STEP)
    for _ in range(8):
        block.advance(0.0, STEP)
    assert block.mode == 1
