"""StickSlipStribeck.fmu: its interface beside StickSlip.fmu's, the block's bits in both faces."""

from __future__ import annotations

from pathlib import Path

import fmpy
import fmpy.validation
import pytest

from stickslip_fmu.laws.named import friction_law
from stickslip_fmu.packer import build
from stickslip_fmu.spec import TABLE, spec_of
from tests.fmu.blocks import block_of, outputs

LAW = friction_law("stribeck").law
SPEC = spec_of(LAW)


@pytest.fixture(scope="module", params=[2, 3])
def fmu(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the FMU of the law, of FMI 2.0 and 3.0."""
    return build(tmp_path_factory.mktemp("stribeck"), face=request.param, law="stribeck")


def test_the_fmu_is_valid_and_named_by_the_law(fmu: Path) -> None:
    """It is valid, and file and identifier are StickSlipStribeck."""
    assert not fmpy.validation.validate_fmu(str(fmu))
    assert fmu.name in ("StickSlipStribeck.fmu", "StickSlipStribeck_fmi3.fmu")
    description = fmpy.read_model_description(str(fmu))
    assert description.coSimulation.modelIdentifier == "StickSlipStribeck"


def test_what_both_models_have_keeps_name_unit_and_reference() -> None:
    """Rows 0 to 33 are StickSlip's; 34 to 60 are the law's own."""
    for row, other in zip(SPEC.table.rows[:34], TABLE.rows, strict=False):
        assert (row.number, row.name, row.type, row.causality, row.variability, row.start) == (
            other.number,
            other.name,
            other.type,
            other.causality,
            other.variability,
            other.start,
        )
    own = {row.name: row.number for row in SPEC.table.rows[34:]}
    assert list(own.values()) == list(range(34, 61))
    assert [own[name] for name in ("shape", "v_s", "delta", "n_points", "mu_1")] == [*range(34, 39)]
    assert [own[name] for name in ("u_2", "mu_2", "u_12", "mu_12")] == [39, 40, 59, 60]


@pytest.mark.parametrize(
    "values", [{}, {"shape": 2, "c": 1.0}, {"shape": 3, "n_points": 3, "mu_2": 0.4}], ids=str
)
def test_the_fmu_gives_what_the_block_gives(fmu: Path, values: dict[str, float]) -> None:
    """A run in fmpy has the block's outputs, bit for bit."""
    run = fmpy.simulate_fmu(
        str(fmu),
        stop_time=1.0,
        step_size=0.125,
        output_interval=0.125,
        start_values=values,
        output=["x", "z", "F_friction", "Q_friction", "t_slip", "mu_k_used"],
    )
    block = block_of(SPEC, values)
    for sample in run[1:]:
        block.advance(float(sample["time"]) - 0.125, 0.125)
        found = {**outputs(block), "mu_k_used": block.state.friction.mu_k_used}  # type: ignore[attr-defined]
        assert all(found[name] == sample[name] for name in run.dtype.names[1:])


def test_laws_that_come_along_have_names(tmp_path: Path) -> None:
    """The name coulomb gives the same StickSlip.fmu as none; another word is refused with both."""
    assert friction_law("coulomb").law.interface.model == "StickSlip"
    named = build(tmp_path / "named", law="coulomb")
    assert named.name == "StickSlip.fmu"
    assert named.read_bytes() == build(tmp_path / "plain").read_bytes()
    with pytest.raises(ValueError, match="'stribek' is no friction law: 'coulomb', 'stribeck', or"):
        build(tmp_path, law="stribek")
