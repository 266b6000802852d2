"""The dimensions of a map are those that were asked for, also in a folder that has the map."""

from itertools import permutations
from pathlib import Path

import numpy as np
import pytest

from stickslip_design.maps.study import map_
from stickslip_design.points.blocks import block_points
from tests.needs import needs

OVER = {"v": "1..50 mm/s log 4", "k": "1e3..1e5 N/m 2", "c": "0..20 N.s/m 3"}


@needs("studies")
@pytest.mark.parametrize("names", list(permutations(OVER)))
@pytest.mark.parametrize("kept", [False, True])
def test_each_point_has_the_values_of_its_coordinates(
    names: tuple[str, ...], kept: bool, tmp_path: Path
) -> None:
    """In any order of the parameters, in memory and out of the file, whatever each point's own."""
    folder = tmp_path / "map" if kept else None
    found = map_({name: OVER[name] for name in names}, folder=folder, workers=1).load()
    assert found["delta_x"].dims == names
    assert set(found["v_c"].dims) == {"k", "c"}
    for place in np.ndindex(*found["delta_x"].shape):
        at = dict(zip(names, place, strict=True))
        alone = block_points({name: float(found[name][i]) for name, i in at.items()})
        for name, column in alone.items():
            where = tuple(at[str(each)] for each in found[name].dims)
            np.testing.assert_array_equal(found[name].values[where], column, err_msg=name)


@needs("studies")
def test_a_map_asked_for_in_another_order_has_that_order(tmp_path: Path) -> None:
    """The velocity is computed last wherever it is named, so that it is the same study."""
    one, other = (
        map_({name: OVER[name] for name in names}, folder=tmp_path, workers=1).load()
        for names in (("v", "k", "c"), ("k", "v", "c"))
    )
    assert (one["T"].dims, other["T"].dims) == (("v", "k", "c"), ("k", "v", "c"))
    np.testing.assert_array_equal(other["T"].values.swapaxes(0, 1), one["T"].values)


@needs("studies")
def test_a_map_is_shown_in_the_unit_that_was_typed_last(tmp_path: Path) -> None:
    """The same points in another unit are the same study."""
    units = {"mm/s": "1..50 mm/s log 4", "m/s": "0.001..0.05 m/s log 4"}
    for unit, text in units.items():
        found = map_({**OVER, "v": text}, folder=tmp_path, workers=1)
        assert found["v"].attrs["shown_in"] == unit
        assert found["v"].attrs["units"] == "m/s"
