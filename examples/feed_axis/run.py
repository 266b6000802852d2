"""The command of this example: build, run in a master of your choice, study."""

from __future__ import annotations

import math
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Final

import numpy as np
import typer

from stickslip.errors import CommandError
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
    file = write_all(output, axis, native)
    found = run_in(master.value, file, stop, h)
    _tell(axis, found)
    _draw(output / "run.svg", axis, found)
    rows = np.column_stack(list(found.values()))
    np.savetxt(output / "run.csv", rows, "%.9g", ",", header=",".join(found), comments="")
    print(f"{file}, {output / 'run.csv'}, {output / 'run.svg'}")


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

    table = Table("", "co-simulation", "estimate", box=None)
    for cells in _holding(axis, found) if axis.distance else _creeping(axis, found):
        table.add_row(*cells)
    Console(markup=False, highlight=False).print(table)


def _creeping(axis: Axis, found: Run) -> list[tuple[str, str, str]]:
    from .estimates import critical_feed, steady_slip
    from .measure import creep
    from .sliding import sliding_mode

    seen = creep(found)
    # Backward everything is the same with the other sign.
    axis = replace(axis, feed=abs(axis.feed))
    expected, rigid = steady_slip(axis), _rigid(axis)
    damping = sliding_mode(axis).damping
    # What shakes by itself never slides evenly.
    ends = f"{critical_feed(axis) * 1e3:.3g} mm/s" if damping > 0.0 else "nowhere"
    return [
        ("jumps in the second half", str(seen.jumps), ""),
        ("jump", _micro(seen.jump), _micro(expected.jump) if expected else "none"),
        ("jump on a rigid drive", "", _micro(rigid["jump"])),
        ("period", _seconds(seen.period), _seconds(expected.period) if expected else "none"),
        ("mean following error", _micro(seen.error), ""),
        ("unevenness, rms", _micro(seen.unevenness), ""),
        ("jumping ends at a feed of", "", ends),
        ("the same on a rigid drive", "", f"{rigid['v_c'] * 1e3:.3g} mm/s"),
        ("damping ratio while it slides", "", f"{damping * 100:.2g} %"),
    ]


def _holding(axis: Axis, found: Run) -> list[tuple[str, str, str]]:
    from .estimates import hunting_slip
    from .measure import hunting

    seen, expected = hunting(found), hunting_slip(axis)
    return [
        ("comes to rest", "yes" if seen.stops else "no", ""),
        ("jump", _micro(seen.jump), _micro(expected.jump) if expected else "none"),
        ("period", _seconds(seen.period), _seconds(expected.period) if expected else "none"),
        ("mean distance from the target", _micro(seen.offset), ""),
    ]


def _rigid(axis: Axis) -> Mapping[str, float]:
    from stickslip_ref import critical_velocity, steady_cycle

    slideway = axis.slideway
    return {
        "jump": float(steady_cycle(slideway).delta_x),
        "v_c": float(critical_velocity(slideway)),
    }


def _draw(target: Path, axis: Axis, found: Run) -> None:
    from . import plots

    end = float(found["time"][-1])
    with plots.styled():
        if axis.distance:
            page = plots.holding(found, axis, 0.5 * end, 0.5 * end)
        else:
            shown = min(0.2, 0.5 * end)
            page = plots.creeping(found, axis, end - shown, shown)
        target.write_text(as_svg(page, "A feed axis"), encoding="utf-8")


def _micro(length: float) -> str:
    return "–" if math.isnan(length) else f"{length * 1e6:.4g} µm"


def _seconds(time: float) -> str:
    return "–" if math.isnan(time) else f"{time:.4g} s"


def _say(text: str) -> None:
    print(f"feed_axis: {text}", file=sys.stderr)
