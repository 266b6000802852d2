"""Probes of how masters call: what each of them sees, and what it leaves alone."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Literal

import pytest

from stickslip_fmu.packer import build
from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.names import NameMap
from stickslip_verification.drive.planting import plant
from stickslip_verification.drive.probes import PROBES, environments, fresh_process, memory
from stickslip_verification.drive.probes.calls import differences
from stickslip_verification.drive.stepping import NotApplicableError
from stickslip_verification.suite.faults import load_mutants
from stickslip_verification.suite.invariants import FOLDER, load_invariants

INVARIANTS = {invariant.id: invariant for invariant in load_invariants().probes}
CALLS = [
    each
    for each, invariant in INVARIANTS.items()
    if f'id = "{each}"' in (FOLDER / "calls.toml").read_text(encoding="utf-8")
]
MEMORY = [each for each in CALLS if each.startswith("memory-")]


def asked(invariant: str, file: FmuFile, **arguments: object) -> list[str]:
    """Return the complaints of a probe about an FMU; some arguments may be others."""
    probe = INVARIANTS[invariant]
    return PROBES[probe.probe](file, **{**probe.arguments, **arguments})


@pytest.fixture(scope="module")
def fmi3(tmp_path_factory: pytest.TempPathFactory) -> Iterator[FmuFile]:
    """Return our FMU 3.0, opened."""
    file = FmuFile(build(tmp_path_factory.mktemp("fmi3"), face=3))
    yield file
    file.close()


@pytest.mark.parametrize("invariant", CALLS)
def test_an_fmu_3_passes_too(fmi3: FmuFile, invariant: str) -> None:
    """Our FMU 3.0 gives no probe of calls a reason to complain."""
    fewer = {"count": 100 if "instances" in invariant else 5000} if invariant in MEMORY else {}
    assert asked(invariant, fmi3, **fewer) == []


@pytest.fixture(autouse=True)
def on_a_busy_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let fresh processes and measurements take their time."""
    monkeypatch.setattr(environments, "_PATIENCE", 600.0)
    monkeypatch.setattr(memory, "_PATIENCE", 100.0)


PLANTED = {
    "clamp-when-set": ("parameters-in-any-order", r"x is .* after step \d+"),
    "load-checked-where-set": ("load-before-mass", "load = -15.0"),
    "coefficients-one-by-one": ("coefficients-in-any-order", r"x is .* and not"),
    "clamp-kept": ("mu_s-raised-after-clamp", "mu_k_used is 0.24, not 0.375"),
    "clamp-as-it-began": ("mu_s-raised-in-clamp", "mu_k_used is 0.115, not 0.24"),
    "clamp-kept-in-slip": ("mu_s-raised-after-clamp-in-slip", "mu_k_used is 0.24, not 0.3"),
    "event-at-the-end-of-a-step-early": ("sticks-at-break-away", "sticking is 0.0, not 1.0"),
    "event-at-the-end-of-a-step-lost": ("slips-after-break-away", "mode is 0.0, not 1.0"),
    "restick-at-the-end-of-a-step-lost": ("step-ends-at-restick", "x is .* after step 1"),
    "restick-after-the-end-of-a-step": ("rests-at-restick", "mode is 1.0, not 0.0"),
    "step-from-absolute-times": ("late-start", "x is .* and not"),
    "durations-from-event-times": ("late-start-to-the-bit", "x is .* and not"),
    "start-settles-before-zero": ("early-start", "x_pull is 0.0 and not"),
    "start-time-of-day": ("starts-at-a-million-seconds", r"dated \d+\.\d+, not 1000000.24525"),
    "start-before-zero": ("starts-before-zero", "t_event begins with 0.0, not -3.0"),
    "state-of-this-process": ("state-in-a-fresh-process", "deserialize|set FMU state"),
    "state-without-parameters": ("state-in-a-fresh-process", "x is .* and not"),
    "environment-time-zone": ("environment", "^the time zone: t_event is"),
    "environment-locale": ("environment-to-the-bit", "^the locale: .* failed"),
    "environment-home": ("environment", "^no home folder: .* failed"),
    "environment-working-folder": ("environment", "^in another working folder: .* failed"),
}


@pytest.mark.parametrize("mutant", PLANTED)
def test_a_fault_of_calls_is_told(fmu_path: Path, tmp_path: Path, mutant: str) -> None:
    """A fault that shows in one manner of calling only is complained of, with what differs."""
    (described,) = load_mutants(mutant)
    invariant, told = PLANTED[mutant]
    assert invariant in described.detected_by
    file = FmuFile(plant(fmu_path, described, tmp_path))
    complaints = " ".join(_complaints(invariant, file))
    file.close()
    assert re.search(told, complaints), complaints


def _complaints(invariant: str, file: FmuFile) -> list[str]:
    """Return the complaints of a probe; a refused call is one."""
    try:
        return asked(invariant, file)
    except RuntimeError as error:
        return [str(error)]


def test_a_foreign_fmu_is_asked_what_it_can(slider_si: Path, slider_si_names: NameMap) -> None:
    """Physics finds nothing in an honest slider; what it lacks does not apply, by name."""
    file = FmuFile(slider_si, slider_si_names)
    lacking = {}
    for each in CALLS:
        if INVARIANTS[each].klass == "physics":
            try:
                assert asked(each, file) == []
            except NotApplicableError as error:
                lacking[each] = str(error)
    file.close()
    assert lacking == {
        "load-before-mass": "it has no variable load",
        "coefficients-in-any-order": "it cannot change mu_k on the way",
        "mu_s-raised-after-clamp-motion": "it cannot change mu_s on the way",
    }


