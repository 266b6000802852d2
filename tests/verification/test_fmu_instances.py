"""Instances of FMUs that are not ours: the same numbers in SI behind any face."""

import itertools
import re
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from stickslip_verification import truth
from stickslip_verification.drive.fmu.archive import FmuFile, available
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.instance import FmuInstance
from stickslip_verification.drive.fmu.names import NameMap
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.run import Series
from tests.needs import needs
from tests.verification.foreign import native
from tests.verification.foreign.building import HERE, altered

STEPS = (0.01,) * 120 + (0.003, 0.2, 1e-9, 0.7, 0.07) * 8

ULP = 2.0**-52


def run(
    fmu: FmuFile, parameters: dict[str, float], names: Sequence[str], steps: Sequence[float] = STEPS
) -> dict[str, Series]:
    """Return what the FMU shows after each step, in SI."""
    rows = []
    with fmu.instantiate() as instance:
        instance.start(parameters)
        read = instance.reader(names)
        now = 0.0
        for h in steps:
            instance.step(now, h)
            now += h
            rows.append(read())
    return {
        name: np.array(column) for name, column in zip(names, zip(*rows, strict=True), strict=True)
    }


@pytest.fixture(scope="module")
def in_mm(slider_mm: Path, slider_mm_names: NameMap) -> FmuFile:
    """Return the opened slider in millimetres, FMI 2.0."""
    return FmuFile(slider_mm, slider_mm_names)


@pytest.fixture(scope="module")
def in_si(slider_si: Path, slider_si_names: NameMap) -> FmuFile:
    """Return the opened slider in SI, FMI 3.0."""
    return FmuFile(slider_si, slider_si_names)


@pytest.mark.parametrize(
    "parameters", [{}, {"v": -0.3, "m": 4.0, "k": 12500.0}, {"v": 0.1, "mu_s": 0.2, "mu_k": 0.2}]
)
def test_millimetres_and_metres_are_the_same_motion(
    in_mm: FmuFile, in_si: FmuFile, parameters: dict[str, float]
) -> None:
    """The same slider behind FMI 2.0 in mm and FMI 3.0 in SI gives the same numbers in SI.

    Up to four roundings lie between them, two at each face (the FMU's own conversion and ours); and
    parameters that differ by a rounding move the motion by as much again in each of some 40 cycles.
    """
    names = available(in_mm, OUTPUT_NAMES)
    assert names == available(in_si, OUTPUT_NAMES)
    mm, si = run(in_mm, parameters, names), run(in_si, parameters, names)
    for name in names:
        scale = float(np.max(np.abs(si[name])))
        assert float(np.max(np.abs(mm[name] - si[name]))) <= 4 * 40 * ULP * scale, name
    assert np.array_equal(mm["mode"], si["mode"])
    assert si["n_slips"][-1] > 2


def deviation(fmu: FmuFile, name: str) -> float:
    """Return the largest deviation from the exact motion at the defaults, over its scale."""
    got = run(fmu, {}, [name])[name]
    samples = truth.run({}, [truth.Step(h, {}) for h in STEPS]).samples
    exact = np.array([float(sample[name]) for sample in samples])
    return float(np.max(np.abs(got - exact)) / np.max(np.abs(exact)))


@pytest.mark.parametrize("name", ["x", "z", "F", "delta_x", "T"])
def test_the_foreign_slider_is_honest(in_mm: FmuFile, name: str) -> None:
    """An exact block of another hand, in other units, follows the exact motion to rounding.

    Each of the 10 cycles of this run adds a few ulp of the time of its events.
    """
    assert deviation(in_mm, name) < 10 * 16 * ULP


def test_half_a_percent_of_static_friction_is_seen(
    slider_faulty: Path, slider_mm_names: NameMap
) -> None:
    """The planted fault moves every break-away, so that the motion is another one."""
    assert deviation(FmuFile(slider_faulty, slider_mm_names), "x") > 1e-3


