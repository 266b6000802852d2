"""Maps as datasets: in memory, in a folder, and what they say of themselves."""

import json
import pickle
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import stickslip as ss
import stickslip_ref
from stickslip_design.maps.study import GridStudy, study_of
from stickslip_design.points.axes import axis_points
from tests.design.tolerances.series import series
from tests.needs import needs

pytestmark = [
    needs("studies"),
    # Without a compiler the Python block computes the same.
    pytest.mark.filterwarnings("ignore::stickslip_design.points.slips.SlowCoreWarning"),
]

OVER = {"v": "1..900 mm/s log 20", "k": "0.1..10 kN/m log 5", "mu_k": "0.1..0.45 3"}
C = {"c": 3.0}
AXIS = series()


@pytest.mark.parametrize("names", [("v", "k", "mu_k"), ("k", "mu_k", "v")])
def test_a_map_has_the_dimensions_asked_for_and_agrees_with_the_reference(
    names: tuple[str, ...], tmp_path: Path
) -> None:
    import xarray

    over = {name: OVER[name] for name in names}
    found = ss.map(over, ss.Parameters(c=3.0), folder=tmp_path, workers=1).load()
    xarray.testing.assert_identical(xarray.open_zarr(tmp_path / "map.zarr").load(), found)
    assert (found["k"].attrs["units"], found["delta_x"].attrs["units"]) == ("N/m", "m")
    assert json.loads(found.attrs["inputs"])["values"] == C
    assert found["delta_x"].dims == names
    assert found["v_c"].dims == tuple(name for name in names if name != "v")
    grid = np.meshgrid(*(found[name].values for name in names), indexing="ij")
    p = stickslip_ref.Parameters(**C, **dict(zip(names, grid, strict=True)))
    cycle = stickslip_ref.steady_cycle(p)
    assert_array_equal(found["regime"] == 1, cycle.exists)
    # Roundings of one closed form, in vectors and alone.
    assert_allclose(found["T"], cycle.T, rtol=1e-14)
    assert_allclose(found["delta_x"], np.where(cycle.exists, cycle.delta_x, 0.0), rtol=1e-14)
    limit = found["v_c"].broadcast_like(found["T"]).transpose(*names)
    assert_allclose(limit, stickslip_ref.coulomb_limit(p), rtol=1e-14)


def test_a_map_of_an_axis_has_its_numbers_and_the_feed() -> None:
    over = {"feed": "0.1..20 mm/s log 9", "axis.stiffness": "5..200 N/um log 3"}
    found = ss.map(over, axis=AXIS, workers=1)
    assert found["critical_feed"].dims == ("axis.stiffness",)
    assert json.loads(found.attrs["point"]) == {"feed": 1e-3, "axis.stiffness": 4e7}
    listed = axis_points(
        AXIS, {"axis.stiffness": found["axis.stiffness"].values}, found["feed"].values.tolist()
    )
    for name in ("jump", "rate", "regime", "critical_feed"):
        # Roundings of one closed form, in vectors and alone.
        assert_allclose(found[name].values.T, listed[name], rtol=1e-14, err_msg=name)


@pytest.mark.parametrize(
    ("over", "options", "reason"),
    [
        ({"friction.mu_z": "0..1", "feed": "1..2"}, {"axis": AXIS}, "nearest: friction.mu_"),
        ({"axis.mass": "-1..2 kg", "feed": "1..2"}, {"axis": AXIS}, "axis.mass = -1 kg is out of"),
        ({"feed": "0..2", "axis.mass": "1..2 kg"}, {"axis": AXIS}, "a feed is above 0"),
        ({"feed": "1..2"}, {"axis": AXIS, "values": {"k": 1.0}}, "k: the axis file states"),
    ],
)
def test_what_cannot_be_mapped_is_refused(
    over: dict[str, str], options: dict[str, Any], reason: str
) -> None:
    with pytest.raises(ValueError, match=reason):
        study_of(over, **{"values": {}, **options})


@pytest.mark.parametrize(
    ("over", "options"),
    [
        ({"v": "1..900 mm/s log 300", "k": "0.1..10 kN/m log 150", "mu_k": "0.1..0.3 2"}, {}),
        pytest.param(
            {"v": "1..900 mm/s log 30", "k": "0.1..10 kN/m log 50", "v_s": "1..30 mm/s 3"},
            {"law": "stribeck", "limit": False},
            marks=needs("cc"),
        ),
    ],
)
def test_a_study_is_the_same_to_the_bit_however_it_is_cut_and_sent(
    over: dict[str, str], options: dict[str, Any]
) -> None:
    study = study_of(over, values=C, **options)
    expected = study.compute(0, study.count)
    sent: GridStudy = pickle.loads(pickle.dumps(study))
    assert sent.identity == study.identity
    assert study.count > 3 * study.quantum
    for start, stop in pairwise([0, study.quantum, 3 * study.quantum, study.count]):
        for name, column in sent.compute(start, stop).items():
            assert column.tobytes() == expected[name][start:stop].tobytes(), name


@pytest.mark.parametrize(
    ("over", "values", "options", "same"),
    [
        ({"v": "0.001..0.002 3"}, {"F_ext": 3.0, "m": 1.0}, {}, True),
        ({}, {"m": 2.0}, {}, False),
        ({"v": "1..2 mm/s log 3"}, {}, {}, False),
        ({}, {}, {"law": "stribeck"}, False),
        ({}, {}, {"limit": False}, False),
    ],
)
def test_all_that_results_depend_on_is_an_input_and_what_is_only_shown_is_not(
    over: dict[str, str], values: dict[str, float], options: dict[str, Any], same: bool
) -> None:
    spans = {"v": "1..2 mm/s 3", "k": "1..2 kN/m 3"}
    other = study_of({**spans, **over}, values=values, **options)
    assert (other.identity == study_of(spans, values={}).identity) is same
