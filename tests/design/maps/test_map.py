"""Maps as datasets: in memory, in a folder, and what they say of themselves."""

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import stickslip_design
import stickslip_ref
from stickslip_design.axis import axis_file_of
from stickslip_design.chunks import StudyError
from stickslip_design.maps import study
from stickslip_design.maps.grid import GridStudy
from stickslip_design.points.axes import axis_points
from stickslip_design.points.blocks import COLUMNS
from tests.needs import needs

pytestmark = needs("studies")

OVER = {"v": "1..900 mm/s log 40", "k": "0.1..10 kN/m log 15", "mu_k": "0.1..0.45 4"}
HELD = {"c": 3.0, "mu_s": 0.5}
RIGID = """
[axis]
mass = "500 kg"
stiffness = "40 N/um"
c = "4 kN s/m"
[friction]
mu_s = 0.20
mu_k = 0.15
[demand]
feeds = ["2 mm/s"]
"""


def test_a_map_agrees_with_the_reference_at_its_points() -> None:
    """At 200 of them, taken by the values of their coordinates."""
    found = stickslip_design.map_(OVER, values=HELD, workers=1)
    random = np.random.default_rng(1)
    for _ in range(200):
        place = {name: int(random.integers(size)) for name, size in found.sizes.items()}
        point = found.isel(place)
        values = {str(name): float(point[name]) for name in found.sizes}
        p = stickslip_ref.Parameters(**HELD, **values)
        cycle = stickslip_ref.steady_cycle(p)
        assert bool(point["regime"] == 1) == cycle.exists
        # Roundings of one closed form, in vectors and alone.
        assert_allclose(point["T"], cycle.T, rtol=1e-14)
        assert_allclose(point["delta_x"], cycle.delta_x if cycle.exists else 0.0, rtol=1e-14)
        assert_allclose(point["v_c"], stickslip_ref.coulomb_limit(p), rtol=1e-14)


def test_a_dataset_says_what_is_in_it_and_where_it_comes_from() -> None:
    """Names, units, regimes, versions, inputs; the critical velocity has no dimension v."""
    found = stickslip_design.map_(OVER, values=HELD, workers=1)
    assert found["delta_x"].dims == tuple(OVER)
    assert found["v_c"].dims == ("k", "mu_k")
    for name, (unit, description) in COLUMNS.items():
        assert found[name].attrs["units"] == unit
        assert found[name].attrs["long_name"] == description
    assert found["k"].attrs["units"] == "N/m"
    assert found["k"].attrs["long_name"] == "Spring stiffness"
    assert found["regime"].attrs["flag_meanings"] == "even sticks swings"
    assert found["regime"].dtype == np.int8
    assert json.loads(found.attrs["inputs"])["values"] == {"c": 3.0}
    assert {"versions", "inputs_digest", "command", "seed"} <= found.attrs.keys()


