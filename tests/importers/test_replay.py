"""A sequence of calls gives the same bits in every importer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest

from stickslip_fmu.spec import TABLE
from tests.needs import each, needs

from . import record, replay
from .cases import CASES
from .host_c import Host, compile_host, unpack, with_libpython
from .record import Call
from .running import CONTAINERS, IMPORTERS, Rows, run


@dataclass(frozen=True)
class Recorded:
    """What an importer showed in a run, and the calls that it made for it."""

    rows: Rows
    calls: list[Call]


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory, fmu_path: Path) -> Host:
    """Give the host written in C, ready to run the FMU."""
    folder = tmp_path_factory.mktemp("host")
    return with_libpython(compile_host(folder), unpack(fmu_path, folder / "fmu"))


@pytest.fixture(scope="module")
def recorded(
    tmp_path_factory: pytest.TempPathFactory, fmu_path: Path
) -> Callable[[str, str], Recorded]:
    """Give what runs a case in an importer, once, with an FMU that writes down the calls."""
    folder = tmp_path_factory.mktemp("recording")
    fmu = record.recording_fmu(fmu_path, folder / "StickSlip.fmu")

    @cache
    def once(importer: str, case: str) -> Recorded:
        calls = folder / f"{importer}-{case}.txt"
        own = folder / f"{importer}-{case}"
        own.mkdir()
        rows = run(importer, fmu, case, own, record.environment(calls))
        return Recorded(rows, record.read(calls))

    return once


@needs("cc", "libpython")
@pytest.mark.parametrize("case", ["default", "inputs"])
@pytest.mark.parametrize("importer", each(IMPORTERS))
def test_a_replay_in_another_importer_repeats_every_bit(
    recorded: Callable[[str, str], Recorded],
    fmu_path: Path,
    host: Host,
    tmp_path: Path,
    importer: str,
    case: str,
) -> None:
    """The calls of one importer, made again by FMPy and by a host in C, read the same numbers."""
    calls = recorded(importer, case).calls
    asked = replay.asked(calls)
    assert len(asked) >= CASES[case].steps
    assert replay.by_fmpy(calls, fmu_path, tmp_path) == asked
    assert replay.in_c(calls, host) == asked


@pytest.mark.parametrize("case", ["default", "inputs"])
@pytest.mark.parametrize("importer", each(IMPORTERS))
def test_an_importer_shows_what_the_fmu_answered(
    recorded: Callable[[str, str], Recorded], importer: str, case: str
) -> None:
    """What stands in an importer's result are the FMU's own numbers, to the bit."""
    run_ = recorded(importer, case)
    instances = record.instances(run_.calls)
    assert len(instances) == (2 if importer in CONTAINERS else 1)
    for instance, rows in zip(instances, (run_.rows, run_.rows.nested), strict=False):
        assert rows is not None
        # Some importers show the start, some begin with the end of the first step.
        points = record.points(run_.calls, instance)[-len(rows.times) :]
        for name, samples in rows.outputs.items():
            reference = TABLE.by_name[name].number
            assert replay.bits(samples) == replay.bits([point[reference] for point in points])


@needs("ecospy", "fmucontainer")
def test_importers_do_not_hand_over_the_same_steps(
    recorded: Callable[[str, str], Recorded],
) -> None:
    """For a step of 0.01 s some hand over that number, some the difference of two times."""
    lengths, sequences, ends = {}, {}, {}
    for importer in ("fmpy", "ecospy", "fmucontainer"):
        calls = recorded(importer, "default").calls
        instance = record.instances(calls)[0]
        steps = record.steps(calls, instance)
        ends[importer] = record.points(calls, instance)[-1]
        assert len(steps) == CASES["default"].steps
        sequences[importer] = steps
        lengths[importer] = {h for _, h in steps}
    assert min(lengths["fmpy"]) == 0.009999999999999787
    assert lengths["ecospy"] == lengths["fmucontainer"] == {0.01}
    # Equal lengths, but one adds them up and the other multiplies.
    assert sequences["ecospy"] != sequences["fmucontainer"]
    # What equal bits are worth: with other steps the last digits are others.
    assert ends["fmpy"] != ends["ecospy"]
