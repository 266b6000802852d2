import numpy as np
import pytest
import scipy.linalg
from numpy.typing import NDArray
from threadpoolctl import threadpool_info, threadpool_limits

from stickslip_design.loop import system
from stickslip_design.loop.stability import swing
from tests.design.axes import SERVO


def threads() -> set[int]:
    return {each["num_threads"] for each in threadpool_info() if each["user_api"] == "blas"}


def test_small_matrices_of_a_loop_take_one_thread_and_the_callers_number_comes_back(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    seen: set[int] = set()

    def noting(matrix: NDArray[np.float64]) -> object:
        seen.update(threads())
        return scipy.linalg.expm(matrix)

    monkeypatch.setattr(system, "expm", noting)
    with threadpool_limits(limits=2, user_api="blas"):
        swing(SERVO)
        after = threads()
    assert seen == {1}
    assert after == {2}
