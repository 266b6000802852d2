"""`stickslip simulate`, `build` and `critical`: what they print and write."""

import hashlib
import os
import re
import signal
import sys
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy.util import read_csv

from stickslip import cli, library
from stickslip.parameters import Parameters
from stickslip.runs import Experiment, experiment, simulate_fmu, simulate_reference
from stickslip_fmu.release import VERSION
from stickslip_fmu.spec import TABLE
from tests.interrupting import PROGRAM, session, wait_for_work
from tests.python import python, run
from tests.workbench.running import Command

each_engine = pytest.mark.parametrize("engine", ["fmu", "reference"])
RUNS: dict[str, Any] = {
    "default": {},
    "reversed": {"v": -0.02, "F_ext": 1.0},
    "damped": {"c": 1.0},
    "sliding": {"c": 30.0, "v": 0.1},
    "ringing": {"v": 0.0, "x_dot_start": 1.0, "k": 1e4},
    "turning": {"x_dot_start": -0.5, "k": 3000.0},
    "beyond": {"z_start": 0.02},
    "no gap": {"mu_k": 0.5},
    "resting": {"v": 0.0},
}


@pytest.mark.parametrize("interval", [0.004, 0.03])
@pytest.mark.parametrize("name", RUNS)
def test_both_engines_give_the_same_run(fmu_path: Path, name: str, interval: float) -> None:
    what = Experiment(Parameters(**RUNS[name]), 0.5, 2.5, interval)
    fmu = simulate_fmu(what, fmu_path, lambda done, total: None)
    reference = simulate_reference(what)
    assert fmu.samples.dtype == reference.samples.dtype
    assert fmu.hidden_events == 0
    assert [(e.kind, e.mode) for e in fmu.events] == [(e.kind, e.mode) for e in reference.events]
    # The reference integrates each slip to some 1e-13 of its scale; 1e-9 leaves room for 60 slips.
    for mine, other in zip(fmu.events, reference.events, strict=True):
        assert (mine.time, mine.x, mine.z) == pytest.approx(
            (other.time, other.x, other.z), abs=1e-9
        )
    for output in ("x", "z", "F", "Q_friction", "T"):
        scale = float(np.max(np.abs(reference.samples[output])))
        assert fmu.samples[output] == pytest.approx(reference.samples[output], abs=1e-9 * scale)


def test_progress_goes_to_the_end_and_a_run_to_be_drawn_has_fine_samples(fmu_path: Path) -> None:
    seen: list[tuple[float, float]] = []
    what = experiment(Parameters(), 1.0, 3.0)
    simulate_fmu(what, fmu_path, lambda done, total: seen.append((done, total)))
    assert [seen[0], seen[-1]] == [pytest.approx((0.01, 2.0)), pytest.approx((2.0, 2.0))]
    stiff = Parameters(k=1e7)
    assert experiment(stiff, 0.0, 1.0).output_interval == 0.01
    # w = 3162 rad/s: half a radian is 0.16 ms.
    assert experiment(stiff, 0.0, 1.0, drawn=True).output_interval == 0.01 / 64
    assert experiment(stiff, 0.0, 1.0, 0.05, drawn=True).output_interval == 0.05


def test_every_parameter_and_input_of_the_fmu_is_an_option(command: Command) -> None:
    said = " ".join(command.passes("simulate", "--help").split())
    for variable in TABLE.rows:
        option = "--" + variable.name.replace("_", "-")
        if variable.settable:
            unit = "" if variable.unit == "1" else f"[{variable.unit}]"
            described = re.escape(option) + r"\b[^.]* VALUE .*?" + re.escape(unit)
            assert re.search(described + rf".*?default {variable.start:g}\.", said)
        else:
            assert f" {option} " not in said


def test_build_prints_path_size_and_digest(command: Command, tmp_path: Path) -> None:
    answer = command.in_fresh_process("build", "--bare")
    content = (tmp_path / "build" / "StickSlip.fmu").read_bytes()
    digest = hashlib.sha256(content).hexdigest()
    words = ["build/StickSlip.fmu", str(len(content)), "bytes", "SHA-256", digest]
    assert (answer.code, answer.out.split()) == (0, words)
    assert command.in_fresh_process("build", "--bare", "-o", "c/other.fmu").code == 0
    assert (tmp_path / "c" / "other.fmu").read_bytes() == content


def test_the_fmu_of_a_run_is_the_block_without_its_documentation(
    command: Command, fmu_path: Path
) -> None:
    built = "from pathlib import Path; from stickslip_fmu.packer import build as b"
    python("-c", f"{built}; b(Path())")
    with zipfile.ZipFile("StickSlip.fmu") as bare, zipfile.ZipFile(fmu_path) as documented:
        names = bare.namelist()
        assert {name.partition("/")[0] for name in names} == {
            "binaries", "modelDescription.xml", "resources"
        }  # fmt: skip
        assert all(bare.read(name) == documented.read(name) for name in names)


@each_engine
def test_the_table_shows_the_cycle_three_times_and_the_csv_every_output(
    command: Command, tmp_path: Path, engine: str
) -> None:
    answer = command.simulate(engine, "--stop-time", "2", "--output-file", "run.csv")
    assert (answer.code, answer.err) == (0, "")
    (jump,) = (line for line in answer.out.splitlines() if "jump of the mass" in line)
    assert jump.count("6.30536") == 2
    assert answer.out.endswith("\nwritten: run.csv\n")
    table = read_csv(tmp_path / "run.csv")
    outputs = [variable.name for variable in TABLE.rows if variable.causality == "output"]
    assert sorted(table.dtype.names) == sorted(["time", *outputs])
    assert len(table) == 201
    assert np.all(table["x"][table["n_slips"] == 0][:20] == 0.0)
    # Written with all digits: 20 mm/s for 2 s, two roundings.
    assert table["x_pull"][-1] == pytest.approx(0.04, rel=4e-16)