def test_our_numbers_go_in_as_theirs(in_mm: FmuFile) -> None:
    """A value that is set in SI is read back in SI, through the units and the sign of the FMU."""
    given = {"m": 3.0, "g": 1.62, "k": 700.0, "mu_s": 0.25, "v": 0.125}
    with in_mm.instantiate() as instance:
        instance.start(given)
        assert instance.reader(list(given))() == list(given.values())
        instance.step(0.0, 0.01)
        force, extension, limit = instance.reader(["F", "z", "F_s"])()
    assert extension == pytest.approx(0.125 * 0.01, rel=4 * ULP)
    assert force == pytest.approx(700.0 * 0.125 * 0.01, rel=8 * ULP)
    assert limit == pytest.approx(0.25 * 3.0 * 1.62, rel=4 * ULP)


def test_si_passes_untouched(fmu_path: Path) -> None:
    """Of an FMU in SI the numbers are handed over bit for bit, whatever they are."""
    fmu = FmuFile(fmu_path)
    given = {"k": 1e3 / 3.0, "v": 0.1 + 0.2, "mu_s": 1.0 / 7.0}
    with fmu.instantiate() as instance:
        instance.start(given)
        assert instance.reader(list(given))() == list(given.values())


def test_a_datum_moves_the_position(
    slider_mm: Path, slider_mm_names: NameMap, tmp_path: Path
) -> None:
    """A position whose unit has an offset is read from the origin of SI."""

    def moved(text: str) -> str:
        assert 'factor="1e-3"' in text
        return text.replace('factor="1e-3"', 'factor="1e-3" offset="0.5"')

    path = altered(slider_mm, tmp_path / "datum.fmu", moved)
    names = ["x", "z", "F"]
    moved_away = run(FmuFile(path, slider_mm_names), {}, names)
    plain = run(FmuFile(slider_mm, slider_mm_names), {}, names)
    assert np.array_equal(moved_away["x"], plain["x"] + 0.5)
    assert np.array_equal(moved_away["z"], plain["z"] - 0.5)
    assert np.array_equal(moved_away["F"], plain["F"])


def test_a_whole_number_must_be_whole(in_mm: FmuFile) -> None:
    """What the FMU holds as an integer cannot be set to a fraction, and says so."""
    with in_mm.instantiate() as instance:
        with pytest.raises(FmuError) as caught:
            instance.set({"mode": 0.5})
        assert str(caught.value) == "SliderMm.fmu: mode = 0.5 is no value of type Integer"


def test_what_the_fmu_does_not_have_is_told(in_mm: FmuFile, in_si: FmuFile) -> None:
    """A variable without a counterpart can be neither set nor read."""
    for fmu in (in_mm, in_si):
        with fmu.instantiate() as instance:
            with pytest.raises(FmuError, match=r"\.fmu: has no variable load, c$"):
                instance.set({"load": 1.0, "v": 0.1, "c": 2.0})
            with pytest.raises(FmuError, match=r"\.fmu: has no variable Q_friction$"):
                instance.reader(["x", "Q_friction"])


@pytest.mark.parametrize("which", ["in_mm", "in_si"])
def test_a_reset_instance_is_a_new_one(which: str, request: pytest.FixtureRequest) -> None:
    """After a reset an instance gives, number for number, what a fresh one gives."""
    fmu: FmuFile = request.getfixturevalue(which)
    with fmu.instantiate() as instance:
        instance.start({"v": 0.5, "k": 5e3})
        instance.step(0.0, 1.0)
        instance.reset()
        instance.start({})
        read = instance.reader(["x", "z"])
        instance.step(0.0, 1.0)
        again = read()
    fresh = run(fmu, {}, ["x", "z"], [1.0])
    assert again == [fresh["x"][0], fresh["z"][0]]


def follow(instance: FmuInstance, begin: float, steps: Sequence[float]) -> list[list[float]]:
    """Return what the instance shows over these steps."""
    read = instance.reader(["x", "x_dot", "z", "T", "n_slips"])
    rows = []
    for h in steps:
        instance.step(begin, h)
        begin += h
        rows.append(read())
    return rows


@pytest.fixture(params=["slider_si", "fmu_path"])
def keeping(request: pytest.FixtureRequest, slider_si_names: NameMap) -> FmuFile:
    """Return an FMU that can keep its state, of either version."""
    path: Path = request.getfixturevalue(request.param)
    return FmuFile(path, slider_si_names if request.param == "slider_si" else None)


