"""Grids cut into boxes, and studies that compute them."""

import pickle
from itertools import pairwise

import numpy as np
import pytest

from stickslip_design.maps.grid import GridStudy, block, boxes
from stickslip_design.maps.study import study_of
from tests.needs import needs

SHAPES = [(3,), (4, 5), (7, 3, 2), (5, 11), (2, 3, 4, 5), (1000,)]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("most", [1, 2, 3, 7, 10, 100, 5000])
def test_boxes_hold_every_point_once_in_order(shape: tuple[int, ...], most: int) -> None:
    """None has more points than are allowed, and a cut at a block cuts no box."""
    numbers = np.arange(np.prod(shape)).reshape(shape)
    found = list(boxes(shape, 0, numbers.size, most))
    seen = np.concatenate([numbers[box.slices].ravel() for box in found])
    np.testing.assert_array_equal(seen, numbers.ravel())
    assert max(box.stop - box.start for box in found) <= most
    whole = block(shape, most)
    cuts = range(0, numbers.size, whole)
    parts = [boxes(shape, cut, min(cut + whole, numbers.size), most) for cut in cuts]
    assert [box for part in parts for box in part] == found


def some_studies() -> list[GridStudy]:
    """Return a study in closed form, and one that is followed."""
    wide = {"v": "1..900 mm/s log 300", "k": "0.1..10 kN/m log 150", "mu_k": "0.1..0.3 2"}
    small = {"v": "1..900 mm/s log 30", "k": "0.1..10 kN/m log 50", "v_s": "1..30 mm/s 3"}
    return [
        study_of(wide, values={"c": 3.0})[0],
        study_of(small, values={"c": 1.0}, law="stribeck", limit=False)[0],
    ]


@needs("cc", "studies")
@pytest.mark.parametrize("number", [0, 1])
def test_a_study_is_the_same_to_the_bit_however_it_is_cut(number: int) -> None:
    """Cut at any multiple of its quantum, and sent to another process."""
    study = some_studies()[number]
    whole = study.compute(0, study.count)
    sent: GridStudy = pickle.loads(pickle.dumps(study))
    assert sent.identity == study.identity
    quantum = study.quantum
    assert study.count > 3 * quantum
    cuts = [0, quantum, 3 * quantum, study.count]
    for start, stop in pairwise(cuts):
        for name, each in sent.compute(start, stop).items():
            assert each.tobytes() == whole[name][start:stop].tobytes(), name


def test_what_the_results_depend_on_is_in_the_identity() -> None:
    """Law, held values, every value of a range; and not what is only shown."""
    over = {"v": "1..2 mm/s 3", "k": "1..2 kN/m 3"}
    of_one = study_of(over, values={})[0].identity
    assert study_of(over, values={"F_ext": 3.0, "m": 1.0})[0].identity == of_one
    assert study_of({**over, "v": "0.001..0.002 3"}, values={})[0].identity == of_one
    others = [
        study_of(over, values={"m": 2.0}),
        study_of({**over, "v": "1..2 mm/s log 3"}, values={}),
        study_of(over, values={}, law="stribeck"),
        study_of(over, values={}, limit=False),
    ]
    assert all(study.identity != of_one for study, _ in others)