@each_engine
@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["--v", "0"], "the pulled end does not move"),
        (["--c", "30", "--v", "0.1"], "above the critical velocity"),
        (["--c", "100"], "over-damped"),
        (["--c", "5", "--mu-k", "0.5"], "without a gap"),
        (["--stop-time", "0.1"], "the mass never broke away"),
        (["--stop-time", "0.4"], "the mass did not break away twice"),
    ],
)
def test_where_there_is_no_cycle_the_table_says_why(
    command: Command, engine: str, arguments: list[str], reason: str
) -> None:
    answer = command.simulate(engine, "--stop-time", "1", *arguments)
    assert answer.code == 0
    assert reason in answer.out


@each_engine
def test_the_clamp_of_mu_k_is_told_once(command: Command, engine: str) -> None:
    answer = command.simulate(engine, "--mu-k", "0.6", "--stop-time", "1")
    assert answer.code == 0
    assert re.fullmatch(r"stickslip: warning: mu_k = 0\.6.*mu_s = 0\.5.*\n", answer.err)


def test_a_failing_call_ends_in_the_words_of_the_fmu(fmu_path: Path) -> None:
    p = Parameters()
    vars(p)["values"]["k"] = -1.0
    with pytest.raises(RuntimeError, match=r"k = -1\.0 N/m is out of range"):
        simulate_fmu(experiment(p, 0.0, 1.0), fmu_path, lambda done, total: None)


@each_engine
def test_a_plot_is_drawn_backward_too_and_says_what_it_lacks(
    command: Command, tmp_path: Path, engine: str
) -> None:
    typed = ("--v", "-20mm/s", "--F-ext", "1 N", "--plot", "run.svg", "--stop-time")
    assert command.simulate(engine, *typed, "1").code == 0
    assert (tmp_path / "run.svg").read_text(encoding="utf-8").startswith("<?xml")
    coarse = command.simulate("fmu", *typed, "10", "--output-interval", "1")
    assert "choose a shorter --output-interval" in coarse.err


@pytest.mark.skipif(sys.platform == "win32", reason="SIGINT cannot be sent to one process there")
@pytest.mark.parametrize("verb", ["simulate", "verify"])
def test_ctrl_c_ends_a_run_without_files_or_processes(
    tmp_path: Path, fmu_path: Path, verb: str
) -> None:
    # Sockets of processes need a short name.
    scratch, work = tmp_path / "s", tmp_path / "work"
    scratch.mkdir()
    work.mkdir()
    # Long enough that nobody waits for its end: a million steps.
    size = ["--stop-time", "1000", "--output-interval", "0.001", "--output-file", "run.csv"]
    options = size if verb == "simulate" else ["-o", "r.json"]
    command = (verb, "--fmu", str(fmu_path), *options)
    with session(*command, folder=work, scratch=scratch) as running:
        # Loading takes less than two.
        wait_for_work(running, 3.0)
        os.killpg(running.pid, signal.SIGINT)
        out, err = running.communicate(timeout=60)
    assert (running.returncode, out, err) == (130, "", "stickslip: interrupted\n")
    assert not list(work.iterdir())
    assert not list(scratch.glob("stickslip*"))


def test_a_table_fits_any_code_page(command: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONIOENCODING", "ascii")
    answer = command.in_fresh_process("simulate", "--engine", "reference", "--stop-time", "1")
    assert (answer.code, answer.err) == (0, "")


@pytest.mark.parametrize(
    ("line", "code", "said"),
    [
        # Who closes an output gets the file all the same; a reader that goes away is no error.
        ("page -o page.html >&-", 0, ""),
        ("page -o page.html 2>&-", 0, ""),
        ("page -o page.html >&- 2>&-", 0, ""),
        ("verify --list | true", 0, ""),
        ("--version >/dev/full", 2, "No space left"),
        ("--version", 0, f"stickslip {VERSION}"),
    ],
)
def test_outputs_that_are_closed_or_full(tmp_path: Path, line: str, code: int, said: str) -> None:
    program = f'"{sys.executable}" -c "{PROGRAM}" {line}'
    done = run("sh", "-c", program, cwd=tmp_path)
    assert min(done.returncode, 1) == min(code, 1)
    assert said in done.stdout + done.stderr
    assert (done.stdout + done.stderr).count("\n") <= 1
    assert (tmp_path / "page.html").is_file() == ("page.html" in line)


def test_a_fault_of_ours_is_not_wrong_use(
    command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(library, "simulate", lambda *_, **__: 1 / 0)
    answer = command("simulate", "--engine", "reference")
    assert answer.code == cli.INTERNAL_ERROR == 70
    assert re.fullmatch(r"stickslip: internal error.*\n", answer.err)


@pytest.mark.gate
def test_bounds_of_the_critical_search_are_those_typed_or_hold_the_velocity(
    command: Command,
) -> None:
    law = ("critical", "--law", "stribeck")
    assert "searched: 10 mm/s to 20 mm/s" in command.passes(*law, "--from", "10mm/s", "--to=20mm/s")
    for v, searched in (("-7m/s", "to 7 m/s"), ("1um/s", "1 µm/s to ")):
        said = command.passes(*law, "--c", "2", "--v", v)
        assert "the mass moves evenly" in said
        assert searched in said
