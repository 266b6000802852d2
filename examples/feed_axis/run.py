"""The command of this example: build, run in a master of your choice, study."""

from __future__ import annotations

import importlib.util
import math
import subprocess
import sys
import tempfile
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Final

import numpy as np
import typer
from numpy.typing import NDArray

from stickslip.errors import CommandError
from stickslip.progress import Meter
from stickslip.units import parse
from stickslip_fmu.packer import build as build_block
from stickslip_native.compiler import CompilerError
from stickslip_native.packer import build as build_native
from stickslip_verification.report.svg import as_svg

from . import masters, ssp
from .axis import Axis
from .build import build_drive
from .coupling import Run
from .options import axis_with, option

OUTPUT: Final = Path("build/feed_axis")
MOST_ROWS: Final = 20_001
"""Rows of run.csv; of a longer run every n-th is written."""

app = typer.Typer(
    help="A feed axis, closed loop: a servo drive moves the stick-slip block.",
    rich_markup_mode=None,
    add_completion=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


class Master(StrEnum):
    """Who steps the two FMUs."""

    FMPY = "fmpy"
    ECOS = "ecos"
    LIBCOSIM = "libcosim"


_PACKAGES: Final = {Master.ECOS: "ecospy", Master.LIBCOSIM: "libcosimpy"}
"""What a master needs beside the project."""

Folder = Annotated[Path, typer.Option("--output", "-o", metavar="DIR", help="Folder to write to.")]
Native = Annotated[
    bool,
    typer.Option(
        "--native", help="Compile the table for this machine: needs a C compiler, and no Python."
    ),
]


@app.command()
def build(native: Native = False, output: Folder = OUTPUT) -> None:
    """Build StickSlip.fmu, ServoDrive.fmu and FeedAxis.ssp."""
    print(write_all(output, Axis(), native))


@app.command()
def run(
    master: Annotated[Master, typer.Option(help="Who steps the FMUs.")] = Master.FMPY,
    feed: Annotated[str | None, option("feed", "Commanded speed.")] = None,
    distance: Annotated[
        str | None,
        option("distance", "Length of a move, after which the axis holds; 0: the feed goes on."),
    ] = None,
    acceleration: Annotated[str | None, option("acceleration", "Commanded acceleration.")] = None,
    m: Annotated[str | None, option("m", "Mass of the table.")] = None,
    k: Annotated[str | None, option("k", "Stiffness of the screw.")] = None,
    c: Annotated[str | None, option("c", "Viscous friction of the way.")] = None,
    mu_s: Annotated[float | None, option("mu_s", "Static friction coefficient.")] = None,
    mu_k: Annotated[float | None, option("mu_k", "Kinetic friction coefficient.")] = None,
    K_v: Annotated[float | None, option("K_v", "Position gain.")] = None,
    omega_v: Annotated[
        float | None, option("omega_v", "Bandwidth of the velocity loop; T_n is 4 / omega_v.")
    ] = None,
    integral: Annotated[
        bool | None, typer.Option("--integral/--no-integral", help="Velocity loop with integral.")
    ] = None,
    on_table: Annotated[
        bool | None, typer.Option("--on-table/--on-motor", help="Where the position is measured.")
    ] = None,
    dead_band: Annotated[str | None, option("dead_band", "Position error taken as none.")] = None,
    velocity_feedforward: Annotated[
        float | None, option("velocity_feedforward", "Part of the speed added.")
    ] = None,
    friction_feedforward: Annotated[
        str | None, option("friction_feedforward", "Force added.")
    ] = None,
    lag: Annotated[str | None, option("lag", "Time constant of the current loop.")] = None,
    dead_time: Annotated[
        str | None, option("dead_time", "Time from a sample to when its force acts.")
    ] = None,
    low_pass: Annotated[
        float | None, option("low_pass", "Low pass of the force command; 0: none.")
    ] = None,
    low_pass_damping: Annotated[
        float | None, option("low_pass_damping", "Its damping ratio; 0: of first order.")
    ] = None,
    notch: Annotated[float | None, option("notch", "Notch of the force command; 0: none.")] = None,
    notch_damping: Annotated[
        float | None, option("notch_damping", "Damping ratio of its poles.")
    ] = None,
    notch_depth: Annotated[
        float | None, option("notch_depth", "What it leaves at its frequency.")
    ] = None,
    dry: Annotated[str | None, option("dry", "Dry friction of motor and nut.")] = None,
    stop_time: Annotated[str, typer.Option(metavar="TIME", help="End of the run.")] = "2",
    step: Annotated[
        str | None,
        typer.Option(metavar="TIME", help="Communication step.", show_default="the sample time"),
    ] = None,
    native: Native = False,
    output: Folder = OUTPUT,
) -> None:
    """Run the axis in a master; print what was found, write FeedAxis.ssp, run.csv and run.svg."""
    given: dict[str, str | float | None] = {
        "feed": feed,
        "distance": distance,
        "acceleration": acceleration,
        "m": m,
        "k": k,
        "c": c,
        "mu_s": mu_s,
        "mu_k": mu_k,
        "K_v": K_v,
        "omega_v": omega_v,
        "on_table": on_table,
        "dead_band": dead_band,
        "velocity_feedforward": velocity_feedforward,
        "friction_feedforward": friction_feedforward,
        "lag": lag,
        "dead_time": dead_time,
        "low_pass": low_pass,
        "low_pass_damping": low_pass_damping,
        "notch": notch,
        "notch_damping": notch_damping,
        "notch_depth": notch_depth,
        "dry": dry,
    }
    axis = axis_with(given, integral)
    stop = parse(stop_time, "s", "--stop-time")
    h = axis.T_s if step is None else parse(step, "s", "--step")
    if axis.K_v == 0.0 or axis.omega_v == 0.0:
        raise CommandError("--kv and --omega-v must be above 0: without them nothing is controlled")
    if axis.feed == 0.0:
        raise CommandError("--feed must not be 0: an axis that is told to stand shows nothing")
    if not 0.0 < h <= stop / 10.0:
        raise CommandError(
            f"--step = {h:g} s is out of range: above 0, a tenth of --stop-time at most"
        )
    check_master(master)
    file = write_all(output, axis, native)
    with Meter(f"Running {stop:g} s in {master.value}"):
        found = run_in(master.value, file, stop, h)
    _tell(axis, found)
    _draw(output / "run.svg", axis, found)
    rows = np.column_stack(list(found.values()))
    kept = thinned(rows)
    np.savetxt(output / "run.csv", kept, "%.9g", ",", header=",".join(found), comments="")
    fewer = "" if len(kept) == len(rows) else f" ({len(kept)} of {len(rows)} rows)"
    print(f"{file}, {output / 'run.csv'}{fewer}, {output / 'run.svg'}")


@app.command()
def study(
    document: Annotated[
        Path, typer.Option(metavar="FILE", help="The how-to, whose tables and pictures to make.")
    ] = Path("docs/feed-axis.md"),
    check: Annotated[bool, typer.Option("--check", help="Write nothing, compare only.")] = False,
) -> None:
    """Make the tables and pictures of the how-to anew, or check that they still hold."""
    from .document import check_document, write_document

    with tempfile.TemporaryDirectory(prefix="feed-axis-") as folder:
        write_all(Path(folder), Axis())
        if not check:
            write_document(document, Path(folder), _say)
            return
        wrong = check_document(document, Path(folder), _say)
    for line in wrong:
        _say(line)
    if wrong:
        raise typer.Exit(1)


def write_all(folder: Path, axis: Axis, native: bool = False) -> Path:
    """Write both FMUs and the SSP file into a folder; return the path of the latter.

    A `native` table is compiled for this machine and has the name of the other one.
    """
    folder.mkdir(parents=True, exist_ok=True)
    if native:
        build_native(folder / "StickSlip.fmu", this_machine=True)
    else:
        build_block(folder)
    build_drive(folder)
    return ssp.write_ssp(folder / "FeedAxis.ssp", axis, folder)


def check_master(master: Master) -> None:
    """Refuse a master that is not installed; the message says how to install it."""
    needed = _PACKAGES.get(master)
    if needed is not None and importlib.util.find_spec(needed) is None:
        raise CommandError(
            f"--master {master} needs {needed}: python -m pip install {needed}"
            + (", and of Debian: apt-get install libtbb12" if master is Master.ECOS else "")
        )


def thinned(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return every n-th row and the last one, `MOST_ROWS` at most."""
    every = -(-len(rows) // (MOST_ROWS - 1))
    last = len(rows) - 1
    return rows[[*range(0, last, every), last]]


def run_in(master: str, file: Path, stop_time: float, step: float) -> Run:
    """Run an SSP file in a process of its own, in the master of this name.

    Raises
    ------
    CommandError
        If the master fails; the message ends with what the FMU said, else with the last line.
    """
    with tempfile.TemporaryDirectory(prefix="feed-axis-") as folder:
        table = Path(folder) / "run.csv"
        words = [master, str(file), repr(stop_time), repr(step), str(table), *ssp.OUTPUTS]
        done = subprocess.run(
            [sys.executable, "-I", masters.__file__, *words],
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode != 0:
            raise CommandError(f"--master {master} failed: {_reason(done.stderr)}")
        # Not every master stops where an FMU fails; what the FMU says is for the person.
        for line in done.stderr.splitlines():
            _say(f"{master}: {line}")
        rows = np.genfromtxt(table, delimiter=",", skip_header=1, ndmin=2)
    names = ["time", *(name.partition(".")[2] for name in ssp.OUTPUTS)]
    return dict(zip(names, rows.T, strict=True))


def main() -> None:
    """Run the command; the exit code is 0 for done, 1 for a failed check, 2 for wrong use."""
    try:
        app(prog_name="python -m examples.feed_axis")
    except (CommandError, CompilerError, ValueError) as error:
        _say(str(error))
        sys.exit(2)
    except OSError as error:
        _say(f"{error.filename or ''}: {error.strerror or error}".lstrip(": "))
        sys.exit(2)


def _reason(errors: str) -> str:
    lines = errors.strip().splitlines() or ["no reason given"]
    return next((line for line in lines if line.startswith(("StickSlip", "ServoDrive"))), lines[-1])


def _tell(axis: Axis, found: Run) -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table("", "co-simulation", "design tool", box=None)
    for cells in _holding(axis, found) if axis.distance else _creeping(axis, found):
        table.add_row(*cells)
    Console(markup=False, highlight=False).print(table)


def _creeping(axis: Axis, found: Run) -> list[tuple[str, str, str]]:
    from stickslip_design.critical import jumps_of, rigid_critical_feed
    from stickslip_design.loop.jumps import jump_at, limit_of_jumps
    from stickslip_design.loop.stability import is_stable, swing

    from .designed import designed
    from .measure import creep

    seen = creep(found)
    # Backward everything is the same with the other sign.
    feed, computed = abs(axis.feed), designed(axis)
    # What shakes by itself never slides evenly.
    stable = is_stable(computed)
    expected = jump_at(computed, feed) if stable else None
    otherwise = "none" if stable else "unstable loop"
    ends = f"{limit_of_jumps(computed).feed * 1e3:.3g} mm/s" if stable else "nowhere"
    rigid = replace(computed, drive=None)
    jumps_of_rigid = jumps_of(rigid, feed)
    return [
        ("jumps in the second half", str(seen.jumps), ""),
        ("jump", _micro(seen.jump), _micro(expected.way) if expected else otherwise),
        ("jump on a rigid drive", "", _micro(jumps_of_rigid.way) if jumps_of_rigid else "none"),
        ("period", _seconds(seen.period), _seconds(expected.period) if expected else otherwise),
        ("mean following error", _micro(seen.error), ""),
        ("unevenness, rms", _micro(seen.unevenness), ""),
        ("jumping ends at a feed of", "", ends),
        ("the same on a rigid drive", "", f"{rigid_critical_feed(rigid) * 1e3:.3g} mm/s"),
        ("damping ratio while it slides", "", f"{swing(computed).damping * 100:.2g} %"),
    ]


def _holding(axis: Axis, found: Run) -> list[tuple[str, str, str]]:
    from .measure import hunting
    from .study import expected_hunting

    seen, expected = hunting(found), expected_hunting(axis)
    return [
        ("comes to rest", "yes" if seen.stops else "no", ""),
        ("jump", _micro(seen.jump), _micro(expected.jump) if expected else "none"),
        ("period", _seconds(seen.period), _seconds(expected.period) if expected else "none"),
        ("mean distance from the target", _micro(seen.offset), ""),
    ]


def _draw(target: Path, axis: Axis, found: Run) -> None:
    from . import plots

    end = float(found["time"][-1])
    with plots.styled():
        if axis.distance:
            page = plots.holding(found, axis, 0.5 * end, 0.5 * end)
        else:
            shown = min(0.2, 0.5 * end)
            page = plots.creeping(found, axis, end - shown, shown)
        target.write_text(as_svg(page, Title="A feed axis"), encoding="utf-8")


def _micro(length: float) -> str:
    return "–" if math.isnan(length) else f"{length * 1e6:.4g} µm"


def _seconds(time: float) -> str:
    return "–" if math.isnan(time) else f"{time:.4g} s"


def _say(text: str) -> None:
    print(f"feed_axis: {text}", file=sys.stderr)
