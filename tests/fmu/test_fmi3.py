"""The FMI 3.0 face in fresh processes without the project: the same block, bit for bit."""

import json
import math
import random
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.python import python

IMPORTER = Path(__file__).with_name("importer3.py")

Script = list[list[Any]]


def imported(task: str, argument: Any, *fmus: Path) -> tuple[Any, str]:
    """Run a task of `importer3` and return its result and what it wrote to standard error."""
    done = python("-I", IMPORTER, task, *fmus, input=json.dumps(argument))
    return json.loads(done.stdout.splitlines()[-1]), done.stderr


def random_script(generator: random.Random) -> Script:
    """Return a run with changing inputs, rollbacks, states through bytes and failures."""
    script: Script = [["start", {"c": generator.choice([0.0, 0.5, 80.0]), "z_start": 0.004}]]
    taken = False
    for _ in range(40):
        action = generator.choice(["step"] * 6 + ["set"] * 3 + ["take", "back", "write", "fail"])
        if action == "step":
            script.append(["step", 10.0 ** generator.uniform(-4.0, 0.0)])
        elif action == "set":
            name = generator.choice(["v", "load", "F_ext", "k", "mu_k"])
            value = {
                "v": generator.uniform(-0.05, 0.1),
                "load": generator.uniform(-9.0, 20.0),
                "F_ext": generator.uniform(-6.0, 6.0),
                "k": generator.uniform(200.0, 5000.0),
                "mu_k": generator.uniform(0.0, 0.6),
            }[name]
            script.append(["set", name, value])
        elif action == "take":
            script.append(["take"])
            taken = True
        elif action == "back" and taken:
            script.append(["back"])
        elif action == "write":
            script.append(["write"])
        elif action == "fail":
            bad = [["set", "k", -1.0], ["set", "F_ext", math.inf], ["step", 0.0], ["set", "m", 2.0]]
            script += [generator.choice(bad), ["reset"], ["start", {}]]
    return script


DEFAULT: Script = [["start", {}], *([["step", 0.01]] * 300)]


def test_both_faces_show_the_same_bits(fmu_path: Path, fmi3_path: Path) -> None:
    """Default run, inputs, rollbacks and failures: FMI 2.0 and 3.0 agree to the last bit.

    Each in a process of its own, and both loaded in one, taking turns.
    """
    generator = random.Random(3)
    scripts = [DEFAULT, *(random_script(generator) for _ in range(12))]
    (by_2,), _ = imported("played", scripts, fmu_path)
    (by_3,), _ = imported("played", scripts, fmi3_path)
    together, _ = imported("played", scripts, fmu_path, fmi3_path)
    assert by_3 == by_2
    assert together == [by_2, by_2]
    lines = [line for script in by_2 for line in script]
    assert lines.count("failed") > 10
    assert len({json.dumps(line) for line in lines}) > 500


def test_fmpy_runs_it_and_the_step_does_not_matter(fmi3_path: Path) -> None:
    """The default run gives the same at 1,000 steps and at one."""
    often = [["start", {}], *([["step", 0.01]] * 1000)]
    once = [["start", {}], ["step", 10.0]]
    (runs,), _ = imported("played", [often, once], fmi3_path)
    last, other = runs[0][-1], runs[1][-1]
    assert last == pytest.approx(other, rel=1e-13, abs=1e-13)
    assert 31 in last


def test_a_serialized_state_goes_on_in_another_process(fmu_path: Path, fmi3_path: Path) -> None:
    """Bytes of either face go on in the other, bit for bit."""
    for first in (fmu_path, fmi3_path):
        (data, shown), _ = imported("packed", {"c": 0.5}, first)
        for second in (fmu_path, fmi3_path):
            again, _ = imported("resumed", (data, shown[0]), second)
            assert again == shown


def test_it_survives_every_failure(fmi3_path: Path) -> None:
    """Two thousand failures, with resets between, leave a process that goes on."""
    (seen, told), errors = imported("failures", 50, fmi3_path)
    assert seen == 50 * 22
    assert "internal error" not in errors
    texts = [text for _, _, text in told]
    for part in (
        "k = -1.0 N/m is out of range: it must be finite and above 0",
        "time is the independent variable: it cannot be set",
        "there is no variable with value reference 4000000",
        "mode is of type Int64, not Float64",
        "2 value references came with 1 values",
        "the state to set is none that this FMU handed out",
    ):
        assert any(part in text for text in texts), part


def test_a_refused_step_is_an_error_and_not_fatal(fmi3_path: Path) -> None:
    """It says where the simulation stands and why; the flag to terminate is false both times."""
    (found, told), _ = imported("refused_step", None, fmi3_path)
    assert found == [[0, False, 0.2], [3, False, 0.1]]
    assert told == [
        [3, "logStatusError", "step size h = -1.0 s is out of range: above 0 and finite"]
    ]


def test_calls_of_other_interfaces_are_survived(fmi3_path: Path) -> None:
    """What model exchange and event mode call is refused, or answered with nothing."""
    found, _ = imported("other_calls", None, fmi3_path)
    assert found.pop("GetContinuousStateDerivatives") == 0
    assert set(found.values()) == {4}


def test_time_is_that_of_the_communication_points(fmi3_path: Path) -> None:
    """It follows the steps and the rollbacks; the start time shows from the first step on."""
    found, _ = imported("times", None, fmi3_path)
    assert found == [[0.0, 0.0, 0.0, 0.0], [5.0, 5.0625], [5.0, 5.125], [5.0, 5.0625]]


def test_instances_are_independent(fmi3_path: Path) -> None:
    """A hundred instances at once keep to themselves, and the search path does not grow."""
    (low, high, entries), _ = imported("many", None, fmi3_path)
    assert entries <= 1
    assert math.isclose(low, 0.5, rel_tol=1e-12)
    assert math.isclose(high, 0.5, rel_tol=1e-12)


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="no /proc to read memory from")
def test_rollbacks_do_not_grow(fmi3_path: Path) -> None:
    """200,000 states taken, set and freed leave no byte behind each."""
    (bytes_more,), _ = imported("growth", None, fmi3_path)
    # One lost object, of 16 bytes at least, at each of them would be 3.2 MB.
    assert bytes_more < 1_000_000


def test_the_standard_library_is_enough(fmi3_path: Path) -> None:
    """An instance loads nothing but its own package, pythonfmu3 and the standard library."""
    loaded, _ = imported("modules", None, fmi3_path)
    roots = {name.split(".")[0] for name in loaded}
    own = {name for name in roots if name.startswith("stickslip_fmu_")}
    assert len(own) == 2
    assert roots - own - {"pythonfmu3"} <= set(sys.stdlib_module_names)