def test_a_folder_holds_the_same_map_and_is_not_computed_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Written a slab at a time, opened by xarray; then neither points nor file are made again."""
    import xarray

    whole = stickslip_design.map_(OVER, values=HELD, workers=1)
    # Slabs of one stiffness, of which the last dimension asked for is not the last one computed.
    monkeypatch.setattr(study, "_SLAB", 100)
    kept = stickslip_design.map_(OVER, values=HELD, folder=tmp_path, workers=1)
    opened = xarray.open_zarr(tmp_path / "map.zarr")
    for each in (kept, opened):
        xarray.testing.assert_identical(each.drop_attrs(), whole.drop_attrs())
        assert each["delta_x"].attrs == whole["delta_x"].attrs
    made = (tmp_path / "map.zarr" / "zarr.json").stat().st_mtime_ns

    def compute(*_: Any) -> None:
        raise AssertionError

    monkeypatch.setattr(GridStudy, "compute", compute)
    stickslip_design.map_(OVER, values=HELD, folder=tmp_path, workers=1)
    assert (tmp_path / "map.zarr" / "zarr.json").stat().st_mtime_ns == made


def test_a_folder_of_another_map_is_refused_and_made_anew_when_told(tmp_path: Path) -> None:
    """What differs is told; the dataset that is there stays until the other one is computed."""
    stickslip_design.map_(OVER, values=HELD, folder=tmp_path, workers=1)
    with pytest.raises(StudyError, match="c is 2"):
        stickslip_design.map_(OVER, values={"c": 2.0}, folder=tmp_path, workers=1)
    other = stickslip_design.map_(OVER, values={"c": 2.0}, folder=tmp_path, workers=1, fresh=True)
    assert json.loads(other.attrs["inputs"])["values"] == {"c": 2.0}


def test_a_map_of_an_axis_has_its_numbers_and_the_feed() -> None:
    """Each point is that of the axis with these numbers; the critical feed does not have a feed."""
    file = axis_file_of(RIGID, "rigid.toml")
    over = {"feed": "0.1..20 mm/s log 9", "axis.stiffness": "5..200 N/um log 7"}
    found = stickslip_design.map_(over, axis=file, workers=1)
    assert found["critical_feed"].dims == ("axis.stiffness",)
    assert json.loads(found.attrs["point"]) == {"feed": 2e-3, "axis.stiffness": 4e7}
    stiffness, feed = found["axis.stiffness"].values, found["feed"].values
    for row, k in enumerate(stiffness):
        there = axis_points(file, {"axis.stiffness": np.full(feed.size, k)}, feed)
        for name in ("jump", "rate", "regime"):
            assert_allclose(found[name].values[:, row], there[name], rtol=1e-14, err_msg=name)
        assert_allclose(found["critical_feed"].values[row], there["critical_feed"][0], rtol=1e-14)
    assert set(np.unique(found["regime"])) == {0, 1}


def test_without_a_feed_a_map_of_an_axis_is_at_the_demanded_one() -> None:
    """At another one where it is given, and where nothing is demanded at none."""
    over = {"axis.mass": "100..900 kg 4", "axis.stiffness": "5..200 N/um log 3"}
    file = axis_file_of(RIGID, "rigid.toml")
    at_demand = stickslip_design.map_(over, axis=file, workers=1)
    given = stickslip_design.map_(over, axis=file, values={"feed": 2e-3}, workers=1)
    assert_array_equal(at_demand["jump"], given["jump"])
    bare = axis_file_of(RIGID.partition("[demand]")[0], "rigid.toml")
    assert set(stickslip_design.map_(over, axis=bare, workers=1).data_vars) == {
        "critical_feed",
        "stable",
        "clamped",
    }


@pytest.mark.parametrize(
    ("over", "values", "reason"),
    [
        ({"friction.mu_z": "0..1", "feed": "1..2"}, {}, "nearest: friction.mu_"),
        ({"axis.mass": "-1..2 kg", "feed": "1..2"}, {}, "axis.mass = -1 kg is out of range"),
        ({"axis.mass": "1..2 N", "feed": "1..2"}, {}, "'axis.mass=1..2 N' is a force"),
        ({"feed": "0..2", "axis.mass": "1..2 kg"}, {}, "a feed is above 0"),
        ({"feed": "1..2", "axis.mass": "1..2 kg"}, {"k": 1.0}, "k: the axis file states"),
    ],
)
def test_what_an_axis_cannot_be_mapped_over_is_refused(
    over: dict[str, str], values: dict[str, float], reason: str
) -> None:
    """By the name of the number, and the nearest that the file states."""
    with pytest.raises(ValueError, match=reason):
        stickslip_design.map_(over, axis=axis_file_of(RIGID, "rigid.toml"), values=values)


@needs("studies")
def test_a_dataset_is_made_anew_when_told(tmp_path: Path) -> None:
    """One of which a file was lost too."""
    first = stickslip_design.map_(OVER, values=HELD, folder=tmp_path, workers=1).load()
    shutil.rmtree(tmp_path / "map.zarr" / "delta_x" / "c")
    again = stickslip_design.map_(OVER, values=HELD, folder=tmp_path, workers=1, fresh=True)
    np.testing.assert_array_equal(again["delta_x"], first["delta_x"])


@needs("studies")
def test_another_feed_is_another_map(tmp_path: Path) -> None:
    """Though the file and the ranges are the same."""
    over = {"axis.mass": "100..900 kg 4", "axis.stiffness": "5..200 N/um log 3"}
    file = axis_file_of(RIGID, "rigid.toml")
    feeds = ({"feed": 1e-3}, {"feed": 3e-3})
    stickslip_design.map_(over, axis=file, values=feeds[0], folder=tmp_path, workers=1)
    with pytest.raises(StudyError, match=r"feed is 0\.003 and was 0\.001"):
        stickslip_design.map_(over, axis=file, values=feeds[1], folder=tmp_path, workers=1)


@needs("studies")
def test_what_is_held_is_not_mapped_over() -> None:
    """As what is meant is not known."""
    with pytest.raises(ValueError, match="k: it is held, and the map is over it too"):
        stickslip_design.map_(OVER, values={"k": 5.0})


@needs("studies", "cc")
@pytest.mark.parametrize(
    ("law", "over", "held", "searched"),
    [
        ("coulomb", {"k": 2000, "c": 2000}, {}, True),
        ("coulomb", {"v": 2000, "k": 5}, {"tau_s": 0.1}, True),
        ("coulomb", {"v": 3, "tau_s": 2000}, {}, False),
        ("stribeck", {"v": 2000, "k": 1000}, {}, True),
        ("stribeck", {"v": 2, "k": 1001}, {}, False),
    ],
)
def test_a_critical_velocity_is_searched_where_that_takes_a_minute_at_most(
    law: str, over: dict[str, int], held: dict[str, float], searched: bool
) -> None:
    """Closed forms always, else up to 1000 searches; v has none of its own."""
    spans: dict[str, Any] = {name: np.linspace(1.0, 2.0, count) for name, count in over.items()}
    source = study.study_of(spans, values=held, law=law)[0].source
    assert ("v_c" in source.columns) == searched