def test_a_state_brings_back_the_motion(keeping: FmuFile) -> None:
    """From a state that it has kept an FMU goes on as before, bit for bit, as often as asked."""
    with keeping.instantiate() as instance:
        instance.start({})
        follow(instance, 0.0, [0.1] * 30)
        state = instance.get_state()
        first = follow(instance, 3.0, [0.1] * 30)
        for _ in range(2):
            instance.set_state(state)
            assert follow(instance, 3.0, [0.1] * 30) == first
        instance.free_state(state)


def test_a_written_state_moves_to_another_instance(keeping: FmuFile) -> None:
    """A state as bytes lets another instance of the FMU go on where the first one was."""
    with keeping.instantiate() as one, keeping.instantiate() as other:
        one.start({"v": 0.05})
        follow(one, 0.0, [0.1] * 30)
        state = one.get_state()
        written = one.serialize(state)
        one.free_state(state)
        other.start({})
        restored = other.deserialize(written)
        other.set_state(restored)
        other.free_state(restored)
        assert follow(other, 3.0, [0.1] * 30) == follow(one, 3.0, [0.1] * 30)


def test_an_fmu_that_cannot_keep_its_state_is_not_asked_to(in_mm: FmuFile) -> None:
    """Where the description says no, no call is made that the FMU may not survive."""
    with in_mm.instantiate() as instance:
        instance.start({})
        with pytest.raises(FmuError) as caught:
            instance.get_state()
        assert str(caught.value) == "SliderMm.fmu: cannot get and set its state, by its description"
        with pytest.raises(FmuError, match="cannot serialize its state"):
            instance.deserialize(b"")


def test_a_step_that_ends_the_simulation_is_an_error(in_si: FmuFile) -> None:
    """An FMU 3.0 that says the simulation is over has not done what it was asked."""
    with in_si.instantiate() as instance:
        instance.start({"v": 11.0})
        with pytest.raises(FmuError) as caught:
            instance.step(0.0, 0.5)
    said = "SliderSi.fmu: fmi3DoStep(t = 0.0, h = 0.5) ends the simulation at t = 0.5"
    assert str(caught.value) == said


