"""What docs/importing.md says that goes wrong with importers."""

import re
from pathlib import Path

import pytest

from tests.conftest import built
from tests.driver import DiedError, Host
from tests.importers.running import ask
from tests.needs import needs


def tell(name: str, *arguments: object, importer: str = "fmpy") -> list[list[float]]:
    answer: list[list[float]]
    answer, _ = ask(importer, name, built("python-2"), *arguments, module="traps")
    return answer


def test_fmpy_takes_a_sloping_input_at_the_beginning_of_each_step() -> None:
    rows = [(0.0, 0.0, 0.0, 0.0), (0.15, 0.3, 0.0, 0.0)]
    [x_pull] = tell("tabled", ["time", "v", "load", "F_ext"], rows, ["x_pull"])
    assert x_pull == pytest.approx([0.0, 0.0, 0.005, 0.015], abs=1e-15)


def test_fmpy_changes_a_parameter_that_has_a_column() -> None:
    rows = [(time, 0.02, 0.0, 0.0, k) for time, k in ((0.0, 1e3), (0.1, 2e3), (0.2, 2e3))]
    F, z = tell("tabled", ["time", "v", "load", "F_ext", "k"], rows, ["F", "z"])
    stiffness = [force / extension for force, extension in zip(F[1:], z[1:], strict=True)]
    assert stiffness == pytest.approx([1e3, 1e3, 2e3, 2e3], rel=1e-15)


@needs("fmucontainer")
def test_a_container_leaves_what_is_over_for_the_next_step() -> None:
    x_pull = tell("coarse", importer="fmucontainer")
    reached = [0.0, 0.01, 0.03, 0.04, 0.06]
    assert x_pull == pytest.approx([0.02 * time for time in reached], abs=1e-15)


@needs("ecospy")
def test_what_is_set_just_before_a_reset_of_ecos_acts_in_the_first_step_after_it() -> None:
    assert tell("pending", importer="ecospy") == pytest.approx(0.05 * 0.01)


@needs("proxyfmu")
def test_after_a_reset_through_proxyfmu_nothing_moves() -> None:
    before, begun, after = tell("standing_still", importer="proxyfmu")
    assert before == pytest.approx(0.0002)
    assert begun == after


@needs("proxyfmu")
def test_without_libpython_ecos_crashes_in_proxyfmu() -> None:
    process = Host(LD_PRELOAD="")
    with pytest.raises(DiedError, match="Unable to bind") as caught:
        ask("proxyfmu", "inputs", built("python-2"), process=process)
    # The socket that nobody removes after the crash.
    for left in re.findall(r"using handle '([^']+)'", caught.value.errors):
        Path(left).unlink(missing_ok=True)
    assert caught.value.code is not None
    assert caught.value.code < 0
