"""The command as a person meets it: what it prints, writes and answers."""

import hashlib
import os
import re
import signal
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmpy.util import read_csv

from stickslip import cli
from stickslip.commands import simulate
from stickslip_fmu.release import VERSION
from stickslip_fmu.spec import TABLE
from tests.interrupting import PROGRAM, session, wait_for_work

from .running import Command


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (["--k", "-1"], ["--k '-1'", "above 0"]),
        (["--k", "nan"], ["--k 'nan'", "above 0"]),
        (["--m", "0"], ["--m '0'", "above 0"]),
        (["--g", "0"], ["--g '0'", "above 0"]),
        (["--c", "-1"], ["--c '-1'", "at least 0"]),
        (["--mu-s", "abc"], ["--mu-s 'abc'", "at least 0"]),
        (["--mu-k", "-0.1"], ["--mu-k '-0.1'", "at least 0"]),
        (["--v", "inf"], ["--v 'inf'", "a velocity in m/s", "finite"]),
        (["--v", "5 N"], ["--v '5 N' is a force", "a velocity in m/s"]),
        (["--load", "-10"], ["load = -10.0 N", ">= -m g = -9.81 N"]),
        (["--stop-time", "-1"], ["--stop-time '-1'", "> 0 s"]),
        (["--start-time", "2", "--stop-time", "1"], ["--stop-time '1'", "> 2 s"]),
        (["--output-interval", "0"], ["--output-interval '0'", "above 0 s"]),
        (["--output-interval", "1e-12"], ["--output-interval '1e-12'", "at least 1e-06 s"]),
        (["--output-file", "missing/run.csv"], ["--output-file", "no folder missing"]),
        (["--output-file", "."], ["--output-file", "it is a folder"]),
        (["--plot", "run.gif"], ["--plot run.gif", ".png, .svg or .pdf"]),
        (["--engine", "abaqus"], ["--engine", "abaqus", "fmu", "reference"]),
        (["--fmu", "none.fmu"], ["--fmu none.fmu", "no such file"]),
        (["--engine", "reference", "--fmu", "a.fmu"], ["--fmu", "--engine fmu only"]),
        (["--spring", "1"], ["--spring"]),
        (["--k"], ["--k"]),
        (["--F_s", "1"], ["--F_s"]),
    ],
)
def test_wrong_use_is_answered_in_one_line(
    command: Command, tmp_path: Path, arguments: list[str], parts: list[str]
) -> None:
    """Exit code 2, one line with name, value and range, and no file."""
    answer = command("simulate", *arguments)
    assert answer.code == 2
    assert answer.out == ""
    assert answer.err.startswith("stickslip: ")
    assert answer.err.count("\n") == 1
    for part in parts:
        assert part in answer.err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "arguments", [[], ["fly"], ["verify", "--cases", "none"], ["verify", "--fmu", "none.fmu"]]
)
def test_wrong_use_of_other_commands_is_one_line_too(
    command: Command, arguments: list[str]
) -> None:
    """No command, no such command, no such case, no such FMU: exit code 2 and a reason."""
    answer = command(*arguments)
    assert answer.code == 2
    assert answer.err.startswith("stickslip: ")
    assert answer.err.count("\n") == 1


def test_every_parameter_and_input_of_the_fmu_is_an_option(command: Command) -> None:
    """Whatever the FMU lets a simulator set, the command lets a person set, and says its unit."""
    said = " ".join(command("simulate", "--help").out.split())
    for variable in TABLE.rows:
        option = "--" + variable.name.replace("_", "-")
        if variable.settable:
            unit = "" if variable.unit == "1" else f"[{variable.unit}]"
            described = re.escape(option) + r"\b[^.]* VALUE .*?" + re.escape(unit)
            assert re.search(described + rf".*?default {variable.start:g}\.", said)
        else:
            assert f" {option} " not in said


def test_build_prints_path_size_and_digest(command: Command, tmp_path: Path) -> None:
    """What is printed is what is on the disk; without -o that is build/StickSlip.fmu."""
    answer = command.in_fresh_process("build")
    content = (tmp_path / "build" / "StickSlip.fmu").read_bytes()
    digest = hashlib.sha256(content).hexdigest()
    assert answer.code == 0
    assert answer.out.split() == [
        "build/StickSlip.fmu", str(len(content)), "bytes", "SHA-256", digest
    ]  # fmt: skip