def test_a_step_that_returns_early_is_an_error(
    in_si: FmuFile, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An FMU 3.0 that stops before the end of the step, which was not allowed, says where it is.

    No wrapper of Python code does it, so the call itself is played here, with the arguments of the
    standard; the native FMU does it in truth, where there is a compiler.
    """

    def stop_half_way(*arguments: object) -> int:
        _, begin, h, _, _, _, early, reached = arguments
        early._obj.value = True  # type: ignore[attr-defined]
        reached._obj.value = begin + h / 2  # type: ignore[attr-defined,operator]
        return 0

    with in_si.instantiate() as instance:
        instance.start({})
        monkeypatch.setattr(instance._slave, "fmi3DoStep", stop_half_way)
        with pytest.raises(FmuError) as caught:
            instance.step(1.0, 0.5)
    said = "SliderSi.fmu: fmi3DoStep(t = 1.0, h = 0.5) returns early at t = 1.25"
    assert str(caught.value) == said


VALUES = {
    "x": 0.25,
    "k": 0.1,
    "mode": -1.0,
    "mu_k": 250.0,
    "mu_s": -300.0,
    "g": 60000.0,
    "F": -1e9,
    "n_slips": 4e9,
    "v": -(2.0**40),
    "m": 2.0**63,
    "sticking": 1.0,
    "load": 1.0,
}
"""A value for each variable of the native FMU, that the next smaller type could not hold."""


@pytest.fixture(scope="module")
def native_fmu(tmp_path_factory: pytest.TempPathFactory) -> FmuFile:
    """Return an FMU 3.0 in C with one variable of each type."""
    return FmuFile(native.build(tmp_path_factory.mktemp("native")))


@needs("cc")
def test_a_number_of_any_type_is_a_number(native_fmu: FmuFile) -> None:
    """Each type of number of FMI 3.0 takes a value of its own and gives it back."""
    assert {variable.kind for variable in native_fmu.variables.values()} == set(native.TYPES)
    with native_fmu.instantiate() as instance:
        instance.start(VALUES)
        assert dict(zip(VALUES, instance.reader(list(VALUES))(), strict=True)) == VALUES


@needs("cc")
@pytest.mark.parametrize(
    ("name", "value"),
    [("mu_k", 300.0), ("mu_k", -1.0), ("v", np.nan), ("v", np.inf), ("sticking", 2.0)],
)
def test_a_number_that_its_type_cannot_hold_is_refused(
    native_fmu: FmuFile, name: str, value: float
) -> None:
    """An integer that would wrap around, or is no number, never reaches the FMU."""
    with (
        native_fmu.instantiate() as instance,
        pytest.raises(FmuError, match=rf"^Native\.fmu: {name} = .* is no value of type \w+$"),
    ):
        instance.set({name: value})


@needs("cc")
def test_an_event_inside_a_step_is_no_error_and_an_early_return_is(native_fmu: FmuFile) -> None:
    """Without event mode a step that met an event is done; one that stopped before its end is not.

    Each step is judged by its own flags, not by those of the step before.
    """
    with native_fmu.instantiate() as instance:
        instance.start({})
        instance.step(0.0, 0.5)
        with pytest.raises(FmuError, match=r"h = 2\.0\) returns early at t = 1\.0$"):
            instance.step(0.0, 2.0)
        instance.step(0.0, 0.5)


@pytest.mark.parametrize(
    ("what", "said"),
    [
        ("discard", r"without a message \(status discarded\)"),
        ("raise", r".*the slider has had enough.* \(status fatal\)"),
    ],
)
def test_a_step_that_is_not_done_is_an_error(
    misbehaving: Callable[[str], Path], what: str, said: str
) -> None:
    """An FMU 2.0 that discards a step or fails in it says so on one line, with its own words."""
    with FmuFile(misbehaving(what)).instantiate() as instance:
        instance.start({})
        instance.step(0.0, 0.1)
        instance.step(0.1, 0.1)
        with pytest.raises(FmuError) as caught:
            instance.step(0.2, 0.1)
    name = f"Does{what.capitalize()}.fmu"
    call = r"fmi2DoStep\(t = 0\.2, h = 0\.1\) failed"
    assert re.fullmatch(rf"{name}: {call}: {said}", str(caught.value))


DRIVE = """
import sys
from pathlib import Path
from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.names import load_names

for path, names in zip(sys.argv[1::2], sys.argv[2::2]):
    fmu = FmuFile(Path(path), load_names(Path(names)) if names else None)
    kept = [fmu.instantiate() for _ in range(2)]
    for instance in kept:
        instance.start({})
        for n in range(3):
            print(n, flush=True)
            instance.step(n * 0.1, 0.1)
    kept[0].free()
print("done")
"""


def drive(*files: tuple[Path, str]) -> subprocess.Popen[str]:
    """Start a process that takes three steps on each FMU and leaves an instance unfreed."""
    arguments = itertools.chain.from_iterable((str(path), names) for path, names in files)
    return subprocess.Popen(
        [sys.executable, "-c", DRIVE, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def test_a_process_ends_well_after_any_fmu(
    slider_si: Path, slider_mm: Path, fmu_path: Path
) -> None:
    """Processes that drove FMUs of either wrapper, in any order, end without a crash or a word."""
    si = (slider_si, str(HERE / "slider_si.toml"))
    mm = (slider_mm, str(HERE / "slider_mm.toml"))
    ours = (fmu_path, "")
    processes = [drive(si), drive(si, mm, ours), drive(ours, mm, si)]
    for process in processes:
        out, err = process.communicate(timeout=60)
        assert (process.returncode, out.splitlines()[-1:], err) == (0, ["done"], "")


def test_a_crash_takes_the_process_with_it(misbehaving: Callable[[str], Path]) -> None:
    """The crashing FMU does crash: its process is killed by a signal in its third step."""
    process = drive((misbehaving("crash"), ""))
    out, _ = process.communicate(timeout=60)
    assert process.returncode < 0
    assert out.splitlines() == ["0", "1", "2"]


def test_a_hang_lasts(misbehaving: Callable[[str], Path]) -> None:
    """The hanging FMU does hang: its third step is not over after many times what two took."""
    process = drive((misbehaving("hang"), ""))
    assert process.stdout is not None
    assert [process.stdout.readline() for _ in range(3)] == ["0\n", "1\n", "2\n"]
    time.sleep(0.3)
    still_running = process.poll() is None
    process.kill()
    process.communicate()
    assert still_running