def test_a_stock_wrapper_may_keep_its_module(slider_mm: Path, slider_mm_names: NameMap) -> None:
    """The stock wrapper keeps 23 kB of each instance of this module: no fault of the FMU."""
    file = FmuFile(slider_mm, slider_mm_names)
    assert asked("memory-of-instances", file) == []
    file.close()


def test_a_state_that_is_not_taken_up_is_told(
    ours: FmuFile, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Bytes that the fresh process does not take up are a complaint with the FMU's message."""
    monkeypatch.setattr(environments, "_written", lambda _: b"null")
    (complaint,) = asked("state-in-a-fresh-process", ours)
    assert "failed" in complaint


@pytest.mark.parametrize(
    ("what", "told"),
    [
        ("crash", r"^the process ended with exit code -?\d+$"),
        ("hang", r"^no answer within 3 s$"),
        ("raise", r"the slider has had enough"),
    ],
)
def test_what_goes_wrong_in_a_fresh_process_is_told(
    misbehaving: Callable[[str], Path],
    ours: FmuFile,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    what: str,
    told: str,
) -> None:
    """A crash, a hang and a failure in the fresh process are complaints, and leave no file."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setattr(fresh_process, "LIMIT", 3.0 if what == "hang" else 60.0)
    monkeypatch.setattr(ours, "path", misbehaving(what))
    complaints = PROBES["elsewhere"](
        ours, environments={}, calls=[{"start": 0.0}], then=[{"step": 0.01, "times": 3}]
    )
    assert re.search(told, complaints[0].removeprefix("in a fresh process: "))
    assert not list(tmp_path.iterdir())


@pytest.fixture
def ours(fmu_path: Path) -> Iterator[FmuFile]:
    """Return our FMU, opened."""
    file = FmuFile(fmu_path)
    yield file
    file.close()


def test_motions_differ_by_a_part_of_the_largest_value_in_the_unit() -> None:
    """A small quantity may differ by a part of a large one in its unit; a discrete one must not."""
    rows = [{"x": 100.0, "z": 1e-3, "mode": 0.0}, {"x": 100.0, "z": 2e-3, "mode": 1.0}]
    other = [{"x": 100.0, "z": 1e-3, "mode": 0.0}, {"x": 100.0, "z": 2.05e-3, "mode": 1.0}]
    assert differences(other, rows, 1e-6) == []
    assert differences(other, rows) == ["z is 0.00205 and not 0.002 after step 2"]
    assert differences(other, rows, 1e-7) == differences(other, rows)
    assert differences(other, rows, None, ["z"]) == []
    reversed_ = [rows[0], {**rows[1], "mode": -1.0}]
    assert differences(reversed_, rows, 1.0) == ["mode is -1.0 and not 1.0 after step 2"]
    nothing = [{**rows[0], "z": float("nan")}]
    assert differences(nothing, nothing) == []
    assert differences(nothing, rows[:1], 1.0) == ["z is nan and not 0.001 after step 1"]


WARM_UP = (10_000, 3_000_000)


def test_a_loss_of_32_bytes_is_told() -> None:
    """A growth in every part is a loss, told with its size; so is one in most parts."""
    loss = [WARM_UP, *[(10_000, 327_680)] * 9]
    (complaint,) = memory.judged(loss, "step", 4.0, 5.0)
    assert complaint == "each step keeps 33 bytes; 4 at most"
    assert memory.judged([*loss[:7], *[(10_000, -900_000)] * 3], "step", 4.0, 5.0) == [complaint]


def test_a_cache_is_no_loss() -> None:
    """Memory that is taken in few parts, or a page now and then, is no loss."""
    jumps = [WARM_UP, *[(10_000, 0)] * 5, *[(10_000, 4_000_000)] * 4]
    assert memory.judged(jumps, "step", 4.0, 5.0) == []
    assert memory.judged([WARM_UP, *[(30, 40_960)] * 9], "instance", 1024.0, 5.0) == []


def test_what_is_slow_is_measured_for_a_while() -> None:
    """A measurement that was cut short still shows a loss; a few parts show nothing."""
    slow = [(12, 700_000), *[(5, 500_000)] * 4]
    assert memory.judged(slow, "step", 4.0, 5.0) == ["each step keeps 100000 bytes; 4 at most"]
    with pytest.raises(NotApplicableError, match="22 times in 5 s are too few to see a loss"):
        memory.judged(slow[:3], "step", 4.0, 5.0)


LOSSES = {
    "memory-of-steps": "memory-of-steps",
    "memory-of-bytes": "memory-of-states",
    "memory-of-instances": "memory-of-instances",
}


@pytest.mark.parametrize("mutant", LOSSES)
def test_a_loss_of_memory_is_told(fmu_path: Path, tmp_path: Path, mutant: str) -> None:
    """An FMU that keeps what nobody needs is complained of, with the size."""
    (described,) = load_mutants(mutant)
    file = FmuFile(plant(fmu_path, described, tmp_path))
    (complaint,) = asked(LOSSES[mutant], file)
    file.close()
    assert re.fullmatch(r"each \w+ keeps \d+ bytes; \d+ at most", complaint)


@pytest.mark.soak
@pytest.mark.parametrize("face", [2, 3])
@pytest.mark.parametrize("invariant", MEMORY)
def test_no_memory_is_kept_for_long(tmp_path: Path, face: Literal[2, 3], invariant: str) -> None:
    """Ten times as many steps, states and instances keep no memory either."""
    file = FmuFile(build(tmp_path, face=face))
    count = 10 * INVARIANTS[invariant].arguments["count"]
    assert asked(invariant, file, count=count, seconds=300.0) == []
    file.close()