def test_build_takes_a_folder_or_a_file(command: Command, tmp_path: Path) -> None:
    """A folder gets StickSlip.fmu, a file ending in .fmu is that file; both are the same bytes."""
    assert command.in_fresh_process("build", "--bare", "-o", "a/b").code == 0
    assert command.in_fresh_process("build", "--bare", "-o", "c/other.fmu").code == 0
    first = tmp_path / "a" / "b" / "StickSlip.fmu"
    assert first.read_bytes() == (tmp_path / "c" / "other.fmu").read_bytes()


@pytest.mark.parametrize("engine", ["fmu", "reference"])
def test_fmpy_reads_the_csv_back(command: Command, tmp_path: Path, engine: str) -> None:
    """Every output is a column, every number comes back, and a stick is one value of x."""
    answer = command.simulate(engine, "--stop-time", "2", "--output-file", "run.csv")
    assert answer.code == 0, answer.err
    table = read_csv(tmp_path / "run.csv")
    outputs = [variable.name for variable in TABLE.rows if variable.causality == "output"]
    assert sorted(table.dtype.names) == sorted(["time", *outputs])
    assert len(table) == 201
    first_stick = table["x"][table["n_slips"] == 0][:20]
    assert np.all(first_stick == 0.0)
    # Written with all digits: 20 mm/s for 2 s, two roundings.
    assert table["x_pull"][-1] == pytest.approx(0.04, rel=4e-16)


def test_both_engines_write_the_same_columns_at_the_same_times(
    command: Command, tmp_path: Path
) -> None:
    """The two CSV files can be compared row by row."""
    for engine in ("fmu", "reference"):
        assert command.simulate(engine, "--output-file", f"{engine}.csv").code == 0
    fmu, reference = (read_csv(tmp_path / f"{engine}.csv") for engine in ("fmu", "reference"))
    assert fmu.dtype.names == reference.dtype.names
    # Times are sums of doubles on one side and products on the other.
    assert fmu["time"] == pytest.approx(reference["time"], rel=1e-14, abs=1e-15)
    # The reference integrates to about 1e-10 of the motion, over 31 cycles.
    assert fmu["x"] == pytest.approx(reference["x"], abs=1e-9)


@pytest.mark.parametrize("engine", ["fmu", "reference"])
def test_units_typed_are_si_values(command: Command, tmp_path: Path, engine: str) -> None:
    """The same quantities with and without units give the same run."""
    with_units = ["--v", "20mm/s", "--k", "1 kN/m", "--m", "1000 g", "--stop-time", "500 ms"]
    plain = ["--v", "0.02", "--k", "1000", "--m", "1", "--stop-time", "0.5"]
    for name, values in (("a.csv", with_units), ("b.csv", plain)):
        assert command.simulate(engine, *values, "--output-file", name).code == 0
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()


@pytest.mark.parametrize("engine", ["fmu", "reference"])
def test_the_table_shows_the_cycle_three_times(command: Command, engine: str) -> None:
    """Measured, exact and simplified: the jump is 6.305 mm, the simplified one 3.924 mm."""
    answer = command.simulate(engine)
    assert answer.code == 0
    jump = next(line for line in answer.out.splitlines() if "jump of the mass" in line)
    assert jump.count("6.30536") == 2
    assert "3.924" in jump
    # 3.924 mm / 6.305 mm - 1
    assert "-37.77 %" in jump
    assert answer.err == ""


@pytest.mark.parametrize("engine", ["fmu", "reference"])
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
def test_where_there_is_no_cycle_the_table_says_so(
    command: Command, engine: str, arguments: list[str], reason: str
) -> None:
    """An empty column is explained, and it is no error."""
    answer = command.simulate(engine, "--stop-time", "1", *arguments)
    assert answer.code == 0
    assert reason in answer.out


@pytest.mark.parametrize("engine", ["fmu", "reference"])
def test_the_clamp_of_mu_k_is_told_once(command: Command, engine: str) -> None:
    """mu_k above mu_s is no error: one line on standard error names both."""
    answer = command.simulate(engine, "--mu-k", "0.6", "--stop-time", "1")
    assert answer.code == 0
    assert answer.err.startswith("stickslip: warning: mu_k = 0.6")
    assert "mu_s = 0.5" in answer.err
    assert answer.err.count("\n") == 1


def test_what_the_fmu_says_reaches_the_person(command: Command, fmu_path: Path) -> None:
    """A failing call of the FMU ends in its own message."""
    from stickslip.errors import CommandError
    from stickslip.simulate.engines import experiment, simulate_fmu
    from stickslip_fmu.spec import TABLE

    values = {**TABLE.start_values(), "k": -1.0}
    with pytest.raises(CommandError, match=r"k = -1\.0 N/m is out of range"):
        simulate_fmu(experiment(values, 0.0, 1.0), fmu_path, lambda done, total: None)


def test_a_file_that_is_no_fmu_is_refused(command: Command, tmp_path: Path) -> None:
    """A text file under the name of an FMU: one line, exit code 2."""
    (tmp_path / "text.fmu").write_text("no archive", encoding="utf-8")
    answer = command("simulate", "--fmu", "text.fmu")
    assert answer.code == 2
    assert "--fmu text.fmu: not an FMU" in answer.err
    assert answer.err.count("\n") == 1


def test_an_old_file_survives_a_run_that_fails(command: Command, tmp_path: Path) -> None:
    """What was there is replaced by something whole or not at all."""
    (tmp_path / "run.csv").write_text("old", encoding="utf-8")
    (tmp_path / "text.fmu").write_text("no archive", encoding="utf-8")
    assert command("simulate", "--fmu", "text.fmu", "--output-file", "run.csv").code == 2
    assert (tmp_path / "run.csv").read_text(encoding="utf-8") == "old"
    assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.parametrize("engine", ["fmu", "reference"])
def test_a_reversed_pull_is_drawn(command: Command, tmp_path: Path, engine: str) -> None:
    """A run pulled backward, with an external force, makes a plot like any other."""
    answer = command.simulate(engine, "--v", "-20mm/s", "--F-ext", "1 N",
        "--stop-time", "1", "--plot", "run.svg",
    )  # fmt: skip
    assert answer.code == 0, answer.err
    assert (tmp_path / "run.svg").read_text(encoding="utf-8").startswith("<?xml")


def test_a_plot_that_lacks_events_is_told(command: Command) -> None:
    """With a step longer than a cycle the plot is incomplete, and a line says what to do."""
    answer = command.simulate(
        "fmu", "--output-interval", "1", "--plot", "run.png"
    )  # fmt: skip
    assert answer.code == 0
    assert "choose a shorter --output-interval" in answer.err


def test_a_table_in_a_pipe_is_not_folded(command: Command) -> None:
    """Every quantity stands in one line where there is no terminal to fit."""
    lines = command.simulate("fmu").out.splitlines()
    assert sum("period" in line for line in lines) == 1
    assert all("…" not in line for line in lines)


def test_the_version_is_that_of_the_release(command: Command) -> None:
    """--version prints name and number."""
    assert command("--version").out == f"stickslip {VERSION}\n"


@pytest.mark.skipif(sys.platform == "win32", reason="SIGINT cannot be sent to one process there")
@pytest.mark.parametrize("engine", ["fmu", "reference"])
def test_ctrl_c_ends_a_run_cleanly(tmp_path: Path, fmu_path: Path, engine: str) -> None:
    """Exit code 130, one line, no traceback, and nothing left in the folders."""
    scratch = tmp_path / "scratch"
    work = tmp_path / "work"
    scratch.mkdir()
    work.mkdir()
    of_fmu = ["--fmu", str(fmu_path)] if engine == "fmu" else []
    # Long enough that nobody waits for its end: a million steps or cycles.
    size = ["--stop-time", "10000", "--output-interval", "0.001"]
    command = ("simulate", "--engine", engine, *of_fmu, *size, "--output-file", "run.csv")
    with session(*command, folder=work, scratch=scratch) as running:
        # Loading takes less than one.
        wait_for_work(running, 2.5)
        running.send_signal(signal.SIGINT)
        out, err = running.communicate(timeout=60)
    assert running.returncode == 130
    assert err == "stickslip: interrupted\n"
    assert out == ""
    assert not list(work.iterdir())
    assert not list(scratch.iterdir())


def test_a_table_fits_any_code_page(command: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the output has no Greek letters, the table is printed all the same."""
    monkeypatch.setenv("PYTHONIOENCODING", "ascii")
    answer = command.in_fresh_process("simulate", "--engine", "reference", "--stop-time", "1")
    assert (answer.code, answer.err) == (0, "")


def test_a_reader_that_goes_away_is_no_error(tmp_path: Path) -> None:
    """A table whose reader closes the pipe ends without a word."""
    reading, writing = os.pipe()
    os.close(reading)
    with os.fdopen(writing, "wb") as pipe:
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM, "verify", "--list"],
            stdout=pipe,
            stderr=subprocess.PIPE,
            cwd=tmp_path,
        )
    assert (done.returncode, done.stderr) == (1, b"")


def test_a_fault_of_ours_is_not_wrong_use(
    command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An internal error has an exit code of its own, and one line instead of a traceback."""

    def broken(*_: object) -> None:
        raise ZeroDivisionError("planted")

    monkeypatch.setattr(simulate, "_run", broken)
    answer = command("simulate", "--engine", "reference")
    assert answer.code == cli.INTERNAL_ERROR == 70
    assert answer.err.startswith("stickslip: internal error")
    assert answer.err.count("\n") == 1


@pytest.mark.parametrize("subcommand", ["simulate", "verify", "prove"])
@pytest.mark.parametrize("member", ["readme.txt", "modelDescription.xml"])
def test_an_archive_that_is_no_fmu_is_wrong_use(
    command: Command, tmp_path: Path, subcommand: str, member: str
) -> None:
    """Without a model description, or with one that is not XML, a zip is refused in one line."""
    file = tmp_path / "broken.fmu"
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr(member, "not XML")
    answer = command(subcommand, "--fmu", file)
    assert answer.code == 2
    assert "not an FMU" in answer.err
    assert answer.err.count("\n") == 1


@pytest.mark.parametrize("subcommand", ["simulate", "verify", "prove"])
def test_a_damaged_fmu_is_wrong_use(
    command: Command, fmu_path: Path, tmp_path: Path, subcommand: str
) -> None:
    """An FMU whose binary was damaged on the way is refused in one line."""
    with zipfile.ZipFile(fmu_path) as archive:
        binary = max(archive.infolist(), key=lambda member: member.compress_size)
    content = bytearray(fmu_path.read_bytes())
    middle = binary.header_offset + binary.compress_size // 2
    content[middle : middle + 100] = b"\xff" * 100
    file = tmp_path / "damaged.fmu"
    file.write_bytes(content)
    answer = command(subcommand, "--fmu", file)
    assert answer.code == 2
    assert "damaged.fmu" in answer.err
    assert answer.err.count("\n") == 1


@pytest.mark.parametrize("closing", [">&-", "2>&-", ">&- 2>&-"])
def test_closed_streams_are_no_failure(closing: str, tmp_path: Path) -> None:
    """Who closes standard output or error gets the file all the same, and no traceback."""
    line = f'"{sys.executable}" -c "{PROGRAM}" page -o page.html {closing}'
    done = subprocess.run(
        ["sh", "-c", line], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "page.html").is_file()


def test_a_full_output_is_told(tmp_path: Path) -> None:
    """Where the output cannot be written, one line says so, and the code is not that of success."""
    line = f'"{sys.executable}" -c "{PROGRAM}" --version >/dev/full'
    done = subprocess.run(["sh", "-c", line], capture_output=True, text=True, check=False)
    assert done.returncode in (1, 2)
    assert "No space left" in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_a_temporary_folder_with_an_umlaut_is_no_obstacle(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The FMU is unpacked where its wrapper can read the name."""
    folder = tmp_path / "ü"
    folder.mkdir()
    monkeypatch.setenv("TMPDIR", str(folder))
    answer = command.in_fresh_process("simulate", "--stop-time", "1")
    assert answer.code == 0, answer.err
